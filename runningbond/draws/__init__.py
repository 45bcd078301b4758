"""Draws of a wall: what differs between them, and what their collapses have in common."""

from .draws import Drawing, Draws
from .scatter import Scatter

__all__ = ["Drawing", "Draws", "Scatter"]
