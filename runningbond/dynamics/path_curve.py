"""What the curve of prescribed displacements says: where a wall fails, whether it still hardens or sheds load."""

import numpy as np

from runningbond.results.outcome import number
from runningbond.scene import Array, Scene

BEAM_ANSWER = "largest reaction of the drive along its path"
BEAM_DIFFERS = "give another reaction"
SUPPORT_ANSWER = "share of the dead load on the support"
SUPPORT_DIFFERS = "leave another share"
LOAD_DIFFERS = "have another collapse load"
LOCK_DIFFERS = "bring it down"

LITTLE = 0.01
"""Fraction of the dead load below which a reaction need not be accurate relative to itself."""

LOSS = 0.8
"""Fraction of the largest force: once the force has fallen to it the wall has failed, and its mechanism is drawn."""

FINAL_PART = 0.1
"""Last part of a path, over which a share no longer changes, and a force no longer grows, if a mechanism has formed."""

FINAL_ROWS = 40
"""Number of places in this part at which a force is read to find its slope."""

SCATTERS = 3.0
"""Ratio of a slope to its standard error below which it is none."""

UNCHANGED = 1e-6
"""Change of the share on a support that counts as none, in addition to the tolerance times its total change."""

WAVERS = 1e-4
"""Fraction of the total change of a share by which it may waver from one large step to the next."""

PATH_ROUNDING = 1e-9
"""Difference of two displacements, relative to the largest one, that is only rounding."""

OVERSHOOT = 0.05
"""Displacement to the other side, relative to the largest one, up to which a path only returns to its start."""


SLIDES = "joints slide: another path, or forces at other points along the joints, may"
"""Beginning of a note on an answer that friction leaves to the path: its bracket only says how closely that was
followed."""


def friction_note(scene: Scene, friction: float, works: Array, least: float, tolerance: float, *, differs: str) -> str:
    """Note on an answer that depends on how joints slid; empty where balance alone gives the joint forces.

    Parameters
    ----------
    scene
        The wall.
    friction
        Work of friction along the path [J].
    works : (n,) float
        Work of what drives the wall up to each row of the path [J].
    least
        Work [J] below which that of the drive need not be accurate relative to itself.
    tolerance
        Part of the work of the drive up to which the work of friction makes no difference.
    differs
        What another path may do, e.g. ``"leave another share"``.
    """
    matters = friction > tolerance * max(float(np.ptp(works)), least) and not scene.is_determinate
    return f"{SLIDES} {differs}" if matters else ""


def goes_both_ways(goals: Array) -> bool:
    """Whether a path from zero through goals ``(n,)``, one after the other, goes to both sides.

    A path that returns to its start, possibly a little beyond it, does not.
    """
    most = float(np.abs(goals).max(initial=0.0))
    return bool(goals.max(initial=0.0) > OVERSHOOT * most and goals.min(initial=0.0) < -OVERSHOOT * most)


def other_way(goals: Array, curve: Array) -> str:
    """Note on the largest force to the other side, of the curve ``(n, 2)`` of a path to both sides; else empty."""
    other = -float(curve[:, 1].min())
    return f"the other way it takes {number(other)}" if goes_both_ways(goals) and other > 0 else ""


def last_leg(curve: Array) -> Array:
    """The rows of a path's curve ``(n, 2)`` since it last reversed, with displacements from there."""
    senses = np.sign(np.diff(curve[:, 0]))
    start = int(np.flatnonzero(senses != senses[-1])[-1]) + 1 if (senses != senses[-1:]).any() else 0
    return np.column_stack([np.abs(curve[start:, 0] - curve[start, 0]), curve[start:, 1]])


def growth_left(curve: Array) -> float:
    """Force [N] by which the largest force of a drive's curve ``(n, 2)`` may grow if the wall is moved twice as far.

    It grows from its last value at no more than its slope over `FINAL_PART`, because joints that have slid or opened
    stay soft; a slope within its scatter is none. Only displacements beyond all earlier ones count.
    """
    value, force = curve.T
    farthest = np.maximum.accumulate(value)
    onward = np.append(True, value[1:] > farthest[:-1] + PATH_ROUNDING * farthest[-1])
    places, force = value[onward], force[onward]
    share = np.linspace(0.0, 1.0, FINAL_ROWS)
    last = np.interp((1 - FINAL_PART * (1 - share)) * places[-1], places, force)
    slope, start = np.polyfit(share, last, 1)
    scatter = np.std(last - start - slope * share) * np.sqrt(12 / FINAL_ROWS)
    before, end = last[FINAL_ROWS // 2 :].reshape(2, -1).mean(axis=1)
    if end < before or slope <= SCATTERS * scatter:
        return 0.0
    return max(0.0, float(start + slope + slope / FINAL_PART - force.max()))


def late_growth(curve: Array) -> float:
    """Growth of the largest force [N] of a curve ``(n, 2)`` over the last part of its path."""
    value, force = curve.T
    late = value >= (1 - FINAL_PART) * value.max()
    return max(0.0, float(force[late].max() - force[~late].max(initial=0.0)))


def _late_shares(curve: Array) -> tuple[Array, Array]:
    """Shares of the last leg of a curve ``(n, 2)``, and those over its last part, from its beginning on."""
    value, share = last_leg(curve).T
    start = (1 - FINAL_PART) * value.max()
    return share, np.append(np.interp(start, value, share), share[value >= start])


def formed(curve: Array, tolerance: float, *, still: float = 0.0, is_small: bool = True) -> bool:
    """Whether a mechanism has formed under a settling support: its share no longer changes at the end of a path.

    Parameters
    ----------
    curve : (n, 2) float
        Displacement, and share of the dead load.
    tolerance
        Fraction of its total change by which a share may still change: at small displacements on a path twice as long,
        along its slope, at finite ones over the last tenth, because the shape goes on changing. An elastic wall sheds
        load too: almost none on a short path, and evenly along it.
    still
        Change of a share that motion may have caused, which counts as none: it may be all the change there was.
    """
    share, late = _late_shares(curve)
    least = max(still, UNCHANGED)
    part = FINAL_PART * tolerance if is_small else min(tolerance, FINAL_PART / 2)
    return bool(np.ptp(late) <= part * np.ptp(share) + least)


def shedding(curve: Array) -> tuple[bool, str]:
    """Whether the share on a support falls at the end of a path, and the name of the change: the share may be negative.

    If the share only wavers over the last part, the whole leg counts.
    """
    share, late = _late_shares(curve)
    changes = abs(late[-1] - late[0]) > UNCHANGED + WAVERS * np.ptp(share)
    first, last = late[0] if changes else share[0], share[-1]
    return bool(last <= first), "sheds load" if abs(last) <= abs(first) else "takes up load"


def failing(curve: Array) -> int:
    """Row of a drive's curve ``(n, 2)`` in which a wall fails.

    The first row beyond earlier displacements at which the force is at most `LOSS` of its peak; else the farthest row.
    """
    moved, force = curve.T
    same = PATH_ROUNDING * np.abs(moved).max()  # a repeated amplitude is not farther than before, except by rounding
    onward = np.append(True, moved[1:] > np.maximum.accumulate(moved)[:-1] + same)
    top = int(force.argmax())
    fallen = top + np.flatnonzero(onward[top:] & (force[top:] <= LOSS * force[top]))
    return int(fallen[0]) if len(fallen) else int(np.argmax(moved >= moved.max() - same))
