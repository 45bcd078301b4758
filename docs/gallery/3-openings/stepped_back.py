"""
A wall that steps back
======================

Storeys of old walls step back: 60 cm below, 45 and 30 cm above. Blocks have their own ``thickness``; joints are as
thick as the thinner block. Less weight above also means less push, where its lever arm is longest: λ, the push as a
share of the weight, is larger than for a wall of constant thickness.
"""

import runningbond as rb

storeys, lintel = {"second": 0.45, "third": 0.30}, {"height": 0.4, "bearing": 0.4}
wall = rb.Wall.running_bond(
    length=4.0,
    height=7.2,
    block_width=0.8,
    block_height=0.4,
    thickness=0.6,
    density=2200.0,
    friction=0.7,
    opening=[{"from": [1.6, y], "to": [2.4, y + 1.2], "lintel": lintel} for y in (0.8, 3.2, 5.6)],
    materials={name: {"density": 2200.0, "thickness": thickness} for name, thickness in storeys.items()},
    assign=[
        {"block": "second", "box": [[0.0, 2.4], [4.0, 4.8]]},
        {"block": "third", "box": [[0.0, 4.8], [4.0, 7.2]]},
    ],
)
same = wall.with_({f"materials.{name}.thickness": 0.6 for name in storeys})
print(f"λ = {wall.run('limit').multiplier:.4f}, as thick all over {same.run('limit').multiplier:.4f}")
wall.plot()
