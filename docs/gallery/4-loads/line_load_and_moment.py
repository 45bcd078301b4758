"""
A floor that rests on one edge
==============================

Dead loads may be point loads, line loads and moments; here a line load along the top, and the moment of a balcony held
by the corner stone.
"""

import runningbond as rb

floor = {"kind": "line", "from": [0.0, 2.4], "to": [1.2, 2.4], "force": [0.0, -5e3]}
balcony = {"kind": "moment", "at": [1.1, 2.3], "moment": -150.0}
size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.25}
wall = rb.Wall.running_bond(
    length=1.2, height=2.4, **size, density=1800.0, friction=0.6, dead=[floor, balcony], title="floor and balcony"
)
wall.plot()

# %%
# The mechanism for a push to the right.
wall.run("limit").plot()
# sphinx_gallery_thumbnail_number = 2
