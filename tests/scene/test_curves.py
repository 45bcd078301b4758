"""Arcs of drawings and the chords that replace them."""

import math

import numpy as np
import pytest
import shapely
from ezdxf.math import BSpline

from runningbond.scene import Array
from runningbond.scene.drawings.curves import SAGITTA, TURN, Arc, Chords, spline_points

SHARES = np.linspace(0.0, 1.0, 7)


def circle(start: float, sweep: float, radius: float = 2.0) -> Arc:
    return Arc(np.array([1.0, -1.0]), radius * np.eye(2), start, sweep)


def angles(points: Array) -> Array:
    """Angles of points about the centre of `circle`, without jumps of 2π."""
    return np.unwrap(np.arctan2(*(points - [1.0, -1.0]).T[::-1]))


@pytest.mark.parametrize("axes", [[[2.0, 1.0], [-0.5, 1.5]], [[2.0, 1.0], [0.5, -1.5]]])
@pytest.mark.parametrize("sweep", [0.7, -2.0])
def test_arc_keeps_its_points_if_its_axes_are_mirrored(axes: list[list[float]], sweep: float) -> None:
    """The second axis of a mirrored arc is to the right of the first; `Arc.along` makes the axes right-handed."""
    centre, (along, up) = np.array([3.0, -1.0]), np.array(axes)
    arc = Arc.along(centre, np.array(axes), 0.4, sweep)
    t = 0.4 + sweep * SHARES[:, None]
    assert arc.at(arc.start + arc.sweep * SHARES) == pytest.approx(centre + np.cos(t) * along + np.sin(t) * up)
    assert np.linalg.det(arc.axes) > 0


@pytest.mark.parametrize("bulge", [1.0, math.tan(math.pi / 8), -0.3, -2.0])
def test_bulge_is_the_tangent_of_a_quarter_of_the_angle(bulge: float) -> None:
    """The arc from p to q passes its chord's midpoint at half the chord length times the bulge, to the right."""
    p, q = np.array([1.0, 1.0]), np.array([4.0, 5.0])
    arc = Arc.from_bulge(p, q, bulge)
    assert arc.sweep == pytest.approx(4 * math.atan(bulge))
    first, middle, last = arc.at(arc.start + arc.sweep * np.array([0.0, 0.5, 1.0]))
    assert first == pytest.approx(p)
    assert last == pytest.approx(q)
    assert middle == pytest.approx((p + q) / 2 + bulge * 2.5 * np.array([0.8, -0.6]))


@pytest.mark.parametrize("angle", [1e-4, 0.01, 0.5, 1.0, 2.0, 6.0])
def test_arc_has_the_fewest_chords_that_meet_the_sagitta(angle: float) -> None:
    """Relative to the radius or the length, whichever is less; `Chords` records the largest sagitta."""
    arc, ends = circle(0.3, angle), circle(0.3, angle).ends
    chords = Chords([arc], ends, 1e-9)
    points = chords.cut(arc)
    assert angles(points) == pytest.approx(0.3 + np.linspace(0.0, angle, len(points)))

    def off(number: int) -> float:
        return 2.0 * (1 - math.cos(angle / number / 2))

    allowed = SAGITTA * 2.0 * min(1.0, angle)
    assert chords.number == len(points) - 1
    assert chords.sagitta == pytest.approx(off(chords.number), rel=1e-4)
    assert off(chords.number) <= allowed * (1 + 1e-4)
    assert chords.number == 1 or off(chords.number - 1) > allowed


def test_overlapping_arcs_of_opposite_sense_share_their_chords() -> None:
    """The common curve is cut once at every corner of the drawing that lies on it."""
    to, fro = circle(0.0, 2.0), circle(2.5, -1.5)
    corner = circle(0.0, 1.3).ends[1]
    near = corner + [3e-7, 0.0]
    chords = Chords([to, fro], np.vstack([to.ends, fro.ends, corner, near]), 1e-6)
    there, back = angles(chords.cut(to)), angles(chords.cut(fro))
    assert (np.diff(there) > 1e-3).all()
    assert (np.diff(back) < -1e-3).all()
    both = there[(there > 0.999) & (there < 2.001)]
    assert back[(back > 0.999) & (back < 2.001)][::-1] == pytest.approx(both, abs=1e-6)
    for at in (1.0, 1.3, 2.0):
        assert np.abs(both - at).min() < 1e-6


def test_arc_across_angle_zero_is_cut_in_order() -> None:
    arc = circle(5.5, 2.0)
    corners = [circle(0.0, at).ends[1] for at in (0.5, 6.0, 0.1)]
    found = angles(Chords([arc], np.vstack([arc.ends, *corners]), 1e-6).cut(arc))
    assert found - found[0] + 5.5 == pytest.approx(np.sort(found - found[0] + 5.5))
    for at in (6.0, 0.1 + TURN, 0.5 + TURN):
        assert np.abs(found - found[0] + 5.5 - at).min() < 1e-9


def spline(knots: list[float] | None = None) -> BSpline:
    control = [(0, 0), (1, 3), (3, -2), (4, 1), (6, 1), (7, 4), (9, 0)]
    return BSpline([(x, y, 0) for x, y in control], order=4, knots=knots)


def test_spline_chords_meet_the_sagitta_of_one_knot_span() -> None:
    """Relative to the mean length of the spans, which keeps splines with many knots as fine as those with few."""
    drawn, points = spline(), spline_points(spline())[:, :2]
    way = np.array([(p.x, p.y) for p in drawn.points(np.linspace(0.0, max(drawn.knots()), 4001))])
    off = shapely.distance(shapely.points(way), shapely.LineString(points)).max()
    length = float(np.hypot(*np.diff(way, axis=0).T).sum())
    assert off <= SAGITTA * length / 4  # of four spans
    assert points[[0, -1]] == pytest.approx(np.array([[0, 0], [9, 0]]))


def test_unclamped_spline_begins_and_ends_within_its_valid_knots() -> None:
    """With uniform knots it begins at 1/6 of the first, 4/6 of the second and 1/6 of the third control point."""
    points = spline_points(spline([float(k) for k in range(11)]))[:, :2]
    assert points[0] == pytest.approx((np.array([0, 0]) + 4 * np.array([1, 3]) + np.array([3, -2])) / 6)
    assert points[-1] == pytest.approx((np.array([6, 1]) + 4 * np.array([7, 4]) + np.array([9, 0])) / 6)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_full_circle_is_cut_at_every_corner_on_it(sense: float) -> None:
    on = [circle(0.0, at).ends[1] for at in (4.0, 1.0, 6.2)]
    whole = circle(3.0, sense * TURN)
    points = Chords([whole], np.vstack([*on, [9.0, 9.0]]), 1e-6).cut(whole)
    found = angles(points)
    assert found[-1] - found[0] == pytest.approx(sense * TURN)
    assert (np.diff(found) * sense > 0.01).all()
    for at in (1.0, 4.0, 6.2):
        assert np.abs(np.mod(found - at + 1, TURN) - 1).min() < 1e-9


def test_corners_just_above_and_below_angle_zero_are_merged() -> None:
    """At angles of ±1e-8."""
    whole = circle(0.0, TURN)
    corners = np.vstack([whole.at([1e-8, -1e-8]), whole.at(2.0)])
    points = Chords([whole], corners, 1e-6).cut(whole)
    assert np.hypot(*np.diff(points, axis=0).T).min() > 1e-3
