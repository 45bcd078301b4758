"""Mechanisms: how blocks move at collapse, brought to one size, and whether loads can drive such a motion at all."""

from dataclasses import dataclass

import numpy as np

from runningbond.joints import JointPoints, wall_caps, wall_points
from runningbond.scene import Array, Blocks, Indices, Scene

MAX_OVERLAP = 0.02
"""Overlap of blocks, in motions of the fastest corner, that the elastic joints of some models leave in a mechanism."""

WORK_TOLERANCE = 0.01
"""Negative work of all loads, relative to that of each of them, that energy stored in elastic joints may pay for."""


def fastest_corner_by_one(blocks: Blocks, motion: Array) -> Array:
    """Scale motions ``(nb, 3)`` so that the fastest corner of any block moves by one metre."""
    fastest = float(np.hypot(*carried(blocks, blocks.owner, blocks.vertices, motion).T).max())
    return motion / fastest if fastest > 0 else motion


def carried(blocks: Blocks, block: Indices, at: Array, motion: Array) -> Array:
    """Displacements ``(n, 2)`` [m] of points ``(n, 2)`` of blocks ``(n,)`` that move by ``(nb, 3)``, to first order."""
    arm = at - blocks.centroid[block]
    u, v, spin = motion[block].T
    return np.column_stack([u - spin * arm[:, 1], v + spin * arm[:, 0]])


def turned(blocks: Blocks, block: Indices, at: Array, motion: Array) -> Array:
    """Displacements ``(n, 2)`` [m] of points ``(n, 2)`` of blocks ``(n,)`` that move by ``(nb, 3)``, however far."""
    arm = at - blocks.centroid[block]
    u, v, spin = motion[block].T
    less, sine = np.cos(spin) - 1, np.sin(spin)
    return np.column_stack([u + less * arm[:, 0] - sine * arm[:, 1], v + sine * arm[:, 0] + less * arm[:, 1]])


def turned_frames(points: JointPoints, motion: Array) -> tuple[Array, Array]:
    """Normals and tangents ``(np, 2)`` of joint points, which turn with their block a in a motion ``(nb, 3)``."""
    spin = motion[points.block[:, 0], 2]
    return rotated(points.normal, spin), rotated(points.tangent, spin)


def rotated(vectors: Array, angle: Array) -> Array:
    """Vectors ``(n, 2)`` turned by angles ``(n,)`` [rad]."""
    (x, y), cosine, sine = vectors.T, np.cos(angle), np.sin(angle)
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y])


def rigid_jumps(blocks: Blocks, points: JointPoints, motion: Array) -> tuple[Array, Array]:
    """Opening and slip [m] of joint points between rigid blocks that move by ``(nb, 3)``, two ``(np,)``."""
    a, b = (carried(blocks, side, points.position, motion) for side in points.block.T)
    jump = b - a
    return (jump * points.normal).sum(axis=1), (jump * points.tangent).sum(axis=1)


@dataclass(frozen=True)
class MechanismCheck:
    """What shows whether a motion can be a collapse.

    Parameters
    ----------
    live
        Work of the live load [J] at λ = 1, the fastest corner moving by one metre; None where the load exerts no force.
    total
        Work of the dead load and λ times the live load [J].
    scale
        Sum of the absolute values of those two [J], by which `total` is judged; inf where a support drives the motion.
    overlap
        Largest overlap of two blocks at the ends of a joint that cannot crush, per motion of the fastest corner.
    """

    live: float | None
    total: float
    scale: float
    overlap: float

    @property
    def is_driven(self) -> bool:
        """Whether the loads drive the motion: both the live load and all loads together do work on it."""
        against_live = self.live is not None and self.live <= 0
        return not against_live and self.total >= -WORK_TOLERANCE * self.scale

    @property
    def warning(self) -> str:
        """What is wrong with the motion, in plain words; empty where nothing is."""
        if self.live is not None and self.live <= 0:
            return f"the live load does {'negative' if self.live < 0 else 'no'} work on this motion"
        if not self.is_driven:
            return "the loads do negative work on this motion"
        if self.overlap > MAX_OVERLAP:
            return f"blocks overlap by up to {self.overlap:.0%} of the largest displacement"
        return ""


def check_mechanism(scene: Scene, motion: Array, dead: Array, live: Array, multiplier: float) -> MechanismCheck:
    """Check the motion of a mechanism against the loads that are said to drive it.

    A velocity field of collapse satisfies ``f_live · u̇ > 0`` and ``(f_dead + λ f_live) · u̇ ≥ 0``, for the loads do the
    work that friction and crushing dissipate, and no joint that cannot crush closes beyond contact.

    Parameters
    ----------
    motion : (nb, 3) float
        Displacement of each block's centroid [m] and rotation [rad].
    dead, live : (3 nb,) float
        Forces and moments of the loads on the blocks [N, N, N m].
    multiplier
        λ under which the wall moves; 0 where it collapses under its dead load, whatever the live load does then.
    """
    motion = fastest_corner_by_one(scene.blocks, motion)
    by_dead, by_live = float(dead @ motion.ravel()), float(live @ motion.ravel())
    points = wall_points(scene)
    opening, _ = rigid_jumps(scene.blocks, points, motion)
    sound = np.isinf(wall_caps(scene, points.joint)[0])
    return MechanismCheck(
        by_live if multiplier and live.any() else None,
        by_dead + multiplier * by_live,
        abs(by_dead) + abs(multiplier * by_live) if scene.settlement is None else np.inf,
        float(max(0.0, -opening.min(initial=0.0, where=sound))),
    )
