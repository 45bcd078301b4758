"""Elastic stiffness of a joint, given directly or from its mortar, and checks whether models can use it."""

import numpy as np

from runningbond.scene import Indices, JointMaterial, Mortar, Scene, SceneError, Stiffness, table_of

from .points import JointPoints

GIVES = 2.0
"""Smallest motion that counts as a collapse, relative to the elastic motion of the wall under the same load.

A load that is applied suddenly moves an elastic wall this far without any collapse.
"""

SOFT = 0.02
"""Overlap of two blocks, relative to the displacement that counts as collapse, above which joints are too soft.

The overlap at a wall's base is that of one joint; the top of the wall settles by half that overlap times the number of
courses. With a collapse displacement of 0.05 block sizes, the limit is 1 ‰ of a block: a hundred courses then settle by
as much as a collapse.
"""

STIFF = 1e-5
"""Rounding force at collapse displacements, per unit of force, above which joints are too stiff; as for rest."""

EPSILON = float(np.finfo(np.float64).eps)


def joint_stiffness(material: JointMaterial) -> Stiffness:
    """Normal and tangential stiffness per unit area [Pa/m].

    For a thin layer of mortar between stiff blocks, in plane stress and confined along the joint:
    k_n = E / (e (1 − ν²)), k_t = E / (2 (1 + ν) e) (Cecchi & Sab 2004).

    Raises
    ------
    SceneError
        If the scene gives neither mortar nor stiffness.

    Examples
    --------
    >>> joint_stiffness(JointMaterial(friction=0.6, elasticity=Mortar(young=1e9, poisson=0.0, thickness=0.01)))
    Stiffness(normal=100000000000.0, shear=50000000000.0)
    """
    elasticity = material.elasticity
    if isinstance(elasticity, Stiffness):
        return elasticity
    if isinstance(elasticity, Mortar):
        young, poisson, thickness = elasticity.young, elasticity.poisson, elasticity.thickness
        return Stiffness(young / (thickness * (1 - poisson**2)), young / (2 * (1 + poisson) * thickness))
    table = table_of(material)
    other = f"{table}.normal_stiffness and {table}.shear_stiffness"
    raise SceneError(f"{table}.mortar", f"is missing; this model needs it, or {other}")


def stiffest(material: JointMaterial) -> float:
    """Largest normal stiffness per unit area [Pa/m], that of a fully closed joint."""
    return joint_stiffness(material).normal if material.closure is None else material.closure.stiffest


def block_compliance(scene: Scene) -> float:
    """Share of the blocks in the compliance of columns of blocks and joints; k_n h / (k_n h + E) for one material each.

    For several materials it is Σ l h / E over Σ l (h / E + 1 / k_n), summed over bed joints of length l with blocks of
    height h on them, or over all joints if there are no bed joints. Blocks without a modulus are rigid; the share is
    zero if joints have no stiffness.
    """
    beds = _beds(scene)
    numbers = np.unique(scene.material_of_joint[beds])
    materials = [scene.joint_materials[k] for k in numbers]
    if not materials or any(each.elasticity is None for each in materials):
        return 0.0
    normal = np.full(len(scene.joint_materials), np.inf)
    normal[numbers] = [joint_stiffness(each).normal for each in materials]
    young = np.array([np.inf if each.young is None else each.young for each in scene.block_materials])
    low, high = scene.blocks.boxes
    block, length = _upper(scene)[beds], scene.joints.length[beds]
    softer = float(length @ ((high - low)[block, 1] / young[scene.material_of_block[block]]))
    return softer / (softer + float(length @ (1 / normal[scene.material_of_joint[beds]])))


def rocking_softness(points: JointPoints) -> float:
    """Largest ratio, over all joints, of the rotation of a joint that bears on an end to that of a closed joint.

    A joint whose force N has moved to an end bears on the point there alone, and the next one, at a distance d, is
    about to close: it has turned by N / (k_n A w d). Closed, it would turn by N e / (k_n A Σ w x²) under the same
    moment. Areas are A w, and x and e are distances from their centroid, of the points and of the end. The ratio is 1
    for two points, and 240 for nine points of a Lobatto rule.
    """
    along = (points.position * points.tangent).sum(axis=1)
    order = np.lexsort((along, points.joint))
    first = np.flatnonzero(np.diff(points.joint[order], prepend=-1))
    count = np.diff(first, append=len(order))
    weight, along = points.area[order], along[order]
    total = np.add.reduceat(weight, first)
    weight /= np.repeat(total, count)
    along -= np.repeat(np.add.reduceat(weight * along, first), count)
    inertia = np.add.reduceat(weight * along**2, first)
    softness = [1.0]
    for end, beside in ((first, first + 1), (first + count - 1, first + count - 2)):
        end, beside, own = end[count > 1], beside[count > 1], inertia[count > 1]
        softness += (own / np.abs(along[end] * weight[end] * (along[end] - along[beside]))).tolist()
    return max(softness)


def _beds(scene: Scene) -> Indices:
    """Bed joints under blocks, or all joints if there are none; not in blocks, under a beam, or at single corners."""
    joints = scene.joints
    between = ~joints.inner & ~joints.at_corner & ~scene.is_beam[_upper(scene)]
    flat = between & joints.is_bed
    return np.flatnonzero(flat if flat.any() else between)


def _upper(scene: Scene) -> Indices:
    """Upper one of the two blocks of each joint."""
    block = scene.joints.block
    a, b = scene.blocks.centroid[block, 1].T
    return np.asarray(np.where(a > b, *block.T))


def stiffness_note(overlap: float, collapse: float, size: float, stiffness: float, force_unit: float) -> str:
    """Note for an outcome's message on stiffnesses that impair its accuracy; empty for others.

    Parameters
    ----------
    overlap, collapse, size
        Largest overlap of two blocks at rest, displacement that counts as collapse, size of a block [m].
    stiffness, force_unit
        Largest stiffness of a joint point [N/m], and smallest unit by which unbalanced forces are divided [N].
    """
    if overlap > SOFT * collapse:
        return (
            f"joints are too soft: blocks overlap by {float(f'{100 * overlap / size:.2g}'):g} % of their size, "
            f"which is beyond small displacements above {100 * SOFT * collapse / size:.2g} %"
        )
    rounding = EPSILON * collapse * stiffness / force_unit
    if rounding > STIFF:
        return (
            f"joints are too stiff: in displacements of a collapse rounding makes forces of {rounding:.1e} "
            f"of the smallest block's load, and rest is known to {STIFF:.0e}"
        )
    return ""
