"""Time steps that are too long: where vibrations of a wall start to grow, and what a run reports then.

Central differences multiply a mode of frequency ω by (x + √(x² − 1))² per step if x = ω Δt / 2 exceeds one, and keep it
bounded below that. Lagged viscous damping of ratio ξ moves the limit to ω Δt = 2 (√(1 + ξ²) − ξ), local damping α to
2 / √(1 + α).
"""

import math
from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
from matplotlib.figure import Figure

from dem.rigid_system import contact_points, rigid_system
from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.dynamics import BlockSystem, Run, State, collapse_by_steps
from runningbond.dynamics.vibrations import vibrations
from runningbond.pictures.charts import looks_of, ticks
from runningbond.results import Outcome
from runningbond.scene import Array, JointMaterial, Stiffness
from runningbond.studies import Chart, Part, Row, Rows, Study
from runningbond.studies.walls import bonded, boxes, outcome_row

STEPS, STEPS_DAMPED = 4000, 100_000  # steps without growth that prove a vibration bounded: undamped, damped
PIECE, CLOSE = 20, 1e-4  # steps between two checks of a vibration, relative accuracy of an edge
SMALL, GROWN = 1e-20, 1e6  # initial size of a vibration, and growth that distinguishes it from beating
TIMES = (0.8, 0.9, 0.99, 1.001, 1.01, 1.03, 1.06, 1.1)  # time steps with measured growth, relative to the critical one
MUCH = 1.05  # time step of a user's run, relative to the critical one
KINDS: dict[str, tuple[ModeCount, bool]] = {  # modes per block, and whether masses are scaled
    "rigid blocks, 3 modes": (3, True),
    "uniform strains, 6 modes, scaled": (6, True),
    "uniform strains, 6 modes": (6, False),
    "all modes, scaled": ("all", True),
    "all modes": ("all", False),
}
WALL, CRITICAL, MASS = "wall-w1", "W1 with joints that hold: critical step [µs]", "One mass on its joint"
BEYOND = f"W1 at {MUCH} critical steps"
GROWTH, LOCAL, VISCOUS = "growth a step at ω Δt", "largest ω Δt, local damping", "largest ω Δt, viscous damping"


def growth_at(times: float) -> float:
    """Theoretical growth per step, for a time step relative to the critical one."""
    return (times + math.sqrt(times**2 - 1)) ** 2 if times > 1 else 1.0


def critical_row(kind: str) -> Row:
    """The critical step of W1 with bonded joints, without damping."""
    modes, scaled = KINDS[kind]
    wall = modal_wall(bonded(published_scene(WALL)), modes=modes)
    return critical_step(system_of(wall, damping=0.0, mass_scaling=scaled))


def critical_step(system: BlockSystem) -> Row:
    """The critical step from the largest eigenvalue and as measured, the bound of each block, and growth at `TIMES`."""
    frequencies, shapes = vibrations(system)
    exact, bound = 2 / float(frequencies[-1]), 2 / math.sqrt(system.interface.frequency_squared)
    # Start with the highest mode, whose growth shows at once, and a small part of every other mode.
    start = shapes[:, -1] + 1e-6 * shapes @ np.random.default_rng(1).normal(size=shapes.shape[1])

    def growth(step: float) -> float:
        return _growth(Run(system, local=0.0, viscous=0.0, dt=step), start, STEPS)

    growths = [growth(times * exact) for times in TIMES]
    row: Row = {"measured": 1e6 * _edge_of(growth, bound), "theory": 1e6 * exact, "allowed": 1e-3}
    row |= {"bound from each block": 1e6 * bound, "bound / critical": bound / exact, "growth": growths}
    return row | {"growth at 1.1 critical": growths[-1]}


@cache
def one_mass() -> tuple[BlockSystem, float, Array]:
    """A tall block on a joint far stiffer in compression than in shear: its system, its ω [1/s] and its mode shape."""
    joint = JointMaterial(0.6, elasticity=Stiffness(1e9, 1e7))
    system = rigid_system(bonded(replace(boxes((0, 0, 0.1, 0.4), joint=joint), thickness=1.0)))
    frequencies, shapes = vibrations(system)
    return system, float(frequencies[-1]), shapes[:, -1]


def mass_row(what: str, value: float) -> Row:
    """Growth of one mass beyond its stability limit, or its limit with damping, beside theory."""
    if what == GROWTH:
        return {"measured": _mass_growth(value), "theory": growth_at(value / 2), "allowed": 1e-6}
    theory = 2 / math.sqrt(1 + value) if what == LOCAL else 2 * (math.sqrt(1 + value**2) - value)
    damping = (value, 0.0) if what == LOCAL else (0.0, value)
    return {"measured": _edge_of(lambda step: _mass_growth(step, *damping), 0.01), "theory": theory, "allowed": 1e-3}


def _mass_growth(omega_dt: float, local: float = 0.0, viscous: float = 0.0) -> float:
    system, frequency, shape = one_mass()
    # The damping ratio of a run refers to the upper bound of the system's frequencies.
    ratio = viscous * math.sqrt(system.interface.frequency_squared) / frequency
    return _growth(Run(system, local=local, viscous=ratio, dt=omega_dt / frequency), shape, STEPS_DAMPED)


def _growth(run: Run, shape: Array, steps: int) -> float:
    """Growth per step of a free vibration, once its fastest-growing part dominates."""
    system, state, moving = run.system, State.at_rest(run.system), np.isfinite(run.system.mass)
    state.motion += SMALL * shape

    def size() -> float:  # any measure proportional to the vibration
        square = system.interface.frequency_squared * state.motion[moving] ** 2 + state.velocity[moving] ** 2
        return float(np.sqrt(system.mass[moving] @ square))

    start = size()
    for _ in range(steps // PIECE):
        run.hold(state, 0.0, PIECE, dead=0.0)
        now = size()
        if now > GROWN * start:
            run.hold(state, 0.0, PIECE, dead=0.0)
            return float((size() / now) ** (1 / PIECE))
    return 1.0


def _edge_of(growth: Callable[[float], float], low: float) -> float:
    """Largest step without growth, searched for from `low`, which has none."""
    high = 2 * low
    while growth(high) <= 1:
        low, high = high, 2 * high
    while high > low * (1 + CLOSE):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if growth(middle) <= 1 else (low, middle)
    return math.sqrt(low * high)


def run_beyond(model: str, times: float = MUCH) -> Outcome:
    """Outcome of W1 as published, with a time step relative to the critical one."""
    scene = published_scene(WALL)
    if model == "fem":
        wall = modal_wall(scene)
        system, points, order = system_of(wall), wall.elements.points, wall.elements.listing
    else:
        system, points = rigid_system(scene), contact_points(scene)
        order = np.argsort(points.joint, kind="stable")
    step = times * 2 / float(vibrations(system)[0][-1])
    run = Run(system, dt=step)
    return collapse_by_steps(scene, model, run, 0.01, points=points, point_order=order, is_self_locking=lambda: False)


def _draw(figure: Figure, rows: Rows) -> None:
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
    times = np.linspace(min(TIMES), max(TIMES), 400)
    left.plot(times, [growth_at(x) for x in times], color="0.4", lw=1.2, label="theory")
    looks = looks_of(list(KINDS))
    for place, row in enumerate(rows[CRITICAL]):
        colour, marker = looks[row["blocks"]]
        left.plot(TIMES, row["growth"], marker, color=colour, mfc="none", ms=5 + 1.6 * place, label=row["blocks"])
        right.plot([row["bound from each block"], row["theory"]], [place, place], color=colour, lw=1)
        for step, mark, size in (("bound from each block", "|", 14), ("theory", "o", 9), ("measured", "x", 5)):
            right.plot(row[step], place, mark, color=colour, mfc="none", ms=size, mew=1.5)
    for mark, label in (("|", "bound from each block"), ("o", "critical, by eigenvalues"), ("x", "edge as measured")):
        right.plot([], [], mark, color="0.3", mfc="none", label=label)
    left.set(xlabel="time step / critical step", ylabel="growth a step")
    right.set_yticks(range(len(KINDS)), list(KINDS), fontsize=8)
    right.set(xscale="log", xlabel="time step of wall W1 [µs]", ylim=(-0.6, len(KINDS) + 0.9), xlim=(1.6, 60))
    ticks(right, [2, 5, 10, 20, 50])
    for axes in (left, right):
        axes.legend(loc="upper left")


DAMPED = {GROWTH: (2.01, 2.1), LOCAL: (0.2, 0.5, 0.8), VISCOUS: (0.05, 0.3, 1.0)}
STUDY = Study(
    "time-step",
    "Time step",
    trusted="the step is at most the bound computed block by block, which is below the critical step",
    beyond="`failed`, with the step taken and a safe one",
    parts={
        CRITICAL: Part(("blocks",), [*zip(KINDS)], critical_row),
        MASS: Part(("what", "value"), [(what, x) for what in DAMPED for x in DAMPED[what]], mass_row),
        BEYOND: Part(("model",), [("dem-dynamic",), ("fem",)], lambda model: outcome_row(run_beyond(model))),
    },
    charts=[Chart("Growth of a vibration a step, and the steps at which it begins", _draw, size=(10, 4.8))],
)
