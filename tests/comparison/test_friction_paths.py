"""Answers that depend on how joints slide: models that follow one path each end elsewhere, and say so."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import runningbond as rb
from runningbond.models import run_model
from runningbond.scene import Scene
from tests.walls import courses

SLIDES = "joints slide: another path, or forces at other points along the joints, may "


def test_share_left_by_friction_depends_on_where_joints_carry_forces_and_is_certified() -> None:
    """Beds have points at their ends only, or in `fem` also between them; each bracket is that of its own path."""
    scene = courses(
        [[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]],
        width=0.4,
        height=0.175,
        block__young=1e11,
        joint={"friction": 0.75, "normal_stiffness": 1e9, "shear_stiffness": 4e8},
        load={"gravity": 9.81, "live": {"kind": "settlement", "box": [[0.36, -9], [9, 0.01]], "by": [0, -0.01]}},
    )
    certified = run_model("limit-nonassociated", scene)
    assert [certified.lower, certified.upper] == pytest.approx([0.32, 0.5], abs=0.005)
    for model, share in {"dem-static": 0.427, "dem-dynamic": 0.427, "fem": 0.403}.items():
        outcome = run_model(model, scene)
        assert outcome.status == "collapse", outcome.message
        assert outcome.multiplier == pytest.approx(share, abs=0.002)
        assert outcome.upper is not None
        assert outcome.lower is not None
        assert outcome.upper - outcome.lower < 0.002
        assert f"{SLIDES}leave another share" in outcome.message


def test_collapse_load_left_by_friction_depends_on_the_path() -> None:
    """A weightless wall is pressed at a corner: the pressed stone topples alone, or leans on its neighbours' friction.

    Its own toe gives λ = 0.5. The model in motion finds that load, dem-static a larger one in a bracket apart from it.
    """
    push = {"kind": "point", "at": [0.0, 0.6], "force": [350.0, 0.0]}
    pressed = {"kind": "point", "at": [0.0, 0.6], "force": [0.0, -350.0]}
    scene = courses(
        [[1, 1], [0.5, 1, 0.5]],
        width=0.3,
        height=0.3,
        joint={"friction": 1.0, "normal_stiffness": 4e9, "shear_stiffness": 1.6e9},
        load={"gravity": 0.0, "dead": [pressed], "live": push},
    )
    moving, static = run_model("dem-dynamic", scene), run_model("dem-static", scene)
    assert moving.lower is not None
    assert moving.upper is not None
    assert static.lower is not None
    assert moving.lower <= 0.5 <= moving.upper < 0.95 * static.lower
    assert f"{SLIDES}have another collapse load" in moving.message


def _upright_blocks(**changes: Any) -> Scene:
    """Four courses of upright blocks, which turn and slide."""
    joint = {"friction": 0.45, "normal_stiffness": 2e10, "shear_stiffness": 8e9}
    rows: list[list[float]] = [[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1], [0.5, 1, 1, 0.5]]
    return courses(rows, width=0.2, height=0.4, joint=joint, block__young=2e10, **changes)


def test_forces_of_a_drive_left_by_friction_lie_apart_at_finite_displacements_as_well() -> None:
    """Under a level beam rigid and deformable blocks end in narrow brackets apart from each other."""
    drive = {"displacement": [0.01, 0]}
    beam = {"height": 0.2, "condition": "level", "force": [0, -5e4], "drive": drive}
    scene = _upright_blocks(load={"gravity": 9.81}, beam=beam)
    rigid, soft = (run_model(model, scene, displacements="finite") for model in ("dem-dynamic", "fem"))
    assert rigid.lower is not None
    assert soft.upper is not None
    assert soft.upper < rigid.lower
    for outcome in (rigid, soft):
        assert outcome.status == "collapse", outcome.message
        assert f"{SLIDES}give another reaction" in outcome.message


def test_load_of_a_push_left_by_friction_is_told_at_finite_displacements() -> None:
    """As it is at small ones, where the load is raised from rest to rest."""
    scene = _upright_blocks(load={"gravity": 9.81, "live": {"kind": "lateral"}})
    settings: list[dict[str, Any]] = [{}, {"displacements": "finite", "distance": 0.005}]
    for each in settings:
        outcome = run_model("dem-dynamic", scene, **each)
        assert outcome.status == "collapse", outcome.message
        assert f"{SLIDES}have another collapse load" in outcome.message


@pytest.mark.parametrize(("friction", "exact"), [(0.3, 0.3), (1.0, 0.5)])
def test_stack_that_slides_or_topples_has_one_collapse_load(friction: float, exact: float) -> None:
    """Balance gives its forces, however points of its joints slid before."""
    scene = courses(
        [[1]] * 3,
        width=0.3,
        height=0.2,
        block__young=1e12,
        joint={"friction": friction, "normal_stiffness": 4e9, "shear_stiffness": 1.6e9},
        load={"gravity": 9.81, "live": {"kind": "lateral"}},
    )
    for model in ("dem-dynamic", "fem"):
        outcome = run_model(model, scene)
        assert outcome.multiplier == pytest.approx(exact, rel=0.01)
        assert SLIDES not in outcome.message
    pushed = run_model("dem-dynamic", scene, displacements="finite", distance=0.005)
    assert pushed.multiplier == pytest.approx(exact, rel=0.02)
    assert SLIDES not in pushed.message


def test_wall_that_locks_on_one_path_may_collapse_on_another() -> None:
    """A flat arch of three stones between two piers under a course and a floor.

    Forces that balance any load are admissible under true friction, too, but need not be those that come about.
    """
    span, height, skew, pier, top = 1.3, 0.25, 0.14, 0.8, 0.45
    below, above = np.linspace(0, span, 4), np.linspace(-skew, span + skew, 4)
    sides = [(below[k], below[k + 1], above[k + 1], above[k]) for k in range(3)]
    sides += [(-pier, 0.0, -skew, -pier), (span, span + pier, span + pier, span + skew)]
    stones = [[(a, 0.0), (b, 0.0), (c, height), (d, height)] for a, b, c, d in sides]
    stones += [[(x, -1.4), (x + pier, -1.4), (x + pier, 0.0), (x, 0.0)] for x in (-pier, span)]
    ends = np.linspace(-pier, span + pier, 6)
    stones += [[(left, height), (right, height), (right, top), (left, top)] for left, right in pairwise(ends)]
    scene = rb.Wall.outlines(
        stones,
        thickness=0.3,
        density=2000.0,
        friction=0.7,
        normal_stiffness=4e9,
        shear_stiffness=1.6e9,
        live={"kind": "line", "from": [0.0, top], "to": [span, top], "force": [0.0, -1000.0]},
    ).scene
    assert run_model("limit", scene).status == "unbounded"
    assert run_model("limit-nonassociated", scene).lower == pytest.approx(12.04, abs=0.01)
    for model in ("dem-static", "dem-dynamic"):
        outcome = run_model(model, scene)
        assert outcome.status == "unbounded", outcome.message
        assert f"{SLIDES}bring it down" in outcome.message
