"""
A load at the top
=================

Weightless panels on a pin and a roller, loaded as in :cite:t:`baraldi2018`: λ is the load in newtons.
"""

import runningbond as rb

for name in ("point-load-4", "point-load-2", "point-load-1", "point-load-quarter"):
    result = rb.read(name).run("limit")
    print(f"{result.outcome.scene}: {result.multiplier / 1e3:.1f} kN")

rb.read("point-load-2").run("limit").plot()
