"""Blocks and walls on moving ground."""

import numpy as np

from dem.finite_system import finite_system
from runningbond.joints.wall_law import with_impacts
from runningbond.response import Resting
from runningbond.scene import BlockMaterial, History, JointMaterial, Load, Scene, Stiffness, build_scene
from runningbond.scene.history import pulse
from tests.limit.test_limit import rectangle


def shaken(kind: str, amplitude: float, period: float) -> History:
    """A pulse of ground acceleration [m/s²]."""
    return History(*pulse(kind, amplitude, period), interval=period / 200)


def block(b: float, h: float, history: History, friction: float = 2.0, stiffness: float = 1e10) -> Scene:
    """A block of half width b and half height h [m] on the ground."""
    return build_scene(
        "block",
        [rectangle(0, 0, 2 * b, 2 * h)],
        thickness=0.12,
        block=BlockMaterial(1800.0),
        joint=JointMaterial(friction, elasticity=Stiffness(stiffness, stiffness)),
        load=Load(live=(history,)),
    )


def resting(scene: Scene) -> Resting:
    return Resting.of(scene, "dem-dynamic", finite_system(with_impacts(scene)))


def still() -> History:
    """Ground with negligible motion."""
    return History(np.array([0.0, 0.01]), np.array([[0.0, 0.0], [1e-9, 0.0]]))
