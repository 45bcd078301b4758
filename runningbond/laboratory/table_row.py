"""A row of a table of tests: its entries as numbers in SI units; invalid entries are refused by file and line."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from runningbond.scene import SceneError
from runningbond.scene.ranges import nearest

LENGTHS, FORCES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}, {"N": 1.0, "kN": 1e3}
STRESSES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm²": 1e6}
ALIKE = {"KN": "kN", "N/mm2": "N/mm²", "N/mm^2": "N/mm²"}
"""Other ways to write these units."""

KINDS: tuple[dict[str, float], ...] = (LENGTHS, FORCES, STRESSES)
"""Units of each kind, and their sizes in SI units."""

NAME = "test unit name"
"""Column of the walls' names."""

FAILURE = "From test report: Failure type"
NUMBERS = {"H": "mm", "L": "mm", "t": "mm", "H0": "mm", "hb": "mm", "lb": "mm", "Ntot": "kN"}
NUMBERS |= {"Vmax,+": "kN", "Vmax,-": "kN", "σ0,pc": "MPa"}
"""Columns that are read as numbers, as tables write them, and their units if their heads have none."""

USUAL = {column.casefold(): unit for column, unit in NUMBERS.items()}
"""The same in lower case."""

OF_WORDS = ("Cyclic / Monotonic", "Joints", "Stone", FAILURE)
WORDS = (NAME, *map(str.casefold, OF_WORDS))
"""Columns that are read as words, in lower case."""

AS_WRITTEN = (*NUMBERS, "Reference", *OF_WORDS)
"""Columns that have a meaning, as tables write them."""

OTHER_NAMES = {"failure type": FAILURE, "failure mode": FAILURE, "n": "Ntot"}
OTHER_NAMES |= {"length": "L", "height": "H", "thickness": "t", "ho": "H0"}
OTHER_NAMES |= {"wall length": "L", "wall height": "H", "wall thickness": "t"}
OTHER_NAMES |= {"block length": "lb", "block height": "hb", "peak force": "Vmax,+"}
OTHER_NAMES |= dict.fromkeys(("σ0", "sigma0", "sigma_0", "sigma0,pc"), "σ0,pc")
"""Columns that may be meant by names that are not similar to theirs."""

LONG = 3
"""Letters of a column's name from which it may be a misspelt one; shorter names, as No, are similar to too many."""

NOTHING = ("", "-", "−", "–", "—", "nan", "na", "n/a", "#n/a", "#nv")
"""Entries that count as empty, in lower case."""

HEAD = re.compile(r"^(.*?)\s*(?:\[(.*)\]|\((.*)\))?\s*$", re.DOTALL)
"""A column's name, and its unit in brackets or parentheses."""

DRY = re.compile(r"dry([ -]?(joint(s|ed)?|stack(ed)?|stone|laid|masonry|\(no mortar\)))*")
"""Words for dry joints, in lower case."""

MINUS = {ord(sign): "-" for sign in "−–"}
"""Signs that count as the minus of a number."""


def meant_by(head: str) -> str:
    """The column that an unread one may be meant as, by name and unit; empty if there is none, or if it is read."""
    name, unit = _name_and_unit(head)
    if name.casefold() in map(str.casefold, (NAME, *AS_WRITTEN)):
        return ""
    likely = nearest(name, AS_WRITTEN) if len(name) >= LONG else ""
    meant = OTHER_NAMES.get(name.casefold(), likely)
    units = units_of(meant) if meant.casefold() in USUAL else {}
    return meant if not unit or ALIKE.get(unit.strip(), unit.strip()) in units else ""


def _name_and_unit(head: str) -> tuple[str, str]:
    """A column's name and its unit, which is empty if there is none."""
    parts = HEAD.match(head.strip().lstrip("\ufeff"))
    assert parts is not None  # it matches any text
    return parts[1], parts[2] or parts[3] or ""


def units_of(column: str) -> dict[str, float]:
    """Units that a column may have: those of the same kind as its default unit."""
    return next(kind for kind in KINDS if USUAL[column.casefold()] in kind)


@dataclass(frozen=True)
class TableRow:
    """A row of a table: its file and line, and its entries by column heads in lower case without units."""

    path: Path
    line: int
    entries: Mapping[str, tuple[str, str]]  # the entry, and its unit
    heads: tuple[str, ...] = ()  # as written

    @classmethod
    def read(cls, path: Path, line: int, heads: list[str], cells: list[str]) -> "TableRow":
        """Make a row from cells; there may be fewer cells than heads, but not more."""
        entries: dict[str, tuple[str, str]] = {}
        row = cls(path, line, entries, tuple(heads))
        for head, cell in zip(heads, cells, strict=False):
            written, unit = _name_and_unit(head)
            name = written.casefold()
            entry = (cell.strip(), unit or USUAL.get(name, ""))
            before = entries.get(name, ("", ""))
            if (name in USUAL or name in WORDS) and entry[0] and before[0] and entry != before:
                what = f"is in another column as well, as {' '.join(before).strip()}; leave one of them empty"
                raise SceneError(row.key(written), what, " ".join(entry).strip())
            entries[name] = entry if entry[0] or not before[0] else before
        if any(cell.strip() for cell in cells[len(heads) :]):
            raise SceneError(row.place, f"must have {len(heads)} entries, as its heads; has {len(cells)}")
        return row

    @property
    def joints(self) -> str:
        """Kind of its joints, such as "dry", in lower case; empty if it is not told."""
        said = self.text("joints").casefold()
        return "" if said in NOTHING else "dry" if DRY.fullmatch(said) else said.partition(" joint")[0]

    @property
    def place(self) -> str:
        """Name of the row in messages: its wall, if it has a name, file and line."""
        name = " ".join(self.text(NAME).split())
        return f"{name}{': ' if name else ''}{self.path.name}, line {self.line}"

    def key(self, column: str) -> str:
        """Name of an entry in messages."""
        return f"{self.place}: {column}"

    def text(self, column: str) -> str:
        """An entry as written; empty if there is none."""
        return self.entries.get(column.casefold(), ("", ""))[0]

    def misspelt(self) -> list[tuple[str, str]]:
        """Heads with an entry that are not read, each with the column it may be meant as, which has no entry."""
        meant = [(head.strip(), meant_by(head)) for head in self.heads]
        return [
            (head, column)
            for head, column in meant
            if column and self._has(_name_and_unit(head)[0]) and not self._has(column)
        ]

    def _has(self, column: str) -> bool:
        return self.text(column).casefold() not in NOTHING

    def number(self, column: str, *others: str) -> float:
        """An entry as a number above 0, in SI units; a refusal tells where it may be, or one of other columns."""
        value = self.optional(column)
        if value is None:
            remedy = "is missing; it must be a number above 0, or a scene NAME.toml be there"
            raise SceneError(self.key(column), remedy + self.likely(column, *others))
        return value

    def likely(self, *columns: str) -> str:
        """Hint at the first head that is not read and may be meant as one of some columns; empty if there is none."""
        likely = (head for head, meant in self.misspelt() if meant in columns)
        return next((f'; did you mean column "{head}"?' for head in likely), "")

    def stress(self, column: str) -> float | None:
        """A stress [Pa] that no model reads, by default in MPa; None if the entry is empty, or not such a number."""
        text, unit = self.entries.get(column.casefold(), ("", ""))
        size = STRESSES.get(ALIKE.get(unit.strip(), unit.strip()) or "MPa")
        try:
            value = float(text.translate(MINUS))
        except ValueError:
            return None
        return value * size if size is not None and math.isfinite(value) else None

    def optional(self, column: str, *, magnitude: bool = False, may_be_zero: bool = False) -> float | None:
        """An entry as a number above 0, or the `magnitude` of any, in SI units; None if it is empty, or a valid 0."""
        text, unit = self.entries.get(column.casefold(), ("", ""))
        if text.casefold() in NOTHING:
            return None
        try:
            value = float(text.translate(MINUS))
        except ValueError:
            value = math.nan
        value = abs(value) if magnitude else value
        if may_be_zero and value == 0:
            return None
        if not (math.isfinite(value) and value > 0):
            comma = ", with a decimal point and no other separators" if "," in text else ""
            raise SceneError(self.key(column), f"must be a number above 0{comma}", text)
        units, unit = units_of(column), ALIKE.get(unit.strip(), unit.strip())
        if unit not in units:
            raise SceneError(self.key(column), f"must have a unit, one of {', '.join(units)}", unit)
        return value * units[unit]
