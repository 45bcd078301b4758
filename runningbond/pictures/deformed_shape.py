"""The deformed shape of a wall, as polygons of its blocks and joint gaps, from which all pictures are drawn."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from runningbond.results.mechanism import carried, turned
from runningbond.scene import Array, Indices, Mask, Scene

from .joint_state import JointState, joint_states
from .style import AT_REST, COURSES, DRAWN, FASTEST, HELD, STATE_COLOURS, VISIBLE_GAP, Colouring

Extent: TypeAlias = tuple[float, float, float, float]
"""Part of the plane: left, right, bottom and top [m]."""


@dataclass(frozen=True, eq=False)
class DeformedShape:
    """Positions of the blocks and joints of a wall at one moment, and how to draw them.

    Parameters
    ----------
    scene
        The wall.
    points, displacement : (n, 2) float
        Undeformed corners of all polygons, polygon by polygon, counter-clockwise [m], and their displacement [m].
    first : (nc + 1,) int
        Index of each polygon's first corner. A polygon is a block, or one of its triangles.
    block : (nc,) int
        Block of each polygon; the ground is left out.
    edges : (ne, 2) int
        Corners at the ends of the blocks' edges.
    faces, face_displacement : (nf, 4, 2) float
        Undeformed corners of each joint's gap [m], along block a's side and back along block b's, and their
        displacement [m].
    state : (nf,) int
        A `JointState` each.
    multiplier, scale
        λ, and the factor by which displacements are enlarged in the drawing.
    colouring
        How blocks are coloured.
    crushed : (nf, 2) bool
        Whether each joint is crushed at its ends; empty if none is.
    motion : (nb, 3) float
        Motion of each block, used only to draw the supports; empty if these are at rest.
    finite
        Whether blocks have turned by finite angles.
    time
        Time since the ground motion began [s]; None without a ground motion.
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
    finite: bool = False

    @classmethod
    def of_rigid_blocks(
        cls, scene: Scene, motion: Array, state: Indices, multiplier: float, *, finite: bool = False
    ) -> "DeformedShape":
        """Shape of rigid blocks with motions ``(nb, 3)`` [m, m, rad], with displacements scaled to be visible.

        The scale follows from the largest displacement of the wall or of its supports, whichever is larger; if blocks
        turn by `finite` angles, it is at least 1. States are those of joints ``(nj,)`` or of their ends ``(nj, 2)``.
        """
        carry, scale_of = (turned, series_scale) if finite else (carried, visible_scale)
        blocks, joints = scene.blocks, scene.joints
        own = scene.wall[blocks.owner]
        displacement = carry(blocks, blocks.owner, blocks.vertices, motion)[own]
        first = np.concatenate([[0], np.cumsum(np.diff(blocks.first)[scene.wall])])
        faces = joints.ends[:, [0, 1, 1, 0]]
        sides = joints.block[:, [0, 0, 1, 1]]
        moved = carry(blocks, sides.ravel(), faces.reshape(-1, 2), motion).reshape(-1, 4, 2)
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
            scale_of(scene.size, farthest_motion(np.concatenate([displacement, moved.reshape(-1, 2)]))),
            motion=motion,
            finite=finite,
            crushed=crushed_ends(state),
        )

    @property
    def placed(self) -> Array:
        """Drawn positions of the polygons' corners, ``(n, 2)`` [m]."""
        return self.points + self.scale * self.displacement

    @property
    def placed_faces(self) -> Array:
        """Drawn positions of the corners of joint gaps, ``(nf, 4, 2)`` [m]."""
        return self.faces + self.scale * self.face_displacement

    @property
    def extent(self) -> Extent:
        """Extent of the whole wall before and after deformation, with a small margin."""
        both = np.concatenate([self.scene.blocks.vertices[self.scene.wall[self.scene.blocks.owner]], self.placed])
        (left, bottom), (right, top) = both.min(axis=0), both.max(axis=0)
        air = 0.03 * max(right - left, top - bottom)
        return left - air, right + air, bottom - air, top + air

    @property
    def gaps(self) -> Array:
        """Drawn distance between the two sides of each joint, at both of its ends, ``(nf, 2)`` [m]."""
        faces = self.placed_faces
        return np.asarray(np.hypot(*(faces[:, [3, 2]] - faces[:, [0, 1]]).transpose(2, 0, 1)))

    @property
    def parted(self) -> Mask:
        """Whether the sides of each joint are more than a block's side apart, ``(nf,)``, so that its gap is not filled.

        This holds only for displacements at true scale; enlarged ones show a connected wall however wide the gaps are.
        """
        return np.asarray((self.scale == 1.0) & (self.gaps.min(axis=1) > usual_side(self.scene)))

    @cached_property
    def drawn_state(self) -> Indices:
        """State in which each joint is drawn, ``(nf,)``: it sticks if its opening is too small to be seen."""
        unseen = (self.state == JointState.OPEN) & (self.gaps.max(axis=1) < VISIBLE_GAP * self.scene.size)
        return np.where(unseen, JointState.STICK, self.state)

    @property
    def states(self) -> list[JointState]:
        """Joint states with a colour that occur in the drawing."""
        return [state for state in STATE_COLOURS if state in self.drawn_state]

    @property
    def hinges(self) -> Array:
        """Drawn positions of the closed ends about which open, uncrushed joints rotate, ``(n, 2)`` [m]."""
        closed = self.gaps.min(axis=1) < 0.5 * VISIBLE_GAP * self.scene.size
        turns = closed & (self.drawn_state == JointState.OPEN)
        turns[: len(self.crushed)] &= ~self.crushed.any(axis=1)
        return np.asarray(self.placed_faces[turns, self.gaps[turns].argmin(axis=1)])

    @property
    def crosses(self) -> Array:
        """Drawn positions of crushed joint ends, midway between their faces, ``(n, 2)`` [m]."""
        if not len(self.crushed):
            return np.zeros((0, 2))
        return np.unique(mid_lines(self.placed_faces)[self.crushed], axis=0)

    def crossed_lines(self, arm: float) -> Array:
        """Lines of the crosses at `crosses` with a half width of `arm` [m], ``(2 n, 2, 2)`` [m]."""
        corners = arm * np.array([[[-1, -1], [1, 1]], [[-1, 1], [1, -1]]])
        return np.asarray((self.crosses[:, None, None] + corners).reshape(-1, 2, 2))

    def drawn_at(self, at: Array, block: ArrayLike) -> Array:
        """Drawn position ``(2,)`` [m] of a point ``(2,)`` [m] on one block or on several ``(n,)``."""
        return np.asarray(at + self.drawn_displacement(np.atleast_1d(np.asarray(block, dtype=np.int64)), at))

    def drawn_displacement(self, block: Indices, at: Array) -> Array:
        """Drawn displacement ``(2,)`` [m] of a point ``(2,)`` [m] on blocks ``(n,)``."""
        if not self.scene.wall[block].any() or (block < 0).any():  # a support, or an anchor in space
            rests = len(self.motion) == 0 or len(block) == 0 or (block < 0).any()
            carry = turned if self.finite else carried
            return np.zeros(2) if rests else self.scale * carry(self.scene.blocks, block[:1], at[None], self.motion)[0]
        own = np.repeat(np.isin(self.block, block), np.diff(self.first))
        # A linear fit to the displacements of the corners is exact for rigid blocks.
        place = np.column_stack([np.ones(own.sum()), self.points[own] - at])
        fitted = np.linalg.lstsq(place, self.displacement[own], rcond=None)[0]
        return np.asarray(self.scale * fitted[0])

    def block_colours(self) -> Array:
        """Colour of each polygon, ``(nc, 3)``: `FASTEST` if drawn to move by `DRAWN` wall sizes or more."""
        if self.colouring == "course":
            colours = np.array(COURSES)[course_numbers(self.scene)[self.block] % len(COURSES)]
        else:
            moved = np.add.reduceat(np.hypot(*self.displacement.T), self.first[:-1]) / np.diff(self.first)
            share = np.minimum(self.scale * moved / (DRAWN * self.scene.size), 1.0)
            colours = np.array(AT_REST) + share[:, None] * (np.array(FASTEST) - AT_REST)
        colours[self.scene.fixed[self.block]] = HELD
        return colours


def crushed_ends(state: Indices) -> Mask:
    """Which joint ends are crushed, from their states ``(nj, 2)``; empty if none is."""
    crushed = np.asarray(state == JointState.CRUSHED)
    return crushed if crushed.ndim == 2 and crushed.any() else np.zeros((0, 2), np.bool_)


def undeformed_shape(scene: Scene) -> DeformedShape:
    """Shape of the wall as it was built."""
    at_rest = np.zeros((len(scene.blocks), 3))
    return DeformedShape.of_rigid_blocks(scene, at_rest, np.zeros(len(scene.joints), np.int64), 0.0)


def around(extents: Sequence[Extent]) -> Extent:
    """Smallest extent that contains all given extents."""
    lefts, rights, bottoms, tops = zip(*extents, strict=True)
    return min(lefts), max(rights), min(bottoms), max(tops)


def common_extent(shapes: Sequence[DeformedShape]) -> Extent:
    """Extent that contains all given shapes of a wall."""
    return around([shape.extent for shape in shapes])


def farthest_motion(displacement: Array) -> float:
    """Largest magnitude of displacements ``(n, 2)``."""
    return float(np.hypot(*displacement.T).max())


def visible_scale(size: float, farthest: float) -> float:
    """Factor that makes the largest motion [m] visible in a wall of a given size [m]; 1 if nothing moves."""
    return DRAWN * size / farthest if farthest > 0 else 1.0


def series_scale(size: float, farthest: float) -> float:
    """`visible_scale` for motions of physical size: at least 1, so that none is drawn smaller than it is."""
    return max(1.0, visible_scale(size, farthest))


def scale_note(shape: DeformedShape) -> str:
    """Note on the scale at which displacements are drawn."""
    return f"displacements × {float(f'{shape.scale:.3g}'):,.12g}"


def usual_side(scene: Scene) -> float:
    """Median of the blocks' smaller sides [m], at least `Scene.block_size`, by which lines and symbols are sized.

    The smallest block would not do: a sliver or a course of tiles would thin out the lines of all other blocks.
    """
    low, high = scene.blocks.boxes
    sides = (high - low).min(axis=1)[scene.wall & ~scene.is_beam]
    return max(scene.block_size, float(np.median(sides))) if len(sides) else scene.block_size


def course_numbers(scene: Scene) -> Indices:
    """Course number of each block, counted from below, ``(nb,)``; −1 for the ground."""
    course = np.full(len(scene.blocks), -1)
    height = scene.blocks.centroid[scene.wall, 1]
    levels = np.sort(height)
    starts = np.diff(levels, prepend=-np.inf) > 0.1 * scene.lowest_block
    course[scene.wall] = np.searchsorted(levels[starts], height + scene.blocks.tolerance) - 1
    return course


def outer_edges(corner: Indices, first: Indices) -> Indices:
    """Ends of the edges that no two polygons share, ``(ne, 2)``, as indices into the sequence of all corners.

    Corners have numbers ``(n,)``, equal in polygons that share them; each polygon starts at an index ``(nc + 1,)``.
    """
    following = np.arange(1, len(corner) + 1)
    following[first[1:] - 1] = first[:-1]
    ends = np.sort(np.column_stack([corner, corner[following]]), axis=1)
    _, index, count = np.unique(ends @ [corner.max() + 1, 1], return_index=True, return_counts=True)
    single = index[count == 1]
    return np.column_stack([single, following[single]])


def outline(scene: Scene, which: Mask | None = None) -> list[Array]:
    """Outline of the undeformed wall or of selected blocks ``(nb,)``, with openings: closed lines ``(n, 2)`` [m]."""
    import shapely

    blocks = scene.blocks
    which = scene.wall if which is None else which
    own = which[blocks.owner]
    number = np.cumsum(which) - 1
    polygons = shapely.polygons(shapely.linearrings(blocks.vertices[own], indices=number[blocks.owner[own]]))
    # Blocks in contact may be as far apart as the tolerance.
    union = shapely.union_all(shapely.buffer(polygons, blocks.tolerance, join_style="mitre"))
    return [np.asarray(ring.coords) for part in shapely.get_parts(union) for ring in (part.exterior, *part.interiors)]


def mid_lines(faces: Array) -> Array:
    """Lines midway between the faces ``(n, 4, 2)`` of joints' gaps, ``(n, 2, 2)``."""
    return (faces[:, :2] + faces[:, :1:-1]) / 2


def joint_lines(faces: Array, state: int) -> Array:
    """Lines that represent joints in a state: both of their faces ``(n, 4, 2)`` if they are open, ``(2 n, 2, 2)``.

    Otherwise one line along the middle, ``(n, 2, 2)``, because dashes on both faces would fill each other's gaps.
    """
    return np.concatenate([faces[:, :2], faces[:, 2:]]) if state == JointState.OPEN else mid_lines(faces)
