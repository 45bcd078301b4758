"""First use of the commands: a scene to start from, misspelled scene names and faulty files."""

import shlex
import tomllib
from pathlib import Path

import pytest

from runningbond.commands.command_line import app, command
from runningbond.limit import limit
from runningbond.scene import read_scene
from runningbond.scene.plausibility import warnings


def test_new_scene_runs_without_warnings(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    assert command(["new", str(path)]) == 0
    said = capsys.readouterr().out
    assert said.startswith(str(path))
    assert f"runningbond run {path} --model limit" in said
    scene = read_scene(path)
    assert not warnings(scene)
    assert not scene.notes
    assert limit(scene).status == "collapse"


def test_suggested_commands_quote_the_path(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "my wall.toml"
    assert command(["new", str(path)]) == 0
    for line in capsys.readouterr().out.splitlines()[2:]:
        assert str(path) in shlex.split(line)


def test_commented_out_keys_of_a_new_scene_are_toml(tmp_path: Path) -> None:
    """Each of the keys that are commented out, at least six, is valid TOML."""
    path = tmp_path / "mine.toml"
    command(["new", str(path)])
    lines = path.read_text(encoding="utf-8").splitlines()
    spare = [k for k, line in enumerate(lines) if line.startswith("# ") and " = " in line]
    assert len(spare) >= 6
    for k in spare:
        assert tomllib.loads(lines[k].removeprefix("# ").split("   ")[0])


@pytest.mark.parametrize("name", ["mine.toml", "mine.txt", "folder.toml"])
def test_nothing_is_overwritten(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / name
    path.mkdir() if name.startswith("folder") else path.write_text("kept")
    assert command(["new", str(path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert path.is_dir() or path.read_text() == "kept"
    assert [one.name for one in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize(
    ("given", "meant"),
    [("pannel-01", "panel-01"), ("panel_07", "panel-07"), ("wal-w4", "wall-w4"), ("pointload-2", "point-load-2")],
)
@pytest.mark.parametrize("verb", [["run", "--model", "limit"], ["show"], ["compare", "--models", "limit"]])
def test_misspelled_scene_name_gets_a_suggestion(
    given: str, meant: str, verb: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert command([verb[0], given, *verb[1:]]) == 2
    assert f'did you mean "{meant}"?' in capsys.readouterr().err


@pytest.mark.parametrize("name", ["xyz", "42", "no/such/file.toml"])
def test_unknown_scene_name_gets_no_suggestion(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["show", name]) == 2
    assert "did you mean" not in capsys.readouterr().err


@pytest.mark.parametrize("content", ["[wall]\n", "nonsense", "title = 3\n", "[wall]\nblock_width = -1\n"])
def test_compare_names_the_faulty_file(tmp_path: Path, content: str, capsys: pytest.CaptureFixture[str]) -> None:
    bad = tmp_path / "bad.toml"
    bad.write_text(content)
    assert command(["compare", "panel-01", str(bad), "--models", "limit", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert error.startswith(f"runningbond: {bad}: ")
    assert error.count(str(bad)) == 1
    assert not (tmp_path / "out").exists()


def test_version_has_three_numbers(capsys: pytest.CaptureFixture[str]) -> None:
    assert command(["--version"]) == 0
    assert capsys.readouterr().out.strip().count(".") == 2


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_shells_can_complete_every_command(shell: str) -> None:
    text = app.generate_completion(shell=shell)  # type: ignore[arg-type]
    assert all(name in text for name in ("new", "run", "compare", "render", "stability"))
