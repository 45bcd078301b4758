"""
Rubble that is shaken
=====================

Stones are given corner by corner, as in a survey, and need not be convex: here merged cells of an irregular grid.
"""

import numpy as np
import shapely

import runningbond as rb

of_stone = ["ppqqsrr", "pmqnnor", "lmmnook", "lijjjkk", "iiggjhk", "eegfhhd", "eabffcd", "aabbccd"]  # from below
cells = np.array([*map(list, of_stone)])
x, y = np.meshgrid(0.3 * np.arange(8), 0.25 * np.arange(9))
random = np.random.default_rng(1)
x[1:-1, 1:-1] += random.uniform(-0.07, 0.07, (7, 6))
y[1:-1] += random.uniform(-0.05, 0.05, (7, 8))
rings = [np.stack([z[:-1, :-1], z[:-1, 1:], z[1:, 1:], z[1:, :-1]], axis=-1) for z in (x, y)]
stones = [shapely.union_all(shapely.polygons(np.stack(rings, axis=-1))[cells == one]) for one in np.unique(cells)]
motion = {"pulse": {"kind": "sine", "amplitude": 1.0, "period": 1.2}, "quantity": "g"}
solid = {"thickness": 0.5, "density": 2400.0, "friction": 0.7, "normal_stiffness": 1e9, "shear_stiffness": 4e8}
wall = rb.Wall.outlines([each.exterior.coords[:] for each in stones], **solid, history=motion)
wall.respond("dem-dynamic", after=1.2).plot()
