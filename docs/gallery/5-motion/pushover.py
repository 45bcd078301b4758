"""
A pushover curve past its peak
==============================

``dem-static`` brings a wall to rest load by load, and follows it on when it bears no more. A hundredth of a
millimetre is all the warning that a dry wall on stiff joints gives.
"""

import runningbond as rb

result = rb.read("wall-w1").run("dem-static")
print(f"{result.lower:.4f} … {result.upper:.4f}")
result.plot("curve")

# %%
# How it falls: forces in the joints as thin lines.
result.plot()
# sphinx_gallery_thumbnail_number = 2
