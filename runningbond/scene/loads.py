"""Loads: dead loads, which are constant, and live loads, which λ multiplies.

Each kind of load is a class that defines its requirements on a scene, its forces on the blocks, and how it is read from
a file (`KINDS`). Users can add kinds as subclasses of `Action`, and pass objects of them in place of a file's table.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .actions import Action
from .beam import BeamLoad
from .errors import SceneError, keys_of
from .history import KEY, History, read_history
from .mass_loads import Body, Lateral, Tilt
from .point_loads import LineLoad, Moment, PointLoad
from .ranges import AT_LEAST_ZERO, vector
from .settlement import Settlement
from .table import Table


@dataclass(frozen=True)
class Load:
    """All loads of a scene.

    Parameters
    ----------
    gravity
        Gravitational acceleration [m/s²]; the weight of the blocks is a dead load.
    live
        Loads that λ multiplies, all by the same factor. A single load may be given without a tuple.
    dead
        Loads that λ does not multiply, in addition to the weight of the blocks.
    """

    gravity: tuple[float, float] = (0.0, -9.81)
    live: tuple[Action, ...] = field(default_factory=lambda: (Lateral(),))
    dead: tuple[Action, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "gravity", vector("load.gravity", self.gravity))
        for name in ("live", "dead"):
            given: Any = getattr(self, name)
            loads = tuple(given) if isinstance(given, Sequence) else (given,)
            if not all(isinstance(load, Action) for load in loads):
                raise SceneError(f"load.{name}", "must be a load, or some: objects of classes like Lateral", given)
            object.__setattr__(self, name, loads)

    def named(self) -> list[tuple[str, Action]]:
        """All loads, each with its key in a scene file."""
        groups = (("load.live", self.live), ("load.dead", self.dead))
        named: list[tuple[str, Action]] = []
        for name, loads in groups:
            listed = [load for load in loads if not isinstance(load, (BeamLoad, History))]
            named += [(f"{name}[{k}]" if len(listed) > 1 else name, load) for k, load in enumerate(listed)]
            named += [(load.key, load) for load in loads if isinstance(load, BeamLoad)]
            named += [(KEY, load) for load in loads if isinstance(load, History)]
        return named


KINDS: dict[str, type[Action]] = {
    "lateral": Lateral,
    "tilt": Tilt,
    "body": Body,
    "point": PointLoad,
    "line": LineLoad,
    "moment": Moment,
    "settlement": Settlement,
}
"""Kinds of loads, by their names in scene files."""


DEAD_KINDS = [kind for kind in KINDS if kind not in ("tilt", "settlement")]
"""Kinds of loads that may be dead loads."""


def read_load(table: Table, folder: Path, *, driven: bool = False) -> Load:
    """Read the loads of a scene file; in Python, objects may be given in place of tables.

    A live load may be missing only if the wall is driven by its beam (`driven`) or by the motion of its ground, whose
    record has a path relative to `folder`.
    """
    if isinstance(table.peek("gravity"), (list, tuple)):
        gravity = table.vector("gravity")
    else:
        gravity = (0.0, -table.number("gravity", AT_LEAST_ZERO))
    history = _history(table, folder, driven=driven)
    given = table.value("live", []) if driven or history else table.required("live", "a table")
    live = _read_actions(table.key("live"), given, list(KINDS))
    dead = _read_actions(table.key("dead"), table.value("dead", []), DEAD_KINDS)
    table.finish()
    if history:
        return Load(gravity, (history,), dead)
    if not live and not driven:
        raise SceneError(table.key("live"), "must be a load, or some", given)
    return Load(gravity, live, dead)


def _history(table: Table, folder: Path, *, driven: bool) -> History | None:
    given = table.value("history")
    if given is None:
        return None
    if driven or "live" in table:
        what = "does not go with load.history, which is what λ multiplies; leave one out"
        raise SceneError("beam.drive" if driven else table.key("live"), what)
    return given if isinstance(given, History) else read_history(Table(KEY, given), folder)


def _read_actions(key: str, content: Any, kinds: list[str]) -> tuple[Action, ...]:
    if isinstance(content, (list, tuple)):
        for k, one in enumerate(content):
            if isinstance(one, (list, tuple)) and not one:
                raise SceneError(f"{key}[{k}]", "must be a load, or some", one)
        return tuple(action for k, one in enumerate(content) for action in _read_actions(f"{key}[{k}]", one, kinds))
    if isinstance(content, Action):
        return (content,)
    table = Table(key, content)
    kind = KINDS[table.choice("kind", kinds)]
    with keys_of(key, "load.live"):
        action = kind.read(table)
    table.finish()
    return (action,)
