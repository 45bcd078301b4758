"""
What a little mortar does
=========================

The smaller a wall, the more cohesion matters: it acts on areas, weight on volumes.
"""

import matplotlib.pyplot as plt
import numpy as np

import runningbond as rb

wall = rb.read("panel-10")
cohesion = (np.array([0.0, 0.25, 0.5, 1.0, 2.0, 4.0]) * 1e3).tolist()
table = rb.sweep(wall, {"joint.cohesion": cohesion}, "limit", jobs=1)

figure, axes = plt.subplots()
axes.plot(np.array(cohesion) / 1e3, table["multiplier"], "o-")
axes.set(xlabel="cohesion [kPa]", ylabel="λ", title=wall.scene.title)

# %%
# The mechanism depends on the cohesion: here at 4 kPa.
wall.with_({"joint.cohesion": 4e3}).run("limit").plot()
