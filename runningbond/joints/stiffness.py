"""Elastic stiffness of a joint, given directly or from its mortar."""

from runningbond.scene import JointMaterial, Mortar, SceneError, Stiffness


def joint_stiffness(material: JointMaterial) -> Stiffness:
    """Normal and tangential stiffness per unit area [Pa/m].

    A thin layer of mortar between stiff blocks, plane stress, confined along the joint:
    k_n = E / (e (1 − ν²)), k_t = E / (2 (1 + ν) e) (Cecchi & Sab 2004).

    Raises
    ------
    SceneError
        If the scene gives neither mortar nor stiffness.
    """
    elasticity = material.elasticity
    if isinstance(elasticity, Stiffness):
        return elasticity
    if isinstance(elasticity, Mortar):
        young, poisson, thickness = elasticity.young, elasticity.poisson, elasticity.thickness
        return Stiffness(young / (thickness * (1 - poisson**2)), young / (2 * (1 + poisson) * thickness))
    raise SceneError(
        "joint.mortar", "is missing; this model needs it, or joint.normal_stiffness and joint.shear_stiffness"
    )
