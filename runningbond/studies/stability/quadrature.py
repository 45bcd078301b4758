"""Quadrature and mesh of the joints: the error due to interior points, and how much of it a finer mesh removes.

A block of width b on n elements rocks about the outermost point of its joint, which for a rule on [−1, 1] with first
node x lies (1 + x) b / (2 n) inside its edge. It therefore topples at

    λ = (b / h) (1 − (1 + x) / n):                                                                           (1)

42, 21 and 11 % too early on 1, 2 and 4 elements with two Gauss points, and never too early with points at the ends. The
same holds for each joint of a wall: interior points are contacts with an inset of the same size, and W1 collapses where
`dem_static`, which has its points at the ends of the joints, collapses with that inset. Blocks are rigid here, and the
mesh is that of their joints; in `benchmarks/studies/fem_study.py` they deform, which at 1000 GPa does not change the
brackets.
"""

from functools import cache
from itertools import product

from matplotlib.figure import Figure

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from fem_interface.model import fem
from runningbond.compare.published import published_scene
from runningbond.joints import Rule, gauss, lobatto
from runningbond.pictures.charts import looks_of
from runningbond.results import Outcome
from runningbond.scene import Scene
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study
from runningbond.studies.walls import inset_wall, one_block

RULES = {"Gauss 2": gauss(2), "Gauss 3": gauss(3), "Lobatto 2": lobatto(), "Simpson": lobatto(3)}
CELLS = (1, 2, 4)  # cells per half block along the course, and over its height: elements of the joint of half a block
WIDTH, HEIGHT = 0.5, 1.0  # of the block [m]
TIGHT, USUAL = 5e-4, 5e-3  # relative width of the brackets, for the block and for walls
SCENES = {"block": "block on n elements", "W1": "W1, inset 20 mm", "panel-04": "panel-04"}
PART, ENDS, EARLY = "λ", "with points at the ends", "of that with points at the ends"


def scene_of(name: str) -> Scene:
    """A scene of `SCENES`."""
    if name == "block":
        return one_block(WIDTH, HEIGHT, 2.0, 1e10)
    return inset_wall("wall-w1") if name == "W1" else published_scene(name)


@cache
def with_points_at_the_ends(name: str) -> float:
    """λ of a scene with points at the ends of its joints: exact for the block, from `dem_dynamic` for walls."""
    return WIDTH / HEIGHT if name == "block" else _middle(dem_dynamic(scene_of(name), USUAL))


def measure(name: str, rule: str, cells: int) -> Row:
    """λ of a scene for one rule and mesh, beside theory: (1) for the block, an equivalent inset for W1."""
    scene, reference = scene_of(name), with_points_at_the_ends(name)
    outcome = fem(scene, TIGHT if name == "block" else USUAL, cells=cells, modes=3, rule=RULES[rule])
    result = _middle(outcome)
    row: Row = {"λ lower": outcome.lower, "λ upper": outcome.upper, ENDS: reference, EARLY: result / reference}
    if name == "block":
        theory = reference * (1 - float(1 + RULES[rule].nodes[0]) / cells)
        row |= {"measured": result, "theory": theory, "allowed": 1e-3}
    elif name == "W1":
        inset = inset_of(scene, RULES[rule], cells)
        theory = _middle(dem_static(scene.with_joint(inset=inset)))
        row |= {"measured": result, "theory": theory, "allowed": USUAL}
    return row


def inset_of(scene: Scene, rule: Rule, cells: int) -> float:
    """Distance of the outermost point from the end of a half-block bed joint [m]; rules start at the inset."""
    assert scene.bond is not None
    element = scene.bond.width / 2 / cells - (2 if cells == 1 else 1) * scene.joint.inset
    return float(scene.joint.inset + (1 + rule.nodes[0]) / 2 * element)


def _middle(outcome: Outcome) -> float:
    assert outcome.lower is not None, outcome.message
    assert outcome.upper is not None, outcome.message
    return (outcome.lower + outcome.upper) / 2


def fits(rows: Rows) -> list[Edge]:
    """Edges: largest deviation of λ, with points at the ends and with interior points."""
    off: dict[str, float] = {}
    for row in rows[PART]:
        mesh = "one cell" if row["cells"] == 1 else "two cells in half a block or more"
        kind = "Gauss points" if row["rule"].startswith("Gauss") else f"points at the ends, {mesh}"
        off[kind] = max(off.get(kind, 0.0), 100 * abs(row[EARLY] - 1))
    return [Edge(f"λ off by at most [%], {kind}", most) for kind, most in off.items()]


def _draw(figure: Figure, rows: Rows) -> None:
    looks = looks_of(list(RULES)[::-1])
    for axes, (name, title) in zip(figure.subplots(1, len(SCENES), sharey=True), SCENES.items(), strict=True):
        for place, rule in enumerate(RULES):
            own = [row for row in rows[PART] if (row["scene"], row["rule"]) == (name, rule)]
            at = [CELLS.index(row["cells"]) + 0.12 * (place - 1.5) for row in own]
            (colour, marker), label = looks[rule], rule if name == "block" else None
            axes.plot(at, [row[EARLY] for row in own], marker, color=colour, ms=6, mfc="none", mew=1.6, label=label)
            if all(row.get("theory") for row in own):
                axes.plot(at, [row["theory"] / row[ENDS] for row in own], ":", color=colour, lw=1.2, zorder=0)
        axes.axhline(1.0, color="0.7", lw=0.8, zorder=0)
        axes.set_title(title, fontsize=9)
        axes.set_xticks(range(len(CELLS)), [str(n) for n in CELLS])
        axes.set(xlim=(-0.4, len(CELLS) - 0.6), ylim=(0.5, 1.1))
        axes.set_xlabel("cells in half a block n", fontsize=9)
    figure.axes[0].set_ylabel("λ / λ with points at the ends")
    figure.axes[0].plot([], [], ":", color="0.3", label="theory")
    figure.legend(loc="outside lower center", ncols=5, fontsize="medium")


USED = ("Gauss 2", "Lobatto 2", "Simpson")
CASES = [*product(["block"], RULES, CELLS), *product(["W1"], USED, CELLS), *product(["panel-04"], USED, CELLS[:2])]
STUDY = Study(
    "quadrature",
    "Quadrature and mesh of the joints",
    trusted="Lobatto and Simpson, with points at the ends of the joints, on two or more cells per half block; with "
    "Gauss points blocks and walls fall early, a block with an error proportional to 1 / n for n elements per"
    " joint",
    beyond="no warning: every rule ends in `collapse` with a bracket as narrow; Lobatto is the default of every "
    "model, and no scene or command can select another",
    parts={PART: Part(("scene", "rule", "cells"), CASES, measure)},
    charts=[Chart("λ by rule and mesh, over λ with points at the ends of the joints", _draw, size=(8, 4.8))],
    fits=fits,
)
