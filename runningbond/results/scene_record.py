"""A scene as plain arrays and back, so that a result knows what it is a result of."""

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runningbond.joints import Law
from runningbond.scene import (
    Action,
    BlockMaterial,
    Blocks,
    Body,
    Bond,
    Forces,
    GivenForces,
    JointMaterial,
    Joints,
    Lateral,
    Load,
    Mortar,
    Pins,
    PointLoad,
    Scene,
    Stiffness,
)

PARTS: dict[str, Any] = {
    part.__name__: part
    for part in (
        Scene,
        Blocks,
        Pins,
        Joints,
        BlockMaterial,
        JointMaterial,
        Mortar,
        Stiffness,
        Load,
        Lateral,
        PointLoad,
        Body,
        GivenForces,
        Forces,
        Bond,
    )
}
"""What scenes are made of."""

ROOT = "scene"
"""Name of the array with the scene's words and numbers, JSON in UTF-8; its arrays are named after it."""


def scene_to_arrays(scene: Scene) -> dict[str, NDArray[Any]]:
    """Arrays that say everything about a scene, by names that start with ``scene``.

    Of a load of a user's own they have its forces, and of a law its name.
    """
    arrays: dict[str, NDArray[Any]] = {}

    def plain(value: object, name: str) -> object:
        if isinstance(value, Law):
            return {"named": value.name}
        if isinstance(value, Action) and type(value).__name__ not in PARTS:
            value = GivenForces(value.forces(scene))
        if isinstance(value, tuple):
            return [plain(inner, f"{name}.{k}") for k, inner in enumerate(value)]
        if is_dataclass(value):
            inner = {field.name: plain(getattr(value, field.name), f"{name}.{field.name}") for field in fields(value)}
            return {"part": type(value).__name__, **inner}
        if isinstance(value, np.ndarray):
            arrays[name] = value
            return {"array": name}
        return value

    arrays[ROOT] = np.frombuffer(json.dumps(plain(scene, ROOT)).encode(), dtype=np.uint8)
    return arrays


def scene_from_arrays(arrays: Mapping[str, NDArray[Any]]) -> Scene:
    """The scene that `scene_to_arrays` took apart; KeyError where there is none."""

    def whole(value: Any) -> Any:
        if isinstance(value, dict):
            if "array" in value:
                return arrays[value["array"]]
            if "named" in value:
                return None
            return PARTS[value["part"]](**{name: whole(inner) for name, inner in value.items() if name != "part"})
        return tuple(map(whole, value)) if isinstance(value, list) else value

    scene: Scene = whole(json.loads(arrays[ROOT].tobytes()))
    return scene
