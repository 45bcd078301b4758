"""Closed forms for running bond as a continuum: elasticity, strength and collapse multipliers."""

from .collapse import crack_slope, lateral_multiplier
from .elasticity import Moduli, elastic_moduli
from .model import homog
from .strength import StrengthDomain

__all__ = ["Moduli", "StrengthDomain", "crack_slope", "elastic_moduli", "homog", "lateral_multiplier"]
