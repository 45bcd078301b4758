"""Settlements whose share depends on how joints slide: models that follow one path each end elsewhere, and say so."""

import pytest

from runningbond.models import run_model
from tests.walls import courses


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
        assert "joints slide: another path, or forces at other points along the joints" in outcome.message
