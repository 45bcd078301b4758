"""
An arch whose abutment moves away
=================================

At small displacements two blocks keep their initial thrust; at finite ones they sink, thrust more and more, and fall.
"""

import matplotlib.pyplot as plt

import runningbond as rb

block, abutment = [[0, 0], [1, 0], [1, 0.4], [-0.15, 0.4]], [[-1, -1], [0, -1], [0, 0], [-0.15, 0.4], [-1, 0.4]]
both, sides = ([outline, [[2 - x, y] for x, y in outline]] for outline in (block, abutment))
joint = {"friction": 0.8, "normal_stiffness": 3e10, "shear_stiffness": 3e10, "inset": 0.002}  # corners are rounded
away = {"kind": "settlement", "box": [[1.9, -2], [4, 1]], "by": [0.2, 0.0]}
arch = rb.Wall.outlines(both, sides, thickness=0.2, density=2000.0, joint=joint, live=away)
for displacements in ("small", "finite"):
    curve = arch.run("dem-dynamic", displacements=displacements).curve
    plt.plot(curve["displacement"], curve["multiplier"], "o-", label=f"{displacements} displacements")
plt.gca().set(xlabel="spread [m]", ylabel="thrust, as a share of the weight", title="Two blocks between abutments")
plt.ylim(0, 3)
plt.legend()
