"""The laboratory: walls that were broken, predicted blind, and scored beside two formulas that anyone works out."""

from .folder import SHIPPED, read_folder
from .measured import MeasuredWall

__all__ = ["SHIPPED", "MeasuredWall", "read_folder"]
