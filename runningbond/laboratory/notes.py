"""Notes on walls: what is unusual in their data, and how it is taken."""

from .measured import MeasuredWall
from .modes import GROUPS, NAMED


def notes_on(wall: MeasuredWall) -> list[str]:
    """What a reader of a wall's scores needs to know of its data, in one line each."""
    return [*_unknown_modes(wall)]


def _unknown_modes(wall: MeasuredWall) -> list[str]:
    words = ", ".join([*GROUPS, *(word.lower() for word in NAMED)])
    unknown = (word for word in wall.modes if word not in GROUPS | NAMED)
    return [f"failure type '{word}' is not understood and does not count; the words are {words}" for word in unknown]
