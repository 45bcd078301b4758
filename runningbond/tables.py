"""Tables: pandas data frames if pandas is installed, otherwise structured arrays with the same columns."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeAlias

import numpy as np

Table: TypeAlias = Any
"""A ``pandas.DataFrame``, or a structured array whose fields are its columns."""


def table(columns: Mapping[str, Any]) -> Table:
    """Make a table of columns of equal length."""
    ready = {name: _column(values) for name, values in columns.items()}
    try:
        from pandas import DataFrame
    except ImportError:
        rows = len(next(iter(ready.values())))
        records = np.zeros(rows, [(name, values.dtype) for name, values in ready.items()])
        for name, values in ready.items():
            records[name] = values
        return records
    return DataFrame(ready)


def _column(values: Sequence[Any]) -> Any:
    """A column as an array: of numbers, with None as NaN, or of objects."""
    if isinstance(values, np.ndarray):
        return values
    if all(value is None or isinstance(value, (bool, int, float, np.number, np.bool_)) for value in values):
        return np.array([np.nan if value is None else value for value in values])
    column = np.empty(len(values), dtype=object)
    column[:] = values
    return column
