"""OpenSeesPy: constant-strain triangles on the suite's own mesh, with frictional node-to-node contact.

Each joint point of the suite is a ``zeroLengthContact2D`` with the same stiffness and friction, and nodes have their
share of the blocks' mass. Statics by load control stop converging at slightly more than half the collapse load.
Therefore the motion is integrated in time: Newmark's method with a little numerical damping, and Newton's method with
the unsymmetric tangent. A wall that begins to fall no longer converges: this counts as collapse, and the message says
so.
"""

import copy
import ctypes
import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
from load_steps import Bracket, by_load_steps
from peer import Peer

from meshing import wall_mesh
from runningbond.joints import joint_stiffness
from runningbond.scene import Array, Scene

STEP = 5e-3
"""Time step [s]."""

GAMMA = 0.6
"""Newmark's γ, with β = (γ + 1/2)² / 4."""

CLOSE, ITERATIONS = 1e-8, 50
"""Convergence tolerance: norm of the displacement increment [m]; and largest number of iterations."""

PEER = Peer(
    name="OpenSeesPy",
    package="openseespy",
    kind="deformable blocks",
    rivals=("fem",),
    does="statics and dynamics with any element and material of a large library; implicit steps of milliseconds",
    does_not="tell a wall in collapse from a step that does not converge; joint elements: contacts go node by node; "
    "keep a state and come back to it",
)


def bracket(scene: Scene, tolerance: float, budget: float) -> Bracket:
    """Bracket the collapse load by load steps."""
    return by_load_steps(OpenSeesWall(library(), scene), scene, tolerance, budget)


def library() -> Any:
    """Import the module, and load the BLAS of its Linux wheel first, which the loader does not find by itself."""
    place = importlib.util.find_spec("openseespylinux")
    if place is not None and place.origin is not None:
        blas = Path(place.origin).parent / "lib" / "libblas.so.3"
        if blas.exists():
            ctypes.CDLL(str(blas), mode=ctypes.RTLD_GLOBAL)
    import openseespy.opensees as ops

    return ops


class OpenSeesWall:
    """A wall in OpenSees, which has only one model at a time and cannot return to an earlier state.

    A copy takes over the model; a copy of a wall without the model builds it again and repeats all loads so far.

    Parameters
    ----------
    ops
        The module.
    scene
        The wall.
    held
        Multipliers and times [s] of the loads so far.
    """

    def __init__(self, ops: Any, scene: Scene, held: tuple[tuple[float, float], ...] = ()) -> None:
        self._ops, self._scene = ops, scene
        self._held: tuple[tuple[float, float], ...] = ()
        self._has_model = True
        self._gravity = float(np.hypot(*scene.load.gravity))
        self._mass = build(ops, scene)
        for multiplier, seconds in held:
            self.hold(multiplier, seconds)

    def hold(self, multiplier: float, seconds: float) -> None:
        """Integrate the motion under a load over some seconds; ArithmeticError if a step does not converge."""
        self._held = (*self._held, (multiplier, seconds))
        self._ops.remove("loadPattern", 1)
        self._ops.pattern("Plain", 1, 1)
        for node, mass in self._mass.items():
            self._ops.load(node, multiplier * self._gravity * mass, -self._gravity * mass)
        if self._ops.analyze(round(seconds / STEP), STEP):
            raise ArithmeticError("no convergence counts as collapse")

    def position(self) -> Array:
        """Displacement of every node of the blocks, ``(n, 2)`` [m]."""
        return np.array([self._ops.nodeDisp(node) for node in self._mass])

    def copy(self) -> "OpenSeesWall":
        """Another wall in the same state, which takes over the model."""
        if not self._has_model:
            return OpenSeesWall(self._ops, self._scene, self._held)
        self._has_model = False
        heir = copy.copy(self)
        heir._has_model = True
        return heir


def build(ops: Any, scene: Scene) -> dict[int, float]:
    """Build a wall in OpenSees; returns the mass [kg] of each node."""
    mesh = wall_mesh(scene)
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 2)
    for node, (x, y) in enumerate(mesh.points.tolist()):
        ops.node(node, x, y)
        if scene.fixed[mesh.block[node]]:
            ops.fix(node, 1, 1)
    ops.nDMaterial("ElasticIsotropic", 1, scene.block.young, scene.block.poisson)
    moving = mesh.triangles[~scene.fixed[mesh.triangle_block]]
    for tag, corners in enumerate(moving.tolist()):
        ops.element("Tri31", tag, *corners, scene.thickness, "PlaneStress", 1)
    (x0, y0), (x1, y1), (x2, y2) = (mesh.points[moving[:, k]].T for k in range(3))
    area = ((x1 - x0) * (y2 - y0) - (y1 - y0) * (x2 - x0)) / 2
    share = scene.block.density * scene.thickness * area / 3
    lumped = np.bincount(moving.ravel(), np.repeat(share, 3), len(mesh.points))
    mass = {int(node): float(lumped[node]) for node in np.flatnonzero(lumped)}
    for node, m in mass.items():
        ops.mass(node, m, m)
    touch(ops, scene, mesh.points, mesh.interfaces.tolist(), len(moving))

    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    ops.constraints("Plain")
    ops.numberer("RCM")
    ops.system("UmfPack")
    ops.test("NormDispIncr", CLOSE, ITERATIONS, 0)
    ops.algorithm("Newton")
    ops.integrator("Newmark", GAMMA, (GAMMA + 0.5) ** 2 / 4)
    ops.analysis("Transient")
    return mass


def touch(ops: Any, scene: Scene, points: Array, interfaces: list[list[int]], first: int) -> None:
    """Add a contact at both ends of every joint element, with element tags from `first` on."""
    stiffness = joint_stiffness(scene.joint)
    tag = first
    for a0, a1, b1, b0 in interfaces:
        along = points[a1] - points[a0]
        length = float(np.hypot(*along))
        half = scene.thickness * length / 2
        law = (half * stiffness.normal, half * stiffness.shear, scene.joint.friction)
        normal = (float(along[1] / length), float(-along[0] / length))  # outwards of a, which is the retained side
        for a, b in ((a0, b0), (a1, b1)):
            ops.element("zeroLengthContact2D", tag, b, a, *law, "-normal", *normal)
            tag += 1
