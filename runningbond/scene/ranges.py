"""Admissible values, stated once beside the field that holds them, for Python and for scene files alike."""

import difflib
import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from numbers import Integral, Real
from pathlib import Path
from typing import Annotated, Any, TypeAlias, get_args, get_type_hints

import numpy as np

from .errors import SceneError

SMALLEST = 1e-100
"""Smallest size of a nonzero number, and inverse of the largest: products of others could overflow or underflow."""


@dataclass(frozen=True)
class Range:
    """A range of finite numbers."""

    least: float = -math.inf
    most: float = math.inf
    above: float = -math.inf
    below: float = math.inf

    def __str__(self) -> str:
        words = {"above": self.above, "at least": self.least, "at most": self.most, "below": self.below}
        limits = [f"{word} {limit:g}" for word, limit in words.items() if math.isfinite(limit)]
        return f"a number {' and '.join(limits)}" if limits else "a number, finite"

    def take(self, key: str, value: object) -> float:
        """The value as a float; refused under its key if it is no number within the range."""
        number = _finite(value)
        if number is None or not (self.least <= number <= self.most and self.above < number < self.below):
            raise SceneError(key, f"must be {self}{_beyond(value, str(self))}", value)
        return number


ABOVE_ZERO, AT_LEAST_ZERO = Range(above=0.0), Range(least=0.0)
Positive: TypeAlias = Annotated[float, ABOVE_ZERO]
NotNegative: TypeAlias = Annotated[float, AT_LEAST_ZERO]


@cache
def ranges_of(part: Any) -> dict[str, Range]:
    """Ranges of the fields of a dataclass type that are annotated with one, by field name."""
    hints = get_type_hints(part, include_extras=True)
    parts = [(name, part) for name, hint in hints.items() for part in (hint, *get_args(hint))]
    return {name: part.__metadata__[0] for name, part in parts if hasattr(part, "__metadata__")}


def check_numbers(part: Any, table: str) -> None:
    """Check the numbers of a frozen dataclass and store them as floats; None passes for fields that default to it."""
    kind: Any = type(part)
    for name, within in ranges_of(kind).items():
        value = getattr(part, name)
        if value is not None or getattr(kind, name, 0.0) is not None:
            object.__setattr__(part, name, within.take(f"{table}.{name}", value))


def vector(key: str, value: Any) -> tuple[float, float]:
    """A pair of finite numbers."""
    numbers = [_finite(x) for x in value] if isinstance(value, (list, tuple, np.ndarray)) else []
    if len(numbers) != 2 or numbers[0] is None or numbers[1] is None:
        raise SceneError(key, "must be a pair of finite numbers [x, y]", value)
    return numbers[0], numbers[1]


def check_whole_number(key: str, value: object, *, least: int = 1) -> None:
    """Refuse a value that is not a whole number, or is less than `least`."""
    if isinstance(value, bool) or not isinstance(value, Integral) or int(value) < least:
        raise SceneError(key, f"must be a whole number, at least {least}", value)


def path_of(key: str, value: object) -> Path:
    """The value as a path; refused under its key if it is none."""
    if not isinstance(value, (str, os.PathLike)):
        raise SceneError(key, "must be a path", value)
    return Path(value)


def one_of(key: str, value: object, options: Iterable[str]) -> str:
    """The value, refused under its key if it is none of the options."""
    words = list(options)
    if not isinstance(value, str) or value not in words:
        listed = ", ".join(f'"{word}"' for word in words)
        raise SceneError(key, f"must be one of {listed}{suggestion(value, words)}", value)
    return value


LEAST_SIMILARITY = 0.6
"""Least similarity ratio (`difflib`, case ignored) at which a word may be a misspelling of another."""


def suggestion(word: object, options: Sequence[str]) -> str:
    """Hint at the option that a misspelt word may stand for; empty if no option is similar."""
    likely = nearest(word, options)
    return f'; did you mean "{likely}"?' if likely else ""


def nearest(word: object, options: Sequence[str]) -> str:
    """The option of which a word is the first part, or else the most similar; empty if none is similar enough."""
    if not isinstance(word, str) or not options:
        return ""

    def likeness(option: str) -> float:
        if option.casefold().startswith(f"{word.casefold()}-"):
            return 1.0
        return difflib.SequenceMatcher(None, option.casefold(), word.casefold()).ratio()

    likely = max(options, key=likeness)  # the first of several that are equally similar
    return likely if likeness(likely) >= LEAST_SIMILARITY else ""


def _beyond(value: object, words: str) -> str:
    """Further requirement on a float that is not finite or too large or small, unless `words` already states it."""
    if not isinstance(value, float) or _finite(value) is not None:
        return ""
    if math.isfinite(value):
        return f", of a size from {SMALLEST:g} to {1 / SMALLEST:g}"
    return ", finite" if "finite" not in words else ""


def _finite(value: object) -> float | None:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, Real):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if number == 0.0 or SMALLEST <= abs(number) <= 1 / SMALLEST else None
