"""Ties in the coordinates of a system: bars that pull with what they are stretched by, yield, and never push.

    t = min(max(k (e − e_p) + P, 0), t_y),    e = g · q

with the elongation e, its plastic part e_p, the stiffness k = E A / L, the preload P and the yield force t_y. A tie
that has yielded, or gone slack, pulls again from e_p on.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import ANCHOR, Array, Mask, Ties, Unsigned

STIFFNESS, YIELD, PRELOAD = range(3)
"""Columns of `TieRows.constants`."""


class TieRows(NamedTuple):
    """Ties: how far modes stretch each, and what it answers."""

    start: Unsigned  # (nt + 1,) first entry of each, then their number
    freedom: Unsigned  # (n,) coordinates that stretch a tie
    share: Array  # (n,) elongation per such coordinate
    constants: Array  # (nt, 3) stiffness [N/m], yield force and preload [N]

    def __len__(self) -> int:
        return len(self.constants)

    @property
    def slack(self) -> Array:
        """Elongation of each that takes its preload away, ``(nt,)`` [m]."""
        return np.asarray(self.constants[:, PRELOAD] / self.constants[:, STIFFNESS])

    def elongation(self, motion: Array) -> Array:
        """Elongation of each tie in a motion ``(nd,)``, ``(nt,)`` [m]."""
        return np.array([self.share[entries] @ motion[self.freedom[entries]] for entries in self._entries()])

    def force(self, motion: Array, stretch: Array) -> Array:
        """Force in each tie after a motion ``(nd,)`` and a plastic elongation ``(nt,)``, ``(nt,)`` [N]."""
        k, most, preload = self.constants.T
        return np.asarray(np.clip(k * (self.elongation(motion) - stretch) + preload, 0.0, most))

    def stored(self, force: Array) -> float:
        """Energy that forces ``(nt,)`` [N] store, beyond what the preloads did [J]."""
        k, _, preload = self.constants.T
        return float(((force**2 - preload**2) / (2 * k)).sum())

    def frequency_squared(self, joints: float, mass: Array) -> float:
        """Bound of ω² [1/s²] with ties, from that of the joints alone and the masses of the modes ``(nd,)``.

        At the ratio r of the two frequencies viscous forces, lagged by a shorter step, count r times: the smallest r
        with r² − r ≥ t, the ω² of the ties on their own in that of the joints, makes up for both.
        """
        if not len(self):
            return joints
        rows = np.zeros((len(self), len(mass)))
        for row, entries in zip(rows, self._entries(), strict=True):
            row[self.freedom[entries]] = self.share[entries]
        root = np.sqrt(self.constants[:, [STIFFNESS]]) * rows / np.sqrt(mass)
        own = float(np.linalg.eigvalsh(root @ root.T)[-1])
        return joints * ((1 + math.sqrt(1 + 4 * own / joints)) / 2) ** 2

    def _entries(self) -> list[slice]:
        return [slice(int(a), int(b)) for a, b in zip(self.start, self.start[1:], strict=False)]


def tie_rows(ties: Ties, moves: Mask, row: Callable[[int, Array, Array], Array]) -> TieRows:
    """The ties of a scene, from which blocks move ``(nb,)`` and a ``row(block, at, direction)`` of those that do.

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


NO_TIE_ROWS = TieRows(np.zeros(1, np.uint64), np.zeros(0, np.uint64), np.zeros(0), np.zeros((0, 3)))


@compiled.kernel
def pull(ties: tuple[Unsigned, Unsigned, Array, Array, Array], motion: Array, force: Array) -> None:
    """Add what ties do to modal forces ``(nd,)``; their plastic elongation, the last of the arrays, is kept."""
    start, freedom, share, constants, stretch = ties
    for k in range(stretch.size):
        stiffness, most, preload = constants[k, 0], constants[k, 1], constants[k, 2]
        elongation = 0.0
        for i in range(start[k], start[k + 1]):
            elongation += share[i] * motion[freedom[i]]
        tension = stiffness * (elongation - stretch[k]) + preload
        if tension > most:
            stretch[k] += (tension - most) / stiffness
            tension = most
        if tension > 0.0:
            for i in range(start[k], start[k + 1]):
                force[freedom[i]] -= tension * share[i]
