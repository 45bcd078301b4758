"""Models at finite displacements."""

from dataclasses import replace
from typing import Any

import pytest

from runningbond.models import MODELS, run_model
from runningbond.models.far import going_far
from runningbond.scene import SceneError
from tests.walls import panel


def test_going_far_passes_displacements_and_distance() -> None:
    """The settings are passed to the model; for small displacements the model is unchanged."""
    asked: list[dict[str, Any]] = []

    def solve(*_: Any, **keys: Any) -> Any:
        asked.append(keys)

    model = replace(MODELS["dem-dynamic"], solve=solve)
    assert going_far(model, "small", None) is model
    far = going_far(model, "finite", 0.25)
    far.solve(None, 0.1)
    assert asked == [{"displacements": "finite", "distance": 0.25}]
    assert far.is_finite
    assert not model.is_finite
    assert far.name == model.name


@pytest.mark.parametrize(
    ("name", "displacements", "distance", "said"),
    [
        ("dem-dynamic", "small", 0.1, 'distance = 0.1: goes with displacements="finite" alone'),
        ("dem-dynamic", "finite", 0.0, "distance = 0.0: must be a number above 0"),
        ("dem-dynamic", "large", None, "displacements = 'large': must be one of"),
        ("limit", "finite", None, "displacements = 'finite': must be \"small\" for limit; "),
    ],
)
def test_unsupported_displacements_are_refused(
    name: str, displacements: str, distance: float | None, said: str
) -> None:
    with pytest.raises(SceneError) as refused:
        going_far(MODELS[name], displacements, distance)
    assert str(refused.value).startswith(said)


@pytest.mark.parametrize("name", ["dem-dynamic", "fem"])
def test_settings_are_checked_at_finite_displacements_too(name: str) -> None:
    far = going_far(MODELS[name], "finite", None)
    with pytest.raises(SceneError, match=f"model {name}: collapse = -1.0: must be a number above 0"):
        run_model(far, panel(block__young=1e10), collapse=-1.0)
