"""Materials of blocks and joints, in SI units."""

import math
from dataclasses import dataclass
from typing import Annotated

from .errors import SceneError
from .ranges import ABOVE_ZERO, NotNegative, Positive, Range, check_numbers

LEAST_FRICTION = 1e-6
"""Least tan φ that is not 0: what is smaller is lost in a linear program's tolerance, cohesion / tan φ with it."""


@dataclass(frozen=True)
class BlockMaterial:
    """What blocks are made of.

    Parameters
    ----------
    density
        Mass density [kg/m³].
    young
        Young's modulus [Pa]; None where the scene leaves it out. Rigid models do not read it.
    poisson
        Poisson's ratio.
    name
        What `assign` calls it in a scene file.

    Raises
    ------
    SceneError
        For numbers that no material has.
    """

    density: Positive
    young: Positive | None = None
    poisson: Annotated[float, Range(above=-1.0, most=0.5)] = 0.0
    name: str = "block"

    def __post_init__(self) -> None:
        check_numbers(self, "block")


@dataclass(frozen=True)
class Mortar:
    """A layer of mortar, from which joint stiffness follows.

    Parameters
    ----------
    young, poisson, thickness
        Young's modulus [Pa], Poisson's ratio, and thickness of the layer [m].
    """

    young: Positive
    poisson: Annotated[float, Range(least=0.0, below=0.5)]
    thickness: Positive

    def __post_init__(self) -> None:
        check_numbers(self, "joint.mortar")


@dataclass(frozen=True)
class Stiffness:
    """Stiffness of a joint per unit area, normal and tangential [Pa/m]."""

    normal: float
    shear: float

    def __post_init__(self) -> None:
        for name in ("normal", "shear"):
            object.__setattr__(self, name, ABOVE_ZERO.take(f"joint.{name}_stiffness", getattr(self, name)))


@dataclass(frozen=True)
class JointMaterial:
    """Mohr–Coulomb joint: ``|τ| ≤ cohesion − σ friction``, ``σ ≤ tensile_strength``.

    Parameters
    ----------
    friction
        tan φ.
    cohesion
        Shear strength at zero normal stress [Pa].
    tensile_strength
        Tension cut-off [Pa], at most the apex ``cohesion / friction`` of the cone; None is the apex, and goes with it
        when a copy of the material is given another friction or cohesion.
    elasticity
        Mortar or stiffness; None where the scene leaves it out. Limit analysis does not read it.
    inset
        Distance by which the contact points are moved in from the joint ends [m].
    fracture_energy_1, fracture_energy_2
        Fracture energies in opening and in shear [J/m²]; None is perfectly plastic.
    law
        A law of one's own (`runningbond.joints.Law`); None is Coulomb's, softening where there is a fracture energy.
    name
        What `assign` calls it in a scene file.

    Raises
    ------
    SceneError
        For numbers that no joint has, alone or together.
    """

    friction: NotNegative
    cohesion: NotNegative = 0.0
    tensile_strength: NotNegative | None = None
    elasticity: Mortar | Stiffness | None = None
    inset: NotNegative = 0.0
    fracture_energy_1: NotNegative | None = None
    fracture_energy_2: NotNegative | None = None
    law: object = None
    name: str = "joint"

    def __post_init__(self) -> None:
        check_numbers(self, "joint")
        check_friction("joint.friction", self.friction, self.friction)
        given = self.tensile_strength
        if given is None and self.friction == 0.0 and self.cohesion > 0.0:
            what = "is missing; with friction 0 its default, cohesion / friction, does not exist"
            raise SceneError("joint.tensile_strength", what)
        if given is not None and given > self._apex * (1 + 1e-3):
            what = f"must be at most cohesion / friction = {self._apex:.6g}, the apex of the Coulomb cone"
            raise SceneError("joint.tensile_strength", what, given)
        if self.fracture_energy_1 is None and self.fracture_energy_2 is not None:
            what = "is missing; what a joint loses in slip it loses in opening as well"
            raise SceneError("joint.fracture_energy_1", what)
        if self.law is not None and not hasattr(self.law, "kernel"):
            raise SceneError("joint.law", "must be a law of joints, a runningbond.joints.Law in Python", self.law)

    @property
    def tension(self) -> float:
        """Tensile strength [Pa]: the one given, or the apex of the cone."""
        if self.tensile_strength is not None:
            return min(self.tensile_strength, self._apex)
        return self._apex if self.friction > 0.0 else 0.0

    @property
    def _apex(self) -> float:
        return self.cohesion / self.friction if self.friction > 0.0 else math.inf


def check_friction(key: str, friction: float, value: float) -> None:
    """Refuse a tan φ too small to tell from none, given as a value under some key."""
    if 0.0 < friction < LEAST_FRICTION:
        what = f"must be 0, for joints without friction, or such that tan φ ≥ {LEAST_FRICTION:g}"
        raise SceneError(key, what, value)
