"""Materials of blocks and joints, in SI units."""

from dataclasses import dataclass


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
    """

    density: float
    young: float | None = None
    poisson: float = 0.0


@dataclass(frozen=True)
class Mortar:
    """A layer of mortar, from which joint stiffness follows.

    Parameters
    ----------
    young
        Young's modulus [Pa].
    poisson
        Poisson's ratio.
    thickness
        Thickness of the layer [m].
    """

    young: float
    poisson: float
    thickness: float


@dataclass(frozen=True)
class Stiffness:
    """Stiffness of a joint per unit area, normal and tangential [Pa/m]."""

    normal: float
    shear: float


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
        Tension cut-off [Pa], at most the apex ``cohesion / friction`` of the cone.
    elasticity
        Mortar or stiffness; None where the scene leaves it out. Limit analysis does not read it.
    inset
        Distance by which the contact points are moved in from the joint ends [m].
    fracture_energy_1, fracture_energy_2
        Fracture energies in opening and in shear [J/m²]; None is perfectly plastic.
    """

    friction: float
    cohesion: float = 0.0
    tensile_strength: float = 0.0
    elasticity: Mortar | Stiffness | None = None
    inset: float = 0.0
    fracture_energy_1: float | None = None
    fracture_energy_2: float | None = None
