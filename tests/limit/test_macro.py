"""Macro-blocks: mechanisms of glued walls, and what their loads prove for the full wall."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.compare import published_scene
from runningbond.limit import Equilibrium, equilibrium, limit, limit_nonassociated
from runningbond.limit.canonical import canonical_order
from runningbond.limit.certificates import certify
from runningbond.limit.force_program import coulomb, frozen_friction, solve_forces
from runningbond.limit.large import search_large
from runningbond.limit.macro import glue, still_points
from runningbond.limit.proved import WIDEST
from runningbond.results import save_outcome
from runningbond.scene import Scene
from tests.checker import check
from tests.walls import panel

WALLS: dict[str, dict[str, Any]] = {
    "dry": {},
    "toothed": {"wall__ends": "toothed"},
    "cohesive": {"joint__cohesion": 2e3},
    "rounded": {"joint__inset": 0.005},
    "wedged": {"support__kind": "pinned-corners"},
    "opening": {"wall__opening": [{"from": [0.5, 0.24], "to": [0.8, 0.42]}]},
}


def wall(name: str) -> Scene:
    return panel(**{"wall__length": 1.2, "wall__height": 0.6, **WALLS[name]})


def place(scene: Scene) -> np.ndarray:
    return np.asarray(scene.blocks.centroid[~scene.fixed])


def associated(system: Equilibrium) -> float:
    return solve_forces(system, coulomb(system.strength)).multiplier


@pytest.mark.parametrize("share", [0.1, 0.3, 0.5])
@pytest.mark.parametrize("name", WALLS)
def test_mechanism_of_glued_wall_is_admissible_in_full_wall(name: str, share: float) -> None:
    """Randomly glued: it obeys the flow rule everywhere, its load is an upper bound, and glued joints do not move."""
    scene = wall(name)
    system = equilibrium(scene).under_live_load()
    joints = np.random.default_rng(0).random(len(scene.joints.block)) < share
    still = joints[system.points.joint]
    glued = glue(system, place(scene), still)
    assert 0 < glued.system.freedoms < system.freedoms
    found = solve_forces(glued.system, coulomb(glued.system.strength))
    if found.status == "unbounded":  # glued fast to the ground
        return
    motion = glued.motions @ found.motion
    assert system.live @ motion == pytest.approx(1.0)
    opening, slip = system.opening.T @ motion, system.slip.T @ motion
    rounding = 1e-9 * np.abs(motion).max()
    assert (opening - system.strength.friction * np.abs(slip)).min() >= -1e2 * rounding
    assert np.abs(np.concatenate([opening[still], slip[still]])).max() <= rounding
    assert system.kinematic_multiplier(motion) == pytest.approx(found.multiplier, rel=1e-7)
    assert found.multiplier >= associated(system) * (1 - 1e-9)


@pytest.mark.parametrize("name", WALLS)
def test_gluing_joints_without_jumps_keeps_multiplier(name: str) -> None:
    scene = wall(name)
    system = equilibrium(scene).under_live_load()
    found = solve_forces(system, coulomb(system.strength))
    glued = glue(system, place(scene), still_points(system, found.motion, 1e-9))
    assert glued.system.freedoms < system.freedoms
    assert associated(glued.system) == pytest.approx(found.multiplier, rel=1e-8)


def test_one_still_point_does_not_glue_blocks() -> None:
    scene = wall("dry")
    system = equilibrium(scene).under_live_load()
    still = np.arange(len(system.points)) % 2 == 0
    assert glue(system, place(scene), still).system.freedoms == system.freedoms


def test_wall_glued_to_ground_has_no_freedoms() -> None:
    scene = wall("dry")
    system = equilibrium(scene).under_live_load()
    assert glue(system, place(scene), np.ones(len(system.points), dtype=bool)).system.freedoms == 0


@pytest.mark.parametrize("name", WALLS)
def test_large_walls_have_certified_loads_below_associated_load(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the size threshold of large walls set to 0. Without a certificate only the associated load is reported."""
    monkeypatch.setattr("runningbond.limit.large.LARGE_POINTS", 0)
    scene = wall(name)
    outcome, bound = limit_nonassociated(scene), limit(scene).multiplier
    assert bound is not None
    assert outcome.upper is not None
    assert outcome.upper <= bound * (1 + 1e-6)
    assert outcome.status in ("collapse", "undecided")
    if outcome.status == "collapse":
        assert outcome.lower is not None
        assert 0 < outcome.lower <= outcome.upper
        save_outcome(outcome, tmp_path, "", scene)
        assert check(tmp_path)


@pytest.mark.parametrize(("name", "glued"), [("panel-12", True), ("wall-w1", False)])
def test_glued_and_full_sequences_find_mechanisms(name: str, glued: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each sequence alone: panel-12's load is a seventh below what other sequences of its first start find."""
    system = equilibrium(published_scene(name)).under_live_load()
    order = canonical_order(system)
    ordered, at = order.applied(system), order.places(system.scene)
    other = "AT_ONCE" if glued else "SLOW"
    monkeypatch.setattr(f"runningbond.limit.large.{other}", (1.0, range(0)))
    found = search_large(ordered, at, lambda _: None)
    (certificate,) = found.certificates
    exact = certify(ordered, certificate.motion)
    assert exact is not None
    assert certificate.least.multiplier == pytest.approx(exact.least.multiplier, rel=1e-4)
    if glued:
        assert exact.least.multiplier == pytest.approx(0.06686, abs=1e-5)


def test_repaired_certificates_match_highs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both ends agree to 1e-7 only, because forces near an extreme load are accepted."""
    system = equilibrium(published_scene("wall-w2")).under_live_load()
    pressure = solve_forces(system, coulomb(system.strength)).pressure
    motion = solve_forces(system, frozen_friction(system.strength, pressure)).motion
    exact = certify(system, motion)
    assert exact is not None
    assert exact.least.multiplier < 0.98 * exact.most.multiplier
    monkeypatch.setattr("runningbond.limit.certificates.REPAIR_FREEDOMS", 0)
    monkeypatch.setattr("runningbond.limit.certificates.solve_forces", None)  # HiGHS is not called
    near = certify(system, motion)
    assert near is not None
    assert near.least.multiplier == pytest.approx(exact.least.multiplier, rel=1e-7)
    assert near.most.multiplier == pytest.approx(exact.most.multiplier, rel=1e-7)


@pytest.mark.parametrize("name", ["dry", "cohesive", "opening"])
def test_bracket_of_huge_wall_contains_multiplier(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """With the size thresholds of large to huge walls set to 0; the bracket may be as wide as `WIDEST`."""
    scene = wall(name)
    exact = limit(scene).multiplier
    assert exact is not None
    for size in ("LARGE", "VERY_LARGE", "HUGE"):
        monkeypatch.setattr(f"runningbond.limit.proved.{size}", 0)
    outcome = limit(scene)
    assert outcome.status == "collapse"
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.lower <= exact * (1 + 1e-9)
    assert outcome.upper >= exact * (1 - 1e-9)
    assert 1e-9 * exact < outcome.upper - outcome.lower <= WIDEST * exact
