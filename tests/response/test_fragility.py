"""Fragility over a set of records."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.stats import norm
from scipy.stats import t as student

import runningbond as rb
from runningbond.fragilities import fitted, interval_of_median
from runningbond.scene.history import pulse
from runningbond.tables import table


@pytest.mark.long
def test_fragility_of_a_block_over_scaled_copies_of_a_record(tmp_path: Path) -> None:
    """Half sines that differ only by a factor overturn the block at the same peak acceleration."""
    time, values = pulse("half-sine", 1.0, 1.0)
    for k, factor in enumerate((0.5, 1.0)):
        rows = np.column_stack([time[::10], factor * values[::10, 0]])
        np.savetxt(tmp_path / f"{k}.csv", rows, delimiter=",")
    wall = rb.Wall.courses(
        [[1]],
        block_width=0.5,
        block_height=2.0,
        thickness=0.12,
        density=1800.0,
        friction=1.5,
        normal_stiffness=1e9,
        shear_stiffness=1e9,
        history={"file": str(tmp_path / "0.csv"), "quantity": "g"},
    )
    records = [tmp_path / "0.csv", tmp_path / "1.csv"]
    found = rb.fragility(wall, records, "dem-dynamic", tolerance=0.05, folder=tmp_path / "kept", jobs=1)
    assert found.left_out == 0
    assert found.intensity[1] == pytest.approx(found.intensity[0], rel=0.05)
    assert found.interval[0] <= found.median <= found.interval[1]
    assert found.probability(found.median * np.array([0.5, 1.0, 2.0])) == pytest.approx([0, 0.5, 1], abs=1e-3)
    again = rb.fragility(wall, records, "dem-dynamic", tolerance=0.05, folder=tmp_path / "kept", jobs=1)
    assert np.array_equal(again.intensity, found.intensity)
    with pytest.raises(rb.SceneError, match="nowhere.csv: .*nowhere.csv"):  # and the reason
        rb.fragility(wall, [records[0], tmp_path / "nowhere.csv"], "dem-dynamic", tolerance=0.05, jobs=1)
    with pytest.raises(rb.SceneError, match="records = .*: must be a list of files"):
        rb.fragility(wall, str(records[0]), "dem-dynamic")


def test_fragility_takes_only_non_negative_intensities() -> None:
    """Normal distribution of the logarithm: zero at intensity zero, Φ(−1) one dispersion below the median."""
    runs = table({"status": ["collapse"]})
    found = rb.Fragility(np.array([0.5]), np.zeros(0), 0.5, 0.4, (0.4, 0.6), runs, 0)
    probability = found.probability(np.array([0.0, 0.5 * np.exp(-0.4), 0.5, np.inf]))
    assert probability == pytest.approx([0.0, norm.cdf(-1.0), 0.5, 1.0], abs=1e-12)
    certain = replace(found, dispersion=0.0).probability(np.array([0.49, 0.51]))
    assert certain.tolist() == [0.0, 1.0]
    assert "0 left out>" in repr(found)
    assert "1 left out (`runs` says why)>" in repr(replace(found, left_out=1))
    for bad in (-1.0, np.array([0.1, np.nan]), "a"):
        with pytest.raises(rb.SceneError, match="intensity = .*: must be numbers of at least 0"):
            found.probability(bad)  # type: ignore[arg-type]


def test_wall_without_a_record_has_no_fragility() -> None:
    with pytest.raises(rb.SceneError, match="load.history.file: is missing"):
        rb.fragility(rb.read("panel-01"), ["a.csv"], "dem-dynamic")


def test_wall_that_falls_by_itself_is_said_to(tmp_path: Path) -> None:
    """The records were once blamed, which `must be two at least that bring the wall down`, without a reason."""
    for name, peak in (("a.csv", 1), ("b.csv", 2)):
        (tmp_path / name).write_text(f"0 0\n0.1 {peak}\n0.2 0\n")
    wall = rb.Wall.courses(
        [[1], [1]],
        block_width=0.2,
        block_height=0.2,
        thickness=0.1,
        density=1800.0,
        friction=0.6,
        normal_stiffness=1e9,
        shear_stiffness=4e8,
        load={"gravity": [7.0, -7.0]},
        history={"file": str(tmp_path / "a.csv"), "quantity": "g"},
    )
    with pytest.raises(rb.SceneError, match=r"bring the wall down; \S*a.csv: collapses under its dead load$"):
        rb.fragility(wall, [str(tmp_path / "a.csv"), str(tmp_path / "b.csv")], "dem-dynamic", jobs=1)


def test_each_record_counts_once(tmp_path: Path) -> None:
    """A record named twice counted as two samples that agree, and the interval of the median had no width."""
    (tmp_path / "a.csv").write_text("0 0\n1 1\n2 0\n")
    wall = rb.read("panel-01").with_(
        {"load.history": {"file": str(tmp_path / "a.csv"), "quantity": "g"}, "load.live": None}
    )
    with pytest.raises(rb.SceneError, match="records: must name each record once, and name a.csv 2 times"):
        rb.fragility(wall, [str(tmp_path / "a.csv"), str(tmp_path / "." / "a.csv")], "dem-dynamic")
    wall.to_toml(tmp_path / "wall.toml")
    with pytest.raises(rb.SceneError, match="records: must name each record once, and name a.csv 2 times"):
        rb.fragility(rb.read(tmp_path / "wall.toml"), ["a.csv", str(tmp_path / "a.csv")], "dem-dynamic")


def test_likely_input_errors_are_warned_about_at_the_calling_line(tmp_path: Path) -> None:
    """The line was once one of the package, so that Python showed the warnings of the first wall alone."""
    for name, peak in (("a.csv", 1), ("b.csv", 2)):
        (tmp_path / name).write_text(f"0 0\n0.1 {peak}\n0.2 0\n")
    history = {"file": str(tmp_path / "a.csv"), "quantity": "g"}
    wall = rb.read("panel-01").with_({"load.history": history, "load.live": None, "block.density": 1.8})
    records, odd = [tmp_path / "a.csv", tmp_path / "b.csv"], "block.density = 1.8: is not within"
    with pytest.warns(UserWarning, match=odd) as told, pytest.raises(rb.SceneError, match="by model limit"):
        rb.fragility(wall, records, "limit", jobs=1)
    assert [Path(each.filename) for each in told] == [Path(__file__)]


def test_records_without_collapse_count_as_lower_bounds() -> None:
    """A log-normal sample censored at a level returns its median and dispersion; dropping the rest does not."""
    n, median, dispersion = 400, 0.5, 0.4
    sample = median * np.exp(dispersion * norm.ppf((np.arange(n) + 0.5) / n))
    for level in (0.5, 0.7):
        found = fitted(np.minimum(sample, level), sample > level)
        known = fitted(sample[sample <= level], np.zeros((sample <= level).sum(), dtype=bool))
        assert abs(np.log(found[0] / median)) < dispersion / np.sqrt(n)
        assert abs(found[1] - dispersion) < dispersion / np.sqrt(2 * n)
        assert abs(found[0] - median) < 0.1 * abs(known[0] - median)
        assert abs(found[1] - dispersion) < 0.1 * abs(known[1] - dispersion)


def test_uncensored_fit_is_the_mean_and_deviation_of_the_logarithms() -> None:
    logs = np.array([-0.7, 0.1, 0.2, 0.9])
    found = fitted(np.exp(logs), np.zeros(4, dtype=bool))
    assert found == pytest.approx((np.exp(logs.mean()), logs.std()))


@pytest.mark.parametrize("n", [5, 12])
def test_interval_of_few_records_has_its_nominal_coverage(n: int) -> None:
    """In 90 % of log-normal samples. Plain resampling covered the median in 79 % of samples of 5, and 86 % of 12."""
    random, none, held = np.random.default_rng(7), np.zeros(n, dtype=bool), 0
    for seed in range(400):
        low, high = interval_of_median(random.lognormal(size=n), none, seed, draws=200)
        held += low <= 1.0 <= high
    assert held / 400 == pytest.approx(0.9, abs=3 * np.sqrt(0.9 * 0.1 / 400))


@pytest.mark.parametrize("n", [6, 12])
def test_interval_of_log_normal_levels_is_students(n: int) -> None:
    """Its width is that of exp(± t s / √n) at 90 %, with t for n − 1 degrees of freedom."""
    logs = np.random.default_rng(3).standard_normal(n)
    low, high = interval_of_median(np.exp(logs), np.zeros(n, dtype=bool), seed=1, draws=20_000)
    exact = student.ppf(0.95, n - 1) * logs.std(ddof=1) / np.sqrt(n)
    assert np.log(high / low) == pytest.approx(2 * exact, rel=0.02)


def test_interval_width_depends_on_the_number_of_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Eight falls, and four records that stand at negligible levels and do not inform the median."""

    def of_falls(level: Any, stands: Any) -> tuple[float, float]:
        logs = np.log(level[~stands])
        return (float(np.exp(logs.mean())), float(logs.std())) if len(logs) > 1 else (np.inf, 0.0)

    logs, stands = np.random.default_rng(3).standard_normal(8), np.arange(12) >= 8
    levels = np.append(np.exp(logs), np.full(4, 1e-6))
    assert fitted(levels, stands) == pytest.approx(of_falls(levels, stands), rel=1e-3)
    monkeypatch.setattr("runningbond.fragilities.fitted", of_falls)  # same result, faster
    few, many = (interval_of_median(levels[:n], stands[:n], seed=2, draws=20_000) for n in (8, 12))
    assert np.log(many[1] / many[0]) > np.log(few[1] / few[0])


def test_one_fall_gives_no_median() -> None:
    assert fitted(np.array([0.2, 0.6, 0.6]), np.array([False, True, True])) == (np.inf, 0.0)


def test_interval_may_be_unbounded_above() -> None:
    levels = np.array([0.2, 0.3, 0.6, 0.6, 0.6])
    low, high = interval_of_median(levels, levels > 0.5, seed=0, draws=30)
    assert 0 < low < fitted(levels, levels > 0.5)[0] < high == np.inf


def test_fragility_uses_records_that_never_bring_the_wall_down(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """By λ: two falls, two that stand to the last scale, one failed run and one that fell at every scale.

    A record that is undecided between two scales, and one under which the wall never comes to rest, are left out.
    """
    rows: dict[str, list[Any]] = {
        "status": ["collapse", "undecided", "collapse", "undecided", "failed", *["undecided"] * 3],
        "multiplier": [0.5, None, 1.0, *[None] * 5],
        "lower": [0.49, 2.0, 0.99, 3.0, 1.0, None, 1.0, None],
        "upper": [0.51, None, 1.01, None, 2.0, 0.1, 2.0, None],
    }
    monkeypatch.setattr("runningbond.fragilities.sweep", lambda *_, **__: table(rows))
    for name in (records := [str(tmp_path / f"{k}.csv") for k in range(8)]):
        Path(name).write_text("time,x,y\n0,0,0\n0.5,0.15,-0.2\n1,0,0\n")  # 0.25 g, inclined
    size: dict[str, Any] = {
        "block_width": 0.5,
        "block_height": 1.0,
        "thickness": 0.1,
        "density": 1800.0,
        "friction": 0.6,
    }
    wall = rb.Wall.courses([[1]], **size, history={"file": records[0], "quantity": "g"})
    found = rb.fragility(wall, records, "dem-dynamic", draws=20)
    assert found.intensity == pytest.approx([0.125, 0.25])
    assert found.stood == pytest.approx([0.5, 0.75])
    assert found.left_out == 4
    assert found.median > 0.125 * np.sqrt(2)
    assert found.interval[0] <= found.median <= found.interval[1]
