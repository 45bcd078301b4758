"""
The more friction, the better, up to a point
============================================

With little friction a panel slides at λ = tan φ. With more friction blocks rotate, and friction helps only because the
crack rises more steeply.
"""

import matplotlib.pyplot as plt
import numpy as np

import runningbond as rb

wall = rb.read("panel-07")
friction = np.linspace(0.1, 1.0, 10).round(2).tolist()
table = rb.sweep(wall, {"joint.friction": friction}, "limit", jobs=1)

figure, axes = plt.subplots()
axes.plot(friction, table["multiplier"], "o-", label="limit")
axes.plot([0, 0.35], [0, 0.35], "--", color="0.5", label="λ = tan φ, sliding")
axes.set(xlabel="tan φ", ylabel="λ", title=wall.scene.title)
axes.legend()
