"""Reduction of a wall's lowest natural frequencies by larger masses."""

from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array, diags_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import LinearOperator, eigsh, splu

from runningbond.joints.wall_points import wall_stiffness
from runningbond.scene import Array

from .joint_elements import nodal_jump
from .modal_wall import ModalWall

GROUND_STIFFNESS = 1e-9
"""Stiffness of springs to the ground per mass, relative to the largest ω²; they let floating bodies vibrate too."""

DENSE = 400
"""Number of coordinates of a body up to which its matrices are dense; larger ones are sparse."""


def modal_stiffness(wall: ModalWall, *, closed: bool = False) -> csr_array:
    """Stiffness of a wall with no open joints, in the moving coordinates, ``(n, n)`` [N/m].

    Joints that close under pressure have their initial stiffness or, if `closed`, their largest.
    """
    of_node, of_coordinate, values = [], [], []
    for template, first in zip(wall.templates, wall.first, strict=False):
        n, shape = len(template.blocks), template.modes.shape
        row, mode = np.nonzero(shape)
        of_node.append(2 * wall.mesh.first_node[template.blocks][:, None] + row)
        of_coordinate.append(first + mode * n + np.arange(n)[:, None])
        values.append(np.tile(shape[row, mode], (n, 1)))
    entries = [np.concatenate([part.ravel() for part in parts]) for parts in (values, of_node, of_coordinate)]
    basis = csr_array((entries[0], (entries[1], entries[2])), shape=(2 * len(wall.mesh.points), len(wall.mass)))
    jump, points = nodal_jump(wall.elements, len(wall.mesh.points)), wall.elements.points
    moving, springs = np.flatnonzero(np.isfinite(wall.mass)), wall_stiffness(wall.scene, points.joint, closed=closed)
    result = diags_array(wall.stiffness).tocsr()
    for operator, stiffness in zip((jump.opening, jump.slip), springs, strict=True):
        B = operator @ basis
        result = result + B.T @ (B * (stiffness * points.area)[:, None])
    return csr_array(result[moving][:, moving])


def frequency_shift(wall: ModalWall, count: int, highest: float) -> Callable[[Array], float]:
    """A function that returns the largest relative drop of a wall's lowest frequencies when its masses change.

    Parameters
    ----------
    wall
        The wall.
    count
        Number of frequencies compared.
    highest
        The wall's largest ω² [1/s²], roughly.

    Returns
    -------
    callable
        Takes modal masses ``(nd,)`` [kg].
    """
    moving = np.isfinite(wall.mass)
    stiffness = csc_array(modal_stiffness(wall) + diags_array(GROUND_STIFFNESS * highest * wall.mass[moving]))
    bodies, body = connected_components(stiffness, directed=False)
    rows = [np.flatnonzero(body == k) for k in range(bodies)]
    lowest_of = [(own, lowest_frequencies(csc_array(stiffness[own][:, own]), count)) for own in rows]

    def lowest(mass: Array) -> Array:
        """The `count` smallest ω² [1/s²] of all bodies, ascending."""
        return np.sort(np.concatenate([of_body(mass[moving][own]) for own, of_body in lowest_of]))[:count]

    exact = lowest(wall.mass)
    return lambda mass: float((1 - np.sqrt(lowest(mass) / exact)).max())


def lowest_frequencies(stiffness: csc_array, count: int) -> Callable[[Array], Array]:
    """A function that returns a body's smallest ω² [1/s²] for its masses ``(n,)``.

    The body must be connected: equal bodies have equal frequencies, of which Lanczos' method finds only one.
    """
    n = stiffness.shape[0]
    if n <= DENSE:
        # Solve M x = K x / ω², because K x = ω² M x has errors relative to the highest ω², far above the lowest.
        K, slowest = stiffness.toarray(), (max(n - count, 0), n - 1)
        return lambda mass: 1 / eigh(np.diag(mass), K, eigvals_only=True, subset_by_index=slowest)
    # A symmetric ordering causes less fill-in than the default ordering for general matrices.
    factors = splu(stiffness, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    inverse = LinearOperator((n, n), factors.solve, dtype=np.float64)
    start = np.random.default_rng(0).standard_normal(n)

    def lowest(mass: Array) -> Array:
        M = diags_array(mass).tocsc()
        return np.asarray(eigsh(stiffness, count, M, sigma=0.0, OPinv=inverse, v0=start, return_eigenvectors=False))

    return lowest
