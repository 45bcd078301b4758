"""What an outcome was computed from, as one digest: scene, model, tolerance, code and numerical libraries."""

import hashlib
import inspect
from collections.abc import Callable
from dataclasses import fields, is_dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import version
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
LIBRARIES = ("numpy", "scipy", "shapely", "numba", "scikit-fem", "gmsh", "clarabel", "highspy")


def fingerprint(scene: Scene, model: str | Model, tolerance: float) -> str:
    """Digest under which the outcome of a model, or one of the package's own by its name, on a scene is kept."""
    digest = hashlib.sha256(code_digest().encode())
    if isinstance(model, Model):
        own = _own_code(model.solve)
        loads = (*scene.load.live, *scene.load.dead) if own else ()  # of which it may read whatever it likes
        digest.update(own + b"".join(_own_code(type(load)) for load in loads))
        if settings := getattr(model.solve, "keywords", None):  # with which it was made of another's
            digest.update(repr(sorted(settings.items())).encode())
        model = model.name
    digest.update(f"{model} {tolerance!r} ".encode())
    for value in (scene, scene.dead_forces, scene.live_forces, scene.control_point):
        _feed(digest, value)  # of a user's own load, what it does as well
    return digest.hexdigest()


def _own_code(given: Callable[..., Any]) -> bytes:
    """The file of a user's function or class, or its compiled code where there is none; nothing for the package's."""
    function: Any = getattr(given, "func", given)
    if function.__module__.split(".")[0] in {room.split(".")[0] for room in COMPUTING_ROOMS}:
        return b""
    try:
        return Path(inspect.getfile(function)).read_bytes()
    except (TypeError, OSError):
        code = getattr(function, "__code__", None)
        return b"" if code is None else code.co_code + repr(code.co_consts).encode()


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
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode() + value.tobytes())
    elif isinstance(value, (list, tuple)):
        digest.update(f"{len(value)} ".encode())
        for entry in value:
            _feed(digest, entry)
    elif is_dataclass(value) or isinstance(value, Action):
        digest.update(type(value).__name__.encode())
        for name in [entry.name for entry in fields(value)] if is_dataclass(value) else sorted(vars(value)):
            digest.update(name.encode())
            _feed(digest, getattr(value, name))
    elif type(value).__repr__ is object.__repr__ or callable(value):  # in a load, which is known by what it does
        digest.update(f"{type(value).__name__} {getattr(value, '__qualname__', '')}".encode())
    else:
        digest.update(repr(value).encode())
