"""Too long a time step: where a wall begins to vibrate ever more, and what a run of it says then.

Central differences multiply a mode of frequency ω by (x + √(x² − 1))² a step where x = ω Δt / 2 exceeds one, and
leave it bounded below. Lagged viscous damping of ratio ξ moves the edge to ω Δt = 2 (√(1 + ξ²) − ξ), local damping α
to 2 / √(1 + α).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from dem.rigid_system import contact_points, rigid_system
from fem_interface.element_order import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.system import system_of
from runningbond.compare import published_scene
from runningbond.compare.figures import COLOURS, OURS, bare
from runningbond.dynamics import BlockSystem, Run, State, collapse_by_steps
from runningbond.results import Outcome
from runningbond.scene import Array, scene_from_dict

from .elastic import bonded, vibrations
from .finding import Edge, Finding

WALL = "wall-w1"
STEPS, STEPS_DAMPED, PIECE = 4000, 100_000, 20
"""Steps after which a vibration that has not grown is not going to, a damped one too, and between two looks at it."""

SMALL = 1e-20
"""Size of a vibration at its start, so small that joints hold until its growth is known."""

GROWN = 1e6
"""Growth by which a vibration is told from one that beats."""

CLOSE = 1e-4
"""Relative accuracy of a measured edge."""

TOLERANCE = 1e-3

MUCH = 1.05
"""Critical steps that a user's run is given."""

BEYOND = (2.01, 2.1)
"""ω Δt of one mass at which growth is set beside theory."""

LOCAL = (0.2, 0.5, 0.8)
VISCOUS = (0.05, 0.3, 1.0)
TIMES = (0.8, 0.9, 0.99, 1.001, 1.01, 1.03, 1.06, 1.1)
"""Time steps at which growth is measured, in critical ones."""

KINDS: tuple[tuple[str, ModeCount, bool], ...] = (
    ("rigid blocks, 3 modes", 3, True),
    ("uniform strains, 6 modes, scaled", 6, True),
    ("uniform strains, 6 modes", 6, False),
    ("all modes, scaled", "all", True),
    ("all modes", "all", False),
)
"""Systems of a wall: what they are called, modes of a block, and whether masses are scaled."""

LOOKS = ((OURS["dem-dynamic"][0], "^"), (COLOURS[0], "s"), (COLOURS[2], "v"), (OURS["fem"][0], "D"), ("#7c3aed", "o"))
"""Colour and marker of each."""


@dataclass(frozen=True, eq=False)
class Measured:
    """A wall that vibrates.

    Parameters
    ----------
    name
        What it is called.
    bound
        Step [s] that the suite takes for critical, from each block alone.
    exact
        Critical step [s], by the largest eigenvalue of the assembled system.
    edge
        Step [s] beyond which it was seen to grow.
    growth : (n,) float
        Growth a step at `TIMES` the critical step.
    """

    name: str
    bound: float
    exact: float
    edge: float
    growth: Array


@dataclass(frozen=True, eq=False)
class OneMass:
    """A block on its joint that moves up and down.

    Parameters
    ----------
    system
        The block.
    frequency : float
        Its ω [1/s].
    shape : (nd,) float
        Its motion.
    """

    system: BlockSystem
    frequency: float
    shape: Array


def experiment() -> Finding:
    """Lengthen the time step of one mass and of a wall until they grow, and that of a user's runs."""
    walls = [measured(name, bonded_wall(modes, scaled)) for name, modes, scaled in KINDS]
    mass, runs = one_mass(), [too_long(model) for model in ("dem-dynamic", "fem")]
    edges = [Edge(f"W1, {wall.name}: critical step [s]", wall.edge, wall.exact, TOLERANCE) for wall in walls]
    edges += [Edge(f"one mass: growth a step at ω Δt = {x}", mass_growth(mass, x), rate(x / 2), 1e-6) for x in BEYOND]
    for alpha in LOCAL:
        edge = mass_edge(mass, local=alpha)
        edges.append(Edge(f"one mass: largest ω Δt, local damping {alpha}", edge, local_edge(alpha), TOLERANCE))
    for ratio in VISCOUS:
        edge = mass_edge(mass, viscous=ratio)
        edges.append(Edge(f"one mass: largest ω Δt, viscous damping {ratio}", edge, viscous_edge(ratio), TOLERANCE))
    rows = [
        (
            wall.name,
            1e6 * wall.bound,
            1e6 * wall.exact,
            wall.bound / wall.exact,
            1e6 * wall.edge,
            float(wall.growth[-1]),
        )
        for wall in walls
    ]
    inside = [wall.bound / wall.exact for wall in walls]
    return Finding(
        title="Time step",
        heads=[
            *("blocks of wall W1", "bound from each block [µs]", "critical step [µs]", "bound / critical"),
            *("edge as measured [µs]", f"growth a step at {TIMES[-1]} critical"),
        ],
        rows=rows,
        edges=edges,
        trust=f"the step is at most the bound from each block alone, here {100 * min(inside):.0f} to "
        f"{100 * max(inside):.0f} % of the critical one; runs take 0.9 of it, less by their damping",
        beyond="; ".join(f"{run.model} at {MUCH} critical steps: {run.status}, {run.message}" for run in runs),
        draw=lambda figure: draw(figure, walls),
    )


def rate(times: float) -> float:
    """Growth a step at so many critical steps."""
    return (times + math.sqrt(times**2 - 1)) ** 2 if times > 1 else 1.0


def local_edge(alpha: float) -> float:
    """Largest stable ω Δt with local damping α."""
    return 2 / math.sqrt(1 + alpha)


def viscous_edge(ratio: float) -> float:
    """Largest stable ω Δt with lagged viscous damping of ratio ξ."""
    return 2 * (math.sqrt(1 + ratio**2) - ratio)


def bonded_wall(modes: ModeCount, scaled: bool) -> BlockSystem:
    """W1 with joints that hold, its blocks undamped."""
    return system_of(modal_wall(bonded(published_scene(WALL)), 1, modes), damping=0.0, mass_scaling=scaled)


def measured(name: str, system: BlockSystem) -> Measured:
    """Find the critical step of a system, by its eigenvalues and by lengthening it."""
    frequencies, shapes = vibrations(system)
    exact = 2 / float(frequencies[-1])

    def growth_at(step: float) -> float:
        # The highest mode, so that its growth is seen as soon as it is there, and a little of every other.
        state = State.at_rest(system)
        noise = np.random.default_rng(1).normal(size=shapes.shape[1])
        state.motion += SMALL * (shapes[:, -1] + 1e-6 * shapes @ noise)
        return growth(Run(system, local=0.0, viscous=0.0, dt=step), state, STEPS)

    bound = 2 / math.sqrt(system.interface.frequency_squared)
    growths = np.array([growth_at(times * exact) for times in TIMES])
    return Measured(name, bound, exact, edge_of(growth_at, bound), growths)


def one_mass() -> OneMass:
    """A tall block whose joint resists compression a hundred times more than shear: it is fastest up and down."""
    wall = {"block_width": 0.1, "block_height": 0.4, "thickness": 1.0, "length": 0.1, "height": 0.4}
    joint = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 1e7}
    others = {"block": {"density": 1800.0}, "support": {"kind": "base"}}
    load = {"gravity": 9.81, "live": {"kind": "lateral"}}
    system = rigid_system(bonded(scene_from_dict({"wall": wall, "joint": joint, "load": load, **others})))
    frequencies, shapes = vibrations(system)
    return OneMass(system, float(frequencies[-1]), shapes[:, -1])


def mass_edge(mass: OneMass, *, local: float = 0.0, viscous: float = 0.0) -> float:
    """Largest ω Δt of one mass that does not grow, as measured."""
    return edge_of(lambda step: mass_growth(mass, step, local=local, viscous=viscous), 0.01)


def mass_growth(mass: OneMass, omega_dt: float, *, local: float = 0.0, viscous: float = 0.0) -> float:
    """Growth a step of one mass at a step ω Δt."""
    # The run's damping ratio is that at the bound of the system's frequencies.
    ratio = viscous * math.sqrt(mass.system.interface.frequency_squared) / mass.frequency
    state = State.at_rest(mass.system)
    state.motion += SMALL * mass.shape
    return growth(Run(mass.system, local=local, viscous=ratio, dt=omega_dt / mass.frequency), state, STEPS_DAMPED)


def growth(run: Run, state: State, steps: int) -> float:
    """Growth of a free vibration a step, once the fastest-growing part of it outgrows all others."""
    before = _size(run.system, state)
    for _ in range(steps // PIECE):
        run.hold(state, 0.0, PIECE, dead=0.0)
        now = _size(run.system, state)
        if now > GROWN * before:
            run.hold(state, 0.0, PIECE, dead=0.0)
            return float((_size(run.system, state) / now) ** (1 / PIECE))
    return 1.0


def edge_of(growth_at: Callable[[float], float], low: float) -> float:
    """Largest step that does not grow; `low` does not."""
    high = 2 * low
    while growth_at(high) <= 1:
        low, high = high, 2 * high
    while high > low * (1 + CLOSE):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if growth_at(middle) <= 1 else (low, middle)
    return math.sqrt(low * high)


def _size(system: BlockSystem, state: State) -> float:
    """Size of a vibration: it need only grow as the vibration does."""
    moving = np.isfinite(system.mass)
    square = system.interface.frequency_squared * state.motion[moving] ** 2 + state.velocity[moving] ** 2
    return float(np.sqrt(system.mass[moving] @ square))


def too_long(model: str, times: float = MUCH) -> Outcome:
    """What W1 as it was published comes to at so many critical steps."""
    scene = published_scene(WALL)
    if model == "fem":
        wall = modal_wall(scene)
        system, order = system_of(wall), wall.elements.listing
    else:
        system, order = rigid_system(scene), np.argsort(contact_points(scene).joint, kind="stable")
    step = times * 2 / float(vibrations(system)[0][-1])
    return collapse_by_steps(scene, model, Run(system, dt=step), 0.01, point_order=order, is_self_locking=lambda: False)


def draw(figure: Figure, walls: Sequence[Measured]) -> None:
    """Growth against the step, and the steps."""
    figure.set_size_inches(10, 4.4)
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1))
    times = np.linspace(min(TIMES), max(TIMES), 400)
    left.plot(times, [rate(x) for x in times], color="0.4", lw=1.2, label="theory")
    looks = zip(walls, LOOKS, strict=True)
    for shift, (wall, (colour, marker)) in enumerate(looks):
        left.plot(TIMES, wall.growth, marker, color=colour, mfc="none", ms=5 + 1.6 * shift, ls="none", label=wall.name)
    left.set(xlabel="time step / critical step", ylabel="growth a step")
    left.legend(frameon=False, fontsize=8, loc="upper left")
    for row, (wall, (colour, _)) in enumerate(zip(walls, LOOKS, strict=True)):
        right.plot([1e6 * wall.bound, 1e6 * wall.exact], [row, row], color=colour, lw=1)
        right.plot(1e6 * wall.bound, row, "|", color=colour, ms=14, mew=2)
        right.plot(1e6 * wall.exact, row, "o", color=colour, mfc="none", ms=9)
        right.plot(1e6 * wall.edge, row, "x", color=colour, ms=5)
    for marker, what in (("|", "bound from each block"), ("o", "critical, by eigenvalues"), ("x", "edge as measured")):
        right.plot([], [], marker, color="0.3", mfc="none", ls="none", label=what)
    right.set_yticks(range(len(walls)), [wall.name for wall in walls], fontsize=8)
    right.set(xscale="log", xlabel="time step of wall W1 [µs]", ylim=(-0.6, len(walls) + 0.9), xlim=(1.6, 60))
    right.set_xticks([2, 5, 10, 20, 50], ["2", "5", "10", "20", "50"])
    right.minorticks_off()
    right.legend(frameon=False, fontsize=8, loc="upper left")
    for axes in (left, right):
        bare(axes)
