"""A scene as a block system of rigid blocks at finite displacements: which corner rests on which face."""

from dataclasses import dataclass, replace

import numpy as np

from dynamics import BlockSystem
from joints import joint_stiffness, point_strength
from joints.point_kernel import coulomb_law
from scene import Array, Indices, Scene, SceneError

from .finite_kernels import gather_finite, scatter_finite
from .rigid_system import rigid_system


@dataclass(frozen=True, eq=False)
class Contacts:
    """Corners on faces, each array a row a contact.

    Parameters
    ----------
    owner, face : (n,) int
        Block whose corner it is, and block on whose side it rests.
    place : (n, 2) float
        Where [m], on the undeformed wall.
    normal : (n, 2) float
        Normal of the joint, from its block a to its block b.
    sense : (n,) float
        1 where the owner is the joint's block b, −1 where it is a.
    bounds : (n, 2) float
        Least and greatest slip [m] at which the corner is still on the face.
    area : (n,) float
        Area [m²] it stands for.
    """

    owner: Indices
    face: Indices
    place: Array
    normal: Array
    sense: Array
    bounds: Array
    area: Array


def contacts(scene: Scene) -> Contacts:
    """Find the corners at the ends of every joint.

    The end of a joint is a corner of one of its blocks, which then rests on the other's face; where it is a corner
    of both, each rests on the other with half the area, so that whichever stays on its face after a slip bears.
    """
    joints, blocks, inset = scene.joints, scene.blocks, scene.joint.inset
    run = joints.ends[:, 1] - joints.ends[:, 0]
    tangent = run / joints.length[:, None]
    rows: list[tuple[int, int, Array, Array, float, Array, float]] = []
    for j, (pair, ends) in enumerate(zip(joints.block, joints.ends, strict=True)):
        for end, inwards in ((ends[0], tangent[j]), (ends[1], -tangent[j])):
            owners = [k for k in (0, 1) if _is_corner(blocks.polygon(pair[k]), end, blocks.tolerance)]
            area = joints.length[j] * scene.thickness / 2 / max(1, len(owners))
            for k in owners:
                place = end + inset * inwards
                sense = 1.0 if k == 1 else -1.0
                reach = _side(blocks.polygon(pair[1 - k]), place, tangent[j], blocks.tolerance)
                bounds = np.sort(sense * reach) + [-blocks.tolerance, blocks.tolerance]
                normal = np.array([tangent[j, 1], -tangent[j, 0]])
                rows.append((pair[k], pair[1 - k], place, normal, sense, bounds, area))
    columns = [np.array(column) for column in zip(*rows, strict=True)]
    return Contacts(*columns)


def finite_system(scene: Scene) -> BlockSystem:
    """Set up the rigid blocks of a scene for finite displacements.

    Raises
    ------
    SceneError
        If the scene gives its joints no stiffness, or pins corners, or glues its joints: a joint that has slid
        away from where it was glued has a cohesion that only a law with damage can speak of.
    """
    if len(scene.pins):
        raise SceneError("support.kind", 'finite displacements need "base" or "fixed-first-course"')
    if scene.joint.cohesion > 0:
        raise SceneError("joint.cohesion", "finite displacements need dry joints", scene.joint.cohesion)
    small = rigid_system(scene)
    found = contacts(scene)
    centroid = scene.blocks.centroid
    stiffness = joint_stiffness(scene.joint)
    strength = point_strength(scene.joint, found.area)
    n = len(found.owner)
    geometry = (
        (3 * found.owner).astype(np.uint64),
        (3 * found.face).astype(np.uint64),
        found.place - centroid[found.owner],
        found.place - centroid[found.face],
        found.normal.copy(),
        found.sense.copy(),
        centroid.copy(),
        found.bounds.copy(),
        np.zeros((len(centroid), 4)),
        np.zeros((n, 5)),
    )
    return replace(
        small,
        law=coulomb_law(stiffness.normal * found.area, stiffness.shear * found.area, strength),
        gather=gather_finite,
        scatter=scatter_finite,
        geometry=geometry,
    )


def _is_corner(polygon: Array, point: Array, tolerance: float) -> bool:
    return bool((np.hypot(*(polygon - point).T) <= 2 * tolerance).any())


def _side(polygon: Array, point: Array, tangent: Array, tolerance: float) -> Array:
    """Ends of the polygon's side through a point, along a tangent and measured from the point, ``(2,)`` [m]."""
    away = (polygon - point) @ np.array([tangent[1], -tangent[0]])
    on_side = np.abs(away) <= 2 * tolerance
    along = (polygon[on_side] - point) @ tangent
    return np.array([along.min(), along.max()])
