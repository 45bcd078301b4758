"""What a load is: the forces that it puts on a scene's blocks, and what else follows from them."""

from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np

from .arrays import Array, Indices
from .errors import SceneError
from .forces import Arrow, Forces
from .ranges import vector
from .table import Table

if TYPE_CHECKING:
    from .wall import Scene

LEAST_COMPONENT = 1e-6
"""Least component of a force that is not 0, in the other one: what is smaller is lost in a program's tolerance."""


ROUNDING = 1e-12
"""Component, in the other one, that is what a computed sine or cosine leaves of zero."""


class Action:
    """A load. `forces` is what every kind has to say; the rest follows from it unless a kind knows better."""

    def forces(self, scene: "Scene") -> Forces:
        """Forces on a scene's blocks; of a live load, those at λ = 1."""
        raise NotImplementedError(f"{type(self).__name__} says no forces")

    def forces_by_piece(self, scene: "Scene", edges: Array) -> Forces:
        """Forces on a scene's blocks, at points that each lie in one of the pieces that they are cut into.

        The pieces are triangles, of a mesh or of blocks that may crack, and given by their edges ``(n, 2, 2)`` [m].
        """
        return self.forces(scene)

    def check(self, scene: "Scene", key: str) -> None:
        """Refuse a scene that the load cannot act on, in a `SceneError` under its key."""

    def note(self, multiplier: float) -> str:
        """What an outcome's message is to say of a multiplier, beside its number."""
        return ""

    def arrows(self, scene: "Scene") -> tuple[Arrow, ...]:
        """What is drawn: an arrow at each point with a force, and a row of them for a force on the blocks' mass."""
        forces = self.forces(scene)
        tips = [tuple(tip) for tip in forces.at.tolist()]
        arrows = []
        for tip in dict.fromkeys(tips):
            here = np.array([tip == other for other in tips])
            arrows.append(Arrow(unit_vector(forces.force[here].sum(axis=0)), np.array(tip), forces.block[here]))
        if forces.acceleration.any():
            arrows.append(Arrow(unit_vector(scene.mass @ forces.acceleration), None, np.zeros(0, dtype=np.int64)))
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
        up = -unit_vector(np.array(gravity)) if any(gravity) else np.array([0.0, 1.0])
        corners = np.flatnonzero(~scene.fixed[blocks.owner])
        height = blocks.vertices[corners] @ up
        top = corners[height >= height.max() - blocks.tolerance]
        corner = top[[np.argmax(blocks.vertices[top] @ direction)]]
        return blocks.owner[corner], blocks.vertices[corner[0]], direction

    @classmethod
    def read(cls, table: Table) -> "Action":
        """The load that a table of a file describes: vectors, named as the fields of its dataclass are."""
        return cls(**{name: table.vector(name) for name in get_type_hints(cls)})


def nonzero_vector(key: str, value: Any) -> tuple[float, float]:
    """A vector that is not zero, neither component of which is lost in the other."""
    pair = vector(key, value)
    rounding = ROUNDING * max(map(abs, pair))
    pair = pair[0] * (abs(pair[0]) > rounding), pair[1] * (abs(pair[1]) > rounding)
    if not any(pair):
        raise SceneError(key, "must not be zero", list(pair))
    smaller, larger = sorted(map(abs, pair))
    if 0 < smaller < LEAST_COMPONENT * larger:
        what = f"must have components that are 0 or at least {LEAST_COMPONENT:g} of each other"
        raise SceneError(key, what, list(pair))
    return pair


def unit_vector(direction: Array) -> Array:
    """A direction ``(2,)`` as a unit vector; along x where it is zero."""
    length = np.hypot(*direction)
    return direction / length if length > 0 else np.array([1.0, 0.0])
