"""Blocks from soft to stiff: what they cost with and without mass scaling, and what scaling must not do.

Without scaling the step falls with the root of the blocks' stiffness. Scaling makes each deformable mode just so heavy
that it does not limit the step; making all of them heavier by one factor reaches the same step, and puts modes into
the band in which the wall moves that have no place there.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dem import limit_nonassociated
from fem_interface.element_order import modal_wall
from fem_interface.mass_scaling import LOWEST, largest_scaling
from fem_interface.modal_wall import ModalWall
from fem_interface.model import fem
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.compare.figures import COLOURS, OURS, bare
from runningbond.dynamics import BlockSystem, Run
from runningbond.results import Outcome
from runningbond.scene import Scene

from .elastic import vibrations
from .finding import Edge, Entry, Finding

INSET = 0.02
"""Inset of the joints of W1 [m], with which its collapse multiplier is one number."""

YOUNG = (1e9, 1e10, 1e11, 1e12, 1e13)
DEAR = 1e11
"""Young's modulus [Pa] beyond which the wall is not brought down without mass scaling: it would take minutes."""

UNIFORM = "all modes by one factor"


@dataclass(frozen=True, eq=False)
class Stiffness:
    """A wall at one stiffness of its blocks and with one way of scaling.

    Parameters
    ----------
    young : float
        Young's modulus [Pa].
    scaling
        What is scaled.
    step : float
        Time step of a run [s].
    factor : float
        Largest factor on a mass.
    shift : float
        Largest relative change of one of the lowest frequencies.
    crowd : int
        Modes no faster than the fastest of the wall of rigid blocks.
    outcome
        Collapse; None where it was not looked for.
    """

    young: float
    scaling: str
    step: float
    factor: float
    shift: float
    crowd: int
    outcome: Outcome | None


def experiment() -> Finding:
    """Stiffen the blocks of W1 ten thousand times."""
    found = [kind for young in YOUNG for kind in at_stiffness(young)]
    rigid = modal_wall(wall(YOUNG[-1]), 1, 3)
    exact = limit_nonassociated(wall(YOUNG[-1]))
    step = Run(system_of(rigid)).dt
    each, none = (by_scaling(found, scaling) for scaling in ("each mode by its own", "none"))
    stiffest, second = none[-1], none[-2]
    edges = [
        Edge("time step as E grows tenfold, no scaling, last decade", second.step / stiffest.step, math.sqrt(10), 0.01),
        Edge("time step at 1e13 Pa, scaled [s]", each[-1].step, step, 0.01),
    ]
    if exact.multiplier is not None:
        edges += [
            Edge(f"λ at {kind.young:.0e} Pa, scaling: {kind.scaling}", kind.outcome.multiplier, exact.multiplier, 0.01)
            for kind in found
            if kind.outcome is not None and kind.outcome.multiplier is not None
        ]
    worst = max(kind.shift for kind in each)
    return Finding(
        title="Block stiffness",
        heads=[
            *("Young's modulus [Pa]", "masses scaled", "largest factor", "time step [µs]", "steps a second of motion"),
            *(f"largest shift of the {LOWEST} lowest ω [%]", "modes in the band of rigid blocks"),
            *("status", "λ lower", "λ upper", "steps taken"),
        ],
        rows=[row(kind) for kind in found],
        edges=edges,
        trust=f"from {YOUNG[0]:.0e} to {YOUNG[-1]:.0e} Pa λ does not depend on the blocks' stiffness, and fem's own "
        f"scaling leaves the {LOWEST} lowest frequencies as they are, to {100 * worst:.2g} %",
        beyond=beyond(found),
        draw=lambda figure: draw(figure, found, step, exact),
    )


def beyond(found: Sequence[Stiffness]) -> str:
    """What becomes of stiff blocks without scaling, and of all with too much of it."""
    dear = [kind for kind in found if kind.outcome is not None and kind.outcome.status != "collapse"]
    told = [f"at {k.young:.0e} Pa {k.outcome.status}, {k.outcome.message}" for k in dear if k.outcome is not None]
    none, each = (by_scaling(found, scaling)[-1] for scaling in ("none", "each mode by its own"))
    told.append(f"at {none.young:.0e} Pa {each.step / none.step:.0f} times as many steps a second")
    shift = max(kind.shift for kind in by_scaling(found, UNIFORM))
    return (
        f"without scaling: {'; '.join(told)}. With one factor for all deformable modes frequencies shift by up to "
        f"{100 * shift:.0f} % and blocks vibrate in the band in which they move as wholes; fem does not offer it"
    )


def wall(young: float) -> Scene:
    """W1 of blocks of a Young's modulus [Pa], its joints inset."""
    scene = published_scene("wall-w1")
    block, joint = replace(scene.block, young=young), replace(scene.joint, inset=INSET)
    return replace(scene, block=block, joint=joint)


def at_stiffness(young: float) -> list[Stiffness]:
    """The wall without scaling, with each mode scaled by its own, and with all of them by one factor."""
    scene = wall(young)
    found = modal_wall(scene)
    rigid = system_of(modal_wall(scene, 1, 3))
    systems = {
        "none": system_of(found, mass_scaling=False),
        "each mode by its own": system_of(found),
    }
    systems[UNIFORM] = uniformly_scaled(found, systems["none"], rigid.interface.frequency_squared)
    exact, _ = vibrations(systems["none"])
    band = float(vibrations(rigid)[0][-1])
    kinds = []
    for scaling, system in systems.items():
        frequencies, _ = vibrations(system)
        outcome = None
        if scaling != UNIFORM and (system is not systems["none"] or young <= DEAR):
            outcome = fem(scene, mass_scaling=scaling != "none")
        kinds.append(
            Stiffness(
                young,
                scaling,
                Run(system).dt,
                largest_scaling(found, system.mass),
                float(np.abs(frequencies[:LOWEST] / exact[:LOWEST] - 1).max()),
                int((frequencies <= band * (1 + 1e-9)).sum()),
                outcome,
            )
        )
    return kinds


def uniformly_scaled(found: ModalWall, system: BlockSystem, target: float) -> BlockSystem:
    """The system with all deformable modes heavier by the factor that brings its largest ω² to a target [1/s²]."""
    factor = max(1.0, system.interface.frequency_squared / target)
    mass = np.where(found.stiffness > 0, factor * found.mass, found.mass)
    bound = min(target, system.interface.frequency_squared)
    return replace(system, mass=mass, interface=replace(system.interface, frequency_squared=bound))


def by_scaling(found: Sequence[Stiffness], scaling: str) -> list[Stiffness]:
    """Those that were scaled in one way."""
    return [kind for kind in found if kind.scaling == scaling]


def row(kind: Stiffness) -> list[Entry]:
    """Row of the table."""
    outcome = kind.outcome
    collapse: list[Entry] = ["not run", "–", "–", "–"]
    if outcome is not None:
        numbers = (outcome.lower, outcome.upper, outcome.steps)
        collapse = [outcome.status, *("–" if number is None else number for number in numbers)]
    own: list[Entry] = [f"{kind.young:.0e}", kind.scaling, kind.factor, 1e6 * kind.step, f"{1 / kind.step:.3g}"]
    return [*own, 100 * kind.shift, kind.crowd, *collapse]


def draw(figure: Figure, found: Sequence[Stiffness], rigid: float, exact: Outcome) -> None:
    """Step, λ and shift of frequencies against the blocks' stiffness."""
    figure.set_size_inches(11, 4.2)
    steps, loads, shifts = figure.subplots(1, 3)
    looks = {"none": (COLOURS[2], "s"), "each mode by its own": OURS["fem"], UNIFORM: ("#7c3aed", "v")}
    for shift, (scaling, (colour, marker)) in enumerate(looks.items()):
        kinds = by_scaling(found, scaling)
        young = np.array([kind.young for kind in kinds])
        line: dict[str, object] = {"color": colour, "marker": marker, "mfc": "none", "lw": 1.2, "label": scaling}
        if scaling != UNIFORM:
            steps.plot(young, [1e6 * kind.step for kind in kinds], **line)
            _brackets(loads, kinds, colour, 1.12 ** (2 * shift - 1))
        if scaling != "none":
            shifts.plot(young, [100 * kind.shift for kind in kinds], **line)
    steps.axhline(1e6 * rigid, color="0.5", lw=0.9, ls="--")
    steps.annotate("rigid blocks", (YOUNG[0], 1e6 * rigid), va="bottom", fontsize=8, color="0.4")
    if exact.multiplier is not None:
        loads.axhline(exact.multiplier, color="0.5", lw=0.9, ls="--")
        loads.annotate(
            "certified",
            (math.sqrt(YOUNG[-1] * YOUNG[-2]), exact.multiplier),
            ha="center",
            va="bottom",
            fontsize=8,
            color="0.4",
        )
        loads.set_ylim(0.97 * exact.multiplier, 1.03 * exact.multiplier)
    steps.set(yscale="log", ylabel="time step [µs]")
    loads.set(ylabel="λ of wall W1, inset 20 mm")
    shifts.set(yscale="log", ylabel=f"largest shift of the {LOWEST} lowest ω [%]")
    for axes in (steps, loads, shifts):
        axes.set(xscale="log", xlabel="Young's modulus of blocks [Pa]")
        bare(axes)
    handles = {
        label: handle
        for axes in (steps, shifts)
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    title = "masses of deformable modes scaled:"
    figure.legend(
        list(handles.values()), list(handles), title=title, loc="outside lower center", ncols=3, frameon=False
    )


def _brackets(axes: Axes, kinds: Sequence[Stiffness], colour: str, aside: float) -> None:
    for kind in kinds:
        outcome = kind.outcome
        if outcome is not None and outcome.lower is not None and outcome.upper is not None:
            paler = 1.0 if outcome.status == "collapse" else 0.4
            axes.plot(
                [aside * kind.young] * 2,
                [outcome.lower, outcome.upper],
                color=colour,
                lw=4,
                alpha=paler,
                solid_capstyle="butt",
            )
