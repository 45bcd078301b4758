"""Limit analysis with true Coulomb friction: slip without dilatancy.

Static and kinematic theorems no longer hold and the collapse load need not be unique. After Gilbert,
Casapulla & Ahmed (2006) a sequence of linear programs freezes each point's shear resistance at μ times a
pressure that is brought up to date between programs. Here the pressure is averaged with weights
(k + 1)^(−1/2) in program k, which settles where fixed weights keep wandering. What the sequence finds is only
believed with a certificate: for the mechanism of one of its programs, forces under the full Coulomb law that
vanish where the mechanism opens and are at the limit, against the motion, where it slides. The multipliers of
such forces are an interval, every point of which is a load at which the wall can collapse.
"""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from runningbond.results import Outcome, collapse_state
from runningbond.scene import Array, Scene

from .associated import LimitState, judge, limit_state, spends_cut_strength
from .equilibrium import Equilibrium, equilibrium
from .force_program import ForceSet, ForceSolution, coulomb, frozen_friction, solve_forces
from .moving_support import BRIDGED, JAMMED, NOTHING, bridges_without_friction, is_bridged, may_leave, reaction_note
from .remarks import remarks

PROGRAM_BUDGET = 40
"""Programs of the sequence after which it ends without a certificate."""

CERTIFIED_IN_A_ROW = 2
"""Certificates in a row that end the sequence."""

NO_JUMP = 1e-7
"""Jump rate, relative to the mechanism's largest motion, that counts as none."""

PENETRATION = 1e-6
"""Closing rate, relative to the mechanism's largest motion, that rules a mechanism out."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proof that a wall can collapse: a scaled mechanism ``(nd,)``, and forces at the least and the most load on it."""

    motion: Array
    least: ForceSolution
    most: ForceSolution


def driving_forces(system: Equilibrium, motion: Array) -> ForceSet | None:
    """Forces that obey Coulomb's law on a mechanism ``(nd,)``: none where it opens, at the limit where it slides.

    A tie that lengthens is at yield, and one that shortens is slack. What holds a beam at its height presses it down,
    if at all: a wall that moves does not get lower. None for a mechanism whose blocks run into each other.
    """
    opening, slip = system.opening.T @ motion, system.slip.T @ motion
    largest = float(np.abs(motion).max(initial=0.0))
    if largest == 0.0 or opening.min(initial=0.0) < -PENETRATION * largest:
        return None
    opens, forward, backward = opening > NO_JUMP * largest, slip > NO_JUMP * largest, slip < -NO_JUMP * largest
    longer = system.elongation(motion)
    cone = coulomb(system.strength)
    up, down = cone.most
    return ForceSet(
        cone.slopes,
        (np.where(opens | backward, 0.0, up), np.where(opens | forward, 0.0, down)),
        np.where(forward, cone.shear_high, cone.shear_low),
        np.where(backward, cone.shear_low, cone.shear_high),
        np.where(longer > NO_JUMP * largest, system.tie_yield, 0.0),
        np.where(longer < -NO_JUMP * largest, 0.0, system.tie_yield),
        late_least=0.0,
    )


def certify(system: Equilibrium, motion: Array) -> Certificate | None:
    """Look for the loads that drive a mechanism; None where there are none. Of loads without end, the least counts."""
    forces = driving_forces(system, motion)
    if forces is None:
        return None
    least = solve_forces(system, forces, "smallest")
    if least.status != "optimal":
        return None
    most = solve_forces(system, forces, "largest")
    if most.status == "unbounded":
        return Certificate(motion, least, least)
    return Certificate(motion, least, most) if most.status == "optimal" else None


@dataclass(frozen=True, eq=False)
class Search:
    """Result of the sequence of programs.

    Parameters
    ----------
    certificates, programs
        Every collapse that was proved, and the number of programs solved in the sequence.
    frictionless
        Whether normal forces alone carry any multiple of the live load.
    growing
        Whether each program of a full sequence carried more than the one before: friction grew with the load.
    """

    certificates: list[Certificate]
    programs: int
    frictionless: bool = False
    growing: bool = False


def search(system: Equilibrium, pressure: Array, high: float = np.inf) -> Search:
    """Run the sequence from a first pressure ``(np,)``, certifying every second program.

    A certificate whose loads all reach `high` is enough by itself.
    """
    certificates: list[Certificate] = []
    in_a_row, multiplier, growing = 0, -np.inf, True
    for k in range(PROGRAM_BUDGET):
        program = solve_forces(system, frozen_friction(system.strength, pressure))
        if program.status == "unbounded":
            return Search(certificates, k + 1, frictionless=True)
        if program.status != "optimal":
            return Search(certificates, k + 1)
        growing, multiplier = growing and program.multiplier > multiplier, program.multiplier
        if k % 2:
            certificate = certify(system, program.motion)
            if certificate is not None:
                certificates.append(certificate)
            in_a_row = in_a_row + 1 if certificate is not None else 0
            if in_a_row == CERTIFIED_IN_A_ROW or (certificate is not None and certificate.least.multiplier >= high):
                return Search(certificates, k + 1)
        weight = (k + 1.0) ** -0.5
        pressure = (1 - weight) * pressure + weight * program.pressure
    return Search(certificates, PROGRAM_BUDGET, growing=growing)


def certified_loads(
    certificates: Sequence[Certificate], load: Callable[[float], float], *, falling: bool = False
) -> list[tuple[float, float]]:
    """Loads at which collapse is certified, as intervals that do not touch, in order.

    `load` makes them of multipliers; `falling` if it falls as they grow.
    """
    ends = [(load(c.least.multiplier), load(c.most.multiplier)) for c in certificates]
    pairs = sorted((min(pair), max(pair)) if falling else pair for pair in ends)
    merged = [pairs[0]]
    for low, high in pairs[1:]:
        if low <= merged[-1][1] + 1e-9 * abs(merged[-1][1]):
            merged[-1] = merged[-1][0], max(high, merged[-1][1])
        else:
            merged.append((low, high))
    return merged


def limit_nonassociated(scene: Scene, tolerance: float = 0.01) -> Outcome:
    """Limit analysis of a scene with true Coulomb friction.

    Parameters
    ----------
    scene, tolerance
        The scene, and the relative width of the interval asked for. A wider one is reported as it is, for the load
        itself is not unique. The search ends with the first certificate that is this close to the associated bound.

    Returns
    -------
    Outcome
        `lower` and `upper` are the smallest and largest load at which a collapse was certified, and
        `multiplier` is the smallest; smaller ones are not excluded, and where several mechanisms were
        certified at loads apart from each other the message says at which. `motion` and `force` belong to it.
        Without a certificate the status is ``undecided`` and `upper` the associated load, which no true
        collapse load exceeds. Of a support that moves, `multiplier` is the largest share of the dead load that it was
        found to bear as the wall gives way, and the associated share is a lower bound.

    Notes
    -----
    A wall whose normal forces balance any multiple of the live load is ``unbounded``, which is proved: no mechanism
    that does not interpenetrate gains power from the load. Where friction is needed for that, Coulomb's law allows
    rest at every multiple, but it may allow a collapse as well, driven by other forces. Such a wall is ``unbounded``
    if no collapse was certified and friction grew with the load in every program; the message says what is not
    proved.
    """
    start = time.perf_counter()
    system = equilibrium(scene).under_live_load()
    state = limit_state(system)
    status, message = judge(state)
    dofs = system.freedoms - system.has_support
    outcome = Outcome(scene.title, "limit-nonassociated", "undecided", dofs=dofs, steps=1, message=message)
    if status in ("collapse", "unbounded"):
        outcome = _collapse(outcome, system, state, tolerance)
    else:
        outcome = replace(outcome, status=status)
    return replace(outcome, message=remarks(scene, outcome.message), seconds=time.perf_counter() - start)


def _collapse(outcome: Outcome, system: Equilibrium, state: LimitState, tolerance: float) -> Outcome:
    """Outcome of a wall that stands; a mechanism that spends of strengths that were cut is none."""
    cut, associated = state.system, state.forces
    bounded = associated.status == "optimal"
    first = associated if bounded else solve_forces(cut, coulomb(cut.strength), "zero")
    # A certificate within the tolerance of the associated bound leaves nothing to search for.
    high = (1 - math.copysign(tolerance, associated.multiplier)) * associated.multiplier if bounded else np.inf
    pressure = first.pressure if first.status == "optimal" else np.zeros(len(cut.points))
    result = search(cut, pressure, high)
    outcome = replace(outcome, steps=1 + result.programs)
    certificates = [
        certificate
        for certificate in result.certificates
        if not spends_cut_strength(system, cut, certificate.motion, dilatancy=0.0)
    ]
    if not certificates:
        return _uncertified(outcome, result, cut, associated.multiplier if bounded else None)
    lowest = min(certificates, key=lambda certificate: certificate.least.multiplier)
    loads = certified_loads(certificates, cut.load, falling=cut.has_support)
    lower, upper = loads[0][0], loads[-1][1]
    if cut.has_support and upper <= NOTHING and may_leave(cut):
        return _bridged(outcome, cut)
    others, beyond = ("larger", "above") if cut.has_support else ("smaller", "below")
    message = f"collapse is certified at every load of the interval; {others} ones are not excluded"
    if len(loads) > 1:
        listed = ", ".join(f"{low:.6g} … {high:.6g}" for low, high in loads)
        message = f"collapse is certified at {listed}, and nothing is proved in between or {beyond}"
    elif upper - lower > tolerance * abs(upper):
        message += "; wider than the tolerance because the load of these mechanisms is not unique"
    least, multiplier = lowest.least, cut.load(lowest.least.multiplier)
    if cut.has_support:
        message = f"{message}; {reaction_note(cut.scene, multiplier)}"
    force = cut.point_forces(least.pressure, least.tangential)
    return replace(
        outcome,
        status="collapse",
        multiplier=multiplier,
        lower=lower,
        upper=max(lower, upper),
        message=message,
        motion=cut.motion(lowest.motion),
        force=force,
        pull=cut.force_unit * least.tie,
        held=-cut.force_unit * least.reaction,
        **collapse_state(cut.scene, cut.points, force, cut.force_unit * least.tie, multiplier),
    )


def _bridged(outcome: Outcome, system: Equilibrium) -> Outcome:
    """Outcome of a wall that bridges its moving support."""
    proof = "by normal forces alone" if bridges_without_friction(system) else "with friction that may come to rest so"
    return replace(outcome, status="unbounded", message=f"{BRIDGED}, {proof}")


def _uncertified(outcome: Outcome, result: Search, system: Equilibrium, bound: float | None) -> Outcome:
    """Outcome of a wall without a certified collapse, under the associated multiplier if there is one."""
    programs = f"no collapse certified in {result.programs} programs"
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
    if result.growing:
        message = f"self-locking: {message}; {programs}, which does not exclude one"
        return replace(outcome, status="unbounded", message=message)
    return replace(outcome, message=f"{programs}; {message}")
