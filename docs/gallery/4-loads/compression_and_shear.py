"""
The more pressure, the more shear
=================================

A shear wall under a beam: its horizontal strength over the vertical load, with a beam that is free to rotate or level.
"""

import matplotlib.pyplot as plt
import numpy as np

import runningbond as rb

size = {"length": 0.6, "height": 1.2, "block_width": 0.3, "block_height": 0.15, "thickness": 0.2}
beam = {"height": 0.2, "drive": {"force": [1.0, 0.0]}}
wall = rb.Wall.running_bond(**size, density=2000.0, friction=0.75, title="under a beam", beam=beam)
forces = np.linspace(1.0, 200.0, 6)

figure, axes = plt.subplots()
for condition in ("free", "level"):
    walls = [wall.with_(beam={"condition": condition, "force": [0.0, -1e3 * n]}) for n in forces]
    axes.plot(forces, [each.run("limit").multiplier / 1e3 for each in walls], "o-", label=condition)
axes.set(xlabel="pressed with [kN]", ylabel="bears horizontally [kN]", title="Beam that turns freely, or stays level")
axes.legend()

# %%
# Under the level beam the thrust line runs from corner to corner.
walls[-1].run("limit").plot()
