"""What a wall gives before it falls: on the springs of its joints, and as it hangs on its ties.

Joints of a wall that is tied open long before its ties yield. Each load that is added then moves it as far as the ties
stretch, at the end of the levers of its mechanism: a soft bar lets a slender wall sway by many times what is a fall of
one that nothing holds.
"""

from dataclasses import replace

from runningbond.scene import Array, Scene
from runningbond.scene.ties import NO_TIES

from .associated import proved_outcome
from .elastic import elastic_displacement
from .kinematics import tie_operator

UNSTRETCHED = 1e-9
"""Elongation of a tie, beside the motion of the fastest corner, that counts as none."""


def given_displacement(scene: Scene, multiplier: float) -> float:
    """Largest displacement of a block [m] under a multiple of the live load before it falls, as far as it is known."""
    return (elastic_displacement(scene, multiplier) or 0.0) + hanging_displacement(scene)


def hanging_displacement(scene: Scene) -> float:
    """Displacement of the fastest corner [m] in the associated mechanism until its ties yield; 0 without such ties.

    Or in that of the wall without ties, if that is more: they may hold it until the wall gives way elsewhere. Ties that
    yield one after the other count by the work they take. Ctrl-C is raised.
    """
    if not len(scene.ties):
        return 0.0
    return max(_until_ties_yield(scene, proved_outcome(each).motion) for each in (scene, replace(scene, ties=NO_TIES)))


def _until_ties_yield(scene: Scene, motion: Array) -> float:
    if not len(motion):
        return 0.0
    ties, longer = scene.ties, tie_operator(scene) @ motion.ravel()
    taut = longer > UNSTRETCHED
    slack = (ties.yield_force - ties.preload) / ties.stiffness
    work = float(ties.yield_force[taut] @ longer[taut])
    return float(ties.yield_force[taut] @ slack[taut]) / work if work else 0.0
