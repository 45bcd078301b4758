"""Rigid blocks on elastic joint points: residual and tangent of the static equations, and their sparse solution.

    B_nᵀ N + B_tᵀ S + Cᵀ r − f_dead − λ f_live = 0,    C q = 0,    f_live · q = d  (or λ given)

in the scaled freedoms and forces of `Equilibrium`; displacements are measured in the elastic length that the unit
of force makes of the stiffest joint point, so that stiffnesses, too, are of order one. Unknowns are ordered
x = (q, r, λ). The tangent has the same pattern in every step: its entries are found once as sums of joint points'
entries, its elimination order is found once, and the dense border of λ is eliminated last.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array
from scipy.sparse.linalg import splu

from joints import PointLaw, PointResponse, wall_stiffness
from scene import Array, Indices, Scene

from .equilibrium import Equilibrium, equilibrium


@dataclass(frozen=True)
class Control:
    """The last equation: the live load's displacement f_live · q, or λ where `multiplier`, has this value."""

    value: float
    multiplier: bool = False


@dataclass(frozen=True, eq=False)
class Pattern:
    """Where the entries of the tangent go, its unknowns already in the order of elimination.

    Parameters
    ----------
    order : (n,) int
        The unknown that is eliminated k-th.
    row, first : (n_entries,), (n + 1,) int
        Row of each entry, and the first entry of each column.
    slot : (n_terms,) int
        Entry to which each term is added, the number of entries for terms of blocks that are held. Terms are
        the joint points' own 6 × 6 tangents, the proximal diagonal, C twice, and column, row and corner of the
        border.
    """

    order: Indices
    row: Indices
    first: Indices
    slot: Indices

    def matrix(self, terms: Array) -> csc_array:
        """Sum the terms up."""
        n = len(self.order)
        summed = np.bincount(self.slot, terms)[: len(self.row)]
        return csc_array((summed, self.row, self.first), shape=(n, n))


@dataclass(frozen=True, eq=False)
class StaticSystem:
    """The static equations of a scene.

    Parameters
    ----------
    equilibrium
        Scaled equilibrium of its blocks.
    law
        Law of its joint points, scaled.
    length_unit : float
        Displacement [m] that counts as 1.
    """

    equilibrium: Equilibrium
    law: PointLaw
    length_unit: float

    @property
    def freedoms(self) -> int:
        """Number of movable degrees of freedom, the first unknowns."""
        return self.equilibrium.freedoms

    @property
    def unknowns(self) -> int:
        """Number of unknowns x = (q, r, λ)."""
        return self.freedoms + self.equilibrium.reaction.shape[1] + 1

    @cached_property
    def opening(self) -> csr_array:
        """Openings of the joint points per freedom, ``(np, nd)``."""
        return csr_array(self.equilibrium.opening.T)

    @cached_property
    def slip(self) -> csr_array:
        """Slips of the joint points per freedom, ``(np, nd)``."""
        return csr_array(self.equilibrium.slip.T)

    def respond(self, x: Array, plastic_slip: Array) -> PointResponse:
        """Answer of the joint points ``(np,)`` to unknowns ``(n,)`` after a plastic slip ``(np,)``."""
        q = x[: self.freedoms]
        return self.law(self.opening @ q, self.slip @ q, plastic_slip)

    def unbalanced(self, x: Array, response: PointResponse, control: Control) -> Array:
        """Residual of all equations, ``(n,)``."""
        system, nd = self.equilibrium, self.freedoms
        q, reaction, multiplier = x[:nd], x[nd:-1], x[-1]
        force = system.opening @ response.normal + system.slip @ response.tangential
        force += system.reaction @ reaction - system.dead - multiplier * system.live
        last = multiplier if control.multiplier else system.live @ q
        return np.concatenate([force, system.reaction.T @ q, [last - control.value]])

    def solve(self, tangent: Array, proximal: float, control: Control, right: Array) -> Array:
        """Solve the tangent equations.

        Parameters
        ----------
        tangent : (np, 2, 2) float
            Of the joint points.
        proximal : float
            Share of the elastic stiffness's diagonal that is added to the tangent.
        control
            Which equation is the last.
        right : (n,) float
            Right-hand side.

        Raises
        ------
        RuntimeError
            For a tangent that is singular to the last bit.
        """
        jump = self._jump
        own = np.matmul(np.matmul(jump.transpose(0, 2, 1), tangent), jump).ravel()
        live = self.equilibrium.live
        by_multiplier = float(control.multiplier)
        pins = self.equilibrium.reaction.tocoo().data
        terms = [own, proximal * self.diagonal, pins, pins, -live, (1 - by_multiplier) * live, [by_multiplier]]
        order = self.pattern.order
        # Pivots stay on the diagonal unless they are tiny: the order of elimination was chosen for that, and what
        # accuracy it costs the next iteration makes good. Partial pivoting takes up to three times as long.
        factors = splu(
            self.pattern.matrix(np.concatenate(terms)),
            permc_spec="NATURAL",
            diag_pivot_thresh=1e-3,
            options={"SymmetricMode": True},
        )
        x = np.empty(len(order))
        x[order] = factors.solve(right[order])
        return x

    @cached_property
    def elastic(self) -> Array:
        """Tangent of the joint points before anything opens or slides, ``(np, 2, 2)``."""
        tangent = np.zeros((len(self.law.normal_stiffness), 2, 2))
        tangent[:, 0, 0], tangent[:, 1, 1] = self.law.normal_stiffness, self.law.shear_stiffness
        return tangent

    @cached_property
    def diagonal(self) -> Array:
        """Diagonal of the elastic stiffness, ``(nd,)``."""
        k_n, k_t = self.law.normal_stiffness, self.law.shear_stiffness
        return np.asarray(self.equilibrium.opening**2 @ k_n + self.equilibrium.slip**2 @ k_t)

    @cached_property
    def _freedoms_of_points(self) -> Indices:
        """Freedoms of the two blocks at each joint point, ``(np, 6)``; −1 where a block is held."""
        scene = self.equilibrium.scene
        first = np.full(len(scene.blocks), -1)
        first[~scene.fixed] = 3 * np.arange(np.count_nonzero(~scene.fixed))
        of_block = np.where(first[:, None] >= 0, first[:, None] + np.arange(3), -1)
        return of_block[self.equilibrium.points.block].reshape(-1, 6)

    @cached_property
    def _jump(self) -> Array:
        """Opening and slip of each joint point per own freedom, ``(np, 2, 6)``; zero where a block is held."""
        own = self._freedoms_of_points
        jump = np.zeros((len(own), 2, 6))
        for k, operator in enumerate((self.opening, self.slip)):
            entries = operator.tocoo()
            column = np.argmax(own[entries.row] == entries.col[:, None], axis=1)
            jump[entries.row, k, column] = entries.data
        return jump

    @cached_property
    def pattern(self) -> Pattern:
        """Where the entries of the tangent go."""
        n, nd, own = self.unknowns, self.freedoms, self._freedoms_of_points
        pins = self.equilibrium.reaction.tocoo()
        free, last = np.arange(nd), np.full(nd, n - 1)
        row = np.concatenate([np.repeat(own, 6, axis=1).ravel(), free, pins.row, nd + pins.col, free, last, [n - 1]])
        column = np.concatenate([np.tile(own, 6).ravel(), free, nd + pins.col, pins.row, last, free, [n - 1]])
        there = (row >= 0) & (column >= 0)
        # Symbolic factors of the unbordered matrix, made diagonally dominant so that nothing is pivoted.
        inner = there & (row < n - 1) & (column < n - 1)
        values = np.where(row == column, float(n), 1.0)[inner]
        unbordered = csc_array(coo_array((values, (row[inner], column[inner])), shape=(n - 1, n - 1)))
        unbordered.setdiag(float(36 * n))
        order = np.append(np.argsort(splu(unbordered, permc_spec="MMD_AT_PLUS_A").perm_c), n - 1)

        place = np.argsort(order)
        key = np.where(there, place[column] * n + place[row], n * n)
        entries, slot = np.unique(key, return_inverse=True)
        entries = entries[entries < n * n]
        first = np.searchsorted(entries, np.arange(n + 1) * n)
        return Pattern(order, (entries % n).astype(np.int32), first.astype(np.int32), slot)


def static_system(scene: Scene) -> StaticSystem:
    """Set up the static equations of a scene.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness.
    """
    system = equilibrium(scene)
    normal, shear = (k * system.points.area for k in wall_stiffness(scene, system.points.joint))
    length = system.force_unit / float(max(normal.max(), shear.max()))
    scale = length / system.force_unit
    return StaticSystem(system, PointLaw(system.strength, normal * scale, shear * scale), length)
