"""The legend of a drawing of a wall: its colours and lines, material by material."""

import textwrap
from typing import Any

import numpy as np

from runningbond.scene import Array, JointMaterial, Scene

from .captions import Caption, held_key, is_force, wall_title
from .quantities import beginning, counted, minus, readable
from .style import BEAM, DARK, DEAD, HELD, MOTION, block_colour, joint_colour
from .ties import TIE, tie_kinds

LINE_LENGTH = 58
"""Characters per line of the legend."""

CORNER: dict[str, Any] = {"marker": "o", "ls": "none", "color": DARK}
"""Marker of a corner that touches a side without a joint."""

CONDITIONS = {
    "free": "free to turn",
    "level": "kept level, free to rise",
    "fixed-height": "kept level and at its height",
}
"""Descriptions of the conditions of a beam."""


def wall_caption(scene: Scene) -> Caption:
    """Caption of a drawing of a wall: its title, its dimensions and the colour key."""
    length, height = np.subtract(*scene.blocks.extent(scene.wall)[::-1])
    used = used_block_materials(scene)
    density = f", {scene.block_materials[used[0]].density:g} kg/m³" if len(used) == 1 else ""
    density += "" if any(scene.load.gravity) else ", no gravity"
    n, cracks, corners = scene.count_blocks(), int(scene.joints.inner.sum()), int(scene.joints.at_corner.sum())
    size = f"{length:.4g} × {height:.4g} m, {thickness_text(scene)}{density}"
    counts = f"{counted(n, 'block')}, {counted(len(scene.joints) - cracks - corners, 'joint')}"
    counts += f", {counted(cracks, 'potential crack')}" if cracks else ""
    counts += f", {counted(corners, 'corner')} on sides" if corners else ""
    key = [*_materials(scene), *_bodies(scene), *_loads(scene)]
    return Caption(wall_title(scene.title), "", [size, counts], key, columns=1)


def thickness_text(scene: Scene) -> str:
    """Text with the thickness of a wall, from the thinnest to the thickest of its blocks."""
    thickness = scene.thickness_of_blocks[scene.masonry]
    sizes = dict.fromkeys(f"{size:.4g}" for size in (thickness.min(), thickness.max()))
    return f"{' … '.join(sizes)} m thick"


def block_colours(scene: Scene) -> Array:
    """Colour of each block of the wall, ``(nw, 3)``: by material, except for held blocks and the beam."""
    colours = np.array([block_colour(int(k)) for k in scene.material_of_block])
    colours[scene.fixed] = HELD
    if scene.beam is not None:
        colours[scene.beam.block] = BEAM
    return np.asarray(colours[scene.wall])


def used_block_materials(scene: Scene) -> list[int]:
    """Numbers of the materials of the wall's blocks."""
    return [int(k) for k in np.unique(scene.material_of_block[scene.masonry])]


def used_joint_materials(scene: Scene) -> list[int]:
    """Numbers of the materials of joints, without contacts of single corners."""
    return [int(k) for k in np.unique(scene.material_of_joint[~scene.joints.at_corner])]


def strength_at_corners(scene: Scene) -> str:
    """Strength of the contacts of single corners, of all their materials."""
    materials = [scene.joint_materials[k] for k in np.unique(scene.material_of_joint[scene.joints.at_corner])]
    return "; ".join(dict.fromkeys(map(strength, materials)))


def strength(material: JointMaterial) -> str:
    """Strength parameters of a joint material, in one line."""
    cohesion = f", c = {_stress(material.cohesion)}" if material.cohesion else ""
    tension = f", fₜ = {_stress(material.tensile_strength)}" if material.tensile_strength else ""
    crushing = f", fₘ = {_stress(material.compressive_strength)}" if material.compressive_strength else ""
    energies = {"G₁": material.fracture_energy_1, "G₂": material.fracture_energy_2}
    toughness = "".join(f", {name} = {readable(energy, 'J/m²')}" for name, energy in energies.items() if energy)
    return f"tan φ = {material.friction:.3g}{cohesion}{tension}{crushing}{toughness}"


def _stress(value: float) -> str:
    """Format a strength in MPa, or in a smaller unit if it is very small."""
    return f"{value / 1e6:.3g} MPa" if value >= 1e4 else readable(value, "Pa")


def _materials(scene: Scene) -> list[Any]:
    """Legend handles for block materials, if there are several, and for joint materials."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    used = used_block_materials(scene)
    handles: list[Any] = []
    if len(used) > 1:
        for k in used:
            block, colour = scene.block_materials[k], block_colour(k)
            name = "blocks" if k == 0 else block.name
            thick = f", {block.thickness:.4g} m thick" if block.thickness else ""
            label = f"{name}: {block.density:g} kg/m³{thick}"
            handles.append(Patch(fc=colour, ec="0.5", lw=0.5, label=label))
    bed, several = scene.joints.is_bed, len(used_joint_materials(scene)) > 1
    for k in used_joint_materials(scene):
        own = (scene.material_of_joint == k) & ~scene.joints.at_corner
        material = scene.joint_materials[k]
        lies = " (bed)" if bed[own].all() else " (head)" if not bed[own].any() else ""
        name = {"joint": "joints", "inner_joint": "potential cracks"}.get(material.name, f"{material.name} joints")
        text = f"{name}{lies if several and material.name != 'inner_joint' else ''}: {strength(material)}"
        handles.append(Line2D([], [], color=joint_colour(k), lw=1.2, label=_wrapped(text)))
    if scene.joints.at_corner.any():
        handles.append(
            Line2D([], [], **CORNER, ms=3.0, label=_wrapped(f"corners on sides: {strength_at_corners(scene)}"))
        )
    return handles


def _bodies(scene: Scene) -> list[Any]:
    """Legend handles for held blocks, the beam, ties, anchors and a moving support."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles = held_key(scene)
    if scene.beam is not None:
        mass = f"{scene.beam.mass:g} kg" if scene.beam.mass else "weightless"
        text = f"stiff beam: {mass}, {CONDITIONS[scene.beam.condition]}"
        handles.append(Patch(fc=BEAM, ec=DARK, lw=1.0, label=_wrapped(text)))
    for kind, members in tie_kinds(scene).items():
        numbers = f" {beginning([str(k) for k in members])}" if len(scene.ties) > 1 else ""
        name = f"tie{'s' if len(members) > 1 else ''}{numbers}"
        handles.append(Line2D([], [], color=TIE, lw=1.6, label=_wrapped(f"{name}: {kind}")))
    if (scene.ties.block < 0).any():
        handles.append(Patch(fc="white", ec="0.45", hatch="//////", lw=0, label="anchor fixed in space"))
    if scene.settlement is not None:
        handles.append(Patch(fc="none", ec=MOTION, hatch="//////", lw=0.6, label="support that moves"))
    return handles


def _loads(scene: Scene) -> list[Any]:
    """Legend handles for a live load P, for dead and live loads if both occur, and for the path of a driven beam."""
    from matplotlib.lines import Line2D

    look: dict[str, Any] = {"lw": 1.0, "marker": ">", "ms": 3.0, "markevery": [1]}
    path = scene.drive_path
    moves = beginning([minus(1e3 * u) for u in path])
    has_live = scene.settlement is None and not path
    kinds = {
        "dead load": (DEAD, bool(scene.load.dead)),
        "live load P, which grows": (DARK, has_live and is_force(scene)),
        "live load, times λ": (DARK, has_live and bool(scene.load.dead) and not is_force(scene)),
        _wrapped(f"given displacement: {moves} mm"): (MOTION, bool(path)),
    }
    return [
        Line2D([0, 1], [0, 0], color=colour, mfc="white" if colour == DEAD else colour, label=name, **look)
        for name, (colour, there) in kinds.items()
        if there
    ]


def _wrapped(text: str) -> str:
    held = text.replace(" ", "\xa0").replace(",\xa0", ", ").replace(":\xa0", ": ")
    return "\n".join(textwrap.wrap(held, LINE_LENGTH)).replace("\xa0", " ")
