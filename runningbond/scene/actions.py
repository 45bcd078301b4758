"""Base class of all loads: the forces that a load puts on a scene's blocks, and what is derived from them."""

from typing import TYPE_CHECKING, Any, get_type_hints

import numpy as np

from .arrays import Array, Indices
from .errors import SceneError
from .forces import Arrow, Forces
from .ranges import vector
from .table import Table

if TYPE_CHECKING:
    from .scene import Scene

LEAST_COMPONENT = 1e-6
"""Smallest nonzero component of a vector, relative to the other: a smaller one is lost in a solver's tolerance."""


ROUNDING = 1e-12
"""Component, relative to the other one, up to which it counts as 0: rounding error of a computed sine or cosine."""


class Action:
    """A load. Every kind must define `forces`; all other methods have defaults, which a kind may override."""

    def forces(self, scene: "Scene") -> Forces:
        """Forces on a scene's blocks; for a live load, those at λ = 1."""
        raise NotImplementedError(f"{type(self).__name__} says no forces")

    def forces_by_piece(self, scene: "Scene", edges: Array) -> Forces:
        """Forces on a scene's blocks when the blocks are divided into pieces; each force then acts on a single piece.

        The pieces are triangles of a mesh or of blocks that may crack, given by their edges ``(n, 2, 2)`` [m].
        """
        return self.forces(scene)

    def check(self, scene: "Scene", key: str) -> None:
        """Raise a `SceneError` under the load's key if the load cannot act on this scene."""

    def note(self, multiplier: float) -> str:
        """Text about a load multiplier that an outcome's message shows next to its value."""
        return ""

    def arrows(self, scene: "Scene") -> tuple[Arrow, ...]:
        """Arrows for drawings: one at each point with a force, and a row of arrows for a force on the blocks' mass."""
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
        """Blocks ``(n,)``, a point of each and a direction there, both ``(n, 2)``: their mean displacement is recorded.

        The control point, one for all blocks that share it, is where the first point force on a movable block acts.
        Without such a force it is, of the highest corners that can move, the one farthest along the load (the paper's
        upper corner on the pushed side).
        """
        arrows = self.arrows(scene)
        for arrow in arrows:
            movable = arrow.block[~scene.fixed[arrow.block]]
            if arrow.at is not None and len(movable):
                return same_for(movable, arrow.at, arrow.direction)
        direction = arrows[-1].direction if arrows else np.array([1.0, 0.0])
        blocks, gravity = scene.blocks, scene.load.gravity
        up = -unit_vector(np.array(gravity)) if any(gravity) else np.array([0.0, 1.0])
        corners = np.flatnonzero(~scene.fixed[blocks.owner])
        height = blocks.vertices[corners] @ up
        top = corners[height >= height.max() - blocks.tolerance]
        corner = top[[np.argmax(blocks.vertices[top] @ direction)]]
        return same_for(blocks.owner[corner], blocks.vertices[corner[0]], direction)

    @classmethod
    def read(cls, table: Table) -> "Action":
        """Read the load from a table of a scene file, whose keys are vectors named like the fields of the dataclass."""
        return cls(**{name: table.vector(name) for name in get_type_hints(cls)})


def same_for(block: Indices, at: Array, direction: Array) -> tuple[Indices, Array, Array]:
    """`Action.control` of blocks ``(n,)`` that have one point ``(2,)`` and one direction ``(2,)`` in common."""
    return block, np.tile(at, (len(block), 1)), np.tile(direction, (len(block), 1))


def nonzero_vector(key: str, value: Any) -> tuple[float, float]:
    """Return a vector with rounding errors set to 0; refuse a zero vector, or a nonzero but negligible component."""
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
    """A direction ``(2,)`` as a unit vector; a zero direction becomes the x axis."""
    length = np.hypot(*direction)
    return direction / length if length > 0 else np.array([1.0, 0.0])
