"""Deformable blocks at finite displacements, whose contacts are detected again as they move.

Deformations are small in the frame of their block, which rotates with it. The coupling of rotation and deformation is
neglected: centrifugal and Coriolis forces on the deformations, and the change of a block's moment of inertia. These
forces would strain a block by the square of the ratio of its corners' speed to the speed of sound, 1e-5 at 10 m/s in
brick; the relative change of inertia is of the order of the strain.
"""

from dataclasses import replace
from functools import cached_property

import numpy as np

from runningbond.contacts.materials import ContactMaterials
from runningbond.contacts.rigid_sides import in_space, turn_out
from runningbond.contacts.search import ContactForces, Contacts, facing_sides, find_contacts, position_of, resting
from runningbond.dynamics import BlockSystem, Interface, moving_far
from runningbond.joints.wall_law import bears_by_area
from runningbond.scene import Array, Indices, Mask

from .bearing_areas import BearingAreas
from .deformable_sides import (
    DeformableSides,
    PlacedNodes,
    gather_deformable,
    reframe_deformable,
    reframe_open,
    scatter_deformable,
)
from .finite_frequency import frequency_squared
from .mass_scaling import ScaledModes, scaled_modes
from .node_outline import NodeOutline
from .system import DAMPING, block_system


def finite_system(blocks: NodeOutline, *, mass_scaling: bool = True) -> BlockSystem:
    """Set up a wall's deformable blocks at finite displacements; `mass_scaling` as in `fem_interface.model.fem`."""
    contacts, scaled = DeformableContacts(blocks), scaled_modes(blocks.wall, DAMPING, mass_scaling=mass_scaling)
    interface = contacts.interface(contacts.undeformed, scaled, scaled.frequency_squared)
    system, forces = block_system(blocks.wall, scaled, interface), blocks.wall.forces_by_piece
    return moving_far(system, blocks.scene, contacts, forces, blocks.wall.deformation)


class DeformableContacts:
    """Contacts of deformable blocks; see `runningbond.dynamics.ContactSearch`.

    Parameters
    ----------
    blocks
        The blocks.
    """

    def __init__(self, blocks: NodeOutline) -> None:
        self.blocks, self.outline, self._materials = blocks, blocks.outline, ContactMaterials(blocks.scene)
        still = np.zeros(len(blocks.wall.mass))
        found = self._near(still, self.outline.margin)
        self._areas = BearingAreas(blocks, found, self._gathered(found, still).contact[:, :2])
        self.undeformed = replace(found, area=self._areas.undeformed, glued=found.joint >= 0)
        if bears_by_area(self._materials.law(found).law):
            self.undeformed = replace(self.undeformed, margin=self.bearing(found).margin)

    def find(self, motion: Array, margin: float) -> Contacts:
        """Contacts nearer than a margin [m] after a motion ``(nd,)``, with their areas on the undeformed wall."""
        return self._areas.initial(self._near(motion, margin))

    def _near(self, motion: Array, margin: float) -> Contacts:
        """Contacts nearer than a margin [m] after a motion ``(nd,)``: ends of facing sides, then points inside them."""
        rigid = self.blocks.rigid(motion)
        ends = find_contacts(self.outline, rigid, margin)
        corner, _ = resting(self.outline, ends, rigid)
        v, _, _, _, e, f = ends.ends.astype(np.int64).T
        side, low = np.where(corner == v, e, f), (ends.inwards > 0) == (corner == v)
        # The resting corner is the last of side e or the first of f at the low end, and the reverse at the high end.
        area = np.minimum(ends.area, self.outline.thickness_between(e, f) * self._of_ends[side, np.where(low, 1, 0)])
        inner = self._inner(rigid, margin)
        contacts = Contacts(
            ends.motion,
            margin,
            np.concatenate([ends.ends, inner.ends]),
            np.concatenate([ends.inwards, inner.inwards]),
            np.concatenate([ends.tilt, inner.tilt]),
            np.concatenate([area, inner.area]),
            np.concatenate([ends.joint, inner.joint]),
            np.concatenate([ends.glued, inner.glued]),
        )
        return self._materials.side_by_side(contacts)

    def bearing(self, contacts: Contacts) -> Contacts:
        """The contacts with the areas over which blocks bear now, as in `ContactSearch`."""
        motion = np.zeros(len(self.blocks.wall.mass))
        motion[self.blocks.wall.rigid] = contacts.motion.reshape(-1, 3)
        return self._areas.present(contacts, self._gathered(contacts, motion).contact[:, :2])

    def _inner(self, rigid: Array, margin: float) -> Contacts:
        """Points inside one of two facing sides that are near the other: points of block b, or of a if b is held."""
        outline, first = self.outline, self.blocks.first * self.blocks.parts
        nodes, points, inset = self.blocks.nodes, self.blocks.points, self.blocks.sides.inset[outline.ends]
        owner, after = outline.blocks.owner, outline.blocks.successor
        e, f = facing_sides(outline, rigid, margin)
        of_a = outline.held[owner[e]]
        own, other = np.where(of_a, f, e), np.where(of_a, e, f)
        count = np.diff(first)[own] - 1
        pair = np.repeat(np.arange(len(own)), count)
        point = first[own][pair] + 1 + np.arange(len(pair)) - np.repeat(np.cumsum(count) - count, count)
        arcs = outline.placed(rigid).arcs
        facet, share = points.facet[point], points.share[point, None]
        block = nodes.owner[facet]
        arm = (1 - share) * nodes.arm[facet] + share * nodes.arm[nodes.following[facet]]
        at = outline.points(block, outline.blocks.centroid[block] + arm, rigid)
        corners = outline.corners(rigid)
        on = other[pair]
        run = corners[after[on]] - corners[on]
        length = np.hypot(*run.T)
        away = ((at - corners[on]) * arcs[on, 2:]).sum(axis=1)
        along = ((at - corners[on]) * run).sum(axis=1) / length
        opposed = -(arcs[own, 2:] * arcs[other, 2:]).sum(axis=1)[pair] > np.cos(np.pi / 4)
        # Leave out points that are too near the other side's corners to carry load before they move by the margin.
        inside = np.minimum(along - inset[on, 0], length - inset[on, 1] - along)
        near = opposed & (np.abs(away) < margin) & (points.half[point] - inside < margin) & self.blocks.bearing[point]
        point, pair, on = point[near], pair[near], on[near]
        rows = (len(outline.radius) + point, on, of_a[pair], after[on], e[pair], f[pair])
        joint = outline.joint_of(e, f)[pair]
        area = outline.thickness_between(own, other)[pair] * self.blocks.gap[[point, point - 1]].sum(axis=0) / 2
        still = np.zeros(len(point))
        return Contacts(rigid, margin, np.column_stack(rows).astype(np.uint64), still, still, area, joint, still > 0)

    @cached_property
    def _of_ends(self) -> Array:
        """Length ``(nv, 2)`` [m] of each side that its start and its end represent.

        It reaches half-way from the last point that does not bear to the first one that does.
        """
        gap, extent, (side, along) = self.blocks.gap, self.blocks.sides.extent, self.blocks.places
        first = np.where(self.blocks.bearing, along - np.roll(gap, 1) / 2, extent[side] / 2)
        last = np.where(self.blocks.bearing, along + gap / 2, extent[side] / 2)
        start = self.blocks.first[:-1] * self.blocks.parts
        of_start, of_end = np.minimum.reduceat(first, start), extent - np.maximum.reduceat(last, start)
        return np.column_stack([of_start, of_end])

    def geometry(self, contacts: Contacts) -> DeformableSides:
        """The arrays that `gather_deformable` and `scatter_deformable` share, with new buffers."""
        blocks, n = self.blocks, len(contacts)
        placed = PlacedNodes(
            np.zeros((len(self.outline.blocks), 4)),
            np.zeros((len(blocks.nodes.arm), 5)),
            np.zeros((len(blocks.first) - 1, 4)),
            np.zeros((len(blocks.nodes.arm), 2)),
        )
        return DeformableSides(
            blocks.new_tables(),
            blocks.nodes,
            blocks.points,
            blocks.sides,
            contacts.ends.astype(np.int64),
            contacts.inwards.copy(),
            contacts.area.copy(),
            placed,
            np.zeros((n, 8)),
            np.zeros((n, 3), dtype=np.int64),
        )

    def interface_on(self, contacts: Contacts, system: BlockSystem) -> Interface:
        """The interface of a system's blocks on contacts."""
        # Always the same guess, because the bound must not depend on earlier contacts.
        return self.interface(contacts, system, system.interface.frequency_squared)

    def interface(self, contacts: Contacts, scaled: ScaledModes | BlockSystem, guess: float) -> Interface:
        """The interface of blocks with scaled modes on contacts; the bound of ω² [1/s²] is iterated from a guess."""
        law, geometry = self._materials.law(contacts), self.geometry(contacts)
        bound = frequency_squared(self.blocks, scaled, contacts, geometry, law, guess)
        kernels = gather_deformable, scatter_deformable
        reframe = reframe_deformable if self.blocks.scene.history else reframe_open
        return Interface(law, contacts.area, *kernels, geometry, bound, reframe=reframe)

    def points(self, contacts: Contacts) -> tuple[Indices, Indices]:
        """A key and a number of each contact, two ``(n,)``, because every contact is a point."""
        return contacts.points()

    def at_joints(self, contacts: Contacts, values: Array) -> Array:
        """See `ContactSearch`; each joint element's point gets its part of the nearest contact's force."""
        key, share = self._joint_points
        at = position_of(contacts.key, key)
        lost = np.array([contacts.margin, 0.0, 0.0, 0.0, 0.0, 0.0])
        part = np.where(np.arange(6)[:, None] // 2 == 1, share, 1.0)
        return np.column_stack([values, lost])[:, at] * part  # -1, for contacts that are lost, is the last column

    def _gathered(self, contacts: Contacts, motion: Array) -> DeformableSides:
        """The geometry of contacts after a motion ``(nd,)``."""
        geometry = self.geometry(contacts)
        gather_deformable(motion, tuple(geometry), *np.zeros((2, len(contacts))))
        return geometry

    def pulls(self, contacts: Contacts, motion: Array, force: Array) -> Array:
        """Forces in space; see `ContactSearch`."""
        contact = self._gathered(contacts, motion).contact
        pull, shear = turn_out.py_func(*force, contact[:, 7])
        return in_space(pull, shear * contact[:, 6], contact[:, 2:4])

    def forces(self, contacts: Contacts, motion: Array, force: Array) -> ContactForces:
        """Forces in space; see `ContactSearch`."""
        contact = self._gathered(contacts, motion).contact
        pull, shear = turn_out.py_func(*force, contact[:, 7])
        return contacts.forces(self.outline, contact[:, :4], np.array([pull, shear * contact[:, 6]]))

    def left_out(self, contacts: Contacts) -> Mask:
        """Contacts that bear no share of a joint point's force; see `ContactSearch`."""
        return position_of(self._joint_points[0], contacts.key) < 0

    @cached_property
    def _joint_points(self) -> tuple[Indices, Array]:
        """Key of the nearest contact of each joint point's joint, and the point's part of that contact's area."""
        points, contacts = self.blocks.wall.elements.points, self._areas.contacts
        nearest, _ = self._areas.nearest
        area = np.bincount(nearest, points.area, len(contacts))
        return contacts.key[nearest], points.area / area[nearest]

    def resting(self, contacts: Contacts, motion: Array) -> Indices:
        """A number for each contact that identifies the corner or point that rests and the side it rests on."""
        geometry = self._gathered(contacts, motion)
        of_a = geometry.touched[:, 2] == 1
        v, w, _, _, e, f = contacts.ends.astype(np.int64).T
        inner = contacts.inwards == 0
        corner, side = np.where(of_a & ~inner, w, v), np.where(of_a, e, f)
        return np.asarray(corner * 2**32 + side)

    def deformation(self, motion: Array) -> float:
        """Upper bound of an outline node's displacement by deformation in a motion ``(nd,)`` [m]."""
        pairs = zip(self.blocks.tables, self.blocks.wall.split(motion), strict=True)
        far = [float(np.abs(table @ Q[3:]).max(initial=0.0)) for table, Q in pairs]
        return float(np.sqrt(2) * max(far, default=0.0))
