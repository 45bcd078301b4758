"""
Strength of running bond as a continuum
=======================================

In-plane stresses that the joints of running bond can carry, for three shapes of blocks: how much shear does a wall
carry under a pressure normal to the bed joints? (:cite:t:`debuhan1997`)
"""

import matplotlib.pyplot as plt
import numpy as np

from homog import StrengthDomain
from runningbond.scene import Bond, JointMaterial

angles = np.radians(np.linspace(-80, 90, 171))
figure, axes = plt.subplots()
for width, height, line in ((0.24, 0.06, "-"), (0.06, 0.06, "--"), (0.06, 0.24, ":")):
    domain = StrengthDomain(Bond(width, height), JointMaterial(friction=0.6, cohesion=1.0))
    reach = np.array([domain.strength((0.0, float(np.sin(a)), float(np.cos(a)))) for a in angles])
    axes.plot(reach * np.cos(angles), reach * np.sin(angles), line, label=f"b / a = {width / height:g}")
axes.set(xlabel="Σ₁₂ / c", ylabel="Σ₂₂ / c", title="tan φ = 0.6, Σ₁₁ = 0, tension positive", xlim=(0, 4), ylim=(-5, 2))
axes.legend()
