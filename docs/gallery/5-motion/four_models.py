"""
One wall, four models
=====================

Bounds, certified loads and loading histories of one wall. With true friction there is no single collapse load: the
result of a model is only as good as its bracket.
"""

import matplotlib.pyplot as plt

import runningbond as rb

wall = rb.read("wall-w2")
models = ("limit", "limit-nonassociated", "dem-static", "dem-dynamic")
figure, axes = plt.subplots(figsize=(6.4, 2.6), layout="constrained")
for row, model in enumerate(models):
    result = wall.run(model)
    axes.plot([result.lower, result.upper], [row, row], lw=5, marker="|", ms=14, solid_capstyle="butt")
axes.axvline(0.563, ls=":", color="0.4")
axes.text(0.563, 3.6, "Ferris & Tin-Loi", ha="center", fontsize=8, backgroundcolor="white")
axes.set(yticks=range(4), xlabel="λ", ylim=(-0.6, 4.0), title=wall.scene.title)
axes.set_yticklabels(models)
