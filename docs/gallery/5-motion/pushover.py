"""
A pushover curve past its peak
==============================

``dem-static`` brings a wall to rest load by load, and follows it past the largest load that it carries. A dry wall on
stiff joints moves by only a hundredth of a millimetre before it falls.
"""

import runningbond as rb

result = rb.read("wall-w1").run("dem-static")
print(f"{result.lower:.4f} … {result.upper:.4f}")
result.plot("curve")

# %%
# The mechanism, with the forces in the joints as thin lines.
result.plot()
# sphinx_gallery_thumbnail_number = 2
