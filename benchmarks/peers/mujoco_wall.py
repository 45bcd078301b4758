"""MuJoCo: rigid boxes with softened contacts.

Blocks are boxes that translate and rotate in the plane of the wall. Elliptic cones, and friction ten times as stiff as
pressure (``impratio``), are recommended in MuJoCo's documentation against slip. Contacts are stiffer and faster than by
default: with the defaults a small wall creeps for ten seconds under less than a hundredth of its weight. A half or a
quarter of the time step, and MuJoCo's additional pass against slip, do not change the bracket of the wall of
240 × 120 mm; ``impratio`` does: 0.44 with its default of 1, 0.48 with 50.
"""

import copy
from typing import Any

import numpy as np
from load_steps import Bracket, by_load_steps
from peer import Peer

from runningbond.scene import Array, Scene

STEP = 2e-3
"""Time step [s], MuJoCo's default."""

FRICTION_STIFFNESS = 10.0
"""``impratio``."""

TIME_CONSTANT = 0.01
"""Time constant of contacts [s] with the default step, critically damped; half the default, well above two steps."""

IMPEDANCE = (0.99, 0.999, 1e-5, 0.5, 2.0)
"""``solimp``."""

MARGIN = 1e-5
"""Distance at which contacts begin [m]."""

PEER = Peer(
    name="MuJoCo",
    package="mujoco",
    kind="rigid blocks in motion",
    rivals=("dem-dynamic", "dem-static"),
    does="three dimensions, falls to the end, robots and motors; every step is a convex program",
    does_not="joints at rest: friction creeps under any load; joint stiffness in N/m³, cohesion; a curve past the peak",
)


def bracket(scene: Scene, tolerance: float, budget: float) -> Bracket:
    """Bracket the collapse load by load steps."""
    return by_load_steps(MujocoWall.of(scene), scene, tolerance, budget)


class MujocoWall:
    """A wall in MuJoCo.

    Parameters
    ----------
    model, data
        MuJoCo's model of the wall, and its state.
    gravity
        Acceleration of gravity [m/s²].
    """

    def __init__(self, model: Any, data: Any, gravity: float) -> None:
        self._model, self._data, self._gravity = model, data, gravity

    @classmethod
    def of(cls, scene: Scene, step: float = STEP) -> "MujocoWall":
        """The wall of a scene, undeformed."""
        import mujoco

        spec = mujoco.MjSpec()
        spec.option.timestep = step
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.option.impratio = FRICTION_STIFFNESS
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        slide, hinge = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE
        for block, (x, z) in enumerate(scene.blocks.centroid):
            low, high = scene.blocks.extent(block)
            width, height = high - low
            body = spec.worldbody.add_body(pos=[x, 0, z])
            if not scene.fixed[block]:
                for kind, axis in ((slide, [1, 0, 0]), (slide, [0, 0, 1]), (hinge, [0, 1, 0])):
                    body.add_joint(type=kind, axis=axis)
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX,
                size=[width / 2, scene.thickness / 2, height / 2],
                density=scene.block.density,
                friction=[scene.joint.friction, 0, 0],
                margin=MARGIN,
                solref=[TIME_CONSTANT * step / STEP, 1.0],
                solimp=IMPEDANCE,
            )
        model = spec.compile()
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        return cls(model, data, float(np.hypot(*scene.load.gravity)))

    def hold(self, multiplier: float, seconds: float) -> None:
        """Integrate the motion under a load over some seconds."""
        import mujoco

        self._model.opt.gravity[:] = multiplier * self._gravity, 0.0, -self._gravity
        mujoco.mj_step(self._model, self._data, nstep=round(seconds / self._model.opt.timestep))

    def position(self) -> Array:
        """Centroid of each block, ``(n, 2)`` [m]."""
        return np.array(self._data.xpos[1:, [0, 2]])

    def rotation(self) -> Array:
        """Rotation of each block that moves, ``(n,)`` [rad]."""
        return -np.array(self._data.qpos[2::3])

    def copy(self) -> "MujocoWall":
        """Another wall in the same state."""
        return MujocoWall(self._model, copy.copy(self._data), self._gravity)
