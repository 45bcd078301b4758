"""Ties in the coordinates of a system: bars that pull in proportion to their elongation, yield, and never push.

    t = min(max(k (e − e_p) + P, 0), t_y),    e = g · q

with the elongation e, its plastic part e_p, the stiffness k = E A / L, the preload P and the yield force t_y. A tie
that has yielded, or gone slack, pulls again above e = e_p − P / k. At finite displacements e is the increase of the
distance between its ends from that of the undeformed wall, and it pulls along the line between them.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import ANCHOR, Array, Indices, Mask, Ties, Unsigned

from .body_points import NO_POINTS, BodyPoints, Points, arm_of, push_at

STIFFNESS, YIELD, PRELOAD = range(3)
"""Columns of `TieRows.constants`."""

STRAINED = 0.05
"""Strain up to which ties that have not yielded count in the time step: more than steel can take."""


class TieRows(NamedTuple):
    """Ties: how modes elongate each of them, and its force law."""

    start: Unsigned  # (nt + 1,) first entry of each, then the total number
    freedom: Unsigned  # (n,) coordinates that elongate a tie
    share: Array  # (n,) elongation per unit of such a coordinate
    constants: Array  # (nt, 3) stiffness [N/m], yield force and preload [N]
    ends: BodyPoints = NO_POINTS  # (2 nt,) at finite displacements: the first ends of all ties, then the second ends
    length: Array = np.zeros(0)  # (nt,) undeformed distance between the two ends [m]

    def __len__(self) -> int:
        return len(self.constants)

    @property
    def slack(self) -> Array:
        """Shortening of each tie that takes its preload away, ``(nt,)`` [m]."""
        return np.asarray(self.constants[:, PRELOAD] / self.constants[:, STIFFNESS])

    def elongation(self, motion: Array) -> Array:
        """Elongation of each tie in a motion ``(nd,)``, ``(nt,)`` [m]."""
        if len(self.length):
            return np.asarray(np.hypot(*self._spans(motion).T) - self.length)
        return np.array([self.share[entries] @ motion[self.freedom[entries]] for entries in self._entries()])

    def _spans(self, motion: Array) -> Array:
        """Vectors from the first end of each to the second, ``(nt, 2)`` [m]."""
        first, second = self.ends.places(motion).reshape(2, -1, 2)
        return np.asarray(second - first)

    def pulls(self, motion: Array, stretch: Array) -> Array:
        """Forces of ties on their ends at finite displacements, ``(2 nt, 2)`` [N]; arguments as in `force`."""
        span = self._spans(motion)
        pull = (self.force(motion, stretch) / np.hypot(*span.T))[:, None] * span
        return np.concatenate([pull, -pull])

    def force(self, motion: Array, stretch: Array) -> Array:
        """Force in each tie after a motion ``(nd,)`` and a plastic elongation ``(nt,)``, ``(nt,)`` [N]."""
        k, most, preload = self.constants.T
        return np.asarray(np.clip(k * (self.elongation(motion) - stretch) + preload, 0.0, most))

    def accelerations(self, mass: Array, reach: Array) -> Array:
        """Largest acceleration of points of the blocks at a tie's ends per newton in the tie, ``(nt,)`` [m/s²].

        From masses of the modes ``(nd,)`` and largest distances of blocks' points from their centroids ``(nb,)`` [m].
        """
        if not len(self.length):
            return np.zeros(0)
        rigid, arm, body = self.ends.rigid, np.hypot(*self.ends.arm.T), self.ends.body
        each = 1 / mass[rigid[:, 0]] + arm * reach[body] / mass[rigid[:, 2]]
        return np.asarray(each.reshape(2, -1).sum(axis=0))

    def stored(self, force: Array) -> float:
        """Energy stored by forces ``(nt,)`` [N], beyond the work of the preloads [J]."""
        k, _, preload = self.constants.T
        return float(((force**2 - preload**2) / (2 * k)).sum())

    def frequency_squared(self, joints: float, mass: Array) -> float:
        """Bound of ω² [1/s²] with ties, from the bound for joints alone and the masses of the modes ``(nd,)``.

        If the two frequencies have the ratio r, viscous forces, lagged by a shorter step, count r times: the smallest r
        with r² − r ≥ t, the ω² of ties alone relative to that of the joints, accounts for both.
        """
        if not len(self):
            return joints
        stiffness, rows = self.constants[:, STIFFNESS], np.zeros((len(self), len(mass)))
        if len(self.length):
            tension = np.minimum(self.constants[:, YIELD], STRAINED * stiffness * self.length)
            self._reaches(rows, tension / stiffness)
        else:
            for row, entries in zip(rows, self._entries(), strict=True):
                row[self.freedom[entries]] = self.share[entries]
        root = np.sqrt(stiffness)[:, None] * rows / np.sqrt(mass)
        own = float(np.linalg.eigvalsh(root @ root.T)[-1])
        return joints * ((1 + math.sqrt(1 + 4 * own / joints)) / 2) ** 2

    def _reaches(self, rows: Array, elongation: Array) -> None:
        """Add how far each coordinate moves the ends of each tie, whatever their rotation, to rows ``(nt, nd)``.

        Only one of the two translations counts, as a tie has one direction at a time. A tension T, with an elongation
        of at most `elongation` ``(nt,)`` [m], also turns a body as it pulls on an arm r, with a stiffness of T r.
        """
        rigid, _, arm, _, mode, shape, _ = self.ends
        tie, reach = np.tile(np.arange(len(self)), 2), np.hypot(*arm.T)
        np.add.at(rows, (tie, rigid[:, 0]), 1.0)
        np.add.at(rows, (tie, rigid[:, 2]), np.sqrt(reach * (reach + elongation[tie])))
        np.add.at(rows, (tie[self.ends.point], mode), np.hypot(*shape.T))

    def _entries(self) -> list[slice]:
        return [slice(int(a), int(b)) for a, b in zip(self.start, self.start[1:], strict=False)]


def tie_rows(ties: Ties, moves: Mask, row: Callable[[int, Array, Array], Array]) -> TieRows:
    """The ties of a scene, given which blocks move ``(nb,)`` and the ``row(block, at, direction)`` of moving blocks.

    The row ``(nd,)`` is the displacement of a point ``(2,)`` of a block along a direction ``(2,)``, per coordinate.
    """
    freedom, share = [], []
    for blocks, ends, along in zip(ties.block.tolist(), ties.ends, ties.direction, strict=True):
        sides = zip(blocks, ends, (-along, along), strict=True)
        total = np.sum([row(block, end, out) for block, end, out in sides if block != ANCHOR and moves[block]], axis=0)
        freedom.append(np.flatnonzero(total))
        share.append(total[freedom[-1]])
    start = np.cumsum([0, *map(len, share)]).astype(np.uint64)
    constants = np.column_stack([ties.stiffness, ties.yield_force, ties.preload])
    empty = np.zeros(0)
    freedoms = np.concatenate([empty, *freedom]).astype(np.uint64)
    return TieRows(start, freedoms, np.concatenate([empty, *share]), constants)


def turned_tie_rows(rows: TieRows, ties: Ties, points: Callable[[Indices, Array], BodyPoints]) -> TieRows:
    """The same ties at finite displacements; `points` returns points of blocks ``(n,)`` at positions ``(n, 2)`` [m]."""
    if not len(ties):
        return rows
    ends = points(ties.block.T.ravel(), ties.ends.swapaxes(0, 1).reshape(-1, 2))
    return TieRows(*rows[:4], ends, ties.length)


NO_TIE_ROWS = TieRows(np.zeros(1, np.uint64), np.zeros(0, np.uint64), np.zeros(0), np.zeros((0, 3)))


@compiled.kernel
def _tension(constants: Array, stretch: Array, k: int, elongation: float) -> float:
    """Force of a tie at an elongation [m]; its plastic elongation is updated."""
    stiffness, most, preload = constants[k, 0], constants[k, 1], constants[k, 2]
    tension = stiffness * (elongation - stretch[k]) + preload
    if tension > most:
        stretch[k] += (tension - most) / stiffness
        tension = most
    pulled: float = max(tension, 0.0)
    return pulled


@compiled.kernel
def _pull_turned(ends: Points, length: Array, constants: Array, stretch: Array, motion: Array, force: Array) -> None:
    rigid, centroid = ends[0], ends[1]
    for k in range(length.size):
        other = k + length.size
        one, two = arm_of(ends, k, motion), arm_of(ends, other, motion)
        dx = centroid[other, 0] + motion[rigid[other, 0]] + two[0] - centroid[k, 0] - motion[rigid[k, 0]] - one[0]
        dy = centroid[other, 1] + motion[rigid[other, 1]] + two[1] - centroid[k, 1] - motion[rigid[k, 1]] - one[1]
        distance = math.sqrt(dx * dx + dy * dy)
        tension = _tension(constants, stretch, k, distance - length[k])
        if tension > 0.0:
            fx, fy = tension * dx / distance, tension * dy / distance
            push_at(ends, k, one, (fx, fy), force)
            push_at(ends, other, two, (-fx, -fy), force)


@compiled.kernel
def pull(ties: tuple[Unsigned, Unsigned, Array, Array, Points, Array, Array], motion: Array, force: Array) -> None:
    """Add the forces of ties to modal forces ``(nd,)``; update their plastic elongation, the last of the arrays."""
    start, freedom, share, constants, ends, length, stretch = ties
    if length.size > 0:
        _pull_turned(ends, length, constants, stretch, motion, force)
        return
    for k in range(stretch.size):
        elongation = 0.0
        for i in range(start[k], start[k + 1]):
            elongation += share[i] * motion[freedom[i]]
        tension = _tension(constants, stretch, k, elongation)
        if tension > 0.0:
            for i in range(start[k], start[k + 1]):
                force[freedom[i]] -= tension * share[i]
