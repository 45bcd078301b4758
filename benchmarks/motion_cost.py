"""Cost against size: processor seconds of `dem-dynamic` per second of ground motion, on running-bond panels.

    PYTHONPATH=. python benchmarks/motion_cost.py [docs/ground-motion-cost.png]

The ground moves by a sine of 2.5 Hz, under which the panel holds together (0.1 g) or slides and rocks (1 g). The wall
starts at rest; `SPAN` seconds from an eighth of the period on are measured, medians of `RUNS` runs in turn.
"""

import statistics
import sys
import time
from dataclasses import replace

from cost_over_size import panel
from matplotlib.figure import Figure

from runningbond.dynamics import Run
from runningbond.response import Resting
from runningbond.response.follow import PART
from runningbond.response.ground import Ground
from runningbond.scene import History
from runningbond.scene.history import STANDARD_GRAVITY, pulse
from tests.response.walls import resting

ACROSS = (4, 6, 9, 12, 17, 24, 39)
"""Blocks per course; the number of courses is twice as large."""

PERIOD, SPAN, RUNS = 0.4, 0.1, 3
MOTIONS = {"0.1 g: holds together": (0.1, "#0b559f", "o"), "1 g: slides and rocks": (1.0, "#c2410c", "s")}


def spent(rest: Resting, history: History) -> tuple[float, float]:
    """Processor seconds per second of motion, and time step [s]."""
    run, state = Run(rest.system, local=0.0, viscous=rest.viscous, part=PART), rest.state.copy()
    ground = Ground(run, history, 1.0, state.time)
    ground.bring(state, PERIOD / 8)
    start, begin = time.process_time(), state.time
    ground.bring(state, PERIOD / 8 + SPAN)
    return (time.process_time() - start) / (state.time - begin), run.dt


def measured() -> list[tuple[int, float, dict[str, float]]]:
    """Number of blocks, time step [s], and processor seconds per second of each motion, for each size."""
    rows: list[tuple[int, float, dict[str, float]]] = []
    histories = {
        name: History(*pulse("sine", amplitude * STANDARD_GRAVITY, PERIOD), interval=PERIOD / 200)
        for name, (amplitude, *_) in MOTIONS.items()
    }
    print("blocks   step [µs]   " + "   ".join(f"{name:>22}" for name in MOTIONS) + "   CPU s a second of motion")
    for across in ACROSS:
        scene = panel(across)
        rest = resting(replace(scene, load=replace(scene.load, live=(histories["0.1 g: holds together"],))))
        if not rows:
            spent(rest, histories["0.1 g: holds together"])  # loads the kernels
        runs: dict[str, list[tuple[float, float]]] = {name: [] for name in MOTIONS}
        for _ in range(RUNS):
            for name, history in histories.items():
                runs[name].append(spent(rest, history))
        medians = {name: statistics.median(seconds for seconds, _ in each) for name, each in runs.items()}
        blocks, step = int(scene.wall.sum()), min(dt for each in runs.values() for _, dt in each)
        rows.append((blocks, step, medians))
        print(f"{blocks:6d} {1e6 * step:11.2f}   " + "   ".join(f"{x:22.2f}" for x in medians.values()), flush=True)
    return rows


def chart(rows: list[tuple[int, float, dict[str, float]]]) -> Figure:
    """Draw the cost on logarithmic axes, with lines at one and three processor seconds per second."""
    figure = Figure(figsize=(6.4, 4.2), layout="constrained")
    axes = figure.add_subplot()
    blocks = [row[0] for row in rows]
    for name, (_, colour, marker) in MOTIONS.items():
        axes.plot(blocks, [row[2][name] for row in rows], color=colour, marker=marker, label=name)
    for ratio, name in ((1.0, "real time"), (3.0, "3 s a second")):
        axes.axhline(ratio, color="0.4", linewidth=0.8, linestyle="--")
        axes.text(blocks[-1], ratio * 1.06, name, color="0.35", fontsize=8, ha="right")
    axes.set(xscale="log", yscale="log", xlabel="blocks of a running-bond panel")
    axes.set_ylabel("processor seconds a second of motion")
    axes.grid(which="major", color="0.9")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(frameon=False, loc="upper left")
    return figure


if __name__ == "__main__":
    table = measured()
    if len(sys.argv) > 1:
        chart(table).savefig(sys.argv[1], dpi=160)
