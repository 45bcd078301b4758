"""The scene file: TOML in, `Scene` or one clear line out."""

import math
import tomllib
from pathlib import Path
from typing import Any, cast, get_args

from .arrays import Array
from .bond import Bond, Ends, FirstCourse, course_pattern, running_bond
from .drawing import METRES, read_drawing
from .errors import SceneError
from .loads import Lateral, Load, PointLoad
from .materials import BlockMaterial, JointMaterial, Mortar, Stiffness
from .supports import SUPPORT_KINDS, SupportKind
from .table import Table
from .wall import Scene, build_scene

LEAST_FRICTION = 1e-6
"""Least tan φ that is not 0: what is smaller drowns in a linear program's tolerance, cohesion / tan φ with it."""

LEAST_COMPONENT = 1e-6
"""Least component of a force that is not 0, in the other one: what is smaller drowns there as well."""


def read_scene(path: str | Path) -> Scene:
    """Read a scene file.

    Parameters
    ----------
    path
        A TOML file; drawings it names are looked up beside it.

    Raises
    ------
    SceneError
        For a file that is missing, is no TOML or describes no wall: one line that names the key,
        the value and what would be right.
    """
    path = Path(path)
    return scene_from_dict(read_description(path), folder=path.parent, default_title=path.stem)


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


def scene_from_dict(content: dict[str, Any], *, folder: Path = Path(), default_title: str = "untitled") -> Scene:
    """Build a scene from the tables of a scene file.

    Parameters
    ----------
    content
        The file as nested dictionaries.
    folder
        Where drawings are looked up.
    default_title
        Title of a scene that has none.
    """
    top = Table("", content)
    title = " ".join(top.text("title", default_title).split())
    wall, block, joint, support, load = (top.table(key) for key in ("wall", "block", "joint", "support", "load"))
    inner = top.optional_table("inner_joint")
    top.finish()
    block_material = _block_material(block)
    joint_material = _joint_material(joint)
    inner_material = _joint_material(inner) if inner else None
    if inner_material and joint_material.elasticity and not inner_material.elasticity:
        raise SceneError("inner_joint.mortar", "is missing; joint has a stiffness, and models that need it need both")
    kind = cast(SupportKind, support.choice("kind", SUPPORT_KINDS))
    support.finish()
    loads = _load(load)
    thickness = wall.number("thickness", above=0.0)
    polygons, ground, bond = _blocks(wall, folder)
    wall.finish()
    if ground is not None and kind in ("corners", "pinned-corners"):
        raise SceneError("support.kind", 'a drawing brings its ground; use "base" or "fixed-first-course"', kind)
    return build_scene(
        title,
        polygons,
        thickness=thickness,
        block=block_material,
        joint=joint_material,
        load=loads,
        support=kind,
        ground=ground,
        bond=bond,
        inner_joint=inner_material,
    )


def _blocks(wall: Table, folder: Path) -> tuple[list[Array], Array | None, Bond | None]:
    _refuse_mixed_descriptions(wall)
    if "drawing" in wall:
        path = folder / wall.text("drawing")
        blocks, ground = read_drawing(path, wall.choice("units", METRES))
        return blocks, ground, None
    bond = Bond(wall.number("block_width", above=0.0), wall.number("block_height", above=0.0))
    if "courses" in wall:
        return course_pattern(bond, wall.rows("courses")), None, bond
    length, height = wall.number("length", above=0.0), wall.number("height", above=0.0)
    first = cast(FirstCourse, wall.choice("first_course", get_args(FirstCourse), "full"))
    ends = cast(Ends, wall.choice("ends", get_args(Ends), "flush"))
    return running_bond(bond, length, height, first, ends), None, bond


def _refuse_mixed_descriptions(wall: Table) -> None:
    """A wall is a drawing, a list of courses, or a length and height; the keys of two ways do not mix."""
    by_size = ("length", "height", "first_course", "ends")
    for way, strangers in (
        ("drawing", ("courses", *by_size, "block_width", "block_height")),
        ("courses", ("units", *by_size)),
        ("length", ("units",)),
    ):
        if way in wall:
            for key in strangers:
                if key in wall:
                    raise SceneError(f"wall.{key}", f"does not go with wall.{way}; describe the wall in one way")
            return


def _block_material(block: Table) -> BlockMaterial:
    material = BlockMaterial(
        density=block.number("density", above=0.0),
        young=block.optional_number("young", above=0.0),
        poisson=block.number("poisson", 0.0, above=-1.0, most=0.5),
    )
    block.finish()
    return material


def _joint_material(joint: Table) -> JointMaterial:
    friction = _friction(joint)
    cohesion = joint.number("cohesion", 0.0, least=0.0)
    material = JointMaterial(
        friction=friction,
        cohesion=cohesion,
        tensile_strength=_tensile_strength(joint, friction, cohesion),
        elasticity=_elasticity(joint),
        inset=joint.number("inset", 0.0, least=0.0),
        fracture_energy_1=joint.optional_number("fracture_energy_1", least=0.0),
        fracture_energy_2=joint.optional_number("fracture_energy_2", least=0.0),
    )
    if material.fracture_energy_1 is None and material.fracture_energy_2 is not None:
        raise SceneError(
            joint.key("fracture_energy_1"), "is missing; what a joint loses in slip it loses in opening as well"
        )
    joint.finish()
    return material


def _friction(joint: Table) -> float:
    angle = joint.optional_number("friction_angle", least=0.0, below=90.0)
    if angle is not None and "friction" in joint:
        raise SceneError(
            joint.key("friction_angle"), f"does not go with {joint.key('friction')}; give one of them", angle
        )
    friction = joint.number("friction", least=0.0) if angle is None else math.tan(math.radians(angle))
    if 0 < friction < LEAST_FRICTION:
        key, value = ("friction", friction) if angle is None else ("friction_angle", angle)
        raise SceneError(
            joint.key(key), f"must be 0, for joints without friction, or such that tan φ ≥ {LEAST_FRICTION:g}", value
        )
    return friction


def _tensile_strength(joint: Table, friction: float, cohesion: float) -> float:
    """Tension cut-off, by default the apex of the cone."""
    given = joint.optional_number("tensile_strength", least=0.0)
    if friction == 0.0:
        if given is None and cohesion > 0.0:
            raise SceneError(
                joint.key("tensile_strength"),
                "is missing; with friction 0 its default, cohesion / friction, does not exist",
            )
        return given or 0.0
    apex = cohesion / friction
    if given is None:
        return apex
    if given > apex * (1 + 1e-3):
        raise SceneError(
            joint.key("tensile_strength"),
            f"must be at most cohesion / friction = {apex:.6g}, the apex of the Coulomb cone",
            given,
        )
    return min(given, apex)


def _elasticity(joint: Table) -> Mortar | Stiffness | None:
    direct = [key for key in ("normal_stiffness", "shear_stiffness") if key in joint]
    if "mortar" in joint:
        if direct:
            raise SceneError(joint.key(direct[0]), f"does not go with {joint.key('mortar')}; give one of them")
        mortar = joint.table("mortar")
        layer = Mortar(
            mortar.number("young", above=0.0),
            mortar.number("poisson", least=0.0, below=0.5),
            mortar.number("thickness", above=0.0),
        )
        mortar.finish()
        return layer
    if direct:
        return Stiffness(joint.number("normal_stiffness", above=0.0), joint.number("shear_stiffness", above=0.0))
    return None


def _load(load: Table) -> Load:
    gravity = load.number("gravity", least=0.0)
    live = load.table("live")
    kind = live.choice("kind", ("lateral", "point"))
    action: Lateral | PointLoad = Lateral()
    if kind == "point":
        action = PointLoad(live.vector("at"), live.vector("force"))
        if not any(action.force):
            raise SceneError("load.live.force", "must not be zero", list(action.force))
        smaller, larger = sorted(map(abs, action.force))
        if 0 < smaller < LEAST_COMPONENT * larger:
            what = f"must have components that are 0 or at least {LEAST_COMPONENT:g} of each other"
            raise SceneError("load.live.force", what, list(action.force))
    live.finish()
    load.finish()
    return Load((0.0, -gravity), action)
