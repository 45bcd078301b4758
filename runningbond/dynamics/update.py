"""The update of a step: velocities and motions from forces, with damping; of modes alone, or of some together.

Local damping α resists every mode by α times the force on it (Cundall 1987). That comes to rest soonest, and drags on
what drifts while it shakes: a wall may creep under it that would fall. Combined damping resists by the same only while
that force changes against the velocity, as in a vibration it does all the time (Itasca), and lets drift what drifts.
"""

from typing import Any, Literal, TypeAlias, cast

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import Array, Indices

from .system import BlockSystem, Kernel

kernel = compiled.kernel

Modes: TypeAlias = tuple[Array, Array, Array]
"""Stiffness [N/m], viscosity [N s/m] and one over the mass [1/kg] of each mode, ``(nd,)``; the last zero where held."""

StateArrays: TypeAlias = tuple[Array, Array, Array, Array, Array]
"""Motion, velocity, history, damped and unbalanced of a `State`, which the steps write to."""

Coupled: TypeAlias = tuple[Indices, Array, Array, Array, Array, Array, Array, Array, Array]
"""Modes with inertia in common ``(n,)``, M⁻¹ of them row by row ``(n²,)`` [1/kg] and their own masses [kg]; their
accelerations of the step before, which steps write to, and five buffers, ``(n,)`` each."""


Damping: TypeAlias = Literal["local", "combined"]
"""How modes with masses of their own are damped; those with inertia in common are by combined damping."""


def update_of(system: BlockSystem, damping: Damping) -> tuple[Kernel, tuple[Any, ...]]:
    """The update of a system, and its memory: what it takes and writes to besides modes and state."""
    freedom, inertia = system.coupling
    if not len(freedom):
        return (update, ()) if damping == "local" else (update_combined, (np.zeros(len(system.mass)),))
    own = system.mass[freedom]
    mobility = np.asarray(np.linalg.inv(np.diag(own) + inertia).ravel(), dtype=np.float64)
    last, before, place, damped, force, free = np.zeros((6, len(freedom)))
    coupled: Coupled = (freedom, mobility, own, last, before, place, damped, force, free)
    return update_coupled, coupled


def _alone(combined: bool) -> Kernel:
    """Compile the update of modes by their own masses, `combined` or by local damping."""

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

    return cast(Kernel, alone)


update, update_combined = _alone(combined=False), _alone(combined=True)


@kernel
def _multiply(matrix: Array, factor: Array, out: Array) -> None:
    """Product with a symmetric matrix ``(n²,)``; row after row, in which vector registers of any width do the same."""
    n = np.uint64(out.size)
    out[:] = 0.0
    for k in range(n):
        value, row = factor[k], k * n
        for i in range(n):
            out[i] += value * matrix[row + i]


@kernel
def update_coupled(modes: Modes, coupling: Coupled, state: StateArrays, local: float, dt: float) -> None:
    """`update` where some modes have inertia in common, which combined damping resists.

    It is α of the force m a that accelerates a mode's own mass m, a = M⁻¹ f without damping. It takes energy from each
    mode, and makes a at most 1 + α times as large: 0 ≤ M⁻¹ m M⁻¹ ≤ M⁻¹.
    """
    freedom, mobility, mass, last, before, place, damping, force, free = coupling
    motion, velocity, _, damped, unbalanced = state
    for k in range(freedom.size):
        i = freedom[k]
        before[k], place[k], damping[k] = velocity[i], motion[i], damped[i]
    update(modes, coupling, state, local, dt)
    for k in range(freedom.size):  # these go on together, from where they were
        i = freedom[k]
        damped[i], force[k] = damping[k], unbalanced[i]
    _multiply(mobility, force, free)
    for k in range(freedom.size):
        change = free[k] - last[k]
        last[k] = free[k]
        against = (before[k] > 0.0 and change < 0.0) or (before[k] < 0.0 and change > 0.0)
        sense = (1.0 if before[k] > 0.0 else -1.0) if against else 0.0
        damping[k] = local * mass[k] * abs(free[k]) * sense
        force[k] -= damping[k]
    _multiply(mobility, force, free)
    for k in range(freedom.size):
        i, after = freedom[k], before[k] + dt * free[k]
        damped[i] += 0.5 * dt * damping[k] * (before[k] + after)
        motion[i] = place[k] + dt * after
        velocity[i] = after
