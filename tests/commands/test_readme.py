"""Commands and Python code of the README run as they are printed there."""

import re
from pathlib import Path

import pytest

from runningbond.commands.command_line import command
from runningbond.models import MODELS
from runningbond.pictures.offscreen import why_not_drawn

README = (Path(__file__).parents[2] / "README.md").read_text()


def _block(language: str) -> str:
    found = re.search(rf"```{language}\n(.*?)```", README, re.DOTALL)
    assert found is not None
    return found.group(1)


@pytest.fixture
def wall(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "wall.toml"
    path.write_text(_block("toml"))
    return path


def test_commands_run_one_after_the_other(wall: Path) -> None:
    lines = re.findall(r"^\.venv/bin/runningbond (.*)$", README, re.MULTILINE)
    assert len(lines) >= 5
    draws = not why_not_drawn()
    for line in lines:
        assert command(line.split()) == (0 if draws or not line.startswith("render") else 3), line


def test_python_lines_run(wall: Path, capsys: pytest.CaptureFixture[str]) -> None:
    exec(_block("python"), {})  # the README's own lines
    assert capsys.readouterr().out.startswith("collapse")


def test_every_model_has_a_row_in_the_table() -> None:
    for model in MODELS:
        assert f"| `{model}` |" in README
