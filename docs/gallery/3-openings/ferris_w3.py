"""
A wall with an opening
======================

The wall W3 of :cite:t:`ferris2001`, given course by course. Their results are 0.404 for joints that dilate and 0.356
for true friction.
"""

import runningbond as rb

wall = rb.read("wall-w3")
wall.plot()

# %%
# Every load of the interval is certified by forces and a mechanism.
result = wall.run("limit-nonassociated")
print(f"λ = {result.lower:.4f} … {result.upper:.4f}; associated {wall.run('limit').multiplier:.4f}")
result.plot()
# sphinx_gallery_thumbnail_number = 2
