"""
What dilatancy hides
====================

In classical limit analysis joints open as they slide. With true friction they do not, and walls of blocks on end lose
up to half of their load. Left: the associated mechanism; right: the weakest one certified with true friction.
"""

import matplotlib.pyplot as plt

import runningbond as rb

wall = rb.read("panel-08")
figure, axes = plt.subplots(1, 2, figsize=(9, 5))
for model, each in zip(("limit", "limit-nonassociated"), axes, strict=True):
    wall.run(model).plot(axes=each)
