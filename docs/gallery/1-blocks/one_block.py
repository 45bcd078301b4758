"""
One block topples or slides
===========================

A block of width b and height h slides at λ = tan φ or topples about its corner at λ = b / h, whichever is smaller.
"""

import matplotlib.pyplot as plt
import numpy as np

import runningbond as rb

stone = {"block_height": 1.0, "thickness": 0.3, "density": 2000.0, "friction": 0.6}
widths = np.linspace(0.2, 1.0, 17)
results = [rb.Wall.courses([[1]], block_width=b, **stone, title=f"b = {b:.2g} m").run("limit") for b in widths]

figure, axes = plt.subplots()
axes.plot(widths, np.minimum(0.6, widths), label="min(tan φ, b / h)")
axes.plot(widths, [result.multiplier for result in results], "o", label="limit")
axes.set(xlabel="width of the block [m]", ylabel="λ", title="A block one metre high")
axes.legend()

# %%
# The slender block rotates about its corner, marked by a circle.
results[2].plot()
# sphinx_gallery_thumbnail_number = 2
