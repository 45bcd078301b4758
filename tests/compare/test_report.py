"""The report of a comparison is one self-contained page that opens in a browser without console messages."""

import base64
import csv
import io
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
import zlib
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from matplotlib.colors import to_rgba
from PIL import Image

from runningbond.campaigns import Campaign
from runningbond.commands.command_line import command
from runningbond.compare import PUBLISHED, published_scene
from runningbond.compare.figures import CURVE_START, charts_of, draw_figures, table_2, wall_curves
from runningbond.compare.plates import plate_drawings, plates
from runningbond.compare.report import FULL_COLOUR, report_html, verdict
from runningbond.compare.table import Comparison, cost_sheets, csv_text, multiplier_sheets
from runningbond.models import MODELS
from runningbond.pictures.captions import is_force
from runningbond.pictures.mechanism import mechanism_shape
from runningbond.pictures.moments import MOMENTS, distances, with_moments
from runningbond.results import Outcome, fastest_corner_by_one
from runningbond.scene import Array, Scene
from runningbond.wall import Wall
from tests.walls import content, panel, write_toml

NAMES = ("limit", "dem-static", "dem-dynamic", "fem")
BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)


def outcome(scene: Scene, model: str) -> Outcome:
    """A mechanism of any wall: blocks above its lowest third move sideways by 1 m; with moments, except `limit`."""
    low, high = scene.blocks.extent(scene.wall)
    above = scene.wall & (scene.blocks.centroid[:, 1] > low[1] + (high - low)[1] / 3) & ~scene.fixed
    motion = fastest_corner_by_one(scene.blocks, above[:, None] * np.array([1.0, 0.0, 0.0]))
    found = Outcome(scene.title, model, "collapse", 0.5, 0.4, 0.6, 100, 10, 0.1, "", motion)
    return found if model == "limit" else with_moments(scene, found, [State(k / 10, k * motion) for k in range(6)])


class State(NamedTuple):
    """State of a run at one moment."""

    multiplier: float
    motion: Array


@pytest.fixture(scope="module")
def comparison() -> Comparison:
    scenes = {case.name: published_scene(case.name) for case in PUBLISHED}
    outcomes = {(name, model): outcome(scene, model) for name, scene in scenes.items() for model in NAMES}
    del outcomes["panel-03", "fem"]
    outcomes["panel-02", "limit"] = Outcome("", "limit", "unbounded")
    models = [MODELS[name] for name in NAMES]
    return Comparison(scenes, models, Campaign(outcomes), {case.name: case for case in PUBLISHED})


@pytest.fixture(scope="module")
def drawn(comparison: Comparison, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Charts and plates."""
    folder = tmp_path_factory.mktemp("plates")
    written = draw_figures(charts_of(comparison), folder)
    for name, draw in plate_drawings(comparison).items():
        (folder / name).write_bytes(draw())
        written.append(folder / name)
    return written


@pytest.fixture(scope="module")
def page(comparison: Comparison, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(report_html(comparison, charts_of(comparison), 0.01), encoding="utf-8")
    return path


class Reader(HTMLParser):
    """Parser that collects the tables, identifiers and links of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.tables: dict[str, list[list[str]]] = {}
        self.identifiers: list[str] = []
        self.linked: list[str] = []
        self._rows: list[list[str]] = []
        self._cell = False

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.linked += [value for key, value in attrs if key in ("src", "href", "action", "srcset") and value]
        self.identifiers += [value for key, value in attrs if key == "id" and value]
        if tag == "table":
            self._rows = self.tables.setdefault(found["data-title"] or "", [])
        if tag == "tr":
            self._rows.append([])
        if tag == "td":
            self._rows[-1].append("")
        self._cell = tag == "td" or (self._cell and tag == "a")

    def handle_data(self, data: str) -> None:
        if self._cell:
            self._rows[-1][-1] += data

    def handle_endtag(self, tag: str) -> None:
        self._cell = False


def read(page: Path) -> Reader:
    reader = Reader()
    reader.feed(page.read_text(encoding="utf-8"))
    reader.close()
    return reader


def test_every_published_figure_of_mechanisms_has_a_plate(comparison: Comparison) -> None:
    """Figures 8 to 10 are H/L = 1/2, 1 and 2 of the four textures, Figure 12 the concentrated load."""
    found = {plate.name: plate for plate in plates(comparison)}
    assert list(found) == ["figure-8", "figure-9", "figure-10", "figure-12", "mechanisms-ferris"]
    for name, slenderness in (("figure-8", 0.5), ("figure-9", 1.0), ("figure-10", 2.0), ("figure-12", 1.0)):
        scenes = [comparison.scenes[wall] for wall in found[name].walls]
        sizes = [np.subtract(*scene.blocks.extent(scene.wall)[::-1]) for scene in scenes]
        assert [h / length for length, h in sizes] == pytest.approx([slenderness] * 4, rel=0.05)
        bonds = [scene.bond for scene in scenes]
        assert [bond.width / bond.height for bond in bonds if bond] == pytest.approx([4, 2, 1, 0.25])
        assert list(found[name].walls.values()) == ["b/a = 4", "b/a = 2", "b/a = 1", "b/a = 1/4"]


def test_a_plate_has_a_wall_in_every_cell(drawn: list[Path]) -> None:
    """A wall slides in every cell: each has pixels of the green of displacements, if only faint."""
    image = np.asarray(Image.open(next(path for path in drawn if path.stem == "figure-9")).convert("RGB")).astype(int)
    red, green, blue = image[: -int(0.05 * len(image))].transpose(2, 0, 1)
    there = (green > red + 25) & (green > blue + 12)
    rows = np.array_split(there[int(0.05 * len(image)) :, int(0.09 * image.shape[1]) :], 4)
    for row in rows:
        for cell in np.array_split(row, 4, axis=1):
            assert cell.sum() > 20


def test_report_loads_nothing_from_outside(page: Path) -> None:
    reader = read(page)
    within = {f"#{name}" for name in reader.identifiers}
    assert all(link.startswith("data:") or link in within for link in reader.linked)
    content = page.read_text(encoding="utf-8")
    assert not re.search(r"https?://|url\((?!#)|@import", content)
    assert len(content.encode()) < 2e6


def drawings(page: Path, kind: str) -> list[ET.Element]:
    """Drawings of a page, each of which is valid XML."""
    content = page.read_text(encoding="utf-8")
    return [ET.fromstring(text) for text in re.findall(rf'<svg class="{kind}".*?</svg>', content, re.DOTALL)]


def test_report_has_every_chart_and_mechanism(page: Path, comparison: Comparison) -> None:
    """Each mechanism has one block drawn for each that moves, and there are no bitmaps."""
    assert len(drawings(page, "chart")) == len(charts_of(comparison))
    walls = drawings(page, "wall")
    cells = [(comparison.scenes[name], outcome) for (name, _), outcome in comparison.campaign.outcomes.items()]
    shapes = [shape for cell in cells if (shape := mechanism_shape(*cell)) is not None]
    assert len(walls) == len(shapes)
    for wall, shape in zip(walls, shapes, strict=True):
        moving = np.maximum.reduceat(np.hypot(*shape.displacement.T), shape.first[:-1]) > 1e-6
        drawn = sum(path.get("d", "").count("z") for path in wall if path.get("class") == "block")
        assert drawn == moving.sum()
    assert not any(list(drawing.iter("image")) for drawing in (*walls, *drawings(page, "chart")))


def test_moments_in_the_report_match_the_outcome(page: Path, comparison: Comparison) -> None:
    """Displacements of first corners in the page are those of the outcome, rounded to 1/127 of the largest."""
    content = page.read_text(encoding="utf-8")
    found = re.findall(r'data-of="(.*?)" data-motion="(.*?)" data-unit="(.*?)" data-said="(.*?)"', content)
    kept = [(name, outcome) for (name, _), outcome in comparison.campaign.outcomes.items() if len(outcome.moments)]
    assert len(found) == len(kept) == len(drawings(page, "moving wall"))
    rest, packed, unit, said = found[0]
    scene, (_, outcome) = comparison.scenes["panel-01"], kept[0]
    whole = np.frombuffer(zlib.decompress(base64.b64decode(packed)), np.int8).reshape(3, 6, -1)
    place, turn = map(float, unit.split())
    moved = outcome.moments.reshape(6, -1, 3)[:, scene.wall]
    assert whole.max() == 127
    scale = 127 * place / moved.max()
    assert np.abs(place * whole[:2].transpose(1, 2, 0) - scale * moved[..., :2] * [1, -1]).max() <= 0.51 * place
    assert not whole[2].any()
    assert turn > 0
    assert said.split("|")[2] == "λ = 0.2000, farthest 2e+03 mm"
    assert f'<path id="{rest}"' in content


def test_outcome_keeps_the_first_last_and_peak_states() -> None:
    """For a wall whose displacement doubles with every state, and whose load is largest at the fourth of twelve."""
    scene = published_scene("panel-01")
    sway = np.where(scene.wall[:, None], [1e-3, 0.0, 0.0], 0.0)
    states = [State(0.5 - 0.01 * abs(k - 3), 2**k * sway) for k in range(12)]
    found = with_moments(scene, Outcome("", "fem", "undecided"), states)
    assert len(found.moment_loads) <= MOMENTS + 1
    assert len(found.moments) == len(found.moment_loads) * len(scene.blocks)
    assert found.moment_loads[:, 0].max() == 0.5
    far = distances(scene, found.moments.reshape(len(found.moment_loads), -1, 3))
    assert (far[0], far[-1]) == pytest.approx((1e-3, 2.048))
    assert len(with_moments(scene, Outcome("", "fem", "undecided"), states, most=3).moment_loads) == 4
    pieces = [State(0.0, np.zeros((3, 3)))]
    assert not len(with_moments(scene, Outcome("", "fem", "undecided"), pieces).moments)


def test_colours_show_the_distance_from_the_median(comparison: Comparison) -> None:
    """A model 15 % above the two others has half the full colour, a printed value far below them the full colour."""
    outcomes = {("panel-12", "limit"): Outcome("", "limit", "collapse", 0.5 * (1 + FULL_COLOUR / 2))}
    outcomes |= {("panel-12", name): Outcome("", name, "collapse", 0.5) for name in ("dem-static", "dem-dynamic")}
    one = replace(comparison, scenes={"panel-12": published_scene("panel-12")}, campaign=Campaign(outcomes))
    content = report_html(one, {}, 0.01)
    row = next(line for line in content.splitlines() if 'href="#wall-panel-12">panel-12' in line and "<td" in line)
    found = re.findall(r'data-v="([0-9.]+)"(?: class="(over|under)" style="--h:([0-9.]+)")?', row)
    colours = {float(value): (way, float(size or 0)) for value, way, size in found}
    full = colours[0.13][1]
    assert colours[0.13] == ("under", full)
    assert colours[0.575][0] == "over"
    assert colours[0.575][1] == pytest.approx(full / 2, abs=0.01)
    assert colours[0.5] == ("", 0.0)


def test_the_verdict_names_the_largest_disagreement(comparison: Comparison) -> None:
    outcomes = dict(comparison.campaign.outcomes)
    outcomes["panel-07", "fem"] = Outcome("", "fem", "collapse", 0.25)
    said = verdict(replace(comparison, campaign=Campaign(outcomes)))
    assert "They differ most on panel-07 (fem 0.2500, limit 0.5000)." in said[1]
    assert said[0] == "75 cases: 19 walls by 4 models. 74 end in a collapse load, 1 unbounded."


def test_load_curves_show_the_elastic_range(comparison: Comparison) -> None:
    """For a wall that is elastic up to 1 µm and then yields up to 10 mm; drawn from `CURVE_START` of its peak on."""
    curve = np.array([[0, 0], [1e-6, 0.6], [1e-2, 0.6]])
    outcomes = {("panel-01", "fem"): Outcome("", "fem", "collapse", 0.6, curve=curve)}
    figure = wall_curves(replace(comparison, campaign=Campaign(outcomes)), "panel-01")
    assert figure is not None
    (axes,) = figure.axes
    moved, load = (np.asarray(data, dtype=float) for data in axes.lines[0].get_data())
    assert axes.get_xscale() == "log"
    assert (moved[0], load[0]) == pytest.approx((CURVE_START * 1e-3, CURVE_START * 0.6), rel=1e-9)
    assert (moved[-1], load[-1]) == pytest.approx((10.0, 0.6))
    elastic = moved < 0.999e-3
    assert load[elastic] == pytest.approx(600 * moved[elastic], rel=1e-9)
    assert elastic.sum() > 10


@pytest.mark.parametrize("reach", [0.55e-5, 2e-5, 1e-4, 1e-2])
def test_load_curves_have_labels_beside_each_other(comparison: Comparison, reach: float) -> None:
    """Of one sort, also where displacements differ by less than ten times."""
    curve = np.array([[0, 0], [reach / 3, 0.5], [reach, 0.6]])
    outcomes = {("panel-01", "fem"): Outcome("", "fem", "collapse", 0.6, curve=curve)}
    figure = wall_curves(replace(comparison, campaign=Campaign(outcomes)), "panel-01")
    assert figure is not None
    figure.draw_without_rendering()
    (axes,) = figure.axes
    (low, high), ticks = axes.get_xlim(), [*axes.get_xticklabels(), *axes.get_xticklabels(minor=True)]
    shown = [tick for tick in ticks if tick.get_text() and low <= tick.get_position()[0] <= high]
    boxes = sorted((box.x0, box.x1) for box in (tick.get_window_extent() for tick in shown))
    assert len(boxes) >= 2
    assert all(end < start for (_, end), (start, _) in pairwise(boxes))
    assert all(float(tick.get_text()) == pytest.approx(tick.get_position()[0]) for tick in shown)


def test_the_tables_have_the_sixteen_published_panels(page: Path, comparison: Comparison) -> None:
    tables = read(page).tables
    paper = [title for title in tables if title.startswith("Baraldi") and "seconds" not in title]
    names = [row[0] for title in paper for row in tables[title][1:]]
    assert names == [case.name for case in PUBLISHED if not case.name.startswith("wall")]
    assert len(names) == 16
    rows = tables[paper[0]][1:]
    row = rows[0]
    assert row[1:5] == [comparison.scenes["panel-01"].title, "0.500", "0.570", "0.537"]
    assert row[-4:] == ["0.4000 – 0.6000"] * 4
    assert rows[2][-1] == "not run"
    assert rows[1][-4] == "unbounded"
    versions = dict(row for row in tables["Versions"][1:])
    assert {"runningbond", "Python", "numpy", "vtk", "pyvista", "tolerance"} <= set(versions)


def test_multipliers_and_newtons_are_in_separate_tables(comparison: Comparison) -> None:
    """No table mixes λ and newtons, also for own scenes, and each row of the CSV file states its unit."""
    scenes = {**comparison.scenes, "mine": published_scene("panel-01"), "yours": published_scene("point-load-1")}
    mixed = replace(comparison, scenes=scenes)
    for sheet in (*multiplier_sheets(mixed), *cost_sheets(mixed)):
        loaded = {is_force(scenes[row[0]]) for row in sheet.rows}
        assert len(loaded) == 1
        assert ("[N]" in sheet.title) == loaded.pop()
    rows = csv.DictReader(io.StringIO(csv_text(mixed)))
    assert {(row["scene"], row["unit"]) for row in rows} == {
        (name, "N" if is_force(scene) else "1") for name, scene in scenes.items()
    }


def test_tables_count_whole_blocks_without_the_beam() -> None:
    """18 blocks of 0.24 × 0.12 m under a beam, 14 of them in halves; the table used to count 33 blocks."""
    size = {"wall__length": 0.96, "wall__height": 0.48, "wall__block_height": 0.12}
    crack = {"friction": 0.6, "cohesion": 1e5, "tensile_strength": 1e5}
    scene = panel(**size, inner_joint=crack, beam={"height": 0.1})
    comparison = Comparison({"own": scene}, [MODELS["limit"]], Campaign({}))
    (sheet,) = cost_sheets(comparison)
    assert sheet.rows[0][1] == "18"
    (row,) = csv.DictReader(io.StringIO(csv_text(comparison)))
    assert row["blocks"] == "18"
    assert repr(Wall(content(**size, inner_joint=crack, beam={"height": 0.1}))).startswith("<Wall 'panel': 18 blocks")


def test_outcomes_without_a_load_have_hollow_markers(comparison: Comparison) -> None:
    """In the chart of Table 2: an undecided outcome with a bound and an unbounded one; decided ones are solid."""
    outcomes = dict(comparison.campaign.outcomes)
    outcomes["panel-05", "dem-static"] = Outcome("", "dem-static", "undecided", upper=0.3)
    figure = table_2(replace(comparison, campaign=Campaign(outcomes)))
    hollow = [
        [(line.get_color(), line.get_ydata()) for line in axes.lines if line.get_markerfacecolor() == "white"]
        for axes in figure.axes
    ]
    limit, static = MODELS["limit"].colour, MODELS["dem-static"].colour
    assert hollow == [[(limit, [0.0])], [(static, [0.3])], []]
    assert any("hollow" in text.get_text() for text in figure.legends[0].get_texts())
    bars = [patch for patch in figure.axes[1].patches if patch.get_edgecolor() == to_rgba(static)]
    assert {patch.get_facecolor() for patch in bars} == {to_rgba("white"), to_rgba(static)}


def test_textures_are_separated_in_the_chart_of_table_2(comparison: Comparison) -> None:
    """The gaps between the markers of two textures are wider than those between the markers of one."""
    for axes in table_2(comparison).axes:
        places = np.sort(np.concatenate([line.get_xdata() for line in axes.lines]))
        gaps = np.diff(np.unique(np.round(places, 6)))
        assert len(gaps[gaps > 1.2 * gaps.min()]) == 3


def opened(page: Path, probe: str) -> subprocess.CompletedProcess[str]:
    """A page with a script in it, as headless Chromium shows it: its output, and messages of its console."""
    if BROWSER is None:
        pytest.skip("no Chromium on this machine")
    copy = page.parent / "probed.html"
    copy.write_text(page.read_text(encoding="utf-8").replace("<body>", probe + "<body>"), encoding="utf-8")
    seen = subprocess.run(
        [
            BROWSER,
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            f"--user-data-dir={page.parent / 'profile'}",
            "--enable-logging=stderr",
            "--virtual-time-budget=10000",
            "--dump-dom",
            copy.as_uri(),
        ],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert seen.returncode == 0, seen.stderr
    return seen


def test_report_opens_in_a_browser_without_console_messages(page: Path) -> None:
    """In headless Chromium every drawing is laid out, table heads take the focus and sort, and the slider works."""
    probe = """<script>addEventListener("load", () => setTimeout(() => {
        const slider = document.querySelector(".moments input");
        const block = document.querySelector(".moving .block:last-child");
        const at = () => block.getBoundingClientRect().x, end = at();
        slider.value = 0; slider.dispatchEvent(new Event("input"));
        const moved = end > at() + 1 && slider.closest(".moments").querySelector("output").value;
        const seen = [...document.querySelectorAll("svg")].filter(one => one.getBoundingClientRect().width > 90);
        const table = document.querySelector("table"), first = () => table.tBodies[0].rows[0].cells[0].textContent;
        const before = first(), head = table.querySelector("th button");
        head.focus(); head.click(); head.click();
        document.title = `${document.activeElement === head} ${seen.length} ${before} ${first()} ${moved}`;
        }, 2000));</script>"""
    seen = opened(page, probe)
    count = len(drawings(page, "chart")) + len(drawings(page, "wall")) + 2 * len(drawings(page, "moving wall"))
    assert f"<title>true {count} panel-01 panel-12 λ = 0.0000, farthest 0 mm</title>" in seen.stdout
    assert "CONSOLE" not in seen.stderr


def test_compare_writes_a_report_of_own_scenes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_toml(content(wall__length=0.48, wall__height=0.24, title="<mine> & yours"), tmp_path / "a & b.toml")
    out = tmp_path / "out"
    assert command(["compare", str(path), "--models", "homog,limit", "--out", str(out), "--jobs", "1"]) == 0
    capsys.readouterr()
    assert read(out / "report.html").tables["Your scenes"][1][:2] == ["a & b", "<mine> & yours"]
    (drawing,) = drawings(out / "report.html", "wall")
    assert f'<path id="{drawing[0].attrib["href"][1:]}"' in (out / "report.html").read_text(encoding="utf-8")
    assert (out / "mechanisms.png").is_file()


def test_long_title_leaves_results_in_view(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The title took the whole width of the page, and the results were behind its edge."""
    title = "northern transept of the parish church after its second restoration, " * 4
    path, out = write_toml(content(title=title.strip(", ")), tmp_path / "church.toml"), tmp_path / "out"
    assert command(["compare", str(path), "--models", "homog,limit", "--out", str(out), "--jobs", "1"]) == 0
    capsys.readouterr()
    probe = """<script>addEventListener("load", () => {
        const fits = [...document.querySelectorAll(".wide")].map(one => one.scrollWidth <= one.clientWidth);
        document.title = `fits ${fits.every(Boolean)}`; });</script>"""
    assert "<title>fits true</title>" in opened(out / "report.html", probe).stdout
