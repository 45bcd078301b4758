"""Joint points and the Mohr–Coulomb joint: the one place where its signs are written down."""

from .coulomb import COULOMB
from .law import KernelLaw, Law, StaticLaw
from .mohr_coulomb import PointStrength, point_strength
from .point_law import PointLaw, PointResponse
from .points import JointPoints, Rule, gauss, joint_points, lobatto
from .resultant_law import ResultantLaw, resultant_law
from .softening import SOFTENING
from .stiffness import joint_stiffness
from .stiffness_range import stiffness_note
from .wall_law import kernel_law, law_of, static_law
from .wall_points import wall_inset, wall_points, wall_stiffness, wall_strength

__all__ = [
    "COULOMB",
    "SOFTENING",
    "JointPoints",
    "KernelLaw",
    "Law",
    "PointLaw",
    "PointResponse",
    "PointStrength",
    "ResultantLaw",
    "Rule",
    "StaticLaw",
    "gauss",
    "joint_points",
    "joint_stiffness",
    "kernel_law",
    "law_of",
    "lobatto",
    "point_strength",
    "resultant_law",
    "static_law",
    "stiffness_note",
    "wall_inset",
    "wall_points",
    "wall_stiffness",
    "wall_strength",
]
