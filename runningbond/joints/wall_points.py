"""Joint points of a wall, with the strength and stiffness of their joints' materials."""

import numpy as np

from runningbond.scene import Array, Indices, Scene, SceneError, table_of

from .law import Law
from .mohr_coulomb import PointStrength, truncated_cone
from .point_law import PointLaw
from .points import JointPoints, Rule, joint_points, lobatto
from .stiffness import joint_stiffness, stiffest
from .trial import CheckedLaw, cone_of

BETWEEN = 9
"""Number of points on a joint that softens, crushes or closes: with 5 points, a toe that crushes carries 2.3 % more,
with 17 points 0.3 % less (SW.200.1, docs/laboratory.md)."""

MIN_POINTS = 3
"""Least number of points on a part of such a joint: with two, its rotational stiffness is that of its two ends."""

CORNER_INSET = 0.4995
"""Inset of the points on the contact of a single corner, relative to its length: their lever arm is of no account."""


def wall_points(scene: Scene, rule: Rule | None = None) -> JointPoints:
    """Place a quadrature rule on every joint of a scene, with its ends moved in by the joint's inset."""
    return joint_points(scene.joints, bearing_thickness(scene), rule, wall_inset(scene))


def bearing_thickness(scene: Scene) -> Array:
    """Thickness of joints [m], ``(nj,)``; that of a corner's contact is reduced where joints have points along them.

    A block that rocks on such a joint bears on its last point alone, with a small part of the area. A corner on a side
    is as soft, and so are corners at finite displacements.
    """
    at_end = float(wall_rule(scene).weights[0])
    return np.where(scene.joints.at_corner, at_end, 1.0) * scene.thickness_of_joints


def wall_rule(scene: Scene, parts: int = 1, *, finite: bool = False) -> Rule:
    """Points at which joints are evaluated: their ends, and also between them if any joint softens, crushes or closes.

    Evaluated only at its ends, a joint is three times as stiff against rotation as along its whole length. Dry and
    perfectly plastic joints carry the same load in both cases, unless friction leads to another load path; a softening
    joint carries up to three times as much if it is evaluated only at its ends (a stone on a bed).

    If joints have several parts, each part has a rule (`spread_rule`).
    """
    return spread_rule(parts) if spreads(scene, finite=finite) else lobatto()


def spreads(scene: Scene, *, finite: bool = False) -> bool:
    """Whether any joint softens, crushes or closes, so that the distribution of pressure along it matters.

    At `finite` displacements, new contacts have the default material, even if no joint of the wall has it.
    """
    materials = scene.joint_materials if finite else scene.materials_of_joints
    return any(each.compressive_strength or each.closure or each.softens or _may_break(each.law) for each in materials)


def _may_break(law: object) -> bool:
    """Whether a material's own law includes damage or crushing."""
    return isinstance(law, Law) and law.may_break


def impact_note(scene: Scene) -> str:
    """Note for a message on impacts on joints that are evaluated along their length; empty for others."""
    what = "joints that soften, crush or close take impacts along their whole length, and rocking loses less energy"
    return f"{what} than by Housner's equation" if spreads(scene, finite=True) else ""


def ends_note(scene: Scene, points: JointPoints) -> str:
    """Note for a message on joints with few points under a beam held at its height; empty for others.

    A block that rotates under the beam presses on the near end of a joint as if all pressure around it acted there: the
    strut in it is then flatter than the real one, and slides although friction is sufficient for the real one.
    """
    fewest = int(np.bincount(points.joint).min()) if len(points) else BETWEEN
    if not len(scene.late_pins) or fewest >= BETWEEN:
        return ""
    where = "their ends" if fewest == 2 else "few points"
    what = "slide under a beam held at its height where joints along whole sides may lock"
    return f"joints carry forces only at {where}, and {what}"


def spread_rule(parts: int = 1) -> Rule:
    """Points of `wall_rule` for joints that soften, crush or close: on parts, at the ends as near as on a whole joint.

    With wider spaces there, joints crack in larger jumps and carry more.
    """
    fewest = range(MIN_POINTS, BETWEEN)
    return next((rule for rule in map(lobatto, fewest) if _end_space(rule) <= parts * _end_space()), lobatto(BETWEEN))


def _end_space(rule: Rule | None = None) -> float:
    """Distance of the first two nodes of a rule, of that with `BETWEEN` points by default."""
    return float(np.diff((rule or lobatto(BETWEEN)).nodes[:2])[0])


def listed_points(scene: Scene, count: int) -> JointPoints | None:
    """Points on a scene's joints that match a number of forces: the joints' ends, or those of `wall_rule`, or None."""
    rules = lobatto(), wall_rule(scene, finite=True)
    return next((wall_points(scene, rule) for rule in rules if count == len(rule.nodes) * len(scene.joints)), None)


def wall_inset(scene: Scene) -> Array:
    """Distance [m] of the outermost points of each joint of a scene from the joint's ends, ``(nj,)``."""
    inset = np.array([material.inset for material in scene.joint_materials])[scene.material_of_joint]
    return np.where(scene.joints.at_corner, CORNER_INSET * scene.joints.length, inset)


def wall_strength(scene: Scene, points: JointPoints) -> PointStrength:
    """Strength of points on a scene's joints."""
    friction, tension, shear = wall_cones(scene, points.joint)
    return PointStrength(friction, tension * points.area, shear * points.area)


def wall_cones(scene: Scene, joint: Indices) -> tuple[Array, Array, Array]:
    """Tan φ, f_t [Pa] and shear at that tension [Pa] of joints of a scene from their laws, three ``(n,)``."""
    laws = [(material, material.law) for material in scene.joint_materials]
    cones = [cone_of(law, material) if isinstance(law, Law) else truncated_cone(material) for material, law in laws]
    friction, tension, shear = np.array(cones)[scene.material_of_joint[joint]].T
    return friction, tension, shear


def wall_caps(scene: Scene, joint: Indices) -> tuple[Array, Array]:
    """Compressive strength [Pa] of joints of a scene, infinite without one, and `peak_closure` [m]: two ``(n,)``."""
    caps = [(each.compressive_strength or np.inf, each.peak_closure) for each in scene.joint_materials]
    strength, peak = np.array(caps, dtype=float)[scene.material_of_joint[joint]].T
    return strength, peak


def wall_stiffness(scene: Scene, joint: Indices, *, closed: bool = False) -> tuple[Array, Array]:
    """Normal and shear stiffness per unit area of joints of a scene, two ``(n,)`` [Pa/m], as in `joint_stiffness`.

    If the joints are `closed`, the normal stiffness is the largest that they reach.
    """
    both = [(joint_stiffness(each), stiffest(each)) for each in scene.materials_of_joints]
    of_material = np.array([(largest if closed else each.normal, each.shear) for each, largest in both])
    normal, shear = of_material[scene.material_number_of_joint[joint]].T
    return normal, shear


def static_law(scene: Scene, strength: PointStrength, normal: Array, shear: Array) -> PointLaw:
    """Law with a tangent for a scene's joint points, from their strength and stiffnesses ``(np,)`` [N/m].

    Raises a `SceneError` for crushing, for closure, and for a law without a tangent.
    """
    for material in scene.materials_of_joints:
        for key in ("compressive_strength", "closure"):
            if getattr(material, key) is not None:
                what = (
                    "is not supported by dem-static, which models neither crushing nor closure; dem-dynamic and fem do"
                )
                raise SceneError(f"{table_of(material)}.{key}", what)
    if all(material.law is None for material in scene.materials_of_joints):
        return PointLaw(strength, normal, shear)
    from .wall_law import common_law

    law = common_law(scene.materials_of_joints)
    if law.response is None:
        raise SceneError("joint.law", f'"{law.name}" has no response with a tangent, which dem-static needs')
    response = law.response(strength, normal, shear)
    return response if law.response is PointLaw else CheckedLaw(strength, normal, shear, response, law.name)
