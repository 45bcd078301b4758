"""Rigid blocks on elastic joint points: residual and tangent of the static equations, and their solution.

    B_nᵀ N + B_tᵀ S + Cᵀ r − f_dead − λ f_live = 0,    C q = c,    f_live · q = d  (or λ given)

in the scaled freedoms and forces of `Equilibrium`; displacements are measured in the elastic deformation of the
stiffest joint point or tie under the unit of force, so that stiffnesses are at most one. Unknowns are ordered
x = (q, r, λ). The tangent has the same sparsity pattern in every step, which is set up once as sums of joint points'
entries. Ties are points after those of the joints (`tied_law`). Supports that move add λ times their own jumps to those
of the blocks; λ is then prescribed, and there is no live load.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import qr
from scipy.sparse import block_diag, csc_array, csr_array, hstack, vstack

from runningbond.joints import PointLaw, PointResponse, static_law, wall_stiffness
from runningbond.limit.equilibrium import Equilibrium, equilibrium
from runningbond.limit.kinematics import jump_operator, movable_freedoms, pin_operator, tie_ends, tie_operator
from runningbond.limit.settlement import reaction_unit
from runningbond.scene import Array, Indices, Scene

from .dissection import Dissection, dissection
from .rows import Rows
from .tied_law import TiedLaw


@dataclass(frozen=True)
class Control:
    """The last equation: it prescribes the displacement f_live · q of the live load, or λ if `multiplier` is set."""

    value: float
    multiplier: bool = False


@dataclass(frozen=True, eq=False)
class StaticSystem:
    """Static equations of a scene."""

    equilibrium: Equilibrium  # scaled equilibrium of the blocks; ties are points after those of the joints
    law: PointLaw | TiedLaw  # scaled law of the joint points and ties
    length_unit: float  # displacement [m] that counts as 1
    support_jump: Array | None = None  # (2, np + nt) openings and slips due to moving supports, at λ = 1
    held: Array | float = 0.0  # (n_pins,) prescribed values of the pinned motions

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
        """Response of the joint points ``(np,)`` to unknowns ``(n,)``, after a plastic slip ``(np,)``."""
        jump = self._jump_of(x)
        if self.support_jump is not None:
            jump += x[-1] * self.support_jump
        return self.law(jump[0], jump[1], plastic_slip)

    def motion(self, x: Array) -> Array:
        """Motion of all blocks, ``(nb, 3)`` [m, m, rad], from unknowns ``(n,)``."""
        scene = self.equilibrium.scene
        motion = np.zeros(3 * len(scene.blocks)) if self.support_jump is None else x[-1] * scene.support_motion.ravel()
        motion[movable_freedoms(scene)] = x[: self.freedoms] * self.equilibrium.scale * self.length_unit
        return motion.reshape(-1, 3)

    def per_freedom(self, row: Array) -> Array:
        """Convert a row ``(3 nb,)`` per motion of the blocks [m, rad] to one per scaled freedom, ``(nd,)``."""
        system = self.equilibrium
        return np.asarray(row[movable_freedoms(system.scene)] * system.scale * self.length_unit)

    def unbalanced(self, x: Array, response: PointResponse, control: Control) -> Array:
        """Residual of all equations, ``(n,)``."""
        system, nd = self.equilibrium, self.freedoms
        q, reaction, multiplier = x[:nd], x[nd:-1], x[-1]
        pinned = self._pins.times(np.concatenate([reaction, q]))
        force = self._force_of(response.normal, response.tangential)
        force += pinned[:nd] - system.dead - multiplier * system.live
        last = multiplier if control.multiplier else dot(system.live, q)
        return np.concatenate([force, pinned[nd:] - self.held, [last - control.value]])

    def viscous(self, motion: Array) -> Array:
        """Forces ``(nd,)`` of dashpots proportional to the elastic stiffness of every joint point."""
        opening, slip = self._jump_of(motion)
        return self._force_of(self.law.normal_stiffness * opening, self.law.shear_stiffness * slip)

    def _jump_of(self, x: Array) -> Array:
        """Opening and slip of the joint points, ``(2, np)``, from the motion that begins the unknowns ``(n,)``."""
        return self._jumps.times(x[: self.freedoms]).reshape(2, -1)

    def _force_of(self, normal: Array, tangential: Array) -> Array:
        """Forces on the freedoms ``(nd,)`` from normal and tangential forces ``(np,)`` of the joint points."""
        opened, slid = self._forces.times(np.concatenate([normal, tangential])).reshape(2, -1)
        return np.asarray(opened + slid)

    def solve(self, tangent: Array, control: Control, right: Array) -> Array:
        """Solve the tangent equations.

        Parameters
        ----------
        tangent : (np, 2, 2) float
            Tangents of the joint points and ties.
        control
            The last equation.
        right : (n,) float
            Right-hand side.

        Raises
        ------
        numpy.linalg.LinAlgError
            If the tangent is exactly singular.
        """
        points, live = len(self._jump), self.equilibrium.live
        border = np.concatenate([live, np.zeros(self.unknowns - 1 - len(live))])
        given = control.multiplier and right[-1] == 0
        loads = [right[:-1], *([] if given else [border]), *([self._tie_ends] if len(tangent) > points else [])]
        # The bordering row and column of λ are eliminated by hand: q = a + λ b.
        solved = self._factors.solve(tangent[:points], np.column_stack(loads)).T
        if len(tangent) > points:
            solved = self._tied(tangent[points:, 0, 0], *np.split(solved, [1 if given else 2]))
        if given:
            return np.append(solved[0], 0.0)
        a, b = solved
        multiplier = right[-1] if control.multiplier else (right[-1] - dot(border, a)) / dot(border, b)
        return np.append(a + multiplier * b, multiplier)

    def _tied(self, tangent: Array, solved: Array, ends: Array) -> Array:
        """Solutions ``(k, n - 1)`` with ties of a tangent ``(nt,)``, from solutions with springs in their place.

        Ties couple distant blocks, which would make fronts large. Instead, a spring as stiff as the tie holds each of
        its ends to the ground: if the tied wall has a regular tangent, so has the wall with springs. The springs are
        then replaced by the ties (Woodbury), with the solutions ``(2 nt, n - 1)`` for unit forces at the ends.
        """
        far, spring = np.diag(tangent), np.diag(tangent - self.law.normal_stiffness[-len(tangent) :])
        change = np.block([[spring, far], [far, spring]])
        capacity = np.eye(len(ends)) + change @ (self._tie_ends.T @ ends.T)
        return np.asarray(solved - np.linalg.solve(capacity, change @ (self._tie_ends.T @ solved.T)).T @ ends)

    @cached_property
    def elastic(self) -> Array:
        """Tangent of the joint points before anything opens or slides, ``(np, 2, 2)``."""
        tangent = np.zeros((len(self.law.normal_stiffness), 2, 2))
        tangent[:, 0, 0], tangent[:, 1, 1] = self.law.normal_stiffness, self.law.shear_stiffness
        return tangent

    @cached_property
    def _jumps(self) -> Rows:
        """`opening` above `slip`, for one product: for a small wall, a call costs as much as the product itself."""
        return Rows.of(csr_array(vstack([self.opening, self.slip])))

    @cached_property
    def _forces(self) -> Rows:
        """Forces on the freedoms due to unit normal forces, then due to unit tangential forces, ``(2 nd, 2 np)``."""
        return Rows.of(block_diag([self.equilibrium.opening, self.equilibrium.slip], format="csr"))

    @cached_property
    def _pins(self) -> Rows:
        """Forces on the freedoms due to unit reactions, then displacements of pinned points per freedom."""
        return Rows.of(block_diag([self.equilibrium.reaction, self.equilibrium.reaction.T], format="csr"))

    @cached_property
    def _tie_ends(self) -> Array:
        """Forces on q and r of a unit pull at the first end of each tie, then at the second ends, ``(n − 1, 2 nt)``."""
        scene = self.equilibrium.scene
        ends = np.zeros((self.unknowns - 1, 2 * len(scene.ties)))
        ends[: self.freedoms] = _rows(self.equilibrium, tie_ends(scene)).toarray()
        return ends

    @cached_property
    def _constant(self) -> Array:
        """Constant entries: of the springs at the ties' ends, then twice those of C in the order of its columns."""
        pins = self.equilibrium.reaction.tocoo().data
        if len(self.equilibrium.scene.ties) == 0:
            return np.concatenate([pins, pins])
        own = np.take_along_axis(self._tie_ends, self._freedoms_of_ends.T, axis=0).T
        stiffness = np.tile(self.law.normal_stiffness[len(self._jump) :], 2)
        return np.concatenate([np.einsum("k,ki,kj->kij", stiffness, own, own).ravel(), pins, pins])

    @cached_property
    def _freedoms_of_ends(self) -> Indices:
        """Freedoms of the block at each end of a tie, ``(2 nt, 3)``; −1 at a held block or an anchor in space."""
        block = self.equilibrium.scene.ties.block.T.ravel()
        return np.where(block[:, None] >= 0, self._freedoms_of_blocks[block], -1)

    @cached_property
    def _freedoms_of_points(self) -> Indices:
        """Freedoms of the two blocks at each joint point, ``(np, 6)``; −1 where a block is held."""
        return self._freedoms_of_blocks[self.equilibrium.points.block].reshape(-1, 6)

    @cached_property
    def _freedoms_of_blocks(self) -> Indices:
        """Freedoms of each block, ``(nb, 3)``; −1 where it is held."""
        scene = self.equilibrium.scene
        first = np.full(len(scene.blocks), -1)
        first[~scene.fixed] = 3 * np.arange(np.count_nonzero(~scene.fixed))
        return np.where(first[:, None] >= 0, first[:, None] + np.arange(3), -1)

    @cached_property
    def _jump(self) -> Array:
        """Opening and slip of each joint point per freedom of its blocks, ``(np, 2, 6)``; zero for held blocks."""
        own = self._freedoms_of_points
        jump = np.zeros((len(own), 2, 6))
        for k, operator in enumerate((self.opening, self.slip)):
            entries = operator[: len(own)].tocoo()
            column = np.argmax(own[entries.row] == entries.col[:, None], axis=1)
            jump[entries.row, k, column] = entries.data
        return jump

    @cached_property
    def _factors(self) -> Dissection:
        """Dissection of the tangent: joint points' 6 × 6 tangents, springs at the ties' ends, and C twice."""
        nd, own, scene = self.freedoms, self._freedoms_of_points, self.equilibrium.scene
        pins, ends = self.equilibrium.reaction.tocoo(), self._freedoms_of_ends
        row = np.concatenate([np.repeat(own, 6, axis=1).ravel(), np.repeat(ends, 3, axis=1).ravel()])
        column = np.concatenate([np.tile(own, 6).ravel(), np.tile(ends, 3).ravel()])
        row, column = np.concatenate([row, pins.row, nd + pins.col]), np.concatenate([column, nd + pins.col, pins.row])
        position, home = scene.blocks.centroid[~scene.fixed], np.arange(nd + pins.shape[1]) // 3
        home[nd + pins.col] = pins.row // 3
        return dissection(row, column, home, position, self._jump, self._constant)


def _independent(pins: csc_array) -> csc_array:
    """Linearly independent pins: a block pinned at both corners has four pins, but only three motions."""
    if pins.shape[1] == 0:
        return pins
    _, triangle, order = qr(pins.toarray(), mode="economic", pivoting=True)
    size = np.abs(np.diag(triangle))
    return csc_array(pins[:, np.sort(order[: len(size)][size > 1e-9 * size[0]])])


def dot(one: Array, other: Array) -> float:
    """Scalar product, summed in a fixed order: a library's result differs in its last bits from machine to machine."""
    return float(np.einsum("i,i", one, other))


def _rows(system: Equilibrium, operator: csr_array) -> csc_array:
    """Convert an operator on the motion of all blocks ``(k, 3 nb)`` to forces on the scaled freedoms, ``(nd, k)``."""
    return csc_array(operator[:, movable_freedoms(system.scene)].T * system.scale[:, None])


def static_system(scene: Scene) -> StaticSystem:
    """Set up the static equations of a scene, without the pins that act only once the dead load is on.

    Raises
    ------
    SceneError
        If the joints have no stiffness, or a law without a tangent; for a support that moves under a weightless wall.
    """
    system, ties = equilibrium(scene), scene.ties
    system = replace(system, reaction=_independent(system.reaction))
    normal, shear = (k * system.points.area for k in wall_stiffness(scene, system.points.joint))
    # A single block held at both corners has no joint and does not move: any unit will do.
    stiffest = float(max(k.max(initial=0.0) for k in (normal, shear, ties.stiffness))) or 1.0
    length = system.force_unit / stiffest
    scale = length / system.force_unit
    joints = static_law(scene, system.strength, normal * scale, shear * scale)
    law: PointLaw | TiedLaw = joints
    if len(ties):
        forces = ties.yield_force / system.force_unit, ties.preload / system.force_unit
        law = TiedLaw(joints, ties.stiffness * scale, *forces)
        opening = csc_array(hstack([system.opening, system.tie]))
        slip = csc_array(hstack([system.slip, 0.0 * system.tie]))
        system = replace(system, opening=opening, slip=slip)
    support_jump = None
    if scene.settlement is not None:
        reaction_unit(scene)  # raises an error for a weightless wall
        system = replace(system, live=np.zeros(system.freedoms), live_unit=1.0)
        moved, jump = scene.support_motion.ravel() / length, jump_operator(system.points, scene.blocks.centroid)
        opened, slid = np.append(jump.opening @ moved, tie_operator(scene) @ moved), jump.slip @ moved
        support_jump = np.array([opened, np.append(slid, np.zeros(len(ties)))])
    return StaticSystem(system, law, length, support_jump)


def with_late_pins(system: StaticSystem, x: Array) -> tuple[StaticSystem, Array]:
    """Add pins that hold the displacements in unknowns ``(n,)``, and their reactions, zero so far, to the unknowns."""
    equations = system.equilibrium
    late = _rows(equations, pin_operator(equations.scene, equations.scene.late_pins))
    reaction = csc_array(hstack([equations.reaction, late]))
    held = np.append(np.zeros(equations.reaction.shape[1]), late.T @ x[: system.freedoms])
    more = replace(system, equilibrium=replace(equations, reaction=reaction), held=held)
    return more, np.insert(x, -1, np.zeros(late.shape[1]))
