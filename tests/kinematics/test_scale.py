"""The unit of lengths is the user's own choice: nothing else may depend on it."""

from __future__ import annotations

import warnings
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.kinematics.extremes import extremes, zeros
from compoundkin.kinematics.one_design import motion_of_design
from tests import catalog
from tests.oracle.cases import BAD, stored
from tests.scaled import scaled
from tests.support import examples

POWERS = (-9, -7, -6, -4, -2, 1, 3, 5, 7, 9)
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


@pytest.mark.full
@catalog.each(catalog.THIRD)
def test_motions_of_the_catalog_are_the_same_in_all_units(name: str) -> None:
    number = catalog.THIRD.index(name)
    _assert_same(catalog.mechanism(name), 10.0 ** POWERS[number % len(POWERS)])


@pytest.mark.parametrize("name", [name for name in stored() if not name.startswith(BAD)][::SOME])
def test_motions_of_random_mechanisms_are_the_same_in_all_units(name: str, tmp_path: Path) -> None:
    path = tmp_path / "mechanism.toml"
    path.write_text(stored()[name])
    try:
        mechanism = ck.load(path)
    except ck.errors.CompoundkinError:
        return  # dimensions that do not fit each other
    _assert_same(mechanism, 1e-9, 1e6)


# Groups with and without closed forms, redundant pairs, gears, slides that drive, change points, gaps.
OF_SIZES = (
    "six-bar", "class-iii-six-bar", "3-rrr", "double-parallelogram-lift", "planetary-train", "rack-and-pinion-steering",
    "excavator-arm", "oscillating-cylinder", "parallelogram", "triple-rocker", "stephenson-iii-floating-driver",
    "elliptic-trammel", "geneva-wheel", "rolling-wheel", "scissor-lift", "watt-ii", "windscreen-wiper",
)  # fmt: skip


@pytest.mark.full
@settings(deadline=None, max_examples=examples(20))
@given(st.sampled_from(OF_SIZES), st.lists(st.integers(-6, 6), min_size=2, max_size=4))
def test_designs_of_an_array_are_what_each_is_alone(name: str, powers: list[int]) -> None:
    """However large the others are."""
    mechanism, factors = catalog.mechanism(name), [10.0**k for k in powers]
    with warnings.catch_warnings(action="ignore"):
        together = ck.solve(scaled(mechanism, np.reshape(factors, (-1, 1))))
        assert ck.verify(together).passed
    for design, factor in enumerate(factors):
        own, alone = motion_of_design(together, design), _solved(scaled(mechanism, factor))
        assert isinstance(alone, ck.results.Motion)
        _assert_alike(alone, own, 1.0)
        gaps = [gap for gap in ck.gaps(together) if gap.design == (design,)]
        assert [(gap.first, gap.last, gap.reason) for gap in gaps] == [
            (gap.first, gap.last, gap.reason) for gap in ck.gaps(alone)
        ]
        for point in list(mechanism.carriers)[-1:]:
            for quantity in (f"{point}.x", f"{point}.velocity.x"):
                (one,), (other,) = extremes(together, quantity), extremes(alone, quantity)
                for side in ("least", "greatest"):
                    found, expected = (np.ravel(getattr(each, side).value) for each in (one, other))
                    scale = alone.size * max(1.0, abs(expected[0]) / alone.size if np.isfinite(expected[0]) else 1.0)
                    np.testing.assert_allclose(found[design], expected[0], rtol=SAME, atol=SAME * scale)
                ours, theirs = zeros(together, quantity).at, zeros(alone, quantity).at
                np.testing.assert_allclose(ours.place[ours.design == design], theirs.place, atol=1e-4)


def test_designs_of_sizes_that_differ_by_more_than_rounding() -> None:
    """By 1e12: what is a link of no length beside the largest is one of its own design."""
    crank = catalog.mechanism("crank-rocker")
    together = ck.solve(scaled(crank, np.array([[1.0], [1e12], [1e-12]])))
    assert ck.verify(together).passed
    assert np.ravel(together.sizes) == pytest.approx(together.size * np.array([1e-12, 1.0, 1e-24]), rel=1e-12)
    own, alone = motion_of_design(together, 2), ck.solve(scaled(crank, 1e-12))
    _assert_alike(alone, own, 1.0)


def test_a_link_of_no_length_in_one_of_several_designs() -> None:
    lengths = np.array([[1.0], [0.0]])
    with pytest.raises(ck.errors.InvalidMechanism, match="A and B coincide: a link of zero length"):
        ck.Mechanism("m", ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=lengths), ck.link("bar", B=0, C=1))
