"""
The same wall twenty times
==========================

Sizes and frictions of real blocks scatter. Draws repeat a run on walls that vary within such tolerances, and give the
spread of the answer.
"""

import matplotlib.pyplot as plt

import runningbond as rb

wall = rb.read("wall-w1")
draws = wall.draws("dem-static", 20, scatter="size=0.01,friction=0.05", tolerance=0.02, jobs=1)
print(draws)

figure, axes = plt.subplots()
axes.hist(draws.multipliers, bins=8, color="#b8c7d9", edgecolor="0.3")
axes.axvline(draws.outcomes[0].multiplier, color="#d55e00", label="the wall as it is")
axes.set(xlabel="λ", ylabel="draws", title=wall.scene.title)
axes.legend()
