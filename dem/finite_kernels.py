"""Kinematics of rigid blocks at finite displacements: corners that rest on the faces of turning blocks.

Each contact has an owner, whose corner it is, and a face, which turns with its block and carries the normal. The
force acts at the corner on both blocks, so that linear and angular momentum are kept whatever slides.
"""

import math

import numpy as np

from joints import compiled
from scene import Array

kernel = compiled.kernel
ONE, TWO = np.uint64(1), np.uint64(2)
DEEPEST = 1e-3
"""Penetration, in lengths of the face, beyond which a corner is not taken to rest on it."""

OPEN = 1.0
"""Opening [m] reported of a corner that has left its face: no joint bears it."""


@kernel
def gather_finite(motion: Array, geometry: tuple[Array, ...], opening: Array, slip: Array) -> None:
    """Opening and slip ``(np,)`` of corners on faces, from motions ``(3 nb,)``.

    `geometry` is owner and face freedoms; corner and face point in their blocks; normal in the face's block; sense
    (1 where the owner is the joint's block b); centroids; bounds of the corner along the face; and, written, cosine,
    sine and place of the blocks, and corner and normal in space with a flag of contact.
    """
    owner, face, corner, foot, frame, sense, centroid, bounds, turned, spatial = geometry
    for i in range(turned.shape[0]):
        spin = motion[3 * i + 2]
        turned[i, 0] = math.cos(spin)
        turned[i, 1] = math.sin(spin)
        turned[i, 2] = centroid[i, 0] + motion[3 * i]
        turned[i, 3] = centroid[i, 1] + motion[3 * i + 1]
    for k in range(owner.size):
        o, f = owner[k], face[k]
        p, q = o // np.uint64(3), f // np.uint64(3)
        x = turned[p, 2] + turned[p, 0] * corner[k, 0] - turned[p, 1] * corner[k, 1]
        y = turned[p, 3] + turned[p, 1] * corner[k, 0] + turned[p, 0] * corner[k, 1]
        c, s = turned[q, 0], turned[q, 1]
        dx = x - turned[q, 2] - c * foot[k, 0] + s * foot[k, 1]
        dy = y - turned[q, 3] - s * foot[k, 0] - c * foot[k, 1]
        nx = c * frame[k, 0] - s * frame[k, 1]
        ny = s * frame[k, 0] + c * frame[k, 1]
        away = sense[k] * (dx * nx + dy * ny)
        along = sense[k] * (dy * nx - dx * ny)
        # A corner deep inside has come in from the side, not through the face, and would be shot out again.
        touching = bounds[k, 0] <= along <= bounds[k, 1] and away > -DEEPEST * (bounds[k, 1] - bounds[k, 0])
        opening[k] = away if touching else OPEN
        slip[k] = along
        spatial[k, 0] = x
        spatial[k, 1] = y
        spatial[k, 2] = nx
        spatial[k, 3] = ny
        spatial[k, 4] = 1.0 if touching else 0.0


@kernel
def scatter_finite(normal: Array, tangential: Array, geometry: tuple[Array, ...], force: Array) -> None:
    """Subtract from forces ``(3 nb,)`` what the contacts' forces ``(np,)`` do on them, in space."""
    owner, face, sense, turned, spatial = geometry[0], geometry[1], geometry[5], geometry[8], geometry[9]
    for k in range(owner.size):
        o, f = owner[k], face[k]
        x, y, nx, ny = spatial[k, 0], spatial[k, 1], spatial[k, 2], spatial[k, 3]
        pull = sense[k] * spatial[k, 4]
        fx = pull * (normal[k] * nx - tangential[k] * ny)
        fy = pull * (normal[k] * ny + tangential[k] * nx)
        force[o] -= fx
        force[o + ONE] -= fy
        force[f] += fx
        force[f + ONE] += fy
        p, q = o // np.uint64(3), f // np.uint64(3)
        force[o + TWO] -= (x - turned[p, 2]) * fy - (y - turned[p, 3]) * fx
        force[f + TWO] += (x - turned[q, 2]) * fy - (y - turned[q, 3]) * fx
