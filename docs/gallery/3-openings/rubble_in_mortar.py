"""
Rubble in mortar
================

A survey shows the visible stones (grey), with the mortar between them. ``expand`` extends each stone to the middle of
joints up to this width: the result is blocks with joints of zero thickness (lines).
"""

from itertools import pairwise

import numpy as np
import shapely

import runningbond as rb

random, mortar = np.random.default_rng(8), 0.02
x, y = np.meshgrid(0.2 * np.arange(11), 0.25 * np.arange(9))
x[:, 1:-1] += random.uniform(-0.05, 0.05, (9, 9))
y[1:] += random.uniform(-0.04, 0.04, (8, 11))
at, heads = np.stack([x, y], axis=-1), ([0, 2, 4, 6, 8, 10], [0, 1, 3, 5, 7, 9, 10])  # stone ends, even and odd courses
pairs = [(k, left, right + 1) for k in range(8) for left, right in pairwise(heads[k % 2])]
cells = [shapely.Polygon([*at[k, left:end], *at[k + 1, left:end][::-1]]) for k, left, end in pairs]
stones = shapely.buffer(shapely.buffer(cells, -mortar / 2 - 0.02, join_style="mitre"), 0.02, quad_segs=2)

solid = {"thickness": 0.5, "density": 2300.0, "friction": 0.65}
wall = rb.Wall.outlines([stone.exterior.coords[:] for stone in stones], expand=1.3 * mortar, **solid)
print(wall, *wall.scene.notes, f"λ = {wall.run('limit').multiplier:.3f}", sep="\n")
axes = wall.plot()
for stone in stones:
    axes.fill(*stone.exterior.xy, facecolor="0.6", zorder=2)
