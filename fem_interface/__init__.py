"""Interface finite elements: deformable blocks on scikit-fem operators, reduced to modes block by block.

`fem_interface.model` runs them; it and `fem_interface.system` need compiled kernels, so they are imported by name.
"""

from .modes import ModeCount, Modes, block_modes
from .operators import JointElements, NodalJump, joint_elements, lumped_mass, mass_matrix, nodal_jump, stiffness_matrix
from .templates import Template, templates

__all__ = [
    "JointElements",
    "ModeCount",
    "Modes",
    "NodalJump",
    "Template",
    "block_modes",
    "joint_elements",
    "lumped_mass",
    "mass_matrix",
    "nodal_jump",
    "stiffness_matrix",
    "templates",
]
