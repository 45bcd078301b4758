"""Points of bodies that rotate: their positions, and the generalised forces that forces at them exert on the bodies.

A point is at c + u + r: centroid and translation of its body, and an arm r = R(θ) (a + Σ φ_k q_k) that rotates with the
body and deforms by small amounts in the body's frame. A force f there contributes f to the translations, r × f to the
rotation and φ_k · Rᵀ f to the deformations.
"""

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import ANCHOR, Array, Indices, Unsigned

Deformation: TypeAlias = Callable[[int, Array], tuple[Indices, Array]]
"""Modes ``(m,)`` that deform a block, and the displacement of a point in its frame per unit of each, ``(m, 2)``."""


class BodyPoints(NamedTuple):
    """Points of bodies."""

    rigid: Unsigned  # (n, 3) indices in the motion of the translations and the rotation of their bodies
    centroid: Array  # (n, 2) centroids of the undeformed bodies [m]
    arm: Array  # (n, 2) from the centroids to the undeformed points [m]
    start: Unsigned  # (n + 1,) first deformation mode of each point, then the total number
    mode: Unsigned  # (m,) indices in the motion of the deformation modes
    shape: Array  # (m, 2) displacement of the point per unit of each mode, in the frame of its body
    body: Indices  # (n,) the bodies; `ANCHOR` for points fixed in space

    @property
    def arrays(self) -> "Points":
        """The arrays that the kernels take."""
        return self[:6]

    @property
    def point(self) -> Indices:
        """Point of each deformation mode, ``(m,)``."""
        count = np.diff(self.start).astype(np.int64)
        return np.repeat(np.arange(len(self.arm)), count)

    def places(self, motion: Array) -> Array:
        """Positions of the points after a motion ``(nd,)``, ``(n, 2)`` [m]."""
        arm = self.arm.copy()
        np.add.at(arm, self.point, self.shape * motion[self.mode, None])
        (px, py), (x, y, spin) = arm.T, motion[self.rigid].T
        c, s = np.cos(spin), np.sin(spin)
        return np.asarray(self.centroid + np.column_stack([x + c * px - s * py, y + s * px + c * py]))


def rigid_body(block: int, at: Array) -> tuple[Indices, Array]:
    """No deformation modes: the `Deformation` of a rigid body."""
    return np.zeros(0, dtype=np.int64), np.zeros((0, 2))


def body_points(
    block: Indices, at: Array, centroid: Array, rigid: Indices, still: int, deformation: Deformation = rigid_body
) -> BodyPoints:
    """Points of undeformed bodies.

    Parameters
    ----------
    block, at : (n,) int, (n, 2) float
        Body of each point, `ANCHOR` for one that is fixed in space, and its position [m].
    centroid, rigid : (nb, 2) float, (nb, 3) int
        Centroids of the bodies [m], and indices in the motion of their translations and rotations.
    still
        Index of a coordinate that never moves.
    deformation
        How bodies deform at a point.
    """
    on_body = (block != ANCHOR)[:, None]
    rest = np.where(on_body, centroid[block], at)
    nothing, places = rigid_body(ANCHOR, at), zip(block.tolist(), at, strict=True)
    own = [nothing if b == ANCHOR else deformation(b, place) for b, place in places]
    return BodyPoints(
        np.where(on_body, rigid[block], still).astype(np.uint64),
        rest,
        at - rest,
        np.cumsum([0, *(len(modes) for modes, _ in own)]).astype(np.uint64),
        np.concatenate([nothing[0], *(modes for modes, _ in own)]).astype(np.uint64),
        np.concatenate([nothing[1], *(shape for _, shape in own)]),
        block,
    )


NO_POINTS = body_points(np.zeros(0, np.int64), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros((0, 3), np.int64), 0)

Points: TypeAlias = tuple[Unsigned, Array, Array, Unsigned, Unsigned, Array]
"""`BodyPoints.arrays`."""


@kernel
def arm_of(points: Points, k: int, motion: Array) -> tuple[float, float, float, float]:
    """Arm of a point in space after a motion ``(nd,)`` [m], and cosine and sine of its body's rotation."""
    rigid, _, arm, start, mode, shape = points
    x, y, spin = arm[k, 0], arm[k, 1], motion[rigid[k, 2]]
    for i in range(start[k], start[k + 1]):
        x += shape[i, 0] * motion[mode[i]]
        y += shape[i, 1] * motion[mode[i]]
    c, s = math.cos(spin), math.sin(spin)
    return c * x - s * y, s * x + c * y, c, s


@kernel
def push_at(
    points: Points, k: int, turned: tuple[float, float, float, float], push: tuple[float, float], force: Array
) -> None:
    """Add a force [N] at a point to the modal forces ``(nd,)``; `turned` is what `arm_of` returns for the point."""
    rigid, _, _, start, mode, shape = points
    (x, y, c, s), (fx, fy) = turned, push
    force[rigid[k, 0]] += fx
    force[rigid[k, 1]] += fy
    force[rigid[k, 2]] += x * fy - y * fx
    for i in range(start[k], start[k + 1]):
        force[mode[i]] += shape[i, 0] * (c * fx + s * fy) + shape[i, 1] * (c * fy - s * fx)
