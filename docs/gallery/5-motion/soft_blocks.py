"""
When blocks are soft
====================

``fem`` takes blocks as stiff as the scene says. The stiffness of blocks shows before collapse; the collapse load
hardly knows it.
"""

import matplotlib.pyplot as plt

import runningbond as rb

size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.2}
mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
wall = rb.Wall.running_bond(
    length=0.8,
    height=0.8,
    **size,
    density=1800.0,
    friction=0.6,
    mortar=mortar,
    young=1e9,
    title="soft and stiff",
)
figure, axes = plt.subplots()
for young in (5e8, 1e10):
    result = wall.with_({"block.young": young}).run("fem", tolerance=0.05)
    moved, load = result.outcome.curve.T
    label = f"E = {young / 1e9:g} GPa: λ = {result.lower:.3f} … {result.upper:.3f}"
    axes.plot(1e3 * (moved[1:] - moved[0]), load[1:], ".-", label=label)
axes.set(xlabel="displacement [mm]", ylabel="λ", title="Until it falls", xscale="log", ylim=(0.3, 0.65))
axes.legend()
