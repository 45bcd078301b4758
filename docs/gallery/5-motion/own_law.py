"""
Joints that are polished as they slide
======================================

A user-defined joint law, from ``examples/own_law.py``: friction drops to half over a tenth of a millimetre of slip.
Walls that slide a little before they rotate fall earlier; :doc:`/how-to/own-law` explains the law.
"""

import runpy
from pathlib import Path

import matplotlib.pyplot as plt

import runningbond as rb

folder = Path(rb.__file__).parents[1] / "examples"
law = runpy.run_path(str(folder / "own_law.py"))["LAW"]
wall = rb.read("wall-w2")
figure, axes = plt.subplots()
for name, its_law, line in (("rough", None, ".-"), ("polished", law, ".--")):
    result = wall.with_({"joint.law": its_law}).run("dem-dynamic", tolerance=0.01)
    moved, load = result.outcome.curve.T
    axes.plot(1e3 * moved, load, line, label=f"{name}: λ = {result.lower:.3f} … {result.upper:.3f}")
axes.set(xlabel="displacement [mm]", ylabel="λ", title="Until it falls", xscale="log", ylim=(0.3, 0.65))
axes.legend(loc="lower right")
