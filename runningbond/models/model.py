"""What a model is: how a scene becomes an outcome, and what tables, charts and `advise` need to know of it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias

from runningbond.pictures.frame import Discretisation, Frame
from runningbond.results import Outcome
from runningbond.scene import JointMaterial, Mortar, Scene, SceneError, check_scene, table_of

if TYPE_CHECKING:
    from runningbond.response import Response  # which needs a compiler

Kind: TypeAlias = Literal["estimate", "bound", "certificate", "history"]
"""What the multiplier of a model is worth: `bound` is proved from above, `certificate` an interval of loads at which
collapse is proved possible, `history` the collapse of a wall that is followed there."""


@dataclass(frozen=True)
class Cost:
    """Law of what a model costs; `runningbond.compare.advice.costs` says how it is used."""

    at_100: float  # seconds for 100 blocks
    growth: float  # power of the number of blocks
    spread: float  # factor within which two thirds of the walls lie about the law
    weightless: float = 1.0  # how many times as much walls without weight cost
    finer: float = 0.0  # power of the tolerance; 0 for a model that does not bisect
    start: float = 0.0  # seconds that a wall of any size takes, until compiled kernels are loaded for one
    cracked: float = 1.0  # how many times as much walls whose blocks may crack cost,
    softened: float = 1.0  # those whose joints soften,
    crushed: float = 1.0  # those whose joints crush or close under pressure,
    soft: float = 1.0  # and those of soft blocks, beside which others are asked


class Recorder(Protocol):
    """Observes a run of its model, and in the end has written what it saw, or has it in `frames` without a folder."""

    @property
    def discretisation(self) -> Discretisation:
        """The wall as it is observed."""

    @property
    def frames(self) -> Sequence[Frame]:
        """What was seen, where there is no folder."""

    def __call__(self, *args: Any, **kwargs: Any) -> None:
        """Look at a state, as the model shows it."""

    def finish(self, outcome: Outcome) -> None:
        """End, once the outcome is there."""


class Progress(Protocol):
    """Observes a run of its model, as a `Recorder` does, and says how far it has come."""

    def __call__(self, *args: Any, **kwargs: Any) -> None:
        """Look at a state, as the model shows it."""

    def line(self) -> str:
        """How far it has come, in a line; asked for at any time, from another thread."""


@dataclass(frozen=True, eq=False)
class Model:
    """A model: how a scene becomes an outcome, and what others need to know of that.

    `solve` goes from a scene and the relative width of the bracket asked for to an outcome. It is handed `parameters`
    by name, and ``observe=…`` if the model has an `observer`. `reads` has the keys of a scene file that have an
    influence on the outcome, as ``joint.friction``, besides the wall, its supports and its loads, which every model
    reads or refuses by name.
    """

    name: str  # what the command line, tables and charts call it
    title: str  # what it does, in half a line
    solve: Callable[..., Outcome]
    reads: frozenset[str]
    kind: Kind = "estimate"  # what its multiplier is worth
    parameters: tuple[str, ...] = ()  # names of its own settings
    observer: Callable[[Scene, Path | None], Recorder] | None = None  # records a run in a folder, or in memory
    progress: Callable[[], Progress] | None = None  # says how far a run has come
    interruptible: bool = False  # whether it ends with what it has found so far on KeyboardInterrupt
    cost: Cost | None = None  # `advise` runs no model without
    is_finite: bool = False  # leads beams through finite displacements, whatever its settings
    takes: frozenset[str] = frozenset()  # what it can do of `Scene.extras`; scenes with others it refuses by name
    respond: Callable[..., "Response"] | None = None  # response to a motion of the ground, of scene, scale
    colour: str = "0.35"  # how charts draw it,
    marker: str = "*"
    line: str | tuple[int, tuple[int, ...]] = "-"  # and its curve

    def __post_init__(self) -> None:
        for field in ("reads", "parameters", "takes"):
            if isinstance(value := getattr(self, field), str):
                raise TypeError(f"{field} of a model must be several words, not {value!r}")

    def check(self, scene: Scene) -> None:
        """Refuse, by name, a scene with what this model does not know of."""
        check_scene(scene)
        for key in scene.extras:
            if key not in self.takes:
                raise SceneError(key, f"is not taken by model {self.name}; take another model, or leave it out")

    def unread(self, scene: Scene, *, finite: bool = False) -> list[str]:
        """Keys of its file that a scene gives and this model does not take into account.

        Displacements are small, unless a beam is led through `finite` ones, as settings or the model itself have it.
        """
        finite = (finite or self.is_finite) and bool(scene.drive_path)
        unread = []
        for kind, materials in (("block", scene.block_materials), ("joint", scene.materials_of_joints)):
            for material in materials:
                read = material.name != "inner_joint" or "inner_joint" in self.reads
                given = [key for key in _given_keys(material) if not (read and f"{kind}.{key}" in self.reads)]
                unread += [f"{table_of(material)}.{key}" for key in given]
        if scene.beam is not None and scene.beam.force_line != "moving" and not finite:
            unread.append("beam.force_line")
        if scene.drive is not None and scene.drive.rate is not None and "beam.drive.rate" not in self.reads:
            unread.append("beam.drive.rate")
        return unread


def _given_keys(material: Any) -> list[str]:
    """Keys of a material's table that say something else than their defaults."""
    own = [entry for entry in fields(material) if entry.name != "name"]
    keys = [entry.name for entry in own if getattr(material, entry.name) != entry.default]
    if isinstance(material, JointMaterial) and "elasticity" in keys:
        stiffness = ["mortar"] if isinstance(material.elasticity, Mortar) else ["normal_stiffness", "shear_stiffness"]
        keys[keys.index("elasticity") : keys.index("elasticity") + 1] = stiffness
    return keys
