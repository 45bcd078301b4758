"""Sweeps: one model on every combination of changes of a wall."""

from collections.abc import Iterable, Mapping
from itertools import product
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .campaigns import ctrl_c_passed_on, run_campaign
from .campaigns.fingerprint import fingerprint
from .likely_slips import warn_of_likely_slips
from .models import TOLERANCE, Model, find_model
from .models.far import check_goes_far, going_far
from .results import make_folder
from .scene import Scene, SceneError
from .scene.ranges import path_of
from .tables import Table, table
from .wall import Wall

ANSWER = ("multiplier", "lower", "upper", "status", "seconds", "message")
"""Columns of a sweep's table after the keys that vary."""


def check_wall(wall: object) -> None:
    """Raise a `SceneError` for anything but a `Wall`."""
    if not isinstance(wall, Wall):
        raise SceneError("wall", "must be a Wall, as rb.read gives one", wall)


def sweep(
    wall: Wall,
    changes: Mapping[str, Iterable[Any]],
    model: str | Model,
    *,
    tolerance: float = TOLERANCE,
    displacements: Literal["small", "finite"] = "small",
    distance: float | None = None,
    folder: str | Path | None = None,
    jobs: int = -1,
) -> Table:
    """Run a model on every combination of changes of a wall.

    Parameters
    ----------
    wall
        The wall.
    changes
        Values of each key that varies, by its full name: ``{"joint.friction": [0.4, 0.6]}``.
    model
        Name of a model, or a user-defined `Model`.
    tolerance
        Requested relative width of the brackets.
    displacements, distance
        Small or finite displacements, and the distance to which live loads push walls at finite ones [m].
    folder
        Folder of the outcomes; a sweep with the same folder computes only those that are missing. None saves nothing.
    jobs
        Number of processes; −1 is one per core.

    Returns
    -------
    Table
        One row per combination, the last key varying fastest: the values of the keys, then `ANSWER`. Combinations that
        are no valid wall, or to which the model does not apply, have the status ``refused`` and the reason as message.

    Raises
    ------
    SceneError
        If the model does not support the displacements, a key has no values, or no combination is a valid wall, for
        example because a key is misspelt.
    """
    model = going_far(find_model(model), displacements, distance)
    check_wall(wall)
    values_of = _values_of(changes)
    cases = [dict(zip(values_of, values, strict=True)) for values in product(*values_of.values())]
    scenes: dict[str, Scene] = {}
    names: list[str] = []
    refusals: dict[tuple[str, str], SceneError] = {}
    for number, case in enumerate(cases):
        try:
            scene = wall.with_(case).scene
            name = _name(scene, model, tolerance)
        except SceneError as refusal:
            names.append(f"case {number}")
            refusals[names[-1], model.name] = refusal
        else:
            names.append(name)
            scenes[name] = scene
    if refusals and not scenes:
        raise next(iter(refusals.values()))
    for name, scene in list(scenes.items()):
        try:
            check_goes_far(model, scene, displacements, distance)
        except SceneError as refusal:
            refusals[name, model.name] = refusal
            del scenes[name]
    kept_in = None if folder is None else path_of("folder", folder)
    if kept_in is not None:
        make_folder(kept_in)
    warn_of_likely_slips(scenes.values())
    with ctrl_c_passed_on():
        campaign = run_campaign(scenes, [model], folder=kept_in, tolerance=tolerance, jobs=jobs)
    answers = {cell: outcome.summary() for cell, outcome in campaign.outcomes.items()}
    for cell, reason in (refusals | campaign.inapplicable).items():
        answers[cell] = {"status": "refused", "message": str(reason)}
    rows = [{**answers[name, model.name], **case} for name, case in zip(names, cases, strict=True)]
    return table({key: [row.get(key) for row in rows] for key in (*values_of, *ANSWER)})


def _name(scene: Scene, model: Model, tolerance: float) -> str:
    """Name of a case after its input, so that its outcome is reused when keys or values are added."""
    try:
        return fingerprint(scene, model, tolerance)[:16]
    except SceneError:
        raise
    except Exception as error:  # raised by the user's load, whose forces are part of the input
        raise SceneError("load", f"raises {type(error).__name__}: {error}") from error


def _values_of(changes: object) -> dict[str, list[Any]]:
    """The values of each key that varies, checked."""
    if not isinstance(changes, Mapping):
        remedy = 'must be lists of values by the full names of keys, {"joint.friction": [0.7]}'
        raise SceneError("changes", remedy, changes)
    for key, values in changes.items():
        if key in ANSWER:
            raise SceneError(key, "is no key of a scene, but a column of the sweep's table", values)
        is_single = isinstance(values, (str, bytes, Mapping)) or (isinstance(values, np.ndarray) and not values.ndim)
        if is_single or not isinstance(values, Iterable):
            raise SceneError(key, "must be a list of the values that it is to take", values)
    found = {key: list(values) for key, values in changes.items()}
    for key, values in found.items():
        if not values:
            raise SceneError(key, "must have one value or more to take", values)
    return found
