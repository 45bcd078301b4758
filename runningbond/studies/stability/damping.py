"""How much damping a run may have: steps until the verdict, and whether it is right, with too little and too much.

With too little a wall goes on ringing. A block of mass m on a joint of stiffness k rings with ω = √(k/m); with local
damping α alone each half of its cycle takes (π / 2ω) (1/√(1−α) + 1/√(1+α)) and leaves √((1−α)/(1+α)) of it.

With too much a fall becomes a creep. Local damping only slows it down, for the unbalanced force, by which rest is
judged, is measured before it: with (1) of `known`, a wall loaded by d beyond λ_c has moved by u after

    t = (2 u (M / F) / ((1 − α) d))^{1/2}.                                                                     (3)

Mass-proportional damping c M u̇ belongs to the unbalanced force, which it uses up: that falls as d e^{−(1−α) c t}
while the wall moves on at d / (c M / F), and is taken for rest if it has come below the threshold before the wall
has come far.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from scipy.optimize import brentq

from runningbond.compare.figures import COLOURS, bare
from runningbond.dynamics import BlockSystem, Criteria, Run, State, Verdict, ramp, settle
from runningbond.dynamics.collapse import CALM, CollapseDetector
from runningbond.dynamics.run import LOCAL, VISCOUS

from .finding import Edge, Entry, Finding
from .literature import RAMP, KnownWall, rounded_wall, sliding_block, toppling_block

Answer: TypeAlias = Literal["right", "wrong", "undecided"]

LOCALS = (0.0, 0.05, 0.1, 0.2, 0.35, LOCAL, 0.65, 0.8, 0.9, 0.95)
"""Local damping α."""

VISCOSITIES = (0.0, 0.01, 0.03, VISCOUS, 0.3, 1.0, 3.0)
"""Damping ratio ξ of the joints' viscosity at the highest frequency."""

MASS_RATES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)
"""Rates c of mass-proportional damping [1/s]."""

BESIDE = 0.02
"""Share of λ_c by which the loads lie below and above it."""

BUDGET = 300_000
"""Steps after which a verdict is given up."""

SHORT = 20_000
"""Steps in which a block is to come to rest under its weight, or to be seen to fall, at the edges of α."""

CLOSE = 0.002
"""Relative width to which an edge is bisected."""


@dataclass(frozen=True)
class Cell:
    """A verdict with some damping.

    Parameters
    ----------
    answer
        Whether it was right.
    steps
        Steps that it took, from the wall without load.
    """

    answer: Answer
    steps: int


@dataclass(frozen=True)
class Map:
    """Verdicts on one load over local damping and viscosity.

    Parameters
    ----------
    wall
        The wall.
    load
        λ in units of the load that brings it down.
    cells
        ``cells[α, ξ]``.
    """

    wall: KnownWall
    load: float
    cells: dict[tuple[float, float], Cell]


def judged(
    wall: KnownWall,
    load: float,
    local: float = LOCAL,
    viscous: float = VISCOUS,
    mass_rate: float = 0.0,
    budget: int = BUDGET,
) -> Cell:
    """Bring a wall to rest, ramp a load up, and hold it until the verdict.

    Parameters
    ----------
    wall
        The wall.
    load
        λ in units of the load that brings it down.
    local, viscous
        Local damping, and the joints' viscous damping ratio.
    mass_rate
        Mass-proportional damping [1/s].
    budget
        Steps after which the verdict is given up.
    """
    run = Run(_damped(wall.system, mass_rate), local=local, viscous=viscous)
    state = State.at_rest(wall.system)
    criteria = Criteria(collapse=wall.far, budget=budget)
    verdict = settle(run, state, 0.0, criteria, sudden=True)
    if verdict == "stable":
        ramp(run, state, 0.0, load * wall.multiplier, RAMP * state.steps)
        left = max(0, budget - state.steps)
        verdict = settle(run, state, load * wall.multiplier, replace(criteria, budget=left))
    elif verdict == "collapse":
        return Cell("wrong", state.steps)
    return Cell(_answer(verdict, load), state.steps)


def mapped(
    wall: KnownWall, load: float, locals_: Sequence[float] = LOCALS, viscosities: Sequence[float] = VISCOSITIES
) -> Map:
    """Verdicts on a load over local damping and viscosity."""
    return Map(wall, load, {(a, x): judged(wall, load, a, x) for a in locals_ for x in viscosities})


def least_local(steps: int = SHORT) -> Edge:
    """Least local damping with which a block comes to rest under its weight in some steps, without viscosity.

    Steps a tenth as long as stable ones, for the theory is of a continuous motion.
    """
    wall = sliding_block()
    criteria = Criteria(collapse=wall.far, budget=steps, interval=20)
    dt = 0.1 * Run(wall.system).dt

    def rests(local: float) -> bool:
        run = Run(wall.system, local=local, viscous=0.0, dt=dt)
        return settle(run, State.at_rest(wall.system), 0.0, criteria) == "stable"

    def surplus(local: float) -> float:
        rings = math.log(1 / criteria.rest) / (0.5 * math.log((1 + local) / (1 - local)))
        omega = math.sqrt((wall.system.interface.law.normal_stiffness * wall.system.interface.area).sum() / _mass(wall))
        half = math.pi / (2 * omega) * (1 / math.sqrt(1 - local) + 1 / math.sqrt(1 + local))
        return steps - rings * half / dt

    theory = float(brentq(surplus, 1e-4, 0.9))
    return Edge(
        f"least local damping α that brings a block to rest in {steps * dt:.2g} s, ξ = 0",
        _bisected(lambda local: not rests(local), theory / 2, theory * 2),
        theory,
        0.03,  # three looks may find the force on its way through zero
    )


def most_local(budget: int = SHORT) -> Edge:
    """Least 1 − α with which the fall of a block is seen within some steps."""
    wall, load = sliding_block(), 1 + BESIDE

    def surplus(left: float) -> float:
        run, rest = wall.rest(1 - left)
        time = math.sqrt(2 * CollapseDetector.EARLY * wall.far * wall.inertia / (left * BESIDE * wall.multiplier))
        return budget - (1 + RAMP) * rest.steps - time / run.dt

    return Edge(
        f"least 1 − α with which a block's fall at {load:g} λ is seen in {budget} steps, ξ = {VISCOUS:g}",
        _bisected(lambda left: judged(wall, load, 1 - left, budget=budget).answer != "right", 1e-3, 0.5),
        float(brentq(surplus, 1e-3, 0.5)),
        0.03,
    )


def most_mass_rate(wall: KnownWall, tolerance: float | None) -> Edge:
    """Largest rate of mass-proportional damping with which a wall's fall is not taken for rest."""
    load = 1 + BESIDE
    beyond = BESIDE * wall.multiplier

    criteria = Criteria(wall.far)
    # Calm is seen half an interval later, in the mean, and believed at the last of its looks; a fall at the one before.
    looks = (CALM - 1.5) * criteria.interval * Run(wall.system).dt

    def surplus(rate: float) -> float:
        decay = (1 - LOCAL) * rate
        calm = math.log(beyond * wall.unrest / criteria.rest) / decay + looks
        return (
            beyond / (rate * wall.inertia) * (calm - (1 - math.exp(-decay * calm)) / decay)
            - CollapseDetector.EARLY * wall.far
        )

    theory = float(brentq(surplus, 0.1, 1e4))
    return Edge(
        f"largest mass-proportional damping that does not feign rest at {load:g} λ [1/s], {wall.name}",
        _bisected(lambda rate: judged(wall, load, mass_rate=rate).answer == "right", theory / 3, theory * 3),
        theory,
        tolerance,
    )


def experiment() -> Finding:
    """Hold loads just below and just above collapse, with all kinds and amounts of damping."""
    block, masonry = sliding_block(), rounded_wall("wall-w1")
    loads = (1 - BESIDE, 1 + BESIDE)
    maps = [mapped(wall, load) for wall in (block, masonry) for load in loads]
    massive = {(wall.name, c): judged(wall, loads[1], mass_rate=c) for wall in (block, masonry) for c in MASS_RATES}
    rows: list[tuple[Entry, ...]] = []
    for found in maps:
        rows += [
            (found.wall.name, f"{found.load:g}", a, x, 0.0, cell.answer, cell.steps)
            for (a, x), cell in found.cells.items()
        ]
    rows += [(name, f"{loads[1]:g}", LOCAL, VISCOUS, c, cell.answer, cell.steps) for (name, c), cell in massive.items()]
    feigned = [most_mass_rate(block, 0.02), most_mass_rate(masonry, None)]
    edges = [least_local(), most_local(), *feigned, most_mass_rate(toppling_block(), 0.02)]
    wrong = sum(cell.answer == "wrong" for found in maps for cell in found.cells.values())
    return Finding(
        title="Damping: steps until the verdict, and whether it is right",
        heads=("wall", "λ / collapse", "α", "ξ", "mass-proportional [1/s]", "verdict", "steps"),
        rows=rows,
        edges=edges,
        trust=_trusted(maps),
        beyond="`undecided`, the budget ran out, with too little damping or too much; a wrong verdict in "
        f"{wrong} of {sum(len(found.cells) for found in maps)} runs with local damping and the joints' viscosity. "
        "Mass-proportional damping above the edges makes a fall look like rest, and no model of the suite has any.",
        draw=partial(_draw, maps, massive, feigned),
    )


def _damped(system: BlockSystem, mass_rate: float) -> BlockSystem:
    moving = np.isfinite(system.mass)
    return replace(system, viscosity=system.viscosity + mass_rate * np.where(moving, system.mass, 0.0))


def _mass(wall: KnownWall) -> float:
    return float(wall.system.mass[wall.system.rigid[0, 1]])


def _answer(verdict: Verdict, load: float) -> Answer:
    if verdict == "undecided":
        return "undecided"
    return "right" if (verdict == "collapse") == (load > 1) else "wrong"


def _bisected(before: Callable[[float], bool], low: float, high: float) -> float:
    """Where something that holds at `low` and not at `high` ceases to."""
    assert before(low)
    assert not before(high)
    while high > low * (1 + CLOSE):
        middle = (low + high) / 2
        low, high = (middle, high) if before(middle) else (low, middle)
    return (low + high) / 2


def _trusted(maps: Sequence[Map]) -> str:
    """Where every map is right."""
    good = {key for key in maps[0].cells if all(found.cells[key].answer == "right" for found in maps)}
    xs = sorted(x for x in VISCOSITIES if (LOCAL, x) in good)
    alphas = sorted(a for a in LOCALS if (a, VISCOUS) in good)
    assert (LOCAL, VISCOUS) in good
    return (
        f"Right with α = {alphas[0]:g} to {alphas[-1]:g} at ξ = {VISCOUS:g}, and with ξ = {xs[0]:g} to {xs[-1]:g} at "
        f"α = {LOCAL:g}, in at most {BUDGET} steps; the suite's α = {LOCAL:g}, ξ = {VISCOUS:g} stands in the middle. "
        "Some viscosity there must be: without it sliding contacts chatter, and local damping drags on the chatter."
    )


def _draw(maps: Sequence[Map], massive: dict[tuple[str, float], Cell], edges: Sequence[Edge], figure: Figure) -> None:
    figure.set_size_inches(10, 5.6)
    grid = figure.add_gridspec(2, 3, width_ratios=(1, 1, 0.95))
    steps = [cell.steps for found in maps for cell in found.cells.values() if cell.answer == "right"]
    shared = LogNorm(min(steps), BUDGET)
    for k, found in enumerate(maps):
        axes = figure.add_subplot(grid[k // 2, k % 2])
        _draw_map(axes, found, shared)
        if k // 2:
            axes.set_xlabel("joints' viscosity ξ")
        if k % 2 == 0:
            axes.set_ylabel("local damping α")
    colours = figure.colorbar(figure.axes[0].images[0], ax=figure.axes, location="bottom", shrink=0.8, aspect=50)
    colours.set_label("steps until the verdict      ? undecided    × wrong    □ the suite's", fontsize=9)
    axes = figure.add_subplot(grid[:, 2])
    _draw_mass_rates(axes, massive, edges)


def _draw_map(axes: Axes, found: Map, norm: LogNorm) -> None:
    right = {key: cell.answer == "right" for key, cell in found.cells.items()}
    steps = np.array([[found.cells[a, x].steps if right[a, x] else BUDGET for x in VISCOSITIES] for a in LOCALS])
    axes.imshow(steps, cmap="cividis_r", norm=norm, origin="lower", aspect="auto")
    for (a, x), cell in found.cells.items():
        if cell.answer != "right":
            at = (VISCOSITIES.index(x), LOCALS.index(a))
            mark = "?" if cell.answer == "undecided" else "×"
            axes.annotate(mark, at, color="white", ha="center", va="center", fontsize=9, fontweight="bold")
    axes.plot(VISCOSITIES.index(VISCOUS), LOCALS.index(LOCAL), "s", ms=13, mfc="none", mec="#c2410c", mew=2)
    axes.set_xticks(range(len(VISCOSITIES)), [f"{x:g}" for x in VISCOSITIES])
    axes.set_yticks(range(len(LOCALS)), [f"{a:g}" for a in LOCALS])
    axes.tick_params(labelsize=8)
    state = "stands" if found.load < 1 else "falls"
    axes.set_title(f"{found.wall.name}, {found.load:g} λ: {state}", fontsize=9)


def _draw_mass_rates(axes: Axes, massive: dict[tuple[str, float], Cell], edges: Sequence[Edge]) -> None:
    names = dict.fromkeys(name for name, _ in massive)
    for name, colour, marker in zip(names, (COLOURS[0], COLOURS[2]), "o^", strict=True):
        cells = [massive[name, c] for c in MASS_RATES]
        axes.loglog(MASS_RATES, [cell.steps for cell in cells], color=colour, lw=1)
        for c, cell in zip(MASS_RATES, cells, strict=True):
            axes.loglog(c, cell.steps, marker, color=colour, ms=6, mfc=colour if cell.answer == "right" else "white")
        axes.loglog([], [], marker, color=colour, label=name)
    axes.loglog([], [], "o", color="0.3", label="seen to fall")
    axes.loglog([], [], "o", color="0.3", mfc="white", label="taken for rest: wrong")
    axes.axvspan(min(edge.measured for edge in edges), MASS_RATES[-1] * 1.5, color="0.93", zorder=0)
    axes.set(xlim=(MASS_RATES[0] / 1.5, MASS_RATES[-1] * 1.5), xlabel="mass-proportional damping c [1/s]")
    axes.set(ylabel="steps until the verdict", ylim=(2e3, 3e5))
    axes.set_title(f"{1 + BESIDE:g} λ, with mass-proportional damping", fontsize=9)
    axes.legend(fontsize=8, loc="upper right", frameon=False)
    bare(axes)
