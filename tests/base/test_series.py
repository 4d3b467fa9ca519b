"""`Series` against polynomial arithmetic, against exact power series, and against finite differences."""

from __future__ import annotations

from math import factorial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import polynomial

from compoundkin.base.series import Series, as_series, constant, planar_series
from tests.support import differences, largest, random_planar, random_real, random_unit

SEEDS = st.integers(0, 2**32 - 1)
ORDERS = st.integers(0, 5)
SHAPE = (3,)


def apart(a: Series, b: Series) -> float:
    """The greatest difference of two series of one length, relative to what is in them."""
    assert len(a.c) == len(b.c)
    return largest((x - y) / (1 + np.abs(x)) for x, y in zip(a.c, b.c, strict=True))


def convolved(a: Series, b: Series) -> Series:
    """The product by NumPy's polynomials, element by element."""
    n = len(a.c)
    rows = [polynomial.polymul([x[k] for x in a.c], [y[k] for y in b.c])[:n] for k in range(SHAPE[0])]
    padded = [np.pad(np.trim_zeros(r, "b"), (0, n))[:n] for r in rows]
    return Series(tuple(np.array(padded).T))


def series(seed: int, order: int) -> tuple[Series, Series]:
    rng = np.random.default_rng(seed)
    return random_planar(rng, order, SHAPE), random_planar(rng, order, SHAPE)


@given(seed=SEEDS, order=ORDERS)
def test_ring(seed: int, order: int) -> None:
    a, b = series(seed, order)
    assert apart(a * b, convolved(a, b)) < 1e-14
    assert apart(a + b, Series(tuple(np.array(a.c) + np.array(b.c)))) == 0
    assert apart(a - b, Series(tuple(np.array(a.c) - np.array(b.c)))) == 0
    assert apart(-a, Series(tuple(-np.array(a.c)))) == 0
    assert apart(a * b, b * a) < 1e-14
    assert a.order == order


@given(seed=SEEDS, order=ORDERS)
def test_division_undoes_multiplication(seed: int, order: int) -> None:
    a, b = series(seed, order)
    b = b + 5.0
    assert apart(convolved(a / b, b), a) < 1e-13
    assert apart(convolved(1.0 / b, b), Series((np.ones(3), *[np.zeros(3)] * order))) < 1e-13
    assert apart((2 - 1j) / b * b, Series((np.full(3, 2 - 1j), *[np.zeros(3)] * order))) < 1e-13


@given(seed=SEEDS, order=ORDERS)
def test_products_of_planar_vectors(seed: int, order: int) -> None:
    a, b = series(seed, order)
    both = convolved(Series(tuple(np.conj(x) for x in a.c)), b)
    assert apart(a.dot(b), Series(tuple(x.real for x in both.c))) < 1e-13
    assert apart(a.cross(b), Series(tuple(x.imag for x in both.c))) < 1e-13
    square = convolved(a, Series(tuple(np.conj(x) for x in a.c)))
    assert apart(a.abs2(), Series(tuple(x.real for x in square.c))) < 1e-13
    assert all(np.isrealobj(c) for s in (a.dot(b), a.cross(b), a.abs2(), a.real, a.imag) for c in s.c)
    assert apart(planar_series(a.real, a.imag), a) == 0
    assert apart(a.conj().conj(), a) == 0
    assert apart(a.conj().imag, -(a.imag)) == 0


@given(seed=SEEDS, order=ORDERS)
def test_square_root(seed: int, order: int) -> None:
    a, _ = series(seed, order)
    square = a.abs2() + 0.5
    root = square.sqrt()
    assert apart(convolved(root, root), square) < 1e-12
    assert np.all(root.c[0] > 0)


@given(seed=SEEDS, order=ORDERS)
def test_unit_vector(seed: int, order: int) -> None:
    a, b = series(seed, order)
    a = a + 3.0
    u = a.unit()
    one = Series((np.ones(3), *[np.zeros(3)] * order))
    assert apart(u.abs2(), one) < 1e-12
    assert largest(u.cross(a).c) < 1e-12
    assert np.all(u.dot(a).c[0] > 0)
    assert apart(u * a.abs2().sqrt(), a) < 1e-12
    assert b.order == order


@given(seed=SEEDS, order=ORDERS)
def test_turn_against_the_power_series_of_the_exponential(seed: int, order: int) -> None:
    """exp(i (a0 + h)) = exp(i a0) (1 + i h + (i h)^2 / 2 + ...), where h has no constant term."""
    rng = np.random.default_rng(seed)
    a = random_real(rng, order, SHAPE, 2.0)
    h = Series((np.zeros(3), *[1j * x for x in a.c[1:]]))
    total = Series((np.ones(3, dtype=complex), *[np.zeros(3)] * order))
    power = total
    for n in range(1, order + 1):
        power = convolved(power, h)
        total = Series(tuple(t + p / factorial(n) for t, p in zip(total.c, power.c, strict=True)))
    expected = Series(tuple(np.exp(1j * a.c[0]) * t for t in total.c))
    assert apart(a.turn(), expected) < 1e-13
    assert apart(a.turn().abs2(), Series((np.ones(3), *[np.zeros(3)] * order))) < 1e-12


@given(seed=SEEDS, order=ORDERS)
def test_angle_undoes_turn(seed: int, order: int) -> None:
    rng = np.random.default_rng(seed)
    a = random_real(rng, order, SHAPE)
    a = Series((rng.uniform(-3.1, 3.1, SHAPE), *a.c[1:]))
    assert apart(a.turn().angle(), a) < 1e-12
    u = random_unit(rng, order, SHAPE)
    assert apart(u.angle().turn(), u) < 1e-12


@pytest.mark.parametrize(
    "function",
    [
        lambda x: (x * x - 2.0) / (x + 3.0),
        lambda x: (x * x + 1.0).sqrt(),
        lambda x: (x * 0.3).turn() * (1.0 / (x + 2.0)),
        lambda x: planar_series(x * x, 1.0 - x).unit(),
        lambda x: planar_series(x + 2.0, x * x).unit().angle(),
        lambda x: planar_series(x, x * x).abs2() - x.dot(planar_series(x, 2.0 * x)) + planar_series(x, x).cross(x * 1j),
    ],
)
def test_every_coefficient_against_finite_differences(function) -> None:  # type: ignore[no-untyped-def]
    """x(t) = 0.4 + 0.7 t - 0.2 t^2 + 0.1 t^3, evaluated at nine times around zero as plain numbers."""
    coefficients = (0.4, 0.7, -0.2, 0.1)
    step = 0.02
    samples = [polynomial.polyval(k * step, coefficients) for k in range(-4, 5)]
    values = np.array([function(constant(x)).c[0] for x in samples])
    found = function(Series(coefficients))
    for k, expected in enumerate(differences(values, step), start=1):
        assert abs(found.derivative(k) - expected) < 1e-7 * 10**k / 10
    assert abs(found.derivative(0) - values[4]) < 1e-15


@given(seed=SEEDS, order=st.integers(1, 4))
def test_constants_behave_as_their_full_series(seed: int, order: int) -> None:
    a, b = series(seed, order)
    number = b.c[0] + 4.0
    short, full = constant(number), Series((number, *[np.zeros(3)] * order))
    for one, other in (
        (a + short, a + full),
        (short + a, full + a),
        (a - short, a - full),
        (short - a, full - a),
        (a * short, a * full),
        (short * a, full * a),
        (a / short, a / full),
        (short / (a + 9.0), full / (a + 9.0)),
        (a.dot(short), a.dot(full)),
        (short.cross(a), full.cross(a)),
    ):
        assert apart(one, other) < 1e-14
    assert (short * short).order == 0
    assert (short + 1.0).order == 0
    assert short.derivative(1).tolist() == [0, 0, 0]
    assert short.derivative(7).tolist() == [0, 0, 0]


@given(seed=SEEDS, order=ORDERS)
def test_numbers_and_arrays_on_either_side(seed: int, order: int) -> None:
    a, _ = series(seed, order)
    array = np.arange(1.0, 4.0)
    for number in (2, 2.5, 1 - 2j, np.float64(0.5), array):
        as_one = constant(number)
        for one, other in (
            (number + a, as_one + a),
            (a + number, a + as_one),
            (number - a, as_one - a),
            (a - number, a - as_one),
            (number * a, as_one * a),
            (a * number, a * as_one),
            (a / number, a / as_one),
            (number / (a + 9.0), as_one / (a + 9.0)),
        ):
            assert isinstance(one, Series)
            assert apart(one, other) < 1e-15
    assert as_series(a) is a
    assert as_series(2.0).c == (2.0,)


def test_shapes_broadcast() -> None:
    rng = np.random.default_rng(0)
    a, b = random_planar(rng, 2, (4, 1)), random_planar(rng, 2, (5,))
    for result in (a * b, a + b, a / b, a.dot(b), a.cross(b)):
        assert all(np.shape(c) == (4, 5) for c in result.c)
    assert np.allclose(
        (a * b).c[2][3, 1], (Series(tuple(x[3, 0] for x in a.c)) * Series(tuple(y[1] for y in b.c))).c[2]
    )


def test_derivatives_are_factorials_times_coefficients() -> None:
    s = Series((1.0, 2.0, 3.0, 4.0))
    assert [s.derivative(k) for k in range(4)] == [1.0, 2.0, 6.0, 24.0]
    assert s.derivative(4) == 0.0


def test_no_root_of_a_negative_number() -> None:
    with np.errstate(invalid="ignore"):
        assert np.isnan(constant(np.array([-1.0])).sqrt().c[0]).all()


def test_division_by_zero_is_not_a_number_for_plain_numbers_too() -> None:
    with np.errstate(all="ignore"):
        assert not np.isfinite((1.0 / constant(0.0)).c[0])
        assert not np.isfinite(((1 + 1j) / constant(0j)).c[0])
        assert not np.isfinite((1.0 / constant(np.zeros(1))).c[0]).any()


def test_repr_shows_the_coefficients() -> None:
    assert repr(Series((1.0, 2.0))) == "Series((1.0, 2.0))"
