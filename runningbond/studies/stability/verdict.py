"""The verdict: how small the unbalanced force of a wall at rest must be, and how far one that falls must have come.

A wall loaded beyond λ_c is driven by (λ − λ_c) F and stays unbalanced by that, so a threshold of rest r, in force
units, takes it for standing up to

    λ − λ_c = r / w,                                                                                           (4)

w the largest unbalanced force of its motion for each unit of λ − λ_c (`KnownWall.unrest`). The other way round, a
wall that settles or slips a little, and is caught, is taken for falling where that is far enough.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dem import limit_nonassociated
from dem.rigid_system import rigid_system
from runningbond.compare.figures import COLOURS, bare
from runningbond.compare.published import published_scene
from runningbond.dynamics import Criteria, Run, load_steps, ramp, settle
from runningbond.dynamics.collapse import U_CRIT
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.results import Outcome
from runningbond.scene import Array, Scene

from .finding import Edge, Entry, Finding
from .literature import RAMP, KnownWall, rounded_wall, sliding_block, toppling_block

REST = Criteria(collapse=U_CRIT).rest
"""The suite's threshold of rest."""

INTERVAL = Criteria(collapse=U_CRIT).interval
"""The suite's steps between two looks."""

RESTS = (0.3, 0.1, 0.03, 0.01, 1e-3, 1e-4, 2 * REST, REST, REST / 2, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 1e-16)
"""Thresholds of rest, in force units."""

FARS = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, U_CRIT / 2, U_CRIT, 2 * U_CRIT, 0.4, 1.6)
"""Displacements of a collapse, in block sizes, of walls with a weight."""

FARS_WEIGHTLESS = (1e-3, U_CRIT / 2, U_CRIT, 2 * U_CRIT, 0.4)
"""The same of a wall without weight."""

INTERVALS = (1, 20, INTERVAL // 2, INTERVAL, 2 * INTERVAL, 2000)
"""Steps between two looks."""

WEIGHTLESS = "point-load-4"
"""The published wall without weight."""

MARKERS = "os^"
"""Marks of the walls, by their colours."""

WIDTH = 0.005
"""Relative width of the brackets."""

BUDGET = 1_000_000
"""Steps after which a load is left undecided."""


@dataclass(frozen=True)
class Trial:
    """A search for λ with some criteria of the verdict.

    Parameters
    ----------
    lower, upper
        Largest load at rest, smallest in collapse; None where there was none.
    decided
        Whether the budget sufficed.
    """

    lower: float | None
    upper: float | None
    decided: bool

    @property
    def middle(self) -> float | None:
        """Middle of the bracket; None where there is none, or the budget ran out."""
        return None if self.lower is None or self.upper is None or not self.decided else (self.lower + self.upper) / 2

    @property
    def answer(self) -> str:
        """What a user is told."""
        if not self.decided:
            return "undecided"
        return "infeasible" if self.middle is None else "collapse"

    def agrees(self, other: "Trial") -> bool:
        """Whether both are decided, at loads that differ by less than their brackets are wide."""
        if self.middle is None or other.middle is None:
            return False
        return abs(self.middle - other.middle) <= WIDTH * other.middle


@dataclass(frozen=True, eq=False)
class Sweep:
    """One criterion driven from too tight to too loose.

    Parameters
    ----------
    name
        The wall.
    criterion
        What is changed, with its unit.
    default
        Its value in the suite.
    trials
        A search for each value, in ascending order.
    known
        λ that is known; None where none is.
    """

    name: str
    criterion: str
    default: float
    trials: dict[float, Trial]
    known: float | None = None

    @property
    def unit(self) -> float:
        """λ that is known, or else that of the suite's own value."""
        middle = self.trials[self.default].middle
        assert middle is not None
        return self.known or middle

    @property
    def plateau(self) -> tuple[float, float]:
        """Smallest and largest value about the suite's that find the same λ."""
        values = list(self.trials)
        same = [self.trials[value].agrees(self.trials[self.default]) for value in values]
        first = last = values.index(self.default)
        while first > 0 and same[first - 1]:
            first -= 1
        while last < len(values) - 1 and same[last + 1]:
            last += 1
        return values[first], values[last]


def trial(scene: Scene, collapse: float, *, rest: float = REST, interval: int = INTERVAL) -> Trial:
    """Search for λ with some criteria, as slowly at first as the suite does.

    Parameters
    ----------
    scene
        The wall.
    collapse
        Displacement at which a wall that does not slow down is in collapse, in block sizes.
    rest
        Threshold of rest, in force units.
    interval
        Steps between two looks.
    """
    run = Run(rigid_system(scene))
    first = FIRST_STEP / run.system.measure(run.system.live)
    criteria = Criteria(collapse * scene.block_size, rest, BUDGET, interval)
    found = load_steps(run, first, WIDTH, criteria)
    lower, upper, borne = found.lower, found.upper, found.borne
    if lower is None or upper is None or borne is None or found.verdict == "undecided":
        return Trial(lower, upper, lower is None and found.verdict == "collapse")
    # The suite leaves its bracket as wide as a loose threshold of rest makes it uncertain; here its edge is looked for.
    settling = RAMP * found.rests[0][1].steps
    while upper - lower > WIDTH * upper:
        middle, state = (lower + upper) / 2, borne.copy()
        ramp(run, state, lower, middle, settling)
        verdict = settle(run, state, middle, criteria)
        if verdict == "undecided":
            return Trial(lower, upper, False)
        lower, upper, borne = (middle, upper, state) if verdict == "stable" else (lower, middle, borne)
    return Trial(lower, upper, True)


def rest_sweep(wall: KnownWall, rests: Sequence[float] = RESTS) -> Sweep:
    """The threshold of rest, from rounding errors up to a good part of a block's weight."""
    trials = {rest: trial(wall.scene, U_CRIT, rest=rest) for rest in sorted(rests)}
    return Sweep(wall.name, "rest [force units]", REST, trials, wall.multiplier)


def far_sweep(wall: KnownWall, fars: Sequence[float] = FARS) -> Sweep:
    """The displacement of a collapse, from below what a wall settles under its weight up to more than a block."""
    trials = {far: trial(wall.scene, far) for far in sorted(fars)}
    return Sweep(wall.name, "u_crit [block sizes]", U_CRIT, trials, wall.multiplier)


def weightless_sweep(fars: Sequence[float] = FARS_WEIGHTLESS) -> Sweep:
    """The same for a wall without weight, that may slip far and be caught."""
    scene = published_scene(WEIGHTLESS)
    trials = {far: trial(scene, far) for far in sorted(fars)}
    return Sweep(f"{WEIGHTLESS}, no weight", "u_crit [block sizes]", U_CRIT, trials)


def interval_sweep(wall: KnownWall, intervals: Sequence[int] = INTERVALS) -> Sweep:
    """The steps between two looks."""
    trials: dict[float, Trial] = {n: trial(wall.scene, U_CRIT, interval=n) for n in sorted(intervals)}
    return Sweep(wall.name, "steps between looks", INTERVAL, trials, wall.multiplier)


def believed(wall: KnownWall, rest: Array) -> Array:
    """λ up to which a wall is taken for standing with thresholds of rest ``(n,)``, by (4)."""
    return np.asarray(wall.multiplier + rest / wall.unrest)


def experiment() -> Finding:
    """Change the criteria of the verdict one at a time, and see what becomes of λ."""
    walls = (sliding_block(), toppling_block(), rounded_wall("wall-w1"))
    rests = [rest_sweep(wall) for wall in walls]
    fars = [*(far_sweep(wall) for wall in (walls[2], rounded_wall("wall-w2"))), weightless_sweep()]
    looks = interval_sweep(walls[2])
    certified = limit_nonassociated(published_scene(WEIGHTLESS))
    sweeps = [*rests, *fars, looks]
    rows: list[tuple[Entry, ...]] = []
    for sweep in sweeps:
        for value, found in sweep.trials.items():
            ends = [f"{end / sweep.unit:.4f}" if end is not None else "–" for end in (found.lower, found.upper)]
            rows.append((sweep.name, sweep.criterion, f"{value:g}", found.answer, *ends))
    return Finding(
        title="Verdict: when a wall is at rest, and when it has fallen",
        heads=("wall", "criterion", "value", "answer", "at rest, of λ known", "falls, of λ known"),
        rows=rows,
        edges=_edges(walls, rests, fars),
        trust=f"λ is the same to {100 * WIDTH:g} % with thresholds of rest from {_both(rests)} force units and, of "
        f"walls with a weight, u_crit from {_both(fars[:2])} block sizes; without weight, loaded in pauses, from "
        f"{_both(fars[2:])}; and with looks every {looks.plateau[0]:g} to {looks.plateau[1]:g} steps. "
        f"The suite takes {REST:g}, {U_CRIT:g} block sizes, and {INTERVAL} steps.",
        beyond="A threshold of rest too loose gives a λ too high by (4), one below rounding `undecided`. A u_crit too "
        "small gives a λ too low, or `infeasible` where not even the settlement under the weight is allowed; one too "
        "large costs steps, and in the end is `undecided`.",
        draw=partial(_draw, walls, rests, fars, certified),
    )


def _both(sweeps: Sequence[Sweep]) -> str:
    """Plateau that some sweeps have in common."""
    low, high = max(sweep.plateau[0] for sweep in sweeps), min(sweep.plateau[1] for sweep in sweeps)
    return f"{low:g} to {high:g}"


def _edges(walls: Sequence[KnownWall], rests: Sequence[Sweep], fars: Sequence[Sweep]) -> list[Edge]:
    edges = []
    for wall, sweep in zip(walls, rests, strict=True):
        for rest in (0.03, 0.01):
            middle = sweep.trials[rest].middle
            if middle is not None:
                what = f"λ taken for standing with rest at {rest:g} force units, {wall.name}"
                edges.append(Edge(what, middle, float(believed(wall, np.array([rest]))[0]), WIDTH))
    for sweep in (*rests, *fars):
        low, high = sweep.plateau
        edges.append(Edge(f"smallest {sweep.criterion} that finds the suite's λ, {sweep.name}", low))
        edges.append(Edge(f"largest {sweep.criterion} that finds the suite's λ, {sweep.name}", high))
    return edges


def _draw(
    walls: Sequence[KnownWall], rests: Sequence[Sweep], fars: Sequence[Sweep], certified: Outcome, figure: Figure
) -> None:
    figure.set_size_inches(10, 4.8)
    left, right = figure.subplots(1, 2)
    for wall, sweep, colour, marker in zip(walls, rests, COLOURS, MARKERS, strict=False):
        _draw_sweep(left, sweep, colour, marker, 0.93)
        many = np.geomspace(1e-5, 0.3, 60)
        left.plot(many, believed(wall, many) / wall.multiplier, color=colour, lw=1)
    left.set(
        xscale="log", xlim=(2e-17, 1), ylim=(0.9, 1.5), xlabel="threshold of rest [force units]", ylabel="λ / λ known"
    )
    left.annotate("?  undecided", (1e-12, 0.93), color="0.4", fontsize=8)
    left.set_title("at rest; lines: λ taken for standing, by theory", fontsize=10)
    for sweep, colour, marker in zip(fars, (COLOURS[2], COLOURS[3], COLOURS[0]), "^Ds", strict=True):
        _draw_sweep(right, sweep, colour, marker, 0.75, joined=True)
    if certified.lower is not None and certified.upper is not None:
        span = (certified.lower / fars[-1].unit, certified.upper / fars[-1].unit)
        right.errorbar(5, span[0], [[0], [span[1] - span[0]]], color=COLOURS[0], lw=1.5, capsize=3)
        right.annotate(f"certified for\n{WEIGHTLESS}", (7, span[1] + 0.005), ha="right", color=COLOURS[0], fontsize=8)
    right.annotate("×  “falls under its weight”\n?  undecided", (2e-6, 0.74), color="0.4", fontsize=8)
    right.set(xscale="log", xlim=(4e-8, 8), ylim=(0.7, 1.1), xlabel="displacement of a collapse [block sizes]")
    right.set_ylabel("λ / λ known (without weight: / the suite's)")
    right.set_title("fallen", fontsize=10)
    for axes in (left, right):
        axes.plot([], [], "o", ms=11, mfc="none", mec="0.3", label="the suite's")
        axes.legend(fontsize=8, frameon=False, loc="upper left")
        bare(axes)


def _draw_sweep(axes: Axes, sweep: Sweep, colour: str, marker: str, bottom: float, *, joined: bool = False) -> None:
    """Middles of a sweep's brackets, narrower than their marks, the suite's in a circle; at the bottom, no answer."""
    drawn = [(value, found.middle / sweep.unit) for value, found in sweep.trials.items() if found.middle is not None]
    value, middle = np.array(drawn).T
    axes.plot(value, middle, marker, ls="-" if joined else "none", lw=0.8, ms=5, color=colour, label=sweep.name)
    for value, found in sweep.trials.items():
        if found.middle is None:
            axes.annotate("?" if found.answer == "undecided" else "×", (value, bottom), color=colour, ha="center")
    axes.plot(sweep.default, dict(drawn)[sweep.default], "o", ms=11, mfc="none", mec=colour)
