"""
An arch, with and without its tie
=================================

The arch is drawn in DXF, with voussoirs on a separate layer; a load stands on the haunch. λ is this load in newtons.
Without the bar between the springings a sixth of the load is enough for the thrust to overturn a pier.
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
