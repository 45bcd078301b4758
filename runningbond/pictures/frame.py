"""One moment of a wall: where its blocks are, and what its joint points do."""

from dataclasses import dataclass, field, replace
from enum import IntEnum

import numpy as np

from runningbond.joints import JointPoints, joint_stiffness, wall_points
from runningbond.joints.mohr_coulomb import truncated_cone
from runningbond.results.mechanism import rigid_jumps
from runningbond.results.outcome import Outcome
from runningbond.scene import Array, Indices, Scene, frozen

VISIBLE = 0.01
"""Jump of a mechanism, in motions of its fastest corner, below which it is not worth showing."""

AT_THE_LIMIT = 1e-3
"""Shear below the strength, relative to it, that counts as sliding."""


class State(IntEnum):
    """What a joint point does; the numbers are those in files."""

    STICK = 0
    SLIDE = 1
    OPEN = 2
    FAILED = 3
    """Neither slides nor is open, but its bond is spent (damage 1)."""


@dataclass(frozen=True, eq=False)
class Triangles:
    """Finite elements of the blocks.

    Parameters
    ----------
    points : (nn, 2) float
        Nodes [m].
    corners : (nt, 3) int
        Nodes of each triangle.
    block : (nt,) int
        Its block.
    """

    points: Array
    corners: Indices
    block: Indices


@dataclass(frozen=True, eq=False)
class Stage:
    """What frames are frames of.

    Parameters
    ----------
    scene
        The wall.
    points
        Its joint points.
    triangles
        Finite elements where blocks deform; None for rigid ones.
    """

    scene: Scene
    points: JointPoints
    triangles: Triangles | None = None

    @classmethod
    def of_rigid_blocks(cls, scene: Scene) -> "Stage":
        """Rigid blocks with contact points at the ends of their joints."""
        return cls(scene, wall_points(scene))


def _none(columns: int = 0) -> Array:
    return np.zeros((0, columns) if columns else 0)


@dataclass(frozen=True, eq=False)
class Frame:
    """One moment of a wall; joint points are those of its `Stage`, in that order.

    Parameters
    ----------
    multiplier
        λ.
    motion : (nb, 3) float
        Displacement of each block's centroid [m] and rotation [rad], for a mechanism per motion of the fastest corner.
    opening, slip : (np,) float
        Jumps [m].
    normal, tangential : (np,) float
        Tractions [Pa], tension positive.
    state : (np,) int
        A `State` each.
    velocity : (nb, 3) float
        Of the centroid [m/s] and of rotation [rad/s]; zero where none is given.
    damage : (np,) float
        0 sound … 1 broken; zero where none is given.
    displacement : (nn, 2) float
        Of the nodes of the stage's triangles [m]; empty for rigid blocks.
    stress : (nt, 3) float
        σ_x, σ_y, τ_xy of those triangles [Pa]; empty without them.
    """

    multiplier: float
    motion: Array
    opening: Array
    slip: Array
    normal: Array
    tangential: Array
    state: Indices
    velocity: Array = field(default_factory=lambda: _none(3))
    damage: Array = field(default_factory=_none)
    displacement: Array = field(default_factory=lambda: _none(2))
    stress: Array = field(default_factory=lambda: _none(3))

    def __post_init__(self) -> None:
        object.__setattr__(self, "state", frozen(self.state, np.int64))
        velocity = self.velocity if len(self.velocity) else np.zeros_like(self.motion)
        object.__setattr__(self, "velocity", velocity)
        object.__setattr__(self, "damage", self.damage if len(self.damage) else np.zeros(len(self.state)))

    def scaled(self, factor: float) -> "Frame":
        """The same moment, everything having moved so many times as far."""
        return replace(
            self,
            motion=factor * self.motion,
            opening=factor * self.opening,
            slip=factor * self.slip,
            displacement=factor * self.displacement,
        )


def mechanism_frame(scene: Scene, outcome: Outcome) -> Frame | None:
    """The mechanism of an outcome, its fastest corner moving by one metre; None where it has none.

    Tractions are those under the load at which it was found, or zero where the outcome lists none for the two points
    of each joint that rigid blocks have.
    """
    if len(outcome.motion) != len(scene.blocks):
        return None
    points = wall_points(scene)
    opening, slip = rigid_jumps(scene.blocks, points, outcome.motion)
    known = len(outcome.force) == len(points)
    traction = outcome.force / points.area[:, None] if known else np.zeros((len(points), 2))
    state = states_of_mechanism(scene, points, opening, slip)
    multiplier = outcome.multiplier if outcome.multiplier is not None else outcome.upper or 0.0
    return Frame(multiplier, outcome.motion, opening, slip, traction[:, 0], traction[:, 1], state)


def states_of_mechanism(scene: Scene, points: JointPoints, opening: Array, slip: Array) -> Indices:
    """States of joint points ``(np,)`` by the jumps of a mechanism whose fastest corner moves by one metre.

    A joint opens if it does so by more than an associated one dilates when it slides, tan φ times the slip. So limit
    analysis and models without dilatancy are told by one rule.
    """
    friction = np.array([material.friction for material in scene.joint_materials])
    dilation = friction[scene.material_of_joint[points.joint]] * np.abs(slip)
    opens = opening > dilation + VISIBLE
    slides = np.abs(slip) > VISIBLE
    return np.select([opens, slides], [State.OPEN, State.SLIDE], State.STICK)


def states_of_points(
    scene: Scene, points: JointPoints, opening: Array, normal: Array, tangential: Array, damage: Array
) -> Indices:
    """States of joint points ``(np,)`` by their jumps [m], tractions [Pa] and damage.

    Open is what has opened beyond what tension can stretch it; the joints of the scene need a stiffness.
    """
    cones = [(*truncated_cone(material), joint_stiffness(material).normal) for material in scene.joint_materials]
    friction, tension, shear, stiffness = np.array(cones)[scene.material_of_joint[points.joint]].T
    sound = 1 - damage
    strength = sound * shear + friction * np.maximum(0.0, sound * tension - normal)
    opens = opening > np.where(damage < 1, tension / stiffness, 0.0) * (1 + 1e-9)
    slides = np.abs(tangential) >= (1 - AT_THE_LIMIT) * strength
    kinds = [State.OPEN, State.SLIDE, State.FAILED]
    return np.select([opens, slides, damage >= 1], kinds, State.STICK)
