"""Equilibrium equations in an order and orientation that do not depend on how a wall was drawn.

A degenerate linear program has many optimal vertices. Which of them a solver returns depends on the order of its rows
and on the last bits of its numbers. A search that starts from such vertices therefore gives the same result for a wall
and its mirror image only if both have the same numbers.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array, diags_array

from runningbond.joints import PointStrength
from runningbond.scene import Array, Indices, Scene

from .equilibrium import Equilibrium

PLACE_DECIMALS = 6
"""Decimals of positions (in block sizes) and loads (in largest loads) by which blocks are distinguished."""

ENTRY_DECIMALS = 10
"""Decimals to which entries of the equations are rounded."""


@dataclass(frozen=True, eq=False)
class Order:
    """A permutation of the equations and unknowns of an `Equilibrium`, for the wall or its mirror image.

    Parameters
    ----------
    side
        −1 for the wall's mirror image.
    rows, points, ties, reactions : int arrays
        Number in the original system of the equation, point, tie and reaction at each place.
    sign : (nd,) float
        Factor of each equation.
    """

    side: float
    rows: Indices
    points: Indices
    ties: Indices
    reactions: Indices
    sign: Array

    def applied(self, system: Equilibrium) -> Equilibrium:
        """Return the equations in this order, rounded; of their scene only the numbers of items remain valid."""
        turn = diags_array(self.sign)

        def ordered(matrix: csc_array, columns: Indices, sense: float = 1.0) -> csc_array:
            return rounded(csc_array(turn @ matrix[self.rows][:, columns]) * sense)

        strength = system.strength
        tension, shear = (_significant(part[self.points]) for part in (strength.tension, strength.shear))
        return replace(
            system,
            strength=PointStrength(_significant(strength.friction[self.points]), tension, shear),
            opening=ordered(system.opening, self.points),
            slip=ordered(system.slip, self.points, self.side),
            reaction=self._unit_reactions(system),
            tie=ordered(system.tie, self.ties),
            tie_yield=_significant(system.tie_yield[self.ties]),
            dead=np.round(self.sign * system.dead[self.rows], ENTRY_DECIMALS),
            live=np.round(self.sign * system.live[self.rows], ENTRY_DECIMALS),
            scale=system.scale[self.rows],
        )

    def _unit_reactions(self, system: Equilibrium) -> csc_array:
        """Reactions that do not show the size of the wall, nor whether it is mirrored.

        Those that only prevent a rotation are measured in forces on an arm of a block's size; those that may have
        either sense have the one in which their columns begin with a positive entry.
        """
        pins, late = system.scene.pins, system.scene.late_pins
        moves = np.abs(np.concatenate([pins.direction, late.direction])).max(axis=1)[self.reactions]
        size = float(np.sqrt(system.scene.blocks.area[~system.scene.fixed].max()))
        columns = csc_array(diags_array(self.sign) @ system.reaction[self.rows][:, self.reactions])
        columns = rounded(csc_array(columns @ diags_array(np.where(moves > 0, 1.0, size))))
        sense = np.sign(columns.data[columns.indptr[:-1]])
        columns.data *= np.repeat(np.where(self.reactions < len(pins), sense, 1.0), np.diff(columns.indptr))
        return columns

    def places(self, scene: Scene) -> Array:
        """Centroids of the movable blocks ``(n, 2)`` [m] in this order, mirrored if the order is."""
        free = np.flatnonzero(~scene.fixed)
        return np.asarray(scene.blocks.centroid[free[self.rows[: 3 * len(free) : 3] // 3]] * (self.side, 1.0))

    def restored(self, motion: Array) -> Array:
        """Convert a motion ``(nd,)`` of the ordered equations to one of the original equations."""
        own = np.empty_like(motion)
        own[self.rows] = self.sign * motion
        return own


def rounded(matrix: csc_array) -> csc_array:
    """Return a matrix of equations without the last bits of its entries."""
    entries = matrix.copy()
    entries.data = np.round(entries.data, ENTRY_DECIMALS)
    entries.eliminate_zeros()
    entries.sort_indices()
    return entries


def _significant(values: Array) -> Array:
    """Values of any magnitude, rounded to ten digits."""
    mantissa, exponent = np.frexp(values)
    return np.ldexp(np.round(mantissa, ENTRY_DECIMALS), exponent)


def canonical_order(system: Equilibrium) -> Order:
    """Order blocks by position and load, and mirror the wall if its mirror image comes first in that order."""
    scene, points = system.scene, system.points
    free = np.flatnonzero(~scene.fixed)
    unit, n = float(np.sqrt(scene.blocks.area[free].max())), len(free)
    spread = points.position if len(points) else scene.blocks.vertices
    loads = np.hstack([part[: 3 * n].reshape(n, 3) for part in (system.live, system.dead)])

    def places(at: Array, side: float) -> Array:
        corner = (side * spread[:, 0]).min(), spread[:, 1].min()
        return np.asarray(np.round((at * (side, 1.0) - corner) / unit, PLACE_DECIMALS) + 0.0)

    def table(side: float) -> Array:
        turned = np.round(loads * np.tile([side, 1.0, side], 2), PLACE_DECIMALS) + 0.0
        return np.hstack([places(scene.blocks.centroid[free], side), turned])

    def in_order(keys: Array) -> Indices:
        return np.lexsort(keys.T[::-1])

    def listed(side: float) -> list[list[float]]:
        rows = table(side)
        return [list(row) for row in rows[in_order(rows)]]

    side = min((1.0, -1.0), key=listed)
    blocks = in_order(table(side))
    rank = np.full(len(scene.blocks), n)
    rank[free[blocks]] = np.arange(n)
    rest = np.arange(3 * n, system.freedoms)
    pair = np.sort(rank[points.block], axis=1)
    ends = places(scene.ties.ends.reshape(-1, 2), side).reshape(-1, 4)
    ties = in_order(np.hstack([ends[:, ::2].sum(axis=1)[:, None], ends[:, 1::2].sum(axis=1)[:, None], abs(ends)]))
    pins = [
        in_order(np.column_stack([rank[each.block], places(each.point, side), np.abs(each.direction)]))
        for each in (scene.pins, scene.late_pins)
    ]
    # Two joints of a block with fixed blocks, which have one rank, may end at the same point.
    strength = system.strength
    strengths = np.column_stack([_significant(x) for x in (strength.friction, strength.tension, strength.shear)])
    outwards = np.where(rank[points.block[:, :1]] <= rank[points.block[:, 1:]], 1.0, -1.0)
    normals = np.round(outwards * points.normal * (side, 1.0), PLACE_DECIMALS) + 0.0
    held = np.concatenate([pins[0], len(pins[0]) + pins[1]])[: system.reaction.shape[1]]
    return Order(
        side,
        np.concatenate([(3 * blocks[:, None] + np.arange(3)).ravel(), rest]),
        in_order(np.hstack([pair, places(points.position, side), strengths, normals])),
        ties,
        held.astype(np.int64),
        np.concatenate([np.tile([side, 1.0, side], n), np.ones(len(rest))]),
    )
