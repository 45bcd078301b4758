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
    """The mechanism of an outcome, its fastest corner moving by one metre; None where it has none.

    Tractions are those under the load of the mechanism, or zero where the outcome lists none for the ends of joints.
    """
    if not has_mechanism(scene, outcome):
        return None
    points = wall_points(scene)
    opening, slip = rigid_jumps(scene.blocks, points, outcome.motion)
    listed, traction = listed_points(scene, len(outcome.force)), np.zeros((len(points), 2))
    if listed is not None and len(points):
        of_joint = (outcome.force / listed.area[:, None]).reshape(len(scene.joints), -1, 2)
        traction = of_joint[:, [0, -1]].reshape(-1, 2)
    crushed = outcome.crushed.ravel() if len(outcome.crushed) else None
    state = states_of_mechanism(scene, points, opening, slip, crushed)
    multiplier = outcome.multiplier if outcome.multiplier is not None else outcome.upper or 0.0
    return Frame(multiplier, outcome.motion, opening, slip, traction[:, 0], traction[:, 1], state)


def has_mechanism(scene: Scene, outcome: Outcome) -> bool:
    """Whether an outcome lists a motion of every block."""
    return len(outcome.motion) == len(scene.blocks)


def outcome_check(scene: Scene, outcome: Outcome) -> MechanismCheck | None:
    """Check the mechanism of an outcome under the load that brought the wall down; None where it has none.

    Of a wall whose ground moves it is a shape in the fall, which loads at one moment need not drive.
    """
    if not has_mechanism(scene, outcome):
        return None
    if scene.history:
        none = np.zeros(outcome.motion.size)
        return check_mechanism(scene, outcome.motion, none, none, 0.0)
    bounds = (outcome.upper, outcome.multiplier, outcome.lower)
    multiplier = next((bound for bound in bounds if bound is not None), 0.0)
    return check_mechanism(scene, outcome.motion, dead_load(scene), live_load(scene), multiplier)


def mechanism_warning(scene: Scene, outcome: Outcome) -> str:
    """What a picture of an outcome's mechanism has to say of it, in plain words; empty where nothing is wrong."""
    check = outcome_check(scene, outcome)
    if check is None or not check.warning:
        return ""
    return check.warning if check.is_driven else f"mechanism not drawn: {check.warning}"


def mechanism_shape(scene: Scene, outcome: Outcome) -> DeformedShape | None:
    """The mechanism of an outcome to be drawn; None where it has none, or one that its loads do not drive."""
    frame, check = mechanism_frame(scene, outcome), outcome_check(scene, outcome)
    if frame is None or check is None or not check.is_driven:
        return None
    if outcome.status == "infeasible" and scene.settlement is None:
        scene = replace(scene, load=replace(scene.load, live=()))  # falls without it
    return DeformedShape.of_rigid_blocks(scene, frame.motion, frame.state.reshape(-1, 2), frame.multiplier)
