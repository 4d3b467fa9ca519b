"""Laws of least time: closed forms of all cases, limits never exceeded, one always reached, no shorter time."""

from __future__ import annotations

from math import inf, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

import compoundkin as ck
from compoundkin.base.errors import InvalidMechanism
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


@settings(max_examples=60)
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
