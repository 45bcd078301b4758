"""Models set to finite displacements, which a user may request in addition to a model's name."""

from dataclasses import replace
from functools import partial

from runningbond.scene import Scene, SceneError
from runningbond.scene.ranges import ABOVE_ZERO, one_of

from .model import Model
from .registry import MODELS


def going_far(model: Model, displacements: str, distance: float | None, flag: str = "") -> Model:
    """The model as it is, or set to finite displacements if ``"finite"`` ones are requested.

    Parameters
    ----------
    model
        The model.
    displacements
        ``"small"`` or ``"finite"``.
    distance
        How far live loads push the wall at finite displacements [m]; None leaves this to the model.
    flag
        Prefix of the names of both settings in error messages: dashes for command-line options.

    Raises
    ------
    SceneError
        For displacements that the model does not support, or a distance that it would not use.
    """
    key = f"{flag}displacements"
    if one_of(key, displacements, ("small", "finite")) == "small":
        if distance is not None:
            far = f"{key} finite" if flag else f'{key}="finite"'
            raise SceneError(f"{flag}distance", f"goes with {far} alone", distance)
        return model
    if "displacements" not in model.parameters:
        able = " and ".join(name for name, each in MODELS.items() if "displacements" in each.parameters)
        raise SceneError(key, f'must be "small" for {model.name}; {able} follow finite ones', displacements)
    if distance is not None:
        ABOVE_ZERO.take(f"{flag}distance", distance)
    far_model = partial(model.solve, displacements=displacements, distance=distance)
    return replace(model, solve=far_model, is_finite=True)


def check_goes_far(model: Model, scene: Scene, displacements: str, distance: float | None, flag: str = "") -> None:
    """Refuse a wall that cannot be analysed at finite displacements, if these are requested, before anything is run."""
    if displacements == "small":
        return
    from runningbond.dynamics.displacements import are_finite, check_finite  # these need a compiler

    try:
        are_finite(displacements, model.name, scene, distance)
    except SceneError as error:
        raise SceneError(f"{flag}{error.key.split()[-1]}", error.remedy, error.value) from None
    check_finite(scene)
