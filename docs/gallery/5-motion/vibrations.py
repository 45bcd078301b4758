"""
How a wall sways
================

Natural vibrations of a wall at rest under its weight, with closed joints as springs. In the first three the wall sways,
bends and bounces.
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Polygon

import runningbond as rb
from dem.dynamic import dem_vibration

scene = rb.read("panel-10").scene
vibration = dem_vibration(scene, 3)
figure, axes = plt.subplots(1, 3, figsize=(8, 5))
for k, each in enumerate(axes):
    motion = vibration.shape[k] / np.abs(vibration.shape[k][:, :2]).max() * 0.15
    for b in np.flatnonzero(scene.wall):
        arm = scene.blocks.polygon(int(b)) - scene.blocks.centroid[b]
        turned = arm + motion[b, 2] * np.column_stack([-arm[:, 1], arm[:, 0]])
        each.add_patch(Polygon(scene.blocks.centroid[b] + motion[b, :2] + turned, fc="#b8c7d9", ec="0.3", lw=0.5))
    each.set(aspect="equal", xlim=(-0.25, 1.7), ylim=(-0.1, 3.1), title=f"{vibration.frequency[k]:.0f} Hz")
    each.axis("off")
