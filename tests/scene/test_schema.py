"""The JSON schema of scene files has the reader's keys, accepts what the reader accepts, and refuses what is wrong."""

import ast
import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_type_hints

import pytest

from runningbond.commands.command_line import command
from runningbond.scene import SceneError, scene_from_dict
from runningbond.scene.history import PULSES
from runningbond.scene.loads import DEAD_KINDS, KINDS
from runningbond.scene.ranges import ranges_of
from runningbond.scene.schema import PLAIN, SCENES, scene_schema
from runningbond.scene.table import Table
from tests.random_scenes import random_scene
from tests.walls import content

ROOT = Path(__file__).parents[2]
FILES = sorted(path for room in ("runningbond", "examples") for path in (ROOT / room).rglob("*.toml"))
SCHEMA = scene_schema()

READERS = {"outlines", "value", "required", "table", "optional_table", "tables_by_name", "list_of_tables", "number"}
READERS |= {"optional_number", "text", "choice", "vector", "rows"}
NOT_IN_FILES = {"law"}
LOOP_KEYS = {"between", "blocks", "layer"}
"""Keys of ``assign`` that its reader reads in a loop, not by literal arguments."""


@pytest.fixture(scope="module")
def validator() -> Any:
    return pytest.importorskip("jsonschema").Draft7Validator(SCHEMA)


def properties(schema: Any) -> Iterator[str]:
    """Keys of a schema, at any depth."""
    if isinstance(schema, dict):
        yield from schema.get("properties", {}) if isinstance(schema.get("properties"), dict) else ()
        for inner in schema.values():
            yield from properties(inner)
    elif isinstance(schema, list):
        for inner in schema:
            yield from properties(inner)


def keys_of_the_reader() -> set[str]:
    """Keys in the source: first arguments of `Table` methods, and fields with ranges of the classes they fill."""
    found: set[str] = set()
    for path in (ROOT / "runningbond" / "scene").rglob("*.py"):
        module: dict[str, Any] = {}
        for node in ast.walk(ast.parse(path.read_text())):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.args):
                continue
            first = node.args[0]
            if node.func.attr in READERS and isinstance(first, ast.Constant) and isinstance(first.value, str):
                found.add(first.value)
            if node.func.attr == "numbers" and isinstance(first, ast.Name) and first.id != "part":
                if not module:
                    exec(f"from runningbond.scene.{path.stem} import *", module)
                left_out = {one.value for one in node.args[1:] if isinstance(one, ast.Constant)}
                found |= set(ranges_of(module[first.id])) - left_out
    return found | {key for kind in ("body", "point") for key in get_type_hints(KINDS[kind])}


def test_every_key_of_the_reader_is_in_the_schema() -> None:
    known = keys_of_the_reader()
    assert {"friction", "poisson", "opening", "orientation", "yield", "acceleration", "growth", "preload"} <= known
    assert set(properties(SCHEMA)) | NOT_IN_FILES == known | LOOP_KEYS | {"wall", "block", "joint", "support", "load"}


def test_every_kind_of_load_pulse_and_support_is_in_the_schema() -> None:
    load = SCHEMA["properties"]["load"]["properties"]
    for name, kinds in (("live", KINDS), ("dead", DEAD_KINDS)):
        one, several = load[name]["anyOf"]
        assert {each["properties"]["kind"]["const"] for each in one["anyOf"]} == set(kinds)
        assert one == several["items"]
    assert load["history"]["properties"]["pulse"]["properties"]["kind"]["enum"] == list(PULSES)


def test_scenes_behind_the_schema_are_read_unless_files_are_missing() -> None:
    refused = []
    for scene in SCENES:
        try:
            scene_from_dict({**PLAIN, **scene})
        except SceneError as error:
            refused.append(error.key)
    assert refused == ["load.history.file", "wall.drawing", "assign[0].layer"]
    assert Table.visits is None


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_shipped_scenes_and_examples_are_valid(path: Path, validator: Any) -> None:
    validator.validate(tomllib.loads(path.read_text(encoding="utf-8")))


def test_scenes_accepted_by_the_reader_are_valid(validator: Any) -> None:
    for scene in (*({**PLAIN, **one} for one in SCENES), *map(random_scene, range(60))):
        validator.validate(scene)


WRONG: list[dict[str, Any]] = [
    {"titel": "panel"},
    {"title": 3},
    {"wall": None},
    {"block__density": -1800.0},
    {"block__density": None},
    {"block__poisson": 0.6},
    {"joint__frction": 0.6},
    {"joint__friction": "0.6"},
    {"joint__friction_angle": 90.0},
    {"joint__softening": "parabolic"},
    {"joint__mortar": {"young": 1e9, "poisson": 0.2}},
    {"joint__closure": {"growth": 1.0, "stiffest": 0.0}},
    {"support__kind": "bse"},
    {"wall__thickness": "12 cm"},
    {"wall__thickness": True},
    {"wall__ends": "ragged"},
    {"wall__courses": [1, 1]},
    {"wall__outlines": [[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]]]},
    {"wall__outlines": [[[0.0, 0.0], [1.0, 0.0]]]},
    {"wall__opening": {"from": [0.0, 0.0], "to": [1.0, 1.0]}},
    {
        "wall__opening": [{"from": [0.0, 0.0]}],
    },
    {"wall__opening": [{"from": [0.0, 0.0], "to": [1.0, 1.0], "lintel": {"height": 0.2}}]},
    {"load__gravity": [0.0, 0.0, -9.81]},
    {"load__gravity": -9.81},
    {"load__live": {"kind": "lateral", "direction": "up"}},
    {"load__live": {"kind": "point", "at": [0.0, 1.0]}},
    {"load__live": [{"kind": "moment", "at": [0.0, 1.0], "force": [0.0, 1.0]}]},
    {"load__dead": {"kind": "settlement", "box": [[0, 0], [1, 1]], "by": [0, 1]}},
    {"load__history": {"pulse": {"kind": "cosine", "amplitude": 1.0, "period": 1.0}}},
    {"load__history": {"file": "a.csv", "quantity": "m/s2"}},
    {"materials": {"oak": {"density": 0.0}}},
    {"joints": {"glue": {"friction": -1.0}}},
    {"assign": [{"block": "oak", "orientation": "level"}]},
    {"beam": {"mass": 3.0}},
    {"beam": {"height": 0.1, "condition": "fixed"}},
    {"beam": {"height": 0.1, "drive": {"rate": 0.0}}},
    {"tie": [{"from": [0, 0], "to": [1, 0], "area": 1e-4, "young": 2e11}]},
    {"tie": {"from": [0, 0], "to": [1, 0], "area": 1e-4, "young": 2e11, "yield": 1.0}},
]


@pytest.mark.parametrize("changes", WRONG, ids=lambda changes: next(iter(changes)))
def test_wrong_scenes_are_refused_by_schema_and_reader(changes: dict[str, Any], validator: Any) -> None:
    scene = content(**changes)
    assert not validator.is_valid(scene)
    with pytest.raises(SceneError):
        scene_from_dict(scene)


def test_schema_command_prints_the_schema(capsys: pytest.CaptureFixture[str], validator: Any) -> None:
    assert command(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
    validator.check_schema(SCHEMA)
