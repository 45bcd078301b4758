"""
How far a wall may lean
=======================

Pushed far, W1 carries less and less until it stands on the brink without any load. Codes assess walls by this curve,
which they assume straight: from the load of limit analysis to zero, where the wall overturns like a single block.
"""

import matplotlib.pyplot as plt
import numpy as np

import runningbond as rb

wall = rb.read("wall-w1")
pushed = wall.run("dem-dynamic", displacements="finite")
load, height = wall.run("limit").multiplier, wall.scene.blocks.extent(wall.scene.wall)[1][1]

figure, axes = plt.subplots()
axes.plot([0, height * np.sin(np.arctan(load))], [load, 0], color="0.7", label="limit, and a block as high")
axes.plot(pushed.curve["displacement"], pushed.curve["multiplier"], label="dem-dynamic, finite displacements")
axes.set(xlabel="displacement of the top [m]", ylabel="λ", ylim=(0, None), title="W1")
axes.legend()
print(pushed.message)
