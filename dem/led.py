"""Walls that are led: a beam or supports are taken through prescribed displacements, from rest to rest.

Each displacement is held until the wall rests, at once by Newton's method or after it has crept there
(`relaxation`): where it snaps, it is followed to its next rest at that displacement. Steps begin with one of the
wall's elastic size, after the dead load and after each reversal, and grow from there, so that friction is taken up
along the way. The whole way is gone through again in steps half as long until its answer settles.

The answer is the largest reaction of a beam's drive along its first move, or the share of the dead load that supports
bear at the settlement asked for. It is one of a collapse if a mechanism has formed: if over the last tenth of the way
it has changed by less than the tolerance, or the wall falls. Else the wall still hardens, or the support still sheds
load, where the way ends, and the answer bounds the collapse from one side only.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from runningbond.limit.associated import is_self_locking
from runningbond.limit.kinematics import control_row
from runningbond.limit.settlement import largest_displacement, reaction_unit
from runningbond.results import Outcome, fastest_corner_by_one
from runningbond.results.outcome import number
from runningbond.scene import Array, Scene

from .pushover import LoadPath, StaticState, state_of
from .relaxation import LONGEST, Rest
from .static_system import Control, StaticSystem

STEPS = 25
"""Least number of steps in the longest leg of a way."""

GROWTH = 1.3
"""Growth of steps from one to the next."""

RUNS = 4
"""Runs, each in steps half as long as those before, after which a way is left undecided."""

LAST = 0.1
"""Part of a way over which a force that has formed a mechanism no longer changes."""

LITTLE = 0.01
"""Share of the dead load below which a reaction need not be relatively accurate."""

REGULAR = 1e-6
"""Share of the elastic stiffness by which the tangent of a first guess is made regular."""


def is_led(scene: Scene) -> bool:
    """Whether displacements are prescribed to a scene, not loads."""
    return scene.settlement is not None or any(key.startswith("beam.drive.displacement") for key in scene.extras)


@dataclass(frozen=True, eq=False)
class Lead:
    """What leads a wall: the beam's drive, or the supports with a share of their settlement."""

    system: StaticSystem
    origin: StaticState  # at rest under the dead load
    first_step: float  # load that an elastic first step is worth

    @property
    def scene(self) -> Scene:
        """The scene."""
        return self.system.equilibrium.scene

    @property
    def settles(self) -> bool:
        """Whether supports are led, not the beam."""
        return self.scene.settlement is not None

    @cached_property
    def metre(self) -> float:
        """Displacement [m] that counts as 1: the settlement asked for, or the unit of f_live · q."""
        if self.settles:
            moved = float(control_row(self.scene) @ self.scene.support_motion.ravel())
            return moved or largest_displacement(self.scene)
        return self.system.equilibrium.force_unit / self.system.equilibrium.live_unit * self.system.length_unit

    @cached_property
    def goals(self) -> Array:
        """Values that are led to one after the other."""
        drive = self.scene.beam.drive if self.scene.beam else None
        return np.ones(1) if drive is None or self.settles else drive.force[0] * np.array(drive.path) / self.metre

    @cached_property
    def elastic_step(self) -> float:
        """First step."""
        system, state = self.system, self.origin
        if system.support_jump is not None:
            return self.first_step / float(np.abs(system.support_jump).max())
        tangent = system.respond(state.x, state.plastic_slip).tangent + REGULAR * system.elastic
        load = np.append(np.zeros(system.unknowns - 1), self.first_step)
        step = system.solve(tangent, Control(self.first_step, multiplier=True), load)
        return abs(float(system.equilibrium.live @ step[: system.freedoms]))

    def stops(self, share: float) -> Iterator[tuple[float, bool]]:
        """Values to hold on the way, each with whether it is the first of a leg, in steps of that share's length."""
        at, goals = 0.0, self.goals
        longest = np.abs(np.diff(goals, prepend=0.0)).max() / STEPS
        for goal in goals:
            lengths = [0.0]
            step = min(self.elastic_step, longest)
            while lengths[-1] < abs(goal - at):
                lengths.append(lengths[-1] + share * step)
                step = min(step * GROWTH**share, longest)
            for k, length in enumerate(lengths[1:]):
                yield float(at + (goal - at) * length / lengths[-1]), k == 0
            at = goal

    def control(self, value: float) -> Control:
        """The equation that holds a value."""
        return Control(value if self.settles else self.origin.displacement + value, multiplier=self.settles)

    def value(self, state: StaticState) -> float:
        """The value that is held in a state."""
        return state.multiplier if self.settles else state.displacement - self.origin.displacement

    def force(self, state: StaticState) -> float:
        """Reaction of the drive along its first move [N], or of the supports against theirs, as a share."""
        system, jump = self.system, self.system.support_jump
        if jump is None:
            return system.equilibrium.live_unit * state.multiplier
        work = float((jump[:, : len(state.force)] * state.force.T).sum() + jump[0, len(state.force) :] @ state.pull)
        return -work * system.equilibrium.force_unit * system.length_unit / reaction_unit(self.scene)

    def onward(self, before: StaticState, now: StaticState, value: float) -> Array:
        """Unknowns ahead, if the wall goes on as in its last step."""
        ahead = (value - self.value(now)) / (self.value(now) - self.value(before))
        return np.asarray(now.x + ahead * (now.x - before.x))

    def elastically(self, now: StaticState, value: float) -> Array:
        """Unknowns ahead, if no point opens or slides farther."""
        if self.settles:
            return np.append(now.x[:-1], value)
        response = self.system.respond(now.x, now.plastic_slip)
        pressed = (response.normal != 0)[:, None, None]
        tangent = self.system.elastic * np.where(pressed, 1.0, REGULAR)
        ahead = self.control(value)
        right = np.append(np.zeros(self.system.unknowns - 1), ahead.value - now.displacement)
        return np.asarray(now.x + self.system.solve(tangent, ahead, right))


@dataclass(frozen=True, eq=False)
class Run:
    """A run along a way: its states at rest, the dead load's first, and what stopped it before the end."""

    states: list[StaticState]
    stopped: Rest | None = None
    aim: float = 0.0  # value that it was led to last

    @property
    def fell(self) -> bool:
        """Whether the wall fell."""
        return self.stopped is not None and self.stopped.verdict == "fall"


def _run(path: LoadPath, lead: Lead, share: float) -> Run:
    states = [path.rests[0]]
    for value, turns in lead.stops(share):
        now = states[-1]
        guesses = [] if turns else [(lead.onward(states[-2], now, value), True)]
        for guess, creeps in (*guesses, (lead.elastically(now, value), True)):
            result = path.hold(guess, now.plastic_slip, lead.control(value), LONGEST, creeps)
            if result.verdict == "rest":
                break
        else:
            return Run(states, result, value)
        states.append(state_of(path.system, result))
    return Run(states, None, value)


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
    lead = Lead(path.system, path.rests[0], first_step)
    runs: list[Run] = []
    answers: list[float] = []
    for k in range(RUNS):
        run = _run(path, lead, 0.5**k)
        if runs and run.stopped and not run.fell:  # out of budget
            break
        runs.append(run)
        forces = [lead.force(state) for state in run.states]
        answers.append(forces[-1] if lead.settles else max(forces))
        if (run.stopped and not run.fell) or (k > 0 and _spread(lead, answers[-2:]) <= tolerance):
            break
    path.past = runs[-1].states[1:]
    for state in path.past:
        path.observe(path.system, state)
    return _judge(_arrays(outcome, lead, runs[-1]), lead, runs, answers, tolerance)


def _spread(lead: Lead, answers: list[float]) -> float:
    """Width of a bracket, relative to its larger end."""
    least = LITTLE if lead.settles else 0.0
    width = max(answers) - min(answers)
    return width / max(*np.abs(answers), least) if width else 0.0


def _arrays(outcome: Outcome, lead: Lead, run: Run) -> Outcome:
    """Curve, forces at the answer and motion there: of a settlement the whole shape, of a drive how it moves."""
    system, states = lead.system, run.states
    value, force = np.array([(lead.value(state), lead.force(state)) for state in states]).T
    most = int(force.argmax()) if not lead.settles else len(states) - 1
    farthest = int(value.argmax())
    if run.fell and run.stopped is not None:
        moving = system.motion(np.append(run.stopped.last, np.zeros(system.unknowns - system.freedoms)))
    else:
        before = states[0 if lead.settles else max(farthest - 1, 0)]
        moving = system.motion(states[farthest].x) - system.motion(before.x)
    return replace(
        outcome,
        curve=np.column_stack([lead.metre * value, force]),
        motion=fastest_corner_by_one(lead.scene.blocks, moving) if moving.any() else np.zeros((0, 3)),
        force=system.equilibrium.force_unit * states[most].force,
    )


def _judge(outcome: Outcome, lead: Lead, runs: list[Run], answers: list[float], tolerance: float) -> Outcome:
    """Verdict on some runs."""
    run, (lower, upper) = runs[-1], (min(answers[-2:]), max(answers[-2:]))
    at = f"{lead.metre * abs(run.aim):.4g} m"
    what = "share of the dead load on the support" if lead.settles else "largest reaction of the drive along its way"
    what += f", in {len(run.states) - 1} steps" + (f" and in {len(runs[-2].states) - 1}" if len(runs) > 1 else "")
    what += "; small displacements" + _notes(lead, outcome)
    so_far = replace(outcome, lower=None if lead.settles else lower, upper=upper if lead.settles else None)
    if run.stopped and not run.fell:
        return replace(so_far, message=f"no answer: at {at} it neither rested nor fell; {what}")
    formed = run.fell or _formed(lead, outcome.curve, tolerance)
    if formed and len(answers) > 1 and _spread(lead, answers[-2:]) <= tolerance:
        fall = f"; the wall falls on its way to {at}, this is of its last rest before" if run.fell else ""
        return replace(
            outcome, status="collapse", multiplier=answers[-1], lower=lower, upper=upper, message=what + fall
        )
    if formed:
        message = f"no answer: other steps change it by more than the bracket; {what}"
        return replace(outcome, lower=lower, upper=upper, message=message)
    reached = f"{number(answers[-1])} at {outcome.curve[:, 0].max():.4g} m"
    if lead.settles:
        message = f"no answer: the support still sheds load where its settlement ends, it bears {reached}; {what}"
        return replace(so_far, message=message)
    if is_self_locking(lead.scene):
        message = f"self-locking: the drive takes {reached}, and joint forces balance any multiple of it; {what}"
        return replace(outcome, status="unbounded", message=message)
    message = f"no answer: the wall still hardens where its drive ends, which takes {reached}; {what}"
    return replace(so_far, message=message)


def _formed(lead: Lead, curve: Array, tolerance: float) -> bool:
    """Whether a mechanism has formed: whether nothing grows, or changes, over the last part of the way."""
    value, force = curve.T
    late = value >= (1 - LAST) * value.max()
    if lead.settles:
        return bool(np.ptp(force[late]) <= tolerance * max(float(np.abs(force[late]).max()), LITTLE))
    most = float(force[late].max())
    return most - float(force[~late].max(initial=0.0)) <= tolerance * most


def _notes(lead: Lead, outcome: Outcome) -> str:
    """What there is to say of a cyclic drive, and of its rate."""
    drive = lead.scene.beam.drive if lead.scene.beam else None
    if lead.settles or drive is None:
        return ""
    other = -float(outcome.curve[:, 1].min())
    back = f"; the other way it takes {number(other)}" if len(drive.path) > 1 and other > 0 else ""
    return back + ("; beam.drive.rate has no influence on states at rest" if drive.rate else "")
