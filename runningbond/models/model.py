"""Definition of a model: how it computes an outcome from a scene, and what tables, charts and `advise` need of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias

from runningbond.joints import unread_keys
from runningbond.pictures.frame import Discretisation, Frame
from runningbond.results import Outcome
from runningbond.scene import JointMaterial, Mortar, Scene, SceneError, check_scene, table_of

if TYPE_CHECKING:
    from runningbond.response import Response  # needs a compiler

Kind: TypeAlias = Literal["estimate", "bound", "certificate", "history"]
"""Meaning of a model's multiplier: `bound` is a proven upper bound, `certificate` an interval of loads at which
collapse is proved possible, `history` the collapse load of a wall whose load path is followed up to collapse."""


@dataclass(frozen=True)
class Cost:
    """Law of a model's run time; see `runningbond.models.costs` for its use."""

    at_100: float  # seconds for 100 blocks
    growth: float  # exponent of the number of blocks
    spread: float  # factor about the law within which two thirds of the walls lie
    weightless: float = 1.0  # factor for walls without weight
    finer: float = 0.0  # exponent of 1 / tolerance; 0 for a model without bisection
    start: float = 0.0  # seconds for a wall of any size, for example to load compiled kernels
    cracked: float = 1.0  # factor for walls whose blocks may crack between all of their triangles,
    softened: float = 1.0  # for walls whose joints soften,
    crushed: float = 1.0  # for walls whose joints crush or close under pressure,
    soft: float = 1.0  # and for walls of soft blocks, for which further models run (`second_opinion`)


class Recorder(Protocol):
    """Observer that records a run of its model, in a folder or, if it has none, in `frames`."""

    @property
    def discretisation(self) -> Discretisation:
        """Discretisation of the wall in the record."""

    @property
    def frames(self) -> Sequence[Frame]:
        """The recorded frames, if there is no folder."""

    def __call__(self, *args: Any, **kwargs: Any) -> None:
        """Record a state, in the arguments that the model passes."""

    def finish(self, outcome: Outcome) -> None:
        """Complete the record when the outcome is available."""


class Progress(Protocol):
    """Observer that reports the progress of a run of its model."""

    def __call__(self, *args: Any, **kwargs: Any) -> None:
        """Note a state, in the arguments that the model passes."""

    def line(self) -> str:
        """Progress of the run, in one line; may be called at any time, from another thread."""


@dataclass(frozen=True, eq=False)
class Model:
    """A model: how an outcome is computed from a scene, and the data on this that other packages need.

    `solve` computes an outcome from a scene and the requested relative width of the bracket. It also receives the
    `parameters` by name, and ``observe=…`` if the model has an `observer` or `progress`. `reads` lists the keys of
    a scene file that influence the outcome, such as ``joint.friction``, in addition to the wall, its supports and its
    loads, which every model reads or refuses by name.
    """

    name: str  # name on the command line, in tables and charts
    title: str  # short description
    solve: Callable[..., Outcome]
    reads: frozenset[str]
    kind: Kind = "estimate"  # meaning of the multiplier
    parameters: tuple[str, ...] = ()  # names of the model's settings
    observer: Callable[[Scene, Path | None], Recorder] | None = None  # records a run in a folder, or in memory
    progress: Callable[[], Progress] | None = None  # reports the progress of a run
    interruptible: bool = False  # whether a KeyboardInterrupt makes it return what it has found so far
    cost: Cost | None = None  # `advise` runs no model without this
    is_finite: bool = False  # moves beams through finite displacements, whatever the settings
    takes: frozenset[str] = frozenset()  # features of `Scene.extras` that it supports; it refuses all others by name
    respond: Callable[..., "Response"] | None = None  # response to ground motion, from scene and scale
    colour: str = "0.35"  # style in charts,
    marker: str = "*"
    line: str | tuple[int, tuple[int, ...]] = "-"  # and of curves

    def __post_init__(self) -> None:
        for field in ("reads", "parameters", "takes"):
            if isinstance(value := getattr(self, field), str):
                raise TypeError(f"{field} of a model must be several words, not {value!r}")

    def check(self, scene: Scene) -> None:
        """Refuse a scene with features that this model does not support; the error names the feature."""
        check_scene(scene)
        for key in scene.extras:
            if key not in self.takes:
                raise SceneError(key, f"is not supported by model {self.name}; take another model, or leave it out")

    def unread_by_law(self, scene: Scene) -> list[str]:
        """Keys of joints that this model reads, but the user's law of these joints does not."""
        unread = []
        for material in scene.materials_of_joints if "joint.law" in self.reads else ():
            keys = unread_keys(material, static="joint.fracture_energy_1" not in self.reads)
            given = [key for key in _given_keys(material) if key in keys and f"joint.{key}" in self.reads]
            unread += [f"{table_of(material)}.{key}" for key in given]
        return list(dict.fromkeys(unread))

    def unread(self, scene: Scene, *, finite: bool = False) -> list[str]:
        """Keys of the scene file that are given and that this model does not take into account.

        Displacements are small, unless a beam is moved through `finite` ones, by the settings or by the model itself.
        """
        finite = (finite or self.is_finite) and bool(scene.drive_path)
        unread = []
        for kind, materials in (("block", scene.block_materials), ("joint", scene.materials_of_joints)):
            for material in materials:
                read = material.name != "inner_joint" or "inner_joint" in self.reads
                given = [key for key in _given_keys(material) if not (read and f"{kind}.{key}" in self.reads)]
                unread += [f"{table_of(material)}.{key}" for key in given]
        unread += self.unread_by_law(scene)
        unread = list(dict.fromkeys(unread))  # contacts of corners have materials of the same name
        if scene.beam is not None and scene.beam.force_line != "moving" and not finite:
            unread.append("beam.force_line")
        if scene.drive is not None and scene.drive.rate is not None and "beam.drive.rate" not in self.reads:
            unread.append("beam.drive.rate")
        return unread


def _given_keys(material: Any) -> list[str]:
    """Keys of a material's table whose values differ from the defaults."""
    own = [entry for entry in fields(material) if entry.name != "name"]
    keys = [entry.name for entry in own if getattr(material, entry.name) != entry.default]
    if isinstance(material, JointMaterial) and "elasticity" in keys:
        stiffness = ["mortar"] if isinstance(material.elasticity, Mortar) else ["normal_stiffness", "shear_stiffness"]
        keys[keys.index("elasticity") : keys.index("elasticity") + 1] = stiffness
    return keys
