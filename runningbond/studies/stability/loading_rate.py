"""How fast a wall may be loaded: what a ramp and a prescribed displacement say of λ, and the suite's load steps.

Under a ramp λ = r t a wall begins to move at λ_c and is seen to fall once it has moved by u. With (1) of `known`,
(M / F) ü = (1 − α) (λ − λ_c), that is at

    λ − λ_c = (6 u r² (M / F) / (1 − α))^{1/3},                                                                 (2)

too high by the rate to the power 2/3. Under displacement control inertia resists only until the wall has come up to
its speed; what is left, a soft start later, are the waves of that start.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dem.rigid_system import rigid_system
from runningbond.compare.figures import COLOURS, bare
from runningbond.compare.published import published_scene
from runningbond.dynamics import BlockSystem, Criteria, Run, State, drive, load_steps, settle, settled_drive
from runningbond.dynamics.collapse import U_CRIT
from runningbond.dynamics.collapse_load import FIRST_STEP
from runningbond.dynamics.load_stepping import LOADING, LOADING_WEIGHTLESS
from runningbond.dynamics.run import LOCAL
from runningbond.scene import Array

from .finding import Edge, Entry, Finding
from .literature import KnownWall, rounded_wall, sliding_block, toppling_block

RATES = 10.0 ** -(np.arange(7) / 3)
"""Rates of λ [1/s]."""

PUSHES = tuple(1_000 * 2**k for k in range(12))
"""Steps in which a wall is pushed as far as a load step may move it: the more, the slower."""

LOADINGS = (0, 1, 4, LOADING, 4 * LOADING, 16 * LOADING)
"""Times in which the load grows by its first step, in times to rest."""

DRY = ("panel-12", "point-load-4")
"""Published walls whose λ depends on their history."""

ORDER = 2 / 3
"""Of a ramp's error in its rate, by (2)."""

LOOK = 5
"""Steps of a ramp between two looks at how far the wall has come."""

BRACKET = 0.005
"""Relative width of the brackets by load steps."""

NOUGHT = 1e-4
"""Errors [%] smaller than this are drawn as this."""


@dataclass(frozen=True, eq=False)
class Ramped:
    """What ramps say of a wall.

    Parameters
    ----------
    wall
        The wall.
    rate : (n,) float
        Rates of λ [1/s], the fastest first.
    multiplier : (n,) float
        λ at which the wall was seen to fall.
    """

    wall: KnownWall
    rate: Array
    multiplier: Array

    @property
    def order(self) -> float:
        """Power of the rate with which the excess over the known λ grows."""
        return float(np.polyfit(np.log(self.rate), np.log(self.multiplier - self.wall.multiplier), 1)[0])

    @property
    def at_no_speed(self) -> tuple[float, float]:
        """λ of a ramp without speed, and its standard error.

        A straight line over the rate to the power 2/3, each point of a weight inverse to that: the scatter is as the
        excess.
        """
        away = self.rate**ORDER
        line, covariance = np.polyfit(away, self.multiplier, 1, w=1 / away, cov=True)
        return float(line[1]), float(np.sqrt(covariance[1, 1]))


@dataclass(frozen=True, eq=False)
class Pushed:
    """What displacement control says of a wall.

    Parameters
    ----------
    wall
        The wall.
    speed : (n,) float
        Mean speed of the blocks [m/s], the fastest first.
    multiplier : (n,) float
        Peak of λ.
    """

    wall: KnownWall
    speed: Array
    multiplier: Array

    @property
    def fit(self) -> float:
        """Fastest speed [m/s] from which on λ stays within one per cent of what is known."""
        off = np.abs(self.multiplier / self.wall.multiplier - 1) > 0.01
        return float(self.speed[np.flatnonzero(off)[-1] + 1])


def ramped(wall: KnownWall, rates: Sequence[float] | Array = RATES, local: float = LOCAL) -> Ramped:
    """Ramps of a wall, each from rest."""
    run, rest = wall.rest(local)
    return Ramped(wall, np.asarray(rates), np.array([_falls_at(run, rest, float(rate), wall.far) for rate in rates]))


def excess(wall: KnownWall, rate: Array, local: float = LOCAL) -> Array:
    """Excess of λ by (2), ``(n,)``, for rates ``(n,)`` [1/s]."""
    return np.asarray(np.cbrt(6 * wall.far * rate**2 * wall.inertia / (1 - local)))


def pushed(wall: KnownWall, pushes: Sequence[int] = PUSHES) -> Pushed:
    """A wall pushed as far as its load steps may move it, in more and more time steps."""
    run, rest = wall.rest()
    peaks = [drive(run, rest, wall.far, steps).peak for steps in pushes]
    return Pushed(wall, wall.far / (np.array(pushes) * run.dt), np.array(peaks))


def bracket(system: BlockSystem, far: float | Array, loading: float = LOADING) -> tuple[float, float]:
    """Bracket of λ by load steps at a speed, a collapse taken for one after some displacements [m]."""
    first = FIRST_STEP / system.measure(system.live)
    found = load_steps(Run(system), first, BRACKET, Criteria(collapse=far), loading=loading)
    assert found.lower is not None
    assert found.upper is not None
    return found.lower, found.upper


@dataclass(frozen=True, eq=False)
class Stepped:
    """What load steps say of a wall.

    Parameters
    ----------
    name
        What to call it.
    brackets
        Largest λ at rest and smallest in a fall, by the time in which the load grew by its first step.
    unit
        λ that is known, or that of the slowest loading.
    default
        The suite's loading of such a wall.
    """

    name: str
    brackets: dict[float, tuple[float, float]]
    unit: float
    default: float = LOADING

    def off(self, loading: float) -> tuple[float, float]:
        """How far a bracket is off its unit [%]."""
        lower, upper = self.brackets[loading]
        return 100 * (lower / self.unit - 1), 100 * (upper / self.unit - 1)


def stepped(wall: KnownWall, loadings: Sequence[float] = LOADINGS) -> Stepped:
    """Load steps of a wall whose λ is known."""
    brackets = {loading: bracket(wall.system, wall.far, loading) for loading in loadings}
    return Stepped(wall.name, brackets, wall.multiplier)


def stepped_dry(name: str, loadings: Sequence[float] = LOADINGS) -> Stepped:
    """Load steps of a published wall whose λ depends on its history."""
    scene = published_scene(name)
    system, far = rigid_system(scene), U_CRIT * scene.block_sizes
    brackets = {loading: bracket(system, far, loading) for loading in loadings}
    default = LOADING_WEIGHTLESS if system.weightless else LOADING
    return Stepped(name, brackets, sum(brackets[max(loadings)]) / 2, default)


def rate_between_steps(wall: KnownWall) -> float:
    """Rate [1/s] of the suite's ramps between its first load steps."""
    run, rest = wall.rest()
    first, put_on = FIRST_STEP / wall.system.measure(wall.system.live), rest.copy()
    settle(run, put_on, first, Criteria(collapse=wall.far))
    return first / (LOADING * (put_on.steps - rest.steps) * run.dt)


def experiment() -> Finding:
    """Load blocks and a wall at many speeds, by each of the three controls."""
    walls = (sliding_block(), toppling_block(), rounded_wall("wall-w1"))
    ramps = [ramped(wall) for wall in walls]
    pushes = [pushed(wall) for wall in walls]
    masonry = walls[-1]
    steps = [stepped(masonry), *map(stepped_dry, DRY)]
    run, rest = masonry.rest()
    settled = settled_drive(run, rest, masonry.far, 0.01)
    rows: list[tuple[Entry, ...]] = []
    for ramp in ramps:
        rows += [
            ("ramp", ramp.wall.name, f"{rate:.3g} 1/s", multiplier, _off(ramp.wall, multiplier))
            for rate, multiplier in zip(ramp.rate, ramp.multiplier, strict=True)
        ]
    for push in pushes:
        rows += [
            ("displacement", push.wall.name, f"{1e3 * speed:.3g} mm/s", multiplier, _off(push.wall, multiplier))
            for speed, multiplier in zip(push.speed, push.multiplier, strict=True)
        ]
    rows.append(
        (
            "displacement, halved until it settles to 1 %",
            masonry.name,
            f"own estimate of the error {100 * settled.rate_error / settled.peak:.2g} %",
            settled.peak,
            _off(masonry, settled.peak),
        )
    )
    for found in steps:
        for loading, (lower, upper) in found.brackets.items():
            off = f"{round(sum(found.off(loading)) / 2, 2) + 0.0:+.2g}"
            rows.append(("load steps", found.name, f"{loading:g} times to rest", (lower + upper) / 2, off))
    return Finding(
        title="Loading rate: ramp, displacement control and load steps",
        heads=("control", "wall", "speed", "λ", "off by [%]"),
        rows=rows,
        edges=_edges(ramps, pushes, steps),
        trust="Load steps: at any speed where λ is unique, for each load is held until the wall rests or falls. Where "
        f"λ depends on the history, as in dry walls, it settles as loading slows: {_settled(steps[1:])}. "
        "A ramp only extrapolated to no speed: its error falls with the rate to the power 2/3. A peak under "
        f"displacement control below {1e3 * min(push.fit for push in pushes):.1g} mm/s, to some tenths of a per cent: "
        "sliding contacts chatter.",
        beyond="A λ that is too high in a ramp or under displacement control, and no model of the suite takes its λ "
        f"from them. A peak settled by halving the speed may settle too early, here {_off(masonry, settled.peak)} % "
        f"off where `rate_error` is {100 * settled.rate_error / settled.peak:.1g} %. By load steps in haste the λ of "
        f"another history, here up to {_span(steps[1:])} % off: of an equilibrium that the wall does bear, but would "
        "not have come to by itself.",
        draw=partial(_draw, ramps, pushes, steps, rate_between_steps(masonry)),
    )


def _falls_at(run: Run, rest: State, rate: float, far: float) -> float:
    state, multiplier = rest.copy(), 0.0
    step = rate * LOOK * run.dt
    while run.system.farthest(state.motion - rest.motion) < far:
        run.hold(state, multiplier + step / 2, LOOK)
        multiplier += step
    return multiplier - step / 2


def _off(wall: KnownWall, multiplier: float) -> str:
    return f"{100 * (multiplier / wall.multiplier - 1):+.2g}"


def _settled(dry: Sequence[Stepped]) -> str:
    """How far apart the λ of walls are at the suite's loading and slower ones."""
    slow = [(found.name, [sum(found.off(at)) / 2 for at in LOADINGS if at >= found.default]) for found in dry]
    spans = [f"{name} within {max(off) - min(off):.1f} %" for name, off in slow]
    return f"from the suite's loading on {' and '.join(spans)}"


def _span(dry: Sequence[Stepped]) -> str:
    """How far a wall in haste is off at most [%]."""
    off = [sum(found.off(loading)) / 2 for found in dry for loading in LOADINGS if loading < found.default]
    return f"{max(off, key=abs):+.0f}"


def _edges(ramps: Sequence[Ramped], pushes: Sequence[Pushed], steps: Sequence[Stepped]) -> list[Edge]:
    edges = []
    for found in ramps:
        wall, whole = found.wall, len(found.wall.scene.blocks) > 2
        known = wall.multiplier
        slowest = float(excess(wall, found.rate[-1:])[0])
        edges += [
            Edge(f"order of a ramp's error in its rate, {wall.name}", found.order, ORDER, 0.05 if whole else 0.005),
            Edge(f"λ of a ramp without speed, {wall.name}", found.at_no_speed[0], known, 0.01 if whole else 0.001),
            Edge(f"its standard error, {wall.name}", found.at_no_speed[1]),
        ]
        measured = float(found.multiplier[-1]) - known
        what = f"excess of λ in a ramp at {found.rate[-1]:.2g} 1/s, {wall.name}"
        edges.append(Edge(what, measured, slowest, None if whole else 0.01))
    for push in pushes:
        whole = len(push.wall.scene.blocks) > 2
        what = f"peak λ at {1e3 * push.speed[-1]:.2g} mm/s, {push.wall.name}"
        edges.append(Edge(what, float(push.multiplier[-1]), push.wall.multiplier, 0.01 if whole else 1e-6))
        edges.append(Edge(f"fastest speed within 1 % [mm/s], {push.wall.name}", 1e3 * push.fit))
    unique, *dry = steps
    edges.append(
        Edge(f"λ by the suite's load steps, {unique.name}", sum(unique.brackets[LOADING]) / 2, unique.unit, BRACKET)
    )
    for slow in dry:
        what = f"λ by the suite's load steps, of that {LOADINGS[-1] / slow.default:g} times as slow, {slow.name}"
        edges.append(Edge(what, sum(slow.brackets[slow.default]) / 2 / slow.unit))
    return edges


def _draw(
    ramps: Sequence[Ramped],
    pushes: Sequence[Pushed],
    steps: Sequence[Stepped],
    between_steps: float,
    figure: Figure,
) -> None:
    figure.set_size_inches(10, 4.4)
    left, middle, right = figure.subplots(1, 3, width_ratios=(1.2, 1.2, 0.8))
    for found, colour, marker in zip(ramps, COLOURS, "os^", strict=False):
        known = found.wall.multiplier
        error = 100 * (found.multiplier / known - 1)
        left.loglog(found.rate, error, marker, color=colour, ms=5, label=found.wall.name)
        left.loglog(found.rate, 100 * excess(found.wall, found.rate) / known, color=colour, lw=1)
    left.axvline(between_steps, color="0.6", lw=0.9, ls="--", zorder=0)
    left.annotate("between the\nsuite's steps", (0.93 * between_steps, 1.3), ha="right", color="0.4", fontsize=8)
    left.set(xlabel="rate of the ramp dλ/dt [1/s]", ylabel="λ too high by [%]", title="ramp; lines: theory")
    left.set(ylim=(1, 100), yticks=[1, 10, 100], yticklabels=["1", "10", "100"])
    for push, colour, marker in zip(pushes, COLOURS, "os^", strict=False):
        error = np.maximum(100 * np.abs(push.multiplier / push.wall.multiplier - 1), NOUGHT)
        middle.loglog(1e3 * push.speed, error, marker, ls="-", lw=1, color=colour, ms=5)
    middle.axhline(1, color="0.6", lw=0.8, ls=":")
    middle.annotate("1 %", (1.0, 1), xycoords=("axes fraction", "data"), ha="right", va="bottom", color="0.4")
    middle.set(xlabel="speed of the blocks [mm/s]", ylabel="peak of λ off by [%]", title="displacement control")
    middle.annotate(f"{NOUGHT:.4f} and less", (0.03, 0.1), xycoords="axes fraction", color="0.4", fontsize=8)
    _draw_brackets(right, steps)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    for axes in (left, middle, right):
        axes.title.set_fontsize(10)
        bare(axes)


def _draw_brackets(axes: Axes, steps: Sequence[Stepped]) -> None:
    places = np.arange(len(LOADINGS))
    for found, colour, aside in zip(steps, (*COLOURS[2:4], COLOURS[0]), (-0.2, 0, 0.2), strict=True):
        for place, loading in zip(places + aside, found.brackets, strict=True):
            axes.plot([place, place], found.off(loading), color=colour, lw=5, solid_capstyle="butt")
        axes.plot([], [], color=colour, lw=5, label=found.name)
        default = LOADINGS.index(found.default) + aside
        axes.annotate("▾", (default, max(found.off(found.default)) + 0.3), ha="center", color=colour, fontsize=11)
    axes.axhline(0, color="0.3", lw=0.8)
    axes.set_xticks(places, [f"{loading:g}" for loading in LOADINGS])
    axes.set(xlabel="first load step in\n[times to rest]; ▾ the suite's", ylabel="bracket of λ off by [%]")
    axes.set_title("load steps")
    axes.margins(y=0.15)
    axes.legend(frameon=False, fontsize=8, loc="center right")
