"""The collapse load of a wall, by steps of constant load, each held until the wall rests or falls."""

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.joints import JointPoints, ends_note, stiffness_note
from runningbond.joints.stiffness import GIVES, rocking_softness
from runningbond.results import Outcome, Supports, fastest_corner_by_one
from runningbond.results.outcome import joined, number
from runningbond.scene import Array, Indices, Scene

from .collapse import U_CRIT, Criteria, crushing_note
from .dead_load import fall_under_dead_load
from .inertia import beam_note
from .led import UNACCOUNTED, LedWall, collapse_of_led
from .load_stepping import LoadSteps, load_steps, smallest_width
from .path_curve import LOAD_DIFFERS, LOCK_DIFFERS, friction_note
from .run import Observer, Run, Unstable, no_observer
from .state import State

FIRST_STEP = 0.05
"""First load step: largest ratio of live force to weight of a block (weightless: to the strength of a joint point)."""

HALVINGS = 8
"""Most halvings of the first step: under even smaller loads the criterion of rest could not detect a motion."""

LARGEST_LOAD, LARGEST_DISPLACEMENT = 1e6, 10.0
"""Multiplier, in first steps, and displacement, in block sizes, beyond which the search for a collapse ends.

At such displacements the small-displacement theory no longer holds, and the elastic displacement between two loads is
more than the displacement that counts as collapse.
"""

BEYOND_BOUND = 2.0
"""Multiplier, in proved upper bounds, up to which the search for a collapse still goes on."""

LARGEST_ELASTIC = 20.0
"""Displacement, in elastic displacements under a load proved too large, beyond which the search for a collapse ends."""

MOST_SOFTNESS = 16.0
"""Largest ratio of a wall's motion to its next rest to that to its last one: a joint is softer the less of it bears.

Joints at nine points turn up to 240 times as far as closed ones (`rocking_softness`), but over many loads.
"""

DRAWN_OVERLAP = 0.02
"""Overlap of joints in a drawn mechanism, relative to the largest displacement, that is barely visible."""

BUDGET = 2_000_000
"""Time steps after which a load is left undecided."""


def collapse_by_steps(
    scene: Scene,
    model: str,
    run: Run,
    tolerance: float,
    *,
    points: JointPoints,
    point_order: Indices,
    is_self_locking: Callable[[], bool],
    bound: Callable[[], float | None] = lambda: None,
    gives: Callable[[float], float] = lambda _: 0.0,
    bears: Callable[[], bool] = lambda: False,
    note: str = "",
    collapse: float = U_CRIT,
    first_step: float = FIRST_STEP,
    budget: int = BUDGET,
    distance: float | None = None,
    observe: Observer = no_observer,
) -> Outcome:
    """Find the load at which a wall collapses.

    Parameters
    ----------
    scene
        The wall.
    model
        Name of the model.
    run
        The run of the wall's blocks.
    tolerance
        Relative width of the bracket.
    points
        Joint points of the run.
    point_order : (np,) int
        Those points in the order in which the outcome lists their forces.
    is_self_locking
        Whether joint forces balance any multiple of the live load; called only where the verdict depends on it.
    bound
        Multiplier that is proved too large, if there is one.
    gives
        Largest displacement of a block [m] under a multiple of the live load while joints neither open nor slip, plus
        that of a wall which hangs on its ties until they yield, as far as they are known.
    bears
        Whether joint forces balance the dead load, considering all cracks of the run; called if the wall falls under
        it.
    note
        What the message is to add about the run.
    collapse
        Displacement at which a wall that does not slow down has collapsed, in block sizes; at least `GIVES` times the
        elastic displacement under the `bound`, and for a wall with weight at least the displacement reached at rest, or
        up to `MOST_SOFTNESS` times as much if joints become softer as they open.
    first_step
        First load step; steps grow while the wall carries them and are bisected once it does not. A first step beyond
        the `bound` is halved until it is below it, at most `HALVINGS` times.
    budget
        Time steps after which a load is left undecided.
    distance
        Displacement of the control point [m] to which the live load pushes a wall at finite displacements; by default
        the smaller side of the wall, or if that gives no answer, as far as both speeds agree. The push ends earlier if
        the multiplier has fallen to zero.
    observe
        Called with the run, its state and the multiplier every few hundred steps, e.g. to take snapshots.

    Returns
    -------
    Outcome
        `lower` is the largest multiplier at which the wall came to rest, `upper` the smallest at which it fell. `curve`
        has every state at rest, and ends in the fall; `motion` is the motion of the fall, also under the dead load. The
        status is ``failed`` if the run creates energy, as it does with too long a time step.
    """
    system, sizes = run.system, scene.block_sizes[run.system.owner]
    criteria = Criteria(collapse=collapse * sizes, budget=budget)
    if system.contacts is None:
        criteria = replace(criteria, softness=min(MOST_SOFTNESS, rocking_softness(points)))
    else:  # what falls may land on the ground before it has moved farther, or for longer
        criteria = replace(criteria, shortest=0)
    first = first_step / (system.measure(system.live) or 1.0)  # pins may carry all of the live load
    outcome = Outcome(scene.title, model, "undecided", dofs=system.freedoms)
    note = joined(note, beam_note(scene), ends_note(scene, points))
    try:
        # A second thread of the linear algebra gains nothing on blocks this small, and waits at every step.
        with threadpool_limits(limits=1, user_api="blas"):
            if scene.is_led or run.system.contacts is not None:
                known = cache(is_self_locking)
                wall = LedWall(scene, run, tolerance, points, point_order, known, bears, criteria)
                outcome = collapse_of_led(outcome, wall, observe, distance)
                return replace(outcome, message=joined(outcome.message, note))
            result, above = LoadSteps(interrupted=True), None
            with suppress(KeyboardInterrupt):
                above = bound()
                elastic = gives(above) if above else 0.0
                result = _search(scene, run, first, tolerance, criteria, above, elastic, observe)
    except Unstable as error:
        return replace(outcome, status="failed", steps=error.steps, message=str(error))
    if above is not None and _is_proved_at_points(scene):
        result.exclude_rests_above(above + max(tolerance * above, smallest_width(run, criteria)))
    if result.rests:
        outcome = replace(outcome, **_path(scene, run, result, points))
    outcome = replace(outcome, steps=result.steps)
    outcome = _judge(outcome, scene, run, result, tolerance, point_order, is_self_locking, criteria, bears, above)
    # Of a fall under the dead load, the toe bears all when the wall has moved as far as counts as collapse.
    counts = collapse * (1.0 if result.rests else criteria.softness)
    stiffness = _note_on_stiffness(scene, run, result, float(np.min(counts * sizes)))
    if outcome.status == "infeasible" and stiffness:
        message = "moves under its dead load as far as counts as collapse"
        outcome = replace(outcome, status="undecided", message=message, motion=np.zeros((0, 3)))
    elif outcome.status == result.verdict == "undecided" and not result.interrupted:
        note = joined(note, f"each load was followed for at most {budget * run.dt:.2g} s")
    state = result.fallen or result.borne
    crushed = "" if state is None else crushing_note(run, state)
    long = ""
    if run.dt > run.safe_step:
        long = f"time steps of {run.dt:.4g} s are longer than the safe ones of {run.safe_step:.4g} s"
    return replace(outcome, message=joined(outcome.message, note, long, stiffness, crushed))


def _search(
    scene: Scene,
    run: Run,
    first: float,
    tolerance: float,
    criteria: Criteria,
    bound: float | None,
    elastic: float,
    observe: Observer,
) -> LoadSteps:
    """Raise the load until the wall falls; the collapse criterion exceeds the `elastic` motion [m] at the bound."""
    sizes = scene.block_sizes[run.system.owner]
    tolerance = tolerance / 2 if run.interface.law.can_break else tolerance  # the last step is added to the bracket
    criteria = replace(criteria, collapse=np.maximum(criteria.collapse, GIVES * elastic))
    # The first steps of a weightless wall may be millionths of its collapse load.
    most = max(LARGEST_LOAD * first, BEYOND_BOUND * (bound or 0.0))
    if bound and 0 < bound < first:
        first *= 2.0 ** max(-HALVINGS, math.floor(math.log2(bound / first)))
    return load_steps(
        run,
        first,
        tolerance,
        criteria,
        most=most,
        farthest=np.maximum(LARGEST_DISPLACEMENT * sizes, LARGEST_ELASTIC * elastic),
        bound=bound,
        observe=observe,
    )


def _note_on_stiffness(scene: Scene, run: Run, result: LoadSteps, collapse: float) -> str:
    """Note on the stiffness of the joints, from the state at rest or in the fall under the dead load; may be empty."""
    state, law, area = result.rests[0][1] if result.rests else result.fallen, run.interface.law, run.interface.area
    if state is None:
        return ""
    opening, _, normal, _ = run.tractions(state)
    springs = law.stiffest * area
    # Crushing is not overlap, and closed joints overlap less than they would if their stiffness did not grow.
    overlap = float(np.minimum(-opening, -normal / law.normal_stiffness).max(initial=0.0))
    stiffest = float(max(springs.max(initial=0.0), (law.shear_stiffness * area).max(initial=0.0)))
    smallest = float(run.system.force_unit[run.system.rigid[:, :2]].min())
    return stiffness_note(overlap, collapse, scene.block_size, stiffest, smallest)


def _judge(
    outcome: Outcome,
    scene: Scene,
    run: Run,
    result: LoadSteps,
    tolerance: float,
    point_order: Indices,
    is_self_locking: Callable[[], bool],
    criteria: Criteria,
    bears: Callable[[], bool],
    above: float | None,
) -> Outcome:
    """Outcome of a search; limit analysis proves that nothing stands `above` a load, or that is None."""
    if result.borne is None:
        if result.verdict == "collapse":
            status, message = fall_under_dead_load(run.interface.law, bears)
            outcome = replace(outcome, status=status, message=message)
            if status != "infeasible" or result.fallen is None:
                return outcome
            return replace(outcome, motion=_mechanism(scene, run, result.fallen.motion))
        why = "interrupted" if result.interrupted else "the budget ran out"
        return replace(outcome, message=f"{why} before the wall came to rest under its dead load")
    outcome = replace(outcome, force=np.column_stack(run.forces(result.borne))[point_order])
    if result.interrupted:
        message = "interrupted: the bracket so far"
        return replace(outcome, lower=result.lower, upper=result.upper, message=message)
    excluded = ""
    if result.excluded:
        proved = "but limit analysis proves that nothing balances such loads, which move it too little to be seen"
        excluded = f"it passed as at rest up to {result.excluded:.3g}, {proved}"
    if result.upper is None or result.lower is None or result.fallen is None:
        if excluded:
            return replace(outcome, lower=result.lower, message=excluded)
        doubt = _doubt(scene, run, result, tolerance, LOCK_DIFFERS)
        return _never_fallen(outcome, scene, run, result, is_self_locking, above, doubt)
    motion = _mechanism(scene, run, _fall(run, result, result.fallen))
    # A load that rises by a step overshoots to at most twice the step, and what breaks stays broken.
    overshoot = result.upper - result.lower if run.interface.law.can_break else 0.0
    upper = result.upper + overshoot
    outcome = replace(outcome, lower=result.lower, upper=upper, motion=motion)
    # The motion under the suddenly applied dead load does not count; afterwards that load may do almost no work.
    try:
        lost = _unaccounted(run, result, result.fallen)
        locks = _may_lock(run, result, criteria, is_self_locking)
    except KeyboardInterrupt:
        return replace(outcome, message="interrupted: the bracket so far")
    except Unstable as error:
        return replace(outcome, status="failed", message=str(error))
    if not lost <= UNACCOUNTED:  # also if the law's energy is no number
        return replace(outcome, status="failed", message=f"{lost:.1%} of the work of the loads is unaccounted for")
    if excluded:
        return replace(outcome, message=excluded)
    if locks:
        far = "at rest it has moved as far as counts as collapse"
        message = f"self-locking: {far}, and joint forces balance any multiple of the load"
        message = joined(message, _doubt(scene, run, result, tolerance, LOCK_DIFFERS))
        return replace(outcome, status="unbounded", lower=None, upper=None, motion=np.zeros((0, 3)), message=message)
    if result.verdict == "undecided":
        return replace(outcome, message="the budget ran out inside this bracket: the wall neither rested nor fell")
    wide, beyond = "", ", and the last step beyond it, by which joints that break may overshoot" if overshoot else ""
    if upper - result.lower > tolerance * upper:
        wide = "; wider than the tolerance because loads as small as their difference would not be seen at rest"
    message = (
        f"largest load at rest and smallest in collapse{beyond}, small displacements; "
        f"work accounted for to {max(lost, 1e-6):.0e} of it{wide}"
    )
    message = joined(message, _doubt(scene, run, result, tolerance, LOAD_DIFFERS))
    return replace(outcome, status="collapse", multiplier=(result.lower + upper) / 2, message=message)


def _doubt(scene: Scene, run: Run, result: LoadSteps, tolerance: float, differs: str) -> str:
    """Note on an answer that depends on how joints slid after a wall had rested under its dead load."""
    if result.borne is None:
        return ""
    loaded, borne = result.rests[0][1], result.borne
    friction = run.ledger(borne).friction - run.ledger(loaded).friction
    live = np.array([state.external - run.dead_work(state) for state in (loaded, borne)])
    return friction_note(scene, friction, live, 0.0, tolerance, differs=differs)


def _may_lock(run: Run, result: LoadSteps, criteria: Criteria, is_self_locking: Callable[[], bool]) -> bool:
    """Whether a wall that forces hold under any load went as far as a fall only because its joints are soft.

    Such forces do not exclude a collapse under true friction: a wall that falls on and on does not lock.
    """
    loaded = result.rests[0][1]
    if result.borne is None or result.fallen is None or result.fall is None:
        return False
    moved = run.system.farthest(result.borne.motion - loaded.motion, criteria.collapse)
    return moved > 1 and is_self_locking() and result.fall.goes_on(result.fallen, loaded) != "collapse"


def _unaccounted(run: Run, result: LoadSteps, fallen: State) -> float:
    """Missing energy of a fall, counted again if blocks that chatter may have made it too large (`Fall`)."""
    loaded = result.rests[0][1]
    lost = run.unaccounted(fallen, since=loaded)
    counted = result.fall.unaccounted(loaded) if lost > UNACCOUNTED and result.fall is not None else None
    return lost if counted is None else counted


def _is_proved_at_points(scene: Scene) -> bool:
    """Whether the bound of limit analysis holds: at points, crushing joints may carry more than along their length."""
    return all(each.compressive_strength is None for each in scene.materials_of_joints)


def _never_fallen(
    outcome: Outcome,
    scene: Scene,
    run: Run,
    result: LoadSteps,
    is_self_locking: Callable[[], bool],
    above: float | None,
    doubt: str,
) -> Outcome:
    """Outcome of a wall that did not fall under any load, with a `doubt` if it locks."""
    self_locking, far = is_self_locking(), ""
    if result.far and result.borne is not None:
        moved = np.hypot(*run.system.motion_of_blocks(result.borne.motion - result.rests[0][1].motion)[:, :2].T)
        block = scene.blocks.name(int(moved.argmax()))
        far = f", up to {result.lower:.3g}, at which {block} has moved {moved.max():.2g} m"
        far += ": too far for small displacements"
    if self_locking and result.verdict == "stable":
        message = f"self-locking: it carried every load tried{far}, and joint forces balance any multiple of the load"
        return replace(outcome, status="unbounded", message=joined(message, doubt))
    message = f"it carried every load tried{far or f', up to {result.lower:.3g}'}"
    if far:
        message += ", or nothing holds it" if above is None else f"; limit analysis proves {number(above)} too much"
    if result.verdict != "stable":
        message = "the budget ran out: the wall neither rested nor fell"
        message += ", though joint forces balance any multiple of the load" if self_locking else ""
    proved = above is not None and above >= (result.lower or 0.0) and _is_proved_at_points(scene)
    return replace(outcome, lower=result.lower, upper=above if proved else None, message=message)


def _mechanism(scene: Scene, run: Run, motion: Array) -> Array:
    """Motion of the blocks ``(nb, 3)`` in a motion of the run ``(nd,)``; the fastest corner moves by one metre."""
    return fastest_corner_by_one(scene.blocks, run.system.motion_of_blocks(motion))


def _fall(run: Run, result: LoadSteps, fallen: State) -> Array:
    """Motion of the fall, ``(nd,)``, from the latest state from which the wall can still be drawn.

    Gaps that earlier loads opened may close in a fall; drawn on the undeformed wall, blocks would overlap each other.
    """
    motions = [fallen.motion - start for start in result.fall_starts]
    for motion in motions:
        opening, _ = run.interface.jumps(run.system.unrestrained(motion))
        overlap = -opening.min(initial=0.0)
        if run.system.live @ motion > 0 and overlap <= DRAWN_OVERLAP * run.system.farthest(motion):
            return motion
    return motions[-1]


def _path(scene: Scene, run: Run, result: LoadSteps, points: JointPoints) -> dict[str, Any]:
    """Curve of the states at rest, then of the fall: control displacement since the first rest, and multiplier.

    Also their reactions and works. Where the load was applied at once, its work is that of slow growth: a load at once
    does twice the work, half of which damping takes.
    """
    states = result.rests
    if result.fallen is not None and result.upper is not None:
        states = [*states, (result.upper, result.fallen)]
    start = states[0][1].motion
    curve = np.array([(run.system.control @ (state.motion - start), multiplier) for multiplier, state in states])
    dead = np.array([run.dead_work(state) for _, state in states])
    live = np.array([run.system.live @ state.motion for _, state in states])
    steps = np.diff(curve[: result.at_once + 1, 1]) * np.diff(live[: result.at_once + 1]) / 2
    extra = np.concatenate([[0.0], np.cumsum(steps), np.full(len(states), steps.sum())])[: len(states)]
    works = np.column_stack([dead, [state.external for _, state in states] - dead - extra])
    forces = [np.column_stack(run.forces(state)) for _, state in states]
    ties = [run.system.ties.force(state.motion, state.stretch) for _, state in states]
    supports = Supports(scene, points, run.system.owner)
    falls = len(states) > len(result.rests)
    return {"curve": curve, **supports.path(forces, ties, [load for load, _ in states], works, falls=falls)}
