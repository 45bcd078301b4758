"""Strength domain of running bond with rigid blocks and Mohr–Coulomb joints (de Buhan & de Felice 1997).

With macroscopic strain rate D and a rotation ω common to all blocks, the jump across a joint between blocks whose
centres are Δx apart is (D − Ω) Δx, constant along the joint: Δx = (b, 0) across head joints and (±b/2, a) across bed
joints. Tractions may therefore be constant along each joint, too. Stresses Σ are carried if there are tractions within
the joint strength whose power on the jumps, per area of the wall, is Σ : D for every D and ω. Joints carry σ ≤ f_t,
|τ| ≤ s + (f_t − σ) tan φ and, with a compressive strength f_m, p² + C_ss τ² ≤ f_m², p = max(0, −σ); s is τ at f_t.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog

from runningbond.joints.mohr_coulomb import truncated_cone
from runningbond.scene import Array, Bond, JointMaterial, SceneError
from runningbond.scene.ranges import SMALLEST, Range

CAP_TOLERANCE = 1e-10
"""Relative excess of tractions over a cap above which a tangent is added there."""

ROUNDS = 100
"""Largest number of rounds of tangents; each round reduces the excess over the caps to a quarter or less."""

FIRST_TANGENTS = np.array([[1.0, 0.0], [0.6, 0.8], [0.6, -0.8], [0.0, 1.0], [0.0, -1.0]])
"""Points of the first tangents to a cap, as unit vectors of (p, √C_ss τ)."""

INFEASIBLE = 2
"""Status by which `scipy.optimize.linprog` calls a program infeasible."""


@dataclass(frozen=True)
class StrengthDomain:
    """Domain of the stresses that running bond can carry, from its block size and the strength of its joints.

    Parameters
    ----------
    bond, joint
        Size of a block, and material of the joints.
    head
        Material of the head joints; None is that of the bed joints. Open joints have ``JointMaterial(friction)``.
    """

    bond: Bond
    joint: JointMaterial
    head: JointMaterial | None = None

    @property
    def _joints(self) -> tuple[JointMaterial, ...]:
        """Materials of the head joint and of the two bed joints of a block."""
        return self.head or self.joint, self.joint, self.joint

    def strength(self, direction: tuple[float, float, float]) -> float:
        """Largest t for which t (Σ11, Σ22, Σ12), tension positive, is carried.

        Parameters
        ----------
        direction
            Σ11 along the courses, Σ22 across them and Σ12, in any unit.

        Returns
        -------
        float
            t [Pa per unit of the direction]; inf if every t is carried.

        Raises
        ------
        SceneError
            For a direction that is not three finite numbers.

        Examples
        --------
        >>> dry = JointMaterial(friction=0.6)
        >>> round(StrengthDomain(Bond(0.24, 0.06), dry).strength((0.0, -1.0, 0.7)), 6)
        0.0
        >>> StrengthDomain(Bond(0.24, 0.06), dry).strength((0.0, -1.0, 0.4))
        inf
        """
        wanted = _stress(direction)
        size = float(np.abs(wanted).max())
        if size == 0.0:
            return float("inf")
        friction, tension, shear = np.array([truncated_cone(each) for each in self._joints]).T
        crushing = np.array([each.compressive_strength or np.inf for each in self._joints])
        crushes = bool(np.isfinite(crushing).any())
        unit = float(max(tension.max(), shear.max()) or (crushing.min() if crushes else 1.0))
        # Unknowns: t, then σ and τ of a head joint and of the two bed joints of a block.
        balance = np.column_stack([np.append(-wanted * [1, 1, 2] / size, 0.0), self._powers()])
        none, one, slope = np.zeros((3, 1)), np.eye(3), np.diag(friction)
        rows = np.block([[none, one, 0 * one], [none, slope, one], [none, slope, -one]])
        right = np.concatenate([tension, shear + friction * tension, shear + friction * tension]) / unit
        if crushes:
            largest = self._capped(balance, rows, right, crushing / unit)
        else:
            largest, _ = _largest(balance, rows, right)
        return max(0.0, largest) * unit / size

    def _powers(self) -> Array:
        """Power of unit σ, then unit τ, on each joint under D11, D22, D12 and ω, per area of the wall; ``(4, 6)``."""
        half, height = 0.5, self.bond.height / self.bond.width
        opening = np.array([[1, 0, 0, 0], [0, height, half, -half], [0, height, -half, half]])
        slip = np.array([[0, 0, 1, -1], [half, 0, height, height], [-half, 0, height, height]])
        share = np.array([height, half, half]) / height
        return np.hstack([opening.T * share, slip.T * share])

    def _capped(self, balance: Array, rows: Array, right: Array, crushing: Array) -> float:
        """Largest t within caps on pressures, by cutting planes: tangents are added where tractions exceed the caps.

        The caps are ``(3,)``, inf for a joint that does not crush.
        """
        stretch = np.sqrt([each.cap_shear for each in self._joints])
        capped = np.flatnonzero(np.isfinite(crushing))
        joint, side = np.repeat(capped, len(FIRST_TANGENTS)), np.tile(FIRST_TANGENTS, (len(capped), 1))
        for _ in range(ROUNDS):
            tangents = np.zeros((len(joint), 7))
            tangents[np.arange(len(joint)), 1 + joint] = -side[:, 0]
            tangents[np.arange(len(joint)), 4 + joint] = stretch[joint] * side[:, 1]
            rows, right = np.vstack([rows, tangents]), np.append(right, crushing[joint])
            largest, (sigma, tau) = _largest(balance, rows, right)
            used = np.column_stack([np.maximum(0.0, -sigma), stretch * tau])
            reach = np.hypot(*used.T)
            excess = reach / crushing
            joint = np.flatnonzero(excess > 1 + CAP_TOLERANCE)
            side = used[joint] / reach[joint, None]
            if not len(joint):
                break
        # Scaled down until they satisfy the caps, the tractions carry t reduced by this factor.
        return largest / max(float(excess.max()), 1.0)


def _largest(balance: Array, rows: Array, right: Array) -> tuple[float, Array]:
    """Largest t, or inf, and tractions σ and τ ``(2, 3)`` of the joints that carry it."""
    free = [(0, None)] + [(None, None)] * 6
    # No stress is always carried, but presolve takes some unbounded programs for infeasible ones.
    for presolve in (True, False):
        found = linprog(
            [-1, *[0] * 6],
            A_ub=rows,
            b_ub=right,
            A_eq=balance,
            b_eq=np.zeros(4),
            bounds=free,
            method="highs",
            options={
                "presolve": presolve,
                "primal_feasibility_tolerance": 1e-10,
                "dual_feasibility_tolerance": 1e-10,
            },
        )
        if found.status != INFEASIBLE:
            break
    if found.status == 3:
        return float("inf"), np.zeros((2, 3))
    if found.status != 0 or found.x is None:
        raise ArithmeticError(f"strength of a wall: {found.message}")
    return float(found.x[0]), found.x[1:].reshape(2, 3)


def _stress(direction: object) -> Array:
    """A direction in stress space as an array ``(3,)``."""
    if not isinstance(direction, (tuple, list, np.ndarray)) or np.shape(direction) != (3,):
        raise SceneError("direction", "must be three numbers, Σ11, Σ22 and Σ12", direction)
    # Values below the smallest number allowed in a scene are set to zero, unless all are.
    small = [isinstance(value, float) and abs(value) < SMALLEST for value in direction]
    if all(small):
        small = [False] * 3
    numbers = [0.0 if small[k] else Range().take(f"direction[{k}]", value) for k, value in enumerate(direction)]
    return np.array(numbers)
