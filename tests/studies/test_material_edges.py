"""Results for extreme materials, shapes and sizes."""

import pytest

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from runningbond.limit import limit
from runningbond.models import MODELS
from runningbond.studies.stability.material_edges import EXTREMES, PART, SIZES, answer, fits, in_words, similar


@pytest.mark.parametrize("model", ["homog", "limit", "limit-nonassociated", "dem-static"])
@pytest.mark.parametrize("what", EXTREMES)
def test_static_models_are_right_or_report_that_they_are_not(what: str, model: str) -> None:
    result = answer(what, model)
    assert result["worth"] != "wrong", result
    assert result["message"]


@pytest.mark.parametrize("what", [what for what in EXTREMES if what != "tan φ = 10⁻⁶"])
def test_rigid_dynamic_model_is_right(what: str) -> None:
    """Also for a metre on a centimetre, although it sinks in so far that joints are reported as too soft."""
    result = answer(what, "dem-dynamic")
    assert result["worth"] == "right", result


@pytest.mark.parametrize(
    "what", ["block 1:50", "no equilibrium: overhang", "gap, 0.99 tolerances", "self-locking: one block pinned"]
)
def test_deformable_dynamic_model_is_right(what: str) -> None:
    result = answer(what, "fem")
    assert result["worth"] == "right", result


@pytest.mark.parametrize(("worth", "agrees"), [("right", True), ("wrong", False)])
def test_one_wrong_answer_does_not_agree_with_theory(worth: str, agrees: bool) -> None:
    rows = [{"wall": what, "model": model, "worth": "right"} for what in EXTREMES for model in MODELS]
    rows[0]["worth"] = worth
    (edge,) = (edge for edge in fits({PART: rows}) if edge.what.endswith(": wrong"))
    assert edge.agrees is agrees


@pytest.mark.parametrize("model", [limit, dem_static, dem_dynamic])
def test_multiplier_of_a_dry_wall_does_not_depend_on_size(model) -> None:  # type: ignore[no-untyped-def]
    """From 1 µm to 1 km with scaled stiffness, to rounding."""
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
def test_multipliers_are_printed_readably(value: float | tuple[float, float] | str, said: str) -> None:
    assert in_words(value) == said
