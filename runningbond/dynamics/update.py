"""The update of a step: velocities and motions from forces, with damping, for uncoupled or coupled modes.

Local damping α resists every mode by α times the force on it (Cundall 1987). Walls come to rest soonest with it, but it
slows down drift with superposed vibration: a wall may creep under it that would fall. Combined damping resists by as
much, but only while that force changes against the velocity, as always in a vibration (Itasca): it leaves drift alone
unless the force on it vibrates without end, as where sliding stones chatter.
"""

from typing import Any, Literal, TypeAlias

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import Array, Unsigned

from .clusters import Clusters, sum_up
from .system import BlockSystem, Kernel

kernel, inlined = compiled.kernel, compiled.inlined

Modes: TypeAlias = tuple[Array, Array, Array]
"""Stiffness [N/m], viscosity [N s/m] and inverse mass [1/kg] of each mode, ``(nd,)``; the last is zero if held."""

StateArrays: TypeAlias = tuple[Array, Array, Array, Array, Array]
"""Motion, velocity, history, damped and unbalanced of a `State`, which the steps write to."""

ROW_MULTIPLE = 8
"""Rows of M⁻¹ below are padded with zeros to a multiple of this number of entries, as many as registers hold."""

Coupled: TypeAlias = tuple[Unsigned, Array, Array, Array, Array, Array, Array, Array, Array, Array]
"""Coupled modes ``(n,)``; rows of their M⁻¹ [1/kg] and their own masses [kg], as long as a row; their accelerations of
the step before, which steps write to, and six buffers."""

Clustered: TypeAlias = tuple[Any, ...]
"""All but the last of `Clusters`, three motions of clusters ``(nc, 3)`` and 1 / (1 + β); masses of the modes [kg], zero
where held, and three accelerations, ``(nd,)`` each: undamped, damped with their own masses, and damped in clusters."""

Damping: TypeAlias = Literal["local", "combined"]
"""Damping of uncoupled modes; coupled modes always have combined damping, and bodies in clusters local damping."""


def update_of(system: BlockSystem, damping: Damping) -> tuple[Kernel, tuple[Any, ...]]:
    """The update of a system, and its memory: what it uses and writes to apart from modes and state."""
    if len(system.clusters.cluster):
        return update_clusters, _memory_of(system.clusters, system.mass)
    freedom, inertia = system.coupling
    if not len(freedom):
        # Local damping does not use the memory, but one type for both means that the loop over steps is compiled once.
        return update if damping == "local" else update_combined, (np.zeros(len(system.mass)),)
    n = len(freedom)
    rows = -(-n // ROW_MULTIPLE) * ROW_MULTIPLE
    mobility, mass = np.zeros((rows, rows)), np.zeros(rows)
    mass[:n] = system.mass[freedom]
    mobility[:n, :n] = np.linalg.inv(np.diag(mass[:n]) + inertia)
    buffers = np.zeros((7, rows))
    modes = freedom.astype(np.uint64)  # signed indices would be checked for being negative
    return update_coupled, (modes, mobility.ravel(), mass, *buffers)


def _memory_of(clusters: Clusters, mass: Array) -> Clustered:
    """Memory of the update of bodies in clusters, for modes with masses ``(nd,)`` [kg]."""
    *arrays, more = clusters
    return (
        *arrays,
        *np.zeros((3, clusters.number, 3)),
        1 / (1 + more),
        np.where(np.isfinite(mass), mass, 0.0),
        *np.zeros((3, len(mass))),
    )


def _alone(combined: bool) -> Any:
    """Compile the update of uncoupled modes, with combined or local damping."""

    @kernel
    def alone(modes: Modes, memory: Any, state: StateArrays, local: float, dt: float) -> None:
        stiffness, viscosity, mobility = modes
        motion, velocity, _, damped, force = state
        for i in range(motion.size):
            before = velocity[i]
            viscous = viscosity[i] * before
            f = force[i] - stiffness[i] * motion[i] - viscous
            force[i] = f
            sense = (1.0 if before > 0.0 else 0.0) - (1.0 if before < 0.0 else 0.0)
            if combined:
                last = memory[0]
                change = f - last[i]
                last[i] = f
                if sense * change >= 0.0:
                    sense = 0.0
            resisted = local * abs(f) * sense
            after = before + dt * mobility[i] * (f - resisted)
            damped[i] += 0.5 * dt * (resisted + viscous) * (before + after)
            motion[i] += dt * after
            velocity[i] = after

    return alone


update, update_combined = _alone(combined=False), _alone(combined=True)


@kernel
def _multiply(matrix: Array, factor: Array, out: Array) -> None:
    """Product with a symmetric matrix ``(n²,)``, n a multiple of four: the same result at any vector register width.

    It takes four rows at once, because sums are read and written once per pass.
    """
    n, k, four = np.uint64(out.size), np.uint64(0), np.uint64(4)
    out[:] = 0.0
    while k < n:
        i1 = k * n
        i2, i3, i4 = i1 + n, i1 + n + n, i1 + n + n + n
        a, b, c, d = factor[k], factor[k + np.uint64(1)], factor[k + np.uint64(2)], factor[k + np.uint64(3)]
        for e in range(n):
            out[e] += a * matrix[i1 + e] + b * matrix[i2 + e] + c * matrix[i3 + e] + d * matrix[i4 + e]
        k += four


_update_here = inlined(update.py_func)  # a call takes longer than the update of a hundred modes


@kernel
def update_coupled(modes: Modes, coupling: Coupled, state: StateArrays, local: float, dt: float) -> None:
    """`update` if some modes are coupled by inertia; these have combined damping.

    The damping is α times the force m a that accelerates a mode's own mass m, with a = M⁻¹ f without damping. It takes
    energy from each mode, and makes a at most 1 + α times as large: 0 ≤ M⁻¹ m M⁻¹ ≤ M⁻¹.
    """
    freedom, mobility, mass, last, before, place, spent, damping, force, free = coupling
    motion, velocity, _, damped, unbalanced = state
    for k in range(freedom.size):
        i = freedom[k]
        before[k], place[k], spent[k] = velocity[i], motion[i], damped[i]
    _update_here(modes, coupling, state, local, dt)
    for k in range(freedom.size):  # coupled modes are integrated again, together, from their old state
        force[k] = unbalanced[freedom[k]]
    _multiply(mobility, force, free)
    for k in range(force.size):
        change = free[k] - last[k]
        last[k] = free[k]
        sense = (1.0 if before[k] > 0.0 else 0.0) - (1.0 if before[k] < 0.0 else 0.0)
        resisted = local * mass[k] * abs(free[k]) * sense
        damping[k] = resisted if sense * change < 0.0 else 0.0
        force[k] -= damping[k]
    _multiply(mobility, force, free)
    for k in range(force.size):
        after = before[k] + dt * free[k]
        spent[k] += 0.5 * dt * damping[k] * (before[k] + after)
        place[k] += dt * after
        before[k] = after
    for k in range(freedom.size):
        i = freedom[k]
        motion[i], velocity[i], damped[i] = place[k], before[k], spent[k]


@inlined
def _damped(pace: float, drift: float, local: float) -> float:
    """An acceleration reduced by local damping against a velocity."""
    sense = (1.0 if drift > 0.0 else 0.0) - (1.0 if drift < 0.0 else 0.0)
    return pace - local * abs(pace) * sense


@kernel
def update_clusters(modes: Modes, memory: Clustered, state: StateArrays, local: float, dt: float) -> None:
    """`update` of bodies in clusters: local damping acts on the clusters, and on the relative motion of their bodies.

    If a body were resisted by α times the force on it, the vibration of its cluster would slow down its drift, and its
    share of that force is 1 + β times as large as the one that accelerates it.
    """
    stiffness, viscosity, mobility = modes
    motion, velocity, _, damped, force = state
    freedom, cluster, arm, part, together, moving, excess, least, mass, undamped, free, pace = memory
    for i in range(motion.size):
        f = force[i] - stiffness[i] * motion[i] - viscosity[i] * velocity[i]
        force[i] = f
        undamped[i] = mobility[i] * f
        pace[i] = free[i] = _damped(undamped[i], velocity[i], local)
    sum_up(freedom, cluster, arm, part, undamped, together)
    sum_up(freedom, cluster, arm, part, velocity, moving)
    excess[:] = 0.0  # effect of the damping of relative motion on the clusters, to be removed
    for k in range(cluster.size):
        c, x, y = cluster[k], arm[k, 0], arm[k, 1]
        i, j, r = freedom[k, 0], freedom[k, 1], freedom[k, 2]
        spin, turn = together[c, 2], moving[c, 2]
        u = _damped(undamped[i] - together[c, 0] + y * spin, velocity[i] - moving[c, 0] + y * turn, local)
        v = _damped(undamped[j] - together[c, 1] - x * spin, velocity[j] - moving[c, 1] - x * turn, local)
        w = _damped(undamped[r] - spin, velocity[r] - turn, local)
        free[i], free[j], free[r] = u, v, w
        excess[c, 0] += part[k, 0] * u
        excess[c, 1] += part[k, 0] * v
        excess[c, 2] += part[k, 1] * (x * v - y * u) + part[k, 2] * w
    for c in range(together.shape[0]):
        for d in range(3):
            together[c, d] = _damped(together[c, d], moving[c, d], local)
    for k in range(cluster.size):
        c, x, y = cluster[k], arm[k, 0], arm[k, 1]
        i, j, r = freedom[k, 0], freedom[k, 1], freedom[k, 2]
        spin, turn = together[c, 2], excess[c, 2]
        u, v = together[c, 0] - y * spin, together[c, 1] + x * spin
        along, across, about = free[i] - excess[c, 0] + y * turn, free[j] - excess[c, 1] - x * turn, free[r] - turn
        free[i], free[j], free[r] = u + along, v + across, spin + about
        pace[i], pace[j], pace[r] = u + least * along, v + least * across, spin + least * about
    for i in range(motion.size):
        before = velocity[i]
        after = before + dt * pace[i]
        damped[i] += 0.5 * dt * (mass[i] * (undamped[i] - free[i]) + viscosity[i] * before) * (before + after)
        motion[i] += dt * after
        velocity[i] = after
