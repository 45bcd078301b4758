"""Strength domain of running bond with rigid blocks and Mohr–Coulomb joints (de Buhan & de Felice 1997).

With macroscopic strain rate D and a rotation ω common to all blocks, the jump across a joint between blocks
whose centres are Δx apart is (D − Ω) Δx, the same all along it: Δx = (b, 0) across head joints and (±b/2, a)
across bed joints. Joints that carry a cone of tractions, σ ≤ f_t, |τ| ≤ s + (f_t − σ) tan φ, resist a jump
(j_n, j_t) with f_t j_n + s |j_t| per unit area if j_n ≥ tan φ |j_t|, and without limit otherwise. The domain is the set
of stresses Σ whose power Σ : D no admissible D exceeds.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from runningbond.joints import point_strength
from runningbond.scene import Bond, JointMaterial


@dataclass(frozen=True)
class StrengthDomain:
    """Stresses that running bond can carry, by its block and the strength of its joints."""

    bond: Bond
    joint: JointMaterial

    def strength(self, direction: tuple[float, float, float]) -> float:
        """Largest t for which t (Σ11, Σ22, Σ12), tension positive, is carried [Pa per unit of it]; inf if any is.

        Solved as min π(D) over D with Σ : D = 1, with each joint's slip split into its two senses.
        """
        b, a = self.bond.width, self.bond.height
        half, n = b / 2, 3
        resistance = point_strength(self.joint, np.array([a, half, half]))
        # Jumps [m] of the head and the two bed joints per D11, D22, D12 and ω.
        opening = np.array([[b, 0, 0, 0], [0, a, half, -half], [0, a, -half, half]], dtype=float)
        slip = np.array([[0, 0, b, -b], [half, 0, a, a], [-half, 0, a, a]], dtype=float)
        # Unknowns: D11, D22, D12, ω, then forward and backward slip of each joint.
        cost = np.concatenate([resistance.tension @ opening, resistance.shear, resistance.shear]) / (a * b)
        split = np.hstack([slip, -np.eye(n), np.eye(n)])
        power = np.concatenate([[direction[0], direction[1], 2 * direction[2], 0.0], np.zeros(2 * n)])
        dilate = np.hstack([-opening, resistance.friction * np.eye(n), resistance.friction * np.eye(n)])
        scale = float(np.abs(cost).max()) or 1.0
        result = linprog(
            cost / scale,
            A_ub=dilate,
            b_ub=np.zeros(n),
            A_eq=np.vstack([split, power]),
            b_eq=np.append(np.zeros(n), 1.0),
            bounds=[(None, None)] * 4 + [(0, None)] * (2 * n),
            method="highs",
        )
        if result.status == 2:
            return float("inf")
        if result.status != 0 or result.fun is None:
            raise ArithmeticError(f"strength in direction {direction}: {result.message}")
        return float(result.fun * scale)
