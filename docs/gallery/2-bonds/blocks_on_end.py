"""
What dilatancy hides
====================

Classical limit analysis lets joints open as they slide. True friction does not, and blocks on end then lose up to
half of their load: to the left the associated mechanism, to the right the weakest one certified with true friction.
"""

import matplotlib.pyplot as plt

import runningbond as rb

wall = rb.read("panel-08")
figure, axes = plt.subplots(1, 2, figsize=(9, 5))
for model, each in zip(("limit", "limit-nonassociated"), axes, strict=True):
    wall.run(model).plot(axes=each)
