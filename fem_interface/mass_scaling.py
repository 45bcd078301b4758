"""Mass scaling of deformable modes, and the frequency that bounds the scaled wall, from each block alone.

With K_b a block's own stiffness, K_j its share of the joints' and C the viscosity of its deformable modes, central
differences are stable at a step Δt(ω) if for every block

    K_b + (2/Δt) C + K_j ≤ ω² M*,    M* = M + β K_b / ω²,

with β a little above one: a mode that is stiff enough to limit the step is made just so heavy that it does not. The
smallest such ω is sought; it comes close to that of rigid blocks, however stiff the blocks are. In walls of few blocks
the lowest vibrations are not far below it and would become slower: masses are scaled for a larger ω there.
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

ROOM = 1.1
"""Step that masses are scaled for, in critical ones: leaves room for the viscosity of the scaled modes."""

CLOSE = 1e-3
"""Relative accuracy of ω²."""


@dataclass(frozen=True)
class Allowance:
    """How far masses may be scaled.

    In walls of less than ten blocks it is at most the lowest two thirds of those frequencies that a wall has of rigid
    blocks: in the highest of them one block swings against the others, and to keep these is almost to scale nothing.
    """

    lowest: int  # number of the lowest frequencies that scaling leaves as they are
    lost: float  # part of them that it may take
    # times a deformation's share of its joints' stiffness that its mass is scaled for, besides its own
    of_joints: float
    viscous: float  # the joints' viscous damping ratio that goes with it


IN_TIME = Allowance(lowest=20, lost=2e-3, of_joints=0.0, viscous=VISCOUS)
"""Where it matters how a wall vibrates."""

AT_REST = Allowance(lowest=1, lost=1e-2, of_joints=4.0, viscous=CALMER)
"""Where only what it bears at rest does, and how long it takes to come to rest."""

LARGE = 1000
"""Number of blocks, or of triangles that may part, beyond which they are not looked at, to save the memory.

The twentieth frequency of so large a wall is far below what limits the step; in a single course, whose waves travel
one way only, it may lose more than is allowed all the same.
"""


@dataclass(frozen=True, eq=False)
class ScaledModes:
    """Modes made fit for a time step.

    Parameters
    ----------
    frequency_squared : float
        ω² that bounds the wall [1/s²].
    mass, viscosity : (nd,) float
        Modal masses after scaling, and viscosity of the deformable modes [N s/m].
    """

    frequency_squared: float
    mass: Array
    viscosity: Array


@dataclass(frozen=True, eq=False)
class _Kind:
    """Blocks of one template, each with other joints: their modes and their share of the joints, ``(n, m, m)``."""

    mass: Array
    stiffness: Array
    joints: Array
    # what masses are scaled for, ``(m,)``: the modes' own stiffness and some times their share of the joints
    scaled_for: Array


def scaled_modes(
    wall: ModalWall, damping: float, *, mass_scaling: bool = True, allowance: Allowance = IN_TIME
) -> ScaledModes:
    """Scale the masses of a wall's modes as far as the joints' step asks for.

    Parameters
    ----------
    wall
        The wall.
    damping
        Viscous damping ratio of the deformable modes.
    mass_scaling
        Whether masses are scaled at all.
    allowance
        How far they may be.
    """
    kinds = _tightest(wall, allowance.of_joints)
    stiffness = _of_coordinates(wall, kinds)
    if mass_scaling:
        square = _smallest(kinds, damping, allowance.viscous)
        fit = _square_to_scale_for(wall, stiffness, square, allowance)
        if fit > square:
            square = _smallest(kinds, damping, allowance.viscous, fit)
    else:
        fit, square = np.inf, _smallest(kinds, damping, allowance.viscous, np.inf)
    mass = _scaled(wall.mass, stiffness, fit)
    return ScaledModes(square, mass, modal_viscosity(wall.stiffness, mass, damping))


def undeformed_frequency_squared(wall: ModalWall) -> float:
    """ω² that bounds the wall if its blocks do not deform [1/s²]."""
    return _rigid_bound(_tightest(wall))


def _tightest(wall: ModalWall, of_joints: float = 0.0) -> list[_Kind]:
    """Blocks with the shares of their joints that bound rigid ones most closely."""
    return min((_kinds(wall, exponent, of_joints) for exponent in EXPONENTS), key=_rigid_bound)


def _of_coordinates(wall: ModalWall, kinds: list[_Kind]) -> Array:
    """What masses are scaled for, ``(nd,)``: `wall.stiffness` where the joints' share does not count."""
    each, result = iter(kinds), []
    for template in wall.templates:
        stiffness, moving = template.modes.stiffness.copy(), np.isfinite(template.modes.mass)
        if moving.any():
            stiffness[moving] = next(each).scaled_for
        result.append(np.repeat(stiffness, len(template.blocks)))
    return np.concatenate([*result, [0.0]])


def _smallest(kinds: list[_Kind], damping: float, viscous: float, fit: float | None = None) -> float:
    """Smallest ω² that bounds the wall, with masses scaled for `fit`, or for that ω² itself where there is none."""

    def bound(square: float) -> float:
        return max(_bound(kind, square, damping, viscous, fit or square) for kind in kinds)

    low = high = _rigid_bound(kinds) or 1.0  # a block whose pins leave no rigid motion has its deformations only
    while bound(high) > high:
        low, high = high, 2 * high
    while high > low * (1 + CLOSE):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if bound(middle) <= middle else (middle, high)
    return high


def _square_to_scale_for(wall: ModalWall, stiffness: Array, square: float, allowance: Allowance) -> float:
    """An ω² from `square` up for which masses may be scaled, so that the lowest frequencies stay as they are.

    It is the smallest, but where what is lost falls faster than 1 / ω², in walls of a few blocks.
    """
    rigid = int(((wall.stiffness == 0) & np.isfinite(wall.mass)).sum())
    lowest = min(allowance.lowest, 2 * rigid // 3)
    if not lowest or not wall.stiffness.any() or (~wall.scene.fixed).sum() > LARGE:
        return square
    shift = frequency_shift(wall, lowest, square)
    # Rounded, for a library's frequencies differ in their last bits from machine to machine.
    while (lost := round(shift(_scaled(wall.mass, stiffness, square)) / allowance.lost, 6)) > 1:
        square *= lost * (1 + CLOSE)
    return square


def _scaled(mass: Array, stiffness: Array, square: float) -> Array:
    return np.asarray(mass * mass_factor(stiffness, mass, ROOM * 2 / np.sqrt(square)))


def modal_viscosity(stiffness: Array, mass: Array, damping: float) -> Array:
    """2 ξ (k m)^{1/2}, nothing for a mode without stiffness whatever its mass."""
    return np.where(stiffness > 0, 2 * damping * np.sqrt(stiffness * np.where(stiffness > 0, mass, 1.0)), 0.0)


def _rigid_bound(kinds: list[_Kind]) -> float:
    """Largest ω² of blocks that do not deform."""
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
    """Blocks that differ in their mesh, their pins or their joints, shared with an exponent (`joint_shares`)."""
    joint = wall.elements
    n, ne, _ = joint.weights.shape
    block = joint.points.block[:ne]
    inertia = wall.scene.inertial_mass
    part = joint_shares(np.where(wall.scene.fixed, np.inf, inertia)[block], exponent)
    normal, shear = wall_stiffness(wall.scene, joint.points.joint[:ne], closed=True)
    springs = joint.points.area.reshape(n, ne) * np.stack([normal, shear])[:, None]  # (2, n, ne)

    # Both sides of all elements, side by side: their local nodes, and all that their stiffness depends on.
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
                frame = np.array([joint.normal[e], [-joint.normal[e, 1], joint.normal[e, 0]]])
                jumps = np.einsum("dx,pxm->dpm", frame, at_points)
                matrix += part[side] * np.einsum("dp,dpm,dpk->mk", springs[:, :, e], jumps, jumps)
        stiffness = modes.stiffness[moving]
        share = np.where(stiffness > 0, of_joints * np.diagonal(joints, axis1=1, axis2=2).max(axis=0), 0.0)
        result.append(_Kind(modes.mass[moving], stiffness, joints, stiffness + share))
    return result
