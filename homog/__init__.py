"""Closed forms for running bond as a continuum: elasticity, strength and collapse multipliers."""

from .elasticity import Moduli, elastic_moduli, rigid_moduli
from .model import crack_slope, homog, lateral_multiplier
from .strength import StrengthDomain

__all__ = ["Moduli", "StrengthDomain", "crack_slope", "elastic_moduli", "homog", "lateral_multiplier", "rigid_moduli"]
