"""Commands that write files, as a user calls them, and the complete results that they leave."""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from runningbond.results import StoreError, load_outcome

WALL = "wall-w1"
TITLE = "Ferris & Tin-Loi W1"
MODELS = ("homog", "limit", "limit-nonassociated", "dem-static")


@dataclass(frozen=True)
class Command:
    """A command as a user calls it.

    Parameters
    ----------
    name
        Its name.
    arguments
        Its arguments, for a folder to work in.
    begun
        Whether the command has written something to that folder and is not finished.
    found
        Complete results in the folder, by name, with what distinguishes one from another.
    damage
        Damages the results in the folder.
    is_alone
        Whether a second command in the same folder is refused while it runs.
    """

    name: str
    arguments: Callable[[Path], list[str]]
    begun: Callable[[Path], bool]
    found: Callable[[Path], dict[str, object]]
    damage: Callable[[Path], None]
    is_alone: bool = False


def _outcomes(folder: Path) -> dict[str, object]:
    """Complete and undamaged outcomes in a folder, without their computing times."""
    found: dict[str, object] = {}
    for record in folder.rglob("outcome.json"):
        try:
            outcome, key = load_outcome(record.parent)
        except StoreError:
            continue
        if key:
            found[str(record.parent.relative_to(folder))] = outcome.summary() | {"seconds": None}
    return found


def _mesh_file(folder: Path) -> dict[str, object]:
    path = folder / "wall.msh"
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest()} if path.exists() else {}


def pictures(folder: Path) -> dict[str, object]:
    """Pictures in a folder whose files are complete."""
    ends = {".png": b"IEND\xaeB`\x82", ".gif": b";"}
    return {
        path.name: "whole"
        for path in folder.iterdir()
        if path.suffix in ends and path.read_bytes().endswith(ends[path.suffix])
    }


def _halve(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def _damage_outcomes(folder: Path) -> None:
    """Truncate the arrays of one outcome, and the records of the others."""
    records = sorted(folder.rglob("outcome.json"))
    _halve(next(records[0].parent.glob("*.npz")))
    for record in records[1:]:
        _halve(record)


RUN = Command(
    "run",
    lambda folder: ["run", WALL, "--model", "dem-dynamic", "--tolerance", "0.1", "--out", str(folder)],
    lambda folder: (folder / "blocks.pvd").exists(),
    _outcomes,
    _damage_outcomes,
    is_alone=True,
)
COMPARE = Command(
    "compare",
    lambda folder: [
        *("compare", str(folder / "wall.toml"), "--models", ",".join(MODELS)),
        *("--jobs", "1", "--out", str(folder)),
    ],
    lambda folder: any(folder.glob("*/*/outcome.json")),
    _outcomes,
    _damage_outcomes,
)
MESH = Command(
    "mesh",
    lambda folder: ["mesh", "panel-06", "--cells", "4", "--out", str(folder / "wall.msh")],
    lambda folder: any(path.stat().st_size for path in folder.glob(".wall.*.msh")),
    _mesh_file,
    lambda folder: _halve(folder / "wall.msh"),
)
RENDER = Command(
    "render",
    lambda folder: ["render", str(folder)],
    lambda folder: (folder / "mechanism.png").exists(),
    pictures,
    lambda folder: _halve(folder / "blocks.pvd"),
)
COMMANDS = (RUN, COMPARE, MESH, RENDER)
