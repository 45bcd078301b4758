"""Cracks inside deformable blocks: triangles joined by inner joints with a strength of their own."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse.linalg import spsolve

from fem_interface.cracks import Cracks, added_compliance, at_most_as_strong, pieces
from fem_interface.fracture import fractured
from fem_interface.frequency_shift import modal_stiffness
from fem_interface.joint_elements import nodal_jump
from fem_interface.modal_wall import ModalWall, modal_wall
from fem_interface.model import fem
from fem_interface.system import system_of
from meshing import wall_mesh
from runningbond.draws.scatter import Scatter
from runningbond.dynamics import Criteria, Run, State, settle
from runningbond.dynamics.toes import Toes
from runningbond.joints.law import FRICTION_WORK
from runningbond.joints.softening import DAMAGE
from runningbond.results import Outcome
from runningbond.scene import (
    Action,
    Array,
    BlockMaterial,
    Forces,
    Indices,
    JointMaterial,
    Load,
    Scene,
    SceneError,
    Stiffness,
    build_scene,
)
from tests.walls import panel

from .walls import check_dissipation

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}


def wall(inner: dict[str, Any] | None, stiffness: float = 1e12, **changes: Any) -> Scene:
    """A small wall whose blocks may crack at joints of a stiffness [Pa/m] in both directions."""
    size = {"wall__length": 0.48, "wall__height": 0.12, "block__young": 1e10, "block__poisson": 0.2}
    tables: dict[str, Any] = {**size, "joint__mortar": MORTAR, **changes}
    if inner is not None:
        tables["inner_joint"] = {
            "friction": 0.6,
            "normal_stiffness": stiffness,
            "shear_stiffness": stiffness,
            **inner,
        }
    return panel(**tables)


STRONG = {"cohesion": 1e9}
BRITTLE = {"tensile_strength": 1e5, "fracture_energy_1": 0.5, "fracture_energy_2": 5.0}
PRESSED = 2e4
"""Force by which a beam presses on a wall [N]."""
SPEED = 2e-3
"""Speed at which a block is pulled apart [m/s]."""

POINT = {"kind": "point", "at": [0.24, 0.12], "force": [0, -1]}


def drawing() -> Scene:
    """Two irregular blocks on a base, triangulated by gmsh."""
    blocks = [
        np.array([[0.0, 0], [0.5, 0], [0.42, 0.6], [0, 0.5]]),
        np.array([[0.5, 0], [1.1, 0], [1.0, 0.55], [0.42, 0.6]]),
    ]
    return build_scene(
        "drawing",
        blocks,
        thickness=0.1,
        block=BlockMaterial(2000.0, 3e9, 0.3),
        joint=JointMaterial(0.6, 1e3, 1e3, Stiffness(1e11, 4e10)),
        load=Load(),
        inner_joint=JointMaterial(0.7, 1e5, 1e5, Stiffness(1e12, 4e11)),
    )


def corners() -> Scene:
    return wall(STRONG, joint__cohesion=1e5, support__kind="corners", load={"gravity": 0.0, "live": POINT})


def elastic_displacement(found: ModalWall) -> float:
    """Displacement of the control point under dead and live load, with all joints elastic [m]."""
    system = system_of(found)
    moving = np.flatnonzero(np.isfinite(system.mass))
    K = modal_stiffness(found)
    return float(system.control[moving] @ spsolve(K.tocsc(), (system.dead + system.live)[moving]))


# --- geometry ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cells", [1, 2])
@pytest.mark.parametrize("make", [lambda: wall(STRONG), drawing, corners])
def test_every_triangle_is_a_piece_and_every_inner_edge_a_joint(make: Any, cells: int) -> None:
    """Edge count: the three edges of a triangle are outline, joint or inner; weight and outline are unchanged."""
    scene = make()
    whole, found = modal_wall(scene, cells), modal_wall(scene, cells, cracks="blocks")
    moving = ~scene.fixed[whole.mesh.triangle_block]
    assert (~found.scene.fixed).sum() == moving.sum()
    assert found.scene.mass[~found.scene.fixed].sum() == pytest.approx(scene.mass[~scene.fixed].sum(), rel=1e-12)
    edges = np.sort(whole.mesh.triangles[moving][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    twice = (np.unique(edges, axis=0, return_counts=True)[1] == 2).sum()
    assert len(found.mesh.joint) - len(whole.mesh.joint) == twice
    assert found.scene.joints.inner.sum() == scene.joints.inner.sum() + twice
    points = found.elements.points
    facing = found.mesh.points[found.elements.nodes[:, :2]] - found.mesh.points[found.elements.nodes[:, 2:]]
    assert np.abs(facing).max() <= scene.blocks.tolerance
    assert ((_between(found, points.block) * points.normal).sum(axis=1) > 0).all()
    assert found.pieces.owner.max() + 1 == len(scene.blocks)
    assert np.abs(found.mesh.points - whole.mesh.points[found.pieces.node]).max() == 0


def _between(found: ModalWall, block: Indices) -> Array:
    """Vector from the pieces on side a to those on side b."""
    centroid = found.scene.blocks.centroid
    return np.asarray(centroid[block[:, 1]] - centroid[block[:, 0]])


def test_axis_of_cracking_block_is_an_edge_of_its_mesh() -> None:
    """Blocks that the scene splits into halves have the triangles of whole blocks."""
    cut, plain = (modal_wall(scene, 2).mesh for scene in (wall(STRONG), wall(None)))

    def centres(mesh: Any) -> Array:
        found = mesh.points[mesh.triangles].mean(axis=1)
        return np.asarray(found[np.lexsort(np.round(found.T, 9))])

    assert np.abs(centres(cut) - centres(plain)).max() < 1e-12


def test_blocks_of_random_wall_crack_at_their_own_strength() -> None:
    """Each joint of a random draw has its own material; edges inside blocks once took that of the last joint (dry)."""
    narrow: dict[str, Any] = {
        "wall__length": None,
        "wall__height": None,
        "wall__courses": [[0.75, 0.75], [0.5, 0.5, 0.5]],
    }
    drawn = Scatter.read("friction=0.05").draw(wall(STRONG, **narrow), 1)
    parted = modal_wall(drawn, cracks="blocks").scene
    inside = parted.material_of_joint[parted.joints.inner]
    assert {parted.joint_materials[k].cohesion for k in inside} == {STRONG["cohesion"]}


def test_equal_cells_have_four_templates() -> None:
    assert len(modal_wall(wall(STRONG, wall__height=0.24), 2, cracks="blocks").templates) == 4


@pytest.mark.parametrize("make", [lambda: wall(STRONG), drawing])
@pytest.mark.parametrize("on", ["elements", "joints"])
def test_continuous_displacements_open_no_inner_joint(make: Any, on: Any) -> None:
    """Continuous displacements have no jump at inner joints, and those of whole blocks at joints between blocks."""
    scene = make()
    whole, found = (modal_wall(scene, 2, points=on, cracks=cracks) for cracks in ("joints", "blocks"))
    u = np.random.default_rng(3).normal(size=whole.mesh.points.shape)
    parts = []
    for wall_, nodal in ((whole, u), (found, u[found.pieces.node])):
        jump = nodal_jump(wall_.elements, len(wall_.mesh.points))
        order = wall_.elements.listing
        parts.append([(jump.opening @ nodal.ravel())[order], (jump.slip @ nodal.ravel())[order]])
    n = len(parts[0][0])
    for before, after in zip(*parts, strict=True):
        assert after[:n] == pytest.approx(before, abs=1e-12)
        assert np.abs(after[n:]).max() < 1e-12


@pytest.mark.parametrize("make", [lambda: wall(STRONG), drawing])
@pytest.mark.parametrize("loads", ["consistent", "inner"])
def test_piece_loads_have_resultant_of_their_block(make: Any, loads: Any) -> None:
    """Gravity and live load accelerate each block in translation, without rotation."""
    scene = make()
    found = modal_wall(scene, 2, cracks="blocks")
    system = system_of(found, loads=loads)
    run = Run(system)
    state = State.at_rest(system)
    state.motion = np.where(np.isfinite(system.mass), (system.dead + 0.4 * system.live) / system.mass, 0.0)
    accelerated = run.system.motion_of_blocks(state.motion)[~scene.fixed]
    assert accelerated == pytest.approx(np.tile([0.4 * 9.81, -9.81, 0.0], (len(accelerated), 1)), abs=1e-10)


class Bracket(Action):
    """Custom force on the first block, at a point beside the wall."""

    def forces(self, scene: Scene) -> Forces:
        """1 N to the right, at the end of an arm."""
        return Forces.on(scene, block=[0], at=(-0.1, 0.05), force=(1.0, 0.0))


def test_force_beside_block_acts_on_one_of_its_pieces() -> None:
    """It has the same resultant on the whole wall; it once acted on none of the pieces."""
    scene = wall(STRONG, load__live=Bracket())
    found = pieces(scene, wall_mesh(scene, 2), "blocks")
    force, at = found.scene.live_forces.force, found.scene.live_forces.at
    assert force.tolist() == [[1.0, 0.0]]
    assert at.tolist() == [[-0.1, 0.05]]
    assert found.owner[found.scene.live_forces.block].tolist() == [0]


def test_block_motions_are_recovered_from_pieces() -> None:
    """Rigid motions of all blocks, applied to their pieces, are recovered."""
    scene = drawing()
    found = modal_wall(scene, cracks="blocks")
    run = Run(system_of(found))
    rigid = np.random.default_rng(4).normal(size=(len(scene.blocks), 3))
    rigid[scene.fixed] = 0.0
    owner = found.pieces.owner
    arm = found.scene.blocks.centroid - scene.blocks.centroid[owner]
    of_piece = rigid[owner]
    of_piece[:, :2] += rigid[owner, 2:] * np.column_stack([-arm[:, 1], arm[:, 0]])
    state = State.at_rest(run.system)
    state.motion[found.rigid] = of_piece
    state.velocity[found.rigid] = 2 * of_piece
    assert run.system.motion_of_blocks(state.motion) == pytest.approx(rigid, abs=1e-12)
    assert run.system.motion_of_blocks(state.velocity) == pytest.approx(2 * rigid, abs=1e-12)


def test_cracks_need_inner_joint_in_scene() -> None:
    with pytest.raises(SceneError, match="inner_joint: is missing; cracks inside blocks") as refused:
        fem(wall(None), cracks="blocks")
    assert "\n" not in str(refused.value)
    with pytest.raises(ValueError, match="cracks = 'everywhere'"):
        modal_wall(wall(STRONG), cracks="everywhere")  # type: ignore[arg-type]


def test_inset_wider_than_inner_edge_is_refused() -> None:
    with pytest.raises(SceneError, match=r"inner_joint\.inset = 0.025"):
        modal_wall(wall({**STRONG, "inset": 0.025}), 2, cracks="blocks")


def test_inner_joints_have_their_own_fracture_energies_not_those_of_mortar() -> None:
    scene = wall({**STRONG, "fracture_energy_1": 7.0}, joint__cohesion=1e5)
    found = modal_wall(scene, cracks="blocks").scene
    materials, of_joint = fractured(found, "corrected")
    inner = {materials[k].fracture_energy_1 for k in of_joint[found.joints.inner]}
    between = {materials[k].fracture_energy_1 for k in of_joint[~found.joints.inner]}
    assert inner == {7.0}
    assert not between & {7.0, None}


# --- strong inner joints -------------------------------------------------------------------------------------


@pytest.mark.parametrize("load", [{}, {"load": {"gravity": 0.0, "live": POINT}}])
def test_compliance_of_inner_joints_falls_as_one_over_stiffness(load: dict[str, Any]) -> None:
    """Their added compliance falls as 1 / k: slope −1 ± 0.05 over two decades."""
    whole = elastic_displacement(modal_wall(wall(None, **load), modes="all"))
    walls = [wall(STRONG, k, **load) for k in (1e13, 1e14, 1e15)]
    added = [elastic_displacement(modal_wall(scene, cracks="blocks")) / whole - 1 for scene in walls]
    assert np.diff(np.log10(added)) == pytest.approx(-1.0, abs=0.05)
    assert added[-1] < 1e-3


@pytest.mark.parametrize("cells", [2, 3])
def test_added_compliance_is_that_of_springs_in_series(cells: int) -> None:
    """E / (k h) in cells of height h, which is less than their width."""
    stiffness, height = 1e12, 0.06 / cells
    scene = wall(STRONG, stiffness, wall__height=0.06, wall__block_height=0.06)
    found = pieces(scene, wall_mesh(scene, cells), "blocks")
    assert added_compliance(found) == pytest.approx(1e10 / (stiffness * height), rel=1e-9)


@pytest.mark.long
def test_strong_inner_joints_give_limit_load_of_whole_blocks() -> None:
    """λ of a small wall with stiff and strong joints between its triangles is that of whole blocks."""
    size = {"wall__length": 0.24, "wall__height": 0.24, "wall__block_width": 0.12, "wall__block_height": 0.12}
    whole = fem(wall(None, **size))
    cracked = fem(wall(STRONG, 2e11, **size), cracks="blocks")
    assert whole.multiplier is not None
    assert whole.multiplier < 0.55
    assert whole.status == cracked.status == "collapse"
    assert cracked.multiplier == pytest.approx(whole.multiplier, rel=0.01)
    assert cracked.dofs is not None
    assert whole.dofs is not None
    assert cracked.dofs > 2 * whole.dofs
    assert cracked.motion.shape == (len(wall(STRONG, **size).blocks), 3)
    assert "inner joints make blocks up to 167% softer" in cracked.message  # E / (k h) of cells of 0.06 m


def strut(inner: dict[str, Any], cracks: Cracks) -> tuple[float, dict[str, Array]]:
    """Force at which a wall between a base and a beam of fixed height has been pushed by 0.2 mm, and the path."""
    size = {"wall__length": 0.24, "wall__height": 0.24, "wall__block_width": 0.12, "wall__block_height": 0.12}
    beam = {"height": 0.1, "condition": "fixed-height", "force": [0, -PRESSED]}
    beam["drive"] = {"displacement": [2e-4, 0], "rate": 0.02, "at": 0.24}
    crushes = {"joint__friction": 1.5, "joint__compressive_strength": 1e9}  # the law of the mortared walls
    scene = wall(inner, 1e13, **size, **crushes, load={"gravity": 9.81}, beam=beam)
    outcome = fem(scene, cracks=cracks, modes="all")
    return outcome.curve[-1, 1], dict(zip(outcome.path_columns, outcome.path.T, strict=True))


@pytest.mark.long
def test_wall_under_fixed_height_beam_cracks_between_triangles() -> None:
    """Strong blocks carry as much as whole blocks, weak ones less. The beam neither rotates nor rises, so N grows."""
    whole, _ = strut(STRONG, "joints")
    strong, way = strut(STRONG, "blocks")
    weak, _ = strut({"cohesion": 1e5, **BRITTLE}, "blocks")
    assert strong == pytest.approx(whole, rel=0.005)
    assert np.abs(way["beam rotation [rad]"]).max() == np.abs(way["beam uplift [m]"]).max() == 0.0
    assert way["ground vertical [N]"][-1] > 1.25 * PRESSED
    assert weak < 0.7 * strong


@pytest.mark.parametrize("at", [0.05, 0.12, 0.3, 0.5])
def test_beam_force_is_same_on_pieces_at_any_height(at: float) -> None:
    """Below the beam, at its underside, at its top and above: the force is the same on pieces as on blocks."""
    scene = wall(STRONG, beam={"height": 0.1, "drive": {"force": [1, 0], "at": at}}, load={"gravity": 9.81})
    parted = modal_wall(scene, cracks="blocks").scene
    whole, pieces = scene.live_forces, parted.live_forces
    assert scene.beam is not None
    assert parted.beam is not None
    assert pieces.block.tolist() == [parted.beam.block]
    assert np.array_equal(pieces.force, whole.force)
    assert np.array_equal(pieces.at, whole.at)
    (before, after) = (each.blocks.centroid[each.beam.block] for each in (scene, parted) if each.beam)
    assert np.array_equal(before, after)


FLOOR = {"kind": "line", "from": [0.0, 0.12], "to": [0.48, 0.12], "force": [300.0, -900.0]}
SLOPE = {"kind": "line", "from": [0.05, 0.02], "to": [0.45, 0.11], "force": [300.0, -900.0]}
LONG: dict[str, Any] = {"wall__length": None, "wall__height": None, "wall__block_height": 0.12, "wall__courses": [[2]]}
"""One block of twice the length: each half has twice as many cells."""


@pytest.mark.parametrize("cells", [1, 2, 3, 4])
@pytest.mark.parametrize("size", [{}, LONG], ids=["bricks", "one long stone"])
def test_line_load_acts_on_every_triangle_along_it(cells: int, size: dict[str, Any]) -> None:
    """Each triangle with a side on top carries the load on that side, at the middle of the side, on any mesh."""
    scene = wall(STRONG, load={"gravity": 9.81, "live": FLOOR}, **size)
    found = modal_wall(scene, cells, cracks="blocks").scene
    for piece in np.flatnonzero(~found.fixed).tolist():
        corner = found.blocks.polygon(piece)
        above = corner[np.abs(corner[:, 1] - 0.12) < 1e-9]
        length = np.ptp(above[:, 0]) if len(above) == 2 else 0.0
        here = found.live_forces.block == piece
        force, at = found.live_forces.force[here], found.live_forces.at[here]
        assert force.sum(axis=0) == pytest.approx(length * np.array(FLOOR["force"]), abs=1e-9)
        if length:
            assert np.average(at, axis=0, weights=force[:, 0]) == pytest.approx(above.mean(axis=0), abs=1e-9)


@pytest.mark.parametrize("line", [FLOOR, SLOPE])
def test_line_load_has_same_resultants_on_pieces_and_blocks(line: dict[str, Any]) -> None:
    """Along the top and across the blocks."""
    scene = wall(STRONG, load={"gravity": 9.81, "live": line})
    found = modal_wall(scene, 3, cracks="blocks")
    each, owner = found.scene.live_forces, found.pieces.owner
    on_blocks = Forces.on(scene, block=owner[each.block], at=each.at, force=each.force)
    wanted = scene.live_forces.resultants(scene)
    assert on_blocks.resultants(scene) == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())


def test_line_load_tears_block_at_strength_of_its_triangles() -> None:
    """Pulled upwards at f_t × thickness plus the weight of the upper half, below which edges cross the whole block."""
    inner = {"cohesion": 4e4, "tensile_strength": 2e4}
    load = {"gravity": 9.81, "live": {"kind": "line", "from": [0.0, 0.12], "to": [0.48, 0.12], "force": [0.0, 1.0]}}
    scene = wall(inner, joint__cohesion=1e5, load=load, **LONG)
    outcome = fem(scene, cells=2, cracks="blocks")
    weight = 1800.0 * 9.81 * 0.12 * 0.12  # of the stone, per length
    assert outcome.multiplier == pytest.approx(2e4 * 0.12 + 0.5 * weight, rel=0.01)


LIVE: dict[str, dict[str, Any]] = {
    "line": FLOOR,
    "moment": {"kind": "moment", "at": [0.1, 0.03], "moment": 1.0},
    "point": POINT,
    "lateral": {"kind": "lateral"},
}


@pytest.mark.parametrize("kind", LIVE)
def test_control_point_is_same_with_pieces(kind: str) -> None:
    scene = wall(STRONG, load={"gravity": 9.81, "live": LIVE[kind]})
    found = modal_wall(scene, 2, cracks="blocks")
    (blocks, at, direction), (held, there, along) = scene.control_point, found.scene.control_point
    whole, parts = np.unique(np.hstack([at, direction]), axis=0), np.unique(np.hstack([there, along]), axis=0)
    assert np.array_equal(whole, parts)
    assert set(found.pieces.owner[held].tolist()) == set(blocks.tolist())


@pytest.mark.parametrize("cracks", ["joints", "blocks"])
def test_displacement_of_a_moment_does_not_depend_on_the_centre_of_rotation(cracks: Cracks) -> None:
    """Whether one or several pieces of the block touch its corners."""
    scene = wall(STRONG, load={"gravity": 9.81, "live": LIVE["moment"]})
    found = modal_wall(scene, 2, cracks=cracks)
    diagonal = np.hypot(*np.ptp(scene.blocks.polygon(int(scene.control_point[0][0])), axis=0))
    for centre in ((0.0, 0.0), (0.24, 0.06), (-3.0, 5.0)):
        motion, (x, y) = np.zeros(len(found.mass)), (found.scene.blocks.centroid - centre).T
        motion[found.rigid] = np.column_stack([-y, x, np.ones_like(x)])
        assert found.control_row() @ motion == pytest.approx(diagonal / 2)


def test_cracks_between_triangles_count_as_inner_joints_at_toes() -> None:
    """As the joints on block axes, which the scene numbers; joints between blocks do not count."""
    scene = wall(STRONG)
    found = modal_wall(scene, 2, cracks="blocks")
    inner = Toes(scene, found.elements.points).is_inner
    assert np.array_equal(inner, found.scene.joints.inner[found.elements.points.joint])
    assert inner.sum() > scene.joints.inner.sum() > 0


# --- weak inner joints ---------------------------------------------------------------------------------------


def pulled_apart(direction: int, energies: tuple[float, float]) -> tuple[Run, State, ModalWall]:
    """A block torn into halves at its axis: the left end is held, the right one moves in x (0) or y (1)."""
    brittle = {"cohesion": 2e5, "tensile_strength": 1e5}
    fracture = {"fracture_energy_1": energies[0], "fracture_energy_2": energies[1]}
    size = {"wall__length": 0.24, "wall__height": 0.06, "joint__friction": 0.0, "block__poisson": 0.0}
    found = modal_wall(wall({**brittle, **fracture}, 1e11, **size), cracks="blocks")
    system = system_of(found)
    centroid = found.scene.blocks.centroid
    moving = ~found.scene.fixed
    # In opening only the two outermost triangles are controlled; in shear both whole halves are.
    reach = np.abs(centroid[:, 0] - 0.12) - (0.09 if direction == 0 else 0.0)
    held, drawn = (np.flatnonzero(moving & (reach > 0) & (sense * (centroid[:, 0] - 0.12) > 0)) for sense in (-1, 1))
    assert len(held) == len(drawn) == (1 if direction == 0 else 4)
    mass = system.mass.copy()
    for k, blocks in ((np.inf, held), (1e15, drawn)):
        for template, first in zip(found.templates, found.first, strict=False):
            n, modes = len(template.blocks), len(template.modes.mass)
            rows = np.flatnonzero(np.isin(template.blocks, blocks))
            mass[(first + n * np.arange(modes)[:, None] + rows).ravel()] = k
    nothing = np.zeros_like(mass)
    run = Run(replace(system, mass=mass, dead=nothing, live=nothing))
    state = State.at_rest(run.system)
    state.velocity[found.rigid[drawn, direction]] = SPEED
    return run, state, found


@pytest.mark.parametrize("direction", [0, 1])
def test_torn_block_dissipates_fracture_energy_of_its_crack(direction: int) -> None:
    """G_I × area if the halves are pulled apart, G_II × area if sheared; nothing elsewhere."""
    energies = (20.0, 35.0)
    run, state, found = pulled_apart(direction, energies)
    spent = np.zeros(run.system.interface.law.points)
    wanted = 1.2 * 2 * energies[direction] / (1e5 if direction == 0 else 2e5) + 1e-5
    while state.steps * run.dt * SPEED < wanted:
        run.hold(state, 0.0, 500)
        after = run.system.interface.area * state.history[FRICTION_WORK]
        assert (after - spent).min() >= -1e-12 * after.max()
        spent = after
    points = found.elements.points
    crack = np.abs(points.position[:, 0] - 0.12) < 1e-9
    crack &= found.scene.joints.inner[points.joint] & (np.abs(points.normal[:, 0]) > 0.99)
    assert run.system.interface.area[crack].sum() == pytest.approx(0.06 * 0.12, rel=1e-12)
    assert spent[crack].sum() == pytest.approx(energies[direction] * 0.06 * 0.12, rel=1e-3)
    assert state.history[DAMAGE][crack] == pytest.approx(1.0)
    assert not state.history[DAMAGE][~crack & found.scene.joints.inner[points.joint]].any()
    assert spent[~crack].sum() < 1e-3 * spent.sum()


def test_weaker_inner_joints_reduce_limit_load() -> None:
    """λ of a tall block on a rough base: b / h as a whole block, less with weaker inner joints, then infeasible."""
    size = {
        "wall__length": 0.12,
        "wall__height": 0.24,
        "wall__block_width": 0.24,
        "wall__block_height": 0.24,
        "joint__friction": 3.0,
    }
    found = [fem(wall({"cohesion": c}, 1e11, **size), cracks="blocks") for c in (1e6, 1e3, 3e2)]
    assert [outcome.status for outcome in found] == ["collapse", "collapse", "infeasible"]
    assert found[0].multiplier == pytest.approx(0.5, rel=0.01)
    assert found[1].upper is not None
    assert found[1].upper < 0.45


def pulled_up(**settings: Any) -> Outcome:
    """A column of one block without weight, on a stronger bed, of tensile strength 1e5 Pa."""
    size = {"wall__length": 0.12, "wall__height": 0.24, "wall__block_width": 0.24, "wall__block_height": 0.24}
    upwards = {"gravity": 0.0, "live": {"kind": "point", "at": [0.06, 0.24], "force": [0, 1]}}
    inner = {"cohesion": 1e6, "tensile_strength": 1e5}
    return fem(wall(inner, 1e11, **size, joint__cohesion=1e7, load=upwards), cracks="blocks", **settings)


def test_block_in_tension_cracks_across() -> None:
    """Tensile strength times section; blocks one cell high, once the default, bore several times as much."""
    outcome = pulled_up()
    assert outcome.multiplier == pytest.approx(1e5 * 0.12 * float(wall(None).thickness), rel=0.01)
    assert "one cell high" not in outcome.message


def test_blocks_one_cell_high_are_told_to_have_no_level_crack() -> None:
    assert "one cell high" in pulled_up(cells=1, budget=200).message


@pytest.mark.parametrize("cells", [1, 2, 3])
def test_stones_crack_right_beside_stronger_joints(cells: int) -> None:
    """A column pushed at its top turns over its toe, its foot in tension at the stone's strength: F h = f_t t b² / 2.

    Cracks between triangles alone pass above the bed, where the moment is smaller.
    """
    size = {"wall__length": 0.12, "wall__height": 0.24, "wall__block_width": 0.24, "wall__block_height": 0.12}
    push = {"gravity": 0.0, "live": {"kind": "point", "at": [0.0, 0.24], "force": [1, 0]}}
    scene = wall({"cohesion": 1e6, "tensile_strength": 1e5}, 1e11, **size, joint__cohesion=1e7, load=push)
    outcome = fem(scene, cracks="blocks", cells=cells)
    exact = 1e5 * float(scene.thickness) * 0.12**2 / 2 / 0.24
    assert outcome.multiplier == pytest.approx(exact, rel=0.01)
    assert "tensile strength of the stone beside them" in outcome.message


def cohesive() -> st.SearchStrategy[JointMaterial]:
    """Mohr–Coulomb materials with a tension cut-off, perfectly plastic."""
    number = st.sampled_from([0.0, 0.3, 0.6, 1.0, 1.7, 2.5])
    return st.builds(
        lambda friction, cohesion, part: JointMaterial(friction, cohesion, part * cohesion / max(friction, 0.5)),
        *(number, number, st.sampled_from([0.0, 0.5, 1.0])),
    )


@given(cohesive(), cohesive(), st.floats(-10, 6), st.floats(-5, 5))
def test_joints_are_at_most_as_strong_as_stones(joint: JointMaterial, stone: JointMaterial, σ: float, τ: float) -> None:
    """The limited joint bears what both bear, and nothing that breaks the joint or is above the stone's tension."""

    def borne(material: JointMaterial) -> bool:
        return abs(τ) <= material.cohesion - σ * material.friction and σ <= material.tension

    limited = at_most_as_strong(joint, stone)
    if borne(joint) and borne(stone):
        assert borne(limited)
    if borne(limited):
        assert borne(joint)
        assert σ <= stone.tension


def test_softening_and_crushing_of_the_stone_come_with_its_strength() -> None:
    stiffness = Stiffness(1e10, 4e9)
    joint = JointMaterial(0.75, 4e5, 3e5, stiffness, 0.01, 50.0, 400.0, compressive_strength=1e7, name="mortar")
    stone = JointMaterial(0.7, 2e5, 1e5, None, 0.0, 5.0, 40.0, "exponential", 4e6, 2e4, name="inner_joint")
    limited = at_most_as_strong(joint, stone)
    assert limited == replace(stone, elasticity=stiffness, inset=0.01, name="mortar")
    assert at_most_as_strong(stone, joint) is stone


@pytest.mark.parametrize("energy", [None, 0.0, 5.0])
def test_dissipation_of_cracking_blocks_never_decreases(energy: float | None) -> None:
    """At every point, between and inside blocks, through rest and collapse; the energy balance closes."""
    brittle = {"cohesion": 300.0, "fracture_energy_1": energy, "fracture_energy_2": energy}
    inner = {key: value for key, value in brittle.items() if value is not None}
    found = modal_wall(wall(inner, 1e11), cracks="blocks")
    run = Run(system_of(found))
    spent = check_dissipation(run, 200).history[FRICTION_WORK]
    inside = found.scene.joints.inner[found.elements.points.joint]
    assert spent[inside].max() > 0
    assert spent[~inside].max() > 0


def test_pinned_corners_of_cracked_blocks_do_not_move() -> None:
    scene = corners()
    found = modal_wall(scene, cracks="blocks")
    run = Run(system_of(found))
    state = State.at_rest(run.system)
    assert settle(run, state, 1e3, Criteria(collapse=1.0, rest=1e-4)) == "stable"
    u = found.displacement(state.motion)
    for point, direction in zip(scene.pins.point, scene.pins.direction, strict=True):
        pinned = np.hypot(*(found.mesh.points - point).T) < 1e-9
        pinned &= ~found.scene.fixed[found.mesh.block]
        assert pinned.sum() == 2
        assert np.abs(u[pinned] @ direction).max() < 1e-12 * np.abs(u).max()
