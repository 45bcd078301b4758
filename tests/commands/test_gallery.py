"""The walls of examples/walls print what their page shows."""

import json
import re
from pathlib import Path

import pytest

from runningbond.commands.command_line import command
from tests.at_length import at_length

FOLDER = Path(__file__).parents[2] / "examples" / "walls"
PAGE = (FOLDER / "README.md").read_text()
RUNS = re.findall(r"^\$ runningbond (run \S+ --model (\S+))\n(?:note: .*\n)*(.*)\n +(.*)\n +(.*)\n", PAGE, re.MULTILINE)
SLOW = [run for run in RUNS if ("facade" in run[0] and run[1] != "limit") or run[1] in ("dem-dynamic", "fem")]
QUICK = [run for run in RUNS if run not in SLOW]


@pytest.mark.parametrize(
    ("line", "model", "head", "answer", "message"),
    [*QUICK, *at_length(*SLOW)],
    ids=[run[0] for run in (*QUICK, *SLOW)],
)
def test_example_walls_print_what_their_page_shows(
    line: str,
    model: str,
    head: str,
    answer: str,
    message: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Limit analysis to 1e-5; other models to 1 %, because friction depends on the path. Messages word for word."""
    monkeypatch.chdir(FOLDER.parents[1])
    assert command([*line.split(), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert head == f"{printed['scene']}: {model}"
    status, *numbers = re.split(r"[:,] \S+ ", answer.replace("\u00a0", " "))
    assert printed["status"] == status
    written = [float(number) for number in numbers]
    assert printed["message"] == message
    slack = 1e-5 if model.startswith("limit") else 0.01
    assert [printed[key] for key in ("multiplier", "lower", "upper")] == pytest.approx(written, rel=slack)


def test_every_example_wall_has_a_picture_and_two_runs() -> None:
    walls = {path.stem for path in FOLDER.glob("*.toml")}
    assert len(walls) == 6
    for wall in walls:
        assert f"({wall}.png)" in PAGE
        assert (FOLDER / f"{wall}.png").is_file()
        assert sum(wall in run[0] for run in RUNS) >= 2


def test_collapse_load_differs_when_pushed_to_the_left() -> None:
    """Beams and half a roof rest nearer to the left end, so the collapse load to the left is another one."""
    import runningbond as rb

    right = rb.read(FOLDER / "floor_beams.toml")
    live = [{"kind": "lateral", "direction": "left"}]
    left = right.with_({"load.live": live}).run("limit")
    assert left.multiplier != pytest.approx(right.run("limit").multiplier, rel=1e-3)
