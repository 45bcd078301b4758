"""compas_cra: rigid-block equilibrium (RBE), which finds for one load whether admissible forces exist.

As in its examples, ``rotate_assembly`` tilts the ground by arctan λ, and ``rbe_solve`` runs the IPOPT of its wheel.
Since release 0.8 this is the penalty form of Kao et al. (2022): tension is allowed at a million times the cost of
compression, and a solution always exists; a load is carried if the solution has no tension. This depends on a
threshold: below the collapse load tension is 1e-7 to 1e-4 of the largest compression, and it grows steadily through
the collapse load. `TENSION` is this threshold; forces are in weights of the heaviest block.

Interfaces are the scene's joints. The search for interfaces in compas_cra takes 2 s for a wall of 20 blocks, and does
not find the ground under a wide wall.
"""

import contextlib
import io
from collections.abc import Iterator
from math import atan
from typing import Any

import numpy as np
from load_steps import Bracket, bisect
from peer import Peer

from runningbond.scene import Scene

IN_SPACE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
"""Map from the plane of the wall to space, with z upwards."""

TENSION = 1e-4
"""Tension, relative to the largest compression, above which a load is not carried."""

PEER = Peer(
    name="compas_cra RBE",
    package="compas_cra",
    kind="equilibrium",
    rivals=("limit",),
    does="3D assemblies of any blocks, from CAD; CRA besides, which couples forces and motions; penalty forces show "
    "where tension is missing",
    does_not="find λ (each load is a program of its own); bound it from both sides; give a mechanism; friction without "
    "dilatancy; cohesion",
)


def bracket(scene: Scene, tolerance: float, budget: float) -> Bracket:
    """Bisect between zero and tan φ, above which every dry wall slides."""
    assembly = tilting_table(scene)
    angle = 0.0

    def borne(multiplier: float) -> bool:
        nonlocal angle
        assembly.rotate_assembly([0, 0, 0], [0, 1, 0], atan(multiplier) - angle, is_rad=True)
        angle = atan(multiplier)
        return without_tension(assembly, scene)

    return bisect(borne, scene.joint.friction, tolerance, budget)


def tilting_table(scene: Scene) -> Any:
    """The wall as an assembly in three dimensions, with the ground as its support."""
    from compas.geometry import Box, Frame
    from compas_assembly.datastructures import Block
    from compas_cra.datastructures import CRA_Assembly

    assembly = CRA_Assembly()
    for block in range(len(scene.blocks)):
        low, high = scene.blocks.extent(block)
        (x, z), (width, height) = (low + high) / 2, high - low
        box = Box(width, scene.thickness, height, frame=Frame([x, 0, z], [1, 0, 0], [0, 1, 0]))
        assembly.add_block(Block.from_shape(box), node=block)
    assembly.set_boundary_conditions([int(block) for block in np.flatnonzero(scene.fixed)])
    across = np.array([-0.5, 0.5, 0.5, -0.5])[:, None] * [[0.0, scene.thickness, 0.0]]
    for (a, b), ends in zip(scene.joints.block, scene.joints.ends, strict=True):
        corners = ends[[0, 0, 1, 1]] @ IN_SPACE + across
        along = (ends[1] - ends[0]) @ IN_SPACE
        area = scene.thickness * float(np.linalg.norm(along))
        frame = Frame(list(corners.mean(axis=0)), list(along), [0, -1, 0])  # its third axis points from a to b
        assembly.add_to_interfaces(int(a), int(b), size=area, points=corners.tolist(), frame=frame)
    return assembly


def without_tension(assembly: Any, scene: Scene) -> bool:
    """Whether the forces that RBE finds for an assembly have no tension at any point."""
    from compas_cra.equilibrium import rbe_solve

    density = 1 / float((scene.blocks.area * scene.thickness)[~scene.fixed].max())
    with contextlib.redirect_stdout(io.StringIO()):  # rbe_solve prints the shape of every matrix, and a line per block
        rbe_solve(assembly, mu=scene.joint.friction, density=density)
    forces = [force for interface in interfaces(assembly) for force in interface.forces]
    tension, compression = (max(float(force[part]) for force in forces) for part in ("c_nn", "c_np"))
    return tension <= TENSION * compression


def interfaces(assembly: Any) -> Iterator[Any]:
    """Every interface of an assembly."""
    for edge in assembly.graph.edges():
        yield from assembly.graph.edge_attribute(edge, "interfaces")
