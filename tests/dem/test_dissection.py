"""Systems by nested dissection beside banded ones: the same solutions, whatever has changed, and the same collapses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem import static_system as systems
from dem.dissection import Dissection, dissection
from dem.static import dem_static
from dem.static_system import Control, StaticSystem, static_system
from runningbond.compare import published_scene
from runningbond.scene import Array, Lateral, Scene, scene_from_dict
from runningbond.scene.beam import Drive
from tests.dem.test_led import ground_moves, under_beam, wall
from tests.dem.test_static import ferris
from tests.dem.test_ties import tie, tied
from tests.limit.test_limit import rectangle
from tests.walls import content, courses

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
SCENES = {
    "one block": wall([rectangle(0, 0, 1, 1)], Lateral()),
    "panel": published_scene("panel-05"),
    "pinned corners": published_scene("point-load-quarter"),
    "opening": published_scene("wall-w3"),
    "ties": tied([rectangle(0, k, 1, 1) for k in range(9)], [tie((0, 0.5), (0.9, 8.5), 1e8, 1e4)], Lateral()),
    "level beam": under_beam("level", Drive((1.0, 0.0), 2.0)),
    "settlement": wall([rectangle(k, 0, 1, 1) for k in range(9)], ground_moves(2, 5, (0.0, -0.01))),
}


def both(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> tuple[StaticSystem, StaticSystem]:
    """Its system in a band, and dissected."""
    band, dissected = static_system(scene), static_system(scene)
    assert not isinstance(band._factors, Dissection)
    monkeypatch.setattr(systems, "MANY", 0)
    assert isinstance(dissected._factors, Dissection)
    return band, dissected


def tangents(system: StaticSystem, generator: np.random.Generator, share: float) -> Array:
    """Coulomb tangents of points of which a share has opened or slides, regular by a little of their elasticity."""
    elastic = system.elastic
    tangent = elastic.copy()
    opens, slides = generator.random((2, len(elastic))) < share / 2
    tangent[slides, 1, 1], tangent[slides, 1, 0] = 0.0, 0.6 * elastic[slides, 0, 0]
    tangent[opens] = 0.0
    return np.asarray(tangent + 1e-3 * elastic)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("by_multiplier", [True, False])
def test_dissected_systems_have_the_solutions_of_banded_ones(
    name: str, by_multiplier: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """One after the other: points change, many, few and none, and change back."""
    band, dissected = both(SCENES[name], monkeypatch)
    generator = np.random.default_rng(1)
    many = tangents(band, generator, 0.5)
    few = np.where((generator.random(len(many)) < 0.02)[:, None, None], band.elastic, many)
    controlled = by_multiplier or not band.equilibrium.live.any()
    for tangent, value in ((band.elastic, 0.7), (many, 0.0), (few, 0.3), (few, 0.0), (many, 0.7)):
        right = np.append(generator.normal(size=band.unknowns - 1), value)
        exact, found = (one.solve(tangent, Control(0.0, controlled), right) for one in (band, dissected))
        assert found == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_solutions_do_not_depend_on_the_order_of_unknowns_terms_and_blocks(seed: int) -> None:
    """A grid of blocks with a coupling of its own for each pair of neighbours."""
    generator = np.random.default_rng(seed)
    columns, rows = generator.integers(1, 12, size=2)
    position = np.array([(x, y) for x in range(columns) for y in range(rows)], dtype=float)
    n = 3 * len(position)
    near = np.argwhere(np.abs(position[:, None] - position).sum(axis=2) <= 1)
    entries = 3 * near[:, :, None] + np.arange(3)
    row, column = (entries[:, 0].repeat(3, axis=1).ravel(), np.tile(entries[:, 1], 3).ravel())
    value = generator.normal(size=len(row)) + 20.0 * (row == column)
    right, nothing = generator.normal(size=(n, 2)), np.zeros((0, 2, 6))
    matrix = np.zeros((n, n))
    np.add.at(matrix, (row, column), value)
    place, block, term = (generator.permutation(k) for k in (n, len(position), len(row)))
    home, shuffled = np.empty(n, dtype=np.int64), np.empty_like(position)
    home[place], shuffled[block] = block[np.arange(n) // 3], position
    factors = dissection(place[row][term], place[column][term], home, shuffled, nothing, value[term])
    loads = np.empty_like(right)
    loads[place] = right
    assert factors.solve(np.zeros((0, 2, 2)), loads)[place] == pytest.approx(np.linalg.solve(matrix, right), abs=1e-10)


def test_a_singular_system_is_refused_and_the_next_one_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    band, dissected = both(ferris("W1"), monkeypatch)
    right, control = np.ones(band.unknowns), Control(0.0, multiplier=True)
    with pytest.raises(np.linalg.LinAlgError):
        dissected.solve(0.0 * band.elastic, control, right)
    exact = band.solve(band.elastic, control, right)
    assert dissected.solve(band.elastic, control, right) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def random_wall(seed: int) -> Scene:
    """Courses of four blocks each, of any quarters of a width, on rounded corners."""
    generator = np.random.default_rng(seed)
    cuts = [np.sort(generator.choice(np.arange(1, 16), 3, replace=False)) for _ in range(generator.integers(3, 7))]
    pattern = [list(np.diff(np.concatenate([[0], cut, [16]])) / 4) for cut in cuts]
    return courses(pattern, joint__mortar=MORTAR, joint__friction=0.65, joint__inset=0.02)


@pytest.mark.parametrize("scene", [*[ferris(f"W{k}", 0.02) for k in (1, 2, 3)], *map(random_wall, range(5))])
def test_walls_collapse_at_the_load_that_bands_find(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """Brackets that overlap, within their width of 1 %."""
    band = dem_static(scene)
    monkeypatch.setattr(systems, "MANY", 0)
    dissected = dem_static(scene)
    assert band.status == dissected.status == "collapse"
    assert dissected.multiplier == pytest.approx(band.multiplier, rel=0.01)


def test_walls_of_many_blocks_are_dissected() -> None:
    tables = content(joint__mortar=MORTAR, wall__length=5.76, wall__height=2.4)
    assert isinstance(static_system(scene_from_dict(tables))._factors, Dissection)
    tables["wall"]["height"] = 1.2
    assert not isinstance(static_system(scene_from_dict(tables))._factors, Dissection)
