"""Supports: which blocks are held, and where."""

from dataclasses import dataclass, field, fields
from typing import Literal, TypeAlias, get_args

import numpy as np

from .arrays import Array, Indices, Mask, frozen
from .blocks import Blocks
from .complement import complement

SupportKind: TypeAlias = Literal["base", "fixed-first-course", "corners", "pinned-corners"]
SUPPORT_KINDS: tuple[str, ...] = get_args(SupportKind)


@dataclass(frozen=True, eq=False)
class Pins:
    """Motions of blocks that are held at zero, in both directions: direction · u(point) + turn · ω = 0.

    Parameters
    ----------
    block : (n,) int
        The block held.
    point, direction : (n, 2) float
        Point [m], and unit vector along which the displacement of this point is zero; (0, 0) for a held rotation.
    turn : (n,) float
        1 [m/rad] for a held rotation, 0 (the default) for a held displacement.
    """

    block: Indices
    point: Array
    direction: Array
    turn: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        object.__setattr__(self, "block", frozen(self.block, np.int64))
        object.__setattr__(self, "point", frozen(np.reshape(self.point, (-1, 2))))
        object.__setattr__(self, "direction", frozen(np.reshape(self.direction, (-1, 2))))
        object.__setattr__(self, "turn", frozen(self.turn if len(self.turn) else np.zeros(len(self.block))))

    def __len__(self) -> int:
        return len(self.block)

    def __add__(self, other: "Pins") -> "Pins":
        return Pins(*(np.concatenate([getattr(each, part.name) for each in (self, other)]) for part in fields(Pins)))


NO_PINS = Pins(np.zeros(0, dtype=np.int64), np.zeros((0, 2)), np.zeros((0, 2)))


def first_course(blocks: Blocks, wall: Mask) -> Mask:
    """Mask of the wall's blocks whose lowest corner is level with the lowest one of the wall, ``(nb,)``."""
    lowest = blocks.boxes[0][:, 1]
    level: Mask = lowest <= lowest[wall].min() + blocks.tolerance
    return wall & level


def corner_pins(blocks: Blocks, wall: Mask, *, roller: bool) -> Pins:
    """Pin the outer bottom corners of the first course; a `roller` leaves the right one free to move horizontally."""
    members = first_course(blocks, wall)
    level = blocks.extent(members)[0][1] + blocks.tolerance
    corner = np.flatnonzero(members[blocks.owner] & (blocks.vertices[:, 1] <= level))
    x = blocks.vertices[corner, 0]
    left, right = corner[x.argmin()], corner[x.argmax()]
    n = 3 if roller else 4
    vertex, direction = [left, left, right, right][:n], [(1.0, 0.0), (0.0, 1.0), (0.0, 1.0), (1.0, 0.0)][:n]
    return Pins(blocks.owner[vertex], blocks.vertices[vertex], np.array(direction))


def free_motions(held: Array, inertia: Array) -> tuple[Array, Array]:
    """Mass-orthogonal motions of a rigid block that comply with its pins.

    Parameters
    ----------
    held : (np, 3) float
        Displacements that the pins keep at zero, per translation along x and y and rotation about the centroid.
    inertia : (3,) float
        Mass of the block, twice, and its moment of inertia.

    Returns
    -------
    (3, 3) and (3,) float
        Motions as columns, zero columns if there are fewer than three; and their masses, inf for zero columns. With
        pins each motion has the block's own mass, and its coordinate is the root mean square displacement [m]. Without
        pins, or if they hold the rotation only, motions are the translations along x and y and the rotation themselves.
    """
    if not held[:, :2].any():
        turns = not held.any()
        return np.diag([1.0, 1.0, float(turns)]), np.array([*inertia[:2], inertia[2] if turns else np.inf])
    root = np.sqrt(inertia)
    free = complement(held / root)
    count = free.shape[1]
    motions, mass = np.zeros((3, 3)), np.full(3, np.inf)
    motions[:, :count] = free / root[:, None] * root[0]
    mass[:count] = inertia[0]
    return motions, mass
