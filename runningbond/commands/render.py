"""``runningbond render``."""

import os
import sys
from pathlib import Path

from runningbond.pictures.style import Colouring
from runningbond.results import load_scene
from runningbond.scene import SceneError

from .terminal import DONE, NO_ANSWER, Flag, can_draw


def render(
    folder: Path,
    /,
    *,
    colour: Colouring = "displacement",
    view: Flag = False,
) -> int:
    """Draw what a result folder has to show: its collapse mechanism, and of a time series the last moment and a film.

    Parameters
    ----------
    folder
        Folder of one outcome: that of run --out, or scene/model in that of compare.
    colour
        Colour blocks by displacement or by course.
    view
        Open a window instead, where there is a screen.
    """
    load_scene(folder)  # refused before anything is tried
    if view:
        if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            raise SceneError("--view", "needs a screen; without it pictures are written")
        from runningbond.pictures.render import view_folder

        view_folder(folder, colour)
        return DONE
    if not can_draw():
        return NO_ANSWER
    from runningbond.pictures.render import render_folder

    written = render_folder(folder, colour)
    print("\n".join(map(str, written)) if written else f"{folder}: the outcome has no mechanism to draw")
    return DONE
