"""``runningbond show``: a wall before any analysis."""

from pathlib import Path
from typing import Annotated

import numpy as np
from cyclopts import Parameter

from runningbond.compare.published import find_scene
from runningbond.compare.table import Sheet
from runningbond.pictures.captions import to_png, to_svg
from runningbond.pictures.flat import figure_of
from runningbond.results import write_atomically
from runningbond.scene import JointMaterial, Scene, SceneError, read_scene

from .terminal import DONE, SceneName, print_table, remarks

WRITERS = {".svg": to_svg, ".png": to_png}


def show(scene: SceneName, /, *, out: Annotated[Path | None, Parameter(name=("--out", "-o"))] = None) -> int:
    """Show a wall before any analysis: what it is made of, what holds it and what it weighs.

    Parameters
    ----------
    out
        Picture to write, .svg or .png: blocks, joints by material, supports and loads.
    """
    if out is not None and out.suffix.lower() not in WRITERS:
        raise SceneError("--out", "must end in .svg or .png", str(out))
    wall = read_scene(find_scene(scene))
    if out is not None:
        write_atomically(out, WRITERS[out.suffix.lower()](figure_of(wall)))
    print_table(Sheet(wall.title, ("quantity", "value"), rows(wall)))
    if out is not None:
        print(out)
    for line in remarks(wall):
        print(line)
    return DONE


def rows(scene: Scene) -> list[tuple[str, str]]:
    """Counts, extents, weights and loads of a scene, each with its unit."""
    low, high = scene.blocks.extent(scene.wall)
    gravity = float(np.hypot(*scene.load.gravity))
    live = scene.live_forces
    push = (scene.mass[:, None] * live.acceleration)[~scene.fixed].sum(axis=0) + live.force.sum(axis=0)
    inner = int(scene.joints.inner.sum())
    length = scene.joints.length
    return [
        ("blocks", f"{int(scene.wall.sum())}, of which {int((scene.wall & scene.fixed).sum())} held"),
        ("number of joints", f"{len(scene.joints) - inner}, and {inner} potential cracks"),
        ("shortest and longest joint", f"{length.min():.4g} m, {length.max():.4g} m" if len(length) else "none"),
        ("pins", str(len(scene.pins))),
        (
            "extent",
            f"x {low[0]:.4g} … {high[0]:.4g} m, y {low[1]:.4g} … {high[1]:.4g} m, {scene.thickness:.4g} m thick",
        ),
        ("mass of the wall", f"{float(scene.mass[scene.wall].sum()):.5g} kg"),
        ("weight of what moves", f"{gravity * float(scene.mass[~scene.fixed].sum()):.5g} N"),
        ("live load at λ = 1", f"({push[0]:.5g}, {push[1]:.5g}) N"),
        ("density of blocks", f"{scene.block.density:g} kg/m³"),
        *zip(("joints", "potential cracks"), map(_strength, scene.joint_materials), strict=False),
    ]


def _strength(material: JointMaterial) -> str:
    inset = f", contacts {material.inset:g} m from the ends" if material.inset else ""
    return f"tan φ {material.friction:g}, cohesion {material.cohesion:g} Pa, tension {material.tension:g} Pa{inset}"
