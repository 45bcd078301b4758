"""
An arch, with and without its tie
=================================

Drawn in DXF, voussoirs on a layer of their own; a load stands on the haunch. λ is that load in newtons; without
the bar between the springings a sixth of it thrusts over a pier.
"""

from pathlib import Path

import runningbond as rb

folder = Path(rb.__file__).parents[1] / "examples" / "walls"
tied = rb.read(folder / "arch_with_tie.toml")
result = tied.run("limit")
print(
    f"with the tie {result.multiplier:,.0f} N; without it: {tied.with_({'tie': None}).run('limit').multiplier:,.0f} N"
)
result.plot()
