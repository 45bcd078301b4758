"""Kinematics of deformable blocks at finite displacements, each in a frame that rotates with the block.

A node is at c + u + R(θ) (X + Σ φ_k q_k): centroid, translation and rotation of its block, and small deformations in
the block's frame. A side of a block is the polygon of its nodes. As with rigid blocks (`contacts.rigid_sides`), two
sides touch at the two ends of their overlap, where the corner of one block, rounded or sharp, rests on a facet of the
other. Points inside a side, which are its nodes and possibly others between them, also rest on facets of the other
side if they are farther from its corners than half the distance to the next point. Closer to the corners, the ends of
the overlap carry the load of these points.

Each contact's traction acts as a force on the two facets where they touch. It is distributed to the two nodes of each
facet with the same resultant and the same moment. At their current positions, the nodal forces act on the blocks' rigid
coordinates, which conserves linear and angular momentum to rounding; rotated back into the block's frame, they are
projected on its modes.
"""

import math
from typing import NamedTuple

from runningbond.contacts.rigid_sides import angle, arc_on_arc, far_arcs, sharp_opening, turn_out, turned_by
from runningbond.joints import compiled
from runningbond.joints.frames import Frames, retell
from runningbond.joints.law import OPENING_BEFORE
from runningbond.scene import Array, Indices

from .block_kernels import NodalTables, to_modes, to_nodes

kernel = compiled.kernel


class OutlineNodes(NamedTuple):
    """Nodes on the outlines of blocks, sorted by side, each the start of a facet.

    Parameters
    ----------
    rigid : (nb, 3) int
        Indices of each block's rigid coordinates in the motion.
    centroid : (nb, 2) float
        Centroid of each undeformed block [m].
    owner : (no,) int
        Block of each node.
    arm : (no, 2) float
        Vector from the centroid of the undeformed block to each node [m].
    place : (no, 2) int
        Indices of the node's displacements in `NodalTables.nodal`.
    following : (no,) int
        Next node counter-clockwise.
    begin, length : (no,) float
        Distance along the side from its first corner to each node, and length of the facet that starts there [m].
    """

    rigid: Indices
    centroid: Array
    owner: Indices
    arm: Array
    place: Indices
    following: Indices
    begin: Array
    length: Array


class SidePoints(NamedTuple):
    """Points along the sides of blocks, the same number on each facet, the first one at the facet's start.

    Parameters
    ----------
    facet : (ns,) int
        Facet of each point.
    share : (ns,) float
        Position of the point on its facet, from 0 at the start to 1 at the end.
    half : (ns,) float
        Half the distance to the nearer of the two neighbouring points [m].
    """

    facet: Indices
    share: Array
    half: Array


class Sides(NamedTuple):
    """Sides of blocks, numbered as the corners that they start from; corners are numbered as in `Outline`.

    Parameters
    ----------
    outer : (nv, 2) int
        First and last facet of each side.
    shares : (nv, 2) float
        Position on these two facets, 0 at the start and 1 at the end, at which the arc of the corner touches them.
    extent, straight : (nv,) float
        Length of the side, and its length between the arcs plus any extension behind a re-entrant corner [m].
    ends : (nv, 2) int
        Corners at its start and at its end.
    inset, radius : (nc,) float
        Distance from the corner at which its arc touches its sides, negative at the end of an extension behind a
        re-entrant corner, and the radius of that arc [m].
    """

    outer: Indices
    shares: Array
    extent: Array
    straight: Array
    ends: Indices
    inset: Array
    radius: Array


class PlacedNodes(NamedTuple):
    """Current positions of blocks, facets and arcs in space.

    Parameters
    ----------
    blocks : (nb, 4) float
        Cosine and sine of each block's rotation, and its centroid [m].
    facets : (no, 5) float
        Position of each facet's first node [m], the facet's direction, and the inverse of its length [1/m].
    arcs : (nv, 4) float
        Centres of the arcs at the two ends of each side [m].
    pushed : (no, 2) float
        Buffer of the forces on outline nodes [N].
    """

    blocks: Array
    facets: Array
    arcs: Array
    pushed: Array


class DeformableSides(NamedTuple):
    """Arrays that `gather_deformable` and `scatter_deformable` share.

    Parameters
    ----------
    tables
        Displacements of the outlines' nodes per deformation mode.
    nodes, points, sides
        The outlines of the undeformed blocks.
    ends : (np, 6) int
        As in `RigidSides`. For a point inside a side: the number of corners plus the point's number, the side that the
        point is near, 1 if that side is block b's, the corner after that side, and the two sides e and f.
    inwards : (np,) float
        1 if the tangent of f points into the overlap, −1 if it points out of it, 0 for a point inside a side.
    area : (np,) float
        Area that each contact represents [m²].
    placed
        Current positions of the outlines, written by `gather_deformable`.
    contact : (np, 8) float
        Written by `gather_deformable`: point [m] and normal of each contact, its positions on the facets of b and a (0
        to 1), undeformed over current length of the facet along which it slips, and the factor `out` of `turn_out`.
    touched : (np, 3) int
        Written by `gather_deformable`: the facets of b and a, and 1 if a's corner or point rests on b or arcs touch.
    """

    tables: NodalTables
    nodes: OutlineNodes
    points: SidePoints
    sides: Sides
    ends: Indices
    inwards: Array
    area: Array
    placed: PlacedNodes
    contact: Array
    touched: Indices


@kernel
def place_nodes(motion: Array, tables: NodalTables, nodes: OutlineNodes, placed: PlacedNodes) -> None:
    """Write the positions of blocks and facets after a motion ``(nd,)``."""
    rigid, centroid, owner, arm, place, following, _, _ = nodes
    turned, facets, _, _ = placed
    nodal = tables.nodal
    to_nodes(tables, motion)
    nodal[tables.still[0] :] = 0.0
    for i in range(turned.shape[0]):
        spin = motion[rigid[i, 2]]
        turned[i, 0] = math.cos(spin)
        turned[i, 1] = math.sin(spin)
        turned[i, 2] = centroid[i, 0] + motion[rigid[i, 0]]
        turned[i, 3] = centroid[i, 1] + motion[rigid[i, 1]]
    for j in range(owner.size):
        b = owner[j]
        c, s = turned[b, 0], turned[b, 1]
        x, y = arm[j, 0] + nodal[place[j, 0]], arm[j, 1] + nodal[place[j, 1]]
        facets[j, 0] = turned[b, 2] + c * x - s * y
        facets[j, 1] = turned[b, 3] + s * x + c * y
    for j in range(owner.size):
        k = following[j]
        dx, dy = facets[k, 0] - facets[j, 0], facets[k, 1] - facets[j, 1]
        inverse = 1.0 / math.sqrt(dx * dx + dy * dy)
        facets[j, 2] = dx * inverse
        facets[j, 3] = dy * inverse
        facets[j, 4] = inverse


@kernel
def _place_arcs(sides: Sides, facets: Array, arcs: Array) -> None:
    """Write the centres of the arcs at the two ends of each side."""
    outer, shares, _, _, ends, _, radius = sides
    for side in range(arcs.shape[0]):
        for end in range(2):
            j = outer[side, end]
            r = radius[ends[side, end]]
            along = shares[side, end] / facets[j, 4]
            arcs[side, 2 * end] = facets[j, 0] + along * facets[j, 2] - r * facets[j, 3]
            arcs[side, 2 * end + 1] = facets[j, 1] + along * facets[j, 3] + r * facets[j, 2]


@kernel
def _facet_at(along: float, begin: Array, first: int, last: int) -> int:
    """Facet at a distance along a side from its first corner, found by bisection between the first and the last."""
    while last > first:
        middle = (first + last + 1) // 2
        if begin[middle] <= along:
            first = middle
        else:
            last = middle - 1
    return first


@kernel
def _project(x: float, y: float, facets: Array, begin: Array, length: Array, ends: Indices) -> tuple[int, float, float]:
    """Facet of a side, given its first and last, that a point projects on, and its positions on facet and side.

    Sides are straight except for small deformations, so any facet has the direction of its side.
    """
    j, last = ends[0], ends[1]
    if last > j:
        along = (x - facets[j, 0]) * facets[j, 2] + (y - facets[j, 1]) * facets[j, 3]
        j = _facet_at(along, begin, j, last)
    share = ((x - facets[j, 0]) * facets[j, 2] + (y - facets[j, 1]) * facets[j, 3]) * facets[j, 4]
    return j, share, begin[j] + share * length[j]


@kernel
def gather_deformable(motion: Array, geometry: DeformableSides, opening: Array, slip: Array) -> None:
    """Write opening and slip ``(np,)`` of contacts [m], from motions ``(nd,)``."""
    tables, nodes, points, sides, ends, inwards, _, placed, contact, touched = geometry
    begin, length = nodes.begin, nodes.length
    outer, shares, extent, straight, corners, inset, radius = sides
    facets, arcs = placed.facets, placed.arcs
    place_nodes(motion, tables, nodes, placed)
    _place_arcs(sides, facets, arcs)
    for k in range(inwards.size):
        v, w, e, f = ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
        sense = inwards[k]
        stretch, out = 1.0, 0.0
        on_arc = False
        if sense == 0.0:
            # A point inside a side: v is the number of corners plus the point's number.
            of_a = ends[k, 2] == 1
            side = e if of_a else f
            point, r = v - radius.size, 0.0
            own, share_own = points.facet[point], points.share[point]
            way = share_own / facets[own, 4]
            x, y = facets[own, 0] + way * facets[own, 2], facets[own, 1] + way * facets[own, 3]
            j, share, moved = _project(x, y, facets, begin, length, outer[side])
            nx, ny = facets[j, 3], -facets[j, 2]
            away = (x - facets[j, 0]) * nx + (y - facets[j, 1]) * ny
            stretch = length[j] * facets[j, 4]
            inside = min(moved - inset[corners[side, 0]], extent[side] - inset[corners[side, 1]] - moved)
            away = max(away, points.half[point] - inside)
        else:
            # If the tangent points into the overlap, e's last corner is near f's first one.
            low = sense > 0.0
            of_e, of_f = (1, 0) if low else (0, 1)
            x, y, r = arcs[e, 2 * of_e], arcs[e, 2 * of_e + 1], radius[v]
            wx, wy, r_w = arcs[f, 2 * of_f], arcs[f, 2 * of_f + 1], radius[w]
            own, share_own = outer[e, of_e], shares[e, of_e]
            side, end, far = f, 1 - of_f, ends[k, 3]
            j, share, along = _project(x, y, facets, begin, length, outer[f])
            on = along - inset[w] if low else extent[f] - inset[w] - along
            of_a = False
            if on < 0.0:
                i, share_e, along = _project(wx, wy, facets, begin, length, outer[e])
                on_e = extent[e] - inset[v] - along if low else along - inset[v]
                of_a = on_e >= 0.0
                on_arc = not of_a and r + r_w > 0.0
                if of_a:
                    x, y, r, sense, on = wx, wy, r_w, -sense, on_e
                    own, share_own = outer[f, of_f], shares[f, of_f]
                    side, end, far = e, 1 - of_e, ends[k, 2]
                    j, share = i, share_e
            if on_arc:
                j, share = outer[f, of_f], shares[f, of_f]
                away, nx, ny = arc_on_arc(x - wx, y - wy, r + r_w)
                moved = r * angle(nx, ny, -facets[own, 3], facets[own, 2])
                moved += r_w * angle(nx, ny, facets[j, 3], -facets[j, 2])
            else:
                nx, ny = facets[j, 3], -facets[j, 2]
                away = (x - facets[j, 0]) * nx + (y - facets[j, 1]) * ny - r
                moved = sense * on
                if r > 0.0:
                    moved -= r * angle(facets[own, 3], -facets[own, 2], -nx, -ny)
                stretch = length[j] * facets[j, 4]
                beyond = on - straight[side]
                if r + radius[far] == 0.0:
                    out = 0.0 if away > beyond else 2.0 * sense
                    away = sharp_opening(away, beyond)
                elif beyond > 0.0:
                    j, share, stretch = outer[side, end], shares[side, end], 1.0
                    dx, dy = x - arcs[side, 2 * end], y - arcs[side, 2 * end + 1]
                    ex, ey, fx, fy = -facets[own, 3], facets[own, 2], facets[j, 3], -facets[j, 2]
                    away, moved, nx, ny = far_arcs(dx, dy, (r, radius[far]), ex, ey, fx, fy)
                    moved += sense * straight[side]
        b, share_b, a, share_a = own, share_own, j, share
        x -= r * nx
        y -= r * ny
        if of_a:
            b, share_b, a, share_a = j, share, own, share_own
            nx, ny = -nx, -ny
        opening[k] = away
        slip[k] = moved
        contact[k, 0] = x
        contact[k, 1] = y
        contact[k, 2] = nx
        contact[k, 3] = ny
        contact[k, 4] = share_b
        contact[k, 5] = share_a
        contact[k, 6] = stretch
        contact[k, 7] = out
        touched[k, 0] = b
        touched[k, 1] = a
        touched[k, 2] = 1 if of_a or on_arc else 0


@kernel
def reframe_deformable(geometry: DeformableSides, frames: Frames, history: Array) -> None:
    """Convert histories after `gather_deformable`, as `reframe_sharp` does after `gather_sharp`."""
    _reframe(geometry, frames, history, True)


@kernel
def reframe_open(geometry: DeformableSides, frames: Frames, history: Array) -> None:
    """As `reframe_deformable`, only for points that are open, as across a crack.

    Corners pressed into each other change sides with every small vibration, each time by almost nothing. If their
    histories were converted each time, a wall under dead load would never come to rest.
    """
    _reframe(geometry, frames, history, False)


@kernel
def _reframe(geometry: DeformableSides, frames: Frames, history: Array, pressed_too: bool) -> None:
    """Convert the histories of contacts that now rest on the other block's side; `pressed_too`, closed ones as well."""
    _, _, _, sides, ends, inwards, _, placed, _, touched = geometry
    (facets, arcs), (bore, plastic) = (placed.facets, placed.arcs), frames
    for k in range(bore.size):
        bears = touched[k, 2] == 1
        if inwards[k] == 0.0 or bears == bore[k]:
            continue
        bore[k] = bears
        if not (pressed_too or history[OPENING_BEFORE, k] > 0.0):
            continue
        v, w, e, f = ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
        if sides.radius[v] + sides.radius[w] > 0.0:
            continue
        of_e, of_f = (1, 0) if inwards[k] > 0.0 else (0, 1)
        i, j = sides.outer[e, of_e], sides.outer[f, of_f]
        apart = arcs[e, 2 * of_e] - arcs[f, 2 * of_f], arcs[e, 2 * of_e + 1] - arcs[f, 2 * of_f + 1]
        opening, slip = turned_by(apart, (facets[j, 3], -facets[j, 2]), (-facets[i, 3], facets[i, 2]), bears)
        retell(history, plastic, k, opening, slip)


@kernel
def scatter_deformable(normal: Array, tangential: Array, geometry: DeformableSides, force: Array) -> None:
    """Subtract the modal forces of the contacts' tractions ``(np,)`` [Pa] from forces ``(nd,)``."""
    tables, nodes, _, _, _, _, area, placed, contact, touched = geometry
    following, (_, facets, _, pushed) = nodes.following, placed
    pushed[:] = 0.0
    for k in range(normal.size):
        if normal[k] == 0.0 and tangential[k] == 0.0:
            continue
        x, y, nx, ny = contact[k, 0], contact[k, 1], contact[k, 2], contact[k, 3]
        pull, shear = turn_out(area[k] * normal[k], area[k] * tangential[k], contact[k, 7])
        shear *= contact[k, 6]
        fx = -pull * nx + shear * ny
        fy = -pull * ny - shear * nx
        # The force on b, then its opposite on a.
        for side in range(2):
            j, share = touched[k, side], contact[k, 4 + side]
            after = following[j]
            tx, ty, inverse = facets[j, 2], facets[j, 3], facets[j, 4]
            along = share / inverse
            # The point may be off the facet by a penetration or a radius, which adds a couple on the two nodes.
            off_x, off_y = x - facets[j, 0] - along * tx, y - facets[j, 1] - along * ty
            couple = (off_x * fy - off_y * fx) * inverse
            gx, gy = (1.0 - share) * fx + couple * ty, (1.0 - share) * fy - couple * tx
            pushed[j, 0] += gx
            pushed[j, 1] += gy
            pushed[after, 0] += fx - gx
            pushed[after, 1] += fy - gy
            fx, fy = -fx, -fy
    _push_nodes(nodes, placed, tables.nodal, force)
    to_modes(tables, force)


@kernel
def _push_nodes(nodes: OutlineNodes, placed: PlacedNodes, nodal: Array, force: Array) -> None:
    """Add the forces on outline nodes to the blocks' rigid forces; write their opposites in the blocks' frames."""
    rigid, _, owner, _, place, _, _, _ = nodes
    turned, facets, _, pushed = placed
    nodal[:] = 0.0
    for j in range(owner.size):
        fx, fy = pushed[j, 0], pushed[j, 1]
        if fx == 0.0 and fy == 0.0:
            continue
        b = owner[j]
        c, s = turned[b, 0], turned[b, 1]
        force[rigid[b, 0]] += fx
        force[rigid[b, 1]] += fy
        force[rigid[b, 2]] += (facets[j, 0] - turned[b, 2]) * fy - (facets[j, 1] - turned[b, 3]) * fx
        nodal[place[j, 0]] -= c * fx + s * fy
        nodal[place[j, 1]] -= c * fy - s * fx
