"""Limit analysis with true Coulomb friction: slip without dilatancy.

Static and kinematic theorems no longer hold and the collapse load need not be unique. What is reported is proved by a
certificate (`certificates`), and the smallest load is that of the lowest certificate that a search over many starts
found (`search`); nobody knows how to prove that there is none below.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from runningbond.results import Outcome, collapse_state
from runningbond.scene import Array, Scene, SceneError, check_scene, table_of

from .associated import LimitState, arrays_of, falling, judge, limit_state, remarks, so_far, spends_cut_strength
from .canonical import Order, canonical_order
from .certificates import Certificate, certified_loads, certify, least_multiplier
from .coarse import POINTS, CoarseSearch
from .equilibrium import Equilibrium, equilibrium
from .force_program import ForceSolution, coulomb, solve_forces
from .large import search_large, takes_one_start
from .moving_support import JAMMED, NOTHING, bridged_message, is_bridged, may_leave, reaction_note
from .search import STARTS, search
from .search_log import Observer, SearchLog

LISTED = 4
"""Intervals of certified loads, apart from each other, that a message lists; of more it tells the number."""


def limit_nonassociated(
    scene: Scene,
    tolerance: float = 0.01,
    *,
    starts: int = STARTS,
    workers: int = 1,
    programs: int | None = None,
    observe: Observer = lambda found: None,
) -> Outcome:
    """Limit analysis of a scene with true Coulomb friction.

    Parameters
    ----------
    scene, tolerance
        The scene, and the relative width of the interval asked for. A wider one is reported as it is, for the load
        itself is not unique.
    starts, workers
        Most starts of the search, over the wall or, of larger ones, to find its parts, and how many are made at a time
        where they can be, which changes nothing of what is found. Fewer are made where none of the last ones brought a
        smaller load, and of very large walls one alone.
    programs
        Linear programs after which no further start is made, those over parts of the wall counted by what they cost;
        where they are not given, as many as take up to three quarters of a minute on walls of 150 to 600 blocks.
    observe
        Is shown what the search has found, from time to time.

    Returns
    -------
    Outcome
        `lower` and `upper` are the smallest and largest load at which a collapse was certified, and
        `multiplier` is the smallest found; smaller ones are not excluded, and where several mechanisms were
        certified at loads apart from each other the message says at which. `motion` and `force` belong to it.
        Without a certificate the status is ``undecided`` and `upper` the associated load, which no true
        collapse load exceeds. Of a support that moves, `multiplier` is the largest share of the dead load that it was
        found to bear as the wall gives way, and the associated share is a lower bound.

    Raises
    ------
    SceneError
        For joints that crush.

    Notes
    -----
    A wall whose normal forces balance any multiple of the live load is ``unbounded``, which is proved: no mechanism
    that does not interpenetrate gains power from the load. Where friction is needed for that, Coulomb's law allows
    rest at every multiple, but it may allow a collapse as well, driven by other forces. Such a wall is ``unbounded``
    if no collapse was certified and friction grew with the load in every program; the message says what is not
    proved.
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
        outcome = falling(outcome, state)
    else:
        outcome = replace(outcome, status=status, upper=so_far(state).get("upper"))
    return replace(outcome, message=remarks(scene, outcome.message), seconds=time.perf_counter() - start)


def _refuse_crushing(scene: Scene) -> None:
    """Certificates know of no crushing: their forces may be more than such joints bear."""
    for material in scene.materials_of_joints:
        if material.compressive_strength is not None:
            key = f"{table_of(material)}.compressive_strength"
            remedy = "is not taken by limit-nonassociated, which knows no crushing; limit, dem-dynamic and fem do"
            raise SceneError(key, remedy, material.compressive_strength)


def _collapse(
    outcome: Outcome,
    system: Equilibrium,
    state: LimitState,
    tolerance: float,
    look: Callable[[Equilibrium, Array], SearchLog],
) -> Outcome:
    """Outcome of a wall that stands; a mechanism that spends of strengths that were cut is none."""
    cut = state.system
    bounded = state.forces.status == "optimal"
    order = canonical_order(cut)
    ordered = order.applied(cut)
    result = look(ordered, order.places(cut.scene))
    proved = _proved_again(system, cut, order, result)
    outcome = replace(outcome, steps=1 + result.programs)
    if not proved:
        return _uncertified(outcome, result, cut, state.forces.multiplier if bounded else None)
    loads = certified_loads(proved, cut.load, falling=cut.has_support)
    if cut.has_support and loads[-1][1] <= NOTHING and may_leave(cut):
        return _bridged(outcome, cut)
    lowest, highest = proved[0], max(proved, key=lambda each: each.most.multiplier)
    least, multiplier, far = lowest.least, cut.load(lowest.least.multiplier), cut.load(highest.most.multiplier)
    message = _message(loads, result, tolerance, falling=cut.has_support)
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
    """Search a wall whose movable blocks have their centroids at `place` ``(n, 2)`` [m], as its size asks for."""
    if takes_one_start(system):
        return search_large(system, place, observe)
    if len(system.points) < POINTS or system.has_support:
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
    """Certificates by the least load, the first and the one of the largest load proved on the unrounded equations.

    What cannot be proved there is left out, and mechanisms that spend of strengths which `full` has more of.
    """
    certificates = [replace(each, motion=order.restored(each.motion)) for each in result.certificates]
    certificates = [each for each in certificates if not spends_cut_strength(full, system, each.motion, dilatancy=0.0)]
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
    return sorted([*proved, *inside], key=least_multiplier)


def _depth(certificate: Certificate) -> float:
    return -certificate.least.multiplier


def _height(certificate: Certificate) -> float:
    return certificate.most.multiplier


def _message(loads: list[tuple[float, float]], result: SearchLog, tolerance: float, *, falling: bool) -> str:
    """What is proved, and how hard anything else was looked for."""
    lower, upper = loads[0][0], loads[-1][1]
    others, beyond = ("larger", "above") if falling else ("smaller", "below")
    message = f"collapse is certified at every load of the interval; {others} ones are not excluded"
    if len(loads) > 1:
        listed = ", ".join(f"{low:.6g} … {high:.6g}" for low, high in loads)
        if len(loads) > LISTED:
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


def _stopped(result: SearchLog) -> str:
    return ", interrupted" if result.interrupted else ""


def _bridged(outcome: Outcome, system: Equilibrium) -> Outcome:
    """Outcome of a wall that bridges its moving support."""
    message = bridged_message(system, "with friction that may come to rest so")
    return replace(outcome, status="unbounded", message=message)


def _uncertified(outcome: Outcome, result: SearchLog, system: Equilibrium, bound: float | None) -> Outcome:
    """Outcome of a wall without a certified collapse, under the associated multiplier if there is one."""
    programs = f"no collapse certified from {_effort(result)}{_stopped(result)}"
    if result.frictionless:
        message = JAMMED if system.has_support else "self-locking: normal forces carry any multiple of the live load"
        return replace(outcome, status="unbounded", message=message)
    if bound is not None and system.has_support:
        share = system.load(bound)
        if is_bridged(system, share):
            return _bridged(outcome, system)
        return replace(outcome, lower=share, message=f"{programs}; lower is the associated bound")
    if bound is not None:
        message = f"{programs}; upper is the associated bound"
        return replace(outcome, upper=system.live_unit * bound, message=message)
    message = "forces within Coulomb's law balance any multiple of the live load"
    if result.growing and not result.interrupted:
        message = f"self-locking: {message}; {programs}, which does not exclude one"
        return replace(outcome, status="unbounded", message=message)
    return replace(outcome, message=f"{programs}; {message}")
