"""Natural vibrations of a wall about its state at rest: closed joints act as springs, open joints have no stiffness.

With opening rows b_n, slip rows b_t and areas w of closed points, and elongation rows g of ties that are neither slack
nor yielding,

    K = diag(k) + B_nᵀ diag(w k_n) B_n + B_tᵀ diag(w k_t) B_t + Gᵀ diag(E A / L) G,    K φ = ω² M φ.

For a joint that stiffens with pressure, k_n is the tangent at its pressure at rest; for a softened joint that is open,
k_n is the secant of unloading. The weight closes the joints; its other effect, the moment of a leaning block, is not
included in K.
"""

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import csr_array, diags_array
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import ArpackError, eigsh

from runningbond.dynamics import U_CRIT, BlockSystem, Criteria, Run, State, put_on_dead_load
from runningbond.dynamics.ties import YIELD
from runningbond.dynamics.vibrations import stiffness_matrix
from runningbond.scene import Array, Scene, SceneError
from runningbond.scene.ranges import check_whole_number

DENSE = 200
"""Degrees of freedom up to which all modes are computed at once."""

PRESSED = 1e-6
"""Pressure, relative to the largest traction, above which a joint is closed: contacts without load have some by
rounding. Bonded joints below their tensile strength are closed too."""

LOOSE = 1e-6
"""ω, relative to (an estimate of) the largest, up to which a motion is not held by any closed joint."""


@dataclass(frozen=True, eq=False)
class Vibration:
    """Natural vibrations in ascending order of frequency.

    Parameters
    ----------
    frequency : (n,) float
        Natural frequencies [Hz].
    shape : (n, nb, 3) float
        Translation of each block's centroid and its rotation [m, m, rad], for a modal mass of 1 kg.
    share : (n, 2) float
        Effective modal mass as a share of the moving mass, for horizontal and vertical ground motion.
    loose
        Number of motions that no closed joint holds; they are left out.
    """

    frequency: Array
    shape: Array
    share: Array
    loose: int = 0


def vibration_at_rest(scene: Scene, run: Run, count: int = 10) -> Vibration:
    """Natural vibrations of a wall under its dead load, at small displacements, `count` at most.

    Raises
    ------
    SceneError
        If the wall does not come to rest or is not under compression, or if `count` is not a valid number.
    """
    check_whole_number("count", count)
    loaded = put_on_dead_load(run, Criteria(collapse=U_CRIT * scene.block_sizes[run.system.owner]))
    if loaded.verdict != "stable":
        raise SceneError(scene.title, "does not come to rest under its dead load")
    return vibration(Run(_with_true_beam(scene, run.system.held_late)), loaded.state, count)


def _with_true_beam(scene: Scene, system: BlockSystem) -> BlockSystem:
    """The system with the mass of the beam that applies in vibrations (`Scene.density_in_motion`)."""
    mass, density = system.mass.copy(), scene.density_in_motion / scene.inertial_density
    mass[system.rigid] *= density[system.owner][:, None]
    return replace(system, mass=mass)


def vibration(run: Run, state: State, count: int = 10) -> Vibration:
    """Natural vibrations of a wall about a state at rest, at small displacements."""
    system = run.system
    opening, _, normal, _ = run.tractions(state)
    law, damage = run.interface.law, run.interface.law.damage(state.history)
    pull, most = system.ties.force(state.motion, state.stretch), system.ties.constants[:, YIELD]
    closed = (normal < -PRESSED * np.abs(normal).max(initial=0.0)) | (
        (law.tension > 0) & (damage < 1) & (normal < law.tension)
    )
    moving = np.flatnonzero(np.isfinite(system.mass))
    jump = opening + law.plastic_closure(state.history)
    torn = (damage > 0) & (jump > 0)
    tangent = law.normal_tangent(np.maximum(0.0, -normal))
    springs = closed * np.array([np.where(torn, normal / np.where(torn, jump, 1.0), tangent), law.shear_stiffness])
    stiffness = stiffness_matrix(system, springs, (pull > 0) & (pull < most))[moving][:, moving]
    root = 1 / np.sqrt(system.mass[moving])
    scaled = diags_array(root) @ stiffness @ diags_array(root)
    count = min(count, len(moving))
    if not closed.any():
        raise SceneError("load.gravity", "closes no joint: a wall that is not pressed together does not vibrate")
    square, vectors, loose = _slowest(scaled, count, LOOSE**2 * float(scaled.diagonal().max()))
    modes = np.zeros((len(square), len(system.mass)))
    modes[:, moving] = (root[:, None] * vectors).T
    ground = system.mass_along
    share = (modes @ ground.T) ** 2 / ground.sum(axis=1)
    shape = np.array([system.motion_of_blocks(mode) for mode in modes])
    return Vibration(np.sqrt(square) / (2 * np.pi), shape.reshape(len(square), -1, 3), share, loose)


def _slowest(scaled: csr_array, count: int, least: float) -> tuple[Array, Array, int]:
    """The `count` smallest eigenvalues of a symmetric matrix above `least`, ascending.

    Also returns their eigenvectors, and the number of eigenvalues not above `least`. Each connected part is solved
    separately: the Lanczos method finds only one of several equal eigenvalues, which equal stacks and loose blocks
    have.
    """
    scaled.eliminate_zeros()
    bodies, body = connected_components(scaled, directed=False)
    rows = [np.flatnonzero(body == k) for k in range(bodies)]
    found = [_slowest_of_body(scaled[own][:, own], count, least) for own in rows]
    square = np.concatenate([each[0] for each in found])
    place = [(k, column) for k, (held, _, _) in enumerate(found) for column in range(len(held))]
    order = np.argsort(square, kind="stable")[:count]
    vectors = np.zeros((scaled.shape[0], len(order)))
    for i, (k, column) in enumerate(place[j] for j in order):
        vectors[rows[k], i] = found[k][1][:, column]
    return square[order], vectors, sum(loose for _, _, loose in found)


def _slowest_of_body(scaled: csr_array, count: int, least: float) -> tuple[Array, Array, int]:
    """As `_slowest`, for one connected part; any number of loose motions may be slower than all others."""
    sought, size = count, scaled.shape[0]
    while True:
        square, vectors = _eigenvectors(scaled, sought, -least)
        held = square > least
        if held.sum() >= count or len(square) == size:
            return square[held][:count], vectors[:, held][:, :count], int((~held).sum())
        sought *= 2


def _eigenvectors(scaled: csr_array, count: int, shift: float) -> tuple[Array, Array]:
    """Eigenvalues of a symmetric matrix, ascending, and eigenvectors: all of a small one, else more than `count`.

    Every eigenvalue must be above `shift`.
    """
    size = scaled.shape[0]
    if size > max(DENSE, 3 * count):
        start = np.random.default_rng(0).standard_normal(size)
        with suppress(ArpackError):  # with many equal eigenvalues the subspace may be exhausted
            square, vectors = eigsh(scaled.tocsc(), k=count + 6, sigma=shift, which="LM", v0=start)
            order = np.argsort(square)
            return square[order], vectors[:, order]
    return eigh(scaled.toarray())
