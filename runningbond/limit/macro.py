"""Macro-blocks: blocks that move together are glued into one, which leaves fewer equations and joint points.

A mechanism of the glued wall is also a mechanism of the full wall, at the same load. Forces in the glued wall balance
each macro-block, but say nothing about forces inside it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import spsolve

from runningbond.joints import PointStrength
from runningbond.scene import Array, Indices, Mask
from runningbond.scene.arrays import components

from .canonical import ENTRY_DECIMALS, rounded
from .certificates import Certificate
from .equilibrium import Equilibrium

COST_EXPONENT = 1.5
"""Exponent of the degrees of freedom in the cost of a program."""


@dataclass(frozen=True, eq=False)
class Glued:
    """The equations of a glued wall, its motions ``(nd, 3 n_macro)`` as those of the full wall, and the points left."""

    system: Equilibrium
    motions: csc_array
    points: Indices

    @property
    def cost(self) -> float:
        """Cost of a program over the glued wall, in programs over the full wall."""
        return float((self.system.freedoms / self.motions.shape[0]) ** COST_EXPONENT)

    def certificate(self, whole: Certificate) -> Certificate:
        """Convert a certificate of the full wall, which must not move glued joints, to one of the glued wall."""
        least, most = (
            replace(each, pressure=each.pressure[self.points], tangential=each.tangential[self.points])
            for each in (whole.least, whole.most)
        )
        motion = spsolve(csc_array(self.motions.T @ self.motions), self.motions.T @ whole.motion)
        return Certificate(motion, least, most)


def still_points(system: Equilibrium, motion: Array, least: float) -> Mask:
    """Points ``(np,)`` whose jumps in a mechanism ``(nd,)`` are below a share of its largest motion."""
    jump = np.abs(system.jumps(motion)).max(axis=0)
    return np.asarray(jump < least * np.abs(motion).max(initial=0.0))


def glue(system: Equilibrium, place: Array, still: Mask) -> Glued:
    """Glue blocks between which all points, at least two, are still; equations are rounded as in `canonical`.

    Parameters
    ----------
    system
        Equations of a wall without moving supports.
    place : (n, 2) float
        Centroids of the movable blocks [m].
    still : (np,) bool
        Points without jumps.
    """
    first, second = sides(system)
    n = len(place)
    pair = first * (n + 1) + second
    _, which, size = np.unique(pair, return_inverse=True, return_counts=True)
    holds = ((np.bincount(which, still) == size) & (size > 1))[which]
    label = components(np.column_stack([first[holds], second[holds]]), n + 1)
    moving = label[:n] != label[n]
    _, macro = np.unique(label[:n][moving], return_inverse=True)
    motions = _motions(np.flatnonzero(moving), macro, place, system.scale)
    kept = np.flatnonzero(label[first] != label[second])
    strength = system.strength
    return Glued(
        replace(
            system,
            points=system.points.part(kept),
            strength=PointStrength(strength.friction[kept], strength.tension[kept], strength.shear[kept]),
            opening=rounded(csc_array(motions.T @ system.opening[:, kept])),
            slip=rounded(csc_array(motions.T @ system.slip[:, kept])),
            tie=rounded(csc_array(motions.T @ system.tie)),
            reaction=rounded(csc_array(motions.T @ system.reaction)),
            dead=np.round(motions.T @ system.dead, ENTRY_DECIMALS),
            live=np.round(motions.T @ system.live, ENTRY_DECIMALS),
        ),
        motions,
        kept,
    )


def freest(system: Equilibrium, place: Array, looseness: Array, levels: Sequence[float], freedoms: int) -> Glued | None:
    """Glue points with `looseness` below the lowest of descending `levels` that leaves 1 to `freedoms`; else None."""
    low, high, result = 0, len(levels), None
    while low < high:  # fewer glued points leave more degrees of freedom
        middle = (low + high) // 2
        glued = glue(system, place, looseness < levels[middle])
        if glued.system.freedoms <= freedoms:
            low, result = middle + 1, glued
        else:
            high = middle
    return result if result is not None and result.system.freedoms else None


def sides(system: Equilibrium) -> tuple[Indices, Indices]:
    """Indices among the n movable blocks of those on both sides of each point, ascending; n for a fixed block."""
    pattern = csc_array(abs(system.opening) + abs(system.slip))
    pattern.sort_indices()
    begin, end = pattern.indptr[:-1], pattern.indptr[1:]
    first, second = (np.asarray(pattern.indices[at] // 3, dtype=np.int64) for at in (begin, end - 1))
    return first, np.where(first == second, system.freedoms // 3, second)


def _motions(moving: Indices, macro: Indices, place: Array, scale: Array) -> csc_array:
    """Displacement of each macro-block's centre, and its rotation times its size, as scaled motions of the blocks."""
    members = np.bincount(macro)
    middle = np.column_stack([np.bincount(macro, place[moving, k]) / members for k in (0, 1)])
    arm = place[moving] - middle[macro]
    spread = np.sqrt(np.bincount(macro, (arm**2).sum(axis=1)) / members)
    ones, turn = np.ones(len(moving)), 1 / (spread + scale[0] / scale[2])[macro]
    rows = 3 * moving[:, None] + [0, 1, 0, 1, 2]
    columns = 3 * macro[:, None] + [0, 1, 2, 2, 2]
    values = np.column_stack([ones, ones, -turn * arm[:, 1], turn * arm[:, 0], turn]) / scale[rows]
    shape = len(scale), 3 * len(members)
    return csc_array(coo_array((values.ravel(), (rows.ravel(), columns.ravel())), shape=shape))
