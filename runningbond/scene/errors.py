"""How bad input is refused: one line that names the key, its value and what would be right."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

LONGEST = 60
"""Characters of a value that are shown."""

UNSEEN = 1e-9
"""Coordinate, in sizes of the wall, that is told as zero: cosines of a right angle leave 6e-17."""


class SceneError(ValueError):
    """Input that describes no wall.

    Parameters
    ----------
    key
        Full name of the offending key, for example ``joint.friction``, or the file's name.
    remedy
        What is wrong and what would be right.
    value
        The value, where there is one.
    """

    def __init__(self, key: str, remedy: str, value: object = None) -> None:
        super().__init__(key, remedy, value)
        self.key, self.remedy, self.value = key, remedy, value

    def __str__(self) -> str:
        value = "" if self.value is None else f" = {abbreviated(self.value)}"
        return f"{self.key}{value}: {' '.join(self.remedy.split())}"


def coordinate(value: float, size: float, digits: int = 4) -> str:
    """A coordinate in so many digits, and as many more as it is farther from the origin than what lies there is large.

    Parameters
    ----------
    size
        Of the wall or drawing [as the coordinate].
    """
    far = abs(value) / size if size > 0 else 0.0
    more = math.floor(math.log10(far)) if 10 <= far < math.inf else 0
    told = 0.0 if 0 < far < UNSEEN else value
    return f"{told + 0.0:.{min(digits + more, 17)}g}"


def place(at: Sequence[float] | NDArray[np.float64], size: float, digits: int = 4) -> str:
    """A point ``(2,)`` as messages tell it; see `coordinate`."""
    return f"({', '.join(coordinate(float(x), size, digits) for x in at)})"


@contextmanager
def keys_of(table: str, default: str) -> Iterator[None]:
    """Name keys after the table that they were read from, where an object names them after its usual one."""
    try:
        yield
    except SceneError as error:
        if not error.key.startswith(f"{default}."):
            raise
        raise SceneError(table + error.key.removeprefix(default), error.remedy, error.value) from None


def abbreviated(value: object) -> str:
    """A value as messages show it, in a line that does not grow with what is in it."""
    try:
        text = " ".join(repr(value).split())
    except ValueError:  # Python refuses to print integers of thousands of digits
        return "(a number too long to print)"
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
