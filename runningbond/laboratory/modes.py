"""Failure mode of a wall, read where the force has fallen to 0.8 of the largest, else at the end of the path.

If the toe is visibly broken, crushed or split by 0.1 mm, the mode is toe crushing (R/TC), as reports call it. Under a
beam that is kept at its height a wall cannot rock; its toes are then the ends of its strut, and do not count. The
beam's point at the actuator's height moves by U. If at least half of U comes from the beam's rotation ω over the height
H, |ω| H ≥ U / 2, the wall rocks (R/TC). A beam that is kept level does not rotate while the wall rocks below it: ω is
then the median rotation of the wall's blocks, each counted by its area, and H the height of the wall without the beam.
Else, if one bed joint slips by U / 2 or more on average over its length, the wall slides there (SL). Else the motion is
distributed over the steps of a diagonal (F).
"""

from collections.abc import Iterable

import numpy as np

from runningbond.dynamics.path_curve import failing
from runningbond.dynamics.traverse import TOE
from runningbond.joints import wall_points
from runningbond.results import Outcome
from runningbond.results.mechanism import carried, rigid_jumps
from runningbond.scene import Array, Scene

ROCKING, DIAGONAL, SLIDING = "R/TC", "F", "SL"
GROUPS = {"R": ROCKING, "TC": ROCKING, "F": DIAGONAL, "S": DIAGONAL, "DT": DIAGONAL, "SL": SLIDING}
"""Modes by the letters of the tables; toe crushing belongs to rocking."""

NAMED = {"ROCKING": ROCKING, "TOE CRUSHING": ROCKING, "SLIDING": SLIDING}
NAMED |= {
    f"{kind}DIAGONAL{crack}": DIAGONAL for kind in ("", "STEPPED ") for crack in ("", " CRACK", " CRACKS", " CRACKING")
}
"""Modes by their names, where a table does not have the letters."""

HALF = 0.5

VISIBLE = 1e-4
"""Least width of a crack that is visible and drawn after a test [m]."""


def measured_modes(words: Iterable[str]) -> tuple[str, ...]:
    """Failure modes named in a report; other words are ignored."""
    known = GROUPS | NAMED
    return tuple(dict.fromkeys(known[word] for word in words if word in known))


def predicted_mode(scene: Scene, outcome: Outcome) -> str | None:
    """Failure mode of an outcome; None if nothing moves."""
    motion = outcome.motion
    if scene.beam is None or scene.beam.block is None or not len(motion) or not motion.any():
        return None
    beam, drive = scene.beam.block, scene.beam.drive
    x, y = scene.blocks.centroid[beam]
    base = float(scene.blocks.extent(scene.wall)[0][1])
    height = float(y) - base if drive is None or drive.at is None else drive.at
    moved = abs(float(carried(scene.blocks, np.array([beam]), np.array([[x, base + height]]), motion)[0, 0]))
    if moved == 0:
        return None
    if TOE in outcome.path_columns and scene.beam.condition != "fixed-height":
        broken = outcome.path[failing(outcome.curve), outcome.path_columns.index(TOE)]
        if broken >= VISIBLE:
            return ROCKING
    turned = _turned_masonry(scene, motion) if scene.beam.condition == "level" else float(motion[beam, 2]) * height
    if abs(turned) >= HALF * moved:
        return ROCKING
    return SLIDING if max(bed_slips(scene, motion, outcome.moved)) >= HALF * moved else DIAGONAL


def _turned_masonry(scene: Scene, motion: Array) -> float:
    """Median rotation of the wall's blocks, each counted by its area, times the wall's height without the beam [m]."""
    masonry = scene.masonry
    (_, bottom), (_, top) = scene.blocks.extent(masonry)
    area = scene.blocks.area[masonry]
    return float(np.quantile(motion[masonry, 2], HALF, weights=area, method="inverted_cdf") * (top - bottom))


def bed_slips(scene: Scene, motion: Array, moved: float | None = None) -> list[float]:
    """Mean slip of each bed joint over the wall's whole length [m], for a motion ``(nb, 3)`` as in `Outcome`."""
    points, bed = wall_points(scene), scene.joints.is_bed & ~scene.joints.at_corner
    _, slip = rigid_jumps(scene.blocks, points, motion, moved)
    level = np.round(points.position[:, 1] / scene.blocks.tolerance).astype(int)
    slips = []
    for each in np.unique(level[bed[points.joint]]):
        own = (level == each) & bed[points.joint]
        slips.append(abs(float(np.average(slip[own], weights=points.area[own]))))
    return slips
