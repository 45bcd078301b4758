"""The states of a wall along its load path to collapse, collected while a model runs."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .contacts.search import ContactForces
from .joints import JointPoints
from .pictures.frame import Frame
from .scene import Array

if TYPE_CHECKING:
    from .models import Recorder


@dataclass(frozen=True, eq=False)
class PathState:
    """A wall under one multiple of its live load.

    Joint points are those of the model's own mesh, ordered by joint and within a joint along its tangent, as in
    `Result.joints`. If blocks may crack, their pieces count as blocks here.

    Parameters
    ----------
    multiplier
        λ; for a support that settles, the share of the dead load that it still carries.
    motion : (nb, 3) float
        Displacement of each block's centroid [m] and rotation [rad] from the undeformed wall.
    force : (np, 2) float
        Normal and tangential force of each joint point [N], tension positive. At finite displacements along normal and
        tangent of the side on which a corner rests, which have turned with block a or with block b, or of rounded
        corners on each other; a corner that emerges at the end of a side has the force per unit of its opening.
    pull : (np, 2) float
        Force of block b on block a at each joint point, along x and y [N]. At finite displacements it acts where the
        two sides touch now, and not at the point.
    opening, slip : (np,) float
        Jumps of the joint points [m]; at finite displacements along the normal and the tangent that turn with block a.
    velocity : (nb, 3) float
        Velocity of the centroid [m/s] and of the rotation [rad/s]; zero at rest.
    damage : (np,) float
        From 0 (sound) to 1 (broken).
    points : JointPoints
        The joint points in the order of `force`, with position (np, 2) [m], joint and blocks.
    new_contacts : ContactForces
        Contacts that blocks have made since the wall was built, at finite displacements: block (n, 2), the place (n, 2)
        [m] where they touch now, and force (n, 2) of the second on the first block, along x and y [N].
    """

    multiplier: float
    motion: Array
    force: Array
    pull: Array
    opening: Array
    slip: Array
    velocity: Array
    damage: Array
    points: JointPoints
    new_contacts: ContactForces

    def __repr__(self) -> str:
        return f"<PathState: λ = {self.multiplier:.4g}, {len(self.motion)} blocks, {len(self.force)} joint points>"


def collected(recorder: "Recorder") -> list[PathState]:
    """The states that a recorder without a folder has collected, in order."""
    points = recorder.discretisation.points
    order = np.lexsort(((points.position * points.tangent).sum(axis=1), points.joint))
    ordered = points.part(order)
    return [
        PathState(
            frame.multiplier,
            frame.motion,
            np.column_stack([frame.normal, frame.tangential])[order] * ordered.area[:, None],
            _pull(frame, points)[order],
            frame.opening[order],
            frame.slip[order],
            frame.velocity,
            frame.damage[order],
            ordered,
            frame.new_contacts,
        )
        for frame in recorder.frames
    ]


def _pull(frame: Frame, points: JointPoints) -> Array:
    """Force of block b on block a at joint points, along x and y ``(np, 2)`` [N]."""
    undeformed = frame.normal[:, None] * points.normal + frame.tangential[:, None] * points.tangent
    return np.asarray(points.area[:, None] * (frame.traction if len(frame.traction) else undeformed))
