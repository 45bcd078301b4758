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
"""Folders that a refusal names."""


def render(
    folder: Path,
    /,
    *,
    colour: Colouring = "displacement",
    view: Flag = False,
) -> int:
    """Draw what a result folder has to show: its collapse mechanism, and of a time series the last moment and a film.

    The mechanism is drawn flat, as vectors too, and painted by PyVista, as moments are.

    Parameters
    ----------
    folder
        Folder of one outcome or response: that of run --out or respond --out, or scene/model in that of compare.
    colour
        Colour painted blocks by displacement or by course.
    view
        Open a window instead, where there is a screen.
    """
    _check(folder)  # refused before anything is tried
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
    """Refuse a folder without an outcome or a response; where folders in it have one, the line names them."""
    records = (RECORD, RESPONSE_RECORD)
    holds = any((folder / name).is_file() for name in records)
    inner = [] if holds else sorted({path.parent for name in records for path in folder.rglob(name)})
    if inner:
        more = f" and {len(inner) - LISTED} more" if len(inner) > LISTED else ""
        what = f"holds no outcome itself; draw one of {', '.join(map(str, inner[:LISTED]))}{more}"
        raise StoreError(f"{folder}: {what}")
    load_scene(folder)
