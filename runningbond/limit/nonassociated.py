"""Limit analysis with true Coulomb friction: slip without dilatancy.

Static and kinematic theorems no longer hold and the collapse load need not be unique. After Gilbert,
Casapulla & Ahmed (2006) a sequence of linear programs freezes each point's shear resistance at μ times a
pressure that is brought up to date between programs. Here the pressure is averaged with weights
(k + 1)^(−1/2) in program k, which settles where fixed weights keep wandering. What the sequence finds is only
believed with a certificate: for the mechanism of one of its programs, forces under the full Coulomb law that
vanish where the mechanism opens and are at the limit, against the motion, where it slides. The multipliers of
such forces are an interval, every point of which is a load at which the wall can collapse.
"""

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from runningbond.results import Outcome
from runningbond.scene import Array, Scene

from .associated import LimitState, breaks, judge, limit_state
from .equilibrium import Equilibrium, equilibrium
from .force_program import ForceSet, ForceSolution, coulomb, frozen_friction, solve_forces

MOST_PROGRAMS = 40
"""Programs of the sequence after which an uncertified collapse is given up."""

ENOUGH = 2
"""Certificates in a row that end the sequence."""

STILL = 1e-7
"""Jump rate, relative to the mechanism's largest motion, that counts as none."""

PENETRATION = 1e-6
"""Closing rate, relative to the mechanism's largest motion, that rules a mechanism out."""


@dataclass(frozen=True, eq=False)
class Certificate:
    """Proof that a wall can collapse: a mechanism and the interval of loads that drive it.

    Parameters
    ----------
    motion : (nd,) float
        The mechanism, scaled.
    least, most
        Forces at the smallest and the largest multiplier.
    """

    motion: Array
    least: ForceSolution
    most: ForceSolution


def driving_forces(system: Equilibrium, motion: Array) -> ForceSet | None:
    """Forces that obey Coulomb's law on a mechanism: none where it opens, at the limit where it slides.

    Parameters
    ----------
    system
        The equilibrium equations.
    motion : (nd,) float
        The mechanism.

    Returns
    -------
    ForceSet or None
        None for a mechanism whose blocks run into each other.
    """
    opening, slip = system.opening.T @ motion, system.slip.T @ motion
    largest = float(np.abs(motion).max(initial=0.0))
    if largest == 0.0 or opening.min(initial=0.0) < -PENETRATION * largest:
        return None
    opens, forward, backward = opening > STILL * largest, slip > STILL * largest, slip < -STILL * largest
    cone = coulomb(system.strength)
    up, down = cone.most
    return ForceSet(
        cone.slopes,
        (np.where(opens | backward, 0.0, up), np.where(opens | forward, 0.0, down)),
        np.where(forward, cone.shear_high, cone.shear_low),
        np.where(backward, cone.shear_low, cone.shear_high),
    )


def certify(system: Equilibrium, motion: Array) -> Certificate | None:
    """Look for the loads that drive a mechanism; None where there are none."""
    forces = driving_forces(system, motion)
    if forces is None:
        return None
    least = solve_forces(system, forces, "smallest")
    if least.status != "optimal":
        return None
    most = solve_forces(system, forces, "largest")
    return Certificate(motion, least, most) if most.status == "optimal" else None


@dataclass(frozen=True, eq=False)
class Search:
    """What the sequence of programs came to.

    Parameters
    ----------
    certificates
        Every collapse that was proved.
    programs
        Number of programs solved in the sequence.
    frictionless
        Whether normal forces alone carry any multiple of the live load.
    """

    certificates: list[Certificate]
    programs: int
    frictionless: bool = False


def search(system: Equilibrium, pressure: Array, high: float = np.inf) -> Search:
    """Run the sequence from a first pressure ``(np,)``, certifying every second program.

    A certificate whose loads all reach `high` is enough by itself.
    """
    certificates: list[Certificate] = []
    in_a_row = 0
    for k in range(MOST_PROGRAMS):
        program = solve_forces(system, frozen_friction(system.strength, pressure))
        if program.status == "unbounded":
            return Search(certificates, k + 1, frictionless=True)
        if program.status != "optimal":
            return Search(certificates, k + 1)
        if k % 2:
            certificate = certify(system, program.motion)
            if certificate is not None:
                certificates.append(certificate)
            in_a_row = in_a_row + 1 if certificate is not None else 0
            if in_a_row == ENOUGH or (certificate is not None and certificate.least.multiplier >= high):
                return Search(certificates, k + 1)
        weight = (k + 1.0) ** -0.5
        pressure = (1 - weight) * pressure + weight * program.pressure
    return Search(certificates, MOST_PROGRAMS)


def certified_loads(certificates: Sequence[Certificate], unit: float) -> list[tuple[float, float]]:
    """Loads at which collapse is certified, as intervals that do not touch, in order."""
    pairs = sorted((unit * max(0.0, c.least.multiplier), unit * max(0.0, c.most.multiplier)) for c in certificates)
    merged = [pairs[0]]
    for low, high in pairs[1:]:
        if low <= merged[-1][1] * (1 + 1e-9):
            merged[-1] = merged[-1][0], max(high, merged[-1][1])
        else:
            merged.append((low, high))
    return merged


def limit_nonassociated(scene: Scene, tolerance: float = 0.01) -> Outcome:
    """Limit analysis of a scene with true Coulomb friction.

    Parameters
    ----------
    scene
        The scene.
    tolerance
        Relative width of the interval asked for. A wider one is reported as it is, for the load itself
        is not unique. The search ends with the first certificate that is this close to the associated bound.

    Returns
    -------
    Outcome
        `lower` and `upper` are the smallest and largest load at which a collapse was certified, and
        `multiplier` is the smallest; smaller ones are not excluded, and where several mechanisms were
        certified at loads apart from each other the message says at which. `motion` and `force` belong to it.
        Without a certificate the status is ``undecided`` and `upper` the associated load, which no true
        collapse load exceeds.
    """
    start = time.perf_counter()
    system = equilibrium(scene)
    associated = limit_state(system)
    status, message = judge(associated)
    found = Outcome(scene.title, "limit-nonassociated", "undecided", dofs=system.freedoms, steps=1, message=message)
    if status in ("collapse", "unbounded"):
        found = _collapse(found, system, associated, tolerance)
    else:
        found = replace(found, status=status)
    return replace(found, seconds=time.perf_counter() - start)


def _collapse(found: Outcome, whole: Equilibrium, state: LimitState, tolerance: float) -> Outcome:
    """Outcome of a wall that stands; a mechanism that spends of strengths that were cut is none."""
    system, associated = state.system, state.forces
    bounded = associated.status == "optimal"
    first = associated if bounded else solve_forces(system, coulomb(system.strength), "zero")
    # Between a certificate and the associated bound nothing is left to be found out, if they lie that close.
    high = (1 - tolerance) * associated.multiplier if bounded else np.inf
    searched = search(system, first.pressure, high)
    found = replace(found, steps=1 + searched.programs)
    certificates = [
        proved for proved in searched.certificates if not breaks(whole, system, proved.motion, dilatancy=0.0)
    ]
    if not certificates:
        if searched.frictionless:
            return replace(
                found, status="unbounded", message="self-locking: normal forces carry any multiple of the live load"
            )
        given_up = f"no collapse certified in {searched.programs} programs; "
        if not bounded:
            return replace(found, message=given_up + "with associated joints the wall locks")
        upper = system.live_unit * associated.multiplier
        return replace(found, upper=upper, message=given_up + "upper is the associated bound")
    worst = min(certificates, key=lambda certificate: certificate.least.multiplier)
    proved = certified_loads(certificates, system.live_unit)
    lower, upper = proved[0][0], proved[-1][1]
    message = "collapse is certified at every load of the interval; smaller ones are not excluded"
    if len(proved) > 1:
        loads = ", ".join(f"{low:.6g} … {high:.6g}" for low, high in proved)
        message = f"collapse is certified at {loads}, and nothing is proved in between or below"
    elif upper - lower > tolerance * upper:
        message += "; wider than the tolerance because the load of these mechanisms is not unique"
    return replace(
        found,
        status="collapse",
        multiplier=lower,
        lower=lower,
        upper=max(lower, upper),
        message=message,
        motion=system.motion(worst.motion),
        force=system.point_forces(worst.least.pressure, worst.least.tangential),
    )
