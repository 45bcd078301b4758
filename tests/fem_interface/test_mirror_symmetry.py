"""Mirror-folded tables of block displacements: against the tables themselves; kernels with and without folding."""

from typing import Any, cast

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fem_interface import mirror_symmetry as folding
from fem_interface.block_kernels import ModalJoints
from fem_interface.mirror_symmetry import Folded, fold_of_many, folded
from fem_interface.modal_wall import modal_wall
from fem_interface.modes import ModeCount
from fem_interface.system import system_of
from meshing import wall_mesh
from runningbond.dynamics import BlockSystem
from runningbond.scene import Array
from tests.walls import panel

MORTAR = {"young": 1e9, "poisson": 0.2, "thickness": 0.01}
OUTLINE = np.array([[0, 0], [1, 0], [2, 0], [2, 1], [1, 1], [0, 1]])
"""Nodes of a block with one inside its lower and one inside its upper side, in units of a cell."""


def unfolded(found: Folded) -> Array:
    """The original table, recovered from the folded one."""
    table = found.table.copy()
    for a, b in found.pairs:
        table[a], table[b] = table[a] + table[b], table[a] - table[b]
    return table


@given(
    size=st.tuples(st.floats(0.01, 10), st.floats(0.01, 10)),
    corner=st.tuples(st.floats(-100, 100), st.floats(-100, 100)),
    turn=st.integers(0, 5),
    drop=st.booleans(),
    seed=st.integers(0, 1000),
)
def test_folding_is_invertible(
    size: tuple[float, float], corner: tuple[float, float], turn: int, drop: bool, seed: int
) -> None:
    """Any table, also of modes without symmetry, with nodes facing each other across two axes, one or none."""
    points = np.roll(OUTLINE * size + corner, turn, axis=0)[: 5 if drop else 6]
    table = np.random.default_rng(seed).normal(size=(2 * len(points), 4))
    found = folded(points, table)
    assert unfolded(found) == pytest.approx(table, abs=1e-12)
    assert not found.worth_it


def _tables(count: ModeCount, height: float) -> tuple[Array, Array]:
    """Nodes and modes of a brick 0.24 m long on the default mesh."""
    scene = panel(joint__mortar=MORTAR, block__young=1e10, wall__block_height=height, wall__height=4 * height)
    mesh, found = wall_mesh(scene), modal_wall(scene, modes=count)
    template = max(found.templates, key=lambda template: len(template.blocks))
    first = mesh.first_node[template.blocks[0]]
    points = mesh.points[first : first + len(template.modes.shape) // 2]
    outline = np.flatnonzero((np.abs(points - points.mean(axis=0)) > np.ptp(points, axis=0) / 2 - 1e-9).any(axis=1))
    shape = template.modes.shape.reshape(len(points), 2, -1)[outline]
    return points[outline], shape.reshape(2 * len(outline), -1)


@pytest.mark.parametrize("count", [3, 6, 10, 20, "all"])
@pytest.mark.parametrize("height", [0.06, 0.12, 0.24])
def test_modes_of_a_rectangle_are_even_or_odd_about_its_axes(count: ModeCount, height: float) -> None:
    """Each in one of four ways, so a mode has at most a quarter of the entries, and one for nodes on an axis; also the
    modes of a square, two of which may be equal."""
    points, table = _tables(count, height)
    found = folded(points, table)
    assert found.worth_it
    assert unfolded(found) == pytest.approx(table, abs=1e-11 * np.abs(table).max())
    assert np.count_nonzero(found.table, axis=0).max() <= len(table) / 4 + 1


def test_irregular_block_is_not_folded() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.1], [0.9, 0.8], [0.2, 0.7]])
    found = folded(points, np.ones((8, 3)))
    assert len(found.pairs) == 0
    assert fold_of_many(1000, points, np.ones((8, 3))) is None


def test_coincident_nodes_unfold() -> None:
    """It is undefined which of the coincident nodes faces another one."""
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    table = np.random.default_rng(0).normal(size=(10, 3))
    assert unfolded(folded(points, table)) == pytest.approx(table, abs=1e-12)


@pytest.mark.parametrize("changes", [{}, {"wall__block_height": 0.24}, {"support__kind": "pinned-corners"}])
@pytest.mark.parametrize("count", [3, 10, "all"])
def test_kernels_do_not_depend_on_folding(
    monkeypatch: pytest.MonkeyPatch, count: ModeCount, changes: dict[str, Any]
) -> None:
    def system(fewest: int) -> BlockSystem:
        monkeypatch.setattr(folding, "FEWEST_BLOCKS", fewest)
        return system_of(modal_wall(panel(joint__mortar=MORTAR, block__young=1e10, **changes), modes=count))

    def answers(system: BlockSystem) -> tuple[Array, Array, Array]:
        rng = np.random.default_rng(1)
        motion = np.where(np.isfinite(system.mass), rng.normal(size=len(system.mass)), 0.0)
        opening, slip = np.zeros((2, system.interface.law.points))
        system.interface.gather(motion, tuple(system.interface.geometry), opening, slip)
        force = rng.normal(size=len(motion))
        system.interface.scatter(*rng.normal(size=(2, len(opening))), tuple(system.interface.geometry), force)
        # The last entry stands for all fixed freedoms and does not count.
        return opening, slip, force[:-1]

    plain, with_folds = system(10**9), system(1)
    numbers = [len(cast(ModalJoints, each.interface.geometry).folded.shapes) for each in (plain, with_folds)]
    assert numbers[0] == 0 < numbers[1]
    for one, other in zip(answers(plain), answers(with_folds), strict=True):
        assert other == pytest.approx(one, abs=1e-12 * np.abs(one).max())
