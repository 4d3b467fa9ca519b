"""The unit of lengths is the user's own choice: nothing else may depend on it."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog
from tests.oracle.cases import BAD, stored
from tests.scaled import scaled

POWERS = (-7, -6, -4, -2, 1, 3, 5, 7)
# Several groups in a row, near limit positions here and there, magnify the different rounding of other units.
SAME = 1e-7
# Random mechanisms of each family, one in so many: all of them were compared once.
SOME = 13


@cache
def _solved(mechanism: ck.Mechanism) -> ck.results.Motion | str:
    with warnings.catch_warnings(action="ignore"):
        try:
            return ck.solve(mechanism)
        except ck.errors.CompoundkinError as error:
            return type(error).__name__


def _assert_same(mechanism: ck.Mechanism, *factors: float) -> None:
    one = _solved(scaled(mechanism, 1.0))
    for factor in factors:
        _assert_alike(one, _solved(scaled(mechanism, factor)), factor)


def _assert_alike(one: ck.results.Motion | str, other: ck.results.Motion | str, factor: float) -> None:
    if isinstance(one, str) or isinstance(other, str):
        assert one == other
        return
    assert other.size == pytest.approx(factor * one.size, rel=1e-12)
    np.testing.assert_array_equal(other.assembled, one.assembled)
    np.testing.assert_array_equal(other.regular, one.regular)
    for name, point in one.points.items():
        for rate in ("position", "velocity", "acceleration"):
            expected, found = np.asarray(getattr(point, rate)), np.asarray(getattr(other.points[name], rate)) / factor
            np.testing.assert_allclose(found, expected, rtol=SAME, atol=SAME * one.size, err_msg=f"{name}.{rate}")


@pytest.mark.parametrize("name", catalog.NAMES)
def test_motions_of_the_catalog_are_the_same_in_all_units(name: str) -> None:
    number = catalog.NAMES.index(name)
    _assert_same(catalog.mechanism(name), 1e-9 if number % 2 else 1e9, 10.0 ** POWERS[number % len(POWERS)])


@pytest.mark.parametrize("name", [name for name in stored() if not name.startswith(BAD)][::SOME])
def test_motions_of_random_mechanisms_are_the_same_in_all_units(name: str, tmp_path: Path) -> None:
    path = tmp_path / "mechanism.toml"
    path.write_text(stored()[name])
    try:
        mechanism = ck.load(path)
    except ck.errors.CompoundkinError:
        return  # dimensions that do not fit each other
    _assert_same(mechanism, 1e-9, 1e6)
