"""Run a model on a scene."""

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from runningbond.results import Outcome
from runningbond.results.outcome import joined
from runningbond.scene import Scene, SceneError
from runningbond.scene.history import FACTOR

from .corners import left_out_corner
from .edges import rolls
from .model import Model
from .notes import does_not_crush, keeps_strength, led_far, left_out, moves, tilted_with_the_ground, without_mass
from .registry import MODELS, TOLERANCE, check_parameters, check_tolerance, find_model
from .settings import check_observer, check_response_settings, check_settings

if TYPE_CHECKING:
    from runningbond.response import Response  # needs a compiler

OF_RESPONSES = ("points", "after", "rows", "observe")  # settings of every response


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
        message = " ".join(f"{type(error).__name__}: {error}".split())  # compilers' messages have many lines
        return Outcome(scene.title, model.name, "failed", message=message)
    if not isinstance(outcome, Outcome):
        raise SceneError(f"model {model.name}", "must return an Outcome", outcome)
    finite = model.is_finite or parameters.get("displacements") == "finite"
    notes = [
        outcome.message,
        "" if finite else moves(model, scene, outcome, parameters.get("collapse")),
        "" if finite else led_far(model, scene, outcome),
        "" if finite else left_out_corner(model, scene, outcome),
        rolls(scene, outcome, tolerance) if finite else "",
        keeps_strength(model, scene),
        does_not_crush(model, scene),
        left_out(model, scene, finite),
    ]
    if outcome.multiplier is not None:
        notes += [load.note(outcome.multiplier) for load in scene.load.live]
        notes += [tilted_with_the_ground(scene), without_mass(scene)]
    return replace(outcome, model=model.name, message=joined(*notes))


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
    notes = impacts, beam_note(scene), without_mass(scene), left_out(find_model(model), scene)
    return replace(response, message=joined(response.message, *notes))
