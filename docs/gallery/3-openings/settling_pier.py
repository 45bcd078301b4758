"""
A pier that settles
===================

The ground under the right pier sinks by 20 mm. λ is the share of the dead load that it still carries
(``examples/walls/settling_pier.toml``).
"""

from pathlib import Path

import runningbond as rb

folder = Path(rb.__file__).parents[1] / "examples" / "walls"
gate = rb.read(folder / "settling_pier.toml")
result = gate.run("dem-static")
print(result.message)
result.plot()

# %%
# The reaction drops at once to the part of the load that the arch above the opening leaves on the pier.
result.plot("curve")
