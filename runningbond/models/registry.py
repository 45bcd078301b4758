"""The models, one object each, and all of them in `MODELS` by their names on the command line.

A user's own model is another `Model`: add it to `MODELS`, or pass it to `run_model`.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from importlib import import_module
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from runningbond.limit import elastic_displacement, limit, limit_nonassociated
from runningbond.own_packages import hidden_package, prefer_to_folders
from runningbond.results import Outcome
from runningbond.results.outcome import joined, two_digits
from runningbond.scene import Scene, SceneError
from runningbond.scene.history import FACTOR
from runningbond.scene.mass_loads import Tilt
from runningbond.scene.ranges import suggestion

from .model import Cost, Model
from .second_opinion import REFINEMENT, asks_others, beside_others
from .settings import check_observer, check_response_settings, check_settings

if TYPE_CHECKING:
    from runningbond.response import Response  # needs a compiler

DRY = frozenset({"block.density", "block.thickness", "joint.friction"})
STRENGTH = DRY | {"joint.law", "joint.cohesion", "joint.tensile_strength", "joint.inset", "inner_joint"}
CRUSHING = STRENGTH | {"joint.compressive_strength", "joint.cap_shear"}
STIFFNESS = STRENGTH | {"joint.mortar", "joint.normal_stiffness", "joint.shear_stiffness"}
SOFTENING = STIFFNESS | {"joint.fracture_energy_1", "joint.fracture_energy_2", "joint.softening"}
INTERFACE = SOFTENING | CRUSHING | {"joint.compressive_fracture_energy", "joint.peak_closure", "joint.closure"}
MOTION = INTERFACE | {"beam.drive.rate"}
ELASTIC = MOTION | {"block.young", "block.poisson"}

LED = {"beam.condition fixed-height", "beam.drive.displacement", "beam.drive.displacement, cyclic"}
EXTRAS = frozenset({"tie", "beam", "load.live settlement"} | LED)  # features (`Scene.extras`) of static models,
FOLLOWED = EXTRAS | {"load.live settlement, along a path"}  # and of models that follow a load path
KERNELS = 0.3  # seconds to load the compiled kernels of models that follow a load path
TOLERANCE = 0.01  # default relative width of the bracket
FAR_MOTION = 0.02  # limit of small motions, per smaller side of the wall: toppling resistance falls by this share
IN_STEPS = ("collapse", "first_step", "budget")  # settings of every model with load steps
OF_RESPONSES = ("points", "after", "rows", "observe")  # settings of every response
OF_BLOCKS = ("cells", "modes", "rule", "points", "cracks", "loads", "mass_scaling", "energies")  # for deformable blocks


def _homog(scene: Scene, tolerance: float) -> Outcome:
    outcome: Outcome = _late("homog", "homog", scene)
    return outcome


def _late(module: str, name: str, *arguments: Any, **settings: Any) -> Any:
    """Import a module of a method's package, or one that needs a compiler or VTK, and call its function or class."""
    prefer_to_folders()  # the working directory may have gained folders of these names since the import of the suite
    hidden = hidden_package(module)
    if hidden is not None:
        raise SceneError("import", hidden)
    return getattr(import_module(module), name)(*arguments, **settings)


_DEM_STATIC, _DEM_DYNAMIC = partial(_late, "dem.static", "dem_static"), partial(_late, "dem.dynamic", "dem_dynamic")


def _fem(scene: Scene, tolerance: float, **settings: Any) -> Outcome:
    deformable = partial(_late, "fem_interface.model", "fem", scene, tolerance)
    outcome: Outcome = deformable(**settings)
    if not asks_others(scene, settings):
        return outcome
    chosen = {key: value for key, value in settings.items() if key in (*IN_STEPS, *OF_BLOCKS)}
    steps = {key: value for key, value in chosen.items() if key in IN_STEPS}
    turn_to = getattr(settings.get("observe"), "turn_to", None)

    def observed(other: str) -> dict[str, Any]:
        return {} if turn_to is None else {"observe": turn_to(other)}

    return beside_others(
        outcome,
        lambda: _DEM_DYNAMIC(scene, tolerance, **steps, **observed("with rigid blocks")),
        lambda: deformable(**chosen | {"cells": REFINEMENT}, **observed(f"on a mesh {REFINEMENT} times as fine")),
    )


_RECORDER = partial(_late, "runningbond.pictures.recording")
_PROGRESS = partial(_late, "runningbond.pictures.progress")
_IN_MOTION: dict[str, Any] = {"interruptible": True, "takes": FOLLOWED | {"load.history"}}
_IN_MOTION |= {"observer": partial(_RECORDER, "motion_recorder"), "progress": partial(_PROGRESS, "MotionProgress")}

_EVERY_MODEL = (
    Model(
        *("homog", "homogenised continuum in closed form", _homog, DRY),
        cost=Cost(0.00029, 0.97, 1.69),
        colour="black",
        marker="_",
        line=(0, (6, 4)),
    ),
    Model(
        *("limit", "limit analysis of the blocks", limit, CRUSHING, "bound"),
        interruptible=True,
        takes=EXTRAS,
        cost=Cost(0.035, 1.34, 1.70, weightless=0.69, start=0.012, crushed=37.0),
        colour="#606fc6",
        marker="o",
    ),
    Model(
        *("limit-nonassociated", "limit analysis with friction that does not dilate", limit_nonassociated, STRENGTH),
        kind="certificate",
        takes=EXTRAS,
        parameters=("starts", "workers", "programs"),
        progress=partial(_PROGRESS, "SearchProgress"),
        interruptible=True,
        cost=Cost(5.0, 0.69, 1.82, weightless=1.2),
        colour="#9b471c",
        marker="s",
    ),
    Model(
        *("dem-static", "equilibrium of rigid blocks, load by load", _DEM_STATIC, STIFFNESS, "history"),
        parameters=(*IN_STEPS, "past"),
        observer=partial(_RECORDER, "StaticRecorder"),
        progress=partial(_PROGRESS, "StaticProgress"),
        interruptible=True,
        cost=Cost(0.49, 1.76, 1.48, weightless=0.72, finer=0.24, start=KERNELS),
        takes=FOLLOWED,
        colour="#420697",
        marker="v",
    ),
    Model(
        *("dem-dynamic", "rigid blocks in motion", _DEM_DYNAMIC, MOTION, "history"),
        parameters=(*IN_STEPS, "displacements", "distance"),
        cost=Cost(1.0, 1.19, 1.40, weightless=1.2, finer=0.17, start=KERNELS, softened=4.0, crushed=11.0),
        respond=partial(_late, "dem.dynamic", "dem_response"),
        **_IN_MOTION,
        colour="#349f8a",
        marker="^",
        line=":",
    ),
    Model(
        *("fem", "deformable blocks in motion", _fem, ELASTIC, "history"),
        parameters=(*IN_STEPS, *OF_BLOCKS, "displacements", "distance"),
        cost=Cost(
            *(3.2, 1.08, 1.43),
            weightless=1.4,
            finer=0.16,
            start=KERNELS,
            cracked=10.0,
            softened=2.2,
            crushed=4.3,
            soft=2.1,
        ),
        respond=partial(_late, "fem_interface.model", "fem_response"),
        **_IN_MOTION,
        colour="#7e2a55",
        marker="D",
        line=(0, (3, 1, 1, 1)),
    ),
)

MODELS: dict[str, Model] = {model.name: model for model in _EVERY_MODEL}
"""Every model by its name, the cheapest first."""

MODEL_LOOKS = {model.name: (model.colour, model.marker) for model in _EVERY_MODEL}  # in charts


def find_model(model: str | Model, key: str = "model") -> Model:
    """The model with a name, or a `SceneError` under `key` (a key or option); a `Model` is returned as it is."""
    if isinstance(model, Model):
        return model
    if not isinstance(model, str) or model not in MODELS:
        raise SceneError(key, f"must be one of {', '.join(MODELS)}{suggestion(model, list(MODELS))}", model)
    return MODELS[model]


def check_tolerance(tolerance: float, key: str = "tolerance") -> None:
    """Refuse a tolerance that is no relative width, under its key or option."""
    if not (isinstance(tolerance, Real) and math.isfinite(tolerance) and 0 < tolerance < 1):
        raise SceneError(key, "must be a number above 0 and below 1", tolerance)


def check_parameters(model: Model, parameters: Mapping[str, Any]) -> None:
    """Refuse settings that a model does not have."""
    for name, value in parameters.items():
        if name not in model.parameters:
            own = ", ".join(model.parameters) or "none"
            raise SceneError(f"model {model.name}: {name}", f"is not a parameter of it; it has {own}", value)


def run_model(
    model: str | Model,
    scene: Scene,
    tolerance: float = TOLERANCE,
    observe: Callable[..., None] | None = None,
    **parameters: Any,
) -> Outcome:
    """Run a model.

    Parameters
    ----------
    model
        A key of `MODELS`, or a model.
    tolerance
        Requested relative width of the bracket.
    observe
        Called with the states that the model passes through, if the model has an observer or reports progress.
    parameters
        Settings of the model, by their names.

    Returns
    -------
    Outcome
        The message ends with the keys of the scene that the model does not take into account. The status is ``failed``,
        with the error message, if the model raised an error; an unknown model or parameter, or a model that does not
        apply to the scene, raises a `SceneError`.
    """
    model = find_model(model)
    check_tolerance(tolerance)
    check_parameters(model, parameters)
    if observe is not None:
        check_observer("observe", observe)
    model.check(scene)
    if model.name in MODELS:  # also one that `going_far` has set to finite displacements
        check_settings(model.name, scene, parameters)
    if observe is not None and (model.observer or model.progress):
        parameters["observe"] = observe
    try:
        outcome = model.solve(scene, tolerance, **parameters)
    except SceneError:
        raise
    except Exception as error:  # a bug in the suite must not abort a campaign, nor end in a traceback
        return Outcome(scene.title, model.name, "failed", message=f"{type(error).__name__}: {error}")
    if not isinstance(outcome, Outcome):
        raise SceneError(f"model {model.name}", "must return an Outcome", outcome)
    finite = model.is_finite or parameters.get("displacements") == "finite"
    notes = [
        outcome.message,
        "" if finite else _moves(model, scene, outcome, parameters.get("collapse")),
        "" if finite else _led_far(model, scene, outcome),
        _keeps_strength(model, scene),
        _left_out(model, scene, finite),
    ]
    if outcome.multiplier is not None:
        notes += [load.note(outcome.multiplier) for load in scene.load.live]
        notes += [_tilted_with_the_ground(scene)]
    return replace(outcome, model=model.name, message=joined(*notes))


def _moves(model: Model, scene: Scene, outcome: Outcome, collapse: float | None) -> str:
    """Note for a wall that has moved beyond small displacements at the largest load at which it is at rest.

    Its joints may deform elastically by more than `collapse` [heights of a block], or they have opened, and the wall
    hangs on soft ties.
    """
    if model.kind != "history" or scene.is_led or scene.history or outcome.status != "collapse" or not outcome.upper:
        return ""
    from dem.static import FALLEN

    if "block.young" not in model.reads:
        scene = scene.with_rigid_blocks()
    gives = (elastic_displacement(scene, outcome.upper) or 0.0) / scene.lowest_block
    moved, load = outcome.curve.T
    low, high = scene.blocks.extent(scene.wall)
    rests = np.abs(moved[load == outcome.lower]) / (high - low).min()
    moved = rests[0] if len(rests) else 0.0
    height, side = (f"{two_digits(100 * share)} % of" for share in (gives, moved))
    soft = f"joints are too soft: the wall gives by {height} a block's height elastically, beyond small displacements"
    far = f"at the largest load at rest the wall has moved by {side} its smaller side, beyond small displacements"
    return joined(soft if gives > (FALLEN if collapse is None else collapse) else "", far if moved > FAR_MOTION else "")


def _led_far(model: Model, scene: Scene, outcome: Outcome) -> str:
    """Note for a wall with prescribed displacements of its support or beam that are not small."""
    if model.kind != "history" or model.is_finite or not scene.is_led or not len(outcome.curve):
        return ""
    low, high = scene.blocks.extent(scene.wall)
    share = float(np.abs(outcome.curve[:, 0]).max() / (high - low).min())
    led = f"{'the support' if scene.settlement else 'the beam'} goes by {two_digits(100 * share)} %"
    follows = "; finite ones follow it" if "displacements" in model.parameters and _may_go_far(scene) else ""
    return f"{led} of the wall's smaller side, beyond small displacements{follows}" if share > FAR_MOTION else ""


def _may_go_far(scene: Scene) -> bool:
    """Whether a wall with prescribed displacements can be analysed at finite displacements."""
    from runningbond.dynamics.rig import check_finite

    try:
        check_finite(scene)
    except SceneError:
        return False
    return True


def _tilted_with_the_ground(scene: Scene) -> str:
    """Note for dead loads other than weights, if the ground tilts."""
    tilts = any(isinstance(load, Tilt) for load in scene.load.live)
    if not tilts or not len(scene.dead_forces.force):
        return ""
    return "dead loads at points and along lines turn with the ground, as jacks do and weights do not"


def _keeps_strength(model: Model, scene: Scene) -> str:
    """Note for joints that lose strength, if the model does not include this; else empty."""
    joints = scene.materials_of_joints
    loses = {
        "joint.fracture_energy_1": any(each.softens for each in joints),
        "joint.compressive_fracture_energy": any(each.compressive_fracture_energy is not None for each in joints),
    }
    kept = any(lost and key not in model.reads for key, lost in loses.items())
    return "joints are taken to keep the strength that they lose as they break: the wall may bear less" if kept else ""


def _left_out(model: Model, scene: Scene, finite: bool = False) -> str:
    """Note on the keys of a scene that a model does not take into account; empty if it reads all."""
    unread = model.unread(scene, finite=finite)
    return f"not taken into account: {', '.join(unread)}" if unread else ""


def check_response(
    model: str | Model, scene: Scene, scale: float, model_key: str = "model", scale_key: str = "scale"
) -> "Callable[..., Response]":
    """Check that a model can compute the response of a scene to its ground motion; return its `Model.respond`.

    Raises
    ------
    SceneError
        For a model without response to ground motion, a scene without ground motion, or a scale that is zero or no
        number.
    """
    model = find_model(model, model_key)
    if model.respond is None:
        able = ", ".join(name for name, each in MODELS.items() if each.respond)
        raise SceneError(model_key, f"follows no motion of the ground; take {able}", model.name)
    if scene.history is None:
        raise SceneError("load.history", "is missing: the motion of the ground that the wall is to follow")
    model.check(scene)
    if not FACTOR.take(scale_key, scale):
        raise SceneError(scale_key, "must not be zero", scale)
    return model.respond


def respond(model: str | Model, scene: Scene, /, scale: float = 1.0, **settings: Any) -> "Response":
    """Compute the response of a scene to its ground motion times `scale`; settings as for `response.follow`.

    The response's message ends with the keys of the scene that the model does not take into account.

    Raises
    ------
    SceneError
        As in `check_response`, and for unknown settings.
    """
    follow = check_response(model, scene, scale)
    own = (*OF_RESPONSES, "cells", "modes") if find_model(model).name == "fem" else OF_RESPONSES
    check_response_settings(settings, own)
    from runningbond.dynamics import beam_note
    from runningbond.joints import impact_note

    response = follow(scene, scale, **settings)
    impacts = impact_note(scene) if len(response.time) else ""
    notes = impacts, beam_note(scene), _left_out(find_model(model), scene)
    return replace(response, message=joined(response.message, *notes))
