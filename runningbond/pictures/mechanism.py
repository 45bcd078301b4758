"""The collapse mechanism of an outcome, checked before it is drawn."""

from dataclasses import replace

import numpy as np

from runningbond.joints import listed_points, wall_points
from runningbond.limit.kinematics import dead_load, live_load
from runningbond.results import MechanismCheck, Outcome, check_mechanism
from runningbond.results.mechanism import rigid_jumps
from runningbond.scene import Scene

from .deformed_shape import DeformedShape
from .frame import Frame
from .joint_state import states_of_mechanism


def mechanism_frame(scene: Scene, outcome: Outcome) -> Frame | None:
    """Frame of an outcome's mechanism, in which the fastest corner moves by one metre; None if there is none.

    Tractions are those at the load of the mechanism, or zero if the outcome lists no forces at the ends of joints.
    """
    if not has_mechanism(scene, outcome):
        return None
    points = wall_points(scene)
    opening, slip = rigid_jumps(scene.blocks, points, outcome.motion, outcome.moved)
    listed, traction = listed_points(scene, len(outcome.force)), np.zeros((len(points), 2))
    if listed is not None and len(points):
        of_joint = (outcome.force / listed.area[:, None]).reshape(len(scene.joints), -1, 2)
        traction = of_joint[:, [0, -1]].reshape(-1, 2)
    crushed = outcome.crushed.ravel() if len(outcome.crushed) else None
    state = states_of_mechanism(scene, points, opening, slip, crushed)
    multiplier = outcome.multiplier if outcome.multiplier is not None else outcome.upper or 0.0
    return Frame(multiplier, outcome.motion, opening, slip, traction[:, 0], traction[:, 1], state)


def has_mechanism(scene: Scene, outcome: Outcome) -> bool:
    """Whether an outcome contains a motion of every block."""
    return len(outcome.motion) == len(scene.blocks)


def outcome_check(scene: Scene, outcome: Outcome) -> MechanismCheck | None:
    """Check the mechanism of an outcome under the load that brought the wall down; None if there is none.

    Under a ground motion, the mechanism is a shape during the fall, which the loads at one moment need not drive.
    """
    if not has_mechanism(scene, outcome):
        return None
    if scene.history:
        none = np.zeros(outcome.motion.size)
        return check_mechanism(scene, outcome.motion, none, none, 0.0)
    bounds = (outcome.upper, outcome.multiplier, outcome.lower)
    multiplier = next((bound for bound in bounds if bound is not None), 0.0)
    dead, live = dead_load(scene), live_load(scene)
    return check_mechanism(scene, outcome.motion, dead, live, multiplier, outcome.moved)


def mechanism_warning(scene: Scene, outcome: Outcome) -> str:
    """Warning that a picture of an outcome's mechanism must contain; empty if nothing is wrong."""
    check = outcome_check(scene, outcome)
    if check is None or not check.warning:
        return ""
    return check.warning if check.is_driven else f"mechanism not drawn: {check.warning}"


def mechanism_shape(scene: Scene, outcome: Outcome) -> DeformedShape | None:
    """Shape of an outcome's mechanism for a drawing; None if there is none or the loads do not drive it."""
    frame, check = mechanism_frame(scene, outcome), outcome_check(scene, outcome)
    if frame is None or check is None or not check.is_driven:
        return None
    if outcome.status == "infeasible" and scene.settlement is None:
        scene = replace(scene, load=replace(scene.load, live=()))  # it falls without the live load
    state = frame.state.reshape(-1, 2)
    if outcome.moved is None:
        return DeformedShape.of_rigid_blocks(scene, frame.motion, state, frame.multiplier)
    return DeformedShape.of_rigid_blocks(scene, outcome.moved * frame.motion, state, frame.multiplier, finite=True)
