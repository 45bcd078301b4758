"""A law, a load and a model of a user's own, plugged in from outside: the examples run and say what is true."""

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
    """Lower and upper end, infinite where there is none."""
    lower, upper = result.lower, result.upper
    return -np.inf if lower is None else lower, np.inf if upper is None else upper


@pytest.mark.long
def test_joints_that_are_polished_bear_less_than_rough_ones() -> None:
    """Blocks that slide and rock before they fall lose friction on the way: wall W2 falls earlier."""
    names = example("own_law", run=True)
    rough, polished = names["rough"], names["polished"]
    assert polished.status == rough.status == "collapse"
    assert bracket(polished)[1] < bracket(rough)[0]


def test_a_wall_that_slides_at_once_does_so_before_it_is_polished() -> None:
    """Exact: λ = tan φ, for a block that has not slid has all of its friction."""
    law = example("own_law")["LAW"]
    mortar = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
    size = {"block_width": 0.4, "block_height": 0.1, "thickness": 0.2}
    block = rb.Wall.courses([[2]], **size, density=1800.0, friction=0.4, mortar=mortar, law=law)
    lower, upper = bracket(block.run("dem-dynamic"))
    assert lower * 0.99 < 0.4 < upper * 1.01


def test_a_dam_slides_under_water_as_the_square_of_its_depth() -> None:
    """Exact: λ = tan φ ρ L H / (ρ_w h² / 2), which for this dam is 3 / h² (it would topple at twice that)."""
    found = example("own_load")
    for level in (0.5, 0.8, 1.0):
        wall = found["dam"].with_({"load.live": found["Water"](level)})
        assert wall.run("limit").multiplier == pytest.approx(3 / level**2, rel=1e-6)


def test_water_presses_with_its_weight_at_a_third_of_its_depth() -> None:
    """Exact, on blocks of the face above and below the level: F = ρ_w g t h² / 2 at h / 3."""
    found = example("own_load")
    for level in (0.35, 1.0):
        forces = found["Water"](level).forces(found["dam"].scene)
        assert forces.force[:, 0].sum() == pytest.approx(1000 * 9.81 * level**2 / 2)
        assert np.average(forces.at[:, 1], weights=forces.force[:, 0]) == pytest.approx(level / 3)


@pytest.mark.filterwarnings("ignore:joint.cohesion = 10")
def test_a_wall_in_one_block_is_never_weaker_than_one_of_many() -> None:
    """The block's motion is a mechanism of the wall, so limit analysis finds no larger load."""
    model = example("own_model")["MONOLITH"]
    for name in ("panel-01", "panel-05", "panel-09", "wall-w1"):
        wall = rb.read(name)
        whole = wall.run(model)
        assert whole.model == "monolith"
        assert bracket(wall.run("limit"))[1] <= bracket(whole)[1] * (1 + 1e-6)
    with pytest.raises(rb.SceneError, match="dry joints"):
        rb.read("panel-01").with_({"joint.cohesion": 10.0}).run(model)


def test_water_presses_on_blocks_as_thick_as_they_are() -> None:
    """A dam as thick all over bears the same water, whichever key has its thickness."""
    dam = example("own_load")["dam"]
    assert dam.with_({"block.thickness": 0.5}).run("limit").multiplier == pytest.approx(dam.run("limit").multiplier)


@pytest.mark.parametrize("name", ["make_mesh", "own_load", "own_model"])
def test_examples_run_as_they_are(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    example(name, run=True)
    assert capsys.readouterr().out


def test_examples_of_ones_own_are_short_and_shown_on_the_page() -> None:
    page = (EXAMPLES.parent / "docs" / "python.md").read_text()
    for name in ("own_law", "own_load", "own_model"):
        lines = (EXAMPLES / f"{name}.py").read_text().splitlines()
        assert len([line for line in lines if line.strip()]) <= 50
        assert f"examples/{name}.py" in page
