"""Openings in a bonded wall and the lintels over them, as a file says them."""

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
        Its height and how far it reaches into the wall on either side [m].
    material
        Name of its material; None is that of the other blocks.
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
        What a file has it under.
    low, high
        Lower left and upper right corner [m].
    lintel
        What spans it; None where nothing does.
    """

    key: str
    low: tuple[float, float]
    high: tuple[float, float]
    lintel: Lintel | None = None


def read_openings(wall: Table, block_names: Sequence[str]) -> list[Opening]:
    """Openings of the table of a wall, whose lintels are of materials of some names."""
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
