"""
A wall that no load brings down
===============================

Hold both lower corners of that panel horizontally, and a strut of steep joints locks: more load only presses more.
The status is ``unbounded``, and no number is made up.
"""

import runningbond as rb

panel = rb.read("point-load-2")
for support in ("corners", "pinned-corners"):
    result = panel.with_(support={"kind": support}).run("limit")
    print(f"{support}: {result.status}, λ = {result.multiplier}")
    print(f"  {result.message}")

result.plot()
