"""Where the linear programs of limit analysis might fail: degenerate walls, scales, and two ways to solve them."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.figure import Figure

from dem import limit_nonassociated
from runningbond.compare.figures import OURS, bare
from runningbond.compare.published import published_scene
from runningbond.limit import equilibrium, limit
from runningbond.limit.associated import LimitState
from runningbond.limit.equilibrium import Equilibrium
from runningbond.limit.force_program import coulomb, solve_forces
from runningbond.scene import BlockMaterial, JointMaterial, Load, PointLoad, Scene, Stiffness, build_scene

from .finding import Edge, Entry, Finding

POWERS = (-6, -4, -2, 0, 2, 4, 6)
"""Powers of ten by which quantities are multiplied, one at a time."""

WALLS = ("wall-w1", "wall-w2", "wall-w3", "panel-04", "panel-03")
"""Published walls that both solvers are put to."""

WORTH = 1e-9
"""Difference that counts as rounding: what a linear program's answer is good for."""


def row_of_piers(number: int, *, height: float = 0.48, friction: float = 0.6) -> Scene:
    """Equal piers of four blocks, 240 mm wide, that stand apart.

    One mechanism becomes as many as there are piers, and all their combinations.
    """
    rise, width = height / 4, 0.24
    outlines = [
        np.array([[0, 0], [width, 0], [width, rise], [0, rise]]) + [0.5 * pier, rise * course]
        for pier in range(number)
        for course in range(4)
    ]
    joint = JointMaterial(friction, elasticity=Stiffness(1e11, 4e10))
    return build_scene("piers", outlines, thickness=0.12, block=BlockMaterial(1800.0), joint=joint, load=Load())


def dusty() -> Scene:
    """A pier with grains of a hundred-millionth of its blocks' weight on its top and beside it."""
    box = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    outlines = [box * [0.24, 0.12] + [0.0, 0.12 * course] for course in range(4)]
    outlines += [box * 1e-4 + [x, y] for x, y in ((0.02, 0.48), (0.12, 0.48), (0.22, 0.48), (0.4, 0.0))]
    joint = JointMaterial(0.6, elasticity=Stiffness(1e11, 4e10))
    return build_scene("dust", outlines, thickness=0.12, block=BlockMaterial(1800.0), joint=joint, load=Load())


def glued() -> Scene:
    """A glued pier under a load on its top, whose multiplier is in newtons; nothing else is as it was in `dusty`."""
    wall = row_of_piers(1)
    joint = replace(wall.joint, cohesion=1e4, tensile_strength=1e4)
    return replace(wall, joint=joint, load=Load((0.0, -9.81), (PointLoad((0.06, 0.48), (1.0, -0.5)),)))


@dataclass(frozen=True)
class Degenerate:
    """A degenerate wall and its exact multiplier."""

    what: str
    scene: Callable[[], Scene]
    exact: float


DEGENERATE = (
    Degenerate("one pier", lambda: row_of_piers(1), 0.5),
    Degenerate("20 equal piers: 20 mechanisms at one load", lambda: row_of_piers(20), 0.5),
    Degenerate("slides and topples at one load", lambda: row_of_piers(5, friction=0.5), 0.5),
    Degenerate("slides in every joint at one load", lambda: row_of_piers(5, friction=0.2), 0.2),
    Degenerate("grains of 1e-7 of a block's weight", dusty, 0.5),
)


def scaled(quantity: str, factor: float) -> tuple[Scene, float]:
    """`glued` with a quantity multiplied, strength along with weight, and the factor by which λ must change."""
    wall = glued()
    (live,) = wall.load.live
    assert isinstance(live, PointLoad)
    if quantity == "density":
        joint = replace(wall.joint, cohesion=1e4 * factor, tensile_strength=1e4 * factor)
        return replace(wall, block=replace(wall.block, density=1800.0 * factor), joint=joint), factor
    if quantity == "load":
        force = (live.force[0] * factor, live.force[1] * factor)
        return replace(wall, load=replace(wall.load, live=(PointLoad(live.at, force),))), 1 / factor
    outlines = [factor * wall.blocks.polygon(int(k)) for k in np.flatnonzero(wall.wall)]
    joint = replace(wall.joint, cohesion=1e4 * factor, tensile_strength=1e4 * factor)
    load = replace(wall.load, live=(PointLoad((live.at[0] * factor, live.at[1] * factor), live.force),))
    grown = build_scene(
        "pier", outlines, thickness=wall.thickness * factor, block=wall.block, joint=joint, load=load
    )  # fmt: skip
    return grown, factor**3


QUANTITIES = ("density", "size", "load")

SCALED: dict[str, Callable[[Scene], float | None]] = {
    "limit": lambda scene: limit(scene).lower,
    "limit-nonassociated": lambda scene: limit_nonassociated(scene).lower,
}
"""The models that solve linear programs, and what they find; neither reads a stiffness."""


def scale_errors(model: str, quantity: str) -> list[float]:
    """Relative error of λ at each of `POWERS`, beside that of the wall as it is; inf where there is no answer."""
    reference = SCALED[model](glued())
    assert reference is not None
    errors = []
    for power in POWERS:
        scene, change = scaled(quantity, 10.0**power)
        found = SCALED[model](scene)
        errors.append(float("inf") if found is None else abs(found / (reference * change) - 1))
    return errors


@dataclass(frozen=True)
class Solved:
    """What two solvers made of a wall: blocks, multipliers, what their certificates miss by, processor times [s]."""

    wall: str
    blocks: int
    multiplier: tuple[float, float]
    missed: tuple[float, float]
    seconds: tuple[float, float]


def solved(name: str) -> Solved:
    """Solve a wall's program by interior point and by dual simplex."""
    system = equilibrium(published_scene(name))
    inner, edge = (_solve(system, method) for method in ("highs-ipm", "highs-ds"))
    states = inner[0], edge[0]
    return Solved(
        name,
        system.freedoms // 3,
        (states[0].forces.multiplier, states[1].forces.multiplier),
        (max(states[0].measures.values()), max(states[1].measures.values())),
        (inner[1], edge[1]),
    )


def _solve(system: Equilibrium, method: str) -> tuple[LimitState, float]:
    start = time.process_time()
    state = LimitState(system, solve_forces(system, coulomb(system.strength), method=method))
    return state, time.process_time() - start


def experiment() -> Finding:
    """Solve degenerate walls, one wall at many scales, and published walls in two ways."""
    rows: list[tuple[Entry, ...]] = []
    edges = []
    for wall in DEGENERATE:
        for model in ("limit", "limit-nonassociated"):
            found = SCALED[model](wall.scene())
            value = float("nan") if found is None else found
            rows.append((wall.what, model, value, wall.exact, abs(value / wall.exact - 1)))
            edges.append(Edge(f"λ, {wall.what}, {model}", value, wall.exact, 1e-6))
    errors = {(model, quantity): scale_errors(model, quantity) for model in SCALED for quantity in QUANTITIES}
    for (model, quantity), error in errors.items():
        worst = max(error)
        rows.append((f"{quantity} × 1e-6 … 1e6", model, 1 + worst, 1.0, worst))
        edges.append(Edge(f"λ over 12 orders of {quantity}, of what it must be, {model}", 1 + worst, 1.0, 1e-6))
    both = [solved(name) for name in WALLS]
    for case in both:
        inner, edge = case.multiplier
        rows.append((case.wall, "simplex against interior point", edge, inner, abs(edge / inner - 1)))
        edges.append(Edge(f"λ by simplex, of that by interior point, {case.wall}", edge / inner, 1.0, 1e-8))
    slower = [case.seconds[1] / case.seconds[0] for case in both]
    worst = max(max(error) for error in errors.values())
    return Finding(
        title="The linear programs of limit analysis",
        heads=("wall", "model", "λ", "λ by theory", "relative error"),
        rows=rows,
        edges=edges,
        trust=f"λ follows density, size and load over twelve orders of magnitude to {worst:.0e}; equal "
        "mechanisms, many at one load, and grains beside blocks change nothing. Interior point and simplex agree, "
        f"with certificates that miss by {max(max(case.missed) for case in both):.0e} at most; simplex takes "
        f"{min(slower):.1f} to {max(slower):.1f} times as long.",
        beyond="An optimum whose forces and mechanism do not prove each other is `failed`, never a number: "
        "“forces and mechanism disagree”, with what they miss by.",
        draw=lambda figure: _draw(figure, errors, both),
    )


def _draw(figure: Figure, errors: dict[tuple[str, str], list[float]], both: list[Solved]) -> None:
    figure.set_size_inches(11, 4.2)
    figure.set_layout_engine("constrained")
    left, right = figure.subplots(1, 2)
    styles = dict(zip(QUANTITIES, ("-", "--", ":"), strict=True))
    for (model, quantity), error in errors.items():
        colour, marker = OURS[model]
        shown = np.maximum(error, 1e-16)
        left.semilogy(POWERS, shown, styles[quantity], color=colour, marker=marker, ms=4, mfc="none", lw=1)
    for model in SCALED:
        left.plot([], [], color=OURS[model][0], marker=OURS[model][1], label=model)
    for quantity, style in styles.items():
        left.plot([], [], style, color="0.3", label=f"× {quantity}")
    left.axhline(WORTH, color="0.7", lw=0.8)
    left.annotate("rounding of a linear program", (POWERS[0], 1.2 * WORTH), fontsize=8, color="0.4")
    left.set(xlabel="power of ten by which a quantity is multiplied", ylabel="relative error of λ", ylim=(5e-17, 1e-5))
    left.set_title("A glued pier at every scale", fontsize=10)
    left.legend(frameon=False, fontsize=8, ncols=2, loc="upper center")
    order = sorted(both, key=lambda case: case.blocks)
    blocks = [case.blocks for case in order]
    for k, (label, marker, colour) in enumerate((("interior point", "o", "#0b559f"), ("dual simplex", "s", "#c2410c"))):
        missed = [max(case.missed[k], 1e-16) for case in order]
        right.loglog(blocks, missed, marker, color=colour, mfc="none", label=f"{label}: what its certificate misses by")
    apart = [max(abs(case.multiplier[1] / case.multiplier[0] - 1), 1e-16) for case in order]
    right.loglog(blocks, apart, "x", color="black", label="difference of the two optima")
    right.set(xlabel="movable blocks", ylabel="relative error", ylim=(5e-17, 1e-4))
    right.set_xticks([30, 50, 100, 200, 300], ["30", "50", "100", "200", "300"])
    right.minorticks_off()
    right.set_title("Published walls, two solvers", fontsize=10)
    right.legend(frameon=False, fontsize=8, loc="upper left")
    for axes in (left, right):
        bare(axes)
