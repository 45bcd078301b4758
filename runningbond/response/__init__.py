"""Response of walls to ground motion."""

from .critical import critical_scale
from .follow import follow
from .response import ENERGIES, Response
from .resting import Resting
from .vibration import Vibration, vibration_at_rest

__all__ = ["ENERGIES", "Response", "Resting", "Vibration", "critical_scale", "follow", "vibration_at_rest"]
