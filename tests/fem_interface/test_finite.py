"""Deformable blocks at finite displacements: against rigid blocks, small displacements and exact solutions."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import dem.finite_system
from dem.dynamic import dem_dynamic
from fem_interface.deformable_sides import reframe_deformable
from fem_interface.finite_system import DeformableContacts, finite_system
from fem_interface.modal_wall import modal_wall
from fem_interface.model import fem
from fem_interface.modes import ModeCount
from fem_interface.node_outline import NodeOutline, node_outline
from fem_interface.system import system_of
from fem_interface.templates import nodes_of, triangles_of
from runningbond.compare import published_scene
from runningbond.dynamics import BlockSystem, Criteria, Run, State, settle
from runningbond.dynamics.contact_update import contacts_of
from runningbond.dynamics.run import LOCAL, VISCOUS
from runningbond.joints.law import OPENING_BEFORE
from runningbond.joints.softening import DAMAGE
from runningbond.scene import (
    Array,
    BlockMaterial,
    JointMaterial,
    Load,
    Mortar,
    PointLoad,
    Scene,
    SceneError,
    Stiffness,
    build_scene,
)
from tests.at_length import at_length
from tests.contacts.test_finite_displacement import check_energy_of_a_fall, check_sliding
from tests.dynamics.test_dynamics import GRAVITY
from tests.limit.test_limit import pile, rectangle
from tests.walls import panel

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}


def wall(young: float = 1e10, **changes: Any) -> Scene:
    """A small wall of deformable blocks on a fixed course, whose joints are one element long each."""
    size = {"wall__length": 0.48, "wall__height": 0.24, "support__kind": "fixed-first-course"}
    return panel(**{**size, "joint__mortar": MORTAR, "block__young": young, "block__poisson": 0.2, **changes})


def dry(blocks: list[Array], friction: float, stiffness: float, inset: float, young: float = 1e10) -> Scene:
    """Blocks of 2000 kg/m³ on flat ground, 0.1 m thick."""
    scene = pile(blocks, friction)
    elasticity = Stiffness(stiffness, stiffness)
    return scene.with_block(young=young, poisson=0.2).with_joint(elasticity=elasticity, inset=inset)


def weight(scene: Scene, block: int) -> float:
    return float(scene.mass[block] * GRAVITY)


def place(run: Run, state: State, block: int) -> Array:
    """Translations and rotation of a block."""
    return np.asarray(state.motion[run.system.rigid[block]])


def pressure(run: Run, state: State, upper: int, lower: int) -> float:
    """Compression [N] between two blocks."""
    search = run.system.contacts
    assert search is not None
    owner = search.outline.blocks.owner[contacts_of(state).ends[:, 4:].astype(np.int64)]
    between = (np.sort(owner, axis=1) == sorted((upper, lower))).all(axis=1)
    return float(-run.forces(state)[0][between].sum())


def weightless(system: BlockSystem) -> BlockSystem:
    return replace(system, dead=np.zeros_like(system.dead), live=np.zeros_like(system.live))


def turned(blocks: NodeOutline, seed: int, turn: float = 0.1, apart: float = 2e-3, deformed: float = 1e-4) -> Array:
    """Motion that rotates and moves every block slightly and strains it by about 1e-3."""
    rng = np.random.default_rng(seed)
    motion = rng.normal(size=len(blocks.wall.mass)) * deformed
    moving = ~blocks.scene.fixed
    motion[blocks.wall.rigid[moving]] = rng.normal(size=(moving.sum(), 3)) * [apart, apart, turn]
    motion[-1] = 0.0
    return motion


def bounded(system: BlockSystem, bound: float) -> BlockSystem:
    """The same blocks with another bound on their frequency."""
    return replace(system, interface=replace(system.interface, frequency_squared=bound))


def jumps_on(system: BlockSystem, geometry: Any, motion: Array, n: int) -> Array:
    found = np.zeros((2, n))
    system.interface.gather(motion, tuple(geometry), *found)
    return found


# --- contacts ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("inset", [0.0, 0.005])
def test_three_modes_move_as_rigid_blocks(monkeypatch: pytest.MonkeyPatch, inset: float) -> None:
    """Motion of a wall that is shaken apart, to 1e-9, over 300 steps and several contact detections.

    Blocks start apart: at coincident corners rounding would decide which one rests on the other's side. Histories are
    transformed for all points, as for rigid blocks, and as in `fem` under ground motion.
    """
    monkeypatch.setattr("fem_interface.finite_system.reframe_open", reframe_deformable)
    scene = wall(joint__inset=inset)
    blocks = node_outline(scene, 1, 3)
    ours, rigid = finite_system(blocks), dem.finite_system.finite_system(scene)
    bound = 4 * max(ours.interface.frequency_squared, rigid.interface.frequency_squared)
    run = Run(bounded(ours, bound))
    other = Run(bounded(rigid, bound))
    motion = turned(blocks, 1, turn=2e-3, apart=2e-4)
    state, reference = State.at_rest(run.system, motion), State.at_rest(other.system, blocks.rigid(motion))
    found = {id(state.contacts): state.contacts}
    for _ in range(15):
        run.hold(state, 0.9, 20)
        other.hold(reference, 0.9, 20)
        assert run.dt == other.dt
        way = reference.motion - blocks.rigid(motion)
        assert blocks.rigid(state.motion - motion) == pytest.approx(way, abs=1e-9 * np.abs(way).max())
        found[id(state.contacts)] = state.contacts
    assert len(found) > 2
    assert np.abs(way).max() > 1e-3


@pytest.mark.parametrize("cells", at_length(1, 2, 3))
def test_cracking_lintel_gains_no_energy(cells: int) -> None:
    """It carries the load of small displacements, where joint points keep their frames.

    Across the crack the corners of the halves are farther apart than it slips. A corner that has passed the other one
    rests on the other half; this changes with each crossing, and must not affect the mortar that still holds.
    """
    glue = JointMaterial(0.6, 1e5, 2e4, elasticity=Mortar(1e10, 0.2, 0.01))
    glue = replace(glue, fracture_energy_1=20.0, fracture_energy_2=200.0)
    lintel = build_scene(
        "lintel",
        [rectangle(-0.1, 0.0, 1.2, 0.2)],
        grounds=[rectangle(-1.0, -0.5, 1.0, 0.5), rectangle(1.0, -0.5, 1.0, 0.5)],
        thickness=0.1,
        block=BlockMaterial(2000.0, 1e10),
        joint=JointMaterial(0.6, elasticity=Mortar(1e9, 0.2, 0.01)),
        inner_joint=glue,
        load=Load(live=(PointLoad((0.3, 0.2), (0.0, -1.0)),)),
    )
    small = fem(lintel, 0.01, cells=cells)
    far = fem(lintel, 0.03, cells=cells, displacements="finite", distance=2e-3)
    assert small.status == far.status == "collapse"
    assert far.multiplier == pytest.approx(small.multiplier, rel=0.01)


@pytest.mark.parametrize("inset", [0.0, 0.005])
@pytest.mark.parametrize(("modes", "cells"), [(6, 1), ("all", 1), ("all", 2)])
def test_small_displacements_agree_to_first_order(modes: ModeCount, cells: int, inset: float) -> None:
    """Modal forces of elastic joints: the difference falls as the square of the amplitude, slope 2 ± 0.1."""
    scene = wall(joint__inset=inset)
    blocks = node_outline(scene, cells, modes)
    finite, small = finite_system(blocks), system_of(modal_wall(scene, cells, modes))
    bears = np.abs(finite.interface.jumps(np.zeros_like(finite.mass))[0]) < 1e-9
    assert finite.interface.area[bears].sum() == pytest.approx(small.interface.area.sum(), rel=1e-12)
    stiffness = np.array([finite.interface.law.normal_stiffness[:1], finite.interface.law.shear_stiffness[:1]])
    rng = np.random.default_rng(0)
    direction = rng.normal(size=len(finite.mass))
    direction[blocks.wall.rigid[:, 2]] /= 0.1
    direction[-1] = 0.0
    amplitudes = 10.0 ** np.arange(-6, -3)
    difference = []
    for amplitude in amplitudes:
        motion = amplitude * direction
        forces = np.zeros((2, len(motion)))
        for system, force, mask in (
            (finite, forces[0], bears),
            (small, forces[1], np.ones(small.interface.law.points)),
        ):
            # Slip is measured from the undeformed position of the contact.
            jump = np.array(system.interface.jumps(motion)) - system.interface.jumps(0 * motion)
            system.interface.scatter(*(stiffness * jump * mask), tuple(system.interface.geometry), force)
        assert np.abs(forces[1]).max() > 0
        difference.append(np.abs(forces[0] - forces[1])[:-1].max())
    slopes = np.diff(np.log10(difference))
    assert slopes == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("inset", [0.0, 0.01])
@given(seed=st.integers(0, 1000))
@settings(max_examples=15, derandomize=True)
def test_scatter_is_transposed_derivative_of_gather_at_large_rotations(inset: float, seed: int) -> None:
    """Scatter is minus the transpose of the derivative of gather, on rotated and deformed blocks.

    For rounded corners this holds to the strain of the side they roll on; for arc against arc only to the penetration.
    Contacts between arcs are left out, and so are nodes close to the end of a side.
    """
    scene = wall(wall__length=0.72, wall__height=0.18, joint__inset=inset)
    blocks = node_outline(scene, 2)
    motion = turned(blocks, seed, deformed=1e-4 if inset == 0 else 1e-7)
    search = DeformableContacts(blocks)
    contacts = search.find(motion, 0.02)
    system = finite_system(blocks)
    geometry = search.geometry(contacts)
    jumps_on(system, geometry, motion, len(contacts))
    rng = np.random.default_rng(seed)
    facets, contact, touched = geometry.placed.facets, geometry.contact, geometry.touched
    opening = jumps_on(system, geometry, motion, len(contacts))[0]
    of_a = touched[:, 2]
    side = np.where(of_a, touched[:, 0], touched[:, 1])
    gap = (1 - 2 * of_a) * np.einsum("kx,kx->k", contact[:, :2] - facets[side, :2], contact[:, 2:4])
    plain = (np.abs(gap - opening) < 1e-12) | (contact[:, 7] != 0)
    assert plain.sum() > 30
    direction = rng.normal(size=len(motion))
    direction[-1] = 0.0
    step = 1e-7 * direction
    rate = jumps_on(system, search.geometry(contacts), motion + step, len(contacts))
    rate = (rate - jumps_on(system, search.geometry(contacts), motion - step, len(contacts))) / 2e-7
    tractions = rng.normal(size=(2, len(contacts))) * plain
    force = np.zeros_like(motion)
    system.interface.scatter(*tractions, tuple(geometry), force)
    work = (tractions * rate * contacts.area).sum()
    scale = np.abs(tractions * rate * contacts.area).sum()
    assert -force[:-1] @ direction[:-1] == pytest.approx(work, abs=1e-5 * scale)


def test_rigid_rotation_of_wall_causes_no_strain_and_no_jumps() -> None:
    """By one radian: no strain of any triangle and no change of any jump between moving blocks, to 1e-12."""
    scene = wall()
    blocks = node_outline(scene, 2)
    mesh, turn, centre = blocks.wall.mesh, 1.0, np.array([0.1, 0.2])
    c, s = math.cos(turn), math.sin(turn)
    R = np.array([[c, -s], [s, c]])
    deformed = turned(blocks, 3, turn=0.0, apart=0.0)
    rigid, deformed[blocks.wall.rigid] = blocks.wall.rigid[~scene.fixed], 0.0
    arm = scene.blocks.centroid[~scene.fixed] - centre
    for motion in (np.zeros_like(deformed), deformed):
        before = blocks.positions(motion)
        rotated = motion.copy()
        rotated[rigid] = np.column_stack([arm @ R.T - arm, np.full(len(arm), turn)])
        after = blocks.positions(rotated)
        moves = ~scene.fixed[mesh.block]
        assert after[moves] == pytest.approx((before[moves] - centre) @ R.T + centre, abs=1e-14)
        contacts = DeformableContacts(blocks).undeformed
        owner = scene.blocks.owner[contacts.ends[:, 4:].astype(np.int64)]
        free = ~scene.fixed[owner].any(axis=1)
        assert free.sum() > 20
        system = finite_system(blocks)
        jumps = [jumps_on(system, system.interface.geometry, m, len(contacts))[:, free] for m in (motion, rotated)]
        assert jumps[1] == pytest.approx(jumps[0], abs=1e-12)
    for block in map(int, np.flatnonzero(~scene.fixed)):
        own, triangles = nodes_of(mesh, block), triangles_of(mesh, block)
        X, x = mesh.points[own][triangles], blocks.positions(rotated - deformed)[own][triangles]
        F = np.linalg.solve(np.diff(X, axis=1), np.diff(x, axis=1))
        assert np.abs(F @ F.transpose(0, 2, 1) - np.eye(2)).max() < 1e-12


def test_spinning_block_stays_free_of_stress() -> None:
    """In free flight at 10 rad/s: no force on any mode, and the rotation is exact."""
    scene = wall()
    blocks = node_outline(scene)
    run = Run(weightless(finite_system(blocks)), local=0.0)
    up = np.zeros_like(run.system.mass)
    up[run.system.rigid[-1, 1]] = 0.5
    state = State.at_rest(run.system, up)
    state.velocity[run.system.rigid[-1, 2]] = 10.0
    steps = round(0.1 / run.dt)
    run.hold(state, 0.0, steps)
    assert place(run, state, -1)[2] == pytest.approx(10.0 * steps * run.dt, rel=1e-9)
    deformations = np.ones(len(up), dtype=bool)
    deformations[blocks.wall.rigid] = False
    assert np.abs(run.system.stiffness * state.motion)[deformations].max() < 1e-12 * 1e10
    assert not state.motion[deformations].any()


def test_free_pile_conserves_momentum_through_contact_updates() -> None:
    """Linear and angular momentum, to 1e-12, while blocks far above the ground fly apart, collide and slide."""
    scene = wall(wall__length=0.72, joint__inset=0.005)
    blocks = node_outline(scene)
    run = Run(weightless(finite_system(blocks)), local=0.0)
    up = np.zeros_like(run.system.mass)
    moving = run.system.rigid[~scene.fixed]
    up[moving[:, 1]] = 5.0
    state = State.at_rest(run.system, up)
    state.velocity[moving] = np.random.default_rng(2).normal(size=moving.shape)
    mass = run.system.mass[moving]

    def momenta() -> Array:
        p = mass * state.velocity[moving]
        x, y = (scene.blocks.centroid[~scene.fixed] + state.motion[moving[:, :2]]).T
        return np.array([*p[:, :2].sum(axis=0), (p[:, 2] + x * p[:, 1] - y * p[:, 0]).sum()])

    before, scale = momenta(), np.abs(mass * state.velocity[moving]).sum()
    found = {id(state.contacts): state.contacts}
    while state.steps < 6000:
        run.hold(state, 0.0, 500)
        found[id(state.contacts)] = state.contacts
    assert len(found) > 10
    assert np.abs(momenta() - before).max() < 1e-12 * scale
    assert state.friction > 0
    assert run.ledger(state).elastic > 0


def test_copied_state_keeps_its_own_contacts() -> None:
    """Continuing from a copy gives the same result to the last bit, whatever the run did in between."""
    run = Run(finite_system(node_outline(wall())))
    state = State.at_rest(run.system)
    state.velocity[run.system.rigid[-1]] = 1.0, 0.5, 2.0
    run.hold(state, 0.8, 1000)
    kept = state.copy()
    run.hold(state, 0.8, 2000)
    assert state.contacts is not kept.contacts
    run.hold(kept, 0.8, 2000)
    assert (state.motion == kept.motion).all()
    assert run.ledger(state) == run.ledger(kept)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"joint__cohesion": 1e4}, "joint"),
        ({"support__kind": "corners"}, "support.kind"),
    ],
)
def test_unsupported_scenes_are_refused(changes: dict[str, Any], key: str) -> None:
    with pytest.raises(SceneError, match=key):
        node_outline(wall(**changes))


def test_materials_without_a_stiffness_are_refused() -> None:
    scene = wall()
    with pytest.raises(SceneError, match="block.young"):
        node_outline(scene.with_block(young=None))
    with pytest.raises(SceneError, match="joint"):
        finite_system(node_outline(scene.with_joint(elasticity=None)))


# --- one block -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cells", [2, *at_length(1)])
def test_resistance_of_stiff_block_falls_as_tangent(cells: int) -> None:
    """E = 1e12: λ(θ) = tan(α − θ) within 1 % of tan α, checked for 0.02 < θ < 0.2."""
    scene = panel(
        wall__length=0.25,
        wall__height=1.0,
        wall__block_width=0.25,
        wall__block_height=1.0,
        wall__thickness=1.0,
        block={"density": 4.0, "young": 1e12, "poisson": 0.2},
        joint={"friction": 2.0, "normal_stiffness": 1e10, "shear_stiffness": 1e10},
    )
    run = Run(finite_system(node_outline(scene, cells)), local=0.05, viscous=0.5)
    state = State.at_rest(run.system)
    settle(run, state, 0.0, Criteria(collapse=0.1))
    speed = GRAVITY * 0.12 / (600_000 * run.dt)
    found = []
    for piece in range(200):
        multiplier = run.drive(state, speed * min(1.0, (piece + 1) / 20), 3000)
        found.append((-place(run, state, 0)[2], multiplier))
    theta, multiplier = np.array(found).T
    falling = (theta > 0.02) & (theta < 0.2)
    assert falling.sum() > 50
    smooth = np.convolve(multiplier, np.ones(5) / 5, "same")
    assert smooth[falling] == pytest.approx(np.tan(math.atan(0.25) - theta)[falling], abs=0.01 * 0.25)


# --- blocks that move onto other blocks ----------------------------------------------------------------------


@pytest.mark.parametrize(("cells", "inset"), [(1, 0.02), (2, 0.0), *at_length((1, 0.0), (2, 0.02))])
def test_block_slides_onto_next_block_of_course(cells: int, inset: float) -> None:
    """At constant speed the resistance is λ = μ throughout, the block does not drop, and its weight is transferred.

    Where its corners pass the joint between the two blocks, it is lifted by no more than the compression of its joint.
    """
    mu, width = 0.3, 0.4
    scene = dry([rectangle(0, 0, 1, 0.2), rectangle(1, 0, 1, 0.2), rectangle(0.3, 0.2, width, 0.2)], mu, 1e8, inset)
    blocks = node_outline(scene, cells)
    system = finite_system(blocks)
    alone = np.zeros_like(system.live)
    alone[system.rigid[2]] = system.live[system.rigid[2]]
    run = Run(replace(system, live=alone))
    state = State.at_rest(run.system)
    assert settle(run, state, 0.0, Criteria(collapse=0.01)) == "stable"
    rest, heavy = place(run, state, 2).copy(), weight(scene, 2)
    sunk = 2 * heavy / (1e8 * 0.1 * width)
    assert pressure(run, state, 0, 2) == pytest.approx(heavy, rel=1e-4)
    resisted: list[float] = []
    where: list[tuple[float, float]] = []
    while place(run, state, 2)[0] < 0.9:
        resisted.append(run.drive(state, 0.05 * heavy * min(1.0, (len(resisted) + 1) / 20), round(0.06 / run.dt)))
        u, v, _ = place(run, state, 2) - rest
        where.append((u, v))
    check_sliding(np.array(resisted), np.array(where)[:, 0], mu, (1 - 0.3 - width, 1 - 0.3), sunk, inset)
    heights = np.array(where)[:, 1]
    assert np.abs(heights).max() < 3 * sunk
    assert settle(run, state, 0.0, Criteria(collapse=0.5)) == "stable"
    assert place(run, state, 2)[1] == pytest.approx(rest[1], abs=sunk)
    assert place(run, state, 2)[2] == pytest.approx(0.0, abs=1e-4)
    assert pressure(run, state, 0, 2) == 0.0
    assert pressure(run, state, 1, 2) == pytest.approx(heavy, rel=1e-4)


@pytest.mark.parametrize("inset", [0.0, 0.01])
def test_energy_balance_closes_while_wall_falls_apart(inset: float) -> None:
    """Work of the loads = kinetic + stored + friction + damped, to 1 % of it, over many contact detections."""
    scene = panel(
        wall__height=0.48,
        wall__length=0.24,
        wall__block_width=0.12,
        joint__mortar={**MORTAR, "young": 1e7},
        joint__inset=inset,
        block__young=1e9,
        block__poisson=0.2,
    )
    run = Run(finite_system(node_outline(scene)))
    check_energy_of_a_fall(run)


def test_bonded_block_slides_dry_after_fracture() -> None:
    """Pushed, it resists by cohesion and friction and then by friction only, in its own place and on the next block."""
    mu, width, energy = 0.3, 0.4, 20.0
    scene = dry([rectangle(0, 0, 1, 0.2), rectangle(1, 0, 1, 0.2), rectangle(0.55, 0.2, width, 0.2)], mu, 1e9, 0.01)
    glue = {"cohesion": 1e4, "tensile_strength": 1e4, "fracture_energy_1": energy, "fracture_energy_2": energy}
    blocks = node_outline(scene.with_joint(**glue))
    system = finite_system(blocks)
    alone = np.zeros_like(system.live)
    alone[system.rigid[2]] = system.live[system.rigid[2]]
    run = Run(replace(system, live=alone))
    state = State.at_rest(run.system)
    assert settle(run, state, 0.0, Criteria(collapse=0.01)) == "stable"
    area, heavy = 0.1 * width, weight(scene, 2)
    resisted: list[tuple[float, float]] = []
    while place(run, state, 2)[0] < 0.5:
        multiplier = run.drive(state, 0.01 * heavy * min(1.0, (len(resisted) + 1) / 20), 200)
        resisted.append((place(run, state, 2)[0], multiplier))
    u, multiplier = np.array(resisted).T
    strongest = mu + 1e4 * area / heavy
    assert 0.7 * strongest < multiplier.max() < 1.02 * strongest
    broken = u > 2 * energy / 1e4 + 0.01
    assert multiplier[broken] == pytest.approx(mu, rel=0.02)
    contacts, undeformed = contacts_of(state), DeformableContacts(blocks).undeformed
    assert (state.history[DAMAGE][contacts.glued] <= 1).all()
    lost = ~np.isin(contacts.key, undeformed.key[undeformed.glued])
    assert lost.any()
    assert not contacts.glued[lost].any()
    assert state.history.shape[1] == len(contacts)
    assert np.isfinite(state.history[OPENING_BEFORE]).all()
    spent = run.ledger(state).friction
    assert spent == pytest.approx(energy * area + mu * heavy * u[-1], rel=0.03)


def test_bonded_wall_fractures_as_at_small_displacements() -> None:
    """Pushed by 1 mm, past the peak and into softening: the same multiplier within 1 % of the peak."""
    mortar = {**MORTAR, "young": 1e8}
    scene = wall(joint__mortar=mortar, joint__cohesion=2e4, joint__tensile_strength=1e4, joint__inset=0.005)
    scene = scene.with_joint(fracture_energy_1=5.0, fracture_energy_2=10.0)
    run: Run
    curves = []
    for run in (
        Run(finite_system(node_outline(scene, 1))),
        Run(system_of(modal_wall(scene)), local=LOCAL, viscous=VISCOUS),
    ):
        state = State.at_rest(run.system)
        settle(run, state, 0.0, Criteria(collapse=0.006))
        power = 1e-3 * np.abs(run.system.live).sum()
        curve = [(0.0, 0.0)]
        while curve[-1][0] < 1e-3:
            multiplier = run.drive(state, power * min(1.0, len(curve) / 20), round(2e-3 / run.dt))
            curve.append((float(run.system.control @ state.motion), multiplier))
        u, multipliers = np.array(curve).T
        curves.append(np.interp(np.linspace(2e-5, 1e-3, 50), u, np.convolve(multipliers, np.ones(5) / 5, "same")))
    finite, small = curves
    assert small.argmax() < 30
    assert small[-1] < 0.7 * small.max()
    assert finite == pytest.approx(small, abs=0.01 * small.max())


# --- walls ---------------------------------------------------------------------------------------------------


def softer(name: str, factor: float, young: float = 1e10) -> Scene:
    """A published wall with corners rounded at 20 mm and softer joints, which allow a longer time step."""
    scene = published_scene(name)
    assert isinstance(scene.joint.elasticity, Mortar)
    elasticity = replace(scene.joint.elasticity, young=scene.joint.elasticity.young * factor)
    return scene.with_block(young=young, poisson=0.2).with_joint(inset=0.02, elasticity=elasticity)


def pushed(model: Any, scene: Scene, at: list[float], **settings: Any) -> Array:
    """Multiplier at displacements of the control point."""
    return np.asarray(np.interp(at, *model(scene, displacements="finite", distance=max(at) + 0.01, **settings).curve.T))


@pytest.mark.long
@pytest.mark.parametrize("modes", [3, pytest.param("all", marks=pytest.mark.long)])
def test_deformable_wall_softens_as_rigid_wall(modes: ModeCount) -> None:
    """W1 past its peak, with corners rounded at 20 mm: within 1 %, with three modes and with all modes."""
    scene = softer("wall-w1", 0.01)
    at = [0.02, 0.05, 0.1, 0.2]
    rigid = pushed(dem_dynamic, scene, at)
    assert pushed(fem, scene, at, modes=modes) == pytest.approx(rigid, rel=0.01)


@pytest.mark.long
def test_post_peak_resistance_depends_neither_on_mesh_nor_on_block_stiffness() -> None:
    at = [0.02, 0.05, 0.1, 0.2, 0.3]
    found = [
        pushed(fem, softer("wall-w1", 0.01, young), at, cells=cells)
        for young, cells in ((1e10, 1), (1e10, 2), (1e12, 1))
    ]
    for curve in found[1:]:
        assert curve == pytest.approx(found[0], rel=0.02)
