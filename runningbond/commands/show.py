"""``runningbond show``: a wall before any analysis."""

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from runningbond.compare.published import find_scene
from runningbond.pictures.flat import figure_of
from runningbond.pictures.render import VECTOR
from runningbond.pictures.sheet import Sheet
from runningbond.results import write_atomically
from runningbond.scene import SceneError, read_scene

from .inventory import rows
from .terminal import DONE, Flag, SceneName, print_table, remarks


def show(
    scene: SceneName,
    /,
    *,
    out: Annotated[Path | None, Parameter(name=("--out", "-o"))] = None,
    numbers: Flag = False,
) -> int:
    """Show a wall before any analysis: its blocks, materials, supports, loads and weight.

    Parameters
    ----------
    out
        Picture to write, .svg or .png: blocks and joints by material, supports, ties, and loads with their sizes.
    numbers
        Write into each block of the picture given by --out its number, as used by `assign`.
    """
    if out is not None and out.suffix.lower() not in VECTOR:
        raise SceneError("--out", "must end in .svg or .png", str(out))
    if numbers and out is None:
        raise SceneError("--numbers", "needs a picture to write into; name one with --out")
    wall = read_scene(find_scene(scene))
    if out is not None:
        write_atomically(out, VECTOR[out.suffix.lower()](figure_of(wall, numbers=numbers)))
    print_table(Sheet(wall.title, ("quantity", "value"), rows(wall)))
    if out is not None:
        print(out)
    for line in remarks(wall):
        print(line)
    return DONE
