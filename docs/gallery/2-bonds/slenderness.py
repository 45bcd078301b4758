"""
Slender panels fall earlier
===========================

If the panel is so high that the crack ends at its side, below the top corner, the side cuts off the wedge, and λ
decreases with the height.
"""

import matplotlib.pyplot as plt

import runningbond as rb

panel = rb.read("panel-06")
heights = [0.48 * k for k in range(1, 8)]
walls = [panel.with_({"wall.height": height}, title=f"H/L = {height / 1.44:.3g}") for height in heights]

figure, axes = plt.subplots()
for model, marker in (("limit", "o-"), ("homog", "s--")):
    axes.plot([h / 1.44 for h in heights], [wall.run(model).multiplier for wall in walls], marker, label=model)
axes.set(xlabel="H / L", ylabel="λ", title="Blocks of 0.24 × 0.12 m, tan φ = 0.6")
axes.legend()

# %%
# The highest panel.
walls[-1].run("limit").plot()
