"""Settings of models and of responses: out of range they are refused by name, before anything runs."""

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
def test_settings_of_load_steps_mean_nothing_where_the_ground_moves(model: str, setting: str) -> None:
    given: dict[str, Any] = {setting: 1}
    scene = panel(block__young=1e10, load__live=None, load__history=PULSE)
    with pytest.raises(SceneError, match=f"model {model}: {setting} = .*: is not taken where the ground moves"):
        run_model(model, scene, **given)


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
def test_settings_of_a_response_are_refused_before_it_is_followed(settings: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        respond("dem-dynamic", panel(load__live=None, load__history=PULSE), **settings)


@pytest.mark.parametrize("model", ["limit", "dem-static", "fem"])
def test_what_is_to_look_on_is_a_function(model: str) -> None:
    with pytest.raises(SceneError, match="observe = 3: must be a function"):
        run_model(model, panel(block__young=1e10), observe=3)  # type: ignore[arg-type]


def test_a_law_of_ones_own_is_read_by_the_models_that_are_handed_it() -> None:
    assert [name for name, model in MODELS.items() if "joint.law" not in model.reads] == ["homog"]


def test_what_is_no_model_or_no_outcome_is_told() -> None:
    with pytest.raises(SceneError, match=r"model = \['limit'\]: must be one of"):
        run_model(["limit"], panel())  # type: ignore[arg-type]
    with pytest.raises(SceneError, match="model mine = 0.3: must return an Outcome"):
        run_model(Model("mine", "a number", lambda scene, tolerance: 0.3, DRY), panel())  # type: ignore[arg-type, return-value]


def test_a_model_does_not_read_the_letters_of_a_word() -> None:
    for name in ("reads", "parameters", "takes"):
        with pytest.raises(TypeError, match=f"{name} of a model must be several words, not 'joint.friction'"):
            Model("mine", "a number", print, **{"reads": DRY, name: "joint.friction"})  # type: ignore[arg-type]


def test_dead_loads_that_are_no_weights_are_told_of_where_the_ground_tilts() -> None:
    dead = {"kind": "point", "at": [0.0, 0.72], "force": [0, -100]}
    for tilted, loads in ((True, {"kind": "tilt"}), (False, {"kind": "lateral"})):
        message = run_model("limit", panel(load__live=loads, load__dead=dead)).message
        assert ("as jacks do and weights do not" in message) == tilted


@pytest.mark.parametrize("ask", [limit, limit_nonassociated, homog, dem_static, dem_dynamic, fem, *VIBRATIONS])
def test_a_wall_in_place_of_its_scene_is_refused_by_name(ask: Any) -> None:
    """It was an error of an attribute that a wall has not, in the middle of a model."""
    for other in (Wall.running_bond(**PANEL), "panel-01"):
        with pytest.raises(SceneError, match=r"scene = .*: must be a Scene: of a Wall it is wall\.scene"):
            ask(other)
