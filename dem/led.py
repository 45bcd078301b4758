"""Walls that are led: a beam or supports are taken through prescribed displacements, from rest to rest.

Each displacement is held until the wall rests, at once by Newton's method or after it has crept there
(`relaxation`): where it snaps, it is followed to its next rest at that displacement. Steps begin with one of the
wall's elastic size, after the dead load and after each reversal, and grow from there, so that friction is taken up
along the path. The whole path is gone through again in steps half as long until its answer settles.

The answer is the largest reaction of a beam's drive along its first move, or the share of the dead load that supports
bear at the settlement asked for. It is one of a collapse if a mechanism has formed: if over the last tenth of the path
it has changed by less than the tolerance, or the wall falls. Else the wall still hardens, or the support still sheds
or takes up load, where the path ends, and the answer bounds the collapse from one side only. A wall at rest on a
support that bears nothing any more bridges it.
"""

from dataclasses import dataclass, replace

import numpy as np

from runningbond.dynamics.lead import LITTLE, formed, goes_both_ways, shedding
from runningbond.limit.associated import is_self_locking
from runningbond.limit.kinematics import dead_load
from runningbond.results import Outcome, Supports, fastest_corner_by_one
from runningbond.results.outcome import number
from runningbond.results.reactions import COME_FREE

from .lead import StaticLead
from .pushover import NOISE, LoadPath, StaticState, state_of
from .relaxation import Rest

RUNS = 4
"""Runs, each in steps half as long as those before, after which a path is left undecided."""

HALVINGS = 20
"""Steps to the fall of a wall from its last rest, each half as long as the last one."""


@dataclass(frozen=True, eq=False)
class StaticTraverse:
    """One traverse of the path: its states at rest, the dead load's first, and what stopped it before the end."""

    states: list[StaticState]
    stopped: Rest | None = None
    aim: float = 0.0  # value that it was led to last

    @property
    def fell(self) -> bool:
        """Whether the wall fell."""
        return self.stopped is not None and self.stopped.verdict == "fall"


def _run(path: LoadPath, lead: StaticLead, share: float) -> StaticTraverse:
    states = [path.rests[0]]
    for value, turns in lead.stops(share):
        result = _hold(path, lead, states, value, turns)
        if result.verdict == "fall":
            return _closer(path, lead, StaticTraverse(states, result, value), turns)
        if result.verdict == "undecided":
            return StaticTraverse(states, result, value)
        states.append(state_of(path.system, result))
        path.past = states[1:]
    return StaticTraverse(states, None, value)


def _hold(path: LoadPath, lead: StaticLead, states: list[StaticState], value: float, turns: bool) -> Rest:
    """Hold a value after some states, the first one of a leg where the path `turns`, until the wall rests or falls."""
    now = states[-1]
    if not turns:
        guess = lead.onward(states[-2], now, value)
        if (result := path.hold(guess, now.plastic_slip, lead.control(value))).verdict == "rest":
            return result
    return path.hold(lead.elastically(now, value), now.plastic_slip, lead.control(value))


def _closer(path: LoadPath, lead: StaticLead, run: StaticTraverse, turns: bool) -> StaticTraverse:
    """A run that ended in a fall, with the states between its last rest and there."""
    states, fall, aim = [*run.states], run.stopped, run.aim
    for _ in range(HALVINGS):
        value = (lead.value(states[-1]) + aim) / 2
        result = _hold(path, lead, states, value, turns)
        if result.verdict == "undecided":
            break
        if result.verdict == "fall":
            fall, aim = result, value
        else:
            states.append(state_of(path.system, result))
            turns = False
    return StaticTraverse(states, fall, aim)


def lead_along(outcome: Outcome, path: LoadPath, tolerance: float, first_step: float) -> Outcome:
    """Lead a wall from rest under its dead load through the displacements of its scene.

    Parameters
    ----------
    outcome
        Its outcome so far.
    path
        Its path with that rest; the last run is added to it, and observed.
    tolerance
        Relative width of the bracket.
    first_step
        Load, in units of `Equilibrium`, that the first elastic step is worth.
    """
    lead = StaticLead(path.system, path.rests[0], first_step)
    runs: list[StaticTraverse] = []
    answers: list[float] = []
    for k in range(RUNS):
        path.past = []
        try:
            run = _run(path, lead, 0.5**k)
        except KeyboardInterrupt:
            so_far = StaticTraverse([path.rests[0], *path.past])
            return replace(_arrays(outcome, lead, so_far), message="no answer: interrupted, this is the path so far")
        if runs and run.stopped and not run.fell:  # out of budget
            break
        runs.append(run)
        forces = [lead.force(state) for state in run.states]
        answers.append(forces[-1] if lead.settles else max(forces))
        if (run.stopped and not run.fell) or (k > 0 and _spread(lead, answers[-2:]) <= tolerance):
            break
    path.past = runs[-1].states[1:]
    for state in path.past:
        path.observe(path, state)
    return _judge(_arrays(outcome, lead, runs[-1]), lead, runs, answers, tolerance)


def _spread(lead: StaticLead, answers: list[float]) -> float:
    """Width of a bracket, relative to its larger end."""
    return (max(answers) - min(answers)) / max(*map(abs, answers), _least(lead))


def _least(lead: StaticLead) -> float:
    """Force below which a bracket need not be relatively narrow."""
    return LITTLE if lead.settles else NOISE * lead.system.equilibrium.live_unit


def _arrays(outcome: Outcome, lead: StaticLead, run: StaticTraverse) -> Outcome:
    """Curve, forces at the answer and motion there: of a settlement the whole shape, of a drive how it moves."""
    system, states = lead.system, run.states
    value, force = np.array([(lead.value(state), lead.force(state)) for state in states]).T
    most = int(force.argmax()) if not lead.settles else len(states) - 1
    farthest = int((np.abs(value) if lead.settles else value).argmax())
    if run.fell and run.stopped is not None:
        moving = system.motion(np.append(run.stopped.last, np.zeros(system.unknowns - system.freedoms)))
    else:
        before = states[0 if lead.settles else max(farthest - 1, 0)]
        moving = system.motion(states[farthest].x) - system.motion(before.x)
    forces = [system.equilibrium.force_unit * state.force for state in states]
    dead = np.array([state.x[: system.freedoms] for state in states]) @ system.per_freedom(dead_load(lead.scene))
    live = np.append(0.0, np.cumsum((force[1:] + force[:-1]) / 2 * np.diff(value))) * lead.joule
    ties = [system.equilibrium.force_unit * state.pull for state in states]
    held = Supports(lead.scene, system.equilibrium.points)
    return replace(
        outcome,
        curve=np.column_stack([lead.metre * value, force]),
        motion=fastest_corner_by_one(lead.scene.blocks, moving) if moving.any() else np.zeros((0, 3)),
        force=forces[most],
        **held.path(forces, ties, force, np.column_stack([dead, live])),
    )


def _judge(
    outcome: Outcome, lead: StaticLead, runs: list[StaticTraverse], answers: list[float], tolerance: float
) -> Outcome:
    """Verdict on some runs."""
    run, (lower, upper) = runs[-1], (min(answers[-2:]), max(answers[-2:]))
    at = f"{lead.metre * abs(run.aim):.4g} m"
    what = "share of the dead load on the support" if lead.settles else "largest reaction of the drive along its path"
    what += f", in {len(run.states) - 1} steps" + (f" and in {len(runs[-2].states) - 1}" if len(runs) > 1 else "")
    what += "; small displacements" + _notes(lead, outcome)
    falls, changes = shedding(outcome.curve) if lead.settles else (False, "")
    so_far = replace(outcome, lower=None if falls else lower, upper=upper if falls else None)
    if run.stopped and not run.fell:
        return replace(so_far, message=f"no answer: at {at} it neither rested nor fell; {what}")
    supports, last = Supports(lead.scene, lead.system.equilibrium.points), run.states[-1]
    if lead.settles and not run.fell and supports.have_come_free(last.force, last.pull):
        return replace(outcome, status="unbounded", message=f"{COME_FREE}; {what}")
    ends = run.fell or formed(outcome.curve, tolerance, settles=lead.settles, least=_least(lead))
    if ends and len(answers) > 1 and _spread(lead, answers[-2:]) <= tolerance:
        fall = f"; the wall falls at {at}, this is of its last rest" if run.fell else ""
        return replace(
            outcome, status="collapse", multiplier=answers[-1], lower=lower, upper=upper, message=what + fall
        )
    if ends and len(answers) == 1:
        message = f"no answer: the budget ran out in steps half as long, which are to say how sure it is; {what}"
        return replace(so_far, message=message)
    if ends:
        message = f"no answer: other steps change it by more than the tolerance; {what}"
        return replace(outcome, lower=lower, upper=upper, message=message)
    ended = outcome.curve[-1, 0] if lead.settles else outcome.curve[:, 0].max()
    reached = f"{number(answers[-1])} at {ended:.4g} m"
    if lead.settles:
        message = f"no answer: the support still {changes} where its settlement ends, it bears {reached}; {what}"
        return replace(so_far, message=message)
    if is_self_locking(lead.scene):
        message = f"self-locking: the drive takes {reached}, and joint forces balance any multiple of it; {what}"
        return replace(outcome, status="unbounded", message=message)
    message = f"no answer: the wall still hardens where its drive ends, which takes {reached}; {what}"
    return replace(so_far, message=message)


def _notes(lead: StaticLead, outcome: Outcome) -> str:
    """What there is to say of a cyclic drive."""
    if lead.settles or lead.scene.drive is None:
        return ""
    other = -float(outcome.curve[:, 1].min())
    return f"; the other way it takes {number(other)}" if goes_both_ways(lead.goals) and other > 0 else ""
