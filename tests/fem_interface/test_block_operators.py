"""Operators of many blocks at once, against those of each block separately."""

import numpy as np
import pytest

from fem_interface.block_operators import block_operators
from fem_interface.operators import mass_matrix, nodes_of_degree, stiffness_matrix
from fem_interface.templates import nodes_of, triangles_of
from meshing import wall_mesh
from runningbond.scene import Scene

from .walls import triangle_wall, wall

YOUNG, POISSON = 1e9, 0.2


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("scene", [wall(), triangle_wall()], ids=["bricks", "triangles"])
@pytest.mark.parametrize("at_once", [1, 2, 500])
def test_batched_operators_equal_single_block_operators(
    scene: Scene, degree: int, at_once: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bitwise, so that histories of dry walls do not depend on neighbouring blocks; in any order, with any moduli."""
    monkeypatch.setattr("fem_interface.block_operators.AT_ONCE", at_once)
    mesh = wall_mesh(scene)
    blocks = np.flatnonzero(~scene.fixed)[::-1].tolist()
    young, poisson = YOUNG * np.arange(float(len(blocks))), np.linspace(0, POISSON, len(blocks))
    found = block_operators(mesh, blocks, young, poisson, degree)
    for block, E, nu, (nodes, stiffness, mass, strain) in zip(blocks, young, poisson, found, strict=True):
        own = mesh.points[nodes_of(mesh, block)], triangles_of(mesh, block)
        assert np.array_equal(nodes, nodes_of_degree(*own, degree))
        assert np.array_equal(stiffness, stiffness_matrix(*own, E, nu, 1.0, degree).toarray())
        assert np.array_equal(mass, mass_matrix(*own, 1.0, 1.0, degree).toarray())
        # A field of uniform strain has that strain everywhere.
        uniform = (nodes @ np.array([[3e-3, 1e-3], [2e-3, -4e-3]])).ravel()
        assert strain @ uniform == pytest.approx(np.tile([3e-3, -4e-3, 3e-3], len(own[1])), abs=1e-15)
