"""Rigid blocks on elastic joint points: residual and tangent of the static equations, and their solution.

    B_nᵀ N + B_tᵀ S + Cᵀ r − f_dead − λ f_live = 0,    C q = 0,    f_live · q = d  (or λ given)

in the scaled freedoms and forces of `Equilibrium`; displacements are measured in the elastic length that the unit
of force makes of the stiffest joint point, so that stiffnesses, too, are of order one. Unknowns are ordered
x = (q, r, λ). The tangent has the same pattern in every step: its entries are found once as sums of joint points'
entries.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csc_array, csr_array

from runningbond.joints import PointLaw, PointResponse, static_law, wall_stiffness
from runningbond.limit.equilibrium import Equilibrium, equilibrium
from runningbond.scene import Array, Indices, Scene

from .band import Band, band


@dataclass(frozen=True)
class Control:
    """The last equation: the live load's displacement f_live · q, or λ where `multiplier`, has this value."""

    value: float
    multiplier: bool = False


@dataclass(frozen=True, eq=False)
class StaticSystem:
    """The static equations of a scene."""

    equilibrium: Equilibrium  # scaled equilibrium of its blocks
    law: PointLaw  # law of its joint points, scaled
    length_unit: float  # displacement [m] that counts as 1

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
        return np.concatenate([force, self._held @ q, [last - control.value]])

    def viscous(self, motion: Array) -> Array:
        """Forces ``(nd,)`` of dashpots in proportion to the elastic stiffness of every joint point."""
        system, law, q = self.equilibrium, self.law, motion[: self.freedoms]
        normal, tangential = law.normal_stiffness * (self.opening @ q), law.shear_stiffness * (self.slip @ q)
        return np.asarray(system.opening @ normal + system.slip @ tangential)

    def solve(self, tangent: Array, control: Control, right: Array) -> Array:
        """Solve the tangent equations.

        Parameters
        ----------
        tangent : (np, 2, 2) float
            Of the joint points.
        control
            Which equation is the last.
        right : (n,) float
            Right-hand side.

        Raises
        ------
        numpy.linalg.LinAlgError
            For a tangent that is singular to the last bit.
        """
        jump, live = self._jump, self.equilibrium.live
        own = np.matmul(np.matmul(jump.transpose(0, 2, 1), tangent), jump).ravel()
        border = np.concatenate([live, np.zeros(self.unknowns - 1 - len(live))])
        # The border of λ is eliminated by hand: q = a + λ b.
        a, b = self._band.solve(np.concatenate([own, self._pins, self._pins]), np.column_stack([right[:-1], border])).T
        multiplier = right[-1] if control.multiplier else (right[-1] - border @ a) / (border @ b)
        return np.append(a + multiplier * b, multiplier)

    @cached_property
    def elastic(self) -> Array:
        """Tangent of the joint points before anything opens or slides, ``(np, 2, 2)``."""
        tangent = np.zeros((len(self.law.normal_stiffness), 2, 2))
        tangent[:, 0, 0], tangent[:, 1, 1] = self.law.normal_stiffness, self.law.shear_stiffness
        return tangent

    @cached_property
    def _held(self) -> csr_array:
        """Displacements of pinned points per freedom, ``(n_pins, nd)``."""
        return csr_array(self.equilibrium.reaction.T)

    @cached_property
    def _pins(self) -> Array:
        """Entries of C in the order of its columns."""
        return np.asarray(self.equilibrium.reaction.tocoo().data)

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
    def _band(self) -> Band:
        """Where the entries of the tangent go: the joint points' own 6 × 6 tangents, then C twice."""
        nd, own, scene = self.freedoms, self._freedoms_of_points, self.equilibrium.scene
        pins = self.equilibrium.reaction.tocoo()
        row = np.concatenate([np.repeat(own, 6, axis=1).ravel(), pins.row, nd + pins.col])
        column = np.concatenate([np.tile(own, 6).ravel(), nd + pins.col, pins.row])
        home = np.repeat(scene.blocks.centroid[~scene.fixed], 3, axis=0)
        held = np.empty((pins.shape[1], 2))
        held[pins.col] = home[pins.row]
        return band(row, column, np.concatenate([home, held]), 0.1 * scene.lowest_block)


def _independent(pins: csc_array) -> csc_array:
    """Pins that do not follow from others: a block pinned at both corners has four, and three motions."""
    if pins.shape[1] == 0:
        return pins
    _, triangle, order = qr(pins.toarray(), mode="economic", pivoting=True)
    size = np.abs(np.diag(triangle))
    return csc_array(pins[:, np.sort(order[: len(size)][size > 1e-9 * size[0]])])


def static_system(scene: Scene) -> StaticSystem:
    """Set up the static equations of a scene.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness, or a law that has no tangent.
    """
    system = equilibrium(scene)
    system = replace(system, reaction=_independent(system.reaction))
    normal, shear = (k * system.points.area for k in wall_stiffness(scene, system.points.joint))
    # A single block held at both corners has no joint, and does not move.
    stiffest = float(max(normal.max(initial=0.0), shear.max(initial=0.0))) or 1.0
    length = system.force_unit / stiffest
    scale = length / system.force_unit
    return StaticSystem(system, static_law(scene, system.strength, normal * scale, shear * scale), length)
