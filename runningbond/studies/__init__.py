"""Studies: cases, rows of measured values, edges compared with theory, and report pages, all built alike."""

from .study import Case, Chart, Edge, Part, Row, Rows, Study, run_around

__all__ = ["Case", "Chart", "Edge", "Part", "Row", "Rows", "Study", "run_around"]
