"""The scene of a tested wall: from its own file, or from its row of the table and the data of its stone."""

import math
import re
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from runningbond.joints import joint_stiffness
from runningbond.joints.closure import closure_curve, stiffness_at
from runningbond.scene import JointMaterial, Scene, SceneError, Stiffness, scene_from_dict
from runningbond.scene.file import read_description

from .formulas import pressed
from .measured import MeasuredWall
from .stones import POISSON, SHEAR_ENERGIES, SPLITTING_ENERGY, UNIT_WEIGHT, Stone, find_stone

GRAVITY = 9.81
LOAD_IN_NAME = re.compile(r"^[^\W\d_]+\d*[._ -](\d+)(?!\d)")
FAR = 0.03
"""Displacement, relative to the actuator's height, to which a wall without a curve is pushed."""

STIFFER = 10
"""Stiffness of inner joints relative to the parts of blocks that they join, if these parts deform."""

SAME_LOAD = 1.15
"""Ratio of the load in a wall's name to that of the table, or its inverse, up to which both are the same load."""

MOST_BLOCKS = 5000
"""Largest number of blocks of a laboratory wall; more of them indicate a wrong unit."""

LEAST_BEAM = 0.2
"""Smallest height of the beam [m], if the actuator is too low to define one; without influence because the beam is
stiff."""

CRUSHING = ("compressive_strength", "compressive_fracture_energy", "cap_shear", "peak_closure")
NO_CRUSHING: dict[str, Any] = {one.name: one.default for one in fields(JointMaterial) if one.name in CRUSHING}
"""Crushing parameters of a joint that does not crush."""


@dataclass(frozen=True)
class Features:
    """Features of a wall that its scene includes; the rungs of the ladder include more and more of them.

    Parameters
    ----------
    driven
        Whether the beam is displaced along the test's path; else it is pushed by a force of λ newtons.
    closes, crushes, splits
        Whether joints stiffen with pressure, whether they crush, and whether blocks may split on their axis.
    deformable
        Whether blocks deform, so that joints get only what remains of the wall's compliance.
    parts
        Number of parts into which blocks may crack over their height; inner joints are stiff enough not to soften them.
    """

    driven: bool = True
    closes: bool = False
    crushes: bool = False
    splits: bool = False
    deformable: bool = False
    parts: int = 1


RICHEST = Features(closes=True, crushes=True, splits=True)
"""All features that a wall's description may have."""


def scene_of(wall: MeasuredWall, features: Features) -> Scene:
    """The scene of a wall, with the given features."""
    if wall.scene_file is None:
        scene = scene_from_dict(_tables(wall, features))
    else:
        scene = _simplified(_read(wall, wall.scene_file, features), features)
    return scene if features.parts == 1 else _stiffened(scene, features.parts)


def driven_path(wall: MeasuredWall) -> tuple[float, ...]:
    """Displacements [m] along which models drive a wall's beam; empty if its own scene has a force instead."""
    return scene_of(wall, Features()).drive_path


def _read(wall: MeasuredWall, path: Path, features: Features) -> Scene:
    """The scene of a wall's own file: with inner joints if it splits, along its path or pushed by a force of 1 N."""
    tables = read_description(path)
    if not features.splits:
        tables.pop("inner_joint", None)
    beam = tables.get("beam", {})
    if not isinstance(beam, dict) or "drive" not in beam:
        raise SceneError(f"{path.name}: beam.drive", "is missing; a tested wall is pushed at its beam")
    scene = scene_from_dict(tables, folder=path.parent, default_title=wall.name)
    if scene.drive is None or (features.driven and scene.drive.path):
        return scene
    for key, remedy, is_wrong in (
        ("beam.drive.force", "must be horizontal", scene.drive.force[1] != 0),
        ("load.live", "must be left out", len(scene.load.live) > 1),
    ):
        if is_wrong:
            told = f"{remedy}; λ is the force that a tested wall is pushed with"
            raise SceneError(f"{path.name}: {key}", told)
    # The force acts to the side to which the wall is pushed first, where its strength may be lower than on the other
    # side. It is 1 N whatever the file has, so that λ is the wall's strength in newtons.
    side = math.copysign(1.0, scene.drive.force[0])
    at = {} if scene.drive.at is None else {"at": scene.drive.at}
    tables["beam"] = beam | {"drive": {"force": [side, 0]} | at}
    return scene_from_dict(tables, folder=path.parent, default_title=wall.name)


def _simplified(scene: Scene, features: Features) -> Scene:
    """The scene without joints that crush, or that stiffen with pressure, unless these features are requested."""
    (left, _), (right, _) = scene.blocks.extent(scene.masonry)
    thickness = float(np.average(scene.thickness_of_blocks[scene.masonry], weights=scene.blocks.area[scene.masonry]))
    pressure = max(pressed(scene), 0.0) / ((right - left) * thickness)
    materials = scene.joint_materials
    if not features.crushes:
        materials = tuple(replace(each, **NO_CRUSHING) for each in materials)
    if not features.closes:
        materials = tuple(_as_stiff_as_under(pressure, each) for each in materials)
    return replace(scene, joint_materials=materials)


def _as_stiff_as_under(pressure: float, material: JointMaterial) -> JointMaterial:
    """A joint of constant stiffness, equal to that of a stiffening joint under a pressure [Pa]."""
    if material.closure is None:
        return material
    normal = float(stiffness_at(pressure, closure_curve(material)))
    return replace(material, closure=None, elasticity=Stiffness(normal, joint_stiffness(material).shear))


def _tables(wall: MeasuredWall, features: Features) -> dict[str, Any]:
    row = wall.row
    stone = find_stone(row)
    if row.joints not in ("dry", ""):
        raise SceneError(row.key("Joints"), 'must be "Dry"; for others give a scene NAME.toml', row.text("joints"))
    length, thickness, at = row.number("L"), row.number("t"), row.number("H0")
    height, width = row.number("hb"), row.number("lb")
    courses = _courses(wall, stone, height)
    force = vertical_load(wall)
    start, growth = stone.stiffness(height, deformable=features.deformable)
    normal = start + growth * force / (length * thickness)
    joint: dict[str, Any] = {
        "friction": stone.friction,
        "normal_stiffness": start if features.closes else normal,
        "shear_stiffness": normal / (2 * (1 + POISSON)),
    }
    if features.closes:
        joint["closure"] = {"growth": growth, "stiffest": stone.young / height}
    if features.crushes:
        joint["compressive_strength"] = stone.prism
    top = courses * height
    beam = max(2 * (at - top), LEAST_BEAM)
    drive: dict[str, Any] = {"force": [1, 0]}
    if features.driven:
        drive = {"displacement": [list(wall.path or (FAR * at,))]}
    tables: dict[str, Any] = {
        "title": wall.name,
        "wall": {
            "block_width": width,
            "block_height": height,
            "thickness": thickness,
            "length": length,
            "height": top,
            "first_course": stone.first_course,
        },
        "block": {"density": UNIT_WEIGHT / GRAVITY, "young": stone.young, "poisson": POISSON},
        "joint": joint,
        "support": {"kind": "base"},
        "load": {"gravity": GRAVITY},
        "beam": {
            "height": beam,
            "condition": "free",
            "force": [0, -force],
            "force_line": "fixed",
            "drive": drive | {"at": at},
        },
    }
    if features.splits:
        tables["inner_joint"] = _crack(stone, width, deformable=features.deformable)
    return tables


def _crack(stone: Stone, width: float, *, deformable: bool) -> dict[str, Any]:
    """A potential crack on the axis of a block: as stiff as its halves, or `STIFFER` times that if they deform."""
    normal = (STIFFER if deformable else 1) * stone.young / (width / 2)
    return {
        "friction": stone.friction,
        "cohesion": stone.cohesion,
        "tensile_strength": stone.tensile,
        "fracture_energy_1": SPLITTING_ENERGY,
        "fracture_energy_2": SHEAR_ENERGIES * SPLITTING_ENERGY,
        "normal_stiffness": normal,
        "shear_stiffness": normal / (2 * (1 + POISSON)),
    }


def _stiffened(scene: Scene, parts: int) -> Scene:
    """The scene with inner joints at least `STIFFER` times as stiff as the parts of blocks between them."""
    inner = scene.inner_joint
    if inner is None:
        return scene
    low, high = (corner[scene.masonry] for corner in scene.blocks.boxes)
    size = float((high - low)[:, 1].min()) / parts
    young = max(scene.block_materials[k].young or 0.0 for k in set(scene.material_of_block[scene.masonry].tolist()))
    wanted = STIFFER * young / size
    return with_inner_stiffness(scene, max(1.0, wanted / joint_stiffness(inner).normal))


def with_inner_stiffness(scene: Scene, times: float) -> Scene:
    """The scene with the stiffness of its inner joints multiplied by `times`."""
    inner = scene.inner_joint
    if inner is None:
        return scene
    stiffness = joint_stiffness(inner)
    stiff = replace(inner, elasticity=Stiffness(times * stiffness.normal, times * stiffness.shear))
    return replace(scene, joint_materials=tuple(stiff if each is inner else each for each in scene.joint_materials))


def _courses(wall: MeasuredWall, stone: Stone, height: float) -> int:
    """Number of courses: by the actuator's height for walls drawn as high as that, else by the table's height."""
    # Walls are as high as the actuator only if that is within a course of the table's height.
    at, tall = wall.row.number("H0"), wall.row.number("H")
    column = "H0" if stone.is_square and abs(at - tall) < 1.02 * height else "H"
    tall = wall.row.number(column)
    courses = round(tall / height)
    if courses < 1 or abs(courses * height - tall) > 0.02 * height:
        raise SceneError(wall.row.key(column), f"must be a whole number of courses of {height:g} m", f"{tall:g} m")
    row = wall.row
    if (blocks := courses * row.number("L") / row.number("lb")) > MOST_BLOCKS:
        remedy = f"makes {blocks:.3g} blocks with lb = {row.text('lb')} and L = {row.text('L')}; are their units right?"
        raise SceneError(row.key("hb"), remedy, row.text("hb"))
    return courses


def load_in_name(name: str) -> float:
    """The load [N] which is part of a wall's name, in kN; 0 if there is none."""
    found = LOAD_IN_NAME.match(name)
    return 1e3 * float(found[1]) if found else 0.0


def vertical_load(wall: MeasuredWall) -> float:
    """The load on the beam [N]: Ntot less the weight of the wall, else σ0 L t, else the number in the wall's name.

    If the number in the name is nearly equal to this load, it is used instead: the wall was tested under it.
    """
    row, named = wall.row, load_in_name(wall.name)
    stress = row.optional("σ0,pc")
    if row.optional("Ntot") is None and (named or stress):
        load = named if stress is None else stress * row.number("L") * row.number("t")
    else:
        load = row.number("Ntot", "σ0,pc") - UNIT_WEIGHT * row.number("L") * row.number("t") * row.number("H")
    if load <= 0:
        raise SceneError(row.key("Ntot"), "must be more than the weight of the wall", row.text("Ntot"))
    return named if named / SAME_LOAD < load < named * SAME_LOAD else load
