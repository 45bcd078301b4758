"""Drawings that people have: DXF files and COMPAS assemblies, read into blocks and ground."""

from .drawing import METRES, Drawing, read_drawing

__all__ = ["METRES", "Drawing", "read_drawing"]
