"""Sweeps: a row a combination, kept and found again, with refusals among the rows."""

import runpy
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

import runningbond as rb
from runningbond.campaigns import tasks
from runningbond.campaigns.fingerprint import fingerprint
from runningbond.models import run_model
from runningbond.results import Outcome, load_outcome
from runningbond.scene import Action, Array, Forces, Indices, Scene, SceneError

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


@pytest.mark.parametrize("values", [[], np.arange(0.6, 0.4, 0.1), iter([])])
def test_a_key_without_a_value_is_refused(values: Any) -> None:
    """As of a range that is the wrong way round; a table without a row came of it, of a misspelt key as well."""
    with pytest.raises(SceneError, match=r"^joint.friction = \[\]: must have one value or more"):
        rb.sweep(WALL, {"joint.friction": values}, "limit", jobs=1)


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


@pytest.mark.parametrize("changes", [{"joint.frictoin": [0.3, 0.4]}, {"joint.friction": [-1.0]}])
def test_a_sweep_over_no_wall_at_all_is_refused(changes: dict[str, list[float]], tmp_path: Path) -> None:
    """Before anything is kept: a misspelt key would otherwise be a table without a number in it."""
    with pytest.raises(SceneError, match="is not a key of|must be a number at least 0"):
        rb.sweep(WALL, changes, "limit", jobs=1, folder=tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


def test_a_model_that_breaks_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    broken = Outcome("", "limit", "failed", message="ZeroDivisionError: by zero")
    monkeypatch.setattr(tasks, "run_model", lambda *_: broken)
    table = rb.sweep(WALL, {"joint.friction": [0.3]}, "limit", jobs=1)
    assert list(table["status"]) == ["failed"]
    assert "ZeroDivisionError" in table["message"][0]


def test_a_sweep_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers in the folder are not computed again, whatever stands before or after them now."""
    rb.sweep(WALL, {"joint.friction": [0.3, 0.2]}, "limit", folder=tmp_path, jobs=1)
    computed = []

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


class Gust(Action):
    """A push on all blocks by a function of their height, and what no force tells."""

    def __init__(self, profile: Callable[[Array], Array], *record: Array) -> None:
        self.profile, self.record = profile, record

    def forces(self, scene: Scene) -> Forces:
        """The push, to the right."""
        return Forces.on(scene, np.outer(self.profile(scene.blocks.centroid[:, 1]), [1.0, 0.0]))


class ReadLeft(Gust):
    """The same, with displacements read at another block."""

    def control(self, scene: Scene) -> tuple[Indices, Array, Array]:
        """The first block, at the origin."""
        return np.array([0]), np.zeros(2), np.array([1.0, 0.0])


ReadLeft.__name__ = "Gust"


def test_a_load_of_ones_own_is_known_by_what_it_does_and_not_by_where_it_lies() -> None:
    def key(load: Gust) -> str:
        return fingerprint(WALL.with_({"load.live": load}).scene, "limit", 0.01)

    def gust(factor: float = 1.0, kind: type[Gust] = Gust, last: float = 0.0) -> Gust:
        return kind(lambda height: 1.0 + factor * height, np.append(np.zeros(2000), [last, 0.0, 0.0, 0.0]))

    assert key(gust()) == key(gust())
    others = (gust(2.0), gust(kind=ReadLeft), gust(last=1.0))
    assert len({key(gust()), *map(key, others)}) == 4


def test_a_model_of_ones_own_may_be_swept(tmp_path: Path) -> None:
    """Exact: the monolith slides at λ = tan φ."""
    model = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "own_model.py"))["MONOLITH"]
    for _ in range(2):
        table = rb.sweep(WALL, {"joint.friction": [0.2, 0.3]}, model, folder=tmp_path, jobs=1)
        assert np.asarray(table["multiplier"]) == pytest.approx([0.2, 0.3])


def test_a_word_of_numpy_that_is_left_out_is_none() -> None:
    """Or what pandas has for it, and not a word."""
    table = rb.sweep(WALL, {"title": [np.str_("a"), None]}, "limit", jobs=1)
    assert [isinstance(title, str) for title in table["title"]] == [True, False]


def test_an_unknown_model_is_refused_at_once() -> None:
    with pytest.raises(rb.SceneError, match='did you mean "limit"?'):
        rb.sweep(WALL, {"joint.friction": [0.3]}, "limt")


@pytest.mark.parametrize("value", [0.4, "base", {"kind": "base"}, np.array(0.4)])
def test_values_are_a_list(value: Any) -> None:
    with pytest.raises(rb.SceneError, match="must be a list of the values"):
        rb.sweep(WALL, {"support.kind": value}, "limit")


@pytest.mark.parametrize("key", ["status", "multiplier", "message"])
def test_columns_of_the_answer_are_no_keys(key: str) -> None:
    """They were in the table once, with the values of the key."""
    with pytest.raises(rb.SceneError, match=f"{key} = .*: is no key of a scene, but a column"):
        rb.sweep(WALL, {key: [1, 2]}, "limit")


def test_an_interrupted_sweep_is_an_interruption(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(tasks, "run_model", interrupted)
    with pytest.raises(KeyboardInterrupt):
        rb.sweep(WALL, {"joint.friction": [0.3]}, "limit", jobs=1)


def test_a_folder_that_is_a_file_is_refused_before_anything_is_computed(tmp_path: Path) -> None:
    (tmp_path / "kept").write_text("")
    with pytest.raises(FileExistsError, match="is not a folder; name one.*kept"):
        rb.sweep(WALL, {"joint.friction": [0.2, 0.3]}, "limit", folder=tmp_path / "kept", jobs=1)


# --- finite displacements ---------------------------------------------------------------------------------------

BLOCK = rb.Wall.running_bond(
    length=0.06,
    height=0.24,
    block_width=0.06,
    block_height=0.24,
    thickness=0.12,
    density=1800.0,
    friction=1.4,
    normal_stiffness=1e10,
    shear_stiffness=4e9,
)


def test_a_sweep_pushes_walls_as_far_as_it_is_asked_to_and_keeps_each_way_apart(tmp_path: Path) -> None:
    """λ = b / h of a block that topples. Of small displacements and of two distances there are three answers."""
    said, far = [], {"displacements": "finite", "distance": 0.01}
    for way in ({}, far, {**far, "distance": 0.004}, far):
        table = rb.sweep(
            BLOCK, {"wall.thickness": [0.12, 0.2]}, "dem-dynamic", folder=tmp_path, jobs=1, **cast(Any, way)
        )
        assert np.asarray(table["multiplier"]) == pytest.approx([0.25, 0.25], rel=0.01)
        said.append((list(table["message"]), list(table["seconds"])))
    assert "small displacements" in said[0][0][0]
    assert "finite displacements" in said[1][0][0]
    assert said[3] == said[1]  # the same answers, found again
    kept = [load_outcome(folder)[0] for folder in sorted(tmp_path.glob("*/dem-dynamic"))]
    assert len(kept) == 6
    far_ones = sorted(float(each.curve[-1, 0]) for each in kept if "finite" in each.message)
    assert far_ones == pytest.approx([0.004, 0.004, 0.01, 0.01], rel=0.02)


def test_walls_that_are_not_pushed_are_rows_of_a_sweep_by_a_distance() -> None:
    """One whose ground moves, and one whose support settles, which go as far as they do."""
    pulse = {"pulse": {"kind": "sine", "amplitude": 0.4, "period": 0.6}, "quantity": "g"}
    sinks = {"kind": "settlement", "box": [[-1, -1], [1, 0]], "by": [0, -0.01]}
    loads = [{"live": None, "history": pulse}, {"live": sinks}]
    table = rb.sweep(BLOCK, {"load": loads}, "dem-dynamic", displacements="finite", distance=0.1, jobs=1)
    assert list(table["status"]) == ["refused", "refused"]
    assert "displacements = 'finite': is not taken where the ground moves" in table["message"][0]
    assert "distance = 0.1: goes with finite displacements of a wall that its live load pushes" in table["message"][1]


@pytest.mark.parametrize(
    ("model", "way", "said"),
    [
        ("limit", {"displacements": "finite"}, '^displacements = .*: must be "small" for limit; dem-dynamic and fem'),
        ("fem", {"displacements": "finit"}, "^displacements = 'finit': must be one of .*; did you mean \"finite\""),
        ("fem", {"distance": 0.1}, '^distance = 0.1: goes with displacements="finite" alone'),
        ("fem", {"displacements": "finite", "distance": 0.0}, "^distance = 0.0: must be a number above 0"),
        ("fem", {"displacements": "finite", "distance": "far"}, "^distance = 'far': must be a number above 0"),
    ],
)
def test_displacements_that_a_model_does_not_follow_are_refused_at_once(
    model: str, way: dict[str, Any], said: str, tmp_path: Path
) -> None:
    """By sweeps and by draws, with the same words; nothing is kept."""
    with pytest.raises(rb.SceneError, match=said):
        rb.sweep(BLOCK, {"wall.thickness": [0.12]}, model, folder=tmp_path / "kept", **way)
    with pytest.raises(rb.SceneError, match=said):
        BLOCK.draws(model, 2, folder=tmp_path / "kept", **way)
    assert not (tmp_path / "kept").exists()
