"""What an outcome was computed from, as one digest: scene, model, tolerance, code and numerical libraries."""

import hashlib
from dataclasses import fields, is_dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import numpy as np

from runningbond.joints import Law
from runningbond.scene import Scene

COMPUTING_ROOMS = (
    *(f"runningbond.{room}" for room in ("scene", "joints", "contacts", "results", "limit", "dynamics")),
    *("meshing", "fem_interface", "dem", "homog"),
)
"""Packages in which a change can change a number."""
LIBRARIES = ("numpy", "scipy", "shapely", "numba", "scikit-fem", "gmsh")


def fingerprint(scene: Scene, model: str, tolerance: float) -> str:
    """Digest under which the outcome of a model on a scene is kept."""
    digest = hashlib.sha256(code_digest().encode())
    digest.update(f"{model} {tolerance!r} ".encode())
    for value in (scene, scene.dead_forces, scene.live_forces):  # of a user's own load, what it does as well
        _feed(digest, value)
    return digest.hexdigest()


@cache
def code_digest() -> str:
    """Digest of every source file that can change a number, and of the libraries' versions."""
    digest = hashlib.sha256(" ".join(f"{name} {version(name)}" for name in LIBRARIES).encode())
    for room in COMPUTING_ROOMS:
        folder = Path(str(import_module(room).__file__)).parent
        for source in sorted(folder.rglob("*.py")):
            digest.update(f"{room}/{source.relative_to(folder)}\n".encode() + source.read_bytes())
    return digest.hexdigest()


def _feed(digest: "hashlib._Hash", value: object) -> None:
    if isinstance(value, Law):
        digest.update(repr(value.identity).encode())
    elif is_dataclass(value):
        digest.update(type(value).__name__.encode())
        for entry in fields(value):
            digest.update(entry.name.encode())
            _feed(digest, getattr(value, entry.name))
    elif isinstance(value, np.ndarray):
        digest.update(f"{value.dtype}{value.shape}".encode() + value.tobytes())
    else:
        digest.update(repr(value).encode())
