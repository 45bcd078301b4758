"""What a command that keeps what it has says when it is stopped, and its exit code."""

import errno

import pytest

from runningbond.campaigns import Campaign, Interrupted
from runningbond.commands.terminal import BAD_INPUT, NO_ANSWER, STOPPED, told_interruption


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
