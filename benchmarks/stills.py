"""Stills of a fall: a wall with a door under a sine pulse of the ground, by `dem-dynamic`.

python benchmarks/stills.py [docs/ground-motion-fall.png]
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import runningbond as rb
from runningbond.dynamics import Run, State
from runningbond.pictures.captions import show_extent, to_png
from runningbond.pictures.deformed_shape import DeformedShape, common_extent
from runningbond.pictures.flat import line_width, paint_mechanism
from runningbond.scene import Array, Scene

SCALE, MOMENTS, AFTER = 1.0, (0.6, 1.0, 1.3, 1.6), 0.2
"""λ, times that are drawn [s], and time followed after the first block has fallen [s]."""

WIDTH = 8.4
"""Width of the picture [in]."""


def wall() -> rb.Wall:
    """A wall of blocks of 500 × 250 mm with a door under a lintel."""
    return rb.Wall.running_bond(
        length=3.0,
        height=2.5,
        block_width=0.5,
        block_height=0.25,
        thickness=0.3,
        density=2000.0,
        friction=0.7,
        normal_stiffness=1e9,
        shear_stiffness=4e8,
        title="wall with a door",
        wall={"opening": [{"from": [1.0, 0.0], "to": [2.0, 1.75], "lintel": {"height": 0.25, "bearing": 0.25}}]},
        history={"pulse": {"kind": "sine", "amplitude": 0.6, "period": 1.0}, "quantity": "g"},
    )


def moment(scene: Scene, motion: Array) -> DeformedShape:
    """Shape of the wall after motions of any size, ``(nb, 3)`` [m, m, rad], drawn to scale."""
    shape = DeformedShape.of_rigid_blocks(scene, motion, np.zeros(len(scene.joints), np.int64), 0.0)
    block = np.repeat(shape.block, np.diff(shape.first))
    arm, (u, v, spin) = shape.points - scene.blocks.centroid[block], motion[block].T
    (x, y), c, s = arm.T, np.cos(spin), np.sin(spin)
    return replace(shape, displacement=np.column_stack([u + c * x - s * y - x, v + s * x + c * y - y]), scale=1.0)


def main() -> None:
    """Compute the response and draw the stills."""
    masonry, film = wall(), list[tuple[float, Array]]()

    def observe(run: Run, state: State, _: float) -> None:
        film.append((state.time, run.system.motion_of_bodies(state.motion)))

    response = masonry.respond("dem-dynamic", SCALE, observe=observe, after=AFTER)
    print(response.message)
    start, scene = film[0][0], masonry.scene
    times = np.array([time - start for time, _ in film])
    shapes = [moment(scene, film[int(np.abs(times - at).argmin())][1]) for at in MOMENTS]
    left, right, bottom, top = common_extent(shapes)
    width = WIDTH / len(shapes)
    height = width * (top - bottom) / (right - left)
    figure = Figure(figsize=(WIDTH, height + 0.25), layout="constrained")
    for axes, shape, at in zip(figure.subplots(1, len(shapes)), shapes, MOMENTS, strict=True):
        show_extent(axes, (left, right, bottom, top))
        paint_mechanism(axes, shape, line_width(scene, (left, right, bottom, top), (width, height)))
        axes.set_title(f"{at:g} s", fontsize=8)
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_bytes(to_png(figure, 200))


if __name__ == "__main__":
    main()
