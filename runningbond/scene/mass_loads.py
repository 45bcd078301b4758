"""Loads in proportion to mass: a push sideways, a tilt of the ground, an acceleration."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .actions import Action, nonzero_vector
from .errors import SceneError
from .forces import Forces
from .table import Table

if TYPE_CHECKING:
    from .wall import Scene

SIDES = {"right": (1.0, 0.0), "left": (-1.0, 0.0)}
LEVEL = 1e-6
"""Cosine between gravity and the ground that is none."""


@dataclass(frozen=True)
class Lateral(Action):
    """Each block pushed by its own weight along a direction, made a unit vector; λ is the ratio of push to weight."""

    direction: tuple[float, float] = (1.0, 0.0)

    def __post_init__(self) -> None:
        x, y = nonzero_vector("load.live.direction", self.direction)
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
        direction = table.peek("direction")
        if isinstance(direction, str) and direction not in SIDES:
            raise SceneError(table.key("direction"), 'must be "right", "left" or a vector [x, y]', direction)
        given = isinstance(direction, (list, tuple))
        return cls(table.vector("direction") if given else SIDES[table.choice("direction", SIDES, "right")])


@dataclass(frozen=True)
class Tilt(Lateral):
    """The ground turned under the wall, down to the side of the direction: λ is the tangent of its angle.

    Along the ground the weight of each block counts λ times, and across it once. Of a wall turned by α both are less
    by cos α, which matters only where joints have a strength, or other loads act, that does not grow with the weight.
    """

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a direction that is not along the ground, across the weight: λ would be the tangent of no angle."""
        super().check(scene, key)
        weight = np.array(scene.load.gravity)
        if abs(weight @ self.direction) > LEVEL * np.hypot(*weight):
            remedy = (
                f"must be across gravity, along the ground; to the right that is [{-weight[1]:.4g}, {weight[0]:.4g}]"
            )
            raise SceneError(f"{key}.direction", remedy, np.round(self.direction, 6).tolist())

    def note(self, multiplier: float) -> str:
        """The angle in degrees."""
        return f"the ground is tilted by {math.degrees(math.atan(multiplier)):.4g}°"


@dataclass(frozen=True)
class Body(Action):
    """An acceleration [m/s²] of all blocks."""

    acceleration: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "acceleration", nonzero_vector("load.live.acceleration", self.acceleration))

    def forces(self, scene: "Scene") -> Forces:
        """The same force per mass on each block."""
        return Forces.on(scene, self.acceleration)
