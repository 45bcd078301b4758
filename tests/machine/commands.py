"""Commands that write, as a user calls them, and the whole work that they leave."""

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
        Whether in that folder something has been written and more is to come.
    found
        What whole work is in the folder, named piece by piece, with what tells one piece from another.
    damage
        Damages what is in the folder.
    is_alone
        Whether another one in the same folder is refused meanwhile.
    """

    name: str
    arguments: Callable[[Path], list[str]]
    begun: Callable[[Path], bool]
    found: Callable[[Path], dict[str, object]]
    damage: Callable[[Path], None]
    is_alone: bool = False


def _outcomes(folder: Path) -> dict[str, object]:
    """Outcomes of a folder that can be trusted and were not broken off, without the time they took."""
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
    """Pictures that end as their format does."""
    ends = {".png": b"IEND\xaeB`\x82", ".gif": b";"}
    return {
        path.name: "whole"
        for path in folder.iterdir()
        if path.suffix in ends and path.read_bytes().endswith(ends[path.suffix])
    }


def _halve(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def _damage_outcomes(folder: Path) -> None:
    """Cut the arrays of one outcome off, and the record of the others."""
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
