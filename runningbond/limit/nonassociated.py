"""Limit analysis with true Coulomb friction: slip without dilatancy.

The static and kinematic theorems no longer hold, and the collapse load need not be unique. Reported loads are proved by
a certificate (`certificates`). The smallest load is that of the lowest certificate found by a search over many starts
(`search`); no method is known to prove that there is none below.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from runningbond.results import Outcome, collapse_state
from runningbond.results.outcome import number
from runningbond.scene import Array, Scene, SceneError, check_scene, table_of

from .associated import LimitState, arrays_of, dead_load_fall, judge, limit_state, remarks, so_far, uses_cut_strength
from .canonical import Order, canonical_order
from .certificates import TOUCHING, Certificate, certified_loads, certify, least_multiplier
from .coarse import COARSE_POINTS, CoarseSearch
from .equilibrium import Equilibrium, equilibrium
from .force_program import ForceSolution, coulomb, frozen_friction, solve_forces
from .large import search_large, takes_one_start
from .moving_support import HOLDS_SUPPORT, bridged_message, is_bridged, reaction_note
from .search import STARTS, search
from .search_log import Observer, SearchLog

LISTED_INTERVALS = 4
"""Largest number of disjoint intervals of loads that a message lists; if there are more, it states their number."""


def limit_nonassociated(
    scene: Scene,
    tolerance: float = 0.01,
    *,
    starts: int = STARTS,
    workers: int = 1,
    programs: int | None = None,
    observe: Observer = lambda found: None,
) -> Outcome:
    """Run the limit analysis of a scene with true Coulomb friction.

    Parameters
    ----------
    scene, tolerance
        The scene, and the required relative width of the interval. A wider interval is still reported, because the load
        itself is not unique.
    starts, workers
        Largest number of starts of the search (for larger walls, of sequences that find parts of the wall), and number
        of starts run in parallel where possible; the latter does not change the result. Fewer starts are made if the
        last ones found no smaller load, and only one for very large walls.
    programs
        Number of linear programs after which no further start is made; those over parts of the wall count by their
        cost. By default as many as take up to three quarters of a minute on walls of 150 to 600 blocks.
    observe
        Called from time to time with what the search has found.

    Returns
    -------
    Outcome
        `lower` and `upper` are the smallest and largest load at which a collapse was certified, and `multiplier` is the
        smallest found; smaller ones are not excluded. If collapses were certified in disjoint intervals of load, the
        message lists these. `motion` and `force` belong to `multiplier`. Without a certificate the status is
        ``undecided`` and `upper` the associated load, which no true collapse load exceeds. For a moving support,
        `multiplier` is the largest share of the dead load that it was found to carry at collapse, and the associated
        share is a lower bound.

    Raises
    ------
    SceneError
        For joints that crush.

    Notes
    -----
    A wall is proved to be ``unbounded`` if normal forces, and the cohesion left at the tensile strength, balance the
    dead load, and normal forces any multiple of the live load: no mechanism without interpenetration gains power from
    these loads. If the dead load needs friction, as that of a stone wedged between two others, it may bring the wall
    down whatever the live load is, and the outcome is ``undecided``. If the balance of the live load needs friction,
    Coulomb's law allows rest at every multiple, but perhaps also a collapse, driven by other forces. Such a wall is
    ``unbounded`` if no collapse was certified and friction grew with the load in every program; the message states what
    is not proved.
    """
    check_scene(scene)
    start = time.perf_counter()
    _refuse_crushing(scene)
    system = equilibrium(scene).under_live_load()
    state = limit_state(system)
    status, message = judge(state)
    dofs = system.freedoms - system.has_support
    outcome = Outcome(scene.title, "limit-nonassociated", "undecided", dofs=dofs, steps=1, message=message)
    if status in ("collapse", "unbounded"):
        look = partial(_look, starts=starts, workers=workers, observe=observe, most=programs)
        outcome = _collapse(outcome, system, state, tolerance, look)
    elif status == "infeasible":
        outcome = dead_load_fall(outcome, state)
    else:
        outcome = replace(outcome, status=status, upper=so_far(state).get("upper"))
    return replace(
        outcome, message=remarks(scene, outcome.message, certified=True), seconds=time.perf_counter() - start
    )


def _refuse_crushing(scene: Scene) -> None:
    """Refuse joints that crush: certificates neglect crushing, so their forces may exceed what such joints carry."""
    for material in scene.materials_of_joints:
        if material.compressive_strength is not None:
            key = f"{table_of(material)}.compressive_strength"
            remedy = "is not supported by limit-nonassociated, which models no crushing; limit, dem-dynamic and fem do"
            raise SceneError(key, remedy, material.compressive_strength)


def _collapse(
    outcome: Outcome,
    system: Equilibrium,
    state: LimitState,
    tolerance: float,
    look: Callable[[Equilibrium, Array], SearchLog],
) -> Outcome:
    """Outcome of a wall that stands; mechanisms that dissipate energy at reduced strengths are rejected."""
    cut = state.system
    bounded = state.forces.status == "optimal"
    order = canonical_order(cut)
    ordered = order.applied(cut)
    result = look(ordered, order.places(cut.scene))
    proved = _proved_again(system, cut, order, result)
    outcome = replace(outcome, steps=1 + result.programs)
    if not proved:
        return _uncertified(outcome, result, cut, _bounds(state) if bounded else None)
    loads = certified_loads(proved, cut.load, falling=cut.has_support)
    if cut.has_support and is_bridged(cut, loads[-1][1], dilates=False):
        return _bridged(outcome, result, cut)
    lowest, highest = proved[0], max(proved, key=lambda each: each.most.multiplier)
    least, multiplier, far = lowest.least, cut.load(lowest.least.multiplier), cut.load(highest.most.multiplier)
    message = _message(loads, result, tolerance, falling=cut.has_support)
    if endless := next((each for each in proved if each.endless), None):
        least_of_it, others = number(cut.load(endless.least.multiplier)), "smaller" if cut.has_support else "larger"
        message += f"; at every load {others} than {least_of_it} as well, if joints are pressed together by more"
    if cut.has_support:
        message = f"{message}; {reaction_note(cut.scene, multiplier)}"
    arrays = arrays_of(cut, lowest.motion, least)
    return replace(
        outcome,
        status="collapse",
        multiplier=multiplier,
        lower=min(multiplier, far),
        upper=max(multiplier, far),
        message=message,
        **arrays,
        **{f"far_{name}": array for name, array in arrays_of(cut, highest.motion, highest.most).items()},
        **collapse_state(cut.scene, cut.points, arrays["force"], arrays["pull"], multiplier),
    )


def _look(
    system: Equilibrium, place: Array, *, starts: int, workers: int, observe: Observer, most: int | None
) -> SearchLog:
    """Search a wall, with its movable blocks' centroids at `place` ``(n, 2)`` [m], by the method for its size."""
    if takes_one_start(system):
        return search_large(system, place, observe)
    if len(system.points) < COARSE_POINTS or system.has_support:
        searched = None if system.has_support else place
        return search(system, _associated(system), starts, workers, observe, most, place=searched)
    coarse = CoarseSearch(system, place, observe, workers, starts, most)
    found = coarse.run()
    if not (found.certificates or found.interrupted):
        found = search(system, _associated(system), starts, workers, observe, most, found)
        return found if found.interrupted else coarse.go_on()
    return found


def _associated(system: Equilibrium) -> ForceSolution:
    return solve_forces(system, coulomb(system.strength))


def _proved_again(full: Equilibrium, system: Equilibrium, order: Order, result: SearchLog) -> list[Certificate]:
    """Certificates by smallest load, proved on the unrounded equations: lowest, highest, and those needed in between.

    Those that fail there, or dissipate at strengths reduced from `full`, are left out.
    """
    certificates = [replace(each, motion=order.restored(each.motion)) for each in result.certificates]
    certificates = [each for each in certificates if not uses_cut_strength(full, system, each.motion, dilatancy=0.0)]
    proved: list[Certificate] = []
    for end in (_depth, _height):
        remaining = sorted(certificates, key=end)
        while remaining and (not proved or end(remaining[-1]) > end(proved[0])):
            again = certify(system, remaining[-1].motion)
            certificates = [each for each in certificates if each is not remaining[-1]]
            del remaining[-1]
            if again is not None:
                proved.append(again)
                break
    if not proved:
        return []
    inside = [
        each
        for each in certificates
        if proved[0].least.multiplier <= each.least.multiplier and each.most.multiplier <= proved[-1].most.multiplier
    ]
    return sorted(_filled(system, proved, inside), key=least_multiplier)


def _filled(system: Equilibrium, proved: list[Certificate], others: list[Certificate]) -> list[Certificate]:
    """Proved certificates, and as few of some others as prove, together with them, all loads of the others.

    Where the proved loads end, the one of the others that reaches farthest is proved or, if none contains that load,
    the next one above.
    """
    proved, others, end = list(proved), list(others), proved[0].most.multiplier
    while True:
        reach = end + TOUCHING * abs(end)
        starts = {each: max(reach, least_multiplier(each)) for each in (*proved, *others) if _height(each) > reach}
        if not starts:
            return proved
        following = min(starts, key=lambda each: (starts[each], each in others, -_height(each)))
        if following in others:
            others.remove(following)
            again = certify(system, following.motion)
            proved += [] if again is None else [again]
        else:
            end = _height(following)


def _depth(certificate: Certificate) -> float:
    return -certificate.least.multiplier


def _height(certificate: Certificate) -> float:
    return certificate.most.multiplier


def _message(loads: list[tuple[float, float]], result: SearchLog, tolerance: float, *, falling: bool) -> str:
    """Message on what is proved, and on the effort of the search."""
    lower, upper = loads[0][0], loads[-1][1]
    others, beyond = ("larger", "above") if falling else ("smaller", "below")
    message = f"collapse is certified at every load of the interval; {others} ones are not excluded"
    if len(loads) > 1:
        listed = ", ".join(f"{low:.6g} … {high:.6g}" for low, high in loads)
        if len(loads) > LISTED_INTERVALS:
            listed = f"{len(loads)} intervals from {lower:.6g} to {upper:.6g}"
        message = f"collapse is certified at {listed}, and nothing is proved in between or {beyond}"
    elif upper - lower > tolerance * abs(upper):
        message += "; wider than the tolerance because the load of these mechanisms is not unique"
    extreme = "largest" if falling else "lowest"
    dry = f", the last {result.dry} of them in vain" if result.dry else ""
    found = f"{extreme} of {len(result.certificates)} certificates from {_effort(result)}{dry}{_stopped(result)}"
    return f"{message}; {found}"


def _effort(result: SearchLog) -> str:
    return f"{result.starts} starts, {result.programs} linear programs"


def _bounds(state: LimitState) -> list[float]:
    """The associated load by forces and by the mechanism, in order; on large walls they differ a little."""
    return sorted(state.system.load(each) for each in (state.forces.multiplier, state.kinematic_multiplier))


def _stopped(result: SearchLog) -> str:
    return ", interrupted" if result.interrupted else ""


def _bridged(outcome: Outcome, result: SearchLog, system: Equilibrium) -> Outcome:
    """Outcome of a wall that bridges its moving support."""
    searched = f"no larger share was certified from {_effort(result)}{_stopped(result)}, which does not exclude one"
    message = bridged_message(system, f"with friction that may come to rest so; {searched}")
    return replace(outcome, status="unbounded", message=message)


def _rests_without_friction(system: Equilibrium) -> bool:
    """Whether normal forces, and the cohesion left at the tensile strength, balance the dead load.

    A moving support does not move yet, and may carry any part of it.
    """
    forces = frozen_friction(system.strength, np.zeros(len(system.points)))
    return solve_forces(system.under_dead_load(), forces, "zero").status == "optimal"


def _uncertified(outcome: Outcome, result: SearchLog, system: Equilibrium, bounds: list[float] | None) -> Outcome:
    """Outcome of a wall without a certified collapse; the associated load bounds it if its `bounds` are known."""
    programs = f"no collapse certified from {_effort(result)}{_stopped(result)}"
    if result.frictionless:
        message = HOLDS_SUPPORT if system.has_support else "normal forces carry any multiple of the live load"
        if _rests_without_friction(system):
            return replace(outcome, status="unbounded", message=f"self-locking: {message}")
        return replace(outcome, message=f"{programs}; {message}, but the dead load needs friction, which may give way")
    if bounds and system.has_support:
        if is_bridged(system, bounds[0], dilates=False):
            return _bridged(outcome, result, system)
        return replace(outcome, lower=bounds[0], message=f"{programs}; lower is the associated bound")
    if bounds:
        return replace(outcome, upper=bounds[1], message=f"{programs}; upper is the associated bound")
    message = "forces within Coulomb's law balance any multiple of the live load"
    if result.growing and not result.interrupted:
        message = f"self-locking: {message}; {programs}, which does not exclude one"
        return replace(outcome, status="unbounded", message=message)
    return replace(outcome, message=f"{programs}; {message}")
