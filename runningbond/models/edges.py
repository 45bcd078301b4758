"""Walls whose joints bear at their ends but would, along their whole length, roll onto their edges first."""

import numpy as np

from runningbond.joints import JointPoints, wall_points, wall_stiffness
from runningbond.joints.wall_points import listed_points, spreads
from runningbond.limit.kinematics import apart_across, live_load
from runningbond.results import Outcome
from runningbond.results.mechanism import fastest_corner
from runningbond.results.outcome import number
from runningbond.results.reactions import WORKS
from runningbond.scene import ANCHOR, Array, Scene

from .beds import Leaning, on_beds

LITTLE_WAY = 1e-7
"""Shortest way of a mechanism at which its load is computed, relative to that on which it loses all of its load."""

WAYS = 500
"""Number of ways between these two."""


def rolls(scene: Scene, outcome: Outcome, tolerance: float) -> str:
    """Note for a push whose largest λ would be smaller by more than `tolerance` if pressures were spread along joints.

    A joint with points at its ends turns about an end at once. A bed of springs bears on a strip that narrows as it
    turns, and by then the wall leans: at λ = b / h, at which a block with points at its ends begins to turn, it is not
    reached. With nine points along joints a pushed pier has this load.
    """
    if outcome.status != "collapse" or scene.is_led or scene.history or spreads(scene, finite=True):
        return ""
    largest, bed = outcome.multiplier or 0.0, load_of_beds(scene, outcome)
    if bed is None and (further := leaning(scene, outcome)) is not None:  # the path ends before this load
        bed = further.load
    least, less = (1 - tolerance) * largest, "joints elsewhere bend"
    if (bed is None or bed >= least) and (leans := on_beds(scene, least)) is not None:
        bed, less = leans.load, "joints slide"
    if bed is None or bed >= least:
        return ""
    told = "joints carry forces only at their ends; pressed along them they roll onto their edges as the wall leans"
    remedy = "a joint.compressive_strength, even one that is never reached, spreads pressures along joints"
    borne = f"it bears about {number(bed)}, or less if {less}" if bed > 0 else "it falls under its dead load"
    return f"{told}, and {borne}; {remedy}"


def load_of_beds(scene: Scene, outcome: Outcome) -> float | None:
    """Largest λ on the path of a push if its joints are beds of springs, from the work of its mechanism.

    A joint that turns by θ under a force N bears on a triangle of pressure, with N a distance e from its edge, where
    9 k t θ e² = 2 N; as long as it is closed, e = l / 2 − k t θ l³ / (12 N). λ is smaller by the work of N on e over
    that of the live load. Other joints than those of the mechanism are taken as rigid. None without a mechanism or
    forces, and if this λ still grows at the end of the path.
    """
    has_path = len(outcome.curve) > 0 and WORKS[1] in outcome.path_columns  # models of users may have none
    points = wall_points(scene)
    if len(outcome.force) != len(points) or not len(outcome.motion) or not has_path:
        return None
    load, far = _far(outcome)
    bed = _of_beds(scene, outcome, points, load, far)
    return None if bed is None or not len(bed) or bed.argmax() == len(bed) - 1 else float(bed.max())


def leaning(scene: Scene, outcome: Outcome) -> Leaning | None:
    """Largest λ of a collapse at small displacements if the wall leans meanwhile and its joints are beds of springs.

    As `load_of_beds`, but λ of the moved mechanism is from the forces F on its blocks, at r from their centroids: on a
    way of 1, on which blocks turn by ω and ties of length L and pull T across their line by v, λ falls by
    -Σ ω² F · r - Σ T v² / L over the work of the live load at λ = 1. None without a mechanism, forces or stiffnesses,
    for walls with held motions, and if λ does not fall.
    """
    points = listed_points(scene, len(outcome.force))
    held = len(scene.pins) or len(scene.late_pins) or scene.is_led or len(outcome.pull) != len(scene.ties)
    rigid = any(each.elasticity is None for each in scene.materials_of_joints)
    load = outcome.multiplier or 0.0
    if points is None or not len(points) or not len(outcome.motion) or held or rigid or load <= 0:
        return None
    pushed = float(live_load(scene) @ outcome.motion.ravel())
    lost = -float(outcome.motion[:, 2] ** 2 @ _virials(scene, outcome, points)) - _lengthening(scene, outcome)
    if pushed <= 0 or lost <= 0:
        return None
    way = np.geomspace(LITTLE_WAY, 1.0, WAYS) * load * pushed / lost
    bed = _of_beds(scene, outcome, points, load - way * lost / pushed, way * pushed)
    if bed is None:
        return None
    top = int(bed.argmax())
    moved = float(way[top]) * fastest_corner(scene.blocks, outcome.motion)
    return Leaning(max(float(bed[top]), 0.0), moved, rigid=True)


def _of_beds(scene: Scene, outcome: Outcome, points: JointPoints, load: Array, far: Array) -> Array | None:
    """λ on beds of springs where it is `load` on edges, after the live load has done the work `far` [J] at λ = 1."""
    motion, joints = outcome.motion.ravel(), scene.joints
    pushed = float(live_load(scene) @ motion)
    if pushed <= 0:
        return None
    first, *_, last = points.position.reshape(len(joints), -1, 2).swapaxes(0, 1)
    length = np.hypot(*(last - first).T)
    pressing = np.maximum(-outcome.force[:, 0], 0.0).reshape(len(joints), -1)
    pressed, borne = pressing.max(axis=1), np.zeros(len(joints))  # an end that is torn open presses the other one
    if spreads(scene):  # N of a joint that crushes is not at its edge in any case
        along = np.hypot(*(points.position.reshape(len(joints), -1, 2) - first[:, None]).T).T
        pressed = pressing.sum(axis=1)
        middle = (pressing * along).sum(axis=1) / np.where(pressed > 0, pressed, 1.0)
        borne = np.minimum(middle, length - middle)
    spin = np.abs(np.diff(outcome.motion[joints.block, 2], axis=1)[:, 0])
    turns = (spin > 0) & (pressed > 0) & ~joints.at_corner
    spring = wall_stiffness(scene, np.arange(len(joints)))[0] * scene.thickness_of_joints
    length, pressed, spin, spring, borne = (each[turns] for each in (length, pressed, spin, spring, borne))
    theta = far[:, None] / pushed * spin
    part: Array = np.sqrt(2 * pressed / (spring * theta)) / 3
    arm = np.where(3 * part <= length, part, length / 2 - spring * theta * length**3 / (12 * pressed))
    return np.asarray(load - np.maximum(arm - borne, 0.0) @ (pressed * spin) / pushed)


def _virials(scene: Scene, outcome: Outcome, points: JointPoints) -> Array:
    """Sum of F · r over the forces F on each block at r from its centroid, at the collapse load, ``(nb,)`` [J]."""
    a, b = points.block.T
    pull = outcome.force[:, :1] * points.normal + outcome.force[:, 1:] * points.tangent  # on block a
    dead, live, ties = scene.dead_forces, scene.live_forces, scene.ties
    tie, end = np.nonzero(ties.block != ANCHOR)
    tied = np.where(end == 0, 1.0, -1.0)[:, None] * (outcome.pull.reshape(-1, 1) * ties.direction)[tie]
    block = np.concatenate([a, b, dead.block, live.block, ties.block[tie, end]])
    force = np.concatenate([pull, -pull, dead.force, (outcome.multiplier or 0.0) * live.force, tied])
    at = np.concatenate([points.position, points.position, dead.at, live.at, ties.ends[tie, end]])
    arm = at - scene.blocks.centroid[block]
    virial = np.zeros(len(scene.blocks))
    np.add.at(virial, block, (force * arm).sum(axis=1))
    return virial


def _lengthening(scene: Scene, outcome: Outcome) -> float:
    """Σ T v² / L of ties of pull T and length L, whose ends move apart by v across their line [J]."""
    apart = apart_across(scene) @ outcome.motion.ravel()
    return float(outcome.pull.ravel() @ (apart**2 / scene.ties.length))


def _far(outcome: Outcome) -> tuple[Array, Array]:
    """λ along a path, and the work so far of the live load at λ = 1 on the way [J], where that is not 0.

    Unlike the displacement of a point, which ties may hold, this grows with every mechanism.
    """
    columns = outcome.curve_columns()
    load, work = columns["multiplier"], columns[WORKS[1]]
    mean = (load[1:] + load[:-1]) / 2
    far = np.cumsum(np.divide(np.diff(work), mean, out=np.zeros(len(mean)), where=mean > 0))
    return load[1:][far > 0], far[far > 0]
