"""Model ``dem-static``: rigid blocks on elastic, frictional joint points, brought to rest load by load until they fall.

The paper's second solver (Sec. 3) sets the stiffness of violated joint actions to zero and solves again, which
cycles or goes singular below collapse (`stiffness_update`). Here each load is held until the wall is in equilibrium
or has fallen, by Newton's method with the consistent Coulomb tangent and, where that finds no equilibrium at once,
by the wall's own creep on dashpots (`relaxation`). Past the largest load that it bears, displacements are prescribed
and the curve goes on.

Walls of upright or of small blocks do not reach one peak and sink: as blocks rock and slip into place λ falls and
rises again many times over motions of a few elastic lengths. Under a displacement such a wall snaps, and where
depends on the steps; under a load it falls to its next rest, or for good. Hence the bracket is one of loads. Friction
remembers: loads in longer steps may bring a wall down earlier or later. The wall is loaded again in steps half as long;
where that brings it down elsewhere, the bracket takes in both.

A beam or supports that are moved by displacements take the wall along, step by step (`led`).
"""

import time
from contextlib import suppress
from dataclasses import replace

import numpy as np
from threadpoolctl import threadpool_limits

from runningbond.joints import ends_note, stiffness_note
from runningbond.limit import elastic_displacement, hanging_displacement
from runningbond.limit.associated import is_self_locking, proved_outcome
from runningbond.limit.kinematics import control_row, dead_load, live_load
from runningbond.results import Outcome, Supports
from runningbond.results.outcome import joined, number
from runningbond.scene import Scene, check_scene

from .climb import INTERRUPTED, NEITHER, SPENT, climb, ends, look_closer, peak
from .led import lead_along
from .pushover import LoadPath, StaticObserver, no_observer, state_of
from .relaxation import relax
from .static_system import Control, StaticSystem, static_system, with_late_pins

FIRST_STEP = 0.03
"""First load, in units of `Equilibrium`."""

FALLEN = 0.05
"""Motion of a block that is a fall unless it slows down, in heights of the lowest block."""

BUDGET = 20_000
"""Linear systems after which a wall is left undecided."""

PAST = 500
"""Linear systems that are spent past the largest load."""

OTHER_STEP = 0.5
"""First step of the path beside the first one, in its own."""

ROUNDING = 1e-9
"""Part of a load by which λ of a state of rest may differ from it."""


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
    """Collapse of a scene under growing loads, each held until the wall rests or falls, at small displacements.

    Parameters
    ----------
    scene
        The scene; its joints need a stiffness.
    tolerance
        Relative width of the bracket.
    first_step
        First load, in live loads as large as the largest dead one, for a weightless wall as the strongest joint
        point. Steps grow while the wall is easily brought to rest and shrink where it is not.
    collapse
        Motion of a block that is a fall unless it slows down, in heights of the lowest block.
    budget
        Linear systems after which it is left undecided, on each path.
    past
        Linear systems that are spent on the curve past the largest load, and on a closer look at the bracket.
    observe
        Called with every state at rest of the first path as it is found, and in the end with those past the largest
        load; then with all those of another path, if that ends lower.

    Returns
    -------
    Outcome
        `lower` is the largest load in equilibrium, `upper` the smallest under which the wall fell; where paths in
        other load steps disagree, both are those of the path that ends lowest and of the one that ends highest.
        `curve` has the states at rest of the lowest, past the largest load under prescribed displacements; `force` is
        of `lower`. Of a wall that is led `curve` has its whole way and `force` is of the answer, and `lower` and
        `upper` are the answers in the last steps and in those twice as long. Ctrl-C ends it with the result so far.
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
                # Under the live load, where joints neither open nor slip.
                moved = elastic_displacement(scene.with_block(young=None), system.equilibrium.live_unit) or 0.0
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
    """What there is to say of the stiffness of joints: at rest under the dead load."""
    equations, law, unit = path.system.equilibrium, path.system.law, path.system.length_unit
    normal = path.rests[0].force[:, 0]
    overlap = unit * float((-normal / law.normal_stiffness[: len(normal)]).max(initial=0.0))
    stiffest = float(max(law.normal_stiffness.max(initial=0.0), law.shear_stiffness.max(initial=0.0)))
    spring, size = equations.force_unit / unit, equations.scene.lowest_block
    return stiffness_note(overlap, path.far * unit, size, spring * stiffest, equations.force_unit)


def _on_paths(result: Outcome, first: LoadPath, budget: int, first_step: float, tolerance: float, past: int) -> Outcome:
    """Outcome of a wall that is loaded from its rest under its weight, and if it collapses in other steps too."""
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
    outcome = _judge(result, path)
    message = outcome.message
    if len(paths) > 1:
        other = f"with load steps {OTHER_STEP:g} times as long {_loads(paths[1])}"
        message += f"; friction remembers: {_loads(first)}, {other}; others may differ by more"
    if len(found) > 1:
        unit = first.system.equilibrium.live_unit
        upper, fall = unit * max(ends(path)[1] for path in ways), unit * min(ends(path)[1] for path in found)
        outcome = replace(outcome, upper=upper, fall=fall)
    steps = budget - first.budget + sum(left - path.budget for path in paths[1:])
    return replace(outcome, steps=steps, message=message + cut)


def _look_closer(path: LoadPath, tolerance: float, past: int) -> str:
    """Follow a path past its largest load, if at all; what there is to say if that was cut short."""
    with suppress(KeyboardInterrupt):
        if past:
            look_closer(path, tolerance, past)
        return ""
    return f"; its curve was {INTERRUPTED}"


def _apart(found: list[LoadPath]) -> list[LoadPath]:
    """Paths whose brackets have no load in common; none where they have: one may rest where another falls."""
    lower, upper = zip(*map(ends, found), strict=True) if found else ((0.0,), (np.inf,))
    return [] if max(lower) < (1 - ROUNDING) * min(upper) else found


def _loads(path: LoadPath) -> str:
    """The bracket of a path, or that it has none."""
    if path.undecided:
        return f"no answer: {path.undecided}"
    return "–".join(number(path.system.equilibrium.live_unit * end) for end in ends(path))


def _judge(result: Outcome, path: LoadPath) -> Outcome:
    """Verdict on a climb, and its arrays."""
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
        message += f"; {NEITHER} under {', '.join(unclear)}" if unclear else ""
        return replace(result, status="collapse", multiplier=result.lower, message=message)
    if path.undecided != INTERRUPTED and path.upper is None and is_self_locking(equations.scene):
        if path.undecided == SPENT:
            message = f"no answer: {path.undecided}, though joint forces balance any multiple of the load"
            return replace(result, message=message)
        message = f"self-locking: {path.undecided}, and joint forces balance any multiple of it"
        return replace(result, status="unbounded", lower=None, motion=np.zeros((0, 3)), message=message)
    return replace(result, message=f"no answer: {path.undecided}")


def _fallen(result: Outcome, system: StaticSystem) -> Outcome:
    """Outcome of a wall that was not brought to rest under its dead load; how it falls is known to limit analysis."""
    fall = proved_outcome(system.equilibrium.scene)
    if fall.status == "infeasible":
        return replace(result, status="infeasible", message=fall.message, motion=fall.motion)
    message = "no equilibrium was found under the dead load"
    told = "" if fall.status == "failed" else ", though forces exist that balance it"
    return replace(result, message=message + told)
