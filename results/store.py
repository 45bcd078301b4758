"""Outcomes on disk: written whole or not at all, and never read by halves.

A result folder holds ``outcome.json`` and the arrays it names. The arrays are written first, under a name
that carries their digest; the JSON file is moved into place last, and only what it vouches for is read.
"""

import hashlib
import io
import json
import os
import tempfile
from pathlib import Path

import numpy as np

from .outcome import ARRAYS, Outcome

RECORD = "outcome.json"


class StoreError(Exception):
    """A result folder that cannot be trusted; the message says why."""


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file so that it is there whole, or as it was before."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def save_outcome(outcome: Outcome, folder: Path, key: str = "") -> None:
    """Write an outcome into a folder of its own.

    Parameters
    ----------
    outcome
        The outcome.
    folder
        The folder; made if missing.
    key
        What the outcome was computed from, given back by `load_outcome`.
    """
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **{name: getattr(outcome, name) for name in ARRAYS})
    content = buffer.getvalue()
    arrays = f"arrays-{hashlib.sha256(content).hexdigest()[:16]}.npz"
    write_atomically(folder / arrays, content)
    scalars = {"key": key, "arrays": arrays, **outcome.summary()}
    record = {**scalars, "sha256": _seal(scalars, content)}
    write_atomically(folder / RECORD, (json.dumps(record, indent=2, allow_nan=False) + "\n").encode())
    for stale in folder.glob("arrays-*.npz"):
        if stale.name != arrays:
            stale.unlink(missing_ok=True)


def _seal(scalars: dict[str, object], content: bytes) -> str:
    """Digest of everything that is kept."""
    return hashlib.sha256(json.dumps(scalars, sort_keys=True).encode() + content).hexdigest()


def load_outcome(folder: Path) -> tuple[Outcome, str]:
    """Read an outcome and its key back.

    Raises
    ------
    StoreError
        If there is no outcome, or anything about it is missing, damaged or not what was written.
    """
    try:
        record = json.loads((folder / RECORD).read_bytes())
        content = (folder / record["arrays"]).read_bytes()
        seal = record.pop("sha256")
        if _seal(record, content) != seal:
            raise StoreError(f"{folder}: is not what {RECORD} vouches for")
        with np.load(io.BytesIO(content)) as stored:
            arrays = {name: stored[name] for name in ARRAYS}
        scalars = {name: value for name, value in record.items() if name not in ("key", "arrays")}
        return Outcome(**scalars, **arrays), str(record["key"])
    except OSError as error:
        raise StoreError(f"{folder}: holds no outcome: {error.strerror or error}") from error
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise StoreError(f"{folder / RECORD}: is damaged: {error}") from error
