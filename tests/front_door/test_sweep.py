"""Sweeps: one row per combination, stored and reused, with refused walls as rows."""

import runpy
import sys
from collections.abc import Callable
from dataclasses import dataclass
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
from tests.at_length import at_length

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


ONE_KIND = pytest.mark.parametrize("tables", ["structured arrays", *at_length("pandas")], indirect=True)
"""For sweeps that take seconds and whose results do not depend on the kind of table."""


@pytest.mark.parametrize("values", [[], np.arange(0.6, 0.4, 0.1), iter([])])
def test_key_without_values_is_refused(values: Any) -> None:
    """For example a range in the wrong direction. It once gave a table without rows, even for a misspelt key."""
    with pytest.raises(SceneError, match=r"^joint.friction = \[\]: must have one value or more"):
        rb.sweep(WALL, {"joint.friction": values}, "limit", jobs=1)


def test_low_wall_slides_at_tan_phi_for_any_thickness() -> None:
    """Exact: λ = tan φ. The last key varies fastest."""
    changes = {"joint.friction": [0.2, 0.3], "wall.thickness": [0.1, 0.2]}
    table = rb.sweep(WALL, changes, "limit", jobs=1)
    assert list(table["joint.friction"]) == [0.2, 0.2, 0.3, 0.3]
    assert list(table["wall.thickness"]) == [0.1, 0.2, 0.1, 0.2]
    assert np.asarray(table["multiplier"]) == pytest.approx([0.2, 0.2, 0.3, 0.3])
    assert set(table["status"]) == {"collapse"}


def test_refused_walls_are_rows() -> None:
    """An invalid wall, and a wall to which the model does not apply."""
    table = rb.sweep(WALL, {"joint.friction": [-1.0, 0.3]}, "limit", jobs=1)
    assert list(table["status"]) == ["refused", "collapse"]
    assert "must be a number at least 0" in table["message"][0]
    assert np.isnan(table["multiplier"][0])
    table = rb.sweep(WALL, {"joint.cohesion": [0.0, 1e3]}, "homog", jobs=1)
    assert list(table["status"]) == ["collapse", "refused"]
    assert "dry joints" in table["message"][1]


@dataclass(frozen=True)
class Wind(Action):
    """A load with no forces at some speeds, and with some only for a while."""

    speed: float

    def forces(self, scene: Scene) -> Forces:
        ASKED.append(self.speed)
        if self.speed == 3.0 and ASKED.count(3.0) > 1:
            raise RuntimeError("calm")
        return Forces.on(scene, acceleration=(1.0 / self.speed, 0.0))


ASKED: list[float] = []


def test_load_that_raises_is_a_row() -> None:
    """It ended the sweep with its own error, and with it the rows of all other loads."""
    ASKED.clear()
    table = rb.sweep(WALL, {"load.live": [Wind(2.0), Wind(0.0), Wind(3.0)]}, "limit", jobs=1)
    assert list(table["status"]) == ["collapse", "refused", "refused"]
    assert "Wind.forces: raises ZeroDivisionError" in table["message"][1]
    assert table["message"][2].endswith("raises RuntimeError: calm")


@pytest.mark.parametrize("changes", [{"joint.frictoin": [0.3, 0.4]}, {"joint.friction": [-1.0]}])
def test_sweep_without_any_valid_wall_is_refused(changes: dict[str, list[float]], tmp_path: Path) -> None:
    """Before anything is stored; otherwise a misspelt key would give a table without a number."""
    with pytest.raises(SceneError, match="is not a key of|must be a number at least 0"):
        rb.sweep(WALL, changes, "limit", jobs=1, folder=tmp_path / "kept")
    assert not (tmp_path / "kept").exists()


def test_failed_run_is_a_row(monkeypatch: pytest.MonkeyPatch) -> None:
    broken = Outcome("", "limit", "failed", message="ZeroDivisionError: by zero")
    monkeypatch.setattr(tasks, "run_model", lambda *_: broken)
    table = rb.sweep(WALL, {"joint.friction": [0.3]}, "limit", jobs=1)
    assert list(table["status"]) == ["failed"]
    assert "ZeroDivisionError" in table["message"][0]


def test_sweep_reuses_stored_outcomes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Outcomes in the folder are not computed again, even if the order of the values has changed."""
    rb.sweep(WALL, {"joint.friction": [0.3, 0.2]}, "limit", folder=tmp_path, jobs=1)
    computed = []

    def counted(*arguments: Any) -> Outcome:
        computed.append(arguments)
        return run_model(*arguments)

    monkeypatch.setattr(tasks, "run_model", counted)
    table = rb.sweep(WALL, {"joint.friction": [0.1, 0.2, 0.3]}, "limit", folder=tmp_path, jobs=1)
    assert np.asarray(table["multiplier"]) == pytest.approx([0.1, 0.2, 0.3])
    assert len(computed) == 1


@ONE_KIND
def test_parallel_sweep_gives_the_same_results() -> None:
    changes = {"joint.friction": [0.2, 0.3]}
    apart, alone = (rb.sweep(WALL, changes, "limit", jobs=jobs) for jobs in (2, 1))
    assert list(apart["multiplier"]) == list(alone["multiplier"])


def test_values_may_be_tables() -> None:
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


def test_changed_user_load_is_computed_again(tmp_path: Path) -> None:
    """Exact: λ = tan φ / factor; the load keeps its name and fields, only its code changes."""
    for factor in (1.0, 2.0, 1.0):
        (tmp_path / "push.py").write_text(LOAD.format(factor=factor))
        push = runpy.run_path(str(tmp_path / "push.py"))["Push"]
        table = rb.sweep(WALL, {"load.live": [push()]}, "limit", folder=tmp_path / "kept", jobs=1)
        assert np.asarray(table["multiplier"]) == pytest.approx([0.4 / factor])


class Gust(Action):
    """Horizontal acceleration as a function of height, and a record that does not affect the forces."""

    def __init__(self, profile: Callable[[Array], Array], *record: Array) -> None:
        self.profile, self.record = profile, record

    def forces(self, scene: Scene) -> Forces:
        """The acceleration of each block, to the right."""
        return Forces.on(scene, np.outer(self.profile(scene.blocks.centroid[:, 1]), [1.0, 0.0]))


class ReadLeft(Gust):
    """The same load with another control point."""

    def control(self, scene: Scene) -> tuple[Indices, Array, Array]:
        """The first block, at the origin."""
        return np.array([0]), np.zeros((1, 2)), np.array([[1.0, 0.0]])


ReadLeft.__name__ = "Gust"


def test_fingerprint_of_a_user_load_depends_on_its_content() -> None:
    def key(load: Gust) -> str:
        return fingerprint(WALL.with_({"load.live": load}).scene, "limit", 0.01)

    def gust(factor: float = 1.0, kind: type[Gust] = Gust, last: float = 0.0) -> Gust:
        return kind(lambda height: 1.0 + factor * height, np.append(np.zeros(2000), [last, 0.0, 0.0, 0.0]))

    assert key(gust()) == key(gust())
    others = (gust(2.0), gust(kind=ReadLeft), gust(last=1.0))
    assert len({key(gust()), *map(key, others)}) == 4


def test_sweep_with_a_user_model(tmp_path: Path) -> None:
    """Exact: the monolith slides at λ = tan φ."""
    model = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "own_model.py"))["MONOLITH"]
    for _ in range(2):
        table = rb.sweep(WALL, {"joint.friction": [0.2, 0.3]}, model, folder=tmp_path, jobs=1)
        assert np.asarray(table["multiplier"]) == pytest.approx([0.2, 0.3])


def test_missing_text_next_to_numpy_strings_is_no_string() -> None:
    """It is None, or the missing value of pandas."""
    table = rb.sweep(WALL, {"title": [np.str_("a"), None]}, "limit", jobs=1)
    assert [isinstance(title, str) for title in table["title"]] == [True, False]


def test_unknown_model_is_refused() -> None:
    with pytest.raises(rb.SceneError, match='did you mean "limit"?'):
        rb.sweep(WALL, {"joint.friction": [0.3]}, "limt")


@pytest.mark.parametrize("value", [0.4, "base", {"kind": "base"}, np.array(0.4)])
def test_values_must_be_a_list(value: Any) -> None:
    with pytest.raises(rb.SceneError, match="must be a list of the values"):
        rb.sweep(WALL, {"support.kind": value}, "limit")


@pytest.mark.parametrize("key", ["status", "multiplier", "message"])
def test_names_of_result_columns_are_refused_as_keys(key: str) -> None:
    """The values of the key once took the place of the result column."""
    with pytest.raises(rb.SceneError, match=f"{key} = .*: is no key of a scene, but a column"):
        rb.sweep(WALL, {key: [1, 2]}, "limit")


def test_interrupt_ends_a_sweep(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(tasks, "run_model", interrupted)
    with pytest.raises(KeyboardInterrupt):
        rb.sweep(WALL, {"joint.friction": [0.3]}, "limit", jobs=1)


def test_folder_that_is_a_file_is_refused_before_any_run(tmp_path: Path) -> None:
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


@ONE_KIND
def test_finite_displacements_and_distances_are_stored_separately(tmp_path: Path) -> None:
    """λ = b / h of a block that overturns; small displacements and two distances give three separate outcomes."""
    said, far = [], {"displacements": "finite", "distance": 0.01}
    for way in ({}, far, {**far, "distance": 0.004}, far):
        table = rb.sweep(
            BLOCK, {"wall.thickness": [0.12, 0.2]}, "dem-dynamic", folder=tmp_path, jobs=1, **cast(Any, way)
        )
        assert np.asarray(table["multiplier"]) == pytest.approx([0.25, 0.25], rel=0.01)
        said.append((list(table["message"]), list(table["seconds"])))
    assert "small displacements" in said[0][0][0]
    assert "finite displacements" in said[1][0][0]
    assert said[3] == said[1]  # reused from the folder
    kept = [load_outcome(folder)[0] for folder in sorted(tmp_path.glob("*/dem-dynamic"))]
    assert len(kept) == 6
    far_ones = sorted(float(each.curve[-1, 0]) for each in kept if "finite" in each.message)
    assert far_ones == pytest.approx([0.004, 0.004, 0.01, 0.01], rel=0.02)


def test_finite_displacements_refuse_ground_motions_and_settlements() -> None:
    """As refused rows: their own motion determines how far the wall moves."""
    pulse = {"pulse": {"kind": "sine", "amplitude": 0.4, "period": 0.6}, "quantity": "g"}
    sinks = {"kind": "settlement", "box": [[-1, -1], [1, 0]], "by": [0, -0.01]}
    loads = [{"live": None, "history": pulse}, {"live": sinks}]
    table = rb.sweep(BLOCK, {"load": loads}, "dem-dynamic", displacements="finite", distance=0.1, jobs=1)
    assert list(table["status"]) == ["refused", "refused"]
    assert "displacements = 'finite': is not supported where the ground moves" in table["message"][0]
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
def test_invalid_displacements_are_refused(model: str, way: dict[str, Any], said: str, tmp_path: Path) -> None:
    """By sweeps and by draws, with the same message; nothing is stored."""
    with pytest.raises(rb.SceneError, match=said):
        rb.sweep(BLOCK, {"wall.thickness": [0.12]}, model, folder=tmp_path / "kept", **way)
    with pytest.raises(rb.SceneError, match=said):
        BLOCK.draws(model, 2, folder=tmp_path / "kept", **way)
    assert not (tmp_path / "kept").exists()
