"""Blocks from soft to stiff: their cost with and without mass scaling, and what mass scaling must not change.

Without scaling the time step is inversely proportional to the root of the blocks' stiffness. Scaling gives each
deformable mode just enough mass not to limit the step. Scaling all deformable modes by one factor reaches the same
step, but moves spurious modes into the frequency band of the wall's own motion.
"""

from dataclasses import replace
from itertools import product

import numpy as np
from matplotlib.figure import Figure

from fem_interface.mass_scaling import IN_TIME
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.model import fem
from fem_interface.system import system_of
from runningbond.dynamics import BlockSystem, Run, largest_scaling
from runningbond.dynamics.vibrations import vibrations
from runningbond.pictures.charts import bracket, level, looks_of, series
from runningbond.scene import Scene
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study
from runningbond.studies.walls import W1, inset_wall, known_wall, outcome_row

YOUNG = (1e9, 1e10, 1e11, 1e12, 1e13)
EXPENSIVE = 1e11  # E [Pa] above which the wall is not brought to collapse without mass scaling: it would take minutes
NONE, EACH, UNIFORM = SCALINGS = ("none", "each mode by its own", "all modes by one factor")
KIND, YOUNGS = "masses scaled", "E [Pa]"
PART, STEP, SHIFT = (
    "W1, its blocks ever stiffer",
    "time step [µs]",
    f"largest shift of the {IN_TIME.lowest} lowest ω [%]",
)


def wall(young: float) -> Scene:
    """W1 with blocks of a given Young's modulus [Pa], and inset joints, which make λ unique."""
    return inset_wall("wall-w1").with_block(young=young)


def uniformly_scaled(result: ModalWall, system: BlockSystem, target: float) -> BlockSystem:
    """The system with all deformable modes scaled by the factor that reduces its largest ω² to a target [1/s²]."""
    squared = system.interface.frequency_squared
    mass = np.where(result.stiffness > 0, max(1.0, squared / target) * result.mass, result.mass)
    return replace(system, mass=mass, interface=replace(system.interface, frequency_squared=min(target, squared)))


def measure(young: float, scaling: str) -> Row:
    """Time step, frequencies and λ of the wall for one way of scaling."""
    result, rigid = modal_wall(wall(young)), system_of(modal_wall(wall(young), 1, 3))
    plain = system = system_of(result, mass_scaling=False)
    if scaling == EACH:
        system = system_of(result)
    elif scaling == UNIFORM:
        system = uniformly_scaled(result, plain, rigid.interface.frequency_squared)
    frequencies, exact, of_rigid = (vibrations(each)[0] for each in (system, plain, rigid))
    row: Row = {
        "largest factor": largest_scaling(system.mass, result.mass),
        STEP: 1e6 * Run(system).dt,
        "of rigid blocks [µs]": 1e6 * Run(rigid).dt,
        SHIFT: 100 * float(np.abs(frequencies[: IN_TIME.lowest] / exact[: IN_TIME.lowest] - 1).max()),
        "modes in the band of rigid blocks": int((frequencies <= of_rigid[-1] * (1 + 1e-9)).sum()),
    }
    if scaling == EACH or (scaling == NONE and young <= EXPENSIVE):
        row |= {"theory": known_wall(W1).multiplier, "allowed": 0.01}
        row |= outcome_row(fem(wall(young), mass_scaling=scaling == EACH))
        row["measured"] = row["λ"]
    return row


def fits(rows: Rows) -> list[Edge]:
    """Edges: power of the stiffness in the unscaled step, the scaled step, and the effect of scaling on frequencies."""
    none, each, uniform = ([row for row in rows[PART] if row[KIND] == kind] for kind in SCALINGS)
    stiffest = each[-1]
    return [
        Edge("time step as E grows tenfold, no scaling, last decade", none[-2][STEP] / none[-1][STEP], 10**0.5, 0.01),
        Edge("time step at 1e13 Pa, scaled [µs]", stiffest[STEP], stiffest["of rigid blocks [µs]"], 0.01),
        Edge("times as many steps at 1e13 Pa without scaling", stiffest[STEP] / none[-1][STEP]),
        Edge(f"{SHIFT}, each mode scaled by its own", max(row[SHIFT] for row in each)),
        Edge(f"{SHIFT}, all modes by one factor", max(row[SHIFT] for row in uniform)),
    ]


def _draw(figure: Figure, rows: Rows) -> None:
    steps, loads, shifts = figure.subplots(1, 3)
    looks, own, exact = looks_of(SCALINGS), rows[PART], known_wall(W1).multiplier
    hollow = {"mfc": "none", "lw": 1.2}
    series(steps, [row for row in own if row[KIND] != UNIFORM], YOUNGS, STEP, KIND, looks, **hollow)
    series(shifts, [row for row in own if row[KIND] != NONE], YOUNGS, SHIFT, KIND, looks, **hollow)
    for row in own:
        if row.get("λ upper") is not None:
            bracket(loads, (0.9 if row[KIND] == NONE else 1.12) * row[YOUNGS], row, looks[row[KIND]][0])
    level(steps, own[0]["of rigid blocks [µs]"], "rigid blocks", 0.05, ha="left")
    level(loads, exact, "certified", 0.83, ha="center")
    steps.set(yscale="log", ylabel=STEP)
    loads.set(ylabel="λ of wall W1, inset 20 mm", ylim=(0.97 * exact, 1.03 * exact))
    shifts.set(yscale="log", ylabel=SHIFT)
    for axes in (steps, loads, shifts):
        axes.set(xscale="log", xlabel="Young's modulus of blocks [Pa]")
    handles = {line.get_label(): line for axes in (steps, shifts) for line in axes.get_legend_handles_labels()[0]}
    title = "masses of deformable modes scaled:"
    figure.legend(handles=[*handles.values()], title=title, loc="outside lower center", ncols=3, fontsize="medium")


STUDY = Study(
    "block-stiffness",
    "Block stiffness",
    trusted="λ does not depend on the stiffness of the blocks, and scaling the mass of each mode by its own stiffness"
    " preserves the lowest frequencies",
    beyond="many times as many steps without mass scaling; with one factor for all deformable modes, blocks would "
    "vibrate in the frequency band of their rigid motions, and `fem` does not offer it",
    parts={PART: Part((YOUNGS, KIND), [*product(YOUNG, SCALINGS)], measure)},
    charts=[Chart("Time step, λ and lowest frequencies of blocks from soft to stiff", _draw, size=(11, 4.8))],
    fits=fits,
)
