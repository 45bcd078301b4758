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

from compare.figures import COLOURS, bare
from dynamics import Criteria, Run, State, drive, load_steps, moved_by, settled_drive
from dynamics.controls import RAMP
from dynamics.run import LOCAL
from dynamics.verdict import FIRST_STEP
from scene import Array

from .finding import Edge, Entry, Finding
from .known import KnownWall, rounded_wall, sliding_block, toppling_block

RATES = 10.0 ** -(np.arange(7) / 3)
"""Rates of λ [1/s]."""

PUSHES = tuple(1_000 * 2**k for k in range(12))
"""Steps in which a wall is pushed as far as a load step may move it: the more, the slower."""

RAMPS = (0, 1, 2, RAMP, 8, 16)
"""Lengths of the ramp to each load step, in times that the wall took to rest under the first one."""

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


def bracket(wall: KnownWall, ramp_length: int) -> tuple[float, float]:
    """Bracket of λ by load steps, with a ramp to each of them."""
    run = Run(wall.system)
    first = FIRST_STEP / wall.system.measure(wall.system.live)
    found = load_steps(run, first, BRACKET, Criteria(collapse=wall.far), ramp_length=ramp_length)
    assert found.lower is not None
    assert found.upper is not None
    return found.lower, found.upper


def rate_between_steps(wall: KnownWall) -> float:
    """Rate [1/s] of the suite's ramp to its first load step."""
    run, rest = wall.rest()
    first = FIRST_STEP / wall.system.measure(wall.system.live)
    return first / (RAMP * rest.steps * run.dt)


def experiment() -> Finding:
    """Load blocks and a wall at many speeds, by each of the three controls."""
    walls = (sliding_block(), toppling_block(), rounded_wall("wall-w1"))
    ramps = [ramped(wall) for wall in walls]
    pushes = [pushed(wall) for wall in walls]
    masonry = walls[-1]
    brackets = {length: bracket(masonry, length) for length in RAMPS}
    run, rest = masonry.rest()
    settled = settled_drive(run, rest, masonry.far, 0.01)
    rows: list[tuple[Entry, ...]] = []
    for found in ramps:
        rows += [
            ("ramp", found.wall.name, f"{rate:.3g} 1/s", multiplier, _off(found.wall, multiplier))
            for rate, multiplier in zip(found.rate, found.multiplier, strict=True)
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
    for length, (lower, upper) in brackets.items():
        middle = (lower + upper) / 2
        rows.append(("load steps", masonry.name, f"{length} times to rest", middle, _off(masonry, middle)))
    return Finding(
        title="Loading rate: ramp, displacement control and load steps",
        heads=("control", "wall", "speed", "λ", "off by [%]"),
        rows=rows,
        edges=_edges(ramps, pushes, brackets),
        trust="Load steps at any ramp, for each load is held until the wall rests or falls. A ramp only extrapolated "
        "to no speed: its error falls with the rate to the power 2/3. A peak under displacement control below "
        f"{1e3 * min(push.fit for push in pushes):.1g} mm/s, to some tenths of a per cent: sliding contacts chatter.",
        beyond="A λ that is too high. No model of the suite takes its λ from a ramp or a displacement. A peak settled "
        f"by halving the speed may settle too early, here {_off(masonry, settled.peak)} % off where `rate_error` is "
        f"{100 * settled.rate_error / settled.peak:.1g} %. A search by load steps that slower loading still moves ends "
        "`undecided` and says by how much.",
        draw=partial(_draw, ramps, pushes, brackets, rate_between_steps(masonry)),
    )


def _falls_at(run: Run, rest: State, rate: float, far: float) -> float:
    state, multiplier = rest.copy(), 0.0
    step = rate * LOOK * run.dt
    while moved_by(run.system, state, rest.motion) < far:
        run.hold(state, multiplier + step / 2, LOOK)
        multiplier += step
    return multiplier - step / 2


def _off(wall: KnownWall, multiplier: float) -> str:
    return f"{100 * (multiplier / wall.multiplier - 1):+.2g}"


def _edges(ramps: Sequence[Ramped], pushes: Sequence[Pushed], brackets: dict[int, tuple[float, float]]) -> list[Edge]:
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
    lower, upper = brackets[RAMP]
    wall = ramps[-1].wall
    edges.append(Edge(f"λ by the suite's load steps, {wall.name}", (lower + upper) / 2, wall.multiplier, BRACKET))
    return edges


def _draw(
    ramps: Sequence[Ramped],
    pushes: Sequence[Pushed],
    brackets: dict[int, tuple[float, float]],
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
    _draw_brackets(right, ramps[-1].wall, brackets)
    figure.legend(*left.get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    for axes in (left, middle, right):
        axes.title.set_fontsize(10)
        bare(axes)


def _draw_brackets(axes: Axes, wall: KnownWall, brackets: dict[int, tuple[float, float]]) -> None:
    places = range(len(brackets))
    for place, (lower, upper) in zip(places, brackets.values(), strict=True):
        ends = (100 * (lower / wall.multiplier - 1), 100 * (upper / wall.multiplier - 1))
        axes.plot([place, place], ends, color=COLOURS[2], lw=5, solid_capstyle="butt")
    axes.axhline(0, color="0.3", lw=0.8)
    axes.axvline(list(brackets).index(RAMP), color="0.6", lw=0.9, ls="--", zorder=0)
    axes.annotate("default", (list(brackets).index(RAMP) - 0.1, -0.95), ha="right", color="0.4", fontsize=8)
    axes.set_xticks(places, [str(length) for length in brackets])
    axes.set(xlabel="ramp to each load\n[times to rest]", ylabel="bracket of λ off by [%]", ylim=(-1, 1))
    axes.set_title(f"load steps, {wall.name}")
