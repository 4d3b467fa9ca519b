"""Driving laws: values and derivatives, motions in time, what is refused, files."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result
from hypothesis import given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.files import dumps, loads
from compoundkin.files.json_schema import schema
from compoundkin.model.laws import FunctionLaw, Law
from compoundkin.model.laws.function_law import differentiate_function
from compoundkin.model.laws.law_numbers import derivative_jumps
from compoundkin.model.laws.motion_programs import Program, program, rise
from compoundkin.model.laws.path_coordinate import PathCoordinate
from compoundkin.model.laws.table_laws import TimeTable
from compoundkin.model.prescribed_paths import LinePath, place_table
from tests.model.test_programs import MOVING, programs
from tests.support import examples

# Central differences over nine points, step 0.01: the error is of the eighth power (Abramowitz and Stegun, 25.3).
STENCIL = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840.0


def four_bar(*words: Any, law: Any = None, **about: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=3, P=(1, 1)),
        ck.link("rocker", D=0, C=3),
        *(words or (ck.drive("crank", law=law),)),
        **about,
    )


def arm(first: Any = None, second: Any = None, **about: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Arm",
        ck.link("frame", A=0),
        ck.link("upper", A=0, B=2),
        ck.link("fore", B=0, C=1),
        ck.drive("upper", law=first),
        ck.drive("fore", on="upper", law=second, speed=1.0),
        **about,
    )


def ram(law: Any = None, **words: Any) -> ck.Mechanism:
    rod = ck.link("rod", P=0), ck.slide("rod", on="frame", through="O", angle=0.0)
    return ck.Mechanism("Ram", ck.link("frame", O=0), *rod, ck.drive("rod", law=law, **words), unit="mm")


def slope(law: Law, t: float, k: int, h: float) -> float:
    """The derivative of the k-th derivative, by differences."""
    values = law.coordinate(t + h * np.arange(-4, 5), k).derivative(k)
    return float(STENCIL @ np.broadcast_to(values, STENCIL.shape)) / h


LAWS: dict[str, Law] = {
    "speed": ck.laws.constant_speed(3.0, start=0.2),
    "acceleration": ck.laws.constant_acceleration(-2.0, speed=3.0, start=0.2),
    "program": ck.laws.program(
        ck.laws.rise(1.0, 0.7, "3-4-5"), ck.laws.dwell(0.3), ck.laws.fall(2.0, 1.0, "4-5-6-7"), start=0.3
    ),
    "repeated": ck.laws.program(ck.laws.rise(1.0, 0.5), ck.laws.dwell(0.1), repeat=True),
    "table": ck.laws.time_table(np.linspace(-0.5, 2.5, 13), np.sin(np.linspace(-0.5, 2.5, 13))),
    "cubic": ck.laws.time_table(np.linspace(-0.5, 2.5, 13), np.sin(np.linspace(-0.5, 2.5, 13)), degree=3),
    "wheel": ck.laws.time_table([0.0, 0.2, 0.5, 0.7, 0.8, 1.1, 1.2], [0.0, 1.0, 2.2, 3.1, 4.0, 5.5, 6.3], repeat=True),
    "function": FunctionLaw(lambda t: 0.5 * np.sin(3.0 * t) + t**2 / (1.0 + t**2)),
}
# Joints of a program, where a derivative may jump.
TIMES = [0.123, 0.456, 0.83, 1.234, 1.93]


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("t", TIMES)
def test_derivatives_are_those_that_differences_show(name: str, t: float) -> None:
    law = LAWS[name]
    # a cubic spline has no continuous jerk
    for k in range(2 if name == "cubic" else 3):
        assert slope(law, t, k, 2e-3) == pytest.approx(
            float(law.coordinate(t, 3).derivative(k + 1)), rel=1e-5, abs=1e-4
        )


def test_constant_speed_and_acceleration_are_the_textbook_formulas() -> None:
    t = np.linspace(-1.0, 3.0, 9)
    moved = LAWS["acceleration"].coordinate(t, 3)
    np.testing.assert_allclose(moved.derivative(0), 0.2 + 3.0 * t - t**2, atol=1e-14)
    np.testing.assert_allclose(moved.derivative(1), 3.0 - 2.0 * t, atol=1e-14)
    assert moved.derivative(2) == -2.0
    assert moved.derivative(3) == 0.0
    np.testing.assert_allclose(LAWS["speed"].coordinate(t, 1).c[0], 0.2 + 3.0 * t)


@given(st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6), st.integers(6, 12))
def test_a_quintic_table_reproduces_polynomials_of_its_degree(c: list[float], count: int) -> None:
    exact = np.polynomial.Polynomial(c)
    times = np.linspace(0.0, 2.0, count) ** 1.3
    table = ck.laws.time_table(times, exact(times))
    t = np.linspace(0.0, times[-1], 40)
    moved = table.coordinate(t, 3)
    for k in range(4):
        np.testing.assert_allclose(moved.derivative(k), exact.deriv(k)(t) if k else exact(t), atol=1e-7 * 10.0**k)


def test_a_table_goes_through_its_values_and_a_short_one_is_a_polynomial() -> None:
    times, values = np.array([0.0, 0.5, 0.7, 1.5, 2.0, 2.1, 3.0]), np.array([0.0, 1.0, 0.5, 0.2, 2.0, 2.5, 1.0])
    for degree in (3, 5):
        np.testing.assert_allclose(
            ck.laws.time_table(times, values, degree=degree).coordinate(times, 0).c[0], values, atol=1e-12
        )
    assert ck.laws.time_table([0, 2], [1, 5]).coordinate(0.5, 1).c == pytest.approx((2.0, 2.0))


def test_a_repeated_table_joins_smoothly_and_goes_on_from_the_value_reached() -> None:
    wheel = LAWS["wheel"]
    before, after = wheel.coordinate(1.2 - 1e-9, 3), wheel.coordinate(1.2 + 1e-9, 3)
    for k in range(4):
        assert before.derivative(k) == pytest.approx(after.derivative(k), rel=1e-4, abs=1e-4)
    turns = wheel.coordinate(np.array([0.3, 1.5, 3.9]), 0).c[0]
    np.testing.assert_allclose(np.diff(turns), [6.3, 12.6], atol=1e-12)


def test_outside_a_table_there_is_nothing() -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"2\.6 s is outside its table, -0\.5 to 2\.5 s"):
        LAWS["table"].coordinate(np.array([0.0, 2.6]), 1)
    # rounding of the last of many steps is not outside
    assert LAWS["table"].coordinate(2.5 + 1e-12, 0).c[0] == pytest.approx(math.sin(2.5))


# Each function with itself written so that arrays alone can follow it: by series and by differences.
WRITTEN: dict[str, Callable[[Any], Any]] = {
    "sines": lambda t: np.sin(2 * t) * np.cos(t) - np.tan(0.3 * t),
    "roots": lambda t: np.sqrt(1.5 + t) + 2.0 ** np.asarray(1.0) / (2.0 + t) - 1.0 / (3.0 - t),
    "powers": lambda t: t**3 - 2 * t**2 + (t + 2) ** 0.7 + np.square(t) + np.power(t + 2.0, -1),
    "exponentials": lambda t: np.exp(-t) * np.log(2.0 + t) + np.sinh(t) - np.cosh(0.5 * t) + np.tanh(t),
    "angles": lambda t: np.arctan(2 * t) + np.deg2rad(30.0 * t) - np.radians(t) + np.degrees(0.01 * t),
    "signs": lambda t: (
        np.abs(t + 5.0) * np.sign(t + 9.0) + np.maximum(t, -9.0) + np.minimum(2.0 * t, 9.0) + np.reciprocal(t + 4)
    ),
    "pieces": lambda t: np.where(t < 9.0, t**2, 0.0) + np.zeros_like(t) + (t > -3.0) * t + np.ones_like(t),
    "remainders": lambda t: ((t + 10.0) % 40.0) ** 2 - np.floor(t + 0.5) * 0.0,
}


@pytest.mark.parametrize("name", WRITTEN)
def test_functions_are_followed_exactly(name: str) -> None:
    f = WRITTEN[name]
    t = np.array([-0.73, -0.2, 0.11, 0.64, 1.37])

    def blind(x: Any) -> Any:
        return np.array([float(f(np.float64(one))) for one in np.ravel(x)]).reshape(np.shape(x))

    exact, found = differentiate_function(f, t, 3), differentiate_function(blind, t, 3)
    for k, limit in enumerate((1e-15, 1e-10, 1e-8, 1e-6)):
        np.testing.assert_allclose(exact[k], found[k], rtol=limit, atol=limit * 10)


def test_a_power_of_zero_has_its_derivatives() -> None:
    assert [one.tolist() for one in differentiate_function(lambda t: t**2, np.zeros(1), 3)] == [
        [0.0],
        [0.0],
        [2.0],
        [0.0],
    ]


@settings(max_examples=examples(30))
@given(st.floats(0.01, 2.0), st.floats(-3.0, 3.0))
def test_differences_are_as_good_as_they_say(scale: float, phase: float) -> None:
    t = np.linspace(0.0, 2.0, 41)
    found = differentiate_function(
        lambda x: np.array(list(map(math.sin, np.ravel(x) / scale + phase))).reshape(x.shape), t, 3
    )
    for k, limit in enumerate((1e-15, 1e-11, 1e-10, 1e-8)):
        exact = np.sin(t / scale + phase + k * np.pi / 2)
        np.testing.assert_allclose(found[k] * scale**k, exact, atol=10 * limit)


def test_a_function_may_return_its_derivatives() -> None:
    t = np.linspace(0.0, 1.0, 5)
    all_four = FunctionLaw(lambda t: (t**2, 2 * t, 2 + 0 * t, 7 + 0 * t)).coordinate(t, 3)
    assert all_four.derivative(3).tolist() == [7.0] * 5
    # the acceleration and the jerk then follow from the speed it returns
    two = FunctionLaw(lambda t: (0 * t, np.sin(t))).coordinate(t, 3)
    np.testing.assert_allclose(two.derivative(2), np.cos(t), atol=1e-14)
    np.testing.assert_allclose(two.derivative(3), -np.sin(t), atol=1e-14)


@pytest.mark.parametrize(
    ("f", "said"),
    [
        (lambda t: 3.0, "shape"),
        (lambda t: t[:-1], "shape"),
        (lambda t: np.log(t), "not finite at 0 s"),
        (lambda t: 1 / 0, "ZeroDivisionError"),
        (lambda t: "far", "does not return numbers"),
        (lambda t: (t,) * 5, "returns 5 arrays"),
        (lambda t: np.interp(t, [0, 0.5, 1], [0, 1, 0]), "has no derivative"),
        (lambda t: np.round(t * 2.0), "has no derivative"),
    ],
)
def test_what_a_function_must_not_do_is_said(f: Any, said: str) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=said) as caught:
        ck.solve(four_bar(law=f), time=np.linspace(0.0, 1.0, 5))
    assert caught.value.problems[0].where == "drives.crank.law"


@pytest.mark.parametrize("name", LAWS)
def test_a_motion_in_time_is_that_of_the_values_and_rates_of_its_law(name: str) -> None:
    t = np.linspace(0.05, 1.95, 20)
    motion = ck.solve(four_bar(law=LAWS[name]), time=t, order=3)
    rates = [np.broadcast_to(LAWS[name].coordinate(t, 3).derivative(k), t.shape) for k in range(4)]
    other = ck.solve(four_bar(), {"crank": rates[0]}, speed=rates[1], acceleration=rates[2], jerk=rates[3], order=3)
    for k in range(4):
        np.testing.assert_allclose(
            motion.points["P"].derivative(k), other.points["P"].derivative(k), rtol=1e-12, atol=1e-12
        )
    np.testing.assert_array_equal(motion.time, t)
    assert ck.verify(motion).passed


@pytest.mark.parametrize("name", ["speed", "acceleration", "program", "repeated", "table", "wheel", "function"])
def test_velocities_are_differences_of_positions_over_time(name: str) -> None:
    middle, h = 0.81, 1e-3
    motion = ck.solve(four_bar(law=LAWS[name]), time=middle + h * np.arange(-4, 5), order=3)
    point = motion.points["P"]
    for k in range(3):
        assert STENCIL @ np.asarray(point.derivative(k)) / h == pytest.approx(
            point.derivative(k + 1)[4], rel=1e-6, abs=1e-6
        )


def test_a_driver_without_a_law_moves_by_its_rates() -> None:
    t = np.linspace(0.0, 1.0, 7)
    motion = ck.solve(arm(ck.laws.constant_speed(2.0)), {"fore": 0.5}, time=t, acceleration={"fore": 4.0}, order=3)
    np.testing.assert_allclose(motion.drives["fore"].value, 0.5 + t + 2.0 * t**2)
    np.testing.assert_allclose(motion.drives["fore"].rate, 1.0 + 4.0 * t)
    np.testing.assert_allclose(motion.drives["upper"].value, 2.0 * t)
    resting = ck.solve(ram(speed=3.0), time=t)
    np.testing.assert_allclose(resting.points["P"].x, 3.0 * t)


def test_designs_and_times_go_together() -> None:
    t = np.linspace(0.0, 1.0, 6)
    speeds = np.array([1.0, 2.0, 3.0])[:, None]
    motion = ck.solve(four_bar(law=ck.laws.constant_speed(speeds)), time=t)
    assert motion.shape == (3, 6)
    np.testing.assert_allclose(motion.drives["crank"].value, speeds * t)
    np.testing.assert_allclose(motion.links["crank"].angular_velocity, speeds + 0 * t)
    one = ck.solve(four_bar(law=ck.laws.constant_speed(2.0)), time=0.5)
    assert one.shape == ()
    assert one.drives["crank"].value == 1.0


@pytest.mark.parametrize("name", LAWS)
def test_every_law_takes_a_single_time_and_times_of_any_shape(name: str) -> None:
    one = ck.solve(four_bar(law=LAWS[name]), time=0.81, order=3, modes={"rocker": 1})
    assert one.shape == ()
    many = ck.solve(four_bar(law=LAWS[name]), time=[[0.3, 0.81], [0.9, 1.1]], order=3, modes={"rocker": 1})
    assert many.shape == (2, 2)
    for k in range(4):
        np.testing.assert_allclose(one.points["P"].derivative(k), many.points["P"].derivative(k)[0, 1], rtol=1e-9)


def test_times_may_go_back() -> None:
    there = ck.solve(four_bar(law=np.sin), time=[0.0, 0.5, 1.0])
    back = ck.solve(four_bar(law=np.sin), time=[1.0, 0.5, 0.0])
    np.testing.assert_allclose(there.points["P"].velocity, back.points["P"].velocity[::-1], atol=1e-12)


def test_the_drawn_pose_leads_to_a_motion_in_time() -> None:
    """The drawing shows the crank at 90 degrees in the other mode; the motion begins elsewhere."""
    start = np.deg2rad(90.0)
    lead = four_bar(ck.drive("crank", law=ck.laws.constant_speed(2.0, start=start + 0.4)))
    other = ck.solve(lead, time=[0.0, 0.1], modes={"coupler": -1})
    drawing = ck.solve(lead, {"crank": [start]}, modes={"coupler": -1})
    drawn = lead.replace(ck.drawn(**{k: complex(drawing.points[k].position[0]) for k in "ABCD"}))
    np.testing.assert_allclose(
        ck.solve(drawn, time=[0.0, 0.1]).points["C"].position, other.points["C"].position, atol=1e-12
    )


def test_times_that_nobody_gives_are_those_of_the_laws() -> None:
    period = ck.laws.program(ck.laws.rise(1.0, 1.5), ck.laws.fall(1.0, 0.5))
    np.testing.assert_allclose(ck.solve(four_bar(law=period)).time, np.linspace(0.0, 2.0, 73))
    np.testing.assert_allclose(ck.solve(arm(period, LAWS["repeated"]), time=[0.0]).time, [0.0])
    stated = four_bar(law=period, time=[0.0, 0.25])
    np.testing.assert_allclose(ck.solve(stated).time, [0.0, 0.25])
    assert ck.solve(stated, {"crank": [0.0, 1.0]}).time is None
    assert ck.solve(four_bar()).time is None


@pytest.mark.parametrize(
    ("solve", "where", "remedy"),
    [
        (lambda: ck.solve(four_bar(law=np.sin)), "time", "give time="),
        (lambda: ck.solve(arm(LAWS["program"], LAWS["repeated"])), "time", "give time="),
        (lambda: ck.solve(four_bar(law=np.sin), time=[]), "time", ""),
        (lambda: ck.solve(four_bar(law=np.sin), time=[0.0, np.nan]), "time", ""),
        (lambda: ck.solve(four_bar(law=np.sin), time="noon"), "time", ""),
        (lambda: ck.solve(four_bar(law=np.sin), {"crank": 1.0}, time=[0.0]), "values.crank", "leave the values out"),
        (lambda: ck.solve(four_bar(law=np.sin), 1.0, time=[0.0]), "values.crank", "leave the values out"),
        (lambda: ck.solve(four_bar(law=np.sin), time=[0.0], speed=2.0), "speed.crank", "leave the speed out"),
        (lambda: ck.solve(arm(np.sin, np.sin), {"fore": 1.0}, time=[0.0]), "values.fore", "leave the values out"),
        (lambda: ck.solve(arm(np.sin), {"fore": [0.0, 1.0]}, time=[0.0, 1.0]), "drives.fore.values", "single number"),
        (lambda: ck.solve(arm(np.sin), time=[0.0, 1.0], jerk={"fore": [0.0, 1.0]}), "drives.fore.jerk", "one number"),
        (lambda: ck.solve(four_bar(law=LAWS["table"]), time=[0.0, 3.0]), "drives.crank.law", "repeat"),
        (lambda: ck.solve(four_bar(law=np.sin), {"crnk": 1.0}, time=[0.0]), "values.crnk", "did you mean"),
        (lambda: four_bar(ck.drive("crank", law=np.sin, values=[0.0])), "drives[0].values", "or the law out"),
        (lambda: four_bar(ck.drive("crank", law=np.sin, speed=2.0)), "drives[0].speed", "or the law out"),
        (lambda: ck.drive("crank", law=3.0), "drives.crank.law", "constant_speed"),
        (lambda: ck.drive("crank", law=TimeTable), "drives.crank.law", "constant_speed"),
        (lambda: four_bar(law=np.sin, time=[np.inf]), "time", ""),
        (lambda: ck.laws.constant_speed("fast"), "law.speed", ""),
        (lambda: ck.laws.constant_acceleration(np.nan), "law.acceleration", ""),
        (lambda: ck.laws.time_table([0, 1, 1], [0, 1, 2]), "law.times", "increasing"),
        (lambda: ck.laws.time_table([0, 1], [0, 1, 2]), "law", "one length"),
        (lambda: ck.laws.time_table([0, 1], [0, 1], degree=4), "law.degree", "5 (quintic)"),
        (lambda: ck.laws.time_table([0, 1, 2], [0, 1, 2], repeat=True), "law.times", "more"),
    ],
)
def test_what_contradicts_is_said_with_its_place_and_remedy(solve: Any, where: str, remedy: str) -> None:
    with pytest.raises((ck.errors.InvalidInput, ck.errors.InvalidMechanism)) as caught:
        solve()
    assert caught.value.problems[0].where == where
    assert remedy in caught.value.problems[0].remedy


def test_laws_are_equal_if_they_say_the_same() -> None:
    assert ck.laws.time_table([0, 1], [2, 3]) == ck.laws.time_table([0.0, 1.0], [2.0, 3.0])
    assert ck.laws.time_table([0, 1], [2, 3]) != ck.laws.time_table([0, 1], [2, 4])
    assert ck.laws.constant_speed(1.0) != ck.laws.constant_acceleration(1.0, 0.0)
    assert hash(ck.laws.constant_speed(1.0)) == hash(ck.laws.constant_speed(1.0))
    assert four_bar(law=np.sin) == four_bar(law=np.sin)
    assert four_bar(law=np.sin) != four_bar(law=np.cos)


# files

tables = st.builds(
    lambda steps, values, degree: ck.laws.time_table(np.cumsum(steps), values[: len(steps)], degree=degree),
    st.lists(st.floats(0.01, 5.0), min_size=2, max_size=9),
    st.lists(st.floats(-10.0, 10.0), min_size=9, max_size=9),
    st.sampled_from([3, 5]),
)
numbers = st.floats(-1e3, 1e3)
written = st.one_of(
    programs.map(lambda p: Program(p.segments, p.start, repeat=True)),
    programs,
    tables,
    st.builds(ck.laws.constant_speed, numbers, numbers),
    st.builds(ck.laws.constant_acceleration, numbers, numbers, numbers),
)
times = st.one_of(st.none(), st.lists(st.floats(-10, 10), min_size=1, max_size=6), st.just(np.arange(0.0, 1.0, 0.01)))


@given(written, times, st.booleans())
def test_laws_and_times_are_read_back_exactly(law: Law, time: Any, is_ram: bool) -> None:
    mechanism = ram(law) if is_ram else four_bar(law=law, time=time)
    for syntax, parsed in (("toml", tomllib.loads), ("json", json.loads)):
        text = dumps(mechanism, syntax)
        Draft202012Validator(schema()).validate(parsed(text))
        assert loads(text, syntax) == mechanism


FILE = """
format = 1
title = "Crank"
time = { from = 0, to = 2, step = 0.5 }
[links.frame]
points = { A = [0, 0] }
[links.crank]
points = { A = [0, 0], B = [1, 0] }
[[drives]]
link = "crank"
law = LAW
[[expected]]
at = { time = 1 }
quantity = "crank.angle"
value = 60
tolerance = 1e-9
"""


@pytest.mark.parametrize(
    ("law", "values"),
    [
        ('{ kind = "constant-speed", speed = { rpm = 10 } }', [0.0, 30.0, 60.0, 90.0, 120.0]),
        ('{ kind = "constant-acceleration", acceleration = 2, start = 10 }', np.rad2deg([0, 0.25, 1, 2.25, 4]) + 10),
        ('{ kind = "time-table", times = [0, 1, 2], values = [0, 60, 0] }', [0.0, 45.0, 60.0, 45.0, 0.0]),
        ('{ kind = "program", segments = [{ law = "parabolic", over = 1, rise = 60 }, { law = "dwell", over = 1 }] }',
         [0.0, 30.0, 60.0, 60.0, 60.0]),
    ],
)  # fmt: skip
def test_laws_in_files_are_in_degrees(law: str, values: Any) -> None:
    motion = ck.solve(loads(FILE.replace("LAW", law)))
    np.testing.assert_allclose(np.rad2deg(motion.drives["crank"].value), values, atol=1e-12)


def test_a_published_number_may_be_at_a_time() -> None:
    mechanism = loads(FILE.replace("LAW", '{ kind = "constant-speed", speed = { rpm = 10 } }'))
    outcome = ck.report(ck.solve(mechanism)).outcome
    assert (outcome.published, outcome.published_passed) == (1, 1)
    assert loads(dumps(mechanism)) == mechanism


@pytest.mark.parametrize(
    ("law", "places"),
    [
        ("3", ["drives[0].law"]),
        ('{ kind = "constant-sped", speed = 1 }', ["drives[0].law.kind"]),
        ("{ speed = 1 }", ["drives[0].law.kind"]),
        ('{ kind = "constant-speed", sped = 1 }', ["drives[0].law.sped"]),
        ('{ kind = "constant-speed", speed = "x", start = "y" }', ["drives[0].law.speed", "drives[0].law.start"]),
        ('{ kind = "time-table", times = [1, 0], values = [0, 60] }', ["drives[0].law.times"]),
        ('{ kind = "program", segments = [] }', ["drives[0].law.segments"]),
        ('{ kind = "program", segments = 1 }', ["drives[0].law.segments"]),
        ('{ kind = "program", segments = [{ law = "dwel", over = 1 }, { law = "dwell", over = 0 }], repeat = 1 }',
         ["drives[0].law.segments[0].law", "drives[0].law.segments[1].over", "drives[0].law.repeat"]),
    ],
)  # fmt: skip
def test_all_problems_of_a_law_in_a_file_are_told(law: str, places: list[str]) -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        loads(FILE.replace("LAW", law))
    assert [problem.where for problem in caught.value.problems] == places


def test_a_python_function_cannot_be_saved() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="time_table") as caught:
        dumps(four_bar(law=np.sin))
    assert caught.value.problems[0].where == "drives.crank.law"


def test_tables_and_reports_tell_the_time() -> None:
    motion = ck.solve(four_bar(law=LAWS["program"]), time=[0.0, 0.5, 1.0])
    assert motion.to_pandas()["time"].tolist() == [0.0, 0.5, 1.0]
    text = ck.report(motion).text()
    assert "crank moves by a program of 2 s, from 17.1887°: 3-4-5 rise by 57.2958°" in " ".join(text.split())
    assert "time" in motion.to_pandas().columns
    assert "time" not in ck.solve(four_bar()).to_pandas().columns


@pytest.mark.parametrize("name", LAWS)
def test_a_report_has_words_for_every_law(name: str) -> None:
    sections = {s.key: s for s in ck.report(ck.decompose(four_bar(law=LAWS[name]))).sections}
    said = [block.text for block in sections["drivers"].blocks if hasattr(block, "text")]
    assert len(said) == 1
    assert said[0].startswith("crank moves ")


# the page and the command line

PAGE = (Path(__file__).parents[2] / "docs" / "laws.md").read_text("utf-8")


def test_the_page_shows_what_its_example_prints(capsys: pytest.CaptureFixture[str]) -> None:
    exec(re.search(r"```python\n(.*?)```", PAGE, re.DOTALL)[1], {})
    assert capsys.readouterr().out == re.search(r"```text\n(.*?)```", PAGE, re.DOTALL)[1]


def test_the_file_on_the_page_loads_and_moves() -> None:
    motion = ck.solve(loads(re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)[1]))
    assert len(motion.time) == 41
    assert ck.report(motion).outcome.passed


def test_the_page_names_every_law_with_its_peaks() -> None:
    for law in MOVING:
        peaks = re.search(rf'`"{law}"`[^|]*\| ([\d.]+) \| ([\d.]+|infinite)', PAGE)
        moved = program(rise(1.0, 1.0, law)).coordinate(np.linspace(1e-6, 1 - 1e-6, 20001), 2)
        assert np.max(np.abs(moved.derivative(1))) == pytest.approx(float(peaks[1]), abs=6e-4)
        if peaks[2] != "infinite":
            assert np.max(np.abs(moved.derivative(2))) == pytest.approx(float(peaks[2]), abs=6e-4)


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Result]:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.toml").write_text(re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)[1])
    return lambda *args: CliRunner().invoke(cli, list(args))


def test_the_command_line_takes_times(run: Callable[..., Result]) -> None:
    rows = run("solve", "law.toml", "--time", "0:2:0.5", "--output", "rocker.angle").stdout.splitlines()
    assert rows[0] == "time [s],crank.value [deg],rocker.angle [deg],assembled"
    assert [row.split(",")[0] for row in rows[1:]] == ["0.0", "0.5", "1.0", "1.5", "2.0"]
    assert float(rows[3].split(",")[1]) == pytest.approx(90.0)
    assert len(run("solve", "law.toml").stdout.splitlines()) == 42
    moved = run("solve", "law.toml", "--at", "0", "--output", "rocker.angle")
    assert moved.stdout.startswith("crank.value")


def test_the_command_line_moves_drivers_without_laws(run: Callable[..., Result]) -> None:
    text = (Path("law.toml").read_text().partition("[drives.law]")[0]).replace("time =", "# time =")
    Path("plain.toml").write_text(text)
    rows = run("solve", "plain.toml", "--time", "0,1", "--at", "10", "--speed", "20deg", "--output", "crank.angle")
    assert [float(row.split(",")[1]) for row in rows.stdout.splitlines()[1:]] == pytest.approx([10.0, 30.0])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--time", "0:2"), "write seconds"),
        (("--time", "0:2:-1"), "do not lead"),
        (("--time", "now"), "write seconds"),
        (("--time", "0:1:0.1", "--at", "3"), "leave the values out"),
        (("--time", "0:1:0.1", "--speed", "3"), "leave the speed out"),
    ],
)
def test_mistakes_with_times_are_said(run: Callable[..., Result], options: tuple[str, ...], said: str) -> None:
    result = run("solve", "law.toml", *options)
    assert result.exit_code == 2
    assert said in " ".join(result.stderr.split())


def test_instant_centres_and_reports_of_a_file_with_a_law(run: Callable[..., Result]) -> None:
    assert run("centres", "law.toml").exit_code == 0
    assert "crank moves by a program of 2 s" in " ".join(run("report", "law.toml").stdout.split())
    assert "crank moves by a program of 2 s" in " ".join(run("report", "law.toml", "--time", "0,1").stdout.split())


def test_corners_of_a_path_are_those_of_its_law() -> None:
    """Such as the jumps of acceleration of a point led along a line; of a table they are its times."""
    law = program(rise(5.0, over=2.0, law="parabolic"))
    line, table = LinePath((0j, 3 + 4j), law), place_table([0.0, 1.0, 3.0, 4.0], [0j, 1j, 2j, 4 + 1j])
    assert (
        derivative_jumps(PathCoordinate(line, "x"), 0.0, 2.0).tolist()
        == derivative_jumps(law, 0.0, 2.0).tolist()
        == [0.0, 1.0, 2.0]
    )
    assert derivative_jumps(PathCoordinate(table, "y"), 0.5, 4.0).tolist() == [1.0, 3.0, 4.0]
