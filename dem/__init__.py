"""Rigid blocks: kinematics and limit analysis; `dem.dynamic` for blocks in motion, which needs compiled kernels."""

from runningbond.limit.associated import LimitState, limit, limit_state
from runningbond.limit.equilibrium import Equilibrium, equilibrium
from runningbond.limit.kinematics import (
    Jump,
    dead_load,
    jump_operator,
    live_load,
    mass_matrix_diagonal,
    movable_freedoms,
    pin_operator,
    point_operator,
)
from runningbond.limit.nonassociated import limit_nonassociated

__all__ = [
    "Equilibrium",
    "Jump",
    "LimitState",
    "dead_load",
    "equilibrium",
    "jump_operator",
    "limit",
    "limit_nonassociated",
    "limit_state",
    "live_load",
    "mass_matrix_diagonal",
    "movable_freedoms",
    "pin_operator",
    "point_operator",
]
