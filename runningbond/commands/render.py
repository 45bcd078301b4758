"""``runningbond render``."""

import os
import sys
from pathlib import Path

from runningbond.pictures.style import Colouring
from runningbond.results import StoreError, load_scene
from runningbond.results.store import RECORD, RESPONSE_RECORD
from runningbond.scene import SceneError

from .terminal import DONE, NO_ANSWER, Flag, can_draw

LISTED = 6
"""Largest number of folders that an error message lists."""


def render(
    folder: Path,
    /,
    *,
    colour: Colouring = "displacement",
    view: Flag = False,
) -> int:
    """Draw the contents of a result folder: its collapse mechanism, and the last moment and a film of a time series.

    The mechanism is drawn by matplotlib, also as vector graphics, and by PyVista, which also draws the moments.

    Parameters
    ----------
    folder
        Folder of one outcome or response: the --out folder of run or respond, or scene/model in that of compare.
    colour
        Colour of the blocks in pictures by PyVista: by displacement or by course.
    view
        Open a window instead of writing files; needs a screen.
    """
    _check(folder)  # before anything is drawn
    if view:
        if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            raise SceneError("--view", "needs a screen; without it pictures are written")
        from runningbond.pictures.render import view_folder

        view_folder(folder, colour)
        return DONE
    from runningbond.pictures.render import PICTURES, draw_folder, render_folder

    written = draw_folder(folder)
    paints = can_draw()
    written += render_folder(folder, colour) if paints else []
    none = f"{folder}: the outcome has no mechanism and no moments, of which it would draw {', '.join(PICTURES)}"
    print("\n".join(map(str, written)) or none)
    return DONE if paints else NO_ANSWER


def _check(folder: Path) -> None:
    """Refuse a folder without an outcome or a response; the message lists inner folders that have one, if any."""
    records = (RECORD, RESPONSE_RECORD)
    holds = any((folder / name).is_file() for name in records)
    inner = [] if holds else sorted({path.parent for name in records for path in folder.rglob(name)})
    if inner:
        more = f" and {len(inner) - LISTED} more" if len(inner) > LISTED else ""
        what = f"holds no outcome itself; draw one of {', '.join(map(str, inner[:LISTED]))}{more}"
        raise StoreError(f"{folder}: {what}")
    load_scene(folder)
