"""
A toe that crushes
==================

With joints of finite compressive strength a rocking wall cannot stand on its corner only, and carries less.
"""

import matplotlib.pyplot as plt

import runningbond as rb

size = {"length": 0.9, "height": 1.5, "block_width": 0.3, "block_height": 0.15, "thickness": 0.2}
beam = {"height": 0.2, "force": [0.0, -1e5], "drive": {"force": [1.0, 0.0]}}
wall = rb.Wall.running_bond(**size, density=2000.0, friction=0.75, title="crushing toe", beam=beam)
strengths = [1, 2, 4, 8, 16]
results = [wall.with_({"joint.compressive_strength": 1e6 * f}).run("limit") for f in strengths]

axes = plt.figure().add_subplot(xscale="log")
axes.plot(strengths, [result.multiplier / 1e3 for result in results], "o-", label="with crushing")
axes.axhline(wall.run("limit").multiplier / 1e3, ls="--", color="0.5", label="never crushes")
axes.minorticks_off()
axes.set(xlabel="compressive strength of joints [MPa]", ylabel="force on the beam [kN]", title="A wall that rocks")
axes.set_xticks(strengths, map(str, strengths))
axes.legend()

# %%
# At 4 MPa. Crosses mark the ends of crushing joints, where blocks overlap.
results[2].plot()
