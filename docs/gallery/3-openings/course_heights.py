"""
Courses of different heights, stones of different weight
========================================================

A plinth of large heavy stones under courses of decreasing height. Materials have names and are assigned by boxes.
"""

import runningbond as rb

wall = rb.Wall.running_bond(
    length=2.4,
    course_heights=[0.4, 0.4, 0.3, 0.3, 0.2, 0.2, 0.2],
    block_width=0.6,
    thickness=0.4,
    density=1800.0,
    friction=0.6,
    title="wall on a plinth",
    materials={"granite": {"density": 2700.0}},
    assign=[{"block": "granite", "box": [[0.0, 0.0], [2.4, 0.8]]}],
)
wall.plot()

# %%
# Pushed to the right, the part above a stepped crack rotates about the edge of the plinth.
wall.run("limit").plot()
