"""The scene file: TOML in, `Scene` or one clear line out."""

import math
import os
import tomllib
from pathlib import Path
from typing import Any, cast

from .errors import SceneError, keys_of
from .loads import read_load
from .materials import BlockMaterial, JointMaterial, Mortar, Stiffness, check_friction
from .outlines import read_outlines
from .ranges import ABOVE_ZERO, AT_LEAST_ZERO, Range
from .supports import SUPPORT_KINDS, SupportKind
from .table import Table
from .wall import Scene, build_scene


def read_scene(path: str | Path) -> Scene:
    """Read a scene file, in TOML; drawings that it names are looked up beside it.

    Raises
    ------
    SceneError
        For a file that is missing, is no TOML or describes no wall: one line that names the key,
        the value and what would be right.
    """
    path = Path(path)
    return scene_from_dict(read_description(path), folder=path.parent, default_title=plain_stem(path))


def read_description(path: Path) -> dict[str, Any]:
    """The tables of a scene file as nested dictionaries, unchecked; errors as of `read_scene`."""
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise SceneError(str(path), f"cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise SceneError(str(path), "is no scene file: it is not UTF-8 text") from error
    except (RecursionError, ValueError) as error:
        raise SceneError(str(path), f"is no valid TOML: {error}") from error


def plain_stem(path: Path) -> str:
    """A file's name without its ending, as text: what is no UTF-8 in it is replaced."""
    return os.fsencode(path.stem).decode(errors="replace")


def scene_from_dict(content: dict[str, Any], *, folder: Path = Path(), default_title: str = "untitled") -> Scene:
    """Build a scene from the tables of a scene file.

    Parameters
    ----------
    content
        The file as nested dictionaries. A joint's ``law``, and a load in place of its table, may be Python objects.
    folder
        Where drawings are looked up.
    default_title
        Title of a scene that has none.

    Raises
    ------
    SceneError
        As `read_scene`.
    """
    top = Table("", content)
    title = " ".join(top.text("title", default_title).split())
    wall, block, joint, support, load = (top.table(key) for key in ("wall", "block", "joint", "support", "load"))
    inner = top.optional_table("inner_joint")
    top.finish()
    block_material = BlockMaterial(**block.numbers(BlockMaterial))
    block.finish()
    joint_material = _joint_material(joint)
    inner_material = _joint_material(inner) if inner else None
    kind = cast(SupportKind, support.choice("kind", SUPPORT_KINDS))
    support.finish()
    loads = read_load(load)
    thickness = wall.number("thickness", ABOVE_ZERO)
    outlines = read_outlines(wall, folder)
    wall.finish()
    return build_scene(
        title,
        outlines.polygons,
        thickness=thickness,
        block=block_material,
        joint=joint_material,
        load=loads,
        support=kind,
        ground=outlines.grounds[0] if outlines.grounds else None,
        bond=outlines.bond,
        inner_joint=inner_material,
    )


def _joint_material(joint: Table) -> JointMaterial:
    with keys_of(joint.name, "joint"):
        material = JointMaterial(
            friction=_friction(joint),
            elasticity=_elasticity(joint),
            law=joint.value("law"),
            **joint.numbers(JointMaterial, "friction"),
        )
    joint.finish()
    return material


def _friction(joint: Table) -> float:
    angle = joint.optional_number("friction_angle", Range(least=0.0, below=90.0))
    if angle is None:
        return joint.number("friction", AT_LEAST_ZERO)
    key = joint.key("friction_angle")
    if "friction" in joint:
        raise SceneError(key, f"does not go with {joint.key('friction')}; give one of them", angle)
    friction = math.tan(math.radians(angle))
    check_friction(key, friction, angle)
    return friction


def _elasticity(joint: Table) -> Mortar | Stiffness | None:
    direct = [key for key in ("normal_stiffness", "shear_stiffness") if key in joint]
    if "mortar" in joint:
        if direct:
            raise SceneError(joint.key(direct[0]), f"does not go with {joint.key('mortar')}; give one of them")
        mortar = joint.table("mortar")
        layer = Mortar(**mortar.numbers(Mortar))
        mortar.finish()
        return layer
    if direct:
        return Stiffness(joint.number("normal_stiffness", ABOVE_ZERO), joint.number("shear_stiffness", ABOVE_ZERO))
    return None
