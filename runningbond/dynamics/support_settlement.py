"""How supports settle from rest to rest, and where a wall falls off supports that move far."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import ClassVar

import numpy as np

from runningbond.results import Supports
from runningbond.results.reactions import UNFELT
from runningbond.scene import Array

from .collapse import hold_load
from .growth import NEARLY_AT_REST
from .lead import RAMP, Lead, pace
from .path_curve import LITTLE, SUPPORT_ANSWER, SUPPORT_DIFFERS, formed, shedding
from .state import State
from .traverse import Place, Traverse, TraverseRow

STAGES = 20
"""Number of rests in each leg of the path of a settlement."""

FALL_PART = 0.003
"""Largest distance between the last rest of a settlement and its fall, relative to the settlement at the fall."""

SUPPORT_WINDOW_STEPS = 25
"""Least time steps between two changes of the speed of supports: each change is a shock that loosens friction."""


@dataclass(frozen=True, eq=False)
class SupportSettlement(Lead):
    """How the supports of a scene settle; speeds are in settlements per second."""

    moves: ClassVar[bool] = False

    answer = SUPPORT_ANSWER
    least = LITTLE

    @property
    def goals(self) -> Array:
        """Fractions of the settlement, one after the other."""
        if self.scene.settlement is None:
            raise TypeError("no support of the scene settles")
        return np.array(self.scene.settlement.path)

    @property
    def displacements(self) -> str:
        """Note on the kind of displacements, and on corners that catch on each other at finite ones."""
        corners = ", sharp corners: with a joint.inset they do not slip past each other"
        return super().displacements + ("" if self.is_small or self.scene.joint.inset else corners)

    def reached(self, curve: Array) -> float:
        """Settlement [m] at the end of a curve ``(n, 2)``."""
        return float(abs(curve[-1, 0]))

    def has_formed(self, traverse: Traverse, tolerance: float, *, still: float) -> bool:
        """Whether the share no longer changes at the end of the path."""
        return formed(traverse.curve, tolerance, still=still, is_small=self.is_small)

    def unfinished(self, curve: Array) -> tuple[str, bool]:
        """Note on a share that still changes, and whether it can only become smaller."""
        falls, changes = shedding(curve)
        return f"the support still {changes}", falls

    def doubt(self, traverse: Traverse, tolerance: float) -> str:
        """Note on a share that depends on how joints slid."""
        return self.friction_note(traverse, tolerance, SUPPORT_DIFFERS)

    def fall(self, traverse: Traverse) -> str:
        """Note on where the wall falls."""
        if traverse.fall is None:
            return super().fall(traverse)
        rest, fall = (abs(self.run.system.carried.displacement) * place.settled for place in traverse.fall)
        return f"the wall falls between {rest:.4g} and {fall:.4g} m"

    def has_come_free(self, row: TraverseRow) -> bool:
        """Whether the moving supports carry nothing at a place of the path."""
        if self.is_small:
            return Supports(self.scene, self.points, self.run.system.owner).have_come_free(row.carried, row.tie)
        borne = np.hypot(*row.carried[:, :2].T)
        return bool(borne[self.scene.support_motion.any(axis=1)].max() <= UNFELT * borne.max())

    def share(self, state: State, speed: float, steps: int, given: float) -> float:
        """Move supports, in place; return the mean share of the dead load that they carry."""
        return self.run.carry(state, speed, steps, given=given) / self.run.system.carried.work

    def go(self, traverse: Traverse, speed: float) -> State:
        """Move supports along their path at a largest speed [settlements/s]; return the state at its end."""
        run, state = self.run, self.start.copy()
        given, far = run.given(state), run.system.carried.displacement
        self.note(traverse, state, 0.0, self.share(state, 0.0, self.criteria.interval, given))
        self.observe(run, state, traverse.rows[-1].force)
        traverse.best = state.copy()
        ahead = [*self._stages()][::-1]
        end, before, doubtful = ahead[0], Place(0.0, 0.0), list[Place]()
        while ahead:
            place = ahead[-1]
            # At finite displacements a wall that slowly tips over is nearly at rest.
            exactly = not self.is_small or bool(doubtful) or place == end
            moving = self._stage(traverse, state, speed, place.settled - before.settled, given, exactly=exactly)
            stands = traverse.verdict == "stable"
            if stands and place in doubtful[:1]:
                doubtful.clear()
            # Of a fall at small displacements the motion is shown; at finite ones blocks may have turned by any angle.
            if (not doubtful or not self.is_small) if stands else self.is_small:
                traverse.motion, traverse.crushed = state.motion - self.start.motion, self.crushed(state)
                traverse.is_shape = not self.is_small
            if stands:
                bears = self.share(state, 0.0, self.criteria.interval, given)
                # Close to the end supports barely move. What changes as they stop is friction that motion has loosened.
                # Up to a fall the share may go on changing in the same sense.
                loosened, since = abs(bears - moving), bears - traverse.rows[-1].force if doubtful else 0.0
                traverse.unseen, traverse.inertia = max(loosened, since), max(loosened, -since)
                self.note(traverse, state, far * place.settled, bears)
                traverse.best, before = state.copy(), ahead.pop()
                self.observe(run, state, bears)
                continue
            # The energy in the rubble of a fall is not judged. A long stage shakes the wall: only a fall in a short one
            # counts, and the others are tried again from a nearer rest.
            state = replace(traverse.best.copy(), steps=state.steps)
            if traverse.verdict == "undecided":
                break
            if place.way - before.way <= FALL_PART * max(abs(place.settled), FALL_PART * self.longest):
                traverse.fall = before, place
                break
            doubtful.append(place)
            ahead.append(Place((before.way + place.way) / 2, (before.settled + place.settled) / 2))
        return state

    def _stages(self) -> Iterator[Place]:
        """Yield the ends of stages, with small ones at the start of each leg, where reactions change most."""
        shares, way = np.linspace(0.0, 1.0, STAGES + 1)[1:] ** 2, 0.0
        for at, goal in pairwise([0.0, *self.goals.tolist()]):
            if goal != at:
                yield from (Place(way + abs(goal - at) * share, at + (goal - at) * share) for share in shares.tolist())
                way += abs(goal - at)

    def _stage(
        self, traverse: Traverse, state: State, speed: float, by: float, given: float, *, exactly: bool
    ) -> float:
        """Move supports by a fraction of the settlement and hold them until the wall rests or falls, in place.

        Return the mean share that supports carry towards the end of their motion.
        """
        run, motion, rows = self.run, self.run.system.carried.motion, 2 * RAMP
        run.return_to(state)
        stage = rows / (STAGES * speed * run.dt * pace(rows).sum())
        windows = windows_of_stage(stage)
        paces = pace(rows, windows)
        steps = max(1, round(stage / paces.size))
        ahead, window, until = float(paces.sum()), steps * run.dt, state.time
        moving, seen = list[float](), state.steps
        for part in paces.ravel().tolist():
            now, since, until = part * by / (window * ahead), state.time, until + window
            moving.append(self.share(state, now, run.steps_until(until, state), given))
            if not self.is_small:  # whole steps of another length go a little farther, or less far
                by, ahead = by - now * (state.time - since), ahead - part
            if state.steps - seen >= self.criteria.interval:
                seen = state.steps
                if self.falls(state):
                    traverse.verdict = "collapse"
                    break
        else:
            state.velocity[motion != 0] = 0.0
            rest = self.criteria.rest if exactly else NEARLY_AT_REST
            traverse.verdict, _ = hold_load(run, state, 0.0, replace(self.criteria, rest=rest))
        return float(np.mean(moving[-max(1, windows // 4) :]))


def windows_of_stage(steps: float) -> int:
    """Number of windows of constant speed in each row of a stage of `steps` steps, a whole number up to rounding."""
    # Rounded first: the last bit of a time step may make 1999.999 steps of 2000, and still there are four windows.
    return max(1, round(steps) // (2 * RAMP * SUPPORT_WINDOW_STEPS))
