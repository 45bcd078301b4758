"""Loads at points of blocks: forces, forces along a line, moments."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import shapely

from .actions import Action, nonzero_vector, same_for, unit_vector
from .arrays import Array, Indices
from .errors import SceneError
from .forces import Arrow, Forces
from .ranges import Range, vector
from .table import Table

if TYPE_CHECKING:
    from .scene import Scene

NO_CUTS = np.zeros(0)
"""No further cuts, as shares of a line."""

STEEP = 10
"""Rise of an edge across a line, in contact tolerances, above which the edge crosses the line even if it ends on it."""


@dataclass(frozen=True)
class PointLoad(Action):
    """A force [N] at a point [m], shared equally by the movable blocks that touch it."""

    at: tuple[float, float]
    force: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "at", vector("load.live.at", self.at))
        object.__setattr__(self, "force", nonzero_vector("load.live.force", self.force))

    def blocks(self, scene: "Scene") -> Indices:
        """Movable blocks that share the load, ``(n,)``."""
        touching = scene.blocks.containing(np.array(self.at))
        return touching[~scene.fixed[touching]]

    def forces(self, scene: "Scene") -> Forces:
        """An equal share of the force on each block."""
        block = self.blocks(scene)
        return Forces.on(scene, block=block, at=self.at, force=np.array(self.force) / max(1, len(block)))

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a point that touches no movable block; the error names the nearest point that does."""
        if len(self.blocks(scene)) == 0:
            blocks, movable = scene.blocks, np.flatnonzero(~scene.fixed)
            (x0, y0), (x1, y1) = blocks.extent(scene.wall)
            x0, x1, y0, y1 = (blocks.coordinate(float(value)) for value in (x0, x1, y0, y1))
            point, shapes = shapely.Point(self.at), blocks.shapes(movable)
            nearest = int(shapely.distance(shapes, point).argmin())
            there = shapely.get_coordinates(shapely.shortest_line(shapes[nearest], point))[0]
            near = f"the nearest is block {movable[nearest]} at {blocks.place(there, digits=6)}"
            what = f"touches no block that can move; {near}, and the wall spans x {x0} … {x1} m, y {y0} … {y1} m"
            raise SceneError(f"{key}.at", what, list(self.at))


@dataclass(frozen=True)
class LineLoad(Action):
    """A force per length [N/m] along a straight line [m], carried by the movable blocks that the line runs along.

    Between two blocks the load acts on the block that it presses on: floors laid into a wall load the course below.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    force: tuple[float, float]

    def __post_init__(self) -> None:
        for name, key in (("start", "from"), ("end", "to")):
            object.__setattr__(self, name, vector(f"load.live.{key}", getattr(self, name)))
        object.__setattr__(self, "force", nonzero_vector("load.live.force", self.force))
        if self.start == self.end:
            raise SceneError("load.live.to", "must lie apart from the line's other end", list(self.end))

    @classmethod
    def read(cls, table: Table) -> "LineLoad":
        """Read the load from a table with two ends and a force per length."""
        return cls(table.vector("from"), table.vector("to"), table.vector("force"))

    def parts(self, scene: "Scene", cuts: Array = NO_CUTS) -> tuple[Indices, Array]:
        """Movable blocks that carry the load ``(n,)``, and the part of the line on each, as shares of it ``(n, 2)``.

        The line is cut where blocks begin and end, and additionally at `cuts` ``(k,)``, shares of the line.
        """
        return self._each_part_once(scene, *self._along(scene), cuts)

    def _along(self, scene: "Scene") -> tuple[Indices, Array]:
        """Movable blocks that the line runs along or through ``(n,)``, from and to which share of it ``(n, 2)``."""
        length, blocks = self._length, scene.blocks
        line = shapely.LineString([self.start, self.end])
        low, high = blocks.boxes
        reach = blocks.tolerance
        near = (high >= np.minimum(self.start, self.end) - reach) & (low <= np.maximum(self.start, self.end) + reach)
        close = np.flatnonzero(near.all(axis=1) & ~scene.fixed)
        common = shapely.intersection(shapely.buffer(blocks.shapes(close), reach), line)
        pieces, of = shapely.get_parts(common, return_index=True)
        at, piece = shapely.get_coordinates(pieces, return_index=True)
        share = np.column_stack([np.full(len(pieces), np.inf), np.full(len(pieces), -np.inf)])
        place, _ = self._beside(at)
        np.minimum.at(share[:, 0], piece, place)
        np.maximum.at(share[:, 1], piece, place)
        long = share[:, 1] - share[:, 0] > 3 * reach / length
        return close[of[long]], self._met_in_crossings(scene, close[of[long]], share[long])

    @property
    def _length(self) -> float:
        return float(np.hypot(*np.subtract(self.end, self.start)))

    def _beside(self, points: Array) -> tuple[Array, Array]:
        """Position of points ``(…, 2)`` along the line, as shares of it, and distance to its left [m], two ``(…)``."""
        (x, y), from_start = np.subtract(self.end, self.start), points - np.array(self.start)
        return np.asarray(from_start @ [x, y] / self._length**2), np.asarray(from_start @ [-y, x] / self._length)

    def _met_in_crossings(self, scene: "Scene", owner: Indices, share: Array) -> Array:
        """Trim the blocks' shares of the line to corners and to the joints that the line crosses, ``(n, 2)``.

        Blocks reach beyond their outlines by the contact tolerance, so at a joint the shares of two blocks overlap: the
        more, the flatter the joint crosses the line.
        """
        crossings = [self._crossings(scene, *one) for one in zip(owner, share, strict=True)]
        into, out = np.array(crossings).reshape(-1, 2).T
        reach = scene.blocks.tolerance / self._length
        first_reaches = (share[:, :1] <= into) & (into <= share[:, 1:])
        second_reaches = (share[:, 0] <= out[:, None]) & (out[:, None] <= share[:, 1])
        left, entered = np.nonzero(first_reaches & second_reaches & (owner[:, None] != owner))
        # If the line lies in a joint, a block on one side may begin in the middle of a block on the other side.
        beyond = (share[left, 1] - out[left]) + (into[entered] - share[entered, 0]) + 3 * reach
        is_one = np.abs(out[left] - into[entered]) <= beyond
        left, entered = left[is_one], entered[is_one]
        met = np.array([self._to_corners(scene, *one) for one in zip(owner, share, strict=True)]).reshape(-1, 2)
        met[left, 1] = met[entered, 0] = (out[left] + into[entered]) / 2
        return met

    def _to_corners(self, scene: "Scene", block: int, share: Array) -> tuple[float, float]:
        """A block's share of the line, trimmed by the contact tolerance to the corners that the line passes."""
        reach = scene.blocks.tolerance
        place, off = self._beside(scene.blocks.polygon(block))
        at = place[np.abs(off) <= reach]
        first, last = (at[np.abs(at - end) <= 3 * reach / self._length] for end in share)
        return max(min(first, default=-math.inf), share[0]), min(max(last, default=math.inf), share[1])

    def _crossings(self, scene: "Scene", block: int, share: Array) -> tuple[float, float]:
        """Positions at which the line enters and leaves a block, near the ends of the block's share; NaN if none.

        An edge is crossed if its ends lie on either side of the line, farther off than the contact tolerance. A steep
        edge also counts as crossed if one end lies on the line, even if the line only touches the block in this corner.
        """
        reach = scene.blocks.tolerance
        place, off = self._beside(scene.blocks.polygon(block))
        run, rise = (np.roll(each, -1) - each for each in (place, off))  # of each edge
        low, high = np.minimum(off, off + rise), np.maximum(off, off + rise)
        across = (low < -reach) & (high > reach)
        across |= (low <= reach) & (high >= -reach) & (high - low > STEEP * reach)
        place, off, run, rise = place[across], off[across], run[across], rise[across]
        at = place - off / rise * run
        # The block's share ends on its outline grown by the tolerance, with arcs at corners: allow for rounding errors.
        within = (1 + 1e-6) * reach * np.hypot(run, rise / self._length) / np.abs(rise)
        into = at[(rise < 0) & (np.abs(at - share[0]) <= within)]
        out = at[(rise > 0) & (np.abs(at - share[1]) <= within)]
        return max(into, default=math.nan), min(out, default=math.nan)

    def _each_part_once(self, scene: "Scene", owner: Indices, share: Array, cuts: Array) -> tuple[Indices, Array]:
        """Cut the line where blocks begin and end, and assign each part to one of the blocks there."""
        close = 3 * scene.blocks.tolerance / self._length
        cuts = np.unique(np.concatenate([[0.0, 1.0], share.ravel(), cuts]))
        # Shares of neighbours overlap by the contact tolerance: the cut is in the middle of the overlap.
        groups = np.split(cuts, np.flatnonzero(np.diff(cuts) > close) + 1)
        cuts = np.array([0.0, *(group.mean() for group in groups[1:-1]), 1.0])
        given: list[tuple[int, float, float]] = []
        for low, high in pairwise(cuts):
            here = owner[(share[:, 0] < (low + high) / 2) & (share[:, 1] > (low + high) / 2)]
            given.append((self._pressed(scene, here, low, high), float(low), float(high)))
        return np.array([part[0] for part in given]), np.array([part[1:] for part in given])

    def _pressed(self, scene: "Scene", blocks: Indices, low: float, high: float) -> int:
        """The block that the force presses on, among the blocks beside a part of the line."""
        if len(blocks) == 1:
            return int(blocks[0])
        at = np.array(self.start) + (low + high) / 2 * np.subtract(self.end, self.start)
        middle, way = scene.blocks.place(at), f"the line from there to {list(self.end)}"
        if len(blocks) == 0:
            what = f"{way} runs at {middle} along no block that can move"
            raise SceneError("load.live.from", what, list(self.start))
        run, force = np.subtract(self.end, self.start), np.array(self.force)
        normal = np.array([-run[1], run[0]]) / np.hypot(*run)
        across = float(normal @ force)
        ahead = at + 3 * scene.blocks.tolerance * np.sign(across) * normal
        within = np.isin(blocks, scene.blocks.containing(ahead))
        pressed = blocks[within & (abs(across) > 1e-6 * float(np.hypot(*force)))]
        if len(pressed) != 1:
            what = f"{way} is at {middle} on more than one block, and presses on neither alone; move it into one"
            raise SceneError("load.live.from", what, list(self.start))
        return int(pressed[0])

    def forces(self, scene: "Scene") -> Forces:
        """Two forces on each of the `parts`, at Gauss points: same resultant and same first two moments as the line."""
        return self._on(scene, *self.parts(scene))

    def forces_by_piece(self, scene: "Scene", edges: Array) -> Forces:
        """As `forces`, with the line additionally cut where it meets edges ``(n, 2, 2)`` [m].

        With elements of constant strain the displacement along each part is then linear, so that the two forces do the
        same work as the line load.
        """
        return self._on(scene, *self.parts(scene, self._met(edges, scene.blocks.tolerance)))

    def _met(self, edges: Array, reach: float) -> Array:
        """Shares of the line ``(k,)`` at which it crosses edges ``(n, 2, 2)`` [m] or ends of edges lie on it."""
        _, off = self._beside(edges)
        on, (low, high) = np.abs(off) <= reach, np.sort(off).T
        across = (low < -reach) & (high > reach)
        first, last = off[across].T
        at = edges[across, 0] + (first / (first - last))[:, None] * (edges[across, 1] - edges[across, 0])
        share, _ = self._beside(np.concatenate([edges[on], at]))
        return np.asarray(share[(share > 0) & (share < 1)])

    def _on(self, scene: "Scene", block: Indices, share: Array) -> Forces:
        run = np.subtract(self.end, self.start)
        width = np.diff(share, axis=1)
        at = (share.mean(axis=1)[:, None] + width * np.array([-0.5, 0.5]) / math.sqrt(3)).ravel()
        size = np.repeat(width.ravel() * self._length / 2, 2)
        return Forces.on(
            scene,
            block=np.repeat(block, 2),
            at=np.array(self.start) + at[:, None] * run,
            force=size[:, None] * np.array(self.force),
        )

    def arrows(self, scene: "Scene") -> tuple[Arrow, ...]:
        """A row of arrows along the line."""
        block, share = self.parts(scene)
        places = np.linspace(0.0, 1.0, 9)[1::2]
        of = block[np.minimum(np.searchsorted(share[:, 1], places), len(block) - 1)]
        tips = np.array(self.start) + places[:, None] * np.subtract(self.end, self.start)
        direction = unit_vector(np.array(self.force))
        return tuple(Arrow(direction, tip, np.array([one])) for tip, one in zip(tips, of, strict=True))

    def control(self, scene: "Scene") -> tuple[Indices, Array, Array]:
        """Middle of the line, on the block that carries the load there, or on both blocks if two meet there."""
        block, share = self.parts(scene)
        reach = scene.blocks.tolerance / self._length
        there = (share[:, 0] <= 0.5 + reach) & (share[:, 1] >= 0.5 - reach)
        middle = np.add(self.start, self.end) / 2
        return same_for(np.unique(block[there]), np.asarray(middle), unit_vector(np.array(self.force)))


@dataclass(frozen=True)
class Moment(Action):
    """A moment [N m], counter-clockwise, on the block that holds a point [m]."""

    at: tuple[float, float]
    moment: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "at", vector("load.live.at", self.at))
        object.__setattr__(self, "moment", Range().take("load.live.moment", self.moment))
        if not self.moment:
            raise SceneError("load.live.moment", "must not be zero", self.moment)

    @classmethod
    def read(cls, table: Table) -> "Moment":
        """Read the load from a table with a point and a moment."""
        return cls(table.vector("at"), table.number("moment", Range()))

    def forces(self, scene: "Scene") -> Forces:
        """The moment on the block that holds the point."""
        moment = np.zeros(len(scene.blocks))
        moment[self._blocks(scene)] = self.moment
        return Forces.on(scene, moment=moment)

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a point that is in no movable block, or on the joint between two."""
        if len(self._blocks(scene)) != 1:
            what = "must lie in one block that can move, and not on a joint"
            raise SceneError(f"{key}.at", what, list(self.at))

    def arrows(self, scene: "Scene") -> tuple[Arrow, ...]:
        """One arrow, on the side of the block that the moment moves down."""
        block = self._blocks(scene)
        low, high = scene.blocks.extent(int(block[0]))
        x = low[0] if self.moment > 0 else high[0]
        return (Arrow(np.array([0.0, -1.0]), np.array([x, high[1]]), block),)

    def control(self, scene: "Scene") -> tuple[Indices, Array, Array]:
        """The block's two corners farthest apart, as they move if it turns with the moment.

        Their mean displacement does not depend on the centre of rotation, which may be any single point.
        """
        block = self._blocks(scene)
        corners = scene.blocks.polygon(int(block[0]))
        apart = corners[:, None] - corners
        length = np.hypot(*apart.transpose(2, 0, 1))
        ends = np.array(np.unravel_index(length.argmax(), length.shape))
        x, y = unit_vector(corners[ends[0]] - corners[ends[1]]) * np.sign(self.moment)
        return np.repeat(block, 2), corners[ends], np.array([[-y, x], [y, -x]])

    def _blocks(self, scene: "Scene") -> Indices:
        touching = scene.blocks.containing(np.array(self.at))
        return touching[~scene.fixed[touching]]


@dataclass(frozen=True, eq=False)
class GivenForces(Action):
    """Forces as plain arrays: they replace user-defined loads in result files, and point loads on randomised walls."""

    given: Forces
    place: tuple[Indices, Array, Array] | None = None  # where displacements are read, as `control` returns it

    def forces(self, scene: "Scene") -> Forces:
        """These forces."""
        return self.given

    def control(self, scene: "Scene") -> tuple[Indices, Array, Array]:
        """Control point of the original load."""
        if self.place is None:
            return super().control(scene)
        # Results stored by earlier versions have one point and one direction for all blocks.
        return self.place if np.ndim(self.place[1]) == 2 else same_for(*self.place)
