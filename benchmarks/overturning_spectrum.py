"""Overturning spectrum of a block under pulses of the ground beside Housner's equation: a table and a chart.

``python benchmarks/overturning_spectrum.py [chart.png]``; some minutes.
"""

import math
import sys
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from runningbond.response import follow
from tests.response.housner import GRAVITY, HousnerBlock
from tests.response.walls import block, resting, shaken, still

BLOCK = HousnerBlock()
UNIT = GRAVITY * BLOCK.b / BLOCK.h
EDGES = {  # ω / p, and about where what a block does changes
    0.5: ((1, 1.32), (2, 1.80), (4, 2.80), (6, 3.80), (8, 4.78)),
    1.0: ((2, 1.22), (3, 1.40), (4, 1.78), (4, 5.02), (4, 5.32), (5, 2.7), (6, 4.57), (6, 8.55), (6, 9.70)),
}
NAMES = {0.5: "half-sine", 1.0: "sine"}


def edge(falls: Callable[[float], bool], about: float, width: float = 0.04, tolerance: float = 2e-3) -> float | None:
    """Where a verdict changes, within a width about a scale."""
    low, high = about * (1 - width), about * (1 + width)
    at_low = falls(low)
    if falls(high) == at_low:
        return None
    while high - low > tolerance * high:
        middle = (low + high) / 2
        low, high = (middle, high) if falls(middle) == at_low else (low, middle)
    return (low + high) / 2


def spectrum() -> list[tuple[float, float, float, float]]:
    """Cycles, ω / p, and the edges of Housner's block and of ours, in g tan α."""
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


def curves() -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
    """Housner's verdicts on a grid of ω / p and scales for both pulses."""
    ratio, scale = np.linspace(0.8, 8.2, 21), np.linspace(1.0, 11.0, 51)
    verdicts = [
        np.array([[BLOCK.overturns(s * UNIT, 2 * math.pi / (r * BLOCK.p), cycles) for r in ratio] for s in scale])
        for cycles in EDGES
    ]
    return ratio, verdicts, scale


def chart(found: list[tuple[float, float, float, float]], path: str) -> None:
    """Draw ours on Housner's."""
    figure = Figure(figsize=(8.4, 3.8), layout="constrained", dpi=160)
    ratio, verdicts, scale = curves()
    for axes, cycles, verdict in zip(figure.subplots(1, 2, sharey=True), EDGES, verdicts, strict=True):
        axes.contourf(ratio, scale, verdict, levels=[0.5, 1.5], colors=["#f2c879"], alpha=0.7)
        axes.contour(ratio, scale, verdict, levels=[0.5], colors="#c2410c", linewidths=1.0)
        rows = np.array([row for row in found if row[0] == cycles])
        axes.plot(rows[:, 1], rows[:, 3], "o", ms=5, color="#0b559f", label="dem-dynamic: edge of falling")
        axes.fill_between([], [], color="#f2c879", alpha=0.7, label="Housner's block falls")
        axes.set_title(f"{NAMES[cycles]} of acceleration")
        axes.set_xlabel("frequency of the pulse ω / p")
        axes.spines[["top", "right"]].set_visible(False)
    figure.axes[0].set_ylabel("amplitude / (g tan α)")
    figure.axes[0].legend(frameon=False, loc="upper left")
    figure.savefig(path)


if __name__ == "__main__":
    edges = spectrum()
    if len(sys.argv) > 1:
        chart(edges, sys.argv[1])
