"""
Long blocks tie a wall together
===============================

Panels of the same size with blocks of different shapes: the closed form for a continuum shows the trend; panels of
blocks of this size carry more.
"""

import matplotlib.pyplot as plt

import runningbond as rb

walls = {"1/4": rb.read("panel-08"), "1": rb.read("panel-07"), "2": rb.read("panel-06"), "4": rb.read("panel-05")}

figure, axes = plt.subplots()
for model, marker in (("limit", "o-"), ("homog", "s--")):
    axes.plot(list(walls), [wall.run(model).multiplier for wall in walls.values()], marker, label=model)
axes.set(xlabel="b / a", ylabel="λ", title="Square panels of 1.44 m, tan φ = 0.6")
axes.legend()
