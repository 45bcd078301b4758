"""Finite-element meshes of walls: triangulated blocks, and joints as zero-thickness elements between split nodes."""

from .files import check_suffix, write_mesh
from .mesh import GROUPS, WallMesh, joint_group, not_meshed, wall_mesh

__all__ = ["GROUPS", "WallMesh", "check_suffix", "joint_group", "not_meshed", "wall_mesh", "write_mesh"]
