"""Build a scene: blocks are joined into a wall on its support."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from .arrays import Array, Indices, Mask
from .assignment import BEAM, GROUND, Assignment, assign_blocks, assign_joints
from .beam import Beam
from .blocks import Blocks
from .bond import Bond
from .checks import check_built
from .corner_contacts import with_corners
from .cracks import cut_in_half
from .errors import SceneError
from .ground import strip_below, strip_reach
from .loads import Load
from .materials import BlockMaterial, JointMaterial, table_of
from .ranges import one_of
from .scene import Scene
from .segments import Joints, find_joints
from .settlement import Settlement, cut_ground
from .supports import NO_PINS, SUPPORT_KINDS, Pins, SupportKind, corner_pins, first_course
from .ties import Tie, place_ties

Material = TypeVar("Material", BlockMaterial, JointMaterial)


def build_scene(
    title: str,
    polygons: Sequence[Array],
    *,
    thickness: float,
    block: BlockMaterial,
    joint: JointMaterial,
    load: Load,
    support: SupportKind = "base",
    grounds: Sequence[Array] = (),
    bond: Bond | None = None,
    inner_joint: JointMaterial | None = None,
    whole_up_to: float = 0.0,
    materials: Sequence[BlockMaterial] = (),
    joints: Sequence[JointMaterial] = (),
    assignments: Sequence[Assignment] = (),
    layers: Sequence[str] = (),
    material_of: Mapping[int, str] | None = None,
    beam: Beam | None = None,
    ties: Sequence[Tie] = (),
    notes: Sequence[str] = (),
) -> Scene:
    """Join blocks into a wall on its support, and check that the scene can be analysed.

    Parameters
    ----------
    polygons : list of (n, 2) float
        Blocks of the wall [m], counter-clockwise.
    grounds : list of (n, 2) float
        Outlines of the ground; if empty, a flat strip is added under the lowest course if the support needs one.
    inner_joint
        Material of a potential crack on the vertical axis of every block.
    whole_up_to
        Width [m] up to which blocks have no potential crack.
    materials, joints
        Further materials of blocks and joints.
    assignments
        Materials assigned to blocks and joints; later entries win.
    layers
        Layer of each block of a drawing.
    material_of
        Names of the materials of individual blocks, before any assignment.
    beam, ties
        A stiff body across the top, and bars.
    notes
        Remarks on how the wall was read.

    Raises
    ------
    SceneError
        For blocks that overlap or are not connected to the support, for an inset that leaves no joint, for a load that
        acts on nothing movable, for an assignment that selects nothing, for a tie that holds nothing.
    """
    one_of("support.kind", support, SUPPORT_KINDS)
    if grounds and support in ("corners", "pinned-corners"):
        raise SceneError("support.kind", 'the wall brings its ground; use "base" or "fixed-first-course"', support)
    if inner_joint and joint.elasticity and not inner_joint.elasticity:
        raise SceneError("inner_joint.mortar", "is missing; joint has a stiffness, and models that need it need both")
    whole = Blocks.from_polygons(polygons)
    whole.check()
    block_materials = (block, *materials)
    names = [each.name for each in block_materials]
    material, assigned = assign_blocks(whole, names, layers, material_of or {}, assignments)
    owner = np.arange(len(polygons))
    if inner_joint is not None:
        polygons, owner = cut_in_half(polygons, whole_up_to)
    blocks, beam, number_of_grounds = _bodies(polygons, grounds, beam, support, load)
    others = len(blocks) - len(polygons)
    wall = np.arange(len(blocks)) < len(blocks) - number_of_grounds
    fixed, pins = _support(support, blocks, wall)
    if beam is not None:
        pins = pins + beam.pins(blocks.centroid[len(polygons)])
        live, dead = beam.loads()
        load = Load(load.gravity, (*live, *load.live), (*load.dead, *dead))
    part_of, material = np.append(owner, np.full(others, -1)), np.append(material[owner], np.zeros(others, np.int64))
    found = _joints(blocks, fixed, whole, part_of)
    joint_materials = (joint, *joints, *(() if inner_joint is None else (replace(inner_joint, name="inner_joint"),)))
    material_of_joint, of_joints = assign_joints(
        found,
        [each.name for each in joint_materials],
        [*(names[k] for k in material[: len(polygons)]), *[BEAM] * (beam is not None), *[GROUND] * number_of_grounds],
        [layers[int(k)] for k in owner] if layers else (),
        assignments,
        blocks.tolerance,
        None if beam is None else (len(polygons), beam.joint or joint.name),
    )
    block_materials, material, no_blocks = _in_use(block_materials, material)
    joint_materials, material_of_joint, no_joints = _in_use(joint_materials, material_of_joint)
    joint_materials, material_of_joint, _ = _in_use(*_without_strength(joint_materials, material_of_joint, found))
    scene = Scene(
        title,
        blocks,
        fixed,
        wall,
        pins,
        found,
        thickness,
        block_materials,
        material,
        joint_materials,
        material_of_joint,
        load,
        bond,
        place_ties(ties, blocks, fixed),
        beam,
        (*notes, *no_blocks, *no_joints),
        part_of,
        tuple(text for _, text in sorted((assigned | of_joints).items())),
    )
    check_built(scene)
    return scene


def _in_use(materials: Sequence[Material], of: Indices) -> tuple[tuple[Material, ...], Indices, list[str]]:
    """Materials in use or of tables like ``[block]``, `of` renumbered to match, and notes on materials left out."""
    kept = [k for k, each in enumerate(materials) if table_of(each) == each.name or (of == k).any()]
    unused = [each for k, each in enumerate(materials) if k not in kept]
    notes = [f"{table_of(each)}: is assigned to nothing; it is left out" for each in unused]
    return tuple(materials[k] for k in kept), np.searchsorted(kept, of), notes


def _bodies(
    polygons: Sequence[Array], grounds: Sequence[Array], beam: Beam | None, support: SupportKind, load: Load
) -> tuple[Blocks, Beam | None, int]:
    """All bodies (blocks of the wall, the beam, grounds), the beam with its block number, and the number of grounds."""
    blocks = Blocks.from_polygons(polygons)
    reach = strip_reach(support, load)
    if not grounds and reach is not None:
        grounds = [strip_below(blocks, reach)]
    settlements = [live for live in load.live if isinstance(live, Settlement)]
    grounds = cut_ground(grounds, settlements, blocks.tolerance)
    bodies = [*polygons]
    if beam is not None:
        beam = replace(beam, block=len(bodies))
        bodies.append(beam.outline(blocks))
    blocks = Blocks.from_polygons([*bodies, *grounds])
    blocks.check()
    return blocks, beam, len(grounds)


def _support(kind: SupportKind, blocks: Blocks, wall: Mask) -> tuple[Mask, Pins]:
    """Mask of fixed bodies, ``(nb,)``, and the pins of the others."""
    if kind == "fixed-first-course":
        return ~wall | first_course(blocks, wall), NO_PINS
    if kind in ("corners", "pinned-corners"):
        return ~wall, corner_pins(blocks, wall, roller=kind == "corners")
    return ~wall, NO_PINS


def _joints(blocks: Blocks, fixed: Mask, whole: Blocks, part_of: Indices) -> Joints:
    """Joints with a movable side, then those between parts of one block, then contacts of single corners."""
    joints = find_joints(blocks)
    movable = ~fixed[joints.block].all(axis=1)
    a, b = part_of[joints.block].T
    inner = (a == b) & (a >= 0) & movable
    order = np.concatenate([np.flatnonzero(movable & ~inner), np.flatnonzero(inner)])
    joints = Joints(joints.block[order], joints.ends[order], inner[order])
    return with_corners(joints, blocks, fixed, whole, part_of)


def _without_strength(
    materials: tuple[JointMaterial, ...], of: Indices, joints: Joints
) -> tuple[tuple[JointMaterial, ...], Indices]:
    """Materials and the material of each joint ``(nj,)``: contacts of corners neither stick nor crush."""
    for k in np.unique(of[joints.at_corner]).tolist():
        material = materials[k]
        if material.is_bonded or material.compressive_strength is not None:
            of = np.where(joints.at_corner & (of == k), len(materials), of)
            materials = (*materials, material.broken().never_crushing())
    return materials, of
