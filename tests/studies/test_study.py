"""A study stores each row as it is measured, resumes, and reads only rows that it can trust."""

import csv
import io
import math
import re
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import psutil
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.figure import Figure

from runningbond.pictures.sheet import Sheet
from runningbond.studies import Chart, Edge, Part, Row, Rows, Study, apart, store
from runningbond.studies.apart import TOO_LONG, Ended, measure_apart
from runningbond.studies.page import LONG, agreement, edges_sheet, section, write_page
from runningbond.studies.store import csv_text, failures, is_complete, read_csv, run_study, table_path
from runningbond.studies.study import FAILURE, all_rows

ROOT = Path(__file__).parents[2]
DONE: list[tuple[int, str]] = []
CASES = [(1, "short"), (2, "long"), (3, "long")]


def measure(load: int, beam: str) -> Row:
    """A made-up row, with a record that it was measured."""
    DONE.append((load, beam))
    return {"measured": float(load), "theory": 1.0, "allowed": 1e-3, "sag [m]": 0.5 * load, "curve": [0.0, load]}


def draw(figure: Figure, rows: Rows) -> None:
    figure.add_subplot().plot([row["load [N]"] for row in rows["Beams"]])


def fits(rows: Rows) -> list[Edge]:
    return [Edge("largest sag [m]", max(row["sag [m]"] for row in rows["Beams"]))]


BEAMS = Study(
    "beams",
    "Beams | and loads",
    {"Beams": Part(("load [N]", "beam"), CASES, measure)},
    [Chart("Sag of beams", draw)],
    trusted="loads are small",
    beyond="they fall",
    fits=fits,
)


@pytest.fixture(autouse=True)
def _nothing_done() -> Iterator[None]:
    DONE.clear()
    yield
    DONE.clear()


entries = st.none() | st.booleans() | st.integers(-(10**9), 10**9) | st.floats(allow_nan=False)
words = st.text(st.characters(codec="utf-8", exclude_characters="\r\0"))


@given(entries | words, entries | words, st.lists(entries))
def test_table_returns_its_rows_bitwise(one: object, other: object, many: list[object]) -> None:
    row = {"load [N]": 1, "one": one, "other": other, "many": many}
    kept = list(read_csv(csv_text(BEAMS, {("Beams", CASES[0]): row})).values())
    assert kept == [{head: entry for head, entry in row.items() if entry is not None and entry != ""}]
    assert repr(kept[0]["many"]) == repr(many)


def test_case_words_are_unquoted_in_the_table_and_read_as_words(tmp_path: Path) -> None:
    cases = [("2", ""), ("all", "off")]
    study = replace(BEAMS, parts={"Beams": Part(("modes", "scaling"), cases, lambda *case: {"answer": "3"})})
    rows = run_study(study, tmp_path)["Beams"]
    assert run_study(study, tmp_path)["Beams"] == rows
    assert rows == [{"modes": modes, "scaling": scaling, "answer": "3"} for modes, scaling in cases]
    assert table_path(study, tmp_path).read_text().splitlines()[1].startswith('Beams,2,,"""3""",')


def test_numpy_numbers_are_stored_as_numbers() -> None:
    row = {"load [N]": 1, "int": np.int64(3), "float": np.float64(0.5), "single": np.float32(0.25)}
    (kept,) = read_csv(csv_text(BEAMS, {("Beams", CASES[0]): row})).values()
    assert kept == {"load [N]": 1, "int": 3, "float": 0.5, "single": 0.25}
    assert {type(entry) for entry in kept.values()} == {int, float}


def test_study_measures_each_case_once(tmp_path: Path) -> None:
    said: list[str] = []
    few = replace(BEAMS, parts={"Beams": replace(BEAMS.parts["Beams"], cases=CASES[1:])})
    first = run_study(few, tmp_path)
    assert not is_complete(BEAMS, tmp_path)
    rows = run_study(BEAMS, tmp_path, progress=said.append)
    assert [*CASES[1:], CASES[0]] == DONE
    assert rows["Beams"][1:] == first["Beams"]
    assert is_complete(BEAMS, tmp_path)
    assert said == ["beams, 2, long", "beams, 3, long", "beams, 1, short"]
    assert run_study(BEAMS, tmp_path) == rows
    assert len(DONE) == 3


def _cut(text: str) -> str:
    return text[:-10]


def _changed(text: str) -> str:
    return text.replace("0.5", "0.6")


def _unquoted(text: str) -> str:
    return text.replace('"', "")


def _renamed(text: str) -> str:
    return text.replace("measured,theory", "theory,measured", 1)


def _left_open(text: str) -> str:
    return text + '"' + "0" * csv.field_size_limit() + "\n"


@pytest.mark.parametrize(
    "damage", [_cut, _changed, _unquoted, _renamed, _left_open, lambda text: "", lambda text: "\0"]
)
def test_damaged_table_is_measured_again(damage: Callable[[str], str], tmp_path: Path) -> None:
    rows = run_study(BEAMS, tmp_path)
    path = table_path(BEAMS, tmp_path)
    path.write_text(damage(path.read_text()))
    DONE.clear()
    assert run_study(BEAMS, tmp_path) == rows
    assert DONE


def test_rows_of_other_code_or_machine_are_measured_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_study(BEAMS, tmp_path)
    run_study(replace(BEAMS, depends=lambda case: "another machine"), tmp_path)
    assert len(DONE) == 6
    monkeypatch.setattr(store, "sources_digest", lambda sources: "other code")
    run_study(BEAMS, tmp_path)
    assert len(DONE) == 9


@pytest.mark.parametrize("jobs", [1, 3])
def test_interrupted_study_resumes(jobs: int, tmp_path: Path) -> None:
    def stopped(load: int, beam: str) -> Row:
        if load == 3:
            raise KeyboardInterrupt
        return measure(load, beam)

    part = BEAMS.parts["Beams"]
    with pytest.raises(KeyboardInterrupt):
        run_study(replace(BEAMS, parts={"Beams": replace(part, measure=stopped)}), tmp_path, jobs=jobs)
    path = table_path(BEAMS, tmp_path)
    kept = len(path.read_text().splitlines()) - 1 if path.exists() else 0
    assert kept == 2 or jobs > 1
    DONE.clear()
    run_study(BEAMS, tmp_path)
    assert len(DONE) == 3 - kept


def test_failing_case_is_reported_and_retried_without_losing_others(tmp_path: Path) -> None:
    def broken(load: int, beam: str) -> Row:
        if load == 2:
            raise ZeroDivisionError("division by zero")
        return measure(load, beam)

    part = BEAMS.parts["Beams"]
    rows = run_study(replace(BEAMS, parts={"Beams": replace(part, measure=broken)}), tmp_path)
    assert failures(rows) == ["2, long, ZeroDivisionError: division by zero"]
    assert len(DONE) == 2
    assert not failures(run_study(BEAMS, tmp_path))
    assert len(DONE) == 3


# --- separate processes --------------------------------------------------------------------------------------


def echo(seconds: float, words: str) -> Row:
    """Return its argument after some seconds."""
    time.sleep(seconds)
    return {"words": words}


def broken(*case: object) -> Row:
    raise KeyError("no such wall")


def test_case_is_measured_in_another_process() -> None:
    assert measure_apart(echo, (0.0, 'a "λ"')) == {"words": 'a "λ"'}


def test_failing_process_reports_its_error() -> None:
    with pytest.raises(Ended, match="KeyError: 'no such wall'"):
        measure_apart(broken, ())


@pytest.mark.long
def test_killed_case_is_measured_again(tmp_path: Path) -> None:
    """The process is killed from outside."""

    def kill() -> None:
        while True:
            for process in psutil.Process().children():
                if any("be killed" in word for word in process.cmdline()):
                    process.kill()
                    return
            time.sleep(0.05)

    study = replace(BEAMS, parts={"Beams": Part(("seconds", "words"), [(1.5, "to be killed")], echo)}, apart=True)
    killer = threading.Thread(target=kill)
    killer.start()
    rows = run_study(study, tmp_path)["Beams"]
    killer.join()
    assert "signal 9" in rows[0][FAILURE]
    assert run_study(study, tmp_path)["Beams"] == [{"seconds": 1.5, "words": "to be killed"}]


def test_stopped_study_ends_its_processes() -> None:
    stop = threading.Event()
    threading.Timer(0.3, stop.set).start()
    with pytest.raises(KeyboardInterrupt):
        measure_apart(echo, (60.0, "to be stopped"), stop)
    assert not [process for process in psutil.Process().children() if "to be stopped" in "".join(process.cmdline())]


def test_run_over_its_time_is_ended_by_the_system() -> None:
    script = "from runningbond.studies import apart\napart.LONGEST = 1\napart.limit_time()\nwhile True: pass"
    ended = subprocess.run([sys.executable, "-c", script], cwd=ROOT, check=False)
    assert ended.returncode == apart.ENDED


def test_run_over_its_time_is_omitted_and_not_retried(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "measure_apart", lambda *_: {"status": TOO_LONG})
    study = replace(BEAMS, apart=True)
    rows = run_study(study, tmp_path)
    assert [row["status"] for row in rows["Beams"]] == [TOO_LONG] * 3
    monkeypatch.setattr(store, "measure_apart", apart.measure_apart)
    assert run_study(study, tmp_path) == rows


# --- edges, tables and pages ---------------------------------------------------------------------------------


def test_edges_agree_to_the_tolerance_that_the_study_allows() -> None:
    edges = [Edge("a", 1.0009, 1.0, 1e-3), Edge("b", 1.002, 1.0, 1e-3), Edge("c", 2.0), Edge("d", 2.0, 1.0)]
    assert [edge.agrees for edge in edges] == [True, False, None, None]
    assert agreement(edges) == "1 of 2 as theory has them"
    assert agreement(edges[2:]) == "2 measured"
    rows = edges_sheet(edges).rows
    assert rows[0] == ["a", "1.0009", "1", "0.09 %", "0.1 %"]
    assert rows[1][3] == "0.2 %, does not agree"
    assert rows[2][2:] == ["–", "–", "–"]


def test_count_that_must_be_zero_agrees_only_with_zero() -> None:
    edges = [Edge("wrong answers", 0, 0.0, 0.0), Edge("wrong answers", 2, 0.0, 0.0)]
    assert [edge.agrees for edge in edges] == [True, False]
    assert edges_sheet(edges).rows[0][1:] == ["0", "0", "0 %", "0 %"]


def test_a_row_with_a_measurement_is_an_edge(tmp_path: Path) -> None:
    edges = BEAMS.edges(run_study(BEAMS, tmp_path))
    assert [edge.agrees for edge in edges] == [True, False, False, None]
    assert edges[0].what == "Beams: 1, short"


def test_tables_omit_lists_and_empty_columns() -> None:
    rows = [{"wall": "W1", "λ": math.inf, "curve": [1, 2], "none": None}, {"wall": "W2", "λ": 0.123456789}]
    (sheet,) = all_rows({"Walls": rows})
    assert (sheet.title, sheet.heads) == ("Walls", ["wall", "λ"])
    assert sheet.rows == [["W1", "inf"], ["W2", "0.12346"]]


def test_page_needs_only_its_charts(tmp_path: Path) -> None:
    rows = run_study(BEAMS, tmp_path)
    written = write_page("beams", ["# All **beams**", *section(BEAMS, rows, tmp_path)], tmp_path, "all")
    assert [path.name for path in written] == ["all.md", "report.html", "beams.png"]
    text, page = (path.read_text() for path in written[:2])
    assert "![Sag of beams](beams.png)" in text
    assert "## Beams | and loads" in text
    assert "| Beams: 2, long | 2 | 1 | 1e+02 %, does not agree | 0.1 % |" in text
    assert "<h1>All <b>beams</b></h1>" in page
    assert page.count("data:image/png;base64,") == 1
    assert "http" not in page.replace("http-equiv", "")


def test_long_tables_are_folded_and_markup_in_cells_is_rendered(tmp_path: Path) -> None:
    sizes = {"Few": 3, "All": LONG + 1}
    sheets = [Sheet(title, ("answer",), [["`undecided` < 1"]] * rows) for title, rows in sizes.items()]
    page = write_page("beams", sheets, tmp_path, "all")[1].read_text(encoding="utf-8")
    assert page.count("<td><code>undecided</code> &lt; 1</td>") == LONG + 4
    assert re.findall(r"<details><summary><h3>(\w+)</h3>, (\d+) rows", page) == [("All", str(LONG + 1))]


def test_table_is_readable_by_other_programs(tmp_path: Path) -> None:
    run_study(BEAMS, tmp_path)
    rows = list(csv.DictReader(io.StringIO(table_path(BEAMS, tmp_path).read_text())))
    assert [row["load [N]"] for row in rows] == ["1", "2", "3"]
    assert rows[1]["beam"] == "long"
