"""The study of accuracy against cost: its known answers, tables, charts and page."""

import os
import subprocess
import sys
from collections.abc import Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text

from runningbond.commands.command_line import command
from runningbond.joints import joint_stiffness
from runningbond.limit import limit_nonassociated
from runningbond.models import MODEL_LOOKS, MODELS
from runningbond.results import save_outcome
from runningbond.studies import Chart, Row, Rows
from runningbond.studies.accuracy.charts import CHARTS, MARKS, TITLES, draw_growth, pareto_front
from runningbond.studies.accuracy.measure import machine, measure
from runningbond.studies.accuracy.parameters import PARAMETERS, VARIED, settings_of
from runningbond.studies.accuracy.questions import ask
from runningbond.studies.accuracy.study import STUDY, page
from runningbond.studies.accuracy.tables import (
    cheapest,
    cheapest_table,
    exponent,
    fits,
    growth,
    growth_table,
    label,
    models_table,
    parameters_table,
    records,
    tables,
)
from runningbond.studies.accuracy.walls import (
    StudiedWall,
    accuracy_walls,
    all_walls,
    error,
    growth_walls,
    stiffness_walls,
)
from runningbond.studies.apart import TOO_LONG, measure_apart
from runningbond.studies.page import draw_charts, write_page
from tests.at_length import at_length
from tests.checker import check

ROOT = Path(__file__).parents[2]


# --- errors --------------------------------------------------------------------------------------------------


@given(st.floats(0.01, 10), st.floats(0, 1), st.floats(0.01, 10))
def test_error_is_the_distance_from_the_interval(low: float, width: float, value: float) -> None:
    """Zero inside, relative to the nearer end outside, and independent of scale."""
    high = low * (1 + width)
    result = error(value, (low, high))
    if low <= value <= high:
        assert result == 0
    else:
        nearer = min(low, high, key=lambda end: abs(end - value))
        assert result == pytest.approx(abs(value / nearer - 1))
    assert error(4 * value, (4 * low, 4 * high)) == result


@pytest.mark.long
def test_errors_of_panels_refer_to_the_certified_interval() -> None:
    wall = accuracy_walls()["panel-04"]
    certified = ask("collapse", "limit-nonassociated", wall.scene, {})
    assert certified.status == "collapse"
    assert wall.interval() == (certified.lower, certified.upper)
    assert StudiedWall(wall.scene).interval() is None


# --- the measurement -----------------------------------------------------------------------------------------


def test_measurement_has_answer_seconds_and_memory() -> None:
    row = measure_apart(measure, ("stack-of-5", "dem-static", "", ""))
    assert row["value"] == pytest.approx(0.46, rel=1e-6)
    assert (row["blocks"], row["known"], row["runs"]) == (5, "exact", 3)
    assert row["error"] < 1e-6
    for name in ("wall_s", "cpu_s", "ratio"):
        assert 0 < row[f"{name}_min"] <= row[name] <= row[f"{name}_max"]
    assert 0 <= row["memory_mb"] < 200
    assert row["machine"] == machine()
    assert not any(part in row["machine"] for part in (os.uname().nodename, str(Path.home())))


def test_memory_of_a_run_excludes_what_was_allocated_before() -> None:
    script = (
        "from runningbond.studies.accuracy import measure\nimport numpy as np\nlarge = np.ones(20_000_000); del large\n"
        "held = measure.start_of_memory(); result = np.ones(5_000_000); print(measure.most_memory() - held)"
    )
    taken = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    if Path("/proc/self/clear_refs").exists():
        assert float(taken.stdout) == pytest.approx(40e6, rel=0.05)


# --- known answers -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["block-topples", "block-slides", "stack-of-5"])
def test_limit_analysis_finds_the_exact_multipliers(name: str) -> None:
    wall = accuracy_walls()[name]
    result = ask("collapse", "limit", wall.scene, {})
    assert wall.answer is not None
    assert result.value == pytest.approx(wall.answer[0], rel=1e-9)
    assert {"block-topples": 0.23 / 0.36, "block-slides": 0.497, "stack-of-5": 0.46}[name] == wall.answer[0]


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "loads"),
    [("wall-w1-inset", [0.58558]), ("wall-w2-inset", [0.52441]), ("wall-w3-inset", [0.33744, 0.34314])],
)
def test_published_multipliers_are_certified_to_their_last_digit(name: str, loads: list[float], tmp_path: Path) -> None:
    """Contacts moved inwards: one load is certified, and for W3 another; the smaller rounds to the published value.

    The script that shares no code with the suite confirms forces and mechanism at both loads.
    """
    wall = accuracy_walls()[name]
    outcome = limit_nonassociated(wall.scene)
    assert outcome.multiplier is not None
    assert outcome.lower == pytest.approx(loads[0], abs=5e-6)
    assert outcome.upper == pytest.approx(loads[-1], abs=5e-6)
    if len(loads) == 1:
        assert outcome.upper == pytest.approx(outcome.lower, rel=1e-6)
    save_outcome(outcome, tmp_path, scene=wall.scene)
    assert check(tmp_path)
    assert wall.answer is not None
    assert error(outcome.multiplier, wall.answer) == 0


@pytest.mark.parametrize("name", [name for name, wall in accuracy_walls().items() if name.startswith("cell-1e")])
def test_compressed_cell_is_blocks_and_joints_in_series(name: str) -> None:
    """Six modes, ten of blocks of 240 × 60 mm, and all are exact; rigid blocks are too stiff by k_n a / E."""
    wall = accuracy_walls()[name]
    assert wall.answer is not None
    assert wall.scene.bond is not None
    excess = joint_stiffness(wall.scene.joint).normal * wall.scene.bond.height / (wall.scene.block.young or 0.0)
    for modes in (6, 10, "all"):
        assert ask("compression", "fem", wall.scene, {"modes": modes}).value == pytest.approx(wall.answer[0], rel=1e-9)
    for model, settings in (("homog", {}), ("dem-static", {}), ("fem", {"modes": 3})):
        result = ask("compression", model, wall.scene, settings)
        assert result.value == pytest.approx(wall.answer[0] * (1 + excess), rel=1e-9)


def test_sheared_cell_of_rigid_blocks_has_the_closed_form() -> None:
    wall = accuracy_walls()["cell-shear"]
    assert wall.answer is not None
    for model, settings in (("dem-static", {}), ("fem", {"modes": 3}), ("fem", {"modes": 3, "cells": 2})):
        assert ask("shear", model, wall.scene, settings).value == pytest.approx(wall.answer[0], rel=1e-9)


@pytest.mark.parametrize("model", ["dem-dynamic", *at_length("fem")])
def test_rotated_block_resists_with_the_tangent_only_at_finite_displacements(model: str) -> None:
    wall = accuracy_walls()["turned-block"]
    assert wall.answer is not None
    assert ask("turned block", model, wall.scene, {}).value == pytest.approx(wall.answer[0], rel=1e-4)
    assert ask("turned block", model, wall.scene, {"drive": 100_000}).value == pytest.approx(0.1 / 0.4, rel=1e-3)


def test_slower_driving_reduces_the_error() -> None:
    wall = accuracy_walls()["stack-of-5"]
    errors = [
        ask("collapse", "dem-dynamic", wall.scene, {"drive": steps}).value / 0.46 - 1  # type: ignore[operator]
        for steps in (25_000, 100_000, 400_000)
    ]
    assert errors == sorted(errors, reverse=True)
    assert 0 < errors[-1] < 0.01


def test_mass_scaling_reduces_the_steps_of_a_physical_second() -> None:
    """By more than a factor of ten at 1000 GPa, and to nearly the number for rigid blocks."""
    wall = stiffness_walls()["stiff-1e12"]
    unscaled = {"mass_scaling": False}
    result = [
        ask("physical second", model, wall.scene, settings)
        for model, settings in (("fem", {}), ("fem", unscaled), ("dem-dynamic", {}))
    ]
    scaled, plain, rigid = (float(one.message.split()[2]) for one in result)
    assert scaled > 10 * plain
    assert scaled == pytest.approx(rigid, rel=0.05)
    for one in result:
        assert one.value is not None
        assert one.lower is not None
        assert one.upper is not None
        assert 0 < one.lower <= one.value <= one.upper


# --- cases of the study --------------------------------------------------------------------------------------


def test_every_case_is_unique_and_valid() -> None:
    assert len(set(STUDY.cases)) == len(STUDY.cases) > 150
    for _, (name, model, parameter, setting) in STUDY.cases:
        wall, settings = all_walls()[name], settings_of(model, parameter, setting)
        assert bool(settings) == bool(parameter)
        if wall.question == "collapse" and "drive" not in settings:
            assert {*settings} <= {"tolerance", *MODELS[model].parameters}


def test_every_parameter_is_varied() -> None:
    varied = {case[1:] for _, case in STUDY.cases}
    for parameter in PARAMETERS:
        for model in parameter.models:
            assert {(model, parameter.name, setting) for setting in parameter.settings} <= varied
    with pytest.raises(KeyError, match="limit has no parameter"):
        settings_of("limit", "cells", "2")


def test_walls_grow_by_factors_of_four() -> None:
    blocks = [wall.blocks for wall in growth_walls().values()]
    assert np.diff(np.log2(blocks)) == pytest.approx(2, abs=0.2)
    assert (blocks[0], blocks[-1]) == (21, 1176)


# --- tables --------------------------------------------------------------------------------------------------

points = st.lists(st.tuples(st.sampled_from([0.1, 0.2, 0.5, 1, 2]), st.sampled_from([0, 0.01, 0.1, 1])), min_size=1)


@given(points)
def test_pareto_front_dominates_all_other_points(result: Sequence[tuple[float, float]]) -> None:
    cost, error = zip(*result, strict=True)
    front = pareto_front(cost, error)
    assert all(np.diff([cost[i] for i in front]) > 0)
    assert all(np.diff([error[i] for i in front]) < 0)
    for j in range(len(result)):
        beaten = [i for i in front if cost[i] <= cost[j] and error[i] <= error[j]]
        assert beaten
        if j in front:
            assert beaten == [j]


def made_up(part: str, case: tuple[str, str, str, str]) -> Row:
    """A made-up row: cost and error depend on model and parameter, growth has the power 1.5."""
    name, model, parameter, setting = case
    wall, place = all_walls()[name], list(MODELS).index(model)
    seconds = (
        1e-4 * 4.0**place * wall.blocks**1.5 if part == "growth" else 0.01 * 4.0**place * (1.5 if parameter else 1)
    )
    off = 0.2 / 3.0**place * (4.0 if setting == "Gauss 2" else 1.0)
    low, high = wall.answer or ((0.5, 0.5) if wall.known else (None, None))
    row: Row = {"wall": name, "model": model, "parameter": parameter, "setting": setting, "machine": machine()}
    row |= {"blocks": wall.blocks, "question": wall.question, "known": wall.known, "status": "collapse", "runs": 3}
    row |= {"value": seconds if low is None else low * (1 + off), "error": None if low is None else off}
    row |= {"answer_low": low, "answer_high": high, "dofs": 3 * wall.blocks * (1 + place), "memory_mb": 1.0}
    return row | {"cpu_s": seconds, "cpu_s_min": 0.9 * seconds, "cpu_s_max": 1.2 * seconds, "ratio": seconds / 0.04}


def table() -> dict[str, list[Row]]:
    """A complete made-up table."""
    return {name: [made_up(name, case) for case in part.cases] for name, part in STUDY.parts.items()}


def changed(rows: Rows, part: str, which: tuple[str, str, str], **entries: object) -> dict[str, list[Row]]:
    """The rows with changed entries for one wall, model and parameter."""
    return {
        name: [
            row | entries if name == part and (row["wall"], row["model"], row["parameter"]) == which else row
            for row in own
        ]
        for name, own in rows.items()
    }


def test_model_with_zero_measured_time_is_listed() -> None:
    """On systems with a coarse processor clock, `homog` takes zero time."""
    free = {"cpu_s": 0.0, "ratio": 0.0}
    rows = {name: [row | free if row["model"] == "homog" else row for row in own] for name, own in table().items()}
    assert "homog" in [row[1] for row in models_table(rows).rows]


def test_cheapest_model_within_a_tolerance_is_found() -> None:
    """Errors 0.067, 0.022, 0.0074, … at rising cost; a model counts as exact on panels that it certified itself."""
    result = records(table(), VARIED)
    everything = tuple(MODELS)
    for tolerance, expected in ((0.1, "limit"), (0.05, "limit-nonassociated"), (0.01, "dem-static")):
        assert cheapest(result, tolerance, everything) == (expected, "", "")
    assert cheapest(result, 0.01, ("fem",)) == ("fem", "", "")
    assert cheapest(result, 1e-9, everything) is None
    assert result["limit-nonassociated", "", ""].own == ["panel-02"]
    assert "panel-02" not in result["limit-nonassociated", "", ""].all("wall")
    assert ["1 %", "follows a path", "dem-static", "16", "0.74 %"] in cheapest_table(table()).rows


@pytest.mark.parametrize("status", ["undecided", TOO_LONG])
def test_model_with_an_unanswered_wall_cannot_be_the_cheapest(status: str) -> None:
    rows = changed(table(), "accuracy", ("wall-w3-inset", "limit", ""), status=status, value=None, error=None)
    assert records(rows)["limit", "", ""].unanswered == ["wall-w3-inset"]
    assert cheapest(records(rows, VARIED), 0.1, ("limit",)) is None


def test_growth_exponent_is_recovered() -> None:
    for rows in growth(table()).values():
        assert exponent(rows) == pytest.approx(1.5, abs=1e-9)


def test_tables_show_the_values_of_the_rows() -> None:
    models = {row[1]: row for row in models_table(table()).rows}
    assert models["limit"][3:5] == ["6.7 %", "6.7 %"]
    assert models["limit"][6:8] == [str(models["limit"][2]), "0"]  # all errors are too high
    parameters = {tuple(row[:3]): row[3:] for row in parameters_table(table()).rows}
    assert parameters["fem", "joint rule", "Gauss 2"] == ["4", "0.33 %", "0.082 %", "1.5", "costs accuracy", ""]
    assert parameters["fem", "cells", "2"][4] == "cost alone"
    halved = {
        name: [row | {"error": row["error"] and row["error"] / 2} for row in own] for name, own in table().items()
    }
    assert {row[1]: row for row in models_table(halved).rows}["limit"][3] == "3.3 %"
    assert len(tables(table())) == 6
    assert tables({name: [] for name in STUDY.parts}) == []


def test_omitted_cases_are_reported() -> None:
    rows = changed(table(), "growth", ("square-48", "fem", ""), status=TOO_LONG, cpu_s=None)
    assert {row[0]: row[4] for row in growth_table(rows).rows}["fem"] == "left out: too long"


@pytest.mark.parametrize("largest", [TOO_LONG, None])
def test_chart_of_growth_says_too_long_only_of_what_was(largest: str | None) -> None:
    """A case that ended in an error has no status."""
    rows, figure = changed(table(), "growth", ("square-48", "fem", ""), status=largest, cpu_s=None), Figure()
    draw_growth(figure, rows)
    told = [text.get_text() for text in figure.legends[0].get_texts() if "more than" in text.get_text()]
    assert told == (["fem: 1.50; more than 60 s beyond 300"] if largest else [])


@pytest.mark.parametrize("chart", CHARTS[:2])
def test_charts_do_not_judge_a_model_by_its_own_certificates(chart: Chart) -> None:
    figure = Figure(figsize=chart.size)
    chart.draw(figure, table())
    colour = MODEL_LOOKS["limit-nonassociated"][0]
    drawn = {
        axes.get_title(loc="left"): any(line.get_color() == colour for line in axes.get_lines()) for axes in figure.axes
    }
    assert drawn == {title: "certified" not in title for title in TITLES.values()}


def test_rigid_blocks_are_too_stiff_by_the_ratio_of_joint_and_block() -> None:
    """Stiffness ratio k_n a / E: 62.5, 6.25 and 0.625 %."""
    edges = fits(table())
    assert [edge.theory for edge in edges] == pytest.approx([0.625, 0.0625, 0.00625])


# --- the page ------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The page of a made-up table, and its charts."""
    folder = tmp_path_factory.mktemp("study")
    return write_page("study", page(table(), folder), folder, STUDY.name)


def test_charts_are_not_blank(written: list[Path], tmp_path: Path) -> None:
    assert [path.stem for path in written[2:]] == [chart.name for chart in STUDY.charts]
    assert len(written[2:]) == 4
    for path in written[2:]:
        image = imread(path)[:, :, :3]
        assert min(image.shape[:2]) > 600
        assert 0.01 < (image.min(axis=2) < 0.95).mean() < 0.5
        assert len(np.unique(image @ [1, 256, 65536])) > 100
    assert draw_charts(STUDY, {name: [] for name in STUDY.parts}, tmp_path / "none") == []


def test_labels_overlap_neither_each_other_nor_marks(tmp_path: Path) -> None:
    """Over degrees of freedom, all settings of a model lie above each other with similar errors."""
    rows = table()
    rows["accuracy"] = [
        row | {"error": row["error"] * (1.0 + 2.0 * (k % 7)) if row["parameter"] else row["error"] / 50}
        for k, row in enumerate(rows["accuracy"])
        if row["error"]
    ]
    figure = Figure((8, 4.6), layout="constrained")
    STUDY.charts[1].draw(figure, rows)
    figure.draw_without_rendering()
    for axes in figure.axes:
        names = [Text.get_window_extent(text) for text in axes.texts]  # without the leader lines
        assert len(names) > 4
        assert not any(one.overlaps(other) for one, other in combinations(names, 2))
        marks = np.concatenate(
            [axes.transData.transform(line.get_xydata()) for line in axes.lines if line.get_marker() in MARKS.values()]
        )
        assert not any(box.contains(*mark) for box in names for mark in marks)


def test_page_has_all_parts_of_the_study(written: list[Path]) -> None:
    text, html = (path.read_text() for path in written[:2])
    for path in written[2:]:
        assert f"]({path.name})" in text
    assert [path.name for path in written[:2]] == ["study.md", "report.html"]
    assert "http" not in html
    assert html.count("<img") == len(STUDY.charts)
    assert f"Measured on {machine()}: {len(STUDY.cases)} of {len(STUDY.cases)} cases." in text
    for sheet in tables(table()):
        assert sheet.markdown() in text
    assert label(("fem", "cells", "2")) == "fem, cells 2"


def test_study_with_no_process_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["study", "--jobs", "0"]) == 2
    assert "--jobs" in capsys.readouterr().err


def test_study_folder_that_is_a_file_is_refused_before_measuring(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "taken").touch()
    assert command(["study", "--out", str(tmp_path / "taken")]) == 2
    printed = capsys.readouterr().err
    assert "is not a folder; name one" in printed
    assert len(printed.splitlines()) == 1
