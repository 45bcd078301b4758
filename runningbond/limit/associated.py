"""Associated limit analysis: the largest load multiplier that admissible joint forces can balance.

The static and kinematic theorems hold for associated joints, which open by tan φ times their slip. The optimum of the
linear program and its dual, the collapse mechanism, bracket one limit load (Livesley 1978). For true friction, which
has no dilatancy, it is an upper bound.
"""

import time
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Context
from typing import Any

import numpy as np

from runningbond.joints import PointStrength
from runningbond.results import Outcome, Status, collapse_state
from runningbond.results.outcome import two_digits
from runningbond.scene import Array, Scene, check_scene

from .crushed import beyond_note, crushed, crushing_note, without_crushing
from .equilibrium import Equilibrium, equilibrium
from .force_program import ForceSolution, coulomb, frozen_friction, solve_forces
from .moving_support import HOLDS_SUPPORT, support_verdict
from .proved import CLOSE, STOP, fall_at_rest, is_large, proved, resting_forces, tolerance_of
from .repair import ROUNDING

NO_EQUILIBRIUM = "collapses under its dead load: no admissible forces balance it"
INTERRUPTED = "the linear program was interrupted"
ZERO_MULTIPLIER = 1e-6
"""Multiplier, in `Equilibrium.live_unit`, below which widths of brackets are relative to this value: λ may be zero."""

PROOF_TOLERANCE = 1e-6
"""Largest relative residual, violation or duality gap at which the solution of a program is accepted."""

WIDTHS = ("gap", "complementarity")
"""Measures that give the width of the bracket; the others decide whether it is a bracket at all."""

STRENGTH_CAP = 1e6
"""Strength of a joint point, in force units (largest dead load on a block), to which larger ones are first reduced.

Joints rarely reach such strengths, and numbers that large would swamp the other forces of the program.
"""

FRICTION_CAP = 1e3
"""Largest tan φ of the program that is solved if HiGHS fails on that of the true one."""

BOUND_MARGIN = 5e-10
"""Relative amount by which `proved_bound` raises a bound before rounding it up; at most half of the ninth digit."""


@dataclass(frozen=True, eq=False)
class LimitState:
    """The optimum of a scene's limit analysis, with the measures that decide whether it is accepted.

    Parameters
    ----------
    system, forces
        The equilibrium equations, and the solution of the linear program.
    rests, self_locking
        Whether admissible forces balance the dead load, and any multiple of the live load; None if this was not
        checked.
    """

    system: Equilibrium
    forces: ForceSolution
    rests: bool | None = None
    self_locking: bool | None = None

    @property
    def jumps(self) -> tuple[Array, Array]:
        """Opening and slip rates of the mechanism at each point, two ``(np,)``."""
        return self.system.jumps(self.forces.motion)

    @property
    def kinematic_multiplier(self) -> float:
        """Multiplier at which the power of the loads equals the dissipation in the mechanism, in scaled units."""
        return self.system.kinematic_multiplier(self.forces.motion)

    @property
    def sound(self) -> bool:
        """Whether forces and mechanism prove each other optimal.

        For large walls the bracket may be as wide as `tolerance_of`; with crushing joints, made of facets, any width
        counts.
        """
        width = max(PROOF_TOLERANCE, tolerance_of(self.system)) if self.system.crushing is None else np.inf
        return self._within(width)

    @property
    def admissible(self) -> bool:
        """Whether forces and mechanism prove a bracket of any width."""
        return self._within(np.inf)

    def _within(self, width: float) -> bool:
        return all(value <= (width if name in WIDTHS else PROOF_TOLERANCE) for name, value in self.measures.items())

    @property
    def measures(self) -> dict[str, float]:
        """Error measures, all of them zero for an exact solution.

        - ``residual``: largest unbalanced force or moment, relative to the largest force.
        - ``violation``: largest distance of a point's forces from its cone of strength, or of a tie's pull from its
          range, relative to the largest force.
        - ``penetration``: largest violation of the flow rule, opening ≥ tan φ |slip|, relative to the largest motion;
          divided by tan φ if that exceeds 1, because a large tan φ amplifies rounding errors.
        - ``gap``: distance between static and kinematic multiplier, relative to the larger of the static one and 1.
        - ``complementarity``: dissipation minus power of forces at points and ties, relative to the live load's power.
        """
        system, forces, strength = self.system, self.forces, self.system.strength
        multiplier, tangential, motion = forces.multiplier, forces.tangential, forces.motion
        normal, (opening, slip) = strength.tension - forces.pressure, self.jumps
        in_joints = system.opening @ normal + system.slip @ tangential
        in_joints = in_joints + system.tie @ forces.tie
        unbalanced = in_joints + system.reaction @ forces.reaction - multiplier * system.live - system.dead
        outside = strength.violation(normal, tangential) / np.hypot(1.0, strength.friction)
        beyond = np.maximum(-forces.tie, forces.tie - system.tie_yield)
        parts = (forces.pressure, tangential, forces.tie, system.dead)
        # In a weightless wall that carries nothing, all forces are rounding errors.
        largest = max(ZERO_MULTIPLIER, abs(multiplier), *(np.abs(part).max(initial=0.0) for part in parts))
        fastest = np.abs(motion).max(initial=0.0)
        spent = normal * opening + tangential * slip
        longer = system.elongation(motion)
        held_back = system.tie_yield * longer.clip(min=0.0) - forces.tie * longer
        closing = (strength.friction * np.abs(slip) - opening) / np.maximum(1.0, strength.friction)
        if system.crushing is not None:
            first, second = system.crushing.ends
            spent[first] += spent[second]
            spent[second] = closing[first] = closing[second] = 0.0
        short = system.dissipation(motion) - spent
        power = np.abs(system.live @ motion) * max(1.0, abs(multiplier))
        measures = {
            "residual": np.abs(unbalanced).max() / largest,
            "violation": max(outside.max(initial=0.0), beyond.max(initial=0.0)) / largest,
            "penetration": closing.max(initial=0.0) / (fastest or np.inf),
            "gap": abs(self.kinematic_multiplier - multiplier) / max(1.0, abs(multiplier)),
            "complementarity": np.abs(np.append(short, held_back)).max(initial=0.0) / power,
        }
        return {name: float(value) for name, value in measures.items()}


def limit_state(system: Equilibrium) -> LimitState:
    """Solve the associated limit analysis of a scene; the status of the solution may differ from ``optimal``.

    Strengths above `STRENGTH_CAP` are first reduced to it. Forces admissible for weaker joints are admissible for
    stronger ones: the solution holds if its mechanism dissipates nothing at reduced strengths, and the state then has
    the reduced system. Otherwise the analysis is repeated with a force unit `STRENGTH_CAP` times as large.
    """
    if system.crushing is not None:
        forces, rests = crushed(system, system.crushing)
        return LimitState(system, forces, rests=rests)
    weaker = _with_capped_strength(system)
    if weaker is system:
        return _solved(system)
    state = _solved(weaker)
    if state.forces.status == "budget":  # the mechanism may dissipate at reduced strengths
        return replace(state, forces=replace(state.forces, motion=np.zeros(0)))
    if (
        state.forces.status == "optimal"
        and state.sound
        and not uses_cut_strength(system, weaker, state.forces.motion, dilatancy=system.strength.friction)
    ):
        return state
    return limit_state(system.in_forces_of(STRENGTH_CAP))


def _with_capped_strength(system: Equilibrium) -> Equilibrium:
    """Return the same equations with strengths of at most `STRENGTH_CAP`."""
    strength = system.strength
    if strength.strongest <= STRENGTH_CAP:
        return system
    # At the lower tension the cone is wider: the shear strength there is larger, and the cohesion is kept.
    tension = strength.tension.clip(max=STRENGTH_CAP)
    shear = (strength.cohesion - strength.friction * tension).clip(max=STRENGTH_CAP)
    return replace(system, strength=PointStrength(strength.friction, tension, shear))


def uses_cut_strength(system: Equilibrium, weaker: Equilibrium, motion: Array, *, dilatancy: Array | float) -> bool:
    """Whether a mechanism ``(nd,)`` dissipates energy, beyond rounding, at strengths that are lower in a weaker system.

    A point that opens by exactly `dilatancy` times its slip dissipates cohesion only.
    """
    unit = weaker.force_unit / system.force_unit * (1 + PROOF_TOLERANCE)
    opening, slip = system.jumps(motion)
    slip = np.abs(slip)
    jumps = np.array([np.abs(opening - dilatancy * slip), slip])
    pairs = [(each.strength.tension, each.strength.cohesion) for each in (weaker, system)]
    cut = np.array([unit * less < strength for less, strength in zip(*pairs, strict=True)])
    return float(jumps[cut].max(initial=0.0)) > PROOF_TOLERANCE * float(jumps.max(initial=0.0))


def _solved(system: Equilibrium) -> LimitState:
    if is_large(system):
        state = _proved(system)
        if state is not None:
            return state
    forces = solve_forces(system, coulomb(system.strength))
    if forces.status == "infeasible" and stands_under_dead_load(system.under_dead_load()) is False:
        return LimitState(system, forces, rests=False)
    if forces.status in ("infeasible", "numerical"):  # if the interior point cannot decide, the simplex method does
        forces = solve_forces(system, coulomb(system.strength), method="highs-ds")
    state = LimitState(system, forces)
    if is_large(system):
        return state
    if forces.status == "optimal" and state.measures["penetration"] > ROUNDING:
        # HiGHS treats joints of very little friction as frictionless, so that they carry any pressure.
        exact = _proved(system)
        if exact is not None and exact.forces.status == "optimal":
            return exact
    if forces.status == "numerical" or (forces.status == "optimal" and not state.sound):
        return _with_capped_friction(system) or state
    return state


def _with_capped_friction(system: Equilibrium) -> LimitState | None:
    """Return the state that the solution with a tan φ of at most `FRICTION_CAP` proves; None if it proves none.

    Forces admissible with less friction are admissible with more, and a mechanism is if no point slips whose friction
    was reduced.
    """
    strength = system.strength
    if strength.friction.max(initial=0.0) <= FRICTION_CAP:
        return None
    weaker = replace(system, strength=replace(strength, friction=strength.friction.clip(max=FRICTION_CAP)))
    state = LimitState(system, solve_forces(weaker, coulomb(weaker.strength)))
    if state.forces.status == "unbounded" and _balances_any_multiple(weaker):
        return replace(state, self_locking=True)
    proves = state.forces.status == "optimal" and state.sound and state.measures["penetration"] <= ROUNDING
    return state if proves else None


def _proved(system: Equilibrium) -> LimitState | None:
    """Return the state that the interior point's solution proves; None if it proves neither a bracket nor a verdict."""
    dead = system.under_dead_load()
    resting, point = resting_forces(dead)
    fall = fall_at_rest(dead, point) if resting is None else None
    if fall is not None:
        return LimitState(system, replace(ForceSolution.none("infeasible"), motion=fall), rests=False)
    state = LimitState(system, proved(system, resting), rests=None if resting is None else True)
    if _needs_closer_stop(state):
        # A vertex costs hours, the interior point's last iterations only seconds.
        state = _narrower(state, replace(state, forces=proved(system, resting, STOP[CLOSE])))
    if state.forces.status == "optimal":
        return state if state.sound else None
    if state.forces.status == "budget":
        return state
    if state.forces.status == "infeasible" and stands_under_dead_load(dead) is False:
        return replace(state, rests=False)
    if state.forces.status == "unbounded" and _balances_any_multiple(system):
        return replace(state, self_locking=True)
    return None


def _needs_closer_stop(state: LimitState) -> bool:
    """Whether a very large wall's interior point stopped before it proved an acceptable bracket."""
    if tolerance_of(state.system) == CLOSE:
        return False
    return state.forces.status == "numerical" or (state.forces.status == "optimal" and not state.sound)


def _narrower(first: LimitState, second: LimitState) -> LimitState:
    """Return the second of two states, or the first's bracket if the second was interrupted before it had one."""
    interrupted = second.forces.status == "budget" and first.forces.status == "optimal"
    if interrupted and first.admissible:
        return replace(first, forces=replace(first.forces, status="budget"))
    return second


def stands_under_dead_load(system: Equilibrium) -> bool | None:
    """Whether admissible forces balance the dead load without live load; None if the solver cannot decide.

    Normal forces nearly always suffice, and their program is much smaller; the full friction cones are tried only if
    normal forces do not suffice.
    """
    if not system.dead.any():
        return True
    dry = system.without_strength(system.dead)
    if solve_forces(dry, frozen_friction(dry.strength, np.zeros(len(dry.points))), "zero").status == "optimal":
        return True
    status = solve_forces(system, coulomb(system.strength), "zero").status
    return status == "optimal" if status in ("optimal", "infeasible") else None


def bears_dead_load(scene: Scene) -> bool:
    """Whether admissible joint forces, also of crushing joints, balance a scene's dead load and some live load."""
    outcome = limit(scene)
    if outcome.status == "collapse":
        return scene.settlement is not None or (outcome.upper or 0.0) > 0
    return outcome.status == "unbounded"


def is_self_locking(scene: Scene) -> bool:
    """Whether admissible joint forces balance any multiple of a scene's live load."""
    system = equilibrium(scene).with_crushing().under_live_load()
    # For a large wall a bound is proved in seconds, while HiGHS takes minutes to find that there are no such forces.
    if system.crushing is None and is_large(system):
        state = _proved(system)
        if state is not None and state.forces.status == "optimal":
            return False
    return _balances_any_multiple(system)


def _balances_any_multiple(system: Equilibrium) -> bool:
    """Whether forces of dry joints balance the live load without dead load; they can be added any number of times.

    Ties are left out, because their forces are bounded.
    """
    dry = system.without_strength(system.live)
    if system.crushing is not None:
        others, rays = without_crushing(dry, system.crushing)
        return solve_forces(others, rays, "zero").status == "optimal"
    if is_large(system) and resting_forces(dry)[0] is not None:
        return True
    return solve_forces(dry, coulomb(dry.strength), "zero").status == "optimal"


def judge(state: LimitState) -> tuple[Status, str]:
    """Status of a limit analysis, and a line that explains it.

    A result is accepted only with its proof: an optimum with matching forces and mechanism, a dead load that no forces
    balance, or self-locking forces.
    """
    system, program = state.system, state.forces.status
    stands = state.rests
    if stands is None and system.crushing is None:
        stands = stands_under_dead_load(system.under_dead_load())
    if stands is None:
        return "failed", "the solver cannot tell whether the wall stands under its dead load"
    if not stands:
        return "infeasible", NO_EQUILIBRIUM
    if program == "optimal":
        if not state.sound:
            return "failed", f"forces and mechanism disagree: {state.measures}"
        if system.has_support:
            return support_verdict(system, system.load(state.forces.multiplier))
        message = "static and kinematic bound, associated joints; true friction may collapse earlier"
        return "collapse", message if system.crushing is None else f"{message}; {crushing_note(system, state.forces)}"
    if program == "budget":
        return "undecided", INTERRUPTED
    if state.self_locking or _balances_any_multiple(system):
        if system.has_support:
            return "unbounded", f"self-locking: {HOLDS_SUPPORT}, with associated joints; true friction may give way"
        message = "self-locking: admissible forces balance any multiple of the live load"
        return "unbounded", f"{message}, with associated joints; true friction may collapse"
    if program == "infeasible":  # at λ = 0 it has the same forces as the program of the dead load
        return "undecided", "the wall is on the brink of falling under its dead load, within rounding"
    return "failed", f"the linear program was not solved: {program}"


def limit(scene: Scene, tolerance: float = 0.01) -> Outcome:
    """Run the associated limit analysis of a scene.

    Parameters
    ----------
    scene, tolerance
        The scene, and the required relative width of the bracket. A vertex closes the bracket to about 1e-9. The
        repaired interior point of a large wall, and the facets of crushing joints, close it to 1e-6; for a very large
        wall, or a large one with crushing joints, to 1e-4; for a huge wall to 1e-2. If the bracket is wider than
        required, the status is ``undecided``.

    Returns
    -------
    Outcome
        `lower` follows from the forces, `upper` from the mechanism; `motion` is the mechanism, `force` the forces. For
        a moving support λ is the smallest share of the dead load that it can carry, `lower` follows from the mechanism
        and `upper` from the forces; if λ is negative, the support has to be driven along its motion.
    """
    check_scene(scene)
    start = time.perf_counter()
    system = equilibrium(scene).with_crushing().under_live_load()
    state = limit_state(system)
    status, message = judge(state)
    outcome = Outcome(
        *(scene.title, "limit", "undecided"),
        dofs=system.freedoms - system.has_support,
        steps=state.forces.iterations,
        message=remarks(scene, message + beyond_note(system)),
    )
    if status == "collapse":
        outcome = _bracketed(outcome, state, tolerance)
    elif status == "infeasible":
        outcome = dead_load_fall(outcome, state)
    else:
        outcome = replace(outcome, status=status, **so_far(state))
    return replace(outcome, seconds=time.perf_counter() - start)


def remarks(scene: Scene, message: str, *, certified: bool = False) -> str:
    """A message, extended by notes on how ties and the beam were modelled, in `certified` collapses or in bounds."""
    pressed = (
        "the beam presses on the wall with at least its dead load; a wall that sinks as it slides may fall earlier"
    )
    free = "the beam is held at its height by whatever vertical force is needed"
    notes = {
        "ties count only by their yield force": len(scene.ties) > 0,
        "not included: friction due to tie.preload, which may hold the wall at these loads": scene.ties.preload.any(),
        pressed if certified else free: len(scene.late_pins) > 0,
        "λ is the force on the beam [N]": len(scene.drive_path) > 0,
        "only the first direction of the beam's path counts": len(scene.drive_path) > 1,
    }
    return "; ".join([message, *(note for note, applies in notes.items() if applies)])


def proved_bound(scene: Scene) -> float | None:
    """Multiplier above which the wall cannot stand, if `limit` proves one; Ctrl-C raises KeyboardInterrupt.

    It is rounded up to nine digits: more digits differ by machine, and load steps depend on it. It is first raised by
    `BOUND_MARGIN`, because otherwise the last bits of a bound such as 0.5 would decide whether its ninth digit changes.
    """
    upper = proved_outcome(scene).upper
    if upper is None:
        return None
    return float(Context(9, ROUND_CEILING).create_decimal_from_float(upper + BOUND_MARGIN * abs(upper)))


def proved_outcome(scene: Scene) -> Outcome:
    """Outcome of `limit`; an interrupted linear program raises KeyboardInterrupt instead of an undecided outcome."""
    outcome = limit(scene)
    if outcome.message.startswith(INTERRUPTED):
        raise KeyboardInterrupt
    return outcome


def so_far(state: LimitState) -> dict[str, Any]:
    """What an interrupted program has proved: bounds, with their forces and mechanism, or that the wall stands."""
    system, forces = state.system, state.forces
    if forces.status != "budget" or system.has_support:
        return {}
    if not len(forces.motion):
        return {"lower": 0.0} if state.rests else {}
    if not state.admissible:
        return {}
    arrays = arrays_of(system, forces.motion, forces)
    return {"lower": system.load(forces.multiplier), "upper": system.load(state.kinematic_multiplier), **arrays}


def _bracketed(outcome: Outcome, state: LimitState, tolerance: float) -> Outcome:
    system, forces = state.system, state.forces
    static, kinematic = system.load(forces.multiplier), system.load(state.kinematic_multiplier)
    lower, upper = min(static, kinematic), max(static, kinematic)
    if upper - lower > tolerance * max(abs(lower), abs(upper), system.live_unit * ZERO_MULTIPLIER):
        return replace(outcome, lower=lower, upper=upper, message="static and kinematic bound lie too far apart")
    arrays = arrays_of(system, forces.motion, forces)
    known = collapse_state(system.scene, system.points, arrays["force"], arrays["pull"], static)
    return replace(outcome, status="collapse", multiplier=static, lower=lower, upper=upper, **arrays, **known)


def dead_load_fall(outcome: Outcome, state: LimitState) -> Outcome:
    """Outcome of a wall that collapses under its dead load: mechanism and, for small walls, the share it can carry."""
    dead, motion = state.system.under_dead_load(), state.forces.motion
    outcome = replace(outcome, status="infeasible")
    if not is_large(dead):
        growing = limit_state(replace(dead, live=dead.dead, dead=np.zeros(dead.freedoms), live_unit=1.0))
        if judge(growing)[0] != "collapse":
            return outcome
        motion, share = growing.forces.motion, growing.system.load(growing.kinematic_multiplier)
        if share > ZERO_MULTIPLIER:
            outcome = replace(outcome, message=f"{outcome.message}; they balance {two_digits(share)} of it")
    return replace(outcome, motion=dead.motion(motion)) if len(motion) else outcome


def arrays_of(system: Equilibrium, motion: Array, forces: ForceSolution) -> dict[str, Any]:
    """A mechanism ``(nd,)`` and the forces that drive it, as the arrays of an `Outcome`."""
    normal = system.strength.tension - forces.pressure
    return {
        "motion": system.motion(motion),
        "force": system.force_unit * np.column_stack([normal, forces.tangential]),
        "pull": system.force_unit * forces.tie,
        "held": -system.force_unit * forces.reaction,
    }
