"""Where the linear programs of limit analysis might fail: degenerate walls, scales, and two solvers."""

import time
from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np
from matplotlib.figure import Figure

from runningbond.compare.published import published_scene
from runningbond.limit import equilibrium
from runningbond.limit.associated import LimitState
from runningbond.limit.force_program import coulomb, solve_forces
from runningbond.models import MODEL_LOOKS, MODELS, TOLERANCE
from runningbond.pictures.charts import LOOKS, floor, level, ticks
from runningbond.scene import JointMaterial, Load, PointLoad, Scene, Stiffness, build_scene
from runningbond.studies import Chart, Part, Row, Rows, Study
from runningbond.studies.walls import boxes

POWERS = (-6, -4, -2, 0, 2, 4, 6)  # powers of ten by which quantities are multiplied, one at a time
WORTH = 1e-9  # relative difference that counts as rounding error of a linear program
STIFFNESS = Stiffness(1e11, 4e10)
QUANTITIES = ("density", "size", "load")
WALLS = ("wall-w1", "wall-w2", "wall-w3", "panel-04", "panel-03")
DEGENERATES, SCALES = "λ of degenerate walls", "λ at every scale, of what it must be"
SOLVERS = "λ by simplex, of that by interior point"
PROGRAMS = ("limit", "limit-nonassociated")  # models that solve linear programs; neither depends on the stiffness


def row_of_piers(number: int, friction: float = 0.6) -> Scene:
    """Separate equal piers of four blocks, 240 mm wide and 480 mm high: one mechanism each, and their combinations."""
    places = [(0.5 * pier, 0.12 * course, 0.24, 0.12) for pier in range(number) for course in range(4)]
    return boxes(*places, joint=JointMaterial(friction, elasticity=STIFFNESS))


def dusty() -> Scene:
    """A pier with grains of about 3.5e-7 of a block's weight on its top and beside it."""
    pier = [(0.0, 0.12 * course, 0.24, 0.12) for course in range(4)]
    grains = [(x, y, 1e-4, 1e-4) for x, y in ((0.02, 0.48), (0.12, 0.48), (0.22, 0.48), (0.4, 0.0))]
    return boxes(*pier, *grains, joint=JointMaterial(0.6, elasticity=STIFFNESS))


DEGENERATE: dict[str, tuple[Callable[[], Scene], float]] = {  # degenerate walls and their exact multipliers
    "one pier": (lambda: row_of_piers(1), 0.5),
    "20 equal piers: 20 mechanisms at one load": (lambda: row_of_piers(20), 0.5),
    "slides and topples at one load": (lambda: row_of_piers(5, 0.5), 0.5),
    "slides in every joint at one load": (lambda: row_of_piers(5, 0.2), 0.2),
    "grains of 1e-7 of a block's weight": (dusty, 0.5),
}


def glued(quantity: str = "", factor: float = 1.0) -> tuple[Scene, float]:
    """A glued pier under 1.1 λ N on its top, one quantity scaled, and its factor on λ; strength scales with weight."""
    size, load = (factor if quantity == what else 1.0 for what in ("size", "load"))
    strength = 1.0 if quantity == "load" else factor
    pier = row_of_piers(1)
    outlines = [size * pier.blocks.polygon(int(block)) for block in np.flatnonzero(pier.wall)]
    joint = replace(pier.joint, cohesion=1e4 * strength, tensile_strength=1e4 * strength)
    block = replace(pier.block, density=1800.0 * (factor if quantity == "density" else 1.0))
    loads = Load((0.0, -9.81), (PointLoad((0.06 * size, 0.48 * size), (1.0 * load, -0.5 * load)),))
    scene = build_scene("pier", outlines, thickness=0.12 * size, block=block, joint=joint, load=loads)
    return scene, {"density": factor, "load": 1 / factor, "size": factor**3}.get(quantity, 1.0)


def degenerate_row(wall: str, model: str) -> Row:
    """λ of a degenerate wall beside the exact one, which is always the smaller of tan φ and width / height."""
    build, exact = DEGENERATE[wall]
    result = MODELS[model].solve(build(), TOLERANCE).lower
    return {"measured": float("nan") if result is None else result, "theory": exact, "allowed": 1e-6}


def scale_row(model: str, quantity: str) -> Row:
    """Largest relative error of λ over twelve orders of magnitude of a quantity; inf if there is no answer."""
    reference, errors = MODELS[model].solve(glued()[0], TOLERANCE).lower, []
    assert reference is not None
    for power in POWERS:
        scene, change = glued(quantity, 10.0**power)
        result = MODELS[model].solve(scene, TOLERANCE).lower
        errors.append(float("inf") if result is None else abs(result / (reference * change) - 1))
    return {"measured": 1 + max(errors), "theory": 1.0, "allowed": 1e-6, "largest error": max(errors), "errors": errors}


def solver_row(wall: str) -> Row:
    """A published wall by dual simplex and by interior point: λ, error of the certificates, and seconds."""
    system = equilibrium(published_scene(wall))
    row: Row = {"movable blocks": system.freedoms // 3}
    for name, method in (("interior point", "highs-ipm"), ("simplex", "highs-ds")):
        start = time.process_time()
        state = LimitState(system, solve_forces(system, coulomb(system.strength), method=method))
        row |= {f"λ, {name}": state.forces.multiplier, f"{name} misses": max(state.measures.values())}
        row |= {f"{name} [s]": time.process_time() - start}
    return {"measured": row["λ, simplex"] / row["λ, interior point"], "theory": 1.0, "allowed": 1e-8, **row}


def _draw(figure: Figure, rows: Rows) -> None:
    left, right = figure.subplots(1, 2)
    styles = dict(zip(QUANTITIES, ("-", "--", ":"), strict=True))
    for row in rows[SCALES]:
        colour, marker = MODEL_LOOKS[row["model"]]
        style = {"color": colour, "marker": marker, "ms": 4, "mfc": "none", "lw": 1}
        label = f"{row['model']}, × {row['quantity']}"
        left.semilogy(POWERS, np.maximum(row["errors"], 1e-16), ls=styles[row["quantity"]], label=label, **style)
    level(left, WORTH, "rounding of a linear program", 0.02, ha="left")
    left.set(xlabel="power of ten by which a quantity is multiplied", ylabel="relative error of λ", ylim=(5e-17, 1e-5))
    floor(left, 1e-16)
    floor(right, 1e-16)
    left.set_title("a glued pier at every scale", fontsize=10)
    blocks = [row["movable blocks"] for row in rows[SOLVERS]]
    for (colour, marker), name in zip(LOOKS[::3], ("interior point", "simplex"), strict=False):
        missed = [max(row[f"{name} misses"], 1e-16) for row in rows[SOLVERS]]
        right.loglog(blocks, missed, marker, color=colour, mfc="none", label=f"{name}: what its certificate misses by")
    apart = [max(abs(row["measured"] - 1), 1e-16) for row in rows[SOLVERS]]
    right.loglog(blocks, apart, "x", color="black", label="difference of the two optima")
    right.set(xlabel="movable blocks", ylabel="relative error", ylim=(5e-17, 1e-4))
    ticks(right, [30, 50, 100, 200, 300])
    right.set_title("published walls, two solvers", fontsize=10)
    left.legend(ncols=2, loc="upper center")
    right.legend(loc="upper left")


STUDY = Study(
    "linear-program",
    "The linear programs of limit analysis",
    trusted="λ scales with density, size and load over twelve orders of magnitude to rounding; coinciding mechanisms "
    "and grains beside blocks do not change it; interior point and simplex agree",
    beyond="an optimum whose forces and mechanism do not prove each other is `failed`, never a number, with the "
    "amount by which they miss",
    parts={
        DEGENERATES: Part(("wall", "model"), [*product(DEGENERATE, PROGRAMS)], degenerate_row),
        SCALES: Part(("model", "quantity"), [*product(PROGRAMS, QUANTITIES)], scale_row),
        SOLVERS: Part(("wall",), [*zip(WALLS)], solver_row),
    },
    charts=[Chart("Errors of limit analysis at every scale, and of its two solvers", _draw, size=(11, 4.6))],
)
