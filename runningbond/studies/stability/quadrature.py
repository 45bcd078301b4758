"""Quadrature and mesh of the joints: what points inside them cost, and what a finer mesh gives back.

A block of width b on n elements rocks about the outermost point of its joint, which for a rule on [−1, 1] with first
node x lies (1 + x) b / (2 n) in from its edge; so it topples at

    λ = (b / h) (1 − (1 + x) / n):                                                                           (1)

42, 21 and 11 % early on 1, 2 and 4 elements with two Gauss points, never with points at the ends. A wall's joints do
the same one by one: points that far in are contacts with as large an inset, so that W1 falls where `dem_static`, which
has its points at the ends of the joints, has it with that inset. Blocks are rigid here, and the mesh is that of their
joints; `benchmarks/studies/fem_study.py` lets them deform, which at 1000 GPa leaves the brackets as they are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dem.dynamic import dem_dynamic
from dem.static import dem_static
from fem_interface.model import fem
from runningbond.compare.figures import COLOURS, bare
from runningbond.compare.published import published_scene
from runningbond.joints import Rule, gauss, lobatto
from runningbond.results import Outcome
from runningbond.scene import Scene

from .blocks import INSET, one_block, rounded
from .finding import Edge, Finding

RULES = {"Gauss 2": gauss(2), "Gauss 3": gauss(3), "Lobatto 2": lobatto(), "Simpson": lobatto(3)}
"""Rules by name."""

MARKS = dict(zip(RULES, zip(COLOURS[::-1], "soD^", strict=True), strict=True))
"""Colour and marker of each rule."""

CELLS = (1, 2, 4)
"""Cells in half a block along the course, and in its height: elements of the joint of half a block."""

WIDTH, HEIGHT = 0.5, 1.0
"""Of the block [m]."""

TIGHT, USUAL = 5e-4, 5e-3
"""Relative width of the brackets, of the block and of walls."""


@dataclass(frozen=True)
class Case:
    """What is asked of a scene with one rule on one mesh.

    Parameters
    ----------
    scene
        Name of the scene.
    rule, cells
        Name of the rule, and the mesh.
    lower, upper
        Bracket of λ.
    reference
        λ with points at the ends of the joints: exact, or `dem_dynamic`'s.
    theory
        λ by theory; None where there is none.
    """

    scene: str
    rule: str
    cells: int
    lower: float
    upper: float
    reference: float
    theory: float | None = None

    @property
    def multiplier(self) -> float:
        """The middle of the bracket."""
        return (self.lower + self.upper) / 2


def block_case(rule: str, cells: int) -> Case:
    """Topple a rigid block whose joint has as many elements as there are `cells`."""
    exact = WIDTH / HEIGHT
    outcome = fem(one_block(WIDTH, HEIGHT, 2.0, 1e10), TIGHT, cells=cells, modes=3, rule=RULES[rule])
    return Case("block", rule, cells, *_bracket(outcome), exact, exact * (1 - float(1 + RULES[rule].nodes[0]) / cells))


def wall_cases(name: str, scene: Scene, wanted: Sequence[tuple[str, int]]) -> list[Case]:
    """Push a wall with some rules on some meshes, and with rigid blocks as `dem_dynamic` has them."""
    rigid = sum(_bracket(dem_dynamic(scene, USUAL))) / 2
    return [
        Case(name, rule, cells, *_bracket(fem(scene, USUAL, cells=cells, modes=3, rule=RULES[rule])), rigid)
        for rule, cells in wanted
    ]


def with_theory(case: Case, scene: Scene) -> Case:
    """A wall's case beside `dem_static` with an inset as large as that of its outermost points.

    Parameters
    ----------
    case
        The case.
    scene
        Its wall, whose bed joints are all of half blocks.
    """
    assert scene.bond is not None
    found = dem_static(replace(scene, joint=replace(scene.joint, inset=inset_of(scene, RULES[case.rule], case.cells))))
    return replace(case, theory=sum(_bracket(found)) / 2)


def inset_of(scene: Scene, rule: Rule, cells: int) -> float:
    """Distance of the outermost point from the end of a bed joint of half a block [m]; rules begin at the inset."""
    assert scene.bond is not None
    ends = 2 if cells == 1 else 1
    element = scene.bond.width / 2 / cells - ends * scene.joint.inset
    return float(scene.joint.inset + (1 + rule.nodes[0]) / 2 * element)


def _bracket(outcome: Outcome) -> tuple[float, float]:
    assert outcome.lower is not None, outcome.message
    assert outcome.upper is not None, outcome.message
    return outcome.lower, outcome.upper


def edges(cases: Sequence[Case]) -> list[Edge]:
    """Where blocks and walls fall, beside theory."""
    return [
        Edge(
            f"λ of {case.scene}, {case.rule}, {case.cells} cells in half a block",
            case.multiplier,
            case.theory,
            1e-3 if case.scene == "block" else USUAL,
        )
        for case in cases
        if case.theory is not None
    ]


def experiment() -> Finding:
    """Topple a block, W1 and an upright panel with every rule on coarse and on fine meshes."""
    block = [block_case(rule, cells) for rule in RULES for cells in CELLS]
    w1 = rounded("wall-w1")
    kinds = [(rule, cells) for rule in ("Gauss 2", "Lobatto 2", "Simpson") for cells in CELLS]
    w1_cases = [with_theory(case, w1) for case in wall_cases("W1", w1, kinds)]
    panel = published_scene("panel-04")
    panel_cases = wall_cases("panel-04", panel, [case for case in kinds if case[1] < max(CELLS)])
    cases = [*block, *w1_cases, *panel_cases]
    inner = [case for case in cases if case.rule.startswith("Gauss")]
    outer = [case for case in cases if not case.rule.startswith("Gauss")]
    off = {
        kind: max(abs(case.multiplier / case.reference - 1) for case in chosen)
        for kind, chosen in (
            ("coarse", [case for case in outer if case.cells == 1]),
            ("fine", [case for case in outer if case.cells > 1]),
            ("gauss", inner),
        )
    }
    return Finding(
        "Quadrature and mesh of the joints",
        ("scene", "rule", "cells in half a block", "λ, lower", "λ, upper", "λ, theory", "to points at the ends [%]"),
        [_row(case) for case in cases],
        edges(cases),
        f"Lobatto and Simpson have points at the ends of the joints: λ to {100 * off['fine']:.1f} % with two cells in "
        f"half a block or more, to {100 * off['coarse']:.1f} % with one. Gauss points lie inside: blocks and walls "
        f"fall up to {100 * off['gauss']:.0f} % early, a block by an error that goes as 1 / n with n elements a joint.",
        "Nothing in the outcome tells that a rule has no points at the ends: every one ends in collapse, its bracket "
        "as narrow. Lobatto is the default of every model, and no scene or command can ask for another.",
        lambda figure: draw(figure, cases),
    )


def _row(case: Case) -> tuple[str | float, ...]:
    theory = "–" if case.theory is None else case.theory
    early = 100 * (case.multiplier / case.reference - 1)
    return case.scene, case.rule, case.cells, case.lower, case.upper, theory, early


def draw(figure: Figure, cases: Sequence[Case]) -> None:
    """λ with every rule against the mesh, over that with points at the ends."""
    scenes = {"block": "block on n elements", "W1": f"W1, inset {1e3 * INSET:.0f} mm", "panel-04": "panel-04"}
    for axes, (scene, title) in zip(figure.subplots(1, len(scenes), sharey=True), scenes.items(), strict=True):
        for place, (rule, (colour, marker)) in enumerate(MARKS.items()):
            _line(axes, [case for case in cases if (case.scene, case.rule) == (scene, rule)], colour, marker, place)
        axes.axhline(1.0, color="0.7", lw=0.8, zorder=0)
        axes.set_title(title, fontsize=9)
        axes.set_xticks(range(len(CELLS)), [str(n) for n in CELLS])
        axes.set(xlim=(-0.4, len(CELLS) - 0.6), ylim=(0.5, 1.1))
        axes.set_xlabel("cells in half a block n", fontsize=9)
        bare(axes)
    figure.axes[0].set_ylabel("λ / λ with points at the ends")
    for rule, (colour, marker) in MARKS.items():
        figure.axes[0].plot([], [], marker, color=colour, mfc="none", mew=1.6, label=rule)
    figure.axes[0].plot([], [], ":", color="0.3", label="theory")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=5, frameon=False)


def _line(axes: Axes, cases: Sequence[Case], colour: str, marker: str, place: int) -> None:
    """One rule's λ on every mesh, a little beside the others', and what theory makes of it."""
    at = [CELLS.index(case.cells) + 0.12 * (place - 1.5) for case in cases]
    axes.plot(at, [case.multiplier / case.reference for case in cases], marker, color=colour, ms=6, mfc="none", mew=1.6)
    known = [(x, case.theory / case.reference) for x, case in zip(at, cases, strict=True) if case.theory is not None]
    if known:
        axes.plot(*zip(*known, strict=True), ":", color=colour, lw=1.2, zorder=0)
