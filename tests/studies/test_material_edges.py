"""What models say at the edges of materials, shapes and sizes."""

import pytest

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from runningbond.limit import limit
from runningbond.studies.stability.material_edges import EXTREMES, SIZES, answer, in_words, similar


@pytest.mark.parametrize("model", ["homog", "limit", "limit-nonassociated", "dem-static"])
@pytest.mark.parametrize("what", EXTREMES)
def test_models_at_rest_are_right_or_say_that_they_are_not(what: str, model: str) -> None:
    result = answer(what, model)
    assert result["worth"] != "wrong", result
    assert result["message"]


@pytest.mark.parametrize("what", [what for what in EXTREMES if what != "tan φ = 10⁻⁶"])
def test_rigid_blocks_in_motion_are_right(what: str) -> None:
    """A metre on a centimetre, too, though it sinks so far into it that joints are said to be too soft."""
    result = answer(what, "dem-dynamic")
    assert result["worth"] == "right", result


@pytest.mark.parametrize(
    "what", ["block 1:50", "no equilibrium: overhang", "gap, 0.99 tolerances", "self-locking: one block pinned"]
)
def test_deformable_blocks_in_motion_are_right(what: str) -> None:
    result = answer(what, "fem")
    assert result["worth"] == "right", result


@pytest.mark.parametrize("model", [limit, dem_static, dem_dynamic])
def test_a_dry_wall_has_one_multiplier_in_every_size(model) -> None:  # type: ignore[no-untyped-def]
    """From 1 µm to 1 km with stiffness along, to rounding."""
    small, usual, large = (model(similar(size / 0.48)).lower for size in SIZES)
    assert small == pytest.approx(usual, rel=1e-9)
    assert large == pytest.approx(usual, rel=1e-9)


@pytest.mark.parametrize(
    ("value", "said"),
    [
        (0.0, "0"),
        ((0.0, 7.15e-9), "≤ 7.2 × 10⁻⁹"),
        ((1e-6, 1.0000001e-6), "10⁻⁶"),
        ((0.000977, 0.00107), "0.000977 – 0.00107"),
        ((0.6, 0.836), "0.6000 – 0.8360"),
        ("unbounded", "unbounded"),
    ],
)
def test_answers_read_as_people_write_them(value: float | tuple[float, float] | str, said: str) -> None:
    assert in_words(value) == said
