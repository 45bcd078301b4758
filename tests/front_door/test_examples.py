"""The example scripts, among them a user-defined law, load and model: they run and give correct results."""

import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import runningbond as rb

EXAMPLES = Path(__file__).parents[2] / "examples"


def example(name: str, run: bool = False) -> dict[str, Any]:
    return runpy.run_path(str(EXAMPLES / f"{name}.py"), run_name="__main__" if run else name)


def bracket(result: rb.Result) -> tuple[float, float]:
    """Lower and upper bound, infinite if there is none."""
    lower, upper = result.lower, result.upper
    return -np.inf if lower is None else lower, np.inf if upper is None else upper


@pytest.mark.long
def test_joints_that_lose_friction_by_slip_reduce_the_multiplier() -> None:
    """Blocks of wall W2 slide and rock before they fall, and lose friction meanwhile: the multiplier is lower."""
    names = example("own_law", run=True)
    rough, polished = names["rough"], names["polished"]
    assert polished.status == rough.status == "collapse"
    assert bracket(polished)[1] < bracket(rough)[0]


def test_first_sliding_has_the_full_friction() -> None:
    """Exact: λ = tan φ, because a block that has not slid has its full friction."""
    law = example("own_law")["LAW"]
    mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
    size = {"block_width": 0.4, "block_height": 0.1, "thickness": 0.2}
    block = rb.Wall.courses([[2]], **size, density=1800.0, friction=0.4, mortar=mortar, law=law)
    lower, upper = bracket(block.run("dem-dynamic"))
    assert lower * 0.99 < 0.4 < upper * 1.01


def test_sliding_multiplier_of_a_dam_under_water() -> None:
    """Exact: λ = tan φ ρ L H / (ρ_w h² / 2), which for this dam is 3 / h² (it would overturn at twice that)."""
    found = example("own_load")
    for level in (0.5, 0.8, 1.0):
        wall = found["dam"].with_({"load.live": found["Water"](level)})
        assert wall.run("limit").multiplier == pytest.approx(3 / level**2, rel=1e-6)


def test_resultant_of_water_pressure() -> None:
    """Exact, also for a level within a block: F = ρ_w g t h² / 2 at h / 3."""
    found = example("own_load")
    for level in (0.35, 1.0):
        forces = found["Water"](level).forces(found["dam"].scene)
        assert forces.force[:, 0].sum() == pytest.approx(1000 * 9.81 * level**2 / 2)
        assert np.average(forces.at[:, 1], weights=forces.force[:, 0]) == pytest.approx(level / 3)


@pytest.mark.filterwarnings("ignore:joint.cohesion = 10")
def test_monolith_is_an_upper_bound_of_limit_analysis() -> None:
    """The monolith's motion is also a mechanism of the wall, so limit analysis finds no larger load."""
    model = example("own_model")["MONOLITH"]
    for name in ("panel-01", "panel-05", "panel-09", "wall-w1"):
        wall = rb.read(name)
        whole = wall.run(model)
        assert whole.model == "monolith"
        assert bracket(wall.run("limit"))[1] <= bracket(whole)[1] * (1 + 1e-6)
    point = {"kind": "point", "at": [0.24, 0.72], "force": [0.0, -1000.0]}
    refused: list[tuple[dict[str, Any], str]] = [
        ({"joint.cohesion": 10.0}, "dry joints"),
        ({"support.kind": "corners"}, "no pins"),
        ({"load.live": point}, "a lateral load to the right alone"),
        ({"load.live": {"kind": "lateral", "direction": "left"}}, "to the right alone"),
        ({"load.dead": [point]}, "to the right alone"),
    ]
    for change, said in refused:
        with pytest.raises(rb.SceneError, match=said):
            rb.read("panel-01").with_(change).run(model)


def test_water_pressure_uses_the_thickness_of_the_blocks() -> None:
    """The multiplier is the same whether `wall.thickness` or `block.thickness` sets the uniform thickness."""
    dam = example("own_load")["dam"]
    assert dam.with_({"block.thickness": 0.5}).run("limit").multiplier == pytest.approx(dam.run("limit").multiplier)


@pytest.mark.parametrize("name", ["make_mesh", "own_load", "own_model"])
def test_examples_run_unchanged(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    example(name, run=True)
    assert capsys.readouterr().out


def test_examples_of_extensions_are_short_and_linked_in_the_docs() -> None:
    page = (EXAMPLES.parent / "docs" / "python.md").read_text()
    for name in ("own_law", "own_load", "own_model"):
        lines = (EXAMPLES / f"{name}.py").read_text().splitlines()
        assert len([line for line in lines if line.strip()]) <= 50
        assert f"examples/{name}.py" in page
