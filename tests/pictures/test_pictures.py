"""Off-screen pictures match the arrays, and a machine that cannot draw reports this in one line."""

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from runningbond.commands.command_line import command
from runningbond.joints import wall_points
from runningbond.limit import limit
from runningbond.pictures.captions import is_force, multiplier_text, to_png
from runningbond.pictures.deformed_shape import DeformedShape, Extent, outline, undeformed_shape
from runningbond.pictures.joint_state import JointState, joint_states
from runningbond.pictures.mechanism import mechanism_frame, mechanism_shape
from runningbond.pictures.offscreen import PROBE, why_not_drawn
from runningbond.pictures.pyvista_figure import frame_figure, mechanism_figure
from runningbond.pictures.pyvista_painter import Painter, square_around
from runningbond.pictures.render import render_folder
from runningbond.pictures.style import AT_REST, FASTEST, HELD, STATE_COLOURS
from runningbond.pictures.vtk_safety import uninterrupted_imports, vtk_errors_raised
from runningbond.results import Outcome, load_outcome, save_outcome
from runningbond.results.mechanism import carried
from runningbond.results.outcome import number
from runningbond.scene import Scene
from tests.at_length import at_length
from tests.walls import content, courses, panel, write_toml


@pytest.fixture(autouse=True)
def vtk_errors_fail_test() -> Iterator[None]:
    """Fail the test on errors reported by VTK."""
    with vtk_errors_raised():
        yield


NO_DRIVER = {"__EGL_VENDOR_LIBRARY_DIRS": "/nonexistent", "DISPLAY": "", "WAYLAND_DISPLAY": ""}
"""Environment in which no driver for off-screen drawing is found."""

drawing = pytest.mark.usefixtures("able_to_draw")


@pytest.fixture(scope="module")
def able_to_draw() -> None:
    if why_not_drawn():
        pytest.skip(why_not_drawn())


@pytest.fixture(scope="module")
def painter(able_to_draw: None) -> Iterator[Painter]:
    painter = Painter(600)
    yield painter
    painter.close()


def paint(painter: Painter, shape: DeformedShape) -> tuple[Any, Extent]:
    return painter.paint(shape, shape.extent).astype(int), square_around(shape.extent)


def pixel(extent: Extent, image: Any, at: Any) -> tuple[Any, Any]:
    """Row and column of points ``(n, 2)`` [m]."""
    left, right, bottom, top = extent
    x, y = np.asarray(at).T
    column = (x - left) / (right - left) * image.shape[1]
    row = (top - y) / (top - bottom) * image.shape[0]
    return np.clip(row.astype(int), 0, image.shape[0] - 1), np.clip(column.astype(int), 0, image.shape[1] - 1)


def of_colour(image: Any, colour: Any, within: int = 12) -> Any:
    """Mask of pixels with a colour, given as ``#rrggbb`` or as shares of 1."""
    wanted = [int(colour[i : i + 2], 16) for i in (1, 3, 5)] if isinstance(colour, str) else 255 * np.asarray(colour)
    return (np.abs(image - np.asarray(wanted)) <= within).all(axis=-1)


def mechanism(scene: Scene, outcome: Outcome) -> DeformedShape:
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    return shape


@drawing
def test_undeformed_wall_fills_its_outline(painter: Painter) -> None:
    """Blocks from edge to edge of the wall, white around it, and no coloured joint."""
    scene = panel()
    image, extent = paint(painter, undeformed_shape(scene))
    coloured = (image < 250).any(axis=-1)
    rows, columns = np.flatnonzero(coloured.any(axis=1)), np.flatnonzero(coloured.any(axis=0))
    corner_rows, corner_columns = pixel(extent, image, np.array(scene.blocks.extent(scene.wall)))
    assert [rows.max(), rows.min()] == pytest.approx(corner_rows, abs=2)
    assert [columns.min(), columns.max()] == pytest.approx(corner_columns, abs=2)
    inside = image[rows.min() + 1 : rows.max(), columns.min() + 1 : columns.max()]
    assert (inside < 250).any(axis=-1).all()
    assert of_colour(inside, AT_REST).mean() > 0.7
    for colour in STATE_COLOURS.values():
        assert not of_colour(image, colour, 40).any()


@drawing
@pytest.mark.parametrize("aside", [0.0, 0.0005, 0.0006, 0.0007, 0.002])
def test_joints_are_visible_at_any_pixel_offset(painter: Painter, aside: float) -> None:
    """Head joints of a wall shifted by fractions of a pixel, 4.6 mm: VTK drops too thin lines at some offsets."""
    scene = courses([[1] * 5, [0.5, 1, 1, 1, 1, 0.5]], width=0.4, height=0.2)
    left, right = aside - 0.07774, aside + 2.66909
    extent = square_around((left, right, left, aside + 1.81441))
    image = painter.paint(undeformed_shape(scene), extent).astype(int)
    places = [*((0.4 * k, 0.1) for k in range(1, 5)), *((0.4 * k - 0.2, 0.3) for k in range(1, 6))]
    for row, column in zip(*pixel(extent, image, places), strict=True):
        assert image[row, column - 2 : column + 3, 0].min() < 220
    assert image[pixel(extent, image, np.array(places) + [0.1, 0.0])][:, 0].min() > 230


@drawing
def test_openings_in_blocks_stay_white(painter: Painter) -> None:
    """A block over a door, L-shaped at its corners, and one that encloses an opening."""
    scene = panel(
        wall__block_width=0.5,
        wall__block_height=0.2,
        wall__length=3.0,
        wall__height=1.2,
        wall__opening=[{"from": [0.8, 0.0], "to": [1.8, 0.9]}, {"from": [2.4, 0.6], "to": [2.6, 0.7]}],
    )
    image, extent = paint(painter, undeformed_shape(scene))
    white, wall = [(1.3, 0.85), (0.85, 0.85), (2.5, 0.65)], [(0.77, 0.85), (0.8, 0.95), (2.32, 0.65), (2.5, 0.75)]
    assert (image[pixel(extent, image, white)] > 250).all()
    assert of_colour(image[pixel(extent, image, wall)], AT_REST).all()


@drawing
def test_joint_states_are_drawn_at_their_joints(painter: Painter) -> None:
    """The colour of a state appears only near joints in that state, and near both faces of every open joint."""
    scene = courses([[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]], width=0.4, height=0.2)
    outcome = limit(scene)
    frame = mechanism_frame(scene, outcome)
    assert frame is not None
    shape = mechanism(scene, outcome)
    image, extent = paint(painter, shape)
    points = wall_points(scene)
    drawn = joint_states(frame.state.reshape(-1, 2))
    assert {JointState.OPEN, JointState.SLIDE} & set(drawn)
    for state in (JointState.OPEN, JointState.SLIDE):
        there = of_colour(image, STATE_COLOURS[state], 25)
        assert there.any() == (state in drawn)
        near = np.zeros_like(there)
        for joint in np.flatnonzero(drawn == state):
            for side in scene.joints.block[joint]:
                ends = scene.joints.ends[joint]
                face = ends + shape.scale * carried(scene.blocks, np.array([side, side]), ends, frame.motion)
                along = face[0] + np.linspace(0, 1, 200)[:, None] * (face[1] - face[0])
                row, column = pixel(extent, image, along)
                middle_row, middle_column = row[100], column[100]
                window = there[middle_row - 3 : middle_row + 4, middle_column - 3 : middle_column + 4]
                if state == JointState.OPEN:  # where faces cross, its colour covers that of a sliding joint
                    assert window.any()
                for r, c in zip(row, column, strict=True):
                    near[max(r - 4, 0) : r + 5, max(c - 4, 0) : c + 5] = True
        assert not (there & ~near).any()
    assert len(points) == 2 * len(scene.joints)


@drawing
def test_blocks_have_colour_of_their_motion(painter: Painter) -> None:
    """The upper of two blocks slides off: it alone moves, has the colour of the fastest, and is drawn displaced."""
    scene = courses([[1], [1]], width=0.4, height=0.1, joint__cohesion=0.0)
    motion = np.zeros((3, 3))
    upper = int(np.argmax(scene.blocks.centroid[:, 1]))
    motion[upper, 0] = 1.0
    shape = mechanism(scene, Outcome("two blocks", "limit", "collapse", 0.6, motion=motion))
    image, extent = paint(painter, shape)
    centre = scene.blocks.centroid + shape.scale * motion[:, :2]
    lower = int(np.flatnonzero(scene.wall & (np.arange(3) != upper))[0])
    rows, columns = pixel(extent, image, centre[[upper, lower]])
    colours = image[rows, columns]
    assert np.abs(colours - 255 * np.array([FASTEST, AT_REST])).max() < 2
    left_behind = scene.blocks.vertices[scene.blocks.first[upper]] + [0.3 * shape.scale, 0.05]
    row, column = pixel(extent, image, left_behind[None])
    assert (image[row[0], column[0]] > 250).all()


@drawing
def test_held_blocks_are_grey_and_courses_alternate(painter: Painter) -> None:
    scene = panel(support__kind="fixed-first-course")
    shape = undeformed_shape(scene)
    image, extent = paint(painter, replace(shape, colouring="course"))
    middle = np.array([[0.6, 0.03], [0.66, 0.09], [0.6, 0.15], [0.66, 0.21]]) + [0.05, 0.01]
    rows, columns = pixel(extent, image, middle)
    first, second, third, fourth = image[rows, columns]
    assert np.abs(first - 255 * np.array(HELD)).max() < 2
    assert (second == fourth).all()
    assert np.abs(second - third).max() > 10


@drawing
def test_pictures_of_one_painter_are_independent(painter: Painter) -> None:
    scene = courses([[1, 1], [0.5, 1, 0.5]])
    before, _ = paint(painter, undeformed_shape(scene))
    paint(painter, mechanism(scene, limit(scene)))
    after, _ = paint(painter, undeformed_shape(scene))
    assert np.array_equal(before, after)


@drawing
def test_drawing_does_not_change_shape(painter: Painter) -> None:
    scene = courses(
        [[1, 1], [0.5, 1, 0.5]],
        support__kind="corners",
        load__live={"kind": "point", "at": [0.4, 0.35], "force": [0.0, -1.0]},
    )
    shape = mechanism(scene, Outcome("", "limit", "collapse", 1.0, motion=-np.ones((len(scene.blocks), 3))))
    first, _ = paint(painter, shape)
    again, _ = paint(painter, shape)
    assert np.array_equal(first, again)


def test_outline_includes_openings() -> None:
    """A wall of 4 × 3 blocks with one block missing: perimeter 2 (1.6 + 0.6) + 2 (0.4 + 0.2) m."""
    scene = courses([[1, 1, 1, 1], [1, -1, 1, 1], [1, 1, 1, 1]], width=0.4, height=0.2)
    length = sum(np.hypot(*np.diff(ring, axis=0).T).sum() for ring in outline(scene))
    assert length == pytest.approx(5.6, rel=1e-3)


def test_multiplier_text_states_bracket() -> None:
    lateral = panel()
    pushed = panel(load__live={"kind": "point", "at": [0.72, 0.72], "force": [0.0, -1.0]}, support__kind="corners")
    assert is_force(pushed)
    assert not is_force(lateral)
    assert multiplier_text(lateral, Outcome("", "", "collapse", 0.27, 0.26, 0.28)) == ("λ = 0.2700", "[0.2600, 0.2800]")
    assert multiplier_text(lateral, Outcome("", "", "collapse", 0.27, 0.27, 0.2700001)) == ("λ = 0.2700", "")
    assert multiplier_text(lateral, Outcome("", "", "undecided", upper=0.28)) == ("undecided", "λ ≤ 0.2800")
    assert multiplier_text(pushed, Outcome("", "", "collapse", 52345.6)) == ("P = 52,346 N", "")
    assert number(0.00123456) == "0.00123"
    assert [number(x) for x in (99.99994, 785.14, -785.14, 1234.5)] == ["99.9999", "785.1", "-785.1", "1,234"]


@given(st.floats(0.01, 1e9))
def test_printed_numbers_are_accurate(value: float) -> None:
    assert float(number(value).replace(",", "")) == pytest.approx(value, rel=5e-3 if value < 0.1 else 6e-4)


@drawing
@pytest.mark.parametrize("kind", ["base", "fixed-first-course", "corners", "pinned-corners"])
def test_supports_and_loads_are_drawn_outside_wall(painter: Painter, kind: str) -> None:
    """Something is drawn where supports and loads are, and nothing is cut off at the upper and lower edge."""
    point = {"kind": "point", "at": [0.72, 0.72], "force": [0.0, -1.0]}
    scene = panel(support__kind=kind, load__live=point if "corners" in kind else {"kind": "lateral"})
    outcome = Outcome(
        "A title that is a good deal longer than the picture is wide, so that it has to be broken up",
        "limit",
        "undecided",
    )
    figure = mechanism_figure(scene, outcome, painter)
    content = to_png(figure)
    image = np.asarray(Image.open(io.BytesIO(content)).convert("RGB")).astype(int)
    margin = 4
    for edge in (image[:margin], image[-margin:]):
        assert (edge > 250).all()
    axes = figure.axes[0]
    box = axes.get_window_extent()
    scale = image.shape[1] / figure.bbox.width
    low, high = scene.blocks.extent(scene.wall)
    (x0, y0), (x1, y1) = (axes.transData.transform(corner) * scale for corner in (low, high))
    below = image[int(image.shape[0] - y0) + 4 : int(image.shape[0] - box.y0 * scale)]
    assert (below < 150).any()
    if "corners" in kind:
        above = image[int(image.shape[0] - box.y1 * scale) : int(image.shape[0] - y1) - 4, int(x0) : int(x1)]
        assert (above < 150).any()
    else:
        beside = image[int(image.shape[0] - y1) : int(image.shape[0] - y0), : int(x0) - 4]
        assert (beside < 150).any()


@drawing
def test_joint_on_ground_is_visible_and_load_has_unit(painter: Painter) -> None:
    """The ground does not hide the joint below a sliding block; a load of one newton is labelled in N."""
    scene = courses([[1]], width=0.4, height=0.2)
    motion = np.zeros((len(scene.blocks), 3))
    motion[scene.wall, 0] = 1.0
    shape = DeformedShape.of_rigid_blocks(scene, motion, np.full(1, JointState.SLIDE), 0.6)
    axes = frame_figure(shape, "wall", "dem-static", painter).axes[0]
    (image,) = axes.images
    supports = [one for one in axes.get_children() if one.get_label() == "support"]
    assert supports
    assert all(one.get_zorder() < image.get_zorder() for one in supports)
    pixels = np.asarray(image.get_array())
    assert ((pixels[..., 3] == 0) == (pixels[..., :3] == 255).all(axis=2)).all()
    assert of_colour(pixels[..., :3], STATE_COLOURS[JointState.SLIDE]).any()
    pushed = panel(load__live={"kind": "point", "at": [0.72, 0.72], "force": [0.0, -1.0]}, support__kind="corners")
    figure = frame_figure(undeformed_shape(pushed), "wall", "dem-static", painter)
    assert "dem-static: P = 0.0000 N" in [text.get_text() for text in figure.axes[0].texts]


@drawing
def test_film_extent_and_key_cover_all_frames(painter: Painter) -> None:
    """A block moves to the left and then, less far, to the right: the picture has both positions and states."""
    scene = courses([[1]], width=0.4, height=0.2)
    shapes = []
    for way, state in ((-1.0, JointState.SLIDE), (0.3, JointState.DEBONDED)):
        motion = np.zeros((len(scene.blocks), 3))
        motion[scene.wall, 0] = way
        shapes.append(replace(DeformedShape.of_rigid_blocks(scene, motion, np.full(1, state), 0.6), scale=0.1))
    axes = frame_figure(shapes[1], "wall", "dem-static", painter, tuple(shapes)).axes[0]
    (left, right), places = axes.get_xlim(), np.concatenate([shape.placed for shape in shapes])
    assert left < places[:, 0].min()
    assert right > places[:, 0].max()
    key = axes.get_legend()
    assert key is not None
    assert {"slides", "debonded"} <= {text.get_text() for text in key.get_texts()}


# Result folders and the command line


@drawing
def test_result_folder_is_drawn_without_scene_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_toml(content(wall__length=0.48, wall__height=0.24), tmp_path / "wall.toml")
    folder = tmp_path / "result"
    assert command(["run", str(path), "--model", "limit", "--out", str(folder), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["status"] == "collapse"
    flat = [folder / "mechanism.svg", folder / "mechanism.png"]
    assert ET.fromstring(flat[0].read_bytes()).tag.endswith("svg")
    before = flat[1].read_bytes()
    assert (folder / "blocks.pvd").is_file()
    path.unlink()
    assert command(["render", str(folder), "--colour", "course"]) == 0
    written = capsys.readouterr().out.split()
    assert written == [*map(str, flat), str(folder / "rendering.png"), str(folder / "film.gif")]
    assert flat[1].read_bytes() == before
    with Image.open(folder / "film.gif") as film:
        assert film.n_frames == 8  # type: ignore[attr-defined]
        first = np.asarray(film.convert("RGB")).astype(int)
        film.seek(7)
        last = np.asarray(film.convert("RGB")).astype(int)
    assert not of_colour(first, STATE_COLOURS[JointState.OPEN], 40)[60:-60].any()
    assert (np.abs(first - last).max(axis=-1) > 50).mean() > 0.01


def test_series_that_cannot_be_written_keeps_outcome(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """If a file blocks the frames' folder, the run goes on, stores its outcome, and prints one line."""
    path = write_toml(
        content(wall__length=0.48, wall__height=0.12, joint__normal_stiffness=1e9, joint__shear_stiffness=4e8),
        tmp_path / "wall.toml",
    )
    folder = tmp_path / "result"
    folder.mkdir()
    (folder / "frames").write_text("in the way")
    assert command(["run", str(path), "--model", "dem-dynamic", "--out", str(folder), "--json"]) == 2
    said = capsys.readouterr()
    assert json.loads(said.out)["status"] == "collapse"
    assert said.err.count("\n") == 1
    assert str(folder / "frames") in said.err
    assert load_outcome(folder)[0].status == "collapse"


@drawing
def test_render_without_mechanism_is_no_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_outcome(Outcome("wall", "limit", "unbounded"), tmp_path, scene=panel())
    assert render_folder(tmp_path) == []
    assert command(["render", str(tmp_path)]) == 0
    assert "no mechanism" in capsys.readouterr().out


def test_folder_without_outcome_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["render", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "holds no outcome" in error


def test_folder_of_results_is_refused_with_their_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for k in range(8):
        save_outcome(Outcome("wall", "limit", "unbounded"), tmp_path / f"wall-{k}" / "limit", scene=panel())
    assert command(["render", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.count("wall-") == 6
    assert str(tmp_path / "wall-5" / "limit") in error
    assert error.rstrip().endswith("and 2 more")


def test_window_needs_screen(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    if not sys.platform.startswith("linux"):
        pytest.skip("screens are told by DISPLAY on Linux alone")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    save_outcome(Outcome("wall", "limit", "unbounded"), tmp_path, scene=panel())
    assert command(["render", str(tmp_path), "--view"]) == 2
    assert "--view" in capsys.readouterr().err


def test_machine_that_cannot_draw_keeps_results(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without a driver VTK ends the process: that of a probe, so that only one line is printed."""
    for name, value in NO_DRIVER.items():
        monkeypatch.setenv(name, value)
    why_not_drawn.cache_clear()
    try:
        if not why_not_drawn():
            pytest.skip("this machine draws even so")
        assert command(["run", "panel-01", "--model", "limit", "--out", str(tmp_path)]) == 0
        error = capfd.readouterr().err
        assert error == ""
        assert load_outcome(tmp_path)[0].status == "collapse"
        assert (tmp_path / "blocks.pvd").is_file()
        assert (tmp_path / "mechanism.png").exists()
        assert command(["render", str(tmp_path)]) == 3
        error = capfd.readouterr().err
        assert error.count("\n") == 1
        assert "cannot draw off-screen" in error
        assert not (tmp_path / "rendering.png").exists()
        assert command(["compare", "panel-01", "--models", "limit", "--out", str(tmp_path / "all"), "--jobs", "1"]) == 0
        assert (tmp_path / "all" / "figure-8.png").exists()
    finally:
        why_not_drawn.cache_clear()


@drawing
@pytest.mark.parametrize("display", ["", *at_length(":77")])
def test_drawing_needs_no_display(display: str) -> None:
    """With DISPLAY empty, or naming a screen that does not exist."""
    assert (
        subprocess.run(
            [sys.executable, "-c", PROBE], env={**os.environ, "DISPLAY": display}, capture_output=True
        ).returncode
        == 0
    )


@drawing
def test_drawing_works_with_a_display() -> None:
    if shutil.which("Xvfb") is None:
        pytest.skip("no Xvfb to make a screen with")
    read, write = os.pipe()
    server = subprocess.Popen(["Xvfb", "-displayfd", str(write)], pass_fds=[write], stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as numbers:
            display = f":{numbers.readline().strip()}"
        probe = subprocess.run(
            [sys.executable, "-c", PROBE], env={**os.environ, "DISPLAY": display}, capture_output=True
        )
        assert probe.returncode == 0
    finally:
        server.terminate()
        server.wait()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_signal_is_delayed_until_import_is_complete(number: signal.Signals) -> None:
    """Interrupted imports of VTK end the process."""
    done: list[int] = []

    def imports() -> None:
        with uninterrupted_imports():
            signal.raise_signal(number)
            done.append(1)

    before = signal.signal(number, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            imports()
        assert done
        assert signal.getsignal(number) is signal.default_int_handler
    finally:
        signal.signal(number, before)
