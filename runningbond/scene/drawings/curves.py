"""Curves of a drawing and the chords that replace them; outlines that share an arc get the same chords."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array

SAGITTA = 5e-4
"""Largest sagitta of a chord, relative to the radius, and also to the length of the arc between two corners."""

ROUNDING = 1e-7
"""Distance, in sizes of the drawing, below which points coincide: for 10 m the sixth decimal in metres."""

TURN = 2 * np.pi


@dataclass(frozen=True, eq=False)
class Arc:
    """Part of a circle or ellipse: points centre + cos t · axes[0] + sin t · axes[1].

    Parameters
    ----------
    centre : (2,) float
    axes : (2, 2) float
        Conjugate semi-axes, the second to the left of the first.
    start, sweep
        Parameter t of the first point, and its change up to the last one; a negative sweep is clockwise [rad].
    """

    centre: Array
    axes: Array
    start: float
    sweep: float

    @classmethod
    def along(cls, centre: Array, axes: Array, start: float, sweep: float) -> "Arc":
        """Create an arc from axes of which the second may also lie to the right of the first."""
        if axes[0, 0] * axes[1, 1] < axes[0, 1] * axes[1, 0]:
            axes, start, sweep = np.array([axes[0], -axes[1]]), -start, -sweep
        return cls(centre, axes, start, sweep)

    @classmethod
    def from_bulge(cls, p: Array, q: Array, bulge: float) -> "Arc":
        """Create the arc from p to q with the angle 4 atan(bulge), counter-clockwise for a positive bulge."""
        x, y = q - p
        centre = (p + q) / 2 + (1 - bulge**2) / (4 * bulge) * np.array([-y, x])
        radius = np.hypot(x, y) * (1 + bulge**2) / (4 * abs(bulge))
        start = float(np.arctan2(*(p - centre)[::-1]))
        return cls(centre, radius * np.eye(2), start, 4 * float(np.arctan(bulge)))

    @property
    def closed(self) -> bool:
        """Whether the arc is a full circle or ellipse."""
        return abs(self.sweep) > TURN * (1 - 1e-12)

    @cached_property
    def radius(self) -> float:
        """Longer of the two semi-axes."""
        return float(np.hypot(*self.axes.T).max())

    def at(self, t: Any) -> Array:
        """Points ``(n, 2)`` at parameters t."""
        t = np.atleast_1d(t)[:, None]
        points: Array = self.centre + np.cos(t) * self.axes[0] + np.sin(t) * self.axes[1]
        return points

    @property
    def ends(self) -> Array:
        """First and last point, ``(2, 2)``."""
        return self.at([self.start, self.start + self.sweep])

    @property
    def samples(self) -> Array:
        """Five points from the first to the last, at equal steps of t, ``(5, 2)``."""
        return self.at(self.start + self.sweep * np.linspace(0, 1, 5))

    def parameters(self, points: Array) -> tuple[Array, Array]:
        """Parameters of points ``(n, 2)`` in [0, 2π), and distances from the full curve (upper bounds for ellipses)."""
        x, y = np.linalg.solve(self.axes.T, (points - self.centre).T)
        return np.mod(np.arctan2(y, x), TURN), np.abs(np.hypot(x, y) - 1) * self.radius


class Chords:
    """Chords for all arcs of one drawing.

    Arcs on the same circle or ellipse share one curve, which is cut at every corner of the drawing that lies on it, and
    into equal parts between these. Outlines along the same part of it thus get the same chords, in either direction.

    Parameters
    ----------
    arcs
        All arcs of the drawing.
    corners : (n, 2) float
        All corners and ends of curves in the drawing.
    tolerance
        Distance up to which a corner counts as on an arc.
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
        """The curve that an arc is a part of, with the parameters and positions of its corners."""
        n = len(self._curves)
        apart = (arc.samples - self._centre[:n]) @ self._inverse[:n]
        off = np.abs(np.hypot(*np.moveaxis(apart, 2, 0)) - self._scale[:n]).max(axis=1, initial=0.0)
        on = np.flatnonzero(off <= 1)
        return self._curves[on[0]] if len(on) else None

    def cut(self, arc: Arc) -> Array:
        """Ends of the chords of an arc, from its first point to its last, ``(n, 2)``."""
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
    """Number of chords for an angle [rad] between two corners, rounded up with a tolerance of 1e-6."""
    by_radius, by_length = angle / (2 * np.arccos(1 - SAGITTA)), np.sqrt(angle / (8 * SAGITTA))
    return max(1, int(np.ceil(max(by_radius, by_length) - 1e-6)))


def spline_points(spline: Any) -> Array:
    """Points ``(n, 3)`` on an ezdxf B-spline, equally many (at most 512) per knot span, dense enough for `SAGITTA`."""
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
