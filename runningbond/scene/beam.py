"""The beam: a stiff body across the top of a wall, through which a test rig or a floor loads it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias, cast, get_args

import numpy as np

from .actions import Action
from .arrays import Array
from .blocks import Blocks
from .errors import SceneError
from .forces import Forces
from .protocol import read_protocol
from .ranges import ABOVE_ZERO, AT_LEAST_ZERO, NotNegative, Positive, Range, check_numbers, one_of, vector
from .supports import NO_PINS, Pins
from .table import Table

if TYPE_CHECKING:
    from .scene import Scene

Condition: TypeAlias = Literal["free", "level", "fixed-height"]
CONDITIONS: tuple[str, ...] = get_args(Condition)

ForceLine: TypeAlias = Literal["moving", "fixed"]
FORCE_LINES: tuple[str, ...] = get_args(ForceLine)


@dataclass(frozen=True)
class Drive:
    """How a beam is driven: by a live force, or by a horizontal displacement.

    Parameters
    ----------
    force
        Live force [N] at λ = 1. For a prescribed displacement it is 1 N along the first move, and λ the reaction [N].
    at
        Height above the base of the wall at which the drive acts [m]; None is mid-height of the beam.
    path
        Horizontal displacements [m] prescribed at this point, one after the other; empty if a force drives the beam.
    rate
        Speed of the prescribed displacement [m/s]; None leaves it to the model.
    """

    force: tuple[float, float]
    at: float | None = None
    path: tuple[float, ...] = ()
    rate: float | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "force", vector("beam.drive.force", self.force))
        if not any(self.force):
            raise SceneError("beam.drive.force", "must not be zero", list(self.force))
        if self.at is not None:
            object.__setattr__(self, "at", Range().take("beam.drive.at", self.at))
        if self.rate is not None:
            object.__setattr__(self, "rate", ABOVE_ZERO.take("beam.drive.rate", self.rate))

    @classmethod
    def along(cls, path: tuple[float, ...], at: float | None = None, rate: float | None = None) -> "Drive":
        """A drive that prescribes a sequence of horizontal displacements [m]."""
        numbers = tuple(Range().take("beam.drive.displacement", x) for x in path)
        moves = np.diff(np.concatenate([[0.0], numbers]))
        if not moves.any():
            raise SceneError("beam.drive.displacement", "must move the beam", list(path))
        return cls((float(np.sign(moves[np.flatnonzero(moves)[0]])), 0.0), at, numbers, rate)


@dataclass(frozen=True)
class Beam:
    """A stiff body across the top of a wall.

    Parameters
    ----------
    height, mass
        Height [m] and mass [kg] of the beam.
    condition
        ``"free"``; ``"level"``: no rotation; ``"fixed-height"``: no rotation, and no vertical displacement once the
        dead load has been applied.
    force
        Dead force at the centre of the beam [N].
    force_line
        Whether, at finite displacements, this force moves with the centre or keeps its line of action. A jack that
        stays in place while the beam rolls under it has a ``"fixed"`` line.
    drive
        How the beam is driven; None if it is not.
    joint
        Name of the material of the joints between beam and wall; None is the default one.
    block
        Number of the beam among the blocks of a scene; None before it has been added to one.
    """

    height: Positive
    mass: NotNegative = 0.0
    condition: Condition = "free"
    force: tuple[float, float] = (0.0, 0.0)
    drive: Drive | None = None
    joint: str | None = None
    block: int | None = None
    force_line: ForceLine = "moving"

    def __post_init__(self) -> None:
        check_numbers(self, "beam")
        one_of("beam.condition", self.condition, CONDITIONS)
        one_of("beam.force_line", self.force_line, FORCE_LINES)
        object.__setattr__(self, "force", vector("beam.force", self.force))
        if self.force_line == "fixed" and not any(self.force):
            raise SceneError("beam.force", "is missing; force_line says where it acts", list(self.force))

    def outline(self, blocks: Blocks) -> Array:
        """Rectangle ``(4, 2)`` [m] of the beam on the highest level of a wall, as long as the edges at this level."""
        level = blocks.extent()[1][1]
        start, stop = blocks.vertices, blocks.vertices[blocks.successor]
        on_top = (np.minimum(start[:, 1], stop[:, 1]) >= level - blocks.tolerance) & (
            np.abs(stop[:, 0] - start[:, 0]) > blocks.tolerance
        )
        if not on_top.any():
            raise SceneError("beam.height", "finds no level top to lie on: the wall ends in a corner", self.height)
        x = np.concatenate([start[on_top, 0], stop[on_top, 0]])
        left, right, top = x.min(), x.max(), level + self.height
        return np.array([[left, level], [right, level], [right, top], [left, top]])

    def pins(self, centroid: Array) -> Pins:
        """Pins that hold the rotation of a beam with this centroid ``(2,)`` [m] at all times; none if it is free."""
        if self.condition == "free" or self.block is None:
            return NO_PINS
        return Pins(np.array([self.block]), centroid, np.zeros(2), np.ones(1))

    def late_pins(self, centroid: Array) -> Pins:
        """Pins that are added once the dead load has been applied: the height of a ``"fixed-height"`` beam."""
        if self.condition != "fixed-height" or self.block is None:
            return NO_PINS
        return Pins(np.array([self.block]), centroid, np.array([0.0, 1.0]))

    def loads(self) -> tuple[tuple[Action, ...], tuple[Action, ...]]:
        """Live loads and dead loads of the beam."""
        live = () if self.drive is None else (BeamLoad(self.drive.force, self.drive.at, "beam.drive"),)
        return live, (BeamLoad(self.force),) if any(self.force) else ()


@dataclass(frozen=True)
class BeamLoad(Action):
    """A force [N] on the beam, at a height above the base of the wall [m]; None is the beam's centroid."""

    force: tuple[float, float]
    height: float | None = None
    key: str = "beam.force"

    def forces(self, scene: "Scene") -> Forces:
        """Force on the block that is the beam."""
        block = scene.beam.block if scene.beam else None
        if block is None:
            raise SceneError(self.key, "needs a beam", list(self.force))
        x, y = scene.blocks.centroid[block]
        base = scene.blocks.extent(scene.wall)[0][1]
        at = (x, y if self.height is None else base + self.height)
        return Forces.on(scene, block=[block], at=at, force=self.force)


def read_beam(table: Table, joint_names: Sequence[str]) -> Beam:
    """Read the beam from a table of a scene file; its joint material must be one of `joint_names`."""
    drive = table.optional_table("drive")
    beam = Beam(
        table.number("height", ABOVE_ZERO),
        table.optional_number("mass", AT_LEAST_ZERO) or 0.0,
        condition=cast(Condition, table.choice("condition", CONDITIONS, "free")),
        force=table.vector("force") if "force" in table else (0.0, 0.0),
        drive=_read_drive(drive) if drive else None,
        joint=table.choice("joint", joint_names) if "joint" in table else None,
        force_line=cast(ForceLine, table.choice("force_line", FORCE_LINES, "moving")),
    )
    table.finish()
    return beam


def _read_drive(table: Table) -> Drive:
    at, path = table.optional_number("at", Range()), table.value("displacement")
    to_and_fro = read_protocol(table)
    if (path is not None) + (to_and_fro is not None) + ("force" in table) != 1:
        raise SceneError(table.name, "must have one of force, displacement and amplitudes")
    if to_and_fro is not None:
        drive = Drive.along(to_and_fro, at, table.optional_number("rate", ABOVE_ZERO))
    elif path is None:
        drive = Drive(table.vector("force"), at)
    else:
        if isinstance(path, list) and len(path) == 1 and isinstance(path[0], list) and path[0]:
            horizontal = tuple(path[0])
        else:
            x, y = vector(table.key("displacement"), path)
            if y:
                raise SceneError(table.key("displacement"), "must be horizontal, [x, 0] or [[x0, x1, …]]", path)
            horizontal = (x,)
        drive = Drive.along(horizontal, at, table.optional_number("rate", ABOVE_ZERO))
    table.finish()
    return drive
