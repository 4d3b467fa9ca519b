"""Elimination in straight-line arithmetic against LAPACK."""

import numpy as np
import pytest

from compoundkin.base.linear import Elimination


@pytest.mark.parametrize("size", [1, 2, 3, 4, 6, 9])
def test_elimination_equals_lapack(size):
    rng = np.random.default_rng(size)
    matrices = rng.standard_normal((40, size, size))
    known = (rng.random((size, size)) < 0.3) & ~np.eye(size, dtype=bool)
    matrices[:, known] = rng.integers(-1, 2, (size, size))[known]
    rows = [
        {j: float(matrices[0, i, j]) if known[i, j] else matrices[:, i, j] for j in range(size)} for i in range(size)
    ]
    right = rng.standard_normal((40, size))
    system = Elimination(rows, size)
    found = np.stack(np.broadcast_arrays(*system.times(list(right.T))), axis=-1)
    expected = np.linalg.solve(matrices, right[..., None])[..., 0]
    scale = np.abs(expected).max(axis=-1) * np.linalg.cond(matrices)
    assert (np.abs(found - expected).max(axis=-1) <= 1e-15 * size * scale).all()
    assert np.broadcast_to(system.determinant, 40) == pytest.approx(np.linalg.det(matrices), rel=1e-11)


def test_a_zero_first_pivot_is_no_pivot():
    zero = np.zeros(1)
    system = Elimination([{1: zero + 1.0}, {0: zero, 2: zero + 1.0}, {3: zero + 1.0}, {0: zero + 1.0}], 4)
    assert [float(x[0]) for x in system.times([1.0, 2.0, 3.0, 4.0])] == [4.0, 1.0, 2.0, 3.0]
