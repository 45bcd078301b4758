"""Masonry walls from their description to their collapse."""
