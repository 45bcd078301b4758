"""
A wall on a tilting table
=========================

Dry walls are often tested on a table that tilts until they fall. λ is then the tangent of the table's angle, and the
message gives the angle itself.
"""

import math

import runningbond as rb

size = {"block_width": 0.24, "block_height": 0.12, "thickness": 0.12}
wall = rb.Wall.running_bond(length=0.96, height=0.96, **size, density=1800.0, friction=0.6, live="tilt", title="tilted")
result = wall.run("limit")
print(f"{math.degrees(math.atan(result.multiplier)):.1f}°")
print(result.message)

result.plot()
