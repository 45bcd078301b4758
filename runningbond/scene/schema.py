"""The scene file as a JSON schema, for editors, derived from what the reader requires while it reads example scenes.

Together the example scenes use every key; whether they make sense as walls does not matter.
"""

import re
from collections.abc import Iterable
from contextlib import suppress
from copy import deepcopy
from functools import cache
from threading import Lock
from typing import Any, TypeAlias

from .errors import SceneError
from .file import scene_from_dict
from .loads import DEAD_KINDS, KINDS
from .ranges import Range, suggestion
from .table import Table

Schema: TypeAlias = dict[str, Any]
Tables: TypeAlias = dict[str, list[tuple[Schema, dict[str, Schema]]]]

ROW = {"from": [0.0, 0.6], "to": [1.2, 0.6]}
AT = {"at": [0.3, 0.6], "force": [0.0, -1.0]}
BOX = [[-1.0, -9.0], [9.0, 0.55]]
EXAMPLE_LOADS: dict[str, Schema] = {
    "lateral": {"direction": [1.0, 0.0]},
    "tilt": {"direction": [-1.0, 0.0]},
    "body": {"acceleration": [1.0, 0.0]},
    "point": AT,
    "line": {**ROW, "force": [0.0, -1.0]},
    "moment": {"at": [0.3, 0.5], "moment": 1.0},
    "settlement": {"box": BOX, "by": [0.0, -0.1], "rotation_angle": 1.0, "about": [0.0, 0.0]},
}
TURNED = {"kind": "settlement", "box": BOX, "rotation_angle": 1.0}
MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
STRENGTH = {"cohesion": 1e5, "tensile_strength": 5e4, "inset": 0.0, "fracture_energy_1": 9.0, "fracture_energy_2": 9.0}
CRUSHING = {"compressive_strength": 1e6, "compressive_fracture_energy": 1e4, "cap_shear": 9.0, "peak_closure": 1e-5}
SPRINGS = {"normal_stiffness": 1e9, "shear_stiffness": 1e9, "closure": {"growth": 1e4, "stiffest": 1e10}}
BLOCKS = {"block_width": 0.4, "thickness": 0.2}
STONE, SOIL = [[0.0, 0.0], [0.4, 0.0], [0.4, 0.2]], [[-1.0, -0.2], [1.0, -0.2], [1.0, 0.0], [-1.0, 0.0]]
TIE = {"from": [0.1, 0.5], "to": [9.0, 0.5], "area": 1e-4, "young": 2e11, "yield": 1e4}
PULSE = {"pulse": {"kind": "sine", "amplitude": 1.0, "period": 1.0}, "quantity": "g", "scale": 1.0}
PLAIN: Schema = {
    "wall": {**BLOCKS, "block_height": 0.2, "length": 1.2, "height": 0.6, "first_course": "full", "ends": "flush"},
    "block": {"density": 1800.0},
    "joint": {"friction": 0.6},
    "support": {"kind": "base"},
    "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
}
LISTED: Schema = {
    "title": "every table",
    "wall": {**BLOCKS, "courses": [[1, 1, 1]] * 3, "course_heights": [0.2, 0.2, 0.2]},
    "materials": {"oak": {"density": 700.0, "young": 1e10, "poisson": 0.3, "thickness": 0.3}},
    "joints": {"glue": {"friction_angle": 35.0, **STRENGTH, **CRUSHING, "mortar": MORTAR, "softening": "linear"}},
    "inner_joint": {"friction": 0.7, **SPRINGS},
    "assign": [
        {"block": "oak", "blocks": [0]},
        {"block": "oak", "box": BOX},
        {"joint": "glue", "between": ["oak", "*"], "orientation": "bed"},
        {"joint": "glue", "orientation": "bed"},
        {"joint": "glue", "box": BOX},
    ],
    "beam": {
        "height": 0.1,
        "mass": 1.0,
        "joint": "glue",
        "force": [0.0, -1.0],
        "drive": {"force": [1.0, 0.0], "at": 0.6},
    },
    "tie": [TIE, {**TIE, "preload": 1.0}],
    "load": {
        "gravity": [0.0, -9.81],
        "live": [
            {"kind": kind, **EXAMPLE_LOADS[kind], **changed}
            for changed in ({}, {"direction": "right"})
            for kind in KINDS
            if kind != "settlement" and changed.keys() <= EXAMPLE_LOADS[kind].keys()
        ],
        "dead": [*({"kind": kind, **EXAMPLE_LOADS[kind]} for kind in DEAD_KINDS), {"kind": "lateral"}],
    },
}
OPENED = {**BLOCKS, "block_height": 0.2, "length": 2.4, "height": 1.2}
LINTEL = {"height": 0.2, "bearing": 0.2}
HOLE = {"from": [0.4, 0.2], "to": [0.8, 0.6]}
LOW = {"from": [1.4, 0.2], "to": [2.0, 0.4], "lintel": LINTEL}
LED = {"height": 0.1, "joint": "lime", "condition": "level", "force": [0.0, -1.0], "force_line": "fixed"}

SAME_KEYS = {r"^materials\.[^.]+": "block", r"^joints\.[^.]+": "joint", r"^inner_joint": "joint"}
"""Tables that have the same keys as another one: pattern of their path, and path of that other table."""

NAMED = ("materials", "joints")
"""Tables whose keys are names chosen by the user."""

SCENES: tuple[Schema, ...] = (
    PLAIN,
    LISTED,
    {
        "materials": {"oak": {"density": 700.0}},
        "wall": {
            **OPENED,
            "opening": [HOLE, {**HOLE, "from": [1.4, 0.2], "to": [2.0, 0.6], "lintel": {**LINTEL, "material": "oak"}}],
        },
        "joints": {"lime": {"friction": 0.5}},
        "beam": {**LED, "drive": {"displacement": [[0.01, -0.01]], "rate": 1e-3}},
        "load": {"gravity": 9.81},
    },
    {
        "wall": {**OPENED, "opening": [{**HOLE, "lintel": {**LINTEL, "material": "elm"}}, LOW]},
        "materials": {"elm": {"density": 600.0}},
        "assign": [{"block": "elm", "blocks": [1]}],
        "load": {"gravity": 9.81, "live": [{"kind": "settlement", **EXAMPLE_LOADS["settlement"]}], "dead": []},
    },
    {"beam": {"height": 0.1, "drive": {"displacement": [0.01, 0]}}, "load": {"gravity": 9.81}},
    {"beam": {"height": 0.1, "drive": {"amplitudes": [0.01], "cycles": 2, "rate": 1e-3}}, "load": {"gravity": 9.81}},
    {"load": {"gravity": 9.81, "live": {**TURNED, "path": [1.0, -1.0]}}},
    {"load": {"gravity": 9.81, "live": {**TURNED, "amplitudes": [0.5, 1.0], "cycles": 3}}},
    {"load": {"gravity": 9.81, "live": TURNED, "dead": {"kind": "point", **AT}}},
    {"load": {"gravity": 9.81, "live": {"kind": "settlement", "box": BOX, "by": [0.0, -0.1]}}},
    {"joints": {"lime": {"friction": 0.5}}, "assign": [{"joint": "lime", "orientation": "head"}]},
    {"load": {"gravity": 9.81, "history": PULSE}},
    {"load": {"gravity": 9.81, "history": {"file": "record.at2"}}},  # no such file: only its keys matter
    {"wall": {"thickness": 0.2, "drawing": "wall.dxf", "units": "mm", "expand": 0.01, "heal": 0.001}},  # no such file
    {"wall": {"thickness": 0.2, "outlines": [STONE], "ground": [SOIL], "units": "m", "expand": 0.01, "heal": 0.001}},
    {"assign": [{"block": "block", "layer": "OAK"}, {"joint": "joint", "layer": "OAK"}]},  # no layer "OAK"
)
"""The example scenes: each replaces or adds tables to those of `PLAIN`."""


_reading = Lock()


def scene_schema() -> Schema:
    """JSON schema, draft 7, of a scene file; during the call no other thread may read a scene: its keys would count."""
    return {"$schema": "http://json-schema.org/draft-07/schema#", "title": "runningbond scene", **_table(_read(), "")}


def _read() -> Tables:
    """Content of the tables of all example scenes and the requirements on their keys, by the tables' common path."""
    with _reading:
        Table.visits, visits = [], []
        try:
            for scene in SCENES:
                with suppress(SceneError):  # for files that do not exist; keys that were read before count
                    scene_from_dict(deepcopy({**PLAIN, **scene}))
        finally:
            visits, Table.visits = Table.visits, None
    tables: Tables = {}
    for name, content, asked in visits:
        if asked:
            tables.setdefault(_path(name), []).append((content, asked))
    return tables


@cache
def _keys() -> dict[str, frozenset[str]]:
    """All keys that the table at each path may have, whatever its kind."""
    return {path: frozenset(key for _, asked in visits for key in asked) for path, visits in _read().items()}


def is_key_of(table: str, key: str) -> bool:
    """Whether a top-level table of a scene file may have a key."""
    return key in _keys()[table]


def misspelt(content: dict[Any, Any], name: str = "") -> SceneError | None:
    """Error for the first unknown key in a table or its inner tables that is spelt much like a known one; else None."""
    path = _path(name)
    known = _keys().get(path, frozenset())
    if not known and path not in NAMED:
        return None
    for key, value in content.items():
        full, inner = f"{name}.{key}" if name else str(key), list[tuple[str, Any]]()
        if path not in NAMED and key not in known:
            if hint := suggestion(key, sorted(known)):
                place, told = f"[{name}]" if name else "a scene file", "a table" if isinstance(value, dict) else value
                return SceneError(full, f"is not a key of {place}{hint}", told)
        elif isinstance(value, dict):
            inner = [(full, value)]
        elif isinstance(value, list):
            inner = [(f"{full}[{k}]", one) for k, one in enumerate(value) if isinstance(one, dict)]
        for found in (misspelt(table, place) for place, table in inner):
            if found is not None:
                return found
    return None


def _path(name: str) -> str:
    """Common path of all tables with the same keys, from the full name of one of them."""
    path = re.sub(r"\[\d+\]", "", name)
    for pattern, default in SAME_KEYS.items():
        path = re.sub(pattern, default, path)
    return path


def _table(tables: Any, path: str) -> Schema:
    """Schema of the table at a path; one of several variants if its keys depend on its ``kind``."""
    visits = tables[path]
    kinds = dict.fromkeys(content["kind"] for content, asked in visits if "words" in asked.get("kind", {}))
    variants = {
        kind: _variant(tables, path, [visit for visit in visits if visit[0].get("kind") == kind])
        for kind in (kinds or [None])
    }
    bare = [
        {**one, "properties": {key: what for key, what in one["properties"].items() if key != "kind"}}
        for one in variants.values()
    ]
    if all(one == bare[0] for one in bare):
        return next(iter(variants.values()))
    for kind, one in variants.items():
        one["properties"]["kind"] = {"const": kind}
    return {"anyOf": list(variants.values())}


def _variant(tables: Any, path: str, visits: list[tuple[Schema, dict[str, Schema]]]) -> Schema:
    keys = dict.fromkeys(key for _, asked in visits for key in asked)
    properties = {}
    for key in keys:
        inner = f"{path}.{key}" if path else key
        found = [_value(tables, inner, asked[key], content.get(key)) for content, asked in visits if key in asked]
        if merged := _merged([one for one in found if one]):
            properties[key] = merged
    required = [key for key in keys if all(asked.get(key, {}).get("required") for _, asked in visits)]
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}


def _value(tables: Any, path: str, asked: Schema, value: Any) -> Schema:
    """Schema of one value; empty if only an example value could show it, and there is none."""
    if within := asked.get("within"):
        return _number(within)
    if words := asked.get("words"):
        return {"enum": words}
    if asked.get("kind") == "tables by name":
        return {"type": "object", "additionalProperties": _table(tables, _path(f"{path}.any"))}
    pair: Schema = {"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2}
    outline: Schema = {"type": "array", "items": pair, "minItems": 3}
    fixed: dict[Any, Schema] = {
        "text": {"type": "string"},
        "vector": pair,
        "outlines": {"type": "array", "items": outline, "minItems": 1},
    }
    return fixed.get(asked.get("kind")) or _like(tables, path, value)


def _like(tables: Any, path: str, value: Any) -> Schema:
    """Schema of values of the same type as an example value."""
    if isinstance(value, dict):
        return _table(tables, _path(path))
    if isinstance(value, list):
        return {"type": "array", "items": _merged([_like(tables, path, one) for one in value])}
    names = {str: "string", int: "number", float: "number"}
    return {"type": names[type(value)]} if value is not None else {}


def _number(within: Range) -> Schema:
    limits = {
        "minimum": within.least,
        "maximum": within.most,
        "exclusiveMinimum": within.above,
        "exclusiveMaximum": within.below,
    }
    finite = {name: limit for name, limit in limits.items() if abs(limit) < float("inf")}
    return {"type": "number", "description": str(within), **finite}


def _merged(found: Iterable[Schema]) -> Schema:
    """Schema that admits any of several; options that differ between scenes are names, so any string is admitted."""
    distinct: list[Schema] = []
    distinct += (one for one in found if one and one not in distinct)
    if len(distinct) > 1 and all("enum" in one for one in distinct):
        return {"type": "string"}
    arrays = [one for one in distinct if one.get("type") == "array" and "minItems" not in one]
    if len(arrays) > 1:
        rest = [one for one in distinct if one not in arrays]
        return _merged([*rest, {"type": "array", "items": _merged([one["items"] for one in arrays])}])
    return distinct[0] if len(distinct) == 1 else {"anyOf": distinct} if distinct else {}
