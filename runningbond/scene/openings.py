"""Openings in a bonded wall and the lintels over them, as a scene file describes them."""

from collections.abc import Sequence
from dataclasses import dataclass

from .errors import SceneError
from .ranges import Positive
from .table import Table


@dataclass(frozen=True)
class Lintel:
    """A block over an opening.

    Parameters
    ----------
    height, bearing
        Height of the lintel and its bearing length in the wall on either side [m].
    material
        Name of the lintel's material; None for the default material of blocks.
    """

    height: Positive
    bearing: Positive
    material: str | None = None


@dataclass(frozen=True)
class Opening:
    """A rectangle without blocks.

    Parameters
    ----------
    key
        Key of the opening in the scene file, for error messages.
    low, high
        Lower left and upper right corner [m].
    lintel
        Lintel that spans the opening; None if nothing does.
    """

    key: str
    low: tuple[float, float]
    high: tuple[float, float]
    lintel: Lintel | None = None


def read_openings(wall: Table, block_names: Sequence[str]) -> list[Opening]:
    """Read the openings of a wall's table; the materials of lintels are chosen from `block_names`."""
    return [_read_opening(table, block_names) for table in wall.list_of_tables("opening")]


def _read_opening(table: Table, block_names: Sequence[str]) -> Opening:
    low, high = table.vector("from"), table.vector("to")
    if not (low[0] < high[0] and low[1] < high[1]):
        what = f"must lie to the right of and above {table.key('from')} = {list(low)}"
        raise SceneError(table.key("to"), what, list(high))
    lintel, over = None, table.optional_table("lintel")
    if over:
        material = over.choice("material", block_names) if "material" in over else None
        lintel = Lintel(**over.numbers(Lintel), material=material)
        over.finish()
    table.finish()
    return Opening(table.name, low, high, lintel)
