"""The paper's static solver as published: where its updates of the stiffness cycle, wander or go singular.

Every dry published wall is loaded up to the collapse load of `dem_static`, the robust variant, in increments of one
size after another, and each tenth of that load told: whether the algorithm got there, or how it ended instead.
A single block has a joint that fails at collapse and not before: the algorithm must bear it to there, and with the
paper's reading of l_c, the whole length of the joint, to twice that.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from dem.static import dem_static
from dem.stiffness_update import StiffnessUpdate, UpdateStatus, stiffness_update
from runningbond.compare.figures import COLOURS
from runningbond.compare.published import BARALDI, FERRIS, PUBLISHED, published_scene
from runningbond.scene import Scene

from .blocks import one_block
from .finding import Edge, Finding

WALLS = tuple(case.name for case in PUBLISHED if case.source in (BARALDI, FERRIS))
"""Dry walls: the paper's twelve panels, W1 to W3."""

TENTHS = 10
"""Shares of the collapse load that are told."""

INCREMENTS = (1, 10, 100)
"""Load steps to the collapse load; 1 stands for each tenth of it put on at once."""

ARMS = (0.5, 1.0)
"""l_c as a share of the joint's length: exact, and as the paper reads."""

FINE = 2000
"""Increments to the collapse load of a single block."""

OUTSIDE = 1e-3
"""Excess of forces over Eq. 3, in the largest of them, that counts as one."""

TOLERANCE = 0.02
"""Relative width of the bracket of the collapse loads."""

Fate: TypeAlias = UpdateStatus | Literal["outside", "unreached"]
"""What became of a tenth of the collapse load: ``outside`` if it converged on forces that break Eq. 3."""

LOOKS: dict[Fate, tuple[str, str, str]] = {
    "converged": ("#bfe3df", "", "converged"),
    "outside": ("#6db8af", "×", "converged, forces break Eq. 3"),
    "cycle": (COLOURS[2], "c", "cycle"),
    "singular": (COLOURS[3], "s", "singular"),
    "wandering": (COLOURS[0], "w", "wandering"),
    "unreached": ("white", "", "given up before"),
}
"""Colour, letter and words of each fate."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A wall, loaded up to its collapse load by the published algorithm.

    Parameters
    ----------
    wall
        Its name.
    collapse
        Its collapse load λ.
    increments, arm
        Load steps to it, and l_c as a share of each joint's length.
    fates
        What became of each tenth of the load.
    borne
        Share of the load up to which every step converged; −1 if not even the dead load's did.
    excess
        Largest excess over Eq. 3 with which a step converged, in its largest force.
    solves
        Linear systems solved.
    """

    wall: str
    collapse: float
    increments: int
    arm: float
    fates: Sequence[Fate]
    borne: float
    excess: float
    solves: int

    @property
    def end(self) -> str:
        """How it ended."""
        return next((fate for fate in self.fates if fate in ("cycle", "singular", "wandering")), "converged")


def trial(wall: str, scene: Scene, collapse: float, increments: int, arm: float) -> Trial:
    """Load a wall up to its collapse load; see `Trial`."""
    if increments == 1:
        loads = collapse * np.arange(1, TENTHS + 1) / TENTHS
        runs = [stiffness_update(scene, load, load, arm) for load in loads]
        fates = [_fate(run, 0) for run in runs]
    else:
        runs = [stiffness_update(scene, collapse / increments, collapse, arm)]
        each = increments // TENTHS
        # The dead load alone belongs to the first tenth.
        fates = [_fate(runs[0], k * each + (k > 0), (k + 1) * each) for k in range(TENTHS)]
    lost = next((k for k, fate in enumerate(fates) if fate not in ("converged", "outside")), TENTHS)
    borne = lost / TENTHS if increments == 1 else (len(runs[0].curve) - 1) / increments
    if not all(len(run.curve) for run in runs):
        borne = -1.0
    excess = max(float(run.excess.max(initial=0.0)) for run in runs)
    return Trial(wall, collapse, increments, arm, fates, borne, excess, sum(run.solves for run in runs))


def _fate(run: StiffnessUpdate, first: int, last: int | None = None) -> Fate:
    """What became of load steps `first` to `last`, by default all."""
    ends = run.status[first:] if last is None else run.status[first : last + 1]
    if not ends:
        return "unreached"
    if ends[-1] != "converged":
        return ends[-1]
    return "outside" if run.excess[first : first + len(ends)].max() > OUTSIDE else "converged"


def trials(walls: Sequence[str], increments: Sequence[int] = INCREMENTS, arms: Sequence[float] = ARMS) -> list[Trial]:
    """Load published walls up to the collapse loads of `dem_static`, in increments of every size."""
    found = []
    for wall in walls:
        scene = published_scene(wall)
        outcome = dem_static(scene, TOLERANCE)
        assert outcome.lower is not None, outcome.message
        found += [trial(wall, scene, outcome.lower, n, arm) for arm in arms for n in increments]
    return found


def block_edges() -> list[Edge]:
    """What a single block bears, in its collapse load."""
    edges = []
    for what, size, exact, arm, theory in (
        ("block that topples, l_c half the joint", (0.5, 2.0), 0.25, 0.5, 1.0),
        ("block that slides, l_c half the joint", (2.0, 0.5), 0.6, 0.5, 1.0),
        ("block that topples, l_c the whole joint", (0.5, 2.0), 0.25, 1.0, 2.0),
    ):
        found = stiffness_update(one_block(*size, 0.6, 1e11), exact / FINE, 2.5 * exact, arm)
        assert found.multiplier is not None
        edges.append(Edge(f"load borne by a {what} [collapse load]", found.multiplier / exact, theory, 1e-3))
    return edges


def experiment() -> Finding:
    """Run the published algorithm on a single block and on every dry published wall."""
    found = trials(WALLS)
    stepped = [each for each in found if each.increments > 1]
    ends = Counter(each.end for each in stepped)
    hopeless = sorted({each.wall for each in stepped if each.borne <= 0})
    safe = min(each.borne for each in stepped if each.wall not in hopeless)
    largest = max(each.excess for each in found)
    broken = sum(each.excess > OUTSIDE for each in stepped)
    told = ", ".join(f"{ends[end]} {word}" for end, word in ENDS.items())
    return Finding(
        "The stiffness update as published, on walls up to their collapse load",
        HEADS,
        [_row(each) for each in found],
        [*block_edges(), Edge("share of the collapse load that every wall bears but those that bear nothing", safe)],
        f"On a single block, up to its collapse. On no wall: {', '.join(hopeless)} get nowhere, the others to as "
        f"little as {100 * safe:.0f} % of the collapse load, which `dem-static` reaches on all of them. "
        f"Of {len(stepped)} runs in steps {told}; {broken} converged on the way on forces that break Eq. 3, "
        f"by up to {100 * largest:.0f} % of the largest.",
        "Each load step has its status, and the run ends with the first that is not converged but cycle, singular or "
        "wandering; its curve stops at the last load that converged.",
        lambda figure: draw(figure, [each for each in found if each.arm == ARMS[0]]),
    )


ENDS = {"cycle": "cycled", "singular": "went singular", "wandering": "wandered", "converged": "got to the end"}
"""What is said of runs by how they ended."""

HEADS = (
    "wall",
    "collapse load λ (dem-static)",
    "l_c / joint",
    "steps to it",
    "ended",
    "borne [collapse load]",
    "largest excess over Eq. 3 [largest force]",
    "linear systems",
)


def _row(each: Trial) -> tuple[str, float, float, str, str, str | float, float, int]:
    steps = "each tenth at once" if each.increments == 1 else str(each.increments)
    borne = "not even its weight" if each.borne < 0 else each.borne
    return each.wall, each.collapse, each.arm, steps, each.end, borne, each.excess, each.solves


def draw(figure: Figure, found: Sequence[Trial]) -> None:
    """Map of what became of every tenth of the collapse load, wall by wall, for each size of increment."""
    axes_of = figure.subplots(1, len(INCREMENTS), sharey=True)
    for axes, increments in zip(axes_of, INCREMENTS, strict=True):
        shown = [each for each in found if each.increments == increments]
        for row, each in enumerate(shown):
            for k, fate in enumerate(each.fates):
                colour, letter, _ = LOOKS[fate]
                edge = "0.85" if fate == "unreached" else "white"
                axes.barh(row, 1 / TENTHS, left=k / TENTHS, height=0.9, color=colour, edgecolor=edge, lw=0.8)
                ink = "white" if fate in ("singular", "wandering") else "black"
                axes.text((k + 0.5) / TENTHS, row, letter, color=ink, ha="center", va="center", fontsize=7)
        axes.set_yticks(range(len(shown)), [each.wall for each in shown], fontsize=8)
        axes.set(xlim=(-0.01, 1.01), ylim=(len(shown) - 0.4, -0.6))
        axes.set_xticks((0, 0.5, 1), ("0", "0.5", "1"), fontsize=8)
        axes.set_xlabel("load / collapse load", fontsize=9)
        title = "each tenth put on at once" if increments == 1 else f"{increments} equal steps"
        axes.set_title(title, fontsize=9)
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
    met = {fate for each in found for fate in each.fates}
    handles = [
        Patch(facecolor=colour, edgecolor="0.7", label=f"{words} ({letter})" if letter else words)
        for fate, (colour, letter, words) in LOOKS.items()
        if fate in met
    ]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
