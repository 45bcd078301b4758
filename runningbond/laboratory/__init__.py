"""Laboratory: walls tested to failure, predicted blind, and scored beside two hand formulas."""

from .folder import chosen_walls, read_folder, shipped_walls
from .measured import MeasuredWall

__all__ = ["MeasuredWall", "chosen_walls", "read_folder", "shipped_walls"]
