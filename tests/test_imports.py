"""Which package may import which, and absence of import cycles."""

import ast
import tomllib
from pathlib import Path

import pytest
from setuptools import find_packages

from runningbond.campaigns.fingerprint import COMPUTING_ROOMS
from runningbond.models import MODELS

ROOT = Path(__file__).parent.parent
MAY_IMPORT: dict[str, set[str]] = {
    "runningbond.scene": set(),
    "runningbond.joints": {"runningbond.scene"},
    "runningbond.contacts": {"runningbond.scene", "runningbond.joints"},
    "runningbond.results": {"runningbond.scene", "runningbond.joints"},
}
BASE = {*MAY_IMPORT}
MAY_IMPORT["runningbond.limit"] = BASE
MAY_IMPORT["runningbond.dynamics"] = BASE
MAY_IMPORT["meshing"] = BASE
MAY_IMPORT["runningbond.response"] = BASE | {"runningbond.limit", "runningbond.dynamics"}
METHODS = MAY_IMPORT["runningbond.response"] | {"runningbond.response", "meshing"}
MAY_IMPORT |= {"dem": METHODS - {"meshing"}, "fem_interface": METHODS, "homog": BASE}
BELOW_PICTURES = METHODS | {"dem", "fem_interface", "homog"}
MAY_IMPORT["runningbond.pictures"] = BELOW_PICTURES
MAY_IMPORT["runningbond.models"] = BELOW_PICTURES | {"runningbond.pictures"}
MAY_IMPORT["runningbond.campaigns"] = MAY_IMPORT["runningbond.models"] | {"runningbond.models"}
MAY_IMPORT["runningbond.draws"] = MAY_IMPORT["runningbond.campaigns"] | {"runningbond.campaigns"}
MAY_IMPORT["runningbond.compare"] = MAY_IMPORT["runningbond.draws"] | {"runningbond.draws"}
MAY_IMPORT["runningbond.studies"] = MAY_IMPORT["runningbond.compare"] | {"runningbond.compare"}
MAY_IMPORT["runningbond.laboratory"] = MAY_IMPORT["runningbond.studies"] | {"runningbond.studies"}
MAY_IMPORT["runningbond.commands"] = MAY_IMPORT["runningbond.laboratory"] | {"runningbond.laboratory"}
"""Each package, and the packages of lower layers that it may import."""

STANDALONE = {"runningbond.own_packages"}
"""Modules that every package may import and that import no package themselves."""

HEAVY = {"gmsh", "pyvista", "vtk"}
"""Libraries that are slow to import and need system libraries; imported only inside functions that use them."""

SOURCES = [path for package in MAY_IMPORT for path in sorted((ROOT / package.replace(".", "/")).rglob("*.py"))]


def _package(module: str) -> str:
    """Package of a module: its first two names within `runningbond`, its first name elsewhere."""
    parts = module.split(".")
    return ".".join(parts[:2]) if parts[0] == "runningbond" else parts[0]


def _imported(tree: ast.AST, module: str = "") -> set[str]:
    """Full names of the modules that a syntax tree imports, relative ones resolved from `module`."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = module.split(".")[: -node.level] if node.level else []
            target = ".".join([*base, *([node.module] if node.module else [])])
            names |= {f"{target}.{alias.name}" for alias in node.names} if target == "runningbond" else {target}
    return names


def _module(source: Path) -> str:
    return ".".join(source.relative_to(ROOT).with_suffix("").parts)


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_packages_import_only_lower_packages(source: Path) -> None:
    module = _module(source)
    foreign = {_package(name) for name in _imported(ast.parse(source.read_text()), module)}
    ours = {name for name in foreign if name.split(".")[0] in {package.split(".")[0] for package in MAY_IMPORT}}
    assert ours - {_package(module)} <= MAY_IMPORT[_package(module)] | STANDALONE


@pytest.mark.parametrize("module", sorted(STANDALONE))
def test_standalone_modules_import_no_package(module: str) -> None:
    tree = ast.parse((ROOT / f"{module.replace('.', '/')}.py").read_text())
    assert not {name for name in _imported(tree, module) if name.split(".")[0] in {*MAY_IMPORT, "runningbond"}}


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: str(path.relative_to(ROOT)))
def test_heavy_libraries_are_imported_inside_functions(source: Path) -> None:
    outside_functions = {
        name.split(".")[0]
        for node in ast.parse(source.read_text()).body
        if isinstance(node, (ast.Import, ast.ImportFrom))
        for name in _imported(ast.Module([node], []))
    }
    assert not outside_functions & HEAVY


def test_packages_have_no_import_cycle() -> None:
    order: list[str] = []
    while len(order) < len(MAY_IMPORT):
        ready = [name for name, allowed in MAY_IMPORT.items() if name not in order and allowed <= set(order)]
        assert ready, "the rooms left import each other"
        order += ready


def test_modules_have_no_import_cycle_at_load() -> None:
    """Imports inside functions do not count, because they are executed only after all modules have been loaded."""
    modules = {_module(source).removesuffix(".__init__"): source for source in SOURCES}
    needs: dict[str, set[str]] = {}
    for name, source in modules.items():
        tree = ast.parse(source.read_text())
        top = ast.Module([node for node in tree.body if isinstance(node, (ast.Import, ast.ImportFrom))], [])
        package = name + ".__init__" if source.name == "__init__.py" else name
        needs[name] = {found for found in _imported(top, package) if found in modules and found != name}
    done: set[str] = set()
    while len(done) < len(needs):
        ready = {name for name, wanted in needs.items() if name not in done and wanted <= done}
        assert ready, f"these modules import each other: {sorted(set(needs) - done)}"
        done |= ready


def test_comparisons_and_commands_have_no_late_import_cycle() -> None:
    """No module of these packages imports itself through others, not even by imports inside functions."""
    packages = {f"runningbond.{package}" for package in ("models", "campaigns", "compare", "commands")}
    sources = {_module(path).removesuffix(".__init__"): path for path in SOURCES}
    needs = {}
    for name, source in sources.items():
        if _package(name) in packages:
            package = name + ".__init__" if source.name == "__init__.py" else name
            needs[name] = {found for found in _imported(ast.parse(source.read_text()), package) if found in sources}
    for start in needs:
        reached: set[str] = set()
        ahead = set(needs[start])
        while ahead:
            reached |= ahead
            ahead = {after for module in ahead for after in needs.get(module, set())} - reached
        assert start not in reached


def test_model_names_are_not_hard_coded() -> None:
    """No string constant in campaigns, compare and commands is a model's name; fingerprint.py names package homog."""
    for package in ("campaigns", "compare", "commands"):
        for source in (ROOT / "runningbond" / package).rglob("*.py"):
            if source.name == "fingerprint.py":
                continue
            words = [node.value for node in ast.walk(ast.parse(source.read_text())) if isinstance(node, ast.Constant)]
            assert not set(MODELS) & {word for word in words if isinstance(word, str)}, source


def test_tree_has_exactly_the_listed_packages() -> None:
    top = {path.parent.name for path in ROOT.glob("*/__init__.py")} - {"tests"}
    assert top == {"runningbond", *(package for package in MAY_IMPORT if "." not in package)}
    inside = {f"runningbond.{path.parent.name}" for path in (ROOT / "runningbond").glob("*/__init__.py")}
    assert inside == {package for package in MAY_IMPORT if "." in package}


def test_distribution_has_exactly_these_packages() -> None:
    with (ROOT / "pyproject.toml").open("rb") as file:
        packages = find_packages(str(ROOT), **tomllib.load(file)["tool"]["setuptools"]["packages"]["find"])
    folders = {path.parent for name in MAY_IMPORT for path in (ROOT / name.replace(".", "/")).rglob("__init__.py")}
    assert set(packages) == {"runningbond", *(".".join(folder.relative_to(ROOT).parts) for folder in folders)}


def test_fingerprint_covers_all_computing_packages() -> None:
    after = ("pictures", "campaigns", "draws", "compare", "studies", "laboratory", "commands")
    assert set(COMPUTING_ROOMS) == set(MAY_IMPORT) - {f"runningbond.{package}" for package in after}
