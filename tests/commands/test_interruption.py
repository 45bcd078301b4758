"""What a command that keeps what it has says when it is stopped, and its exit code."""

import errno
import json

import pytest

from runningbond.campaigns import Campaign, Interrupted
from runningbond.commands.command_line import command
from runningbond.commands.terminal import BAD_INPUT, NO_ANSWER, STOPPED, told_interruption
from runningbond.models import Model


@pytest.mark.parametrize(
    ("cause", "reason", "code", "said"),
    [
        (None, "", STOPPED, "Interrupted: 3 of 5 kept\n"),
        (OSError(errno.ENOSPC, "full"), "out: full", BAD_INPUT, "runningbond: out: full: 3 of 5 kept\n"),
        (RuntimeError(), "the cluster failed", NO_ANSWER, "runningbond: the cluster failed: 3 of 5 kept\n"),
    ],
)
def test_who_is_stopped_is_told_why_and_what_is_kept(
    cause: Exception | None, reason: str, code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    stopped = Interrupted(Campaign(), reason)
    stopped.__cause__ = cause
    assert told_interruption(stopped, "3 of 5 kept") == code
    assert capsys.readouterr() == ("", said)


def test_a_climb_that_is_stopped_says_how_far_it_came(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It ended without a word, and in JSON without an object."""

    def at_limit(model: Model) -> list[int]:
        return [2] if model.name == "limit" else []

    monkeypatch.setattr("runningbond.commands.advise.interruptions", at_limit)
    assert command(["advise", "wall-w3", "--json"]) == STOPPED
    told = json.loads(capsys.readouterr().out)
    assert [rung["model"] for rung in told["rungs"]] == ["homog", "limit"]
    assert told["upper"] == told["rungs"][-1]["upper"] == pytest.approx(0.4037, rel=1e-3)
    assert told["message"].startswith("interrupted before limit-nonassociated: ")
    assert command(["advise", "wall-w3"]) == STOPPED
    assert "\n  interrupted before limit-nonassociated: " in capsys.readouterr().out
