"""Overturning spectrum of a block under ground pulses, beside that of Housner's equation: a table and a chart.

``PYTHONPATH=. python benchmarks/overturning_spectrum.py [chart.png]`` takes some minutes.
"""

import math
import sys
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from runningbond.response import follow
from tests.response.housner import GRAVITY, HousnerBlock, edge
from tests.response.walls import block, resting, shaken, still

BLOCK = HousnerBlock()
UNIT = GRAVITY * BLOCK.b / BLOCK.h
EDGES = {  # by number of cycles: ω / p, and approximate amplitude in g tan α at which the verdict changes
    0.5: ((1, 1.32), (2, 1.80), (4, 2.80), (6, 3.80), (8, 4.78)),
    1.0: ((2, 1.22), (3, 1.40), (4, 1.78), (4, 5.02), (4, 5.32), (6, 4.57), (6, 8.55), (6, 9.70)),
}
NAMES = {0.5: "half-sine", 1.0: "sine"}


def spectrum() -> list[tuple[float, float, float, float]]:
    """Cycles, ω / p, and amplitudes in g tan α at which the verdict changes, for Housner's block and `dem-dynamic`."""
    rest = resting(block(BLOCK.b, BLOCK.h, still()))
    found: list[tuple[float, float, float, float]] = []
    for cycles, edges in EDGES.items():
        for ratio, about in edges:
            period = 2 * math.pi / (ratio * BLOCK.p)
            shakes = replace(rest, scene=block(BLOCK.b, BLOCK.h, shaken(NAMES[cycles], UNIT, period)))

            def exactly(scale: float, period: float = period, cycles: float = cycles) -> bool:
                return BLOCK.overturns(scale * UNIT, period, cycles)

            def ours(scale: float, shakes: object = shakes) -> bool:
                return follow(shakes, scale, rows=50).verdict == "collapse"  # type: ignore[arg-type]

            exact = edge(exactly, about, tolerance=2e-4)
            own = exact and edge(ours, exact)
            if exact and own:
                found.append((cycles, ratio, exact, own))
                print(f"{NAMES[cycles]:9s} {ratio:3g} {exact:8.4f} {own:8.4f} {own / exact - 1:+7.2%}", flush=True)
    return found


def curves(cycles: float) -> list[tuple[float, float, bool]]:
    """ω / p and amplitudes at which the verdict on Housner's block changes, and whether it overturns above."""
    found = []
    for ratio in np.linspace(1.0, 8.0, 15):
        period = 2 * math.pi / (ratio * BLOCK.p)

        def falls(scale: float, period: float = period) -> bool:
            return BLOCK.overturns(scale * UNIT, period, cycles)

        scales = 1.02 * 1.05 ** np.arange(49)
        verdicts = [falls(scale) for scale in scales]
        for k in np.flatnonzero(np.diff(verdicts)):
            middle = edge(falls, float(np.sqrt(scales[k] * scales[k + 1])), 0.025, 5e-3)
            if middle:
                found.append((float(ratio), middle, verdicts[k + 1]))
    return found


def chart(found: list[tuple[float, float, float, float]], path: str) -> None:
    """Draw the results of `dem-dynamic` over the spectrum by Housner's equation."""
    figure = Figure(figsize=(8.4, 3.8), layout="constrained", dpi=160)
    for axes, cycles in zip(figure.subplots(1, 2, sharey=True), EDGES, strict=True):
        edges = curves(cycles)
        first = {ratio: min(scale for r, scale, _ in edges if r == ratio) for ratio, _, _ in edges}
        axes.plot(list(first), list(first.values()), color="#c2410c", lw=1.2, label="Housner: falls above")
        again = [(r, scale, falls) for r, scale, falls in edges if scale > first[r]]
        for falls, style, name in ((False, "--", "stands again above"), (True, "-.", "falls without impact above")):
            line = [(r, scale) for r, scale, above in again if above == falls]
            if line:
                axes.plot(*zip(*line, strict=True), style, color="#c2410c", lw=1.2, label=name)
        rows = np.array([row for row in found if row[0] == cycles])
        axes.plot(rows[:, 1], rows[:, 3], "o", ms=5, color="#0b559f", label="dem-dynamic")
        axes.set_title(f"{NAMES[cycles]} of acceleration")
        axes.set_xlabel("frequency of the pulse ω / p")
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False, loc="upper left")
    figure.axes[0].set_ylabel("amplitude / (g tan α)")
    figure.savefig(path)


if __name__ == "__main__":
    edges = spectrum()
    if len(sys.argv) > 1:
        chart(edges, sys.argv[1])
