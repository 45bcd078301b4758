"""What an outcome was computed from, as one digest: scene, model, tolerance, code and numerical libraries."""

import ast
import hashlib
import inspect
import sys
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, is_dataclass
from dis import get_instructions
from functools import cache, partial
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec, resolve_name
from pathlib import Path
from typing import Any

import numpy as np

from runningbond.joints import Law
from runningbond.models import Model
from runningbond.scene import Action, Scene

COMPUTING_ROOMS = (  # packages in which a change can change a number
    *(f"runningbond.{room}" for room in ("scene", "joints", "contacts", "results", "limit", "dynamics", "response")),
    *("meshing", "fem_interface", "dem", "homog", "runningbond.models"),
)
PLAIN = (bool, int, float, complex, str, bytes, tuple, np.ndarray)
"""Values outside of code without a file that it is known by, beside its own."""
PACKAGES = {room.partition(".")[0] for room in COMPUTING_ROOMS}
LIBRARY_FOLDERS = {"site-packages", "dist-packages"}
"""Where libraries lie: a user's own files lie elsewhere."""
LIBRARIES = ("numpy", "scipy", "shapely", "numba", "scikit-fem", "gmsh", "clarabel", "highspy")


def fingerprint(scene: Scene, model: str | Model, tolerance: float) -> str:
    """Digest under which the outcome of a model, or one of the package's own by its name, on a scene is kept."""
    digest = hashlib.sha256(code_digest().encode())
    if isinstance(model, Model):
        own = _own_code(model.solve)
        loads = (*scene.load.live, *scene.load.dead) if own else ()  # of which it may read whatever it likes
        digest.update(own + b"".join(_own_code(type(load)) for load in loads))
        if own or getattr(model.solve, "keywords", None):  # of the package's own none is known by more than its name
            _feed_given(digest, model.solve)
        model = model.name
    digest.update(f"{model} {tolerance!r} ".encode())
    for value in (scene, scene.dead_forces, scene.live_forces, scene.control_point):
        _feed(digest, value)  # of a user's own load, what it does as well
    return digest.hexdigest()


def _own_code(given: Callable[..., Any]) -> bytes:
    """The file of a function or class and a user's files that it imports, or its compiled code where it is in none.

    Nothing where `code_digest` has it.
    """
    function: Any = getattr(given, "func", given)
    function = getattr(function, "__func__", function)
    function = function if hasattr(function, "__module__") and hasattr(function, "__qualname__") else type(function)
    if f"{function.__module__}.".startswith(tuple(f"{room}." for room in COMPUTING_ROOMS)):
        return b""
    if _is_in_file(function):
        return _own_files(function.__module__) or Path(inspect.getfile(function)).read_bytes()
    if inspect.isclass(function):
        return repr(
            [(name, _code(getattr(x, "__code__", None))) for name, x in sorted(vars(function).items())]
        ).encode()
    return repr(_code(getattr(function, "__code__", None))).encode()


def _own_files(module: str) -> bytes:
    """The files of a user's module and of those that they import, each once; nothing of the package or a library."""
    found: dict[str, bytes] = {}
    _add_file(module, found)
    return b"".join(found.values())


def _add_file(module: str, found: dict[str, bytes]) -> None:
    file = _file(module)
    if file is not None and module not in found:
        found[module] = file.read_bytes()
        for name in _imported(found[module], module if file.name == "__init__.py" else module.rpartition(".")[0]):
            _add_file(name, found)


def _file(module: str) -> Path | None:
    """The file of a user's module; found without loading it, so that it is the same before and after that."""
    if module.partition(".")[0] in ("", "__main__", *sys.stdlib_module_names, *PACKAGES):
        return None
    spec = None
    with suppress(ImportError, ValueError, AttributeError):  # there is none of the name, or it has no place
        spec = find_spec(module)
    if spec is None or not spec.has_location or not (spec.origin or "").endswith(".py"):
        return None
    path = Path(str(spec.origin))
    return None if LIBRARY_FOLDERS & set(path.parts) else path


@cache
def _imported(source: bytes, package: str) -> tuple[str, ...]:
    """Names of what may be modules among all that a file imports, wherever in it."""
    names = list[str]()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            with suppress(ImportError):  # beyond the package
                name = resolve_name("." * node.level + (node.module or ""), package)
                names += [name, *(f"{name}.{alias.name}" for alias in node.names)]
    return tuple(names)


def _is_in_file(function: Any) -> bool:
    """Whether other processes find a function or class by its name, in a module: else they are sent its code alone."""
    module = sys.modules.get(function.__module__)
    found: Any = module
    for name in function.__qualname__.split("."):
        found = getattr(found, name, None)
    return found is function and function.__module__ != "__main__" and bool(getattr(module, "__file__", None))


def _code(code: Any) -> tuple[Any, ...]:
    """Compiled code as what it says, that of functions within it too, and a user's files that it imports."""
    if not hasattr(code, "co_code"):
        return ("", code)
    imported = [_own_files(each.argval) for each in get_instructions(code) if each.opname == "IMPORT_NAME"]
    return code.co_code, code.co_names, *imported, *map(_code, code.co_consts)


def _feed_given(digest: "hashlib._Hash", given: Any, seen: tuple[int, ...] = ()) -> None:
    """Add what something that is called was given beside its code: defaults, what it is closed over, fields, settings.

    Of code in no file also the plain values, the functions, and a user's modules and classes that it names.
    """
    if id(given) in seen:
        return
    seen = (*seen, id(given))
    given = _as_written(given)
    if isinstance(given, partial):
        _feed_values(digest, (*given.args, *sorted((given.keywords or {}).items())), seen)
        _feed_given(digest, given.func, seen)
    elif inspect.isfunction(given):
        closure, defaults = inspect.getclosurevars(given), (given.__defaults__, given.__kwdefaults__)
        outside = {} if _is_in_file(given) else closure.globals
        named = [
            (name, x)
            for name, x in outside.items()
            if isinstance(x, PLAIN) or inspect.isfunction(_as_written(x)) or _is_own(x)
        ]
        _feed_values(
            digest, (*defaults, *sorted(closure.nonlocals.items()), *sorted(named, key=lambda pair: pair[0])), seen
        )
    elif inspect.ismethod(given):
        _feed_values(digest, (given.__self__, given.__func__), seen)
    elif not inspect.isroutine(given) and not inspect.isclass(given) and not inspect.ismodule(given):
        _feed_values(digest, tuple(sorted(getattr(given, "__dict__", {}).items())), seen)


def _as_written(given: Any) -> Any:
    """The function that something compiled by numba was written as; all else as it is."""
    return getattr(given, "py_func", given)


def _is_own(value: Any) -> bool:
    """Whether a value is a user's module, or a class of one."""
    return (inspect.ismodule(value) or inspect.isclass(value)) and _file(_module_of(value)) is not None


def _module_of(value: Any) -> str:
    """Name of a module, or of that of a class."""
    return str(value.__name__ if inspect.ismodule(value) else value.__module__)


def _feed_values(digest: "hashlib._Hash", values: tuple[Any, ...], seen: tuple[int, ...]) -> None:
    """Add values, and what those that are called, or say nothing of themselves, are made of."""
    for value in values:
        if isinstance(value, tuple):
            _feed_values(digest, value, seen)
            continue
        if inspect.isclass(value) or inspect.ismodule(value):
            digest.update(value.__name__.encode() + _own_files(_module_of(value)))
            continue
        value = _as_written(value)
        _feed(digest, value)
        if _says_nothing(value):
            if inspect.isfunction(value):
                digest.update(_own_code(value))
            _feed_given(digest, value, seen)


@cache
def code_digest() -> str:
    """Digest of every source file that can change a number, and of the libraries' versions."""
    digest = hashlib.sha256(" ".join(f"{name} {version(name)}" for name in LIBRARIES).encode())
    for room in COMPUTING_ROOMS:
        folder = Path(str(import_module(room).__file__)).parent
        for source in sorted(folder.rglob("*.py")):
            digest.update(f"{room}/{source.relative_to(folder).as_posix()}\n".encode() + source.read_bytes())
    return digest.hexdigest()


def _feed(digest: "hashlib._Hash", value: object) -> None:
    """Add a value to a digest: what it says, never where it lies in memory."""
    if isinstance(value, Law):
        digest.update(repr(value.identity).encode())
        _feed_own_functions(digest, value)
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode() + value.tobytes())
    elif isinstance(value, (set, frozenset)):
        digest.update(repr(sorted(map(repr, value))).encode())
    elif isinstance(value, (list, tuple)):
        digest.update(f"{len(value)} ".encode())
        for entry in value:
            _feed(digest, entry)
    elif is_dataclass(value) or isinstance(value, Action):
        digest.update(type(value).__name__.encode())
        for name in [entry.name for entry in fields(value)] if is_dataclass(value) else sorted(vars(value)):
            digest.update(name.encode())
            _feed(digest, getattr(value, name))
    elif _says_nothing(value):  # in a load, which is known by what it does
        digest.update(f"{type(value).__name__} {getattr(value, '__qualname__', '')}".encode())
    else:
        digest.update(repr(value).encode())


def _feed_own_functions(digest: "hashlib._Hash", law: Law) -> None:
    """Add what a user's functions of a law call, which its identity does not know."""
    for entry in fields(law):
        given = _as_written(getattr(law, entry.name))
        own = _own_code(given) if callable(given) else b""
        if own:
            digest.update(own)
            _feed_given(digest, given)


def _says_nothing(value: object) -> bool:
    """Whether a value is told by where it lies in memory."""
    return type(value).__repr__ is object.__repr__ or callable(value)
