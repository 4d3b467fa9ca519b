"""The linear algebra of groups without a closed form where it is singular."""

from __future__ import annotations

import numpy as np

from compoundkin.base.linear import inverted, solve


def test_one_singular_matrix_does_not_spoil_the_batch() -> None:
    rng = np.random.default_rng(0)
    matrices, right = rng.standard_normal((4, 5, 6, 6)), rng.standard_normal((4, 5, 6))
    matrices[1, 2] = 0.0
    matrices[3, 4, :, 2] = 0.0
    regular = np.ones((4, 5), dtype=bool)
    regular[1, 2] = regular[3, 4] = False
    for found in (solve(matrices, right), np.einsum("...ij,...j->...i", inverted(matrices), right)):
        assert np.array_equal(np.isfinite(found).all(axis=-1), regular)
        back = np.einsum("...ij,...j->...i", matrices[regular], found[regular])
        assert np.allclose(back, right[regular], atol=1e-9)


def test_what_is_not_a_number_stays_so() -> None:
    matrices = np.stack([np.eye(3), np.full((3, 3), np.nan), np.zeros((3, 3))])
    with np.errstate(invalid="ignore"):
        found = solve(matrices, np.ones((3, 3)))
    assert found[0].tolist() == [1, 1, 1]
    assert np.isnan(found[1:]).all()
