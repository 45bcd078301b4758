"""One frame of a run: the motion of the blocks of a wall and the state of its joint points at one moment."""

from dataclasses import dataclass, field, replace

import numpy as np

from runningbond.contacts.search import ContactForces
from runningbond.joints import JointPoints, wall_points
from runningbond.scene import Array, Indices, Scene, frozen


@dataclass(frozen=True, eq=False)
class Triangles:
    """Finite elements of the blocks: nodes ``(nn, 2)`` [m], node indices ``(nt, 3)`` and block of each triangle."""

    points: Array
    corners: Indices
    block: Indices


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A wall, its joint points, and the finite elements of its blocks; None for rigid blocks."""

    scene: Scene
    points: JointPoints
    triangles: Triangles | None = None

    @classmethod
    def of_rigid_blocks(cls, scene: Scene) -> "Discretisation":
        """Discretise a scene into rigid blocks with contact points at the ends of their joints."""
        return cls(scene, wall_points(scene))


@dataclass(frozen=True, eq=False)
class Frame:
    """One moment of a wall; joint points are those of its `Discretisation`, in the same order.

    Parameters
    ----------
    multiplier
        λ.
    motion : (nb, 3) float
        Displacement of each block's centroid [m] and rotation [rad]; in a mechanism the fastest corner moves by 1 m.
    opening, slip : (np,) float
        Jumps [m] along the normal and the tangent, which rotate with block a.
    normal, tangential : (np,) float
        Tractions [Pa], tension positive, along the normal and the tangent of the side that carries the contact.
    state : (np,) int
        A `JointState` each.
    velocity : (nb, 3) float
        Velocity of the centroid [m/s] and of rotation [rad/s]; zero if not given.
    damage : (np,) float
        0 sound … 1 broken; zero if not given.
    displacement : (nn, 2) float
        Displacement of the nodes of the triangles [m]; empty for rigid blocks.
    sides : (2, np, 2) float
        Displacement of the joint points on block a and on block b [m]; empty for rigid blocks.
    stress : (nt, 3) float
        σ_x, σ_y, τ_xy of the triangles [Pa]; empty for rigid blocks.
    time
        Time since the ground motion began [s]; None without a ground motion.
    new_contacts
        Contacts made since the wall was built, with their forces; they are no joint points.
    traction : (np, 2) float
        Tractions along x and y [Pa], tension positive; empty if they have the directions of undeformed joints.
    finite
        Whether the rotations of blocks are finite, instead of linearised.
    """

    multiplier: float
    motion: Array
    opening: Array
    slip: Array
    normal: Array
    tangential: Array
    state: Indices
    velocity: Array = field(default_factory=lambda: np.zeros((0, 3)))
    damage: Array = field(default_factory=lambda: np.zeros(0))
    displacement: Array = field(default_factory=lambda: np.zeros((0, 2)))
    sides: Array = field(default_factory=lambda: np.zeros((0, 0, 2)))
    stress: Array = field(default_factory=lambda: np.zeros((0, 3)))
    time: float | None = None
    traction: Array = field(default_factory=lambda: np.zeros((0, 2)))
    new_contacts: ContactForces = field(default_factory=ContactForces)
    finite: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "state", frozen(self.state, np.int64))
        velocity = self.velocity if len(self.velocity) else np.zeros_like(self.motion)
        object.__setattr__(self, "velocity", velocity)
        object.__setattr__(self, "damage", self.damage if len(self.damage) else np.zeros(len(self.state)))

    def scaled(self, factor: float) -> "Frame":
        """Return the same moment with all displacements and jumps multiplied by a factor."""
        return replace(
            self,
            motion=factor * self.motion,
            opening=factor * self.opening,
            slip=factor * self.slip,
            displacement=factor * self.displacement,
            sides=factor * self.sides,
        )
