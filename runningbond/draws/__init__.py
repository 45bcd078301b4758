"""Draws of a wall: what differs between them, and what their collapses have in common."""

from .draws import Draws, Sampling
from .scatter import Scatter

__all__ = ["Draws", "Sampling", "Scatter"]
