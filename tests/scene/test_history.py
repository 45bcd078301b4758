"""Ground motions: values of records and pulses, and messages about invalid ones."""

import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from runningbond.commands.command_line import command
from runningbond.models import MODELS, run_model
from runningbond.scene import (
    BlockMaterial,
    History,
    JointMaterial,
    Lateral,
    Load,
    Scene,
    SceneError,
    build_scene,
    scene_from_dict,
)
from runningbond.scene.history import STANDARD_GRAVITY, pulse
from runningbond.scene.records import read_record
from tests.walls import content, write_toml

SINE = {"kind": "sine", "amplitude": 2.0, "period": 0.5}
PULSE = {"pulse": SINE, "quantity": "acceleration"}
ROWS = "".join(f"{0.01 * k:.2f}, {k % 3 - 1}\n" for k in range(20))
PEER = "head\nevent\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=  7, DT=   .0050 SEC,\n .1 .2 -.1 .0 1.E-1\n .1 .0\n"


def scene(history: Any, folder: Path = Path(), **changes: Any) -> Scene:
    return scene_from_dict(content(load__live=None, load__history=history, **changes), folder=folder)


def of(history: Any, folder: Path = Path()) -> History:
    read = scene(history, folder).history
    assert read is not None
    return read


# --- values of records and pulses ----------------------------------------------------------------------------


@pytest.mark.parametrize(("kind", "span"), [("sine", 1.0), ("half-sine", 0.5), ("ricker", 3.0), ("ramp", 1.0)])
def test_velocity_of_a_pulse_is_the_integral_of_its_acceleration(kind: str, span: float) -> None:
    history = of({"pulse": {**SINE, "kind": kind}, "quantity": "acceleration"})
    assert history.duration == pytest.approx(0.5 * span)
    assert np.hypot(*history.peak) == pytest.approx(2.0, rel=1e-5)
    time = np.linspace(0, history.duration, 7)
    exact = {
        "sine": lambda t: 2 * np.sin(4 * np.pi * t),
        "half-sine": lambda t: 2 * np.sin(4 * np.pi * t),
        "ramp": lambda t: 2 * t / 0.5,
        "ricker": lambda t: 2 * (1 - 2 * (2 * np.pi * (t - 0.75)) ** 2) * np.exp(-((2 * np.pi * (t - 0.75)) ** 2)),
    }[kind]
    integral = [quad(exact, 0, t, limit=200)[0] for t in time]
    assert history.velocity(time)[:, 0] == pytest.approx(integral, abs=3e-6)
    assert not history.velocity(time)[:, 1].any()
    after = history.velocity(history.duration + 1.0)[0] - history.velocity(history.duration)[0]
    assert after == pytest.approx(2.0 if kind == "ramp" else 0.0, abs=1e-9)


@pytest.mark.parametrize(("quantity", "order"), [("acceleration", 0), ("velocity", 1), ("displacement", 2)])
def test_a_record_of_any_quantity_has_the_same_velocity(quantity: str, order: int) -> None:
    """For x = A sin² ω t, finely sampled."""
    time = np.linspace(0, 1, 2001)
    w = np.pi
    motions = (2 * w**2 * np.cos(2 * w * time), w * np.sin(2 * w * time), np.sin(w * time) ** 2)
    history = History(time, np.column_stack([motions[order], 0 * time]), quantity)
    assert history.velocity(time)[:, 0] == pytest.approx(motions[1], abs=2e-3)


def test_units_and_scale(tmp_path: Path) -> None:
    (tmp_path / "record.csv").write_text("# made up\ntime,x,y\n0,0,0\n0.5, 0.3,-0.1\n1,0,0\n")
    (tmp_path / "record.AT2").write_text(PEER)
    one = of({"file": "record.csv", "quantity": "g", "scale": 2.0}, tmp_path)
    assert one.acceleration(0.5) == pytest.approx(np.array([0.6, -0.2]) * STANDARD_GRAVITY)
    assert one.acceleration(0.25) == pytest.approx(np.array([0.3, -0.1]) * STANDARD_GRAVITY)
    forces = scene({"file": "record.csv", "quantity": "g"}, tmp_path).live_forces
    assert forces.acceleration[0] == pytest.approx(-np.array([0.3, -0.1]) * STANDARD_GRAVITY)
    peer = of({"file": "record.AT2"}, tmp_path)
    assert peer.acceleration(0.005)[0] == pytest.approx(0.2 * STANDARD_GRAVITY)
    assert peer.duration == pytest.approx(0.03)


@pytest.mark.parametrize("names", ["time [s],acceleration [m/s2]", "t,a1", '"time";"x 2"', "T a_x"])
def test_column_names_may_contain_digits(names: str, tmp_path: Path) -> None:
    (tmp_path / "record.csv").write_text(f"{names}\n{ROWS}")
    assert len(read_record(tmp_path / "record.csv", "file").time) == ROWS.count("\n")


def test_velocity_before_and_after_a_record() -> None:
    """At rest before; a velocity record may begin with a jump and keeps its last value, displacements end at rest."""
    time = np.array([0.0, 1.0, 2.0])
    moving = History(time, np.array([[0.5, 0.0], [0.7, 0.0], [0.6, 0.0]]), "velocity")
    displaced = History(time, np.array([[0.0, 0.0], [1.0, 0.0], [2.5, 0.0]]), "displacement")
    for history, first, last in ((moving, 0.5, 0.6), (displaced, 0.75, 0.0)):
        assert history.velocity(np.array([-1.0, 0.0])).tolist() == [[0, 0], [0, 0]]
        assert history.velocity(1e-9)[0] == pytest.approx(first, abs=1e-6)
        assert history.velocity(9.0)[0] == pytest.approx(last, abs=1e-6)
        assert history.jump == pytest.approx(first)
        assert history.note(2.0).endswith(f"g, and has {2 * first:.4g} m/s at once as the record begins")


def test_record_resolution_is_computed_only_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is needed every few time steps; without a cache it took longer than the wall for long records."""
    history = History(np.array([0.0, 0.01, 0.02, 0.03]), np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 0.0]]))
    plain, gone_through = np.diff, 0

    def counted(values: Any, *rest: Any, **more: Any) -> Any:
        nonlocal gone_through
        gone_through += values is history.time
        return plain(values, *rest, **more)

    monkeypatch.setattr(np, "diff", counted)
    assert np.allclose([history.resolution for _ in range(3)], 0.005)
    assert gone_through == 1


def test_ramp_keeps_its_final_value() -> None:
    """A ramp of acceleration stays at its amplitude; after a ramp of velocity the acceleration is zero."""
    of_velocity = of({"pulse": {**SINE, "kind": "ramp"}, "quantity": "velocity"})
    assert of_velocity.velocity(np.array([0.5, 9.0]))[:, 0] == pytest.approx(2.0)
    assert of_velocity.acceleration(0.6)[0] == 0
    assert of({"pulse": {**SINE, "kind": "ramp"}, "quantity": "acceleration"}).acceleration(0.6)[0] == 2
    in_g = of({"pulse": {**SINE, "kind": "ramp"}, "quantity": "g"})
    assert in_g.acceleration(0.6)[0] == pytest.approx(2 * STANDARD_GRAVITY)


def test_time_of_a_record_starts_at_its_first_sample() -> None:
    """A late start is equivalent to a start at 0, with no motion before; the resolution is half the shortest step."""
    time, values = np.array([0.0, 0.1, 0.4, 0.6]), np.array([[1.0, 0.0], [2.0, 0.0], [-1.0, 0.0], [1.0, 0.0]])
    first, late = History(time, values), History(time + 30.0, values)
    for moment in (-0.1, 0.0, 0.05, 0.25, 0.7):
        assert late.acceleration(moment) == pytest.approx(first.acceleration(moment))
        assert late.velocity(moment) == pytest.approx(first.velocity(moment))
    assert first.acceleration(-0.1).tolist() == [0.0, 0.0]
    assert (late.duration, late.resolution) == pytest.approx((0.6, 0.05))


def test_record_may_have_absolute_times(tmp_path: Path) -> None:
    """Seconds since 1970, rounded to 2e-7 s, give the motion of the same record from 0 s."""
    motions = []
    for start in (0, 1_600_000_000):
        rows = (f"{start + k // 200}.{k % 200 * 5:03d}, {k % 7 - 3}" for k in range(400))
        (tmp_path / "record.csv").write_text("\n".join(rows))
        motions.append(of({"file": "record.csv", "quantity": "acceleration"}, tmp_path))
    first, late = motions
    assert late.duration == pytest.approx(first.duration, abs=1e-6)
    assert late.resolution == pytest.approx(0.0025, rel=1e-3)
    assert late.velocity(late.time) == pytest.approx(first.velocity(first.time), abs=1e-5)


@pytest.mark.parametrize(
    ("time", "values"),
    [
        ([0, 1], [1, 2, 3]),
        ([0, 1], [[1, 2], [3]]),
        ([0, 1], [1, 2]),
        ([[0, 1]], [[1, 0], [2, 0]]),
        (1.0, [1, 0]),
        ([0, "now"], [[1, 0], [2, 0]]),
        ([0, math.inf], [[1, 0], [2, 0]]),
    ],
)
def test_times_and_values_that_do_not_match_are_refused(time: Any, values: Any) -> None:
    with pytest.raises(SceneError, match=r"^load\.history: must have"):
        History(time, values)


@pytest.mark.parametrize("multiplier", [1.5, -1.5])
def test_peak_acceleration_is_the_largest_vector_norm(multiplier: float) -> None:
    """3 m/s² sideways and 4 m/s² down are 5 m/s² in total; the same with the sign reversed (λ < 0)."""
    values = np.array([[0.0, 0.0], [4.5, 0.0], [3.0, -4.0], [0.0, 0.0]])
    history = History(np.arange(4.0), values)
    assert history.peak == pytest.approx([3.0, -4.0])
    assert history.note(multiplier) == f"the ground is accelerated by up to {7.5 / STANDARD_GRAVITY:.4g} g"


@pytest.mark.parametrize("kind", ["sine", "ramp"])
def test_resolution_of_a_pulse_is_a_two_hundredth_of_its_period(kind: str) -> None:
    """Independent of its number of samples; a ramp has only two."""
    assert of({"pulse": {**SINE, "kind": kind}, "quantity": "acceleration"}).resolution == pytest.approx(0.5 / 200)


@pytest.mark.parametrize("part", [";", "\t", " ", " ; "])
def test_commas_are_decimal_marks_if_columns_have_another_separator(part: str, tmp_path: Path) -> None:
    """Also with times in whole seconds, where the single comma of a row was once taken for a column separator."""
    for time in (["0,00", "0,01", "0,02"], ["0", "1", "2"], ["0.00", "0.01", "0.02"]):
        rows = (part.join(row) for row in zip(time, ("0", "-2,5", "1,5e-1"), strict=True))
        (tmp_path / "record.csv").write_text(f"t{part}a\n" + "\n".join(rows))
        record = read_record(tmp_path / "record.csv", "file")
        assert record.time.tolist() == [float(word.replace(",", ".")) for word in time]
        assert record.values.tolist() == [[0.0, 0.0], [-2.5, 0.0], [0.15, 0.0]]


def test_word_with_comma_and_point_between_semicolons_is_no_number(tmp_path: Path) -> None:
    """It was two columns: the wall was shaken vertically."""
    (tmp_path / "record.csv").write_text("0.00;0\n0.01;1.000,5\n")
    with pytest.raises(SceneError, match=r"line 2 = '1\.000,5': must be a number"):
        read_record(tmp_path / "record.csv", "file")


@pytest.mark.parametrize("head", ["TIME HISTORY IN UNITS OF", "TIME HISTORY  IN UNITS OF", "TIME SERIES IN UNITS OF"])
@pytest.mark.parametrize("after", ["", ". FILTER POINTS: HP=0.1 Hz   LP=40.0 Hz", ", 230"])
def test_headers_of_all_peer_databases(head: str, after: str, tmp_path: Path) -> None:
    (tmp_path / "el-centro.AT2").write_text(PEER.replace("TIME SERIES IN UNITS OF G", f"{head} G{after}"))
    assert read_record(tmp_path / "el-centro.AT2", "file").quantity == "g"


@pytest.mark.parametrize(
    ("end", "unit", "quantity", "metres"),
    [
        ("at2", "ACCELERATION TIME SERIES IN UNITS OF G", "g", 1.0),
        ("at2", "ACCELERATION TIME SERIES IN UNITS OF CM/S/S", "acceleration", 0.01),
        ("AT2", "ACCELERATION TIME SERIES IN UNITS OF CM/S2", "acceleration", 0.01),
        ("vt2", "VELOCITY TIME SERIES IN UNITS OF CM/SEC", "velocity", 0.01),
        ("dt2", "DISPLACEMENT TIME HISTORY IN UNITS OF CM.", "displacement", 0.01),
    ],
)
def test_peer_records_are_converted_from_their_units(
    end: str, unit: str, quantity: str, metres: float, tmp_path: Path
) -> None:
    """Values may have Fortran exponents (1.D-1)."""
    text = PEER.replace("ACCELERATION TIME SERIES IN UNITS OF G", unit).replace("1.E-1", "1.D-1")
    (tmp_path / f"record.{end}").write_text(text)
    record = read_record(tmp_path / f"record.{end}", "file")
    assert record.quantity == quantity
    assert record.values[:, 0] == pytest.approx(metres * np.array([0.1, 0.2, -0.1, 0.0, 0.1, 0.1, 0.0]))
    assert not record.values[:, 1].any()
    assert record.time == pytest.approx(0.005 * np.arange(7))


def test_older_peer_header_and_blank_separated_columns(tmp_path: Path) -> None:
    old = PEER.replace("NPTS=  7, DT=   .0050 SEC,", "    7   .0050   NPTS, DT")
    (tmp_path / "old.vt2").write_text(old.replace("ACCELERATION", "VELOCITY").replace("OF G", "OF CM/S"))
    record = read_record(tmp_path / "old.vt2", "file")
    assert record.quantity == "velocity"
    assert record.values[1, 0] == pytest.approx(0.002)
    (tmp_path / "blank.txt").write_text("% t a\n  0.0\t1e-2  \n\n 0.1   -2E-2\n")
    assert read_record(tmp_path / "blank.txt", "file").values[:, 0].tolist() == [0.01, -0.02]


def test_duration_of_each_kind_of_pulse() -> None:
    assert [pulse(kind, 1.0, 2.0)[0][-1] for kind in ("sine", "half-sine", "ricker", "ramp")] == [2.0, 1.0, 6.0, 2.0]


@pytest.mark.parametrize("name", [name for name, model in MODELS.items() if not model.respond])
def test_models_without_time_refuse_a_history(name: str) -> None:
    with pytest.raises(SceneError, match=f"load.history: is not supported by model {name}"):
        run_model(name, scene(PULSE))


# --- what is refused -----------------------------------------------------------------------------------------


def record(text: str, **keys: Any) -> tuple[dict[str, Any], str]:
    return {"file": "record.csv", "quantity": "g", **keys}, text


def peer(old: str, new: str) -> tuple[dict[str, Any], str]:
    return {"file": "record.at2"}, PEER.replace(old, new)


REFUSED: list[tuple[Any, str]] = [
    ({}, "load.history: must have one of file and pulse"),
    ({"file": "record.csv", **PULSE}, "load.history: must have one of file and pulse"),
    (3, "load.history = 3: must be a table"),
    ({"pulse": SINE}, "load.history.quantity: is missing; without it the record has no unit"),
    ({**PULSE, "quantity": "speed"}, "load.history.quantity = 'speed': must be one of"),
    ({**PULSE, "quantity": "m/s2"}, "load.history.quantity = 'm/s2': must be one of"),
    ({**PULSE, "scale": 0}, "load.history.scale = 0.0: must not be zero"),
    ({**PULSE, "scale": "big"}, "load.history.scale = 'big': must be a number"),
    ({**PULSE, "scale": float("nan")}, "load.history.scale = nan: must be a number"),
    ({**PULSE, "skale": 1}, 'load.history.skale = 1: is not a key of [load.history]; did you mean "scale"?'),
    ({**PULSE, "pulse": "sine"}, "load.history.pulse = 'sine': must be a table"),
    ({**PULSE, "pulse": {**SINE, "kind": "cosine"}}, "load.history.pulse.kind = 'cosine': must be one of"),
    ({**PULSE, "pulse": {"kind": "sine", "period": 1}}, "load.history.pulse.amplitude: is missing"),
    ({**PULSE, "pulse": {"kind": "sine", "amplitude": 1}}, "load.history.pulse.period: is missing"),
    ({**PULSE, "pulse": {**SINE, "amplitude": 0}}, "load.history.pulse.amplitude = 0.0: must not be zero"),
    ({**PULSE, "pulse": {**SINE, "period": 0}}, "load.history.pulse.period = 0: must be a number above 0"),
    ({**PULSE, "pulse": {**SINE, "period": -1}}, "load.history.pulse.period = -1: must be a number above 0"),
    ({**PULSE, "pulse": {**SINE, "period": "1 s"}}, "load.history.pulse.period = '1 s': must be a number"),
    ({**PULSE, "pulse": {**SINE, "phase": 1}}, "load.history.pulse.phase = 1: is not a key of [load.history.pulse]"),
    ({"file": "no.csv", "quantity": "g"}, "no.csv': cannot be read"),
    ({"file": "no\0.csv", "quantity": "g"}, "cannot be read: embedded null"),
    ({"file": 3, "quantity": "g"}, "load.history.file = 3: must be a string"),
    (record("", quantity="speed"), "load.history.quantity = 'speed': must be one of"),
    (record(""), "record.csv, line 1: ends a record of 0 rows"),
    (record("# nothing\n\n"), "record.csv, line 2: ends a record of 0 rows"),
    (record("0, 1\n"), "record.csv, line 1: ends a record of 1 rows"),
    (record("0, 1\n0.1, nan\n0.2, 0\n"), "record.csv, line 2 = 'nan': must be a finite number"),
    (record("0, 1\n0.1, inf\n"), "record.csv, line 2 = 'inf': must be a finite number"),
    (record("0, 1\n0.1, 1e9\n"), "record.csv, line 2 = '1e9': must be a finite number, at most 1e+06"),
    (record("0, 1\n1e11, 1\n"), "record.csv, line 2 = '1e11': must be a finite number, at most 1e+10"),
    (record("1, 1\n2e6, 1\n"), "record.csv, line 2 = 2000000.0: must be at most 1e+06 s later than the first row"),
    (
        record("1600000000.02, 1\n1600000000.01, 1\n"),
        "later than the row before, at 1600000000.02 s",
    ),
    (record("0, 1\n0.1,\n0.2, 1\n"), "record.csv, line 2: has a gap where a number must be"),
    (record("0, 1, 2\n0.1,,1\n"), "record.csv, line 2: has a gap where a number must be"),
    (record("0, 1\n0.1, high\n"), "record.csv, line 2 = 'high': must be a number"),
    (record("# t a\n0, 1\n0.2, 2\n0.1, 1\n"), "record.csv, line 4 = 0.1: must be later than the row before, at 0.2 s"),
    (record("0, 1\n0.2, 2\n0.2, 1\n"), "record.csv, line 3 = 0.2: must be later than the row before"),
    (record("0\n1\n"), "record.csv, line 1 = '0': must have two or three columns"),
    (record("0, 1, 2, 3\n1, 2, 3, 4\n"), "record.csv, line 1 = '0 1 2 3': must have two or three columns"),
    (record("0, 1\n0.1, 1, 2\n"), "record.csv, line 2 = '0.1 1 2': must have 2 columns, as the first row"),
    (record("0, 1, 2\n0.1, 1\n"), "record.csv, line 2 = '0.1 1': must have 3 columns, as the first row"),
    (record("0 1\n0.1 1;2\n"), "record.csv, line 2 = '0.1 1 2': must have 2 columns"),
    (record(ROWS + "0.40, 1\n"), "record.csv, line 21 = 0.4: comes after a gap of 0.21 s, the steps of the record are"),
    (record("0, 0\n1, 0\n"), "load.history = 'record.csv': does not move the ground"),
    (record("0, 1\n1, 1\n", quantity="velocity"), "'record.csv': moves the ground by a jump alone, as it begins"),
    (peer("OF G", "OF FURLONGS"), "record.at2, line 3 = 'ACCELERATION TIME SERIES IN UNITS OF FURLONGS': must name"),
    (peer(" IN UNITS OF G", ""), "record.at2, line 3 = 'ACCELERATION TIME SERIES': must name the unit"),
    (peer("NPTS=  7", "NPTS=  9"), "record.at2, line 6: ends a record of 7 values; NPTS says 9"),
    (peer("NPTS=  7", "NPTS=  1"), "record.at2, line 4 = 'NPTS= 1, DT= .0050 SEC,': must say how many values"),
    (peer("DT=   .0050", "DT=   0.0"), "record.at2, line 4 = 'NPTS= 7, DT= 0.0 SEC,': must say how many values"),
    (peer("DT=   .0050", "DT= 1..1"), "record.at2, line 4 = 'NPTS= 7, DT= 1..1 SEC,': must say how many values"),
    (peer("DT=   .0050", "DT= ."), "record.at2, line 4 = 'NPTS= 7, DT= . SEC,': must say how many values"),
    (record("nan, nan\n0, 1\n0.1, 1\n"), "record.csv, line 1 = 'nan': must be a finite number"),
    (record("inf 1\n0 1\n0.1 1\n"), "record.csv, line 1 = 'inf': must be a finite number"),
    (peer("NPTS=  7, DT=   .0050 SEC,", "seven"), "record.at2, line 4 = 'seven': must say how many values"),
    (peer("-.1", "***"), "record.at2, line 5 = '***': must be a number"),
    (peer("-.1", "NaN"), "record.at2, line 5 = 'NaN': must be a finite number"),
    (({"file": "record.at2"}, "one\ntwo\n"), "record.at2, line 2: ends a file of PEER, which has four lines"),
    (({"file": "record.at2", "quantity": "velocity"}, PEER), "load.history.quantity = 'velocity': must be left out or"),
]


@pytest.mark.parametrize(("given", "said"), REFUSED, ids=range(len(REFUSED)))
def test_invalid_history_is_refused(given: Any, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """One-line message with the file name and line number; exit code 2, nothing written."""
    history, text = given if isinstance(given, tuple) else (given, None)
    if text is not None:
        (tmp_path / history["file"]).write_text(text)
    path = write_toml(content(load__live=None, load__history=history), tmp_path / "wall.toml")
    for name in ("run", "respond"):
        assert command([name, str(path), "--model", "dem-dynamic", "--out", str(tmp_path / "out")]) == 2
        printed = capsys.readouterr()
        assert printed.out == ""
        assert said in printed.err
        assert printed.err.count("\n") == 1
        assert not (tmp_path / "out").exists()


def test_record_that_is_not_utf8_is_refused(tmp_path: Path) -> None:
    (tmp_path / "record.csv").write_bytes(b"\xff\xfe0,1")
    with pytest.raises(SceneError, match="is not a record: it is not UTF-8 text"):
        of({"file": "record.csv", "quantity": "g"}, tmp_path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes in its folders")
def test_record_that_is_a_pipe_is_refused_without_waiting(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "record.csv")
    with pytest.raises(SceneError, match="cannot be read: it is not a regular file"):
        of({"file": "record.csv", "quantity": "g"}, tmp_path)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"load__live": {"kind": "lateral"}}, "load.live: does not go with load.history"),
        ({"support__kind": "corners"}, "support.kind: does not go with load.history"),
        ({"beam": {"height": 0.1, "condition": "level"}}, "beam.condition: does not go with load.history"),
        ({"beam": {"height": 0.1, "condition": "fixed-height"}}, "beam.condition: does not go with load.history"),
        ({"beam": {"height": 0.1, "drive": {"force": [1, 0]}}}, "beam.drive: does not go with load.history"),
    ],
)
def test_keys_that_conflict_with_a_history_are_refused(changes: dict[str, Any], said: str) -> None:
    with pytest.raises(SceneError, match=said):
        scene_from_dict(content(**{"load__live": None, "load__history": PULSE, **changes}))


def test_python_refuses_a_history_beside_another_live_load() -> None:
    history = of(PULSE)
    square = [np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])]
    with pytest.raises(SceneError, match=r"load\.live: does not go with load\.history"):
        build_scene(
            "two",
            square,
            thickness=0.1,
            block=BlockMaterial(1800.0),
            joint=JointMaterial(0.6),
            load=Load(live=(history, Lateral())),
        )


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--model", "limit"], "--model = 'limit': follows no motion of the ground; take dem-dynamic, fem"),
        (["--model", "dem-dynamc"], 'did you mean "dem-dynamic"?'),
        (["--model", "dem-dynamic", "--scale", "0"], "--scale = 0.0: must not be zero"),
        (["--model", "dem-dynamic", "--scale", "1e100"], "--scale = 1e+100: must be a number at least -1e"),
        (["--model", "dem-dynamic", "--scale", "nan"], "--scale = nan: must be a number at least"),
        (["--model", "dem-dynamic", "--scale", "large"], "--scale"),
    ],
)
def test_invalid_respond_options_are_refused(
    arguments: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write_toml(content(load__live=None, load__history=PULSE), tmp_path / "wall.toml")
    assert command(["respond", str(path), *arguments, "--out", str(tmp_path / "out")]) == 2
    printed = capsys.readouterr()
    assert said in printed.err
    assert printed.err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_respond_needs_a_history(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["respond", "panel-01", "--model", "dem-dynamic"]) == 2
    assert "load.history: is missing" in capsys.readouterr().err
