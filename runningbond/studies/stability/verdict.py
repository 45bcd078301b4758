"""The verdict: how small the unbalanced force of a wall at rest must be, and how far a collapsing wall must have moved.

A wall loaded beyond λ_c is driven by (λ − λ_c) F and remains unbalanced by that force. A rest threshold r, in force
units, therefore accepts it as standing up to

    λ − λ_c = r / w,                                                                                           (4)

where w is the largest unbalanced force of its motion per unit of λ − λ_c (`KnownWall.unbalanced`). Conversely, a wall
that settles or slips a little before it stops is taken for collapsing if the collapse displacement is as small as that.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dem.rigid_system import rigid_system
from runningbond.compare.published import published_scene
from runningbond.dynamics import U_CRIT, Criteria, Run, load_steps, ramp, settle
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.limit import limit_nonassociated
from runningbond.pictures.charts import LOOKS, looks_of
from runningbond.scene import Array
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study, run_around
from runningbond.studies.walls import RAMP, SLIDING, TOPPLING, W1, W2, known_scene, known_wall

SUITE = Criteria(collapse=U_CRIT)
WALLS = (SLIDING, TOPPLING, W1)
WEIGHTLESS = "point-load-4"  # the published wall without weight
REST, FAR, INTERVAL = ("rest [force units]", "u_crit [block sizes]", "steps between looks")
DEFAULT: dict[str, float] = {REST: SUITE.rest, FAR: U_CRIT, INTERVAL: SUITE.interval}
LOOSE = (0.01, 0.03)  # rest thresholds that are loose enough for (4) to show
TINY, LARGE = (1e-16, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6), (1e-4, 1e-3, *LOOSE, 0.1, 0.3)
RESTS = (*TINY, *(x * SUITE.rest for x in (0.5, 1, 2)), *LARGE)
FARS = (1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, *(x * U_CRIT for x in (0.5, 1, 2)), 0.4, 1.6)
FARS_WEIGHTLESS = (1e-3, *(x * U_CRIT for x in (0.5, 1, 2)), 0.4)
INTERVALS = (1, 20, *(int(x * SUITE.interval) for x in (0.5, 1, 2)), 2000)
SWEEPS = {(name, REST): RESTS for name in WALLS}  # values of a criterion by wall, ascending
SWEEPS |= {(W1, FAR): FARS, (W2, FAR): FARS, (WEIGHTLESS, FAR): FARS_WEIGHTLESS, (W1, INTERVAL): INTERVALS}

WIDTH, BUDGET = 0.005, 1_000_000  # relative width of the brackets, and steps after which a load is left undecided
PART, SCALED = "Searches for λ, one criterion changed", "λ / λ known"


def search(name: str, criterion: str, value: float) -> Row:
    """Search for λ with one criterion changed, starting as slowly as the suite does."""
    scene = published_scene(name) if name == WEIGHTLESS else known_scene(name)
    chosen = DEFAULT | {criterion: value}
    run = Run(rigid_system(scene))  # with its own inertia, which the theory of false stability assumes
    first = FIRST_STEP / run.system.measure(run.system.live)
    criteria = Criteria(chosen[FAR] * scene.block_size, chosen[REST], BUDGET, int(chosen[INTERVAL]))
    result = load_steps(run, first, WIDTH, criteria)
    lower, upper, borne, verdict = result.lower, result.upper, result.borne, result.verdict
    if lower is None or upper is None or borne is None or verdict == "undecided":
        infeasible = lower is None and verdict == "collapse"
        return {"answer": "infeasible" if infeasible else "undecided", "λ lower": lower, "λ upper": upper}
    # With a loose rest threshold the suite leaves its bracket as wide as its uncertainty; here its edge is bisected.
    settling = RAMP * result.rests[0][1].steps
    while upper - lower > WIDTH * upper:
        middle, state = (lower + upper) / 2, borne.copy()
        ramp(run, state, lower, middle, settling)
        verdict = settle(run, state, middle, criteria)
        if verdict == "undecided":
            return {"answer": "undecided", "λ lower": lower, "λ upper": upper}
        lower, upper, borne = (middle, upper, state) if verdict == "stable" else (lower, middle, borne)
    middle = (lower + upper) / 2
    row: Row = {"answer": "collapse", "λ lower": lower, "λ upper": upper, "λ": middle}
    if name != WEIGHTLESS:
        row[SCALED] = middle / known_wall(name).multiplier
    if criterion == REST and value in LOOSE:
        row |= {"measured": middle, "theory": believed(name, value), "allowed": WIDTH}
    return row


def believed(name: str, rest: float) -> float:
    """λ up to which a rest threshold accepts a wall as standing, by (4)."""
    wall = known_wall(name)
    return wall.multiplier + rest / wall.unbalanced


def plateau(rows: Sequence[Row]) -> tuple[float, float]:
    """Smallest and largest value of a criterion around the suite's with the same λ, to within the width of brackets."""
    values = [row["value"] for row in rows]
    own = DEFAULT[rows[0]["criterion"]]
    multiplier = rows[values.index(own)]["λ"]
    found = [row for row in rows if row.get("λ") is not None]
    return run_around(own, values, {row["value"] for row in found if abs(row["λ"] - multiplier) <= WIDTH * multiplier})


def sweep(rows: Rows, name: str, criterion: str) -> list[Row]:
    """Rows of one criterion on one wall."""
    return [row for row in rows[PART] if (row["wall"], row["criterion"]) == (name, criterion)]


def fits(rows: Rows) -> list[Edge]:
    """Edges: range of each criterion in which λ is the suite's."""
    edges = []
    for name, criterion in SWEEPS:
        ends = zip(("smallest", "largest"), plateau(sweep(rows, name, criterion)), strict=True)
        edges += [Edge(f"{which} {criterion} that finds the suite's λ, {name}", value) for which, value in ends]
    return edges


def _draw(figure: Figure, rows: Rows) -> None:
    left, right = figure.subplots(1, 2)
    many: Array = np.geomspace(1e-5, 0.3, 60)
    for place, (name, (colour, marker)) in enumerate(looks_of(WALLS).items()):
        _draw_sweep(left, sweep(rows, name, REST), name, colour, marker, 0.91 + 0.02 * place)
        theory = [believed(name, rest) / known_wall(name).multiplier for rest in many]
        left.plot(many, theory, color=colour, lw=1)
    left.set(xscale="log", xlabel="threshold of rest [force units]", ylabel=SCALED, xlim=(2e-17, 1), ylim=(0.9, 1.5))
    left.annotate("?  undecided", (1e-12, 0.945), color="0.4", fontsize=8)
    left.set_title("at rest; lines: λ taken for standing, by theory", fontsize=10)
    looks = dict(zip((W1, W2, WEIGHTLESS), LOOKS[1:4], strict=True))
    for place, (name, (colour, marker)) in enumerate(looks.items()):
        label = f"{name}, no weight" if name == WEIGHTLESS else name
        _draw_sweep(right, sweep(rows, name, FAR), label, colour, marker, 0.73 + 0.02 * place, joined=True)
    certified, unit = limit_nonassociated(published_scene(WEIGHTLESS)), _unit(sweep(rows, WEIGHTLESS, FAR))
    if certified.lower is not None and certified.upper is not None:
        low, high, colour = certified.lower / unit, certified.upper / unit, looks[WEIGHTLESS][0]
        right.errorbar(5, low, [[0], [high - low]], color=colour, lw=1.5, capsize=3)
        right.annotate(f"certified for\n{WEIGHTLESS}", (7, high + 0.005), ha="right", color=colour, fontsize=8)
    right.annotate("×  infeasible\n?  undecided", (2e-6, 0.77), color="0.4", fontsize=8)
    right.set(xscale="log", xlim=(3e-10, 8), ylim=(0.6, 1.1), xlabel="displacement of a collapse [block sizes]")
    right.set_ylabel("λ / λ known (without weight: / the suite's)")
    right.set_title("fallen", fontsize=10)
    for axes in (left, right):
        axes.plot([], [], "o", ms=11, mfc="none", mec="0.3", label="the suite's")
        axes.legend(loc="upper left")


def _unit(rows: Sequence[Row]) -> float:
    """The known λ, or else λ for the suite's own value."""
    own = next(row for row in rows if row["value"] == DEFAULT[row["criterion"]])
    return float(own["λ"] / own.get(SCALED, 1.0))


def _draw_sweep(
    axes: Axes, rows: Sequence[Row], label: str, colour: str, marker: str, bottom: float, *, joined: bool = False
) -> None:
    """Plot the middles of a sweep's brackets, narrower than the marks; values without an answer are at the bottom."""
    drawn = {row["value"]: row["λ"] / _unit(rows) for row in rows if row.get("λ") is not None}
    line = "-" if joined else "none"
    axes.plot([*drawn], [*drawn.values()], marker, ls=line, lw=0.8, ms=5, color=colour, label=label)
    for row in rows:
        if row["value"] not in drawn:
            mark = "?" if row["answer"] == "undecided" else "×"
            axes.annotate(mark, (row["value"], bottom), color=colour, ha="center")
    suite = DEFAULT[rows[0]["criterion"]]
    axes.plot(suite, drawn[suite], "o", ms=11, mfc="none", mec=colour)


STUDY = Study(
    "verdict",
    "Verdict: when a wall is at rest, and when it has fallen",
    trusted="λ is the same over decades of each criterion, and the suite's values lie inside",
    beyond="a rest threshold that is too loose gives a λ too high by (4), one below rounding `undecided`; a u_crit "
    "that is too small gives a λ too low for a wall without weight, or `infeasible` if it does not even allow"
    " the settlement under the weight; one that is too large costs steps, and finally ends `undecided`",
    parts={PART: Part(("wall", "criterion", "value"), [(*x, y) for x, ys in SWEEPS.items() for y in ys], search)},
    charts=[Chart("λ by the threshold of rest and by the displacement that counts as a collapse", _draw, size=(10, 5))],
    fits=fits,
)
