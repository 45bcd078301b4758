"""
A window under a lintel
=======================

Openings can be cut out of the bond anywhere. This wall is not symmetric, so the direction of the push matters.
"""

import matplotlib.pyplot as plt

import runningbond as rb

size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.3}
window = {"from": [0.6, 0.8], "to": [1.4, 1.8], "lintel": {"height": 0.2, "bearing": 0.2}}
wall = rb.Wall.running_bond(
    length=3.2, height=2.4, **size, density=1900.0, friction=0.6, title="wall with a window", wall={"opening": [window]}
)
figure, axes = plt.subplots(1, 2, figsize=(9, 4.5))
for direction, each in zip(("right", "left"), axes, strict=True):
    wall.with_({"load.live": {"kind": "lateral", "direction": direction}}, title=f"to the {direction}").run(
        "limit"
    ).plot(axes=each)
