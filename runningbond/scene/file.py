"""Reading a scene file: from TOML to a `Scene`, or to an error of one line."""

import math
import os
import tomllib
from pathlib import Path
from typing import Any, cast, get_args

from .assignment import ANY, BEAM, GROUND, read_assignments
from .beam import read_beam
from .build import build_scene
from .errors import SceneError, keys_of
from .ground import strip_reach
from .loads import read_load
from .materials import BlockMaterial, Closure, JointMaterial, Mortar, Softening, Stiffness, check_friction
from .outlines import read_outlines
from .ranges import ABOVE_ZERO, AT_LEAST_ZERO, Range, path_of
from .scene import Scene
from .supports import SUPPORT_KINDS, SupportKind
from .table import Table
from .ties import read_tie

RESERVED = ("block", "joint", "inner_joint", ANY, BEAM, GROUND)
"""Names that are not allowed for materials of ``[materials]`` and ``[joints]``."""


DUPLICATE_KEY = ("Cannot overwrite", "Cannot mutate")
"""Starts of the messages with which Python's TOML reader refuses a key that is given twice."""


def read_scene(path: str | Path) -> Scene:
    """Read a scene file in TOML; paths of drawings and records in it are relative to its folder.

    Raises
    ------
    SceneError
        For a file that is missing, is not valid TOML or does not describe a wall: one line that names the
        key, the value and what would be right.
    """
    path = path_of("path", path)
    return scene_from_dict(read_description(path), folder=path.parent, default_title=plain_stem(path))


def read_description(path: Path) -> dict[str, Any]:
    """The tables of a scene file as nested dictionaries, unchecked; raises the same errors as `read_scene`."""
    try:
        return tomllib.loads(path.read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise SceneError(str(path), f"cannot be read: {error.strerror or error}") from error
    except UnicodeDecodeError as error:
        raise SceneError(str(path), "is not a scene file: it is not UTF-8 text") from error
    except (RecursionError, ValueError) as error:
        twice = "; a key is given twice" if str(error).startswith(DUPLICATE_KEY) else ""
        raise SceneError(str(path), f"is not valid TOML: {error}{twice}") from error


def plain_stem(path: Path) -> str:
    """A file's name without its suffix, as text in which bytes that are not UTF-8 are replaced."""
    return os.fsencode(path.stem).decode(errors="replace")


def _title(text: str) -> str:
    """A title as one line; characters that no picture can show in it are refused."""
    title = " ".join(text.split())
    if any(letter < " " or letter in "\ufffe\uffff" for letter in title):  # none of them is allowed in XML
        raise SceneError("title", "must be a string without control characters", title)
    if any("\ud800" <= letter <= "\udfff" for letter in title):  # of file names that are not UTF-8
        raise SceneError("title", "must be Unicode text, without lone surrogates", ascii(title))
    return title


def scene_from_dict(content: dict[str, Any], *, folder: Path = Path(), default_title: str = "untitled") -> Scene:
    """Build a scene from the tables of a scene file.

    Parameters
    ----------
    content
        The file as nested dictionaries. A joint's ``law`` is a Python object; loads may be objects in place of tables.
    folder
        Folder that paths of drawings and records are relative to.
    default_title
        Title if the file gives none.

    Raises
    ------
    SceneError
        As for `read_scene`.
    """
    if not isinstance(content, dict):
        raise SceneError("content", "must be a dictionary of the tables of a scene file", content)
    try:
        return _scene(content, folder, default_title)
    except SceneError:
        from .schema import misspelt

        # A misspelt key may be the reason why another one is missing or does not fit, so it is reported first.
        found = misspelt(content) if Table.visits is None else None
        if found is not None:
            raise found from None
        raise


def _scene(content: dict[str, Any], folder: Path, default_title: str) -> Scene:
    top = Table("", content)
    title = _title(top.text("title", default_title))
    wall, block, joint, support, load = (top.table(key) for key in ("wall", "block", "joint", "support", "load"))
    inner, beam_table = top.optional_table("inner_joint"), top.optional_table("beam")
    material_tables, joint_tables = top.tables_by_name("materials"), top.tables_by_name("joints")
    assign, tie_tables = top.value("assign", []), top.list_of_tables("tie")
    top.finish()
    block_material, *materials = (_block_material(table) for table in (block, *material_tables))
    joint_material, *joints = (_joint_material(table) for table in (joint, *joint_tables))
    inner_material = _joint_material(inner) if inner else None
    block_names = [each.name for each in (block_material, *materials)]
    joint_names = [each.name for each in (joint_material, *joints)]
    assignments = read_assignments(assign, block_names, joint_names)
    beam = read_beam(beam_table, joint_names) if beam_table else None
    kind = cast(SupportKind, support.choice("kind", SUPPORT_KINDS))
    support.finish()
    loads = read_load(load, folder, driven=beam is not None and beam.drive is not None)
    thickness = wall.number("thickness", ABOVE_ZERO)
    outlines = read_outlines(wall, folder, thickness, block_names, strip=strip_reach(kind, loads))
    wall.finish()
    return build_scene(
        title,
        outlines.polygons,
        thickness=thickness,
        block=block_material,
        joint=joint_material,
        load=loads,
        support=kind,
        grounds=outlines.grounds,
        bond=outlines.bond,
        inner_joint=inner_material,
        whole_up_to=outlines.whole_up_to,
        materials=materials,
        joints=joints,
        assignments=assignments,
        layers=outlines.layers,
        material_of=outlines.materials,
        beam=beam,
        ties=[read_tie(table) for table in tie_tables],
        notes=outlines.notes,
    )


def _block_material(block: Table) -> BlockMaterial:
    with keys_of(block.name, "block"):
        material = BlockMaterial(**block.numbers(BlockMaterial), name=_material_name(block))
    block.finish()
    return material


def _material_name(table: Table) -> str:
    """Name of a material: the name of its table without that of the parent table; it may contain dots."""
    kind, _, name = table.name.partition(".")
    if kind != table.name and not name.strip():
        raise SceneError(table.name, "must have a name, by which [[assign]] knows it")
    if name in RESERVED:
        raise SceneError(table.name, f"is a name that means something else; take another than {', '.join(RESERVED)}")
    return name or kind


def _joint_material(joint: Table) -> JointMaterial:
    with keys_of(joint.name, "joint"):
        material = JointMaterial(
            friction=_friction(joint),
            elasticity=_elasticity(joint),
            closure=_closure(joint),
            law=joint.value("law"),
            softening=cast(Softening, joint.choice("softening", get_args(Softening), "linear")),
            name=_material_name(joint),
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


def _closure(joint: Table) -> Closure | None:
    if "closure" not in joint:
        return None
    table = joint.table("closure")
    closure = Closure(**table.numbers(Closure))
    table.finish()
    return closure


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
