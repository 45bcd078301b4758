"""Loads: dead ones that are always there, and live ones that λ multiplies.

A kind of load is one class here: what it asks of a scene, the forces that it puts on its blocks, and how a file says
it (`KINDS`). One of a user's own is a subclass of `Action` too, and an object of it stands where a file has a table.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np

from .arrays import Array, Indices
from .errors import SceneError, keys_of
from .forces import Arrow, Forces
from .ranges import AT_LEAST_ZERO, one_of, vector
from .table import Table

if TYPE_CHECKING:
    from .wall import Scene

LEAST_COMPONENT = 1e-6
"""Least component of a force that is not 0, in the other one: what is smaller is lost in a program's tolerance."""

SIDES = {"right": (1.0, 0.0), "left": (-1.0, 0.0)}


class Action:
    """A load. `forces` is what every kind has to say; the rest follows from it unless a kind knows better."""

    def forces(self, scene: "Scene") -> Forces:
        """Forces on a scene's blocks; of a live load, those at λ = 1."""
        raise NotImplementedError(f"{type(self).__name__} says no forces")

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a scene that the load cannot act on, in a `SceneError` under its key."""

    def factor(self, time: float) -> float:
        """What multiplies the load at a time [s]; only models that follow a history of loads read it."""
        return 1.0

    def arrows(self, scene: "Scene") -> tuple[Arrow, ...]:
        """What is drawn: an arrow at each point with a force, and a row of them for a force on the blocks' mass."""
        forces = self.forces(scene)
        tips = [tuple(tip) for tip in forces.at.tolist()]
        arrows = []
        for tip in dict.fromkeys(tips):
            here = np.array([tip == other for other in tips])
            arrows.append(Arrow(_unit(forces.force[here].sum(axis=0)), np.array(tip), forces.block[here]))
        if forces.acceleration.any():
            arrows.append(Arrow(_unit(scene.mass @ forces.acceleration), None, np.zeros(0, dtype=np.int64)))
        return tuple(arrows)

    def control(self, scene: "Scene") -> tuple[Indices, Array, Array]:
        """Blocks whose displacement is averaged at the control point ``(n,)``, the point and a direction ``(2,)``.

        It is where the first force at a point of a block that can move acts, or else the highest corner that
        lies farthest along the load (the paper's upper corner on the side of the push).
        """
        arrows = self.arrows(scene)
        for arrow in arrows:
            movable = arrow.block[~scene.fixed[arrow.block]]
            if arrow.at is not None and len(movable):
                return movable, arrow.at, arrow.direction
        direction = arrows[-1].direction if arrows else np.array([1.0, 0.0])
        blocks, gravity = scene.blocks, scene.load.gravity
        up = -_unit(np.array(gravity)) if any(gravity) else np.array([0.0, 1.0])
        corners = np.flatnonzero(~scene.fixed[blocks.owner])
        height = blocks.vertices[corners] @ up
        top = corners[height >= height.max() - blocks.tolerance]
        corner = top[[np.argmax(blocks.vertices[top] @ direction)]]
        return blocks.owner[corner], blocks.vertices[corner[0]], direction

    @classmethod
    def read(cls, table: Table) -> "Action":
        """The load that a table of a file describes: vectors, named as the fields of its dataclass are."""
        return cls(**{name: table.vector(name) for name in get_type_hints(cls)})


@dataclass(frozen=True)
class Lateral(Action):
    """Each block pushed by its own weight along a direction, made a unit vector; λ is the ratio of push to weight."""

    direction: tuple[float, float] = (1.0, 0.0)

    def __post_init__(self) -> None:
        x, y = _direction("load.live.direction", self.direction)
        length = float(np.hypot(x, y))
        object.__setattr__(self, "direction", (x / length, y / length))

    def forces(self, scene: "Scene") -> Forces:
        """The weight of each block, along the direction."""
        gravity = float(np.hypot(*scene.load.gravity))
        return Forces.on(scene, (gravity * self.direction[0], gravity * self.direction[1]))

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse blocks without weight."""
        if not any(scene.load.gravity):
            what = "leaves a lateral load nothing to push with; give the blocks a weight"
            raise SceneError("load.gravity", what, 0.0)

    @classmethod
    def read(cls, table: Table) -> "Lateral":
        """The load of a table with a direction, to the right unless it says another."""
        direction = table.value("direction", "right")
        if isinstance(direction, str):
            direction = SIDES[one_of(table.key("direction"), direction, SIDES)]
        return cls(direction)


@dataclass(frozen=True)
class Body(Action):
    """An acceleration [m/s²] of all blocks."""

    acceleration: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "acceleration", _direction("load.live.acceleration", self.acceleration))

    def forces(self, scene: "Scene") -> Forces:
        """The same force per mass on each block."""
        return Forces.on(scene, self.acceleration)


@dataclass(frozen=True)
class PointLoad(Action):
    """A force [N] at a point [m], shared equally by the movable blocks that touch it."""

    at: tuple[float, float]
    force: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "at", vector("load.live.at", self.at))
        object.__setattr__(self, "force", _direction("load.live.force", self.force))

    def blocks(self, scene: "Scene") -> Indices:
        """Movable blocks that share the load, ``(n,)``."""
        touching = scene.blocks.containing(np.array(self.at))
        return touching[~scene.fixed[touching]]

    def forces(self, scene: "Scene") -> Forces:
        """An equal share of the force on each block."""
        block = self.blocks(scene)
        return Forces.on(scene, block=block, at=self.at, force=np.array(self.force) / max(1, len(block)))

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a point that nothing is at."""
        if len(self.blocks(scene)) == 0:
            (x0, y0), (x1, y1) = scene.blocks.extent(scene.wall)
            spans = f"x {x0:.4g} … {x1:.4g} m, y {y0:.4g} … {y1:.4g} m"
            raise SceneError(f"{key}.at", f"touches no block that can move; the wall spans {spans}", list(self.at))


@dataclass(frozen=True, eq=False)
class GivenForces(Action):
    """Forces as they are: what a record keeps of a load of a user's own."""

    given: Forces

    def forces(self, scene: "Scene") -> Forces:
        """These forces."""
        return self.given


@dataclass(frozen=True)
class Load:
    """All loads of a scene.

    Parameters
    ----------
    gravity
        Acceleration [m/s²] that gives the blocks their weight, a dead load.
    live
        Loads that λ multiplies, all of them together; at least one. One alone may be given as it is.
    dead
        Loads beside the weight of the blocks that λ does not multiply.
    """

    gravity: tuple[float, float] = (0.0, -9.81)
    live: tuple[Action, ...] = field(default_factory=lambda: (Lateral(),))
    dead: tuple[Action, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "gravity", vector("load.gravity", self.gravity))
        for name in ("live", "dead"):
            given: Any = getattr(self, name)
            loads = tuple(given) if isinstance(given, Sequence) else (given,)
            if not all(isinstance(load, Action) for load in loads) or (name == "live" and not loads):
                raise SceneError(f"load.{name}", "must be a load, or some: objects of classes like Lateral", given)
            object.__setattr__(self, name, loads)

    def named(self) -> list[tuple[str, Action]]:
        """Each load with the key that a file has it under."""
        groups = (("load.live", self.live), ("load.dead", self.dead))
        return [
            (f"{name}[{k}]" if len(loads) > 1 else name, load) for name, loads in groups for k, load in enumerate(loads)
        ]


KINDS: dict[str, type[Action]] = {"lateral": Lateral, "point": PointLoad, "body": Body}
"""Kinds of loads, by the names that scene files have for them."""


def read_load(table: Table) -> Load:
    """The loads of a file; in Python an object may stand in place of the table of one."""
    if isinstance(table.peek("gravity"), (list, tuple)):
        gravity = table.vector("gravity")
    else:
        gravity = (0.0, -table.number("gravity", AT_LEAST_ZERO))
    live = _read_actions(table.key("live"), table.required("live", "a table"))
    dead = _read_actions(table.key("dead"), table.value("dead", []))
    table.finish()
    return Load(gravity, live, dead)


def _read_actions(key: str, content: Any) -> tuple[Action, ...]:
    if isinstance(content, (list, tuple)):
        return tuple(action for k, one in enumerate(content) for action in _read_actions(f"{key}[{k}]", one))
    if isinstance(content, Action):
        return (content,)
    table = Table(key, content)
    kind = KINDS[table.choice("kind", KINDS)]
    with keys_of(key, "load.live"):
        action = kind.read(table)
    table.finish()
    return (action,)


def _direction(key: str, value: Any) -> tuple[float, float]:
    """A vector that is not zero, neither component of which is lost in the other."""
    pair = vector(key, value)
    if not any(pair):
        raise SceneError(key, "must not be zero", list(pair))
    smaller, larger = sorted(map(abs, pair))
    if 0 < smaller < LEAST_COMPONENT * larger:
        what = f"must have components that are 0 or at least {LEAST_COMPONENT:g} of each other"
        raise SceneError(key, what, list(pair))
    return pair


def _unit(direction: Array) -> Array:
    length = np.hypot(*direction)
    return direction / length if length > 0 else np.array([1.0, 0.0])
