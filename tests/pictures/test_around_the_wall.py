"""Drawings of what surrounds a wall: loads with their sizes, ties, supports, the beam, labels and block numbers."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from io import BytesIO
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import same_color, to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Patch, Polygon
from matplotlib.text import Text
from PIL import Image

from runningbond.joints import wall_points
from runningbond.limit import limit
from runningbond.pictures.captions import to_png, to_svg
from runningbond.pictures.flat import figure_of
from runningbond.pictures.labels import Label, Spot, block_numbers, place_labels
from runningbond.pictures.mechanism import mechanism_shape
from runningbond.pictures.quantities import counted, millimetres, pair, readable
from runningbond.pictures.style import BEAM, BLOCK_COLOURS, DARK, DEAD, DRAWN, HELD, JOINT_COLOURS, MOTION
from runningbond.results import Outcome
from runningbond.results.reactions import Supports
from runningbond.scene import (
    Action,
    Array,
    BlockMaterial,
    Forces,
    JointMaterial,
    Lateral,
    LineLoad,
    Load,
    Scene,
    Settlement,
    build_scene,
    read_scene,
    scene_from_dict,
)

from ..scene.test_loads import Wind
from .scenes import MORTAR, SCENES, facade, large, line, on_a_step, point, settling_portal, wall


@dataclass(frozen=True)
class MassForceAndMoment(Action):
    """A load of the user's own: an acceleration and a moment at once."""

    def forces(self, scene: Scene) -> Forces:
        moment = np.zeros(len(scene.blocks))
        moment[0] = 7.0
        return Forces.on(scene, (1.0, 0.0), moment)


NAMES = [*SCENES, "on_a_step"]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], tuple[Scene, Figure]]:
    """Function that returns a scene and its figure by name, each made once."""
    made: dict[str, tuple[Scene, Figure]] = {}

    def draw(name: str) -> tuple[Scene, Figure]:
        if name not in made:
            scene = (
                on_a_step(tmp_path_factory.mktemp("step")) if name == "on_a_step" else scene_from_dict(SCENES[name]())
            )
            figure = figure_of(scene)
            made[name] = scene, figure
        return made[name]

    return draw


def words(figure: Figure) -> list[Text]:
    """All non-empty texts of a figure: labels, captions and key."""
    axes = figure.axes[0]
    legend = axes.get_legend()
    key = legend.get_texts() if legend else []
    return [text for text in [*axes.texts, *key] if text.get_text()]


def labels(figure: Figure) -> list[str]:
    """Labels of a figure, without its captions, which are annotations, and without that of its scale."""
    found = [text.get_text() for text in figure.axes[0].texts if type(text) is Text]
    bar = max(float(np.ptp(line.get_xdata())) for line in named(figure, "scale", Line2D))
    found.remove(f"{bar:.6g} m")  # the scale is as long as its label states
    return found


def named(figure: Figure, name: str, kind: Any) -> list[Any]:
    return [
        artist for artist in figure.axes[0].get_children() if isinstance(artist, kind) and artist.get_label() == name
    ]


def arrows(figure: Figure) -> Counter[str]:
    """Numbers of arrows by their labels."""
    found = [artist for artist in figure.axes[0].get_children() if isinstance(artist, FancyArrowPatch)]
    return Counter(str(artist.get_label()) for artist in found if artist.get_label())


def assert_legible(figure: Figure) -> None:
    """Assert that no two texts overlap by more than rounding, and that no text or arrow is cut off."""
    figure.draw_without_rendering()  # before, texts have no position
    texts, whole = words(figure), figure.bbox
    for artist in (*texts, *(one for one in figure.axes[0].get_children() if isinstance(one, FancyArrowPatch))):
        box = artist.get_window_extent()
        assert whole.x0 <= box.x0 <= box.x1 <= whole.x1
        assert whole.y0 <= box.y0 <= box.y1 <= whole.y1
    for one, other in combinations(texts, 2):
        a, b = one.get_window_extent(), other.get_window_extent()
        common = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
        assert min(common) <= 1.5, f"{one.get_text()!r} and {other.get_text()!r}"


@pytest.mark.parametrize("name", NAMES)
def test_texts_do_not_overlap_and_are_inside_figure(name: str, drawn: Any) -> None:
    assert_legible(drawn(name)[1])


@st.composite
def loaded(draw: st.DrawFn) -> dict[str, Any]:
    """A wall of any shape and size under a few loads, perhaps with a beam or a tie."""
    length, height = draw(st.sampled_from([(1.0, 1.0), (4.0, 1.0), (2.0, 4.0), (60.0, 30.0), (0.1, 0.1)]))
    sizes, ends = st.floats(1.0, 1e7), st.sampled_from([(0.0, 1.0), (0.0, 0.5), (0.25, 0.75)])
    sides = st.sampled_from([(0.0, -1.0), (1.0, 0.0), (-1.0, 0.0), (0.6, -0.8), (0.0, 1.0)])

    def load() -> dict[str, Any]:
        kind, (x, y), size = (
            draw(st.sampled_from(["lateral", "body", "point", "line", "moment"])),
            draw(sides),
            draw(sizes),
        )
        start, end = draw(ends)
        return {
            "lateral": {"kind": "lateral", "direction": [x, y]},
            "body": {"kind": "body", "acceleration": [x, y]},
            "point": point(length * start, height, size * x, size * y),
            "line": line(height, length * start, length * end, [0.0, -size]),
            "moment": {"kind": "moment", "at": [0.51 * length, 0.97 * height], "moment": size * (x or 1.0)},
        }[kind]

    tables = wall(length, height, (length / 4, height / 6)) | {
        "load": {"gravity": draw(st.sampled_from([9.81, [1, -9]]))}
    }
    dead, live = [load() for _ in range(draw(st.integers(0, 3)))], [load(), load()]
    pushes = [each["direction"] for each in live if each["kind"] == "lateral"]
    assume(len(pushes) < 2 or np.sum(pushes, axis=0).any())  # loads that cancel are refused
    tables["load"] |= {"dead": dead, "live": live}
    if draw(st.booleans()):
        tables["tie"] = [{"from": [0.03 * length, 0.9 * height], "to": [1.2 * length, 0.9 * height]}]
        tables["tie"][0] |= {"area": 1e-4, "young": 2e11, "yield": 1e4}
    return tables


@settings(max_examples=10, derandomize=True)
@given(loaded())
def test_texts_of_random_loads_are_legible(tables: dict[str, Any]) -> None:
    assert_legible(figure_of(scene_from_dict(tables)))


LIVE, DEAD_LOAD, MOVED = "live load", "dead load", "motion"


@pytest.mark.parametrize(
    ("name", "said", "counts"),
    [
        ("facade", ["5 kN/m", "8 kN/m", "λ · weight"], {LIVE: 5, DEAD_LOAD: 36}),
        ("settling_portal", ["20 mm"], {MOVED: 1}),
        ("turning_support", ["0.5°", "5 mm"], {MOVED: 2}),
        ("shear_wall", ["0.625 m", "100 kN", "u = ±4 mm\n6 moves"], {MOVED: 1, DEAD_LOAD: 1}),
        ("kept_beam", ["50 kN", "λ · 1 kN"], {LIVE: 1, DEAD_LOAD: 1}),
        ("free_beam", ["20 kN", "30 kN", "u = 10 mm"], {MOVED: 1, DEAD_LOAD: 2}),
        ("tied", ["tie 0", "tie 1", "λ · 2 kN m", "λ · weight"], {LIVE: 6}),
        ("tilted", ["g = 1.62 m/s²", "α", "λ = tan α"], {LIVE: 1, "gravity": 1}),
        ("cracked", ["P"], {LIVE: 1}),
        ("one_block", ["λ · 1.044 kN/m"], {LIVE: 5}),
        ("on_a_step", ["λ · 1 kN", "λ · weight"], {LIVE: 6}),
    ],
)
def test_each_load_is_drawn_with_its_size(name: str, said: list[str], counts: dict[str, int], drawn: Any) -> None:
    scene, figure = drawn(name)
    assert sorted(labels(figure)) == said
    found = arrows(figure)
    for kind in ("live load", "motion", "gravity"):
        assert found[kind] == counts.get(kind, 0), kind
    assert bool(found["dead load"]) == bool(scene.load.dead)
    if name != "facade":  # the number of arrows of a line load depends on its drawn length
        assert found["dead load"] == counts.get("dead load", 0)


def test_point_forces_are_multiples_of_their_resultant() -> None:
    """With a resultant of 1 N, λ is the resultant P in newtons; each force used to be labelled P, whatever its size."""
    pushes = [point(0.5, 1.0, 0, -3), point(1.5, 1.0, 0, 2)]
    tables = wall(2.0, 1.0, load={"gravity": 9.81, "live": pushes})
    assert sorted(labels(figure_of(scene_from_dict(tables)))) == ["2 P", "3 P"]
    beam = {"height": 0.3, "condition": "fixed-height", "drive": {"force": [3, 0]}}
    tables = wall(2.0, 1.0, beam=beam, load={"gravity": 9.81, "live": [point(2.0, 0.9, -2, 0)]})
    assert sorted(labels(figure_of(scene_from_dict(tables)))) == ["2 P", "3 P"]


def test_each_of_many_loads_has_one_label(drawn: Any) -> None:
    """Ten loads and a gravity vector: loads on the mass in the same direction share their arrows and a label."""
    _, figure = drawn("many_loads")
    shared = "λ · 2 m/s²\n+ λ · weight"
    own = ["λ · 1 kN", "λ · 1.5 kN/m", "λ · 2 kN", "λ · 500 N", "5 kN", "2 kN/m", "500 N m", "weight", "1 m/s²"]
    assert sorted(labels(figure)) == sorted([shared, *own, "g = (1, −9.5) m/s²"])
    for text in figure.axes[0].texts:
        if type(text) is Text and text.get_text() != "1 m":  # the scale
            assert same_color(text.get_color(), DARK if "λ" in text.get_text() else DEAD)
    assert {"dead load", "live load, times λ"} <= {text.get_text() for text in words(figure)}


@pytest.mark.parametrize(
    ("load", "direction"),
    [
        (point(0.5, 1.0, 0, -2e3), (0, -1)),
        (point(0.0, 0.9, 2e3, 0), (1, 0)),
        (point(2.0, 0.9, 2e3, 0), (1, 0)),
        (point(0.5, 1.0, 0, 2e3), (0, 1)),
        ({"kind": "lateral", "direction": "left"}, (-1, 0)),
        ({"kind": "body", "acceleration": [0, -3]}, (0, -1)),
        (line(1.0, 0, 2, [0, -1e3]), (0, -1)),
        (line(1.0, 0, 2, [0, 1e3]), (0, 1)),
        (line(1.0, 0, 2, [1e3, 0]), (1, 0)),
        (line(1.0, 0, 2, [-6e2, -8e2]), (-0.6, -0.8)),
    ],
)
def test_arrows_have_direction_of_load_and_lie_outside_wall(load: dict[str, Any], direction: Any) -> None:
    """A push ends at the wall or before it and a pull starts there, so no arrow covers a block."""
    scene = scene_from_dict(wall(2.0, 1.0) | {"load": {"gravity": 9.81, "live": load}})
    arrows = named(figure_of(scene), "live load", FancyArrowPatch)
    assert arrows
    for arrow in arrows:
        tail, tip = arrow._path_original.vertices
        assert (tip - tail) / np.hypot(*(tip - tail)) == pytest.approx(np.array(direction), abs=1e-9)
        x, y = (tail + tip) / 2
        assert not (0 < x < 2 and 0 < y < 1)


def test_adjacent_pressures_are_drawn_to_scale_at_wall() -> None:
    """Earth pressure in steps: all arrows end at the wall, and each row begins where the next one ends."""
    steps = {0.0: 900.0, 0.25: 600.0, 0.5: 300.0}
    dead = [{"kind": "line", "from": [0, y], "to": [0, y + 0.25], "force": [q, 0]} for y, q in steps.items()]
    load = {"gravity": 9.81, "live": {"kind": "lateral"}, "dead": dead}
    figure = figure_of(scene_from_dict(wall(1.0, 1.0) | {"load": load}))
    runs = [arrow._path_original.vertices for arrow in named(figure, "dead load", FancyArrowPatch)]
    assert len(runs) == len({tuple(run[0]) for run in runs})
    lengths: dict[float, set[float]] = {}
    for tail, tip in runs:
        assert tip[0] == pytest.approx(0.0, abs=1e-9)
        lengths.setdefault(round(float(tip[0] - tail[0]), 6), set()).add(float(tip[1]))
    least, middle, most = sorted(lengths)
    assert most - middle == pytest.approx(middle - least, abs=1e-5)
    assert max(lengths[most]) == pytest.approx(min(lengths[middle]))


@pytest.mark.parametrize(
    ("count", "said"),
    [(4, ["1 kN/m", "2 kN/m", "3 kN/m", "4 kN/m", "λ · weight"]), (21, ["1 … 21 kN/m", "λ · weight"])],
)
def test_fill_of_many_loads_has_one_label(count: int, said: list[str]) -> None:
    """One load per stone of an arch: the labels of 21 sizes were piled up above it, some of them on its stones."""
    ends = np.linspace(0.0, 2.0, count + 1)
    fill = [{"kind": "line", "from": [a, 1], "to": [b, 1]} for a, b in pairwise(ends)]
    dead = [one | {"force": [0, -1e3 * (k + 1)]} for k, one in enumerate(fill)]
    load = {"gravity": 9.81, "live": {"kind": "lateral"}, "dead": dead}
    figure = figure_of(scene_from_dict(wall(2.0, 1.0) | {"load": load}))
    assert sorted(labels(figure)) == said
    assert_legible(figure)
    assert arrows(figure)["dead load"] >= 2 * count


def test_load_that_is_dead_and_live_has_both_labels() -> None:
    """The same Python object: times λ as a live load, and as it is as a dead load."""
    line = LineLoad((0.0, 1.0), (2.0, 1.0), (0.0, -1000.0))
    scene = scene_from_dict(wall(2.0, 1.0))
    figure = figure_of(replace(scene, load=Load((0.0, -9.81), (line,), (line,))))
    assert sorted(labels(figure)) == ["1 kN/m", "λ · 1 kN/m"]


def test_pressures_with_enough_space_keep_their_labels() -> None:
    """Earth pressure in eight steps beside a wall of 4 m, each step higher than its label."""
    levels = np.linspace(0.0, 4.0, 9)
    earth = [{"kind": "line", "from": [0, a], "to": [0, b], "force": [1e3 * (4 - a), 0]} for a, b in pairwise(levels)]
    load = {"gravity": 9.81, "live": {"kind": "lateral"}, "dead": earth}
    figure = figure_of(scene_from_dict(wall(1.0, 4.0) | {"load": load}))
    assert len(labels(figure)) == 9


@pytest.mark.parametrize("lean", [0.0, 0.1, 0.2])
def test_loads_along_a_steep_face_are_drawn_in_one_chain_beside_it(lean: float) -> None:
    """Vertical loads on the two stones of a face that leans by up to 6 degrees; they do not push each other away."""
    outlines = [[[lean * y, y], [0.8, y], [0.8, y + 0.5], [lean * (y + 0.5), y + 0.5]] for y in (0.0, 0.5)]
    dead = [
        {"kind": "line", "from": [lean * y, y], "to": [lean * (y + 0.5), y + 0.5], "force": [0, -2e3]}
        for y in (0.0, 0.5)
    ]
    content = wall(1.0, 1.0) | {"load": {"gravity": 9.81, "live": {"kind": "lateral"}, "dead": dead}}
    content["wall"] = {"outlines": outlines, "thickness": 1.0}
    figure = figure_of(scene_from_dict(content))
    runs = np.array([arrow._path_original.vertices for arrow in named(figure, "dead load", FancyArrowPatch)])
    middles = runs.mean(axis=1)
    aside = middles @ np.array([1.0, -lean]) / np.hypot(1.0, lean)
    assert aside == pytest.approx(np.full(len(runs), aside[0]), abs=1e-6)
    assert aside[0] < 0
    assert middles[:, 1].max() < 1.1


def test_oblique_live_loads_beside_dead_loads_stay_at_their_height() -> None:
    """Wind on a face that carries weights along it, too: moved aside, together, and not along its own direction."""
    ends = list(pairwise(np.linspace(0.0, 1.0, 5).tolist()))
    dead = [{"kind": "line", "from": [0, a], "to": [0, b], "force": [0, -1e3]} for a, b in ends]
    live = [{"kind": "line", "from": [0, a], "to": [0, b], "force": [2e3, -1e3]} for a, b in ends]
    figure = figure_of(scene_from_dict(wall(1.0, 1.0) | {"load": {"gravity": 9.81, "live": live, "dead": dead}}))
    tips = np.array([arrow._path_original.vertices[1] for arrow in named(figure, "live load", FancyArrowPatch)])
    weights = np.array([arrow._path_original.vertices for arrow in named(figure, "dead load", FancyArrowPatch)])
    assert tips[:, 1].min() == pytest.approx(0.0, abs=1e-9)
    assert tips[:, 1].max() == pytest.approx(1.0, abs=1e-9)
    assert tips[:, 0] == pytest.approx(np.full(len(tips), tips[0, 0]), abs=1e-9)
    assert tips[:, 0].max() < weights[..., 0].min()
    assert np.unique(np.round(weights[..., 0], 9)).size == 1


def test_label_of_a_line_load_that_breaks_is_clear_of_its_line() -> None:
    """It stands beside the unmoved part; the mean of both parts is in between."""
    tables = wall(2.0, 2.0)
    tables["load"]["live"] = {"kind": "line", "from": [0.0, 0.0], "to": [0.0, 2.0], "force": [1000.0, 0.0]}
    scene = scene_from_dict(tables)
    motion = np.zeros((len(scene.wall), 3))
    motion[scene.blocks.centroid[:, 1] > 1.25, 0] = 1.0
    figure = figure_of(scene, Outcome("", "limit", "collapse", 1.0, motion=motion))
    (axes,) = figure.axes
    (text,) = [text for text in axes.texts if text.get_text() == "λ · 1 kN/m"]
    figure.canvas.draw()
    box = text.get_window_extent()
    (line,) = named(figure, "live load", Line2D)
    ends = axes.transData.transform(line.get_xydata())
    beside = (ends[:, 1] > box.y0 - 20) & (ends[:, 1] < box.y1 + 20)
    assert beside.any()
    edge = 0.21 * text.get_fontproperties().get_size_in_points() * figure.dpi / 72  # white, it would cut the line
    assert box.x1 + edge < ends[beside, 0].min()


def test_two_loads_along_one_line_are_drawn_apart() -> None:
    """Floor and plaster on the top of two stones: two rows above each other, each straight."""
    dead = [line(1.0, a, a + 1, [0, -force]) for force in (1e3, 1e3) for a in (0, 1)]
    load = {"gravity": 9.81, "live": {"kind": "lateral"}, "dead": dead}
    figure = figure_of(scene_from_dict(wall(2.0, 1.0) | {"load": load}))
    tips = [arrow._path_original.vertices[1] for arrow in named(figure, "dead load", FancyArrowPatch)]
    levels = Counter(round(float(y), 6) for _, y in tips)
    assert len(levels) == 2
    assert len(set(levels.values())) == 1


def test_earth_pressure_on_arch_is_drawn_at_arch_with_one_label() -> None:
    """One load per stone, of its own size and direction: inclined rows do not push each other away from the arch."""
    ray = np.exp(1j * np.linspace(np.pi, 0, 14))
    stones = [[0.8 * ray[k + 1], ray[k + 1], ray[k], 0.8 * ray[k]] for k in range(13)]
    inwards = -(ray[1:] + ray[:-1]) / np.abs(ray[1:] + ray[:-1])
    xy = [np.column_stack([np.real(one), np.imag(one)]) for one in stones]
    earth = [
        LineLoad(tuple(xy[k][2]), tuple(xy[k][1]), ((8e3 + 100 * k) * way.real, (8e3 + 100 * k) * way.imag))
        for k, way in enumerate(inwards)
    ]
    scene = build_scene(
        "cellar",
        xy,
        thickness=1.0,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.7),
        load=Load(live=(Lateral(),), dead=tuple(earth)),
    )
    figure = figure_of(scene)
    assert sorted(labels(figure)) == ["8 … 9.2 kN/m", "λ · weight"]
    tips = [arrow._path_original.vertices[-1] for arrow in named(figure, "dead load", FancyArrowPatch)]
    around = shapely.LineString(np.column_stack([ray.real, ray.imag]))
    assert max(around.distance(shapely.Point(tip)) for tip in tips) < 1e-9


def on_a_slope(sense: float) -> Scene:
    """A block of 1 m by 2 m across ground of slope 1 : 4 that is 3 m deep."""
    foot, lean = np.array([1.0, 0.25]), np.array([-0.5, 2.0])
    return build_scene(
        "slope",
        [np.array([[0.0, 0.0], foot, foot + lean, lean])],
        grounds=[np.array([[-2.0, -3.0], [4.0, -3.0], [4.0, 1.0], [-2.0, -0.5]])],
        thickness=0.3,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.7),
        load=Load(live=(Lateral((sense, 0.0)),)),
    )


@pytest.mark.parametrize(("sense", "pushes"), [(1.0, 5), (-1.0, 4)])
def test_drawn_ground_covers_neither_scale_nor_loads(sense: float, pushes: int) -> None:
    """The scale is below the drawn part of the ground, however deep that is, and no arrow crosses the block."""
    scene = on_a_slope(sense)
    figure = figure_of(scene)
    (ground,) = named(figure, "support", Polygon)
    bar = max(line.get_ydata().max() for line in named(figure, "scale", Line2D))
    assert bar < ground.get_xy()[:, 1].min() < 0
    body = shapely.Polygon(scene.blocks.polygon(1))
    found = named(figure, "live load", FancyArrowPatch)
    assert len(found) == pushes
    assert not any(shapely.LineString(arrow._path_original.vertices).intersects(body) for arrow in found)


@pytest.mark.parametrize("by", [(0.02, 0.0), (0.0, -0.02), (0.0, 0.02)])
@pytest.mark.parametrize("step", [0.0, 0.1])
def test_label_of_ground_motion_is_beside_ground(step: float, by: tuple[float, float]) -> None:
    """On level or stepped ground, whose right part moves: its arrow and label used to be drawn on the ground.

    In the displaced position the ground is drawn as deep as before.
    """
    rows = [(0.0, 0.0), (2.0, -step)]
    scene = build_scene(
        "two piers",
        [np.array([[x, y], [x + 1, y], [x + 1, 2.0], [x, 2.0]]) for x, y in rows],
        grounds=[np.array([[x - 1, -3.0], [x + 1, -3.0], [x + 1, y], [x - 1, y]]) for x, y in rows],
        thickness=0.3,
        block=BlockMaterial(2000.0),
        joint=JointMaterial(0.7),
        load=Load(live=(Settlement(((1.1, -4.0), (9.0, 0.0)), by),)),
    )
    motion = np.where(scene.blocks.centroid[:, :1] > 1.5, [[*by, 0.0]], 0.0) / 0.02
    depths = []
    for outcome in (None, Outcome("", "limit", "collapse", 0.4, motion=motion)):
        figure = figure_of(scene, outcome)
        ground = [one.get_xy() for one in named(figure, "support", Patch) if same_color(one.get_edgecolor(), MOTION)]
        (own,) = [one for one in ground if one[:, 0].min() > 0.9]
        depths.append(np.ptp(own[:, 1]))
        figure.draw_without_rendering()
        inverse = figure.axes[0].transData.inverted()
        (size,) = [text for text in figure.axes[0].texts if text.get_text() == "20 mm"]
        top = inverse.transform(size.get_window_extent())[1, 1]
        assert top < own[:, 1].min() + 0.01
        (arrow,) = named(figure, "motion", FancyArrowPatch)
        assert arrow._path_original.vertices[:, 1].max() < own[:, 1].min()
    assert depths[0] == pytest.approx(depths[1], rel=0.1)


def faces(figure: Figure) -> Array:
    """Colours of the blocks, ``(nw, 3)``."""
    (blocks,) = [one for one in figure.axes[0].collections if isinstance(one, PolyCollection)]
    return np.asarray(blocks.get_facecolor())[:, :3]


@pytest.mark.parametrize(("height", "said"), [(0.5, ["λ · 60 N"] * 2), (2.0, ["λ · Σ 480 N"])])
def test_user_defined_load_is_drawn_as_arrows(height: float, said: list[str]) -> None:
    """Wind on two courses has a label at each; on eight courses one label states the sum."""
    tables = wall(1.0, height) | {"load": {"gravity": 9.81, "live": [Wind(800.0)]}}
    figure = figure_of(scene_from_dict(tables))
    assert labels(figure) == said
    assert arrows(figure)["live load"] == height / 0.25


def test_user_defined_load_on_mass_and_moment_is_drawn() -> None:
    tables = wall(1.0, 0.5) | {"load": {"gravity": 9.81, "live": [MassForceAndMoment()]}}
    assert sorted(labels(figure_of(scene_from_dict(tables)))) == ["λ · 7 N m", "λ · forces on mass"]


def test_ground_motion_is_drawn_as_largest_inertia_force() -> None:
    pulse = {"pulse": {"kind": "half-sine", "amplitude": 0.4, "period": 1.0}, "quantity": "g", "scale": 0.5}
    tables = wall(1.0, 0.5) | {"load": {"gravity": 9.81, "history": pulse}}
    assert labels(figure_of(scene_from_dict(tables))) == ["λ · 0.2 g\ninertia at the peak"]


def test_blocks_have_colour_of_their_material(drawn: Any) -> None:
    scene, figure = drawn("facade")
    colours = np.array([BLOCK_COLOURS[k] for k in scene.material_of_block[scene.wall]])
    assert faces(figure) == pytest.approx(colours)
    assert len(np.unique(colours, axis=0)) == 2
    said = [text.get_text() for text in words(figure)]
    assert "oak: 700 kg/m³" in said
    assert "blocks: 2000 kg/m³" in said
    assert faces(drawn("kept_beam")[1])[-1] == pytest.approx(np.array(BEAM))
    held = scene_from_dict(wall(2.0, 1.0, support={"kind": "fixed-first-course"}))
    assert (np.abs(faces(figure_of(held)) - HELD) < 1e-9).all(axis=1).tolist() == held.fixed.tolist()


def test_many_materials_have_different_colours_in_wall_and_key() -> None:
    tables = wall(2.0, 2.0)
    tables["materials"] = {f"m{k}": {"density": 1500.0 + k} for k in range(8)}
    tables["assign"] = [{"block": f"m{k}", "box": [[0, 0.25 * k], [2, 0.25 * k + 0.25]]} for k in range(8)]
    figure = figure_of(scene_from_dict(tables))
    assert len(np.unique(faces(figure), axis=0)) == 8
    legend = figure.axes[0].get_legend()
    assert legend is not None
    key = {one.get_facecolor() for one in legend.get_patches() if "kg/m³" in str(one.get_label())}
    assert len(key) == 8


def test_joints_have_colour_of_their_material(drawn: Any) -> None:
    """The key distinguishes the materials of bed and head joints, and omits unused materials."""
    scene, figure = drawn("kept_beam")
    lines = [one for one in figure.axes[0].collections if isinstance(one, LineCollection)]
    assert [len(one.get_segments()) for one in lines] == [(scene.material_of_joint == k).sum() for k in (1, 2)]
    assert all(same_color(np.asarray(one.get_color())[0], JOINT_COLOURS[k]) for k, one in enumerate(lines, 1))
    said = [text.get_text() for text in words(figure)]
    assert "mortar joints (bed): tan φ = 0.75, c = 0.1 MPa,\nfₜ = 0.05 MPa" in said
    assert "dry joints (head): tan φ = 0.4" in said
    assert not [text for text in said if text.startswith("joints")]


def test_joint_strengths_have_symbols_with_subscripts() -> None:
    strengths = {"cohesion": 3e5, "tensile_strength": 1e5, "compressive_strength": 8e6}
    energies = {"fracture_energy_1": 20.0, "fracture_energy_2": 150.0}
    scene = scene_from_dict(wall(2.0, 1.0, joint=MORTAR | strengths | energies))
    said = [text.get_text() for text in words(figure_of(scene))]
    assert "joints: tan φ = 0.75, c = 0.3 MPa, fₜ = 0.1 MPa,\nfₘ = 8 MPa, G₁ = 20 J/m², G₂ = 150 J/m²" in said


def test_ties_are_drawn_with_plates_and_anchor(drawn: Any) -> None:
    scene, figure = drawn("tied")
    ties = [np.array(tie.get_xydata()) for tie in named(figure, "tie", Line2D)]
    assert np.array(ties) == pytest.approx(scene.ties.ends)
    assert len(named(figure, "tie plate", Line2D)) == 3
    assert [one.get_hatch() is not None for one in named(figure, "anchor", Patch)] == [True]
    said = [text.get_text() for text in words(figure)]
    assert "tie 0: E A = 63 MN, yields at 70 kN, preload 5 kN" in said
    assert "anchor fixed in space" in said


def test_ties_have_same_numbers_as_in_tables() -> None:
    """In the drawing each tie has its number; the key lists equal ties together; a single tie has no number."""
    bar = {"area": 3e-4, "young": 2.1e11, "yield": 7e4}
    rows = ((0.1, 0.0), (0.6, 5e3), (0.9, 0.0))
    ties: list[dict[str, Any]] = [{"from": [0.1, y], "to": [1.9, y], "preload": force, **bar} for y, force in rows]
    scene = scene_from_dict(wall(2.0, 1.0) | {"tie": ties})
    figure = figure_of(scene)
    assert sorted(text for text in labels(figure) if "tie" in text) == ["tie 0", "tie 1", "tie 2"]
    said = [text.get_text() for text in words(figure)]
    assert [text for text in said if "yields" in text] == [
        "ties 0, 2: E A = 63 MN, yields at 70 kN",
        "tie 1: E A = 63 MN, yields at 70 kN, preload 5 kN",
    ]
    assert {f"tie {k} [N]" for k in range(3)} <= set(Supports(scene, wall_points(scene)).columns)
    alone = words(figure_of(scene_from_dict(wall(2.0, 1.0) | {"tie": ties[:1]})))
    assert [each.get_text() for each in alone if "tie" in each.get_text()] == ["tie: E A = 63 MN, yields at 70 kN"]


@pytest.mark.parametrize(
    ("name", "guides", "hatched"), [("shear_wall", 2, 0), ("kept_beam", 4, 2), ("free_beam", 0, 0)]
)
def test_beam_guides_match_its_condition(name: str, guides: int, hatched: int, drawn: Any) -> None:
    """Two rollers under a bar if the beam may rise, or under hatching if its height is fixed; none on a free beam."""
    _, figure = drawn(name)
    parts = named(figure, "beam guide", Patch)
    assert len(parts) == guides
    assert sum(part.get_hatch() is not None for part in parts) == hatched
    assert len(named(figure, "beam", Patch)) == 1


def test_drive_is_drawn_at_its_height(drawn: Any) -> None:
    _, figure = drawn("shear_wall")
    (arrow,) = named(figure, "motion", FancyArrowPatch)
    assert arrow._path_original.vertices[:, 1] == pytest.approx(0.625)
    assert same_color(arrow.get_edgecolor(), MOTION)
    assert arrow.get_arrowstyle().arrow == "<|-|>"  # cyclic


def test_only_moving_support_has_colour_of_motion(drawn: Any) -> None:
    """Ground from x = 1.9 m on sinks; a level dashed line below shows its final position."""
    _, figure = drawn("settling_portal")
    for patch in named(figure, "support", Patch):
        x = patch.get_xy()[:, 0]
        assert same_color(patch.get_edgecolor(), MOTION if x.min() > 1.8 else "0.45")
    (dashed,) = named(figure, "motion", Line2D)
    x, y = np.array(dashed.get_xydata()).T
    assert x.min() == pytest.approx(1.9)
    assert y[0] == y[1] < 0
    assert "support that moves" in [text.get_text() for text in words(figure)]


def test_ground_tilts_to_side_of_load(drawn: Any) -> None:
    _, figure = drawn("tilted")
    slopes = [np.diff(one.get_xydata(), axis=0)[0] for one in named(figure, "live load", Line2D)]
    level, tilted = slopes
    assert level[1] == 0
    assert tilted[0] < 0 > tilted[1]


def test_gravity_stays_clear_of_displaced_blocks() -> None:
    """A wall that slides to the right, where gravity is drawn; the last vertex only closes the path of the arrow."""
    scene = scene_from_dict(
        wall(1.44, 0.72, (0.24, 0.06)) | {"load": {"gravity": [2.0, -9.81], "live": {"kind": "lateral"}}}
    )
    outcome = limit(scene)
    shape = mechanism_shape(scene, outcome)
    assert shape is not None
    (arrow,) = named(figure_of(scene, outcome), "gravity", FancyArrowPatch)
    assert arrow.get_path().vertices[:-1, 0].min() > shape.placed[:, 0].max() > 1.5


def shear(scene: Scene, factor: float) -> Array:
    """Motion of a wall whose courses slide on one another."""
    motion = np.zeros((len(scene.blocks), 3))
    motion[scene.wall, 0] = factor * scene.blocks.centroid[scene.wall, 1]
    return motion


def test_ties_of_mechanism_follow_blocks_and_anchors_stay() -> None:
    scene = scene_from_dict(SCENES["tied"]())
    motion = shear(scene, 1.0)
    figure = figure_of(scene, Outcome("", "limit", "collapse", 0.5, motion=motion))
    ends = np.array([one.get_xydata() for one in named(figure, "tie", Line2D)])
    moved = ends - scene.ties.ends
    scale = moved[0, 0, 0] / motion[scene.ties.block[0, 0], 0]
    expected = np.where(scene.ties.block < 0, 0.0, motion[scene.ties.block, 0])
    assert moved[:, :, 0] == pytest.approx(scale * expected, abs=1e-9)
    assert moved[1, 1] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_beam_and_ground_of_mechanism_are_displaced() -> None:
    scene = scene_from_dict(SCENES["kept_beam"]())
    assert scene.beam is not None
    motion = shear(scene, -1.0)
    figure = figure_of(scene, Outcome("", "limit", "collapse", 50.0, motion=motion))
    (beam,) = named(figure, "beam", Patch)
    aside = beam.get_xy()[:-1] - scene.blocks.polygon(int(scene.beam.block or 0))
    assert (aside[:, 0] < -0.05).all()
    assert aside == pytest.approx(np.tile(aside[0], (4, 1)), abs=1e-9)

    portal = scene_from_dict(settling_portal())
    down = portal.support_motion / 0.02
    down[portal.wall & (portal.blocks.centroid[:, 0] > 1.5), 1] = -1.0
    figure = figure_of(portal, Outcome("", "limit", "collapse", 0.4, motion=down))
    level = {round(float(one.get_xy()[:, 1].max()), 3) for one in named(figure, "support", Patch)}
    assert len(level) == 2
    assert max(level) == 0.0
    assert min(level) < -0.1


@pytest.mark.parametrize(
    "load",
    [point(2.0, 0.9, 1.0, 0.0), {"kind": "line", "from": [2.0, 0.75], "to": [2.0, 1.0], "force": [100.0, 0.0]}],
    ids=["point", "line"],
)
def test_loads_on_mechanism_start_at_displaced_face(load: dict[str, Any]) -> None:
    """A course slides out to the right: arrows start at its end, and do not cross it."""
    scene = scene_from_dict(wall(2.0, 1.0, load={"gravity": 9.81, "live": load}))
    motion = np.zeros((len(scene.blocks), 3))
    motion[scene.wall & (scene.blocks.centroid[:, 1] > 0.75), 0] = 1.0
    figure = figure_of(scene, Outcome("", "limit", "collapse", 0.5, motion=motion))
    blocks = [one for one in figure.axes[0].collections if isinstance(one, PolyCollection)]
    end = max(np.asarray(path.vertices)[:, 0].max() for one in blocks for path in one.get_paths())
    pulls = named(figure, "live load", FancyArrowPatch)
    assert pulls
    for arrow in pulls:
        tail, tip = arrow._path_original.vertices
        assert tail[0] == pytest.approx(end, abs=1e-9)
        assert tip[0] > tail[0]


@pytest.mark.parametrize(("force_line", "aside"), [("moving", True), ("fixed", False)])
def test_force_on_a_moved_beam_keeps_its_line_if_that_is_fixed(force_line: str, aside: bool) -> None:
    """On the moved beam's edge, in the middle of the beam or on the line through its middle as built."""
    beam = {"height": 0.25, "force": [0.0, -1e4], "force_line": force_line, "drive": {"displacement": [0.01, 0.0]}}
    scene = scene_from_dict(wall(2.0, 1.0, beam=beam, load={"gravity": 9.81}))
    assert scene.beam is not None
    motion = np.zeros((len(scene.blocks), 3))
    motion[scene.beam.block] = [0.5, 0.0, 0.0]
    figure = figure_of(scene, Outcome("", "limit", "collapse", 1e5, motion=motion))
    (moved,) = named(figure, "beam", Patch)
    corners = moved.get_xy()[:-1]
    (arrow,) = named(figure, "dead load", FancyArrowPatch)
    x, y = arrow._path_original.vertices[1]
    assert y == pytest.approx(corners[:, 1].max(), abs=1e-9)
    assert corners[:, 0].mean() > 1.05
    assert x == pytest.approx(corners[:, 0].mean() if aside else 1.0, abs=1e-9)


def test_drive_arm_of_mechanism_stays_on_beam_without_dimension() -> None:
    beam = {"height": 0.25, "mass": 500.0, "drive": {"displacement": [0.01, 0.0], "at": 2.0}}
    scene = scene_from_dict(wall(2.0, 1.0, beam=beam, load={"gravity": 9.81}))
    assert scene.beam is not None
    motion = np.zeros((len(scene.blocks), 3))
    motion[scene.beam.block] = [0.5, 0.5, -0.2]
    figure = figure_of(scene, Outcome("", "limit", "collapse", 1e5, motion=motion))
    (moved,) = named(figure, "beam", Patch)
    corners = moved.get_xy()[:-1]
    one, other = corners[np.argsort(corners[:, 0])[:2]]
    (arm,) = named(figure, "beam", Line2D)
    assert arm.get_xydata()[0] == pytest.approx((one + other) / 2, abs=1e-9)
    assert named(figure_of(scene), "dimension", Line2D)
    assert not named(figure, "dimension", Line2D)


@pytest.mark.parametrize("rise", [-0.01, 0.0, 0.01])
def test_force_at_corner_pulls_from_outside(rise: float) -> None:
    """Also if the force is slightly inclined: beside the corner there is nothing of the wall."""
    load = {"gravity": 9.81, "live": point(2.0, 1.0, 1.0, rise)}
    figure = figure_of(scene_from_dict(wall(2.0, 1.0, load=load)))
    (arrow,) = named(figure, "live load", FancyArrowPatch)
    assert arrow._path_original.vertices[0] == pytest.approx([2.0, 1.0])


def test_moments_about_one_point_have_different_radii() -> None:
    """A dead and two live moments on one block: three arrows at three distances, none on another."""
    turned = [{"kind": "moment", "at": [0.5, 0.5], "moment": size} for size in (1e3, -1e3, 2e3)]
    load = {"gravity": 9.81, "dead": turned[0], "live": turned[1:]}
    figure = figure_of(scene_from_dict(wall(1.0, 1.0, (1.0, 1.0), load=load)))
    drawn = [*named(figure, "dead load", FancyArrowPatch), *named(figure, "live load", FancyArrowPatch)]
    middle = np.array([0.5, 0.5])
    radii = sorted(float(np.hypot(*(arrow._path_original.vertices - middle).T).mean()) for arrow in drawn)
    assert len(radii) == 3
    assert np.diff(radii).min() > 0.25 * radii[0]
    assert_legible(figure)


def test_moving_support_limits_scale_of_mechanism() -> None:
    """The wall bridges the support, and follows it by a thousandth."""
    portal = scene_from_dict(settling_portal())
    down = portal.support_motion / 0.02
    down[portal.wall, 1] = -1e-3
    shape = mechanism_shape(portal, Outcome("", "limit", "collapse", 0.4, motion=down))
    assert shape is not None
    assert shape.scale * np.abs(shape.face_displacement).max() == pytest.approx(DRAWN * portal.size)


def test_block_numbers_match_assign_and_lie_inside_blocks() -> None:
    """The two halves of a block that may crack share one number, in the middle of the whole block."""
    plain, cracked = scene_from_dict(facade()), scene_from_dict(SCENES["cracked"]())
    for scene in (plain, cracked):
        texts = [text for text in figure_of(scene, numbers=True).axes[0].texts if text.get_text().isdigit()]
        assert [text.get_text() for text in texts] == [str(k) for k in range(scene.part_of.max() + 1)]
        for number, text in enumerate(texts):
            parts = np.flatnonzero(scene.part_of == number)
            low, high = (np.array(corner)[parts] for corner in scene.blocks.boxes)
            assert (low.min(axis=0) < text.get_position()).all()
            assert (high.max(axis=0) > text.get_position()).all()
    assert not labels(figure_of(plain))[0].isdigit()
    chosen = facade()
    chosen["assign"] = [{"block": "oak", "blocks": [137]}]
    again = scene_from_dict(chosen)
    assert np.flatnonzero(again.material_of_block == 1).tolist() == np.flatnonzero(plain.part_of == 137).tolist()


def test_block_numbers_fit_into_blocks_cut_by_openings() -> None:
    """In the wider arm of an L, and in narrow pieces, in legible type."""
    around = [{"from": [0.7, 0.55], "to": [1.5, 1.1]}, {"from": [2.0, 1.1], "to": [2.4, 1.6]}]
    tables = wall(2.4, 1.6, (0.4, 0.2))
    tables["wall"]["opening"] = around
    scene = scene_from_dict(tables)
    for number, placed in enumerate(block_numbers(scene, 0.01)):
        (own,) = np.flatnonzero(scene.part_of == number)
        outline = shapely.Polygon(scene.blocks.polygon(int(own)))
        assert outline.contains(shapely.box(*placed.box.ravel())), number
        assert placed.label.size > 3.0, number


def test_block_numbers_do_not_hide_loads() -> None:
    """A load on a floor is drawn over the course below, in whose blocks the white edges of numbers hid its heads."""
    tables = wall(6.0, 3.0, (0.6, 0.3))
    tables["load"]["dead"] = [line(1.5, 0.0, 6.0, [0.0, -8e3])]
    scene = scene_from_dict(tables)

    def blue(numbers: bool) -> int:
        pixels = np.array(Image.open(BytesIO(to_png(figure_of(scene, numbers=numbers)))).convert("RGB")).astype(int)
        return int((np.abs(pixels - np.rint(255 * np.array(to_rgb(DEAD)))) < 8).all(axis=2).sum())

    assert blue(True) > 0.75 * blue(False)


@pytest.mark.long
def test_block_numbers_of_large_wall_are_legible() -> None:
    """The sheet is enlarged for that, up to five columns wide."""
    scene = scene_from_dict(large())
    figure = figure_of(scene, numbers=True)
    numbers = [text for text in figure.axes[0].texts if text.get_text().isdigit()]
    assert len(numbers) == scene.wall.sum() == 2025
    assert figure.get_size_inches()[0] > 10
    assert np.median([text.get_fontsize() for text in numbers]) > 2.5


@pytest.mark.parametrize("numbers", [False, True])
def test_svg_and_png_are_written(numbers: bool, tmp_path: Path) -> None:
    scene = on_a_step(tmp_path)
    assert to_svg(figure_of(scene, numbers=numbers)).startswith(b"<?xml")
    assert to_svg(figure_of(scene, numbers=numbers)) == to_svg(figure_of(scene, numbers=numbers))
    assert to_png(figure_of(scene, numbers=numbers)).startswith(b"\x89PNG")


def test_labels_do_not_overlap() -> None:
    """Ten labels for one point, which may be to its right, above or below it."""
    spots = [Spot(np.zeros(2), side) for side in ((1.0, 0.0), (0.0, 1.0), (0.0, -1.0))]
    placed = place_labels([Label("10 kN", spots) for _ in range(10)], np.zeros((0, 2, 2)), 0.01)
    for one, other in combinations(placed, 2):
        assert (np.abs(one.middle - other.middle) >= 0.999 * (one.half + other.half)).any()


def test_labels_keep_clear_of_hinges() -> None:
    """The load on an arch acts beside a hinge, which the halo around the load's letter would hide."""
    scene = read_scene(Path(__file__).parents[2] / "examples" / "walls" / "arch_with_tie.toml")
    figure = figure_of(scene, limit(scene))
    axes = figure.axes[0]
    (hinges,) = (line for line in axes.lines if line.get_marker() == "o")
    at = axes.transData.transform(np.array(hinges.get_xydata()))
    assert len(at) == 4
    figure.draw_without_rendering()
    (load,) = (text for text in axes.texts if text.get_text() == "P")
    halo = 0.2 * float(load.get_fontsize()) + hinges.get_markersize() / 2
    box = load.get_window_extent().padded(halo * figure.dpi / 72)
    assert not [point for point in at if box.contains(*point)]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (readable(999.0, "N"), "999 N"),
        (readable(1e3, "N"), "1 kN"),
        (readable(-2.5e6, "N m"), "−2.5 MN m"),
        (readable(0.25, "N"), "0.25 N"),
        (readable(0.0, "N/m"), "0 N/m"),
        (pair(np.array([0.0, -1500.0]), "N"), "(0, −1.5) kN"),
        (millimetres(-0.0125), "−12.5 mm"),
        (counted(1, "joint"), "1 joint"),
        (counted(0, "joint"), "0 joints"),
    ],
)
def test_quantities_have_readable_units(text: str, said: str) -> None:
    assert text == said


def test_surroundings_leave_enough_space_for_wall(drawn: Any) -> None:
    """Even with loads of every kind the wall takes more than 40 % of the width."""
    left, right = drawn("many_loads")[1].axes[0].get_xlim()
    assert 4.0 / (right - left) > 0.4
