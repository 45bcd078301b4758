"""Numbers and material parameters of elements, as mesh files list them for other programs."""

import numpy as np

from runningbond.joints import joint_stiffness
from runningbond.scene import Array, Indices, JointMaterial, Scene

from .mesh import WallMesh

NO_NUMBER = -1
"""Value for the block of a joint element and for the joint of a triangle, which do not exist."""

NOTHING = 0.0
"""Value of a parameter that an element does not have, or that the scene does not give."""


def element_data(mesh: WallMesh, scene: Scene) -> dict[str, tuple[Array | Indices, Array | Indices]]:
    """Data of triangles ``(nt,)`` and of joint elements ``(ne,)`` by name.

    ``block`` and ``joint`` are numbers in the scene, `NO_NUMBER` elsewhere. Of triangles ``thickness`` [m], ``density``
    [kg/m³], ``young`` [Pa] and ``poisson``, of joint elements ``thickness``, ``friction``, ``cohesion`` and
    ``tensile_strength`` [Pa], ``normal_stiffness`` and ``shear_stiffness`` [Pa/m]; `NOTHING` elsewhere. The ground has
    no density, and only the wall's own blocks have elastic parameters, not its beam.
    """
    block, joint = mesh.triangle_block, mesh.joint
    data: dict[str, tuple[Array | Indices, Array | Indices]] = {
        "block": (block, np.full(len(joint), NO_NUMBER)),
        "joint": (np.full(len(block), NO_NUMBER), joint),
        "thickness": (scene.thickness_of_blocks[block], scene.thickness_of_joints[joint]),
    }
    for name, values in _of_blocks(scene).items():
        data[name] = values[block], np.full(len(joint), NOTHING)
    for name, values in _of_joints(scene).items():
        data[name] = np.full(len(block), NOTHING), values[joint]
    return data


def _of_blocks(scene: Scene) -> dict[str, Array]:
    """Parameters of each block, ``(nb,)``."""
    materials = scene.block_materials
    elastic = np.array([(each.young or NOTHING, each.poisson if each.young else NOTHING) for each in materials])
    young, poisson = np.where(scene.masonry[:, None], elastic[scene.material_of_block], NOTHING).T
    return {"density": np.where(scene.wall, scene.density, NOTHING), "young": young, "poisson": poisson}


def _of_joints(scene: Scene) -> dict[str, Array]:
    """Parameters of each joint, ``(nj,)``."""
    names = "friction", "cohesion", "tensile_strength", "normal_stiffness", "shear_stiffness"
    of_materials = np.array([_joint_parameters(each) for each in scene.joint_materials])
    return dict(zip(names, of_materials[scene.material_of_joint].T, strict=True))


def _joint_parameters(material: JointMaterial) -> tuple[float, ...]:
    stiffness = (NOTHING, NOTHING)
    if material.elasticity is not None:
        elastic = joint_stiffness(material)
        stiffness = elastic.normal, elastic.shear
    return (material.friction, material.cohesion, material.tension, *stiffness)
