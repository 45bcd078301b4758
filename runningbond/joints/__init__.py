"""Joint points and the Mohr–Coulomb joint: the only place that defines its signs."""

from .law import KernelLaw, Law, crushes_by_law, loses_strength, unread_keys
from .mohr_coulomb import PointStrength, point_strength
from .point_law import PointLaw, PointResponse
from .points import JointPoints, Rule, gauss, joint_points, lobatto
from .resultant_law import ResultantLaw
from .stiffness import joint_stiffness, stiffness_note
from .wall_points import (
    ends_note,
    impact_note,
    listed_points,
    static_law,
    wall_caps,
    wall_cones,
    wall_inset,
    wall_points,
    wall_rule,
    wall_stiffness,
    wall_strength,
)

__all__ = [
    "JointPoints",
    "KernelLaw",
    "Law",
    "PointLaw",
    "PointResponse",
    "PointStrength",
    "ResultantLaw",
    "Rule",
    "crushes_by_law",
    "ends_note",
    "gauss",
    "impact_note",
    "joint_points",
    "joint_stiffness",
    "listed_points",
    "lobatto",
    "loses_strength",
    "point_strength",
    "static_law",
    "stiffness_note",
    "unread_keys",
    "wall_caps",
    "wall_cones",
    "wall_inset",
    "wall_points",
    "wall_rule",
    "wall_stiffness",
    "wall_strength",
]
