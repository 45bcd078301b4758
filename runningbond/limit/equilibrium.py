"""Equilibrium of rigid blocks, without dimensions.

    B_nᵀ f_n + B_tᵀ f_t + Cᵀ r − λ f_live = f_dead

with point forces f (tension positive) and reactions r of pinned points. Lengths are measured in block sizes,
forces in the largest dead load (for a weightless wall, in the strongest joint point), each block's equations in its
share of the largest block, and the live load in its largest entry, so that a wall of any size, density and unit of
load gives the same numbers.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csc_array, csr_array

from runningbond.joints import JointPoints, PointStrength, wall_points, wall_strength
from runningbond.results import fastest_corner_by_one
from runningbond.scene import Array, Scene

from .kinematics import dead_load, jump_operator, live_load, movable_freedoms, pin_operator


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """The equilibrium equations of a scene's movable blocks, scaled.

    Parameters
    ----------
    scene, points
        The scene, and its contact points: the ends of every joint, moved in by the scene's inset.
    strength
        Strength of those points, in force units.
    opening, slip : (nd, np) sparse array
        Transposed jump operators of the movable degrees of freedom.
    reaction : (nd, n_pins) sparse array
        Transposed pin operator.
    dead, live : (nd,) float
        Loads.
    force_unit, live_unit : float
        Force [N] and multiplier λ that count as 1.
    scale : (nd,) float
        Factor of each equation: blocks count by their own weight, or a small one's balance would be lost in
        the solver's tolerance beside a large one, and moments by their own size.
    """

    scene: Scene
    points: JointPoints
    strength: PointStrength
    opening: csc_array
    slip: csc_array
    reaction: csc_array
    dead: Array
    live: Array
    force_unit: float
    live_unit: float
    scale: Array

    @property
    def freedoms(self) -> int:
        """Number of movable degrees of freedom."""
        return len(self.dead)

    def motion(self, multipliers: Array) -> Array:
        """Motion ``(nb, 3)`` [m, m, rad] from multipliers of equations ``(nd,)``; its fastest corner moves by 1 m."""
        motion = np.zeros(3 * len(self.scene.blocks))
        motion[movable_freedoms(self.scene)] = multipliers * self.scale
        return fastest_corner_by_one(self.scene.blocks, motion.reshape(-1, 3))

    def point_forces(self, pressure: Array, tangential: Array) -> Array:
        """Normal and tangential force at each point ``(np, 2)`` [N] from scaled ones, tension positive."""
        return self.force_unit * np.column_stack([self.strength.tension - pressure, tangential])

    def in_forces_of(self, unit: float) -> "Equilibrium":
        """The same equations, forces measured in so many of what counts as 1 here."""
        strength = PointStrength(self.strength.friction, self.strength.tension / unit, self.strength.shear / unit)
        dead, force_unit, live_unit = self.dead / unit, self.force_unit * unit, self.live_unit * unit
        return replace(self, strength=strength, dead=dead, force_unit=force_unit, live_unit=live_unit)

    def without_strength(self, load: Array) -> "Equilibrium":
        """The same blocks under another dead load, their joints dry."""
        nothing = np.zeros(len(self.points))
        return replace(self, dead=load, strength=PointStrength(self.strength.friction, nothing, nothing))


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
    force_unit = float(np.abs(dead).max()) or strength.strongest or live_size

    def rows(operator: csr_array) -> csc_array:
        return csc_array(operator[:, free].T * scale[:, None])

    return Equilibrium(
        scene,
        points,
        PointStrength(strength.friction, strength.tension / force_unit, strength.shear / force_unit),
        rows(jump.opening),
        rows(jump.slip),
        rows(pin_operator(scene)),
        dead / force_unit,
        live / live_size,
        force_unit,
        force_unit / live_size,
        scale,
    )
