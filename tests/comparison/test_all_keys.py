"""Random scenes over all keys: no model exceeds what `limit` proves, and an independent checker confirms it."""

import copy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from runningbond.limit.kinematics import dead_load, live_load
from runningbond.models import MODELS, run_model
from runningbond.results import Outcome, save_outcome
from runningbond.scene import Scene, SceneError, scene_from_dict
from tests.checker import SCRIPT, check
from tests.random_scenes import mirrored, random_scene
from tests.walls import courses

LIMITS = ("limit", "limit-nonassociated")
SLACK = 1e-4
"""Load, in weights of the heaviest block, that the criterion of rest cannot detect."""

BUDGETS = {
    "limit-nonassociated": {"starts": 4},
    "dem-static": {"budget": 300},
    "dem-dynamic": {"budget": 10_000},
    "fem": {"budget": 10_000},
}


def _unit(scene: Scene) -> float:
    """Multiplier at which the live load equals the largest block weight; 1, the whole weight, for a moving support."""
    live = float(np.abs(live_load(scene)).max())
    return float(np.abs(dead_load(scene)).max()) / live if live else 1.0


def _proved(outcome: Outcome, scene: Scene, folder: Path) -> None:
    save_outcome(outcome, folder, "", scene)
    assert check(folder)


def _within(outcome: Outcome, bound: Outcome, scene: Scene) -> None:
    """Check that no load exceeds the bound, and that no reaction of a moving support is below it."""
    exact, unit = outcome.model in LIMITS, _unit(scene)
    slack = 1e-6 if exact else SLACK
    if bound.status == "infeasible":
        assert outcome.status in ("infeasible", "undecided")
    if bound.status != "collapse" or outcome.status == "failed":
        return
    assert bound.lower is not None
    assert bound.upper is not None
    width = 0.0 if exact or outcome.upper is None or outcome.lower is None else outcome.upper - outcome.lower
    room = width + slack * (unit + abs(bound.upper))
    if scene.settlement is not None:
        if outcome.upper is not None:
            assert outcome.upper >= bound.lower - room
        return
    assert outcome.status != "unbounded"
    if outcome.lower is not None:
        assert outcome.lower <= bound.upper + room


def _outcome(model: str, scene: Scene) -> Outcome | None:
    """Result of a model for a scene; None if the model refuses the scene."""
    try:
        return run_model(model, scene, **BUDGETS.get(model, {}))  # type: ignore[arg-type]
    except SceneError:
        return None


def _holds(seed: int, models: tuple[str, ...], folder: Path) -> str:
    scene = scene_from_dict(random_scene(seed))
    bound = run_model("limit", scene)
    assert bound.status in ("collapse", "unbounded", "infeasible"), bound.message
    _proved(bound, scene, folder / "limit")
    for model in models:
        outcome = _outcome(model, scene)
        if outcome is None:
            continue
        assert model != "limit-nonassociated" or outcome.status != "failed", outcome.message
        if model == "limit-nonassociated":
            _proved(outcome, scene, folder / model)
        if model != "homog":  # an estimate, which may lie on either side
            _within(outcome, bound, scene)
    return bound.status


@pytest.mark.parametrize("seed", range(12))
def test_no_model_exceeds_the_load_that_limit_proves(seed: int, tmp_path: Path) -> None:
    _holds(seed, ("limit-nonassociated", "dem-static"), tmp_path)


@pytest.mark.long
@pytest.mark.parametrize("start", range(0, 300, 30))
def test_no_model_exceeds_the_load_that_limit_proves_at_length(start: int, tmp_path: Path) -> None:
    others = tuple(model for model in MODELS if model != "limit")
    found = [_holds(seed, others, tmp_path) for seed in range(start, start + 30)]
    assert found.count("collapse") > len(found) / 3


@pytest.mark.parametrize("seed", range(100, 112))
def test_mirrored_scene_has_the_same_multiplier(seed: int) -> None:
    content = random_scene(seed)
    if content["support"]["kind"] == "corners":  # one of the corners is a roller
        content["support"]["kind"] = "pinned-corners"
    content["assign"] = [entry for entry in content.get("assign", []) if "blocks" not in entry]
    one, two = (run_model("limit", scene_from_dict(tables)) for tables in (content, mirrored(copy.deepcopy(content))))
    assert one.status == two.status
    assert (one.multiplier or 0.0) == pytest.approx(two.multiplier or 0.0, rel=1e-7, abs=1e-9)


@pytest.mark.parametrize("lean", [-2.0, 0.0, 2.0])
def test_checker_puts_inclined_loads_at_joints_on_the_loaded_blocks(lean: float, tmp_path: Path) -> None:
    """A load on the course below a beam stays there at any inclination; the beam's centroid lies along its line."""
    floor = {"kind": "line", "from": [0.5, 0.35], "to": [0.8, 0.35], "force": [1e3 * lean, -1e3]}
    beam = {"height": 0.2, "mass": 10.0}
    scene = courses([[1, 1], [0.5, 1, 0.5]], beam=beam, load__dead=[floor], joint__cohesion=1e5)
    outcome = run_model("limit", scene)
    assert outcome.status == "collapse"
    _proved(outcome, scene, tmp_path)


@pytest.mark.parametrize("joint", [{}, {"compressive_strength": 2e5, "cap_shear": 2.0}], ids=["dry", "that crush"])
@pytest.mark.parametrize("live", [[-1.3, -0.6], [2.2, -0.9], [0.0, 1.0]])
def test_weightless_dry_wall_has_zero_load_capacity(live: list[float], joint: dict[str, float], tmp_path: Path) -> None:
    """Nothing compresses its joints: λ is 0, and all forces are rounding errors."""
    loads = {"gravity": 0.0, "live": {"kind": "body", "acceleration": live}}
    material = {"friction": 0.385, "inset": 0.007} | joint
    patterns: list[list[list[float]]] = [[[0.5, 1, 1, 1, 0.5], [1, 1, 1, 1]], [[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]]]
    for pattern in patterns:
        scene = courses(pattern, load=loads, joint=material)
        outcome = run_model("limit", scene)
        assert outcome.status == "collapse", outcome.message
        assert outcome.multiplier == pytest.approx(0.0, abs=1e-9)
        _proved(outcome, scene, tmp_path)


@pytest.mark.parametrize("array", ["force", "pull", "motion", "multiplier"])
def test_checker_detects_errors(array: str, tmp_path: Path) -> None:
    """A force, tie force, motion or multiplier that is off by a thousandth: run as a script, it exits with 1."""
    tie = {"from": [0.03, 0.5], "to": [-1.0, 0.5], "area": 1e-4, "young": 2e11, "yield": 5.0}
    scene = courses([[1], [1]], width=0.1, height=0.3, tie=[tie])
    outcome = run_model("limit", scene)
    assert outcome.status == "collapse"
    _proved(outcome, scene, tmp_path)
    value: Any = getattr(outcome, array)
    if array == "multiplier":
        changed = dict.fromkeys(("lower", "multiplier", "upper"), 1.001 * value)
    else:
        largest = np.unravel_index(np.abs(value).argmax(), value.shape)
        spoilt = np.array(value)
        spoilt[largest] *= 1.001
        changed = {array: spoilt}
    save_outcome(replace(outcome, **changed), tmp_path, "", scene)
    found = subprocess.run([sys.executable, str(SCRIPT), str(tmp_path)], capture_output=True, text=True, check=False)
    assert found.returncode == 1
    assert "WRONG" in found.stdout


def test_checker_names_a_folder_without_a_result(tmp_path: Path) -> None:
    found = subprocess.run([sys.executable, str(SCRIPT), str(tmp_path)], capture_output=True, text=True, check=False)
    assert found.returncode == 1
    assert found.stderr == f"{tmp_path}: holds no outcome.json of a limit analysis\n"


def test_checker_needs_only_numpy() -> None:
    imported = [line.split()[1] for line in SCRIPT.read_text().splitlines() if line.startswith(("import ", "from "))]
    assert {name.partition(".")[0] for name in imported} <= {*sys.stdlib_module_names, "numpy"}
