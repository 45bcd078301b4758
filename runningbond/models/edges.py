"""Note for walls whose joints bear at their ends but would, along their whole length, roll onto their edges first."""

import numpy as np

from runningbond.joints import wall_points, wall_stiffness
from runningbond.joints.wall_points import spreads
from runningbond.limit.kinematics import live_load
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.results.reactions import WORKS
from runningbond.scene import Array, Scene


def rolls(scene: Scene, outcome: Outcome, tolerance: float) -> str:
    """Note for a push whose largest λ would be smaller by more than `tolerance` if pressures were spread along joints.

    A joint with points at its ends turns about an end at once. A bed of springs bears on a strip that narrows as it
    turns, and by then the wall leans: at λ = b / h, at which a block with points at its ends begins to turn, it is not
    reached. With nine points along joints a pushed pier has this load.
    """
    if outcome.status != "collapse" or scene.is_led or scene.history or spreads(scene, finite=True):
        return ""
    largest, bed = outcome.multiplier or 0.0, load_of_beds(scene, outcome)
    if bed is None or bed >= (1 - tolerance) * largest:
        return ""
    told = "joints carry forces only at their ends; pressed along them they roll onto their edges as the wall leans"
    remedy = "a joint.compressive_strength, even one that is never reached, spreads pressures along joints"
    return f"{told}, and it bears about {number(max(bed, 0.0))}; {remedy}"


def load_of_beds(scene: Scene, outcome: Outcome) -> float | None:
    """Largest λ on the path of a push if its joints are beds of springs, from the work of its mechanism.

    A joint that turns by θ under a force N bears on a triangle of pressure, with N a distance e from its edge, where
    9 k t θ e² = 2 N; as long as it is closed, e = l / 2 − k t θ l³ / (12 N). λ is smaller by the work of N on e over
    that of the live load. Other joints than those of the mechanism are taken as rigid. None without a mechanism or
    forces, and if this λ still grows at the end of the path.
    """
    points, joints = wall_points(scene), scene.joints
    has_path = len(outcome.curve) > 0 and WORKS[1] in outcome.path_columns  # models of users may have none
    if len(outcome.force) != len(points) or not len(outcome.motion) or not has_path:
        return None
    motion = outcome.motion.ravel()
    pushed = float(live_load(scene) @ motion)
    if pushed <= 0:
        return None
    first, last = points.position.reshape(-1, 2, 2).swapaxes(0, 1)
    length = np.hypot(*(last - first).T)
    pressed = -outcome.force[:, 0].reshape(-1, 2).min(axis=1)  # an end that is torn open presses the other one
    spin = np.abs(np.diff(outcome.motion[joints.block, 2], axis=1)[:, 0])
    turns = (spin > 0) & (pressed > 0) & ~joints.at_corner
    spring = wall_stiffness(scene, np.arange(len(joints)))[0] * scene.thickness_of_joints
    length, pressed, spin, spring = length[turns], pressed[turns], spin[turns], spring[turns]
    load, far = _far(outcome)
    theta = far[:, None] / pushed * spin
    part: Array = np.sqrt(2 * pressed / (spring * theta)) / 3
    arm = np.where(3 * part <= length, part, length / 2 - spring * theta * length**3 / (12 * pressed))
    bed = load - arm @ (pressed * spin) / pushed
    return float(bed.max()) if len(bed) and bed.argmax() < len(bed) - 1 else None


def _far(outcome: Outcome) -> tuple[Array, Array]:
    """λ along a path, and the work so far of the live load at λ = 1 on the way [J], where that is not 0.

    Unlike the displacement of a point, which ties may hold, this grows with every mechanism.
    """
    columns = outcome.curve_columns()
    load, work = columns["multiplier"], columns[WORKS[1]]
    mean = (load[1:] + load[:-1]) / 2
    far = np.cumsum(np.divide(np.diff(work), mean, out=np.zeros(len(mean)), where=mean > 0))
    return load[1:][far > 0], far[far > 0]
