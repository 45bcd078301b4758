"""Runs of alike joints: a numbering of blocks and joints that lets kernels step through memory consecutively.

A wall of equal blocks has few kinds of joints: joints of one kind have the same material, area and position
relative to their two blocks. Blocks are numbered column by column, from the bottom up, and the joints of one kind by
their blocks: if joint j separates blocks p and q, joint j + 1 usually separates p + 1 and q + 1.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.joints import JointPoints, lobatto, wall_points, wall_rule
from runningbond.joints.along import Along, along
from runningbond.joints.wall_law import row_of_joint
from runningbond.scene import Array, Indices, Scene

from .rigid_kernels import RigidJoints

RESOLUTION = 1e-9
"""Difference, relative to the wall's size, below which two joints are of one kind: far below the contact tolerance.

Areas, which also depend on the thickness, are compared relative to the largest one.
"""


@dataclass(frozen=True, eq=False)
class JointOrder:
    """Blocks, joints and their contact points in the order that the kernels use."""

    block: Indices  # (nb,) position of each block in that order
    points: JointPoints  # the first points of all joints, then all second ones, and so on
    runs: RigidJoints
    between: Along | None  # interpolation of the points from a joint's two ends; None if the ends are the points


def joint_order(scene: Scene) -> JointOrder:
    """Number a scene's blocks and joints."""
    rule = wall_rule(scene)
    points = wall_points(scene, lobatto())
    half = np.hypot(*(points.position[1::2] - points.position[::2]).T) / 2
    place = np.argsort(scene.column_by_column)
    normal = points.normal[::2]
    shape = np.column_stack([normal, half, _arms(scene, normal)])
    size = float(np.ptp(scene.blocks.extent(scene.wall), axis=0).max())
    area = points.area[::2]
    units = RESOLUTION * np.array([1.0, 1.0, *[size] * 5, area.max(initial=0.0) or 1.0])
    shape = np.column_stack([shape, area])
    rounded = np.rint(shape / units).astype(np.int64)
    kind = np.unique(np.column_stack([row_of_joint(scene), rounded]), axis=0, return_inverse=True)[1].ravel()
    a, b = place[scene.joints.block].T
    order = np.lexsort((a, kind))
    a, b, kind = a[order], b[order], kind[order]
    goes_on = (np.diff(a) == 1) & (np.diff(b) == 1) & (np.diff(kind) == 0)
    begin = np.flatnonzero(np.append(len(order) > 0, ~goes_on))
    first, second = ((of[begin] - begin).astype(np.uint64) for of in (a, b))
    runs = RigidJoints(np.append(begin, len(order)).astype(np.uint64), first, second, shape[order][begin])
    ends, n = points.part(np.concatenate([2 * order, 2 * order + 1])), len(order)
    if len(rule.nodes) == 2:
        return JointOrder(place, ends, runs, None)
    between, _ = along(tuple(runs), np.arange(2 * n).reshape(2, n).T, ends.area, rule)
    rows = len(rule.nodes) * order + np.arange(len(rule.nodes))[:, None]
    return JointOrder(place, wall_points(scene, rule).part(rows.ravel()), runs, between)


def _arms(scene: Scene, normal: Array) -> Array:
    """Lever arms of each joint's normal and tangential force about its two blocks' centroids, ``(nj, 4)`` [m]."""
    middle = scene.joints.ends.mean(axis=1)
    arms = np.zeros((len(scene.joints), 4))
    for side, block in enumerate(scene.joints.block.T):
        x, y = (middle - scene.blocks.centroid[block]).T
        arms[:, side] = x * normal[:, 1] - y * normal[:, 0]
        arms[:, 2 + side] = x * normal[:, 0] + y * normal[:, 1]
    return arms
