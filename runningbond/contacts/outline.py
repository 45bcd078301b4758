"""Outlines of blocks whose corners are rounded by the inset of the joints."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from runningbond.scene import Array, Blocks, Indices, Joints, Mask, Scene, SceneError

from .reentrant import ConvexParts, RunOn
from .rigid_sides import Corners, Placed, place_outline

MARGIN = 0.02
"""Least distance up to which sides count as near, relative to the size of the smallest block (root of its area).

It affects run time, not accuracy: a larger one means more pairs to evaluate in every time step, but fewer searches.
"""

FLAT = 0.1
"""Angle [rad] by which the outline turns at a corner, below which the corner is not rounded, and rests with both sides.
"""


@dataclass(frozen=True, eq=False)
class Outline:
    """Blocks with rounded corners: each corner is an arc that touches its two sides an inset away from the corner.

    Sides have the numbers of the corners that they start from. After the real corners come the virtual ends of sides
    that are extended behind re-entrant corners (`reentrant`): corners from which no side starts.
    """

    blocks: Blocks  # the blocks, undeformed
    parts: ConvexParts  # their convex parts
    radius: Array  # (nc,) radius of each corner's arc [m]
    centre: Array  # (nc, 2) centre of the arc, from the centroid of its block [m]
    side: Indices  # (nc,) side that starts at the corner, or that is extended to it
    exterior: Array  # (nc,) angle by which the outline turns at the corner [rad], 0 at virtual corners
    normal: Array  # (nv, 2) outward normal of each side
    length: Array  # (nv,) length of each side [m],
    straight: Array  # (nv,) and length between its arcs, with its extensions [m]
    ends: Indices  # (nv, 2) corners at the start and the end of each side, virtual ones if it is extended
    run_on: Array  # (nv, 2) extensions there [m]
    thickness: Array  # (nb,) out-of-plane thickness of each block [m]
    held: Mask  # (nb,) fixed blocks: there are no contacts between two of them
    # (nj,) pair of sides of each joint of the undeformed wall, ascending (`side_pair`), and (nj,) the joint's number
    joined: tuple[Indices, Indices]
    joints: Joints  # joints of the undeformed wall; contacts of single corners are sides that met later

    @classmethod
    def of(cls, scene: Scene) -> "Outline":
        """Round the corners of a scene's blocks by the inset of its joints.

        Raises
        ------
        SceneError
            If the insets at the two ends of a side are together longer than the side.
        """
        blocks = scene.blocks
        start, after = blocks.vertices, blocks.successor
        side = start[after] - start
        length = np.hypot(*side.T)
        run = side / length[:, None]
        normal = np.column_stack([run[:, 1], -run[:, 0]])
        turn = run[blocks.predecessor]
        exterior = np.arctan2(turn[:, 0] * run[:, 1] - turn[:, 1] * run[:, 0], (turn * run).sum(axis=1))
        inset = np.where(exterior > FLAT, scene.joint.inset, 0.0)
        radius = inset / np.tan(np.maximum(exterior, FLAT) / 2)
        straight = length - inset - inset[after]
        if (straight < 0).any():
            raise SceneError("joint.inset", "must be less than half the shortest side of a block", scene.joint.inset)
        centre = start + inset[:, None] * run - radius[:, None] * normal
        own, behind = np.arange(len(after)), RunOn.of(blocks, run)
        of_corner, none = np.concatenate([own, behind.side]), np.zeros(len(behind.side))
        centre = np.concatenate([centre, behind.point]) - blocks.centroid[blocks.owner[of_corner]]
        corners = np.concatenate([radius, none]), centre, of_corner, np.concatenate([exterior, none])
        ends, runs_on = np.column_stack([own, after]), np.zeros((len(own), 2))
        ends[behind.side, behind.end], runs_on[behind.side, behind.end] = len(own) + np.arange(len(none)), behind.far
        sides = normal, length, straight + runs_on.sum(axis=1), ends, runs_on
        joints = scene.joints.between_sides
        joined = _joined_sides(blocks, normal, length, joints)
        parts = ConvexParts.of(blocks, normal)
        return cls(blocks, parts, *corners, *sides, scene.thickness_of_blocks, scene.fixed, joined, joints)

    @property
    def margin(self) -> float:
        """Distance up to which sides of blocks that barely move count as near [m]."""
        return float(MARGIN * np.sqrt(self.blocks.area.min()))

    @cached_property
    def reach(self) -> Array:
        """Distance of the farthest corner of each block from its centroid, ``(nb,)`` [m]."""
        blocks = self.blocks
        return np.maximum.reduceat(np.hypot(*(blocks.vertices - blocks.centroid[blocks.owner]).T), blocks.first[:-1])

    def thickness_between(self, e: Indices, f: Indices) -> Array:
        """Out-of-plane thickness [m] of contacts of two blocks' sides ``(n,)``: that of the thinner block, ``(n,)``."""
        owner = self.blocks.owner
        return np.asarray(np.minimum(self.thickness[owner[e]], self.thickness[owner[f]]))

    def joint_of(self, e: Indices, f: Indices) -> Indices:
        """Joint that pairs of sides formed on the undeformed wall, −1 for none, ``(n,)``."""
        key, joint = self.joined
        if not len(key):
            return np.full(len(e), -1)
        at = np.minimum(np.searchsorted(key, sought := side_pair(e, f)), len(key) - 1)
        return np.where(key[at] == sought, joint[at], -1)

    @cached_property
    def corner_arrays(self) -> Corners:
        """The arrays from which kernels compute the outline's position."""
        blocks = self.blocks
        freedom = (3 * blocks.owner[self.side]).astype(np.uint64)
        return Corners(blocks.centroid.copy(), freedom, self.centre.copy(), self.normal[self.side])

    def placed(self, motion: Array) -> Placed:
        """Positions of blocks and arcs after a motion ``(3 nb,)``."""
        placed = Placed(np.zeros((4, len(self.blocks))), np.zeros((len(self.radius), 4)))
        place_outline(motion, self.corner_arrays, placed)
        return placed

    def corners(self, motion: Array) -> Array:
        """Positions of the corners after a motion ``(3 nb,)``, ``(nv, 2)`` [m]."""
        return self.points(self.blocks.owner, self.blocks.vertices, motion)

    def along(self, side: Indices, at: Array, motion: Array) -> Array:
        """Distance ``(n,)`` [m] of points ``(n, 2)`` in space from the starts of sides ``(n,)``, along these."""
        corners = self.corners(motion)
        run = (corners[self.blocks.successor[side]] - corners[side]) / self.length[side, None]
        return np.asarray(((at - corners[side]) * run).sum(axis=1))

    def points(self, block: Indices, at: Array, motion: Array) -> Array:
        """Positions ``(n, 2)`` [m], after a motion ``(3 nb,)``, of points of blocks given on the undeformed wall."""
        cosine, sine, x, y = self.placed(motion).blocks[:, block]
        arm = at - self.blocks.centroid[block]
        return np.column_stack([x + cosine * arm[:, 0] - sine * arm[:, 1], y + sine * arm[:, 0] + cosine * arm[:, 1]])


def side_pair(e: Indices, f: Indices) -> Indices:
    """Number of each pair of sides ``(n,)``, the same for both orders of the two."""
    return np.minimum(e, f) * 2**32 + np.maximum(e, f)


def _joined_sides(blocks: Blocks, normal: Array, length: Array, joints: Joints) -> tuple[Indices, Indices]:
    """Pairs of sides that form joints, ascending, and the joints: the side of each block nearest the joint's middle."""
    start, along = blocks.vertices, np.column_stack([-normal[:, 1], normal[:, 0]])

    def side(block: int, middle: Array) -> int:
        own = slice(blocks.first[block], blocks.first[block + 1])
        way = np.clip(((middle - start[own]) * along[own]).sum(axis=1), 0.0, length[own])
        apart = start[own] + way[:, None] * along[own] - middle
        return int(own.start + np.hypot(*apart.T).argmin())

    sides = [[side(b, m) for b in pair] for pair, m in zip(joints.block, joints.ends.mean(axis=1), strict=True)]
    key = side_pair(*np.reshape(sides, (-1, 2)).T.astype(np.int64))
    order = np.argsort(key)
    return key[order], order
