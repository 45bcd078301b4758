"""Kinematics of rigid blocks at finite displacements: two facing sides, and the two ends of their overlap.

A side is straight between two corners. A corner is an arc of radius r about a centre c, and touches the sides at the
joints' inset from the corner (r = 0: a sharp corner). If side e of block b lies on side f of block a, each end of their
overlap is the corner v of e or the corner w of f, whichever is farther in. With the normal n from a to b, the tangent
t, and the tilt φ of b against a,

    v rests on f:   opening n_f · (c_v − c_w) − r_v − r_w,   slip t_f · (c_v − c_w) − r_v φ
    w carries e:    opening n_e · (c_v − c_w) − r_v − r_w,   slip t_e · (c_v − c_w) + r_w φ
    arc on arc:     opening |c_v − c_w| − r_v − r_w,         slip r_v ∠(n_e, n) + r_w ∠(n_f, n),  n along the centres

The three cases join continuously, and so does their friction when a corner leaves one block's side and its own side
slides on over another one's. Only if sharp corners lie on each other, penetrating by δ, the slip changes suddenly, by
δ sin φ; `reframe_sharp` adds this to the history, so that it has no effect. The rates of opening and slip are those of
the two blocks at the contact point: contact forces are work-conjugate to them, and keep linear and angular momentum.
"""

import math
from typing import NamedTuple

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.joints.frames import Frames, retell
from runningbond.scene import Array, Mask, Unsigned

ONE, TWO, THREE = np.uint64(1), np.uint64(2), np.uint64(3)

QUARTER_TURN, QUARTER_TAIL = 1.57079632673412561417, 6.07710050650619224932e-11
"""π / 2 in two parts (from fdlibm); the first has so few digits that small multiples of it are exact."""

S1, S2, S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
S4, S5, S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10
C1, C2, C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
C4, C5, C6 = -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11
"""Polynomial coefficients of sine and cosine up to π / 4 (`__kernel_sin` and `__kernel_cos` of fdlibm)."""


class Corners(NamedTuple):
    """The corners of undeformed blocks, in the frame of the undeformed wall."""

    centroid: Array  # (nb, 2) centroid of each block [m]
    freedom: Unsigned  # (nv,) first degree of freedom of each corner's block
    centre: Array  # (nv, 2) centre of each corner's arc, from the centroid [m]
    normal: Array  # (nv, 2) outward normal of the side that starts at the corner


class Placed(NamedTuple):
    """Positions of blocks and of the arcs of their corners in space."""

    blocks: Array  # (4, nb) cosine and sine of each block's rotation, and its centroid [m]
    arcs: Array  # (nv, 4) centre of each corner's arc [m] and outward normal of the side that starts there


class RigidSides(NamedTuple):
    """Arrays that `gather_sides` and `scatter_sides` share."""

    corners: Corners  # the corners of the undeformed blocks
    # (nv,) radius of each corner's arc, and length of the side that starts there between its arcs [m]
    radius: Array
    straight: Array
    # (np, 6) for each end of facing sides e and f: corners v and w, the far corners of e and f, and e and f
    ends: Unsigned
    inwards: Array  # (np,) 1 if the overlap lies along the tangent of f from the end, −1 if against it
    tilt: Array  # (np,) tilt of e against f, minus the rotations of the blocks [rad]
    area: Array  # (np,) area that the end represents [m²]
    placed: Placed  # written by `gather_sides`: positions in space
    contact: Array  # (np, 4) written by `gather_sides`: contact point [m] and normal of each end
    out: Array  # (np,) written by `gather_sides`: how the force of each end is turned (`turn_out`)
    bears: Mask  # (np,) written by `gather_sharp`: True if w carries e, False if v rests on f


@kernel
def turn(motion: Array, cosine: Array, sine: Array) -> None:
    """Write cosines and sines ``(nb,)`` of the rotations in a motion ``(3 nb,)``, accurate to rounding.

    This replaces the library functions, so that the loop runs in vector registers.
    """
    for i in range(cosine.size):
        spin = motion[3 * i + 2]
        quarters = math.floor(spin * (2.0 / math.pi) + 0.5)
        r = (spin - quarters * QUARTER_TURN) - quarters * QUARTER_TAIL
        z = r * r
        s = r + r * z * (S1 + z * (S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)))))
        c = 1.0 - (0.5 * z - z * z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6))))))
        odd = quarters - 2.0 * math.floor(0.5 * quarters) > 0.5
        turns = quarters - 4.0 * math.floor(0.25 * quarters)
        along, across = (s if odd else c), (c if odd else s)
        cosine[i] = -along if (turns > 0.5) & (turns < 2.5) else along
        sine[i] = -across if turns > 1.5 else across


@kernel
def place_outline(motion: Array, corners: Corners, placed: Placed) -> None:
    """Write the positions of blocks and arcs after a motion ``(3 nb,)``."""
    centroid, freedom, centre, normal = corners
    blocks, arcs = placed
    cosine, sine, x, y = blocks[0], blocks[1], blocks[2], blocks[3]
    turn(motion, cosine, sine)
    for i in range(x.size):
        x[i] = centroid[i, 0] + motion[3 * i]
        y[i] = centroid[i, 1] + motion[3 * i + 1]
    for corner in range(freedom.size):
        v = np.uint64(corner)
        b = freedom[v] // THREE
        c, s = cosine[b], sine[b]
        arcs[v, 0] = x[b] + c * centre[v, 0] - s * centre[v, 1]
        arcs[v, 1] = y[b] + s * centre[v, 0] + c * centre[v, 1]
        arcs[v, 2] = c * normal[v, 0] - s * normal[v, 1]
        arcs[v, 3] = s * normal[v, 0] + c * normal[v, 1]


@kernel
def arc_on_arc(dx: float, dy: float, radii: float) -> tuple[float, float, float]:
    """Opening of two arcs, and the unit normal along the line ``(dx, dy)`` between their centres."""
    distance = math.hypot(dx, dy)
    return distance - radii, dx / distance, dy / distance


@kernel
def sharp_opening(away: float, beyond: float) -> float:
    """Opening of a sharp corner that is `away` from a side and `beyond` its far end [m], both negative inside.

    If the corner is deeper than its distance from that end, the penetration decreases again, to zero at twice this
    distance: the corner emerges at the end, and belongs to the side round the end. Otherwise a block that slides onto
    the next block of its course would get stuck at that block's flank, which it overlaps by the closure of the joint
    below. The opening changes by up to √5 times the motion of the corner. The contact force is turned accordingly
    (`turn_out`); otherwise blocks that hit each other's edges would be thrown off with energy from nowhere.
    """
    return away if away > beyond else 2.0 * beyond - away


@kernel
def turn_out(pull: float, shear: float, out: float) -> tuple[float, float]:
    """Normal and tangential force of a contact with opening (1 − |c|) `away` + c `moved`, where c is `out`.

    `away` is the distance along the normal, and `moved` the slip; c is 0, or ±2 for a corner that emerges.
    """
    return pull * (1.0 - abs(out)), shear + pull * out


def in_space(pull: Array, shear: Array, normal: Array) -> Array:
    """Forces ``(2, n)`` along x and y from normal and tangential ones ``(n,)`` of contacts with normals ``(n, 2)``."""
    nx, ny = normal.T
    return np.array([pull * nx - shear * ny, pull * ny + shear * nx])


@kernel
def gather_sides(motion: Array, geometry: RigidSides, opening: Array, slip: Array) -> None:
    """Write opening and slip ``(np,)`` [m] of the ends of facing sides after a motion ``(3 nb,)``."""
    corners, radius, straight, ends, inwards, tilt, _, placed, contact, let_go, _ = geometry
    place_outline(motion, corners, placed)
    freedom = corners.freedom
    arcs = placed.arcs
    for row in range(inwards.size):
        k = np.uint64(row)
        v, w, e, f = ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
        dx, dy = arcs[v, 0] - arcs[w, 0], arcs[v, 1] - arcs[w, 1]
        r_v, r_w = radius[v], radius[w]
        sense = inwards[k]
        turned = motion[freedom[v] + TWO] - motion[freedom[w] + TWO] + tilt[k]
        nx, ny = arcs[f, 2], arcs[f, 3]
        along = dy * nx - dx * ny
        on_f = sense * along
        away = dx * nx + dy * ny - r_v - r_w
        moved = along - r_v * turned
        x, y = arcs[v, 0], arcs[v, 1]
        behind, out = r_v, 0.0
        if on_f >= 0.0:
            beyond = on_f - straight[f]
            far = ends[k, 3]
            if r_v + radius[far] == 0.0:
                out = 0.0 if away > beyond else 2.0 * sense
                away = sharp_opening(away, beyond)
            elif beyond > 0.0:
                dx, dy = arcs[v, 0] - arcs[far, 0], arcs[v, 1] - arcs[far, 1]
                away, moved, nx, ny = far_arcs(dx, dy, (r_v, radius[far]), -arcs[e, 2], -arcs[e, 3], nx, ny)
                moved += sense * straight[f]
        else:
            ex, ey = -arcs[e, 2], -arcs[e, 3]
            along_e = dy * ex - dx * ey
            on_e = -sense * along_e
            if on_e >= 0.0:
                nx, ny = ex, ey
                away = dx * nx + dy * ny - r_v - r_w
                moved = along_e + r_w * turned
                x, y, behind = arcs[w, 0], arcs[w, 1], -r_w
                beyond = on_e - straight[e]
                far = ends[k, 2]
                if r_w + radius[far] == 0.0:
                    out = 0.0 if away > beyond else -2.0 * sense
                    away = sharp_opening(away, beyond)
                elif beyond > 0.0:
                    dx, dy = arcs[far, 0] - arcs[w, 0], arcs[far, 1] - arcs[w, 1]
                    away, moved, nx, ny = far_arcs(dx, dy, (radius[far], r_w), ex, ey, arcs[f, 2], arcs[f, 3])
                    moved -= sense * straight[e]
            elif r_v + r_w > 0.0:
                away, nx, ny = arc_on_arc(dx, dy, r_v + r_w)
                moved = r_v * angle(nx, ny, ex, ey) + r_w * angle(nx, ny, arcs[f, 2], arcs[f, 3])
        opening[k] = away
        slip[k] = moved
        contact[k, 0] = x - behind * nx
        contact[k, 1] = y - behind * ny
        contact[k, 2] = nx
        contact[k, 3] = ny
        let_go[k] = out


@kernel
def gather_sharp(motion: Array, geometry: RigidSides, opening: Array, slip: Array) -> None:
    """As `gather_sides` for sharp corners only: conditional values in place of branches make it faster."""
    corners, _, straight, ends, inwards, _, _, placed, contact, out, held = geometry
    place_outline(motion, corners, placed)
    arcs = placed.arcs
    for row in range(inwards.size):
        k = np.uint64(row)
        v, w, e, f = ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
        x, y, sense = arcs[v, 0], arcs[v, 1], inwards[k]
        x_w, y_w = arcs[w, 0], arcs[w, 1]
        dx, dy = x - x_w, y - y_w
        nx, ny, ex, ey = arcs[f, 2], arcs[f, 3], -arcs[e, 2], -arcs[e, 3]
        along, along_e = dy * nx - dx * ny, dy * ex - dx * ey
        bears = (sense * along < 0.0) & (sense * along_e <= 0.0)
        nx, ny = (ex if bears else nx), (ey if bears else ny)
        along, way = (along_e if bears else along), (-sense if bears else sense)
        away, on = dx * nx + dy * ny, way * along
        beyond = on - (straight[e] if bears else straight[f])
        comes_out = (on >= 0.0) & (away <= beyond)
        opening[k] = 2.0 * beyond - away if comes_out else away  # `sharp_opening`
        slip[k] = along
        out[k] = 2.0 * way if comes_out else 0.0
        held[k] = bears
        contact[k, 0] = x_w if bears else x
        contact[k, 1] = y_w if bears else y
        contact[k, 2] = nx
        contact[k, 3] = ny


@kernel
def turned_by(
    apart: tuple[float, float], f: tuple[float, float], e: tuple[float, float], bears: bool
) -> tuple[float, float]:
    """Increase of opening and slip [m] when measured along e in place of f (`bears`), or along f in place of e.

    `apart` is the vector from w to v [m]; f and e are the outward normal of f and the inward normal of e.
    """
    sign = 1.0 if bears else -1.0
    nx, ny = sign * (e[0] - f[0]), sign * (e[1] - f[1])
    return apart[0] * nx + apart[1] * ny, apart[1] * nx - apart[0] * ny


@kernel
def turned_sharp(geometry: RigidSides, k: int) -> tuple[float, float]:
    """Increase of opening and slip of end k [m] when measured along the side in use now in place of the other one."""
    _, _, _, ends, _, _, _, placed, _, _, bears = geometry
    arcs, v, w, e, f = placed.arcs, ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
    apart = arcs[v, 0] - arcs[w, 0], arcs[v, 1] - arcs[w, 1]
    by: tuple[float, float] = turned_by(apart, (arcs[f, 2], arcs[f, 3]), (-arcs[e, 2], -arcs[e, 3]), bears[k])
    return by


@kernel
def reframe_sharp(geometry: RigidSides, frames: Frames, history: Array) -> None:
    """After `gather_sharp`, transform the history of ends whose jumps are now measured along the other block's side."""
    bears, (bore, plastic) = geometry[-1], frames
    # This is rare: counting the ends first takes less time than a branch for each.
    changed = 0
    for row in range(bore.size):
        changed += bears[row] != bore[row]
    if changed == 0:
        return
    for row in range(bore.size):
        k = np.uint64(row)
        if bears[k] != bore[k]:
            opening, slip = turned_sharp(geometry, k)
            retell(history, plastic, k, opening, slip)
            bore[k] = bears[k]


@kernel
def angle(nx: float, ny: float, fx: float, fy: float) -> float:
    """Angle [rad] from one unit vector f to another n."""
    return math.atan2(fx * ny - fy * nx, fx * nx + fy * ny)


@kernel
def far_arcs(
    dx: float, dy: float, radii: tuple[float, float], ex: float, ey: float, fx: float, fy: float
) -> tuple[float, float, float, float]:
    """Opening, slip and normal of two arcs with radii (r_v, r_w), over which blocks slide off each other's sides.

    ``(dx, dy)`` leads from the centre of w to that of v, ``(ex, ey)`` is the inward normal of e and ``(fx, fy)`` the
    outward normal of f. Beyond a mean tilt of 45° the arcs belong to the sides round the corners; the opening is then
    made positive, so that they are not counted twice.
    """
    r_v, r_w = radii
    away, nx, ny = arc_on_arc(dx, dy, r_v + r_w)
    of_e, of_f = angle(nx, ny, ex, ey), angle(nx, ny, fx, fy)
    if abs(of_e + of_f) > 0.5 * math.pi:
        away = abs(away)
    return away, r_v * of_e + r_w * of_f, nx, ny


@kernel
def scatter_sides(normal: Array, tangential: Array, geometry: RigidSides, force: Array) -> None:
    """Subtract the resultants of the contacts' tractions ``(np,)`` in space from forces ``(3 nb,)``."""
    corners, _, _, ends, _, _, area, placed, contact, out, _ = geometry
    freedom, cx, cy = corners.freedom, placed.blocks[2], placed.blocks[3]
    for row in range(normal.size):
        k = np.uint64(row)
        n, t = normal[k], tangential[k]
        if n == 0.0 and t == 0.0:
            continue
        b, a = freedom[ends[k, 0]], freedom[ends[k, 1]]
        x, y, nx, ny = contact[k, 0], contact[k, 1], contact[k, 2], contact[k, 3]
        pull, shear = area[k] * n, area[k] * t
        if out[k] != 0.0:
            pull, shear = turn_out(pull, shear, out[k])
        fx = pull * nx - shear * ny
        fy = pull * ny + shear * nx
        p, q = b // THREE, a // THREE
        # Computed before any write: after writes, arrays that may alias would have to be read again.
        of_b = (x - cx[p]) * fy - (y - cy[p]) * fx
        of_a = (x - cx[q]) * fy - (y - cy[q]) * fx
        force[b] -= fx
        force[b + ONE] -= fy
        force[b + TWO] -= of_b
        force[a] += fx
        force[a + ONE] += fy
        force[a + TWO] += of_a
