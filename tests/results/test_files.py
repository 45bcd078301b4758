"""Stored scenes, files for ParaView, joint states, and the recording of runs."""

import shutil
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import meshio
import numpy as np
import pytest
import pyvista

from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.joints import wall_points
from runningbond.joints.coulomb import COULOMB
from runningbond.limit import limit
from runningbond.models import run_model
from runningbond.pictures.frame import Discretisation, Frame
from runningbond.pictures.joint_state import JointState, states_of_mechanism, states_under_load
from runningbond.pictures.mechanism import mechanism_frame
from runningbond.pictures.recording import MotionRecorder, StaticRecorder, record_mechanism, stresses
from runningbond.pictures.time_series import MAX_FRAMES, TimeSeries, frame_files, read_grid
from runningbond.pictures.vtk_safety import VtkError, vtk_errors_raised
from runningbond.results import Outcome, StoreError, load_scene, save_outcome, write_atomically
from runningbond.results.mechanism import carried, rigid_jumps
from runningbond.scene import Scene
from tests.walls import courses, panel


@pytest.fixture(autouse=True)
def vtk_errors_fail_test() -> Iterator[None]:
    """Fail the test on errors reported by VTK."""
    with vtk_errors_raised():
        yield


POINT = {"kind": "point", "at": [0.72, 0.72], "force": [0.0, -1.0]}
STIFF = {"joint__mortar": {"young": 1e9, "poisson": 0.2, "thickness": 0.01}}
BRITTLE = {"friction": 0.6, "cohesion": 3e5, "tensile_strength": 1e5, "normal_stiffness": 1e10, "shear_stiffness": 4e9}


@pytest.mark.parametrize(
    "changes",
    [
        {},
        STIFF,
        {"support__kind": "corners", "load__live": POINT},
        {"support__kind": "fixed-first-course", "joint__inset": 0.01},
        {"block__young": 1e10, "inner_joint": BRITTLE, "joint__normal_stiffness": 1e9, "joint__shear_stiffness": 4e8},
    ],
)
def test_scene_is_stored_with_result(tmp_path: Path, changes: dict[str, Any]) -> None:
    scene = panel(**changes)
    save_outcome(Outcome(scene.title, "limit", "undecided"), tmp_path, "key", scene)
    back = load_scene(tmp_path)
    assert fingerprint(back, "limit", 0.01) == fingerprint(scene, "limit", 0.01)
    assert np.array_equal(back.control_point[1], scene.control_point[1])


def test_result_without_scene_is_reported(tmp_path: Path) -> None:
    save_outcome(Outcome("wall", "limit", "undecided"), tmp_path)
    with pytest.raises(StoreError, match="without its scene"):
        load_scene(tmp_path)


def moved(scene: Scene, seed: int = 0) -> Frame:
    """A frame of random numbers; its jumps are those of its rigid motion."""
    random = np.random.default_rng(seed)
    points = wall_points(scene)
    motion = np.where(scene.fixed[:, None], 0.0, random.normal(size=(len(scene.blocks), 3)))
    opening, slip = rigid_jumps(scene.blocks, points, motion)
    normal, tangential, damage = random.normal(size=(3, len(points)))
    state = random.integers(0, 4, len(points))
    return Frame(0.25, motion, opening, slip, normal, tangential, state, 2 * motion, np.abs(damage))


def arrays(data: Any) -> dict[str, Any]:
    from vtkmodules.util import numpy_support

    convert: Any = numpy_support.vtk_to_numpy
    return {data.GetArrayName(i): convert(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def points_of(grid: Any) -> Any:
    from vtkmodules.util import numpy_support

    convert: Any = numpy_support.vtk_to_numpy
    return convert(grid.GetPoints().GetData())


def test_block_files_contain_motion_and_numbers(tmp_path: Path) -> None:
    """Corners, their displacement and velocity by rigid-body motion, and block numbers."""
    scene = panel()
    frame = moved(scene)
    TimeSeries(Discretisation.of_rigid_blocks(scene), tmp_path).add(frame)
    grid = read_grid(frame_files(tmp_path, "blocks")[0])
    blocks = scene.blocks
    place = points_of(grid)
    own = scene.wall[blocks.owner]
    assert np.array_equal(place[own, :2], blocks.vertices[own])
    assert not place[:, 2].any()
    arm = place[:, :2] - blocks.centroid[blocks.owner]
    u, v, spin = frame.motion[blocks.owner].T
    exact = np.column_stack([u - spin * arm[:, 1], v + spin * arm[:, 0], 0 * u])
    of_points, of_cells = arrays(grid.GetPointData()), arrays(grid.GetCellData())
    assert of_points["displacement [m]"] == pytest.approx(exact, rel=1e-14, abs=1e-14)
    assert of_points["velocity [m/s]"] == pytest.approx(2 * exact, rel=1e-14, abs=1e-14)
    assert np.array_equal(of_cells["block"], np.arange(len(blocks)))
    assert np.array_equal(of_cells["held"] > 0, scene.fixed)
    assert arrays(grid.GetFieldData())["multiplier"] == 0.25
    for i in (0, 7, len(blocks) - 2):
        cell = grid.GetCell(i)
        corners = [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
        assert np.array_equal(blocks.vertices[corners], blocks.polygon(i))


def test_courses_and_templates_are_counted() -> None:
    """Twelve courses from the bottom; full blocks, equal left and right half blocks, and the ground."""
    from runningbond.pictures.vtk_grids import GridBuilder

    scene = panel()
    grid = GridBuilder(Discretisation.of_rigid_blocks(scene)).blocks(moved(scene))
    found = arrays(grid.GetCellData())
    assert np.array_equal(np.unique(found["course"]), np.arange(-1, 12))
    assert found["course"][~scene.wall] == -1
    height = scene.blocks.centroid[scene.wall, 1]
    assert np.array_equal(found["course"][scene.wall], np.floor(height / 0.06).astype(int))
    areas = [scene.blocks.area[found["template"] == number] for number in np.unique(found["template"])]
    assert len(areas) == 3
    assert all(np.ptp(area) < 1e-12 for area in areas)


def test_joint_files_contain_jumps_and_tractions(tmp_path: Path) -> None:
    """Each cell lies on its joint; its two faces move with their blocks, and separate by opening and slip."""
    scene = panel()
    frame, points = moved(scene), wall_points(scene)
    TimeSeries(Discretisation.of_rigid_blocks(scene), tmp_path).add(frame)
    grid = read_grid(frame_files(tmp_path, "joints")[0])
    n = len(scene.joints)
    assert grid.GetNumberOfCells() == 2 * n
    place, of_points, of_cells = points_of(grid)[:, :2], arrays(grid.GetPointData()), arrays(grid.GetCellData())
    displacement = of_points["displacement [m]"][:, :2]
    for kind, cells in (("line", range(n)), ("quad", range(n, 2 * n))):
        for joint, cell in enumerate(cells):
            ids = grid.GetCell(cell).GetPointIds()
            corners = [ids.GetId(k) for k in range(ids.GetNumberOfIds())]
            ends = scene.joints.ends[joint]
            assert of_cells["joint"][cell] == joint
            if kind == "line":
                assert place[corners] == pytest.approx(ends, abs=1e-12)
                continue
            assert place[corners] == pytest.approx(ends[[0, 1, 1, 0]], abs=1e-12)
            a, b = scene.joints.block[joint]
            sides = carried(scene.blocks, np.array([a, a, b, b]), place[corners], frame.motion)
            assert displacement[corners] == pytest.approx(sides, abs=1e-12)
    normal, tangent = (np.repeat(x, 1, axis=0) for x in (points.normal, points.tangent))
    quads = np.arange(6 * n).reshape(n, 6)[:, 2:]
    own = np.arange(2 * n).reshape(n, 2)
    for k in (0, 1):
        apart = displacement[quads[:, 3 - k]] - displacement[quads[:, k]]
        assert (apart * normal[own[:, k]]).sum(axis=1) == pytest.approx(frame.opening[own[:, k]], abs=1e-12)
        assert (apart * tangent[own[:, k]]).sum(axis=1) == pytest.approx(frame.slip[own[:, k]], abs=1e-12)
        for name, values in (
            ("opening [m]", frame.opening),
            ("slip [m]", frame.slip),
            ("normal stress [Pa]", frame.normal),
            ("shear stress [Pa]", frame.tangential),
            ("damage", frame.damage),
            ("state", frame.state),
        ):
            assert np.array_equal(of_points[name][quads[:, k]], values[own[:, k]])


def test_joint_shows_state_of_highest_priority() -> None:
    """Open before crushed, then sliding, debonded and sticking."""
    from runningbond.pictures.vtk_grids import GridBuilder

    scene = courses([[1], [1]])
    frame = moved(scene)
    order = [JointState.STICK, JointState.DEBONDED, JointState.SLIDE, JointState.CRUSHED, JointState.OPEN]
    for one in order:
        for other in order:
            state = np.array([one, other] * len(scene.joints))
            shown = Frame(0, frame.motion, frame.opening, frame.slip, frame.normal, frame.tangential, state)
            found = arrays(GridBuilder(Discretisation.of_rigid_blocks(scene)).joints(shown).GetCellData())["state"]
            assert (found == max(one, other, key=order.index)).all()


def test_meshio_reads_same_data(tmp_path: Path) -> None:
    """meshio shares no code with VTK, and reads the same points, cells and data."""
    scene = panel()
    frame = moved(scene)
    TimeSeries(Discretisation.of_rigid_blocks(scene), tmp_path).add(frame)
    mesh = meshio.read(frame_files(tmp_path, "joints")[0])
    assert {block.type: len(block.data) for block in mesh.cells} == {
        "line": len(scene.joints),
        "quad": len(scene.joints),
    }
    assert mesh.point_data["opening [m]"].reshape(-1, 6)[:, :2] == pytest.approx(frame.opening.reshape(-1, 2), abs=0)


@pytest.mark.parametrize("last", [8, 9, 10, 11])
def test_interrupted_series_stays_readable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, last: int) -> None:
    """Each frame is two VTU files and then two PVD files; the third frame is interrupted at each of them."""
    scene = panel()
    series = TimeSeries(Discretisation.of_rigid_blocks(scene), tmp_path)
    written: list[str] = []

    def killed(path: Path, content: bytes) -> None:
        if len(written) == last:
            raise KeyboardInterrupt
        written.append(path.name)
        write_atomically(path, content)

    monkeypatch.setattr("runningbond.pictures.time_series.write_atomically", killed)
    series.add(moved(scene, 0))
    series.add(moved(scene, 1))
    with pytest.raises(KeyboardInterrupt):
        series.add(moved(scene, 2))
    for kind in ("blocks", "joints"):
        found = frame_files(tmp_path, kind)
        assert len(found) == written.count(f"{kind}.pvd")
        for path in found:
            assert read_grid(path).GetNumberOfCells() > 0


def test_series_whose_folder_is_deleted_lists_only_frames_that_are_there(tmp_path: Path) -> None:
    """ParaView refused the series, which listed the frames written before, too."""
    scene, folder = panel(), tmp_path / "out"
    series = TimeSeries(Discretisation.of_rigid_blocks(scene), folder)
    for seed in range(2):
        series.add(moved(scene, seed))
    shutil.rmtree(folder)
    for seed in range(2, 5):
        series.add(moved(scene, seed))
    for kind in ("blocks", "joints"):
        assert [path.name for path in frame_files(folder, kind)] == [f"{kind}-{k:04d}.vtu" for k in (2, 3, 4)]
    assert len(series) == 3


def test_pyvista_reads_all_frames_of_series(tmp_path: Path) -> None:
    """PyVista reads the PVD file like ParaView, and steps through its times."""
    scene = panel()
    series = TimeSeries(Discretisation.of_rigid_blocks(scene), tmp_path)
    frames = [moved(scene, seed) for seed in range(3)]
    for frame in frames:
        series.add(frame)
    open_reader: Any = pyvista.get_reader
    reader = open_reader(tmp_path / "joints.pvd")
    assert reader.time_values == [0.0, 1.0, 2.0]
    for time, frame in zip(reader.time_values, frames, strict=True):
        reader.set_active_time_value(time)
        read = reader.read()[0].point_data["slip [m]"].reshape(-1, 6)[:, :2]
        assert np.array_equal(read.ravel(), frame.slip)


def test_long_series_is_thinned_but_keeps_its_ends(tmp_path: Path) -> None:
    scene = courses([[1]])
    series = TimeSeries(Discretisation.of_rigid_blocks(scene), tmp_path)
    frame = moved(scene)
    for k in range(3 * MAX_FRAMES):
        series.add(Frame(k, frame.motion, frame.opening, frame.slip, frame.normal, frame.tangential, frame.state))
        assert len(series) <= MAX_FRAMES
    loads = [float(arrays(read_grid(path).GetFieldData())["multiplier"][0]) for path in frame_files(tmp_path, "blocks")]
    assert (loads[0], loads[-1]) == (0, 3 * MAX_FRAMES - 1)
    assert loads == sorted(loads)
    assert np.ptp(np.diff(loads)) < np.diff(loads).max()
    on_disk = {path.name for path in (tmp_path / "frames").iterdir()}
    assert on_disk == {path.name for kind in ("blocks", "joints") for path in frame_files(tmp_path, kind)}
    times = [float(entry.attrib["timestep"]) for entry in ET.parse(tmp_path / "blocks.pvd").iter("DataSet")]
    assert times == sorted(set(times))


def test_thinned_series_keeps_ascent_and_largest_load(tmp_path: Path) -> None:
    """Fifteen states up to the peak and a hundred beyond it: frames are thinned evenly by number."""
    scene = courses([[1]])
    series, frame = TimeSeries(Discretisation.of_rigid_blocks(scene), tmp_path), moved(scene)
    curve = [*np.linspace(0, 1, 16), *np.linspace(0.99, 0.5, 100)]
    for load in curve:
        series.add(replace(frame, multiplier=load))
    loads = [float(arrays(read_grid(path).GetFieldData())["multiplier"][0]) for path in frame_files(tmp_path, "blocks")]
    assert max(loads) == 1.0
    assert loads.index(1.0) >= 4


def test_arrays_are_same_in_all_frames(tmp_path: Path) -> None:
    scene = panel(**STIFF)
    outcome = limit(scene)
    record_mechanism(scene, outcome, tmp_path)
    for kind in ("blocks", "joints"):
        layouts = set()
        for path in frame_files(tmp_path, kind):
            grid = read_grid(path)
            data = (grid.GetPointData(), grid.GetCellData(), grid.GetFieldData())
            layouts.add(tuple((n, a.dtype.str, a.shape) for part in data for n, a in sorted(arrays(part).items())))
        assert len(layouts) == 1


def test_vtk_errors_are_raised(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "torn.vtu").write_text("<VTKFile")
    with pytest.raises(VtkError, match="parsing XML"):
        read_grid(tmp_path / "torn.vtu")
    assert capfd.readouterr().err == ""


# Joint states


def test_toppling_block_opens_base_except_at_hinge() -> None:
    """A block twice as high as wide topples at λ = 1/2 with friction 0.6: only one end of its base opens."""
    scene = courses([[1]], width=0.2, height=0.4)
    outcome = limit(scene)
    frame = mechanism_frame(scene, outcome)
    assert frame is not None
    assert outcome.multiplier == pytest.approx(0.5, rel=1e-9)
    assert sorted(frame.state) == [JointState.STICK, JointState.OPEN]
    left = np.argmin(wall_points(scene).position[:, 0])
    assert frame.state[left] == JointState.OPEN
    # Its whole weight acts on the hinge, and at most 0.6 of it as shear.
    assert frame.normal[1 - left] * wall_points(scene).area[1 - left] == pytest.approx(-scene.mass[0] * 9.81, rel=1e-6)


def test_sliding_block_that_dilates_has_state_slide() -> None:
    """A block twice as wide as high slides at λ = 0.6, and associated joints lift it by 0.6 times the slip."""
    scene = courses([[1]], width=0.4, height=0.2)
    frame = mechanism_frame(scene, limit(scene))
    assert frame is not None
    assert (frame.opening > 0.1).all()
    assert (frame.state == JointState.SLIDE).all()


def test_states_under_load_follow_joint_law() -> None:
    """Tension 1e5 Pa on 1e10 Pa/m opens beyond 1e-5 m; sliding follows from cohesion 3e5 Pa and friction 0.6."""
    scene = panel(joint=BRITTLE)
    points = wall_points(scene)
    n = len(points)

    def state(opening: float, normal: float, tangential: float, damage: float) -> JointState:
        each = (np.full(n, x) for x in (opening, normal, tangential, damage))
        found = states_under_load(scene, points, *each)
        assert (found == found[0]).all()
        return JointState(found[0])

    assert state(0.9e-5, 0.9e5, 0.0, 0.0) == JointState.STICK
    assert state(1.1e-5, 1.0e5, 0.0, 0.0) == JointState.OPEN
    assert state(-1e-6, -1e5, 3.5e5, 0.0) == JointState.STICK
    assert state(-1e-6, -1e5, 3.6e5, 0.0) == JointState.SLIDE
    assert state(-1e-6, -1e5, 0.5e5, 1.0) == JointState.DEBONDED
    assert state(-1e-6, -1e5, 0.6e5, 1.0) == JointState.SLIDE
    assert state(1e-7, 0.0, 0.0, 1.0) == JointState.OPEN


CLOSING = {"friction": 0.6, "normal_stiffness": 1e10, "shear_stiffness": 4e9}


def test_joint_is_crushed_from_plastic_closure_at_strength() -> None:
    """Strength 2 MPa at a closure of 10 µm: joints that closed less still harden, and joints that open are open."""
    cap = {"compressive_strength": 2e6, "peak_closure": 1e-5, "compressive_fracture_energy": 1e3}
    scene = courses([[1]], width=0.2, height=0.2, joint={**CLOSING, **cap})
    points, one = wall_points(scene), np.ones(2)
    closed = np.array([0.9e-5, 1.1e-5])
    assert [*states_under_load(scene, points, -2e-4 * one, -2e6 * one, 0 * one, 0 * one, closed)] == [0, 4]
    assert (states_under_load(scene, points, 1e-4 * one, 0 * one, 0 * one, 0 * one, closed) == JointState.OPEN).all()
    sound = courses([[1]], width=0.2, height=0.2, joint=CLOSING)
    assert (states_under_load(sound, points, -2e-4 * one, -2e6 * one, 0 * one, 0 * one, closed) == 0).all()


def test_states_follow_cone_of_user_defined_law() -> None:
    """tan φ = 0.2 in the law, 0.6 in the material: 0.3 of the pressure slides, as does an opening of 0.2 slips."""
    law = replace(COULOMB, name="smooth", cone=lambda _: (0.2, 0.0, 0.0))
    joint = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 4e8, "law": law}
    scene = courses([[1]], width=0.2, height=0.2, joint=joint)
    points = wall_points(scene)
    one = np.ones(len(points))
    assert (states_under_load(scene, points, -1e-6 * one, -one, 0.3 * one, 0 * one) == JointState.SLIDE).all()
    assert (states_under_load(scene, points, -1e-6 * one, -one, 0.1 * one, 0 * one) == JointState.STICK).all()
    assert (states_of_mechanism(scene, points, 0.2 * one, one) == JointState.SLIDE).all()


def test_run_is_recorded_up_to_collapse(tmp_path: Path) -> None:
    """The loads of the series are those of the curve; at the end the wall falls, with open joints."""
    scene = courses([[1], [1]], width=0.2, height=0.2, **STIFF)
    recorder = MotionRecorder(scene, tmp_path)
    outcome = run_model("dem-dynamic", scene, 0.02, recorder)
    recorder.finish(outcome)
    assert outcome.status == "collapse"
    silent = run_model("dem-dynamic", scene, 0.02)
    assert (silent.lower, silent.upper, silent.steps) == (outcome.lower, outcome.upper, outcome.steps)
    grids = [read_grid(path) for path in frame_files(tmp_path, "blocks")]
    loads = np.array([arrays(grid.GetFieldData())["multiplier"][0] for grid in grids])
    assert len(grids) <= MAX_FRAMES
    assert (np.diff(loads) >= 0).all()
    rests, fall = outcome.curve[:-1], loads[loads == outcome.upper]
    assert set(loads) == {*rests[:, 1], outcome.upper}
    assert 1 < len(fall) <= 13
    # At rest, the displacement of the control point is that of the curve.
    block, (at,), (direction,) = scene.control_point
    corner = np.flatnonzero((scene.blocks.vertices == at).all(axis=1) & (scene.blocks.owner == block[0]))[0]
    for multiplier, grid in zip(loads, grids, strict=True):
        if multiplier != outcome.upper:
            shown = arrays(grid.GetPointData())["displacement [m]"][corner, :2] @ direction
            assert shown == pytest.approx(rests[rests[:, 1] == multiplier][0, 0], rel=1e-9, abs=1e-15)
    joints = arrays(read_grid(frame_files(tmp_path, "joints")[-1]).GetPointData())
    assert JointState.OPEN in joints["state"]
    assert np.abs(arrays(grids[-1].GetPointData())["velocity [m/s]"]).max() > 1e-4


def test_fall_of_breaking_wall_is_recorded_below_upper_bound(tmp_path: Path) -> None:
    """The load of the fall is that of the curve's end; the bracket extends beyond by the last step."""
    soft = {**BRITTLE, "cohesion": 2e4, "tensile_strength": 1e4, "fracture_energy_1": 10.0, "fracture_energy_2": 50.0}
    scene = courses([[1], [1]], width=0.2, height=0.2, joint=soft)
    recorder = MotionRecorder(scene, tmp_path)
    outcome = run_model("dem-dynamic", scene, 0.05, recorder)
    recorder.finish(outcome)
    assert outcome.status == "collapse"
    fell = outcome.curve[-1, 1]
    assert outcome.upper is not None
    assert fell < outcome.upper
    grids = [read_grid(path) for path in frame_files(tmp_path, "blocks")]
    loads = np.array([arrays(grid.GetFieldData())["multiplier"][0] for grid in grids])
    assert 1 < (loads == fell).sum() <= 13
    assert loads[-1] == fell
    assert np.abs(arrays(grids[-1].GetPointData())["velocity [m/s]"]).max() > 1e-4


@pytest.mark.parametrize("model", ["dem-static", "dem-dynamic"])
def test_unloaded_joints_neither_slide_nor_open(model: str) -> None:
    """Head joints of rigid blocks under dead load, in which programs leave 1e-12 Pa and 1e-21 m."""
    scene = courses([[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]], 0.4, 0.2, **STIFF)
    recorder: Any = MotionRecorder(scene, None) if model == "dem-dynamic" else StaticRecorder(scene, None)
    recorder.finish(run_model(model, scene, 0.1, recorder))
    rest = recorder.frames[0]
    assert rest.multiplier == 0.0
    assert (rest.state == JointState.STICK).all()


def test_static_states_are_recorded_in_equilibrium(tmp_path: Path) -> None:
    """The loads and displacements of the series are those of the curve.

    In each state, the tractions on the base sum to the wall's weight and to the live load.
    """
    scene = courses([[1], [1]], width=0.2, height=0.2, **STIFF)
    recorder = StaticRecorder(scene, tmp_path)
    outcome = run_model("dem-static", scene, 0.02, recorder)
    recorder.finish(outcome)
    assert outcome.status == "collapse"
    silent = run_model("dem-static", scene, 0.02)
    assert np.array_equal(silent.curve, outcome.curve)
    blocks = [read_grid(path) for path in frame_files(tmp_path, "blocks")]
    joints = [read_grid(path) for path in frame_files(tmp_path, "joints")]
    block, (at,), (direction,) = scene.control_point
    corner = np.flatnonzero((scene.blocks.vertices == at).all(axis=1) & (scene.blocks.owner == block[0]))[0]
    shown = [
        (
            float(arrays(grid.GetPointData())["displacement [m]"][corner, :2] @ direction),
            float(arrays(grid.GetFieldData())["multiplier"][0]),
        )
        for grid in blocks
    ]
    shown = [(place - shown[0][0], load) for place, load in shown]
    for row in shown:
        assert np.abs(outcome.curve - row).max(axis=1).min() < 1e-12
    points = wall_points(scene)
    base = np.flatnonzero((points.block == len(scene.blocks) - 1).any(axis=1))
    weight = float(scene.mass[scene.wall].sum()) * 9.81
    for (_, load), grid in zip(shown, joints, strict=True):
        data = arrays(grid.GetPointData())
        ends = 6 * (base // 2) + base % 2
        force = np.array([data["normal stress [Pa]"][ends], data["shear stress [Pa]"][ends]]) @ points.area[base]
        assert np.abs(force) == pytest.approx([weight, load * weight], rel=1e-6, abs=1e-6 * weight)


@pytest.mark.parametrize("modes", [6, 10, "all"])
def test_uniform_strain_has_hookes_stress(modes: ModeCount) -> None:
    """In every block, in addition to other motions; on a mesh whose nodes distinguish its modes."""
    scene = panel(block__young=2e9, block__poisson=0.25, **STIFF)
    wall = modal_wall(scene, 2, modes)
    gradient = np.array([[3e-5, 1e-5], [2e-5, -4e-5]])  # of u_i along x_j
    motion = np.zeros(len(wall.mass))
    for template, into in zip(wall.templates, wall.split(motion), strict=True):
        for column, block in enumerate(template.blocks):
            u = wall.mesh.points[wall.mesh.block == block] @ gradient.T
            into[:, column] = np.linalg.lstsq(template.modes.shape, u.ravel())[0]
    moved = ~scene.fixed[wall.mesh.triangle_block]
    plane = 2e9 / (1 - 0.25**2)
    exact = plane * (3e-5 - 0.25 * 4e-5), plane * (-4e-5 + 0.25 * 3e-5), 2e9 / 2.5 * 3e-5
    found = stresses(wall, motion)
    assert found[moved] == pytest.approx(np.broadcast_to(np.array(exact), found[moved].shape), rel=1e-9)
    assert not found[~moved].any()


@pytest.mark.parametrize("settings", [{"cells": 2, "modes": "all"}, {"cracks": "blocks"}])
def test_run_is_recorded_on_mesh_of_its_settings(settings: dict[str, Any], tmp_path: Path) -> None:
    """For non-default settings, with two cells; at rest, the mean vertical stress is that at half the height."""
    inner = {"friction": 0.6, "cohesion": 1e6, "normal_stiffness": 1e11, "shear_stiffness": 4e10}
    crack = {"inner_joint": inner} if "cracks" in settings else {}
    scene = panel(wall__length=0.48, wall__height=0.12, block__young=1e9, **STIFF, **crack)
    recorder = MotionRecorder(scene, tmp_path)
    outcome = run_model("fem", scene, 0.3, recorder, **settings)
    recorder.finish(outcome)
    wall = modal_wall(scene, 2, settings.get("modes"), cracks=settings.get("cracks", "joints"))
    grids = [read_grid(path) for path in frame_files(tmp_path, "blocks")]
    assert {grid.GetNumberOfCells() for grid in grids} == {len(wall.mesh.triangles)}
    corners = wall.mesh.points[wall.mesh.triangles]
    (x1, y1), (x2, y2) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    area = np.where(wall.scene.fixed[wall.mesh.triangle_block], 0.0, np.abs(x1 * y2 - x2 * y1))
    stress = arrays(grids[0].GetCellData())["stress [Pa]"]
    assert arrays(grids[0].GetFieldData())["multiplier"] == 0
    assert area @ stress[:, 1] / area.sum() == pytest.approx(-1800 * 9.81 * 0.12 / 2, rel=1e-4)


def test_deformable_blocks_are_recorded_as_triangles_with_stress(tmp_path: Path) -> None:
    """A wall at rest under its weight: the mean vertical stress of a course is the weight above its middle."""
    scene = panel(wall__length=0.48, wall__height=0.18, block__young=1e9, **STIFF)
    recorder = MotionRecorder(scene, tmp_path)
    outcome = run_model("fem", scene, 0.1, recorder)
    recorder.finish(outcome)
    grids = [read_grid(path) for path in frame_files(tmp_path, "blocks")]
    assert {grids[0].GetCellType(i) for i in range(grids[0].GetNumberOfCells())} == {5}
    cells = arrays(grids[0].GetCellData())
    assert len(cells["block"]) == len(modal_wall(scene).mesh.triangles)
    for course, above in enumerate((0.15, 0.09, 0.03)):
        vertical = cells["stress [Pa]"][cells["course"] == course, 1].mean()
        assert vertical == pytest.approx(-1800 * 9.81 * above, rel=1e-4)
    assert arrays(grids[-1].GetFieldData())["multiplier"] == outcome.upper
    # The faces of joints lie on the sides of triangles, up to the deformation of a block.
    joints = read_grid(frame_files(tmp_path, "joints")[-1])
    quads = 6 * np.arange(joints.GetNumberOfPoints() // 6)[:, None] + np.arange(2, 6)
    faces = (points_of(joints) + arrays(joints.GetPointData())["displacement [m]"])[quads.ravel(), :2]
    nodes = (points_of(grids[-1]) + arrays(grids[-1].GetPointData())["displacement [m]"])[:, :2]
    nearest = np.hypot(*(faces[:, None] - nodes[None]).transpose(2, 0, 1)).min(axis=1)
    largest = np.abs(arrays(grids[-1].GetPointData())["displacement [m]"]).max()
    assert nearest.max() < 0.05 * largest
