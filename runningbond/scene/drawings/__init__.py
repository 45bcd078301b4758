"""Drawings that people have: DXF files and COMPAS assemblies, read into blocks and ground."""

from .drawing import METRES, Drawing, listed_outlines, read_drawing

__all__ = ["METRES", "Drawing", "listed_outlines", "read_drawing"]
