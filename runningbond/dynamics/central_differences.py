"""Central differences with lagged viscous and local damping, compiled for any kinematics and any law.

Each step gathers the jumps, evaluates the law at all points, scatters the forces and updates each mode:

    f = f_dead + λ f_live − K q − Bᵀ t(B q) − c v⁻
    v⁺ = v⁻ + Δt (f − α |f| sign v⁻) / m
    q⁺ = q + Δt v⁺

with v half a step behind q (Cundall & Strack 1979; Munjiza 2004).
"""

from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from runningbond.joints import compiled
from runningbond.scene import Array, Indices

from .kernel_calls import advance, gather, reframe, respond, scatter
from .rig import turn_rig
from .ties import pull
from .turning_loads import turn_live, turn_loads, work_of_turned
from .turning_supports import turn_supports
from .update import Modes, StateArrays

kernel, inlined, copy_into = compiled.kernel, compiled.inlined, compiled.copy_into

Work: TypeAlias = tuple[Array, Array, Array, Array, Array, Array]
"""Buffers: motion and load ``(nd,)``, then opening, slip, normal and tangential traction of the points, ``(np,)``."""

Watch: TypeAlias = tuple[int, float, Array]
"""Steps taken before; energy [J] supplied to the state except the work of the loads that are constant now, inf if
energy is not checked; the largest energy supplied so far ``(1,)`` [J], updated in place.

These are plain tuples: unpacking a named one would add a tenth to the time of each kernel call for a small wall.
"""

Scales: TypeAlias = tuple[float, float, float]
"""Time step [s], local damping α, and the ratio of the joints' viscosity to their stiffness, in time steps."""

Control: TypeAlias = Literal["held", "driven", "carried"]
"""What is prescribed: the loads; the dead load and the power of the live load; or the dead load and held velocities."""

CONTROLS: tuple[Control, ...] = get_args(Control)
"""Names of the controls, in the order of the numbers `HELD`, `DRIVEN` and `CARRIED`."""

HELD, DRIVEN, CARRIED = range(3)

STEPS_PER_LOAD = 20
"""Number of steps over which a rising load is kept constant."""

LOOK = 100
"""Number of steps between two energy checks."""

CERTAIN_SHARE = 0.05
"""Fraction of the kinetic and elastic energy that a stable run must at least have been supplied with.

Of the work W of the loads, central differences turn E into kinetic and elastic energy and dissipate D, with
W = D + E + R to rounding, where |R| ≤ (Δt / Δt_critical) E because velocities are half a step behind. So a stable run
has W ≥ D + (1 − Δt / Δt_critical) E; this fraction is safe up to 0.95 of the critical step. When an oscillation returns
to its start, W passes through zero, but the velocity half a step before does not: so the largest W so far counts.
"""

LARGEST_DISSIPATION = 2.0
"""Ratio of dissipated to supplied energy above which a run is unstable: 1 in theory, but D is summed step by step."""


@kernel
def _restrained(motion: Array, freedom: Indices, basis: Array, moved: Array) -> None:
    copy_into(moved, motion)
    for r in range(freedom.shape[0]):
        for row in range(3):
            total = 0.0
            for column in range(3):
                total += basis[r, row, column] * motion[freedom[r, column]]
            moved[freedom[r, row]] = total


@kernel
def _project(force: Array, freedom: Indices, basis: Array) -> None:
    for r in range(freedom.shape[0]):
        x, y, m = force[freedom[r, 0]], force[freedom[r, 1]], force[freedom[r, 2]]
        for column in range(3):
            force[freedom[r, column]] = basis[r, 0, column] * x + basis[r, 1, column] * y + basis[r, 2, column] * m


@kernel
def _is_stable(given: float, load: Array, modes: Modes, state: StateArrays, most: Array) -> bool:
    """Whether kinetic, elastic and dissipated energy are within the energy supplied [J]; False if any is NaN.

    The supply is `given` and the work of a load that was constant; `most` keeps its largest value. The work of the
    joints is left out: at high frequencies the work of their viscosity is overestimated, and in a wall that vibrates
    without damping so is that of their friction.
    """
    stiffness, _, mobility = modes
    motion, velocity, _, damped, _ = state
    supplied = given
    held = 0.0
    spent = 0.0
    for i in range(motion.size):
        supplied += load[i] * motion[i]
        if mobility[i] > 0.0:  # held modes may be moved, but have no inertia and no damping
            held += 0.5 * velocity[i] * velocity[i] / mobility[i]
            spent += damped[i]
        held += 0.5 * stiffness[i] * motion[i] * motion[i]
    most[0] = max(most[0], supplied)
    # Local damping that makes a mode unstable supplies energy instead of dissipating it.
    return bool(max(spent, 0.0) + CERTAIN_SHARE * held <= LARGEST_DISSIPATION * most[0])


@kernel
def _dot(one: Array, other: Array) -> float:
    total = 0.0
    for i in range(one.size):
        total += one[i] * other[i]
    return total


@kernel
def _carry(live: Array, speed: float, velocity: Array, force: Array) -> float:
    """Prescribe the velocity of held modes; return the force on these modes, per unit of their motion."""
    pressed = 0.0
    for i in range(live.size):
        if live[i] != 0.0:
            pressed += live[i] * force[i]
            velocity[i] = speed * live[i]
    return pressed


@kernel
def _drive(live: Array, response: float, modes: Modes, state: StateArrays) -> float:
    """Add the multiple of the live load that keeps its power constant, and return it."""
    stiffness, viscosity, mobility = modes
    motion, velocity, _, _, force = state
    pushed = 0.0
    for i in range(live.size):
        pushed += live[i] * mobility[i] * (force[i] - stiffness[i] * motion[i] - viscosity[i] * velocity[i])
    multiplier = -pushed / response
    for i in range(live.size):
        force[i] += multiplier * live[i]
    return multiplier


@kernel
def _restore_speed(
    live: Array, response: float, speed: float, mobility: Array, dt: float, motion: Array, velocity: Array
) -> float:
    """Restore the prescribed speed, which local damping of the live load has reduced; return the multiplier needed."""
    returned: float = (speed - _dot(live, velocity)) / (dt * response)
    for i in range(live.size):
        change = dt * returned * mobility[i] * live[i]
        velocity[i] += change
        motion[i] += dt * change
    return returned


@inlined
def _at_constant_loads(
    control: int, steps: int, scales: Scales, load: Array, live: Array, speed: float, arrays: Any, watch: Watch
) -> tuple[int, bool, float, float]:
    """The steps of `step` during which loads are constant."""
    dt, local, joint_viscosity = scales
    addresses, geometry, parameters, modes, restraint, ties, far, memory, state, work, frames = arrays
    rig, dead_loads, live_loads, supports = far
    _, _, mobility = modes
    motion, velocity, history, _, force = state
    freedom, basis = restraint
    moved, _, opening, slip, normal, tangential = work
    already, given, most = watch
    at_gather, at_reframe, at_law, at_scatter, at_update = addresses
    driven, carried, tied, rigged = control == DRIVEN, control == CARRIED, ties[6].size > 0, rig[0].size > 0
    turns, pushes = dead_loads[2].size > 0, driven and live_loads[2].size > 0
    response, total, worked, multiplier, before, moment = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if driven:
        for i in range(live.size):
            response += live[i] * mobility[i] * live[i]
    restrained = freedom.size > 0
    unrestrained = moved if restrained else motion
    for taken in range(steps):
        if restrained:
            _restrained(motion, freedom, basis, moved)
        gather(at_gather, unrestrained, geometry, opening, slip)
        reframe(at_reframe, geometry, frames, history)
        respond(at_law, opening, slip, parameters, history, joint_viscosity, normal, tangential)
        if restrained:
            force[:] = 0.0
        else:
            copy_into(force, load)
        scatter(at_scatter, normal, tangential, geometry, force)
        if restrained:
            _project(force, freedom, basis)
            for i in range(force.size):
                force[i] += load[i]
        if tied:
            pull(ties, motion, force)
        if rigged:
            moment = turn_rig(rig, motion, live)
            force[rig[0][2]] += moment
            response = 0.0
            for k in range(3):
                response += live[rig[0][k]] ** 2 * mobility[rig[0][k]]
        if turns:
            turn_loads(dead_loads, motion, force)
        if pushes:
            turn_live(live_loads, motion, live)
            response = 0.0
            for i in range(live.size):
                response += live[i] * mobility[i] * live[i]
        if carried:
            turn_supports(supports, motion, live)
            pressed = _carry(live, speed, velocity, force)
            total += pressed
            worked -= pressed * speed * dt
        if driven:
            before = _dot(live, velocity)
            multiplier = _drive(live, response, modes, state)
        advance(at_update, modes, memory, state, local, dt)
        if driven:
            multiplier += _restore_speed(live, response, speed, mobility, dt, motion, velocity)
            total += multiplier
            worked += 0.5 * multiplier * dt * (before + speed)
        if rigged:
            turned = moment * dt * velocity[rig[0][2]]
            worked += turned
            rig[3][0] += turned
        if turns:
            worked += work_of_turned(dead_loads, velocity, dt)
        due = (already + taken + 1) % LOOK == 0 and given < np.inf
        if due and not _is_stable(given + worked, load, modes, state, most):
            return taken + 1, False, total, worked
    return steps, True, total, worked


@kernel
def step(
    control: int, steps: int, scales: Scales, load: Array, live: Array, speed: float, arrays: Any, watch: Watch
) -> tuple[int, bool, float, float]:
    """Take time steps of a model.

    Parameters
    ----------
    control
        Held: a constant load plus a multiplier of the live load that rises from zero by `speed` per step; driven:
        live·v is kept at `speed` [W] by a multiplier of the live load; carried: held modes move at `speed` [1/s] times
        `live`.
    arrays
        `Addresses` of the kernels, then their arguments: the interface's geometry, the law's parameters, modes;
        restraint, ties, the objects at finite displacements; the update's memory, `StateArrays`, `Work` and `Frames`.
        The objects at finite displacements are a rig, rotating dead loads, rotating live loads, and rotating supports.
        With a rig (its freedoms are not empty) the live load rotates with the beam (`rig`), is written to, and acts on
        nothing else; the live load is also written to if it drives at points that rotate, or if supports rotate.
    watch
        The energy is checked at every `LOOK`-th step of the state's life; if the check fails, the steps end.

    Returns
    -------
    steps, stable, multipliers, work
        Steps taken; whether no more energy is spent than was supplied; the sum of the driving multipliers, or of the
        forces on the carried modes per unit of their motion; the work of all loads except the constant one.
    """
    rises = speed != 0.0 and control == HELD
    state, work, _ = arrays[8:]
    motion, loaded = state[0], work[1]
    already, given, most = watch
    copy_into(loaded, load)
    taken, stable, total, worked, multiplier, before = 0, True, 0.0, 0.0, 0.0, 0.0
    while stable and taken < steps:
        piece = steps
        if rises:
            piece = min(STEPS_PER_LOAD, steps - taken)
            multiplier = speed * (taken + 0.5 * piece)
            for i in range(live.size):
                loaded[i] = load[i] + multiplier * live[i]
            before = multiplier * _dot(live, motion)
        watched = (already + taken, given + worked - before, most)
        pace = 0.0 if rises else speed
        more, stable, summed, turned = _at_constant_loads(control, piece, scales, loaded, live, pace, arrays, watched)
        taken += more
        total += summed
        worked += turned
        if rises:
            worked += multiplier * _dot(live, motion) - before
    return taken, stable, total, worked
