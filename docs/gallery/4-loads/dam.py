"""
A dam against water
===================

Water presses on the upstream face; λ multiplies the weight of the water. The load is a user-defined object, from
``examples/own_load.py``; for this dam λ = 3 / h² exactly.
"""

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import runningbond as rb

own = runpy.run_path(str(Path(rb.__file__).parents[1] / "examples" / "own_load.py"))
levels = np.linspace(0.4, 1.0, 7)
results = [own["dam"].with_({"load.live": own["Water"](level)}).run("limit") for level in levels]

figure, axes = plt.subplots()
axes.plot(levels, 3 / levels**2, label="3 / h²")
axes.plot(levels, [result.multiplier for result in results], "o", label="limit")
axes.set(xlabel="depth of the water [m]", ylabel="λ", title="A dam that slides")
axes.legend()

# %%
# At one metre of water the dam fails if water is three times as heavy as it really is.
results[-1].plot()
