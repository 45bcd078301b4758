"""Descriptions of walls as nested tables, as in a scene file: their copies, changes and full names of keys."""

import re
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from .scene import SceneError


def as_in_a_file(value: Any) -> Any:
    """A copy of nested values in the types of a TOML file, which has no None; objects of other types as they are."""
    if isinstance(value, Mapping):
        return {str(key): as_in_a_file(inner) for key, inner in value.items() if inner is not None}
    if isinstance(value, (list, tuple)):
        return [as_in_a_file(inner) for inner in value]
    if hasattr(value, "__array__"):
        array = np.asarray(value)  # an object array holds, for example, polygons of unequal numbers of corners
        return [as_in_a_file(inner) for inner in array] if array.dtype == object and array.ndim else array.tolist()
    return str(value) if isinstance(value, Path) else value


def merge_changes(description: dict[str, Any], changes: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """A description with nested tables put in, in any order; a key that occurs in two of them is refused."""
    together: dict[str, Any] = {}
    for change in changes:
        together = _together(together, change)
    return merge(description, together)


def _together(one: Mapping[Any, Any], other: Mapping[Any, Any], name: str = "") -> dict[Any, Any]:
    """The keys of two nested tables; a key that occurs in both raises a `SceneError`."""
    together = dict(one)
    for key, value in other.items():
        before, full_name = together.get(key), _full_name(name, key)
        if key not in together:
            together[key] = value
        elif isinstance(before, Mapping) and isinstance(value, Mapping):
            together[key] = _together(before, value, full_name)
        else:
            raise SceneError(full_name, "is given twice; give it once", value)
    return together


def _full_name(name: str, key: str | int) -> str:
    """The name of a key of a named table, or of an entry of a named list by its number."""
    if isinstance(key, int):
        return f"{name}[{key}]"
    return f"{name}.{key}" if name else key


def keys_of_name(name: str, table: Mapping[Any, Any]) -> list[str | int]:
    """Keys and list indices that a full name consists of; existing keys may contain dots."""
    known = [key for key in table if f"{name}.".startswith(f"{key}.")]
    key = max(known, key=len, default=name.partition(".")[0])
    rest, path, inner = name[len(key) + 1 :], [key], table.get(key)
    numbered = re.fullmatch(r"(.+?)((?:\[\d+\])+)", key)
    if inner is None and numbered and isinstance(table.get(numbered[1]), list):
        numbers = [int(number) for number in re.findall(r"\d+", numbered[2])]
        path, inner = [numbered[1], *numbers], table[numbered[1]]
        for number in numbers:
            inner = inner[number] if isinstance(inner, list) and number < len(inner) else None
    if key == name:
        return path
    return [*path, *keys_of_name(rest, inner if isinstance(inner, Mapping) else {})]


def merge(old: Mapping[Any, Any], new: Mapping[Any, Any], name: str = "", *, is_list: bool = False) -> dict[Any, Any]:
    """A table with the keys of another put in or, if they are None, removed; a list is a table with numbers as keys."""
    merged = dict(old)
    for given, value in new.items():
        key = given if is_list else str(given)
        before, full_name = merged.get(key), _full_name(name, key)
        if is_list and key not in old:
            raise SceneError(full_name, f"is not there; {name} has {len(old)}, numbered from 0", value)
        numbered = not is_list and key not in old and re.fullmatch(r"(.+?)\[\d+\]", key)
        if numbered and isinstance(old.get(numbered[1]), Mapping):
            only = _full_name(name, numbered[1])
            raise SceneError(full_name, f"is no entry of a list: {only} is one table, whose keys are {only}.…", value)
        if numbered and numbered[1] not in old:
            raise SceneError(full_name, f"is not there: the wall has no {_full_name(name, numbered[1])}", value)
        if isinstance(value, Mapping) and not isinstance(value.get("kind"), str):  # but a material named kind
            if not isinstance(before, list):
                merged[key] = merge(before if isinstance(before, Mapping) else {}, value, full_name)
            elif value and all(isinstance(number, int) for number in value):
                merged[key] = list(merge(dict(enumerate(before)), value, full_name, is_list=True).values())
            else:
                what = f"is a list, which is changed as a whole, or by entry, {full_name}[0]"
                raise SceneError(full_name, what, before)
        elif value is None:
            merged.pop(key, None)
        else:
            merged[key] = value
    return merged
