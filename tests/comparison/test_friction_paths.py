"""Answers that depend on how joints slide: models that follow one path each end elsewhere, and say so."""

import pytest

from runningbond.models import run_model
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
    assert "other paths may differ by more" in static.message


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
