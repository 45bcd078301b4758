"""Points of bodies that turn: where they are, and what forces at them do on the bodies' coordinates.

A point is at c + u + r: centroid and translation of its body, and an arm r = R(θ) (a + Σ φ_k q_k) that turns with the
body and has small deformations in its frame. A force f there does f on the translations, r × f on the rotation and
φ_k · Rᵀ f on the deformations.
"""

import math
from collections.abc import Callable
from typing import NamedTuple, TypeAlias

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.scene import ANCHOR, Array, Indices, Unsigned

Deformation: TypeAlias = Callable[[int, Array], tuple[Indices, Array]]
"""Coordinates ``(m,)`` of the deformations of a block, and a point's displacement in its frame for each ``(m, 2)``."""


class BodyPoints(NamedTuple):
    """Points of bodies."""

    rigid: Unsigned  # (n, 3) where in the motion the translations and the rotation of their bodies stand
    centroid: Array  # (n, 2) of the bodies at rest [m]
    arm: Array  # (n, 2) from there to the points at rest [m]
    start: Unsigned  # (n + 1,) first deformation of each, then their number
    mode: Unsigned  # (m,) where in the motion the deformations stand
    shape: Array  # (m, 2) displacement of the point for each, in the frame of its body
    body: Indices  # (n,) the bodies, `ANCHOR` of what is fixed in space

    @property
    def arrays(self) -> "Points":
        """What kernels take."""
        return self[:6]

    @property
    def point(self) -> Indices:
        """Point of each deformation, ``(m,)``."""
        count = np.diff(self.start).astype(np.int64)
        return np.repeat(np.arange(len(self.arm)), count)

    def places(self, motion: Array) -> Array:
        """Where the points are after a motion ``(nd,)``, ``(n, 2)`` [m]."""
        arm = self.arm.copy()
        np.add.at(arm, self.point, self.shape * motion[self.mode, None])
        (px, py), (x, y, spin) = arm.T, motion[self.rigid].T
        c, s = np.cos(spin), np.sin(spin)
        return np.asarray(self.centroid + np.column_stack([x + c * px - s * py, y + s * px + c * py]))


def rigid_body(block: int, at: Array) -> tuple[Indices, Array]:
    """The deformations of a body that has none."""
    return np.zeros(0, dtype=np.int64), np.zeros((0, 2))


def body_points(
    block: Indices, at: Array, centroid: Array, rigid: Indices, still: int, deformation: Deformation = rigid_body
) -> BodyPoints:
    """Points of bodies at rest.

    Parameters
    ----------
    block, at : (n,) int, (n, 2) float
        Body of each, `ANCHOR` of one that is fixed in space, and its place [m].
    centroid, rigid : (nb, 2) float, (nb, 3) int
        Centroids of the bodies [m], and where in the motion their translations and rotations stand.
    still
        A coordinate that never moves.
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
    """Add to forces ``(nd,)`` what a push [N] at a point does, of which `arm_of` says how it is turned."""
    rigid, _, _, start, mode, shape = points
    (x, y, c, s), (fx, fy) = turned, push
    force[rigid[k, 0]] += fx
    force[rigid[k, 1]] += fy
    force[rigid[k, 2]] += x * fy - y * fx
    for i in range(start[k], start[k + 1]):
        force[mode[i]] += shape[i, 0] * (c * fx + s * fy) + shape[i, 1] * (c * fy - s * fx)
