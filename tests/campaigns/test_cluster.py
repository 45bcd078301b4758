"""A campaign on a cluster gives the same results as on one machine, even if workers die."""

import json
import os
import signal
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from runningbond.campaigns import Campaign, Cell, run_campaign
from runningbond.commands.command_line import command
from runningbond.models import Model, run_model
from runningbond.results import Outcome
from runningbond.scene import Scene
from tests.walls import courses, panel

distributed = pytest.importorskip("distributed")

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}


@pytest.fixture(scope="module")
def local_cluster() -> Iterator[Any]:
    """Dask scheduler in this process, and a worker in a process of its own that is restarted when it dies."""
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        yield cluster


def connected(local_cluster: Any) -> Any:
    return distributed.Client(local_cluster.scheduler_address, set_as_default=False)


@pytest.fixture
def client(local_cluster: Any) -> Iterator[Any]:
    """Connection through which a test inspects and disturbs two workers."""
    local_cluster.scale(2)
    with connected(local_cluster) as client:
        client.wait_for_workers(2, timeout=120)
        yield client
        client.run(restore, on_error="ignore")  # a worker that died has been replaced by a new one


def scheduler(client: Any) -> str:
    return str(client.scheduler.address)


def results_of(campaign: Campaign) -> dict[Cell, dict[str, Any] | str]:
    """All results of a campaign except run times."""
    found = {cell: outcome.summary() | {"seconds": None} for cell, outcome in campaign.outcomes.items()}
    return found | campaign.inapplicable


def patch_worker(changes: dict[str, Any]) -> None:
    """Replace module attributes in a worker's process, and remember the original ones."""
    from importlib import import_module

    for name, value in changes.items():
        module, attribute = name.split(":")
        before = import_module(module)
        PATCHED.append((before, attribute, getattr(before, attribute)))
        setattr(before, attribute, value)


PATCHED: list[tuple[Any, str, Any]] = []


def restore() -> None:
    for module, attribute, value in PATCHED:
        setattr(module, attribute, value)
    PATCHED.clear()


def kill_process(model: Model, scene: Scene, tolerance: float, observe: object = None) -> Outcome:
    """Run a model, but kill the worker for one wall, as the kernel does when memory runs out."""
    if scene.title == "too large":
        os.kill(os.getpid(), signal.SIGKILL)
    return model.solve(scene, tolerance)


def other_sources() -> str:
    return "others"


def test_worker_with_other_sources_is_refused(
    local_cluster: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Even if it is the only worker, with one core, for which joblib by itself would compute in this process."""
    with connected(local_cluster) as client:
        client.run(patch_worker, {"runningbond.campaigns.fingerprint:code_digest": other_sources})
        line = ["compare", "panel-04", "--models", "limit", "--out", str(tmp_path), "--cluster", scheduler(client)]
        assert command(line) == 3
        client.run(restore, on_error="ignore")  # a worker that died has been replaced by a new one
    printed = capsys.readouterr()
    assert "other sources or libraries" in printed.err
    assert "0 of 1 cases are kept" in printed.err
    assert not list(tmp_path.glob("*/*"))


def kill_once(model: Model, scene: Scene, tolerance: float, observe: object = None, *, note: str) -> Outcome:
    """`run_model`, but kill the process once, when a dem-dynamic run first carries some of its live load."""

    def die(run: object, state: object, multiplier: float) -> None:
        if multiplier > 0 and not Path(note).exists():
            Path(note).write_text("killed")
            os.kill(os.getpid(), signal.SIGKILL)

    return run_model(model, scene, tolerance, die if model.name == "dem-dynamic" else None)


def test_killed_worker_does_not_change_the_results(client: Any, tmp_path: Path) -> None:
    """One of two workers dies during a dem-dynamic run; the results equal those of a campaign without a cluster."""
    scenes = {
        "wall": panel(wall__length=0.48, wall__height=0.24, joint__mortar=MORTAR),
        "stack": courses([[1], [1]], width=0.2, height=0.2, joint__mortar=MORTAR),
    }
    models = ["homog", "limit", "limit-nonassociated", "dem-dynamic"]
    here, there, note = tmp_path / "here", tmp_path / "there", tmp_path / "note"
    expected = results_of(run_campaign(scenes, models, folder=here, jobs=1))
    kept = {path.parent.relative_to(here).parts for path in here.glob("*/*/outcome.json")}
    assert set(expected) - kept == {("stack", "homog")}, "says nothing about a stack"
    done: list[Cell] = []

    def look(cell: Cell) -> None:
        done.append(cell)
        assert (there.joinpath(*cell) / "outcome.json").exists() == (cell in kept), "is kept as soon as it is there"

    client.run(patch_worker, {"runningbond.campaigns.tasks:run_model": partial(kill_once, note=str(note))})
    found = run_campaign(scenes, models, folder=there, cluster=scheduler(client), progress=look)
    assert note.exists()
    assert sorted(done) == sorted(expected)
    assert results_of(found) == expected
    # A local campaign reuses the results of the cluster.
    assert run_campaign(scenes, models, folder=there, jobs=1).reused == kept


def test_wall_that_kills_its_workers_fails_alone(
    client: Any, local_cluster: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(local_cluster.scheduler, "allowed_failures", 0)
    client.run(patch_worker, {"runningbond.campaigns.tasks:run_model": kill_process})
    scenes = {"large": panel(title="too large"), "small": panel()}
    campaign = run_campaign(scenes, ["limit"], folder=tmp_path, cluster=scheduler(client))
    assert campaign.outcomes["small", "limit"].status == "collapse"
    assert campaign.outcomes["large", "limit"].status == "failed"
    assert "killed" in campaign.outcomes["large", "limit"].message
    assert not (tmp_path / "large").exists()


def test_cluster_may_be_given_by_scheduler_file(client: Any, tmp_path: Path) -> None:
    file = tmp_path / "scheduler.json"
    file.write_text(json.dumps({"type": "Scheduler", "address": scheduler(client)}))
    campaign = run_campaign({"wall": panel()}, ["limit"], folder=tmp_path, cluster=str(file))
    assert campaign.outcomes["wall", "limit"].status == "collapse"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--cluster", "tcp://127.0.0.1:9"], "--cluster = 'tcp://127.0.0.1:9': is neither"),
        (["--cluster", "no such file"], "is neither the address of a Dask scheduler nor its file"),
        (["--cluster", __file__], "is neither the address of a Dask scheduler nor its file"),
        (["--cluster", "tcp://127.0.0.1:9", "--jobs", "2"], "--jobs = 2: does not go with --cluster"),
    ],
)
def test_invalid_cluster_is_refused(
    arguments: list[str],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("runningbond.campaigns.cluster.PATIENCE", 1)
    assert command(["compare", "panel-04", "--models", "limit", "--out", str(tmp_path), *arguments]) == 2
    printed = capsys.readouterr()
    assert said in printed.err
    assert printed.out == ""


def test_invalid_cluster_address_is_refused_before_any_output(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert command(["compare", "panel-04", "--models", "homog", "--out", str(out), "--cluster", "nowhere"]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not out.exists()
