"""Reference walls of the tests, as tables of a scene file."""

import copy
import json
from pathlib import Path
from typing import Any

from runningbond.scene import Scene, scene_from_dict

PANEL: dict[str, Any] = {
    "title": "panel",
    "wall": {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12, "length": 1.44, "height": 0.72},
    "block": {"density": 1800.0},
    "joint": {"friction": 0.6},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}


def content(**changes: Any) -> dict[str, Any]:
    """The reference panel with some keys changed: ``wall__height=1.44``; None takes a key out."""
    tables = copy.deepcopy(PANEL)
    for name, value in changes.items():
        *path, key = name.split("__")
        table = tables
        for step in path:
            table = table.setdefault(step, {})
        if value is None:
            del table[key]
        else:
            table[key] = value
    return tables


def panel(**changes: Any) -> Scene:
    """The reference panel as a scene, with some keys changed."""
    return scene_from_dict(content(**changes))


def courses(pattern: list[list[float]], width: float = 0.4, height: float = 0.175, **changes: Any) -> Scene:
    """A wall given course by course."""
    size = {"wall__block_width": width, "wall__block_height": height}
    return panel(wall__length=None, wall__height=None, wall__courses=pattern, **size, **changes)


def write_toml(tables: dict[str, Any], path: Path) -> Path:
    """Write tables as a scene file, with as much of TOML as they need."""
    lines: list[str] = [f"{key} = {_value(value)}" for key, value in tables.items() if not isinstance(value, dict)]
    for name, table in tables.items():
        if isinstance(table, dict):
            lines += [f"[{name}]", *(f"{json.dumps(key)} = {_value(value)}" for key, value in table.items())]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(key)} = {_value(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value) if isinstance(value, str) else str(value)
