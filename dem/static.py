"""Model ``dem-static``: rigid blocks on elastic, frictional joint points, brought to rest load by load until they fall.

The paper's second solver (Sec. 3) sets the stiffness of violated joint actions to zero and solves again, which
cycles or becomes singular below collapse (`stiffness_update`). Here each load is held until the wall is in equilibrium
or has fallen: by Newton's method with the consistent Coulomb tangent and, if that finds no equilibrium at once, by
creep of the wall on dashpots (`relaxation`). Past the largest load that the wall carries, displacements are prescribed
and the curve continues.

The curves of walls of upright or small blocks do not have a single peak: as blocks rock and slip into place, λ falls
and rises again many times over motions of a few elastic lengths. Under a prescribed displacement such a wall snaps, at
a point that depends on the steps; under a load it falls to its next equilibrium, or for good. Hence the bracket is one
of loads. Friction makes the result path-dependent: longer load steps may bring a wall down at a lower or higher load.
The wall is therefore loaded again in steps half as long; if it then falls elsewhere, the bracket includes both.

A beam or supports with prescribed displacements take the wall along, step by step (`led`).
"""

import time
from contextlib import suppress
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.dynamics.path_curve import LOCK_DIFFERS, friction_note
from runningbond.joints import ends_note, stiffness_note
from runningbond.limit import elastic_displacement, hanging_displacement
from runningbond.limit.associated import is_self_locking, proved_outcome
from runningbond.limit.kinematics import control_row, dead_load, live_load
from runningbond.results import Outcome, Supports
from runningbond.results.outcome import joined, number
from runningbond.scene import Scene, check_scene

from .climb import BUDGET_SPENT, INTERRUPTED, NO_VERDICT, climb, ends, look_closer, peak
from .led import lead_along
from .load_path import LoadPath, StaticObserver, friction_work, no_observer, state_of
from .relaxation import relax
from .static_system import Control, StaticSystem, static_system, with_late_pins

FIRST_STEP = 0.03
"""First load, in units of `Equilibrium`."""

FALLEN = 0.05
"""Motion of a block that counts as a fall unless it slows down, relative to the smallest block height."""

BUDGET = 20_000
"""Linear systems after which a wall is left undecided."""

PAST = 500
"""Linear systems that may be spent past the largest load, each time the curve is followed or a load tried there."""

OTHER_STEP = 0.5
"""First step of the second load path, relative to that of the first path."""

ROUNDING = 1e-9
"""Relative difference between a load and λ of its equilibrium that is put down to rounding."""


def dem_static(
    scene: Scene,
    tolerance: float = 0.01,
    *,
    first_step: float = FIRST_STEP,
    collapse: float = FALLEN,
    budget: int = BUDGET,
    past: int = PAST,
    observe: StaticObserver = no_observer,
) -> Outcome:
    """Find the collapse load of a scene at small displacements, with each load held until the wall rests or falls.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness.
    tolerance
        Relative width of the bracket.
    first_step
        First load, in units in which the live load equals the largest dead load, or for a weightless wall the strength
        of the strongest joint point. Steps grow while equilibrium is found easily, and shrink while it is not.
    collapse
        Motion of a block that counts as a fall unless it slows down, relative to the smallest block height.
    budget
        Linear systems on each load path after which the wall is left undecided.
    past
        Linear systems that may be spent past the largest load, each time the curve is followed or a load tried there.
    observe
        Called with every equilibrium of the first path as it is found, and at the end with those past the largest
        load; then with all those of the second path, if that ends lower.

    Returns
    -------
    Outcome
        `lower` is the largest load in equilibrium, `upper` the smallest under which the wall fell; if paths with
        different load steps disagree, `lower` is that of the path that ends lowest, `upper` of the one that ends
        highest. `curve` has the equilibria of the lowest path, past the largest load at prescribed displacements;
        `force` belongs to `lower`. For a driven wall, `curve` has the whole path, `force` belongs to the answer, and
        `lower` and `upper` are the answers with the last steps and with steps twice as long. Ctrl-C ends the run with
        the result so far.
    """
    check_scene(scene)
    start = time.perf_counter()
    system = static_system(scene)
    outcome = Outcome(scene.title, "dem-static", "undecided", dofs=system.freedoms)
    far = collapse * scene.lowest_block / system.length_unit
    nothing = np.zeros(len(system.law.normal_stiffness))
    try:
        with threadpool_limits(limits=1, user_api="blas"):
            rest = relax(system, np.zeros(system.unknowns), nothing, Control(0.0, multiplier=True), far, budget)
            if rest.verdict != "rest":
                outcome = _fallen(replace(outcome, steps=rest.solves), system)
            else:
                if len(scene.late_pins):
                    system, late = with_late_pins(system, rest.x)
                    rest = replace(rest, x=late)
                # Elastic motion under the live load, while joints neither open nor slip.
                moved = elastic_displacement(scene.with_rigid_blocks(), system.equilibrium.live_unit) or 0.0
                elastic, rests = moved / system.length_unit, [state_of(system, rest)]
                hangs = 0.0 if scene.is_led else hanging_displacement(scene) / system.length_unit
                path = LoadPath(system, far, budget - rest.solves, rests, elastic, hangs, observe=observe)
                observe(path, path.rests[0])
                if scene.is_led:
                    outcome = lead_along(outcome, path, tolerance, first_step)
                    outcome = replace(outcome, steps=budget - path.budget)
                else:
                    outcome = _on_paths(outcome, path, budget, first_step, tolerance, past)
                notes = _window(path), ends_note(scene, system.equilibrium.points)
                outcome = replace(outcome, message=joined(outcome.message, *notes))
    except KeyboardInterrupt:
        outcome = replace(outcome, message=f"no answer: {INTERRUPTED}")
    return replace(outcome, seconds=time.perf_counter() - start)


def _window(path: LoadPath) -> str:
    """Note on joints that are too soft or too stiff, judged at rest under the dead load; empty for others."""
    equations, law, unit = path.system.equilibrium, path.system.law, path.system.length_unit
    normal = path.rests[0].force[:, 0]
    overlap = unit * float((-normal / law.normal_stiffness[: len(normal)]).max(initial=0.0))
    stiffest = float(max(law.normal_stiffness.max(initial=0.0), law.shear_stiffness.max(initial=0.0)))
    spring, size = equations.force_unit / unit, equations.scene.lowest_block
    return stiffness_note(overlap, path.far * unit, size, spring * stiffest, equations.force_unit)


def _on_paths(result: Outcome, first: LoadPath, budget: int, first_step: float, tolerance: float, past: int) -> Outcome:
    """Outcome of a wall that is loaded from rest under its dead load, and again in other steps if it collapses."""
    paths, left, cut = [first], first.budget, ""
    climb(first, first_step, tolerance)
    if not first.undecided:
        cut = _look_closer(first, tolerance, past)
        if not cut:
            paths.append(LoadPath(first.system, first.far, left, first.rests[:1], first.elastic, first.hangs))
            climb(paths[-1], OTHER_STEP * first_step, tolerance, ends(first))
    found = [path for path in paths if not path.undecided]
    ways = _apart(found) or [first]
    path = min(ways, key=ends)
    if path is not first:
        cut = _look_closer(path, tolerance, past)
    for state in path.past if path is first else (*path.rests, *path.past):
        first.observe(path, state)
    outcome = _judge(result, path, tolerance)
    message = outcome.message
    if len(paths) > 1:
        other = f"with load steps {OTHER_STEP:g} times as long {_loads(paths[1])}"
        message += f"; these loads depend on the load path: {_loads(first)}, {other}; other paths may differ by more"
    if len(found) > 1:
        unit = first.system.equilibrium.live_unit
        upper, fall = unit * max(ends(path)[1] for path in ways), unit * min(ends(path)[1] for path in found)
        outcome = replace(outcome, upper=upper, fall=fall)
    steps = budget - first.budget + sum(left - path.budget for path in paths[1:])
    return replace(outcome, steps=steps, message=message + cut)


def _look_closer(path: LoadPath, tolerance: float, past: int) -> str:
    """Follow a path past its largest load if `past` allows; return a note if that was interrupted."""
    with suppress(KeyboardInterrupt):
        if past:
            look_closer(path, tolerance, past)
        return ""
    return f"; its curve was {INTERRUPTED}"


def _apart(found: list[LoadPath]) -> list[LoadPath]:
    """The paths if their brackets have no load in common, so that one rests where another falls; otherwise none."""
    lower, upper = zip(*map(ends, found), strict=True) if found else ((0.0,), (np.inf,))
    return [] if max(lower) < (1 - ROUNDING) * min(upper) else found


def _loads(path: LoadPath) -> str:
    """Bracket of a path as text, or why it has none."""
    if path.undecided:
        return f"no answer: {path.undecided}"
    return "–".join(number(path.system.equilibrium.live_unit * end) for end in ends(path))


def _judge(result: Outcome, path: LoadPath, tolerance: float) -> Outcome:
    """Outcome with the verdict on a load path, and its arrays."""
    system, states = path.system, [*path.rests, *path.past]
    equations, best = system.equilibrium, peak(path)
    unit = equations.live_unit
    q = np.array([state.x[: system.freedoms] for state in states])
    loads = np.array([unit * state.multiplier for state in states])
    moved, dead, live = (system.per_freedom(row(equations.scene)) for row in (control_row, dead_load, live_load))
    dead, live = q @ dead, q @ live
    mean = (loads[1:] + loads[:-1]) / 2
    works = np.column_stack([dead, loads[0] * live[0] + np.append(0.0, np.cumsum(mean * np.diff(live)))])
    forces = [equations.force_unit * state.force for state in states]
    ties = [equations.force_unit * state.pull for state in states]
    moving = path.fall if path.fall is not None else q[-1] - q[-2] if len(q) > 1 else None
    result = replace(
        result,
        lower=unit * best.multiplier,
        upper=None if path.upper is None else unit * path.upper,
        curve=np.column_stack([(q - q[0]) @ moved, loads]),
        motion=np.zeros((0, 3)) if moving is None else equations.motion(moving),
        force=equations.force_unit * best.force,
        **Supports(equations.scene, equations.points).path(forces, ties, loads, works),
    )
    if not path.undecided:
        heights = path.fall_over(path.upper or 0.0) * system.length_unit / equations.scene.lowest_block
        message = f"largest load at rest and smallest of a fall over {heights:.2g} block heights, small displacements"
        if path.fall is None:
            message = "largest load at rest, and what limit analysis proves that nothing exceeds; small displacements"
        unclear = [number(unit * load) for load in path.unclear if best.multiplier < load < (path.upper or np.inf)]
        message += f"; {NO_VERDICT} under {', '.join(unclear)}" if unclear else ""
        return replace(result, status="collapse", multiplier=result.lower, message=message)
    if path.undecided != INTERRUPTED and path.upper is None and is_self_locking(equations.scene):
        if path.undecided == BUDGET_SPENT:
            message = f"no answer: {path.undecided}, though joint forces balance any multiple of the load"
            return replace(result, message=message)
        friction, live = friction_work(system, path.rests), works[: len(path.rests), 1]
        doubt = friction_note(equations.scene, friction, live, 0.0, tolerance, differs=LOCK_DIFFERS)
        message = joined(f"self-locking: {path.undecided}, and joint forces balance any multiple of it", doubt)
        return replace(result, status="unbounded", lower=None, motion=np.zeros((0, 3)), message=message)
    return replace(result, message=f"no answer: {path.undecided}")


def _fallen(result: Outcome, system: StaticSystem) -> Outcome:
    """Outcome of a wall that was not brought to rest under its dead load; limit analysis shows whether it must fall."""
    fall = proved_outcome(system.equilibrium.scene)
    if fall.status == "infeasible":
        return replace(result, status="infeasible", message=fall.message, motion=fall.motion)
    message = "no equilibrium was found under the dead load"
    told = "" if fall.status == "failed" else ", though forces exist that balance it"
    return replace(result, message=message + told)
