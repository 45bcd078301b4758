"""Loads proportional to mass: a lateral load, a tilt of the ground, an acceleration."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .actions import Action, nonzero_vector
from .errors import SceneError
from .forces import Forces
from .table import Table

if TYPE_CHECKING:
    from .scene import Scene

SIDES = {"right": (1.0, 0.0), "left": (-1.0, 0.0)}
PERPENDICULAR_COSINE = 1e-6
"""Cosine of the angle between gravity and a direction up to which they count as perpendicular."""


@dataclass(frozen=True)
class Lateral(Action):
    """A force on each block along a direction, kept as a unit vector; λ is the ratio of this force to the weight."""

    direction: tuple[float, float] = (1.0, 0.0)

    def __post_init__(self) -> None:
        x, y = nonzero_vector("load.live.direction", self.direction)
        length = float(np.hypot(x, y))
        object.__setattr__(self, "direction", (x / length, y / length))

    def forces(self, scene: "Scene") -> Forces:
        """A force equal to its weight on each block, along the direction."""
        gravity = float(np.hypot(*scene.load.gravity))
        return Forces.on(scene, (gravity * self.direction[0], gravity * self.direction[1]))

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a scene whose blocks have no weight."""
        if not any(scene.load.gravity):
            what = "leaves a lateral load nothing to push with; give the blocks a weight"
            raise SceneError("load.gravity", what, 0.0)

    @classmethod
    def read(cls, table: Table) -> "Lateral":
        """Read the load from a table of a scene file; its direction is to the right by default."""
        direction = table.peek("direction")
        if isinstance(direction, str) and direction not in SIDES:
            raise SceneError(table.key("direction"), 'must be "right", "left" or a vector [x, y]', direction)
        given = isinstance(direction, (list, tuple))
        return cls(table.vector("direction") if given else SIDES[table.choice("direction", SIDES, "right")])


@dataclass(frozen=True)
class Tilt(Lateral):
    """A tilt of the ground under the wall, down towards the direction: λ is the tangent of the tilt angle.

    The model applies λ times the weight of each block along the ground and the full weight normal to it. In a wall
    tilted by α both are smaller by the factor cos α. This matters only if joint strengths or other loads do not scale
    with the weight.
    """

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a direction not perpendicular to gravity, for which λ would not be the tangent of a tilt angle."""
        super().check(scene, key)
        weight = np.array(scene.load.gravity)
        if abs(weight @ self.direction) > PERPENDICULAR_COSINE * np.hypot(*weight):
            remedy = (
                f"must be across gravity, along the ground; to the right that is [{-weight[1]:.4g}, {weight[0]:.4g}]"
            )
            raise SceneError(f"{key}.direction", remedy, np.round(self.direction, 6).tolist())

    def note(self, multiplier: float) -> str:
        """The tilt angle in degrees."""
        return f"the ground is tilted by {math.degrees(math.atan(multiplier)):.4g}°"


@dataclass(frozen=True)
class Body(Action):
    """A force per unit mass [m/s²] on all blocks."""

    acceleration: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "acceleration", nonzero_vector("load.live.acceleration", self.acceleration))

    def forces(self, scene: "Scene") -> Forces:
        """The same force per unit mass on each block."""
        return Forces.on(scene, self.acceleration)
