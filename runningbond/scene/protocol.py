"""Loading protocols: the turning points of a prescribed displacement."""

from typing import Any

from .errors import SceneError
from .ranges import Range
from .table import Table

MOST_CYCLES = 1000
"""Largest number of cycles per amplitude."""


def turning_points(key: str, value: Any) -> tuple[float, ...]:
    """Check the turning points of a path that starts from zero: a list of finite numbers, not all of them zero."""
    points = tuple(Range().take(key, x) for x in value) if isinstance(value, (list, tuple)) else ()
    if not any(points):
        raise SceneError(key, "must be a list of finite numbers that are not all zero", value)
    return points


def read_protocol(table: Table) -> tuple[float, ...] | None:
    """Read the turning points from a table's amplitudes and cycles; None for a table without amplitudes.

    Each amplitude is followed by its opposite, and this is repeated for the number of cycles (a negative amplitude
    begins on the other side). The path ends at zero.
    """
    if "amplitudes" not in table:
        if "cycles" in table:
            raise SceneError(table.key("cycles"), "needs amplitudes that are gone through", table.value("cycles"))
        return None
    amplitudes = turning_points(table.key("amplitudes"), table.value("amplitudes"))
    if not all(amplitudes):
        where = f"{table.key('amplitudes')}[{amplitudes.index(0.0)}]"
        raise SceneError(where, "must not be zero: the path begins and ends there by itself", 0.0)
    cycles = table.optional_number("cycles", Range(least=1, most=MOST_CYCLES)) or 1.0
    if not cycles.is_integer():
        raise SceneError(table.key("cycles"), "must be a whole number", cycles)
    return (*(x for amplitude in amplitudes for x in (amplitude, -amplitude) * int(cycles)), 0.0)
