"""The estimate of the error by rounding, against forty digits next to limit positions and change points."""

import warnings
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpmath import mpf

import compoundkin as ck
from tests.kinematics.exact_motions import CASES, ORDER, special, true_errors

RATES = (1.3, 0.4, -0.7)
DECADES = range(1, 10)
SAMPLES = 2


def near(title: str, distances: np.ndarray) -> ck.results.Motion:
    """A motion at some distances from the limit or change point of a case."""
    case = CASES[title]
    values = np.sort([float(special(title) + case.sense * mpf(float(d))) for d in distances])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.FewDigits)
        speed, acceleration, jerk = RATES
        given = {"speed": speed, "acceleration": acceleration, "jerk": jerk}
        return ck.solve(case.mechanism, {case.driver: values}, **given, order=ORDER, modes=case.modes)


@cache
def compared(title: str) -> np.ndarray:
    """Pairs of the true error and the estimate, of every order that has digits, at samples of a case."""
    rng = np.random.default_rng(7)
    pairs = []
    for decade in DECADES:
        motion = near(title, 10.0**-decade * rng.uniform(0.3, 1.0, SAMPLES))
        assert motion.assembled.all()
        estimates = [motion.error(k) for k in range(ORDER + 1)]
        for at, value in enumerate(motion.drives[CASES[title].driver].value):
            true = true_errors(title, motion, at, float(value), RATES)
            pairs += [(t, e[at]) for t, e in zip(true, estimates, strict=True) if np.isfinite(e[at])]
    return np.array(pairs)


@pytest.mark.parametrize("title", CASES)
def test_the_true_error_is_of_the_size_of_the_estimate(title):
    true, estimate = compared(title).T
    assert len(true) > 20 * SAMPLES
    assert 2.0 < np.median(estimate / true) < 50.0


def test_true_errors_exceed_the_estimate_in_fewer_than_one_sample_in_a_hundred():
    true, estimate = np.concatenate([compared(title) for title in CASES]).T
    assert np.mean(true > estimate) < 0.01


def test_the_estimate_exceeds_a_hundred_true_errors_in_fewer_than_one_sample_in_ten():
    true, estimate = np.concatenate([compared(title) for title in CASES]).T
    assert np.mean(estimate > 100.0 * true) < 0.10


@pytest.mark.parametrize(("distance", "warned", "regular"), [(1e-9, 0, 2), (1e-13, 1, 2), (1e-16, 0, 1)])
def test_rates_with_few_digits_are_warned_about_and_those_with_none_are_no_numbers(distance, warned, regular):
    case = CASES["four-bar"]
    values = [1.0, float(special("four-bar") - mpf(distance))]
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        motion = ck.solve(case.mechanism, {"crank": values})
    assert [w.category for w in said] == [ck.errors.FewDigits] * warned
    assert motion.assembled.all()
    assert motion.regular.sum() == regular
    assert np.isfinite(motion.links["rocker"].angular_velocity).sum() == regular
    assert np.isfinite(motion.error(1)).sum() == regular
    assert motion.error(0)[1] < 1e-6
    assert ck.verify(motion).passed
    text = " ".join(ck.report(motion).text().split())
    assert ("Rates have fewer than three digits" in text) == bool(warned)


@pytest.mark.parametrize("distance", [1e-3, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9])
def test_motions_next_to_change_points_pass(distance):
    values = np.sort([*np.linspace(0.0, 2.0 * np.pi, 73), np.pi - distance, np.pi + distance])
    motion = ck.solve(CASES["parallelogram"].mechanism, {"crank": values}, order=3)
    assert motion.regular.all()
    assert ck.verify(motion).passed


@pytest.mark.parametrize(
    "values", [np.pi, np.r_[np.linspace(1.0, np.pi, 31), np.full(5, np.pi), np.linspace(3.2, 5.0, 9)]]
)
def test_poses_exactly_at_a_change_point_pass(values):
    """A single pose, and a motion that rests there: differences beside it have fewer digits than the pose."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ck.errors.ChangePointWarning)
        motion = ck.solve(CASES["parallelogram"].mechanism, {"crank": values}, order=3)
    assert np.abs(motion.links["rocker"].angular_velocity - 1.0).max() < 1e-12
    assert ck.verify(motion).passed


@pytest.mark.parametrize("order", ["a", 1.5, None, True, -1, 7])
def test_an_error_is_asked_for_by_the_order_of_a_derivative(order: Any) -> None:
    motion = ck.solve(ck.load("crank-rocker"), {"crank": [1.0]})
    with pytest.raises(ck.errors.InvalidInput):
        motion.error(order)


def test_links_that_stand_still_have_no_error_in_their_rates() -> None:
    still = [ck.link("one", E=0, G=3), ck.link("two", F=0, G=4)]
    moving = ck.link("frame", A=0, E=10, F=15), ck.link("crank", A=0, B=1), ck.drive("crank")
    motion = ck.solve(ck.Mechanism("A dyad on the frame", *moving, *still), {"crank": [0.0, 1.0]})
    assert np.all(motion.error(0) < 1e-13)
    assert np.all(motion.error(1) < 1e-13)
    assert ck.verify(motion).passed
