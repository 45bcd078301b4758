"""How much damping a run may have: steps until the verdict, and whether it is right, with too little and too much.

With too little damping a wall keeps ringing. A block of mass m on a joint of stiffness k rings with ω = √(k/m); with
local damping α only, each half cycle takes (π / 2ω) (1/√(1−α) + 1/√(1+α)) and multiplies the amplitude by
√((1−α)/(1+α)).

With too much damping a collapse becomes a creep. Local damping only slows it down, because the unbalanced force, which
decides whether a wall is at rest, is measured before local damping: by (1) of `studies.walls`, a wall loaded by d
beyond λ_c has moved by u after

    t = (2 u (M / F) / ((1 − α) d))^{1/2}.                                                                     (3)

Mass-proportional damping c M u̇ is part of the unbalanced force and balances the load: the unbalanced force decays as
d e^{−(1−α) c t} while the wall moves on at d / (c M / F). The wall is taken to be at rest if the unbalanced force falls
below the threshold before the wall has moved far.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from scipy.optimize import brentq

from runningbond.dynamics import Criteria, Run, State, ramp, settle
from runningbond.dynamics.collapse import CALM, CollapseDetector
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.pictures.charts import LOOKS, looks_of
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study, run_around
from runningbond.studies.walls import RAMP, SLIDING, TOPPLING, W1, known_wall

LOCALS = (0.0, 0.05, 0.1, 0.2, 0.35, LOCAL, 0.65, 0.8, 0.9, 0.95)  # local damping α
VISCOSITIES = (0.0, 0.01, 0.03, VISCOUS, 0.3, 1.0, 3.0)  # damping ratio ξ of the joints at the highest frequency
MASS_RATES = (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)  # rates c of mass-proportional damping [1/s]
WALLS, BESIDE = (SLIDING, W1), 0.02  # walls of the maps; share of λ_c by which loads are below and above it
BUDGET, SHORT = 300_000, 20_000  # step budgets for a verdict, in the maps and at the edges of α
CLOSE = 0.002  # relative accuracy of the edges
MAPS, MASSIVE, EDGES = "Verdicts by damping", "Verdicts with mass-proportional damping", "Edges"
LOAD, RATE = "λ / collapse", "c [1/s]"
LEAST_LOCAL = f"least α that brings it to rest in {SHORT} tenths of a step, ξ = 0"
MOST_LOCAL = f"least 1 − α with which a fall at {1 + BESIDE:g} λ is seen in {SHORT} steps"
FEIGNED = f"largest mass-proportional damping that does not feign rest at {1 + BESIDE:g} λ [1/s]"


def judged(
    name: str, load: float, local: float = LOCAL, viscous: float = VISCOUS, mass_rate: float = 0.0, budget: int = BUDGET
) -> Row:
    """Settle a wall, ramp it to a load relative to λ_c, and hold that: is the verdict right, and after how many steps.

    Local damping is kept to the end. The other parameters are the joints' viscous damping ratio, a mass-proportional
    damping rate [1/s] and a budget of steps.
    """
    wall = known_wall(name)
    drag = mass_rate * np.where(np.isfinite(wall.system.mass), wall.system.mass, 0.0)
    run = Run(replace(wall.system, viscosity=wall.system.viscosity + drag), local=local, viscous=viscous)
    state, criteria = State.at_rest(wall.system), Criteria(wall.far, budget=budget, dragged=np.inf, shortest=0)
    verdict, right = settle(run, state, 0.0, criteria, sudden=True), False
    if verdict == "stable":
        ramp(run, state, 0.0, load * wall.multiplier, RAMP * state.steps)
        left = max(0, budget - state.steps)
        verdict = settle(run, state, load * wall.multiplier, replace(criteria, budget=left))
        right = verdict == ("collapse" if load > 1 else "stable")
    return {"verdict": "right" if right else "undecided" if verdict == "undecided" else "wrong", "steps": state.steps}


def least_local(name: str = SLIDING) -> Row:
    """Smallest local damping with which a block settles under its weight in `SHORT` steps, without viscosity.

    The steps are a tenth of the stable one because the theory is for continuous motion.
    """
    wall = known_wall(name)
    system, criteria = wall.system, Criteria(collapse=wall.far, budget=SHORT, interval=20)
    dt, stiffness = 0.1 * Run(system).dt, (system.interface.law.normal_stiffness * system.interface.area).sum()
    omega = math.sqrt(stiffness / system.mass[system.rigid[0, 1]])

    def rings(local: float) -> bool:
        run = Run(system, local=local, viscous=0.0, dt=dt)
        return settle(run, State.at_rest(system), 0.0, criteria) != "stable"

    def surplus(local: float) -> float:
        rings = math.log(1 / criteria.rest) / (0.5 * math.log((1 + local) / (1 - local)))
        half = math.pi / (2 * omega) * (1 / math.sqrt(1 - local) + 1 / math.sqrt(1 + local))
        return SHORT - rings * half / dt

    theory = float(brentq(surplus, 1e-4, 0.9))
    # The force may pass through zero at three successive checks.
    return {"measured": _bisected(rings, theory / 2, theory * 2), "theory": theory, "allowed": 0.03}


def most_local(name: str = SLIDING) -> Row:
    """Smallest 1 − α with which the collapse of a block is detected within `SHORT` steps, by (3)."""
    wall, load = known_wall(name), 1 + BESIDE

    def surplus(left: float) -> float:
        run, rest = wall.rest(1 - left)
        time = math.sqrt(2 * CollapseDetector.EARLY * wall.far * wall.inertia / (left * BESIDE * wall.multiplier))
        return SHORT - (1 + RAMP) * rest.steps - time / run.dt

    def unseen(left: float) -> bool:
        return bool(judged(name, load, 1 - left, budget=SHORT)["verdict"] != "right")

    return {"measured": _bisected(unseen, 1e-3, 0.5), "theory": float(brentq(surplus, 1e-3, 0.5)), "allowed": 0.03}


def most_mass_rate(name: str) -> Row:
    """Largest rate of mass-proportional damping with which the collapse of a wall is not taken for rest."""
    wall, load = known_wall(name), 1 + BESIDE
    beyond, criteria = BESIDE * wall.multiplier, Criteria(wall.far, shortest=0)
    # Rest is first seen half an interval late, on average, and accepted at the last of `CALM` checks; a collapse must
    # be seen by the check before.
    looks = (CALM - 1.5) * criteria.interval * Run(wall.system).dt

    def surplus(rate: float) -> float:
        decay = (1 - LOCAL) * rate
        calm = math.log(beyond * wall.unbalanced / criteria.rest) / decay + looks
        moved = beyond / (rate * wall.inertia) * (calm - (1 - math.exp(-decay * calm)) / decay)
        return moved - CollapseDetector.EARLY * wall.far

    def seen(rate: float) -> bool:
        return bool(judged(name, load, mass_rate=rate)["verdict"] == "right")

    theory = float(brentq(surplus, 0.1, 1e4))
    measured = _bisected(seen, theory / 3, theory * 3)
    return {"measured": measured, "theory": theory, "allowed": 0.02 if wall.is_block else None}


def _bisected(before: Callable[[float], bool], low: float, high: float) -> float:
    """Value at which a condition that holds at `low`, and not at `high`, ceases to hold."""
    assert before(low)
    assert not before(high)
    while high > low * (1 + CLOSE):
        middle = (low + high) / 2
        low, high = (middle, high) if before(middle) else (low, middle)
    return (low + high) / 2


def fits(rows: Rows) -> list[Edge]:
    """Edges: ranges of α and ξ around the suite's with only right verdicts, and the number of wrong verdicts."""
    bad = {(row["α"], row["ξ"]) for row in rows[MAPS] if row["verdict"] != "right"}
    alphas = run_around(LOCAL, LOCALS, {a for a in LOCALS if (a, VISCOUS) not in bad})
    xis = run_around(VISCOUS, VISCOSITIES, {x for x in VISCOSITIES if (LOCAL, x) not in bad})
    ends = {"smallest α": alphas[0], "largest α": alphas[1], "smallest ξ": xis[0], "largest ξ": xis[1]}
    right = [Edge(f"{end} with which every verdict is right, the other as in the suite", ends[end]) for end in ends]
    wrong = sum(row["verdict"] == "wrong" for row in rows[MAPS])
    return [*right, Edge("wrong verdicts with local damping and the joints' viscosity", wrong, 0.0, 0.0)]


def _draw(figure: Figure, rows: Rows) -> None:
    grid = figure.add_gridspec(2, 3, width_ratios=(1, 1, 0.95))
    norm = LogNorm(min(row["steps"] for row in rows[MAPS] if row["verdict"] == "right"), BUDGET)
    for place, (name, load) in enumerate(dict.fromkeys((row["wall"], row[LOAD]) for row in rows[MAPS])):
        axes = figure.add_subplot(grid[place // 2, place % 2])
        _draw_map(axes, [row for row in rows[MAPS] if (row["wall"], row[LOAD]) == (name, load)], norm)
        axes.set_title(f"{name}, {load:g} λ: {'stands' if load < 1 else 'falls'}", fontsize=9)
        axes.set(xlabel="joints' viscosity ξ" if place // 2 else "", ylabel="" if place % 2 else "local damping α")
    colours = figure.colorbar(figure.axes[0].images[0], ax=figure.axes, location="bottom", shrink=0.8, aspect=50)
    colours.set_label("steps until the verdict      ? undecided    × wrong    □ the suite's", fontsize=9)
    _draw_mass_rates(figure.add_subplot(grid[:, 2]), rows)


def _draw_map(axes: Axes, rows: Sequence[Row], norm: LogNorm) -> None:
    steps = np.array([row["steps"] if row["verdict"] == "right" else BUDGET for row in rows])
    axes.imshow(steps.reshape(len(LOCALS), -1), cmap="cividis_r", norm=norm, origin="lower", aspect="auto")
    for row in rows:
        if row["verdict"] != "right":
            at = VISCOSITIES.index(row["ξ"]), LOCALS.index(row["α"])
            mark = "?" if row["verdict"] == "undecided" else "×"
            axes.annotate(mark, at, color="white", ha="center", va="center", fontsize=9, fontweight="bold")
    for colour, width in (("white", 4), (LOOKS[3][0], 2)):
        axes.plot(VISCOSITIES.index(VISCOUS), LOCALS.index(LOCAL), "s", ms=13, mfc="none", mec=colour, mew=width)
    axes.set_xticks(range(len(VISCOSITIES)), [f"{x:g}" for x in VISCOSITIES])
    axes.set_yticks(range(len(LOCALS)), [f"{a:g}" for a in LOCALS])
    axes.tick_params(labelsize=8)


def _draw_mass_rates(axes: Axes, rows: Rows) -> None:
    for name, (colour, marker) in looks_of(WALLS).items():
        own = [row for row in rows[MASSIVE] if row["wall"] == name]
        axes.loglog([row[RATE] for row in own], [row["steps"] for row in own], color=colour, lw=1)
        for row in own:
            fill = colour if row["verdict"] == "right" else "white"
            axes.loglog(row[RATE], row["steps"], marker, color=colour, ms=6, mfc=fill)
        axes.loglog([], [], marker, color=colour, label=name)
    for fill, label in (("0.3", "seen to fall"), ("white", "taken for rest: wrong")):
        axes.loglog([], [], "o", color="0.3", mfc=fill, label=label)
    ends = MASS_RATES[0] / 1.5, MASS_RATES[-1] * 1.5
    feigned = min(row["measured"] for row in rows[EDGES] if row["what"] == FEIGNED and row["wall"] in WALLS)
    axes.axvspan(feigned, ends[1], color="0.93", zorder=0)
    axes.set(xlim=ends, xlabel="mass-proportional damping c [1/s]", ylabel="steps until the verdict", ylim=(2e3, 3e5))
    axes.set_title(f"{1 + BESIDE:g} λ, with mass-proportional damping", fontsize=9)
    axes.legend(loc="upper right")


STUDY = Study(
    "damping",
    "Damping: steps until the verdict, and whether it is right",
    trusted="α and ξ within wide ranges around the suite's values; some viscosity is needed, because without it "
    "sliding contacts chatter, and local damping slows down what chatters",
    beyond="`undecided` because the step budget runs out, with too little or too much damping; mass-proportional "
    "damping above the edges makes a collapse look like rest, and no model of the suite uses it",
    parts={
        MAPS: Part(("wall", LOAD, "α", "ξ"), [*product(WALLS, (1 - BESIDE, 1 + BESIDE), LOCALS, VISCOSITIES)], judged),
        MASSIVE: Part(
            ("wall", RATE), [*product(WALLS, MASS_RATES)], lambda wall, c: judged(wall, 1 + BESIDE, mass_rate=c)
        ),
        EDGES: Part(
            ("what", "wall"),
            [(LEAST_LOCAL, SLIDING), (MOST_LOCAL, SLIDING), *product([FEIGNED], (SLIDING, W1, TOPPLING))],
            lambda what, name: {LEAST_LOCAL: least_local, MOST_LOCAL: most_local, FEIGNED: most_mass_rate}[what](name),
        ),
    },
    charts=[Chart("Steps until the verdict over local, viscous and mass-proportional damping", _draw, size=(10, 6))],
    fits=fits,
)
