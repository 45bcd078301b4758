"""Ground motion records in files: two or three columns of text, or PEER's AT2, VT2 and DT2."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .arrays import Array
from .errors import SceneError

COMMENTS = ("#", "%", "!", "//")

PEER = {".at2": "ACCELERATION", ".vt2": "VELOCITY", ".dt2": "DISPLACEMENT"}
"""Quantity in a PEER file, by file extension."""

PEER_UNITS = {
    ("ACCELERATION", "G"): ("g", 1.0),
    ("ACCELERATION", "CM/S/S"): ("acceleration", 0.01),
    ("ACCELERATION", "CM/S2"): ("acceleration", 0.01),
    ("VELOCITY", "CM/S"): ("velocity", 0.01),
    ("VELOCITY", "CM/SEC"): ("velocity", 0.01),
    ("DISPLACEMENT", "CM"): ("displacement", 0.01),
}
"""Quantity of a history and the conversion factor into its unit, by the third line of a PEER file."""

NAMES = re.compile(r"[\"']?(?!(nan|inf)\b)[^\W\d_]", re.IGNORECASE)
"""Beginning of a first row that holds the names of the columns."""

DECIMAL = re.compile(r"[^,]*|[^,.]*\d,\d[^,.]*")
"""A word in which a comma, if there is one, is a decimal comma."""

GAP_STEPS, FEWEST_ROWS = 5.0, 8
"""Time step, in median time steps, above which a record has a gap; fewest rows of a record checked for gaps."""

LARGEST_VALUE = 1e6
"""Largest admissible value, in the file's unit, and duration [s] of a record: no ground motion is larger."""

LARGEST_TIME = 1e10
"""Largest admissible time [s], also of clocks that count from 1970; rounded to floats, it is exact to 1e-6 s."""


@dataclass(frozen=True, eq=False)
class Record:
    """A record as read from a file."""

    time: Array  # (n,) [s], ascending
    values: Array  # (n, 2) horizontal and vertical, in the file's unit (PEER: in the unit of `quantity`)
    quantity: str | None = None  # if the file states it


def read_record(path: Path, key: str) -> Record:
    """Read a record.

    Raises
    ------
    SceneError
        For a file that cannot be read, under the key; for a file that is no record, under the file's name and the
        number of the wrong line.
    """
    try:
        if path.exists() and not (path.is_file() or path.is_dir()):  # a pipe, which may never end
            raise SceneError(key, "cannot be read: it is not a regular file", path.name)
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except OSError as error:
        raise SceneError(key, f"cannot be read: {error.strerror or error}", path.name) from error
    except UnicodeDecodeError as error:
        raise SceneError(key, "is not a record: it is not UTF-8 text", path.name) from error
    except ValueError as error:  # a name with a NUL
        raise SceneError(key, f"cannot be read: {error}", path.name) from error
    return _peer(path, lines) if path.suffix.lower() in PEER else _columns(path, lines)


def _line(path: Path, number: int) -> str:
    return f"{path.name}, line {number}"


def _numbers(path: Path, number: int, words: Sequence[str], most: float = LARGEST_VALUE) -> list[float]:
    """The words of a line as finite numbers, whose magnitudes are at most `most`."""
    found = []
    for word in words:
        try:
            value = float(re.sub(r"(?<=\d|\.)[dD](?=[+-]?\d)", "e", word))
        except ValueError:
            what = "must be a number" if word else "has a gap where a number must be"
            raise SceneError(_line(path, number), what, word or None) from None
        if not abs(value) <= most:
            raise SceneError(_line(path, number), f"must be a finite number, at most {most:g}", word)
        found.append(value)
    return found


def _rows(lines: Sequence[str]) -> Iterator[tuple[int, list[str]]]:
    """Number of each line that is neither empty nor a comment, and its words."""
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if text and not text.startswith(COMMENTS):
            yield number, _words(text)


def _words(text: str) -> list[str]:
    """The words of a row; if semicolons or blanks separate them, commas are decimal commas.

    Commas beside blanks, or in words with points, are separators as well, unless there are semicolons.
    """
    words = re.split(r"\s*;\s*|\s+", text)
    if len(words) > 1 and all(map(DECIMAL.fullmatch, words)):
        return [word.replace(",", ".") for word in words]
    if ";" in text:
        return words
    return re.split(r"[,;]|\s+", re.sub(r"\s*([,;])\s*", r"\1", text))


def _columns(path: Path, lines: Sequence[str]) -> Record:
    rows = list(_rows(lines))
    if rows and NAMES.match(rows[0][1][0]):
        del rows[0]
    if len(rows) < 2:
        where = _line(path, rows[0][0] if rows else max(1, len(lines)))
        raise SceneError(where, f"ends a record of {len(rows)} rows; it must have two at least")
    width, table = len(rows[0][1]), []
    for number, words in rows:
        if len(words) not in (2, 3) or len(words) != width:
            wanted = "two or three columns, time, horizontal and, maybe, vertical" if width not in (2, 3) else ""
            what = f"must have {wanted or f'{width} columns, as the first row'}"
            raise SceneError(_line(path, number), what, " ".join(words))
        table.append(_numbers(path, number, words[:1], LARGEST_TIME) + _numbers(path, number, words[1:]))
        if len(table) > 1 and table[-1][0] <= table[-2][0]:
            what = f"must be later than the row before, at {table[-2][0]:.15g} s"
            raise SceneError(_line(path, number), what, table[-1][0])
        if table[-1][0] - table[0][0] > LARGEST_VALUE:
            what = f"must be at most {LARGEST_VALUE:g} s later than the first row"
            raise SceneError(_line(path, number), what, table[-1][0])
    values = np.array(table)
    step = np.diff(values[:, 0])
    wide = np.flatnonzero(step > GAP_STEPS * np.median(step))
    if len(wide) and len(values) >= FEWEST_ROWS:
        number = rows[int(wide[0]) + 1][0]
        what = f"comes after a gap of {step[wide[0]]:.4g} s, the steps of the record are {np.median(step):.4g} s"
        raise SceneError(_line(path, number), what, float(values[wide[0] + 1, 0]))
    vertical = values[:, 2] if width == 3 else np.zeros(len(values))
    return Record(values[:, 0], np.column_stack([values[:, 1], vertical]))


def _peer(path: Path, lines: Sequence[str]) -> Record:
    """Read a PEER file: four header lines with the unit, NPTS and DT, then the values row by row."""
    if len(lines) < 5:
        raise SceneError(_line(path, max(1, len(lines))), "ends a file of PEER, which has four lines before its values")
    holds = PEER[path.suffix.lower()]
    unit = re.search(r"\b(\w+)\s+TIME\s+(?:SERIES|HISTORY)\s+IN\s+UNITS\s+OF\s+(\S+)", lines[2].upper())
    known = PEER_UNITS.get((unit[1], unit[2].rstrip(",."))) if unit else None
    if known is None:
        units = " or ".join(given for what, given in PEER_UNITS if what == holds)
        what = f'must name the unit, "{holds} TIME SERIES IN UNITS OF …", one of {units}'
        raise SceneError(_line(path, 3), what, lines[2].strip() or None)
    count, step = _head(path, lines[3])
    values: list[float] = []
    for number, words in _rows(lines[4:]):
        values += _numbers(path, number + 4, words)
    if len(values) != count:
        what = f"ends a record of {len(values)} values; NPTS says {count}"
        raise SceneError(_line(path, len(lines)), what)
    scaled = known[1] * np.array(values)
    return Record(step * np.arange(count, dtype=float), np.column_stack([scaled, np.zeros(count)]), known[0])


def _head(path: Path, line: str) -> tuple[int, float]:
    """Number of values and time step [s] of a PEER file."""
    number = r"((?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)(?![\d.])"
    found = re.search(rf"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*{number}", line, re.IGNORECASE)
    found = found or re.match(rf"\s*(\d+)\s+{number}\s+NPTS", line, re.IGNORECASE)
    if found is None or int(found[1]) < 2 or not 0 < float(found[2]) < 1:
        what = 'must say how many values, two at least, and their time step: "NPTS= 4000, DT= .005 SEC"'
        raise SceneError(_line(path, 4), what, line.strip() or None)
    return int(found[1]), float(found[2])
