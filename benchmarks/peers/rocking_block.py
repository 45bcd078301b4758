"""A block of 0.5 × 2 m under ground motion: `dem-dynamic` and engines for games and robots beside Housner's equation.

    PYTHONPATH=. python benchmarks/peers/rocking_block.py

Needs ``pip install -e '.[peers]'``; the table has a line for an engine that is missing. Pulses are 5 % below and above
six overturning thresholds of Housner's block (Zhang & Makris 2001). All programs integrate in the frame of the ground,
each step under the mean ground acceleration over it, from rest under gravity until the block has overturned or
`SECONDS` after the pulse. Engines run in turn on each pulse, in one process; seconds are processor time for the motion
only, without building and settling. Engines have the settings of the walls' table (see the docstrings of their
modules), and also a tenth of the time step. The last table is the cost of a second of motion for a wall of 300 blocks,
from `MANY` seconds of it.
"""

import math
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib import import_module
from importlib.util import find_spec
from itertools import product
from typing import Any, TypeAlias

import numpy as np
from walls import wall_of

from runningbond.dynamics import Run
from runningbond.response import Resting, follow
from runningbond.response.follow import PART
from runningbond.response.ground import Ground
from runningbond.scene import History
from tests.response.housner import GRAVITY, HousnerBlock
from tests.response.walls import block, resting, shaken, still

BLOCK = HousnerBlock()
UNIT = GRAVITY * BLOCK.b / BLOCK.h
EDGES = (  # cycles, ω / p, amplitude in g tan α
    (0.5, 2, 1.801),
    (0.5, 4, 2.798),
    (1.0, 2, 1.223),
    (1.0, 4, 1.780),
    (1.0, 4, 5.0215),
    (1.0, 4, 5.3174),
)
SIDES = (0.95, 1.05)
ENGINES = (  # package, module of this folder, and its class
    ("pymunk", "pymunk_wall", "PymunkWall"),
    ("mujoco", "mujoco_wall", "MujocoWall"),
    ("Box2D", "box2d_wall", "Box2DWall"),
)
CROWD, MANY = "120x60", 0.1
SECONDS, SETTLE, LIES = 6.0, 1.0, math.radians(60)

Answer: TypeAlias = tuple[float, float, float]
"""Largest rotation [rad], inf if the block falls; processor seconds; seconds of motion."""


@dataclass(frozen=True)
class Pulse:
    """Cycles of a sine, its frequency ω / p, and its amplitude in g tan α."""

    cycles: float
    ratio: float
    scale: float

    @property
    def period(self) -> float:
        """Period of the sine [s]."""
        return 2 * math.pi / (self.ratio * BLOCK.p)

    @property
    def history(self) -> History:
        """Ground motion for λ = 1."""
        return shaken("sine" if self.cycles == 1 else "half-sine", UNIT, self.period)

    @property
    def exact(self) -> float:
        """Largest rotation of Housner's block [rad], inf if it overturns."""
        return BLOCK.peak(self.scale * UNIT, self.period, self.cycles)


def ours(stiffness: float) -> Callable[[Pulse], Answer]:
    """`dem-dynamic` with a joint stiffness [Pa/m], as a function of the pulse."""
    rest = resting(block(BLOCK.b, BLOCK.h, still(), stiffness=stiffness))
    corners = np.array([[0.0, 2 * BLOCK.h], [2 * BLOCK.b, 2 * BLOCK.h]])

    def answer(pulse: Pulse) -> Answer:
        shaken_scene = replace(rest.scene, load=replace(rest.scene.load, live=(pulse.history,)))
        wall = Resting(shaken_scene, rest.model, rest.system, rest.state, rest.verdict)
        start = time.process_time()
        response = follow(wall, pulse.scale, points=corners, rows=50)
        spent = time.process_time() - start
        side = np.diff(corners + response.displacement, axis=1)[:, 0]
        falls = response.verdict == "collapse"
        peak = math.inf if falls else float(np.abs(np.arctan2(side[:, 1], side[:, 0])).max())
        return peak, spent, float(response.time[-1])

    return answer


def engine(kind: Any, step: float) -> Callable[[Pulse], Answer]:
    """An engine, by the class of its wall in this folder, as a function of the pulse."""

    def answer(pulse: Pulse) -> Answer:
        scene = block(BLOCK.b, BLOCK.h, still())
        wall, history, moving = kind.of(scene, step), pulse.history, int(np.flatnonzero(~scene.fixed)[0])
        wall.hold(0.0, SETTLE)
        steps = round((history.duration + SECONDS) / step)
        loads, peak, taken, start = means(history, pulse.scale, step, steps), 0.0, 0, time.process_time()
        while taken < steps and peak < LIES:
            wall.hold(loads[taken], step)
            peak = max(peak, abs(float(wall.rotation()[moving])))
            taken += 1
        return math.inf if peak >= LIES else peak, time.process_time() - start, taken * step

    return answer


def competitors() -> dict[str, Callable[[Pulse], Answer] | None]:
    """All programs with their settings; None for those that are not installed."""
    found: dict[str, Callable[[Pulse], Answer] | None] = {
        f"`dem-dynamic`, {stiffness:.0e} Pa/m".replace("+", ""): ours(stiffness) for stiffness in (1e10, 1e11)
    }
    for (package, module, name), part in product(ENGINES, (1.0, 0.1)):
        code = import_module(module)
        step = part * code.STEP
        installed = find_spec(package) is not None
        found[f"{package}, {1e3 * step:g} ms"] = engine(getattr(code, name), step) if installed else None
    return found


def main() -> None:
    """Print the tables."""
    sides = sorted((cycles, ratio, side * scale) for cycles, ratio, scale in EDGES for side in SIDES)
    pulses = [Pulse(*side) for side in sides]
    runs = competitors()
    found: dict[str, list[Answer]] = {name: [] for name, run in runs.items() if run}
    for name in found:
        answer(runs, name, pulses[0])  # loads the kernels
    print("largest rotation in α, or a fall, by pulse: cycles, ω / p, amplitude in g tan α\n")
    names = list(found)
    print("| pulse | Housner | " + " | ".join(names) + " |\n" + "|---" * (len(names) + 2) + "|")
    exact = [pulse.exact for pulse in pulses]
    for pulse, right in zip(pulses, exact, strict=True):
        for name in names:
            found[name].append(answer(runs, name, pulse))
        cells = [told(right), *(told(found[name][-1][0]) for name in names)]
        print(f"| {pulse.cycles:g}, {pulse.ratio:g}, {pulse.scale:.3f} | " + " | ".join(cells) + " |", flush=True)
    print("\n| program | verdicts | rotation off by, at most (mean) | CPU s a second of motion | times the first's |")
    print("|---|---|---|---|---|")
    first = cost(found[names[0]])
    for name in runs:
        if name not in found:
            print(f"| {name} | not installed | | | |")
            continue
        peaks = [row[0] for row in found[name]]
        same = sum((a == math.inf) == (b == math.inf) for a, b in zip(peaks, exact, strict=True))
        off = [abs(a / b - 1) for a, b in zip(peaks, exact, strict=True) if math.inf not in (a, b)]
        each = f"{max(off):.1%} ({np.mean(off):.1%})" if off else "–"
        own = cost(found[name])
        print(f"| {name} | {same} of {len(peaks)} | {each} | {own:.3f} | {own / first:.1f} |")
    print(f"\n| program | CPU s a second of motion of {int(wall_of(CROWD).wall.sum())} blocks |\n|---|---|")
    for name, spent in crowd():
        print(f"| {name} | " + ("not installed" if spent is None else f"{spent:.1f}") + " |", flush=True)


def means(history: History, scale: float, step: float, steps: int) -> list[float]:
    """Mean inertia force on the blocks in each step, relative to their weight."""
    velocity = scale * history.velocity(np.linspace(0.0, step * steps, steps + 1))[:, 0]
    return [float(-x) for x in np.diff(velocity) / (step * GRAVITY)]


def crowd() -> Iterator[tuple[str, float | None]]:
    """Processor seconds per second of motion, by program, for a wall of many blocks under a sine of 2 Hz and 0.3 g.

    They are None for a program that is not installed.
    """
    scene = wall_of(CROWD)
    history = shaken("sine", 0.3 * GRAVITY, 0.5)
    rest = resting(replace(scene, load=replace(scene.load, live=(history,))))
    run, state = Run(rest.system, local=0.0, viscous=rest.viscous, part=PART), rest.state.copy()
    ground = Ground(run, history, 1.0, state.time)
    ground.bring(state, MANY / 10)
    start = time.process_time()
    ground.bring(state, 1.1 * MANY)
    yield "`dem-dynamic`", (time.process_time() - start) / MANY
    for package, module, name in ENGINES:
        code = import_module(module)
        if find_spec(package) is None:
            yield package, None
            continue
        wall = getattr(code, name).of(scene)
        wall.hold(0.0, MANY)
        loads, start = means(history, 1.0, code.STEP, round(MANY / code.STEP)), time.process_time()
        for load in loads:
            wall.hold(load, code.STEP)
        yield f"{package}, {1e3 * code.STEP:g} ms", (time.process_time() - start) / MANY


def answer(runs: dict[str, Callable[[Pulse], Answer] | None], name: str, pulse: Pulse) -> Answer:
    """Answer of an installed program for a pulse."""
    run = runs[name]
    assert run is not None
    return run(pulse)


def told(peak: float) -> str:
    """Text for a rotation, relative to α, or for a fall."""
    return "falls" if peak == math.inf else f"{peak / BLOCK.alpha:.3f}"


def cost(answers: list[Answer]) -> float:
    """Processor seconds per second of motion."""
    return sum(row[1] for row in answers) / sum(row[2] for row in answers)


if __name__ == "__main__":
    main()
