"""Walls built in Python: same scenes and messages as from files; changed as copies; written and read."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import runningbond as rb
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.commands.command_line import command
from runningbond.compare.published import PUBLISHED, published_scene
from runningbond.descriptions import as_in_a_file
from runningbond.scene import Scene, SceneError, scene_from_dict
from runningbond.scene.schema import scene_schema
from runningbond.wall import TOP_LEVEL
from tests.scene.drafting import BRICKS, closed, dxf, tables
from tests.walls import content

PANEL: dict[str, Any] = {
    "length": 1.44,
    "height": 0.72,
    "block_width": 0.24,
    "block_height": 0.06,
    "thickness": 0.12,
    "density": 1800.0,
    "friction": 0.6,
}

SOLID = {"density": 1800.0, "friction": 0.6}


def same_scene(one: Scene, other: Scene) -> bool:
    """Whether two scenes are the same to the models (equal fingerprints)."""
    return fingerprint(one, "limit", 0.01) == fingerprint(other, "limit", 0.01)


@pytest.mark.parametrize("name", [case.name for case in PUBLISHED])
def test_published_walls_are_unchanged_by_writing_and_reading(name: str, tmp_path: Path) -> None:
    wall = rb.read(name)
    assert same_scene(wall.scene, published_scene(name))
    wall.to_toml(tmp_path / "copy.toml")
    assert same_scene(rb.read(tmp_path / "copy.toml").scene, wall.scene)


def test_any_characters_are_unchanged_by_writing_and_reading(tmp_path: Path) -> None:
    title = 'é "quoted" \\ back, ✓ 🧱 and a \x7f that TOML wants escaped'
    wall = rb.Wall.running_bond(**PANEL, title=title)
    wall.to_toml(tmp_path / "wall.toml")
    assert rb.read(tmp_path / "wall.toml").description == wall.description


def test_keywords_and_tables_make_the_same_wall() -> None:
    mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
    by_words = rb.Wall.running_bond(**PANEL, ends="toothed", mortar=mortar, support="fixed-first-course", title="x")
    size = {key: PANEL[key] for key in ("length", "height", "block_width", "block_height", "thickness")}
    by_tables = rb.Wall.from_dict(
        {
            "title": "x",
            "wall": {**size, "ends": "toothed"},
            "block": {"density": 1800.0},
            "joint": {"friction": 0.6, "mortar": mortar},
            "support": {"kind": "fixed-first-course"},
            "load": {"gravity": 9.81, "live": {"kind": "lateral"}},
        }
    )
    assert same_scene(by_words.scene, by_tables.scene)


def test_tuples_and_arrays_are_accepted_as_lists() -> None:
    size = {key: PANEL[key] for key in ("block_width", "block_height", "thickness", "density", "friction")}
    by_lists = rb.Wall.courses([[1, 1], [0.5, 1, 0.5]], **size)
    mixed: Any = ((1, 1), np.array([0.5, 1, 0.5]))
    assert same_scene(rb.Wall.courses(mixed, **size).scene, by_lists.scene)
    assert by_lists.with_({"joint.friction": np.float32(0.5)}).scene.joint.friction == 0.5


def test_table_named_by_a_number_is_no_list() -> None:
    """Materials 1 and 2, as users number them: the names are text, as in a file."""
    wall = rb.Wall.running_bond(**PANEL, materials={1: {"density": 1800.0}}, assign=[{"block": "1", "blocks": [0]}])
    assert wall.description["materials"] == {"1": {"density": 1800.0}}
    assert wall.with_(materials={1: {"density": 1700.0}}).description["materials"] == {"1": {"density": 1700.0}}


def test_description_has_only_the_types_of_a_file() -> None:
    """An array of unequal rows, an array without dimensions, a name that is a number, and a path."""
    rows = np.array([np.array([1, 1]), np.array([0.5, 1, 0.5])], dtype=object)
    size = {key: PANEL[key] for key in ("block_width", "block_height", "density", "friction")}
    thickness: Any = np.array(0.12, dtype=object)
    given: Any = rows
    wall = rb.Wall.courses(given, **size, thickness=thickness)
    assert wall.description["wall"]["courses"] == [[1, 1], [0.5, 1, 0.5]]
    assert wall.description["wall"]["thickness"] == 0.12
    assert all(isinstance(row, list) for row in as_in_a_file(rows))
    assert as_in_a_file({1: Path("a") / "b.dxf"}) == {"1": str(Path("a") / "b.dxf")}


def test_with_changes_a_copy_only() -> None:
    wall = rb.Wall.running_bond(**PANEL)
    by_name, by_table = wall.with_({"joint.friction": 0.7}), wall.with_(joint={"friction": 0.7})
    assert wall.scene.joint.friction == 0.6
    assert same_scene(by_name.scene, by_table.scene)
    assert by_name.scene.joint.friction == 0.7
    assert by_name.scene.block.density == 1800.0
    wall.description["joint"]["friction"] = 0.1
    assert wall.description["joint"]["friction"] == 0.6


def test_names_with_dots_in_full_names() -> None:
    materials = {"oak": {"density": 700.0}, "oak.1": {"density": 800.0}}
    wall = rb.Wall.running_bond(**PANEL).with_({"materials": materials, "assign": [{"block": "oak.1", "blocks": [0]}]})
    heavier = wall.with_({"materials.oak.1.density": 900.0, "materials.elm.density": 600.0})
    assert heavier.scene.mass[0] == pytest.approx(900 / 800 * wall.scene.mass[0])
    changed = {"oak": {"density": 700.0}, "oak.1": {"density": 900.0}, "elm": {"density": 600.0}}
    assert heavier.description["materials"] == changed
    with pytest.raises(rb.SceneError, match="friction"):
        wall.with_({"joint.friction.": 0.7}).scene  # noqa: B018


def test_none_removes_a_key() -> None:
    wall = rb.Wall.running_bond(**PANEL).with_({"joint.friction": None, "joint.friction_angle": 45.0})
    assert wall.scene.joint.friction == pytest.approx(1.0)
    assert "mortar" not in rb.Wall.running_bond(**PANEL, mortar=None).description["joint"]
    assert "title" not in rb.Wall.from_dict({**wall.description, "title": None}).description


def test_table_of_another_kind_replaces_the_old_one() -> None:
    point = rb.Wall.running_bond(**PANEL, live={"kind": "point", "at": (0.72, 0.72), "force": (0, -1)})
    back = point.with_({"load.live": {"kind": "lateral"}})
    assert back.scene.load.gravity == point.scene.load.gravity
    assert same_scene(back.scene, rb.Wall.running_bond(**PANEL).scene)
    assert isinstance(rb.read("panel-01").with_({"load.live": {"kind": "lateral"}}).description["load"]["live"], dict)


def test_order_of_changes_does_not_matter() -> None:
    """A direction is kept with the kind of its load, whichever is given first."""
    wall = rb.Wall.running_bond(**PANEL)
    kind, direction = {"load.live": {"kind": "tilt"}}, {"load.live.direction": "left"}
    turned = {"kind": "tilt", "direction": "left"}
    assert wall.with_({**kind, **direction}).description["load"]["live"] == turned
    assert wall.with_({**direction, **kind}).description["load"]["live"] == turned
    assert wall.with_(direction, load={"live": {"kind": "tilt"}}).description["load"]["live"] == turned
    beamed = wall.with_({"beam": {"height": 0.2}})
    for changes in ({"beam": None, "beam.mass": 5.0}, {"beam.mass": 5.0, "beam": None}):
        with pytest.raises(SceneError, match="beam.*: is given twice"):
            beamed.with_(changes)


def test_drawing_is_found_independently_of_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two folders have drawings of the same name: a copy of the first wall must use the first drawing."""
    walls = []
    for name, bricks in (("one", BRICKS), ("two", BRICKS[:2])):
        (tmp_path / name).mkdir()
        monkeypatch.chdir(tmp_path / name)
        dxf(Path("wall.dxf"), closed(bricks))
        walls.append(rb.Wall.from_dict(tables()))
    copies = [wall.with_({"joint.friction": 0.5}) for wall in walls]
    assert [wall.scene.wall.sum() for wall in copies] == [7, 2]
    copies[0].to_toml("copy.toml")
    assert same_scene(rb.read("copy.toml").scene, copies[0].scene)


def test_copies_are_of_the_drawing_that_the_wall_was_read_from(tmp_path: Path) -> None:
    """A copy of a wall whose drawing has changed would be another wall; one with another drawing is meant to be."""
    for name, bricks in (("wall", BRICKS), ("other", BRICKS[:2])):
        dxf(tmp_path / f"{name}.dxf", closed(bricks))
    wall = rb.Wall.from_dict(tables(), folder=tmp_path)
    dxf(tmp_path / "wall.dxf", closed(BRICKS[:2]))
    for copying in (
        lambda: wall.with_(),
        lambda: rb.sweep(wall, {"joint.friction": [0.5, 0.6]}, "limit", jobs=1),
        lambda: wall.to_toml(tmp_path / "copy.toml"),
    ):
        with pytest.raises(SceneError, match="^wall.drawing = 'wall.dxf': has changed since"):
            copying()
    assert wall.with_({"wall.drawing": "other.dxf"}).scene.wall.sum() == 2


def test_arrays_of_a_scene_are_read_only() -> None:
    """A change in place would alter the wall for the next run."""
    scene = rb.Wall.running_bond(**PANEL).scene
    seen = {"mass": scene.mass, "density": scene.density, "area": scene.blocks.area}
    for kind, forces in (("dead", scene.dead_forces), ("live", scene.live_forces)):
        seen |= {
            f"{kind} acceleration": forces.acceleration,
            f"{kind} moment": forces.moment,
            f"{kind} force": forces.force,
        }
    seen |= {"centroid": scene.blocks.centroid, "boxes": scene.blocks.boxes[0], "length": scene.joints.length}
    for name, values in seen.items():
        with pytest.raises(ValueError, match="read-only"):
            values *= 9.81
        assert not values.flags.writeable, name


def test_material_may_be_named_kind() -> None:
    materials = {"kind": {"density": 700.0}, "oak": {"density": 600.0}}
    wall = rb.Wall.running_bond(**PANEL, materials=materials)
    heavier = wall.with_({"materials.kind.density": 800.0})
    assert heavier.description["materials"] == {"kind": {"density": 800.0}, "oak": {"density": 600.0}}


def test_entries_of_lists_are_changed_by_their_numbers() -> None:
    """As messages name them, for ties, loads, vectors and courses; the other entries stay."""
    tie = {"from": [0.12, 0.03], "to": [1.32, 0.03], "area": 1e-4, "young": 2.1e11, "yield": 1e3, "preload": 500.0}
    floor = {"kind": "line", "from": [0.0, 0.72], "to": [1.44, 0.72], "force": [0.0, -1e3]}
    live = [{"kind": "lateral"}, {"kind": "point", "at": [0.0, 0.69], "force": [1e3, 0.0]}]
    wall = rb.Wall.running_bond(**PANEL, tie=[tie, tie | {"yield": 2e3}], dead=[floor], live=live)
    with pytest.raises(SceneError, match=re.escape("tie[1].preload = 9000.0: must be at most the yield force")):
        wall.with_({"tie[1].preload": 9e3})
    changed = wall.with_({"tie[1].preload": 9e2, "load.dead[0].force[1]": -2e3, "tie[0].yield": 4e3})
    assert changed.description["tie"] == [tie | {"yield": 4e3}, tie | {"yield": 2e3, "preload": 9e2}]
    assert changed.description["load"]["dead"] == [floor | {"force": [0.0, -2e3]}]
    assert changed.scene.ties.yield_force.tolist() == [4e3, 2e3]
    turned = wall.with_({"load.live[0]": {"kind": "tilt"}, "load.live[1]": None, "tie[0]": {"preload": None}})
    assert turned.description["load"]["live"] == [{"kind": "tilt"}]
    assert turned.description["tie"][0] == {key: value for key, value in tie.items() if key != "preload"}
    courses = rb.Wall.courses([[1, 1], [0.5, 1, 0.5]], block_width=0.4, block_height=0.2, thickness=0.2, **SOLID)
    assert courses.with_({"wall.courses[1][0]": 0.25, "wall.courses[1][1]": 1.25}).description["wall"]["courses"] == [
        [1, 1],
        [0.25, 1.25, 0.5],
    ]


def test_list_is_not_changed_by_number_and_by_name_at_once() -> None:
    """A name among the numbers would become one more tie."""
    tie = {"from": [0.12, 0.03], "to": [1.32, 0.03], "area": 1e-4, "young": 2.1e11, "yield": 1e3}
    wall = rb.Wall.running_bond(**PANEL, tie=[tie, tie])
    with pytest.raises(SceneError, match=re.escape("is a list, which is changed as a whole, or by entry, tie[0]")):
        wall.with_({"tie[0].yield": 4e3, "tie.yield": 3e3})


def test_sweep_over_the_yield_force_of_a_tie() -> None:
    """A block pushed by 1 N at its top, with a tie at mid-height: λ balances the moments of weight and tie."""
    block = rb.Wall.courses([[1]], block_width=0.4, block_height=1.0, thickness=1.0, density=1000.0, friction=1.5)
    tie = {"from": [-1.0, 0.5], "to": [0.0, 0.5], "area": 1e-4, "young": 2e11, "yield": 1.0}
    push = {"kind": "point", "at": [0.0, 1.0], "force": [1.0, 0.0]}
    wall = block.with_({"tie": [tie], "load.live": push})
    found = rb.sweep(wall, {"tie[0].yield": [1e3, 2e3]}, "limit", jobs=1)
    weight = 400.0 * 9.81
    assert list(found["multiplier"]) == pytest.approx([weight * 0.2 + 0.5 * 1e3, weight * 0.2 + 0.5 * 2e3])


REFUSED: list[tuple[dict[str, Any], str]] = [
    ({"density": -1.0}, "block.density = -1.0: must be a number above 0"),
    ({"friction": -0.1}, "joint.friction = -0.1: must be a number at least 0"),
    ({"length": 1.0}, "wall.length = 1.0: must be a whole number of half blocks"),
    ({"frction": 0.5}, 'frction = 0.5: is not a key of a wall; did you mean "friction"?'),
    ({"joint": {"cohesoin": 1.0}}, 'joint.cohesoin = 1.0: is not a key of [joint]; did you mean "cohesion"?'),
    ({"support": "bsae"}, 'did you mean "base"?'),
    ({"live": "laterl"}, 'did you mean "lateral"?'),
    ({"mortar": {"young": 1e9}}, "joint.mortar.poisson: is missing"),
]


@pytest.mark.parametrize(("keys", "said"), REFUSED, ids=[next(iter(keys)) for keys, _ in REFUSED])
def test_python_refuses_what_a_file_may_not_contain(keys: dict[str, Any], said: str) -> None:
    with pytest.raises(rb.SceneError, match=re.escape(said)) as refusal:
        rb.Wall.running_bond(**{**PANEL, **keys})
    assert "\n" not in str(refusal.value)


def test_repr_of_advice_equals_the_output_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    """Except for the times, because the two run separately."""
    advice = rb.read("wall-w3").advise(0.3)
    assert command(["advise", "wall-w3", "--tolerance", "0.3"]) == 0
    printed, said = (
        re.sub(r"\d+\.?\d* s|about [^(]*\(×÷ [^)]*\)", "", each) for each in (capsys.readouterr().out, repr(advice))
    )
    assert printed.split() == said.split()
    outcome = advice.outcome()
    assert outcome.lower is not None
    assert outcome.upper is not None
    assert outcome.upper - outcome.lower <= 0.3 * outcome.upper
    assert [rung.model for rung in advice.rungs][:2] == ["homog", "limit"]


def test_advice_warns_of_likely_input_errors() -> None:
    wall = rb.Wall.running_bond(**PANEL).with_({"joint.friction": 30.0, "joint.cohesion": 0.0})
    with pytest.warns(UserWarning, match="friction_angle = 30 meant"):
        wall.advise(0.9)


def test_openings_are_given_as_in_a_file() -> None:
    size = {"block_width": 0.4, "block_height": 0.2, "thickness": 0.2, "density": 1800.0, "friction": 0.6}
    window = {"from": [0.8, 0.4], "to": [1.2, 0.8], "lintel": {"height": 0.2, "bearing": 0.2}}
    wall = rb.Wall.running_bond(length=2.0, height=1.2, opening=[window], **size)
    whole = rb.Wall.running_bond(length=2.0, height=1.2, **size)
    blocks, solid = (each.scene.blocks.area[each.scene.wall].sum() for each in (wall, whole))
    assert solid - blocks == pytest.approx(0.4 * 0.4)


def test_course_heights_replace_the_block_height() -> None:
    """As `wall.course_heights` in a file."""
    size = {"block_width": 0.4, "thickness": 0.2, "density": 1800.0, "friction": 0.6}
    heights = [0.2, 0.1, 0.3]
    wall = rb.Wall.running_bond(length=1.6, course_heights=heights, **size)
    assert wall.description["wall"]["course_heights"] == heights
    assert np.unique(wall.scene.blocks.extent(wall.scene.wall)[1][1]) == pytest.approx(0.6)
    by_rows = rb.Wall.courses([[1] * 4, [0.5, 1, 1, 1, 0.5], [1] * 4], course_heights=tuple(heights), **size)
    assert by_rows.scene.blocks.vertices == pytest.approx(wall.scene.blocks.vertices)
    with pytest.raises(SceneError, match=r"wall.course_heights.*does not go with wall.block_height"):
        rb.Wall.running_bond(length=1.6, course_heights=heights, block_height=0.2, **size)


PULSE = {"pulse": {"kind": "half-sine", "amplitude": 0.3, "period": 0.2}, "quantity": "g"}


@pytest.mark.parametrize(
    "analyse",
    [
        lambda wall: wall.run("limit"),
        lambda wall: rb.sweep(wall, {"joint.friction": [0.5, 0.6]}, "limit", jobs=1),
        lambda wall: wall.draws("dem-static", 2, tolerance=0.1, jobs=1),
        lambda wall: wall.with_({"load.live": None, "load.history": PULSE}).respond("dem-dynamic"),
    ],
    ids=["run", "sweep", "draws", "respond"],
)
def test_likely_input_errors_are_warned_about_at_the_calling_line(analyse: Any) -> None:
    """With the same text as on the command line, once, and with the caller's file."""
    stiff = {"joint.normal_stiffness": 1e9, "joint.shear_stiffness": 4e8}
    wall = rb.Wall.running_bond(**PANEL).with_({"block.density": 1.8, **stiff})
    with pytest.warns(UserWarning, match=r"block.density = 1.8: is not within .* kg/m³") as told:
        analyse(wall)
    assert [Path(each.filename).name for each in told] == [Path(__file__).name]


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"joint.friction": "rough"}, "joint.friction = 'rough': must be a number"),
        ({"joint.frction": 0.4}, 'did you mean "friction"?'),
        ({"wall.length.x": 1.0}, "wall.length"),
        ({"wall": None}, "wall: is missing"),
        ({"wall.courses.0": 1.0}, "wall.courses"),
    ],
)
def test_every_change_is_checked(changes: dict[str, Any], said: str) -> None:
    size = {key: PANEL[key] for key in ("block_width", "block_height", "thickness", "density", "friction")}
    for wall in (rb.Wall.running_bond(**PANEL), rb.Wall.courses([[1, 1]], **size)):
        if set(changes) != {"wall.length.x"} or "length" in wall.description["wall"]:
            with pytest.raises(rb.SceneError, match=re.escape(said)):
                wall.with_(changes)


@pytest.mark.parametrize("file", ["r.csv", "job/../r.csv"])
def test_wall_written_through_a_linked_folder_keeps_its_record(file: str, tmp_path: Path) -> None:
    """The system follows the link to disk/job before it applies "..": there is another record of that name."""
    (tmp_path / "disk" / "job").mkdir(parents=True)
    for folder, peak in ((tmp_path, 0.5), (tmp_path / "disk", 0.05)):
        times = np.linspace(0.0, 0.4, 41)
        lines = (f"{t:.6f},{peak * np.sin(2 * np.pi * t / 0.4):.6f}" for t in times)
        (folder / "r.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "job").symlink_to("disk/job")
    history = {"file": file, "quantity": "g"}
    stiff = {"friction": 0.6, "normal_stiffness": 1e9, "shear_stiffness": 1e9}
    wall = rb.Wall.from_dict(content(load={"gravity": 9.81, "history": history}, joint=stiff), tmp_path)
    for at in (tmp_path / "job" / "wall.toml", tmp_path / "wall.toml"):
        wall.to_toml(at)
        assert same_scene(rb.read(at).scene, wall.scene)


def test_wall_without_a_title_keeps_its_name_when_written(tmp_path: Path) -> None:
    wall = rb.Wall.from_dict(content(title=None))
    wall.to_toml(tmp_path / "other.toml")
    assert rb.read(tmp_path / "other.toml").scene.title == wall.scene.title == "untitled"


def test_wall_with_python_objects_is_not_written(tmp_path: Path) -> None:
    wall = rb.Wall.running_bond(**PANEL)
    wall._description["joint"]["law"] = object()
    with pytest.raises(rb.SceneError, match=re.escape("joint.law")):
        wall.to_toml(tmp_path / "wall.toml")
    assert not (tmp_path / "wall.toml").exists()


@pytest.mark.parametrize(("name", "meant"), [("panel-1", "panel-01"), ("panel-7", "panel-07"), ("wall-W3", "wall-w3")])
def test_suggestion_is_the_nearest_published_wall(name: str, meant: str) -> None:
    """panel-01, panel-10, panel-11 and panel-12 are equally near to panel-1; the last was once suggested."""
    with pytest.raises(SceneError, match=f'did you mean "{meant}"'):
        rb.read(name)


def test_scene_from_dict_needs_a_dictionary() -> None:
    with pytest.raises(SceneError, match="content = 3: must be a dictionary of the tables of a scene file"):
        scene_from_dict(3)  # type: ignore[arg-type]


def test_missing_file_is_refused() -> None:
    with pytest.raises(rb.SceneError, match="no such file, nor a published scene"):
        rb.read("panel-99")


def test_repr_of_a_wall() -> None:
    assert repr(rb.Wall.running_bond(**PANEL, title="panel")) == "<Wall 'panel': 78 blocks, 1.44 × 0.72 m>"


def test_wall_has_pictures_for_notebooks() -> None:
    wall = rb.Wall.running_bond(**PANEL)
    assert "<svg" in wall._repr_svg_()
    assert wall._repr_png_().startswith(b"\x89PNG")


def test_wall_is_plotted_into_given_axes() -> None:
    from matplotlib.figure import Figure

    axes = Figure().add_subplot()
    assert rb.Wall.running_bond(**PANEL).plot(axes) is axes
    assert axes.has_data()


@pytest.mark.parametrize(
    ("ask", "said"),
    [
        (lambda wall: wall.with_("joint.friction"), "with_ = 'joint.friction': takes values by the full names"),
        (lambda wall: wall.with_({3: 1}), "with_ = 3: takes keys by their full names"),
        (lambda wall: wall.with_({".joint": 1}), "with_ = '.joint': takes keys by their full names"),
        (lambda wall: wall.with_({"joint..friction": 1}), "with_ = 'joint..friction': takes keys by their full names"),
        (
            lambda wall: wall.with_({"load.dead": [{"kind": "body", "acceleration": [0, -1]}]}).with_(
                {"load.dead[1].acceleration": [0, -2]}
            ),
            "load.dead[1] = {'acceleration': [0, -2]}: is not there; load.dead has 1, numbered from 0",
        ),
        (
            lambda wall: wall.with_({"tie[0].yield": 3.0}),
            "tie[0] = {'yield': 3.0}: is not there: the wall has no tie",
        ),
        (
            lambda wall: wall.with_({"load.live[0].direction": "left"}),
            "is no entry of a list: load.live is one table, whose keys are load.live.…",
        ),
        (
            lambda wall: wall.with_({"load.live": [{"kind": "lateral"}]}).with_({"load.live": {}}),
            "is a list, which is changed as a whole, or by entry, load.live[0]",
        ),
        (
            lambda wall: wall.with_({"load.live": [{"kind": "lateral"}]}).with_({"load.live.direction": "left"}),
            "is a list, which is changed as a whole, or by entry, load.live[0]",
        ),
        (lambda wall: wall.with_({"friction": 0.3}), 'give it as {"joint.friction": 0.3}'),
        (lambda wall: wall.with_(joint__friction=0.3), 'give it as {"joint.friction": 0.3}'),
        (lambda wall: wall.with_(**{"load.live.kind": "body"}), """give it as {"load.live.kind": 'body'}"""),
        (lambda wall: wall.with_(mortar={"young": 1e9}), """give it as {"joint.mortar": {'young': 1000000000.0}}"""),
        (lambda wall: wall.with_(length=2.0), 'length = 2.0: is a key of [wall]; give it as {"wall.length": 2.0}'),
        (lambda wall: rb.fragility(wall.scene, [], "dem-dynamic"), "must be a Wall, as rb.read gives one"),
        (
            lambda wall: wall.with_({"joint.friction": 0.3}, joint={"friction": 0.4}),
            "joint.friction = 0.4: is given twice",
        ),
        (
            lambda wall: wall.with_({"joint.friction": 0.3, "joint": {"friction": 0.4}}),
            "joint.friction = 0.4: is given",
        ),
        (lambda _: rb.Wall.running_bond(**PANEL, joint={"friction": 0.4}), "joint.friction = 0.4: is given twice"),
        (lambda _: rb.Wall.running_bond(**PANEL, wall={"length": 0.96}), "wall.length = 0.96: is given twice"),
        (
            lambda _: rb.Wall.running_bond(**PANEL, live="tilt", load={"live": {"kind": "tilt"}}),
            "load.live.kind = 'tilt': is",
        ),
        (lambda _: rb.Wall.running_bond(**PANEL, title="a\0b"), "title = 'a\\x00b': must be a string without control"),
        (lambda _: rb.Wall.from_dict([1]), "description = [1]: must be a mapping of the tables of a scene file"),  # type: ignore[arg-type]
        (lambda wall: rb.sweep(wall, [0.4], "limit"), "changes = [0.4]: must be lists of values by the full names"),  # type: ignore[arg-type]
        (lambda wall: wall.draws("dem-static", 2, jobs=0), "jobs = 0: must be a number of processes"),
        (lambda wall: wall.run("fem", cells=1.5), "cells = 1.5: must be a whole number, at least 1"),
        (lambda wall: wall.run("fem", cells=True), "cells = True: must be a whole number, at least 1"),
        (lambda wall: wall.run("fem", cells="2"), "cells = '2': must be a whole number, at least 1"),
        (lambda wall: wall.run("fem", scene=3), "model fem: scene = 3: is not a parameter of it"),
        (lambda wall: wall.run("limit", observe=print), "model limit: observe"),
        (lambda wall: rb.sweep(wall, {"joint.friction": [0.4]}, "limit", folder=3), "folder = 3: must be a path"),  # type: ignore[arg-type]
        (lambda wall: rb.Wall.from_dict(wall.description, 3), "folder = 3: must be a path"),  # type: ignore[arg-type]
        (lambda wall: wall.draws("dem-static", 2, folder=3), "folder = 3: must be a path"),
        (lambda wall: wall.to_toml(3), "path = 3: must be a path"),
        (lambda _: rb.read(3), "wall = 3: must be a path"),  # type: ignore[arg-type]
    ],
)
def test_invalid_arguments_are_refused_by_name(ask: Any, said: str) -> None:
    with pytest.raises(rb.SceneError, match=re.escape(said)):
        ask(rb.read("wall-w1"))


def test_numpy_integers_are_accepted() -> None:
    number: Any = np.int64(2)
    draws = rb.read("wall-w1").draws("dem-static", number, jobs=1, tolerance=0.05)
    assert len(draws.outcomes) == 2


def test_message_for_a_key_without_table_gives_the_full_name() -> None:
    with pytest.raises(SceneError, match=r'friction = 0.3: is a key of \[joint\]; give it as {"joint.friction": 0.3}'):
        rb.read("wall-w1").with_(friction=0.3)


@pytest.mark.parametrize("value", [float("inf"), float("nan"), -float("inf")])
def test_non_finite_numbers_are_refused(value: float) -> None:
    with pytest.raises(SceneError, match=r"joint\.friction = .*: must be a number at least 0, finite"):
        rb.read("wall-w1").with_({"joint.friction": value})


def test_plot_of_a_missing_curve_is_refused() -> None:
    result = rb.read("wall-w1").run("limit")
    with pytest.raises(SceneError, match="what = 'curve': must be mechanism: limit has no curve here"):
        result.plot("curve")


def test_explicit_live_load_is_kept_and_the_default_is_not() -> None:
    """A live load given in either way stays beside a beam's drive; the default is dropped for a drive or history."""
    beam = {"height": 0.2, "mass": 50.0, "drive": {"force": [1, 0]}}
    live = {"kind": "lateral", "direction": "left"}
    one, other = (
        rb.Wall.running_bond(**PANEL, beam=beam, **given) for given in ({"live": live}, {"load": {"live": live}})
    )
    assert one.description == other.description
    assert one.description["load"]["live"] == live
    assert "live" not in rb.Wall.running_bond(**PANEL, beam=beam).description["load"]
    history = {"pulse": {"kind": "sine", "amplitude": 0.1, "period": 0.5}, "quantity": "g"}
    for given in ({"history": history}, {"load": {"history": history}}):
        assert set(rb.Wall.running_bond(**PANEL, **given).description["load"]) == {"gravity", "history"}
    plain = rb.Wall.running_bond(**PANEL)
    assert rb.Wall.running_bond(**PANEL, beam=None).description == plain.description
    assert rb.Wall.running_bond(**PANEL, history=None).description == plain.description
    with pytest.raises(SceneError, match="title = 3: must be a string"):
        rb.Wall.running_bond(**PANEL, title=3)
    with pytest.raises(SceneError, match='is not a key of a wall; did you mean "friction"'):
        rb.Wall.running_bond(**{**PANEL, "frictoin": np.float32(0.4)})


def test_top_level_keys_agree_with_the_schema() -> None:
    assert set(TOP_LEVEL) == set(scene_schema()["properties"])
