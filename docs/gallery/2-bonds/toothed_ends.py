"""
Flush and toothed ends
======================

Without the half blocks that close its courses a panel is lighter where its weight matters.
"""

import matplotlib.pyplot as plt

import runningbond as rb

flush = rb.read("panel-06")
figure, axes = plt.subplots(1, 2, figsize=(9, 5))
for ends, each in zip(("flush", "toothed"), axes, strict=True):
    flush.with_({"wall.ends": ends}, title=f"{ends} ends").run("limit").plot(axes=each)
