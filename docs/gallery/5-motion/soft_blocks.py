"""
When blocks are soft
====================

``fem`` uses the stiffness of the blocks given in the scene. It affects the displacements before collapse, but barely
the collapse load.
"""

import matplotlib.pyplot as plt

import runningbond as rb

mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
size = {"length": 0.8, "height": 0.8, "block_width": 0.4, "block_height": 0.2, "thickness": 0.2}
wall = rb.Wall.running_bond(**size, density=1800.0, friction=0.6, mortar=mortar)
figure, axes = plt.subplots()
for young, line in ((5e8, ".-"), (1e10, ".--")):
    result = wall.with_({"block.young": young}).run("fem", tolerance=0.05)
    moved, load = result.outcome.curve[1:].T
    name = f"E = {young / 1e9:g} GPa: λ = {result.lower:.3f} … {result.upper:.3f}"
    axes.plot(1e3 * (moved - result.outcome.curve[0, 0]), load, line, label=name)
axes.set(xlabel="displacement [mm]", ylabel="λ", title="Until it falls", xscale="log", ylim=(0.3, 0.65))
axes.legend(loc="lower right")
