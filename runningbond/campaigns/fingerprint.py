"""Fingerprint of an outcome's origin, as one digest: scene, model, tolerance, code and numerical libraries."""

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
PLAIN_TYPES = (bool, int, float, complex, str, bytes, tuple, np.ndarray)
"""Types of global values that are included for a user's code that is in no file."""
PACKAGES = {room.partition(".")[0] for room in COMPUTING_ROOMS}
LIBRARY_FOLDERS = {"site-packages", "dist-packages"}
"""Folders of installed libraries; all other files are the user's own."""
LIBRARIES = ("numpy", "scipy", "shapely", "numba", "scikit-fem", "gmsh", "clarabel", "highspy")


def fingerprint(scene: Scene, model: str | Model, tolerance: float) -> str:
    """Digest under which the outcome of a model on a scene is saved; a name stands for one of the package's models."""
    digest = hashlib.sha256(code_digest().encode())
    if isinstance(model, Model):
        own = _own_code(model.solve)
        loads = (*scene.load.live, *scene.load.dead) if own else ()  # a user's model may read anything of them
        digest.update(own + b"".join(_own_code(type(load)) for load in loads))
        if own or getattr(model.solve, "keywords", None):  # for the package's models the name suffices
            _feed_given(digest, model.solve)
        model = model.name
    digest.update(f"{model} {tolerance!r} ".encode())
    for value in (scene, scene.dead_forces, scene.live_forces, scene.control_point):
        _feed(digest, value)  # forces and control point: for a user's own load, its effect is included
    return digest.hexdigest()


def _own_code(given: Callable[..., Any]) -> bytes:
    """Source file of a function or class with the user's files that it imports, or its compiled code without a file.

    Empty for code that `code_digest` includes.
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
    """Content of a user's module and of the user's modules that it imports, each once; no package or library files."""
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
    """File of a user's module, or None; found without importing it, so that the result does not depend on imports."""
    if module.partition(".")[0] in ("", "__main__", *sys.stdlib_module_names, *PACKAGES):
        return None
    spec = None
    with suppress(ImportError, ValueError, AttributeError):  # no module of this name, or one without location
        spec = find_spec(module)
    if spec is None or not spec.has_location or not (spec.origin or "").endswith(".py"):
        return None
    path = Path(str(spec.origin))
    return None if LIBRARY_FOLDERS & set(path.parts) else path


@cache
def _imported(source: bytes, package: str) -> tuple[str, ...]:
    """Names of possible modules among all imports anywhere in a file."""
    names = list[str]()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            with suppress(ImportError):  # a relative import beyond the package
                name = resolve_name("." * node.level + (node.module or ""), package)
                names += [name, *(f"{name}.{alias.name}" for alias in node.names)]
    return tuple(names)


def _is_in_file(function: Any) -> bool:
    """Whether other processes can import a function or class by name from a module; else they receive its code only."""
    module = sys.modules.get(function.__module__)
    found: Any = module
    for name in function.__qualname__.split("."):
        found = getattr(found, name, None)
    return found is function and function.__module__ != "__main__" and bool(getattr(module, "__file__", None))


def _code(code: Any) -> tuple[Any, ...]:
    """Content of compiled code and of functions inside it, with the user's files that it imports."""
    if not hasattr(code, "co_code"):
        return ("", code)
    imported = [_own_files(each.argval) for each in get_instructions(code) if each.opname == "IMPORT_NAME"]
    return code.co_code, code.co_names, *imported, *map(_code, code.co_consts)


def _feed_given(digest: "hashlib._Hash", given: Any, seen: tuple[int, ...] = ()) -> None:
    """Add the data of a callable, in addition to its code: defaults, closure variables, fields, bound arguments.

    For code in no file, also add the plain global values, functions, and a user's modules and classes that it names.
    """
    if id(given) in seen:
        return
    seen = (*seen, id(given))
    given = _python_function(given)
    if isinstance(given, partial):
        _feed_values(digest, (*given.args, *sorted((given.keywords or {}).items())), seen)
        _feed_given(digest, given.func, seen)
    elif inspect.isfunction(given):
        closure, defaults = inspect.getclosurevars(given), (given.__defaults__, given.__kwdefaults__)
        outside = {} if _is_in_file(given) else closure.globals
        named = [
            (name, x)
            for name, x in outside.items()
            if isinstance(x, PLAIN_TYPES) or inspect.isfunction(_python_function(x)) or _is_own(x)
        ]
        _feed_values(
            digest, (*defaults, *sorted(closure.nonlocals.items()), *sorted(named, key=lambda pair: pair[0])), seen
        )
    elif inspect.ismethod(given):
        _feed_values(digest, (given.__self__, given.__func__), seen)
    elif not inspect.isroutine(given) and not inspect.isclass(given) and not inspect.ismodule(given):
        _feed_values(digest, tuple(sorted(getattr(given, "__dict__", {}).items())), seen)


def _python_function(given: Any) -> Any:
    """The Python function of a function compiled by numba; anything else as it is."""
    return getattr(given, "py_func", given)


def _is_own(value: Any) -> bool:
    """Whether a value is a user's module, or a class defined in one."""
    return (inspect.ismodule(value) or inspect.isclass(value)) and _file(_module_of(value)) is not None


def _module_of(value: Any) -> str:
    """Name of a module, or of the module of a class."""
    return str(value.__name__ if inspect.ismodule(value) else value.__module__)


def _feed_values(digest: "hashlib._Hash", values: tuple[Any, ...], seen: tuple[int, ...]) -> None:
    """Add values, and the code and data of callables and of objects whose repr shows only their address."""
    for value in values:
        if isinstance(value, tuple):
            _feed_values(digest, value, seen)
            continue
        if inspect.isclass(value) or inspect.ismodule(value):
            digest.update(value.__name__.encode() + _own_files(_module_of(value)))
            continue
        value = _python_function(value)
        _feed(digest, value)
        if _repr_is_address(value):
            if inspect.isfunction(value):
                digest.update(_own_code(value))
            _feed_given(digest, value, seen)


@cache
def code_digest() -> str:
    """Digest of every source file that can change a result, and of the versions of numerical libraries."""
    digest = hashlib.sha256(" ".join(f"{name} {version(name)}" for name in LIBRARIES).encode())
    for room in COMPUTING_ROOMS:
        folder = Path(str(import_module(room).__file__)).parent
        for source in sorted(folder.rglob("*.py")):
            digest.update(f"{room}/{source.relative_to(folder).as_posix()}\n".encode() + source.read_bytes())
    return digest.hexdigest()


def _feed(digest: "hashlib._Hash", value: object) -> None:
    """Add a value to a digest, by its content and never by its memory address."""
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
    elif _repr_is_address(value):  # in a load, whose effect (forces, control point) is included
        digest.update(f"{type(value).__name__} {getattr(value, '__qualname__', '')}".encode())
    else:
        digest.update(repr(value).encode())


def _feed_own_functions(digest: "hashlib._Hash", law: Law) -> None:
    """Add the code of a user's functions in a law, which the law's identity does not include."""
    for entry in fields(law):
        given = _python_function(getattr(law, entry.name))
        own = _own_code(given) if callable(given) else b""
        if own:
            digest.update(own)
            _feed_given(digest, given)


def _repr_is_address(value: object) -> bool:
    """Whether the repr of a value may show its memory address in place of its content."""
    return type(value).__repr__ is object.__repr__ or callable(value)
