"""Models that follow walls through finite displacements, where these are asked for beside a model's name."""

from dataclasses import replace
from functools import partial

from runningbond.scene import Scene, SceneError
from runningbond.scene.ranges import ABOVE_ZERO, one_of

from .model import Model
from .registry import MODELS


def going_far(model: Model, displacements: str, distance: float | None, flag: str = "") -> Model:
    """A model as it is, or, where ``"finite"`` displacements are asked for, as it follows walls through them.

    Parameters
    ----------
    model
        The model.
    displacements
        ``"small"`` or ``"finite"``.
    distance
        How far live loads push walls at finite ones [m]; None leaves that to the model.
    flag
        What stands before the names of both where they were given: dashes, for options.

    Raises
    ------
    SceneError
        For displacements that the model does not know, or a distance that it would not read.
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
    """Refuse finite displacements of a wall that cannot be followed through them, before anything is run."""
    if displacements == "small":
        return
    from runningbond.dynamics.rig import check_finite, is_finite  # which need a compiler

    try:
        is_finite(displacements, model.name, scene, distance)
    except SceneError as error:
        raise SceneError(f"{flag}{error.key.split()[-1]}", error.remedy, error.value) from None
    check_finite(scene)
