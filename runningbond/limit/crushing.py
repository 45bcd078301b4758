"""Resultants of joints of finite compressive strength: support function and boundary points of their strength domain.

At each point of such a joint the tractions lie in a domain K: |τ| ≤ c − σ tan φ, σ ≤ f_t and the cap
p² + C_ss τ² ≤ f_m² on the pressure p = max(0, −σ), an ellipse that continues straight in tension. The resultants of all
fields of tractions in K form the convex strength domain of a joint. If its ends open by α₁ and α₂, with α linear in
between, and it slips by β, the support function of that domain is

    H(α₁, α₂, β) = A ∫₀¹ h(α₁ + (α₂ − α₁) ξ, β) dξ,    h(α, β) = max {α σ + β τ : (σ, τ) ∈ K},

the largest power that the joint can dissipate. The gradient of H contains the forces N₁ = A ∫ σ (1 − ξ) and
N₂ = A ∫ σ ξ at the ends and V = A ∫ τ of the tractions that attain it. For τ ≥ 0 the boundary of K consists, by falling
ratio α / β of its normals, of

    T, the corner of the cut-off;  B, where the cone meets the cap, if it does;  the arc.

Tractions are constant at the corners. On the arc, σ = f_m tanh u with sinh u = √C_ss α / β, from α / β < 0 downwards.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from runningbond.joints import wall_cones
from runningbond.scene import Array, Indices, Scene

SHORT_ARC = 0.1
"""Range of α on an arc, relative to hypot(α, β/√C_ss), up to which quadrature is exact and closed forms are not."""

TINY = 1e-14
"""Differences of α, and slips, relative to the largest jump, that count as zero."""

STRONGEST = 1e9
"""Strength of a joint, in force units, above which it is assumed never to crush: it would swamp the other joints."""

NODES, WEIGHTS = ((part + shift) / 2 for part, shift in zip(np.polynomial.legendre.leggauss(8), (1, 0), strict=True))


@dataclass(frozen=True, eq=False)
class Crushing:
    """Joints of finite compressive strength, in force units.

    Parameters
    ----------
    joint : (nc,) int
        Numbers of the joints; the points of joint j are 2j and 2j + 1.
    strength, cap_shear : (nc,) float
        Largest pressure f_m A, and C_ss.
    ratio : (2, nc) float
        Ratios α / β, in falling order, at which one piece of the boundary of K ends and the next begins.
    sigma, tau : (2, nc) float
        Tractions of the corners T and B, times the joint's area.
    """

    joint: Indices
    strength: Array
    cap_shear: Array
    ratio: Array
    sigma: Array
    tau: Array

    def __len__(self) -> int:
        return len(self.joint)

    @property
    def ends(self) -> Indices:
        """Points at the first and second end of each joint, ``(2, nc)``."""
        return np.array([2 * self.joint, 2 * self.joint + 1])

    def forces(self, jumps: Array) -> Array:
        """Forces N₁, N₂ and V ``(3, nc)`` that dissipate most on jumps α₁, α₂ and β, ``(3, nc)``."""
        first, second, slip = jumps
        scale = np.abs(jumps).max(axis=0) + np.finfo(float).tiny
        low, beta = np.minimum(first, second), np.maximum(np.abs(slip), TINY * scale)
        high = low + np.maximum(np.abs(second - first), TINY * scale)
        span = high - low
        edges = [high, *np.clip(beta * self.ratio, low, high)]
        total = self._arc(low, (edges[-1] - low) / span, np.zeros(len(self)), span, beta)
        for (end, start), sigma, tau in zip(pairwise(edges), self.sigma, self.tau, strict=True):
            width, middle = (end - start) / span, ((end + start) / 2 - low) / span
            total += np.array([sigma * width, sigma * width * middle, tau * width])
        normal, moment, shear = total
        ends = np.where(second >= first, [normal - moment, moment], [moment, normal - moment])
        return np.array([*ends, np.sign(slip) * shear])

    def _arc(self, start: Array, width: Array, at: Array, span: Array, beta: Array) -> Array:
        """∫σ, ∫σ ξ and ∫τ, ``(3, nc)``, on the elliptic arc, for ξ from `at` over `width`; α grows from `start`."""
        unit = np.sqrt(np.where(self.cap_shear > 0, self.cap_shear, 1.0))
        small, end = beta / unit, start + width * span
        root, root_end = np.hypot(start, small), np.hypot(end, small)
        alpha = start + NODES[:, None] * width * span
        weight, radius = WEIGHTS[:, None] * width, np.hypot(alpha, small)
        sigma, tau = alpha / radius, small / radius
        here = (weight * np.array([sigma, sigma * NODES[:, None] * width, tau])).sum(axis=1)
        turn = np.arcsinh(end / small) - np.arcsinh(start / small)
        normal = (root_end - root) / span
        second = ((end * root_end - start * root - small**2 * turn) / (2 * span) - start * normal) / span
        closed = np.array([normal, second, small * turn / span])
        short = width * span <= SHORT_ARC * np.maximum(root, root_end)
        normal, second, shear = self.strength * np.where(short, here, closed)
        return np.where(width > 0, [normal, at * normal + second, shear / unit], 0.0)

    def dissipation(self, jumps: Array) -> Array:
        """Largest power H ``(nc,)`` of admissible forces on jumps α₁, α₂ and β ``(3, nc)``."""
        return np.asarray((self.forces(jumps) * jumps).sum(axis=0))

    def blocks(self, share: Array) -> Array:
        """Forces of stress blocks that occupy shares ``(k,)`` of a joint from either end, ``(3, n)``, joint by joint.

        A stress block is at pressure f_m or, with shear, at corner B; the rest of the joint is at the tension cut-off.
        """
        end, other = share - share**2 / 2, share**2 / 2
        found = []
        for side in (1, -1):
            for sense in (0.0, 1.0, -1.0):
                here = -self.strength if sense == 0.0 else self.sigma[1]
                rise = (here - self.sigma[0])[:, None]
                ends = [rise * end + self.sigma[0, :, None] / 2, rise * other + self.sigma[0, :, None] / 2][::side]
                shear = sense * (share * (self.tau[1] - self.tau[0])[:, None] + self.tau[0, :, None])
                found.append([*ends, shear])
        return np.moveaxis(np.array(found), 0, 2).reshape(3, -1)


def may_crush(scene: Scene) -> Indices:
    """Joints of a scene that have a compressive strength."""
    has = np.array([material.compressive_strength is not None for material in scene.joint_materials])
    return np.flatnonzero(has[scene.material_of_joint])


def crushing(scene: Scene, force_unit: float, strongest: float = STRONGEST) -> Crushing | None:
    """The crushing joints of a scene, without those stronger than `strongest`; None if there are none."""
    materials, joint = [scene.joint_materials[k] for k in scene.material_of_joint], may_crush(scene)
    strength = np.array([materials[k].compressive_strength for k in joint], dtype=float)
    area = scene.joints.length[joint] * scene.thickness_of_joints[joint] / force_unit
    crushes = strength * area <= strongest
    joint, strength, area = joint[crushes], strength[crushes], area[crushes]
    if not len(joint):
        return None
    shear = np.array([materials[k].cap_shear for k in joint])
    ratio, sigma, tau = _boundary(*wall_cones(scene, joint), strength, shear)
    return Crushing(joint, strength * area, shear, ratio, sigma * area, tau * area)


def _boundary(slope: Array, tension: Array, held: Array, strength: Array, shear: Array) -> tuple[Array, Array, Array]:
    """Ratios and corners of `Crushing` from tan φ, f_t, τ at f_t, f_m and C_ss, ``(2, n)`` each."""
    cohesion = held + slope * tension
    most = strength / np.sqrt(np.where(shear > 0, shear, np.nan))  # largest shear of the cap
    most = np.where(shear > 0, most, np.inf)
    stretch, crossing = 1 + shear * slope**2, shear * slope * cohesion
    root = np.sqrt((strength**2 * stretch - shear * cohesion**2).clip(min=0.0))
    # The cone meets the cap under pressure, in tension, or nowhere because it lies beyond the cap.
    pressed, pulled = cohesion < most, (cohesion >= most) & (held < most)
    with np.errstate(divide="ignore", invalid="ignore"):
        sigma = np.where(pressed, (crossing - root) / stretch, np.where(pulled, (cohesion - most) / slope, 0.0))
        tau = np.where(pressed, (cohesion - slope * sigma).clip(min=0.0), most)
        last = np.where(shear * tau > 0, sigma / (shear * tau), -np.inf)
    ratio = np.array([np.where(pressed | pulled, slope, 0.0), np.where(pressed, last, 0.0)])
    return ratio, np.array([tension, sigma]), np.array([np.minimum(held, most), tau])
