"""The stable time step, from each block alone, and the mass scaling of its deformable modes."""

import math

import numpy as np

from runningbond.joints import JointPoints
from runningbond.scene import Array, Indices

SAFETY = 0.9
"""Fraction of the bound on the time step that is taken."""

EXPONENTS = (0.0, 0.5, 1.0)
"""Exponents of the ratio in which two blocks share a joint (`joint_shares`): the lowest bound is taken."""


def stable_step(frequency_squared: float, damping_ratio: float = 0.0, local: float = 0.0) -> float:
    """Time step [s] at which central differences stay bounded.

    Δt = 0.9 · (2/ω') (√(1 + ξ'²) − ξ') with ω' = √(1 + α) ω and ξ' = √(1 + α) ξ: local damping multiplies all forces
    that slow a mode down by up to 1 + α, its lagged viscous force included. Exact for α or ξ alone; for both,
    conservative.

    Parameters
    ----------
    frequency_squared
        Largest ω² [1/s²], or a bound above it.
    damping_ratio
        ξ of the viscous damping of that mode.
    local
        α of the local damping.

    Examples
    --------
    >>> stable_step(frequency_squared=4.0)  # 0.9 of 2 / ω
    0.9
    """
    enlarged = math.sqrt(1 + local)
    ratio = enlarged * damping_ratio
    return SAFETY * 2 / (enlarged * math.sqrt(frequency_squared)) * (math.sqrt(1 + ratio**2) - ratio)


def joint_shares(mass: Array, exponent: float) -> Array:
    """Factors on the two sides' own energies in a joint, with which their sum exceeds that of the jump, ``(n, 2)``.

    For any c > 0, (u_b − u_a)² ≤ (1 + c) u_b² + (1 + 1/c) u_a². With c = (m_b / m_a)^exponent, and factor 1 beside a
    held side (2 for exponent 0), two blocks of different mass share a joint evenly.

    Parameters
    ----------
    mass : (n, 2) float
        Masses of the blocks on either side [kg], inf where one is held.
    exponent
        0 shares by halves, 1 by mass.
    """
    with np.errstate(invalid="ignore"):
        ratio = mass / mass[:, ::-1]
    return np.asarray(1 + np.nan_to_num(ratio, nan=1.0, posinf=0.0) ** exponent)


def block_frequency_squared(stiffness: Array, mass: Array) -> Array:
    """Largest ω² of blocks against their own share of their joints' energy, ``(nb,)`` [1/s²].

    If the two sides' shares add up to at least the energy of the jump between them (twice each side's own energy, for
    instance), the maximum over all blocks bounds the system without a global matrix.

    Parameters
    ----------
    stiffness : (nb, m, m) float
        Stiffness of each block's modes against its share of its joints.
    mass : (nb, m) float
        Modal masses.
    """
    root = 1 / np.sqrt(mass)
    scaled = stiffness * root[:, :, None] * root[:, None, :]
    return np.asarray(np.linalg.eigvalsh(scaled)[:, -1])


def rigid_frequency_squared(
    points: JointPoints, side: Indices, centroid: Array, mass: Array, normal: Array, shear: Array
) -> float:
    """Bound of the largest ω² of rigid blocks on the joints between them [1/s²], the best of `EXPONENTS`.

    Parameters
    ----------
    points
        Points of the joints.
    side : (np, 2) int
        Blocks on either side of each point.
    centroid : (nb, 2) float
        Centroids of the blocks [m].
    mass : (nb, 3) float
        Mass, mass and polar moment of inertia of each block [kg, kg, kg m²], inf where it is held.
    normal, shear : (np,) float
        Stiffness of the joints at their points [Pa/m].
    """
    moving = np.isfinite(mass).all(axis=1)
    each = (rigid_stiffness(points, side, centroid, mass, normal, shear, exponent) for exponent in EXPONENTS)
    return min(float(block_frequency_squared(own[moving], mass[moving]).max()) for own in each)


def rigid_stiffness(
    points: JointPoints,
    side: Indices,
    centroid: Array,
    mass: Array,
    normal: Array,
    shear: Array,
    exponent: float = 0.5,
) -> Array:
    """Stiffness of each rigid block against its share of its joints, ``(nb, 3, 3)`` [N/m, N, N m].

    Arguments are those of `rigid_frequency_squared`, with the exponent of `joint_shares`.
    """
    part, own = joint_shares(mass[side, 0], exponent), np.zeros((len(mass), 3, 3))
    for direction, stiffness in ((points.normal, normal), (points.tangent, shear)):
        for s in (0, 1):
            arm = points.position - centroid[side[:, s]]
            turning = direction[:, 1] * arm[:, 0] - direction[:, 0] * arm[:, 1]
            jump = np.column_stack([direction, turning])
            spring = stiffness * points.area * part[:, s]
            np.add.at(own, side[:, s], spring[:, None, None] * (jump[:, :, None] * jump[:, None, :]))
    return own


def mass_factor(stiffness: Array, mass: Array, dt: float, local: float = 0.0) -> Array:
    """Factor by which each mode's mass grows so that its own stiffness does not limit the step, ``(nd,)``.

    M* = M + β (Δt² / 4) K with β = 1.2 (1 + α): one for rigid modes, and close to one for sufficiently slow modes.
    """
    return 1 + 0.3 * (1 + local) * dt**2 * stiffness / mass
