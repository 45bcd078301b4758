"""Rigid blocks on elastic joint points: residual and tangent of the static equations, and their solution.

    B_nᵀ N + B_tᵀ S + Cᵀ r − f_dead − λ f_live = 0,    C q = c,    f_live · q = d  (or λ given)

in the scaled freedoms and forces of `Equilibrium`; displacements are measured in the elastic length that the unit
of force makes of the stiffest joint point, so that stiffnesses, too, are of order one. Unknowns are ordered
x = (q, r, λ). The tangent has the same pattern in every step: its entries are found once as sums of joint points'
entries. Ties are points after those of the joints (`tied_law`). Supports that move add λ times their own jumps to those
of the blocks; then λ is given, and nothing is a live load.
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
    """The last equation: the live load's displacement f_live · q, or λ where `multiplier`, has this value."""

    value: float
    multiplier: bool = False


@dataclass(frozen=True, eq=False)
class StaticSystem:
    """The static equations of a scene."""

    equilibrium: Equilibrium  # scaled equilibrium of its blocks; its ties are points after those of the joints
    law: PointLaw | TiedLaw  # law of its joint points and ties, scaled
    length_unit: float  # displacement [m] that counts as 1
    support_jump: Array | None = None  # (2, np) openings and slips that supports make at λ = 1
    held: Array | float = 0.0  # (n_pins,) what the pinned motions are

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
        jump = self._jump_of(x)
        if self.support_jump is not None:
            jump += x[-1] * self.support_jump
        return self.law(jump[0], jump[1], plastic_slip)

    def motion(self, x: Array) -> Array:
        """Motion of all blocks, ``(nb, 3)`` [m, m, rad], that unknowns ``(n,)`` stand for."""
        scene = self.equilibrium.scene
        motion = np.zeros(3 * len(scene.blocks)) if self.support_jump is None else x[-1] * scene.support_motion.ravel()
        motion[movable_freedoms(scene)] = x[: self.freedoms] * self.equilibrium.scale * self.length_unit
        return motion.reshape(-1, 3)

    def per_freedom(self, row: Array) -> Array:
        """A row ``(3 nb,)`` per motion of the blocks [m, rad] as one per scaled freedom, ``(nd,)``."""
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
        """Forces ``(nd,)`` of dashpots in proportion to the elastic stiffness of every joint point."""
        opening, slip = self._jump_of(motion)
        return self._force_of(self.law.normal_stiffness * opening, self.law.shear_stiffness * slip)

    def _jump_of(self, x: Array) -> Array:
        """Opening and slip of the joint points in a motion, the first of unknowns ``(n,)``; ``(2, np)``."""
        return self._jumps.times(x[: self.freedoms]).reshape(2, -1)

    def _force_of(self, normal: Array, tangential: Array) -> Array:
        """Forces on the freedoms ``(nd,)`` of forces ``(np,)`` of the joint points."""
        opened, slid = self._forces.times(np.concatenate([normal, tangential])).reshape(2, -1)
        return np.asarray(opened + slid)

    def solve(self, tangent: Array, control: Control, right: Array) -> Array:
        """Solve the tangent equations.

        Parameters
        ----------
        tangent : (np, 2, 2) float
            Of the joint points and ties.
        control
            Which equation is the last.
        right : (n,) float
            Right-hand side.

        Raises
        ------
        numpy.linalg.LinAlgError
            For a tangent that is singular to the last bit.
        """
        points, live = len(self._jump), self.equilibrium.live
        border = np.concatenate([live, np.zeros(self.unknowns - 1 - len(live))])
        given = control.multiplier and right[-1] == 0
        loads = [right[:-1], *([] if given else [border]), *([self._tie_ends] if len(tangent) > points else [])]
        # The border of λ is eliminated by hand: q = a + λ b.
        solved = self._factors.solve(tangent[:points], np.column_stack(loads)).T
        if len(tangent) > points:
            solved = self._tied(tangent[points:, 0, 0], *np.split(solved, [1 if given else 2]))
        if given:
            return np.append(solved[0], 0.0)
        a, b = solved
        multiplier = right[-1] if control.multiplier else (right[-1] - dot(border, a)) / dot(border, b)
        return np.append(a + multiplier * b, multiplier)

    def _tied(self, tangent: Array, solved: Array, ends: Array) -> Array:
        """Solutions ``(k, n - 1)`` with ties of a tangent ``(nt,)`` from those with springs in their place.

        Ties couple what lies far apart, and fronts would be as large. Each of a tie's ends is a spring to the ground
        instead, as stiff as the tie: where the tied wall has a regular tangent, so has that one. In the springs' stead
        come the ties (Woodbury), by the solutions ``(2 nt, n - 1)`` for unit forces at the ends.
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
        """`opening`, then `slip`: two products cost little more than one, and each call as much as a small wall's."""
        return Rows.of(csr_array(vstack([self.opening, self.slip])))

    @cached_property
    def _forces(self) -> Rows:
        """Forces on the freedoms of unit normal forces, then those of unit tangential ones, ``(2 nd, 2 np)``."""
        return Rows.of(block_diag([self.equilibrium.opening, self.equilibrium.slip], format="csr"))

    @cached_property
    def _pins(self) -> Rows:
        """Forces on the freedoms of unit reactions, then displacements of pinned points per freedom."""
        return Rows.of(block_diag([self.equilibrium.reaction, self.equilibrium.reaction.T], format="csr"))

    @cached_property
    def _tie_ends(self) -> Array:
        """Forces on all but λ of a unit pull at each first, then each second end of a tie, ``(n − 1, 2 nt)``."""
        scene = self.equilibrium.scene
        ends = np.zeros((self.unknowns - 1, 2 * len(scene.ties)))
        ends[: self.freedoms] = _rows(self.equilibrium, tie_ends(scene)).toarray()
        return ends

    @cached_property
    def _constant(self) -> Array:
        """Entries of the springs at the ties' ends, then of C in the order of its columns, twice."""
        pins = self.equilibrium.reaction.tocoo().data
        if len(self.equilibrium.scene.ties) == 0:
            return np.concatenate([pins, pins])
        own = np.take_along_axis(self._tie_ends, self._freedoms_of_ends.T, axis=0).T
        stiffness = np.tile(self.law.normal_stiffness[len(self._jump) :], 2)
        return np.concatenate([np.einsum("k,ki,kj->kij", stiffness, own, own).ravel(), pins, pins])

    @cached_property
    def _freedoms_of_ends(self) -> Indices:
        """Freedoms of the block at each end of a tie, ``(2 nt, 3)``; −1 where none moves."""
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
        """Opening and slip of each joint point per own freedom, ``(np, 2, 6)``; zero where a block is held."""
        own = self._freedoms_of_points
        jump = np.zeros((len(own), 2, 6))
        for k, operator in enumerate((self.opening, self.slip)):
            entries = operator[: len(own)].tocoo()
            column = np.argmax(own[entries.row] == entries.col[:, None], axis=1)
            jump[entries.row, k, column] = entries.data
        return jump

    @cached_property
    def _factors(self) -> Dissection:
        """Where the entries of the tangent go: the joint points' 6 × 6 tangents, the springs at ties' ends, C twice."""
        nd, own, scene = self.freedoms, self._freedoms_of_points, self.equilibrium.scene
        pins, ends = self.equilibrium.reaction.tocoo(), self._freedoms_of_ends
        row = np.concatenate([np.repeat(own, 6, axis=1).ravel(), np.repeat(ends, 3, axis=1).ravel()])
        column = np.concatenate([np.tile(own, 6).ravel(), np.tile(ends, 3).ravel()])
        row, column = np.concatenate([row, pins.row, nd + pins.col]), np.concatenate([column, nd + pins.col, pins.row])
        position, home = scene.blocks.centroid[~scene.fixed], np.arange(nd + pins.shape[1]) // 3
        home[nd + pins.col] = pins.row // 3
        return dissection(row, column, home, position, self._jump, self._constant)


def _independent(pins: csc_array) -> csc_array:
    """Pins that do not follow from others: a block pinned at both corners has four, and three motions."""
    if pins.shape[1] == 0:
        return pins
    _, triangle, order = qr(pins.toarray(), mode="economic", pivoting=True)
    size = np.abs(np.diag(triangle))
    return csc_array(pins[:, np.sort(order[: len(size)][size > 1e-9 * size[0]])])


def dot(one: Array, other: Array) -> float:
    """Scalar product, summed in one order: that of a library differs in its last bits from machine to machine."""
    return float(np.einsum("i,i", one, other))


def _rows(system: Equilibrium, operator: csr_array) -> csc_array:
    """An operator on the motion of all blocks ``(k, 3 nb)`` as forces on the scaled freedoms, ``(nd, k)``."""
    return csc_array(operator[:, movable_freedoms(system.scene)].T * system.scale[:, None])


def static_system(scene: Scene) -> StaticSystem:
    """Set up the static equations of a scene, without what is held only once its dead load is on.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness, or a law that has no tangent; for a support under a weightless wall.
    """
    system, ties = equilibrium(scene), scene.ties
    system = replace(system, reaction=_independent(system.reaction))
    normal, shear = (k * system.points.area for k in wall_stiffness(scene, system.points.joint))
    # A single block held at both corners has no joint, and does not move.
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
        reaction_unit(scene)  # refuses a wall that nothing moves
        system = replace(system, live=np.zeros(system.freedoms), live_unit=1.0)
        moved, jump = scene.support_motion.ravel() / length, jump_operator(system.points, scene.blocks.centroid)
        opened, slid = np.append(jump.opening @ moved, tie_operator(scene) @ moved), jump.slip @ moved
        support_jump = np.array([opened, np.append(slid, np.zeros(len(ties)))])
    return StaticSystem(system, law, length, support_jump)


def with_late_pins(system: StaticSystem, x: Array) -> tuple[StaticSystem, Array]:
    """Hold what is held once the dead load is on as it is in unknowns ``(n,)``; they with the further reactions."""
    equations = system.equilibrium
    late = _rows(equations, pin_operator(equations.scene, equations.scene.late_pins))
    reaction = csc_array(hstack([equations.reaction, late]))
    held = np.append(np.zeros(equations.reaction.shape[1]), late.T @ x[: system.freedoms])
    more = replace(system, equilibrium=replace(equations, reaction=reaction), held=held)
    return more, np.insert(x, -1, np.zeros(late.shape[1]))
