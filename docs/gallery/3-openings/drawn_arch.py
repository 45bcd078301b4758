"""
The thinnest semicircular arch
==============================

To stand under its own weight a semicircular arch must be at least about a tenth of its radius thick. Here rings are
drawn with ezdxf and pushed sideways; the thinnest does not stand at all.
"""

import tempfile

import ezdxf
import numpy as np

import runningbond as rb

others = {"block": {"density": 2200.0}, "joint": {"friction": 0.8}, "support": {"kind": "base"}}
sideways = {"gravity": 9.81, "live": {"kind": "lateral"}}
for thickness in (0.10, 0.11, 0.12, 0.15, 0.20):
    document, angles = ezdxf.new(), np.linspace(np.pi, 0, 22)
    inner, outer = (np.column_stack([np.cos(angles), np.sin(angles)]) * (1 + x * thickness / 2) for x in (-1, 1))
    stones = [[inner[k], inner[k + 1], outer[k + 1], outer[k]] for k in range(21)]
    for corners in (*stones, [(-1.5, -0.2), (1.5, -0.2), (1.5, 0.0), (-1.5, 0.0)]):  # the lowest outline is the ground
        document.modelspace().add_lwpolyline(corners, close=True)
    with tempfile.TemporaryDirectory() as folder:
        document.saveas(f"{folder}/arch.dxf")
        drawn = {"drawing": "arch.dxf", "units": "m", "thickness": 0.5}
        result = rb.Wall({"title": "arch", "wall": drawn, "load": sideways, **others}, folder).run("limit")
    print(f"thickness {thickness:.2f} of the radius: {result.status}, λ = {result.multiplier}")
result.plot()
