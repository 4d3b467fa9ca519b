"""Percentiles of very many values: those of NumPy, whatever the pieces and however few are sorted at once."""

from __future__ import annotations

import numpy as np
import pytest

from compoundkin.base import percentiles
from compoundkin.base.arrays import Number
from compoundkin.base.percentiles import percentiles_by_column, percentiles_of


@pytest.mark.parametrize("kind", ["normal", "rounded", "spread", "constant", "two clusters"])
def test_percentiles_of_very_many_values_are_those_of_sorted_ones(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(percentiles, "MOST_SORTED", 50)
    monkeypatch.setattr(percentiles, "CLASSES", 16)
    random = np.random.default_rng(1)
    for count in (1, 2, 51, 400):
        values = random.normal(size=count)
        values = {"rounded": np.round(values, 1), "spread": np.exp(20.0 * values), "constant": 0.0 * values + 2.5,
                  "two clusters": np.where(values > 0.0, 1.0 + 1e-12 * values, 1e9)}.get(kind, values)  # fmt: skip
        parts, shares = np.array_split(values, 3), [0.0, 5.0, 25.0, 50.0, 95.0, 99.9, 100.0]
        found = percentiles_of(lambda parts=parts: parts, shares)  # type: ignore[misc]
        assert found == np.percentile(values, shares).tolist()


def test_percentiles_of_courses_read_all_poses_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is far beyond the others, ties, least and greatest numbers; what is not finite counts for nothing."""
    monkeypatch.setattr(percentiles, "MOST_SORTED", 600)
    monkeypatch.setattr(percentiles, "MOST_LAID", 1000)
    random, largest = np.random.default_rng(2), np.finfo(float).max
    values = random.normal(size=(3000, 40))
    values[:, 1] = np.where(values[:, 1] > 2.0, 1e300 * values[:, 1], values[:, 1])
    values[:, 2] = np.round(values[:, 2], 1)
    values[:, 3] *= 5e-324 / 0.1
    values[:, 4] = np.where(values[:, 4] > 0.0, largest, -largest)
    values[:, 5] = np.nan
    values[:, 6] = np.where(random.random(3000) < 0.9, values[:, 6], random.choice([np.nan, np.inf, -np.inf], 3000))
    reads, shares = [], [0.0, 5.0, 50.0, 99.9, 100.0]

    def pieces() -> list[Number]:
        reads.append(1)
        return np.array_split(values, 5)

    found = percentiles_by_column(pieces, 40, shares)
    assert len(reads) <= 6
    for column, own in zip(values.T, found.T, strict=True):
        known = column[np.isfinite(column)]
        if len(known):
            # NumPy's own goes through infinity between the least and the greatest number
            by_order = np.sort(known)[[0, -1]] if np.ptp(known / 2.0) > largest / 2.0 else None
            expected = np.percentile(known, shares) if by_order is None else own
            np.testing.assert_array_equal(own, expected)
            assert by_order is None or own[[0, -1]].tolist() == by_order.tolist()
        else:
            assert np.isnan(own).all()
