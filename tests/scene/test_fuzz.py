"""Random scenes and options for all six models: a consistent outcome within the bounds, or a one-line message."""

import tempfile
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, event, given, settings
from hypothesis import strategies as st

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from fem_interface.model import fem
from homog import homog
from runningbond.commands.command_line import command
from runningbond.limit import equilibrium, limit, limit_nonassociated
from runningbond.limit.kinematics import dead_load
from runningbond.models import MODELS
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError, read_scene
from tests.scenes import drawn, outlines, small_walls, write_drawing
from tests.walls import write_toml

ANY: dict[str, Any] = {"suppress_health_check": list(HealthCheck)}

RUNS: dict[str, Callable[[Scene, float], Outcome]] = {
    "homog": lambda scene, tolerance: homog(scene),
    "limit": limit,
    "limit-nonassociated": limit_nonassociated,
    "dem-static": lambda scene, tolerance: dem_static(scene, tolerance, budget=300),
    "dem-dynamic": lambda scene, tolerance: dem_dynamic(scene, tolerance, budget=10_000),
    "fem": lambda scene, tolerance: fem(scene, tolerance, budget=10_000),
}
"""The models with small budgets; many runs end because the budget is exhausted."""

REST_LOAD = 1e-4
"""Load [weights] by which models other than limit analysis may exceed the bound; the rest criterion's resolution."""


def _check_outcome(outcome: Outcome, scene: Scene) -> None:
    """Check what `Outcome` does not check by itself."""
    # The only accepted failure is one that the run detects itself: a residual of its energy balance.
    assert outcome.status != "failed" or "unaccounted" in outcome.message, outcome.message
    assert outcome.message
    assert outcome.message == " ".join(outcome.message.split())
    for values in (outcome.motion, outcome.force, outcome.curve):
        assert np.isfinite(values).all()
    numbers = [x for x in (outcome.lower, outcome.multiplier, outcome.upper) if x is not None]
    assert all(x >= 0 for x in numbers)
    assert outcome.status in ("collapse", "undecided", "failed") or not numbers
    if outcome.model != "homog" and outcome.status == "collapse":
        assert outcome.lower is not None
        assert outcome.upper is not None
        assert outcome.dofs == 3 * np.count_nonzero(~scene.fixed) or outcome.model in ("dem-dynamic", "fem")


def _check_bounds(outcome: Outcome, bound: Outcome, scene: Scene) -> None:
    """Check that no model exceeds the associated limit load, or finds equilibrium where none is possible."""
    if outcome.model == "homog":  # an estimate, on either side
        return
    unit, dead = equilibrium(scene).live_unit, dead_load(scene)
    if bound.status == "infeasible":
        slow_fall = 0 < dead @ bound.motion.ravel() < REST_LOAD * np.abs(dead).sum() if len(bound.motion) else False
        carries_nothing = outcome.status == "collapse" and (outcome.upper or 0.0) <= REST_LOAD * unit
        assert outcome.status in ("infeasible", "undecided") or (slow_fall and carries_nothing)
        assert outcome.lower is None or slow_fall
    if bound.status == "collapse" and outcome.status != "failed":
        assert bound.upper is not None
        assert outcome.status != "unbounded"
        if outcome.lower is not None:
            width = 0.0 if outcome.upper is None else outcome.upper - outcome.lower
            exact = outcome.model.startswith("limit")
            most = bound.upper * (1 + 1e-6) + 1e-6 * unit if exact else bound.upper + width + REST_LOAD * unit
            assert outcome.lower <= most
            assert outcome.upper is None or not exact or outcome.upper <= most


def _check_message(error: SceneError) -> None:
    text = str(error)
    assert text == " ".join(text.split())
    assert ": " in text
    assert not text.startswith((":", "="))


def _run_models(table: dict[str, Any], models: list[str], tolerance: float, drawing: Any = None) -> list[str]:
    """Run the models on a scene file, check the outcomes, and return statuses or ``refused``."""
    with tempfile.TemporaryDirectory() as folder:
        if drawing is not None:
            write_drawing(drawing, Path(folder) / "wall.dxf")
            table = drawn(table)
        try:
            scene = read_scene(write_toml(table, Path(folder) / "wall.toml"))
        except SceneError as error:
            _check_message(error)
            return [f"no scene: {str(error).partition(' = ')[0].partition(': ')[0]}"]
    bound, said = limit(scene), []
    for model in models:
        try:
            outcome = bound if model == "limit" else RUNS[model](scene, tolerance)
        except SceneError as error:
            _check_message(error)
            said.append(f"{model}: refused")
            continue
        _check_outcome(outcome, scene)
        _check_bounds(outcome, bound, scene)
        said.append(f"{model}: {outcome.status}")
    for answer in said:
        event(answer)
    return said


tolerances = st.sampled_from([0.5, 0.1, 0.02])
some_models = st.sampled_from(["dem-dynamic", "fem"]).map(
    lambda slow: ["homog", "limit", "limit-nonassociated", "dem-static", slow]
)
some_drawing = st.one_of(*[st.none()] * 9, outlines())


@given(table=small_walls(), models=some_models, tolerance=tolerances, drawing=some_drawing)
@settings(max_examples=20, derandomize=True, **ANY)
def test_random_scenes_give_outcomes_within_bounds(
    table: dict[str, Any], models: list[str], tolerance: float, drawing: Any
) -> None:
    _run_models(table, models, tolerance, drawing)


@pytest.mark.long
@given(table=small_walls(), models=some_models, tolerance=tolerances, drawing=some_drawing)
@settings(max_examples=2500, **ANY)
def test_random_scenes_give_outcomes_within_bounds_at_length(
    table: dict[str, Any], models: list[str], tolerance: float, drawing: Any
) -> None:
    _run_models(table, models, tolerance, drawing)


words = st.sampled_from(
    ["", "nan", "inf", "-1", "0", "1", "1e-400", "0.5", "0.01", "1e-9", "abc", "0x1", "1_0", "½", "--json"]
)
"""Values of options, valid and invalid."""


@given(
    table=small_walls(),
    model=st.sampled_from([*MODELS, "Limit", "femm", "limit ", ""]),
    options=st.lists(
        st.sampled_from(["--tolerance", "--model", "--out", "--jobs", "--json", "--tolernace", "--cells"]), max_size=2
    ),
    values=st.lists(words, min_size=2, max_size=2),
)
@settings(max_examples=60, derandomize=True, **ANY)
def test_random_options_give_an_outcome_or_one_line(
    table: dict[str, Any], model: str, options: list[str], values: list[str]
) -> None:
    """For the slow models the stiffness is removed, so that they refuse the scene instead of running long."""
    if model in ("dem-static", "dem-dynamic", "fem"):
        table["joint"].pop("mortar", None)
        table["joint"].pop("normal_stiffness", None)
    out, err = StringIO(), StringIO()
    with tempfile.TemporaryDirectory() as folder:
        path = write_toml(table, Path(folder) / "wall.toml")
        chosen = [word for pair in zip(options, values, strict=False) for word in pair]
        chosen = [
            f"{folder}/out" if before == "--out" else word for before, word in zip(["", *chosen], chosen, strict=False)
        ]
        with redirect_stdout(out), redirect_stderr(err):
            code = command(["run", str(path), "--model", model, *chosen])
    assert code in (0, 2, 3)
    assert (code == 2) == (out.getvalue() == "")
    if code == 2:
        assert err.getvalue().startswith("runningbond: ")
        assert err.getvalue().count("\n") == 1
