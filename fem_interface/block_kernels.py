"""Kinematics of blocks with modes as compiled kernels: modes to joint nodes, those to jumps, and back.

Motions are kept template by template, each a matrix Q of modes by blocks, so that the displacements of all nodes that
lie on joints are one product U = Φ Q, and the forces on the modes another, F −= Φᵀ S. Joint elements come in runs
(`runs.find_runs`), in which blocks follow one another as elements do, so that the loops run in vector registers.
Indices are unsigned, which need no check for counting from the end.
"""

from typing import Any

import numpy as np

from joints import compiled
from scene import Array

kernel = compiled.kernel


@kernel
def to_nodes(shapes: Any, motion: Array, table: Array, nodal: Array) -> None:
    """Displacements of the nodes on joints, from modal coordinates ``(nd,)``."""
    for k in range(shapes.shape[0]):
        blocks, modes, width, first, at, entry = shapes[k]
        phi = table[entry : entry + width * modes].reshape(width, modes)
        Q = motion[first : first + modes * blocks].reshape(modes, blocks)
        np.dot(phi, Q, nodal[at : at + width * blocks].reshape(width, blocks))


@kernel
def to_modes(shapes: Any, nodal: Array, table: Array, product: Array, force: Array) -> None:
    """Subtract from modal forces ``(nd,)`` those of the nodes on joints."""
    for k in range(shapes.shape[0]):
        blocks, modes, width, first, at, entry = shapes[k]
        phi = table[entry : entry + width * modes].reshape(modes, width)
        S = nodal[at : at + width * blocks].reshape(width, blocks)
        out = product[: modes * blocks]
        np.dot(phi, S, out.reshape(modes, blocks))
        into = force[first : first + modes * blocks]
        for i in range(into.size):
            into[i] -= out[i]


@kernel
def gather_modes(motion: Array, geometry: Any, opening: Array, slip: Array) -> None:
    """Opening and slip at all points, ``(np,)`` [m], from modal coordinates ``(nd,)``."""
    shapes, table, _, start, places, shares, _, still, nodal, _ = geometry
    to_nodes(shapes, motion, table, nodal)
    # What does not move shares the last entries, which scatter has written to.
    nodal[still[0] :] = 0.0
    points = shares.shape[1]
    ne = opening.size // points
    for run in range(places.shape[0]):
        low, high = start[run], start[np.uint64(run + 1)]
        for p in range(points):
            for axis in range(2):
                out = opening[p * ne : (p + 1) * ne] if axis == 0 else slip[p * ne : (p + 1) * ne]
                begun = False
                for k in range(4):
                    share = shares[run, p, axis, k]
                    a, b = places[run, k], places[run, k + 4]
                    if share != 0.0 and begun:
                        for e in range(low, high):
                            out[e] += share * (nodal[b + e] - nodal[a + e])
                    elif share != 0.0:
                        begun = True
                        for e in range(low, high):
                            out[e] = share * (nodal[b + e] - nodal[a + e])


@kernel
def scatter_modes(normal: Array, tangential: Array, geometry: Any, force: Array) -> None:
    """Subtract from modal forces ``(nd,)`` what the tractions at the points ``(np,)`` [Pa] do on the modes."""
    shapes, _, table, start, places, _, shares, _, nodal, product = geometry
    points = shares.shape[1]
    ne = normal.size // points
    nodal[:] = 0.0
    for run in range(places.shape[0]):
        low, high = start[run], start[np.uint64(run + 1)]
        for p in range(points):
            for axis in range(2):
                traction = normal[p * ne : (p + 1) * ne] if axis == 0 else tangential[p * ne : (p + 1) * ne]
                for k in range(4):
                    share = shares[run, p, axis, k]
                    a, b = places[run, k], places[run, k + 4]
                    if share != 0.0:
                        # The two sides apart, for a run may have one side's blocks a step behind the other's.
                        for e in range(low, high):
                            nodal[a + e] -= share * traction[e]
                        for e in range(low, high):
                            nodal[b + e] += share * traction[e]
    to_modes(shapes, nodal, table, product, force)
