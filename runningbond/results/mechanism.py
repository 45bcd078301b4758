"""Mechanisms: block motions at collapse, their scaling to a common size, and a check that the loads can drive them."""

from dataclasses import dataclass

import numpy as np

from runningbond.joints import JointPoints, wall_caps, wall_points
from runningbond.scene import Array, Blocks, Indices, Scene

MAX_OVERLAP = 0.02
"""Overlap of blocks in a mechanism, relative to the motion of the fastest corner, that elastic joints may leave."""

WORK_TOLERANCE = 0.01
"""Negative work of all loads, relative to the sum of their absolute works, that elastic energy of joints may supply."""


def fastest_corner_by_one(blocks: Blocks, motion: Array) -> Array:
    """Scale motions ``(nb, 3)`` so that the fastest corner of any block moves by one metre."""
    fastest = fastest_corner(blocks, motion)
    return motion / fastest if fastest > 0 else motion


def fastest_corner(blocks: Blocks, motion: Array) -> float:
    """Largest linearised displacement [m] of any corner of any block for motions ``(nb, 3)``."""
    return float(np.hypot(*carried(blocks, blocks.owner, blocks.vertices, motion).T).max())


def carried(blocks: Blocks, block: Indices, at: Array, motion: Array) -> Array:
    """Linearised displacements ``(n, 2)`` [m] of points ``(n, 2)`` on blocks ``(n,)`` for motions ``(nb, 3)``."""
    arm = at - blocks.centroid[block]
    u, v, spin = motion[block].T
    return np.column_stack([u - spin * arm[:, 1], v + spin * arm[:, 0]])


def turned(blocks: Blocks, block: Indices, at: Array, motion: Array) -> Array:
    """Displacements ``(n, 2)`` [m] of points ``(n, 2)`` on blocks ``(n,)`` for finite motions ``(nb, 3)``."""
    arm = at - blocks.centroid[block]
    u, v, spin = motion[block].T
    less, sine = np.cos(spin) - 1, np.sin(spin)
    return np.column_stack([u + less * arm[:, 0] - sine * arm[:, 1], v + sine * arm[:, 0] + less * arm[:, 1]])


def turned_frames(points: JointPoints, motion: Array) -> tuple[Array, Array]:
    """Normals and tangents ``(np, 2)`` of joint points, rotated with their block a by a motion ``(nb, 3)``."""
    spin = motion[points.block[:, 0], 2]
    return rotated(points.normal, spin), rotated(points.tangent, spin)


def rotated(vectors: Array, angle: Array) -> Array:
    """Vectors ``(n, 2)`` rotated by angles ``(n,)`` [rad]."""
    (x, y), cosine, sine = vectors.T, np.cos(angle), np.sin(angle)
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y])


def rigid_jumps(blocks: Blocks, points: JointPoints, motion: Array, moved: float | None = None) -> tuple[Array, Array]:
    """Opening and slip, two ``(np,)`` [m], of joint points between rigid blocks with motions ``(nb, 3)``.

    If the blocks have `moved` far, these are 1 / `moved` of the jumps in the deformed shape (`Outcome.moved`).
    """
    if moved is None:
        a, b = (carried(blocks, side, points.position, motion) for side in points.block.T)
        normal, tangent = points.normal, points.tangent
    else:
        a, b = (turned(blocks, side, points.position, moved * motion) / moved for side in points.block.T)
        normal, tangent = turned_frames(points, moved * motion)
    jump = b - a
    return (jump * normal).sum(axis=1), (jump * tangent).sum(axis=1)


@dataclass(frozen=True)
class MechanismCheck:
    """Quantities that decide whether a motion can be a collapse mechanism.

    Parameters
    ----------
    live
        Work of the live load [J] at λ = 1 if the fastest corner moves by one metre; None if λ = 0 or it has no force.
    total
        Work of the dead load and λ times the live load [J].
    scale
        Sum of the absolute works of both loads [J], the reference for `total`; inf if a moving support drives the wall.
    overlap
        Largest overlap at the ends of joints that cannot crush, relative to the motion of the fastest corner.
    """

    live: float | None
    total: float
    scale: float
    overlap: float

    @property
    def is_driven(self) -> bool:
        """Whether the live load, if any, does positive work, and all loads no negative work beyond the tolerance."""
        against_live = self.live is not None and self.live <= 0
        return not against_live and self.total >= -WORK_TOLERANCE * self.scale

    @property
    def warning(self) -> str:
        """Description of what is wrong with the motion; empty if nothing is."""
        if self.live is not None and self.live <= 0:
            return f"the live load does {'negative' if self.live < 0 else 'no'} work on this motion"
        if not self.is_driven:
            return "the loads do negative work on this motion"
        if self.overlap > MAX_OVERLAP:
            return f"blocks overlap by up to {self.overlap:.0%} of the largest displacement"
        return ""


def check_mechanism(
    scene: Scene, motion: Array, dead: Array, live: Array, multiplier: float, moved: float | None = None
) -> MechanismCheck:
    """Check a mechanism against the loads that should drive it.

    Velocities at collapse satisfy ``f_live · u̇ > 0`` and ``(f_dead + λ f_live) · u̇ ≥ 0``, because the loads do the
    work that friction and crushing dissipate. Joints that cannot crush do not close beyond contact.

    Parameters
    ----------
    motion : (nb, 3) float
        Displacement of each block's centroid [m] and rotation [rad].
    dead, live : (3 nb,) float
        Forces and moments of the loads on the blocks [N, N, N m].
    multiplier
        λ at which the wall moves; 0 if it collapses under its dead load: the live load's work is then not checked.
    moved
        As in `Outcome`.
    """
    motion = fastest_corner_by_one(scene.blocks, motion)
    by_dead, by_live = float(dead @ motion.ravel()), float(live @ motion.ravel())
    points = wall_points(scene)
    opening, _ = rigid_jumps(scene.blocks, points, motion, moved)
    sound = np.isinf(wall_caps(scene, points.joint)[0])
    return MechanismCheck(
        by_live if multiplier and live.any() else None,
        by_dead + multiplier * by_live,
        abs(by_dead) + abs(multiplier * by_live) if scene.settlement is None else np.inf,
        float(max(0.0, -opening.min(initial=0.0, where=sound))),
    )
