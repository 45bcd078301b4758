"""Runs of alike joints: numbers for blocks and joints with which kernels walk through memory straight ahead.

A wall of equal blocks has few kinds of joints: what the joint of one pair of blocks is to them, the joint of the
next pair is to those. Blocks are numbered column by column, from the bottom up, and joints of one kind by their
blocks, so that where joint j separates blocks p and q, joint j + 1 as a rule separates p + 1 and q + 1.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.scene import Array, Indices, Scene

RESOLUTION = 1e-9
"""Difference, in sizes of the wall, below which two joints are of one kind: far below the contact tolerance."""


@dataclass(frozen=True, eq=False)
class JointOrder:
    """Blocks and joints in the order of the kernels."""

    block: Indices  # (nb,) place of each block
    joint: Indices  # (nj,) the joint that stands at each place
    start: Indices  # (nr + 1,) first place of each run of joints, then their number
    # (nr,) place of the blocks a and b of each run's first joint
    first: Indices
    second: Indices
    # (nr, 7) what is the same for all joints of a run: normal n_x, n_y, half length [m] between the two points, and
    # lever arms [m] of normal and tangential force at the joint's middle about the centroids: normal_a, normal_b,
    # tangent_a, tangent_b
    shape: Array


def joint_order(scene: Scene, half: Array) -> JointOrder:
    """Number a scene's blocks and joints.

    Parameters
    ----------
    half : (nj,) float
        Half the distance [m] between the two points of each joint.
    """
    place = np.argsort(scene.column_by_column)
    shape = np.column_stack([*_normals(scene).T, half, *_arms(scene).T])
    size = float(np.ptp(scene.blocks.extent(scene.wall), axis=0).max())
    rounded = np.rint(shape / [RESOLUTION, RESOLUTION, *[RESOLUTION * size] * 5]).astype(np.int64)
    kind = np.unique(np.column_stack([scene.material_of_joint, rounded]), axis=0, return_inverse=True)[1].ravel()
    a, b = place[scene.joints.block].T
    order = np.lexsort((a, kind))
    a, b, kind = a[order], b[order], kind[order]
    goes_on = (np.diff(a) == 1) & (np.diff(b) == 1) & (np.diff(kind) == 0)
    begin = np.flatnonzero(np.append(len(order) > 0, ~goes_on))
    start = np.append(begin, len(order))
    return JointOrder(place, order, start, a[begin], b[begin], shape[order][begin])


def _normals(scene: Scene) -> Array:
    run = scene.joints.ends[:, 1] - scene.joints.ends[:, 0]
    return np.column_stack([run[:, 1], -run[:, 0]]) / scene.joints.length[:, None]


def _arms(scene: Scene) -> Array:
    """Lever arms of each joint's normal and tangential force about its two blocks' centroids, ``(nj, 4)`` [m]."""
    normal = _normals(scene)
    middle = scene.joints.ends.mean(axis=1)
    arms = np.zeros((len(scene.joints), 4))
    for side, block in enumerate(scene.joints.block.T):
        x, y = (middle - scene.blocks.centroid[block]).T
        arms[:, side] = x * normal[:, 1] - y * normal[:, 0]
        arms[:, 2 + side] = x * normal[:, 0] + y * normal[:, 1]
    return arms
