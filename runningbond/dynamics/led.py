"""Walls under prescribed displacements: of a beam on a path, of supports from rest to rest, or pushed by the live load.

The whole path is traversed again at half the speed until its answer converges: the largest reaction of a beam's drive
along its first move, the share of the dead load that supports carry at the required settlement, or the largest
multiplier of a pushing live load. The answer counts as a collapse if a mechanism has formed: if it has changed by less
than the tolerance over the last tenth of the path and, at small displacements, would grow by no more than that on a
path twice as long; or the wall falls. Otherwise the wall still hardens, or the support still sheds or takes up load,
at the end of the path. A wall at rest whose support carries nothing any more bridges it.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from runningbond.joints import JointPoints
from runningbond.results import Outcome, Supports
from runningbond.results.mechanism import fastest_corner
from runningbond.results.outcome import joined, number, two_digits
from runningbond.results.reactions import AT_REST, COME_FREE, WORKS
from runningbond.scene import Indices, Scene

from .beam_drive import BeamDrive
from .collapse import Criteria, crushing_note
from .dead_load import fall_under_dead_load, put_on_dead_load
from .lead import Lead
from .push import Push
from .run import CALMING, Observer, Run, Unstable, no_observer
from .state import State
from .support_settlement import SupportSettlement
from .traverse import BEAM, Traverse

LEAST_STEPS, REST_MULTIPLE, REST_MULTIPLE_FINITE = 20_000, 20, 2
"""Fewest time steps of the longest leg in the first traverse if no rate is given, and their least multiple of the steps
to rest under the dead load: at small displacements, and at finite ones, whose paths are longer.
"""

FALL_MULTIPLE = 2
"""How many more steps supports take that move at finite displacements: shaken blocks slide a little, and fall early."""

LOCKED = 20.0
"""Largest ratio of live force to weight of a block (weightless: to the strength of the strongest joint point) up to
which a self-locking wall is pushed."""

MUCH = 0.5
"""Growth that is left, relative to the tolerance, above which a bracket need not have room for it."""

UNACCOUNTED = 0.01
"""Fraction of the work of the loads that the energy ledger may miss before a run counts as failed."""


class _LastPath:
    """Observer that passes states on to another one, and keeps those of the last traverse to show them again."""

    def __init__(self, observe: Observer) -> None:
        self._observe = observe
        self._seen: list[tuple[Run, State, float]] = []

    def __call__(self, run: Run, state: State, multiplier: float) -> None:
        """Pass a state on."""
        if run.is_driven:
            if self._seen and state.steps < self._seen[-1][1].steps:  # the first state of a slower traverse
                self._seen.clear()
            self._seen.append((run, state.copy(), multiplier))
        self._observe(run, state, multiplier)

    def show_again(self) -> None:
        """Show the last traverse once more to an observer that has seen another path since."""
        with suppress(KeyboardInterrupt):
            for seen in self._seen:
                self._observe(*seen)


@dataclass(frozen=True, eq=False)
class LedWall:
    """A wall whose displacements are prescribed; its fields are the arguments of `collapse_by_steps` of their names."""

    scene: Scene
    run: Run
    tolerance: float
    points: JointPoints
    point_order: Indices
    is_self_locking: Callable[[], bool]
    bears: Callable[[], bool]
    criteria: Criteria


def collapse_of_led(outcome: Outcome, wall: LedWall, observe: Observer, distance: float | None) -> Outcome:
    """Apply the displacements of a scene to a wall; `observe` as in `collapse_by_steps`.

    `outcome` is the outcome so far. A wall pushed by its live load moves by `distance` [m], by default its smaller
    side, or if that gives no answer, as far as both speeds agree.

    Returns
    -------
    Outcome
        `curve` has the displacement and the reaction [N], or the share of the dead load, of the whole path. `lower` and
        `upper` enclose the answer by as much as the last halving of the speed has changed it.
    """
    is_free = distance is None and not wall.scene.is_led
    path = _LastPath(observe)
    watch = path if is_free and observe is not no_observer else observe
    found, nearer = _followed(outcome, wall, watch, distance)
    if nearer is None or not is_free:
        return found
    again, _ = _followed(outcome, wall, observe, nearer)
    narrowed = _narrowed(found, again, nearer)
    if narrowed.multiplier is None:
        path.show_again()
    return narrowed


def _followed(
    outcome: Outcome, wall: LedWall, observe: Observer, distance: float | None
) -> tuple[Outcome, float | None]:
    """The outcome of one path; if it has no answer, a shorter distance [m] that may give one, or None."""
    scene, run, tolerance, points = wall.scene, wall.run, wall.tolerance, wall.points
    traverses = list[Traverse]()
    try:
        resting = run if run.system.contacts is None else Run(run.system, local=CALMING)
        loaded = put_on_dead_load(resting, wall.criteria, observe)
        state, verdict = loaded.state, loaded.verdict
        outcome = replace(outcome, steps=loaded.steps)
        if verdict == "collapse":
            status, message = fall_under_dead_load(run.interface.law, wall.bears)
            return replace(outcome, status=status, message=message), None
        if verdict == "undecided":
            return replace(outcome, message="the budget ran out before the wall came to rest under its dead load"), None
        run = run.held_late(state)
        run.is_driven = True
        lead = _lead(wall, run, state, observe, distance)
        if faster := lead.too_fast():
            return replace(outcome, message=f"no answer: {faster}"), None
        for duration in _durations(lead, loaded.rest):
            traverses.append(traverse := Traverse(state, np.zeros_like(state.motion), lead.moves))
            last = lead.go(traverse, lead.longest / duration)
            before, lead = lead, lead.after(traverse)
            outcome = replace(outcome, steps=(outcome.steps or 0) + last.steps - state.steps)
            if traverse.verdict == "undecided" and lead is before:
                break
            if _has_converged(lead, traverses, tolerance) and not lead.rate:
                break
    except (KeyboardInterrupt, Unstable) as stop:
        hint = ""
        if traverses:
            traverses[-1].calm()
            hint = lead.shorter(traverses[-1])
            traverse = lead.kept(traverses)
            outcome = _path(outcome, scene, run, points, traverse) if traverse.rows else outcome
        if isinstance(stop, Unstable):
            return replace(outcome, status="failed", steps=stop.steps, message=joined(str(stop), hint)), None
        return replace(outcome, message="interrupted: the path so far"), None
    # A support that barely moves does almost no work. The motion under the suddenly applied dead load does not count.
    # If the path returns, works nearly cancel: their ranges are what counts.
    gone = float(np.ptp([row.works for row in traverse.rows], axis=0).sum()) if traverse.rows else 0.0
    lost = run.unaccounted(last, max(gone, lead.least_work), since=state)
    outcome = _arrays(_path(outcome, scene, run, points, traverse), lead, traverse, wall.point_order)
    if not lost <= UNACCOUNTED:  # also if the law's energy is no number
        message = f"{lost:.1%} of the work of the loads is unaccounted for"
        return replace(outcome, status="failed", message=message), None
    # Motion takes more at twice the speed; where it took less, cracks have set free what the last traverse lost.
    traverse.spent = min(each.spent for each in traverses[-2:])
    outcome = _judge(outcome, lead, traverses, tolerance)
    outcome = replace(outcome, message=joined(outcome.message, crushing_note(run, traverse.best)))
    if outcome.status == "undecided" and outcome.upper is None and lead.moves and wall.is_self_locking():
        message = f"self-locking: joint forces balance any multiple of it; {outcome.message}"
        return replace(outcome, status="unbounded", message=message), None
    return outcome, lead.nearer(traverses[-2], traverses[-1], tolerance) if _is_wide(outcome) else None


def _lead(wall: LedWall, run: Run, start: State, observe: Observer, distance: float | None) -> Lead:
    """How the displacements of a scene are applied; a push goes over a distance [m], a self-locking one not so far."""
    scene, criteria, points = wall.scene, wall.criteria, wall.points
    if scene.is_led:
        kind = BeamDrive if scene.settlement is None else SupportSettlement
        return kind(scene, run, start, criteria, observe, points)
    low, high = scene.blocks.extent(scene.wall)
    side = float((high - low).min())
    most = LOCKED / (run.system.measure(run.system.live) or 1.0) if wall.is_self_locking() else np.inf
    # Few walls move farther than their smaller side before they fall; those that do are pushed farther the next time.
    reach = min(distance or side, side)
    return Push(scene, run, start, criteria, observe, points, distance or side, most, reach)


def _durations(lead: Lead, rest: int) -> list[float]:
    """Durations of the longest leg [s], one per traverse: for twice the rate and the rate, or doubling each time.

    The doublings end at the budget.
    """
    if rate := lead.rate:
        return [lead.longest / (2 * rate), lead.longest / rate]
    legs = float(np.abs(np.diff(lead.goals, prepend=0.0)).sum()) / lead.longest
    steps = max(LEAST_STEPS, (REST_MULTIPLE if lead.is_small else REST_MULTIPLE_FINITE) * rest)
    if not (lead.moves or lead.is_small):
        steps *= FALL_MULTIPLE
    runs = max(2, int(np.log2(max(1.0, lead.criteria.budget / (legs * steps)))) + 1)
    return [steps * lead.run.dt * 2**k for k in range(runs)]


def _bracket(traverses: list[Traverse]) -> tuple[float, float]:
    """Bracket of the answer: the last answer, minus and plus its change from the answer at twice the speed.

    The effect of the speed falls at least as fast as the speed, and what a mean over a window misses of a peak as fast
    as the window length. Inertia of accelerating bodies can only raise the force. An oscillating force has larger means
    over shorter windows: if these do not converge on the peak, the lower end is from means over whole rows.
    """
    fast, slow = traverses[-2:]
    change = abs(fast.answer - slow.answer)
    lower = slow.answer - max(change, slow.inertia)
    if not slow.resolved:
        lower = min(lower, slow.lasting - abs(fast.lasting - slow.lasting) - slow.inertia)
    return lower, slow.answer + change + slow.unseen


def _still(lead: Lead, traverses: list[Traverse]) -> float:
    """Least answer of a wall at rest: the last one without what motion takes, minus its change from twice the speed.

    Both answers may contain much inertia: vibrations that begin with the uplift last. If a rate is asked for, the beam
    reaches it, and twice that, on the same way, so that the whole answer must change little with the speed; if it is
    chosen, it is enough that what is left without motion does. That fluctuates, so twice its change counts.
    """
    fast, slow = traverses[-2:]
    change = abs(fast.answer - slow.answer)
    if not lead.rate:
        change = min(change, 2 * abs(fast.still - slow.still))
    return slow.still - change


def _spread(lead: Lead, traverses: list[Traverse]) -> float:
    """Width of the bracket, relative to its larger end."""
    if len(traverses) < 2:
        return np.inf
    lower, upper = _bracket(traverses)
    return (upper - lower) / max(-lower, upper, lead.least) if upper > lower else 0.0


def _has_converged(lead: Lead, traverses: list[Traverse], tolerance: float) -> bool:
    """Whether half the speed would change the answer, and what else is reported, by less than the tolerance.

    If a wall falls off its supports at the same settlement at both speeds, its share may change up to there by more.
    A little growth that is left has room in the bracket beside the effect of the speed; no speed helps against much.
    """
    if len(traverses) < 2:
        return False
    if any(traverse.fall for traverse in traverses[-2:]):
        return _fall_alike(traverses[-2], traverses[-1], tolerance)
    ended = all(traverse.verdict != "undecided" for traverse in traverses[-2:])
    if not ended or lead.apart(*traverses[-2:]) > tolerance:
        return False
    left = lead.growth_left(traverses[-1]) / max(traverses[-1].answer, lead.least)
    return _spread(lead, traverses) <= tolerance - (left if left < MUCH * tolerance else 0.0)


def _fall_alike(fast: Traverse, slow: Traverse, tolerance: float) -> bool:
    """Whether a wall falls at the same place of its path at both speeds, to a tolerance of the settlement there."""
    if fast.fall is None or slow.fall is None:
        return False
    rests, falls = zip(fast.fall, slow.fall, strict=True)
    first = min(falls)
    return max(rests).way <= first.way + tolerance * abs(first.settled)


def _arrays(outcome: Outcome, lead: Lead, traverse: Traverse, point_order: Indices) -> Outcome:
    """Forces at the answer, and motion: that to the deformed shape, or the mechanism of a drive."""
    run = lead.run
    force, motion = run.at_joints(traverse.best)[2:4].T[point_order], run.system.motion_of_blocks(traverse.motion)
    if motion.any():
        fastest = fastest_corner(lead.scene.blocks, motion)
        moved = fastest if traverse.is_shape else None
        outcome = replace(outcome, motion=motion / fastest, moved=moved, crushed=traverse.crushed)
    return replace(outcome, force=force)


def _path(outcome: Outcome, scene: Scene, run: Run, points: JointPoints, traverse: Traverse) -> Outcome:
    """Curve, reactions and works of a traverse, from states at rest, or in motion with their inertia left out."""
    supports = Supports(scene, points, run.system.owner)
    _, force, carried, tie, works, beam = map(np.array, zip(*traverse.rows, strict=True))
    columns = (*supports.columns, *WORKS, AT_REST)
    rests = np.full(len(force), not traverse.moves)
    rests[0] = True  # under the dead load
    if run.system.contacts is not None:
        held = carried[:, supports.block]
        held[:, :, 2] -= supports.about[:, 0] * held[:, :, 1] - supports.about[:, 1] * held[:, :, 0]
        path = np.column_stack([-held.reshape(len(held), -1), tie, works, rests])
    else:
        loads = force if traverse.moves else np.zeros(len(force))
        path = supports.path(carried, tie, loads, works)["path"]
        path[:, -1] = rests
    if beam.size:
        path, columns = np.column_stack([path[:, :-1], beam, path[:, -1]]), (*columns[:-1], *BEAM, AT_REST)
    return replace(outcome, curve=traverse.curve, path=path, path_columns=columns)


def _judge(outcome: Outcome, lead: Lead, traverses: list[Traverse], tolerance: float) -> Outcome:
    """Verdict on several traverses, of which the last is drawn."""
    traverse, what = traverses[-1], _answer(outcome, lead, traverses)
    at = f"{lead.reached(outcome.curve):.4g} m"
    if traverse.verdict == "undecided" or len(traverses) < 2:
        return replace(outcome, message=f"no answer: beyond {at} it neither rested nor fell; {what}")
    if places := [each.fall for each in traverses[-2:] if each.fall is not None]:
        if not _fall_alike(traverses[-2], traverse, tolerance):
            return replace(outcome, message=f"no answer: another speed changes whether or where it falls; {what}")
        traverse.fall = min(rest for rest, _ in places), max(fall for _, fall in places)
    least, most = _bracket(traverses)
    fell = traverse.verdict == "collapse"
    if not fell and lead.has_come_free(traverse.rows[-1]):
        message = joined(COME_FREE, what, lead.doubt(traverse, tolerance))
        return replace(outcome, status="unbounded", message=message)
    spread, left = _spread(lead, traverses), lead.growth_left(traverse)
    lower = min(least, _still(lead, traverses)) - traverse.drag
    outcome = replace(outcome, lower=lower, upper=most + left)
    room = (tolerance - spread if spread <= tolerance else tolerance) * max(traverse.answer, lead.least)
    has_formed = left <= room and lead.has_formed(traverse, tolerance, still=traverse.answer - least)
    if not fell and not has_formed:
        still, falls = lead.unfinished(outcome.curve)
        still = f"{still} at the displacement asked for, {at}"
        if traverse.answer > lead.most:
            still = f"the wall bears more than {LOCKED:g} times its largest dead load"
        message = joined(f"no answer: {still}: {number(traverse.answer)}; {what}", lead.moving(traverse, tolerance))
        bounds = (None, most) if falls else (lower, None)
        return replace(outcome, lower=bounds[0], upper=bounds[1], message=message)
    if spread > tolerance and not lead.rate:
        remedy = lead.remedy(traverses[-2], traverse, tolerance)
        why = joined("another speed changes it by more than the tolerance", remedy)
        if traverse.fall is not None:
            why = f"{lead.fall(traverse)}, up to which it changes by more than the tolerance"
        return replace(outcome, message=f"no answer: {why}; {what}")
    told = "" if spread <= tolerance else "; another speed changes it by more than the tolerance"
    told += f"; {lead.fall(traverse)}" if fell else ""
    told += "" if lead.moves or not fell else ", and the answer is that of its last rest"
    message = joined(what + told, lead.doubt(traverse, tolerance))
    return replace(outcome, status="collapse", multiplier=traverse.answer, message=message)


def _is_wide(outcome: Outcome) -> bool:
    """Whether there is a bracket, but no answer."""
    return outcome.status == "undecided" and None not in (outcome.lower, outcome.upper)


def _narrowed(outcome: Outcome, again: Outcome, distance: float) -> Outcome:
    """The outcome of a push over a shorter `distance` [m], if its bracket overlaps that of the whole distance.

    Where a wall is borne anew farther on, the shorter push ends before its largest multiplier.
    """
    steps = (outcome.steps or 0) + (again.steps or 0)
    if "interrupted" in again.message:
        return replace(outcome, steps=steps, message=joined(outcome.message, "interrupted on a shorter path"))
    (low, high), (least, most) = _bounds(outcome), _bounds(again)
    pushed = f"pushed to {two_digits(distance)} m"
    if again.multiplier is None:
        return replace(outcome, steps=steps, message=joined(outcome.message, f"{pushed} there is no answer either"))
    if not (least <= high and low <= most):
        near = f"{pushed} it is between {number(least)} and {number(most)}"
        return replace(outcome, steps=steps, message=joined(outcome.message, near))
    whole = f"over the whole distance it is between {number(low)} and {number(high)}"
    return replace(again, steps=steps, message=joined(again.message, f"{pushed}: {whole}"))


def _bounds(outcome: Outcome) -> tuple[float, float]:
    """The bracket of an outcome; NaN for a bound that there is not."""
    lower, upper = (np.nan if bound is None else bound for bound in (outcome.lower, outcome.upper))
    return lower, upper


def _answer(outcome: Outcome, lead: Lead, traverses: list[Traverse]) -> str:
    """Name of the answer, with how it was obtained and where displacements are read."""
    what = lead.answer + (", at its rate and at twice that" if lead.rate else ", at two speeds")
    if len(traverses) > 1 and (apart := lead.apart(*traverses[-2:])):
        what += f", whose curves differ by {100 * apart:.2g} % of it on average, as far as they stay above half of it"
    return joined(what, lead.other_way(outcome.curve), lead.displacements, lead.before(outcome.curve), lead.read_at)
