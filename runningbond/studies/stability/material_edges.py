"""What every model says of materials, shapes and sizes at the edge of what there is.

Each extreme has an exact answer: a multiplier, a pair of loads between which it lies, or a status. A model may give
it, say that it cannot, or refuse; a number beside it is a wrong answer.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from runningbond.compare.models import MODELS, TOLERANCE
from runningbond.results import Outcome, Status
from runningbond.results.outcome import number
from runningbond.scene import Scene, SceneError, build_scene, scene_from_dict
from runningbond.scene.blocks import CONTACT_TOLERANCE

from .finding import Edge, Finding

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
"""Of the joints of all walls that are not scaled."""

UNSEEN = 1e-4
"""Multiplier below which models in motion see no difference from zero."""

SIZES = (1e-6, 1.0, 1e3)
"""Lengths [m] of one and the same wall."""

PRESSED = {"gravity": 9.81, "live": {"kind": "point", "at": [0.24, 0.24], "force": [0.0, -1.0]}}
"""A load on the middle of the top of `panel`."""

COLOURS = {
    "right": "#a6cee3",
    "estimate": "#dcdcdc",
    "refused": "#f7f7f7",
    "says so": "#fdd49e",
    "wrong": "#d7301f",
}
"""What an answer is worth, and its colour."""


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
        The multiplier, the two loads between which it lies, the status, or ``refused``.
    """

    what: str
    build: Callable[[], Scene]
    exact: float | tuple[float, float] | Status | str


@dataclass(frozen=True)
class Answer:
    """What a user gets: the outcome in short, what it is worth, and the message or the refusal."""

    said: str
    worth: str
    message: str


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


def answer(extreme: Extreme, model: str) -> tuple[Answer, Outcome | None]:
    """Ask a model about an extreme."""
    try:
        outcome = MODELS[model].solve(extreme.build(), TOLERANCE)
    except SceneError as error:
        # `homog` refuses what it has no closed form for, and the reader what is no wall.
        right = extreme.exact == "refused"
        return Answer("refused", "right" if right else "refused" if model == "homog" else "wrong", str(error)), None
    return Answer(_in_short(outcome), worth(outcome, extreme.exact), outcome.message), outcome


def worth(outcome: Outcome, exact: float | tuple[float, float] | str) -> str:
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


def experiment() -> Finding:
    """Ask every model about every extreme."""
    walls = extremes()
    table = {(wall.what, model): answer(wall, model) for wall in walls for model in MODELS}
    answers = {key: short for key, (short, _) in table.items()}
    rows = [
        (wall.what, _exact(wall.exact), model, answers[wall.what, model].said, answers[wall.what, model].worth,
         answers[wall.what, model].message)
        for wall in walls
        for model in MODELS
    ]  # fmt: skip
    edges = [Edge("widest gap that is contact, in block sizes", _widest_gap(), CONTACT_TOLERANCE, 1e-3)]
    for model in MODELS:
        found = [table[f"{size:g} m wall, similar", model][1] for size in SIZES]
        loads = [outcome.multiplier for outcome in found if outcome is not None and outcome.multiplier is not None]
        for size, load in zip(SIZES, loads, strict=False):
            if size != 1.0:
                edges.append(Edge(f"λ of a wall of {size:g} m, of that of 1 m, {model}", load / loads[1], 1.0, 1e-9))
    count = {value: sum(short.worth == value for short in answers.values()) for value in COLOURS}
    wrong = [f"{what} ({model})" for (what, model), short in answers.items() if short.worth == "wrong"]
    missed = f": {', '.join(wrong)}" if wrong else ""
    silent = [f"{what} ({model})" for (what, model), short in answers.items() if short.worth == "says so"]
    unanswered = f"; no answer, and why, to {', '.join(silent)}" if silent else ""
    told = sorted({short.message for short in answers.values() if short.worth == "says so"})
    return Finding(
        title="Materials, shapes and sizes at the edge",
        heads=("wall", "exact", "model", "answer", "worth", "message"),
        rows=rows,
        edges=edges,
        trust=f"{count['right']} of {len(answers)} answers are right, {count['wrong']} wrong{missed}. Models in motion "
        f"see no multiplier below {UNSEEN:g}, and brackets there are as wide{unanswered}.",
        beyond="; ".join(told) or "nothing: every model answers",
        draw=lambda figure: _draw(
            figure, [wall.what for wall in walls], [_exact(wall.exact) for wall in walls], answers
        ),
    )


def _exact(exact: float | tuple[float, float] | str) -> str:
    if isinstance(exact, str):
        return exact
    return "–".join(map(number, exact)) if isinstance(exact, tuple) else number(exact)


def _widest_gap() -> float:
    """Gap, in block sizes, at which two blocks begin to be none of one wall."""
    low, high = 0.5, 2.0
    while high - low > 1e-6:
        middle = (low + high) / 2
        try:
            gaping(middle)
            low = middle
        except SceneError:
            high = middle
    return low * CONTACT_TOLERANCE


def _draw(figure: Figure, walls: Sequence[str], exact: Sequence[str], answers: dict[tuple[str, str], Answer]) -> None:
    """A map, walls by models, of what the user gets."""
    figure.set_size_inches(10.5, 0.31 * len(walls) + 1.4)
    figure.set_layout_engine("constrained")
    axes = figure.add_subplot()
    for row, wall in enumerate(walls):
        for column, model in enumerate(MODELS):
            short = answers[wall, model]
            axes.add_patch(Rectangle((column, row), 1, 1, facecolor=COLOURS[short.worth], edgecolor="white", lw=1.5))
            colour = "white" if short.worth == "wrong" else "0.15"
            axes.text(column + 0.5, row + 0.5, short.said, ha="center", va="center", fontsize=7.5, color=colour)
        axes.text(len(MODELS) + 0.05, row + 0.5, exact[row], va="center", fontsize=8)
    axes.text(len(MODELS) + 0.05, -0.45, "exact", va="center", fontsize=9, weight="bold")
    axes.set_xticks(np.arange(len(MODELS)) + 0.5, list(MODELS))
    axes.set_yticks(np.arange(len(walls)) + 0.5, list(walls), fontsize=8)
    axes.set(xlim=(0, len(MODELS) + 0.75), ylim=(len(walls), 0))
    axes.xaxis.tick_top()
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    keys = [Rectangle((0, 0), 1, 1, facecolor=colour, edgecolor="0.6") for colour in COLOURS.values()]
    labels = ["right", "estimate, on either side", "refused: no closed form", "no answer, and it says so", "wrong"]
    figure.legend(keys, labels, loc="outside lower center", ncols=5, frameon=False, fontsize=8)
