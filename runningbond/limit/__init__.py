"""Limit analysis of rigid blocks: linear programs over joint forces, dual mechanisms, and bounds that both prove."""

from .associated import LimitState, bears_dead_load, is_self_locking, limit, limit_state, proved_bound
from .elastic import elastic_displacement
from .equilibrium import Equilibrium, equilibrium
from .hanging import given_displacement, hanging_displacement
from .nonassociated import limit_nonassociated

__all__ = [
    "Equilibrium",
    "LimitState",
    "bears_dead_load",
    "elastic_displacement",
    "equilibrium",
    "given_displacement",
    "hanging_displacement",
    "is_self_locking",
    "limit",
    "limit_nonassociated",
    "limit_state",
    "proved_bound",
]
