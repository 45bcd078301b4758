"""
Floors that hold a wall
=======================

The ends of three floor beams and half a roof load this wall; the parts that they press together stand longer
(``examples/walls/floor_beams.toml``).
"""

from pathlib import Path

import matplotlib.pyplot as plt

import runningbond as rb

folder = Path(rb.__file__).parents[1] / "examples" / "walls"
loaded = rb.read(folder / "floor_beams.toml")
bare = loaded.with_({"load.dead": None}, title="without floors")
figure, axes = plt.subplots(1, 2, figsize=(9, 5))
for wall, each in zip((bare, loaded), axes, strict=True):
    wall.run("limit").plot(axes=each)
