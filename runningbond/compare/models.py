"""The models that exist, by the names the command line knows them by."""

import difflib
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeAlias

from dem import limit_nonassociated
from homog import homog
from runningbond.limit import limit
from runningbond.results import Outcome
from runningbond.scene import Scene, SceneError

if TYPE_CHECKING:
    from dem.pushover import StaticObserver
    from runningbond.dynamics import Observer

Model: TypeAlias = Callable[..., Outcome]
"""From a scene and the relative width of the bracket asked for, and an observer where it has any, to an outcome."""


def _dem_static(scene: Scene, tolerance: float, observe: "StaticObserver | None" = None, **asked: Any) -> Outcome:
    """`dem.static.dem_static`, imported when it is wanted, as `_dem_dynamic` is."""
    from dem.pushover import nobody
    from dem.static import dem_static

    return dem_static(scene, tolerance, observe=observe or nobody, **asked)


def _dem_dynamic(scene: Scene, tolerance: float, observe: "Observer | None" = None) -> Outcome:
    """`dem.dynamic.dem_dynamic`, imported when it is wanted, for its compiler takes a second to load."""
    from dem.dynamic import dem_dynamic
    from runningbond.dynamics import nobody

    return dem_dynamic(scene, tolerance, observe=observe or nobody)


def _fem(scene: Scene, tolerance: float, observe: "Observer | None" = None, **asked: Any) -> Outcome:
    """`fem_interface.model.fem`, imported when it is wanted; whether a wall locks is asked of its rigid blocks."""
    from fem_interface.model import fem
    from runningbond.dynamics import nobody
    from runningbond.limit.associated import is_self_locking

    return fem(scene, tolerance, locks=lambda: is_self_locking(scene), observe=observe or nobody, **asked)


MODELS: dict[str, Model] = {
    "homog": lambda scene, tolerance: homog(scene),
    "limit": limit,
    "limit-nonassociated": limit_nonassociated,
    "dem-static": _dem_static,
    "dem-dynamic": _dem_dynamic,
    "fem": _fem,
}

IN_MOTION = ("dem-dynamic", "fem")
"""Models that bring blocks forward in time, and can be stopped with an answer so far."""

OBSERVED = ("dem-static", *IN_MOTION)
"""Models whose states can be observed as they are found."""

TOLERANCE = 0.01


def check_model(name: str, option: str = "--model") -> None:
    """Refuse a name that is no model's."""
    if name not in MODELS:
        likely = difflib.get_close_matches(name, MODELS, n=1)
        hint = f'; did you mean "{likely[0]}"?' if likely else ""
        raise SceneError(option, f"must be one of {', '.join(MODELS)}{hint}", name)


def check_tolerance(tolerance: float) -> None:
    """Refuse a tolerance that is no relative width."""
    if not (math.isfinite(tolerance) and 0 < tolerance < 1):
        raise SceneError("--tolerance", "must be a number above 0 and below 1", tolerance)


def run_model(
    name: str,
    scene: Scene,
    tolerance: float = TOLERANCE,
    observe: "Observer | StaticObserver | None" = None,
    **asked: Any,
) -> Outcome:
    """Run a model by name.

    Parameters
    ----------
    name
        A key of `MODELS`.
    scene
        The scene.
    tolerance
        Relative width of the bracket asked for.
    observe
        Looks at the states of a model of `OBSERVED`, of its own kind; others are not observed.
    asked
        What else is asked of that model, by its own names.

    Returns
    -------
    Outcome
        ``failed``, with the error's own words, where the model broke.

    Raises
    ------
    SceneError
        For an unknown model, or one that does not apply to the scene.
    """
    check_model(name)
    check_tolerance(tolerance)
    try:
        if observe is not None and name in OBSERVED:
            return MODELS[name](scene, tolerance, observe=observe, **asked)
        return MODELS[name](scene, tolerance, **asked)
    except SceneError:
        raise
    except Exception as error:  # a defect of ours must not lose a campaign, nor end in a traceback
        return Outcome(scene.title, name, "failed", message=f"{type(error).__name__}: {error}")
