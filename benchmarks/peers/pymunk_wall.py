"""Pymunk: rigid polygons in the plane by sequential impulses (Chipmunk).

Pymunk's defaults are for games in pixels: 10 iterations, and an overlap of 0.1 (here that would be 0.1 m). Here the
overlap is 0.1 mm; shapes also have it as a radius, as the documentation recommends against seams, and therefore touch
from the start. Iterations and time step are chosen such that the wall of 120 × 60 mm reaches the loads at which its
collapse is certified: with 10 iterations and 1 ms it falls at 0.39, with 30 at 0.40, with 100 at 0.41, with 100 and
half the step at 0.42. On the other walls 30 iterations and 1 ms suffice, for a third of the time or less.
The friction of a pair is the product of the frictions of the shapes, hence the square root.
"""

from typing import Any

import numpy as np
from load_steps import Bracket, by_load_steps
from peer import Peer

from runningbond.scene import Array, Scene

STEP = 5e-4
"""Time step [s]."""

ITERATIONS = 100

OVERLAP = 1e-4
"""Admissible overlap of shapes [m]."""

PEER = Peer(
    name="pymunk",
    package="pymunk",
    kind="rigid blocks in motion",
    rivals=("dem-dynamic", "dem-static"),
    does="falls to the end, with impacts and new contacts; any polygons; pictures as it runs",
    does_not="joint stiffness, cohesion; forces that balance (iterations are cut off); a curve past the peak",
)


def bracket(scene: Scene, tolerance: float, budget: float) -> Bracket:
    """Bracket the collapse load by load steps."""
    return by_load_steps(PymunkWall.of(scene), scene, tolerance, budget)


class PymunkWall:
    """A wall in a space of Pymunk.

    Parameters
    ----------
    space
        Space of Pymunk.
    gravity
        Acceleration of gravity [m/s²].
    step
        Time step [s].
    """

    def __init__(self, space: Any, gravity: float, step: float) -> None:
        self._space, self._gravity, self._step = space, gravity, step

    @classmethod
    def of(cls, scene: Scene, step: float = STEP) -> "PymunkWall":
        """The wall of a scene, undeformed."""
        import pymunk

        space = pymunk.Space()
        space.iterations, space.collision_slop = ITERATIONS, OVERLAP
        inertia = scene.mass * scene.blocks.polar_moment / scene.blocks.area
        for block, centroid in enumerate(scene.blocks.centroid):
            if scene.fixed[block]:
                body = pymunk.Body(body_type=pymunk.Body.STATIC)
            else:
                body = pymunk.Body(float(scene.mass[block]), float(inertia[block]))
            body.position = tuple(centroid.tolist())
            corners = (scene.blocks.polygon(block) - centroid).tolist()
            shape = pymunk.Poly(body, [tuple(corner) for corner in corners], radius=OVERLAP / 2)
            shape.friction = scene.joint.friction**0.5
            space.add(body, shape)
        return cls(space, float(np.hypot(*scene.load.gravity)), step)

    def hold(self, multiplier: float, seconds: float) -> None:
        """Integrate the motion under a load over some seconds."""
        self._space.gravity = (multiplier * self._gravity, -self._gravity)
        for _ in range(round(seconds / self._step)):
            self._space.step(self._step)

    def position(self) -> Array:
        """Centroid of each block, ``(n, 2)`` [m]."""
        return np.array([body.position for body in self._space.bodies])

    def rotation(self) -> Array:
        """Rotation of each block, ``(n,)`` [rad]."""
        return np.array([body.angle for body in self._space.bodies])

    def copy(self) -> "PymunkWall":
        """Another wall in the same state, except for the impulses from which its iterations start."""
        return PymunkWall(self._space.copy(), self._gravity, self._step)
