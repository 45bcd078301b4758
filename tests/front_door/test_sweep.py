"""Sweeps: a row a combination, kept and found again, with refusals among the rows."""

import runpy
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import runningbond as rb
from runningbond.compare import models, tasks
from runningbond.results import Outcome

WALL = rb.Wall.courses(
    [[1, 1], [0.5, 1, 0.5]], block_width=0.4, block_height=0.2, thickness=0.2, density=1800.0, friction=0.4
)


@pytest.fixture(params=["structured arrays", "pandas"], autouse=True)
def tables(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables with and without pandas."""
    if request.param == "pandas":
        pytest.importorskip("pandas")
    else:
        monkeypatch.setitem(sys.modules, "pandas", None)


def test_a_low_wall_slides_at_its_friction_whatever_its_thickness() -> None:
    """Exact: λ = tan φ. The last key varies fastest."""
    changes = {"joint.friction": [0.2, 0.3], "wall.thickness": [0.1, 0.2]}
    table = rb.sweep(WALL, changes, "limit", jobs=1)
    assert list(table["joint.friction"]) == [0.2, 0.2, 0.3, 0.3]
    assert list(table["wall.thickness"]) == [0.1, 0.2, 0.1, 0.2]
    assert np.asarray(table["multiplier"]) == pytest.approx([0.2, 0.2, 0.3, 0.3])
    assert set(table["status"]) == {"collapse"}


def test_refusals_are_rows() -> None:
    """A wall that is none, and a wall that a model does not apply to."""
    table = rb.sweep(WALL, {"joint.friction": [-1.0, 0.3]}, "limit", jobs=1)
    assert list(table["status"]) == ["refused", "collapse"]
    assert "must be a number at least 0" in table["message"][0]
    assert np.isnan(table["multiplier"][0])
    table = rb.sweep(WALL, {"joint.cohesion": [0.0, 10.0]}, "homog", jobs=1)
    assert list(table["status"]) == ["collapse", "refused"]
    assert "dry joints" in table["message"][1]


def test_a_model_that_breaks_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    broken = Outcome("", "limit", "failed", message="ZeroDivisionError: by zero")
    monkeypatch.setattr(tasks, "run_model", lambda *_: broken)
    table = rb.sweep(WALL, {"joint.friction": [0.3]}, "limit", jobs=1)
    assert list(table["status"]) == ["failed"]
    assert "ZeroDivisionError" in table["message"][0]


def test_a_sweep_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers in the folder are not computed again, whatever stands before or after them now."""
    rb.sweep(WALL, {"joint.friction": [0.3, 0.2]}, "limit", folder=tmp_path, jobs=1)
    run_model, computed = models.run_model, []

    def counted(*arguments: Any) -> Outcome:
        computed.append(arguments)
        return run_model(*arguments)

    monkeypatch.setattr(tasks, "run_model", counted)
    table = rb.sweep(WALL, {"joint.friction": [0.1, 0.2, 0.3]}, "limit", folder=tmp_path, jobs=1)
    assert np.asarray(table["multiplier"]) == pytest.approx([0.1, 0.2, 0.3])
    assert len(computed) == 1


def test_processes_find_what_one_does() -> None:
    changes = {"joint.friction": [0.2, 0.3]}
    apart, alone = (rb.sweep(WALL, changes, "limit", jobs=jobs) for jobs in (2, 1))
    assert list(apart["multiplier"]) == list(alone["multiplier"])


def test_tables_may_vary_as_well() -> None:
    at_top = {"kind": "point", "at": [0.4, 0.4], "force": [1.0, 0.0]}
    table = rb.sweep(WALL, {"load.live": [{"kind": "lateral"}, at_top]}, "limit", jobs=1)
    assert list(table["status"]) == ["collapse", "collapse"]
    assert table["load.live"][1] == at_top


LOAD = """
from dataclasses import dataclass
from runningbond.scene import Action, Forces

@dataclass(frozen=True)
class Push(Action):
    def forces(self, scene):
        return Forces.on(scene, (9.81 * {factor}, 0.0))
"""


def test_a_changed_load_of_ones_own_is_computed_anew(tmp_path: Path) -> None:
    """Exact: λ = tan φ / factor, though the load is called the same and has the same fields."""
    for factor in (1.0, 2.0, 1.0):
        (tmp_path / "push.py").write_text(LOAD.format(factor=factor))
        push = runpy.run_path(str(tmp_path / "push.py"))["Push"]
        table = rb.sweep(WALL, {"load.live": [push()]}, "limit", folder=tmp_path / "kept", jobs=1)
        assert np.asarray(table["multiplier"]) == pytest.approx([0.4 / factor])


def test_an_unknown_model_is_refused_at_once() -> None:
    with pytest.raises(rb.SceneError, match='did you mean "limit"?'):
        rb.sweep(WALL, {"joint.friction": [0.3]}, "limt")


@pytest.mark.parametrize("value", [0.4, "base", {"kind": "base"}])
def test_values_are_a_list(value: Any) -> None:
    with pytest.raises(rb.SceneError, match="must be a list of the values"):
        rb.sweep(WALL, {"support.kind": value}, "limit")


def test_an_interrupted_sweep_is_an_interruption(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(tasks, "run_model", interrupted)
    with pytest.raises(KeyboardInterrupt):
        rb.sweep(WALL, {"joint.friction": [0.3]}, "limit", jobs=1)
