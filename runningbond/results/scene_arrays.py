"""Conversion of a scene to arrays and back, so that a result is stored together with its wall."""

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import runningbond.scene
from runningbond.joints import Law
from runningbond.scene import Action, GivenForces, Scene

DATACLASSES: dict[str, Any] = {
    name: part for name, part in vars(runningbond.scene).items() if isinstance(part, type) and is_dataclass(part)
}
"""Dataclasses that scenes consist of, by name."""

SCENE_KEY = "scene"
"""Name of the array with the scene's texts and numbers (JSON in UTF-8), and prefix of the names of its other arrays."""


def scene_to_arrays(scene: Scene) -> dict[str, NDArray[Any]]:
    """Return arrays that describe a scene completely, under names that start with ``scene``.

    For a user-defined load they contain its forces and its control point; for a joint law, only its name.
    """
    arrays: dict[str, NDArray[Any]] = {}

    def encoded(value: object, name: str) -> object:
        if isinstance(value, Law):
            return {"named": value.name}
        if isinstance(value, Action) and type(value).__name__ not in DATACLASSES:
            value = GivenForces(value.forces(scene), value.control(scene))
        if isinstance(value, tuple):
            return [encoded(inner, f"{name}.{k}") for k, inner in enumerate(value)]
        if is_dataclass(value):
            inner = {field.name: encoded(getattr(value, field.name), f"{name}.{field.name}") for field in fields(value)}
            return {"part": type(value).__name__, **inner}
        if isinstance(value, np.ndarray):
            arrays[name] = value
            return {"array": name}
        return value

    arrays[SCENE_KEY] = np.frombuffer(json.dumps(encoded(scene, SCENE_KEY)).encode(), dtype=np.uint8)
    return arrays


def scene_from_arrays(arrays: Mapping[str, NDArray[Any]]) -> Scene:
    """Rebuild a scene from the arrays of `scene_to_arrays`, without joint laws; KeyError if there is none."""

    def decoded(value: Any) -> Any:
        if isinstance(value, dict):
            if "array" in value:
                return arrays[value["array"]]
            if "named" in value:
                return None
            return DATACLASSES[value["part"]](
                **{name: decoded(inner) for name, inner in value.items() if name != "part"}
            )
        return tuple(map(decoded, value)) if isinstance(value, list) else value

    scene: Scene = decoded(json.loads(arrays[SCENE_KEY].tobytes()))
    return scene
