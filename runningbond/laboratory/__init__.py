"""The laboratory: walls that were broken, predicted blind, and scored beside two formulas that anyone works out."""

from .folder import read_folder, shipped_walls
from .measured import MeasuredWall

__all__ = ["MeasuredWall", "read_folder", "shipped_walls"]
