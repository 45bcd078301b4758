"""Notes on what an outcome does not take into account, and on motions that are not small."""

import numpy as np

from runningbond.joints import crushes_by_law, loses_strength
from runningbond.limit import elastic_displacement
from runningbond.results import Outcome
from runningbond.results.outcome import joined, two_digits
from runningbond.scene import Scene, SceneError
from runningbond.scene.mass_loads import Body, Lateral, Tilt

from .model import Model

FAR_MOTION = 0.02
"""Limit of small motions, per smaller side of the wall: toppling resistance falls by this share."""

SAME_LOAD = 1e-6
"""Relative difference of λ below which loads of a path are one load: on a plateau they drift by rounding."""


def moves(model: Model, scene: Scene, outcome: Outcome, collapse: float | None) -> str:
    """Note for a wall that has moved beyond small displacements at the largest load at which it is at rest.

    Its joints may deform elastically by more than `collapse` [heights of a block], or they have opened, and the wall
    hangs on soft ties.
    """
    if model.kind != "history" or scene.is_led or scene.history or outcome.status != "collapse" or not outcome.upper:
        return ""
    from dem.static import FALLEN

    if "block.young" not in model.reads:
        scene = scene.with_rigid_blocks()
    gives = (elastic_displacement(scene, outcome.upper) or 0.0) / scene.lowest_block
    moved, load = outcome.curve.T
    largest = outcome.lower or 0.0
    reached = np.abs(load - largest) <= SAME_LOAD * abs(largest)  # on a plateau it is borne all along the way
    rests = np.abs(moved[reached]) / _smaller_side(scene)
    moved = rests[0] if len(rests) else 0.0
    height, side = (f"{two_digits(100 * share)} % of" for share in (gives, moved))
    soft = f"joints are too soft: the wall gives by {height} a block's height elastically, beyond small displacements"
    far = f"at the largest load at rest the wall has moved by {side} its smaller side, beyond small displacements"
    return joined(soft if gives > (FALLEN if collapse is None else collapse) else "", far if moved > FAR_MOTION else "")


def led_far(model: Model, scene: Scene, outcome: Outcome) -> str:
    """Note for a wall with prescribed displacements of its support or beam that are not small."""
    if model.kind != "history" or model.is_finite or not scene.is_led or not len(outcome.curve):
        return ""
    share = float(np.abs(outcome.curve[:, 0]).max() / _smaller_side(scene))
    led = f"{'the support' if scene.settlement else 'the beam'} goes by {two_digits(100 * share)} %"
    follows = "; finite ones follow it" if "displacements" in model.parameters and _may_go_far(scene) else ""
    return f"{led} of the wall's smaller side, beyond small displacements{follows}" if share > FAR_MOTION else ""


def _smaller_side(scene: Scene) -> float:
    """Length or height [m] of the wall without supports and beam."""
    low, high = scene.blocks.extent(scene.masonry)
    return float((high - low).min())


def _may_go_far(scene: Scene) -> bool:
    """Whether a wall with prescribed displacements can be analysed at finite displacements."""
    from runningbond.dynamics.displacements import check_finite

    try:
        check_finite(scene)
    except SceneError:
        return False
    return True


def tilted_with_the_ground(scene: Scene) -> str:
    """Note for dead loads other than weights, if the ground tilts."""
    tilts = any(isinstance(load, Tilt) for load in scene.load.live)
    if not tilts or not len(scene.dead_forces.force):
        return ""
    return "dead loads at points and along lines turn with the ground, as jacks do and weights do not"


def without_mass(scene: Scene) -> str:
    """Note for dead loads that weigh on a wall, as floors do, if only blocks are pushed by their mass."""
    live, gravity = scene.load.live, np.array(scene.load.gravity)
    inertia = scene.history is not None or (bool(live) and all(isinstance(load, Lateral | Body) for load in live))
    if not inertia or not any((load.forces(scene).force @ gravity > 0).any() for load in scene.load.dead):
        return ""
    pushed = "the ground's motion does not move" if scene.history else "λ does not push"
    return f"dead loads at points and along lines have no mass: {pushed} floors that weigh so much"


def keeps_strength(model: Model, scene: Scene) -> str:
    """Note for joints that lose strength, if the model does not include this; else empty."""
    joints = scene.materials_of_joints
    loses = {
        "joint.fracture_energy_1": any(map(loses_strength, joints)),
        "joint.compressive_fracture_energy": any(each.compressive_fracture_energy is not None for each in joints),
    }
    kept = any(lost and key not in model.reads for key, lost in loses.items())
    return "joints are taken to keep the strength that they lose as they break: the wall may bear less" if kept else ""


def does_not_crush(model: Model, scene: Scene) -> str:
    """Note for joints that crush by a law of their own, if the model evaluates no such law; else empty."""
    left = "joint.fracture_energy_1" not in model.reads and any(map(crushes_by_law, scene.materials_of_joints))
    return "joints are taken not to crush, as they do by their law: the wall may bear less" if left else ""


def left_out(model: Model, scene: Scene, finite: bool = False) -> str:
    """Note on the keys of a scene that a model does not take into account; empty if it reads all."""
    unread = model.unread(scene, finite=finite)
    return f"not taken into account: {', '.join(unread)}" if unread else ""
