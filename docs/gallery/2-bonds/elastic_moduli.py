"""
How stiff a wall of rigid blocks is
===================================

Only the joints deform: moduli of the equivalent continuum over the shape of the blocks (:cite:t:`cecchi2004`).
"""

import matplotlib.pyplot as plt
import numpy as np

from homog import elastic_moduli

k_n, k_t = 1.04e11, 4.2e10  # mortar of 1 GPa, 10 mm thick
springs = {"bed_normal": k_n, "head_normal": k_n, "bed_shear": k_t, "head_shear": k_t}
ratio = np.geomspace(0.25, 8, 40)
moduli = [elastic_moduli(0.24, 0.24 / r, **springs) for r in ratio]

figure, axes = plt.subplots()
kinds = (("a1111", "along the courses", "-"), ("a2222", "across them", "--"), ("a1212", "in shear", ":"))
for name, label, line in kinds:
    axes.loglog(ratio, [getattr(each, name) / 1e9 for each in moduli], line, label=label)
axes.set(xlabel="b / a", ylabel="modulus [GPa]", title="Running bond of rigid blocks 0.24 m wide")
axes.minorticks_off()
axes.set_xticks([0.25, 0.5, 1, 2, 4, 8], ["1/4", "1/2", "1", "2", "4", "8"])
axes.legend()
