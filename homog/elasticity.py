"""Elastic moduli of running bond with rigid blocks and elastic joints (Cecchi & Sab 2004)."""

from dataclasses import dataclass

from runningbond.joints import joint_stiffness
from runningbond.scene import Scene


@dataclass(frozen=True)
class Moduli:
    """In-plane moduli per unit thickness [Pa]: σ11 = a1111 E11, σ22 = a2222 E22, σ12 = 2 a1212 E12.

    There is no coupling between the two normal strains (a1122 = 0), because the blocks are rigid.
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

    Examples
    --------
    >>> elastic_moduli(240, 60, bed_normal=80, bed_shear=30, head_normal=50, head_shear=20).a1111
    19200.0
    """
    b, a = block_width, block_height
    # Shear strain tilts the bond against the heads' shear and the beds' normal stiffness, in series with bed shear.
    tilting = b * head_shear + bed_normal * b**2 / (4 * a)
    sliding = a * bed_shear
    return Moduli(
        b * head_normal + bed_shear * b**2 / (4 * a),
        a * bed_normal,
        tilting * sliding / (tilting + sliding),
    )


def rigid_moduli(scene: Scene) -> Moduli:
    """Closed-form moduli [Pa] of a wall's running bond of rigid blocks."""
    assert scene.bond is not None
    joint = joint_stiffness(scene.materials_of_joints[0])
    springs = dict.fromkeys(("bed_normal", "head_normal"), joint.normal)
    springs |= dict.fromkeys(("bed_shear", "head_shear"), joint.shear)
    return elastic_moduli(scene.bond.width, scene.bond.height, **springs)
