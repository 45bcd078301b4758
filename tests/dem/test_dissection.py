"""Nested dissection against full matrices: the same solutions after any changes, and the same limit loads."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dem.dissection import dissection
from dem.front_kernels import _invert
from dem.static import dem_static
from dem.static_system import Control, StaticSystem, static_system
from runningbond.compare import published_scene
from runningbond.scene import Array, Lateral, Scene
from runningbond.scene.beam import Drive
from tests.at_length import at_length
from tests.dem.test_led import ground_moves, under_beam, wall
from tests.dem.test_static import ferris
from tests.dem.test_ties import tie, tied
from tests.limit.test_limit import rectangle
from tests.walls import courses

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


def full(system: StaticSystem, tangent: Array, control: Control) -> Array:
    """Matrix of all equations, ``(n, n)``, from the jump operators."""
    nd, equations = system.freedoms, system.equilibrium
    jump = [operator.toarray() for operator in (system.opening, system.slip)]
    matrix = np.zeros((system.unknowns, system.unknowns))
    for i in range(2):
        for j in range(2):
            matrix[:nd, :nd] += jump[i].T @ (tangent[:, i, j, None] * jump[j])
    pins = equations.reaction.toarray()
    matrix[:nd, nd:-1], matrix[nd:-1, :nd] = pins, pins.T
    matrix[:nd, -1] = -equations.live
    if control.multiplier:
        matrix[-1, -1] = 1.0
    else:
        matrix[-1, :nd] = equations.live
    return matrix


def tangents(system: StaticSystem, generator: np.random.Generator, share: float) -> Array:
    """Coulomb tangents with a share of points open or sliding, regularized by a little of the elastic stiffness."""
    elastic = system.elastic
    tangent = elastic.copy()
    opens, slides = generator.random((2, len(elastic))) < share / 2
    tangent[slides, 1, 1], tangent[slides, 1, 0] = 0.0, 0.6 * elastic[slides, 0, 0]
    tangent[opens] = 0.0
    return np.asarray(tangent + 1e-3 * elastic)


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("by_multiplier", [True, False])
def test_dissection_solves_as_full_matrix(name: str, by_multiplier: bool) -> None:
    """One after the other: many, few and no points change, and change back."""
    system = static_system(SCENES[name])
    generator = np.random.default_rng(1)
    many = tangents(system, generator, 0.5)
    few = np.where((generator.random(len(many)) < 0.02)[:, None, None], system.elastic, many)
    control = Control(0.0, by_multiplier or not system.equilibrium.live.any())
    for tangent, value in ((system.elastic, 0.7), (many, 0.0), (few, 0.3), (few, 0.0), (many, 0.7)):
        right = np.append(generator.normal(size=system.unknowns - 1), value)
        exact = np.linalg.solve(full(system, tangent, control), right)
        assert system.solve(tangent, control, right) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def inverted(matrix: Array) -> Array:
    """Inverse by Gauss–Jordan elimination of one column after the other."""
    matrix, others = matrix.copy(), ~np.eye(len(matrix), dtype=bool)
    order = np.arange(len(matrix))
    for k, other in enumerate(others):
        best = k + int(np.abs(matrix[k:, k]).argmax())
        matrix[[k, best]], order[[k, best]] = matrix[[best, k]], order[[best, k]]
        factor, inverse = np.where(other, matrix[:, k], 0.0), 1 / matrix[k, k]
        matrix[:, k] = ~other
        matrix[k] *= inverse
        matrix -= factor[:, None] * matrix[k]
    return np.asarray(matrix[:, np.argsort(order)])


@settings(max_examples=30)
@given(st.integers(1, 30), st.integers(0, 2**32 - 1))
def test_inverse_is_that_by_single_columns_to_the_last_bit(size: int, seed: int) -> None:
    """Zeros make pivoting necessary; the load path of a wall of many blocks may depend on the last bit."""
    generator = np.random.default_rng(seed)
    matrix = generator.permutation(np.triu(generator.normal(size=(size, size))))
    found, singular = matrix.copy(), matrix.copy()
    assert _invert(found)
    assert (found == inverted(matrix)).all()
    assert np.abs(found @ matrix - np.eye(size)).max() <= 1e-13 * np.abs(found).max() * np.abs(matrix).max() * size
    singular[:, generator.integers(size)] = 0.0
    assert not _invert(singular)


@settings(max_examples=15)
@given(st.integers(0, 2**32 - 1))
def test_solution_does_not_depend_on_order_of_unknowns(seed: int) -> None:
    """A grid of blocks with a random coupling for each pair of neighbours; unknowns, terms and blocks are permuted."""
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


def test_singular_system_is_refused_and_next_one_solved() -> None:
    system = static_system(ferris("W1"))
    right, control = np.ones(system.unknowns), Control(0.0, multiplier=True)
    with pytest.raises(np.linalg.LinAlgError):
        system.solve(0.0 * system.elastic, control, right)
    exact = np.linalg.solve(full(system, system.elastic, control), right)
    assert system.solve(system.elastic, control, right) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def random_wall(seed: int) -> Scene:
    """Courses of four blocks each, with random widths in quarters, with inset contacts."""
    generator = np.random.default_rng(seed)
    cuts = [np.sort(generator.choice(np.arange(1, 16), 3, replace=False)) for _ in range(generator.integers(3, 7))]
    pattern = [list(np.diff(np.concatenate([[0], cut, [16]])) / 4) for cut in cuts]
    return courses(pattern, joint__mortar=MORTAR, joint__friction=0.65, joint__inset=0.02)


@pytest.mark.parametrize(
    "scene",
    [
        ferris("W1", 0.02),
        *map(random_wall, range(2)),
        *at_length(ferris("W2", 0.02), ferris("W3", 0.02), *map(random_wall, range(2, 5))),
    ],
)
def test_limit_loads_agree_with_full_matrices(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same multiplier within 1 %."""
    dissected = dem_static(scene)
    monkeypatch.setattr(
        StaticSystem,
        "solve",
        lambda system, tangent, control, right: np.linalg.solve(full(system, tangent, control), right),
    )
    exact = dem_static(scene)
    assert exact.status == dissected.status == "collapse"
    assert dissected.multiplier == pytest.approx(exact.multiplier, rel=0.01)
