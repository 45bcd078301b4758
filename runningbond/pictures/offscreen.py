"""Check whether this machine can draw off-screen, made in a child process because it may crash."""

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

TIMEOUT = 120
"""Time [s] after which the child process, which only draws a square, is stopped."""


@cache
def why_not_drawn() -> str:
    """Reason why this machine cannot draw pictures, in one line; empty if it can.

    VTK ends the whole process if the system has no OpenGL that works without a screen, so a child process tries it.
    """
    try:
        tried = subprocess.run([sys.executable, "-c", PROBE], capture_output=True, timeout=TIMEOUT, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"no pictures: the process that tries to draw off-screen failed: {error}"
    if tried.returncode == 0:
        return ""
    how = f"ended by signal {-tried.returncode}" if tried.returncode < 0 else "drew nothing"
    return f"no pictures: this machine cannot draw off-screen ({how}); tools/system-libraries installs what it needs"
