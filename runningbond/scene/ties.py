"""Ties: straight bars between two points, or from a point to an anchor in space, that carry tension only."""

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from .arrays import Array, Indices, Mask, frozen
from .blocks import Blocks
from .errors import SceneError, keys_of
from .ranges import ABOVE_ZERO, NotNegative, Positive, check_numbers, vector
from .table import Table

ANCHOR = -1
"""Block number of an end that touches no block: a point fixed in space."""


@dataclass(frozen=True)
class Tie:
    """A bar as a scene file describes it.

    Parameters
    ----------
    start, end
        Ends of the bar [m].
    area, young
        Cross-section [m²] and Young's modulus [Pa].
    yield_force
        Force at which the bar yields [N].
    preload
        Force in the bar before anything moves [N]; at most the yield force.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    area: Positive
    young: Positive
    yield_force: Positive
    preload: NotNegative = 0.0

    def __post_init__(self) -> None:
        check_numbers(self, "tie")
        for name, key in (("start", "from"), ("end", "to")):
            object.__setattr__(self, name, vector(f"tie.{key}", getattr(self, name)))
        if self.preload > self.yield_force:
            raise SceneError("tie.preload", f"must be at most the yield force, {self.yield_force:g} N", self.preload)


@dataclass(frozen=True, eq=False)
class Ties:
    """The ties of a scene.

    Parameters
    ----------
    block : (nt, 2) int
        Blocks that hold the two ends, `ANCHOR` for an end that is fixed in space.
    ends : (nt, 2, 2) float
        Coordinates of the ends [m].
    area, young, yield_force, preload : (nt,) float
        As in `Tie`.
    """

    block: Indices
    ends: Array
    area: Array
    young: Array
    yield_force: Array
    preload: Array

    def __post_init__(self) -> None:
        object.__setattr__(self, "block", frozen(np.reshape(self.block, (-1, 2)), np.int64))
        object.__setattr__(self, "ends", frozen(np.reshape(self.ends, (-1, 2, 2))))
        for part in fields(self)[2:]:
            object.__setattr__(self, part.name, frozen(getattr(self, part.name)))

    def __len__(self) -> int:
        return len(self.block)

    @property
    def length(self) -> Array:
        """Length of each tie, ``(nt,)`` [m]."""
        return np.asarray(np.hypot(*(self.ends[:, 1] - self.ends[:, 0]).T))

    @property
    def direction(self) -> Array:
        """Unit vector of each tie from its first end to its second, ``(nt, 2)``."""
        return np.asarray((self.ends[:, 1] - self.ends[:, 0]) / self.length[:, None])

    @property
    def stiffness(self) -> Array:
        """Axial stiffness of each tie, E A / L, ``(nt,)`` [N/m]."""
        return np.asarray(self.young * self.area / self.length)


NO_TIES = Ties(np.zeros((0, 2), dtype=np.int64), np.zeros((0, 2, 2)), *np.zeros((4, 0)))


def read_tie(table: Table) -> Tie:
    """Read the tie that a table of a scene file describes."""
    with keys_of(table.name, "tie"):
        numbers = table.numbers(Tie, "yield_force")
        tie = Tie(table.vector("from"), table.vector("to"), yield_force=table.number("yield", ABOVE_ZERO), **numbers)
    table.finish()
    return tie


def place_ties(ties: Sequence[Tie], blocks: Blocks, fixed: Mask) -> Ties:
    """Find the blocks that hold the ends of ties; a `SceneError` for ties without effect, or with an ambiguous end."""
    if not ties:
        return NO_TIES
    owner = np.full((len(ties), 2), ANCHOR)
    for k, tie in enumerate(ties):
        for end, (key, at) in enumerate((("from", tie.start), ("to", tie.end))):
            touching = blocks.containing(np.array(at))
            if len(touching) > 1:
                names = " and ".join(blocks.name(int(block)) for block in touching[:2])
                what = f"lies on the joint of {names}; move it into the one that holds the tie"
                raise SceneError(f"tie[{k}].{key}", what, list(at))
            owner[k, end] = touching[0] if len(touching) else ANCHOR
        if not any(block != ANCHOR and not fixed[block] for block in owner[k]):
            bodies = ["no block" if block == ANCHOR else f"block {block}, which is held" for block in owner[k]]
            what = f"is at {bodies[1]}, and tie[{k}].from at {bodies[0]}; one of them must be at a block that can move"
            raise SceneError(f"tie[{k}].to", what, list(tie.end))
        if owner[k, 0] == owner[k, 1]:
            raise SceneError(f"tie[{k}].to", f"must lie on another block than tie[{k}].from", list(tie.end))
    ends = np.array([(tie.start, tie.end) for tie in ties])
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    if length[k := int(length.argmin())] <= blocks.tolerance:
        raise SceneError(f"tie[{k}].to", f"must lie apart from tie[{k}].from", list(ties[k].end))
    return Ties(owner, ends, *np.array([(tie.area, tie.young, tie.yield_force, tie.preload) for tie in ties]).T)
