"""Measurements of the campaigns on parts of their walls: on stones, on prisms, and on walls before they were pushed.

Nothing here is fitted to a shear test. Numbers are from the laboratory's README and its table, which take them from
Lourenço et al. (2005), Vasconcelos (2005) and Vasconcelos & Lourenço (2009) via Vanin et al. (2017), unless stated
otherwise.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from runningbond.pictures.sheet import Sheet
from runningbond.scene import JointMaterial, SceneError
from runningbond.scene.ranges import suggestion

from .table_row import TableRow

UNIT_WEIGHT = 20e3
"""Unit weight of the walls [N/m³]: `Ntot` of the table less the load in their names, divided by their volume."""

POISSON = 0.2
"""Poisson's ratio of stone; no campaign reports it."""

SPLITTING_ENERGY = 100.0
"""Mode I fracture energy of stone [J/m²], for all walls: 0.1 N/mm. Not measured by the campaigns. Published values for
sandstone and granite are about 0.05 to 0.25 N/mm, for example Vasconcelos, Lourenço, Alves & Pamplona (2008); from
memory."""

SHEAR_ENERGIES = 10.0
"""Ratio of mode II to mode I fracture energy if no source reports it; usual for interface elements."""


@dataclass(frozen=True)
class Stone:
    """A stone, its sawn blocks, and the dry walls built of them.

    Parameters
    ----------
    friction
        tan φ of dry joints.
    prism, block, tensile
        Compressive strengths of prisms and of the block, and the block's tensile strength [Pa].
    young
        Young's modulus of the block [Pa].
    moduli
        Young's modulus of walls under vertical loads [Pa], by the mean pressure [Pa].
    first_course
        Block with which the lowest course starts.
    is_square
        Whether the wall is as high as the actuator, whatever height the table has.
    """

    friction: float
    prism: float
    block: float
    tensile: float
    young: float
    moduli: Mapping[float, float]
    first_course: Literal["full", "half"]
    is_square: bool = False

    @property
    def cohesion(self) -> float:
        """Shear strength of the intact block [Pa]: √(f_c f_t) / 2, from the Coulomb line through both strengths."""
        return math.sqrt(self.block * self.tensile) / 2

    def modulus(self, pressure: float) -> float:
        """Young's modulus of walls [Pa] under a pressure [Pa], interpolated; beyond the measured ones the nearest."""
        pressures, moduli = np.array(sorted(self.moduli.items())).T
        return float(np.interp(pressure, pressures, moduli))

    def stiffness(self, block_height: float, *, deformable: bool) -> tuple[float, float]:
        """Normal stiffness of a bed joint at zero pressure [Pa/m], and its growth with pressure [1/m].

        The least-squares straight line through E / h of walls under their vertical loads. If blocks deform, their
        compliance is subtracted: 1 / k = h (1 / E - 1 / E_b).
        """
        pressure, modulus = np.array(sorted(self.moduli.items())).T
        stiffness = 1 / (block_height * (1 / modulus - (1 / self.young if deformable else 0.0)))
        growth, start = np.polyfit(pressure, stiffness, 1)
        return float(start), float(growth)


STONES = {
    "sandstone": Stone(
        friction=0.62,
        prism=57e6,
        block=92e6,
        tensile=3.7e6,
        young=15.5e9,
        moduli={0.15e6: 566e6, 0.5e6: 756e6, 1.0e6: 1135e6, 1.25e6: 1188e6},
        first_course="half",
        is_square=True,
    ),
    "granite": Stone(
        friction=0.65,
        prism=73e6,
        block=69e6,
        tensile=2.8e6,
        young=20.2e9,
        moduli={0.5e6: 3287e6, 0.875e6: 4068e6, 1.25e6: 4722e6},
        first_course="full",
    ),
}


def find_stone(row: TableRow) -> Stone:
    """The stone that a row names."""
    name, known = row.text("stone"), list(STONES)
    if name.casefold() not in known:
        what = f"must be one of {', '.join(known)}{suggestion(name.casefold(), known)}"
        raise SceneError(row.key("Stone"), f"{what}; for another give a scene NAME.toml{row.likely('Stone')}", name)
    return STONES[name.casefold()]


def sources() -> Sheet:
    """Table of all numbers that are common to the walls of a stone, with their sources."""
    rows = []
    for name, stone in STONES.items():
        start, growth = stone.stiffness(0.1 if stone.is_square else 0.15, deformable=False)
        moduli = ", ".join(f"{e / 1e6:g} at {p / 1e6:g}" for p, e in stone.moduli.items())
        rows += [
            [name, "tan φ of dry joints", f"{stone.friction:g}", "reported by the campaign"],
            [name, "E of the wall under pressures [MPa]", moduli, "measured before it was pushed (Epc)"],
            [
                name,
                "joint stiffness k₀ [MPa/m] + growth [1/m] · p",
                f"{start / 1e6:.0f} + {growth:.0f} p",
                "least squares through Epc / h_b",
            ],
            [name, "stiffest joint [MPa/m]", "E_b / h_b", f"E_b = {stone.young / 1e9:g} GPa, of blocks"],
            [name, "shear stiffness", "k(σ₀) / (2 (1 + ν))", f"isotropy, ν = {POISSON:g}"],
            [name, "strength of joints in compression [MPa]", f"{stone.prism / 1e6:g}", "prisms"],
            [name, "C_ss of their cap, p² + C_ss τ² ≤ f_m²", f"{JointMaterial.cap_shear:g}", "default for mortar"],
            [
                name,
                "f_t of blocks [MPa]",
                f"{stone.tensile / 1e6:g}",
                "flexural" if stone.is_square else "direct tension",
            ],
            [name, "cohesion of blocks [MPa]", f"{stone.cohesion / 1e6:.1f}", "√(f_c f_t) / 2, of cores and f_t"],
            [name, "G_I of blocks [N/mm]", f"{SPLITTING_ENERGY / 1e3:g}", "default for stone, not measured here"],
            [name, "G_II of blocks", f"{SHEAR_ENERGIES:g} G_I", "usual, not measured"],
            [name, "unit weight [kN/m³]", f"{UNIT_WEIGHT / 1e3:g}", "Ntot less the number in the name"],
        ]
    return Sheet("What the models read, and where it comes from", ("stone", "what", "value", "source"), rows)
