"""What is modelled: blocks, joints, materials, supports and loads, and the file they are read from."""

from .arrays import Array, Indices, Mask, frozen
from .blocks import Blocks
from .bond import Bond, course_pattern, running_bond
from .errors import SceneError
from .file import read_description, read_scene, scene_from_dict
from .forces import Arrow, Forces
from .loads import Action, Body, GivenForces, Lateral, Load, PointLoad
from .materials import BlockMaterial, JointMaterial, Mortar, Stiffness
from .segments import Joints, find_joints
from .supports import NO_PINS, Pins, free_motions
from .wall import Scene, build_scene

__all__ = [
    "NO_PINS",
    "Action",
    "Array",
    "Arrow",
    "BlockMaterial",
    "Blocks",
    "Body",
    "Bond",
    "Forces",
    "GivenForces",
    "Indices",
    "JointMaterial",
    "Joints",
    "Lateral",
    "Load",
    "Mask",
    "Mortar",
    "Pins",
    "PointLoad",
    "Scene",
    "SceneError",
    "Stiffness",
    "build_scene",
    "course_pattern",
    "find_joints",
    "free_motions",
    "frozen",
    "read_description",
    "read_scene",
    "running_bond",
    "scene_from_dict",
]
