"""Joint points of a wall, each with the strength and the stiffness of its joint's material."""

import math

import numpy as np

from runningbond.scene import Array, Indices, Scene, SceneError, table_of

from .law import Law
from .mohr_coulomb import PointStrength, truncated_cone
from .point_law import PointLaw
from .points import JointPoints, Rule, joint_points, lobatto
from .stiffness import joint_stiffness, stiffest

BETWEEN = 9
"""Points of a joint along which pressures are spread: with five a toe that crushes bears 2.4 % more, with 17 0.4 % less
(SW.200.1, docs/laboratory.md)."""

LEAST = 3
"""Points of a part of such a joint at least: two are as stiff against turning as if it were all at its ends."""


def wall_points(scene: Scene, rule: Rule | None = None) -> JointPoints:
    """Lay a quadrature rule on every joint of a scene, its ends moved in by the joint's inset."""
    return joint_points(scene.joints, scene.thickness_of_joints, rule, wall_inset(scene))


def wall_rule(scene: Scene, parts: int = 1, *, finite: bool = False) -> Rule:
    """Points that the law of a scene's joints is evaluated at: the ends, and what softens, crushes or closes between.

    At its ends alone a joint is three times as stiff against turning as along all of its length. Dry and perfectly
    plastic ones bear the same, but that friction may bring them along another path; one that softens bears up to three
    times as much (a stone on a bed).

    Of joints in several parts each part has a rule, and all of them together as many points as a whole joint.
    """
    return spread_rule(parts) if spreads(scene, finite=finite) else lobatto()


def spreads(scene: Scene, *, finite: bool = False) -> bool:
    """Whether any joint softens, crushes or closes, so that how pressures are spread along it matters.

    At `finite` displacements sides may meet anew, which are of the default material even if no joint was.
    """
    materials = scene.joint_materials if finite else scene.materials_of_joints
    return any(each.compressive_strength or each.closure or each.softens or _breaks(each.law) for each in materials)


def _breaks(law: object) -> bool:
    """Whether a material's own law is one that knows damage."""
    return isinstance(law, Law) and law.damage is not None


def impact_note(scene: Scene) -> str:
    """What a message says of impacts on joints that bear them all along; empty where their ends do."""
    what = "joints that soften, crush or close bear impacts all along, which then take less of a rocking motion"
    return f"{what} than Housner's" if spreads(scene, finite=True) else ""


def ends_note(scene: Scene, points: JointPoints) -> str:
    """What a message says of joints that bear at a few points, under a beam held at its height; empty elsewhere.

    What turns under it presses on the near end of a joint as if all of the pressure about it were there: a strut is
    then steeper than it is, and slides where friction is enough for that which it is.
    """
    fewest = int(np.bincount(points.joint).min()) if len(points) else BETWEEN
    if not len(scene.late_pins) or fewest >= BETWEEN:
        return ""
    where = "their ends" if fewest == 2 else "few points"
    return f"joints bear at {where} alone, and slide under a beam held at its height where whole ones may lock"


def spread_rule(parts: int = 1) -> Rule:
    """Points of `wall_rule` where joints soften, crush or close."""
    return lobatto(BETWEEN if parts == 1 else max(LEAST, 1 + math.ceil((BETWEEN - 1) / parts)))


def listed_points(scene: Scene, count: int) -> JointPoints | None:
    """The points on a scene's joints that so many forces are of: their ends, or those of `wall_rule`, or others."""
    rules = lobatto(), wall_rule(scene, finite=True)
    return next((wall_points(scene, rule) for rule in rules if count == len(rule.nodes) * len(scene.joints)), None)


def wall_inset(scene: Scene) -> Array:
    """Distance [m] by which the points of each joint of a scene keep from its ends, ``(nj,)``."""
    return np.array([material.inset for material in scene.joint_materials])[scene.material_of_joint]


def wall_strength(scene: Scene, points: JointPoints) -> PointStrength:
    """Strength of points on a scene's joints."""
    friction, tension, shear = wall_cones(scene, points.joint)
    return PointStrength(friction, tension * points.area, shear * points.area)


def wall_cones(scene: Scene, joint: Indices) -> tuple[Array, Array, Array]:
    """Tan φ, f_t [Pa] and shear at that tension [Pa] of joints of a scene by their law, three ``(n,)``."""
    laws = [(material, material.law) for material in scene.joint_materials]
    cones = [law.cone(material) if isinstance(law, Law) else truncated_cone(material) for material, law in laws]
    friction, tension, shear = np.array(cones)[scene.material_of_joint[joint]].T
    return friction, tension, shear


def wall_caps(scene: Scene, joint: Indices) -> tuple[Array, Array]:
    """Compressive strength [Pa] of joints of a scene, infinite without one, and closure at it [m], two ``(n,)``."""
    caps = [(each.compressive_strength or np.inf, each.peak_closure) for each in scene.joint_materials]
    strength, peak = np.array(caps, dtype=float)[scene.material_of_joint[joint]].T
    return strength, peak


def wall_stiffness(scene: Scene, joint: Indices, *, closed: bool = False) -> tuple[Array, Array]:
    """Normal and shear stiffness per unit area of joints of a scene, two ``(n,)`` [Pa/m], as of `joint_stiffness`.

    Of joints that are `closed` it is the largest that they come to.
    """
    both = [(joint_stiffness(each), stiffest(each)) for each in scene.materials_of_joints]
    of_material = np.array([(largest if closed else each.normal, each.shear) for each, largest in both])
    normal, shear = of_material[scene.material_number_of_joint[joint]].T
    return normal, shear


def static_law(scene: Scene, strength: PointStrength, normal: Array, shear: Array) -> PointLaw:
    """Law of a scene's joint points with a tangent, of points with a strength and stiffnesses ``(np,)`` [N/m].

    A law without a tangent is refused by a `SceneError`.
    """
    for material in scene.materials_of_joints:
        for key in ("compressive_strength", "closure"):
            if getattr(material, key) is not None:
                what = "is not taken by dem-static, which knows neither crushing nor closure; dem-dynamic and fem do"
                raise SceneError(f"{table_of(material)}.{key}", what)
    if all(material.law is None for material in scene.materials_of_joints):
        return PointLaw(strength, normal, shear)
    from .wall_law import common_law

    law = common_law(scene.materials_of_joints)
    if law.response is None:
        raise SceneError("joint.law", f'"{law.name}" has no response with a tangent, which dem-static needs')
    return law.response(strength, normal, shear)
