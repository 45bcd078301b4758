"""Gaps and overlaps of a drawing: closed with `wall.heal`, reported without it."""

import math
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from runningbond.scene import Array, Blocks, SceneError, find_joints
from runningbond.scene.drawings import healing, read_drawing
from runningbond.scene.drawings.healing import heal, missed_joints

from .drafting import BRICKS, GROUND, Outline, box, closed, dxf, multiplier, scene_of


def metres(outlines: list[Outline]) -> list[Array]:
    return [np.array(outline) / 1e3 for outline in outlines]


def sloppy(outlines: list[Array], reach: float, seed: int) -> list[Array]:
    """Outlines with corners moved randomly by up to 0.35 `reach` per axis; corners that met stay within `reach`."""
    rng = np.random.default_rng(seed)
    return [outline + rng.uniform(-0.35, 0.35, outline.shape) * reach for outline in outlines]


def touching(outlines: list[Array]) -> int:
    return len(find_joints(Blocks.from_polygons(outlines)))


@settings(max_examples=20)
@given(seed=st.integers(0, 10**6), reach=st.sampled_from([1e-4, 1e-3, 4e-3]))
def test_healing_restores_all_joints(seed: int, reach: float) -> None:
    drawn = sloppy(metres([*BRICKS, GROUND]), reach, seed)
    healed, note = heal(drawn, reach)
    assert touching(healed) == 14
    moved = max(np.hypot(*(a - b).T).max() for a, b in zip(drawn, healed, strict=True))
    assert moved <= reach
    assert f"by at most {moved:.2g} m" in note


def test_healing_does_not_move_touching_blocks() -> None:
    drawn = metres([*BRICKS, GROUND])
    healed, note = heal(drawn, 1e-3)
    assert all((a == b).all() for a, b in zip(drawn, healed, strict=True))
    assert note == "heal: nothing to close"


def test_healing_does_not_depend_on_position(monkeypatch: pytest.MonkeyPatch) -> None:
    """At map coordinates doubles resolve about a nanometre; healing must not use all iterations to close the rest."""
    step, steps = healing._step, 0

    def counted(*given: Any) -> Array:
        nonlocal steps
        steps += 1
        return step(*given)

    monkeypatch.setattr(healing, "_step", counted)
    drawn = sloppy(metres([*BRICKS, GROUND]), 1e-3, 1)
    near, _ = heal(drawn, 1e-3)
    taken, steps = steps, 0
    there = np.array([512_345.0, 5_412_345.0])
    far, _ = heal([outline + there for outline in drawn], 1e-3)
    assert 0 < steps <= taken + 3
    assert np.vstack(far) - there == pytest.approx(np.vstack(near), abs=4e-9)


@pytest.mark.parametrize("reach", [1e-3, 1e-4])
def test_healed_wall_has_the_multiplier_of_the_exact_wall(reach: float, tmp_path: Path) -> None:
    """To a relative error of gap over block size, because the multiplier depends continuously on the shape."""
    exact = multiplier(scene_of(dxf(tmp_path / "wall.dxf", closed())))
    for seed in range(4):
        drawn = [1e3 * o for o in sloppy(metres(BRICKS), reach, seed)]
        scene = scene_of(dxf(tmp_path / "wall.dxf", closed([list(map(tuple, o)) for o in drawn])), heal=reach)
        assert scene.notes[-1].startswith("heal: ")
        assert multiplier(scene) == pytest.approx(exact, rel=reach / 0.1)


def test_parallel_gaps_heal_to_the_exact_multiplier(tmp_path: Path) -> None:
    """Bricks drawn 0.4 mm too small on all sides leave gaps of 0.8 mm; healed, only the wall's outline differs."""
    exact = multiplier(scene_of(dxf(tmp_path / "wall.dxf", closed())))
    small = [
        [
            (x + 0.4 * (1 if x == min(p[0] for p in o) else -1), y + 0.4 * (1 if y == min(p[1] for p in o) else -1))
            for x, y in o
        ]
        for o in BRICKS
    ]
    scene = scene_of(dxf(tmp_path / "wall.dxf", closed(small)), heal=1e-3)
    assert len(scene.joints) == 14
    assert multiplier(scene) == pytest.approx(exact, rel=3e-3)


def test_heal_longer_than_a_short_side_is_refused(tmp_path: Path) -> None:
    """The ground has a step of 3 mm, both ends of which are near a block's lower corner."""
    stones: list[Outline] = [
        [(0, -3), (400, -3), (400, 200), (0, 200)],
        [(400, 0), (800, 0), (800, 200), (400, 200)],
    ]
    step: Outline = [(-1000, -200), (2000, -200), (2000, 0), (400, 0), (400, -3), (-1000, -3)]
    path = dxf(tmp_path / "step.dxf", closed(stones), closed([step], layer="ground"), ground=False)
    assert len(scene_of(path, heal=2e-3).joints) == 4
    with pytest.raises(SceneError, match=r"joins two corners of block 2 at .*, 0.003 m apart, at \(0.4, 0\); choose"):
        scene_of(path, heal=4e-3)


def test_heal_is_at_most_a_tenth_of_the_smallest_side() -> None:
    """Here that of the ground, which is 50 mm deep."""
    drawn = metres([*BRICKS, GROUND])
    heal(drawn, 0.0049)
    with pytest.raises(SceneError, match="must be at most a tenth of the smallest block's smaller side"):
        heal(drawn, 0.0051)


def test_overlaps_are_healed(tmp_path: Path) -> None:
    outlines: list[Outline] = [
        [(0, -0.3), (200, -0.3), (200, 100.4), (0, 100.4)],
        [(0, 100), (200, 100), (200, 200), (0, 200)],
    ]
    with pytest.raises(SceneError, match="overlaps"):
        scene_of(dxf(tmp_path / "wall.dxf", closed(outlines)))
    scene = scene_of(dxf(tmp_path / "wall.dxf", closed(outlines)), heal=5e-4)
    assert len(scene.joints) == 2
    assert "gaps and overlaps of up to 0.0004 m" in scene.notes[-1]


def test_corner_and_edge_meet_with_the_least_squares_of_displacements() -> None:
    """The corner is above the edge's quarter point: g = c + 3/4 a + 1/4 b, with c down and a, b of the edge's ends up.

    Least squares give c = g / (1 + 9/16 + 1/16), a = 3/4 c and b = 1/4 c; nothing else moves.
    """
    gap = 1e-3
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    wedge = np.array([[0.25, 1.0 + gap], [1.25, 2.0], [-0.75, 2.0]])
    healed, _ = heal([square, wedge], 2 * gap)
    down = gap / (1 + 9 / 16 + 1 / 16)
    assert healed[0] - square == pytest.approx(np.array([[0, 0], [0, 0], [0, down / 4], [0, 3 / 4 * down]]), abs=2e-6)
    assert healed[1] - wedge == pytest.approx(np.array([[0, -down], [0, 0], [0, 0]]), abs=2e-6)


def test_two_corners_meet_halfway() -> None:
    left = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    right = np.array([[1.002, 0.0], [2.0, 0.0], [2.0, 1.0], [1.002, 1.0]])
    healed, note = heal([left, right], 3e-3)
    assert healed[0][[1, 2], 0] == pytest.approx([1.001, 1.001])
    assert healed[1][[0, 3], 0] == pytest.approx([1.001, 1.001])
    assert note == "heal: 4 corners moved, by at most 0.001 m, to close gaps and overlaps of up to 0.002 m"


def test_a_joint_along_many_blocks_heals_to_one_straight_line() -> None:
    rng = np.random.default_rng(3)
    lower = [np.array([(k, 0), (k + 1, 0), (k + 1, 1), (k, 1)]) + [0, -0.01 * rng.random()] for k in range(12)]
    upper = [np.array([(k, 1), (k + 1, 1), (k + 1, 2), (k, 2)]) + [0.5, 0.01 * rng.random()] for k in range(12)]
    healed, _ = heal([*lower, *upper], 0.02)
    bed = np.vstack([o[2:] for o in healed[:12]] + [o[:2] for o in healed[12:]])
    slope = np.polyfit(bed[:, 0], bed[:, 1], 1)
    assert np.abs(bed[:, 1] - np.polyval(slope, bed[:, 0])).max() < 1e-9


def test_healing_of_an_arch() -> None:
    stones = []
    for a, b in pairwise(np.linspace(0, math.pi, 12)):
        stones.append(np.array([[r * math.cos(t), r * math.sin(t)] for r, t in ((2, a), (2.4, a), (2.4, b), (2, b))]))
    healed, _ = heal(sloppy(stones, 2e-3, 5), 2e-3)
    assert touching(healed) == 10


def test_gap_without_a_joint_is_reported_with_the_heal_that_closes_it(tmp_path: Path) -> None:
    outlines: list[Outline] = [*BRICKS[:5], *[[(x, y + 0.5) for x, y in o] for o in BRICKS[5:]]]
    path = dxf(tmp_path / "wall.dxf", closed(outlines))
    (note,) = read_drawing(path, "mm").notes
    assert note.startswith(
        "a gap of 0.0005 m between block 2 at (0.05, 0.15) and block 5 at (0.1, 0.2505) leaves no joint"
    )
    proposed = float(note.split("heal = ")[1].split()[0])
    assert len(scene_of(path, heal=proposed).joints) == 14
    assert read_drawing(path, "mm", heal=2e-4).notes == ("heal: nothing to close", note)


def test_gap_left_open_by_healing_gets_no_smaller_heal_proposed(tmp_path: Path) -> None:
    """A side of 0.2 mm beyond the end of the edge it should lie on; after heal = 4 mm the note once proposed 0.7 mm."""
    lower = [(999.3, 397.2), (603.0, 604.3), (498.3, 360.1), (556.2, 0.0), (999.5, 0.0), (999.5, 397.3)]
    upper = [(999.4, 398.4), (999.4, 737.7), (606.9, 737.8), (603.3, 605.4)]
    path = dxf(tmp_path / "wall.dxf", closed([lower, upper, [(0, -300), (1500, -300), (1500, 0), (0, 0)]]))
    *_, note = read_drawing(path, "mm", heal=4e-3).notes
    assert note.startswith("a gap of 0.00065 m between block 0")
    assert note.endswith("leaves no joint there; wall.heal = 0.004 leaves it open; draw the corners there anew")


def test_wide_gaps_are_not_reported() -> None:
    apart = [[(x, y + (40 if k >= 5 else 0)) for x, y in o] for k, o in enumerate(BRICKS)]
    assert missed_joints(metres([*BRICKS, GROUND])) == missed_joints(metres([*apart, GROUND])) == ""


def test_gap_width_is_judged_by_the_smaller_block() -> None:
    """3 mm between bricks and a ground of 100 m is wide, though negligible for the ground; 0.5 mm is reported."""
    ground = box(-50_000.0, -100_000.0, 50_000.0, 0.0)
    for lifted, seen in ((3.0, False), (0.5, True)):
        bricks = [[(x, y + lifted) for x, y in brick] for brick in BRICKS]
        assert bool(missed_joints(metres([*bricks, ground]))) == seen


def test_widest_of_several_gaps_is_reported() -> None:
    """0.3 mm below the middle course and 0.6 mm above it; the proposed `heal` closes both."""
    lifted = [[(x, y + (0 if k < 2 else 0.3 if k < 5 else 0.9)) for x, y in brick] for k, brick in enumerate(BRICKS)]
    note = missed_joints(metres([*lifted, GROUND]))
    assert note.startswith("a gap of 0.0006 m between block 2")
    healed, _ = heal(metres([*lifted, GROUND]), float(note.split("heal = ")[1].split()[0]))
    assert touching(healed) == 14
