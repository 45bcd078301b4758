"""What is orthogonal to vectors: an orthonormal basis of it, of coordinates themselves where nothing touches them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.linalg import null_space

from runningbond.scene import Array, complement
from runningbond.scene.supports import free_motions

WHOLE = arrays(np.int64, (2, 4), elements=st.integers(-3, 3))


@given(WHOLE)
def test_it_is_an_orthonormal_basis_of_all_that_rows_leave(rows: Array) -> None:
    """Of as many vectors as singular values leave; dependent rows and rows of nothing leave more."""
    found = complement(rows.astype(float))
    assert found.shape[1] == null_space(rows.astype(float), rcond=1e-12).shape[1]
    assert found.T @ found == pytest.approx(np.eye(found.shape[1]), abs=1e-12)
    assert rows @ found == pytest.approx(0.0, abs=1e-9)


def test_a_block_on_a_roller_shifts_along_it_and_turns_about_it() -> None:
    """Of all mixtures of the two, in which a library's singular vectors come in any, these are the ones."""
    corner, inertia = np.array([0.2, -0.1]), np.array([8.0, 8.0, 0.3])
    motions, mass = free_motions(np.array([[0.0, 1.0, corner[0]]]), inertia)
    along, about = motions.T[:2]
    assert along == pytest.approx([1.0, 0.0, 0.0])
    assert about[0] == pytest.approx(0.0)
    assert about[1] + corner[0] * about[2] == pytest.approx(0.0)
    assert motions.T @ np.diag(inertia) @ motions == pytest.approx(np.diag([8.0, 8.0, 0.0]))
    assert mass.tolist() == [8.0, 8.0, np.inf]
