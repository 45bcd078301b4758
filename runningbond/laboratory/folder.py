"""Folders of tested walls: a table with a row per wall, and files of its curve, crack map and scene named after it."""

import csv
import io
import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import chain, dropwhile
from pathlib import Path

import numpy as np
from matplotlib.image import imread

from runningbond.scene import Array, SceneError
from runningbond.scene.ranges import suggestion

from .measured import CYCLIC, DRIFTS, MONOTONIC, NOISE, MeasuredWall
from .scores import LEAST_DISSIPATED, UNLOADED, loops
from .table_row import MINUS, NAME, NOTHING, TableRow

DATA = Path(__file__).parent / "data"
SHIPPED = (DATA / "dry", DATA / "mortared")
HEADS = ["displacement_mm", "force_kN"]
CURVE, SCENE, CRACKS = ENDINGS = (".csv", ".toml", "-cracks.png")
SEPARATORS = ",;\t"
COMMENT = re.compile(r"#(?!(N/A|NV|DIV/0!|VALUE!|REF!|NUM!|NAME\?|NULL!)\s*([,;\t]|$))|sep=.\s*$", re.IGNORECASE)
"""Beginning of a comment: #, unless it is that of an error value of a spreadsheet; or the spreadsheet's ``sep=;``."""

WRONG_UNIT = 100.0
"""Ratio of the largest force of a curve to that of the table, or its inverse, above which one of them has a wrong
unit."""

BETWEEN_MODES = re.compile(r"[,;/+&()]|\b(?:and|with|then|followed by)\b|(?<![a-z]{3})[-–—](?![a-z]{3})", re.IGNORECASE)
"""What separates failure modes: hyphens as well, as in R-TC, but not within words, as in toe-crushing."""

DECIMAL = re.compile(r"\s*[-+−–]?\d*,\d+(?:[eE][-+]?\d+)?\s*")


def raised(error: SceneError) -> None:
    """Raise the error for which a wall is refused."""
    raise error


def read_folder(folder: Path, refuse: Callable[[SceneError], None] = raised) -> list[MeasuredWall]:
    """Read the walls of a folder, in the order of its table.

    The table is the one CSV file that has a column ``Test unit name``; ``NAME.csv`` contains a wall's curve,
    ``NAME.toml`` its scene and ``NAME-cracks.png`` its cracks, each optional. Entries are separated by commas, or by
    semicolons or tabs, in which case numbers may have decimal commas. Lines that begin with # are comments. Empty lines
    separate the loops of a curve, as ``NaN,NaN`` does.

    Parameters
    ----------
    folder
        The folder.
    refuse
        Called with the reason why a wall cannot be read; the wall is then left out, unless `refuse` raises the error.

    Raises
    ------
    SceneError
        If something cannot be read: one line with the file, its line and what would be right.
    """
    path, lines = _table(folder)
    heads = lines[0][1]
    walls: dict[str, MeasuredWall] = {}
    if not lines[1:]:
        raise SceneError(path.name, "holds no wall, only heads")
    for number, cells in lines[1:]:
        try:
            wall = _wall(folder, TableRow.read(path, number, heads, cells), walls)
        except SceneError as error:
            refuse(error)
        else:
            walls[wall.name] = wall
    return list(walls.values())


def shipped_walls() -> dict[str, MeasuredWall]:
    """Walls that the package ships, by name."""
    return {wall.name: wall for folder in SHIPPED for wall in read_folder(folder)}


def chosen_walls(names: Iterable[str]) -> dict[str, MeasuredWall]:
    """Shipped walls of these names, by name; an unknown name raises a `SceneError`."""
    walls = shipped_walls()
    for name in names:
        if name not in walls:
            raise SceneError("wall", f"must be of {', '.join(walls)}{suggestion(name, list(walls))}", name)
    return {name: walls[name] for name in names}


def unused(folder: Path) -> list[str]:
    """Files of a folder that are named like the files of a wall, but belong to no wall in its table."""
    table, lines = _table(folder)
    files = _files(folder)
    named = {cell.strip() for _, cells in lines for cell in cells}
    own = {table, *(_file(files, f"{name}{ending}") for name in named for ending in ENDINGS)}
    return sorted(path.name for name, path in files.items() if name.endswith(ENDINGS) and path not in own)


def _files(folder: Path) -> dict[str, Path]:
    """Visible files of a folder, by name with the ending in lower case."""
    files = (path for path in sorted(folder.iterdir()) if path.is_file() and not path.name.startswith("."))
    return {path.with_suffix(path.suffix.lower()).name: path for path in files}


def _file(files: Mapping[str, Path], name: str) -> Path | None:
    """The file of a name, else the first that differs from it only in upper and lower case; None if there is none."""
    alike = (path for other, path in files.items() if other.casefold() == name.casefold())
    return files.get(name) or next(alike, None)


def _table(folder: Path) -> tuple[Path, list[tuple[int, list[str]]]]:
    """The table of a folder, and its non-empty lines with their numbers."""
    if not folder.is_dir():
        raise SceneError(str(folder), "must be a folder that holds tests.csv")
    tables, unread = list[Path](), list[SceneError]()
    for name, path in _files(folder).items():
        try:
            heads = next(_filled_lines(path), (0, []))[1] if name.endswith(CURVE) else []
        except SceneError as error:  # belongs to a refused wall, unless it is the table
            unread.append(error)
        else:
            if any(cell.strip().lstrip("\ufeff").casefold().startswith(NAME) for cell in heads):
                tables.append(path)
    if unread and not tables:
        raise unread[0]
    if len(tables) != 1:
        found = f"has {len(tables)}: {', '.join(path.name for path in tables)}" if tables else "has none"
        raise SceneError(str(folder), f'must hold one table, a CSV file with a column "Test unit name"; it {found}')
    return tables[0], list(_filled_lines(tables[0]))


def _separator(heads: str) -> str:
    """Separator of a table with this first line: that beside a required head, as others contain some themselves."""
    for name in (NAME, *HEADS):
        own = rf'{name}[^"{SEPARATORS}]*"? *'
        if beside := re.search(rf'{own}([{SEPARATORS}])|([{SEPARATORS}]) *"?{own}$', heads, re.IGNORECASE):
            return str(next(filter(None, beside.groups())))
    return max(SEPARATORS, key=heads.count)


def _is_empty(cells: list[str]) -> bool:
    """Whether a line has no entries."""
    return not any(cell.strip() for cell in cells)


def _filled_lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Numbers and entries of the lines that are neither empty nor comments."""
    return ((number, cells) for number, cells in _lines(path) if not _is_empty(cells))


def _lines(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Numbers and entries of the lines that are no comments."""
    try:
        text = path.read_bytes().decode("utf-8-sig")
        told = [line for line in text.splitlines() if line.strip() and not COMMENT.match(line)]
        separator = _separator(told[0] if told else "")
        rest, number = io.StringIO(text, newline=""), 0
        for line in rest:
            number += 1
            if COMMENT.match(line):
                continue
            reader = csv.reader(chain([line], rest), strict=True, delimiter=separator)
            try:
                cells = next(reader)
            finally:
                number += reader.line_num - 1  # a quoted entry may have several lines
            if not (cells and COMMENT.match(cells[0])):
                yield number, cells if separator == "," else [_with_point(cell) for cell in cells]
    except OSError as error:
        raise SceneError(str(path), f"cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise SceneError(path.name, "is not a table: it is not UTF-8 text") from error
    except csv.Error as error:
        raise SceneError(f"{path.name}, line {number}", f"is not a line of a CSV file: {error}") from error


def _with_point(cell: str) -> str:
    """An entry, with a decimal point if it is a number with a decimal comma."""
    return cell.replace(",", ".") if DECIMAL.fullmatch(cell) else cell


def _wall(folder: Path, row: TableRow, others: Iterable[str]) -> MeasuredWall:
    name = row.text(NAME)
    if not name or name.startswith(".") or set(name) & set('/\\:*?"<>|$'):
        raise SceneError(row.key("Test unit name"), "must be a name, as it may be that of a file, without $", name)
    if name.casefold() in map(str.casefold, others):
        what = "is the second row of that name; names must differ in more than upper and lower case"
        raise SceneError(row.key("Test unit name"), what, name)
    files = _files(folder)
    there = {ending: path for ending in ENDINGS if (path := _file(files, f"{name}{ending}"))}
    kind = row.text("cyclic / monotonic")
    if kind.casefold() not in NOTHING and not any(word in kind.casefold() for word in (CYCLIC, MONOTONIC)):
        what = 'must be "Cyclic" or "Monotonic"; or empty, where the record says it'
        raise SceneError(row.key("Cyclic / Monotonic"), what, kind)
    curve = read_curve(there[CURVE]) if CURVE in there else np.zeros((0, 2))
    if len(curve) and np.nansum(curve[:, 0] * curve[:, 1]) <= 0:
        raise SceneError(f"{name}.csv", "has its forces against its displacements; change the sign of one of them")
    _check_displacements(name, curve, row.optional("H0"))
    if CRACKS in there:
        _check_picture(there[CRACKS])
    modes = _words(row.text("from test report: failure type"))
    printed = [row.optional("Vmax,+", may_be_zero=True), row.optional("Vmax,-", magnitude=True, may_be_zero=True)]
    peaks = tuple(value for value in printed if value is not None)
    if len(curve) and peaks:
        largest, told = float(np.nanmax(np.abs(curve[:, 1]))), max(peaks)
        if not told / WRONG_UNIT < largest < told * WRONG_UNIT:
            forces = f"{largest / 1e3:.3g} kN, and the table one of {told / 1e3:.3g} kN"
            what = f"has a largest force of {forces}; are their units right?"
            raise SceneError(f"{name}.csv", what)
    wall = MeasuredWall(name, row, curve, peaks, modes, there.get(SCENE), there.get(CRACKS))
    if wall.is_cyclic and min(wall.reach) > NOISE * max(wall.reach):
        wall = replace(wall, curve=_from_rest(curve))
        _check_cycles(wall)
    elif _ends_at_rest(curve):
        wall = replace(wall, curve=curve[::-1], is_reversed=True)
    if _is_pushed_left(wall):
        wall = replace(wall, curve=-wall.curve, is_turned=True)
    return replace(wall, peaks=_peaks(wall, *printed))


def _words(said: str) -> tuple[str, ...]:
    """Failure modes in the words of a table, in capitals."""
    parts = [] if said.casefold() in NOTHING else BETWEEN_MODES.split(said)
    return tuple(" ".join(part.replace("-", " ").upper().split()) for part in parts if part.strip())


def _check_displacements(name: str, curve: Array, height: float | None) -> None:
    """Refuse a curve whose displacements cannot be in mm, compared with the actuator's height [m]."""
    if height is None or not len(curve):
        return
    largest = float(np.nanmax(np.abs(curve[:, 0])))
    if not DRIFTS[0] < largest / height < DRIFTS[1]:
        told = f"{1e3 * largest:.3g}, {largest / height:.2g} of H0 = {1e3 * height:.4g} mm"
        raise SceneError(f"{name}.csv: {HEADS[0]}", f"must be in mm; the largest is {told}")


def _check_picture(path: Path) -> None:
    """Refuse a crack map that could not be drawn beside the curves later."""
    try:
        imread(path, format="png")
    except (OSError, SyntaxError, ValueError) as error:  # pillow raises SyntaxError for a damaged file
        raise SceneError(path.name, "is no PNG picture, or a damaged one") from error


def _is_pushed_left(wall: MeasuredWall) -> bool:
    """Whether a wall was pushed to the negative side: to the positive side only by noise or, if monotonic, less far."""
    right, left = wall.reach
    return left * NOISE > right or (left > right and not wall.is_cyclic)


def _ends_at_rest(curve: Array) -> bool:
    """Whether a record of a push to one side starts where the wall was pushed farthest, and leads to rest."""
    moved = np.abs(curve[~np.isnan(curve[:, 0]), 0])
    return bool(len(moved) and moved[0] > (1 - NOISE) * moved.max() and moved[-1] < NOISE * moved.max())


def _from_rest(curve: Array) -> Array:
    """A curve to both sides; if it is an envelope, as two parts that go outward from rest.

    An envelope is a record without unloading: its forces are to the sides of its displacements, none are at rest, and
    its points to each side only go outward, or only inward from where they do not start at rest. Small forces against
    this are noise and left out; points that step back by noise are put in order. The side of its first point comes
    first, but if it leads from one side straight to the other, the positive one.
    """
    known = curve[~np.isnan(curve[:, 0])]
    moved, force = known.T
    if (np.abs(force[moved * force <= 0]) > NOISE * np.abs(force).max()).any():
        return curve
    back = UNLOADED * float(np.abs(moved).max())
    parts = list[Array]()
    for own in (curve[:, 0] > 0, curve[:, 0] < 0):
        side, first = curve[own & (curve[:, 0] * curve[:, 1] >= 0)], int(np.argmax(own))
        if not len(side):
            return curve
        is_from_rest = first > 0 and curve[first - 1, 0] == 0
        if abs(side[0, 0]) > abs(side[-1, 0]) and not is_from_rest:
            side = side[::-1]
        if not _only_rises(np.abs(side[:, 0]), back):
            return curve
        parts.append(side[np.argsort(np.abs(side[:, 0]), kind="stable")])
    is_straight = _only_rises(moved, back) or _only_rises(-moved, back)
    if not is_straight and moved[moved != 0][0] < 0:
        parts.reverse()
    rest = known[moved == 0][:1] * 0
    return np.concatenate([rest, parts[0], np.full((1, 2), np.nan), rest, parts[1]])


def _only_rises(values: Array, back: float) -> bool:
    """Whether values ``(n,)`` never fall below an earlier one by more than `back`."""
    return bool((values >= np.maximum.accumulate(values) - back).all())


def _check_cycles(wall: MeasuredWall) -> None:
    """Refuse a record of cycles that cannot be in the order of the test."""
    known = wall.curve[~np.isnan(wall.curve[:, 0])]
    steps, force = np.diff(known[:, 0]), known[:, 1]
    clear = np.sign(force[np.abs(force) > NOISE * np.abs(force).max()])
    is_sorted = (steps >= 0).all() or (steps <= 0).all()
    found = loops(wall.curve)
    work, turnover = sum(loop.work for loop in found), sum(loop.turnover for loop in found)
    for told, is_wrong in (
        ("its rows are sorted by displacement", is_sorted and np.count_nonzero(np.diff(clear)) > 1),
        ("its cycles release energy", work < -LEAST_DISSIPATED * turnover),
    ):
        if is_wrong:
            what = f"must have its rows in the order of the test, and {HEADS[0]} and {HEADS[1]} not exchanged; {told}"
            raise SceneError(f"{wall.name}.csv", what)


def _peaks(wall: MeasuredWall, positive: float | None, negative: float | None) -> tuple[float, ...]:
    """Largest forces to the sides to which a wall was pushed: as its table has them, else as its curve has them.

    A monotonic test has one. So has a cyclic one whose record is to one side, unless its table has both; whichever
    column has the number.
    """
    printed = [negative, positive] if wall.is_turned else [positive, negative]
    recorded: list[float | None] = [None, None]
    if len(wall.curve):
        forces = float(np.nanmax(wall.curve[:, 1])), -float(np.nanmin(wall.curve[:, 1]))
        least = NOISE * max(wall.reach)
        pushed = zip(forces, wall.reach, strict=True)
        recorded = [force if far > least and force > 0 else None for force, far in pushed]
    told = [value for value in printed if value is not None]
    if not wall.is_cyclic or (len(wall.curve) and recorded[1] is None and len(told) < 2):
        return tuple([*told, *(value for value in recorded if value is not None)][:1])
    known = [one if one is not None else other for one, other in zip(printed, recorded, strict=True)]
    return tuple(value for value in known if value is not None)


def read_curve(path: Path) -> Array:
    """Displacement [m] and force [N] of a curve, ``(n, 2)``; rows of two NaN separate its loops.

    In the file, a row without both numbers separates loops: an empty line, or a row with two entries of `NOTHING`.
    """
    lines = list(dropwhile(lambda line: _is_empty(line[1]), _lines(path)))
    written = [cell.strip() for cell in lines[0][1]] if lines else []
    heads = [head.casefold() for head in written]
    if any(head.casefold() not in heads for head in HEADS):
        raise SceneError(
            f"{path.name}, line {lines[0][0] if lines else 1}",
            f"must be the heads {','.join(HEADS)}",
            ",".join(written),
        )
    columns = [heads.index(head.casefold()) for head in HEADS]
    for number, cells in lines[1:]:
        if any(cell.strip() for cell in cells[len(heads) :]):
            what = f"must have {len(heads)} entries, as its heads; has {len(cells)}"
            raise SceneError(f"{path.name}, line {number}", what, ",".join(cells))
    rows = [_point(path, number, [cells[k] if k < len(cells) else "" for k in columns]) for number, cells in lines[1:]]
    curve = np.array(rows, dtype=float).reshape(-1, 2) * (1e-3, 1e3)
    is_point = ~np.isnan(curve[:, 0])
    known = curve[is_point]
    if len(known) < 2 or not np.ptp(known[:, 0]) or not known[:, 1].any():
        raise SceneError(
            path.name, "must hold points of a curve: two or more, at different displacements, under a force"
        )
    if not (is_point[1:] & is_point[:-1]).any():
        raise SceneError(path.name, "has a gap after every point, such as an empty line; gaps must separate loops")
    return curve


def _point(path: Path, line: int, cells: list[str]) -> tuple[float, float]:
    if all(cell.strip().casefold() in NOTHING for cell in cells):
        return math.nan, math.nan
    try:
        x, y = (float(cell.translate(MINUS)) for cell in cells)
    except ValueError:
        x, y = math.inf, math.inf
    if math.isinf(x) or math.isinf(y) or math.isnan(x) != math.isnan(y):
        what = "must be two numbers, or NaN,NaN or empty between loops"
        raise SceneError(f"{path.name}, line {line}", what, ",".join(cells))
    return x, y
