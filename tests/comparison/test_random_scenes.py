"""Any scene gives a result or a one-line error, never a traceback; results satisfy their definitions."""

import json
import tempfile
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from runningbond.commands.command_line import command
from runningbond.joints import joint_points, point_strength
from runningbond.limit import limit, limit_nonassociated
from runningbond.limit.kinematics import dead_load, jump_operator, live_load, movable_freedoms, pin_operator
from runningbond.scene import Scene, SceneError, scene_from_dict
from tests.scenes import spoilt, walls
from tests.walls import write_toml

LIMITS = ("limit", "limit-nonassociated")
FEW: dict[str, Any] = {"derandomize": True, "suppress_health_check": list(HealthCheck)}
MANY: dict[str, Any] = {"max_examples": 2000, "suppress_health_check": list(HealthCheck)}


def _run(scene: dict[str, Any], model: str) -> tuple[int, str, str]:
    out, err = StringIO(), StringIO()
    with tempfile.TemporaryDirectory() as folder:
        path = write_toml(scene, Path(folder) / "wall.toml")
        with redirect_stdout(out), redirect_stderr(err):
            code = command(["run", str(path), "--model", model, "--json"])
    return code, out.getvalue(), err.getvalue()


def _object_or_line(scene: dict[str, Any], model: str) -> None:
    code, out, err = _run(scene, model)
    if code == 2:
        assert out == ""
        assert err.count("\n") == 1
        return
    found = json.loads(out)
    assert out.count("\n") == 1
    assert code == (3 if found["status"] in ("undecided", "failed") else 0)
    assert "Error" not in found["message"]
    assert (found["multiplier"] is not None) == (found["status"] == "collapse")


def _second_opinion(scene: Scene) -> tuple[str, float]:
    """Independent limit analysis: physical units, friction as inequalities, simplex method."""
    points = joint_points(scene.joints, scene.thickness, inset=scene.joint.inset)
    strength = point_strength(scene.joint, points.area)
    jump, free = jump_operator(points, scene.blocks.centroid), movable_freedoms(scene)
    size = float(np.sqrt(scene.blocks.area.min()))
    dead, live = dead_load(scene)[free], live_load(scene)[free]
    unit = max(float(np.abs(dead).max()), float(strength.tension.max()), float(strength.shear.max())) or 1.0
    reach = float(np.abs(live).max())
    row = np.tile([1, 1, 1 / size], len(free) // 3)[:, None]
    normal, tangential = jump.opening[:, free].T.toarray() * row, jump.slip[:, free].T.toarray() * row
    pins = pin_operator(scene)[:, free].T.toarray() * row
    n, p, eye = len(points), pins.shape[1], np.eye(len(points))
    equal = np.hstack([normal, tangential, pins, -live[:, None] * row / reach])
    cone = np.vstack([np.hstack([scene.joint.friction * eye, s * eye, np.zeros((n, p + 1))]) for s in (1, -1)])
    cohesion = (strength.shear + scene.joint.friction * strength.tension) / unit
    bounds = [(None, t) for t in strength.tension / unit] + [(None, None)] * (n + p) + [(0, None)]

    def solve(sense: float, most: float | None) -> Any:
        return linprog(
            np.append(np.zeros(2 * n + p), -sense),
            A_ub=cone,
            b_ub=np.tile(cohesion, 2),
            A_eq=equal,
            b_eq=dead * row[:, 0] / unit,
            bounds=[*bounds[:-1], (0, most)],
            method="highs-ds",
        )

    if solve(0, 0.0).status == 2:
        return "infeasible", 0.0
    found = solve(1, None)
    return ("unbounded", 0.0) if found.status == 3 else ("collapse", float(found.x[-1]) * unit / reach)


def _agrees(scene: dict[str, Any]) -> None:
    try:
        wall = scene_from_dict(scene)
    except SceneError:
        return
    status, multiplier = _second_opinion(wall)
    outcome = limit(wall)
    assert outcome.status == status
    if status == "collapse":
        scale = max(abs(multiplier), float(limit_scale(wall)))
        assert outcome.multiplier == pytest.approx(multiplier, rel=1e-5, abs=1e-5 * scale)
    true = limit_nonassociated(wall, starts=2)
    assert true.status != "failed", true.message
    assert (true.status == "infeasible") == (status == "infeasible")
    if outcome.upper is not None and true.upper is not None:
        assert true.upper <= outcome.upper * (1 + 1e-6) + 1e-6 * limit_scale(wall)


def limit_scale(scene: Scene) -> float:
    """Multiplier at which the live load equals the largest weight or strength."""
    weight = float(np.abs(dead_load(scene)).max())
    return (weight or 1.0) / float(np.abs(live_load(scene)).max())


@given(scene=walls())
@settings(max_examples=60, **FEW)
def test_limit_analysis_agrees_with_a_second_opinion(scene: dict[str, Any]) -> None:
    _agrees(scene)


@given(scene=spoilt(), model=st.sampled_from([*LIMITS, "homog"]))
@settings(max_examples=150, **FEW)
def test_any_scene_gives_a_result_or_one_line(scene: dict[str, Any], model: str) -> None:
    _object_or_line(scene, model)


def test_most_random_scenes_are_valid() -> None:
    """Otherwise the tests above would test refusals only."""
    answered = []

    @given(scene=walls())
    @settings(max_examples=60, **FEW)
    def count(scene: dict[str, Any]) -> None:
        answered.append(_run(scene, "limit")[0] == 0)

    count()
    assert sum(answered) > 0.6 * len(answered)


@pytest.mark.long
@given(scene=walls())
@settings(**MANY)
def test_limit_analysis_agrees_with_a_second_opinion_at_length(scene: dict[str, Any]) -> None:
    _agrees(scene)


@pytest.mark.long
@given(scene=spoilt(), model=st.sampled_from([*LIMITS, "homog"]))
@settings(**MANY)
def test_any_scene_gives_a_result_or_one_line_at_length(scene: dict[str, Any], model: str) -> None:
    _object_or_line(scene, model)
