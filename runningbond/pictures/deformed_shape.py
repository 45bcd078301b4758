"""The deformed shape of a wall, as polygons of its blocks and of its joints' gaps: what every picture is drawn from."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from runningbond.results.mechanism import carried
from runningbond.scene import Array, Indices, Mask, Scene

from .joint_state import JointState, joint_states
from .style import AT_REST, COURSES, DRAWN, FASTEST, HELD, SEEN, STATE_COLOURS, Colouring

Extent: TypeAlias = tuple[float, float, float, float]
"""A part of the plane: left, right, bottom and top [m]."""


@dataclass(frozen=True, eq=False)
class DeformedShape:
    """Where the blocks and joints of a wall are at one moment, and how that is to be drawn.

    Parameters
    ----------
    scene
        The wall.
    points, displacement : (n, 2) float
        Corners of one polygon after another, counter-clockwise, before they move [m], and their displacement [m].
    first : (nc + 1,) int
        Where each polygon's corners start. A polygon is a block, or one of its triangles.
    block : (nc,) int
        Block of each polygon; the ground is left out.
    edges : (ne, 2) int
        Corners at the ends of the blocks' edges.
    faces, face_displacement : (nf, 4, 2) float
        Corners of each joint's gap before they move [m], along block a's side and back along b's, and their
        displacement [m].
    state : (nf,) int
        A `JointState` each.
    multiplier, scale
        λ, and the factor of displacements in the drawing.
    colouring
        How blocks are coloured.
    crushed : (nf, 2) bool
        Whether each joint is crushed at its ends; empty where none is.
    motion : (nb, 3) float
        Motion of each block, of which that of supports is drawn; empty where these rest.
    time
        Since the motion of the ground began [s]; None where there is none.
    """

    scene: Scene
    points: Array
    displacement: Array
    first: Indices
    block: Indices
    edges: Indices
    faces: Array
    face_displacement: Array
    state: Indices
    multiplier: float
    scale: float
    colouring: Colouring = "displacement"
    motion: Array = field(default_factory=lambda: np.zeros((0, 3)))
    crushed: Mask = field(default_factory=lambda: np.zeros((0, 2), np.bool_))
    time: float | None = None

    @classmethod
    def of_rigid_blocks(cls, scene: Scene, motion: Array, state: Indices, multiplier: float) -> "DeformedShape":
        """Blocks that move by ``(nb, 3)`` [m, m, rad], displacements made visible.

        The largest is that of the wall or, where these move farther, of its supports. States are those of joints
        ``(nj,)`` or of their ends ``(nj, 2)``.
        """
        blocks, joints = scene.blocks, scene.joints
        own = scene.wall[blocks.owner]
        displacement = carried(blocks, blocks.owner, blocks.vertices, motion)[own]
        first = np.concatenate([[0], np.cumsum(np.diff(blocks.first)[scene.wall])])
        faces = joints.ends[:, [0, 1, 1, 0]]
        sides = joints.block[:, [0, 0, 1, 1]]
        moved = carried(blocks, sides.ravel(), faces.reshape(-1, 2), motion).reshape(-1, 4, 2)
        return cls(
            scene,
            blocks.vertices[own],
            displacement,
            first,
            np.flatnonzero(scene.wall),
            outer_edges(np.arange(len(displacement)), first),
            faces,
            moved,
            joint_states(state.reshape(len(faces), -1)),
            multiplier,
            visible_scale(scene.size, farthest_motion(np.concatenate([displacement, moved.reshape(-1, 2)]))),
            motion=motion,
            crushed=crushed_ends(state),
        )

    @property
    def placed(self) -> Array:
        """Corners of the polygons where they are drawn, ``(n, 2)`` [m]."""
        return self.points + self.scale * self.displacement

    @property
    def placed_faces(self) -> Array:
        """Corners of the joints' gaps where they are drawn, ``(nf, 4, 2)`` [m]."""
        return self.faces + self.scale * self.face_displacement

    @property
    def extent(self) -> Extent:
        """What shows the whole wall before and after, with a little air around it."""
        both = np.concatenate([self.scene.blocks.vertices[self.scene.wall[self.scene.blocks.owner]], self.placed])
        (left, bottom), (right, top) = both.min(axis=0), both.max(axis=0)
        air = 0.03 * max(right - left, top - bottom)
        return left - air, right + air, bottom - air, top + air

    @property
    def gaps(self) -> Array:
        """How far the two ends of each joint are drawn apart, ``(nf, 2)`` [m]."""
        faces = self.placed_faces
        return np.asarray(np.hypot(*(faces[:, [3, 2]] - faces[:, [0, 1]]).transpose(2, 0, 1)))

    @property
    def parted(self) -> Mask:
        """Whether the two sides of each joint, drawn where they are, are a block apart, ``(nf,)``: no gap, but space.

        What is drawn farther than it moves is one wall however far that is.
        """
        return np.asarray((self.scale == 1.0) & (self.gaps.min(axis=1) > usual_side(self.scene)))

    @cached_property
    def drawn_state(self) -> Indices:
        """The state that each joint is drawn in, ``(nf,)``: it sticks where it opens by less than can be seen."""
        unseen = (self.state == JointState.OPEN) & (self.gaps.max(axis=1) < SEEN * self.scene.size)
        return np.where(unseen, JointState.STICK, self.state)

    @property
    def states(self) -> list[JointState]:
        """States of its joints that are drawn."""
        return [state for state in STATE_COLOURS if state in self.drawn_state]

    @property
    def hinges(self) -> Array:
        """Closed ends about which joints that open turn, where they are drawn, ``(n, 2)`` [m]."""
        closed = self.gaps.min(axis=1) < 0.5 * SEEN * self.scene.size
        turns = closed & (self.drawn_state == JointState.OPEN)
        turns[: len(self.crushed)] &= ~self.crushed.any(axis=1)
        return np.asarray(self.placed_faces[turns, self.gaps[turns].argmin(axis=1)])

    @property
    def crosses(self) -> Array:
        """Ends of joints that are crushed, midway between their faces where they are drawn, ``(n, 2)``."""
        if not len(self.crushed):
            return np.zeros((0, 2))
        return np.unique(mid_lines(self.placed_faces)[self.crushed], axis=0)

    def crossed_lines(self, arm: float) -> Array:
        """The lines of crosses there, half as wide as an arm [m], ``(2 n, 2, 2)`` [m]."""
        corners = arm * np.array([[[-1, -1], [1, 1]], [[-1, 1], [1, -1]]])
        return np.asarray((self.crosses[:, None, None] + corners).reshape(-1, 2, 2))

    def drawn_at(self, at: Array, block: ArrayLike) -> Array:
        """Where a point ``(2,)`` [m] of a block, or of some ``(n,)``, is drawn, ``(2,)`` [m]."""
        return np.asarray(at + self.drawn_displacement(np.atleast_1d(np.asarray(block, dtype=np.int64)), at))

    def drawn_displacement(self, block: Indices, at: Array) -> Array:
        """How far a point ``(2,)`` [m] of some blocks ``(n,)`` is drawn to have moved, ``(2,)`` [m]."""
        if not self.scene.wall[block].any() or (block < 0).any():  # a support, or an anchor in space
            rests = len(self.motion) == 0 or len(block) == 0 or (block < 0).any()
            return (
                np.zeros(2) if rests else self.scale * carried(self.scene.blocks, block[:1], at[None], self.motion)[0]
            )
        own = np.repeat(np.isin(self.block, block), np.diff(self.first))
        # The linear displacement that fits the corners best is exact where the block is rigid.
        place = np.column_stack([np.ones(own.sum()), self.points[own] - at])
        fitted = np.linalg.lstsq(place, self.displacement[own], rcond=None)[0]
        return np.asarray(self.scale * fitted[0])

    def block_colours(self) -> Array:
        """Colour of each polygon, ``(nc, 3)``; what moves as far as is drawn at most has that of the fastest."""
        if self.colouring == "course":
            colours = np.array(COURSES)[course_numbers(self.scene)[self.block] % len(COURSES)]
        else:
            moved = np.add.reduceat(np.hypot(*self.displacement.T), self.first[:-1]) / np.diff(self.first)
            share = np.minimum(self.scale * moved / (DRAWN * self.scene.size), 1.0)
            colours = np.array(AT_REST) + share[:, None] * (np.array(FASTEST) - AT_REST)
        colours[self.scene.fixed[self.block]] = HELD
        return colours


def crushed_ends(state: Indices) -> Mask:
    """Which ends of joints are crushed, by their states ``(nj, 2)``; empty where none is."""
    crushed = np.asarray(state == JointState.CRUSHED)
    return crushed if crushed.ndim == 2 and crushed.any() else np.zeros((0, 2), np.bool_)


def undeformed_shape(scene: Scene) -> DeformedShape:
    """The wall as it was built."""
    at_rest = np.zeros((len(scene.blocks), 3))
    return DeformedShape.of_rigid_blocks(scene, at_rest, np.zeros(len(scene.joints), np.int64), 0.0)


def around(extents: Sequence[Extent]) -> Extent:
    """The smallest extent that several are within."""
    lefts, rights, bottoms, tops = zip(*extents, strict=True)
    return min(lefts), max(rights), min(bottoms), max(tops)


def common_extent(shapes: Sequence[DeformedShape]) -> Extent:
    """What shows all of several shapes of a wall."""
    return around([shape.extent for shape in shapes])


def farthest_motion(displacement: Array) -> float:
    """Largest of some displacements ``(n, 2)``."""
    return float(np.hypot(*displacement.T).max())


def visible_scale(size: float, farthest: float) -> float:
    """Factor that makes the farthest motion [m] visible in a wall of a size [m]; 1 where nothing moves."""
    return DRAWN * size / farthest if farthest > 0 else 1.0


def series_scale(size: float, farthest: float) -> float:
    """The same of a motion that has a size of its own: none is drawn smaller than it is."""
    return max(1.0, visible_scale(size, farthest))


def scale_note(shape: DeformedShape) -> str:
    """What is said of how displacements are drawn."""
    return f"displacements × {float(f'{shape.scale:.3g}'):,.12g}"


def usual_side(scene: Scene) -> float:
    """Smaller side that half of a wall's blocks have at least [m], by which lines and signs on them are measured.

    The smallest block is no measure: a sliver or a course of tiles would thin out the lines of all others.
    """
    low, high = scene.blocks.boxes
    sides = (high - low).min(axis=1)[scene.wall & ~scene.is_beam]
    return max(scene.block_size, float(np.median(sides))) if len(sides) else scene.block_size


def course_numbers(scene: Scene) -> Indices:
    """Course of each block from below, ``(nb,)``, the ground's being −1."""
    course = np.full(len(scene.blocks), -1)
    height = scene.blocks.centroid[scene.wall, 1]
    levels = np.sort(height)
    starts = np.diff(levels, prepend=-np.inf) > 0.1 * scene.lowest_block
    course[scene.wall] = np.searchsorted(levels[starts], height + scene.blocks.tolerance) - 1
    return course


def outer_edges(corner: Indices, first: Indices) -> Indices:
    """Ends of the edges that no two polygons share, ``(ne, 2)``, as places among the corners of one after another.

    Corners have numbers ``(n,)``, the same in polygons that share them; those of each polygon start at ``(nc + 1,)``.
    """
    following = np.arange(1, len(corner) + 1)
    following[first[1:] - 1] = first[:-1]
    ends = np.sort(np.column_stack([corner, corner[following]]), axis=1)
    _, index, count = np.unique(ends @ [corner.max() + 1, 1], return_index=True, return_counts=True)
    single = index[count == 1]
    return np.column_stack([single, following[single]])


def outline(scene: Scene, which: Mask | None = None) -> list[Array]:
    """Outline of the undeformed wall, or of blocks ``(nb,)`` of it, openings and all: closed lines ``(n, 2)`` [m]."""
    import shapely

    blocks = scene.blocks
    which = scene.wall if which is None else which
    own = which[blocks.owner]
    number = np.cumsum(which) - 1
    polygons = shapely.polygons(shapely.linearrings(blocks.vertices[own], indices=number[blocks.owner[own]]))
    # What touches in the scene may be as far apart as the tolerance.
    union = shapely.union_all(shapely.buffer(polygons, blocks.tolerance, join_style="mitre"))
    return [np.asarray(ring.coords) for part in shapely.get_parts(union) for ring in (part.exterior, *part.interiors)]


def mid_lines(faces: Array) -> Array:
    """Lines midway between the faces ``(n, 4, 2)`` of joints' gaps, ``(n, 2, 2)``."""
    return (faces[:, :2] + faces[:, :1:-1]) / 2


def joint_lines(faces: Array, state: int) -> Array:
    """What joints in a state are drawn with: both of their faces ``(n, 4, 2)`` where they are open, ``(2 n, 2, 2)``.

    Else one line along the middle, ``(n, 2, 2)``: dashes on both faces would fill each other's gaps.
    """
    return np.concatenate([faces[:, :2], faces[:, 2:]]) if state == JointState.OPEN else mid_lines(faces)
