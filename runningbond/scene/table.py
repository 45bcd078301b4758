"""One table of a scene file: returns values after checking their types and ranges, and refuses unknown keys."""

from collections.abc import Iterable
from dataclasses import MISSING, fields
from typing import Any, ClassVar

from .errors import SceneError
from .ranges import Range, one_of, ranges_of, vector

OUTLINES = "a list of outlines, each a list of corners [x, y]"


class Table:
    """A TOML table that is being read: its full name (empty for the top level of the file) and its content."""

    visits: "ClassVar[list[tuple[str, dict[str, Any], dict[str, dict[str, Any]]]] | None]" = None
    """If this is a list, each table appends its name, its content, and the requirements on its keys (see `schema`)."""

    def __init__(self, name: str, content: Any) -> None:
        if not isinstance(content, dict):
            raise SceneError(name, f"must be a table, [{name}] with keys of its own", content)
        self.name = name
        self._left: dict[str, Any] = dict(content)
        self._keys: dict[str, dict[str, Any]] = {}  # requirements on each key that the reader has asked for
        if Table.visits is not None:
            Table.visits.append((name, content, self._keys))

    def key(self, key: str) -> str:
        """Full name of a key."""
        return f"{self.name}.{key}" if self.name else key

    def __contains__(self, key: str) -> bool:
        self._ask(key)
        return key in self._left

    def value(self, key: str, default: Any = None) -> Any:
        """The unchecked value of a key; `default` if the key is missing."""
        self._ask(key)
        return self._left.pop(key, default)

    def peek(self, key: str) -> Any:
        """The unchecked value of a key, which does not count as read; None if the key is missing."""
        return self._left.get(key)

    def required(self, key: str, wanted: str) -> Any:
        """The unchecked value of a key; a missing key is refused."""
        self._ask(key, required=True)
        if key not in self._left:
            raise SceneError(self.key(key), f"is missing; it must be {wanted}")
        return self._left.pop(key)

    def _ask(self, key: str, **what: Any) -> None:
        """Record a requirement on a key: presence, a range, a set of words, or a kind of value."""
        self._keys.setdefault(key, {}).update(what)

    def table(self, key: str) -> "Table":
        """A table inside this one."""
        return Table(self.key(key), self.required(key, "a table"))

    def optional_table(self, key: str) -> "Table | None":
        """A table inside this one; None if the key is missing."""
        value = self.value(key)
        return None if value is None else Table(self.key(key), value)

    def tables_by_name(self, key: str) -> "list[Table]":
        """The tables of a table of tables; empty if the key is missing."""
        outer = self.optional_table(key)
        self._ask(key, kind="tables by name")
        return [] if outer is None else [Table(outer.key(name), inner) for name, inner in outer._left.items()]

    def list_of_tables(self, key: str) -> "list[Table]":
        """A list of tables; empty if the key is missing."""
        value = self.value(key, [])
        if not isinstance(value, list):
            raise SceneError(self.key(key), f"must be tables, [[{self.key(key)}]] with keys of their own", value)
        return [Table(f"{self.key(key)}[{k}]", inner) for k, inner in enumerate(value)]

    def number(self, key: str, within: Range) -> float:
        """A number in a range."""
        self._ask(key, within=within)
        return within.take(self.key(key), self.required(key, str(within)))

    def optional_number(self, key: str, within: Range) -> float | None:
        """A number in a range; None if the key is missing."""
        self._ask(key, within=within)
        value = self.value(key)
        return None if value is None else within.take(self.key(key), value)

    def numbers(self, part: type, *left_out: str) -> dict[str, float]:
        """Numbers of the fields of a dataclass that have a range, except `left_out`; required if without a default."""
        defaults = {field.name: field.default for field in fields(part)}
        values = {
            name: self.number(name, within) if defaults[name] is MISSING else self.optional_number(name, within)
            for name, within in ranges_of(part).items()
            if name not in left_out
        }
        return {name: value for name, value in values.items() if value is not None}

    def text(self, key: str, default: str | None = None) -> str:
        """A string; the key is required if `default` is None."""
        self._ask(key, kind="text")
        value = self.required(key, "a string") if default is None else self.value(key, default)
        if not isinstance(value, str):
            raise SceneError(self.key(key), "must be a string", value)
        return value

    def choice(self, key: str, options: Iterable[str], default: str | None = None) -> str:
        """One of a few words; the key is required if `default` is None."""
        words = list(options)
        self._ask(key, words=words)
        wanted = "one of " + ", ".join(f'"{word}"' for word in words)
        value = self.required(key, wanted) if default is None else self.value(key, default)
        return one_of(self.key(key), value, words)

    def vector(self, key: str) -> tuple[float, float]:
        """A pair of finite numbers."""
        self._ask(key, kind="vector")
        return vector(self.key(key), self.required(key, "a pair of numbers [x, y]"))

    def rows(self, key: str) -> list[list[float]]:
        """A list of lists of finite numbers."""
        value = self.required(key, "a list of courses")
        if not isinstance(value, list):
            raise SceneError(self.key(key), "must be a list of courses, each a list of widths", value)
        rows = []
        for i, row in enumerate(value):
            try:
                rows.append([Range().take("", x) for x in (row if isinstance(row, list) else [None])])
            except SceneError:
                raise SceneError(f"{self.key(key)}[{i}]", "must be a list of finite numbers", row) from None
        return rows

    def outlines(self, key: str) -> list[list[tuple[float, float]]]:
        """A list of outlines, each a list of corners."""
        self._ask(key, kind="outlines")
        value, key = self.required(key, OUTLINES), self.key(key)
        if not isinstance(value, list) or not value:
            raise SceneError(key, f"must be {OUTLINES}", value)
        return [self._outline(f"{key}[{k}]", outline) for k, outline in enumerate(value)]

    @staticmethod
    def _outline(key: str, corners: Any) -> list[tuple[float, float]]:
        if not isinstance(corners, list) or len(corners) < 3:
            raise SceneError(key, "must be an outline, a list of three corners or more, each [x, y]", corners)
        return [vector(f"{key}[{k}]", corner) for k, corner in enumerate(corners)]

    def finish(self) -> None:
        """Refuse keys that have not been read: they have no meaning."""
        for key, value in self._left.items():
            place = f"[{self.name}]" if self.name else "a scene file"
            what = f"is not a key of {place}, which has {', '.join(self._keys)}"
            raise SceneError(self.key(key), what, "a table" if isinstance(value, dict) else value)
