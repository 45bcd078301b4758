"""Outcomes and responses on disk: written completely or not at all, and read only if nothing is missing.

A result folder holds ``outcome.json`` or ``response.json`` and the array file that it names. The arrays are written
first, under a name that contains their digest; the JSON file is moved into place last. A folder is accepted only if
the checksum in the JSON file matches.
"""

import errno
import hashlib
import io
import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from runningbond.scene import Scene
from runningbond.scene.folder_lock import locked

from .outcome import ARRAYS, Outcome
from .scene_arrays import SCENE_KEY, scene_from_arrays, scene_to_arrays

RECORD, RESPONSE_RECORD = "outcome.json", "response.json"
ARRAY_FILES = f"arrays-{'[0-9a-f]' * 16}.npz"
"""Glob pattern of the names of array files; files with other names belong to the user and are left alone."""


class StoreError(Exception):
    """A result folder that cannot be trusted; the message says why."""


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Yield a new file beside `path` that replaces it once written; an OSError names `path`.

    If anything goes wrong, `path` is left as it was before. The folder is created if missing.
    """
    with _errors_named(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=path.suffix.lower())
        os.close(handle)
        try:
            yield Path(name)
            with open(name, "r+b") as file:  # Windows cannot flush a file that is opened only for reading
                os.fsync(file.fileno())
            os.chmod(name, 0o644)
            os.replace(name, path)
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file completely, or leave it as it was before; an OSError names the file."""
    with replacing(path) as beside:
        beside.write_bytes(content)


def make_folder(folder: Path) -> None:
    """Make a folder and check that files can be written there, before a long computation; an OSError names it."""
    if folder.exists() and not folder.is_dir():
        raise FileExistsError(errno.EEXIST, "is not a folder; name one, or a new one", str(folder))
    with _errors_named(folder):
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b" ")


@contextmanager
def _errors_named(path: Path) -> Iterator[None]:
    """Name a path in an OSError."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error


def save_outcome(outcome: Outcome, folder: Path, key: str = "", scene: Scene | None = None) -> None:
    """Write an outcome into its own folder, created if missing.

    `load_outcome` also returns the key, which identifies the input it was computed from; `load_scene` returns the wall.
    """
    columns: dict[str, NDArray[Any]] = {name: getattr(outcome, name) for name in ARRAYS}
    if outcome.path_columns:
        columns |= {"path": outcome.path, "path_columns": np.array(outcome.path_columns)}
    columns |= scene_to_arrays(scene) if scene else {}
    _save(folder, RECORD, {"key": key, **outcome.summary(), "fall": outcome.fall, "moved": outcome.moved}, columns)


def save_response(summary: Mapping[str, Any], scene: Scene, folder: Path) -> None:
    """Write the summary of a response into a folder, created if missing; `load_scene` reads its wall back."""
    _save(folder, RESPONSE_RECORD, summary, scene_to_arrays(scene))


def _save(folder: Path, name: str, said: Mapping[str, Any], columns: Mapping[str, NDArray[Any]]) -> None:
    """Write a JSON file and the arrays that its checksum covers."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **columns)
    content = buffer.getvalue()
    arrays = f"arrays-{hashlib.sha256(content).hexdigest()[:16]}.npz"
    scalars = {"arrays": arrays, **said}
    record = {**scalars, "sha256": _seal(scalars, content)}
    make_folder(folder)
    with locked(folder):  # otherwise another writer would delete these arrays as stale
        write_atomically(folder / arrays, content)
        write_atomically(folder / name, (json.dumps(record, indent=2, allow_nan=False) + "\n").encode())
        for stale in (*folder.glob(ARRAY_FILES), *folder.glob(".arrays-*.npz.*"), *folder.glob(f".{name}.*")):
            if stale.name != arrays:
                stale.unlink(missing_ok=True)


def _seal(scalars: dict[str, object], content: bytes) -> str:
    """Digest of everything that is stored."""
    return hashlib.sha256(json.dumps(scalars, sort_keys=True).encode() + content).hexdigest()


def load_outcome(folder: Path) -> tuple[Outcome, str]:
    """Read an outcome and its key; StoreError if there is none, or if any part is missing, damaged or changed."""
    with _trusted(folder) as (record, stored):
        path = ("path", "path_columns") if "path" in stored else ()
        arrays: dict[str, Any] = {name: stored[name] for name in (*ARRAYS, *path) if name in stored}
        scalars = {name: value for name, value in record.items() if name not in ("key", "arrays")}
        return Outcome(**scalars, **arrays), str(record["key"])


def holds_response(folder: Path) -> bool:
    """Whether a folder contains a response and no outcome."""
    return (folder / RESPONSE_RECORD).is_file() and not (folder / RECORD).is_file()


def load_response_summary(folder: Path) -> dict[str, Any]:
    """Read the summary of a response; StoreError as in `load_outcome`."""
    with _trusted(folder, RESPONSE_RECORD) as (record, _):
        return record


def load_scene(folder: Path) -> Scene:
    """Read the scene of an outcome or a response; StoreError as in `load_outcome`, or if no scene was stored."""
    with _trusted(folder, RESPONSE_RECORD if holds_response(folder) else RECORD) as (_, stored):
        if SCENE_KEY not in stored:
            raise StoreError(f"{folder}: holds an outcome without its scene")
        return scene_from_arrays(stored)


@contextmanager
def _trusted(folder: Path, name: str = RECORD) -> Iterator[tuple[dict[str, Any], Mapping[str, NDArray[Any]]]]:
    """Yield the content of a JSON file and the arrays of a folder, if their checksum matches."""
    try:
        with locked(folder, reading=True):
            record = json.loads((folder / name).read_bytes())
            content = (folder / record["arrays"]).read_bytes()
        seal = record.pop("sha256")
        if _seal(record, content) != seal:
            raise StoreError(f"{folder}: is not what {name} vouches for")
        with np.load(io.BytesIO(content)) as stored:
            yield record, stored
    except OSError as error:
        raise StoreError(f"{folder}: holds no outcome: {error.strerror or error}") from error
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise StoreError(f"{folder / name}: is damaged: {error}") from error
