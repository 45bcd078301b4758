"""Equilibrium equations of rigid blocks in dimensionless form.

    B_nᵀ f_n + B_tᵀ f_t + Eᵀ N + Cᵀ r − λ f_live = f_dead

with point forces f (tension positive), pulls 0 ≤ N ≤ yield force of ties and reactions r of pinned points. Preload and
stiffness of a tie do not influence what it can carry. Lengths are measured in block sizes, forces in the largest dead
load (for a weightless wall, in the strongest joint point or tie), the live load in its largest entry, and each block's
equations in its share of the largest block's area. So size, density and unit of load do not change the numbers.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array, csr_array, hstack, vstack

from runningbond.joints import JointPoints, PointStrength, wall_points, wall_strength
from runningbond.results import fastest_corner_by_one
from runningbond.scene import Array, Scene

from .crushing import Crushing, crushing
from .kinematics import dead_load, jump_operator, live_load, movable_freedoms, pin_operator, tie_operator
from .settlement import largest_displacement, reaction_unit


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """The equilibrium equations of a scene's movable blocks, scaled.

    Parameters
    ----------
    scene, points
        The scene, and its contact points: the ends of every joint, moved inwards by the scene's inset.
    strength
        Strength of the contact points, in force units.
    opening, slip : (nd, np) sparse array
        Transposed jump operators of the movable degrees of freedom.
    reaction : (nd, n_pins) sparse array
        Transposed pin operator.
    tie : (nd, nt) sparse array
        Transposed elongation operator of ties.
    tie_yield : (nt,) float
        Yield forces of ties, in force units.
    dead, live : (nd,) float
        Loads.
    force_unit, live_unit : float
        Force [N] and multiplier λ that count as 1.
    scale : (nd,) float
        Factor of each equation, from the block's area relative to the largest and, for moments, also its size; without
        it the solver's tolerance would hide the balance of small blocks beside large ones.
    crushing
        Joints of finite compressive strength, if they are taken into account (`with_crushing`).
    """

    scene: Scene
    points: JointPoints
    strength: PointStrength
    opening: csc_array
    slip: csc_array
    reaction: csc_array
    tie: csc_array
    tie_yield: Array
    dead: Array
    live: Array
    force_unit: float
    live_unit: float
    scale: Array
    crushing: Crushing | None = None

    @property
    def freedoms(self) -> int:
        """Number of movable degrees of freedom."""
        return len(self.dead)

    @property
    def has_support(self) -> bool:
        """Whether the last equation is that of a moving support."""
        return self.freedoms > len(movable_freedoms(self.scene))

    @property
    def least(self) -> float:
        """Lower bound of the multiplier: zero for loads, which keep their sense; −inf for moving supports."""
        return -np.inf if self.has_support else 0.0

    def load(self, multiplier: float) -> float:
        """λ of the scene from a multiplier: a moving support's share of the dead load, or a load of at least zero."""
        return self.live_unit * (0.0 - multiplier if self.has_support else max(0.0, multiplier))

    def motion(self, multipliers: Array) -> Array:
        """Motion ``(nb, 3)`` [m, m, rad] from multipliers of equations ``(nd,)``; its fastest corner moves by 1 m."""
        free, moved = movable_freedoms(self.scene), multipliers * self.scale
        motion = np.zeros(3 * len(self.scene.blocks))
        motion[free] = moved[: len(free)]
        if self.has_support:
            motion += moved[-1] * unit_support_motion(self.scene)
        return fastest_corner_by_one(self.scene.blocks, motion.reshape(-1, 3))

    @cached_property
    def _rates(self) -> tuple[csr_array, csr_array, csr_array]:
        """Opening and slip rates of points and elongation rates of ties per multiplier of an equation."""
        return self.opening.T, self.slip.T, self.tie.T

    def jumps(self, multipliers: Array) -> tuple[Array, Array]:
        """Opening and slip rates of points, ``(np,)`` each, from multipliers of equations ``(nd,)``."""
        opening, slip, _ = self._rates
        return opening @ multipliers, slip @ multipliers

    def elongation(self, multipliers: Array) -> Array:
        """Elongation rates of ties, ``(nt,)``, from multipliers of equations ``(nd,)``."""
        return np.asarray(self._rates[2] @ multipliers)

    def with_crushing(self) -> "Equilibrium":
        """The same equations with crushing joints; without dead load the strongest such joint is the force unit."""
        if self.dead.any():
            return replace(self, crushing=crushing(self.scene, self.force_unit))
        joints = crushing(self.scene, self.force_unit, np.inf)
        if joints is None:
            return self
        system = self.in_forces_of(float(joints.strength.max()))
        return replace(system, crushing=crushing(self.scene, system.force_unit))

    def crushed_jumps(self, motion: Array) -> Array:
        """Openings of both ends and slip of crushing joints, ``(3, nc)``, from multipliers of equations ``(nd,)``."""
        if self.crushing is None:
            return np.zeros((3, 0))
        ends = self.crushing.ends
        opening, slip = self.jumps(motion)
        return np.array([*opening[ends], slip[ends[0]]])

    def dissipation(self, motion: Array) -> Array:
        """Largest power ``(np,)`` of admissible forces at each point on a mechanism ``(nd,)``.

        That of a crushing joint is assigned to its first point. Other points have to obey the flow rule.
        """
        found = self.strength.dissipation(*self.jumps(motion))
        if self.crushing is not None:
            found[self.crushing.ends[1]] = 0.0
            found[self.crushing.ends[0]] = self.crushing.dissipation(self.crushed_jumps(motion))
        return found

    def dissipated(self, motion: Array) -> float:
        """Largest power of admissible forces of joints and ties on a mechanism ``(nd,)``."""
        return float(self.dissipation(motion).sum() + self.tie_yield @ self.elongation(motion).clip(min=0.0))

    def kinematic_multiplier(self, motion: Array) -> float:
        """Multiplier at which the loads' power equals the dissipation of a mechanism's joints and ties; scaled."""
        return float((self.dissipated(motion) - self.dead @ motion) / (self.live @ motion))

    def in_forces_of(self, unit: float) -> "Equilibrium":
        """The same equations with a force unit that is `unit` times as large."""
        strength = PointStrength(self.strength.friction, self.strength.tension / unit, self.strength.shear / unit)
        dead, force_unit, live_unit = self.dead / unit, self.force_unit * unit, self.live_unit * unit
        pull = self.tie_yield / unit
        return replace(self, strength=strength, tie_yield=pull, dead=dead, force_unit=force_unit, live_unit=live_unit)

    def without_strength(self, load: Array) -> "Equilibrium":
        """The same blocks under another dead load, with dry joints and without ties."""
        nothing = np.zeros(len(self.points))
        strength = PointStrength(self.strength.friction, nothing, nothing)
        return replace(self, dead=load, strength=strength, tie_yield=np.zeros_like(self.tie_yield))

    def under_dead_load(self) -> "Equilibrium":
        """The same equations without what `under_live_load` adds to them."""
        n = len(movable_freedoms(self.scene))
        parts = {name: getattr(self, name)[:n] for name in ("opening", "slip", "tie", "dead", "live", "scale")}
        return replace(self, reaction=self.reaction[:n, : len(self.scene.pins)], **parts)

    def under_live_load(self) -> "Equilibrium":
        """The equations while λ grows: with motions held under the live load only, and with a moving support.

        A moving support adds an equation, the virtual work of the forces on it per unit displacement. Its live load is
        the resultant of the dead load, and the multiplier the share of it that drives the support along its motion;
        the support carries the negative of this share (`load`).
        """
        scene, late = self.scene, self.scene.late_pins
        system = self
        if len(late):
            held = pin_operator(scene, late)[:, movable_freedoms(scene)].T * self.scale[:, None]
            system = replace(self, reaction=csc_array(hstack([self.reaction, held])))
        if scene.settlement is None:
            return system
        motion, jump = unit_support_motion(scene), jump_operator(self.points, scene.blocks.centroid)

        def extended(rows: csc_array, last: Array) -> csc_array:
            return csc_array(vstack([rows, csc_array(last[None])]))

        return replace(
            system,
            opening=extended(self.opening, jump.opening @ motion),
            slip=extended(self.slip, jump.slip @ motion),
            tie=extended(self.tie, tie_operator(scene) @ motion),
            reaction=extended(system.reaction, np.zeros(system.reaction.shape[1])),
            dead=np.append(self.dead, 0.0),
            live=np.append(self.live, 1.0),
            live_unit=self.force_unit * largest_displacement(scene) / reaction_unit(scene),
            scale=np.append(self.scale, 1.0),
        )


def unit_support_motion(scene: Scene) -> Array:
    """Motion of moving supports, ``(3 nb,)``, scaled to a largest displacement of 1 m at the ends of joints on them."""
    return np.asarray(scene.support_motion.ravel() / largest_displacement(scene))


def equilibrium(scene: Scene) -> Equilibrium:
    """Set up the equilibrium equations of a scene."""
    points = wall_points(scene)
    strength = wall_strength(scene, points)
    jump = jump_operator(points, scene.blocks.centroid)
    free = movable_freedoms(scene)
    area = scene.blocks.area[~scene.fixed]
    share = area / area.max()
    scale = np.column_stack([1 / share, 1 / share, 1 / (share * np.sqrt(area))]).ravel()

    dead, live = dead_load(scene)[free] * scale, live_load(scene)[free] * scale
    live_size = float(np.abs(live).max()) or 1.0
    pull = scene.ties.yield_force
    force_unit = float(np.abs(dead).max()) or max(strength.strongest, pull.max(initial=0.0)) or live_size

    def rows(operator: csr_array) -> csc_array:
        return csc_array(operator[:, free].T * scale[:, None])

    return Equilibrium(
        scene,
        points,
        PointStrength(strength.friction, strength.tension / force_unit, strength.shear / force_unit),
        rows(jump.opening),
        rows(jump.slip),
        rows(pin_operator(scene)),
        rows(tie_operator(scene)),
        pull / force_unit,
        dead / force_unit,
        live / live_size,
        force_unit,
        force_unit / live_size,
        scale,
    )
