"""What the digest of an outcome knows of."""

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

OWN = {"runningbond", "meshing", "fem_interface", "dem", "homog"}
OTHERS = {"threadpoolctl", "filelock", "ezdxf", "meshio"}
"""Of threads and locks, and of files: what is read from a drawing is in the digest as a scene."""


def test_no_library_that_computes_is_left_out() -> None:
    """A library of another version may give other numbers: each that a room which computes imports is in the digest."""
    imported = set()
    for room in COMPUTING_ROOMS:
        for source in Path(str(import_module(room).__file__)).parent.rglob("*.py"):
            for node in ast.walk(ast.parse(source.read_text("utf-8"))):
                if isinstance(node, ast.Import):
                    imported |= {alias.name.partition(".")[0] for alias in node.names}
                elif isinstance(node, ast.ImportFrom) and not node.level and node.module:
                    imported.add(node.module.partition(".")[0])
    foreign = imported - OWN - set(sys.stdlib_module_names)
    assert {"numpy", "clarabel", "highspy"} <= foreign
    distributions = packages_distributions()
    assert {name for module in foreign for name in distributions[module]} - OTHERS <= set(LIBRARIES)


def closed_over(factor: float) -> Any:
    """A solver of a user's that knows of a number by being closed over it."""
    return lambda scene, tolerance: Outcome(scene.title, "mine", "collapse", factor)


def with_default(factor: float) -> Any:
    """One that has it by default."""

    def solve(scene: Scene, tolerance: float, by: float = factor) -> Outcome:
        return Outcome(scene.title, "mine", "collapse", by)

    return solve


class Solver:
    """One that is an object, and has it in a field."""

    def __init__(self, factor: float) -> None:
        self.factor = factor

    def solve(self, scene: Scene, tolerance: float) -> Outcome:
        """As of a bound method."""
        return Outcome(scene.title, "mine", "collapse", self.factor)

    __call__ = solve


def named(factor: float) -> Any:
    """One without a file, as of a notebook, that names a number outside of itself."""
    names: dict[str, Any] = {"FACTOR": factor, "__name__": "__main__"}
    exec("def solve(scene, tolerance): return FACTOR", names)
    return names["solve"]


def through_another(factor: float) -> Any:
    """One that calls another."""
    inner = closed_over(factor)
    return lambda scene, tolerance: inner(scene, tolerance)


def compiled(factor: float) -> Any:
    """One that calls a compiled function, which is closed over the number."""

    def written() -> float:
        return factor

    inner = numba.njit(written)
    return lambda scene, tolerance: Outcome(scene.title, "mine", "collapse", inner())


def compiled_and_named(factor: float) -> Any:
    """One without a file that calls a compiled function, which names the number."""
    names: dict[str, Any] = {"FACTOR": factor, "__name__": "__main__", "njit": numba.njit}
    exec("@njit\ndef inner(): return FACTOR\ndef solve(scene, tolerance): return inner()", names)
    return names["solve"]


MAKERS = [closed_over, with_default, lambda x: Solver(x).solve, Solver, named, partial, through_another]


@pytest.mark.parametrize("made", [*MAKERS, compiled, compiled_and_named])
def test_a_users_model_is_known_by_what_it_was_given(made: Any) -> None:
    """Wherever it is asked for: a process that it was sent to has its code without a file."""
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
def test_a_users_model_is_known_by_the_files_that_it_imports(
    source: str, has_file: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sweep took what an older version of the helper had given, of a model in a module as of one in a script."""
    (tmp_path / "between.py").write_text("import helper\n")
    (tmp_path / "mine.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    keys = []
    for factor in (1.0, 1.0, 20.0):  # Python takes a file of the same second and the same size for the one it compiled
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
def test_a_users_law_is_known_by_what_its_functions_call(
    call: str, has_file: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sweep took what the law had given before a function was changed that another one of the law calls."""
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


def test_code_without_a_file_is_known_by_the_names_in_it() -> None:
    """The same instructions and constants, of another function."""
    keys = set()
    for name in ("min", "max"):
        names: dict[str, Any] = {"__name__": "__main__"}
        exec(f"def solve(scene, tolerance): return {name}(scene.thickness, 10.0)", names)
        keys.add(fingerprint(WALL, Model("mine", "a user's own", names["solve"], frozenset()), 1e-3))
    assert len(keys) == 2


@pytest.mark.parametrize("name", ["rocking", "rigid"])
def test_a_model_of_the_package_that_is_in_no_room_which_computes_is_known_by_its_file(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The laboratory kept what another formula had given."""
    model, read = LADDER[name].model, Path.read_bytes
    before = fingerprint(WALL, model, 1e-3)
    file = inspect.getfile(model.solve.func)  # type: ignore[attr-defined]
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + (b"changed" if str(path) == file else b""))
    assert fingerprint(WALL, model, 1e-3) != before
