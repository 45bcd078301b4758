"""
A façade of two storeys
=======================

Door, windows, lintels of oak and granite, a floor and a roof as loads: a scene file of eighty lines
(``examples/walls/facade.toml``, on the page of :doc:`six walls </walls>`).
"""

from pathlib import Path

import runningbond as rb

folder = Path(rb.__file__).parents[1] / "examples" / "walls"
facade = rb.read(folder / "facade.toml")
facade.plot()

# %%
# Pushed to the right, the façade separates at the windows.
facade.run("limit").plot()
# sphinx_gallery_thumbnail_number = 2
