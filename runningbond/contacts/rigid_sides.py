"""Kinematics of rigid blocks at finite displacements: two sides that face each other, and the two ends they share.

A side is straight between two corners, and a corner is an arc of radius r about a centre c, as far in from the corner
as the joints' inset (r = 0: a sharp corner). Where side e of block b lies on side f of block a, each end of their
overlap is the corner v of e or the corner w of f, whichever is farther in. With the normal n from a to b, the tangent
t, and the tilt φ of b against a,

    v rests on f:   opening n_f · (c_v − c_w) − r_v − r_w,   slip t_f · (c_v − c_w) − r_v φ
    w bears e:      opening n_e · (c_v − c_w) − r_v − r_w,   slip t_e · (c_v − c_w) + r_w φ
    arc on arc:     opening |c_v − c_w| − r_v − r_w,         slip r_v ∠(n_e, n) + r_w ∠(n_f, n),  n along the centres

Each goes over into the next without a jump, and so does their friction when a corner comes off one block's side and
its side slides on over another's. Only sharp corners that lie on each other, pressed in by δ, go over with a jump of
the slip, δ sin φ, of which no notice is taken (`reframe_sharp`). The rates of opening and slip are those of the two
blocks at the point where they touch: forces there do the work that the jumps say, and keep linear and angular momentum.
"""

import math
from typing import NamedTuple

import numpy as np

from runningbond.joints.compiled import kernel
from runningbond.joints.frames import Frames, retell
from runningbond.scene import Array, Mask, Unsigned

ONE, TWO, THREE = np.uint64(1), np.uint64(2), np.uint64(3)

QUARTER, REST = 1.57079632673412561417, 6.07710050650619224932e-11
"""π / 2 in two parts, the first with so few digits that small multiples of it are exact (fdlibm's)."""

S1, S2, S3 = -1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04
S4, S5, S6 = 2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10
C1, C2, C3 = 4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05
C4, C5, C6 = -2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11
"""Coefficients of sine and cosine up to π / 4 (fdlibm's `__kernel_sin` and `__kernel_cos`)."""


class Corners(NamedTuple):
    """The corners of undeformed blocks, in the frame of the undeformed wall."""

    centroid: Array  # (nb, 2) centroid of each block [m]
    freedom: Unsigned  # (nv,) first freedom of each corner's block
    centre: Array  # (nv, 2) centre of each corner's arc, from the centroid [m]
    normal: Array  # (nv, 2) outward normal of the side that starts at the corner


class Placed(NamedTuple):
    """Where blocks and the arcs of their corners are in space."""

    blocks: Array  # (4, nb) cosine and sine of each block's rotation, and its centroid [m]
    arcs: Array  # (nv, 4) centre of each corner's arc [m] and outward normal of the side that starts there


class RigidSides(NamedTuple):
    """What `gather_sides` and `scatter_sides` share."""

    corners: Corners  # the corners of the undeformed blocks
    # (nv,) radius of each corner's arc, and length of the side that starts there between its arcs [m]
    radius: Array
    straight: Array
    # (np, 6) of each end of facing sides e and f the corners v and w, the far corners of e and f, and e and f
    ends: Unsigned
    inwards: Array  # (np,) 1 where inwards is along the tangent of f, −1 where it is against it
    tilt: Array  # (np,) tilt of e against f, less the turns of the blocks [rad]
    area: Array  # (np,) area the end stands for [m²]
    placed: Placed  # written by `gather_sides`: the outlines in space
    contact: Array  # (np, 4) written by `gather_sides`: point of contact [m] and normal of each end
    out: Array  # (np,) written by `gather_sides`: how the pull of each end is turned (`turn_out`)
    bears: Mask  # (np,) written by `gather_sharp`: whether w bears e, else v rests on f


@kernel
def turn(motion: Array, cosine: Array, sine: Array) -> None:
    """Write cosines and sines ``(nb,)`` of rotations in a motion ``(3 nb,)``, to rounding.

    In place of the library's: so the loop runs in vector registers.
    """
    for i in range(cosine.size):
        spin = motion[3 * i + 2]
        quarters = math.floor(spin * (2.0 / math.pi) + 0.5)
        r = (spin - quarters * QUARTER) - quarters * REST
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
    """Write where blocks and arcs are after a motion ``(3 nb,)``."""
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
    """Opening of two arcs and the normal along the line of their centres ``(dx, dy)``."""
    distance = math.hypot(dx, dy)
    return distance - radii, dx / distance, dy / distance


@kernel
def sharp_opening(away: float, beyond: float) -> float:
    """Opening of a sharp corner that is `away` from a side and `beyond` its far end, both negative inside.

    A corner deeper in than it is far from that end is let go of, until twice as deep: it is coming out there, and
    belongs to the side round the end. Else a block that slides onto the next one of its course would be stuck in the
    flank of that one, by no more than the joint under it gives way. It changes by √5 times the way of the corner; its
    pull is turned by as much (`turn_out`), or blocks that hit each other's edges would be thrown away by no energy.
    """
    return away if away > beyond else 2.0 * beyond - away


@kernel
def turn_out(pull: float, shear: float, out: float) -> tuple[float, float]:
    """Normal and tangential force of a contact whose opening is (1 − |c|) `away` + c `moved`, c being `out`.

    `away` is along the normal, and `moved` the slip: c is 0, or ±2 for a corner that is let go of.
    """
    return pull * (1.0 - abs(out)), shear + pull * out


def in_space(pull: Array, shear: Array, normal: Array) -> Array:
    """Forces ``(2, n)`` along x and y, of normal and tangential ones ``(n,)`` of contacts with normals ``(n, 2)``."""
    nx, ny = normal.T
    return np.array([pull * nx - shear * ny, pull * ny + shear * nx])


@kernel
def gather_sides(motion: Array, geometry: RigidSides, opening: Array, slip: Array) -> None:
    """Opening and slip ``(np,)`` of the ends of facing sides, from motions ``(3 nb,)``."""
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
    """As `gather_sides` where all corners are sharp: with choices in place of branches, which is faster."""
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
    """By how much opening and slip [m] of corners `apart` are larger along e than along f, or the other way round.

    `apart` leads from w to v [m], f and e are the outward normal of f and the inward one of e.
    """
    sign = 1.0 if bears else -1.0
    nx, ny = sign * (e[0] - f[0]), sign * (e[1] - f[1])
    return apart[0] * nx + apart[1] * ny, apart[1] * nx - apart[0] * ny


@kernel
def turned_sharp(geometry: RigidSides, k: int) -> tuple[float, float]:
    """By how much opening and slip of end k [m] are larger along the side that bears now than along the other one."""
    _, _, _, ends, _, _, _, placed, _, _, bears = geometry
    arcs, v, w, e, f = placed.arcs, ends[k, 0], ends[k, 1], ends[k, 4], ends[k, 5]
    apart = arcs[v, 0] - arcs[w, 0], arcs[v, 1] - arcs[w, 1]
    by: tuple[float, float] = turned_by(apart, (arcs[f, 2], arcs[f, 3]), (-arcs[e, 2], -arcs[e, 3]), bears[k])
    return by


@kernel
def reframe_sharp(geometry: RigidSides, frames: Frames, history: Array) -> None:
    """After `gather_sharp`, retell the history of ends where one block's side has taken over from the other's."""
    bears, (bore, plastic) = geometry[-1], frames
    # Hardly ever any: to count them takes less time than a branch for each.
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
    """Angle from one unit vector f to another n."""
    return math.atan2(fx * ny - fy * nx, fx * nx + fy * ny)


@kernel
def far_arcs(
    dx: float, dy: float, radii: tuple[float, float], ex: float, ey: float, fx: float, fy: float
) -> tuple[float, float, float, float]:
    """Opening, slip and normal of two arcs, of radii (r_v, r_w), by which blocks come off each other's sides.

    ``(dx, dy)`` leads from the centre of w to that of v, ``(ex, ey)`` is the inward normal of e and ``(fx, fy)`` the
    outward one of f. Beyond a tilt of 45° on the average, the arcs belong to the sides round the corners; so they are
    not counted twice.
    """
    r_v, r_w = radii
    away, nx, ny = arc_on_arc(dx, dy, r_v + r_w)
    of_e, of_f = angle(nx, ny, ex, ey), angle(nx, ny, fx, fy)
    if abs(of_e + of_f) > 0.5 * math.pi:
        away = abs(away)
    return away, r_v * of_e + r_w * of_f, nx, ny


@kernel
def scatter_sides(normal: Array, tangential: Array, geometry: RigidSides, force: Array) -> None:
    """Subtract from forces ``(3 nb,)`` what the contacts' tractions ``(np,)`` do on them, in space."""
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
        # Before anything is written: what is written to might else have to be read again.
        of_b = (x - cx[p]) * fy - (y - cy[p]) * fx
        of_a = (x - cx[q]) * fy - (y - cy[q]) * fx
        force[b] -= fx
        force[b + ONE] -= fy
        force[b + TWO] -= of_b
        force[a] += fx
        force[a + ONE] += fy
        force[a + TWO] += of_a
