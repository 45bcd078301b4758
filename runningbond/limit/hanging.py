"""Displacement of a wall before it collapses: from the elasticity of its joints, and from the stretch of its ties.

Joints of a tied wall open long before the ties yield. Each load increment then moves the wall by the stretch of the
ties, magnified by the lever arms of its mechanism: with a flexible bar a slender wall may sway by many times the
displacement at which a wall without ties falls.
"""

from dataclasses import replace

from runningbond.scene import Array, Scene
from runningbond.scene.ties import NO_TIES

from .associated import proved_outcome
from .elastic import elastic_displacement
from .kinematics import tie_operator

UNSTRETCHED = 1e-9
"""Elongation of a tie, relative to the motion of the fastest corner, that counts as zero."""


def given_displacement(scene: Scene, multiplier: float) -> float:
    """Largest displacement of a block [m] under a multiple of the live load before collapse, as far as it is known."""
    return (elastic_displacement(scene, multiplier) or 0.0) + hanging_displacement(scene)


def hanging_displacement(scene: Scene) -> float:
    """Displacement of the fastest corner [m] in the associated mechanism until its ties yield; 0 without such ties.

    The mechanism of the wall without ties counts instead if its displacement is larger, because ties may hold the wall
    until it fails elsewhere. The displacements at which ties yield are averaged, weighted by their work. Ctrl-C raises.
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
