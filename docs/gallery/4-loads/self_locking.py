"""
A wall that no load brings down
===============================

If both lower corners of the panel are held horizontally, a strut of steep joints locks: more load only means more
pressure. The status is ``unbounded``, and there is no multiplier. In ``limit`` joints open as they slide; with true
friction such a wall may collapse, but this one carries every load that ``dem-static`` and ``dem-dynamic`` try, too.
"""

import runningbond as rb

panel = rb.read("point-load-2")
for support in ("corners", "pinned-corners"):
    result = panel.with_(support={"kind": support}).run("limit")
    print(f"{support}: {result.status}, λ = {result.multiplier}")
    print(f"  {result.message}")

result.plot()
