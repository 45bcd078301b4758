"""The paper's static solver as published: where its updates of the stiffness cycle, wander or become singular.

Every dry published wall is loaded up to the collapse load of `dem_static`, the robust variant, with each of several
increment sizes. The rows report for each tenth of that load whether the algorithm reached it, or how it ended instead.
A single block has a joint that fails at collapse and not before: the algorithm must carry the block's load up to
collapse, and with the paper's reading of l_c, the whole length of the joint, up to twice that load.
"""

from collections import Counter
from functools import cache
from itertools import product

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from dem.static import dem_static
from dem.stiffness_update import StiffnessUpdate, stiffness_update
from runningbond.compare.published import BARALDI, FERRIS, PUBLISHED, published_scene
from runningbond.pictures.charts import LOOKS as LINES
from runningbond.scene import Scene
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study
from runningbond.studies.walls import one_block

WALLS = tuple(case.name for case in PUBLISHED if case.source in (BARALDI, FERRIS))  # dry: twelve panels, W1 to W3
TENTHS, FINE = 10, 2000  # shares of the collapse load in the rows, and increments to that of a single block
INCREMENTS = (1, 10, 100)  # load steps to the collapse load; 1 means that each tenth is applied at once
ARMS = (0.5, 1.0)  # l_c as a share of the joint's length: exact, and as read in the paper
ARM = "l_c / joint"
CAPTION = f"Each tenth of the collapse load under the published algorithm, {ARM} = {ARMS[0]}"
OUTSIDE = 1e-3  # excess of forces over Eq. 3, relative to the largest force, above which it counts as violated
TOLERANCE = 0.02  # relative width of the bracket of collapse loads

LOOKS = {  # colour, letter and label of the possible results for a tenth of the collapse load
    "converged": ("#bfe3df", "", "converged"),
    "outside": ("#6db8af", "×", "converged, forces break Eq. 3"),
    "cycle": (LINES[2][0], "c", "cycle"),
    "singular": (LINES[3][0], "s", "singular"),
    "wandering": (LINES[0][0], "w", "wandering"),
    "unreached": ("white", "", "given up before"),
}
BLOCKS = {  # width and height [m], exact λ, l_c as a share of the joint, and theoretical capacity in collapse loads
    "topples, l_c half the joint": ((0.5, 2.0), 0.25, 0.5, 1.0),
    "slides, l_c half the joint": ((2.0, 0.5), 0.6, 0.5, 1.0),
    "topples, l_c the whole joint": ((0.5, 2.0), 0.25, 1.0, 2.0),
}
BLOCK, PART = "load borne by one block [collapse load]", "Walls up to their collapse load"
ENDED, BORNE, EXCESS = "ended", "borne [collapse load]", "largest excess over Eq. 3 [largest force]"


def block_row(what: str) -> Row:
    """Capacity of a single block, relative to its collapse load."""
    size, exact, arm, theory = BLOCKS[what]
    result = stiffness_update(one_block(*size, 0.6, 1e11), exact / FINE, 2.5 * exact, arm)
    assert result.multiplier is not None
    return {"measured": result.multiplier / exact, "theory": theory, "allowed": 1e-3}


@cache
def collapse_load(wall: str) -> float:
    """λ of a wall by `dem_static`."""
    outcome = dem_static(published_scene(wall), TOLERANCE)
    assert outcome.lower is not None, outcome.message
    return outcome.lower


def measure(wall: str, arm: float, increments: int) -> Row:
    """Results for each tenth of a wall's collapse load."""
    return {"λ, dem-static": collapse_load(wall), **loaded(published_scene(wall), collapse_load(wall), arm, increments)}


def loaded(scene: Scene, collapse: float, arm: float, increments: int) -> Row:
    """Load a scene up to a load: how it ended, its capacity (−1 if below its weight), and the result of each tenth."""
    if increments == 1:
        loads = collapse * np.arange(1, TENTHS + 1) / TENTHS
        runs = [stiffness_update(scene, load, load, arm) for load in loads]
        fates = [_fate(run, 0, len(run.status)) for run in runs]
    else:
        runs = [stiffness_update(scene, collapse / increments, collapse, arm)]
        each = increments // TENTHS
        # The step with only the dead load belongs to the first tenth.
        fates = [_fate(runs[0], k * each + (k > 0), (k + 1) * each + 1) for k in range(TENTHS)]
    lost = next((k for k, fate in enumerate(fates) if fate not in ("converged", "outside")), TENTHS)
    borne = lost / TENTHS if increments == 1 else (len(runs[0].curve) - 1) / increments
    return {
        ENDED: next((fate for fate in fates if fate in ("cycle", "singular", "wandering")), "converged"),
        BORNE: borne if all(len(run.curve) for run in runs) else -1.0,
        EXCESS: max(float(run.excess.max(initial=0.0)) for run in runs),
        "linear systems": sum(run.solves for run in runs),
        "fates": fates,
    }


def _fate(run: StiffnessUpdate, first: int, end: int) -> str:
    """Result of load steps from `first` on, before `end`; ``outside`` if they converged but violate Eq. 3."""
    ends = run.status[first:end]
    if not ends or ends[-1] != "converged":
        return ends[-1] if ends else "unreached"
    return "outside" if run.excess[first : first + len(ends)].max() > OUTSIDE else "converged"


def fits(rows: Rows) -> list[Edge]:
    """Edges: how runs in steps ended, and the smallest capacity."""
    stepped = [row for row in rows[PART] if row["steps"] > 1]
    nowhere = {row["wall"] for row in stepped if row[BORNE] <= 0}
    least = min(row[BORNE] for row in stepped if row["wall"] not in nowhere)
    ends = Counter(row[ENDED] for row in stepped)
    return [
        Edge("share of the collapse load that every wall bears but those that bear nothing", least),
        Edge(f"walls of {len(WALLS)} that bear nothing", len(nowhere)),
        *(Edge(f"runs of {len(stepped)} in steps that ended: {end}", ends[end]) for end in LOOKS if ends[end]),
        Edge("of them met forces that break Eq. 3", sum(row[EXCESS] > OUTSIDE for row in stepped)),
        Edge(EXCESS, max(row[EXCESS] for row in rows[PART])),
    ]


def _draw(figure: Figure, rows: Rows) -> None:
    for axes, increments in zip(figure.subplots(1, len(INCREMENTS), sharey=True), INCREMENTS, strict=True):
        own = [row for row in rows[PART] if (row["steps"], row[ARM]) == (increments, ARMS[0])]
        for place, row in enumerate(own):
            for k, fate in enumerate(row["fates"]):
                colour, letter, _ = LOOKS[fate]
                edge = "0.85" if fate == "unreached" else "white"
                axes.barh(place, 1 / TENTHS, left=k / TENTHS, height=0.9, color=colour, edgecolor=edge, lw=0.8)
                ink = "white" if fate in ("singular", "wandering") else "black"
                axes.text((k + 0.5) / TENTHS, place, letter, color=ink, ha="center", va="center", fontsize=7)
        axes.set_yticks(range(len(own)), [row["wall"] for row in own], fontsize=8)
        axes.set(xlim=(-0.01, 1.01), ylim=(len(own) - 0.4, -0.6))
        axes.set_xticks((0, 0.5, 1), ("0", "0.5", "1"), fontsize=8)
        axes.set_xlabel("load / collapse load", fontsize=9)
        axes.set_title("each tenth put on at once" if increments == 1 else f"{increments} equal steps", fontsize=9)
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
    met = {fate for row in rows[PART] for fate in row["fates"]}
    looks = [look for fate, look in LOOKS.items() if fate in met]
    names = [f"{label} ({letter})" if letter else label for _, letter, label in looks]
    handles = [Patch(facecolor=x[0], edgecolor="0.7", label=name) for x, name in zip(looks, names, strict=True)]
    figure.legend(handles=handles, loc="outside lower center", ncols=3)


STUDY = Study(
    "stiffness-update",
    "The stiffness update as published, on walls up to their collapse load",
    trusted="on a single block up to its collapse; on no wall",
    beyond="each load step has a status, and a run ends at the first `cycle`, `singular` or `wandering` one; its "
    "curve stops at the last converged load",
    parts={
        BLOCK: Part(("block that",), [*zip(BLOCKS)], block_row),
        PART: Part(("wall", ARM, "steps"), [*product(WALLS, ARMS, INCREMENTS)], measure),
    },
    charts=[Chart(CAPTION, _draw, size=(9, 5))],
    fits=fits,
)
