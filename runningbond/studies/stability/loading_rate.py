"""How fast a wall may be loaded: λ by a ramp, by a prescribed displacement, and by the suite's load steps.

Under a ramp λ = r t a wall begins to move at λ_c, and its collapse is detected once it has moved by u. By (1) of
`studies.walls`, (M / F) ü = (1 − α) (λ − λ_c), this is at

    λ − λ_c = (6 u r² (M / F) / (1 − α))^{1/3},                                                                 (2)

an excess that grows with the rate to the power 2/3. Under displacement control inertia resists only until the wall has
reached its speed; after a soft start only the waves of that start remain.
"""

from collections.abc import Mapping
from functools import cache
from itertools import product
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from dem.dynamic import quasi_static_run
from runningbond.compare.published import published_scene
from runningbond.dynamics import U_CRIT, Criteria, Run, load_steps, settle
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.dynamics.load_stepping import LOADING, LOADING_WEIGHTLESS
from runningbond.dynamics.run import LOCAL
from runningbond.pictures.charts import LOOKS, floor, level, looks_of, series
from runningbond.scene import Array
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study
from runningbond.studies.pushover import drive, settled_drive
from runningbond.studies.walls import SLIDING, TOPPLING, W1, known_scene, known_wall

WALLS = (SLIDING, TOPPLING, W1)
RATES = tuple(10.0 ** -(k / 3) for k in range(7))  # rates of λ [1/s], the fastest first
PUSHES = tuple(1_000 * 2**k for k in range(12))  # time steps in which a wall is pushed by the collapse displacement
LOADINGS = (0, 1, 4, LOADING, 2 * LOADING, 8 * LOADING)  # durations of the first load step, in times to rest
DRY = ("panel-12", "point-load-4")  # published walls whose λ depends on their history; the second has no weight
ORDER, LOOK, BRACKET = 2 / 3, 5, 0.005  # power of the rate in (2), steps between checks, relative bracket width
FLOOR = 1e-4  # smallest difference in charts [%]
RAMPS, DRIVEN, STEPPED, OWN = "Ramps", "Displacement control", "Load steps", "The suite's own speeds"
RATE, SPEED, OFF, LOADED = "rate [1/s]", "speed [mm/s]", "off by [%]", "first step in [times to rest]"


def off(name: str, multiplier: float) -> float:
    """Deviation of λ of a wall from the known value [%]."""
    return 100 * (multiplier / known_wall(name).multiplier - 1)


def excess(name: str, rate: float, local: float = LOCAL) -> float:
    """Excess of λ by (2) in a ramp at a rate [1/s]."""
    wall = known_wall(name)
    return float(np.cbrt(6 * wall.far * rate**2 * wall.inertia / (1 - local)))


def ramp_row(name: str, rate: float, local: float = LOCAL) -> Row:
    """λ at which the collapse of a wall under a ramp is detected."""
    wall = known_wall(name)
    run, rest = wall.rest(local)
    state, multiplier, step = rest.copy(), 0.0, rate * LOOK * run.dt
    while run.system.farthest(state.motion - rest.motion) < wall.far:
        run.hold(state, multiplier + step / 2, LOOK)
        multiplier += step
    result = multiplier - step / 2
    return {"λ": result, "λ, theory": wall.multiplier + excess(name, rate, local), OFF: off(name, result)}


def order(name: str, rate: Array, multiplier: Array) -> float:
    """Power of the rate in the excess of λ over the known value."""
    return float(np.polyfit(np.log(rate), np.log(multiplier - known_wall(name).multiplier), 1)[0])


def at_no_speed(rate: Array, multiplier: Array) -> tuple[float, float]:
    """λ of a ramp at zero rate and its standard error, by a line over rate^(2/3), weighted by 1 / rate^(2/3)."""
    away = rate**ORDER
    line, covariance = np.polyfit(away, multiplier, 1, w=1 / away, cov=True)
    return float(line[1]), float(np.sqrt(covariance[1, 1]))


def push_row(name: str, steps: int) -> Row:
    """Peak of λ of a wall that is pushed by the collapse displacement of its load steps, in a number of time steps."""
    wall = known_wall(name)
    run, rest = wall.rest()
    peak = drive(run, rest, wall.far, steps).peak
    return {SPEED: 1e3 * wall.far / (steps * run.dt), "λ": peak, OFF: off(name, peak)}


@cache
def search_of(name: str) -> tuple[Run, float, Criteria]:
    """Input of a search for λ of a wall: its run, its first load step, and its collapse criteria."""
    scene = published_scene(name) if name in DRY else known_scene(name)
    run = quasi_static_run(scene)
    far: float | Array = U_CRIT * scene.block_sizes if name in DRY else U_CRIT * scene.block_size
    return run, FIRST_STEP / run.system.measure(run.system.live), Criteria(collapse=far)


def step_row(name: str, loading: float) -> Row:
    """Bracket of λ by load steps; the load grows by its first step in `loading` times the time to rest."""
    run, first, criteria = search_of(name)
    result = load_steps(run, first, BRACKET, criteria, loading=loading)
    assert result.lower is not None
    assert result.upper is not None
    return {"λ lower": result.lower, "λ upper": result.upper, "λ": (result.lower + result.upper) / 2}


def own_row(name: str) -> Row:
    """The suite's own speeds: ramps between its first load steps, and displacement control that has settled to 1 %."""
    (run, rest), (_, first, criteria) = known_wall(name).rest(), search_of(name)
    state = rest.copy()
    settle(run, state, first, criteria)
    settled = settled_drive(run, rest, known_wall(name).far, 0.01)
    return {
        "rate between load steps [1/s]": first / (LOADING * (state.steps - rest.steps) * run.dt),
        "λ, displacement halved until it settles": settled.peak,
        OFF: off(name, settled.peak),
        "own estimate [%]": 100 * settled.rate_error / settled.peak,
    }


def default_loading(name: str) -> float:
    """The suite's duration of the first load step of a wall, in times to rest."""
    return LOADING_WEIGHTLESS if search_of(name)[0].system.weightless else LOADING


def fits(rows: Rows) -> list[Edge]:
    """Edges: orders and limits of ramps, peaks under displacement control, and load steps that are too fast."""
    edges = []
    for name in WALLS:
        known, loose = known_wall(name).multiplier, not known_wall(name).is_block
        own = [row for row in rows[RAMPS] if row["wall"] == name]
        rate, multiplier = (np.array([row[head] for row in own]) for head in (RATE, "λ"))
        limit, error = at_no_speed(rate, multiplier)
        slow, pushed = own[-1], [row for row in rows[DRIVEN] if row["wall"] == name]  # the fastest row first
        too_fast = [place for place, row in enumerate(pushed) if abs(row[OFF]) > 1.0]
        ramped = (float(multiplier[-1]) - known, slow["λ, theory"] - known, None if loose else 0.01)
        to_order, to_limit, to_peak = (0.05, 0.01, 0.01) if loose else (0.005, 0.001, 1e-6)
        edges += [
            Edge(f"order of a ramp's error in its rate, {name}", order(name, rate, multiplier), ORDER, to_order),
            Edge(f"λ of a ramp without speed, {name}", limit, known, to_limit),
            Edge(f"its standard error, {name}", error),
            Edge(f"excess of λ in a ramp at {slow[RATE]:.2g} 1/s, {name}", *ramped),
            Edge(f"peak λ at {pushed[-1][SPEED]:.2g} mm/s, {name}", pushed[-1]["λ"], known, to_peak),
            Edge(f"fastest speed within 1 % [mm/s], {name}", pushed[too_fast[-1] + 1][SPEED]),
        ]
    steps = {(row["wall"], row[LOADED]): row["λ"] for row in rows[STEPPED]}
    edges.append(Edge(f"λ by the suite's load steps, {W1}", steps[W1, LOADING], known_wall(W1).multiplier, BRACKET))
    for name in DRY:
        own_speed, slowest = default_loading(name), LOADINGS[-1]
        ratio: dict[float, float] = {at: steps[name, at] / steps[name, slowest] for at in LOADINGS if at <= own_speed}
        what = f"λ by the suite's load steps, of that {slowest / own_speed:g} times as slow, {name}"
        edges.append(Edge(what, ratio.pop(own_speed)))
        hasty = max(ratio.values(), key=lambda ratio: abs(ratio - 1))
        edges.append(Edge(f"λ in haste, of that of the slowest loading, {name}", hasty))
    return edges


def _above_floor(row: Mapping[str, Any]) -> float | None:
    """Deviation of λ [%]; None if it is not above `FLOOR`."""
    return abs(row[OFF]) if abs(row[OFF]) > FLOOR else None


def _draw(figure: Figure, rows: Rows) -> None:
    left, middle, right = figure.subplots(1, 3, width_ratios=(1.2, 1.2, 0.8))
    looks = looks_of(WALLS)
    series(left, rows[RAMPS], RATE, OFF, "wall", looks, ls="none", ms=5)
    for name, (colour, _) in looks.items():
        theory = [100 * excess(name, rate) / known_wall(name).multiplier for rate in RATES]
        left.plot(RATES, theory, color=colour, lw=1)
    between = rows[OWN][0]["rate between load steps [1/s]"]
    left.axvline(between, color="0.6", lw=0.9, ls="--", zorder=0)
    left.annotate("between the\nsuite's steps", (0.93 * between, 1.3), ha="right", color="0.4", fontsize=8)
    left.set(xscale="log", yscale="log", xlabel="rate of the ramp dλ/dt [1/s]", ylabel="λ too high by [%]")
    left.set(ylim=(1, 100), yticks=[1, 10, 100], yticklabels=["1", "10", "100"])
    series(middle, rows[DRIVEN], SPEED, _above_floor, "wall", looks, lw=1, ms=5)
    below = [row for row in rows[DRIVEN] if _above_floor(row) is None]
    least = {name: (colour, "v") for name, (colour, _) in looks.items()}
    series(middle, below, SPEED, lambda row: FLOOR, "wall", least, ls="none", mfc="white", ms=5, label="_")
    floor(middle, FLOOR)
    middle.set_ylim(FLOOR / 2, None)
    level(middle, 1, "1 %")
    middle.set(xscale="log", yscale="log", xlabel="speed of the blocks [mm/s]", ylabel="peak of λ off by [%]")
    middle.set_yticks(
        [10.0**k for k in range(-4, 5)], ["▿ 0.0001", "0.001", "0.01", "0.1", "1", "10", "100", "1000", "10⁴"]
    )
    for name, (colour, _), aside in zip((W1, *DRY), LOOKS[2:], (-0.2, 0, 0.2), strict=True):
        own, places = [row for row in rows[STEPPED] if row["wall"] == name], np.arange(len(LOADINGS)) + aside
        unit = own[-1]["λ"] if name in DRY else known_wall(name).multiplier  # of the slowest loading, or known
        lower, upper = (100 * (np.array([row[end] for row in own]) / unit - 1) for end in ("λ lower", "λ upper"))
        right.vlines(places, lower, upper, color=colour, lw=5, label=name)
        default = LOADINGS.index(default_loading(name))
        right.annotate("▾", (places[default], upper[default] + 0.3), ha="center", color=colour, fontsize=11)
    right.axhline(0, color="0.3", lw=0.8)
    right.set_xticks(np.arange(len(LOADINGS)), [f"{loading:g}" for loading in LOADINGS])
    right.set(xlabel="first load step in\n[times to rest]; ▾ the suite's", ylabel="bracket of λ off by [%]")
    right.margins(y=0.15)
    right.legend(loc="center right")
    for axes, title in ((left, "ramp; lines: theory"), (middle, "displacement control"), (right, "load steps")):
        axes.set_title(title, fontsize=10)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=9)


STUDY = Study(
    "loading-rate",
    "Loading rate: ramp, displacement control and load steps",
    trusted="load steps at any speed if λ is unique, because each load is held until the wall rests or falls, and at "
    "the suite's speed or slower if λ depends on the history; a ramp only if extrapolated to zero speed, and "
    "a peak under displacement control only below the speeds of the edges",
    beyond="a λ that is too high in a ramp or under displacement control, which no model of the suite uses for λ; "
    "with fast load steps, the λ of an equilibrium that the wall can carry but would not have reached by "
    "itself",
    parts={
        RAMPS: Part(("wall", RATE), [*product(WALLS, RATES)], ramp_row),
        DRIVEN: Part(("wall", "time steps"), [*product(WALLS, PUSHES)], push_row),
        OWN: Part(("wall",), [(W1,)], own_row),
        STEPPED: Part(("wall", LOADED), [*product((W1, *DRY), LOADINGS)], step_row),
    },
    charts=[Chart("λ by the speed of loading: a ramp, a prescribed displacement, load steps", _draw, size=(10, 4.8))],
    fits=fits,
)
