"""Comparison of models: published walls, tables, charts, reports and advice."""

from .published import PUBLISHED, published_scene

__all__ = ["PUBLISHED", "published_scene"]
