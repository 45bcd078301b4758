"""
A block that rocks: λ to the very end
=====================================

At finite displacements a rocking block carries λ = tan(α − θ), with its rotation θ and tan α = b / h. One run follows
it until it is balanced on its corner.
"""

import matplotlib.pyplot as plt
import numpy as np

import runningbond as rb

size = {"block_width": 0.25, "block_height": 1.0, "thickness": 0.2}
springs = {"normal_stiffness": 1e9, "shear_stiffness": 4e8}
block = rb.Wall.courses([[1]], **size, density=2000.0, friction=0.8, **springs)
curve = block.run("dem-dynamic", displacements="finite").curve
theta = np.linspace(0, np.arctan(0.25), 50)

figure, axes = plt.subplots()
axes.plot(np.sin(theta), np.tan(theta[-1] - theta), lw=4, color="0.8", label="tan(α − θ)")
axes.plot(curve["displacement"], curve["multiplier"], label="dem-dynamic")
axes.set(xlabel="displacement of the corner [m]", ylabel="λ", title="Block of 0.25 × 1 m")
axes.legend()
