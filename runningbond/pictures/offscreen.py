"""Whether this machine draws off-screen, as a process that may crash finds out."""

import subprocess
import sys
from functools import cache

PROBE = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Plane(), color="black", lighting=False)
plotter.view_xy()
shades = plotter.screenshot(return_img=True)
raise SystemExit(0 if shades.min() < 64 < 192 < shades.max() else 1)
"""

PATIENCE = 120
"""Seconds after which a process that only draws a square is stopped."""


@cache
def why_not_drawn() -> str:
    """Why there are no pictures from this machine, in one line; empty where there are.

    VTK ends the whole process where the system has no OpenGL that works without a screen, so another one tries.
    """
    try:
        tried = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=PATIENCE, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"no pictures: a process that was to try did not end well: {error}"
    if tried.returncode == 0:
        return ""
    how = f"ended by signal {-tried.returncode}" if tried.returncode < 0 else "drew nothing"
    return f"no pictures: this machine cannot draw off-screen ({how}); tools/system-libraries installs what it needs"
