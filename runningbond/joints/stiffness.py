"""Elastic stiffness of a joint, given directly or from its mortar, and whether it is one that models can use."""

import numpy as np

from runningbond.scene import Indices, JointMaterial, Mortar, Scene, SceneError, Stiffness, table_of

GIVES = 2.0
"""Least motion that counts as a collapse, in what the springs of all joints give under that load.

Put on at once, it moves a wall so far that has not begun to fall.
"""

SOFT = 0.02
"""Overlap of two blocks, in displacements that count as collapse, above which joints are too soft.

The overlap at a wall's base is that of one joint; its top settles by half as many of them as there are courses. At
this share of a collapse of 0.05 block sizes, 1 ‰ of a block, a hundred courses settle by as much as a fall.
"""

STIFF = 1e-5
"""Force that rounding in displacements as large as a collapse may amount to, in units of force: that of rest."""

EPSILON = float(np.finfo(np.float64).eps)


def joint_stiffness(material: JointMaterial) -> Stiffness:
    """Normal and tangential stiffness per unit area [Pa/m].

    A thin layer of mortar between stiff blocks, plane stress, confined along the joint:
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
    """Largest normal stiffness per unit area [Pa/m], that of a joint that has closed."""
    return joint_stiffness(material).normal if material.closure is None else material.closure.stiffest


def block_compliance(scene: Scene) -> float:
    """Share of the blocks in the compliance of columns of blocks and joints: of one material each, k_n h / (k_n h + E).

    Of several it is Σ l h / E over Σ l (h / E + 1 / k_n), of bed joints of length l and the blocks of height h on them;
    of all joints where none is one. Blocks without a modulus are rigid; zero where joints have no stiffness.
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


def _beds(scene: Scene) -> Indices:
    """Bed joints under blocks, or all joints where there is none; those inside blocks and under a beam aside."""
    joints = scene.joints
    between = ~joints.inner & ~scene.is_beam[_upper(scene)]
    flat = between & joints.is_bed
    return np.flatnonzero(flat if flat.any() else between)


def _upper(scene: Scene) -> Indices:
    """The higher one of the two blocks of each joint."""
    block = scene.joints.block
    a, b = scene.blocks.centroid[block, 1].T
    return np.asarray(np.where(a > b, *block.T))


def stiffness_note(overlap: float, collapse: float, size: float, stiffness: float, force_unit: float) -> str:
    """What an outcome's message is to say of stiffnesses that its numbers suffer from; empty for others.

    Parameters
    ----------
    overlap, collapse, size
        Largest depth of one block in another at rest, displacement that counts as collapse, size of a block [m].
    stiffness, force_unit
        Largest stiffness of a joint point [N/m], and smallest force by which unbalanced ones are measured [N].
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
