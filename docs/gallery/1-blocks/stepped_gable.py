"""
A stepped gable
===============

Courses may have different lengths: each is a list of widths in blocks, from left to right; a negative number is a gap.
"""

import runningbond as rb

base = [[1] * 4, [0.5, 1, 1, 1, 0.5]] * 3
steps = [[1] * 4, [0.5, 1, 1, 1, 0.5], [-1, 1, 1], [-1, 0.5, 1, 0.5], [-1.5, 1], [-1.5, 1]]
size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.25}
gable = rb.Wall.courses(base + steps, **size, density=1900.0, friction=0.6, title="stepped gable")
gable.plot()

# %%
# Pushed to the right, the part above a stepped crack breaks off and takes the top along.
result = gable.run("limit-nonassociated")
print(f"λ = {result.lower:.4f} … {result.upper:.4f}")
result.plot()
# sphinx_gallery_thumbnail_number = 2
