"""One table of a scene file: takes keys out with their type and range checked, refuses what is left."""

import difflib
import math
from collections.abc import Iterable
from typing import Any

from .errors import SceneError

SMALLEST = 1e-100
"""Numbers below it, or above its inverse, describe nothing; their products leave the range of a double."""


class Table:
    """A TOML table being read.

    Parameters
    ----------
    name
        Full name, empty for the file's top level.
    content
        What the file holds under that name.
    """

    def __init__(self, name: str, content: Any) -> None:
        if not isinstance(content, dict):
            raise SceneError(name, f"must be a table, [{name}] with keys of its own", content)
        self.name = name
        self._left: dict[str, Any] = dict(content)
        self._known: list[str] = []

    def key(self, key: str) -> str:
        """Full name of a key."""
        return f"{self.name}.{key}" if self.name else key

    def __contains__(self, key: str) -> bool:
        return key in self._left

    def table(self, key: str) -> "Table":
        """A table inside this one."""
        return Table(self.key(key), self._take(key, "a table"))

    def optional_table(self, key: str) -> "Table | None":
        """A table inside this one where the key is present, None where it is not."""
        if key in self._left:
            return self.table(key)
        self._known.append(key)
        return None

    def number(
        self,
        key: str,
        default: float | None = None,
        *,
        least: float = -math.inf,
        most: float = math.inf,
        above: float = -math.inf,
        below: float = math.inf,
    ) -> float:
        """A finite number in a range; `default` None makes the key required."""
        wanted = f"a number{_range(least, most, above, below)}"
        value = self._take(key, wanted) if default is None else self._left.pop(key, default)
        self._known.append(key)
        number = _finite(value)
        if number is None or not (least <= number <= most and above < number < below):
            raise SceneError(self.key(key), f"must be {wanted}", value)
        return number

    def optional_number(self, key: str, **limits: float) -> float | None:
        """A number where the key is present, None where it is not."""
        if key in self._left:
            return self.number(key, **limits)
        self._known.append(key)
        return None

    def text(self, key: str, default: str | None = None) -> str:
        """A string; `default` None makes the key required."""
        value = self._take(key, "a string") if default is None else self._left.pop(key, default)
        self._known.append(key)
        if not isinstance(value, str):
            raise SceneError(self.key(key), "must be a string", value)
        return value

    def choice(self, key: str, options: Iterable[str], default: str | None = None) -> str:
        """One of a few words."""
        words = list(options)
        wanted = "one of " + ", ".join(f'"{word}"' for word in words)
        value = self._take(key, wanted) if default is None else self._left.pop(key, default)
        self._known.append(key)
        if value not in words:
            raise SceneError(self.key(key), f"must be {wanted}{_suggestion(value, words)}", value)
        return str(value)

    def vector(self, key: str) -> tuple[float, float]:
        """A pair of finite numbers."""
        value = self._take(key, "a pair of numbers [x, y]")
        numbers = [_finite(x) for x in value] if isinstance(value, list) else []
        if len(numbers) != 2 or numbers[0] is None or numbers[1] is None:
            raise SceneError(self.key(key), "must be a pair of finite numbers [x, y]", value)
        return numbers[0], numbers[1]

    def rows(self, key: str) -> list[list[float]]:
        """A list of lists of finite numbers."""
        value = self._take(key, "a list of courses")
        if not isinstance(value, list):
            raise SceneError(self.key(key), "must be a list of courses, each a list of widths", value)
        rows = []
        for i, row in enumerate(value):
            numbers = [_finite(x) for x in row] if isinstance(row, list) else [None]
            finite = [x for x in numbers if x is not None]
            if len(finite) < len(numbers):
                raise SceneError(f"{self.key(key)}[{i}]", "must be a list of finite numbers", row)
            rows.append(finite)
        return rows

    def finish(self) -> None:
        """Refuse keys that nobody asked for."""
        for key, value in self._left.items():
            raise SceneError(
                self.key(key), f"is not a key of {self._place()}{_suggestion(key, self._known)}", _shown(value)
            )

    def _take(self, key: str, wanted: str) -> Any:
        self._known.append(key)
        if key not in self._left:
            likely = difflib.get_close_matches(key, [k for k in self._left if k not in self._known], n=1)
            hint = f"; is {self.key(likely[0])} a misspelling of it?" if likely else ""
            raise SceneError(self.key(key), f"is missing; it must be {wanted}{hint}")
        return self._left.pop(key)

    def _place(self) -> str:
        return f"[{self.name}]" if self.name else "a scene file"


def _finite(value: Any) -> float | None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    try:
        number = float(value)
    except OverflowError:
        return None
    return number if number == 0.0 or SMALLEST <= abs(number) <= 1 / SMALLEST else None


def _range(least: float, most: float, above: float, below: float) -> str:
    parts = []
    if above > -math.inf:
        parts.append(f"above {above:g}")
    if least > -math.inf:
        parts.append(f"at least {least:g}")
    if most < math.inf:
        parts.append(f"at most {most:g}")
    if below < math.inf:
        parts.append(f"below {below:g}")
    return " " + " and ".join(parts) if parts else ", finite"


def _suggestion(word: Any, known: list[str]) -> str:
    likely = difflib.get_close_matches(word, known, n=1) if isinstance(word, str) else []
    return f'; did you mean "{likely[0]}"?' if likely else ""


def _shown(value: Any) -> Any:
    return "a table" if isinstance(value, dict) else value
