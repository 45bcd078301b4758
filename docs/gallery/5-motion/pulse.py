"""
A pier shaken by a pulse
========================

An earthquake is not a load multiplier: ``respond`` follows a wall through a motion of its ground, and reports whether
it stands. Here the same pulse acts twice, the second time doubled.
"""

import matplotlib.pyplot as plt

import runningbond as rb

size = {"block_width": 0.5, "block_height": 0.5, "thickness": 0.3}
pulse = {"pulse": {"kind": "sine", "amplitude": 0.4, "period": 0.6}, "quantity": "g"}
springs = {"normal_stiffness": 1e9, "shear_stiffness": 4e8}
pier = rb.Wall.running_bond(length=0.5, height=2.0, **size, density=2000.0, friction=0.7, **springs, history=pulse)

figure, axes = plt.subplots()
for scale in (0.75, 1.5):
    response = pier.respond("dem-dynamic", scale=scale)
    stood = response.fallen == 0
    axes.plot(response.time[stood], response.displacement[stood, 0, 0], label=f"{scale} × 0.4 g: {response.verdict}")
axes.set(xlabel="time [s]", ylabel="displacement of the top [m]", title="A pier of four courses under a sine pulse")
axes.legend()
