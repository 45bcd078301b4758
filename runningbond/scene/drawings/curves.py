"""Curves of a drawing and the chords that stand for them: the same ones for all who draw along one arc."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array

SAGITTA = 5e-4
"""How far a chord may leave its arc, as a share of the radius and of the arc between two corners."""

ROUNDING = 1e-7
"""Distance, in sizes of the drawing, below which two points are one: what six decimals in metres leave of 10 m."""

TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Arc:
    """Part of a circle or ellipse: the points centre + cos t · axes[0] + sin t · axes[1].

    Parameters
    ----------
    centre : (2,) float
    axes : (2, 2) float
        Conjugate half axes, the second to the left of the first.
    start, sweep
        First parameter, and how far it runs from there, clockwise where negative [rad].
    """

    centre: Array
    axes: Array
    start: float
    sweep: float

    @classmethod
    def along(cls, centre: Array, axes: Array, start: float, sweep: float) -> "Arc":
        """An arc with axes of either sense."""
        if axes[0, 0] * axes[1, 1] < axes[0, 1] * axes[1, 0]:
            axes, start, sweep = np.array([axes[0], -axes[1]]), -start, -sweep
        return cls(centre, axes, start, sweep)

    @classmethod
    def from_bulge(cls, p: Array, q: Array, bulge: float) -> "Arc":
        """The arc from p to q whose angle is 4 atan(bulge), to the left of which its centre lies where that is > 0."""
        x, y = q - p
        centre = (p + q) / 2 + (1 - bulge**2) / (4 * bulge) * np.array([-y, x])
        radius = np.hypot(x, y) * (1 + bulge**2) / (4 * abs(bulge))
        start = float(np.arctan2(*(p - centre)[::-1]))
        return cls(centre, radius * np.eye(2), start, 4 * float(np.arctan(bulge)))

    @property
    def closed(self) -> bool:
        """Whether it runs all the way round."""
        return abs(self.sweep) > TURN * (1 - 1e-12)

    @cached_property
    def radius(self) -> float:
        """Larger half axis."""
        return float(np.hypot(*self.axes.T).max())

    def at(self, t: Any) -> Array:
        """Points at parameters, ``(n, 2)``."""
        t = np.atleast_1d(t)[:, None]
        points: Array = self.centre + np.cos(t) * self.axes[0] + np.sin(t) * self.axes[1]
        return points

    @property
    def ends(self) -> Array:
        """First and last point, ``(2, 2)``."""
        return self.at([self.start, self.start + self.sweep])

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Parameters of points ``(n, 2)`` in [0, 2π), and their distances from the whole curve, but for a factor."""
        x, y = np.linalg.solve(self.axes.T, (points - self.centre).T)
        return np.mod(np.arctan2(y, x), TURN), np.abs(np.hypot(x, y) - 1) * self.radius


class Chords:
    """Chords for the arcs of one drawing.

    A curve on which several arcs lie is cut at every drawn corner that touches it and evenly between two of these,
    so that whoever draws along a part of it, in either sense, gets the same chords there.

    Parameters
    ----------
    arcs
        All arcs of the drawing.
    corners : (n, 2) float
        All its corners and ends.
    tolerance
        Distance below which a corner lies on an arc.
    """

    def __init__(self, arcs: Sequence[Arc], corners: Array, tolerance: float) -> None:
        self.tolerance = tolerance
        self.number, self.sagitta = 0, 0.0
        self._curves: list[tuple[Arc, Array, Array]] = []
        self._centre, self._inverse = np.zeros((len(arcs), 1, 2)), np.zeros((len(arcs), 2, 2))
        self._scale = np.zeros((len(arcs), 1))
        for arc in arcs:
            if self._curve_under(arc) is None:
                new = len(self._curves)
                self._scale[new] = arc.radius / tolerance
                self._centre[new], self._inverse[new] = arc.centre, np.linalg.inv(arc.axes) * self._scale[new]
                t, off = arc.parameters(corners)
                on = np.flatnonzero(off <= tolerance)
                on = on[np.argsort(t[on], kind="stable")]
                fresh = np.diff(t[on], prepend=-1.0) * arc.radius > tolerance
                if fresh[1:].any() and (t[on][0] + TURN - t[on][-1]) * arc.radius <= tolerance:
                    fresh[0] = False
                on = on[fresh]
                self._curves.append((arc, t[on], corners[on]))

    def _curve_under(self, arc: Arc) -> tuple[Arc, Array, Array] | None:
        """The curve of which an arc is a part, with its corners' parameters and places."""
        n = len(self._curves)
        apart = (arc.at(arc.start + arc.sweep * np.linspace(0, 1, 5)) - self._centre[:n]) @ self._inverse[:n]
        off = np.abs(np.hypot(*np.moveaxis(apart, 2, 0)) - self._scale[:n]).max(axis=1, initial=0.0)
        on = np.flatnonzero(off <= 1)
        return self._curves[on[0]] if len(on) else None

    def cut(self, arc: Arc) -> Array:
        """Corners of the chords of an arc from its first point to its last, ``(n, 2)``."""
        under = self._curve_under(arc)
        assert under is not None
        curve, t, corners = under
        ends = arc.ends[:: 1 if arc.sweep > 0 else -1]
        if not len(t):
            t, corners = np.zeros(1), curve.at(0.0)
        first = curve.parameters(ends[:1])[0][0]
        if arc.closed:
            after, corners, first = np.append(t - t[0], TURN), np.vstack([corners, corners[:1]]), t[0]
        else:
            sweep, slack = abs(arc.sweep), self.tolerance / curve.radius
            after = np.mod(t - first, TURN)
            inside = np.flatnonzero((after > slack) & (after < sweep - slack))
            inside = inside[np.argsort(after[inside])]
            after = np.concatenate([[0.0], after[inside], [sweep]])
            corners = np.vstack([ends[:1], corners[inside], ends[1:]])
        points = [corners[:1]]
        for low, high, corner in zip(after, after[1:], corners[1:], strict=False):
            pieces = _pieces(float(high - low))
            points += [curve.at(first + np.linspace(low, high, pieces + 1)[1:-1]), corner[None]]
            self.number += pieces
            self.sagitta = max(self.sagitta, curve.radius * (1 - np.cos((high - low) / pieces / 2)))
        found = np.vstack(points)
        return found if arc.sweep > 0 else found[::-1]


def _pieces(angle: float) -> int:
    """Chords that an angle [rad] between two corners is cut into; a hair more than a whole number is that number."""
    by_radius, by_length = angle / (2 * np.arccos(1 - SAGITTA)), np.sqrt(angle / (8 * SAGITTA))
    return max(1, int(np.ceil(max(by_radius, by_length) - 1e-6)))


def spline_points(spline: Any) -> Array:
    """Points along an ezdxf B-spline, ``(n, 3)``, as many between all its knots, close enough for `SAGITTA`."""
    knots = np.array(spline.knots())
    knots = np.unique(np.clip(knots, knots[spline.order - 1], knots[-spline.order]))
    pieces = 2
    while True:
        t = np.interp(np.arange(2 * pieces * (len(knots) - 1) + 1) / (2 * pieces), np.arange(len(knots)), knots)
        points = np.array([(p.x, p.y, p.z) for p in spline.points(t)])
        off = np.hypot(*(points[1::2] - (points[:-1:2] + points[2::2]) / 2).T[:2])
        length = np.hypot(*np.diff(points, axis=0).T[:2]).sum()
        if pieces >= 512 or off.max() <= SAGITTA * length / max(1, len(knots) - 1):
            return np.asarray(points[::2])
        pieces *= 2
