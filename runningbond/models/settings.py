"""Checks of the settings of the package's own models, before a model runs."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from runningbond.joints.points import Rule
from runningbond.scene import Scene, SceneError
from runningbond.scene.ranges import ABOVE_ZERO, AT_LEAST_ZERO, check_whole_number

Check: TypeAlias = Callable[[str, object], object]
"""Function that refuses an invalid value under a key."""


def _true_or_false(key: str, value: object) -> None:
    if not isinstance(value, (bool, np.bool_)):
        raise SceneError(key, "must be True or False", value)


def _modes(key: str, value: Any) -> None:
    from fem_interface.modes import degree_of

    degree_of(value, key)


def _rule(key: str, value: object) -> None:
    if not isinstance(value, Rule):
        raise SceneError(key, "must be a Rule of runningbond.joints.points, of nodes and weights", value)


def check_observer(key: str, value: object) -> None:
    """Refuse an observer that cannot be called."""
    if not callable(value):
        raise SceneError(key, "must be a function, which is shown the states that the model passes through", value)


CHECKS: Mapping[str, Check] = {
    "collapse": ABOVE_ZERO.take,
    "first_step": ABOVE_ZERO.take,
    "budget": check_whole_number,
    "past": partial(check_whole_number, least=0),
    "starts": check_whole_number,
    "workers": check_whole_number,
    "programs": check_whole_number,
    "mass_scaling": _true_or_false,
    "modes": _modes,
    "rule": _rule,
}
"""Checks of settings, by their names; others are checked where they are used."""

OPTIONAL = ("programs", "modes", "rule")
"""Settings that may also be None."""

NOT_IN_MOTION = ("collapse", "first_step", "budget", "displacements", "distance")
"""Settings that are meaningless if the ground moves."""

OF_MOTIONS: Mapping[str, Check] = {"rows": check_whole_number, "after": AT_LEAST_ZERO.take, "observe": check_observer}
"""Checks of settings of a response."""


def check_settings(model: str, scene: Scene, settings: Mapping[str, Any]) -> None:
    """Refuse settings of one of the package's models that are out of range, or meaningless for a scene."""
    for name, value in settings.items():
        key = f"model {model}: {name}"
        if scene.history and name in NOT_IN_MOTION:
            raise SceneError(key, "is not supported where the ground moves; leave it out", value)
        if name in CHECKS and not (value is None and name in OPTIONAL):
            CHECKS[name](key, value)


def check_response_settings(settings: Mapping[str, Any], known: tuple[str, ...]) -> None:
    """Refuse settings of a response that are unknown or out of range."""
    for name, value in settings.items():
        if name not in known:
            raise SceneError(name, f"is not a setting of a response; it has {', '.join(known)}", value)
        if name in OF_MOTIONS:
            OF_MOTIONS[name](name, value)
