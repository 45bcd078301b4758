"""Eigenvectors by Jacobi rotations, against SciPy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import eigh, null_space

from fem_interface.eigenvectors import eigenvectors, symmetric_eigenvectors


@settings(max_examples=30)
@given(n=st.integers(1, 24), several=st.integers(0, 6), decades=st.integers(0, 10), seed=st.integers(0, 2**32 - 1))
def test_symmetric_matrices_are_diagonalized(n: int, several: int, decades: int, seed: int) -> None:
    """Also with repeated eigenvalues, and with eigenvalues over ten decades."""
    generator = np.random.default_rng(seed)
    own = np.sort(10.0 ** generator.uniform(0, decades, n))
    own[:several] = own[0]
    turn, _ = np.linalg.qr(generator.normal(size=(n, n)))
    matrix = turn @ (own[:, None] * turn.T)
    matrix = (matrix + matrix.T) / 2
    found, vectors = symmetric_eigenvectors(matrix)
    assert found == pytest.approx(own, abs=1e-13 * own[-1])
    assert vectors.T @ vectors == pytest.approx(np.eye(n), abs=1e-13)
    assert matrix @ vectors == pytest.approx(vectors * found, abs=1e-13 * n * own[-1])


@settings(max_examples=30)
@given(columns=st.integers(1, 16), rows=st.integers(0, 5), seed=st.integers(0, 2**32 - 1))
def test_eigenvectors_span_the_constrained_subspace(columns: int, rows: int, seed: int) -> None:
    generator = np.random.default_rng(seed)
    n = 30
    root, inert = generator.normal(size=(2, n, n))
    K, M = root @ root.T, inert @ inert.T + n * np.eye(n)
    within, zero = generator.normal(size=(n, columns)), generator.normal(size=(rows, n))
    zero = np.vstack([zero, 2.0 * zero[:1]])  # one constraint repeats another
    own, shapes = eigenvectors(K, M, within, zero)
    space = within @ null_space(zero @ within) if rows else within
    assert shapes.shape == space.shape
    exact = eigh(space.T @ K @ space, space.T @ M @ space, eigvals_only=True) if space.size else own
    assert own == pytest.approx(exact, rel=1e-10)
    assert shapes.T @ M @ shapes == pytest.approx(np.eye(len(own)), abs=1e-11)
    assert np.abs(zero @ shapes).max(initial=0.0) <= 1e-9 * np.abs(zero).max(initial=1.0)
