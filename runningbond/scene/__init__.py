"""Description of a wall: blocks, joints, materials, supports and loads, and the scene file they are read from."""

from .actions import Action
from .arrays import Array, Indices, Mask, Unsigned, frozen
from .beam import Beam, BeamLoad, Drive
from .blocks import Blocks
from .bond import Bond
from .build import build_scene
from .complement import complement
from .errors import SceneError
from .file import read_description, read_scene, scene_from_dict
from .forces import Arrow, Forces
from .history import History
from .loads import Load
from .mass_loads import Body, Lateral, Tilt
from .materials import BlockMaterial, Closure, JointMaterial, Mortar, Stiffness, table_of
from .point_loads import GivenForces, LineLoad, Moment, PointLoad
from .scene import Scene, check_scene
from .segments import Joints, find_joints
from .settlement import Settlement
from .supports import NO_PINS, Pins, free_motions
from .ties import ANCHOR, NO_TIES, Tie, Ties

__all__ = [
    "ANCHOR",
    "NO_PINS",
    "NO_TIES",
    "Action",
    "Array",
    "Arrow",
    "Beam",
    "BeamLoad",
    "BlockMaterial",
    "Blocks",
    "Body",
    "Bond",
    "Closure",
    "Drive",
    "Forces",
    "GivenForces",
    "History",
    "Indices",
    "JointMaterial",
    "Joints",
    "Lateral",
    "LineLoad",
    "Load",
    "Mask",
    "Moment",
    "Mortar",
    "Pins",
    "PointLoad",
    "Scene",
    "SceneError",
    "Settlement",
    "Stiffness",
    "Tie",
    "Ties",
    "Tilt",
    "Unsigned",
    "build_scene",
    "check_scene",
    "complement",
    "find_joints",
    "free_motions",
    "frozen",
    "read_description",
    "read_scene",
    "scene_from_dict",
    "table_of",
]
