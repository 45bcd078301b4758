"""The study of accuracy against cost: its table, its known answers, its fits, its charts and what it concludes."""

import inspect
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.image import imread

from runningbond.commands.command_line import command
from runningbond.joints import joint_stiffness
from runningbond.studies.accuracy import Case, Row, all_cases, read_csv, run_study, study
from runningbond.studies.accuracy.answer import Answer
from runningbond.studies.accuracy.cases import wall_of
from runningbond.studies.accuracy.charts import CHARTS, draw_charts
from runningbond.studies.accuracy.conclusions import conclusions
from runningbond.studies.accuracy.findings import cheapest, exponent, growth, label, records, sheets
from runningbond.studies.accuracy.fits import pareto_front, slope
from runningbond.studies.accuracy.measure import Killed, Measurement, TooLong, machine, measure_apart
from runningbond.studies.accuracy.page import CAPTIONS, write_page
from runningbond.studies.accuracy.parameters import KNOBS, VARIED, settings_of
from runningbond.studies.accuracy.questions import MODELS, ask
from runningbond.studies.accuracy.rows import FAILED, TOO_LONG, csv_text, distance, with_errors
from runningbond.studies.accuracy.walls import accuracy_walls, growth_walls, stiffness_walls

ROOT = Path(__file__).parent.parent
CASES = [Case("accuracy", wall, model) for wall in ("stack-of-5", "panel-02") for model in ("limit", "dem-static")]


def answered(case: Case, stop: threading.Event) -> Measurement:
    """An answer made up for the test."""
    said = Answer("collapse", 0.5, 0.4, 0.5, 15, 7, "a message, with a comma")
    return Measurement(said, (0.3, 0.1, 0.2), (0.2, 0.2, 0.2), (4.0, 2.0, 9.0), 1.5)


def remembering(seen: list[Case]) -> Callable[[Case, threading.Event], Measurement]:
    """The same, with a list of what was measured."""

    def measure(case: Case, stop: threading.Event) -> Measurement:
        seen.append(case)
        return answered(case, stop)

    return measure


def row(wall: str, model: str, knob: str = "", setting: str = "", **found: object) -> Row:
    """A row of the accuracy study, of an exact answer of 1."""
    plain = Row("accuracy", wall, 5, "collapse", model, knob, setting, "exact", 1.0, 1.0, status="collapse")
    return replace(plain, **found)  # type: ignore[arg-type]


# --- the table -----------------------------------------------------------------------------------------------

numbers = st.none() | st.floats(allow_nan=False, allow_infinity=False)
counts = st.none() | st.integers(0, 10**9)


@given(numbers, numbers, counts, st.text(st.characters(codec="utf-8", exclude_characters="\r\0")))
def test_a_table_gives_its_rows_back_to_the_last_bit(
    value: float | None, seconds: float | None, steps: int | None, message: str
) -> None:
    rows = [row("stack-of-5", "fem", "cells", "2", value=value, cpu_s=seconds, steps=steps, message=message)] * 2
    assert read_csv(csv_text(rows)) == rows


@pytest.mark.parametrize(
    "damage", [lambda text: text[:-40], lambda text: text.replace("15,7", "fifteen,7"), lambda text: ""]
)
def test_a_damaged_table_is_measured_anew(damage: Callable[[str], str], tmp_path: Path) -> None:
    run_study(tmp_path, cases=CASES[:1], measure=answered)
    path = tmp_path / "study.csv"
    path.write_text(damage(path.read_text()))
    seen: list[Case] = []
    assert len(run_study(tmp_path, cases=CASES[:1], measure=remembering(seen))) == len(seen) == 1


def test_a_table_with_other_columns_is_of_an_older_study() -> None:
    text = csv_text([row("stack-of-5", "limit")])
    assert read_csv(text.replace("memory_mb", "memory", 1)) == []
    assert len(read_csv(text)) == 1


@given(st.floats(0.01, 10), st.floats(0, 1), st.floats(0.01, 10))
def test_error_is_the_distance_from_the_interval(low: float, width: float, value: float) -> None:
    """Zero inside, relative to the nearer end outside, and the same when everything is scaled."""
    high = low * (1 + width)
    error = distance(value, (low, high))
    if low <= value <= high:
        assert error == 0
    else:
        nearer = min(low, high, key=lambda end: abs(end - value))
        assert error == pytest.approx(abs(value / nearer - 1))
    assert distance(4 * value, (4 * low, 4 * high)) == error


def test_errors_of_panels_are_from_the_certified_interval_whatever_the_order() -> None:
    panel = replace(row("panel-02", "dem-static", value=0.44), known="certified", answer_low=None, answer_high=None)
    judge = replace(panel, model="limit-nonassociated", value=0.48, lower=0.48, upper=0.5)
    inside = replace(panel, model="fem", value=0.49)
    for rows in ([panel, judge, inside], [judge, inside, panel]):
        found = {one.model: one for one in with_errors(rows)}
        assert found["dem-static"].error == pytest.approx(0.04 / 0.48)
        assert (found["fem"].answer_low, found["fem"].answer_high) == (0.48, 0.5)
        assert found["fem"].error == found["limit-nonassociated"].error == 0
    undecided = replace(judge, status="undecided", value=None, lower=None)
    assert all(one.error is None for one in with_errors([panel, undecided, inside]))


# --- the run -------------------------------------------------------------------------------------------------


def test_a_study_measures_nothing_twice(tmp_path: Path) -> None:
    seen: list[Case] = []
    first = run_study(tmp_path, cases=CASES[:2], measure=remembering(seen))
    rows = run_study(tmp_path, cases=CASES, measure=remembering(seen))
    assert seen == CASES
    assert rows[:2] == first
    assert read_csv((tmp_path / "study.csv").read_text()) == rows
    assert (rows[0].wall_s, rows[0].wall_s_min, rows[0].wall_s_max, rows[0].runs) == (0.2, 0.1, 0.3, 3)
    assert (rows[0].ratio, rows[0].ratio_min, rows[0].ratio_max) == (4, 2, 9)
    assert rows[0].error == pytest.approx(0.5 / 0.46 - 1)
    assert rows[0].machine == machine()
    assert not any(part in rows[0].machine for part in (os.uname().nodename, str(Path.home())))


def test_other_code_or_another_machine_is_measured_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_study(tmp_path, cases=CASES, measure=answered)
    monkeypatch.setattr(study, "machine", lambda: "another")
    seen: list[Case] = []
    run_study(tmp_path, cases=CASES[:1], measure=remembering(seen))
    assert seen == CASES[:1]
    assert len(read_csv((tmp_path / "study.csv").read_text())) == 1


@pytest.mark.parametrize("jobs", [1, 3])
def test_an_interrupted_study_goes_on_where_it_was(jobs: int, tmp_path: Path) -> None:
    def stopped(case: Case, stop: threading.Event) -> Measurement:
        if case == CASES[-1]:
            raise KeyboardInterrupt
        return answered(case, stop)

    with pytest.raises(KeyboardInterrupt):
        run_study(tmp_path, cases=CASES, jobs=jobs, measure=stopped)
    kept = read_csv((tmp_path / "study.csv").read_text()) if (tmp_path / "study.csv").exists() else []
    assert len(kept) == 3 or jobs > 1
    seen: list[Case] = []
    run_study(tmp_path, cases=CASES, measure=remembering(seen))
    assert set(seen) == set(CASES) - {one.case for one in kept}


def test_a_killed_case_is_measured_anew(tmp_path: Path) -> None:
    """Its process is killed from outside; the others' rows stay."""
    dear = Case("growth", "square-48", "dem-static")

    def kill() -> None:
        while True:
            for process in psutil.Process().children():
                if "square-48" in process.cmdline():
                    process.kill()
                    return
            time.sleep(0.05)

    killer = threading.Thread(target=kill)
    killer.start()
    rows = run_study(tmp_path, cases=[CASES[0]], measure=answered)
    rows = run_study(tmp_path, cases=[dear])
    killer.join()
    assert [one.status for one in rows] == ["collapse", FAILED]
    assert "signal 9" in rows[1].message
    seen: list[Case] = []
    rows = run_study(tmp_path, cases=[CASES[0], dear], measure=remembering(seen))
    assert seen == [dear]
    assert [one.status for one in rows] == ["collapse", "collapse"]


def test_a_run_that_takes_too_long_is_left_out_and_not_tried_again(tmp_path: Path) -> None:
    def slow(case: Case, stop: threading.Event) -> Measurement:
        raise TooLong("more than 60 s")

    rows = run_study(tmp_path, cases=CASES[:1], measure=slow)
    assert (rows[0].status, rows[0].cpu_s) == (TOO_LONG, None)
    assert run_study(tmp_path, cases=CASES[:1], measure=answered) == rows


def test_the_system_ends_a_run_that_works_too_long() -> None:
    script = (
        "from runningbond.studies.accuracy import measure\nmeasure.LONGEST = 1\nmeasure._limit_time()\nwhile True: pass"
    )
    ended = subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=False)
    assert ended.returncode == -signal.SIGXCPU


def test_a_process_that_breaks_says_why() -> None:
    with pytest.raises(Killed, match="KeyError: 'no such wall'"):
        measure_apart(Case("accuracy", "no such wall", "limit"))


def test_a_measurement_has_its_answer_its_seconds_and_its_memory() -> None:
    found = measure_apart(Case("accuracy", "stack-of-5", "dem-static"))
    assert found.answer.value == pytest.approx(0.46, rel=1e-6)
    assert len(found.wall_s) == len(found.cpu_s) == 3
    assert len(found.ratio) == 3
    assert min(found.ratio) > 0
    assert min(found.wall_s) > 0
    assert min(found.cpu_s) > 0
    assert found.memory_mb is not None
    assert 0 <= found.memory_mb < 200


def test_memory_is_what_a_run_takes_beyond_what_was_held() -> None:
    script = (
        "from runningbond.studies.accuracy import measure\nimport numpy as np\nlarge = np.ones(20_000_000); del large\n"
        "held = measure._start_of_memory(); found = np.ones(5_000_000); print(measure._most_memory() - held)"
    )
    taken = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=True)
    if Path("/proc/self/clear_refs").exists():
        assert float(taken.stdout) == pytest.approx(40e6, rel=0.05)


# --- known answers -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["block-topples", "block-slides", "stack-of-5"])
def test_limit_analysis_finds_the_exact_multipliers(name: str) -> None:
    wall = accuracy_walls()[name]
    found = ask("collapse", "limit", wall.scene, {})
    assert wall.answer is not None
    assert found.value == pytest.approx(wall.answer[0], rel=1e-9)
    assert {"block-topples": 0.23 / 0.36, "block-slides": 0.497, "stack-of-5": 0.46}[name] == wall.answer[0]


@pytest.mark.parametrize("name", ["wall-w1-inset", "wall-w2-inset", "wall-w3-inset"])
def test_published_multipliers_are_certified_to_their_last_digit(name: str) -> None:
    """With contacts moved in, the interval of certified loads is a point, and rounds to what was published."""
    wall = accuracy_walls()[name]
    found = ask("collapse", "limit-nonassociated", wall.scene, {})
    assert found.value is not None
    assert found.upper == pytest.approx(found.lower, rel=1e-6)
    assert wall.answer is not None
    assert distance(found.value, wall.answer) == 0


@pytest.mark.parametrize("name", [name for name, wall in accuracy_walls().items() if name.startswith("cell-1e")])
def test_a_compressed_cell_is_blocks_and_joints_in_series(name: str) -> None:
    """Six modes and more are exact; rigid blocks are too stiff by k_n a / E."""
    wall = accuracy_walls()[name]
    assert wall.answer is not None
    assert wall.scene.bond is not None
    excess = joint_stiffness(wall.scene.joint).normal * wall.scene.bond.height / (wall.scene.block.young or 0.0)
    for modes in (6, 10, "all"):
        assert ask("compression", "fem", wall.scene, {"modes": modes}).value == pytest.approx(wall.answer[0], rel=1e-9)
    for model, settings in (("homog", {}), ("dem-static", {}), ("fem", {"modes": 3})):
        found = ask("compression", model, wall.scene, settings)
        assert found.value == pytest.approx(wall.answer[0] * (1 + excess), rel=1e-9)


def test_a_sheared_cell_of_rigid_blocks_has_the_closed_form() -> None:
    wall = accuracy_walls()["cell-shear"]
    assert wall.answer is not None
    for model, settings in (("dem-static", {}), ("fem", {"modes": 3}), ("fem", {"modes": 3, "cells": 2})):
        assert ask("shear", model, wall.scene, settings).value == pytest.approx(wall.answer[0], rel=1e-9)


@pytest.mark.parametrize("model", ["dem-dynamic", "fem"])
def test_a_block_turned_far_bears_the_tangent_and_small_displacements_do_not_know(model: str) -> None:
    wall = accuracy_walls()["turned-block"]
    assert wall.answer is not None
    assert ask("turned block", model, wall.scene, {"speed": 4e-3}).value == pytest.approx(wall.answer[0], rel=1e-3)
    assert ask("turned block", model, wall.scene, {"drive": 100_000}).value == pytest.approx(0.1 / 0.4, rel=1e-3)


def test_the_slower_a_wall_is_driven_the_nearer_it_comes() -> None:
    wall = accuracy_walls()["stack-of-5"]
    errors = [
        ask("collapse", "dem-dynamic", wall.scene, {"drive": steps}).value / 0.46 - 1  # type: ignore[operator]
        for steps in (25_000, 100_000, 400_000)
    ]
    assert errors == sorted(errors, reverse=True)
    assert 0 < errors[-1] < 0.01


def test_a_physical_second_of_stiff_blocks_takes_fewer_steps_with_scaled_masses() -> None:
    """More than ten times fewer at 1000 GPa, and nearly as few as rigid blocks take."""
    wall = stiffness_walls()["stiff-1e12"]
    unscaled = {"mass_scaling": False}
    found = [
        ask("physical second", model, wall.scene, settings)
        for model, settings in (("fem", {}), ("fem", unscaled), ("dem-dynamic", {}))
    ]
    scaled, plain, rigid = (float(one.message.split()[2]) for one in found)
    assert scaled > 10 * plain
    assert scaled == pytest.approx(rigid, rel=0.05)
    for one in found:
        assert one.value is not None
        assert one.lower is not None
        assert one.upper is not None
        assert 0 < one.lower <= one.value <= one.upper


# --- what there is to measure --------------------------------------------------------------------------------


def test_every_case_is_measured_once_and_can_be() -> None:
    cases = all_cases()
    assert len(set(cases)) == len(cases) > 150
    for case in cases:
        wall, settings = wall_of(case), settings_of(case.model, case.knob, case.setting)
        assert bool(settings) == bool(case.knob)
        if wall.question == "collapse" and "drive" not in settings:
            inspect.signature(MODELS[case.model]).bind(wall.scene, **settings)


def test_every_knob_is_turned_somewhere() -> None:
    turned = {(case.model, case.knob, case.setting) for case in all_cases()}
    for knob in KNOBS:
        for model in knob.models:
            assert {(model, knob.name, setting) for setting in knob.settings} <= turned
    with pytest.raises(KeyError, match="limit has no knob"):
        settings_of("limit", "cells", "2")


def test_walls_grow_four_times_at_a_time() -> None:
    blocks = [wall.blocks for wall in growth_walls().values()]
    assert np.diff(np.log2(blocks)) == pytest.approx(2, abs=0.2)
    assert (blocks[0], blocks[-1]) == (21, 1176)


# --- fits ----------------------------------------------------------------------------------------------------

points = st.lists(st.tuples(st.sampled_from([0.1, 0.2, 0.5, 1, 2]), st.sampled_from([0, 0.01, 0.1, 1])), min_size=1)


@given(points)
def test_nothing_beats_the_pareto_front_and_it_beats_everything_else(found: Sequence[tuple[float, float]]) -> None:
    cost, error = zip(*found, strict=True)
    front = pareto_front(cost, error)
    assert all(np.diff([cost[i] for i in front]) > 0)
    assert all(np.diff([error[i] for i in front]) < 0)
    for j in range(len(found)):
        beaten = [i for i in front if cost[i] <= cost[j] and error[i] <= error[j]]
        assert beaten
        if j in front:
            assert beaten == [j]


@given(st.floats(-1, 4), st.floats(1e-6, 1e3))
def test_slopes_fit_powers_exactly(power: float, unit: float) -> None:
    sizes = [20, 80, 300, 1200]
    assert slope(sizes, [unit * size**power for size in sizes]) == pytest.approx(power, abs=1e-9)


# --- what it concludes ---------------------------------------------------------------------------------------


def table() -> list[Row]:
    """A whole table made up: cost and error by model and knob, growth with the power 1.5, steps ever shorter."""
    rows = []
    for case in all_cases():
        wall = wall_of(case)
        place = ("homog", "limit", "limit-nonassociated", "dem-static", "dem-dynamic", "fem").index(case.model)
        seconds = 0.01 * 4.0**place * (1.5 if case.knob else 1.0)
        error = 0.2 / 3.0**place * (4.0 if case.setting == "Gauss 2" else 1.0)
        if case.part == "growth":
            seconds = 1e-4 * 4.0**place * wall.blocks**1.5
        low, high = wall.answer or ((0.5, 0.5) if wall.known else (None, None))
        value = seconds if low is None else low * (1 + error)
        about = (case.part, case.wall, wall.blocks, wall.question, case.model, case.knob, case.setting)
        rows.append(
            Row(
                *about,
                wall.known,
                low,
                high,
                "collapse",
                value,
                low,
                high,
                None if low is None else error,
                3 * wall.blocks * (1 + place),
                steps=10,
                runs=3,
                wall_s=seconds,
                cpu_s=seconds,
                cpu_s_min=0.9 * seconds,
                cpu_s_max=1.2 * seconds,
                ratio=seconds / 0.04,
                memory_mb=1.0,
                machine=machine(),
            )
        )
    return rows


def test_the_cheapest_within_a_tolerance_is_found() -> None:
    """Errors 0.067, 0.022, 0.0074, … at ever greater cost; the model that certified a panel counts as within there."""
    found = records(table(), VARIED)
    everything = tuple(MODELS)
    for tolerance, expected in ((0.1, "limit"), (0.05, "limit-nonassociated"), (0.01, "dem-static")):
        assert cheapest(found, tolerance, VARIED, everything) == (expected, "", "")
    assert cheapest(found, 0.01, VARIED, ("fem",)) == ("fem", "", "")
    assert cheapest(found, 1e-9, VARIED, everything) is None
    assert found["limit-nonassociated", "", ""].own == ["panel-02"]
    assert "panel-02" not in found["limit-nonassociated", "", ""].walls


def test_a_wall_without_a_number_is_named_and_keeps_a_model_from_being_cheapest() -> None:
    rows = [
        replace(one, status="undecided", value=None, error=None)
        if (one.wall, one.model, one.knob) == ("wall-w3-inset", "limit", "")
        else one
        for one in table()
    ]
    assert records(rows)["limit", "", ""].unanswered == ["wall-w3-inset"]
    assert cheapest(records(rows, VARIED), 0.1, VARIED, ("limit",)) is None


def test_growth_has_its_power() -> None:
    for rows in growth(table()).values():
        assert exponent(rows) == pytest.approx(1.5, abs=1e-9)


def test_conclusions_come_from_the_table() -> None:
    text = "\n".join(conclusions(table()))
    assert "**A bound at once: `limit`.** Error of 6.7 % in the median" in text
    assert re.search(r"Within 1 % on each .* `dem-static` that follows a path \(16 times `limit`\)", text)
    assert "`fem, joint rule Gauss 2` 0.33 % instead of 0.082 % at 1.5 times the cost" in text
    assert "`limit` 1.50" in text
    halved = [replace(one, error=one.error / 2) if one.error is not None else one for one in table()]
    assert "**A bound at once: `limit`.** Error of 3.3 % in the median" in "\n".join(conclusions(halved))
    assert conclusions([]) == []
    assert sheets([]) == []


def test_cases_left_out_are_said_to_be() -> None:
    rows = [
        replace(one, status=TOO_LONG, cpu_s=None) if (one.wall, one.model) == ("square-48", "fem") else one
        for one in table()
    ]
    assert "Left out, for a run takes more than a minute: `fem` on 1176." in "\n".join(conclusions(rows))


def test_charts_are_not_blank(tmp_path: Path) -> None:
    found = draw_charts(table(), tmp_path)
    assert [path.stem for path in found] == list(CHARTS) == list(CAPTIONS)
    for path in found:
        image = imread(path)[:, :, :3]
        assert min(image.shape[:2]) > 600
        inked = (image.min(axis=2) < 0.95).mean()
        assert 0.01 < inked < 0.5
        assert len(np.unique(image.reshape(-1, 3), axis=0)) > 100
    assert draw_charts([], tmp_path / "none") == []


def test_the_page_needs_nothing_but_its_charts(tmp_path: Path) -> None:
    rows = table()
    written = write_page(rows, tmp_path)
    text = (tmp_path / "study.md").read_text()
    page = (tmp_path / "report.html").read_text()
    for chart in (path for path in written if path.suffix == ".png"):
        assert f"]({chart.name})" in text
    assert "http" not in page
    assert page.count("<img") == len(CHARTS)
    for sentence in conclusions(rows):
        assert sentence in text
    assert machine() in text
    assert page.count("<tr>") > len(rows)
    assert label(("fem", "cells", "2")) == "fem, cells 2"


def test_a_study_in_no_process_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["study", "--jobs", "0"]) == 2
    assert "--jobs" in capsys.readouterr().err
