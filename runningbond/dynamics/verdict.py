"""The collapse of a wall by steps of constant load, each held until the wall rests or falls."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.joints import stiffness_note
from runningbond.results import Outcome, fastest_corner_by_one
from runningbond.scene import Array, Indices, Scene

from .loading import LoadSteps, load_steps
from .run import Criteria, Observer, Run, Unstable, nobody
from .system import State

COLLAPSE = 0.05
"""Displacement at which a wall that does not slow down is in collapse, in block sizes (`Scene.block_sizes`).

A wall without weight may slip as far and be caught by the pressure that the slip itself brings about; loaded slowly
enough it does not.
"""

FIRST_STEP = 0.05
"""First load step, in live loads as large as the largest dead one (for a weightless wall, as the strongest joint)."""

UNACCOUNTED = 0.01
"""Share of the work of the loads that may be missing from the energy ledger before a run is not believed."""

MOST, FARTHEST = 1e6, 10.0
"""Multiplier, in first steps, and displacement, in block sizes, beyond which no collapse is looked for.

So far small displacements are none, and what is elastic between two loads is more than counts as collapse.
"""

BUDGET = 2_000_000
"""Time steps after which a load is left undecided."""


def collapse_by_steps(
    scene: Scene,
    model: str,
    run: Run,
    tolerance: float,
    *,
    point_order: Indices,
    locks: Callable[[], bool],
    note: str = "",
    collapse: float = COLLAPSE,
    first_step: float = FIRST_STEP,
    budget: int = BUDGET,
    observe: Observer = nobody,
) -> Outcome:
    """Find the load that brings a wall down.

    Parameters
    ----------
    scene
        The wall.
    model
        Name of the model.
    run
        Its blocks in motion.
    tolerance
        Relative width of the bracket.
    point_order : (np,) int
        Joint points in the order in which the outcome lists their forces.
    locks
        Whether the wall is known to bear any multiple of the live load; asked where no load brought it down.
    note
        What the message is to say about the run besides.
    collapse
        Displacement at which a wall that does not slow down is in collapse, in block sizes.
    first_step
        First load step; steps grow while they are borne and are bisected once one is not.
    budget
        Time steps after which a load is left undecided.
    observe
        Called every so many steps.

    Returns
    -------
    Outcome
        `lower` is the largest multiplier under which the wall came to rest, `upper` the smallest under which
        it fell. `curve` has every state at rest, and ends in the fall. ``failed`` where the run makes up energy,
        as one with too long a time step does.
    """
    system = run.system
    criteria = Criteria(collapse=collapse * run.sizes(scene), budget=budget)
    first = first_step / (system.measure(system.live) or 1.0)  # pins may take up all of it
    # Second threads of the linear algebra gain nothing on blocks this small, and wait for each other at every step.
    outcome = Outcome(scene.title, model, "undecided", dofs=system.freedoms)
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            most, farthest = MOST * first, FARTHEST * run.sizes(scene)
            found = load_steps(run, first, tolerance, criteria, most=most, farthest=farthest, observe=observe)
    except Unstable as error:
        return replace(outcome, status="failed", steps=error.steps, message=str(error))
    outcome = _judge(replace(outcome, steps=found.taken), scene, run, found, tolerance, point_order, locks)
    window = _window(scene, run, found, criteria)
    if outcome.status == "infeasible" and window:
        message = "moves as far under its dead load as counts as collapse"
        outcome = replace(outcome, status="undecided", message=message)
    elif outcome.status == found.verdict == "undecided" and not found.interrupted:
        note = "; ".join(part for part in (note, f"each load was followed for at most {budget * run.dt:.2g} s") if part)
    long = f"time steps of {run.dt:.4g} s are longer than the safe ones of {run.safe_step:.4g} s"
    parts = (outcome.message, note, long if run.dt > run.safe_step else "", window)
    return replace(outcome, message="; ".join(part for part in parts if part))


def _window(scene: Scene, run: Run, found: LoadSteps, criteria: Criteria) -> str:
    """What there is to say of the stiffness of joints: at rest, or in a fall, under the dead load."""
    state, law = found.rests[0][1] if found.rests else found.fallen, run.system.law
    if state is None:
        return ""
    normal, _ = run.forces(state)
    springs = law.normal_stiffness * run.system.area
    overlap = float((-normal / springs).max(initial=0.0))
    stiffest = float(max(springs.max(initial=0.0), (law.shear_stiffness * run.system.area).max(initial=0.0)))
    smallest = float(run.system.force_unit[run.system.rigid[:, :2]].min())
    far = float(np.min(criteria.collapse))
    return stiffness_note(overlap, far, scene.block_size, stiffest, smallest)


def _judge(
    outcome: Outcome,
    scene: Scene,
    run: Run,
    found: LoadSteps,
    tolerance: float,
    point_order: Indices,
    locks: Callable[[], bool],
) -> Outcome:
    """Outcome of a search."""
    if found.borne is None:
        return _never_at_rest(outcome, found)
    curve, force = _curve(run, found), np.column_stack(run.forces(found.borne))[point_order]
    if found.interrupted:
        message = "interrupted: the bracket found so far"
        return replace(outcome, lower=found.lower, upper=found.upper, curve=curve, force=force, message=message)
    if found.upper is None or found.lower is None or found.fallen is None:
        return _never_fallen(outcome, found, locks)
    motion = _mechanism(scene, run, found.borne, found.fallen)
    outcome = replace(outcome, lower=found.lower, upper=found.upper, curve=curve, motion=motion, force=force)
    lost = _unaccounted(run, found.fallen)
    if lost > UNACCOUNTED:
        return replace(outcome, status="failed", message=f"{lost:.1%} of the work of the loads is unaccounted for")
    if found.verdict == "undecided":
        return replace(outcome, message="the budget ran out inside this bracket: the wall neither rested nor fell")
    wide = ""
    if found.upper - found.lower > tolerance * found.upper:
        wide = "; wider than the tolerance because loads as small as their difference would not be seen at rest"
    return replace(
        outcome,
        status="collapse",
        multiplier=(found.lower + found.upper) / 2,
        message="largest load at rest and smallest in collapse, small displacements; "
        f"work accounted for to {max(lost, 1e-6):.0e} of it{wide}",
    )


def _never_at_rest(outcome: Outcome, found: LoadSteps) -> Outcome:
    """Outcome of a wall that did not come to rest under its dead load."""
    if found.interrupted:
        return replace(outcome, message="interrupted before the wall came to rest under its dead load")
    if found.verdict == "collapse":
        return replace(outcome, status="infeasible", message="falls under its dead load")
    return replace(outcome, message="the budget ran out before the wall came to rest under its dead load")


def _never_fallen(outcome: Outcome, found: LoadSteps, locks: Callable[[], bool]) -> Outcome:
    """Outcome of a wall that no load brought down."""
    if locks():
        message = "self-locking: borne up to every load tried, and joint forces balance any multiple of it"
        return replace(outcome, status="unbounded", message=message)
    message = "the budget ran out: the wall neither rested nor fell"
    if found.verdict == "stable":
        message = f"it bore every load tried, the largest of them {found.lower:.3g}"
    return replace(outcome, lower=found.lower, message=message)


def _unaccounted(run: Run, state: State) -> float:
    """Share of the work of the loads that the energy ledger misses.

    Works of the dead and of the live load each count: where a slender wall topples they nearly cancel.
    """
    ledger = run.ledger(state)
    dead = float(run.system.dead @ state.motion)
    work = abs(dead) + abs(ledger.external - dead)
    return abs(ledger.residual) / work if work else 0.0


def _curve(run: Run, found: LoadSteps) -> Array:
    """Control displacement and multiplier of the states at rest, then of the fall."""
    rows = [(run.system.control @ state.motion, multiplier) for multiplier, state in found.rests]
    if found.fallen is not None and found.upper is not None:
        rows.append((run.system.control @ found.fallen.motion, found.upper))
    return np.array(rows)


def _mechanism(scene: Scene, run: Run, borne: State, fallen: State) -> Array:
    """What moved between the last rest and the fall, its fastest corner by one metre."""
    return fastest_corner_by_one(scene.blocks, run.motion_of_blocks(fallen) - run.motion_of_blocks(borne))
