"""Rigid blocks on beds of springs, which lean on soft joints before the mechanism of stiff ones turns."""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from runningbond.compare import published_scene
from runningbond.compare.advice.knowledge import Knowledge
from runningbond.limit import limit
from runningbond.models import MODELS
from runningbond.models.beds import Lost, _climb, on_beds
from runningbond.models.edges import leaning, rolls
from runningbond.results import Outcome
from runningbond.scene import Array, Scene, scene_from_dict
from tests.beds import stack_on_beds
from tests.walls import courses

WIDTH, HEIGHT, THICKNESS, WEIGHT = 0.5, 4.0, 0.3, 2000.0 * 9.81  # of a pier, and the weight of its stone


def on_a_plinth(plinth: float, stiffness: float, **changes: Any) -> Scene:
    """A pier on a stiff bed, on a plinth of a given width, as high as the pier is wide, on a soft bed."""
    left = (plinth - WIDTH) / 2
    boxes = [(0.0, 0.0, plinth, WIDTH), (left, WIDTH, WIDTH, HEIGHT)]
    outlines = [[[x, y], [x + w, y], [x + w, y + h], [x, y + h]] for x, y, w, h in boxes]
    tables = {
        "wall": {"outlines": outlines, "thickness": THICKNESS},
        "block": {"density": 2000.0},
        "joint": {"friction": 2.0, "normal_stiffness": stiffness, "shear_stiffness": 0.4 * stiffness},
        "joints": {"stiff": {"friction": 2.0, "normal_stiffness": 1e13, "shear_stiffness": 4e12}},
        "assign": [{"joint": "stiff", "box": [[0.0, WIDTH - 0.01], [plinth, WIDTH + 0.01]]}],
        "support": {"kind": "base"},
        "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
    }
    return scene_from_dict(tables | changes)


def as_it_leans(plinth: float, stiffness: float) -> float:
    """Largest λ of the two blocks if the upper bed is rigid: the plinth leans, and the pier upon it may turn."""
    low, high = WEIGHT * THICKNESS * plinth * WIDTH, WEIGHT * THICKNESS * WIDTH * HEIGHT
    turned, spring, both = np.geomspace(1e-6, 0.1, 100_000), stiffness * THICKNESS, low + high
    closed = spring * plinth**3 / 12 * turned
    cracked = both * (plinth / 2 - np.sqrt(2 * both / (9 * spring * turned)))
    lever = low * WIDTH / 2 + high * (WIDTH + HEIGHT / 2)
    leans = np.where(closed < both * plinth / 6, closed, cracked) / lever - turned
    return float(np.minimum(leans, WIDTH / HEIGHT - turned).max())


@pytest.mark.parametrize(("plinth", "stiffness"), [(0.57, 1e10), (0.6, 1e9), (0.6, 1e10), (1.0, 1e8)])
def test_soft_bed_outside_the_mechanism_leans(plinth: float, stiffness: float) -> None:
    scene, exact = on_a_plinth(plinth, stiffness), as_it_leans(plinth, stiffness)
    found = on_beds(scene, WIDTH / HEIGHT)
    assert found is not None
    assert found.load == pytest.approx(exact, rel=0.015)
    assert on_beds(scene, 0.98 * exact) is None
    leans = leaning(scene, limit(scene))  # of the pier alone
    assert leans is not None
    assert leans.load > 0.99 * WIDTH / HEIGHT


@pytest.mark.parametrize(("share", "rests"), [(0.97, False), (1.03, True)])
def test_wall_on_a_bed_too_soft_for_its_weight_falls_under_it(share: float, rests: bool) -> None:
    """As in buckling: its weight turns the wall further than its bed turns it back. The answer of `advise` was .125."""
    plinth = 0.6
    low, high = WEIGHT * THICKNESS * plinth * WIDTH, WEIGHT * THICKNESS * WIDTH * HEIGHT
    enough = (low * WIDTH / 2 + high * (WIDTH + HEIGHT / 2)) / (THICKNESS * plinth**3 / 12)
    scene = on_a_plinth(plinth, share * enough)
    found = on_beds(scene, WIDTH / HEIGHT)
    assert found is not None
    assert (found.load > 0) == rests
    assert found.load < 0.05 * WIDTH / HEIGHT
    assert ("falls under its dead load" in str(found)) != rests
    known = Knowledge(scene, 0.05)
    known.learn(MODELS["limit"], limit(scene))
    assert known.on_edges is not None
    assert (known.on_edges.load > 0) == rests


@pytest.mark.parametrize(("rows", "stiffness"), [(4, 1e9), (8, 1e9), (8, 1e10), (12, 1e9)])
def test_stack_on_beds(rows: int, stiffness: float) -> None:
    joint = {"friction": 0.8, "normal_stiffness": stiffness, "shear_stiffness": 0.4 * stiffness}
    scene = courses([[1]] * rows, 0.5, 0.5, joint=joint)
    exact = stack_on_beds(rows, 0.5, 0.5, float(scene.mass[0]) * 9.81, 0.12 * stiffness, 0.12 * 0.4 * stiffness)
    found = on_beds(scene, 1 / rows)
    assert found is not None
    assert found.load == pytest.approx(exact, rel=0.01)


def block_on_closing_bed(width: float, height: float, weight: float, curve: tuple[float, float, float]) -> float:
    """Largest λ of a block on a bed whose stiffness [N/m²] grows, by integration of its pressures."""
    first, growth, last = curve
    end = np.log(last / first) / growth
    along = width * (np.arange(4000) + 0.5) / 4000 - width / 2

    def pressures(middle: float, turn: float) -> Array:
        closed = np.maximum(middle + turn * along, 0.0)
        below = np.minimum(closed, end)
        return np.asarray(first / growth * np.expm1(growth * below) + last * (closed - below)) * width / 4000

    def leans(turn: float) -> float:
        out = width / 2 * turn
        middle = brentq(lambda middle: pressures(middle, turn).sum() - weight, -out, out + weight / (first * width))
        return float(pressures(middle, turn) @ along) / (weight * height / 2) - turn

    return max(leans(turn) for turn in np.geomspace(1e-4, 0.2, 400))


@pytest.mark.parametrize("stiffest", [1e8, 1e10])
def test_closed_bed_is_stiffer(stiffest: float) -> None:
    """A block of 0.4 × 1 m; on a bed of its first stiffness alone it would bear less."""
    closure = {"growth": 5000.0, "stiffest": stiffest}
    joint = {"friction": 2.0, "normal_stiffness": 2e7, "shear_stiffness": 1e9, "closure": closure}
    scene = courses([[1]], 0.4, 1.0, joint=joint)
    curve = 2e7 * 0.12, 5000.0, stiffest * 0.12
    exact = block_on_closing_bed(0.4, 1.0, float(scene.mass[0]) * 9.81, curve)
    found = on_beds(scene, 0.4)
    assert found is not None
    assert found.load == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize("scale", [0.01, 100.0])
def test_scaled_wall_leans_alike(scale: float) -> None:
    """Rotations do not depend on the size of a wall; they were compared with it."""

    def sized(scale: float) -> Scene:
        joint = {"friction": 0.8, "normal_stiffness": 3e7 / scale, "shear_stiffness": 1.2e7 / scale}
        return courses([[1]] * 3, 0.5 * scale, 0.5 * scale, joint=joint, block__density=1800.0 / scale)

    one, other = (on_beds(sized(each), 1 / 3) for each in (1.0, scale))
    assert one is not None
    assert other is not None
    assert other.load == pytest.approx(one.load, rel=1e-6)
    assert other.moved == pytest.approx(scale * one.moved, rel=1e-4)


@pytest.mark.parametrize("share", [0.97, 1.03])
def test_block_on_bed_falls_under_dead_load_above_it(share: float) -> None:
    """If P h + W h/2 is larger than the stiffness of the closed bed, k t b³/12. There was no answer to that."""
    width, height, stiffness = 0.5, 2.0, 1e8
    joint = {"friction": 2.0, "normal_stiffness": stiffness, "shear_stiffness": 1e12}
    scene = courses([[1]], width, height, joint=joint)
    above = share * stiffness * 0.12 * width**3 / 12 / height - float(scene.mass[0]) * 9.81 / 2
    load = {"kind": "line", "from": [0.0, height], "to": [width, height], "force": [0.0, -above / width]}
    found = on_beds(courses([[1]], width, height, joint=joint, load__dead=[load]), 1e-3)
    assert (found is not None) == (share > 1)
    if found is not None:
        assert found.load == 0
        assert str(found) == "as it leans it falls under its dead load"
    note = rolls(
        courses([[1]], width, height, joint=joint, load__dead=[load]),
        Outcome("", "dem-dynamic", "collapse", 0.01),
        0.01,
    )
    assert ("it falls under its dead load" in note) == (share > 1)


def test_wall_that_a_long_step_passes_by_rests() -> None:
    """Sought from its rest under the dead load alone, it was said to bear 9 % less than 11.4."""
    size = {"length": 0.9405, "height": 1.284, "block_width": 0.3135, "block_height": 0.321, "thickness": 0.25}
    above = {"kind": "line", "from": [0.0, 1.284], "to": [0.9405, 1.284], "force": [0.0, -190000.0]}
    tables = {
        "wall": size,
        "block": {"density": 2000.0},
        "joint": {"friction": 1.0, "normal_stiffness": 1.7e8, "shear_stiffness": 6.8e7},
        "support": {"kind": "base"},
        "load": {"gravity": 9.81, "live": {"kind": "lateral"}, "dead": [above]},
    }
    assert on_beds(scene_from_dict(tables), 11.4) is None


@pytest.mark.parametrize(("stiff", "found"), [(1e15, True), (1e18, False)])
def test_wall_that_is_lost_is_not_said_to_fall(stiff: float, found: bool) -> None:
    """With a bed 10⁹ times as stiff as the other one, a load near zero was the largest."""
    joints = {"stiff": {"friction": 2.0, "normal_stiffness": stiff, "shear_stiffness": 0.4 * stiff}}
    leans = on_beds(on_a_plinth(0.6, 1e9, joints=joints), 0.9 * WIDTH / HEIGHT)
    assert (leans is not None) == found
    if leans is not None:
        assert leans.load == pytest.approx(as_it_leans(0.6, 1e9), rel=0.015)


@pytest.mark.parametrize("borne", [0.1, 0.7, 0.999])
def test_climb_ends_below_the_load_under_which_a_wall_falls(borne: float) -> None:
    def rest(load: float, motion: Array, step: float = 0.3) -> Array | None:
        """Under loads up to `borne`, and sought from motions up to a step before them."""
        return motion + load - motion[0] if load <= min(borne, motion[0] + step) else None

    reached, motion = _climb(rest, 1.0, np.zeros(1))
    assert reached == motion[0]
    assert borne - 1 / 128 < reached <= borne


def test_climb_is_lost_if_its_shortest_step_is() -> None:
    def rest(load: float, motion: Array) -> Array:
        if load > 0.5:
            raise Lost
        return motion

    with pytest.raises(Lost):
        _climb(rest, 1.0, np.zeros(1))


def test_mirrored_wall_leans_alike() -> None:
    left = {"gravity": 9.81, "live": {"kind": "lateral", "direction": "left"}}
    one, other = (on_beds(on_a_plinth(0.6, 1e9, **changes), 0.125) for changes in ({}, {"load": left}))
    assert one is not None
    assert other is not None
    assert other == pytest.approx(one, rel=1e-6)


@pytest.mark.parametrize(("name", "lowest"), [("panel-02", 0.4771), ("panel-09", 0.4208), ("wall-w3", 0.3558)])
def test_walls_on_stiff_joints_rest(name: str, lowest: float) -> None:
    """Just below the lowest certified loads, which assume rigid joints."""
    assert on_beds(published_scene(name), 0.995 * lowest) is None


def test_wall_with_held_motions_or_rigid_joints_is_not_judged() -> None:
    joint = {"joint": {"friction": 0.8, "normal_stiffness": 1e8, "shear_stiffness": 4e7}}
    assert on_beds(courses([[1]] * 8, 0.5, 0.5, **joint), 0.125) is not None
    assert on_beds(courses([[1]] * 8, 0.5, 0.5, support={"kind": "pinned-corners"}, **joint), 0.125) is None
    assert on_beds(courses([[1]] * 8, 0.5, 0.5), 0.125) is None


TIED_AT, FAR = 3.0, 40.0  # height and length of a level tie [m], so long that it stays level


@pytest.mark.parametrize(
    ("stiffness", "pulls", "preload"),  # N per metre that the pier moves where it is tied, and shares of its weight
    [(1e9, 1e5, 0.0), (1e9, 1e6, 0.0), (1e9, 1e8, 0.0), (1e9, 1e5, 0.05), (1e9, 1e6, 0.1), (1e10, 1e6, 0.05)],
)
def test_tied_pier_leans_as_its_bed_and_its_tie_give_way(stiffness: float, pulls: float, preload: float) -> None:
    """A pier on a bed of springs; the tie at its side yields at a tenth of its weight."""
    weight, spring = WEIGHT * THICKNESS * WIDTH * HEIGHT, stiffness * THICKNESS
    bar = {"area": 1e-4, "young": pulls * FAR / 1e-4, "yield": 0.1 * weight, "preload": preload * weight}
    tables: dict[str, Any] = {
        "wall": {"outlines": [[[0, 0], [WIDTH, 0], [WIDTH, HEIGHT], [0, HEIGHT]]], "thickness": THICKNESS},
        "block": {"density": 2000.0},
        "joint": {"friction": 2.0, "normal_stiffness": stiffness, "shear_stiffness": 1e13},
        "tie": [{"from": [-FAR, TIED_AT], "to": [0.0, TIED_AT]} | bar],
        "support": {"kind": "base"},
        "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
    }
    scene = scene_from_dict(tables)
    turned = np.geomspace(1e-6, 0.3, 100_000)
    closed = spring * WIDTH**3 / 12 * turned
    cracked = weight * (WIDTH / 2 - np.sqrt(2 * weight / (9 * spring * turned)))
    righting = np.where(closed < weight * WIDTH / 6, closed, cracked)
    tied = np.minimum(0.1, preload + pulls * TIED_AT * turned / weight) * weight * TIED_AT
    exact = float(((righting + tied) / (weight * HEIGHT / 2) - turned).max())
    yields = (WIDTH / 2 + 0.1 * TIED_AT) / (HEIGHT / 2)
    assert limit(scene).multiplier == pytest.approx(yields, rel=1e-6)
    found = on_beds(scene, yields)
    assert found is not None
    assert found.load == pytest.approx(exact, rel=0.01)
    assert found.load < 0.97 * yields
    assert on_beds(scene, 0.98 * exact) is None


def test_ties_between_blocks_turn_with_them() -> None:
    """Two piers, each on its bed, of which one is pushed and drags the other along by a slanting tie of a few newtons.

    Mirrored, or with the ends of the tie interchanged, they bear the same.
    """
    found = []
    for mirrored in (False, True):
        sense = -1.0 if mirrored else 1.0
        piers = [[[x, 0], [x + 0.5, 0], [x + 0.5, 4], [x, 4]] for x in (-1.5, 1.0)]
        for ends in ([-1.0, 3.5], [1.0, 2.0]), ([1.0, 2.0], [-1.0, 3.5]):
            first, second = ([sense * x, y] for x, y in ends)
            tables: dict[str, Any] = {
                "wall": {"outlines": piers, "thickness": THICKNESS},
                "block": {"density": 2000.0},
                "joint": {"friction": 2.0, "normal_stiffness": 1e9, "shear_stiffness": 4e8},
                "tie": [{"from": first, "to": second, "area": 1e-4, "young": 1e10, "yield": 500.0}],
                "support": {"kind": "base"},
                "load": {
                    "gravity": 9.81,
                    "live": {"kind": "point", "at": [sense * 1.25, 2.0], "force": [sense, 0.0]},
                },
            }
            leans = on_beds(scene_from_dict(tables), 5000.0)
            assert leans is not None
            found.append(leans.load)
    assert found == pytest.approx(found[:1] * 4, rel=1e-6)


def test_load_is_not_advised_as_proved_where_soft_joints_lean() -> None:
    scene = on_a_plinth(0.6, 1e9)
    for tolerance, leans in ((0.05, True), (0.15, False)):
        known = Knowledge(scene, tolerance)
        known.learn(MODELS["limit"], limit(scene))
        assert known.evidence == "proof"
        assert (known.on_edges is not None) == leans


def test_push_with_points_at_the_ends_of_joints_tells_what_soft_ones_bear() -> None:
    """The mechanism of the stiff bed loses little."""
    scene = on_a_plinth(0.6, 1e9)
    note = rolls(scene, Outcome("", "dem-dynamic", "collapse", 0.125, 0.125, 0.125), 0.01)
    assert "it bears about 0.11" in note
    assert "or less if joints slide" in note
    assert rolls(scene, Outcome("", "dem-dynamic", "collapse", 0.125, 0.125, 0.125), 0.15) == ""
