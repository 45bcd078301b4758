"""What the fingerprint of an outcome depends on."""

import ast
import inspect
import sys
from functools import partial
from importlib import import_module
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any

import numba
import pytest
from numba.cloudpickle import dumps, loads

from runningbond.campaigns.fingerprint import COMPUTING_ROOMS, LIBRARIES, fingerprint
from runningbond.laboratory.ladder import LADDER
from runningbond.models import MODELS, Model
from runningbond.results import Outcome
from runningbond.scene import Scene

from ..walls import panel

WALL = panel(wall__length=0.48, wall__height=0.12)

SUITE_PACKAGES = {"runningbond", "meshing", "fem_interface", "dem", "homog"}
EXCLUDED = {"threadpoolctl", "filelock", "ezdxf", "meshio"}
"""Libraries for threads, locks and files; what is read from a drawing is in the fingerprint as part of the scene."""


def test_versions_of_all_computing_libraries_are_included() -> None:
    """Another library version may give other numbers, so every library imported by a computing package counts."""
    imported = set()
    for room in COMPUTING_ROOMS:
        for source in Path(str(import_module(room).__file__)).parent.rglob("*.py"):
            for node in ast.walk(ast.parse(source.read_text("utf-8"))):
                if isinstance(node, ast.Import):
                    imported |= {alias.name.partition(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
                    imported.add(node.module.partition(".")[0])
    foreign = imported - SUITE_PACKAGES - set(sys.stdlib_module_names)
    assert {"numpy", "clarabel", "highspy"} <= foreign
    distributions = packages_distributions()
    assert {name for module in foreign for name in distributions[module]} - EXCLUDED <= set(LIBRARIES)


def closed_over(factor: float) -> Any:
    """A user's solver with a number in its closure."""
    return lambda scene, tolerance: Outcome(scene.title, "mine", "collapse", factor)


def with_default(factor: float) -> Any:
    """A solver with the number as a default argument."""

    def solve(scene: Scene, tolerance: float, by: float = factor) -> Outcome:
        return Outcome(scene.title, "mine", "collapse", by)

    return solve


class Solver:
    """A solver object with the number in a field."""

    def __init__(self, factor: float) -> None:
        self.factor = factor

    def solve(self, scene: Scene, tolerance: float) -> Outcome:
        """Solve; also passed as a bound method."""
        return Outcome(scene.title, "mine", "collapse", self.factor)

    __call__ = solve


def named(factor: float) -> Any:
    """A solver without a source file, as in a notebook, that uses a global number."""
    names: dict[str, Any] = {"FACTOR": factor, "__name__": "__main__"}
    exec("def solve(scene, tolerance): return FACTOR", names)
    return names["solve"]


def through_another(factor: float) -> Any:
    """A solver that calls another one."""
    inner = closed_over(factor)
    return lambda scene, tolerance: inner(scene, tolerance)


def compiled(factor: float) -> Any:
    """A solver that calls a compiled function with the number in its closure."""

    def written() -> float:
        return factor

    inner = numba.njit(written)
    return lambda scene, tolerance: Outcome(scene.title, "mine", "collapse", inner())


def compiled_and_named(factor: float) -> Any:
    """A solver without a source file that calls a compiled function, which uses a global number."""
    names: dict[str, Any] = {"FACTOR": factor, "__name__": "__main__", "njit": numba.njit}
    exec("@njit\ndef inner(): return FACTOR\ndef solve(scene, tolerance): return inner()", names)
    return names["solve"]


MAKERS = [closed_over, with_default, lambda x: Solver(x).solve, Solver, named, partial, through_another]


@pytest.mark.parametrize("made", [*MAKERS, compiled, compiled_and_named])
def test_fingerprint_of_a_user_model_includes_its_parameters(made: Any) -> None:
    """In every process: after pickling, the code has no source file."""
    made = (lambda x: partial(Solver.solve, Solver(x))) if made is partial else made
    keys = [
        fingerprint(WALL, Model("mine", "a user's own", made(factor), frozenset()), 1e-3) for factor in (1.0, 1.0, 2.0)
    ]
    assert keys[0] == keys[1] != keys[2]
    sent = loads(dumps(made(1.0)))
    assert fingerprint(WALL, Model("mine", "a user's own", sent, frozenset()), 1e-3) == keys[0]


@pytest.mark.parametrize(
    "source",
    [
        "from helper import FACTOR\ndef solve(scene, tolerance): return FACTOR",
        "def solve(scene, tolerance):\n    import helper\n    return helper.FACTOR",
        "import between\ndef solve(scene, tolerance): return between.helper.FACTOR",
    ],
)
@pytest.mark.parametrize("has_file", [True, False])
def test_fingerprint_of_a_user_model_includes_imported_files(
    source: str, has_file: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a sweep reuses outcomes of an older version of the helper, for models in modules and in scripts."""
    (tmp_path / "between.py").write_text("import helper\n")
    (tmp_path / "mine.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    keys = []
    for factor in (1.0, 1.0, 20.0):  # Python reuses compiled code of a file with the same second and size
        (tmp_path / "helper.py").write_text(f"FACTOR = {factor}\n")
        for name in ("mine", "between", "helper"):
            sys.modules.pop(name, None)
        names = vars(import_module("mine"))
        if not has_file:
            names = {"__name__": "__main__"}
            exec(source, names)
        keys.append(fingerprint(WALL, Model("mine", "a user's own", names["solve"], frozenset()), 1e-3))
    assert keys[0] == keys[1] != keys[2]


LAW = """
from dataclasses import replace

from runningbond.joints.coulomb import COULOMB

def worn(factor):
    return {factor} * factor

def constants(material):
    k_n, k_t, tension, friction, *others = COULOMB.constants(material)
    return k_n, k_t, tension, {call}(friction), *others

LAW = replace(COULOMB, name="worn", constants=constants)
"""


@pytest.mark.parametrize("call", ["worn", "helper.worn"])
@pytest.mark.parametrize("has_file", [True, False])
def test_fingerprint_of_a_user_law_includes_called_functions(
    call: str, has_file: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise a sweep reuses outcomes from before a change of a function that the law calls indirectly."""
    monkeypatch.syspath_prepend(tmp_path)
    keys = []
    for factor in (0.5, 0.5, 0.25):  # another size, as above
        source = f"import helper\n{LAW.format(call=call, factor=factor if call == 'worn' else 1.0)}"
        (tmp_path / "helper.py").write_text(f"def worn(friction):\n    return {factor} * friction\n")
        (tmp_path / "mylaw.py").write_text(source)
        for name in ("mylaw", "helper"):
            sys.modules.pop(name, None)
        names: dict[str, Any] = {"__name__": "__main__"}
        if has_file:
            names = vars(import_module("mylaw"))
        else:
            exec(source, names)
        keys.append(fingerprint(panel(joint__law=names["LAW"]), MODELS["dem-dynamic"], 1e-3))
    assert keys[0] == keys[1] != keys[2]


def test_fingerprint_of_code_without_a_file_includes_its_names() -> None:
    """Equal instructions and constants, but another function (min, max)."""
    keys = set()
    for name in ("min", "max"):
        names: dict[str, Any] = {"__name__": "__main__"}
        exec(f"def solve(scene, tolerance): return {name}(scene.thickness, 10.0)", names)
        keys.add(fingerprint(WALL, Model("mine", "a user's own", names["solve"], frozenset()), 1e-3))
    assert len(keys) == 2


@pytest.mark.parametrize("name", ["rocking", "rigid"])
def test_fingerprint_includes_the_source_file_of_laboratory_models(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It lies outside the computing packages; otherwise outcomes of an older formula are reused."""
    model, read = LADDER[name].model, Path.read_bytes
    before = fingerprint(WALL, model, 1e-3)
    file = inspect.getfile(model.solve.func)  # type: ignore[attr-defined]
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + (b"changed" if str(path) == file else b""))
    assert fingerprint(WALL, model, 1e-3) != before
