"""``runningbond mesh``."""

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from meshing import check_suffix, not_meshed, wall_mesh, write_mesh
from runningbond.compare.published import find_scene
from runningbond.scene import read_scene

from .terminal import DONE, SceneName, Whole, remarks


def mesh(
    scene: SceneName,
    /,
    *,
    out: Annotated[Path, Parameter(name=("--out", "-o"))],
    cells: Whole = 1,
) -> int:
    """Write a finite-element mesh of a wall, with joints as zero-thickness elements.

    Parameters
    ----------
    out
        File to write, .msh or .vtu.
    cells
        Number of cells in half a block along the course, and in the height of a block.
    """
    check_suffix(out)
    wall = read_scene(find_scene(scene))
    meshed = wall_mesh(wall, cells)
    write_mesh(meshed, wall, out)
    print(
        f"{out}: {len(meshed.points)} nodes, {len(meshed.triangles)} triangles, {len(meshed.interfaces)} joint elements"
    )
    lacking = not_meshed(wall)
    for line in (*((f"note: {lacking}",) if lacking else ()), *remarks(wall)):
        print(line, file=sys.stderr)
    return DONE
