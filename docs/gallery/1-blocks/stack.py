"""
A stack of blocks
=================

For n blocks on top of each other λ = b / (n h): the whole stack rotates about the lowest corner.
"""

import runningbond as rb

size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.2}
for n in (4, 6, 8):
    stack = rb.Wall.courses([[1]] * n, **size, density=1800.0, friction=0.7, title=f"{n} blocks")
    result = stack.run("limit")
    print(f"{n} blocks: λ = {result.multiplier:.4f}, b / (n h) = {0.4 / (n * 0.2):.4f}")

result.plot()
