"""Central differences with lagged viscous and local damping, compiled for any kinematics and any law.

Each step is a gather of jumps, the law over all points, a scatter of forces and one diagonal update:

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
from .rig import turn_live, turn_loads, turn_rig, turn_supports, work_of_turned
from .ties import pull
from .update import Modes, StateArrays

kernel, inlined, copy_into = compiled.kernel, compiled.inlined, compiled.copy_into


Work: TypeAlias = tuple[Array, Array, Array, Array, Array, Array]
"""Buffers: motion and load ``(nd,)``, then opening, slip, normal and tangential traction of the points, ``(np,)``."""

Watch: TypeAlias = tuple[int, float, Array]
"""Steps taken before; energy [J] that the state was given but for the work of loads that are constant now, inf where
it is not watched; the largest energy supplied so far ``(1,)`` [J], brought up to date.

These are plain tuples: to take a named one apart costs a call of the kernels a tenth of the steps of a small wall.
"""

Scales: TypeAlias = tuple[float, float, float]
"""Time step [s], local damping α, and the joints' viscosity per stiffness, in time steps."""

Control: TypeAlias = Literal["held", "driven", "carried"]
"""What the steps prescribe: a load alone, the live load's power besides, or the velocity of held modes."""

CONTROLS: tuple[Control, ...] = get_args(Control)
"""In the order of their numbers."""

HELD, DRIVEN, CARRIED = range(3)

RISE = 20
"""Steps in which a load that rises is constant."""

LOOK = 100
"""Steps between two looks at the energy."""

CERTAIN_SHARE = 0.05
"""Share of the energy in motion and in springs that a stable run certainly was supplied with.

Of the work W of the loads, central differences make energy E in motion and in springs and energy D spent, with
W = D + E + R to rounding, where |R| ≤ (Δt / Δt_critical) E as velocities are half a step behind. So a stable run has
W ≥ D + (1 − Δt / Δt_critical) E; this share holds up to 0.95 of the critical step. Where a swing comes back to
its start W passes through nothing, and the velocity of half a step ago does not: W is the largest of the run so far.
"""

TOO_MUCH_SPENT = 2.0
"""Energy spent on damping, in energies supplied, that no stable run comes to: 1, but it is summed step by step."""


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
    """Whether no more energy [J] is in motion, in springs and spent on damping than was supplied; not where it is NaN.

    Supplied are what was given and the work of a load that was constant; `most` keeps the most of it. The joints' work
    is left out: at high frequencies that of their viscosity comes out too large, and in a wall that rings without
    damping so does that of their friction.
    """
    stiffness, _, mobility = modes
    motion, velocity, _, damped, _ = state
    supplied = given
    held = 0.0
    spent = 0.0
    for i in range(motion.size):
        supplied += load[i] * motion[i]
        if mobility[i] > 0.0:  # what is held may be carried on, and knows neither inertia nor damping
            held += 0.5 * velocity[i] * velocity[i] / mobility[i]
            spent += damped[i]
        held += 0.5 * stiffness[i] * motion[i] * motion[i]
    most[0] = max(most[0], supplied)
    # Local damping that makes a mode unstable gives energy instead of taking it.
    return bool(max(spent, 0.0) + CERTAIN_SHARE * held <= TOO_MUCH_SPENT * most[0])


@kernel
def _dot(one: Array, other: Array) -> float:
    total = 0.0
    for i in range(one.size):
        total += one[i] * other[i]
    return total


@kernel
def _carry(live: Array, speed: float, velocity: Array, force: Array) -> float:
    """Give held modes their speed; what presses on them per unit of their motion."""
    pressed = 0.0
    for i in range(live.size):
        if live[i] != 0.0:
            pressed += live[i] * force[i]
            velocity[i] = speed * live[i]
    return pressed


@kernel
def _drive(live: Array, response: float, modes: Modes, state: StateArrays) -> float:
    """Add the multiple of the live load that keeps its power, and return it."""
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
def _give_back(
    live: Array, response: float, speed: float, mobility: Array, dt: float, motion: Array, velocity: Array
) -> float:
    """Local damping acts on the live load too; what it takes from the prescribed speed is given back, and returned."""
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
    """The steps of `step` in which loads stay as they are."""
    dt, local, joint_viscosity = scales
    addresses, geometry, parameters, modes, restraint, ties, far, memory, state, work, frames = arrays
    rig, turning, pushing, leaning = far
    _, _, mobility = modes
    motion, velocity, history, _, force = state
    freedom, basis = restraint
    moved, _, opening, slip, normal, tangential = work
    already, given, most = watch
    at_gather, at_reframe, at_law, at_scatter, at_update = addresses
    driven, carried, tied, rigged = control == DRIVEN, control == CARRIED, ties[6].size > 0, rig[0].size > 0
    turns, pushes = turning[2].size > 0, driven and pushing[2].size > 0
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
            turn_loads(turning, motion, force)
        if pushes:
            turn_live(pushing, motion, live)
            response = 0.0
            for i in range(live.size):
                response += live[i] * mobility[i] * live[i]
        if carried:
            turn_supports(leaning, motion, live)
            pressed = _carry(live, speed, velocity, force)
            total += pressed
            worked -= pressed * speed * dt
        if driven:
            before = _dot(live, velocity)
            multiplier = _drive(live, response, modes, state)
        advance(at_update, modes, memory, state, local, dt)
        if driven:
            multiplier += _give_back(live, response, speed, mobility, dt, motion, velocity)
            total += multiplier
            worked += 0.5 * multiplier * dt * (before + speed)
        if rigged:
            turned = moment * dt * velocity[rig[0][2]]
            worked += turned
            rig[3][0] += turned
        if turns:
            worked += work_of_turned(turning, velocity, dt)
        due = (already + taken + 1) % LOOK == 0 and given < np.inf
        if due and not _is_stable(given + worked, load, modes, state, most):
            return taken + 1, False, total, worked
    return steps, True, total, worked


@kernel
def step(
    control: int, steps: int, scales: Scales, load: Array, live: Array, speed: float, arrays: Any, watch: Watch
) -> tuple[int, bool, float, float]:
    """Take steps of a model.

    Parameters
    ----------
    control
        Held, a multiplier of the live load that rises from zero by the speed a step is added to a constant load;
        driven, live·v is kept at the speed [W], by a multiplier of the live load; carried, held modes move at the
        speed [1/s] times `live`.
    arrays
        `Addresses` of the kernels; what they are called with: the interface's geometry, the law's parameters, modes;
        restraint, ties, what is there at finite displacements; the update's memory, `StateArrays`, `Work` and `Frames`.
        At finite displacements there are a rig, turning loads, those that are live, and supports that turn. With a rig,
        whose freedoms say that there is one, the live load turns with the beam (`rig`), is written to, and acts on
        nothing else; it is written to where it drives at points that turn as well, and the way of supports that turn.
    watch
        The energy is looked at every `LOOK` steps of the state's life; where it does not add up, the steps end.

    Returns
    -------
    steps, stable, multipliers, work
        Steps taken; whether no more energy is spent than was supplied; the sum of the multipliers that drive, or of
        what presses on the carried modes per unit of their motion; the work of all but the constant load.
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
            piece = min(RISE, steps - taken)
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
