"""Openings cut out of a bonded wall, and the blocks that remain."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
import shapely

from .arrays import Array
from .bond import LATTICE_TOLERANCE
from .errors import SceneError
from .openings import Opening
from .polygons import outer_corners, polygonal_parts

SLIVER = 0.25
"""Minimum length of a piece, in nominal block widths, and minimum height, relative to the height of its course."""

ROUNDING_MARGIN = 1 - 1e-6
"""Factor on minimum sizes that allows for rounding errors: a piece of just this size is accepted."""

Pieces: TypeAlias = dict[int, list[Any]]
"""Pieces of each block that was cut or took up a sliver, as Shapely polygons, by the number of the block."""


def cut_openings(
    polygons: Sequence[Array], openings: Sequence[Opening], width: float
) -> tuple[list[Array], dict[int, str]]:
    """Cut openings out of a bonded wall, and the space for their lintels, which become the wall's last blocks.

    Blocks are cut along the opening's sides: they become shorter, lower or L-shaped, or fall in two. No mason would lay
    a piece shorter than a quarter of the nominal block, so such a piece is merged with its neighbour in the course. If
    it has no neighbour, or if a piece is lower than a quarter of its course, the opening is refused; it should end at
    the joint instead. A side that is off a joint by no more than the lattice tolerance is moved onto it. An opening
    may end at the wall's side (a notch) or at its top, but not extend beyond. A lintel must lie entirely in the wall.

    Parameters
    ----------
    polygons : list of (4, 2) float
        Blocks, upright rectangles [m], course by course from the bottom, left to right.
    width
        Nominal width of the blocks [m].

    Returns
    -------
    list of (n, 2) float
        The remaining pieces of the blocks [m], in the order of the blocks, followed by the lintels.
    dict
        Materials of the lintels that name one, by block number.

    Raises
    ------
    SceneError
        For the cases above, for openings and lintels that overlap, that cut no block, or leave nothing of the wall.
    """
    wall = _Wall(np.array(polygons), width)
    holes = [wall.hole(opening.key, opening.low, opening.high) for opening in openings]
    beds, materials = [], []
    for opening, hole in zip(openings, holes, strict=True):
        if opening.lintel:
            reach, rise = opening.lintel.bearing, opening.lintel.height
            left, right, bottom = hole.low[0] - reach, hole.high[0] + reach, hole.high[1]
            beds.append(wall.hole(f"{opening.key}.lintel", (left, bottom), (right, bottom + rise)))
            materials.append(opening.lintel.material)
    wall.check([*holes, *beds])
    pieces = wall.pieces([*holes, *beds])
    left_over = [
        part
        for block, polygon in enumerate(polygons)
        for part in (map(outer_corners, pieces[block]) if block in pieces else [polygon])
    ]
    if not left_over:
        raise SceneError(openings[-1].key, "leaves nothing of the wall")
    named = {len(left_over) + k: name for k, name in enumerate(materials) if name is not None}
    return left_over + [bed.corners for bed in beds], named


@dataclass(frozen=True, eq=False)
class _Hole:
    """A rectangle to be cut out of the wall: its lower left and upper right corner ``(2,)`` [m]."""

    key: str
    low: Array
    high: Array

    @property
    def corners(self) -> Array:
        (x0, y0), (x1, y1) = self.low, self.high
        return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])

    @property
    def shape(self) -> Any:
        return shapely.box(*self.low, *self.high)

    def shared(self, low: Array, high: Array) -> Array:
        """Areas ``(n,)`` [m²] shared with rectangles, given by their lower and upper corners ``(n, 2)`` [m]."""
        return np.asarray(np.maximum(np.minimum(self.high, high) - np.maximum(self.low, low), 0.0).prod(axis=1))


@dataclass(frozen=True, eq=False)
class _Wall:
    """A bonded wall: the corners of its blocks ``(nb, 4, 2)`` [m] and their nominal width [m]."""

    corners: Array
    width: float

    @cached_property
    def low(self) -> Array:
        return np.asarray(self.corners.min(axis=1))

    @cached_property
    def high(self) -> Array:
        return np.asarray(self.corners.max(axis=1))

    @cached_property
    def rounding(self) -> float:
        return LATTICE_TOLERANCE * float((self.high - self.low).min())

    def hole(self, key: str, low: tuple[float, float], high: tuple[float, float]) -> _Hole:
        """A rectangle whose sides are moved onto the nearest joints if they are off them by rounding errors only."""
        lines = np.concatenate([self.low, self.high])
        snapped = []
        for corner in (low, high):
            nearest = lines[np.abs(lines - corner).argmin(axis=0), [0, 1]]
            snapped.append(np.where(np.abs(nearest - corner) <= self.rounding, nearest, corner))
        return _Hole(key, *snapped)

    def check(self, holes: list[_Hole]) -> None:
        """Refuse rectangles that leave the wall, cut no block or overlap, and lintels partly outside the blocks."""
        (x0, y0), (x1, y1) = low, high = self.low.min(axis=0), self.high.max(axis=0)
        spans = f"x {x0:.4g} … {x1:.4g} m, y {y0:.4g} … {y1:.4g} m"
        for k, hole in enumerate(holes):
            reach = np.round([hole.low, hole.high], 9).tolist()
            if (hole.low < low).any() or (hole.high > high).any():
                raise SceneError(hole.key, f"must not reach beyond the wall, which spans {spans}", reach)
            for other in holes[:k]:
                if hole.shared(other.low[None], other.high[None])[0] > self.rounding**2:
                    raise SceneError(hole.key, f"overlaps {other.key}; keep them apart", reach)
            inside, whole = hole.shared(self.low, self.high).sum(), float(np.prod(hole.high - hole.low))
            if inside <= self.rounding**2:
                raise SceneError(hole.key, f"cuts no block of the wall, which spans {spans}", reach)
            if hole.key.endswith(".lintel") and inside < ROUNDING_MARGIN * whole:
                raise SceneError(hole.key, "must lie whole in the wall; part of it is where there is no block", reach)

    def pieces(self, holes: list[_Hole]) -> Pieces:
        """Remaining pieces of the blocks that holes cut, with slivers merged into their neighbours."""
        cut = np.flatnonzero(sum(hole.shared(self.low, self.high) for hole in holes) > self.rounding**2)
        rest = shapely.difference(shapely.polygons(self.corners[cut]), shapely.union_all([h.shape for h in holes]))
        pieces: Pieces = {int(i): polygonal_parts(shape) for i, shape in zip(cut, rest, strict=True)}
        slivers = [(i, part) for i, parts in pieces.items() for part in parts if self._is_sliver(i, part)]
        for block, sliver in slivers:  # the list grows if merging two slivers makes another one
            if any(part is sliver for part in pieces[block]):
                neighbour, whole = self._join(pieces, block, sliver, holes)
                slivers += [(neighbour, whole)] * self._is_sliver(neighbour, whole)
        for block, parts in pieces.items():
            for part in parts:
                self._refuse(block, part, holes)
        return pieces

    def _is_sliver(self, block: int, part: Any) -> bool:
        left, _, right, _ = part.bounds
        whole = self.high[block, 0] - self.low[block, 0]
        return bool(right - left < ROUNDING_MARGIN * min(SLIVER * self.width, whole))

    def _join(self, pieces: Pieces, block: int, sliver: Any, holes: list[_Hole]) -> tuple[int, Any]:
        """Merge a sliver with the piece beside it that has the longest head joint with it; return block and union."""
        beside = [
            (shapely.length(shapely.intersection(sliver, other)), neighbour, other)
            for neighbour in (block - 1, block, block + 1)
            if 0 <= neighbour < len(self.low) and self.low[neighbour, 1] == self.low[block, 1]
            for other in pieces.get(neighbour, [shapely.Polygon(self.corners[neighbour])])
            if other is not sliver
        ]
        shared, neighbour, other = max(beside, key=lambda found: found[0], default=(0.0, block, sliver))
        if shared <= self.rounding:
            left, _, right, _ = sliver.bounds
            what = f"leaves a piece {right - left:.4g} m long of a block, and none beside it that it could be part of"
            raise SceneError(_beside(sliver, holes).key, f"{what}; move it, or let it end at the wall's side")
        pieces[block] = [part for part in pieces[block] if part is not sliver]
        own, whole = pieces.setdefault(neighbour, [other]), shapely.union(other, sliver)
        pieces[neighbour] = [whole if part is other else part for part in own]
        return neighbour, whole

    def _refuse(self, block: int, part: Any, holes: list[_Hole]) -> None:
        """Refuse a piece that is too low or has a hole in it."""
        low, high = self.low[block, 1], self.high[block, 1]
        _, bottom, _, top = part.bounds
        if len(part.interiors):
            raise SceneError(_beside(part, holes).key, "lies inside one block; let it reach a joint")
        if top - bottom < ROUNDING_MARGIN * SLIVER * (high - low):
            what = f"leaves a piece {top - bottom:.4g} m high of a course from y = {low:.6g} to {high:.6g} m"
            raise SceneError(_beside(part, holes).key, f"{what}; let it end at one of them, or leave a quarter")


def _beside(part: Any, holes: list[_Hole]) -> _Hole:
    """The hole nearest to a piece."""
    return min(holes, key=lambda hole: shapely.distance(hole.shape, part))
