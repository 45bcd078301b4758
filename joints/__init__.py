"""Joint points and the Mohr–Coulomb joint: the one place where its signs are written down."""

from .mohr_coulomb import PointStrength, point_strength
from .points import JointPoints, Rule, gauss, joint_points, lobatto
from .stiffness import joint_stiffness

__all__ = [
    "JointPoints",
    "PointStrength",
    "Rule",
    "gauss",
    "joint_points",
    "joint_stiffness",
    "lobatto",
    "point_strength",
]
