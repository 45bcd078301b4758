"""Generators of walls on the half-block lattice: running bond and course patterns."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np

from .arrays import Array
from .errors import SceneError
from .ranges import ABOVE_ZERO, one_of

FirstCourse: TypeAlias = Literal["full", "half"]
Ends: TypeAlias = Literal["flush", "toothed"]

Rows: TypeAlias = list[tuple[Array, Array]]
"""Left and right sides of the blocks of each course, bottom to top, in half blocks."""

BLOCK_LIMIT = 1_000_000
LATTICE_TOLERANCE = 1e-6
"""Largest deviation of a number of half blocks or courses from a whole number n, as a multiple of max(1, n)."""


@dataclass(frozen=True)
class Bond:
    """Nominal block of a bonded wall: width along the course and height [m]."""

    width: float
    height: float

    def __post_init__(self) -> None:
        for name in ("width", "height"):
            object.__setattr__(self, name, ABOVE_ZERO.take(f"wall.block_{name}", getattr(self, name)))

    def courses_in(self, height: float) -> int:
        """Number of courses in a height [m]; raises a `SceneError` unless it is a whole number."""
        return _whole_number(height / self.height, "wall.height", height, f"courses of {self.height:g}")

    def levels(self, n_courses: int) -> Array:
        """Levels of the bed joints of `n_courses` courses, including bottom and top, ``(n_courses + 1,)`` [m]."""
        return np.asarray(self.height * np.arange(n_courses + 1))


def bonded_rows(
    width: float, length: float, n_courses: int, first_course: FirstCourse = "full", ends: Ends = "flush"
) -> Rows:
    """Courses of a running-bond panel, from the nominal block width and the panel's length [m].

    Parameters
    ----------
    first_course
        Whether the first course starts with a full or a half block.
    ends
        ``"flush"``: courses are closed by half blocks; ``"toothed"``: courses that would start with a half
        block omit it at both ends.
    """
    one_of("wall.first_course", first_course, get_args(FirstCourse))
    one_of("wall.ends", ends, get_args(Ends))
    n_half = _whole_number(length / (width / 2), "wall.length", length, f"half blocks of {width / 2:g}")
    if n_half * n_courses / 2 > BLOCK_LIMIT:
        raise SceneError("wall.length", f"gives more than {BLOCK_LIMIT} blocks; make the wall smaller", length)
    if ends == "toothed" and (n_half % 2 or n_half < 4):
        raise SceneError("wall.length", "toothed ends need a whole number of blocks, at least two", length)
    courses = []
    for course in range(n_courses):
        starts_half = (course % 2 == 1) != (first_course == "half")
        cuts = np.arange(1 if starts_half else 0, n_half + 1, 2, dtype=np.float64)
        if ends == "flush":
            cuts = np.unique(np.concatenate([[0.0], cuts, [n_half]]))
        courses.append((cuts[:-1], cuts[1:]))
    return courses


def pattern_rows(courses: Sequence[Sequence[float]]) -> Rows:
    """Courses of a wall, bottom to top, each given as a list of widths in blocks, left to right from x = 0.

    A negative width is an opening, whose two sides must lie on the half-block lattice.
    """
    if sum(len(course) for course in courses) > BLOCK_LIMIT:
        raise SceneError("wall.courses", f"has more than {BLOCK_LIMIT} blocks; make the wall smaller")
    if not courses:
        raise SceneError("wall.courses", "has no course; give at least one, bottom to top", [])
    rows = []
    for course, widths in enumerate(courses):
        name = f"wall.courses[{course}]"
        width = np.asarray(widths, dtype=float)
        if not (width > 0).any():
            raise SceneError(name, "is an empty course; give it at least one block", list(widths))
        if (width == 0).any():
            raise SceneError(name, "has a width of 0; a block is positive, an opening negative", list(widths))
        cuts = 2 * np.concatenate([[0.0], np.cumsum(np.abs(width))])
        nearest = np.rint(cuts)
        on_lattice = np.abs(cuts - nearest) <= LATTICE_TOLERANCE * np.maximum(1.0, nearest)
        cuts = np.where(on_lattice, nearest, cuts)
        off = (width < 0) & ~(on_lattice[:-1] & on_lattice[1:])
        if off.any():
            i = int(np.argmax(off))
            raise SceneError(
                f"{name}[{i}]",
                f"is an opening off the lattice, from {cuts[i] / 2:g} to {cuts[i + 1] / 2:g} blocks; "
                "both its sides must lie at whole or half blocks",
                float(width[i]),
            )
        solid = width > 0
        rows.append((cuts[:-1][solid], cuts[1:][solid]))
    return rows


def rectangles(rows: Rows, width: float, levels: Array) -> list[Array]:
    """Blocks ``(4, 2)`` [m] of courses between levels ``(n + 1,)`` [m], on a lattice of half the block width [m].

    Corners run counter-clockwise; blocks are listed course by course, left to right.
    """
    blocks: list[Array] = []
    for (left, right), low, high in zip(rows, levels[:-1], levels[1:], strict=True):
        x0, x1 = left * (width / 2), right * (width / 2)
        y0, y1 = np.full_like(x0, low), np.full_like(x0, high)
        blocks.extend(np.stack([np.stack([x0, x1, x1, x0], 1), np.stack([y0, y0, y1, y1], 1)], 2))
    return blocks


def _whole_number(ratio: float, key: str, value: float, unit: str) -> int:
    nearest = round(ratio) if np.isfinite(ratio) and ratio < 1e9 else 0
    if nearest < 1 or abs(ratio - nearest) > LATTICE_TOLERANCE * max(1.0, nearest):
        raise SceneError(key, f"must be a whole number of {unit} m; this is {ratio:.6g} of them", value)
    return nearest
