"""Random draws of a wall: what varies between them, and statistics of their collapse loads."""

from .draws import Draws, Sampling
from .scatter import Scatter

__all__ = ["Draws", "Sampling", "Scatter"]
