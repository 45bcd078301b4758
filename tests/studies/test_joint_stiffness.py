"""Joint stiffness: what does not depend on it, and what outcomes report if something does."""

from typing import Any

import pytest

from dem.dynamic import dem_dynamic, quasi_static_run
from dem.static import dem_static
from fem_interface.model import fem
from runningbond.compare import published_scene
from runningbond.joints import stiffness_note
from runningbond.joints.stiffness import EPSILON, SOFT, STIFF
from runningbond.models import run_model
from runningbond.studies.stability.joint_stiffness import (
    CASES,
    COLLAPSES,
    CONDITION,
    K_N,
    NORMAL,
    OVERLAP,
    REST,
    THEORY,
    at_rest,
    condition,
    fits,
    overlap,
    wall,
)
from runningbond.studies.stability.joint_stiffness import stiffness_note as said_in
from tests.at_length import at_length

EXACT = 0.58558
"""λ of W1 with joints inset by 20 mm, certified by linear programs."""

Model = Any


@pytest.mark.parametrize("normal", [1e7, 1e9, 1e12])
def test_overlap_is_the_weight_above_over_the_stiffness(normal: float) -> None:
    """ρ g H / k_n at the base of a wall of constant width: 1800 · 9.81 · 1.05 / k_n."""
    depth = at_rest(normal)[OVERLAP]
    assert overlap(wall(normal), normal) * 0.175 == pytest.approx(1800 * 9.81 * 1.05 / normal, rel=1e-9)
    assert depth == pytest.approx(overlap(wall(normal), normal), rel=1e-6)


def test_condition_of_the_static_equations_does_not_depend_on_stiffness() -> None:
    assert condition(wall(1e14)) == pytest.approx(condition(wall(1e8)), rel=1e-9)


@pytest.mark.parametrize("normal", [1e9, 1e11])
@pytest.mark.parametrize("model", [dem_static, dem_dynamic, *at_length(fem)])
def test_stiffness_within_the_usual_range_changes_nothing_and_gives_no_note(model: Model, normal: float) -> None:
    outcome = model(wall(normal))
    assert outcome.status == "collapse"
    assert outcome.multiplier == pytest.approx(EXACT, rel=0.005)
    assert not said_in(outcome.message)


@pytest.mark.parametrize(("normal", "deep"), [(1e7, "1.1 %"), (1e6, "11 %")])
@pytest.mark.parametrize("model", [dem_static, dem_dynamic, *at_length(fem)])
def test_soft_joints_are_reported(model: Model, normal: float, deep: str) -> None:
    """Blocks overlap by one per cent of their size or more; λ barely changes here, but might for another wall."""
    outcome = model(wall(normal))
    assert outcome.status == "collapse"
    assert outcome.multiplier == pytest.approx(EXACT, rel=0.01)
    assert f"joints are too soft: blocks overlap by {deep} of their size" in outcome.message


@pytest.mark.parametrize("model", [dem_static, dem_dynamic, *at_length(fem)])
def test_settlement_into_soft_joints_is_not_taken_for_collapse(model: Model) -> None:
    """Settling by its own size under dead load is no collapse, and the exact load is still found."""
    outcome = model(wall(1e5))
    assert outcome.status == "collapse"
    assert outcome.multiplier == pytest.approx(EXACT, rel=0.01)
    assert "joints are too soft" in outcome.message


def test_exhausted_budget_reports_the_simulated_time() -> None:
    scene = wall(1e15)
    outcome = dem_dynamic(scene, budget=20_000)
    assert outcome.status == "undecided"
    followed = 20_000 * quasi_static_run(scene).dt
    assert f"each load was followed for at most {followed:.2g} s" in outcome.message


def test_stiffness_note_appears_at_its_thresholds() -> None:
    size, collapse, unit = 0.2, 0.01, 100.0
    depth, stiffness = SOFT * collapse, STIFF * unit / (EPSILON * collapse)
    assert stiffness_note(0.999 * depth, collapse, size, 0.999 * stiffness, unit) == ""
    assert "too soft: blocks overlap by 0.1 % of" in stiffness_note(1.001 * depth, collapse, size, 1.0, unit)
    assert "too stiff: in displacements" in stiffness_note(0.0, collapse, size, 1.001 * stiffness, unit)


def test_rounding_in_too_stiff_joints_is_reported() -> None:
    assert "joints are too stiff" in dem_static(wall(1e18)).message


@pytest.mark.parametrize("name", ["panel-04", "wall-w3", *at_length("point-load-quarter")])
@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_published_walls_get_no_stiffness_note(name: str, model: str) -> None:
    assert not said_in(run_model(model, published_scene(name), 0.05).message)


def test_range_of_stiffness_ends_at_the_first_note() -> None:
    """Around the stiffness of the wall's own joints: a note at 1e9 Pa/m used to leave the range from 1e5 Pa/m on."""
    rest = [{K_N: normal, OVERLAP: 1e-5, THEORY: 1e-5, CONDITION: 1.0} for normal in NORMAL]
    cases: list[dict[str, Any]] = [{K_N: normal, "model": model} for normal, model in CASES]
    rows = [case | {"status": "collapse", "λ": EXACT, "of the stiffness": ""} for case in cases]
    for row in rows:
        if row[K_N] == 1e9:
            row["of the stiffness"] = "joints are too soft"
        if row[K_N] == 1e14:
            row["status"] = "undecided"
    edges = {edge.what: edge.measured for edge in fits({REST: rest, COLLAPSES: rows})}
    ends = [edges[f"{end} k_n at which all models collapse and say nothing [Pa/m]"] for end in ("smallest", "largest")]
    assert ends == [1e10, 1e13]
