"""Driven walls: a beam or supports follow prescribed displacements, from equilibrium to equilibrium.

Each displacement is held until the wall rests: Newton's method finds the equilibrium, or the wall creeps to it
(`relaxation`). A wall that snaps is followed to its next equilibrium at that displacement. After the dead load and each
reversal, steps start at the wall's elastic size and then grow, so that friction is taken up along the path. The whole
path is repeated in steps half as long until its answer settles.

The answer is the largest reaction of a beam's drive along its first move, or the share of the dead load that supports
carry at the prescribed settlement. It is a collapse load if a mechanism has formed: if the reaction would grow by no
more than the tolerance on a path twice as long, or the share changes by less than the tolerance over the last tenth of
the path, or if the wall falls. Otherwise the wall still hardens, or the support still sheds or takes up load, where
the path ends, and the answer bounds the collapse from one side only. A wall at rest on a support that no longer carries
any load bridges that support.
"""

from dataclasses import dataclass, replace

import numpy as np

from runningbond.limit.associated import is_self_locking
from runningbond.limit.kinematics import dead_load
from runningbond.results import Outcome, Supports, fastest_corner_by_one
from runningbond.results.outcome import joined, number
from runningbond.results.reactions import COME_FREE, WORKS

from .beam_drive import StaticBeamDrive
from .climb import BUDGET_SPENT, NO_VERDICT
from .lead import StaticLead
from .load_path import LoadPath, StaticState, state_of
from .relaxation import Rest
from .support_settlement import StaticSettlement

MAX_TRAVERSES = 4
"""Number of traverses, each in steps half as long as in the traverse before, after which a path is left undecided."""

BISECTIONS = 20
"""Number of bisections of the step from the last equilibrium to the fall of a wall."""


@dataclass(frozen=True, eq=False)
class StaticTraverse:
    """One traverse of the path: its states in equilibrium, from the dead load on, and what stopped it early."""

    states: list[StaticState]
    stopped: Rest | None = None
    aim: float = 0.0  # last prescribed value

    @property
    def fell(self) -> bool:
        """Whether the wall fell."""
        return self.stopped is not None and self.stopped.verdict == "fall"


def _traverse(path: LoadPath, lead: StaticLead, share: float) -> StaticTraverse:
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
    """Hold a value after some states until the wall rests or falls; `turns` marks the first value of a leg."""
    now = states[-1]
    if not turns:
        guess = lead.onward(states[-2], now, value)
        if (result := path.hold(guess, now.plastic_slip, lead.control(value))).verdict == "rest":
            return result
    return path.hold(lead.elastically(now, value), now.plastic_slip, lead.control(value))


def _closer(path: LoadPath, lead: StaticLead, traverse: StaticTraverse, turns: bool) -> StaticTraverse:
    """Add states between the last equilibrium and the fall to a traverse that ended in a fall."""
    states, fall, aim = [*traverse.states], traverse.stopped, traverse.aim
    for _ in range(BISECTIONS):
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
    """Drive a wall from rest under its dead load through the prescribed displacements of its scene.

    Parameters
    ----------
    outcome
        Outcome so far.
    path
        Load path that starts with that state of rest; the last traverse is added to it, and observed.
    tolerance
        Relative width of the bracket.
    first_step
        Load of the first elastic step, in units of `Equilibrium`.
    """
    kind = StaticBeamDrive if path.system.support_jump is None else StaticSettlement
    lead: StaticLead = kind(path.system, path.rests[0], first_step)
    traverses: list[StaticTraverse] = []
    answers: list[float] = []
    for k in range(MAX_TRAVERSES):
        path.past = []
        try:
            traverse = _traverse(path, lead, 0.5**k)
        except KeyboardInterrupt:
            so_far = StaticTraverse([path.rests[0], *path.past])
            return replace(_arrays(outcome, lead, so_far), message="no answer: interrupted, this is the path so far")
        if traverses and traverse.stopped and not traverse.fell:
            break
        traverses.append(traverse)
        forces = [lead.force(state) for state in traverse.states]
        answers.append(forces[lead.answering(np.array(forces))])
        if (traverse.stopped and not traverse.fell) or (k > 0 and _spread(lead, answers[-2:]) <= tolerance):
            break
    path.past = traverses[-1].states[1:]
    for state in path.past:
        path.observe(path, state)
    cut = f"at {_at(lead, traverse)} {BUDGET_SPENT if path.budget <= 0 else NO_VERDICT}"
    return _judge(_arrays(outcome, lead, traverses[-1]), lead, traverses, answers, tolerance, cut)


def _spread(lead: StaticLead, answers: list[float]) -> float:
    """Width of a bracket, relative to its larger end."""
    return (max(answers) - min(answers)) / max(*map(abs, answers), lead.least)


def _arrays(outcome: Outcome, lead: StaticLead, traverse: StaticTraverse) -> Outcome:
    """Add curve, forces at the answer, and motion: of the fall, the settlement, or the drive's farthest step."""
    system, states = lead.system, traverse.states
    value, force = np.array([(lead.value(state), lead.force(state)) for state in states]).T
    if traverse.fell and traverse.stopped is not None:
        moving = system.motion(np.append(traverse.stopped.last, np.zeros(system.unknowns - system.freedoms)))
    else:
        before, after = lead.moving(value)
        moving = system.motion(states[after].x) - system.motion(states[before].x)
    forces = [system.equilibrium.force_unit * state.force for state in states]
    dead = np.array([state.x[: system.freedoms] for state in states]) @ system.per_freedom(dead_load(lead.scene))
    live = np.append(0.0, np.cumsum((force[1:] + force[:-1]) / 2 * np.diff(value))) * lead.joule
    ties = [system.equilibrium.force_unit * state.pull for state in states]
    held = Supports(lead.scene, system.equilibrium.points)
    return replace(
        outcome,
        curve=np.column_stack([lead.metre * value, force]),
        motion=fastest_corner_by_one(lead.scene.blocks, moving) if moving.any() else np.zeros((0, 3)),
        force=forces[lead.answering(force)],
        **held.path(forces, ties, force, np.column_stack([dead, live])),
    )


def _at(lead: StaticLead, traverse: StaticTraverse) -> str:
    """Last prescribed displacement of a traverse as text."""
    return f"{lead.metre * abs(traverse.aim):.4g} m"


def _judge(
    outcome: Outcome,
    lead: StaticLead,
    traverses: list[StaticTraverse],
    answers: list[float],
    tolerance: float,
    cut: str,
) -> Outcome:
    """Outcome with its verdict and message; `cut` is where and why the last traverse was given up."""
    traverse, (lower, upper), at = traverses[-1], (min(answers[-2:]), max(answers[-2:])), _at(lead, traverses[-1])
    steps, *before = (len(each.states) - 1 for each in traverses[-1:-3:-1])
    taken = f"in {steps} steps" + "".join(f" and in {fewer}" for fewer in before)
    what = joined(f"{lead.answer}, {taken}", "small displacements", lead.other_way(outcome.curve))
    unfinished, falls = lead.unfinished(outcome.curve)
    so_far = replace(outcome, lower=None if falls else lower, upper=upper if falls else None)
    if traverse.stopped and not traverse.fell:
        return replace(so_far, message=f"no answer: {cut}; {what}")
    doubt = lead.doubt(traverse.states, outcome.path[:, outcome.path_columns.index(WORKS[1])], tolerance)
    if not traverse.fell and lead.has_come_free(traverse.states[-1]):
        return replace(outcome, status="unbounded", message=joined(COME_FREE, what, doubt))
    room = tolerance - _spread(lead, [lower, upper])
    room = (room if room > 0 else tolerance) * max(upper, lead.least)
    left = 0.0 if traverse.fell else lead.growth_left(outcome.curve)
    upper += left
    if not traverse.fell and not (left <= room and lead.has_formed(outcome.curve, tolerance)):
        reached = f"{number(answers[-1])} at {lead.reached(outcome.curve):.4g} m"
        if lead.may_lock and is_self_locking(lead.scene):
            message = f"self-locking: the drive takes {reached}, and joint forces balance any multiple of it; {what}"
            return replace(outcome, status="unbounded", message=message)
        return replace(so_far, message=f"no answer: {unfinished} {reached}; {what}")
    if len(answers) == 1:
        message = f"no answer: {cut} in steps half as long, which are to say how sure it is; {what}"
        return replace(so_far, message=message)
    outcome = replace(outcome, lower=lower, upper=upper)
    if _spread(lead, answers[-2:]) > tolerance:
        return replace(outcome, message=f"no answer: other steps change it by more than the tolerance; {what}")
    fall = f"the wall falls at {at}, and the answer is that of its last rest" if traverse.fell else ""
    return replace(outcome, status="collapse", multiplier=answers[-1], message=joined(what, fall, doubt))
