"""Equilibrium equations in an order and orientation that do not depend on how a wall was drawn.

A degenerate linear program has many optimal vertices. Which of them a solver returns depends on the order of its rows
and on the last bits of its numbers. A search that starts from such vertices therefore gives the same result for a wall
and its mirror image only if both have the same numbers.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

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
    """Order the items of a wall, or of its mirror image if that comes first, by their rows in the tables of `_View`."""
    wall, image = _View(system, 1.0), _View(system, -1.0)
    for own, mirrored in zip(wall.tables(), image.tables(), strict=True):
        if own != mirrored:
            return wall.order() if own < mirrored else image.order()
    return wall.order()


class _View:
    """A wall, seen from the front or, with `side` −1, from behind: tables of its blocks, points, ties and pins."""

    def __init__(self, system: Equilibrium, side: float) -> None:
        self.system, self.scene, self.side = system, system.scene, side
        self.free = np.flatnonzero(~self.scene.fixed)
        self.unit = float(np.sqrt(self.scene.blocks.area[self.free].max()))
        spread = system.points.position if len(system.points) else self.scene.blocks.vertices
        self.corner = (side * spread[:, 0]).min(), spread[:, 1].min()

    def tables(self) -> Iterator[list[list[float]]]:
        """Tables with their rows in order; most walls differ from their mirror image in the first one already."""
        for table in (self.blocks, self.points, self.ties, *self.pins):
            yield table[_in_order(table)].tolist()

    @cached_property
    def blocks(self) -> Array:
        """Place and loads of each movable block, ``(n, 8)``."""
        n = len(self.free)
        loads = np.hstack([part[: 3 * n].reshape(n, 3) for part in (self.system.live, self.system.dead)])
        turned = np.round(loads * np.tile([self.side, 1.0, self.side], 2), PLACE_DECIMALS) + 0.0
        return np.hstack([self._places(self.scene.blocks.centroid[self.free]), turned])

    @cached_property
    def rank(self) -> Indices:
        """Place of each block in the order, ``(nb,)``; all fixed blocks come last, with one rank."""
        rank = np.full(len(self.scene.blocks), len(self.free))
        rank[self.free[_in_order(self.blocks)]] = np.arange(len(self.free))
        return rank

    @cached_property
    def points(self) -> Array:
        """Blocks, place, strength and normal of each point, ``(np, 9)``, and its jump if a support moves.

        Two joints of a block with fixed blocks may end at the same point.
        """
        points, strength = self.system.points, self.system.strength
        strengths = [_significant(part) for part in (strength.friction, strength.tension, strength.shear)]
        rank = self.rank[points.block]
        outwards = np.where(rank[:, :1] <= rank[:, 1:], self.side, -self.side)
        columns = [np.sort(rank, axis=1), self._places(points.position), np.column_stack(strengths)]
        columns += [np.round(outwards * points.normal * (1.0, self.side), PLACE_DECIMALS) + 0.0]
        if self.system.has_support:
            jumps = np.column_stack([part[[-1]].toarray()[0] for part in (self.system.opening, self.system.slip)])
            columns += [np.round(jumps * (1.0, self.side), PLACE_DECIMALS) + 0.0]
        return np.hstack(columns)

    @cached_property
    def ties(self) -> Array:
        """Ends and yield force of each tie, ``(nt, 7)``."""
        ends = self._places(self.scene.ties.ends.reshape(-1, 2)).reshape(-1, 4)
        middle = np.column_stack([ends[:, ::2].sum(axis=1), ends[:, 1::2].sum(axis=1)])
        return np.column_stack([middle, abs(ends), _significant(self.system.tie_yield)])

    @cached_property
    def pins(self) -> tuple[Array, Array]:
        """Block, place and direction of pins, of all loads and of the live load, ``(n, 5)`` each."""
        first, late = (
            np.column_stack([self.rank[pins.block], self._places(pins.point), np.abs(pins.direction)])
            for pins in (self.scene.pins, self.scene.late_pins)
        )
        return first, late

    def order(self) -> Order:
        """Order of the equations and unknowns."""
        side, n = self.side, len(self.free)
        blocks, rest = _in_order(self.blocks), np.arange(3 * n, self.system.freedoms)
        first, late = (_in_order(pins) for pins in self.pins)
        held = np.concatenate([first, len(first) + late])[: self.system.reaction.shape[1]]
        return Order(
            side,
            np.concatenate([(3 * blocks[:, None] + np.arange(3)).ravel(), rest]),
            _in_order(self.points),
            _in_order(self.ties),
            held.astype(np.int64),
            np.concatenate([np.tile([side, 1.0, side], n), np.ones(len(rest))]),
        )

    def _places(self, at: Array) -> Array:
        return np.asarray(np.round((at * (self.side, 1.0) - self.corner) / self.unit, PLACE_DECIMALS) + 0.0)


def _in_order(table: Array) -> Indices:
    """Row numbers of a table in lexicographic order of its rows."""
    return np.lexsort(table.T[::-1])
