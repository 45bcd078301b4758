"""One frame of a run: where the blocks of a wall are, and what its joint points do."""

from dataclasses import dataclass, field, replace

import numpy as np

from runningbond.joints import JointPoints, wall_points
from runningbond.scene import Array, Indices, Scene, frozen


@dataclass(frozen=True, eq=False)
class Triangles:
    """Finite elements of the blocks: nodes ``(nn, 2)`` [m], the nodes of each triangle ``(nt, 3)`` and its block."""

    points: Array
    corners: Indices
    block: Indices


@dataclass(frozen=True, eq=False)
class Discretisation:
    """A wall, its joint points, and the finite elements of its blocks, None for rigid ones."""

    scene: Scene
    points: JointPoints
    triangles: Triangles | None = None

    @classmethod
    def of_rigid_blocks(cls, scene: Scene) -> "Discretisation":
        """Rigid blocks with contact points at the ends of their joints."""
        return cls(scene, wall_points(scene))


@dataclass(frozen=True, eq=False)
class Frame:
    """One moment of a wall; joint points are those of its `Discretisation`, in that order.

    Parameters
    ----------
    multiplier
        λ.
    motion : (nb, 3) float
        Displacement of each block's centroid [m] and rotation [rad], for a mechanism per motion of the fastest corner.
    opening, slip : (np,) float
        Jumps [m], along the normal and the tangent that turn with block a.
    normal, tangential : (np,) float
        Tractions [Pa], tension positive, along the normal and the tangent of the side that bears.
    state : (np,) int
        A `JointState` each.
    velocity : (nb, 3) float
        Of the centroid [m/s] and of rotation [rad/s]; zero where none is given.
    damage : (np,) float
        0 sound … 1 broken; zero where none is given.
    displacement : (nn, 2) float
        Of the nodes of the triangles [m]; empty for rigid blocks.
    stress : (nt, 3) float
        σ_x, σ_y, τ_xy of those triangles [Pa]; empty without them.
    time
        Since the motion of the ground began [s]; None where there is none.
    traction : (np, 2) float
        Tractions along x and y [Pa], tension positive; empty where they have the directions of undeformed joints.
    finite
        Whether blocks turn by their rotation, and not to first order.
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
    stress: Array = field(default_factory=lambda: np.zeros((0, 3)))
    time: float | None = None
    traction: Array = field(default_factory=lambda: np.zeros((0, 2)))
    finite: bool = False

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
