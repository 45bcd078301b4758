"""Contents of a scene as rows of a table: counts, weights, supports, ties, and loads with their resultants."""

from collections.abc import Iterator

import numpy as np

from runningbond.joints import wall_points, wall_rule
from runningbond.pictures.legend import (
    CONDITIONS,
    strength,
    strength_at_corners,
    thickness_text,
    used_block_materials,
    used_joint_materials,
)
from runningbond.pictures.quantities import beginning, counted, millimetres, minus, pair, readable, signed
from runningbond.scene import (
    ANCHOR,
    Action,
    Array,
    BeamLoad,
    Forces,
    History,
    LineLoad,
    Moment,
    Scene,
    Settlement,
    Tilt,
)
from runningbond.scene.loads import KINDS

Row = tuple[str, str]


def rows(scene: Scene) -> list[Row]:
    """Rows for all quantities of a scene, with their units."""
    assigned = ((key, text) for key, _, text in (line.partition(": ") for line in scene.assigned))
    return [*_blocks(scene), *_joints(scene), *_held(scene), *_loads(scene), *assigned]


def _blocks(scene: Scene) -> Iterator[Row]:
    low, high = scene.blocks.extent(scene.wall)
    count, pieces = scene.count_blocks(), int(scene.masonry.sum())
    parts = "" if pieces == count else f" in {pieces} parts"
    yield "blocks", f"{count}{parts}, of which {scene.count_blocks(scene.fixed)} held"
    for k in used_block_materials(scene):
        own, material = (scene.material_of_block == k) & scene.masonry, scene.block_materials[k]
        mass = float(scene.mass[own].sum())
        blocks = counted(scene.count_blocks(own), "block")
        thick = f" and {material.thickness:.4g} m" if material.thickness else ""
        yield f"  of {material.name}", f"{blocks} of {material.density:g} kg/m³{thick}, {_mass(scene, mass)}"
    ends = [[signed(scene.blocks.coordinate(float(value))) for value in corner] for corner in (low, high)]
    x, y = (" … ".join(both) for both in zip(*ends, strict=True))
    yield "extent", f"x {x} m, y {y} m, {thickness_text(scene)}"
    yield "mass of the wall", f"{float(scene.mass[scene.wall].sum()):.5g} kg"
    gravity = float(np.hypot(*scene.load.gravity))
    yield "weight of movable blocks", readable(gravity * float(scene.mass[~scene.fixed].sum()), "N")


def _mass(scene: Scene, mass: float) -> str:
    return f"{mass:.5g} kg, {readable(mass * float(np.hypot(*scene.load.gravity)), 'N')}"


def _joints(scene: Scene) -> Iterator[Row]:
    joints, bed = scene.joints, scene.joints.is_bed
    cracks, corners = int(joints.inner.sum()), int(joints.at_corner.sum())
    length = joints.between_sides.length
    lengths = f", {length.min():.4g} … {length.max():.4g} m long" if len(length) else ""
    inner = f", and {counted(cracks, 'potential crack')}" if cracks else ""
    yield "joints", f"{len(length) - cracks}{inner}{lengths}"
    for k in used_joint_materials(scene):
        own, material = (scene.material_of_joint == k) & ~joints.at_corner, scene.joint_materials[k]
        inset = f", contacts {material.inset:g} m from the ends" if material.inset else ""
        lie = f"{int((own & bed).sum())} bed, {int((own & ~bed).sum())} head"
        yield f"  of {material.name}", f"{lie}: {strength(material)}{inset}"
    if corners:
        yield "corners", f"{corners} on sides without a joint there: {strength_at_corners(scene)}"
    tolerance = f"{scene.blocks.tolerance:.3g} m count as contact"
    rule = wall_rule(scene)
    yield "contact points", f"{len(wall_points(scene, rule))}, {len(rule.nodes)} to a joint; gaps up to {tolerance}"


def _held(scene: Scene) -> Iterator[Row]:
    """Rows for supports, the beam and ties."""
    ground = int((~scene.wall).sum())
    held = [f"ground in {counted(ground, 'piece')}" if ground > 1 else "ground"] if ground else []
    fixed = scene.count_blocks(scene.fixed)
    held += [counted(fixed, "fixed block")] if fixed else []
    pins = scene.pins.direction.any(axis=1)
    for block in np.unique(scene.pins.block[pins]):
        own = (scene.pins.block == block) & pins
        at = signed(scene.blocks.place(scene.pins.point[own][0]))
        held.append(f"{'roller' if own.sum() == 1 else 'pin'} at {at} m")
    yield "supports", ", ".join(held) or "none"
    if scene.beam is not None:
        beam, on = scene.beam, f"on joints of {scene.beam.joint or scene.joint.name}"
        yield "beam", f"{beam.height:.4g} m high, {_mass(scene, beam.mass)}, {CONDITIONS[beam.condition]}, {on}"
    ties = scene.ties
    for k in range(len(ties)):
        ends = " to ".join(
            f"{signed(scene.blocks.place(end))} m, {_body(scene, int(block))},"
            for block, end in zip(ties.block[k], ties.ends[k], strict=True)
        )
        stiffness = readable(float(ties.stiffness[k]), "N/m")
        preload = f", preload {readable(float(ties.preload[k]), 'N')}" if ties.preload[k] else ""
        yield (
            f"tie[{k}]",
            f"from {ends} E A / L = {stiffness}, yields at {readable(float(ties.yield_force[k]), 'N')}{preload}",
        )


def _body(scene: Scene, block: int) -> str:
    """Name of the body at an end of a tie: a block with its number, the beam, the ground, or an anchor."""
    if block == ANCHOR:
        return "an anchor fixed in space"
    number = scene.part_of[block]
    return f"block {number}" if number >= 0 else "the beam" if scene.wall[block] else "the ground"


def _loads(scene: Scene) -> Iterator[Row]:
    """Rows for each load with its resultant, and for the resultant of all live loads."""
    x, y = scene.load.gravity
    yield "gravity", f"({minus(x)}, {minus(y)}) m/s²"
    corner = scene.blocks.extent(scene.wall)[0]
    about = f"about {signed(scene.blocks.place(corner))}"
    for key, load in scene.load.named():
        if isinstance(load, Settlement):
            yield key, _settlement(scene, load)
            continue
        yield key, f"{_kind(scene, load)}: {_resultant(scene, load.forces(scene), corner)} {about}"
    if scene.settlement is None:
        yield "live load at λ = 1", f"{_resultant(scene, scene.live_forces, corner)} {about}"


def _resultant(scene: Scene, forces: Forces, corner: Array) -> str:
    """Resultant force on all blocks that move, and its moment about a point."""
    loose = ~scene.fixed
    on_mass = scene.mass[:, None] * forces.acceleration * loose[:, None]
    own = loose[forces.block]
    force = on_mass.sum(axis=0) + forces.force[own].sum(axis=0)
    moment = forces.moment[loose].sum()
    for arm, push in ((scene.blocks.centroid - corner, on_mass), (forces.at[own] - corner, forces.force[own])):
        moment += (arm[:, 0] * push[:, 1] - arm[:, 1] * push[:, 0]).sum()
    force[np.abs(force) < 1e-9 * np.abs(force).max()] = 0.0
    return f"{pair(force, 'N')}, {readable(float(moment), 'N m')}"


def _kind(scene: Scene, load: Action) -> str:
    """Kind of a load, in words."""
    match load:
        case BeamLoad():
            path = scene.drive_path if load.key == "beam.drive" else ()
            moves = beginning([minus(1e3 * x) for x in path])
            rate = scene.drive.rate if path and scene.drive else None
            speed = f" at {millimetres(rate)}/s" if rate else ""
            return f"moved to {moves} mm{speed}, the force that takes" if path else "on the beam"
        case LineLoad():
            length = float(np.hypot(*np.subtract(load.end, load.start)))
            return f"{readable(float(np.hypot(*load.force)), 'N/m')} along {length:.4g} m"
        case Moment():
            return f"on {_body(scene, int(np.flatnonzero(load.forces(scene).moment)[0]))}"
        case History():
            return f"{load.source}, {load.duration:.4g} s, {load.note(1.0)} at λ = 1; inertia then"
        case Tilt():
            return "tilt of the ground, λ = tan α"
        case _:
            return next((name for name, kind in KINDS.items() if type(load) is kind), type(load).__name__)


def _settlement(scene: Scene, load: Settlement) -> str:
    moving = counted(int(load.moving(scene).sum()), "support")
    parts = [f"moved by ({', '.join(millimetres(x) for x in load.by)})"] if any(load.by) else []
    parts += [f"turned by {minus(load.rotation_angle)}°"] if load.rotation_angle else []
    times = "" if load.path == (1.0,) else f", {beginning([f'{share:g}' for share in load.path])} times that"
    return f"{moving} {' and '.join(parts)}{times}; λ is the share of the reaction"
