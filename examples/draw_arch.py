"""Draw an arch on two piers: blocks on the layers PIERS and ARCH, the ground on the layer GROUND; in millimetres."""

import sys
from itertools import pairwise

import ezdxf
import numpy as np

SPAN, RISE_AT, PIER, RING, VOUSSOIRS = 4000.0, 2500.0, 600.0, 300.0, 15


def rectangle(x: float, y: float, width: float, height: float) -> list[tuple[float, float]]:
    """Corners of a rectangle from its lower left one."""
    return [(x, y), (x + width, y), (x + width, y + height), (x, y + height)]


def main(path: str) -> None:
    """Write the drawing."""
    document = ezdxf.new("R2000")  # type: ignore[attr-defined]
    space = document.modelspace()
    space.add_lwpolyline(
        rectangle(-1000, -500, SPAN + 2 * PIER + 2000, 500), close=True, dxfattribs={"layer": "GROUND"}
    )
    for x in (0.0, PIER + SPAN):
        for y in np.arange(0, RISE_AT, 500.0):
            space.add_lwpolyline(rectangle(x, y, PIER, 500.0), close=True, dxfattribs={"layer": "PIERS"})
    middle = PIER + SPAN / 2
    rays = np.linspace(np.pi, 0, VOUSSOIRS + 1)
    inner, outer = SPAN / 2, SPAN / 2 + RING
    for a, b in pairwise(rays):
        corners = [
            (r * np.cos(t) + middle, r * np.sin(t) + RISE_AT)
            for r, t in ((inner, a), (inner, b), (outer, b), (outer, a))
        ]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": "ARCH"})
    document.saveas(path)


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "arch_on_piers.dxf")
