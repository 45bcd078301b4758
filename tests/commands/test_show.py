"""``runningbond show``: the wall before any analysis."""

from pathlib import Path

import pytest

from runningbond.commands.command_line import command
from runningbond.commands.inventory import rows
from runningbond.compare import published_scene

from ..walls import panel


def test_show_tells_what_the_panel_weighs() -> None:
    """Panel 1 is 1.44 × 0.72 × 0.12 m of 1800 kg/m³, in twelve courses of six or five and two halves."""
    told = dict(rows(published_scene("panel-01")))
    mass = 1800 * 1.44 * 0.72 * 0.12
    assert told["blocks"] == f"{6 * 6 + 6 * 7}, of which 0 held"
    assert told["mass of the wall"] == f"{mass:.5g} kg"
    assert told["weight of what moves"] == f"{9.81e-3 * mass:.4g} kN"
    assert told["live load at λ = 1"].startswith(f"({9.81e-3 * mass:.4g}, 0) kN, −")


def test_a_push_to_the_left_is_shown_as_one() -> None:
    told = dict(rows(panel(load__live={"kind": "lateral", "direction": "left"})))
    assert told["live load at λ = 1"].startswith("(−")


@pytest.mark.parametrize(("suffix", "begins"), [(".svg", b"<?xml"), (".PNG", b"\x89PNG")])
def test_show_draws_the_wall(suffix: str, begins: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    picture = tmp_path / f"wall{suffix}"
    assert command(["show", "wall-w3", "-o", str(picture)]) == 0
    assert picture.read_bytes().startswith(begins)
    assert "weight of what moves" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "says"),
    [(["panel-01", "-o", "wall.pdf"], "--out = 'wall.pdf': must end in .svg or .png"), (["panel-77"], "panel-77")],
)
def test_show_refuses_in_one_line(
    arguments: list[str], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert command(["show", *arguments]) == 2
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1
    assert not list(tmp_path.iterdir())
