"""The states that a wall passes through on its way to collapse, collected while a model runs."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from .joints import JointPoints
from .scene import Array

if TYPE_CHECKING:
    from .models import Recorder


@dataclass(frozen=True, eq=False)
class PathState:
    """A wall under one multiple of its live load.

    Joint points stand joint by joint, those of a joint in the sense of its tangent, as in `Result.joints`. They are
    those of the model's own mesh; where blocks may crack, their pieces are blocks here.

    Parameters
    ----------
    multiplier
        λ; where a support settles, the share of the dead load that it bears.
    motion : (nb, 3) float
        Displacement of each block's centroid [m] and rotation [rad] since the wall was built.
    force : (np, 2) float
        Normal and tangential force of each joint point [N], tension positive: of the side that bears, where blocks have
        turned against each other.
    opening, slip : (np,) float
        Jumps of the joint points [m]; at finite displacements along the normal and the tangent that turn with block a.
    velocity : (nb, 3) float
        Of the centroid [m/s] and of rotation [rad/s]; zero at rest.
    damage : (np,) float
        0 sound … 1 broken.
    points : JointPoints
        Where the joint points are, in the order of `force`: their position (np, 2) [m], their joint and blocks.
    """

    multiplier: float
    motion: Array
    force: Array
    opening: Array
    slip: Array
    velocity: Array
    damage: Array
    points: JointPoints

    def __repr__(self) -> str:
        return f"<PathState: λ = {self.multiplier:.4g}, {len(self.motion)} blocks, {len(self.force)} joint points>"


def collected(recorder: "Recorder") -> list[PathState]:
    """The states that a recorder without a folder has seen, in the order in which they came."""
    points = recorder.discretisation.points
    order = np.lexsort(((points.position * points.tangent).sum(axis=1), points.joint))
    ordered = points.part(order)
    return [
        PathState(
            frame.multiplier,
            frame.motion,
            np.column_stack([frame.normal, frame.tangential])[order] * ordered.area[:, None],
            frame.opening[order],
            frame.slip[order],
            frame.velocity,
            frame.damage[order],
            ordered,
        )
        for frame in recorder.frames
    ]
