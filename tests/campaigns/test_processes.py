"""Tasks side by side on one machine."""

import pytest
from joblib import effective_n_jobs

from runningbond.campaigns import processes


@pytest.mark.parametrize(
    ("jobs", "tasks", "cores", "started"),
    [(-1, 1, 16, 2), (-1, 5, 16, 5), (-1, 40, 16, 16), (8, 5, 16, 5), (3, 5, 16, 3), (8, 40, 1, 2), (-1, 5, 1, 1)],
)
def test_no_more_processes_are_started_than_there_are_cores_and_tasks(
    jobs: int, tasks: int, cores: int, started: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two at least where there are to be processes at all: joblib computes in this one for one."""
    monkeypatch.setattr(processes, "cpu_count", lambda: cores)
    with processes._processes(jobs, tasks):
        assert effective_n_jobs(None) == started
