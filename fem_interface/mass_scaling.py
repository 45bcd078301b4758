"""Mass scaling of deformable modes, and a bound of the scaled wall's highest frequency from each block by itself.

With K_b a block's own stiffness, K_j its share of the joints' stiffness and C the viscosity of its deformable modes,
central differences are stable at a step Δt(ω) if for every block

    K_b + (2/Δt) C + K_j ≤ ω² M*,    M* = M + β K_b / ω²,

with β a little above one: a mode stiff enough to limit the step is made just heavy enough not to. The smallest such ω
is computed; it is close to that of rigid blocks, however stiff the blocks are. In walls of few blocks the lowest
natural frequencies are not far below it and would drop noticeably; there masses are scaled for a larger ω.
"""

from dataclasses import dataclass

import numpy as np

from runningbond.dynamics import CALMER, block_frequency_squared, joint_shares, mass_factor, stable_step
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.dynamics.time_step import EXPONENTS
from runningbond.joints.wall_points import wall_stiffness
from runningbond.scene import Array

from .frequency_shift import frequency_shift
from .modal_wall import RESOLUTION, ModalWall

STEP_MARGIN = 1.1
"""Step that masses are scaled for, over the critical step 2/ω; above one because of the scaled modes' viscosity."""

FREQUENCY_TOLERANCE = 1e-3
"""Relative tolerance of ω² at which iterations end."""


@dataclass(frozen=True)
class Allowance:
    """How far masses may be scaled.

    At most the lowest two thirds of the frequencies that the wall has with rigid blocks are preserved, which matters in
    walls of fewer than ten blocks. In the highest ones single blocks vibrate against the others, and preserving these
    would allow almost no scaling.
    """

    lowest: int  # number of lowest frequencies that scaling preserves
    lost: float  # largest relative drop of these frequencies
    # masses are scaled for a deformation's own stiffness plus this factor times its share of the joints' stiffness
    of_joints: float
    viscous: float  # viscous damping ratio of the joints that the step is computed with


IN_TIME = Allowance(lowest=20, lost=2e-3, of_joints=0.0, viscous=VISCOUS)
"""Scaling for motions in which a wall's vibrations matter."""

AT_REST = Allowance(lowest=1, lost=1e-2, of_joints=4.0, viscous=CALMER)
"""Scaling if only the load that a wall carries at rest matters, and the time that it takes to come to rest."""

LARGE_WALL = 1000
"""Number of movable blocks, or of triangles that may separate, above which the drop of frequencies is not checked, to
save memory.

The twentieth frequency of so large a wall is far below the one that limits the step. In a single course, where waves
travel in one direction only, it may nevertheless drop by more than is allowed.
"""


@dataclass(frozen=True, eq=False)
class ScaledModes:
    """Modes with scaled masses.

    Parameters
    ----------
    frequency_squared : float
        Upper bound of the wall's largest ω² [1/s²].
    mass, viscosity : (nd,) float
        Modal masses after scaling, and viscosity of the deformable modes [N s/m].
    """

    frequency_squared: float
    mass: Array
    viscosity: Array


@dataclass(frozen=True, eq=False)
class _Kind:
    """Blocks of one template on different joints: their modes, and their shares of the joints, ``(n, m, m)``."""

    mass: Array
    stiffness: Array
    joints: Array
    # stiffness that masses are scaled for, ``(m,)``: the modes' own plus `of_joints` times their share of the joints'
    scaled_for: Array


def scaled_modes(
    wall: ModalWall, damping: float, *, mass_scaling: bool = True, allowance: Allowance = IN_TIME
) -> ScaledModes:
    """Scale the masses of a wall's modes so that the joints limit the time step.

    Parameters
    ----------
    wall
        The wall.
    damping
        Viscous damping ratio of the deformable modes.
    mass_scaling
        Whether masses are scaled at all.
    allowance
        How far masses may be scaled.
    """
    kinds = _tightest(wall, allowance.of_joints)
    stiffness = _scaling_stiffness(wall, kinds)
    if mass_scaling:
        square = _smallest_bound(kinds, damping, allowance.viscous)
        fit = _square_to_scale_for(wall, stiffness, square, allowance)
        if fit > square:
            square = _smallest_bound(kinds, damping, allowance.viscous, fit)
    else:
        fit, square = np.inf, _smallest_bound(kinds, damping, allowance.viscous, np.inf)
    mass = _scaled(wall.mass, stiffness, fit)
    return ScaledModes(square, mass, modal_viscosity(wall.stiffness, mass, damping))


def undeformed_frequency_squared(wall: ModalWall) -> float:
    """Upper bound of the wall's largest ω² [1/s²] if its blocks do not deform."""
    return _rigid_bound(_tightest(wall))


def _tightest(wall: ModalWall, of_joints: float = 0.0) -> list[_Kind]:
    """Blocks on those shares of their joints (`EXPONENTS`) that yield the lowest bound for rigid blocks."""
    return min((_kinds(wall, exponent, of_joints) for exponent in EXPONENTS), key=_rigid_bound)


def _scaling_stiffness(wall: ModalWall, kinds: list[_Kind]) -> Array:
    """Stiffness that masses are scaled for, ``(nd,)``: equal to `wall.stiffness` if `of_joints` is zero."""
    each, result = iter(kinds), []
    for template in wall.templates:
        stiffness, moving = template.modes.stiffness.copy(), np.isfinite(template.modes.mass)
        if moving.any():
            stiffness[moving] = next(each).scaled_for
        result.append(np.repeat(stiffness, len(template.blocks)))
    return np.concatenate([*result, [0.0]])


def _smallest_bound(kinds: list[_Kind], damping: float, viscous: float, fit: float | None = None) -> float:
    """Smallest ω² that bounds the wall, with masses scaled for `fit`, or for that ω² itself if `fit` is None."""

    def bound(square: float) -> float:
        return max((_bound(kind, square, damping, viscous, fit or square) for kind in kinds), default=0.0)

    low = high = _rigid_bound(kinds) or 1.0  # zero if pins leave no rigid motion: blocks can only deform, if at all
    while bound(high) > high:
        low, high = high, 2 * high
    while high > low * (1 + FREQUENCY_TOLERANCE):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if bound(middle) <= middle else (middle, high)
    return high


def _square_to_scale_for(wall: ModalWall, stiffness: Array, square: float, allowance: Allowance) -> float:
    """The ω², `square` or larger, for which masses may be scaled so that the lowest frequencies are preserved.

    It is the smallest such ω² unless the drop of frequencies falls faster than 1 / ω², as in walls of a few blocks.
    """
    rigid = int(((wall.stiffness == 0) & np.isfinite(wall.mass)).sum())
    lowest = min(allowance.lowest, 2 * rigid // 3)
    if not lowest or not wall.stiffness.any() or (~wall.scene.fixed).sum() > LARGE_WALL:
        return square
    shift = frequency_shift(wall, lowest, square)
    # Rounded, because a library's frequencies differ in their last bits between machines.
    while (lost := round(shift(_scaled(wall.mass, stiffness, square)) / allowance.lost, 6)) > 1:
        square *= lost * (1 + FREQUENCY_TOLERANCE)
    return square


def _scaled(mass: Array, stiffness: Array, square: float) -> Array:
    return np.asarray(mass * mass_factor(stiffness, mass, STEP_MARGIN * 2 / np.sqrt(square)))


def modal_viscosity(stiffness: Array, mass: Array, damping: float) -> Array:
    """Viscosity 2 ξ (k m)^{1/2} of modes; zero for a mode without stiffness, whatever its mass."""
    return np.where(stiffness > 0, 2 * damping * np.sqrt(stiffness * np.where(stiffness > 0, mass, 1.0)), 0.0)


def _rigid_bound(kinds: list[_Kind]) -> float:
    """Largest ω² [1/s²] of blocks that do not deform, each on its share of the joints."""
    result = 0.0
    for kind in kinds:
        rigid = np.flatnonzero(kind.stiffness == 0)
        if len(rigid):
            joints = kind.joints[:, rigid[:, None], rigid]
            result = max(result, float(block_frequency_squared(joints, kind.mass[None, rigid]).max()))
    return result


def _bound(kind: _Kind, square: float, damping: float, viscous: float, fit: float) -> float:
    mass = _scaled(kind.mass, kind.scaled_for, fit)
    viscosity = modal_viscosity(kind.stiffness, mass, damping)
    own = kind.stiffness + 2 / stable_step(square, viscous, LOCAL) * viscosity
    return float(block_frequency_squared(kind.joints + np.diag(own), mass[None]).max())


def _kinds(wall: ModalWall, exponent: float, of_joints: float) -> list[_Kind]:
    """Blocks that differ in mesh, pins or joints; joints are shared with an exponent (`joint_shares`)."""
    joint, tangent = wall.elements, wall.elements.tangent
    n, ne, _ = joint.weights.shape
    block = joint.points.block[:ne]
    inertia = wall.scene.inertial_mass
    part = joint_shares(np.where(wall.scene.fixed, np.inf, inertia)[block], exponent)
    normal, shear = wall_stiffness(wall.scene, joint.points.joint[:ne], closed=True)
    springs = joint.points.area.reshape(n, ne) * np.stack([normal, shear])[:, None]  # (2, n, ne)

    # Sides a of all elements, then sides b: their local nodes, and all that their stiffness depends on.
    block, part = block.T.ravel(), part.T.ravel()
    nodes = np.concatenate([joint.nodes[:, :2], joint.nodes[:, 2:]]) - wall.mesh.first_node[block][:, None]
    shares = joint.weights.transpose(1, 0, 2).reshape(ne, 2 * n)
    alike = np.hstack([joint.normal, *springs.transpose(0, 2, 1) / springs.max(initial=1e-300), shares])
    features = np.column_stack([nodes, part, np.tile(alike, (2, 1))])
    _, likeness = np.unique(np.rint(features / RESOLUTION), axis=0, return_inverse=True)

    order = np.lexsort([likeness, block])
    of_block = np.split(order, np.searchsorted(block[order], np.arange(1, len(wall.scene.blocks))))
    result = []
    for template in wall.templates:
        modes = template.modes
        moving = np.isfinite(modes.mass)
        if not moving.any():
            continue
        shape = modes.shape[:, moving].reshape(-1, 2, moving.sum())
        seen = {likeness[of_block[b]].tobytes(): of_block[b] for b in template.blocks}
        joints = np.zeros((len(seen), shape.shape[2], shape.shape[2]))
        for matrix, sides in zip(joints, seen.values(), strict=True):
            for side in sides:
                e = side % ne
                at_points = np.einsum("pe,exm->pxm", joint.weights[:, e], shape[nodes[side]])
                frame = np.array([joint.normal[e], tangent[e]])
                jumps = np.einsum("dx,pxm->dpm", frame, at_points)
                matrix += part[side] * np.einsum("dp,dpm,dpk->mk", springs[:, :, e], jumps, jumps)
        stiffness = modes.stiffness[moving]
        share = np.where(stiffness > 0, of_joints * np.diagonal(joints, axis1=1, axis2=2).max(axis=0), 0.0)
        result.append(_Kind(modes.mass[moving], stiffness, joints, stiffness + share))
    return result
