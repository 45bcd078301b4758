"""Elastic moduli of running bond with rigid blocks and elastic joints (Cecchi & Sab 2004)."""

from dataclasses import dataclass

import numpy as np

from runningbond.joints import joint_stiffness
from runningbond.scene import Mask, Scene, SceneError, Stiffness, check_scene
from runningbond.scene.ranges import ABOVE_ZERO, AT_LEAST_ZERO

from .bond import between_blocks, is_running_bond


@dataclass(frozen=True)
class Moduli:
    """In-plane moduli per unit thickness [Pa]: σ11 = a1111 E11, σ22 = a2222 E22, σ12 = 2 a1212 E12.

    The two normal strains are not coupled (a1122 = 0), because the blocks are rigid.
    """

    a1111: float
    a2222: float
    a1212: float


def elastic_moduli(
    block_width: float,
    block_height: float,
    *,
    bed_normal: float,
    bed_shear: float,
    head_normal: float,
    head_shear: float,
) -> Moduli:
    """Moduli of the infinite wall from blocks b × a [m] and stiffnesses per unit area [Pa/m] of bed and head joints.

    Stiffnesses may be zero, e.g. for open head joints.

    Raises
    ------
    SceneError
        For numbers that are not valid sizes or stiffnesses.

    Examples
    --------
    >>> elastic_moduli(240, 60, bed_normal=80, bed_shear=30, head_normal=50, head_shear=20).a1111
    19200.0
    """
    b, a = ABOVE_ZERO.take("block_width", block_width), ABOVE_ZERO.take("block_height", block_height)
    bed_normal, bed_shear = AT_LEAST_ZERO.take("bed_normal", bed_normal), AT_LEAST_ZERO.take("bed_shear", bed_shear)
    head_normal = AT_LEAST_ZERO.take("head_normal", head_normal)
    head_shear = AT_LEAST_ZERO.take("head_shear", head_shear)
    # Under shear strain, block rotation (against head shear and bed normal stiffness) acts in series with bed sliding.
    tilting = b * head_shear + bed_normal * b**2 / (4 * a)
    sliding = a * bed_shear
    in_series = tilting * sliding / (tilting + sliding) if sliding else 0.0
    return Moduli(b * head_normal + bed_shear * b**2 / (4 * a), a * bed_normal, in_series)


def rigid_moduli(scene: Scene) -> Moduli:
    """Closed-form moduli [Pa] of a wall's running bond of rigid blocks.

    Joints with the ground or the beam are excluded. Openings, toothed ends and an inset have no influence.

    Raises
    ------
    SceneError
        For walls that are not in running bond, whose blocks differ in thickness, whose beds or heads have several
        materials or no stiffness, or whose blocks may crack.
    """
    check_scene(scene)
    bond = scene.bond
    if bond is None or not is_running_bond(scene, bond):
        raise SceneError("wall", "has no moduli in closed form: they need running bond of blocks of one size")
    if scene.inner_joint is not None:
        raise SceneError("inner_joint", "leaves no moduli in closed form: they need rigid blocks that do not crack")
    thickness = np.unique(scene.thickness_of_blocks[scene.masonry])
    if len(thickness) > 1:
        told = ", ".join(f"{each:g}" for each in thickness)
        raise SceneError("thickness of blocks", "must be one; the closed form has one for all of them", told)
    between, beds = between_blocks(scene), scene.joints.is_bed
    bed, head = (_stiffness(scene, between & chosen, what) for chosen, what in ((beds, "bed"), (~beds, "head")))
    springs = {"bed_normal": bed.normal, "bed_shear": bed.shear, "head_normal": head.normal, "head_shear": head.shear}
    return elastic_moduli(bond.width, bond.height, **springs)


def _stiffness(scene: Scene, chosen: Mask, what: str) -> Stiffness:
    """Stiffness of the chosen joints, which must share one material."""
    kinds = [scene.joint_materials[k] for k in np.unique(scene.material_of_joint[chosen])]
    if len(kinds) != 1:
        names = ", ".join(each.name for each in kinds)
        raise SceneError(f"{what} joints", "must be of one material; the closed form has one for each", names)
    return joint_stiffness(kinds[0])
