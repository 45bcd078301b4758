"""The commands of the tutorial print what its page shows, and its Python code runs."""

import re
from pathlib import Path
from typing import Any

import matplotlib
import pytest

from runningbond.commands.command_line import command

PAGE = (Path(__file__).parents[2] / "docs" / "tutorial.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"^\$ runningbond (.*)\n((?:.+\n)*?)```", PAGE, re.MULTILINE)
LOADS = re.compile(r"collapse: λ (\S+), lower (\S+), upper (\S+)")
DIGEST = re.compile(r"(?<=arrays-)[0-9a-f]{16}")


def numbers(text: str) -> list[float]:
    found = LOADS.search(text.replace("\u00a0", " "))
    assert found is not None, text
    return [float(number) for number in found.groups()]


def words(text: str) -> str:
    """Words without the digests of arrays, which depend on rounding errors."""
    return " ".join(DIGEST.sub("…", text).split())


def test_tutorial_prints_what_the_page_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Loads to 1 %, because with friction rounding errors may change the path; all other words must agree."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(matplotlib, "rcParams", matplotlib.rcParams.copy())
    matplotlib.use("Agg")
    assert len(COMMANDS) == 6
    for line, shown in COMMANDS:
        refused = "typo" in line
        if refused:
            scene = Path("wall.toml").read_text(encoding="utf-8")
            Path("typo.toml").write_text(scene.replace("friction =", "frictoin ="), encoding="utf-8")
        assert command(line.split()) == (2 if refused else 0), line
        output = capsys.readouterr()
        printed = output.err if refused else output.out
        for expected in shown.splitlines():
            if LOADS.search(expected):
                assert numbers(printed) == pytest.approx(numbers(expected), rel=0.01)
            else:
                assert words(expected) in words(printed), expected
    names: dict[str, Any] = {}
    for snippet in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(snippet, names)
    rising = [float(line.split()[1]) for line in capsys.readouterr().out.splitlines()]
    assert len(rising) == 3
    assert rising == sorted(rising)
    assert Path("wall.svg").exists()
