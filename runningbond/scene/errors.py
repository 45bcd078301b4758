"""Errors for bad input: one line that names the key, its value and what would be right."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

MAX_VALUE_LENGTH = 60
"""Number of characters above which a value is shortened in a message."""

ZERO_COORDINATE = 1e-9
"""Coordinate, in sizes of the wall, below which messages show 0: the cosine of a right angle is computed as 6e-17."""


class SceneError(ValueError):
    """Input that does not describe a valid wall.

    Parameters
    ----------
    key
        Full name of the offending key, for example ``joint.friction``, or the file's name.
    remedy
        What is wrong and what would be right.
    value
        The offending value, if there is one.
    """

    def __init__(self, key: str, remedy: str, value: object = None) -> None:
        super().__init__(key, remedy, value)
        self.key, self.remedy, self.value = key, remedy, value

    def __str__(self) -> str:
        value = "" if self.value is None else f" = {abbreviated(self.value)}"
        return f"{self.key}{value}: {' '.join(self.remedy.split())}"


def coordinate(value: float, size: float, digits: int = 4) -> str:
    """A coordinate with `digits` digits, and one more for each power of ten by which it exceeds the size of the wall.

    Parameters
    ----------
    size
        Size of the wall or drawing, in the unit of the coordinate.
    """
    far = abs(value) / size if size > 0 else 0.0
    more = math.floor(math.log10(far)) if 10 <= far < math.inf else 0
    told = 0.0 if 0 < far < ZERO_COORDINATE else value
    return f"{told + 0.0:.{min(digits + more, 17)}g}"


def place(at: Sequence[float] | NDArray[np.float64], size: float, digits: int = 4) -> str:
    """A point ``(2,)`` as text for messages; see `coordinate`."""
    return f"({', '.join(coordinate(float(x), size, digits) for x in at)})"


@contextmanager
def keys_of(table: str, default: str) -> Iterator[None]:
    """Rename keys in a `SceneError` from the default table to the table that the values were read from."""
    try:
        yield
    except SceneError as error:
        if not error.key.startswith(f"{default}."):
            raise
        raise SceneError(table + error.key.removeprefix(default), error.remedy, error.value) from None


@contextmanager
def exits_in_a_line() -> Iterator[None]:
    """End a script with the line of a `SceneError`, without a traceback."""
    try:
        yield
    except SceneError as error:
        raise SystemExit(str(error)) from None


def abbreviated(value: object) -> str:
    """A value as text for messages, shortened to one line of limited length."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # Python refuses to print integers of thousands of digits
        return "(a number too long to print)"
    return text if len(text) <= MAX_VALUE_LENGTH else f"{text[: MAX_VALUE_LENGTH - 1]}…"
