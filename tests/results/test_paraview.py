"""Files for ParaView: times, tensors, vectors, the ground near the wall, and the macro."""

import runpy
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any
from unittest.mock import MagicMock

import numpy as np
import pytest
import pyvista

from runningbond.joints import wall_points
from runningbond.limit import limit
from runningbond.models import find_model, respond, run_model
from runningbond.pictures.frame import Discretisation, Frame, Triangles
from runningbond.pictures.mechanism import mechanism_shape
from runningbond.pictures.recording import ResponseRecorder, motion_recorder, record_mechanism
from runningbond.pictures.style import DRAWN
from runningbond.pictures.time_series import MACRO, frame_files, times_shown
from runningbond.pictures.vtk_grids import DISPLACEMENT, GridBuilder
from runningbond.results import Outcome
from runningbond.results.mechanism import turned
from runningbond.results.store import load_outcome, save_outcome
from runningbond.scene import Scene, scene_from_dict
from tests.at_length import at_length
from tests.scene.test_corner_contacts import leaning
from tests.walls import courses, panel

STIFF = {"friction": 0.7, "normal_stiffness": 1e8, "shear_stiffness": 1e8}


@pytest.mark.parametrize(
    ("frames", "shown"),
    [
        ([(None, 0.0), (None, 0.2), (None, 0.5)], [0.0, 0.2, 0.5]),
        ([(None, 0.0), (None, 0.5), (None, 0.5), (None, 0.5)], [0.0, 0.5, 0.5 + 5e-7, 0.5 + 1e-6]),
        ([(None, 0.3), (None, 0.3)], [0.0, 1.0]),
        ([(None, 0.0), (None, 0.5), (None, 0.4)], [0.0, 1.0, 2.0]),
        ([(0.0, 1.5), (0.1, 1.5), (0.4, 1.5)], [0.0, 0.1, 0.4]),
        ([], []),
    ],
)
def test_frame_times_are_seconds_or_increasing_loads(frames: Any, shown: list[float]) -> None:
    assert times_shown(frames) == pytest.approx(shown, abs=1e-12)


def tower() -> Scene:
    """Two blocks of 0.5 × 0.5 m on ground that moves by half a sine."""
    size = {"courses": [[1], [1]], "block_width": 0.5, "block_height": 0.5, "thickness": 0.3}
    pulse = {"pulse": {"kind": "half-sine", "amplitude": 1.0, "period": 1.0}, "quantity": "g"}
    return scene_from_dict(
        {
            "title": "tower",
            "wall": size,
            "block": {"density": 2000.0, "young": 1e11},
            "joint": STIFF,
            "support": {"kind": "base"},
            "load": {"gravity": 9.81, "history": pulse},
        }
    )


def test_fall_at_critical_scale_is_recorded_in_seconds(tmp_path: Path) -> None:
    """The tower turns about its toe, against the ground's acceleration; of all scales tried only the upper is kept."""
    scene = tower()
    recorder = motion_recorder(scene, tmp_path)
    outcome = run_model("dem-dynamic", scene, 0.3, recorder)
    recorder.finish(outcome)
    read: Any = pyvista.get_reader
    series = read(tmp_path / "blocks.pvd")
    times = np.array(series.time_values)
    assert times[0] == 0.0
    assert (np.diff(times) > 0).all()
    assert times[-1] > scene.history.duration if scene.history else False
    for time in times:
        series.set_active_time_value(time)
        grid = series.read()[0]
        assert grid.field_data["time [s]"][0] == time
        assert grid.field_data["multiplier"][0] == outcome.upper
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    assert outcome.motion[:2, 2] == pytest.approx(outcome.motion[0, 2], rel=0.02)
    assert outcome.motion[0, 2] > 0.5
    toe = np.hypot(*shape.displacement.T)[(shape.points == 0.0).all(axis=1)]
    assert toe == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("model", ["dem-dynamic", "fem"])
def test_fall_under_dead_load_is_recorded(model: str, tmp_path: Path) -> None:
    """Two blocks over an opening without a lintel are unsupported: they fall, and the blocks around them stay."""
    scene = courses([[1, -2, 1], [1, 1, 1, 1]], joint=STIFF, block={"density": 2000.0, "young": 1e10})
    recorder = motion_recorder(scene, tmp_path)
    outcome = run_model(model, scene, 0.1, recorder)
    assert outcome.status == "infeasible"
    save_outcome(outcome, tmp_path)
    recorder.finish(outcome)
    assert load_outcome(tmp_path)[0].status == "infeasible"  # frames written later belong to it
    hanging = np.isin(np.arange(len(scene.blocks)), [3, 4])
    assert outcome.motion[hanging, 1] == pytest.approx(-1.0, abs=0.01)
    assert np.abs(outcome.motion[~hanging]).max() < 0.01
    assert mechanism_shape(scene, outcome) is not None
    grids: list[Any] = [pyvista.read(file) for file in frame_files(tmp_path, "blocks")]
    assert {float(grid.field_data["multiplier"][0]) for grid in grids} == {0.0}
    fallen = [float(np.asarray(grid.point_data[DISPLACEMENT])[:, 1].min()) for grid in grids]
    assert fallen == sorted(fallen, reverse=True)
    assert fallen[-1] < -0.05 * 0.175  # the displacement that counts as a collapse


def test_only_fall_under_slow_dead_load_is_recorded(tmp_path: Path) -> None:
    """The dead load on a glued block is applied at once, then slowly: only the second fall is recorded."""
    glue = {"cohesion": 15e3, "tensile_strength": 15e3}
    scene = courses([[1, -1], [1, 1]], joint=STIFF | glue, block={"density": 2000.0})
    recorder = motion_recorder(scene, tmp_path)
    outcome = run_model("dem-dynamic", scene, 0.1, recorder)
    recorder.finish(outcome)
    assert outcome.status == "infeasible"
    grids: list[Any] = [pyvista.read(file) for file in frame_files(tmp_path, "blocks")]
    fallen = [float(np.asarray(grid.point_data[DISPLACEMENT])[:, 1].min()) for grid in grids]
    assert len(fallen) > 1
    assert fallen == sorted(fallen, reverse=True)


@pytest.mark.parametrize("model", ["dem-dynamic", "fem"])
def test_toppling_blocks_keep_their_shape(model: str) -> None:
    """Sides of rotated blocks keep their length, and the top is where the response has it."""
    scene = tower()
    recorder = ResponseRecorder(scene, None)
    response = respond(model, scene, 2.0, observe=recorder, rows=2000, after=0.3)
    recorder.finish(Outcome(scene.title, model, "undecided", upper=2.0))
    frame = recorder.frames[-1]
    assert frame.time is not None
    assert np.abs(frame.motion[:, 2]).min(initial=1.0, where=~scene.fixed) > 0.3
    grid = GridBuilder(recorder.discretisation).blocks(frame)
    rest, moved = (np.asarray(values)[:, :2] for values in (grid.points, grid.point_data[DISPLACEMENT]))
    for cell in np.flatnonzero(np.asarray(grid.cell_data["held"]) == 0):
        corner = grid.get_cell(cell).point_ids
        before, after = (np.hypot(*(at[corner] - at[np.roll(corner, 1)]).T) for at in (rest, rest + moved))
        assert after == pytest.approx(before, rel=1e-4)
    for point, way in zip(response.points, response.displacement.transpose(1, 2, 0), strict=True):
        here = moved[np.hypot(*(rest - point).T) < 1e-9]
        assert here[0] == pytest.approx([np.interp(frame.time, response.time, each) for each in way], abs=2e-3)


@pytest.mark.parametrize("model", ["dem-dynamic", "fem"])
def test_jumps_are_relative_displacements_at_large_rotation(model: str) -> None:
    """For a tower up to its fall, in space and along a normal that turns with block a, to 10 µm."""
    scene = tower()
    recorder = ResponseRecorder(scene, None)
    respond(model, scene, 2.0, observe=recorder, rows=2000, after=0.3)
    recorder.finish(Outcome(scene.title, model, "undecided", upper=2.0))
    points, frames = recorder.discretisation.points, recorder.frames
    assert np.abs(frames[0].slip).max() < 1e-6
    assert np.abs(frames[-1].motion[:, 2]).min(initial=1.0, where=~scene.fixed) > 0.3
    for frame in frames:
        a, b = (turned(scene.blocks, side, points.position, frame.motion) for side in points.block.T)
        spin = frame.motion[points.block[:, 0], 2]
        normal = np.column_stack([-np.sin(spin), np.cos(spin)]) * points.normal[:, 1:]  # all joints are beds
        assert frame.opening == pytest.approx(((b - a) * normal).sum(axis=1), abs=1e-5)
        grid = GridBuilder(recorder.discretisation).joints(frame)
        place, shown, along = (
            np.asarray(each)[:, :2] for each in (grid.points, grid.point_data["jump [m]"], grid.point_data["normal"])
        )
        assert (shown * along).sum(axis=1) == pytest.approx(np.asarray(grid.point_data["opening [m]"]), abs=1e-12)
        for at, jump in zip(points.position, b - a, strict=True):
            assert np.abs(shown[(place == at).all(axis=1)] - jump).max() < 1e-5


@pytest.mark.parametrize("displacements", ["small", "finite"])
def test_sides_of_joints_lie_on_faces_of_deformed_blocks(displacements: str) -> None:
    """Soft blocks shorten by .1 mm under their weight: corners of quadrilaterals go where the blocks' corners go."""
    scene = courses([[1], [1], [1]], joint=STIFF, block={"density": 2000.0, "young": 1e7, "poisson": 0.2})
    recorder = motion_recorder(scene, None)
    run_model("fem", scene, 0.3, recorder, displacements=displacements)
    grids, frame = GridBuilder(recorder.discretisation), recorder.frames[0]
    blocks, joints = grids.blocks(frame), grids.joints(frame)
    place, moved = (np.asarray(values)[:, :2] for values in (blocks.points, blocks.point_data[DISPLACEMENT]))
    assert np.abs(moved).max() > 1e-4
    quads = joints.cells_dict[9]
    for quad, joint in zip(quads, joints.cell_data["joint"][-len(quads) :], strict=True):
        for side, block in zip((quad[:2], quad[2:]), scene.joints.block[joint], strict=True):
            nodes = np.unique(blocks.cells_dict[5][blocks.cell_data["block"] == block])
            for at, way in zip(joints.points[side, :2], joints.point_data[DISPLACEMENT][side, :2], strict=True):
                here = nodes[np.hypot(*(place[nodes] - at).T) < 1e-9]
                assert np.abs(moved[here] - way).max(initial=0.0) < 1e-12
                assert len(here) or scene.fixed[block]  # the ground has no nodes under the wall


def test_shape_of_fall_has_visible_size() -> None:
    """Its farthest corner has moved by nearly a tenth of the wall's size, whatever the final displacement."""
    scene = tower()
    response = respond("dem-dynamic", scene, 2.0, rows=200)
    assert response.verdict == "collapse"
    assert abs(response.motion[:2, 2]).max() > 0.5
    farthest = np.hypot(*(response.shape[1, :2] + response.shape[1, 2] * np.array([-0.25, 0.25])))
    assert 0.07 < farthest / np.sqrt(0.5) < 0.1


def test_stresses_are_tensors_with_principal_stresses() -> None:
    scene = panel()
    stress = np.random.default_rng(0).normal(size=(4, 3))
    triangles = Triangles(np.eye(3)[:, :2], np.tile([0, 1, 2], (4, 1)), np.zeros(4, dtype=np.int64))
    points = wall_points(scene)
    none = np.zeros(len(points))
    motion = np.zeros((len(scene.blocks), 3))
    frame = Frame(0.0, motion, none, none, none, none, none.astype(int), displacement=np.zeros((3, 2)), stress=stress)
    data = GridBuilder(Discretisation(scene, points, triangles)).blocks(frame).cell_data
    xx, yy, zz, xy, yz, xz = np.array(data["stress [Pa]"]).T
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]).transpose(2, 0, 1)
    assert np.array_equal(tensor[:, [0, 1, 0], [0, 1, 1]], stress)
    ends = [data[f"{which} principal stress [Pa]"] for which in ("smallest", "largest")]
    assert np.transpose(ends) == pytest.approx(np.linalg.eigvalsh(tensor[:, :2, :2]))


def test_tractions_and_jumps_are_vectors(tmp_path: Path) -> None:
    """For a mechanism of limit analysis, checked against their normal and tangential components."""
    scene = panel()
    outcome = limit(scene)
    record_mechanism(scene, outcome, tmp_path)
    data = pyvista.read(frame_files(tmp_path, "joints")[-1]).point_data
    normal = np.asarray(data["normal"])
    assert np.hypot(*normal.T[:2]) == pytest.approx(1.0)
    for vector, along, across in (
        ("jump [m]", "opening [m]", "slip [m]"),
        ("traction [Pa]", "normal stress [Pa]", "shear stress [Pa]"),
    ):
        values = np.asarray(data[vector])
        tangential = -values[:, 0] * normal[:, 1] + values[:, 1] * normal[:, 0]
        assert (values * normal).sum(axis=1) == pytest.approx(np.asarray(data[along]), abs=1e-9)
        assert tangential == pytest.approx(np.asarray(data[across]), abs=1e-9)
        assert abs(values).max() > 0


@pytest.mark.parametrize(
    ("model", "joint"),
    [("limit", {"inset": 0.03}), ("dem-static", {"inset": 0.03}), ("dem-dynamic", {"compressive_strength": 1e6})],
)
def test_recorded_joint_forces_balance_blocks(model: str, joint: dict[str, float], tmp_path: Path) -> None:
    """Against weight and live load, moments included, under the largest load at rest, at which pressures are uneven.

    Tractions on mid-lines do not: with an inset these are shorter than joints, and nine points are not evenly spaced.
    """
    check_balance(courses([[1, 1], [0.5, 1, 0.5], [1, 1]], joint=STIFF | joint), model, tmp_path)


@pytest.mark.parametrize("model", ["limit", *at_length("dem-static", "dem-dynamic", "fem")])
def test_recorded_forces_at_corners_balance_blocks(model: str, tmp_path: Path) -> None:
    """A block in a notch, and a stone whose tip bears on it."""
    check_balance(leaning(), model, tmp_path)


def check_balance(scene: Scene, model: str, tmp_path: Path) -> None:
    observer = find_model(model).observer
    recorder = observer(scene, tmp_path) if observer else None
    outcome = run_model(model, scene, 0.05, recorder)
    if recorder is None:
        record_mechanism(scene, outcome, tmp_path)
    grids: list[Any] = [pyvista.read(file) for file in frame_files(tmp_path, "joints")]
    loads = [float(grid.field_data["multiplier"][0]) for grid in grids]
    borne = (outcome.lower or 0.0) * (1 + 1e-9)  # `limit` writes the multiplier, which rounding raises above the bound
    at = max((k for k, load in enumerate(loads) if load <= borne), key=loads.__getitem__)
    load, grid = loads[at], grids[at]
    lines = grid.cells_dict[3]
    sides = scene.joints.block[np.asarray(grid.cell_data["joint"])[: len(lines)]]
    force = np.asarray(grid.point_data["force [N]"])
    assert not np.delete(force, lines.ravel(), axis=0).any()
    x, y, _ = (np.asarray(grid.points)[lines.ravel()] - [0.3, 0.1, 0.0]).T
    fx, fy, _ = force[lines.ravel()].T
    pulls = np.column_stack([fx, fy, x * fy - y * fx])
    held = np.zeros((len(scene.blocks), 3))
    for side, sign in enumerate((1.0, -1.0)):
        np.add.at(held, np.repeat(sides[:, side], 2), sign * pulls)
    weight, (x, y) = 9.81 * scene.mass, (scene.blocks.centroid - [0.3, 0.1]).T
    held += weight[:, None] * np.column_stack([np.full_like(x, load), -np.ones_like(x), -x - load * y])
    assert np.abs(held[~scene.fixed]).max() < 1e-4 * weight[~scene.fixed].sum()


@pytest.mark.parametrize(
    ("model", "joint"),
    [
        ("dem-dynamic", {"compressive_strength": 1e8, "inset": 0.003}),
        *at_length(("dem-dynamic", {}), ("fem", {})),
    ],
)
def test_recorded_forces_balance_a_block_that_slides_onto_another(model: str, joint: dict[str, float]) -> None:
    """Far enough for half of its weight, at each moment; the contact made on the way is where the other block is."""
    push = {"kind": "point", "at": [0.0, 0.2], "force": [1.0, 0.0]}
    changes: dict[str, Any] = {"block": {"density": 2000.0, "young": 1e10, "poisson": 0.2}, "load__live": push}
    own = STIFF | {"friction": 0.3} | joint
    scene = courses([[1, 1], [1, -1]], joint=own, support__kind="fixed-first-course", **changes)
    recorder = motion_recorder(scene, None)
    run_model(model, scene, 0.05, recorder, displacements="finite", distance=0.25)
    weight, above = 9.81 * scene.mass[2], 2
    for frame in recorder.frames:
        grid = GridBuilder(recorder.discretisation).joints(frame)
        lines, met = grid.cells_dict[3], grid.cells_dict.get(1, np.zeros((0, 1), dtype=int))
        force, sides = np.asarray(grid["force [N]"]), np.column_stack([grid["block a"], grid["block b"]])
        pulls = np.concatenate([force[lines].sum(axis=1), force[met[:, 0]]])
        sides = np.concatenate([sides[: len(lines)], sides[len(sides) - len(met) :]])
        held = pulls[sides[:, 0] == above].sum(axis=0) - pulls[sides[:, 1] == above].sum(axis=0)
        assert held + [frame.multiplier, -weight, 0.0] == pytest.approx(np.zeros(3), abs=0.02 * weight)
    on_next = (sides[len(lines) :] == 1).any(axis=1)
    assert np.abs(force[met[on_next, 0]]).sum(axis=0)[1] > 0.4 * weight
    x, y, _ = (np.asarray(grid.points) + grid[DISPLACEMENT])[met[on_next, 0]].T
    assert y == pytest.approx(0.175, abs=0.01)
    assert ((x > 0.4 - 1e-3) & (x < 0.66)).all()


@pytest.mark.parametrize("support", ["base", "fixed-first-course"])
def test_ground_is_shown_only_near_wall(support: str) -> None:
    scene = panel(support__kind=support)
    points = wall_points(scene)
    none, motion = np.zeros(len(points)), np.zeros((len(scene.blocks), 3))
    frame = Frame(0.0, motion, none, none, none, none, none.astype(int))
    builder = GridBuilder(Discretisation.of_rigid_blocks(scene))
    left, right, bottom, top, *_ = builder.blocks(frame).bounds
    low, high = scene.blocks.extent(scene.wall)
    air = 0.16 * np.sqrt(np.prod(high - low))
    assert left >= low[0] - air
    assert right <= high[0] + air
    assert bottom >= low[1] - air
    assert top == high[1]
    assert builder.joints(frame).bounds[0] >= low[0]


@pytest.mark.parametrize("folder", ["run", "two words 'n \\ slash"])
def test_macro_opens_series_in_its_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, folder: str) -> None:
    """Without ParaView: the calls of the macro are recorded, and the arrays that it names exist in the files."""
    scene = courses([[1], [1]], width=0.2, height=0.4)
    out = tmp_path / folder
    record_mechanism(scene, limit(scene), out)
    simple, paraview = MagicMock(), ModuleType("paraview")
    monkeypatch.setattr(paraview, "simple", simple, raising=False)
    monkeypatch.setitem(sys.modules, "paraview", paraview)
    text = (out / MACRO).read_text(encoding="utf-8")
    elsewhere = tmp_path / "macros" / MACRO
    elsewhere.parent.mkdir()
    elsewhere.write_text(text, encoding="utf-8")
    for macro in (out / MACRO, elsewhere):
        simple.reset_mock()
        names = runpy.run_path(str(macro))
        opened = [Path(call.kwargs["FileName"]) for call in simple.PVDReader.call_args_list]
        assert [path.name for path in opened] == ["blocks.pvd", "joints.pvd"]
        assert all(path.is_file() for path in opened)
        assert simple.WarpByVector.return_value.Vectors == ["POINTS", DISPLACEMENT]
        asked = {call.args[1] for call in simple.ColorBy.call_args_list}
        assert asked == {("POINTS", DISPLACEMENT, "Magnitude"), ("CELLS", "state"), None}
        assert len(names["states"].Annotations) == 2 * len(names["STATES"]) == 10
        assert len(names["states"].IndexedColors) == 15
        assert simple.AnnotateTime.return_value.Format == "moment = {time:.5g}"
    last = [pyvista.read(frame_files(out, kind)[-1]) for kind in ("blocks", "joints")]
    assert all(DISPLACEMENT in grid.point_data for grid in last)
    assert "state" in last[1].cell_data
    farthest = np.hypot(*np.asarray(last[0].point_data[DISPLACEMENT]).T[:2]).max()
    assert names["FARTHEST"] == pytest.approx(farthest)
    assert names["SCALE"] * farthest == pytest.approx(DRAWN * np.sqrt(0.2 * 0.8))


def test_new_series_deletes_old_macro(tmp_path: Path) -> None:
    scene = courses([[1], [1]], width=0.2, height=0.4)
    outcome = limit(scene)
    record_mechanism(scene, outcome, tmp_path)
    assert (tmp_path / MACRO).is_file()
    record_mechanism(scene, replace(outcome, motion=np.zeros((0, 3))), tmp_path)
    assert not list(tmp_path.glob("*.p*"))
