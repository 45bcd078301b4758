"""What every model says of materials, shapes and sizes at the edge of what there is.

Each extreme has an exact answer: a multiplier, a pair of loads between which it lies, or a status. A model may give
it, say that it cannot, or refuse; a number beside it is a wrong answer.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from runningbond.compare.models import MODELS, TOLERANCE
from runningbond.results import Outcome
from runningbond.results.outcome import number
from runningbond.scene import Scene, SceneError, build_scene, scene_from_dict
from runningbond.scene.blocks import CONTACT_TOLERANCE
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
"""Of the joints of all walls that are not scaled."""

UNSEEN = 1e-4
"""Multiplier below which models in motion see no difference from zero."""

SIZES = (1e-6, 1.0, 1e3)
"""Lengths [m] of one and the same wall."""

PRESSED = {"gravity": 9.81, "live": {"kind": "point", "at": [0.24, 0.24], "force": [0.0, -1.0]}}
"""A load on the middle of the top of `panel`."""

WORTH = {
    "right": ("#a6cee3", "right"),
    "estimate": ("#dcdcdc", "estimate, on either side"),
    "refused": ("#f7f7f7", "refused: no closed form"),
    "says so": ("#fdd49e", "no answer, and it says so"),
    "wrong": ("#d7301f", "wrong"),
}
"""What an answer may be worth: its colour, and words for it."""

PART = "Answers"
Exact: TypeAlias = float | tuple[float, float] | str
"""A multiplier, the two loads between which it lies, a status, or ``refused``."""


@dataclass(frozen=True)
class Extreme:
    """A wall at an edge, and what is true of it.

    Parameters
    ----------
    what
        The edge in a few words.
    build
        The wall; it may be refused.
    exact
        What is true.
    """

    what: str
    build: Callable[[], Scene]
    exact: Exact


def panel(**changes: Any) -> Scene:
    """A dry panel of four courses of blocks 240 × 60 mm, 480 mm long, with some keys of its scene changed."""
    return scene_from_dict(_panel(**changes))


def _panel(size: float = 1.0, **changes: Any) -> dict[str, Any]:
    tables: dict[str, Any] = {
        "wall": {
            "block_width": 0.24 * size,
            "block_height": 0.06 * size,
            "thickness": 0.12 * size,
            "length": 0.48 * size,
            "height": 0.24 * size,
        },
        "block": {"density": 1800.0, "young": 2e10, "poisson": 0.2},
        "joint": {"friction": 0.6, "mortar": MORTAR},
        "support": {"kind": "base"},
        "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
    }
    for name, value in changes.items():
        table, _, key = name.partition("__")
        tables[table] = value if not key else {**tables[table], key: value}
    return tables


def pier(width: float, height: float, blocks: int = 1, **joint: float) -> Scene:
    """A pier of equal blocks, which topples at width / height of the whole."""
    return courses([[1]] * blocks, width, height / blocks, **joint)


def courses(pattern: list[list[float]], width: float, height: float, **joint: float) -> Scene:
    """A wall given course by course."""
    tables = _panel(joint={"friction": 0.6, "mortar": MORTAR, **joint})
    tables["wall"] = {"block_width": width, "block_height": height, "thickness": 0.12, "courses": pattern}
    return scene_from_dict(tables)


def piled(*boxes: tuple[float, float, float, float]) -> Scene:
    """Boxes (left, bottom, width, height) [m] on a base, with the materials of `panel`."""
    ours = panel()
    outlines = [np.array([[x, y], [x + w, y], [x + w, y + h], [x, y + h]]) for x, y, w, h in boxes]
    return build_scene("boxes", outlines, thickness=0.12, block=ours.block, joint=ours.joint, load=ours.load)


def gaping(gap: float) -> Scene:
    """A block of 240 × 240 mm that hovers over another by some contact tolerances."""
    return piled((0, 0, 0.24, 0.24), (0, 0.24 * (1 + gap * CONTACT_TOLERANCE), 0.24, 0.24))


def similar(size: float) -> Scene:
    """The panel in another size, stiffness along: displacements, too, are in proportion to its size."""
    stiffness = {"normal_stiffness": 1e11, "shear_stiffness": 4e10}
    block = {"density": 1800.0, "young": 2e10 * size, "poisson": 0.2}
    return panel(size=size, joint={"friction": 0.6, **stiffness}, block=block)


def extremes() -> list[Extreme]:
    """Every wall that is tried."""
    weak = {"cohesion": 1e-3, "fracture_energy_1": 1e-9, "fracture_energy_2": 1e-9}
    brittle = {"cohesion": 1e3, "fracture_energy_1": 0.0, "fracture_energy_2": 0.0}
    sliding = 300.0 / (1800.0 * 9.81 * 0.12)
    return [
        Extreme("tan φ = 0", lambda: panel(joint__friction=0.0), 0.0),
        Extreme("tan φ = 1e-9", lambda: panel(joint__friction=1e-9), "refused"),
        Extreme("tan φ = 1e-6", lambda: panel(joint__friction=1e-6), 1e-6),
        Extreme("tan φ = 1e-3", lambda: panel(joint__friction=1e-3), 1e-3),
        Extreme("tan φ = 3, pier", lambda: pier(0.24, 0.36, 3, friction=3.0), 2 / 3),
        Extreme("tan φ = 1e6, pier", lambda: pier(0.24, 0.36, 3, friction=1e6), 2 / 3),
        Extreme("c, G → 0", lambda: panel(joint={"friction": 0.6, "mortar": MORTAR, **weak}), 0.6),
        Extreme("G = 0, c = 1 kPa", lambda: panel(joint={"friction": 0.6, "mortar": MORTAR, **brittle}), (0.6, 0.836)),
        Extreme("f_t = 0, c = 10 kPa", lambda: pier(0.24, 0.36, 3, cohesion=1e4, tensile_strength=0.0), 2 / 3),
        Extreme(
            "tan φ = f_t = 0, c = 300 Pa",
            lambda: pier(0.24, 0.12, friction=0.0, cohesion=300.0, tensile_strength=0.0),
            sliding,
        ),
        Extreme("locks: pressed", lambda: panel(load=PRESSED), "unbounded"),
        Extreme("locks: one block pinned", _held, "unbounded"),
        Extreme("falls: overhang", lambda: courses([[1], [1, 2]], 0.24, 0.06), "infeasible"),
        Extreme("falls: dry on corners", lambda: panel(support__kind="corners"), "infeasible"),
        Extreme("gap, 0.99 tolerances", lambda: gaping(0.99), 0.5),
        Extreme("gap, 1.01 tolerances", lambda: gaping(1.01), "refused"),
        Extreme("overlap, 0.99 tolerances", lambda: gaping(-0.99), 0.5),
        Extreme("block 1:50", lambda: pier(0.02, 1.0), 0.02),
        Extreme("block 50:1", lambda: pier(1.0, 0.02), 0.6),
        Extreme("small on large, 1:100", lambda: piled((0, 0, 1, 1), (0.495, 1, 0.01, 0.02)), 0.5),
        Extreme("large on small, 100:1", lambda: piled((0.495, 0, 0.01, 0.01), (0, 0.01, 1, 1)), _ON_SMALL),
        Extreme("1 µm wall, same mortar", lambda: panel(size=SIZES[0] / 0.48), 0.6),
        *[Extreme(f"{size:g} m wall, similar", lambda s=size: similar(s / 0.48), 0.6) for size in SIZES],  # type: ignore[misc]
    ]


_ON_SMALL = (0.01 * 0.005 * 0.01 + 1 * 0.005) / (0.01 * 0.01 * 0.005 + 1 * 0.51)
"""λ at which a block of 1 m on one of 10 mm turns with it about the ground: weights and their arms."""


def _held() -> Scene:
    load = {"gravity": 9.81, "live": {"kind": "point", "at": [0.12, 0.06], "force": [1.0, -1.0]}}
    tables = _panel(support={"kind": "pinned-corners"}, load=load)
    tables["wall"] |= {"length": 0.24, "height": 0.06}
    return scene_from_dict(tables)


def answer(what: str, model: str) -> Row:
    """What a model answers about an extreme, what that is worth, and the message or the refusal."""
    exact, build = EXTREMES[what].exact, EXTREMES[what].build
    row: Row = {"exact": _in_words(exact)}
    try:
        outcome = MODELS[model](build(), TOLERANCE)
    except SceneError as error:
        # `homog` refuses what it has no closed form for, and the reader what is no wall.
        value = "right" if exact == "refused" else "refused" if model == "homog" else "wrong"
        return row | {"answer": "refused", "worth": value, "message": str(error)}
    row |= {"answer": _in_short(outcome), "worth": worth(outcome, exact), "λ": outcome.multiplier}
    return row | {"message": outcome.message}


def worth(outcome: Outcome, exact: Exact) -> str:
    """What an outcome is worth beside the exact answer."""
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


def _in_short(outcome: Outcome) -> str:
    if outcome.multiplier is None:
        return outcome.status
    lower, upper = outcome.lower, outcome.upper
    if lower is None or upper is None or upper - lower <= 1e-6 * upper:
        return number(outcome.multiplier)
    return f"{number(lower)}–{number(upper)}"


def _in_words(exact: Exact) -> str:
    if isinstance(exact, str):
        return exact
    return "–".join(map(number, exact)) if isinstance(exact, tuple) else number(exact)


def widest_gap(what: str) -> Row:
    """Gap, in block sizes, at which two blocks begin to be none of one wall."""
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
    """One λ at every size, and what the answers are worth."""
    found = []
    for model in MODELS:
        loads = {row["wall"]: row.get("λ") for row in rows[PART] if row["model"] == model}
        usual = loads[f"{SIZES[1]:g} m wall, similar"]
        for size in (SIZES[0], SIZES[2]):
            load = loads[f"{size:g} m wall, similar"]
            if load is not None and usual is not None:
                found.append(Edge(f"λ of a wall of {size:g} m, of that of 1 m, {model}", load / usual, 1.0, 1e-9))
    count = Counter(row["worth"] for row in rows[PART])
    return found + [Edge(f"answers of {len(rows[PART])}: {WORTH[value][1]}", count[value]) for value in WORTH]


def draw(figure: Figure, rows: Rows) -> None:
    """A map, walls by models, of what the user gets."""
    figure.set_size_inches(10.5, 0.31 * len(EXTREMES) + 1.6)
    axes = figure.add_subplot()
    places = {wall: place for place, wall in enumerate(EXTREMES)}
    for row in rows[PART]:
        at, column = places[row["wall"]], list(MODELS).index(row["model"])
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
    figure.legend(handles=keys, loc="outside lower center", ncols=5, frameon=False, fontsize=8)


EXTREMES = {extreme.what: extreme for extreme in extremes()}
STUDY = Study(
    "material-edges",
    "Materials, shapes and sizes at the edge",
    trusted="no answer is wrong; models in motion see no multiplier below 0.0001, and brackets there are as wide",
    beyond="`undecided` and why, or a refusal that names what is wrong",
    parts={
        PART: Part(("wall", "model"), [(wall, model) for wall in EXTREMES for model in MODELS], answer),
        "widest gap that is contact [block sizes]": Part(("between",), [("two blocks",)], widest_gap),
    },
    charts=[Chart("material-edges", "What every model answers at the edge, beside the exact answer", draw)],
    fits=fits,
)
