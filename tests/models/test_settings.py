"""Invalid settings of models and responses are refused by name, before anything runs."""

from typing import Any

import pytest

from dem.dynamic import dem_dynamic, dem_vibration
from dem.static import dem_static
from fem_interface.model import fem, fem_vibration
from homog import homog
from runningbond.limit import limit, limit_nonassociated
from runningbond.models import MODELS, Model, respond, run_model
from runningbond.models.registry import DRY
from runningbond.scene import SceneError
from runningbond.wall import Wall
from tests.walls import panel

VIBRATIONS = (dem_vibration, fem_vibration)
PANEL: dict[str, Any] = {"length": 0.48, "height": 0.12, "block_width": 0.24, "block_height": 0.06, "thickness": 0.12}
PANEL |= {"density": 1800.0, "friction": 0.6}
PULSE = {"pulse": {"kind": "sine", "amplitude": 0.1, "period": 0.5}, "quantity": "g"}


@pytest.mark.parametrize(
    ("model", "setting", "value", "said"),
    [
        ("dem-static", "first_step", 0, "must be a number above 0"),
        ("dem-static", "past", -1, "must be a whole number, at least 0"),
        ("dem-static", "budget", 1.5, "must be a whole number, at least 1"),
        ("dem-dynamic", "collapse", -1, "must be a number above 0"),
        ("dem-dynamic", "budget", True, "must be a whole number"),
        ("limit-nonassociated", "starts", "many", "must be a whole number"),
        ("limit-nonassociated", "workers", 0, "must be a whole number"),
        ("fem", "modes", 2, "modes = .*: must be 3, a number from 6 to 20"),
        ("fem", "modes", 4, "modes = .*: must be 3, a number from 6 to 20"),
        ("fem", "rule", "lobatto", "must be a Rule"),
        ("fem", "points", "element", 'did you mean "elements"'),
        ("fem", "loads", "x", 'must be one of "consistent", "inner"'),
        ("fem", "energies", "x", 'must be one of "given", "corrected", "printed"'),
        ("fem", "mass_scaling", "x", "must be True or False"),
    ],
)
def test_settings_out_of_range_are_refused(model: str, setting: str, value: Any, said: str) -> None:
    with pytest.raises(SceneError, match=said) as refused:
        run_model(model, panel(block__young=1e10), **{setting: value})
    assert str(refused.value).startswith(f"model {model}: {setting} = ")


@pytest.mark.parametrize("model", ["dem-dynamic", "fem"])
@pytest.mark.parametrize("setting", ["collapse", "first_step", "budget", "displacements"])
def test_load_step_settings_are_refused_for_ground_motion(model: str, setting: str) -> None:
    given: dict[str, Any] = {setting: 1}
    scene = panel(block__young=1e10, load__live=None, load__history=PULSE)
    with pytest.raises(SceneError, match=f"model {model}: {setting} = .*: is not supported where the ground moves"):
        run_model(model, scene, **given)


@pytest.mark.parametrize("model", [dem_dynamic, fem])
@pytest.mark.parametrize(
    ("setting", "value", "said"),
    [
        ("displacements", "nonsense", "must be one of"),
        ("displacements", "finite", "is not supported where the ground moves"),
        ("distance", -3.0, "must be a number above 0"),
        ("distance", 3.0, "goes with finite displacements"),
    ],
)
def test_displacements_and_distance_are_checked_for_ground_motion(
    model: Any, setting: str, value: Any, said: str
) -> None:
    scene = panel(block__young=1e10, load__live=None, load__history=PULSE)
    with pytest.raises(SceneError, match=f"{setting} = .*: {said}"):
        model(scene, **{setting: value})


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"scal": 2.0}, "scal = 2.0: is not a setting of a response; it has points, after, rows, observe"),
        ({"cells": 2}, "cells = 2: is not a setting"),
        ({"rows": 0}, "rows = 0: must be a whole number, at least 1"),
        ({"after": -1.0}, "after = -1.0: must be a number at least 0"),
        ({"after": "later"}, "after = 'later': must be a number at least 0"),
        ({"observe": 3}, "observe = 3: must be a function"),
        ({"scene": 3}, "scene = 3: is not a setting of a response"),
    ],
)
def test_invalid_response_settings_are_refused(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        respond("dem-dynamic", panel(load__live=None, load__history=PULSE), **settings)


@pytest.mark.parametrize("model", ["limit", "dem-static", "fem"])
def test_observer_must_be_a_function(model: str) -> None:
    with pytest.raises(SceneError, match="observe = 3: must be a function"):
        run_model(model, panel(block__young=1e10), observe=3)  # type: ignore[arg-type]


def test_all_models_but_homog_accept_custom_laws() -> None:
    assert [name for name, model in MODELS.items() if "joint.law" not in model.reads] == ["homog"]


def test_invalid_model_or_outcome_is_refused() -> None:
    with pytest.raises(SceneError, match=r"model = \['limit'\]: must be one of"):
        run_model(["limit"], panel())  # type: ignore[arg-type]
    with pytest.raises(SceneError, match="model mine = 0.3: must return an Outcome"):
        run_model(Model("mine", "a number", lambda scene, tolerance: 0.3, DRY), panel())  # type: ignore[arg-type, return-value]


def test_single_string_instead_of_names_is_refused() -> None:
    for name in ("reads", "parameters", "takes"):
        with pytest.raises(TypeError, match=f"{name} of a model must be several words, not 'joint.friction'"):
            Model("mine", "a number", print, **{"reads": DRY, name: "joint.friction"})  # type: ignore[arg-type]


def test_message_on_dead_point_loads_under_tilt() -> None:
    dead = {"kind": "point", "at": [0.0, 0.72], "force": [0, -100]}
    for tilted, loads in ((True, {"kind": "tilt"}), (False, {"kind": "lateral"})):
        message = run_model("limit", panel(load__live=loads, load__dead=dead)).message
        assert ("as jacks do and weights do not" in message) == tilted


@pytest.mark.parametrize("ask", [limit, limit_nonassociated, homog, dem_static, dem_dynamic, fem, *VIBRATIONS])
def test_wall_instead_of_scene_is_refused(ask: Any) -> None:
    """This once raised an AttributeError in the middle of a model."""
    for other in (Wall.running_bond(**PANEL), "panel-01"):
        with pytest.raises(SceneError, match=r"scene = .*: must be a Scene: of a Wall it is wall\.scene"):
            ask(other)
