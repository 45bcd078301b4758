"""Accuracy against cost: every model and its knobs on walls whose answer is known, timed and drawn."""

from .cases import Case, all_cases
from .rows import Row, read_csv
from .study import run_study

__all__ = ["Case", "Row", "all_cases", "read_csv", "run_study"]
