"""Box2D: rigid polygons in the plane by sequential impulses; the engine of many games.

Box2D lets shapes overlap by 5 mm and gives them a skin of 10 mm, both compiled in, and recommends bodies of 0.1 to
10 m. Lengths and gravity are scaled by the same factor: times are unchanged, and the skin is a smaller part of a block.
The friction of a pair is the geometric mean of the frictions of the shapes.
"""

from typing import Any

import numpy as np

from runningbond.scene import Array, Scene

STEP = 5e-4
"""Time step [s]."""

ITERATIONS = 100
"""Velocity iterations per step; there are 30 position iterations."""

SIZE = 5.0
"""Scale of lengths: units of Box2D per metre."""


class Box2DWall:
    """A wall in a world of Box2D, without sleeping bodies.

    Parameters
    ----------
    world, bodies
        World of Box2D and its bodies.
    gravity
        Acceleration of gravity [m/s²].
    step
        Time step [s].
    """

    def __init__(self, world: Any, bodies: list[Any], gravity: float, step: float) -> None:
        self._world, self._bodies, self._gravity, self._step = world, bodies, gravity, step

    @classmethod
    def of(cls, scene: Scene, step: float = STEP) -> "Box2DWall":
        """The wall of a scene, undeformed."""
        import Box2D

        world, bodies = Box2D.b2World(), []
        for block, centroid in enumerate(scene.blocks.centroid):
            corners = (SIZE * (scene.blocks.polygon(block) - centroid)).tolist()
            make = world.CreateStaticBody if scene.fixed[block] else world.CreateDynamicBody
            body = make(position=tuple((SIZE * centroid).tolist()), allowSleep=False)
            body.CreatePolygonFixture(vertices=[tuple(c) for c in corners], density=1.0, friction=scene.joint.friction)
            bodies.append(body)
        return cls(world, bodies, float(np.hypot(*scene.load.gravity)), step)

    def hold(self, multiplier: float, seconds: float) -> None:
        """Integrate the motion under a load over some seconds."""
        self._world.gravity = (SIZE * multiplier * self._gravity, -SIZE * self._gravity)
        for _ in range(round(seconds / self._step)):
            self._world.Step(self._step, ITERATIONS, 30)

    def rotation(self) -> Array:
        """Rotation of each block, ``(n,)`` [rad]."""
        return np.array([body.angle for body in self._bodies])
