"""Flat drawings of walls and mechanisms: vectors that match the arrays, without VTK."""

import io
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

from dem.static import dem_static
from runningbond.limit import limit
from runningbond.pictures.captions import Caption, colour_key, figure_with_room, show_extent, to_png, to_svg
from runningbond.pictures.deformed_shape import DeformedShape, undeformed_shape
from runningbond.pictures.flat import draw_mechanism, draw_wall, figure_of, line_width, paint_mechanism
from runningbond.pictures.inline import inline_mechanism
from runningbond.pictures.joint_state import JointState
from runningbond.pictures.mechanism import mechanism_shape
from runningbond.pictures.resultants import resultants
from runningbond.pictures.style import AT_REST, DRAWN, FASTEST, STATE_COLOURS, VISIBLE_GAP
from runningbond.results import Outcome
from runningbond.scene import Scene
from tests.walls import courses, panel

POINT = {"kind": "point", "at": [0.72, 0.72], "force": [0.0, -1.0]}
CRACK = {"friction": 0.6, "cohesion": 3e5, "tensile_strength": 1e5}


def of_kind(figure: Figure, kind: Any) -> list[Any]:
    return [drawn for drawn in figure.axes[0].collections if isinstance(drawn, kind)]


def texts(figure: Figure) -> str:
    axes = figure.axes[0]
    legend = axes.get_legend()
    key = [] if legend is None else [text.get_text() for text in legend.get_texts()]
    return "\n".join([*(text.get_text() for text in axes.texts), *key])


def test_wall_is_drawn_block_by_block() -> None:
    """The polygons are those of the blocks, and the caption states their number and material."""
    scene = panel()
    figure = figure_of(scene)
    (blocks,) = of_kind(figure, PolyCollection)
    drawn = [path.vertices[:-1] for path in blocks.get_paths()]
    assert len(drawn) == scene.wall.sum()
    for block, polygon in zip(np.flatnonzero(scene.wall), drawn, strict=True):
        assert polygon == pytest.approx(scene.blocks.polygon(int(block)), abs=1e-12)
    assert "1.44 × 0.72 m, 0.12 m thick, 1800 kg/m³\n78 blocks, 204 joints" in texts(figure)
    assert "tan φ = 0.6" in texts(figure)


def test_caption_counts_whole_blocks_and_cracks_apart_from_joints() -> None:
    """Blocks of 0.24 × 0.12 m that may crack: the caption used to say 45 joints."""
    size = {"wall__length": 0.96, "wall__height": 0.48, "wall__block_height": 0.12}
    figure = figure_of(panel(**size, support__kind="fixed-first-course", inner_joint=CRACK))
    assert "18 blocks, 35 joints, 10 potential cracks" in texts(figure)


def test_numbered_mechanism_has_room_for_thrust() -> None:
    """Forces are drawn beyond the base of a stack; with block numbers, they used to be cut off there."""
    scene = courses([[1], [1], [1]], height=0.4)
    axes = figure_of(scene, limit(scene), numbers=True).axes[0]
    thrust = np.concatenate([line.get_xydata() for line in axes.lines if line.get_label() == "thrust"])
    assert thrust[:, 1].min() < -0.15
    assert axes.get_ylim()[0] < thrust[:, 1].min()


def test_joints_are_drawn_by_material() -> None:
    """Mortar joints and potential cracks in two colours, each joint once, along its own line."""
    scene = panel(inner_joint=CRACK)
    figure = figure_of(scene)
    lines = of_kind(figure, LineCollection)
    assert len(lines) == 2
    for inner, drawn in enumerate(lines):
        ends = scene.joints.ends[scene.joints.inner == bool(inner)]
        assert np.array(drawn.get_segments()) == pytest.approx(ends, abs=1e-12)
    first, second = (drawn.get_color()[0] for drawn in lines)
    assert tuple(first) != tuple(second)
    assert "c = 0.3 MPa, fₜ = 0.1 MPa" in texts(figure)


def test_mechanism_is_drawn_in_displaced_position() -> None:
    """The fastest corner is drawn to move by `DRAWN` sizes of the wall; the undeformed wall is drawn behind."""
    scene = courses([[1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]], height=0.2)
    outcome = limit(scene)
    figure = figure_of(scene, outcome)
    ghost, blocks = of_kind(figure, PolyCollection)[:2]
    still, moved = (np.concatenate([path.vertices[:-1] for path in drawn.get_paths()]) for drawn in (ghost, blocks))
    assert np.hypot(*(moved - still).T).max() == pytest.approx(DRAWN * np.sqrt(1.2 * 0.6), rel=1e-9)
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    assert moved == pytest.approx(shape.placed, abs=1e-12)
    said = texts(figure)
    assert f"limit: λ = {outcome.multiplier:.4f}" in said
    assert "drawn to move 0.1 m" in said


def test_joint_states_differ_in_line_style() -> None:
    """Sliding joints are dashed, open ones solid: one line per sliding joint, and two per open one."""
    scene = panel()
    outcome = limit(scene)
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    assert shape.states == [JointState.SLIDE, JointState.OPEN]
    figure = figure_of(scene, outcome)
    lines = {tuple(np.round(255 * drawn.get_color()[0][:3])): drawn for drawn in of_kind(figure, LineCollection)}
    found = {
        state: lines[tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))]
        for state, colour in STATE_COLOURS.items()
        if state in shape.states
    }
    dashes = {state: drawn.get_linestyle()[0][1] for state, drawn in found.items()}
    assert dashes[JointState.OPEN] is None
    assert dashes[JointState.SLIDE] is not None
    assert len(found[JointState.SLIDE].get_segments()) == (shape.state == JointState.SLIDE).sum()
    assert len(found[JointState.OPEN].get_segments()) == 2 * (shape.drawn_state == JointState.OPEN).sum()


def test_invisible_gap_is_not_drawn() -> None:
    """Both blocks of a stack move sideways by the full size; the upper one rises by 0.9 or 1.1 visible gaps."""
    scene = courses([[1], [1]], width=0.4, height=0.4)
    upper = int(np.argmax(scene.blocks.centroid[:, 1] * scene.wall))
    for share, states in ((0.9, []), (1.1, [JointState.OPEN])):
        motion = np.zeros((len(scene.blocks), 3))
        motion[scene.wall, 0] = 1.0
        motion[upper, 1] = share * VISIBLE_GAP / DRAWN
        opens = np.where((scene.joints.block == upper).any(axis=1), JointState.OPEN, JointState.STICK)
        assert DeformedShape.of_rigid_blocks(scene, motion, opens, 0.0).states == states


def test_resultant_passes_through_centre_of_pressure() -> None:
    """A block 0.2 × 0.4 m topples at λ = 1/2: its weight W and the push W/2 act on the ground at the toe."""
    scene = courses([[1]], width=0.2, height=0.4)
    outcome = limit(scene)
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    (line,), largest, beside = resultants(shape, outcome)
    assert not beside
    weight = float(scene.mass[scene.wall].sum()) * 9.81
    assert largest == pytest.approx(weight * np.hypot(1, 0.5), rel=1e-6)
    assert line.mean(axis=0) == pytest.approx([0.2, 0.0], abs=1e-6)
    run = line[1] - line[0]
    assert abs(run[1] / run[0]) == pytest.approx(2.0, rel=1e-6)
    assert run[0] * run[1] < 0
    assert np.hypot(*run) == pytest.approx(scene.block_size, rel=1e-9)
    assert "force ≤" in texts(figure_of(scene, outcome))
    assert "force ≤" not in texts(figure_of(panel(), limit(panel())))
    assert not len(resultants(shape, replace(outcome, force=np.zeros((0, 2))))[0])


def test_resultants_of_tensile_joints_lie_outside_joints() -> None:
    """Two glued blocks of 0.4 × 0.2 m: λ shifts the resultant above a joint by λ times the height of its centroid.

    For nearly equal tension and pressure the resultant is far away; for equal ones it is a couple without a position.
    """
    glue = {"cohesion": 2e4, "tensile_strength": 1e4, "normal_stiffness": 1e10, "shear_stiffness": 4e9}
    scene = courses([[1], [1]], width=0.4, height=0.2, joint={"friction": 0.6, **glue})
    outcome = dem_static(scene)
    assert outcome.lower is not None
    lines, _, beside = resultants(undeformed_shape(scene), outcome)
    assert lines.mean(axis=1)[:, 0] == pytest.approx([0.2 + 0.2 * outcome.lower, 0.2 + 0.1 * outcome.lower], rel=1e-6)
    assert not beside
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    for pull in (99.0, 100.0):
        couple = replace(outcome, force=np.array([[pull, 0.0], [-100.0, 30.0], [-50.0, 0.0], [-50.0, 0.0]]))
        lines, _, beside = resultants(shape, couple)
        assert (len(lines), beside) == (1, 1)
        assert "1 far beside their joints" in texts(figure_of(scene, couple))


def test_thin_course_does_not_change_line_width() -> None:
    """Line widths stay the same, and resultants are still drawn."""
    drawn = []
    for tile in (0.2, 0.01):
        scene = panel(wall__height=None, wall__block_height=None, wall__course_heights=[0.2, tile, 0.2, 0.2])
        figure = figure_of(scene, limit(scene))
        assert "force ≤" in texts(figure)
        drawn.append(line_width(scene, (0.0, 1.5, 0.0, 1.0), (3.5, 3.0)))
    assert drawn[1] == pytest.approx(drawn[0], rel=1e-6)


def test_closed_cracks_are_invisible() -> None:
    """A wall that slides as one body looks the same with and without potential cracks, also at the ends of outlines."""
    pictures = []
    both: list[dict[str, Any]] = [{}, {"inner_joint": CRACK | {"cohesion": 1e7, "tensile_strength": 1e6}}]
    for tables in both:
        scene = courses([[1, 1], [0.5, 1, 0.5], [1, 1]], **tables)
        slide = np.outer(scene.wall, [1.0, 0.0, 0.0])
        shape = mechanism_shape(scene, Outcome("wall", "model", "collapse", 0.6, motion=slide))
        assert shape is not None
        figure = Figure(figsize=(3.5, 2.5), dpi=300)
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        show_extent(axes, shape.extent)
        paint_mechanism(axes, shape, line_width(scene, shape.extent, (3.5, 2.5)))
        picture = io.BytesIO()
        figure.savefig(picture)
        # Left out are dashed lines, of the base and the undeformed wall: their dashes start again at each half block.
        corners = np.array([shape.placed.min(axis=0) + [0.01, 0.05], shape.placed.max(axis=0) - 0.01])
        (left, bottom), (right, top) = axes.transData.transform(corners).astype(int)
        pictures.append(np.asarray(Image.open(picture).convert("L"), dtype=int)[-top:-bottom, left:right])
    plain, cracked = pictures
    line = int(plain.max() - plain.min())
    assert line > 20
    assert np.abs(plain - cracked).max() < 0.75 * line  # lines end within a pixel of each other


def test_hinge_is_marked_at_centre_of_rotation() -> None:
    """A block twice as high as wide topples about the lower corner on the far side."""
    scene = courses([[1]], width=0.2, height=0.4)
    figure = figure_of(scene, limit(scene))
    (hinge,) = [line for line in figure.axes[0].lines if line.get_marker() == "o"]
    assert np.array(hinge.get_xydata()) == pytest.approx(np.array([[0.2, 0.0]]), abs=1e-6)
    assert "hinge" in texts(figure)


def test_motion_that_is_no_mechanism_is_not_drawn() -> None:
    scene = panel()
    backwards = replace(limit(scene), motion=-limit(scene).motion)
    figure = figure_of(scene, backwards)
    _, blocks = of_kind(figure, PolyCollection)
    moved = np.concatenate([path.vertices[:-1] for path in blocks.get_paths()])
    assert moved == pytest.approx(scene.blocks.vertices[scene.wall[scene.blocks.owner]], abs=1e-12)
    assert "mechanism not drawn: the live load does negative work on this motion" in texts(figure)
    assert "slides" not in texts(figure)
    assert "no mechanism" in texts(figure_of(scene, Outcome("", "limit", "unbounded")))


@pytest.mark.parametrize("kind", ["base", "fixed-first-course", "corners", "pinned-corners"])
def test_nothing_is_cut_off_at_figure_edge(kind: str) -> None:
    """For every support and load, with a title too long for one line; outside the axes there are captions."""
    scene = panel(support__kind=kind, load__live=POINT if "corners" in kind else {"kind": "lateral"})
    scene = replace(scene, title="A title that is a good deal longer than the picture is wide, and has to be broken up")
    for figure in (figure_of(scene), figure_of(scene, replace(limit(scene), scene=scene.title))):
        image = np.asarray(Image.open(io.BytesIO(to_png(figure))).convert("L")).astype(int)
        for edge in (image[:4], image[-4:]):
            assert (edge > 250).all()
        box = figure.axes[0].get_window_extent()
        captions = np.concatenate([image[: int(len(image) - box.y1)], image[int(len(image) - box.y0) + 1 :]])
        assert (captions < 150).any()
        assert (captions[:, [0, 1, 2, -3, -2, -1]] > 250).all()


def test_key_of_all_states_fits_the_width() -> None:
    """Frames of walls whose joints slide, open, debond and crush have a key of six entries."""
    caption = Caption(["wall"], "", [], colour_key(crushes=True))
    figure, axes = figure_with_room((0.0, 1.0, 0.0, 1.0), caption)
    caption.write(axes)
    legend = axes.get_legend()
    assert legend is not None
    box = legend.get_window_extent().transformed(figure.transFigure.inverted())
    assert box.x0 >= 0
    assert box.x1 <= 1


def test_key_with_a_long_entry_has_fewer_columns() -> None:
    """Five entries, of which the last is as wide as half of the picture, are cut off in three columns."""
    long = Line2D([], [], label="force ≤ 1.674 kN, 3 far beside their joints")
    caption = Caption(["wall"], "", [], [Line2D([], [], label="hinge"), *colour_key([JointState.OPEN]), long])
    figure, axes = figure_with_room((0.0, 1.0, 0.0, 1.0), caption)
    caption.write(axes)
    legend = axes.get_legend()
    assert legend is not None
    box = legend.get_window_extent().transformed(figure.transFigure.inverted())
    assert box.x0 >= 0
    assert box.x1 <= 1


def test_svg_is_vectors_and_reproducible() -> None:
    scene = panel()
    content = to_svg(figure_of(scene, limit(scene)))
    root = ET.fromstring(content)
    assert not list(root.iter("{http://www.w3.org/2000/svg}image"))
    assert len(list(root.iter("{http://www.w3.org/2000/svg}path"))) > scene.wall.sum()
    assert content == to_svg(figure_of(scene, limit(scene)))


def test_drawing_into_given_axes() -> None:
    figure = Figure()
    left, right = figure.subplots(1, 2)
    scene: Scene = panel()
    draw_wall(left, scene)
    draw_mechanism(right, scene, limit(scene))
    assert to_png(figure, 100)[1:4] == b"PNG"


def test_flat_drawings_do_not_import_vtk() -> None:
    program = (
        "import sys; from tests.walls import panel; from runningbond.limit import limit;"
        "from runningbond.pictures.flat import figure_of; from runningbond.pictures.captions import to_svg;"
        "to_svg(figure_of(panel(), limit(panel()))); print([name for name in sys.modules if 'vtk' in name and "
        "not name.startswith('runningbond') or name == 'pyvista'])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.stdout.strip() == "[]", done.stderr


def test_block_colours_of_inline_mechanism_have_one_hue() -> None:
    """Shades lie on the line from the colour at rest to that of the fastest block, though similar ones are merged."""
    scene = panel(wall__length=0.48, wall__height=1.44)
    shape = mechanism_shape(scene, limit(scene))
    assert shape is not None
    blocks = re.findall(r'class="block" d="[^"]*" fill="(#\w+)"', inline_mechanism(shape, shape.extent, "wall"))
    assert len(blocks) > 5
    way = np.subtract(FASTEST, AT_REST)
    shades = np.array([to_rgb(colour) for colour in blocks]) - AT_REST
    assert shades == pytest.approx(np.outer(shades @ way / (way @ way), way), abs=1.5 / 255)
