"""Answers of every model for materials, shapes and sizes at the limits of what is possible.

Each extreme has an exact answer: a multiplier, two loads between which it lies, or a status. A model may return that
answer, report that it cannot, or refuse the scene; any other number is wrong.
"""

from collections import Counter
from collections.abc import Callable
from itertools import product
from typing import Any, TypeAlias

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from runningbond.models import MODELS, TOLERANCE
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene, SceneError, scene_from_dict
from runningbond.scene.blocks import CONTACT_TOLERANCE
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study
from runningbond.studies.walls import TABLES, Box, boxes

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
UNSEEN = 1e-4  # multiplier below which dynamic models cannot distinguish it from zero
SIZES = (1e-6, 1.0, 1e3)  # lengths [m] of the same wall
PART = "Answers"
Exact: TypeAlias = float | tuple[float, float] | str  # λ, two loads between which λ lies, a status, or ``refused``
WORTH = {  # ratings of an answer: colour and label
    "right": ("#8fbcd8", "right"),
    "estimate": ("#dcdcdc", "estimate, on either side"),
    "refused": ("#f7f7f7", "refused: no closed form"),
    "says so": ("#cf8733", "no answer, and it says so"),
    "wrong": ("#a11c12", "wrong"),
}


def dry(**changes: Any) -> dict[str, Any]:
    """The table of a joint with tan φ = 0.6 and 10 mm of mortar, with some of its keys changed."""
    return TABLES["joint"] | changes


def panel(size: float = 1.0, **tables: Any) -> Scene:
    """A panel of four courses of blocks 240 × 60 mm, 480 mm long times `size`, with other tables of its scene."""
    lengths = {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12, "length": 0.48, "height": 0.24}
    wall = {name: length * size for name, length in lengths.items()}
    return scene_from_dict(TABLES | {"wall": wall} | tables)


def courses(pattern: list[list[float]], width: float, height: float, **joint: float) -> Scene:
    """A wall given course by course."""
    wall = {"block_width": width, "block_height": height, "thickness": 0.12, "courses": pattern}
    return panel(wall=wall, joint=dry(**joint))


def pier(width: float, height: float, blocks: int = 1, **joint: float) -> Scene:
    """A pier of equal blocks, which topples at λ = width / height of the whole."""
    return courses([[1]] * blocks, width, height / blocks, **joint)


def piled(*piles: Box) -> Scene:
    """Boxes on a base, with the materials of `panel`."""
    return boxes(*piles, joint=panel().joint, block=panel().block)


def gaping(gap: float) -> Scene:
    """A block of 240 × 240 mm above another, with a gap in contact tolerances, negative for an overlap."""
    return piled((0, 0, 0.24, 0.24), (0, 0.24 * (1 + gap * CONTACT_TOLERANCE), 0.24, 0.24))


def pressed(x: float, force: list[float], **tables: Any) -> Scene:
    """The panel, or another wall, under a point force on its top."""
    at = [x, 0.06 if "wall" in tables else 0.24]
    return panel(load={"gravity": 9.81, "live": {"kind": "point", "at": at, "force": force}}, **tables)


def similar(size: float) -> Scene:
    """The panel in another size, Young's modulus of its blocks in proportion, so that displacements are, too."""
    joint = {"friction": 0.6, "normal_stiffness": 1e11, "shear_stiffness": 4e10}
    return panel(size, joint=joint, block={"density": 1800.0, "young": 2e10 * size, "poisson": 0.2})


BRICK = {"block_width": 0.24, "block_height": 0.06, "thickness": 0.12, "length": 0.24, "height": 0.06}
PINNED = {"wall": BRICK, "support": {"kind": "pinned-corners"}}
BRITTLE = {"fracture_energy_1": 0.0, "fracture_energy_2": 0.0}
GLUED = {"friction": 0.0, "cohesion": 300.0, "tensile_strength": 0.0}
# λ at which a 1 m block on a 10 mm block overturns with it about the ground: weights times lever arms
ON_SMALL = (0.01 * 0.005 * 0.01 + 1 * 0.005) / (0.01 * 0.01 * 0.005 + 1 * 0.51)
EXTREMES: dict[str, tuple[Callable[[], Scene], Exact]] = {  # walls, which may be refused, and their exact answers
    "tan φ = 0": (lambda: panel(joint=dry(friction=0.0)), 0.0),
    "tan φ = 10⁻⁹": (lambda: panel(joint=dry(friction=1e-9)), "refused"),
    "tan φ = 10⁻⁶": (lambda: panel(joint=dry(friction=1e-6)), 1e-6),
    "tan φ = 0.001": (lambda: panel(joint=dry(friction=1e-3)), 1e-3),
    "tan φ = 3, pier": (lambda: pier(0.24, 0.36, 3, friction=3.0), 2 / 3),
    "tan φ = 10⁶, pier": (lambda: pier(0.24, 0.36, 3, friction=1e6), 2 / 3),
    "c, G → 0": (lambda: panel(joint=dry(cohesion=1e-3, fracture_energy_1=1e-9, fracture_energy_2=1e-9)), 0.6),
    "G = 0, c = 1 kPa": (lambda: panel(joint=dry(cohesion=1e3, **BRITTLE)), (0.6, 0.836)),
    "fₜ = 0, c = 10 kPa": (lambda: pier(0.24, 0.36, 3, cohesion=1e4, tensile_strength=0.0), 2 / 3),
    "tan φ = fₜ = 0, c = 300 Pa": (lambda: pier(0.24, 0.12, 1, **GLUED), 300.0 / (1800.0 * 9.81 * 0.12)),
    "self-locking: pressed": (lambda: pressed(0.24, [0.0, -1.0]), "unbounded"),
    "self-locking: one block pinned": (lambda: pressed(0.12, [1.0, -1.0], **PINNED), "unbounded"),
    "no equilibrium: overhang": (lambda: courses([[1], [1, 2]], 0.24, 0.06), "infeasible"),
    "no equilibrium: dry on corners": (lambda: panel(support={"kind": "corners"}), "infeasible"),
    "gap, 0.99 tolerances": (lambda: gaping(0.99), 0.5),
    "gap, 1.01 tolerances": (lambda: gaping(1.01), "refused"),
    "overlap, 0.99 tolerances": (lambda: gaping(-0.99), 0.5),
    "block 1:50": (lambda: pier(0.02, 1.0), 0.02),
    "block 50:1": (lambda: pier(1.0, 0.02), 0.6),
    "small on large, 1:100": (lambda: piled((0, 0, 1, 1), (0.495, 1, 0.01, 0.02)), 0.5),
    "large on small, 100:1": (lambda: piled((0.495, 0, 0.01, 0.01), (0, 0.01, 1, 1)), ON_SMALL),
    "1 µm wall, same mortar": (lambda: panel(SIZES[0] / 0.48), 0.6),
    "1 µm wall, similar": (lambda: similar(SIZES[0] / 0.48), 0.6),
    "1 m wall, similar": (lambda: similar(SIZES[1] / 0.48), 0.6),
    "1000 m wall, similar": (lambda: similar(SIZES[2] / 0.48), 0.6),
}


def answer(what: str, model: str) -> Row:
    """Answer of a model for an extreme, its rating, and the message or the refusal."""
    build, exact = EXTREMES[what]
    row: Row = {"exact": in_words(exact)}
    try:
        outcome = MODELS[model].solve(build(), TOLERANCE)
    except SceneError as error:
        # `homog` refuses scenes without a closed form, and the reader refuses what is not a wall.
        value = "right" if exact == "refused" else "refused" if model == "homog" else "wrong"
        return row | {"answer": "refused", "worth": value, "message": str(error)}
    said: Exact = outcome.status if outcome.multiplier is None else outcome.multiplier
    lower, upper = outcome.lower, outcome.upper
    if said != outcome.status and lower is not None and upper is not None and upper - lower > 1e-6 * upper:
        said = lower, upper
    row |= {"answer": in_words(said), "worth": worth(outcome, exact), "λ": outcome.multiplier}
    return row | {"message": outcome.message}


def in_words(exact: Exact) -> str:
    """An answer as text in a chart: an interval from zero as its upper bound, one with equal ends as a number."""
    if isinstance(exact, str):
        return exact
    ends = list(dict.fromkeys(_plain(x) for x in (exact if isinstance(exact, tuple) else (exact,))))
    return f"≤ {ends[1]}" if len(ends) > 1 and ends[0] == "0" else " – ".join(ends)


def _plain(value: float) -> str:
    """A multiplier as text, with powers of ten instead of e-notation."""
    if value == 0 or value >= 1e-4:
        return number(value) if value else "0"
    mantissa, power = f"{value:.2g}".split("e")
    return ("" if mantissa == "1" else f"{mantissa} × ") + "10" + str(int(power)).translate(RAISED)


def worth(outcome: Outcome, exact: Exact) -> str:
    """Rating of an outcome against the exact answer."""
    if outcome.status in ("undecided", "failed"):
        return "says so"
    if isinstance(exact, str):
        return "right" if outcome.status == exact else "wrong"
    if outcome.status != "collapse" or outcome.multiplier is None:
        return "wrong"
    if outcome.model == "homog":
        return "estimate"
    low, high = exact if isinstance(exact, tuple) else (exact, exact)
    lower = outcome.multiplier if outcome.lower is None else outcome.lower
    upper = outcome.multiplier if outcome.upper is None else outcome.upper
    slack = max(TOLERANCE * high / 2, UNSEEN / 10)
    return "right" if lower <= high + slack and upper >= low - slack and upper - lower < high + 2 * UNSEEN else "wrong"


def widest_gap(what: str) -> Row:
    """Largest gap, in block sizes, at which two blocks are still in contact."""
    low, high = 0.5, 2.0
    while high - low > 1e-6:
        middle = (low + high) / 2
        try:
            gaping(middle)
            low = middle
        except SceneError:
            high = middle
    return {"measured": low * CONTACT_TOLERANCE, "theory": CONTACT_TOLERANCE, "allowed": 1e-3}


def fits(rows: Rows) -> list[Edge]:
    """Edges: λ is equal at every size, and the number of answers by rating, of which none may be wrong."""
    edges = []
    for model in MODELS:
        loads = {row["wall"]: row.get("λ") for row in rows[PART] if row["model"] == model}
        usual = loads["1 m wall, similar"]
        for size in ("1 µm", "1000 m"):
            load = loads[f"{size} wall, similar"]
            if load is not None and usual is not None:
                edges.append(Edge(f"λ of a wall of {size}, of that of 1 m, {model}", load / usual, 1.0, 1e-9))
    count = Counter(row["worth"] for row in rows[PART])
    none = {"wrong": (0.0, 0.0)}
    for value, (_, what) in WORTH.items():
        edges.append(Edge(f"answers of {len(rows[PART])}: {what}", count[value], *none.get(value, ())))
    return edges


def _draw(figure: Figure, rows: Rows) -> None:
    axes = figure.add_subplot()
    for row in rows[PART]:
        at, column = list(EXTREMES).index(row["wall"]), list(MODELS).index(row["model"])
        axes.add_patch(Rectangle((column, at), 1, 1, facecolor=WORTH[row["worth"]][0], edgecolor="white", lw=1.5))
        colour = "white" if row["worth"] == "wrong" else "0.15"
        axes.text(column + 0.5, at + 0.5, row["answer"], ha="center", va="center", fontsize=7.5, color=colour)
        if column == 0:
            axes.text(len(MODELS) + 0.05, at + 0.5, row["exact"], va="center", fontsize=8)
    axes.text(len(MODELS) + 0.05, -0.45, "exact", va="center", fontsize=9, weight="bold")
    axes.set_xticks(np.arange(len(MODELS)) + 0.5, list(MODELS))
    axes.set_yticks(np.arange(len(EXTREMES)) + 0.5, list(EXTREMES), fontsize=8)
    axes.set(xlim=(0, len(MODELS) + 0.75), ylim=(len(EXTREMES), 0))
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    keys = [Rectangle((0, 0), 1, 1, facecolor=colour, edgecolor="0.6", label=label) for colour, label in WORTH.values()]
    figure.legend(handles=keys, loc="outside lower center", ncols=5)


SIZE = 10.5, 0.31 * len(EXTREMES) + 1.6  # of the chart [in]
STUDY = Study(
    "material-edges",
    "Materials, shapes and sizes at the edge",
    trusted="no answer is wrong; dynamic models resolve no multiplier below 0.0001, and brackets there are as wide",
    beyond="`undecided` with the reason, or a refusal that names what is wrong",
    parts={
        PART: Part(("wall", "model"), [*product(EXTREMES, MODELS)], answer),
        "widest gap that is contact [block sizes]": Part(("between",), [("two blocks",)], widest_gap),
    },
    charts=[Chart("What every model answers at the edge, beside the exact answer", _draw, size=SIZE)],
    fits=fits,
)
