"""Sweeps: one model on every combination of changes of a wall."""

from collections.abc import Iterable, Mapping
from contextlib import ExitStack
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from .compare.campaign import Campaign, Interrupted, run_campaign
from .compare.fingerprint import fingerprint
from .compare.models import TOLERANCE, check_model
from .scene import Scene, SceneError
from .tables import Table, table
from .wall import Wall

ANSWER = ("multiplier", "lower", "upper", "status", "seconds", "message")
"""Columns of a sweep's table after the keys that vary."""


def sweep(
    wall: Wall,
    changes: Mapping[str, Iterable[Any]],
    model: str,
    *,
    tolerance: float = TOLERANCE,
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
        Name of the model.
    tolerance
        Relative width of the brackets asked for.
    folder
        Where outcomes are kept; a sweep with the same folder computes only what is not there. None keeps nothing.
    jobs
        Number of processes; −1 is one a core.

    Returns
    -------
    Table
        A row a combination, the last key varying fastest: the values of the keys, then `ANSWER`. Combinations that
        describe no wall, or to which the model does not apply, have the status ``refused`` and say why.
    """
    check_model(model, "model")
    for key, values in changes.items():
        if not isinstance(values, Iterable) or isinstance(values, (str, Mapping)):
            raise SceneError(key, "must be a list of the values that it is to take", values)
    cases = [dict(zip(changes, values, strict=True)) for values in product(*changes.values())]
    built = [_scene(wall, case) for case in cases]
    # Named after what they are computed from, outcomes are found again when keys or values are added.
    names = [fingerprint(found, model, tolerance)[:16] if isinstance(found, Scene) else "" for found in built]
    scenes = {name: found for name, found in zip(names, built, strict=True) if isinstance(found, Scene)}
    campaign = _campaign(scenes, model, tolerance, folder, jobs)
    columns: dict[str, list[Any]] = {name: [] for name in (*changes, *ANSWER)}
    for case, name, found in zip(cases, names, built, strict=True):
        refusal = str(found) if isinstance(found, SceneError) else campaign.inapplicable.get((name, model))
        answer = {"status": "refused", "message": refusal}
        row = {**case, **(answer if refusal is not None else campaign.outcomes[name, model].summary())}
        for key, column in columns.items():
            column.append(row.get(key))
    return table(columns)


def _scene(wall: Wall, case: Mapping[str, Any]) -> Scene | SceneError:
    """The scene of a changed wall, or why there is none."""
    try:
        return wall.with_(case).scene
    except SceneError as refusal:
        return refusal


def _campaign(scenes: dict[str, Scene], model: str, tolerance: float, folder: str | Path | None, jobs: int) -> Campaign:
    with ExitStack() as stack:
        where = Path(folder if folder is not None else stack.enter_context(TemporaryDirectory()))
        try:
            return run_campaign(scenes, [model], folder=where, tolerance=tolerance, jobs=jobs)
        except Interrupted as stopped:
            if stopped.reason:
                raise
            raise KeyboardInterrupt from None
