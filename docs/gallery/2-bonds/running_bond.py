"""
A panel of running bond
=======================

The smallest script of a wall: build it, see it, let it fall.
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
# A wedge over a stepped crack turns about the far corner.
result = wall.run("limit")
print(result)
result.plot()
# sphinx_gallery_thumbnail_number = 2
