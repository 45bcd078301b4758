"""Arrows of loads, labelled with their sizes: live loads dark and multiplied by λ, dead loads blue."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from runningbond.scene import (
    Action,
    Array,
    Beam,
    BeamLoad,
    Body,
    History,
    Indices,
    Lateral,
    LineLoad,
    Moment,
    PointLoad,
    Settlement,
    Tilt,
)
from runningbond.scene.actions import unit_vector
from runningbond.scene.history import STANDARD_GRAVITY

from .captions import is_force
from .deformed_shape import DeformedShape
from .gravity import draw_gravity, draw_tilt
from .labels import Spot, text_size
from .line_load_rows import Row, chains_of, is_in_wall, row_of
from .quantities import millimetres, minus, readable, span, times_lambda
from .sketch import Sketch
from .style import DARK, DEAD, MOTION, TYPE

EARTH = (0.0, -9.81)

MAX_LABELS = 4
"""Number of forces of one load, or of line loads in a chain, up to which each one is labelled."""


class LoadDrawing:
    """Draws the loads of a wall into a sketch one after another, each clear of the previous ones."""

    def __init__(self, sketch: Sketch, shape: DeformedShape) -> None:
        self.sketch, self.shape, self.scene, self.a = sketch, shape, shape.scene, sketch.a
        self.low, self.high = self.scene.blocks.extent(self.scene.wall)
        ground = np.flatnonzero(~self.scene.wall)
        self.ground = shapely.union_all([shapely.Polygon(self.scene.blocks.polygon(int(k))) for k in ground])
        self.reach = 1e-6 * self.scene.size
        self.rows: list[Array] = []
        self.strips: list[shapely.Geometry] = []
        self.alone: list[Array] = []
        self.turns: list[tuple[Array, float]] = []
        self.pushes: dict[tuple[bool, float, float], list[str]] = {}
        load = shape.scene.load
        self.largest = {live: _largest(loads) for live, loads in ((False, load.dead), (True, load.live))}
        self.sizes = {
            live: self._sizes_along(loads, live=live) for live, loads in ((False, load.dead), (True, load.live))
        }

    def draw(self) -> None:
        """Draw all loads: along lines first, then at points, and on the whole wall last."""
        load = self.scene.load
        for live, given in ((False, load.dead), (True, load.live)):
            lines = [each for each in given if isinstance(each, LineLoad)]
            for chain in chains_of(lines, self.reach):
                self._draw_chain([lines[k] for k in chain], live=live)
        loads = [(action, False) for action in load.dead] + [(action, True) for action in load.live]
        order: tuple[Any, ...] = ((PointLoad, BeamLoad), Moment)
        ranks = [next((k for k, kinds in enumerate(order) if isinstance(one, kinds)), 2) for one, _ in loads]
        for k in np.argsort(ranks, kind="stable"):
            self._draw(*loads[k])
        for (live, x, y), texts in self.pushes.items():
            self._push(np.array([x, y]), "\n+ ".join(texts), *_look(live))
        if load.gravity != EARTH and any(load.gravity):
            draw_gravity(self.sketch, *self._around(), load.gravity)

    def _sizes_along(self, loads: Sequence[Action], *, live: bool) -> dict[int, str]:
        """Label of each line load by its `id`; a long chain of line loads gets one label with the range of its sizes.

        A fill on an arch is given like this, one load per stone. All loads are labelled if each label fits on its load.
        """
        lines = [each for each in loads if isinstance(each, LineLoad)]
        sizes = [math.hypot(*each.force) for each in lines]
        said = [times_lambda(readable(size, "N/m"), live=live) for size in sizes]
        for chain in chains_of(lines, self.reach):
            own = np.array(chain)
            if len(own) <= MAX_LABELS or all(self._has_room(lines[k], said[k]) for k in own):
                continue
            middles = np.array([np.add(lines[k].start, lines[k].end) / 2 for k in own])
            middle = own[np.hypot(*(middles - middles.mean(axis=0)).T).argmin()]
            whole = times_lambda(span([sizes[k] for k in own], "N/m"), live=live)
            for k in own:
                said[k] = whole if k == middle else ""
        return {id(each): text for each, text in zip(lines, said, strict=True)}

    def _has_room(self, load: LineLoad, text: str) -> bool:
        """Whether a text beside a line load is no longer than the load."""
        run, (width, height) = np.abs(np.subtract(load.end, load.start)), text_size(text, TYPE)
        beside = abs(load.force[0]) > abs(load.force[1])
        return bool(run[1] >= height * self.sketch.point if beside else run[0] >= width * self.sketch.point)

    def _draw(self, action: Action, live: bool) -> None:
        colour, name = _look(live)
        match action:
            case LineLoad():
                pass  # drawn with its chain
            case PointLoad():
                self._point(np.array(action.at), action.blocks(self.scene), action.force, live, colour, name)
            case BeamLoad():
                self._beam(action, live)
            case Moment():
                at = np.array(action.at)
                self._turn(
                    self.shape.drawn_at(at, self.scene.blocks.containing(at)[:1]), action.moment, live, colour, name
                )
            case Tilt():
                draw_tilt(self.sketch, self.low, self.high, action.direction)
            case Lateral():
                self._on_mass(np.array(action.direction), "weight", live)
            case Body():
                size = readable(math.hypot(*action.acceleration), "m/s²")
                self._on_mass(unit_vector(np.array(action.acceleration)), size, live)
            case History():
                size = f"{math.hypot(*action.peak) / STANDARD_GRAVITY:.3g} g\ninertia at the peak"
                self._on_mass(unit_vector(-action.peak), size, live)
            case Settlement():
                pass  # drawn with the support that it moves
            case _:
                self._own(action, live, colour, name)

    def _own(self, action: Action, live: bool, colour: str, name: str) -> None:
        """Draw a user-defined load by its arrows and the forces there; of many forces, only the sum is labelled."""
        forces = action.forces(self.scene)
        arrows = action.arrows(self.scene)
        tips = [(arrow, arrow.at) for arrow in arrows if arrow.at is not None]
        for arrow, at in tips:
            force = forces.force[(forces.at == at).all(axis=1)].sum(axis=0)
            if len(tips) <= MAX_LABELS:
                self._point(at, arrow.block, (float(force[0]), float(force[1])), live, colour, name)
                continue
            tip = self.shape.drawn_at(at, arrow.block)
            self.sketch.arrow(name, [tip - 1.5 * self.a * arrow.direction, tip], colour)
            self.rows.append(np.sort([tip - 1.5 * self.a * arrow.direction, tip], axis=0))
        if len(tips) > MAX_LABELS:
            arrow, at = tips[len(tips) // 2]
            total = f"Σ {readable(float(np.hypot(*forces.force.sum(axis=0))), 'N')}"
            spot = Spot(self.shape.drawn_at(at, arrow.block) - 1.5 * self.a * arrow.direction, _side(-arrow.direction))
            self.sketch.label(times_lambda(total, live=live), [spot], colour)
        for arrow in arrows[len(tips) :]:
            self._on_mass(arrow.direction, "forces on mass", live)
        turned = np.flatnonzero(forces.moment)
        for block in turned:
            said = "" if len(turned) <= MAX_LABELS else "Σ " if block == turned[0] else None
            moment = float(forces.moment.sum() if said else forces.moment[block])
            self._turn(self.scene.blocks.centroid[block], moment, live, colour, name, said)

    def _point(self, at: Array, block: Indices, force: tuple[float, float], live: bool, colour: str, name: str) -> None:
        size = self._size(force, live=live)
        direction = unit_vector(np.array(force))
        within = at + 0.02 * (self.scene.blocks.centroid[block].mean(axis=0) - at)  # all may be outside at a corner
        ahead, behind = (is_in_wall(self.scene, within + side * 0.5 * self.a * direction) for side in (1, -1))
        self._force(self.shape.drawn_at(at, block), direction, size, colour, name, pulls=behind and not ahead)

    def _size(self, force: tuple[float, float], *, live: bool) -> str:
        """Label of a point force; if λ is a force P, a multiple of P."""
        size = math.hypot(*force)
        if live and is_force(self.scene):
            return "P" if math.isclose(size, 1.0) else f"{minus(size)} P"
        return times_lambda(readable(size, "N"), live=live)

    def _force(
        self,
        tip: Array,
        direction: Array,
        text: str,
        colour: str,
        name: str,
        *,
        both: bool = False,
        pulls: bool = False,
    ) -> None:
        """Draw a labelled arrow to a point, or away from it if it pulls and would otherwise cross the wall."""
        a = self.a
        tip = tip + 2.2 * a * direction if pulls else tip
        tail = tip - 2.2 * a * direction
        for other in self.alone:
            run = other[1] - other[0]
            if np.hypot(*(other[1] - tip)) < 0.5 * a and run @ direction > 0.9 * np.hypot(*run):
                tip = other[0] - 0.2 * a * direction
                tail = tip - 2.2 * a * direction
        while any(_meet(np.array([tail, tail + 1.3 * a * direction]), box) for box in self.rows):
            tail = tail - 0.6 * a * direction
        self.alone.append(np.array([tail, tip]))
        self.sketch.arrow(name, [tail, tip], colour, both=both)
        across = np.array([-direction[1], direction[0]])
        beside = tail + 0.7 * a * direction
        sides = [-across, across] if across[0] < -0.1 else [across, -across]
        spots = [Spot(beside, _side(one)) for one in sides]
        end = Spot(tip, _side(direction)) if pulls else Spot(tail, _side(-direction))
        self.sketch.label(text, [*spots, end] if abs(direction[1]) > 0.5 else [end, *spots], colour)

    def _draw_chain(self, loads: Sequence[LineLoad], *, live: bool) -> None:
        """Draw rows of arrows that adjoin; outside the wall they are moved outwards together, clear of other rows."""
        rows = [row_of(load, self.shape, self.a, self.largest[live]) for load in loads]
        while any(row.outside and row.overlaps(other) for row in rows for other in self.strips):
            rows = [row.moved(0.5 * self.a) for row in rows]
        self.strips += [row.strip for row in rows]
        for load, row in zip(loads, rows, strict=True):
            self._draw_row(row, *_look(live), self.sizes[live][id(load)])

    def _draw_row(self, row: Row, colour: str, name: str, text: str) -> None:
        tails, tips = row.tails, row.tips
        both = np.concatenate([tails, tips])
        self.rows.append(np.array([both.min(axis=0), both.max(axis=0)]))
        for tail, tip in zip(tails, tips, strict=True):
            self.sketch.arrow(name, [tail, tip], colour)
        if not row.is_shear:
            self.sketch.line(name, tails, color=colour, lw=1.2, zorder=6)
        ends = sorted((tails[0], tails[-1]), key=lambda end: float(end[0]))
        if not text:
            return
        outer = max(tails, tips, key=lambda line: float(line.mean(axis=0) @ row.away))
        spots = [Spot(self._outside(outer, row.away, text), _side(row.away))]
        self.sketch.label(text, [*spots, Spot(ends[1], (1, 0.5)), Spot(ends[0], (-1, 0.5))], colour)

    def _outside(self, line: Array, away: Array, text: str) -> Array:
        """Point at the middle of a line ``(n, 2)`` [m], outside the part of it that lies beside a text.

        The mean of a line that a mechanism breaks lies on neither part.
        """
        across = np.abs(away[::-1])
        middle, size = line.mean(axis=0), np.array(text_size(text, TYPE)) * self.sketch.point
        aside = np.abs((line - middle) @ (away[::-1] * (-1, 1)))
        beside = aside <= max(aside.min(), float(size @ across) / 2)
        return np.asarray(middle + ((line - middle) @ away)[beside].max() * away)

    def _beam(self, load: BeamLoad, live: bool) -> None:
        """Draw a force on the beam, up to its edge; a prescribed displacement has the colour of motions."""
        beam = self.scene.beam
        assert beam is not None
        forces = load.forces(self.scene)
        at, number = forces.at[0], forces.block
        direction = unit_vector(np.array(load.force))
        low, high = self.scene.blocks.extent(int(number[0]))
        half, middle = (high - low) / 2, (low + high) / 2
        reach = min(half[k] / abs(direction[k]) for k in (0, 1) if abs(direction[k]) > 1e-9)
        tip = middle - reach * direction
        if load.height is not None and abs(direction[0]) > 0.5:
            tip[1] = at[1]
        text, colour, name, both = self._drive_text(beam, load, live)
        if not low[1] <= at[1] <= high[1]:
            aside = np.array([-math.copysign(1.2 * self.a, direction[0]), 0.0])
            shoulder, tip = np.array([tip[0], middle[1]]), tip + aside
            arm = [self.shape.drawn_at(each, number) for each in (shoulder, shoulder + aside, tip)]
            self.sketch.line("beam", arm, lw=1.8)
            if not self.shape.displacement.any():  # a moved beam is no longer at this height
                self._height(tip, at[1] - self.low[1], -math.copysign(1.0, direction[0]))
        drawn = self.shape.drawn_at(tip, number)
        if beam.force_line == "fixed" and not live:  # the point moves with the beam, but along the line only
            drawn = tip + (drawn - tip) @ direction * direction
        self._force(drawn, direction, text, colour, name, both=both)

    def _height(self, at: Array, height: float, side: float) -> None:
        """Draw the height of a point above the base of the wall as a dimension line."""
        foot = np.array([at[0], at[1] - height])
        self.sketch.line("dimension", [foot, at], lw=0.5)
        for end in (foot, at):
            self.sketch.line("dimension", [end - 0.25 * self.a, end + 0.25 * self.a], lw=0.7)
        middle = (foot + at) / 2
        spots = [Spot(middle, (one, 0.0), upright=True) for one in (side, -side)]
        self.sketch.label(f"{minus(height)} m", spots)

    def _drive_text(self, beam: Beam, load: BeamLoad, live: bool) -> tuple[str, str, str, bool]:
        path = beam.drive.path if beam.drive and live else ()
        if not path:
            return self._size(load.force, live=live), *_look(live), False
        if len(path) == 1:
            return f"u = {millimetres(path[0])}", MOTION, "motion", False
        low, high = min(path), max(path)
        span = f"±{millimetres(high)}" if low == -high else f"{minus(1e3 * low)} … {millimetres(high)}"
        moves = int(np.count_nonzero(np.diff([0.0, *path])))
        return f"u = {span}\n{moves} moves", MOTION, "motion", True

    def _turn(self, at: Array, moment: float, live: bool, colour: str, name: str, said: str | None = "") -> None:
        """Draw a moment's arrow around others at the same point; its label begins with `said`, None for no label."""
        a = self.a
        about_it = [radius for other, radius in self.turns if np.hypot(*(other - at)) < 0.5 * a]
        radius = max(about_it, default=0.3 * a) + 0.6 * a
        self.turns.append((at, radius))
        self.sketch.turn(name, at, radius, colour, clockwise=moment < 0)
        if said is None:
            return
        text = times_lambda(said + readable(abs(moment), "N m"), live=live)
        sides = [(0.0, 1.0), (1.0, 0.0), (-1.0, 0.0), (0.0, -1.0)]
        self.sketch.label(text, [Spot(at + radius * np.array(side), side) for side in sides], colour)

    def _on_mass(self, direction: Array, size: str, live: bool) -> None:
        """Register a load on the mass of all blocks; loads in the same direction share their arrows."""
        x, y = np.round(direction, 6).tolist()
        self.pushes.setdefault((live, x, y), []).append(times_lambda(size, live=live))

    def _around(self) -> tuple[Array, Array]:
        """Corners of the box around the wall and its displaced blocks."""
        placed = self.shape.placed
        return np.minimum(self.low, placed.min(axis=0)), np.maximum(self.high, placed.max(axis=0))

    def _push(self, direction: Array, text: str, colour: str, name: str) -> None:
        """Draw a labelled row of arrows along the side that is pushed, clear of the displaced blocks."""
        a, (low, high) = self.a, self._around()
        flat = abs(direction[0]) >= abs(direction[1])
        inwards = np.array([np.sign(direction[0]), 0.0] if flat else [0.0, np.sign(direction[1])])
        across = np.abs(inwards[::-1])
        reach, width = float((high - low) @ np.abs(inwards)) / 2, float((high - low) @ across) / 2
        n = int(np.clip(width / (0.6 * a), 2, 5))
        places = width * np.linspace(-0.8, 0.8, n) if n > 2 else np.array([-0.4, 0.4]) * width
        tips = (low + high) / 2 - (reach + 0.7 * a) * inwards + places[:, None] * across
        ends = np.concatenate([tips - 1.5 * a * direction, tips])
        taken = [*self.rows, *self.sketch.taken()]
        while any(_meet(ends, box) for box in taken):
            ends = ends - 0.6 * a * inwards
        self.rows.append(np.array([ends.min(axis=0), ends.max(axis=0)]))
        tails, tips = ends[: len(places)], ends[len(places) :]
        outside = [
            not shapely.intersects(self.ground, shapely.LineString(ends)) for ends in zip(tails, tips, strict=True)
        ]
        if any(outside):
            tails, tips = tails[outside], tips[outside]
        for tail, tip in zip(tails, tips, strict=True):
            self.sketch.arrow(name, [tail, tip], colour)
        highest = max(tails, key=lambda tail: float(tail[1])) + 0.3 * a * direction
        beside = Spot(tails.mean(axis=0), _side(-inwards), upright=flat)
        above = Spot(highest, (float(-np.sign(direction[0])) if flat else 0.0, 1.0))
        length = max(map(len, text.split("\n"))) * 4 * self.sketch.point
        self.sketch.label(text, [beside, above] if not flat or 2.5 * width > length else [above, beside], colour)


def _look(live: bool) -> tuple[str, str]:
    """Colour and name of live or dead loads."""
    return (DARK, "live load") if live else (DEAD, "dead load")


def _largest(loads: Sequence[Action]) -> float:
    """Largest line load [N/m]; 0 if there is none."""
    return max((math.hypot(*each.force) for each in loads if isinstance(each, LineLoad)), default=0.0)


def _side(direction: Array) -> tuple[float, float]:
    """Side of a point to which a direction leads, one of eight."""
    x, y = np.rint(1.2 * unit_vector(direction) / np.abs(unit_vector(direction)).max())
    return float(np.clip(x, -1, 1)), float(np.clip(y, -1, 1))


def _meet(points: Array, box: Array) -> bool:
    """Whether the bounding box of points ``(n, 2)`` overlaps another box ``(2, 2)`` [m]."""
    sides = np.minimum(points.max(axis=0), box[1]) - np.maximum(points.min(axis=0), box[0])
    slack = 1e-9 * np.abs(box).max()
    return bool((sides > -slack).all() and sides.max() > slack)
