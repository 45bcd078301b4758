"""Who may import whom, and that the rooms stay apart."""

import ast
import tomllib
from pathlib import Path

import pytest

from compare.fingerprint import COMPUTING_ROOMS

ROOT = Path(__file__).parent.parent
MAY_IMPORT = {
    "scene": set(),
    "joints": {"scene"},
    "results": {"scene", "joints"},
    "dynamics": {"scene", "joints", "results"},
    "meshing": {"scene", "joints"},
    "fem_interface": {"scene", "joints", "results", "dynamics", "meshing"},
    "dem": {"scene", "joints", "results", "dynamics"},
    "homog": {"scene", "joints", "results"},
    "compare": {"scene", "joints", "results", "dynamics", "meshing", "fem_interface", "dem", "homog"},
}
HEAVY = {"gmsh", "pyvista", "vtk"}
"""Slow to import and in need of system libraries; imported inside the functions that use them."""

SOURCES = [path for room in MAY_IMPORT for path in sorted((ROOT / room).rglob("*.py"))]


def _imported(tree: ast.AST) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_rooms_import_only_what_the_design_allows(source: Path) -> None:
    room = source.relative_to(ROOT).parts[0]
    foreign = _imported(ast.parse(source.read_text())) & set(MAY_IMPORT) - {room}
    assert foreign <= MAY_IMPORT[room]


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_heavy_libraries_are_imported_where_they_are_used(source: Path) -> None:
    outside_functions = {
        name
        for node in ast.parse(source.read_text()).body
        if isinstance(node, (ast.Import, ast.ImportFrom))
        for name in _imported(ast.Module([node], []))
    }
    assert not outside_functions & HEAVY


def test_there_is_no_cycle_between_rooms() -> None:
    order: list[str] = []
    while len(order) < len(MAY_IMPORT):
        ready = [room for room, allowed in MAY_IMPORT.items() if room not in order and allowed <= set(order)]
        assert ready, "the rooms left import each other"
        order += ready


def test_no_room_stands_outside_the_design() -> None:
    """Every package of the tree and of the distribution is one of the design's rooms."""
    rooms = {path.parent.name for path in ROOT.glob("*/__init__.py")} - {"tests"}
    with (ROOT / "pyproject.toml").open("rb") as file:
        packages = set(tomllib.load(file)["tool"]["setuptools"]["packages"])
    assert {package.split(".")[0] for package in packages} == rooms
    assert packages == {
        ".".join(path.parent.relative_to(ROOT).parts) for room in rooms for path in (ROOT / room).rglob("__init__.py")
    }
    assert rooms <= set(MAY_IMPORT)


def test_what_can_change_a_number_is_in_the_fingerprint() -> None:
    rooms = {path.parent.name for path in ROOT.glob("*/__init__.py")} - {"tests", "compare"}
    assert set(COMPUTING_ROOMS) == rooms
