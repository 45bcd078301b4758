"""Blocks and ground read from drawings: DXF files and COMPAS assemblies."""

from .drawing import METRES, Drawing, listed_outlines, read_drawing

__all__ = ["METRES", "Drawing", "listed_outlines", "read_drawing"]
