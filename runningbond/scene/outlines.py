"""The outlines of a wall's blocks, read from the ``[wall]`` table of a scene file."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast, get_args

import numpy as np

from .arrays import Array
from .bond import Bond, Ends, FirstCourse, bonded_rows, pattern_rows, rectangles
from .cutting import cut_openings
from .errors import SceneError
from .openings import read_openings
from .ranges import ABOVE_ZERO
from .table import Table

EQUAL = 1e-9
"""Relative tolerance for equal course heights, and for their sum against the given height of the wall."""


UNCRACKED_WIDTH = 0.75
"""Width, as a share of the nominal block width, up to which a block of a bonded wall gets no potential crack inside."""


@dataclass(frozen=True, eq=False)
class Outlines:
    """The block geometry that a scene file describes.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Blocks of the wall [m], counter-clockwise.
    grounds : list of (n, 2) float
        Pieces of the ground [m]; empty if the support is to generate one.
    bond
        Nominal block, if the wall is bonded in courses of equal height.
    whole_up_to
        Width [m] up to which blocks stay whole if blocks may crack (``inner_joint``).
    layers
        Layer of each block in a drawing; empty for other walls.
    materials
        Names of the materials of individual blocks, by block number.
    notes
        What was left out of a drawing or repaired in it, one line each.
    """

    polygons: list[Array]
    grounds: list[Array] = field(default_factory=list)
    bond: Bond | None = None
    whole_up_to: float = 0.0
    layers: tuple[str, ...] = ()
    materials: dict[int, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()


def read_outlines(
    wall: Table, folder: Path, thickness: float, block_names: Sequence[str], *, strip: float | None = None
) -> Outlines:
    """Read the outlines that the table of a wall describes.

    Parameters
    ----------
    folder
        Folder that paths of drawings are relative to.
    thickness
        Out-of-plane thickness of the wall [m].
    block_names
        Names of the materials that blocks may have.
    strip
        Reach, in sizes of the wall, of the strip of ground that is laid below blocks without one; None for none.

    Raises
    ------
    SceneError
        If the table describes no wall, or describes it in two ways.
    """
    _refuse_mixed_descriptions(wall)
    if "drawing" in wall:
        from .drawings import METRES, read_drawing  # only now: healing needs a good part of scipy

        path, units = folder / wall.text("drawing"), wall.choice("units", METRES)
        drawing = read_drawing(path, units, thickness=thickness, strip=strip, **_corrections(wall))
        return Outlines(drawing.blocks, drawing.grounds, layers=drawing.layers, notes=drawing.notes)
    if "outlines" in wall:
        from .drawings import METRES, listed_outlines

        blocks, grounds = wall.outlines("outlines"), wall.outlines("ground") if "ground" in wall else []
        scale = METRES[wall.choice("units", METRES, "m")]
        listed = listed_outlines(blocks, grounds, scale, strip=strip, **_corrections(wall))
        return Outlines(listed.blocks, listed.grounds, notes=listed.notes)
    width = wall.number("block_width", ABOVE_ZERO)
    heights = _course_heights(wall)
    bond = Bond(width, float(heights[0])) if heights is not None and np.ptp(heights) <= EQUAL * heights[0] else None
    if heights is None:
        bond = Bond(width, wall.number("block_height", ABOVE_ZERO))
    if "courses" in wall:
        rows = pattern_rows(wall.rows("courses"))
        if heights is not None and len(heights) != len(rows):
            what = f"must be as many as the courses of wall.courses, {len(rows)}"
            raise SceneError("wall.course_heights", what, heights.tolist())
    else:
        length = wall.number("length", ABOVE_ZERO)
        n_courses = _number_of_courses(wall, bond, heights)
        first = cast(FirstCourse, wall.choice("first_course", get_args(FirstCourse), "full"))
        ends = cast(Ends, wall.choice("ends", get_args(Ends), "flush"))
        rows = bonded_rows(width, length, n_courses, first, ends)
    levels = bond.levels(len(rows)) if bond else np.cumsum([0.0, *cast(Array, heights)])
    polygons, openings = rectangles(rows, width, levels), read_openings(wall, block_names)
    materials: dict[int, str] = {}
    if openings:
        polygons, materials = cut_openings(polygons, openings, width)
    return Outlines(polygons, bond=bond, whole_up_to=UNCRACKED_WIDTH * width, materials=materials)


def _corrections(wall: Table) -> dict[str, float | None]:
    """Largest widths [m] of the mortar joints to be expanded into and of the gaps to be healed; None if not given."""
    return {"expand": wall.optional_number("expand", ABOVE_ZERO), "heal": wall.optional_number("heal", ABOVE_ZERO)}


def _course_heights(wall: Table) -> Array | None:
    """Heights of the courses ``(n,)`` [m] if the file lists them; None if all have one block's height."""
    key, heights = wall.key("course_heights"), wall.value("course_heights")
    if heights is None:
        return None
    if "block_height" in wall:
        raise SceneError(key, "does not go with wall.block_height; give one of them", heights)
    if not isinstance(heights, list) or not heights:
        raise SceneError(key, "must be a list of heights, one for each course, bottom to top", heights)
    return np.array([ABOVE_ZERO.take(f"{key}[{k}]", height) for k, height in enumerate(heights)])


def _number_of_courses(wall: Table, bond: Bond | None, heights: Array | None) -> int:
    """Number of courses that fill the given height, or of the listed courses, whose sum must equal a given height."""
    if heights is None and bond:
        return bond.courses_in(wall.number("height", ABOVE_ZERO))
    listed = cast(Array, heights)
    height, total = wall.optional_number("height", ABOVE_ZERO), float(listed.sum())
    if height is not None and abs(height - total) > EQUAL * total:
        raise SceneError("wall.height", f"must be left out, or be the sum of wall.course_heights, {total:.6g}", height)
    return len(listed)


def _refuse_mixed_descriptions(wall: Table) -> None:
    """Refuse keys of two descriptions: a wall is a drawing, outlines, courses, or a length and a height."""
    by_size = ("length", "height", "first_course", "ends")
    drawn = ("ground", "units", "expand", "heal")
    bonded = ("block_width", "block_height", "course_heights", "opening")
    for description, strangers in (
        ("drawing", ("outlines", "ground", "courses", *by_size, *bonded)),
        ("outlines", ("courses", *by_size, *bonded)),
        ("courses", (*drawn, *by_size)),
        ("length", drawn),
    ):
        if description in wall:
            for key in strangers:
                if key in wall:
                    what = f"does not go with wall.{description}; describe the wall in one way"
                    raise SceneError(f"wall.{key}", what)
            return
    if not any(key in wall for key in by_size):
        raise SceneError(
            "wall", "must say what its blocks are: by length and height, by courses, by outlines, or by a drawing"
        )
