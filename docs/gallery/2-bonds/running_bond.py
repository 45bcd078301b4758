"""
A panel of running bond
=======================

The shortest script: build a wall, plot it, and compute its collapse.
"""

import runningbond as rb

wall = rb.Wall.running_bond(
    length=1.44,
    height=1.44,
    block_width=0.24,
    block_height=0.12,
    thickness=0.12,
    density=1800.0,
    friction=0.6,
)
wall.plot()

# %%
# A wedge above a stepped crack rotates about the far corner.
result = wall.run("limit")
print(result)
result.plot()
# sphinx_gallery_thumbnail_number = 2
