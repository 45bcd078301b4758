"""Studies: cases, rows of what was measured, edges beside theory, and pages of them, on one skeleton."""

from .study import Case, Chart, Edge, Part, Row, Rows, Study

__all__ = ["Case", "Chart", "Edge", "Part", "Row", "Rows", "Study"]
