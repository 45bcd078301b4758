"""Messages and exit codes of interrupted commands that store what they have found."""

import errno
import json
import signal
import sys
from pathlib import Path

import pytest

from runningbond.campaigns import Campaign, Interrupted
from runningbond.commands.command_line import command
from runningbond.commands.terminal import BAD_INPUT, NO_ANSWER, STOPPED, interruptions, report_interrupt
from runningbond.models import MODELS, Model

KEPT = "0 of 5 cases are kept in out; the same command goes on.\n"


@pytest.mark.parametrize(
    ("cause", "reason", "code", "said"),
    [
        (None, "", STOPPED, f"Interrupted: {KEPT}"),
        (OSError(errno.ENOSPC, "full"), "out: full", BAD_INPUT, f"runningbond: out: full: {KEPT}"),
        (RuntimeError(), "the cluster failed", NO_ANSWER, f"runningbond: the cluster failed: {KEPT}"),
    ],
)
def test_interrupted_campaign_reports_cause_and_stored_results(
    cause: Exception | None, reason: str, code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    stopped = Interrupted(Campaign(), reason)
    stopped.__cause__ = cause
    assert report_interrupt(stopped, 5, "cases", Path("out")) == code
    assert capsys.readouterr() == ("", said)


def test_interrupted_advice_reports_the_rungs_so_far(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Earlier, the command printed nothing, and with ``--json`` no object."""

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


@pytest.mark.parametrize(
    ("folder", "fresh", "kept"),
    [
        (None, False, "nothing is kept without --out"),
        (Path("out"), True, "0 of 5 cases are kept in out; the same command without --fresh goes on."),
    ],
)
def test_resume_hint_without_out_and_with_fresh(
    folder: Path | None, fresh: bool, kept: str, capsys: pytest.CaptureFixture[str]
) -> None:
    report_interrupt(Interrupted(Campaign(), ""), 5, "cases", folder, fresh=fresh)
    assert capsys.readouterr().err == f"Interrupted: {kept}\n"


@pytest.mark.parametrize("is_terminal", [True, False])
def test_first_interrupt_prints_a_hint_on_a_terminal(
    is_terminal: bool, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """With 100 000 blocks minutes passed without output, in which a second Ctrl-C loses all results."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: is_terminal)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        received = interruptions(MODELS["limit"])
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL
    finally:
        for number, listener in before.items():
            signal.signal(number, listener)
    assert received == [signal.SIGINT]
    said = capfd.readouterr().err
    assert ("limit: ends with what it has by now; Ctrl-C again ends it at once\n" in said) == is_terminal == bool(said)
