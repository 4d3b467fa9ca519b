"""Motion programs: published peaks, joints of the pieces, symmetry, derivatives against differences."""

from __future__ import annotations

from math import inf, pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

import compoundkin as ck
from compoundkin.base.errors import InvalidInput, InvalidMechanism
from compoundkin.base.series import Series
from compoundkin.model.laws.cam_laws import LAWS, Discontinuity, unit_pieces
from compoundkin.model.laws.motion_programs import (
    Program,
    ProgramSegment,
    dwell,
    fall,
    least_time,
    program,
    rise,
    synchronised,
)
from tests.support import examples

MOVING = [law for law in LAWS if law != "dwell"]

# Peak velocity, acceleration and jerk for a rise of 1 over a span of 1 as the tables of R. L. Norton, Design of
# Machinery, chapter 8, and Cam Design and Manufacturing Handbook print them; the modified sine also in PSMotion's
# MechDesigner manual (1.76, 5.53, 69.47). None: infinite. The closed forms are below.
PEAKS = {
    "constant-velocity": (1.0, None, None),
    "parabolic": (2.0, 4.0, None),
    "harmonic": (1.571, 4.945, None),
    "cycloidal": (2.0, 6.283, 39.5),
    "3-4-5": (1.875, 5.774, 60.0),
    "4-5-6-7": (2.188, 7.526, 52.5),
    "modified-trapezoid": (2.0, 4.888, 61.4),
    "modified-sine": (1.760, 5.528, 69.5),
}
# Two printed accelerations are 0.2 % above the closed forms: 4.945 for pi**2 / 2 = 4.935, 7.526 for 7.513.
PRINTED = 2.5e-3

EXACT = {
    "harmonic": (pi / 2, pi**2 / 2),
    "cycloidal": (2.0, 2 * pi, 4 * pi**2),
    "3-4-5": (15 / 8, 10 / sqrt(3), 60.0),
    "4-5-6-7": (35 / 16, 84 * sqrt(5) / 25, 52.5),
    "modified-trapezoid": (2.0, 8 * pi / (2 + pi), 32 * pi**2 / (2 + pi)),
    "modified-sine": (4 * pi / (4 + pi), 4 * pi**2 / (4 + pi), 16 * pi**3 / (4 + pi)),
}


def derivatives(moving: Program, x: object, order: int = 3, repeat: bool | None = None) -> list[np.ndarray]:
    """Position and derivatives with respect to the coordinate itself."""
    x = np.asarray(x, dtype=float)
    along = moving.at(Series((x, np.ones_like(x), *[np.zeros_like(x)] * (order - 1))[: order + 1]), repeat)
    return [along.derivative(k) for k in range(order + 1)]


# Places between 0 and 1 that are never a joint, symmetric about the middle.
INSIDE = (np.arange(4000) + 0.5) / 4000


@pytest.mark.parametrize("law", MOVING)
def test_peaks_are_the_published_ones(law: str) -> None:
    found = derivatives(program(rise(1.0, over=1.0, law=law)), np.linspace(1e-9, 1 - 1e-9, 40001))
    for printed, values in zip(PEAKS[law], found[1:], strict=True):
        if printed is not None:
            assert np.max(np.abs(values)) == pytest.approx(printed, rel=PRINTED)


@pytest.mark.parametrize("law", EXACT)
def test_peaks_are_those_of_the_closed_forms(law: str) -> None:
    found = derivatives(program(rise(1.0, over=1.0, law=law)), np.linspace(1e-9, 1 - 1e-9, 40001))
    for exact, values in zip(EXACT[law], found[1:], strict=False):
        assert np.max(np.abs(values)) == pytest.approx(exact, rel=1e-6)


def test_the_jerk_of_the_modified_sine_at_the_crossover_is_the_published_one() -> None:
    """PSMotion's MechDesigner manual, modified sinusoid: -23.15."""
    middle = derivatives(program(rise(1.0, over=1.0, law="modified-sine")), 0.5)
    assert middle[3] == pytest.approx(-23.15, abs=0.02)


@pytest.mark.parametrize("law", MOVING)
def test_laws_are_symmetric(law: str) -> None:
    place, speed, acceleration, jerk = derivatives(program(rise(1.0, over=1.0, law=law)), INSIDE)
    np.testing.assert_allclose(place + place[::-1], 1.0, atol=1e-14)
    np.testing.assert_allclose(speed, speed[::-1], atol=1e-12)
    np.testing.assert_allclose(acceleration, -acceleration[::-1], atol=1e-11)
    np.testing.assert_allclose(jerk, jerk[::-1], atol=1e-9)


@pytest.mark.parametrize("law", MOVING)
def test_velocity_integrates_to_the_rise_and_never_turns_back(law: str) -> None:
    speed = derivatives(program(rise(7.0, over=3.0, law=law)), 3.0 * INSIDE)[1]
    assert np.mean(speed) * 3.0 == pytest.approx(7.0, rel=1e-6)
    assert np.all(speed >= -1e-12)


@pytest.mark.parametrize("law", ["modified-trapezoid", "modified-sine", "cycloidal", "3-4-5", "4-5-6-7"])
def test_position_velocity_and_acceleration_are_continuous_at_every_joint(law: str) -> None:
    pieces = unit_pieces(law)
    ends = [*(piece.start for piece in pieces[1:]), 1.0]
    for k in range(3):
        before = [0.0, *(piece.derivative(k, end - piece.start) for piece, end in zip(pieces, ends, strict=True))]
        after = [*(piece.derivative(k, 0.0) for piece in pieces), 1.0 if k == 0 else 0.0]
        np.testing.assert_allclose(before, after, atol=1e-13)
    assert program(dwell(1.0), rise(1.0, 1.0, law), dwell(1.0), fall(1.0, 1.0, law)).discontinuities() == ()


def test_jumps_of_velocity_and_acceleration_are_told() -> None:
    harmonic = program(dwell(1.0), rise(2.0, over=1.0, law="harmonic"), dwell(1.0), fall(2.0, over=1.0))
    found = harmonic.discontinuities()
    assert [(one.place, one.order) for one in found] == [(1.0, 2), (2.0, 2)]
    assert [one.jump for one in found] == pytest.approx([pi**2, pi**2])
    linear = program(dwell(1.0), rise(3.0, over=1.5, law="constant-velocity"))
    assert linear.discontinuities() == (Discontinuity(1.0, 1, 2.0), Discontinuity(2.5, 1, -2.0))
    # a harmonic rise and fall without dwells is one cosine: no jump at the turn or where it begins anew
    assert program(rise(1.0, 2.0, "harmonic"), fall(1.0, 2.0, "harmonic")).discontinuities() == ()


def test_harmonic_rise_and_fall_are_one_cosine() -> None:
    moving = program(rise(2.0, 3.0, "harmonic"), fall(2.0, 3.0, "harmonic"), start=1.0)
    x = np.linspace(-7.0, 20.0, 301)
    found = derivatives(moving, x)
    w = pi / 3.0
    for k, values in enumerate(found):
        expected = (2.0 if k == 0 else 0.0) - np.cos(w * x + k * pi / 2) * w**k
        np.testing.assert_allclose(values, expected, atol=1e-12)


def test_cycloidal_rise_is_the_textbook_formula() -> None:
    x = np.linspace(0.0, 2.0, 101)
    place, speed, *_ = derivatives(program(rise(5.0, over=2.0)), x)
    np.testing.assert_allclose(place, 5.0 * (x / 2 - np.sin(pi * x) / (2 * pi)), atol=1e-14)
    np.testing.assert_allclose(speed, 2.5 * (1 - np.cos(pi * x)), atol=1e-13)


def test_the_modified_curves_are_the_textbook_formulas() -> None:
    """Norton, Design of Machinery, chapter 8; those of the modified trapezoid are printed to eight digits."""
    x = np.linspace(0.0, 1.0, 201)
    sine = np.select(
        [x < 1 / 8, x < 7 / 8],
        [
            pi * x - np.sin(4 * pi * x) / 4,
            2 + pi * x - 9 / 4 * np.sin((pi + 4 * pi * x) / 3),
        ],
        4 + pi * x - np.sin(4 * pi * x) / 4,
    ) / (4 + pi)
    np.testing.assert_allclose(derivatives(program(rise(1.0, 1.0, "modified-sine")), x)[0], sine, atol=1e-14)
    x = np.linspace(0.0, 0.5, 101)
    trapezoid = np.select(
        [x < 1 / 8, x < 3 / 8],
        [
            0.38898448 * x - 0.0309544 * np.sin(4 * pi * x),
            2.44406184 * x**2 - 0.22203097 * x + 0.00723407,
        ],
        1.6110154 * x - 0.0309544 * np.sin(4 * pi * x - pi) - 0.3055077,
    )
    found = derivatives(program(rise(1.0, 1.0, "modified-trapezoid")), x)[0]
    np.testing.assert_allclose(found, trapezoid, atol=2e-7)


def test_outside_it_holds_its_ends_unless_it_repeats() -> None:
    once = program(rise(2.0, over=1.0), start=1.0)
    place, *rest = derivatives(once, [-5.0, 9.0])
    assert place.tolist() == [1.0, 3.0]
    assert np.all(np.array(rest) == 0.0)
    there_and_back = program(rise(2.0, over=1.0), fall(2.0, over=1.0))
    np.testing.assert_allclose(derivatives(there_and_back, [0.3, 2.3, -1.7])[0], derivatives(there_and_back, 0.3)[0])
    assert derivatives(there_and_back, 2.5, repeat=False)[0] == pytest.approx(0.0, abs=1e-15)


def test_an_indexing_program_goes_on_from_where_it_is() -> None:
    index = program(rise(60.0, over=1.0, law="modified-sine"), dwell(0.5), repeat=True)
    assert index.repeats
    places = derivatives(index, [0.5, 2.0, 3.5, -0.1, 15.0])[0]
    np.testing.assert_allclose(places, [30.0, 90.0, 150.0, 0.0, 600.0], atol=1e-12)


def test_as_a_law_in_time_it_holds_its_last_value_unless_told_to_repeat() -> None:
    lift = rise(1.0, over=1.0), fall(1.0, over=1.0)
    assert program(*lift).coordinate(np.array([2.5]), 2).c[0].tolist() == pytest.approx([0.0], abs=1e-15)
    assert program(*lift, repeat=True).coordinate(np.array([2.5]), 0).c[0].tolist() == pytest.approx([0.5])


def test_shapes_numbers_and_constants_are_kept() -> None:
    moving = program(rise(2.0, over=1.0), fall(2.0, over=1.0))
    assert moving.at(Series((np.full((3, 4), 0.5), 1.0, 0.0))).c[1].shape == (3, 4)
    assert [type(c) for c in moving.at(Series((0.5, 1.0, 0.0))).c] == [float] * 3
    assert moving.at(Series((0.5,))).c == pytest.approx((1.0,))
    assert np.isnan(moving.at(Series((np.array([np.nan]), 1.0))).c[0]).all()


programs = st.builds(
    lambda parts, start: Program(tuple(parts), start),
    st.lists(
        st.builds(
            lambda law, over, amount: ProgramSegment(law, over, 0.0 if law == "dwell" else amount),
            st.sampled_from(list(LAWS)),
            st.floats(0.2, 5.0),
            st.floats(-10.0, 10.0),
        ),
        min_size=1,
        max_size=5,
    ),
    st.floats(-5.0, 5.0),
)


@given(programs, st.floats(0.02, 0.98), st.integers(0, 4))
def test_derivatives_are_those_that_differences_show(moving: Program, share: float, index: int) -> None:
    piece = moving.pieces[index % len(moving.pieces)]
    ends = [*(one.start for one in moving.pieces[1:]), moving.period]
    length = ends[index % len(moving.pieces)] - piece.start
    x, h = piece.start + share * length, 0.01 * length
    steps = np.array([-2.0, -1.0, 0.0, 1.0, 2.0]) * h
    found = derivatives(moving, x + steps, repeat=False)
    natural = max(abs(s.rise) for s in moving.segments) + 1e-3
    for k in range(3):
        # five points: the error is h**4 / 30 times the fifth derivative (Abramowitz and Stegun, 25.3.6)
        slope = found[k] @ np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * h)
        assert slope == pytest.approx(found[k + 1][2], abs=3e-4 * natural * 10.0**k / min(1.0, length) ** (k + 1))


@given(programs, st.floats(-10.0, 30.0), st.tuples(*[st.floats(-2.0, 2.0)] * 3))
def test_along_a_series_the_chain_rule_holds(moving: Program, x: float, rates: tuple[float, float, float]) -> None:
    v, a, j = rates
    f = [float(d) for d in derivatives(moving, x)]
    along = moving.at(Series((x, v, a / 2, j / 6)))
    assert along.derivative(1) == pytest.approx(f[1] * v)
    assert along.derivative(2) == pytest.approx(f[2] * v**2 + f[1] * a, abs=1e-9)
    assert along.derivative(3) == pytest.approx(f[3] * v**3 + 3 * f[2] * v * a + f[1] * j, abs=1e-7)


@given(programs)
def test_values_at_the_breaks_are_sums_of_the_rises(moving: Program) -> None:
    held = derivatives(moving, moving.breaks, order=0, repeat=False)[0]
    np.testing.assert_allclose(held, moving.values, atol=1e-12)
    x = np.linspace(0.0, moving.period, 501)
    assert np.ptp(derivatives(moving, x, order=0, repeat=False)[0]) <= moving.lift + 1e-12


@pytest.mark.parametrize(
    ("make", "where"),
    [
        (lambda: rise(1.0, over=1.0, law="cycloid"), "did you mean 'cycloidal'"),
        (lambda: rise(1.0, over=0.0), "segment.over"),
        (lambda: rise(float("nan"), over=1.0), "segment.rise"),
        (lambda: fall("1", over=1.0), "'1' is no number"),  # type: ignore[arg-type]
        (lambda: dwell(-1.0), "segment.over"),
        (lambda: ProgramSegment("dwell", 1.0, 2.0), "a dwell rises by 0"),
        (lambda: program(), "there is no segment"),
        (lambda: program(rise(1.0, 1.0), 5.0), "is no program segment"),  # type: ignore[arg-type]
        (lambda: program(rise(1.0, 1.0), start=float("inf")), "program.start"),
    ],
)
def test_what_cannot_be_meant_is_said(make: object, where: str) -> None:
    with pytest.raises((InvalidMechanism, InvalidInput)) as caught:
        make()  # type: ignore[operator]
    assert where in str(caught.value)


# (distance, speed, acceleration, jerk) and the time, one for each case: which limits are reached.
# Closed forms of L. Biagiotti, C. Melchiorri, Trajectory Planning for Automatic Machines and Robots, Springer 2008:
# (3.8) to (3.10) for trapezoid and triangle; (3.25) to (3.28) for the double s without and with constant speed.
CASES: dict[str, tuple[tuple[float, float, float, float], float]] = {
    "trapezoid": ((10.0, 5.0, 10.0, inf), 10 / 5 + 5 / 10),
    "triangle": ((2.0, 5.0, 8.0, inf), 2 * sqrt(2 / 8)),
    "triangle that just reaches the speed": ((2.5, 5.0, 10.0, inf), 1.0),
    "no limit of speed": ((9.0, inf, 4.0, inf), 3.0),
    "all three": ((10.0, 5.0, 10.0, 30.0), 10 / 5 + 5 / 10 + 10 / 30),
    "acceleration not reached": ((10.0, 5.0, 20.0, 30.0), 10 / 5 + 2 * sqrt(5 / 30)),
    "speed not reached": ((10.0, 20.0, 10.0, 30.0), 10 / 30 + sqrt((10 / 30) ** 2 + 4 * 10 / 10)),
    "neither": ((10.0, 20.0, 50.0, 30.0), (32 * 10 / 30) ** (1 / 3)),
    "jerk alone": ((2.0, inf, inf, 1.0), 4.0),
    "acceleration and jerk just reached": ((2.0, 1.0, 1.0, 1.0), 4.0),
}


# Rounding of the pieces' coefficients, as a part of a limit.
ROUNDING = 1e-11


def moved(distance: float, speed: float, acceleration: float, jerk: float, **more: float) -> Program:
    given = {"speed": speed, "acceleration": acceleration, "jerk": jerk}
    return least_time(distance, **{k: v for k, v in given.items() if v != inf}, **more)


@pytest.mark.parametrize("name", CASES)
def test_the_time_is_the_closed_form(name: str) -> None:
    limits, expected = CASES[name]
    assert moved(*limits).period == pytest.approx(expected, rel=1e-14)


# So far apart that every case occurs, but no part is lost in the rounding of the time.
LIMIT = st.floats(0.05, 50.0)


@settings(max_examples=examples(60))
@given(st.floats(1e-3, 100.0), LIMIT | st.just(inf), LIMIT, LIMIT | st.just(inf), st.sampled_from((1.0, -1.0)))
def test_limits_hold_and_one_is_reached_at_every_moment(
    distance: float, speed: float, acceleration: float, jerk: float, sign: float
) -> None:
    law = moved(sign * distance, speed, acceleration, jerk, start=3.0)
    joints = np.array([*(piece.start for piece in law.pieces), law.period])
    t = (joints[:-1, None] + np.diff(joints)[:, None] * (np.arange(99) + 0.5) / 99).ravel()
    found = law.coordinate(t, 3)
    parts = [np.abs(found.derivative(k)) / limit for k, limit in ((1, speed), (2, acceleration), (3, jerk))]
    assert all(np.max(part) <= 1 + ROUNDING for part in parts)
    # the argument of Pontryagin: where no limit is reached, time could be saved
    used = [part > 1 - 1e-9 for part in parts]
    assert np.all(np.any(used, axis=0))
    assert np.all(found.derivative(1) * sign >= 0.0)
    ends = law.coordinate(np.array([0.0, law.period]), 1)
    np.testing.assert_allclose(ends.c[0], [3.0, 3.0 + sign * distance], rtol=1e-13, atol=0)
    # times are exact to rounding of the last one
    steepest = float(np.max(np.abs(found.derivative(2))))
    assert np.all(np.abs(ends.c[1]) <= 1e-14 * steepest * law.period + ROUNDING * distance / law.period)
    orders = {one.order for one in law.discontinuities()}
    assert orders == ({2} if jerk == inf else set())


@pytest.mark.parametrize("name", ["triangle", "trapezoid", "all three", "speed not reached", "neither"])
def test_no_sampled_motion_goes_farther_in_less_time(name: str) -> None:
    """A linear program: the farthest place reached from rest to rest by 150 pieces of constant jerk."""
    (distance, *limits), time = CASES[name]
    assert _farthest(0.985 * time, *limits) < distance < _farthest(1.015 * time, *limits)


def _farthest(time: float, speed: float, acceleration: float, jerk: float) -> float:
    """With an infinite jerk the pieces are of constant acceleration."""
    n = 150
    h, steps = time / n, np.tril(np.ones((n, n)))
    if jerk == inf:
        highest, rates = acceleration, [h * steps]
        place = h * h * (steps @ steps - steps / 2)
    else:
        highest, a = jerk, h * steps
        before = np.vstack([np.zeros(n), a[:-1]])
        v = np.cumsum(h * before + h * h / 2 * np.eye(n), axis=0)
        rates = [v, a]
        place = np.cumsum(h * np.vstack([np.zeros(n), v[:-1]]) + h * h / 2 * before + h**3 / 6 * np.eye(n), axis=0)
    bounds = (speed, acceleration)[: len(rates)]
    rows = np.vstack([sign * rate for rate in rates for sign in (1, -1)])
    below = np.concatenate([np.full(2 * n, min(bound, 1e9)) for bound in bounds])
    found = linprog(-place[-1], A_ub=rows, b_ub=below, A_eq=np.array([rate[-1] for rate in rates]),
                    b_eq=np.zeros(len(rates)), bounds=(-highest, highest), method="highs")  # fmt: skip
    assert found.success
    return float(-found.fun)


def test_stretched_and_synchronised_axes_end_together_within_their_limits() -> None:
    x = least_time(300.0, speed=200.0, acceleration=900.0, jerk=9000.0)
    y = least_time(-80.0, speed=200.0, acceleration=900.0)
    cycle = program(rise(1.0, law="least-time", jerk=8.0), dwell(0.1), fall(1.0, over=0.7), start=0.5)
    together = synchronised(x, y, cycle)
    assert [one.span for one in together] == [(0.0, cycle.period)] * 3
    t = np.linspace(0.0, cycle.period, 1001)
    for one, slow in zip((x, y, cycle), together, strict=True):
        fast = np.abs(one.coordinate(t * one.period / cycle.period, 3).c)
        k = one.period / cycle.period
        np.testing.assert_allclose(np.abs(slow.coordinate(t, 3).c)[:2], fast[:2] * [[1.0], [k]], rtol=1e-9, atol=1e-9)
    assert together[2] == cycle
    assert program(rise(0.0, law="least-time", jerk=1.0, over=2.0)).coordinate(1.0, 1).c == (0.0, 0.0)


def test_a_short_segment_is_stretched_as_much_as_a_long_one() -> None:
    """What rounding leaves of the whole time would be a great part of a last segment that takes nanoseconds."""
    short = program(dwell(1000.0 / 3.0), rise(1e-18, law="least-time", acceleration=1.0))
    long, stretched = synchronised(least_time(1e5, acceleration=1.0), short)
    assert stretched.period == pytest.approx(long.period, rel=1e-15)
    assert stretched.segments[1].over == pytest.approx(2e-9 * long.period / short.period, rel=1e-12)


@pytest.mark.parametrize("kind", [np.float32, np.array, np.float64])
def test_numbers_of_numpy_are_read_as_numbers(kind: Any) -> None:
    law = least_time(kind(8.0), acceleration=kind(2.0))
    assert law == least_time(8.0, acceleration=2.0)
    assert hash(law) == hash(least_time(8.0, acceleration=2.0))
    assert "np." not in repr(law)


def arm(law: Program) -> ck.Mechanism:
    frame, bar = ck.link("frame", A=(0, 0)), ck.link("arm", A=(0, 0), B=(1, 0))
    return ck.Mechanism("Arm", frame, bar, ck.drive("arm", law=law))


def test_a_driver_moves_by_it_and_files_keep_it(tmp_path: object) -> None:
    law = program(
        rise(1.5, law="least-time", speed=2.0, acceleration=10.0, jerk=100.0),
        dwell(0.2),
        fall(0.75, law="least-time", acceleration=12.0, over=2.0),
    )
    motion = ck.solve(arm(law))
    assert motion.drives["arm"].value[-1] == pytest.approx(0.75)
    assert np.max(np.abs(motion.drives["arm"].second)) <= 10.0 * (1 + ROUNDING)
    path = f"{tmp_path}/arm.toml"
    ck.save(arm(law), path)
    text = Path(path).read_text("utf-8")
    first, _, last = (line for line in text.splitlines() if "law =" in line)
    assert "jerk = 100" in first
    assert "over" not in first
    assert "over = 2" in last
    assert ck.load(path).drives[0].law == law
    told = ck.report(ck.decompose(arm(law))).text()
    assert "within 2 rad/s, 10 rad/s^2 and 100 rad/s^3" in told.replace("\n", " ").replace("  ", " ")


def test_a_cam_may_be_made_for_it(tmp_path: object) -> None:
    up, down = (word(20, np.pi, "least-time", jerk=200.0) for word in (rise, fall))
    cam = ck.profiles.synthesise(program(up, down), base=40)
    made = ck.Mechanism(
        "Cam", ck.link("frame", A=0), ck.link("cam", A=0), ck.link("follower", P=0),
        ck.slide("follower", on="frame", through="A", angle=ck.deg(90)),
        ck.cam("follower", on="cam", at="P", profile=cam), ck.drive("cam"),
    )  # fmt: skip
    ck.save(made, f"{tmp_path}/cam.toml")
    assert ck.load(f"{tmp_path}/cam.toml") == made


@pytest.mark.parametrize(
    ("make", "where", "words"),
    [
        (lambda: least_time(1.0, acceleration=0.0), "acceleration", "is not a limit"),
        (lambda: least_time(1.0, acceleration=1.0, speed=-2.0), "speed", "give a positive number"),
        (lambda: least_time(1.0, acceleration=1.0, jerk=np.nan), "jerk", "leave it out"),
        (lambda: least_time(1.0, speed=1.0), "acceleration", "nothing limits"),
        (lambda: least_time(0.0, jerk=1.0), "rise", "write a dwell"),
        (lambda: least_time(8.0, acceleration=2.0, over=3.9), "over", "it takes 4"),
        (lambda: least_time(1e300, acceleration=1e-300), "over", "other units"),
        # ramps that are no part of the whole time any more
        (lambda: least_time(1e50, speed=1e-50, acceleration=1e50, jerk=1e50), "over", "other units"),
        (lambda: rise(1.0, over=1.0, speed=3.0), "speed", "no such limit"),
        (lambda: rise(1.0), "over", "there is no span"),
        (lambda: ProgramSegment("least-tim", rise=1.0), "law", "least-time"),
        (lambda: synchronised(), "programs", "give two or more"),
    ],
)
def test_what_cannot_be_meant_says_where(make: object, where: str, words: str) -> None:
    with pytest.raises(InvalidMechanism) as caught:
        make()  # type: ignore[operator]
    assert any(problem.where.endswith(where) for problem in caught.value.problems)
    assert words in str(caught.value)
