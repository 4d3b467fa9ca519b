"""Curves against closed forms (circle, ellipse, involute, parabola), brute force, and theorems on closed curves."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compoundkin.base.arrays import Number
from compoundkin.base.curves import Analytic, Curve, Function, Spline
from compoundkin.base.curves.samples import hull_indices
from compoundkin.base.errors import InvalidMechanism
from compoundkin.base.series import Series, constant
from tests.support import differences

SEEDS = st.integers(0, 2**32 - 1)
TURN = 2.0 * np.pi
A, B = 3.0, 2.0


def ellipse(s: Number) -> Number:
    return A * np.cos(s) + 1j * B * np.sin(s)


def ellipse_series(s: Series) -> Series:
    return A * s.turn().real + s.turn().imag * (1j * B)


# every kind of curve as the same ellipse, and how near its points and its derivatives come to it
ELLIPSES: dict[str, tuple[Curve, float]] = {
    "analytic": (Analytic(ellipse_series, 0.0, TURN, closed=True), 1e-14),
    "function": (Function(ellipse, 0.0, TURN, closed=True), 1e-11),
    "spline": (Spline(ellipse(np.linspace(0.0, TURN, 401)), closed=True), 1e-9),
}
KINDS = pytest.mark.parametrize("kind", ELLIPSES)


def eccentric(curve: Curve, s: Number) -> Number:
    """The angle that belongs to a point of an ellipse, however the curve is parametrised."""
    point = curve.at(s).c[0]
    return np.angle(point.real / A + 1j * point.imag / B)


def shortest(p: complex) -> float:
    """The distance of a point from the ellipse: the best of all stationary points, roots of a quartic in exp(i s)."""
    # (A^2 - B^2) sin s cos s - A x sin s + B y cos s = 0, times 4 i z^2 where z = exp(i s)
    c, d = A**2 - B**2, 2.0 * (A * p.real + 1j * B * p.imag)
    z = np.roots([c, -d.conjugate(), 0.0, d, -c])
    return float(np.min(np.abs(p - ellipse(np.angle(z)))))


def apart(a: Number, b: Number) -> float:
    """The greatest difference of angles."""
    return float(np.max(np.abs(np.exp(1j * np.asarray(a)) - np.exp(1j * np.asarray(b)))))


def moving(polynomial: Callable[[float], Number], order: int = 3, step: float = 0.01) -> tuple[Series, list[Number]]:
    """A motion as a series at time 0 (of nine samples, exact for polynomials), and its nine positions."""
    positions = [np.asarray(polynomial(k * step), dtype=complex) for k in range(-4, 5)]
    rates = differences(np.stack(positions, axis=-1), step)
    return Series((positions[4], rates[0], rates[1] / 2.0, rates[2] / 6.0)[: order + 1]), positions


# --- closed forms -----------------------------------------------------------------------------------------


@KINDS
def test_points_curvature_length_and_size_of_an_ellipse(kind: str) -> None:
    from scipy.special import ellipe

    curve, near = ELLIPSES[kind]
    s = np.linspace(curve.low, curve.high, 101).reshape(1, 101)
    angle = eccentric(curve, s)
    assert np.max(np.abs(curve.at(s).c[0] - ellipse(angle))) < 10 * near
    expected = A * B / (A**2 * np.sin(angle) ** 2 + B**2 * np.cos(angle) ** 2) ** 1.5
    assert np.max(np.abs(curve.curvature(s) - expected)) < 1e4 * near
    along = -A * np.sin(angle) + 1j * B * np.cos(angle)
    assert np.max(np.abs(curve.tangent(s).c[0] - along / np.abs(along))) < 1e3 * near
    assert np.max(np.abs(curve.normal(s).c[0] - -1j * along / np.abs(along))) < 1e3 * near
    assert curve.length == pytest.approx(4.0 * A * ellipe(1.0 - (B / A) ** 2), rel=1e-10)
    assert curve.size == pytest.approx(2.0 * np.hypot(A, B), rel=1e-5)
    assert curve.is_counterclockwise
    assert curve.crosses_itself() == ()


@KINDS
def test_derivatives_belong_to_the_points(kind: str) -> None:
    curve, _ = ELLIPSES[kind]
    step = 0.02 * (curve.high - curve.low) / TURN
    s = np.linspace(curve.low, curve.high, 17)[:, None] + step * np.arange(-4, 5)
    expected = differences(curve.at(s).c[0], step)
    found = curve.derivatives(s[:, 4], 3)
    assert len(found) == 4
    for k in range(1, 4):
        assert np.max(np.abs(found[k] - expected[k - 1])) < 1e-9 * 100**k


@KINDS
def test_foot_on_an_ellipse_against_all_stationary_points(kind: str) -> None:
    curve, near = ELLIPSES[kind]
    rng = np.random.default_rng(1)
    p = rng.uniform(-5, 5, (4, 25)) + 1j * rng.uniform(-5, 5, (4, 25))
    least = np.reshape([shortest(x) for x in p.flat], p.shape)
    s = curve.foot(p)
    assert s.c[0].shape == p.shape
    assert np.all((curve.low <= s.c[0]) & (s.c[0] <= curve.high))
    apart = p - curve.at(s).c[0]
    assert np.max(np.abs(np.abs(apart) - least)) < 1e-12 + 10 * near
    assert np.max(np.abs((np.conj(apart) * curve.tangent(s).c[0]).real)) < 1e-12
    assert not np.any(curve.beyond(p))


@KINDS
def test_support_of_an_ellipse(kind: str) -> None:
    """Where n . C is greatest, the angle is atan2(b n_y, a n_x); the distance is the root of (a n_x)^2 + (b n_y)^2."""
    curve, near = ELLIPSES[kind]
    n = np.exp(1j * np.linspace(-7.0, 7.0, 501))
    s = curve.support(n)
    assert apart(eccentric(curve, s.c[0]), np.arctan2(B * n.imag, A * n.real)) < 1e4 * near
    distance = (np.conj(n) * curve.at(s).c[0]).real
    assert np.max(np.abs(distance - np.hypot(A * n.real, B * n.imag))) < 10 * near


@KINDS
def test_series_of_points_feet_and_supports_against_differences(kind: str) -> None:
    """Each coefficient to order 3 against the same search at nine neighbouring times."""
    curve, _ = ELLIPSES[kind]
    start = np.array([0.3, 1.1, 4.0])

    def place(t: float) -> Number:
        return (4.0 + start) * np.exp(1j * start) + (1.0 - 2j) * t + (0.5 + 1j) * t**2 - 0.7j * t**3

    p, positions = moving(place)
    for found, search in ((curve.foot(p), curve.foot), (curve.support(p), curve.support)):
        expected = differences(np.stack([search(x).c[0] for x in positions], axis=-1), 0.01)
        for k, rate in enumerate(expected, start=1):
            assert np.max(np.abs(found.derivative(k) - rate)) < 1e-8 * 10 ** (2 * k - 2)
    s, parameters = moving(lambda t: start + 0.7 * t + 0.2 * t**2 + 0.1 * t**3)
    s = s.real
    for function in (curve.at, curve.tangent, curve.normal):
        expected = differences(np.stack([function(x.real).c[0] for x in parameters], axis=-1), 0.01)
        for k, rate in enumerate(expected, start=1):
            assert np.max(np.abs(function(s).derivative(k) - rate)) < 1e-8 * 10 ** (2 * k - 2)


def test_involute_of_the_unit_circle() -> None:
    """Radius of curvature s, arc s^2 / 2; parallel curves are involutes of the same circle."""
    curve = Analytic(lambda s: s.turn() * (1.0 - 1j * s), 0.5, 4.0, closed=False)
    s = np.linspace(0.5, 4.0, 50)
    assert np.max(np.abs(curve.curvature(s) - 1.0 / s)) < 1e-13
    assert curve.length == pytest.approx((16.0 - 0.25) / 2.0, rel=1e-13)
    assert np.max(np.abs(curve.normal(s).c[0] + 1j * np.exp(1j * s))) < 1e-14
    parallel = curve.offset(0.3)
    assert np.max(np.abs(parallel.at(s).c[0] - np.exp(1j * s) * (1.0 - 1j * (s + 0.3)))) < 1e-13
    assert np.max(np.abs(parallel.curvature(s) - 1.0 / (s + 0.3))) < 1e-12
    found = curve.foot(parallel.at(Series((s, 1.0, 0.0, 0.0))))
    assert np.max(np.abs(found.c[0] - s)) < 1e-13
    assert all(np.max(np.abs(c - e)) < 1e-10 for c, e in zip(found.c[1:], (1.0, 0.0, 0.0), strict=True))


def test_undercut_where_the_roller_is_larger_than_the_radius_of_curvature() -> None:
    """Radii of curvature of the involute are s: an offset of -2 is undercut up to s = 2."""
    curve = Analytic(lambda s: s.turn() * (1.0 - 1j * s), 0.5, 4.0, closed=False)
    assert not curve.undercut(-0.4)
    ((low, high),) = curve.undercut(-2.0)
    assert low == 0.5
    assert high == pytest.approx(2.0, abs=1e-12)
    assert curve.undercut(-5.0) == ((0.5, 4.0),)


def test_undercut_of_an_ellipse_is_at_its_ends() -> None:
    """The radius of curvature is least at the ends of the major axis, b^2 / a = 4 / 3."""
    curve, _ = ELLIPSES["analytic"]
    assert not curve.undercut(1.0)
    assert not curve.undercut(-1.333)
    assert not curve.offset(-1.333).crosses_itself()
    spans = curve.undercut(-1.5)
    # (a^2 sin^2 + b^2 cos^2)^(3/2) = 1.5 a b
    edge = np.arcsin(np.sqrt(((1.5 * A * B) ** (2 / 3) - B**2) / (A**2 - B**2)))
    expected = ((np.pi - edge, np.pi + edge), (TURN - edge, TURN + edge))
    assert np.max(np.abs(np.array(spans) - expected)) < 1e-9
    # the swallowtails of the parallel curve lie on the major axis
    crossings = curve.offset(-1.5).crosses_itself()
    assert len(crossings) == 2
    assert max(abs(c.point.imag) for c in crossings) < 1e-9


def test_circle_all_over() -> None:
    circle = Analytic(lambda s: 5.0 * s.turn() + (1 + 2j), 0.0, TURN, closed=True)
    larger = circle.offset(2.0)
    s = np.linspace(-20.0, 20.0, 99)
    assert np.max(np.abs(larger.at(s).c[0] - (7.0 * np.exp(1j * s) + 1 + 2j))) < 1e-13
    assert np.max(np.abs(larger.curvature(s) - 1 / 7)) < 1e-13
    assert larger.length == pytest.approx(14.0 * np.pi, rel=1e-12)
    assert circle.undercut(-5.0001) == ((0.0, TURN),)
    # the foot of a point that circles at any distance turns with it
    p = Series((s, 1.0, 0.0, 0.0)).turn() * 3.0 + (1 + 2j)
    foot = circle.foot(p)
    assert apart(foot.c[0], s) < 1e-14
    assert np.max(np.abs(foot.c[1] - 1.0)) < 1e-13
    assert max(np.max(np.abs(c)) for c in foot.c[2:]) < 1e-12


# --- theorems on closed curves ------------------------------------------------------------------------------


def random_closed(seed: int) -> tuple[Curve, Callable[[Number], Number]]:
    """A star-shaped curve: a circle and a few random waves, counterclockwise, and its formula."""
    rng = np.random.default_rng(seed)
    waves = (rng.standard_normal(4) + 1j * rng.standard_normal(4)) * 0.2 / np.arange(2, 6) ** 2
    scale, centre = 10.0 ** rng.uniform(-3, 3), complex(*rng.uniform(-1, 1, 2))

    def point(s: Number) -> Number:
        radius = 1.0 + sum((w * np.exp(1j * k * s)).real for k, w in enumerate(waves, start=2))
        return scale * (centre + radius * np.exp(1j * s))

    return Function(point, 0.0, TURN, closed=True), point


@given(seed=SEEDS)
def test_whole_curve(seed: int) -> None:
    """Total curvature 2 pi (Hopf), L^2 >= 4 pi area, length of the parallel curve L + 2 pi d (Steiner)."""
    curve, point = random_closed(seed)
    s = np.linspace(0.0, TURN, 512, endpoint=False)
    speed = np.abs(curve.derivatives(s, 1)[1])
    assert np.mean(curve.curvature(s) * speed) == pytest.approx(1.0, rel=1e-8)
    assert curve.length == pytest.approx(np.mean(speed) * TURN, rel=1e-9)
    assert curve.length**2 >= 4.0 * np.pi * curve.samples.area
    assert curve.is_counterclockwise
    assert not curve.crosses_itself()
    assert np.max(np.abs(curve.at(s).c[0] - point(s))) < 1e-11 * curve.size
    distance = 0.1 * curve.size
    if not curve.undercut(distance):
        parallel = curve.offset(distance)
        assert parallel.length == pytest.approx(curve.length + TURN * distance, rel=1e-7)
        assert np.max(np.abs(parallel.normal(s).c[0] - curve.normal(s).c[0])) < 1e-7


@given(seed=SEEDS)
def test_searches_find_the_best_of_the_whole_curve(seed: int) -> None:
    curve, point = random_closed(seed)
    rng = np.random.default_rng(seed + 1)
    dense = point(np.linspace(0.0, TURN, 5001))
    p = np.mean(dense) + (rng.standard_normal(40) + 1j * rng.standard_normal(40)) * curve.size
    foot = curve.foot(p)
    apart = p - curve.at(foot).c[0]
    # nearer than any of the points compared, up to what samples cannot tell apart
    assert np.all(np.abs(apart) <= np.min(np.abs(p[:, None] - dense), axis=1) + 1e-6 * curve.size)
    assert np.max(np.abs((np.conj(apart) * curve.tangent(foot).c[0]).real)) < 1e-12 * curve.size
    n = np.exp(1j * rng.uniform(-4.0, 4.0, 40))
    support = curve.support(n)
    reached = (np.conj(n) * curve.at(support).c[0]).real
    assert np.all(reached >= np.max((np.conj(n)[:, None] * dense).real, axis=1) - 1e-11 * curve.size)
    assert np.max(np.abs((np.conj(n) * curve.tangent(support).c[0]).real)) < 1e-10


@given(seed=SEEDS)
def test_points_of_the_curve_are_their_own_feet(seed: int) -> None:
    curve, _ = random_closed(seed)
    s = np.random.default_rng(seed).uniform(0.0, TURN, 30)
    moved = Series((s, 1.0, 0.5, -0.2))
    found = curve.foot(curve.at(moved))
    assert np.max(np.abs(np.exp(1j * found.c[0]) - np.exp(1j * s))) < 1e-12
    for c, expected in zip(found.c[1:], moved.c[1:], strict=True):
        assert np.max(np.abs(c - expected)) < 1e-9


@given(seed=SEEDS)
def test_moving_and_turning_the_curve_moves_nothing_else(seed: int) -> None:
    _, point = random_closed(seed)
    points = point(np.linspace(0.0, TURN, 40, endpoint=False))
    turn, shift = np.exp(0.7j), 3.0 - 1j
    one, other = Spline(points, closed=True), Spline(turn * points + shift, closed=True)
    s = np.linspace(0.0, one.high, 25)
    assert other.high == pytest.approx(one.high, rel=1e-9)
    size = one.size + abs(shift)
    assert np.max(np.abs(other.at(s).c[0] - (turn * one.at(s).c[0] + shift))) < 1e-8 * size


def test_convex_hull_against_another_algorithm() -> None:
    from scipy.spatial import ConvexHull

    rng = np.random.default_rng(3)
    points = rng.standard_normal(300) + 1j * rng.standard_normal(300)
    found = ConvexHull(np.stack((points.real, points.imag), axis=-1)).vertices
    own = hull_indices(points)
    start = list(found).index(own[0])
    assert own.tolist() == np.roll(found, -start).tolist()
    assert hull_indices(np.linspace(0, 1 + 1j, 5)).tolist() == [0, 4]


# --- splines ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("closed", [True, False])
def test_a_spline_goes_through_its_points_and_gains_six_orders(closed: bool) -> None:
    """Twice as many points, unevenly spaced: at least 40 times as near (2^6 = 64 in the limit)."""
    missed = []
    for n in (40, 80, 160) if closed else (80, 160, 320):
        t = TURN * np.arange(n) / n if closed else np.linspace(0.0, 3.0, n)
        points = ellipse(t + 0.3 * np.sin(t))
        curve = Spline(points, closed)
        assert np.max(np.abs(curve.at(curve.foot(points)).c[0] - points)) < 1e-12
        dense = curve.at(np.linspace(0.0, curve.high, 2001)).c[0]
        missed.append(np.max(np.abs(np.hypot(dense.real / A, dense.imag / B) - 1.0)))
    assert missed[0] / missed[1] > 40
    assert missed[1] / missed[2] > 40


def test_the_parameter_of_a_spline_is_nearly_the_length_of_arc() -> None:
    curve = Spline(5.0 * np.exp(1j * TURN * np.arange(60) / 60), closed=True)
    assert curve.high == pytest.approx(10.0 * np.pi, rel=1e-8)
    speed = np.abs(curve.derivatives(np.linspace(0.0, curve.high, 300), 1)[1])
    assert np.max(np.abs(speed - 1.0)) < 1e-6


def test_few_points() -> None:
    square = Spline([1, 1j, -1, -1j], closed=True)
    assert abs(square.at(square.high / 8).c[0]) == pytest.approx(1.0, abs=0.03)
    line = Spline([0, 1, 2, 3], closed=False)
    assert line.length == pytest.approx(3.0, rel=1e-14)
    assert np.max(np.abs(line.curvature(np.linspace(0.0, 3.0, 7)))) < 1e-12
    assert line.support(1j + 1.0).c[0] == 3.0
    assert np.isfinite(line.foot(2.5 + 1j).c[0])


def test_a_closed_spline_may_repeat_its_first_point() -> None:
    points = [complex(ellipse(t)) for t in np.linspace(0.0, TURN, 30, endpoint=False)]
    assert Spline([*points, points[0]], closed=True) == Spline(points, closed=True)
    assert hash(Spline(points, closed=True)) == hash(Spline(tuple(points), closed=True))


@KINDS
def test_a_closed_curve_is_periodic_and_smooth_at_its_seam(kind: str) -> None:
    curve, near = ELLIPSES[kind]
    period = curve.high - curve.low
    s = np.linspace(curve.low, curve.high, 33)
    for turns in (-3, 1, 7):
        assert np.max(np.abs(curve.at(s + turns * period).c[0] - curve.at(s).c[0])) < 1e-13 + near
    a, b = curve.derivatives(curve.low, 3), curve.derivatives(curve.low - 1e-12, 3)
    assert all(abs(x - y) < 1e-4 for x, y in zip(a, b, strict=True))


# --- open curves ----------------------------------------------------------------------------------------------

PARABOLA = Analytic(lambda s: s + 1j * (s * s), -1.0, 1.0, closed=False)


def test_beyond_the_ends_of_an_open_curve() -> None:
    """The normal at the end (1, 1) of y = x^2 has the direction (-2, 1)."""
    end = 1 + 1j
    p = np.array(
        [end + (-2 + 1j) * 0.1 + 0.1, end + (-2 + 1j) * 0.1 - 0.1, end + 1.0, -end.conjugate() - 0.5, 0.3 - 1j]
    )
    foot = PARABOLA.foot(Series((p, np.full(5, 1 + 1j), np.zeros(5))))
    assert PARABOLA.beyond(p).tolist() == [True, False, True, True, False]
    assert PARABOLA.beyond(p, foot).tolist() == [True, False, True, True, False]
    assert foot.c[0][[0, 2, 3]].tolist() == [1.0, 1.0, -1.0]
    assert foot.c[1][[0, 2, 3]].tolist() == [0.0, 0.0, 0.0]
    assert np.all(foot.c[1][[1, 4]] != 0.0)
    # (p - C) . C' = 0 for p = (x, y): 2 s^3 + (1 - 2 y) s - x = 0
    for k in (1, 4):
        roots = np.roots([2.0, 0.0, 1.0 - 2.0 * p[k].imag, -p[k].real])
        assert np.min(np.abs(roots - foot.c[0][k])) < 1e-12


def test_a_flat_face_on_an_open_curve() -> None:
    """Directions (x, -1) touch y = x^2 at s = x / 2; others touch an end."""
    n = np.array([0.5 - 1j, -1.9 - 1j, 3.0 - 1j, 1j - 0.1])
    s = PARABOLA.support(Series((n, np.ones(4))))
    assert np.max(np.abs(s.c[0] - [0.25, -0.95, 1.0, -1.0])) < 1e-14
    assert np.max(np.abs(s.c[1] - [0.5, 0.5, 0.0, 0.0])) < 1e-13


# --- crossings ----------------------------------------------------------------------------------------------


def test_crossings() -> None:
    lemniscate = Function(lambda s: np.cos(s) + 0.5j * np.sin(2 * s), 0.1, 0.1 + TURN, closed=True)
    (crossing,) = lemniscate.crosses_itself()
    assert abs(crossing.point) < 1e-12
    assert apart([crossing.first, crossing.second], [np.pi / 2, -np.pi / 2]) < 1e-12
    limacon = Function(lambda s: (1.0 + 2.0 * np.cos(s)) * np.exp(1j * s), 0.0, TURN, closed=True)
    (crossing,) = limacon.crosses_itself()
    assert apart([crossing.first, crossing.second], [2 * np.pi / 3, 4 * np.pi / 3]) < 1e-12
    trefoil = Function(lambda s: 1j * np.exp(-1j * s) - 2j * np.exp(2j * s), 0.0, TURN, closed=True)
    crossings = trefoil.crosses_itself()
    assert len(crossings) == 3
    assert np.ptp([abs(c.point) for c in crossings]) < 1e-12
    assert Function(np.exp, 0.0, 1.0, closed=False).crosses_itself() == ()
    loop = Function(lambda s: s**3 - s + 1j * s**2, -1.5, 1.5, closed=False)
    (crossing,) = loop.crosses_itself()
    assert (crossing.first, crossing.second) == pytest.approx((-1.0, 1.0), abs=1e-12)


def test_a_circle_run_twice_is_no_profile() -> None:
    assert Analytic(Series.turn, 0.0, 2 * TURN, closed=True).crosses_itself()


def test_clockwise() -> None:
    curve = Spline(ellipse(-np.linspace(0.0, TURN, 40)), closed=True)
    assert not curve.is_counterclockwise
    s = np.linspace(0.0, 5.0, 9)
    assert np.all(curve.curvature(s) < 0.0)
    inside = curve.offset(0.5)
    assert inside.length == pytest.approx(curve.length - TURN * 0.5, rel=1e-6)
    assert np.max(np.abs(inside.at(s).c[0] - (curve.at(s).c[0] + 0.5 * curve.normal(s).c[0]))) < 1e-14


# --- shapes, missing poses, speed ---------------------------------------------------------------------------


@KINDS
def test_shapes_broadcast_and_numbers_stay_numbers(kind: str) -> None:
    curve, _ = ELLIPSES[kind]
    rng = np.random.default_rng(0)
    lead = 5.0 * np.exp(1j * rng.uniform(0, TURN, (3, 1)))
    p = Series((lead, rng.standard_normal((1, 4)) + 0j, 0.3j))
    foot = curve.foot(p)
    assert [np.shape(c) for c in foot.c] == [(3, 1), (3, 4), (3, 4)]
    one = curve.foot(Series((complex(lead[1, 0]), complex(p.c[1][0, 2]), 0.3j)))
    assert [float(c) for c in one.c] == pytest.approx([foot.c[0][1, 0], foot.c[1][1, 2], foot.c[2][1, 2]], rel=1e-10)
    assert np.ndim(curve.at(one.c[0]).c[0]) == 0
    assert np.ndim(curve.curvature(0.1)) == 0
    assert [np.ndim(c) for c in curve.derivatives(0.5, 12)] == [0] * 13
    assert curve.at(constant(0.5)).order == 0
    assert curve.foot(np.zeros((0, 3), dtype=complex)).c[0].shape == (0, 3)


@KINDS
def test_unassembled_poses_stay_missing(kind: str) -> None:
    curve, _ = ELLIPSES[kind]
    p = Series((np.array([4.0 + 1j, np.nan + 0j, 2j]), np.array([1.0 + 0j, np.nan, 1j])))
    for found in (curve.foot(p), curve.support(p)):
        assert all(np.isfinite(c).tolist() == [True, False, True] for c in found.c)
        assert np.isfinite(curve.at(found).c[1]).tolist() == [True, False, True]


def test_no_rates_at_the_centre_of_curvature() -> None:
    """A point that passes the centre of a circle has no foot that moves smoothly."""
    circle = Analytic(Series.turn, 0.0, TURN, closed=True)
    foot = circle.foot(Series((np.array([0j, 0.5 + 0j]), np.array([1 + 1j, 1j]))))
    assert np.isfinite(foot.c[0]).all()
    assert np.isfinite(foot.c[1]).tolist() == [False, True]


@KINDS
def test_a_whole_motion_takes_a_moment(kind: str) -> None:
    """36,000 poses of a roller on the profile with velocity and acceleration; some 60 ms when nothing else runs."""
    curve, _ = ELLIPSES[kind]
    s = np.linspace(curve.low, curve.high, 36000, endpoint=False)
    p = curve.offset(1.0).at(Series((s, 1.0, 0.0)))
    curve.foot(p.c[0][:9])
    times = []
    for _ in range(3):
        start = time.process_time()
        found = curve.foot(p)
        times.append(time.process_time() - start)
    period = curve.high - curve.low
    assert np.max(np.abs((found.c[0] - s + period / 2) % period - period / 2)) < 1e-12 * period
    assert np.max(np.abs(found.c[1] - 1.0)) < 1e-8
    assert min(times) < 1.0


# --- what cannot be a curve ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: Spline([0, 1, 1j], closed=True), "points: 3 points are too few for a curve; give 4 or more"),
        (lambda: Spline([0, 1, 1j, 0], closed=True), "3 points are too few"),
        (lambda: Spline([], closed=False), "0 points are too few"),
        (
            lambda: Spline([0, 1, 1, 2, 3j], closed=False),
            r"points\[2\]: the same point as the one before; leave it out",
        ),
        (lambda: Spline([2, 2, 2, 2], closed=False), r"points\[1\]: the same point"),
        (lambda: Spline([0, 1, np.nan, 2, np.inf], closed=False), r"(?s)points\[2\].*finite.*points\[4\]"),
        (lambda: Spline(np.ones((2, 5)), closed=False), r"one list of points, these have the shape \(2, 5\)"),
        (lambda: Spline(["a", "b"], closed=False), "complex numbers"),  # type: ignore[list-item]
        (lambda: Function(np.exp, 1.0, 1.0, closed=False), "cannot run from 1.0 to 1.0"),
        (lambda: Function(np.exp, 0.0, np.inf, closed=False), "cannot run from"),
        (lambda: Function(lambda s: 1j, 0.0, 1.0, closed=False), r"function: the function gives the shape \(\)"),
        (lambda: Function(lambda s: s[:-1], 0.0, 1.0, closed=False), "one complex number for each parameter"),
        (lambda: Function(lambda s: s if s > 0 else -s, 0.0, 1.0, closed=False), "does not take an array"),
        (
            lambda: Function(lambda s: s + 1j * np.abs(s - 0.3), 0.0, 1.0, closed=False),
            r"s = 0\.(3|29).*: .*not smooth",
        ),
        (lambda: Function(lambda s: np.where(s > 0.5, np.nan, s), 0.0, 1.0, closed=False), "not a finite number"),
        (lambda: Function(np.exp, 0.0, 1.0, closed=True), "closed: the curve ends 1.71828 away from where it begins"),
        (lambda: Analytic(Series.turn, 0.0, 1.0, closed=True), "closed: the curve ends"),
        (lambda: Analytic(Series.turn, 1.0, 0.0, closed=False), "cannot run from 1.0 to 0.0"),
    ],
)
def test_problems_are_told(make: Callable[[], Curve], told: str) -> None:
    with pytest.raises(InvalidMechanism, match=told):
        make()


def test_stretches_between_breaks() -> None:
    """Between the places where derivatives jump the index is one; on a closed curve the last piece is the first."""
    circle = Analytic(Series.turn, 0.0, 2 * np.pi, True, (1.0, 3.0))
    places = np.array([0.5, 1.5, 2.9, 3.1, 6.2, 0.5 + 2 * np.pi])
    assert circle.smooth_piece(places).tolist() == [0, 1, 1, 0, 0, 0]
    assert circle.offset(0.5).breaks == (1.0, 3.0)
    arc = Analytic(Series.turn, 0.0, 2.0, False, (1.0,))
    assert arc.smooth_piece(np.array([0.5, 1.5])).tolist() == [0, 1]
    assert Analytic(Series.turn, 0.0, 2.0, False).smooth_piece(0.5) == 0
