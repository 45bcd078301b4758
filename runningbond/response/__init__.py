"""Response of walls to motions of their ground."""

from .critical import critical_scale
from .follow import follow
from .response import ENERGIES, Response
from .resting import Resting

__all__ = ["ENERGIES", "Response", "Resting", "critical_scale", "follow"]
