"""Materials of blocks and joints, in SI units."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias, get_args

from .errors import SceneError
from .ranges import ABOVE_ZERO, NotNegative, Positive, Range, check_numbers, one_of

Softening: TypeAlias = Literal["linear", "exponential"]
"""How strength falls with a jump: on a straight line, or exponentially (Lourenço & Rots 1997)."""

CAP_SHEAR = 9.0
"""C_ss of the cap on pressures where none is given."""

LEAST_FRICTION, MOST_FRICTION = 1e-6, 1e6
"""Least tan φ that is not 0: what is smaller is lost in a linear program's tolerance, cohesion / tan φ with it.

The largest is where normal forces that decide are lost beside the shear that they allow.
"""


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
    thickness
        Out-of-plane thickness of its blocks [m]; None is that of the wall.
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
    thickness: Positive | None = None
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
class Closure:
    """How a joint closes: its normal stiffness grows with the pressure p on it, dp/dδ = k_n + growth · p.

    The semi-logarithmic law of rock joints (Evans, Kohl, Hopkirk & Rybach 1992), which a dry joint's stiffness under
    several pressures gives as a straight line.

    Parameters
    ----------
    growth
        Stiffness per pressure [1/m]; `Stiffness.normal` is that without pressure.
    stiffest
        Stiffness at which the growth ends [Pa/m].
    """

    growth: Positive
    stiffest: Positive

    def __post_init__(self) -> None:
        check_numbers(self, "joint.closure")


@dataclass(frozen=True)
class JointMaterial:
    """Mohr–Coulomb joint: ``|τ| ≤ cohesion − σ friction``, ``σ ≤ tensile_strength``, and it may crush and close.

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
    softening
        The branch along which these are spent.
    compressive_strength, cap_shear
        f_m [Pa] and C_ss of the cap on pressures, ``p² + cap_shear τ² ≤ compressive_strength²`` (Lourenço & Rots 1997,
        eq. 19, with C_nn = 1, C_n = 0); None is a joint that never crushes.
    compressive_fracture_energy
        Energy of crushing, all that is not elastic [J/m²]; None is perfectly plastic.
    peak_closure
        Plastic closure [m] at which a joint that begins to crush at a third of its strength has come to it (Lourenço &
        Rots 1997, κ_p); 0 is elastic up to the strength.
    closure
        How the normal stiffness grows with pressure; None is constant.
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
        """Energy of crushing up to `peak_closure` [J/m²]."""
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
        """Whether it can bear anything without pressure."""
        return self.tension > 0.0 or self.cohesion > 0.0

    @property
    def softens(self) -> bool:
        """Whether it loses with its opening and slip what it can bear beyond friction."""
        return self.fracture_energy_1 is not None and self.is_bonded

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
    """Refuse a tan φ too small to tell from none, or too large to tell from no slip; the value is what was given."""
    if friction > MOST_FRICTION:
        raise SceneError(key, f"must be such that tan φ ≤ {MOST_FRICTION:g}, with which no joint slides", value)
    if 0.0 < friction < LEAST_FRICTION:
        what = f"must be 0, for joints without friction, or such that tan φ ≥ {LEAST_FRICTION:g}"
        raise SceneError(key, what, value)
