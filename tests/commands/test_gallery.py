"""The walls of examples/walls: what their page says they print, printed again."""

import json
import re
from pathlib import Path

import pytest

from runningbond.commands.command_line import command
from tests.at_length import at_length

FOLDER = Path(__file__).parents[2] / "examples" / "walls"
PAGE = (FOLDER / "README.md").read_text()
RUNS = re.findall(r"^\$ runningbond (run \S+ --model (\S+))\n(.*)\n +(.*)\n +(.*)\n", PAGE, re.MULTILINE)
SLOW = [run for run in RUNS if ("facade" in run[0] and run[1] != "limit") or run[1] in ("dem-dynamic", "fem")]
QUICK = [run for run in RUNS if run not in SLOW]


@pytest.mark.parametrize(
    ("line", "model", "head", "answer", "message"),
    [*QUICK, *at_length(*SLOW)],
    ids=[run[0] for run in (*QUICK, *SLOW)],
)
def test_a_wall_prints_what_its_page_says(
    line: str,
    model: str,
    head: str,
    answer: str,
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Limit analysis to its digits and words; what follows a path to its bracket, for friction remembers."""
    monkeypatch.chdir(FOLDER.parents[1])
    assert command([*line.split(), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert head == f"{printed['scene']}: {model}"
    status, *numbers = re.split(r"[:,] \S+ ", answer.replace("\u00a0", " "))
    assert printed["status"] == status
    written = [float(number) for number in numbers]
    if model == "limit":
        assert printed["message"] == message
    slack = 1e-5 if model.startswith("limit") else 0.01
    assert [printed[key] for key in ("multiplier", "lower", "upper")] == pytest.approx(written, rel=slack)


def test_every_wall_has_its_picture_and_its_runs() -> None:
    walls = {path.stem for path in FOLDER.glob("*.toml")}
    assert len(walls) == 6
    for wall in walls:
        assert f"({wall}.png)" in PAGE
        assert (FOLDER / f"{wall}.png").is_file()
        assert sum(wall in run[0] for run in RUNS) >= 2


def test_a_wall_is_pushed_both_ways() -> None:
    """The beams and half a roof stand nearer to the left end: pushed to the left the wall falls at another load."""
    import runningbond as rb

    right = rb.read(FOLDER / "floor_beams.toml")
    live = [{"kind": "lateral", "direction": "left"}]
    left = right.with_({"load.live": live}).run("limit")
    assert left.multiplier != pytest.approx(right.run("limit").multiplier, rel=1e-3)
