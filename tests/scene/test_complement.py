"""Orthonormal basis of the orthogonal complement of rows, and the free motions of supported blocks."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import null_space

from runningbond.scene import Array, complement
from runningbond.scene.supports import free_motions

INTEGER_ROWS = arrays(np.int64, (2, 4), elements=st.integers(-3, 3))


@given(INTEGER_ROWS)
def test_complement_is_an_orthonormal_basis_of_the_null_space(rows: Array) -> None:
    """Its dimension agrees with SciPy's `null_space`, also for dependent and zero rows."""
    found = complement(rows.astype(float))
    assert found.shape[1] == null_space(rows.astype(float), rcond=1e-12).shape[1]
    assert found.T @ found == pytest.approx(np.eye(found.shape[1]), abs=1e-12)
    assert rows @ found == pytest.approx(0.0, abs=1e-9)


def test_free_motions_of_a_block_on_a_roller_are_a_shift_and_a_rotation() -> None:
    """Singular vectors from a library may mix the two arbitrarily; `free_motions` must not."""
    corner, inertia = np.array([0.2, -0.1]), np.array([8.0, 8.0, 0.3])
    motions, mass = free_motions(np.array([[0.0, 1.0, corner[0]]]), inertia)
    along, about = motions.T[:2]
    assert along == pytest.approx([1.0, 0.0, 0.0])
    assert about[0] == pytest.approx(0.0)
    assert about[1] + corner[0] * about[2] == pytest.approx(0.0)
    assert motions.T @ np.diag(inertia) @ motions == pytest.approx(np.diag([8.0, 8.0, 0.0]))
    assert mass.tolist() == [8.0, 8.0, np.inf]
