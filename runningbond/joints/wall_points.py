"""Joint points of a wall, each with the strength and the stiffness of its joint's material."""

import numpy as np

from runningbond.scene import Array, Indices, Scene, SceneError

from .law import Law
from .mohr_coulomb import PointStrength, truncated_cone
from .point_law import PointLaw
from .points import JointPoints, Rule, joint_points
from .stiffness import joint_stiffness


def wall_points(scene: Scene, rule: Rule | None = None) -> JointPoints:
    """Lay a quadrature rule on every joint of a scene, its ends moved in by the joint's inset."""
    return joint_points(scene.joints, scene.thickness, rule, wall_inset(scene))


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


def wall_stiffness(scene: Scene, joint: Indices) -> tuple[Array, Array]:
    """Normal and shear stiffness per unit area of joints of a scene, two ``(n,)`` [Pa/m], as of `joint_stiffness`."""
    of_material = np.array([(each.normal, each.shear) for each in map(joint_stiffness, scene.joint_materials)])
    normal, shear = of_material[scene.material_of_joint[joint]].T
    return normal, shear


def static_law(scene: Scene, strength: PointStrength, normal: Array, shear: Array) -> PointLaw:
    """Law of a scene's joint points with a tangent, of points with a strength and stiffnesses ``(np,)`` [N/m].

    A law without a tangent is refused by a `SceneError`.
    """
    if all(material.law is None for material in scene.joint_materials):
        return PointLaw(strength, normal, shear)
    from .wall_law import common_law

    law = common_law(scene.joint_materials)
    if law.response is None:
        raise SceneError("joint.law", f'"{law.name}" has no response with a tangent, which dem-static needs')
    return law.response(strength, normal, shear)
