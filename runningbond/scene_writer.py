"""Write the description of a scene as the text of a scene file."""

import json
import re
from collections.abc import Mapping
from typing import Any

from .scene import SceneError


def toml(description: Mapping[str, Any]) -> str:
    """Nested dictionaries as TOML: top-level tables under their own headings, all others inline.

    Raises
    ------
    SceneError
        For a value that TOML cannot express.
    """
    tables = {key: value for key, value in description.items() if isinstance(value, Mapping)}
    lines = [f"{_key(key)} = {_value(value, key)}" for key, value in description.items() if key not in tables]
    for name, table in tables.items():
        lines += ["", f"[{_key(name)}]"]
        lines += [f"{_key(key)} = {_value(value, f'{name}.{key}')}" for key, value in table.items()]
    return "\n".join(lines) + "\n"


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else _value(key, key)


def _value(value: Any, name: str) -> str:
    if isinstance(value, Mapping):
        inner = (f"{_key(key)} = {_value(item, f'{name}.{key}')}" for key, item in value.items())
        return "{ " + ", ".join(inner) + " }"
    if isinstance(value, list):
        items = [_value(item, name) for item in value]
        outlines = any(isinstance(corner, list) for item in value if isinstance(item, list) for corner in item)
        return "[\n" + "".join(f"    {item},\n" for item in items) + "]" if outlines else f"[{', '.join(items)}]"
    if isinstance(value, (bool, int, float, str)):
        # JSON literals are valid TOML, except one control character and non-finite floats, which no scene has.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    raise SceneError(name, "is an object of Python, which no file can hold", value)
