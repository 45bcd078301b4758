"""
A band of mortar in a dry wall
==============================

Three courses laid in mortar hold the part above the crack together (``examples/walls/mortared_band.toml``).
"""

from pathlib import Path

import matplotlib.pyplot as plt

import runningbond as rb

folder = Path(rb.__file__).parents[1] / "examples" / "walls"
banded = rb.read(folder / "mortared_band.toml")
dry = banded.with_({"assign": None, "joints": None}, title="the same wall, dry")
figure, axes = plt.subplots(1, 2, figsize=(9, 5))
for wall, each in zip((dry, banded), axes, strict=True):
    wall.run("limit").plot(axes=each)
