"""Critical scale of a record: the smallest λ tried at which a wall falls, and the largest below it at which it stands.

Scales are increased by the factor `RATIO` until the wall falls, and the last interval is bisected. A wall that falls at
one scale may stand at a larger one: rocking blocks overturn in more than one way (Zhang & Makris 2001). The search
therefore continues with the same factor to `BEYOND` times the first fall, and reports each window of scales in which
the wall stands again.
"""

import math
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from runningbond.dynamics import BlockSystem, Observer, beam_note, no_observer
from runningbond.joints import impact_note
from runningbond.results import Outcome, fastest_corner_by_one
from runningbond.results.outcome import joined, number
from runningbond.results.reactions import AT_REST
from runningbond.scene import Scene
from runningbond.scene.history import STANDARD_GRAVITY

from .follow import AFTER, follow
from .response import MISSED, Response
from .resting import Resting

START, LARGEST_SCALE = 0.05, 50.0
"""Peak ground acceleration, in g, at the first scale tried, and the one above which the search for a fall ends."""

RATIO, BEYOND = 1.25, 2.0
"""Factor between successive scales, and factor beyond the first fall up to which windows are searched for."""

ROWS = 50
"""Rows per second of a response during a search."""


@dataclass(eq=False)
class ScaleSearch:
    """Responses at the scales that were tried."""

    respond: Callable[[float], Response]
    tried: dict[float, Response]

    def falls(self, scale: float) -> bool:
        """Whether the wall falls at a scale."""
        if scale not in self.tried:
            self.tried[scale] = self.respond(scale)
        return self.tried[scale].verdict == "collapse"

    @property
    def in_order(self) -> list[Response]:
        """Responses in ascending order of their scales."""
        return [self.tried[scale] for scale in sorted(self.tried)]

    def windows(self) -> list[tuple[float, float]]:
        """Ranges of scales above the first fall in which the wall was found to stand."""
        found: list[list[float]] = []
        fallen = inside = False
        for response in self.in_order:
            stands = response.verdict == "stands"
            if fallen and stands:
                found[-1].append(response.scale) if inside else found.append([response.scale])
            inside, fallen = stands, fallen or response.verdict == "collapse"
        return [(window[0], window[-1]) for window in found]


def critical_scale(
    scene: Scene, model: str, system: BlockSystem, tolerance: float, *, note: str = "", observe: Observer = no_observer
) -> Outcome:
    """Find the smallest multiple of a record at which a wall falls.

    Parameters
    ----------
    scene, model
        The wall, with a ground motion, and the name of the model.
    system
        Its blocks at finite displacements.
    tolerance
        Relative width of the bracket.
    note
        Text to add to the message.
    observe
        As in `follow`, for every run; at the end the fall at the upper scale is run once more for the observer.

    Returns
    -------
    Outcome
        `motion` is `Response.shape` of the fall, scaled so that the fastest corner moves by one metre. For every scale
        tried, `curve` holds the largest mean displacement of the upper corners [m] before a fall, and λ; `path` holds
        whether the wall stood, and its residual drift.
    """
    start, rest = time.perf_counter(), Resting.of(scene, model, system)
    outcome = Outcome(scene.title, model, "undecided", dofs=system.freedoms, steps=rest.state.steps)
    outcome = replace(outcome, seconds=time.perf_counter() - start)
    if rest.trouble:
        return replace(outcome, status=rest.trouble[0], message=rest.trouble[1])
    search, stopped = ScaleSearch(lambda scale: follow(rest, scale, rows=ROWS, observe=observe), {}), False
    unit = STANDARD_GRAVITY / float(np.hypot(*rest.history.peak))
    try:
        _bracket(search, START * unit, LARGEST_SCALE * unit, tolerance)
    except KeyboardInterrupt:
        stopped = True
    outcome = _judged(outcome, rest, search, stopped)
    seconds = time.perf_counter() - start
    if outcome.upper is not None and observe is not no_observer and not stopped:
        with suppress(KeyboardInterrupt):
            follow(rest, outcome.upper, after=AFTER, rows=ROWS, observe=observe)
    message = joined(outcome.message, impact_note(scene), note, beam_note(scene))
    return replace(outcome, message=message, seconds=seconds)


def _bracket(search: ScaleSearch, first: float, most: float, tolerance: float) -> None:
    """Lower the scale until there is no fall, raise it to the first fall and beyond, and bisect the first bracket."""

    def scale(number: int) -> float:  # not factor by factor: rounding would make equal scales differ
        return first * RATIO**number

    number = 0
    while search.falls(scale(number)) and scale(number) > most * 1e-9:
        number -= 1
    while not search.falls(scale(number)):
        if scale(number) > most:
            return
        number += 1
    for beyond in range(1, math.floor(math.log(BEYOND) / math.log(RATIO)) + 1):
        search.falls(scale(number + beyond))
    lower, upper = scale(number - 1), scale(number)
    search.falls(lower)
    while upper - lower > tolerance * upper and search.tried[lower].verdict == "stands":
        middle = (lower + upper) / 2
        lower, upper = (lower, middle) if search.falls(middle) else (middle, upper)


def _judged(outcome: Outcome, rest: Resting, search: ScaleSearch, stopped: bool) -> Outcome:
    runs = search.in_order
    first = next((k for k, run in enumerate(runs) if run.verdict == "collapse"), len(runs))
    upper = runs[first] if first < len(runs) else None
    standing = [k for k in range(first) if runs[k].verdict == "stands"]
    lower = runs[standing[-1]] if standing else None
    points = rest.top
    height = float(points[:, 1].mean() - rest.scene.blocks.extent(rest.scene.wall)[0][1])
    outcome = replace(
        outcome,
        lower=lower.scale if lower else None,
        upper=upper.scale if upper else None,
        steps=(outcome.steps or 0) + sum(run.steps for run in runs),
        curve=np.array([(height * run.peak_drift, run.scale) for run in runs]).reshape(-1, 2),
        path=np.array([(run.verdict == "stands", run.residual_drift) for run in runs], dtype=float).reshape(-1, 2),
        path_columns=(AT_REST, "drift at the end"),
    )
    if stopped:
        return replace(outcome, message="interrupted: the bracket so far")
    if upper is None:
        most = number(runs[-1].scale)
        stands = all(run.verdict == "stands" for run in runs)
        told = f"stands at every scale tried, up to {most}" if stands else f"falls at no scale tried, up to {most}"
        return replace(outcome, message=told if standing else f"{told}, and rests at none")
    outcome = replace(outcome, motion=fastest_corner_by_one(rest.scene.blocks, upper.shape))
    doubtful = max((run for run in (lower, upper) if run), key=lambda run: run.unaccounted)
    if doubtful.unaccounted > MISSED:
        message = (
            f"{doubtful.unaccounted:.1%} of the energy supplied is unaccounted for at λ = {number(doubtful.scale)}"
        )
        return replace(outcome, status="failed", message=message)
    if lower is None:
        return replace(
            outcome, message="no scale was found at which the wall comes to rest below one at which it falls"
        )
    unsure = ", ".join(number(run.scale) for run in runs[:first] if run.verdict != "stands")
    if standing[-1] < first - 1:
        return replace(outcome, message=f"at λ = {unsure} the wall neither rests nor falls")
    others = f"others but {unsure}, where it neither rests nor falls," if unsure else "tried"
    again = [f"{number(low)} … {number(high)}" if high > low else number(low) for low, high in search.windows()]
    parts = (
        f"the wall stands at the lower scale and at all {others} below it; at the upper one it {upper.message}",
        f"it stands again at {', '.join(again)}" if again else "",
        f"scales were tried in steps of {RATIO:g} up to {number(runs[-1].scale)}; narrower windows are not seen",
    )
    middle = (lower.scale + upper.scale) / 2
    return replace(outcome, status="collapse", multiplier=middle, message=joined(*parts))
