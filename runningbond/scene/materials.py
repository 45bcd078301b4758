"""Materials of blocks and joints, in SI units."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, Literal, TypeAlias, get_args

from .errors import SceneError
from .ranges import ABOVE_ZERO, NotNegative, Positive, Range, check_numbers, one_of

Softening: TypeAlias = Literal["linear", "exponential"]
"""Decrease of strength with the displacement jump: linear, or exponential (Lourenço & Rots 1997)."""

CAP_SHEAR = 9.0
"""Default of C_ss, the shear coefficient of the compression cap."""

LEAST_FRICTION, MOST_FRICTION = 1e-6, 1e6
"""Smallest nonzero and largest tan φ. Below, tan φ and cohesion / tan φ are lost in a linear program's tolerance.

Above, decisive normal forces are lost beside the shear forces that they permit.
"""


@dataclass(frozen=True)
class BlockMaterial:
    """Material of blocks.

    Parameters
    ----------
    density
        Mass density [kg/m³].
    young
        Young's modulus [Pa]; None if the scene does not give it. Rigid models do not use it.
    poisson
        Poisson's ratio.
    thickness
        Out-of-plane thickness of its blocks [m]; None is the thickness of the wall.
    name
        Name of the material in a scene file, which `assign` refers to.

    Raises
    ------
    SceneError
        For numbers outside their physical range.
    """

    density: Positive
    young: Positive | None = None
    poisson: Annotated[float, Range(above=-1.0, most=0.5)] = 0.0
    thickness: Positive | None = None
    name: str = "block"

    def __post_init__(self) -> None:
        check_numbers(self, "block")


@dataclass(frozen=True)
class Mortar:
    """A layer of mortar, from which the stiffness of a joint is computed.

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
class Closure:
    """Closure law of a joint: its normal stiffness grows with the pressure p on it, dp/dδ = k_n + growth · p.

    This is the semi-logarithmic law of rock joints (Evans, Kohl, Hopkirk & Rybach 1992). Its parameters follow from a
    straight line through the stiffness of a dry joint measured at several pressures.

    Parameters
    ----------
    growth
        Increase of stiffness per pressure [1/m]; `Stiffness.normal` is the stiffness at zero pressure.
    stiffest
        Largest normal stiffness [Pa/m]: the growth ends there.
    """

    growth: Positive
    stiffest: Positive

    def __post_init__(self) -> None:
        check_numbers(self, "joint.closure")


@dataclass(frozen=True)
class JointMaterial:
    """Mohr–Coulomb joint: ``|τ| ≤ cohesion − σ friction``, ``σ ≤ tensile_strength``, and optional crushing and closure.

    Parameters
    ----------
    friction
        tan φ.
    cohesion
        Shear strength at zero normal stress [Pa].
    tensile_strength
        Tension cut-off [Pa], at most the apex ``cohesion / friction`` of the cone. None is the apex, which
        then changes in copies of the material with another friction or cohesion.
    elasticity
        Mortar or stiffness; None if the scene does not give it. Limit analysis does not use it.
    inset
        Distance by which the contact points are moved inwards from the joint ends [m].
    fracture_energy_1, fracture_energy_2
        Fracture energies of modes I (opening) and II (shear) [J/m²]; None is perfectly plastic.
    softening
        Shape of the softening branch, ``"linear"`` or ``"exponential"``.
    compressive_strength, cap_shear
        f_m [Pa] and C_ss of the compression cap, ``p² + cap_shear τ² ≤ compressive_strength²`` (Lourenço & Rots 1997,
        eq. 19, with C_nn = 1, C_n = 0); without a compressive strength (None) the joint never crushes.
    compressive_fracture_energy
        Energy dissipated by crushing, without the elastic part [J/m²]; None is perfectly plastic.
    peak_closure
        Plastic closure [m] at which the joint reaches its compressive strength, having begun to crush at a third of it
        (Lourenço & Rots 1997, κ_p); 0 is elastic up to the strength.
    closure
        Growth of the normal stiffness with pressure; None is a constant stiffness.
    law
        A user-defined law (`runningbond.joints.Law`); None is Coulomb's, with softening if a fracture energy is given.
    name
        Name of the material in a scene file, which `assign` refers to.

    Raises
    ------
    SceneError
        For numbers outside their physical range, and for numbers that contradict each other.
    """

    friction: NotNegative
    cohesion: NotNegative = 0.0
    tensile_strength: NotNegative | None = None
    elasticity: Mortar | Stiffness | None = None
    inset: NotNegative = 0.0
    fracture_energy_1: NotNegative | None = None
    fracture_energy_2: NotNegative | None = None
    softening: Softening = "linear"
    compressive_strength: Positive | None = None
    compressive_fracture_energy: Positive | None = None
    cap_shear: NotNegative = CAP_SHEAR
    peak_closure: NotNegative = 0.0
    closure: Closure | None = None
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
        one_of("joint.softening", self.softening, get_args(Softening))
        if self.softening != "linear" and self.fracture_energy_1 is None:
            raise SceneError("joint.fracture_energy_1", "is missing; a joint that softens needs one")
        self._check_crushing()
        self._check_closure()
        if self.law is not None and not hasattr(self.law, "kernel"):
            raise SceneError("joint.law", "must be a law of joints, a runningbond.joints.Law in Python", self.law)

    def _check_crushing(self) -> None:
        energy = self.compressive_fracture_energy
        shaped = energy is not None or self.peak_closure or self.cap_shear != CAP_SHEAR
        if self.compressive_strength is None and shaped:
            what = "is missing; a joint that crushes needs a strength"
            raise SceneError("joint.compressive_strength", what)
        if energy is not None and energy <= self.energy_to_peak:
            what = f"must be above {self.energy_to_peak:.6g}, which is spent on the way to the peak"
            raise SceneError("joint.compressive_fracture_energy", what, energy)

    @property
    def energy_to_peak(self) -> float:
        """Energy dissipated by crushing up to `peak_closure` [J/m²]."""
        return (1 / 3 + math.pi / 6) * (self.compressive_strength or 0.0) * self.peak_closure

    def _check_closure(self) -> None:
        if self.closure is None:
            return
        if not isinstance(self.elasticity, Stiffness):
            raise SceneError("joint.normal_stiffness", "is missing; closure needs the stiffness without pressure")
        if self.closure.stiffest < self.elasticity.normal:
            what = f"must be at least normal_stiffness = {self.elasticity.normal:g}"
            raise SceneError("joint.closure.stiffest", what, self.closure.stiffest)

    @property
    def is_bonded(self) -> bool:
        """Whether the joint has a tensile or shear strength at zero pressure."""
        return self.tension > 0.0 or self.cohesion > 0.0

    def broken(self) -> "JointMaterial":
        """A copy without cohesion and tension, with the same friction, stiffness and crushing."""
        still = replace(self, softening="linear", fracture_energy_2=None)
        return replace(still, cohesion=0.0, tensile_strength=None, fracture_energy_1=None)

    def never_crushing(self) -> "JointMaterial":
        """A copy with infinite compressive strength."""
        still = replace(self, compressive_fracture_energy=None, peak_closure=0.0, cap_shear=CAP_SHEAR)
        return replace(still, compressive_strength=None)

    @property
    def softens(self) -> bool:
        """Whether opening and slip reduce the cohesion and tensile strength of the joint."""
        return self.fracture_energy_1 is not None and self.is_bonded

    @property
    def tension(self) -> float:
        """Tensile strength [Pa]: the one given, at most the apex of the cone, or else the apex."""
        if self.tensile_strength is not None:
            return min(self.tensile_strength, self._apex)
        return self._apex if self.friction > 0.0 else 0.0

    @property
    def _apex(self) -> float:
        return self.cohesion / self.friction if self.friction > 0.0 else math.inf


def check_friction(key: str, friction: float, value: float) -> None:
    """Refuse a tan φ that solvers cannot tell from zero or from infinity; `value` is what the user has given."""
    if friction > MOST_FRICTION:
        raise SceneError(key, f"must be such that tan φ ≤ {MOST_FRICTION:g}, with which no joint slides", value)
    if 0.0 < friction < LEAST_FRICTION:
        what = f"must be 0, for joints without friction, or such that tan φ ≥ {LEAST_FRICTION:g}"
        raise SceneError(key, what, value)


def table_of(material: BlockMaterial | JointMaterial) -> str:
    """Name of the scene file's table that describes a material."""
    if material.name in ("block", "joint", "inner_joint"):
        return material.name
    return f"{'materials' if isinstance(material, BlockMaterial) else 'joints'}.{material.name}"
