"""Stops: rigid ends with restitution and rest, elastic ends, and the energy that they take."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, InvalidMechanism
from tests.dynamics.cases import SI

G, MASS = 9.81, 2.0
FIRST = np.sqrt(2.0 / G)


def shaft(*more: Any) -> ck.Mechanism:
    """A block of 2 kg that falls along a vertical guide; its end is 1 m below the start."""
    return ck.Mechanism(
        "Block in a shaft",
        ck.link("frame", O=(0, 0)),
        ck.link("block", P=(0, 0)),
        ck.slide("block", on="frame", at="P", through="O", angle=np.pi / 2, name="shaft"),
        ck.drive("block"),
        ck.mass("block", MASS, at="P", inertia=0.0),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def pendulum(*more: Any) -> ck.Mechanism:
    """A point mass of 1 kg on a bar of 1 m."""
    return ck.Mechanism(
        "Pendulum",
        ck.link("frame", A=0),
        ck.link("bar", A=0, B=1),
        ck.drive("bar"),
        ck.mass("bar", 1.0, at="B", inertia=0.0),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def double(*more: Any) -> ck.Mechanism:
    """Two point masses of 1 kg on bars of 1 m, the second hung to the first."""
    return ck.Mechanism(
        "Double pendulum",
        ck.link("frame", A=0),
        ck.link("upper", A=0, B=1),
        ck.link("lower", B=0, C=1),
        ck.drive("upper"),
        ck.drive("lower", on="upper"),
        ck.mass("upper", 1.0, at="B", inertia=0.0),
        ck.mass("lower", 1.0, at="C", inertia=0.0),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def test_a_mass_that_bounces() -> None:
    """Times and heights are geometric series; in the end it has lost its whole height, and rests."""
    e = 0.5
    found = ck.simulate(shaft(ck.stop("shaft", low=-1.0, restitution=e)), start=0.0, until=3.0)
    series = [FIRST + 2.0 * FIRST * sum(e**k for k in range(1, n + 1)) for n in range(len(found.events))]
    np.testing.assert_allclose([event.time for event in found.events], series, rtol=1e-9)
    lost = [MASS * G * (1.0 - e * e) * e ** (2 * n) for n in range(6)]
    np.testing.assert_allclose([event.lost for event in found.events[:6]], lost, rtol=1e-9)
    assert [event.name for event in found.events] == ["stop"] * (len(series) - 1) + ["rests"]
    assert found.losses["stop along shaft"] == pytest.approx(MASS * G, rel=1e-11)
    assert found.energy.worst < 1e-9
    rest = found.times > 3.0 * FIRST
    np.testing.assert_allclose(found.motion.points["P"].y[rest], -1.0, atol=1e-12)
    second = found.motion.points["P"].y[(found.times > series[0]) & (found.times < series[1])].max()
    assert second == pytest.approx(-1.0 + e * e, abs=1e-3)


def test_a_mass_rests_until_it_is_lifted() -> None:
    """A force that grows in time lifts it where it is the weight; from there on it is a cubic of the time."""
    lift = ck.force("block", (0, lambda t: 6.0 * MASS * G * t), at="P")
    found = ck.simulate(shaft(ck.stop("shaft", low=-1.0), lift), start=-1.0, until=1.0)
    assert [event.name for event in found.events] == ["rests", "leaves"]
    assert found.events[1].time == pytest.approx(1.0 / 6.0, abs=1e-9)
    after = found.times > 1.0 / 6.0
    grown = -1.0 + G * (found.times[after] - 1.0 / 6.0) ** 3
    np.testing.assert_allclose(found.motion.points["P"].y[after], grown, atol=1e-9)
    assert not np.any(found.motion.drives["block"].second[found.times < 1.0 / 6.0])


def test_an_elastic_end_gives_back_what_it_has() -> None:
    """Within the end it swings harmonically about its rest; it is left with the speed of the approach."""
    k = 2000.0
    found = ck.simulate(shaft(ck.stop("shaft", low=-1.0, stiffness=k)), start=0.0, until=1.0)
    pace, rest, speed = np.sqrt(k / MASS), MASS * G / k, np.sqrt(2.0 * G)
    contact = 2.0 / pace * (np.pi - np.arctan2(speed / pace, rest))
    assert [event.time for event in found.events] == pytest.approx([FIRST, FIRST + contact], rel=1e-9)
    within = (found.times > FIRST) & (found.times < FIRST + contact)
    since = pace * (found.times[within] - FIRST)
    depth = rest + speed / pace * np.sin(since) - rest * np.cos(since)
    np.testing.assert_allclose(found.motion.points["P"].y[within], -1.0 - depth, atol=1e-9)
    assert found.energy.worst < 1e-9
    assert found.losses == {"stop along shaft": 0.0}


def test_an_elastic_end_with_damping_does_not_pull() -> None:
    """Its force is never below zero, and it takes in the end all but the energy of its rest."""
    k, c = 2000.0, 20.0
    stop = ck.stop("shaft", low=-1.0, stiffness=k, damping=c)
    found = ck.simulate(shaft(stop), start=0.0, until=8.0)
    sunk = MASS * G / k
    assert found.losses[stop.name] == pytest.approx(MASS * G * (1.0 + sunk) - k * sunk * sunk / 2.0, rel=1e-9)
    assert found.energy.worst < 1e-9
    acceleration = found.motion.drives["block"].second
    assert acceleration.min() > -G * (1.0 + 1e-9)
    first = found.events[1].time - found.events[0].time
    half = c / (2.0 * MASS)
    pace = np.sqrt(k / MASS - half * half)
    # x'' + 2 half x' + k/m x = g from x = 0 with the speed of the fall, up to where k x + c x' = 0
    v, x0 = np.sqrt(2.0 * G), sunk
    t = np.linspace(0.5 * first, 1.5 * first, 200001)
    b = (v - half * x0) / pace
    swing = np.exp(-half * t) * (-x0 * np.cos(pace * t) + b * np.sin(pace * t))
    rate = np.exp(-half * t) * ((half * x0 + pace * b) * np.cos(pace * t) + (pace * x0 - half * b) * np.sin(pace * t))
    force = k * (swing + x0) + c * rate
    assert first == pytest.approx(t[np.argmax(force < 0.0)], rel=1e-5)


def test_turns_are_counted_at_a_stop_of_a_pin() -> None:
    """A pendulum goes over the top twice before it meets a stop; there it has the speed of its height."""
    found = ck.simulate(pendulum(ck.stop("A", high=ck.deg(800), restitution=0.7)), start=(0.0, 9.0), until=3.0)
    hit = found.events[0]
    assert [event.name for event in found.events] == ["stop"]
    speed = np.sqrt(81.0 - 2.0 * G * np.sin(ck.deg(800)))
    assert hit.lost == pytest.approx((1.0 - 0.49) * speed**2 / 2.0, rel=1e-9)
    assert found.motion.drives["bar"].rate[np.searchsorted(found.times, hit.time)] < 0.0
    assert found.energy.worst < 1e-9


def double_rates(t: float, y: Any) -> Any:
    """Return the rates of both angles of a double pendulum, from the frame, by Lagrange's equations."""
    a, b, u, v = y
    matrix = np.array([[2.0, np.cos(a - b)], [np.cos(a - b), 1.0]])
    bias = np.sin(a - b) * np.array([v * v, -u * u])
    return np.array([u, v, *np.linalg.solve(matrix, -bias - G * np.array([2.0 * np.cos(a), np.cos(b)]))])


def straight_rates(t: float, y: Any) -> Any:
    """Return the rates where both bars are one, as a pendulum with masses at 1 and 2 m."""
    second = -G * (1.0 + 2.0) * np.cos(y[0]) / (1.0 + 4.0)
    return np.array([y[2], y[2], second, second])


def pushed_apart(t: float, y: Any) -> float:
    """Return the acceleration of the knee without its stop."""
    _, _, first, second = double_rates(t, y)
    return float(second - first)


def knee(t: float, y: Any) -> float:
    return float(y[1] - y[0])


def course_with_a_stop(y: Any, until: float, e: float) -> tuple[list[float], list[str], Any]:
    """Return times and kinds of events of a double pendulum whose knee does not bend back, and the last state."""
    from scipy.integrate import solve_ivp

    t, times, kinds, rests = 0.0, list[float](), list[str](), False
    while True:
        watch: Callable[[float, Any], float] = pushed_apart if rests else knee
        watch.terminal, watch.direction = True, 1.0 if rests else -1.0  # type: ignore[attr-defined]
        rates = straight_rates if rests else double_rates
        found = solve_ivp(rates, (t, until), y, method="DOP853", rtol=1e-12, atol=1e-13, events=watch)
        y = found.y[:, -1]
        if not found.t_events[0].size:
            return times, kinds, y
        t = float(found.t_events[0][0])
        times.append(t)
        if rests:
            kinds.append("leaves")
            rests = False
            continue
        matrix, n = np.array([[2.0, np.cos(y[0] - y[1])], [np.cos(y[0] - y[1]), 1.0]]), np.array([-1.0, 1.0])
        push = np.linalg.solve(matrix, n)
        y[2:] -= (1.0 + e) * (n @ y[2:]) / (n @ push) * push
        y[1] = max(y[1], y[0])
        rests = e == 0.0 and pushed_apart(t, y) < 0.0
        kinds.append("rests" if rests else "stop")


def test_a_knee_against_another_integrator() -> None:
    """A double pendulum whose knee hits, rests against its stop and leaves it: hand-written equations and SciPy."""
    stop = ck.stop("B", low=0.0, restitution=0.0)
    found = ck.simulate(double(stop), start={"upper": -1.0, "lower": 1.0}, until=3.0)
    times, kinds, last = course_with_a_stop(np.array([-1.0, 0.0, 0.0, 0.0]), 3.0, 0.0)
    assert [event.name for event in found.events] == kinds
    assert {"rests", "leaves"} <= set(kinds)
    np.testing.assert_allclose([event.time for event in found.events], times, atol=1e-7)
    upper, lower = found.motion.drives["upper"], found.motion.drives["lower"]
    at_end = [upper.value[-1], upper.value[-1] + lower.value[-1], upper.rate[-1], upper.rate[-1] + lower.rate[-1]]
    np.testing.assert_allclose(at_end, last, atol=1e-6)
    assert found.energy.worst < 1e-9
    held = (found.times > times[kinds.index("rests")]) & (found.times < times[kinds.index("leaves")])
    np.testing.assert_allclose(lower.value[held], 0.0, atol=1e-10)


def test_a_knee_that_bounces_against_another_integrator() -> None:
    """The first six impacts, by hand-written equations."""
    found = ck.simulate(double(ck.stop("B", low=0.0, restitution=0.5)), start={"upper": -1.0, "lower": 1.0}, until=1.5)
    times, _, _ = course_with_a_stop(np.array([-1.0, 0.0, 0.0, 0.0]), 1.5, 0.5)
    np.testing.assert_allclose([event.time for event in found.events], times, atol=1e-7)
    assert len(times) >= 3
    assert found.energy.worst < 1e-9


def test_two_stops_and_a_limit_position() -> None:
    """A slider-crank between a stop of the piston and one of the crank: what is lost is the energy of the start."""
    linkage = ck.Mechanism(
        "Slider-crank",
        ck.link("frame", O=(0, 0)),
        ck.link("crank", O=(0, 0), A=(0.1, 0)),
        ck.link("rod", A=(0, 0), B=(0.35, 0)),
        ck.link("piston", B=(0, 0)),
        ck.slide("piston", on="frame", at="B", through="O", angle=ck.deg(90), name="guide"),
        ck.drawn(O=(0, 0), A=(0.1, 0), B=(0, 0.335)),
        ck.drive("crank"),
        ck.mass("crank", 3, at=(0.02, 0), inertia=0.02),
        ck.mass("rod", 1, at=(0.15, 0), inertia=0.012),
        ck.mass("piston", 2),
        ck.gravity(0, -G),
        ck.stop("guide", low=0.26, restitution=0.3, name="bottom"),
        ck.stop("crank", high=ck.deg(95), stiffness=500.0, damping=2.0, name="bumper"),
        units=SI,
    )
    found = ck.simulate(linkage, start={"crank": (ck.deg(60), 6.0)}, until=3.0)
    assert found.motion.points["B"].y.min() > 0.26 - 1e-9
    assert set(found.losses) == {"bottom", "bumper"}
    assert found.energy.worst < 1e-9
    assert found.energy.work[-1] == pytest.approx(-sum(found.losses.values()), rel=1e-8)
    for before, after in pairwise(found.events):
        assert before.time <= after.time


def test_a_block_with_friction_bounces() -> None:
    """Down an incline, against its stop, up and down again: each way has an acceleration of its own."""
    incline = ck.Mechanism(
        "Block on an incline",
        ck.link("frame", O=(0, 0)),
        ck.link("block", P=(0, 0)),
        ck.slide("block", on="frame", at="P", through="O", angle=ck.deg(-30), name="way"),
        ck.drive("block"),
        ck.mass("block", MASS, at="P", inertia=0),
        ck.gravity(0, -G),
        ck.friction("way", 0.2),
        ck.stop("way", high=1.0, restitution=0.5),
        units=SI,
    )
    found = ck.simulate(incline, start=0.0, until=1.3)
    down, up = (G * (0.5 + sense * 0.2 * np.cos(np.pi / 6)) for sense in (-1.0, 1.0))
    first = np.sqrt(2.0 / down)
    back = 0.5 * down * first
    second = first + back / up + back / np.sqrt(up * down)
    assert [event.time for event in found.events if event.name == "stop"] == pytest.approx([first, second], rel=1e-9)
    assert found.energy.worst < 1e-9


def test_stops_that_cannot_be() -> None:
    """Each is named, all at once; a start beyond a rigid stop is none."""
    wrong = (
        ck.stop("shaft", low=1.0, high=0.5, restitution=1.5),
        ck.stop("shfat", low=0.0, damping=3.0, name="b"),
        ck.stop("shaft", name="c"),
        ck.stop("shaft", low=0.0, stiffness=-1.0, damping=-2.0, restitution=0.1, name="d"),
    )
    with pytest.raises(InvalidMechanism) as refused:
        shaft(*wrong)
    places = [problem.where for problem in refused.value.problems]
    assert places == [
        "stops[0].low",
        "stops[0].restitution",
        "stops[1].pair",
        "stops[1].damping",
        "stops[2]",
        "stops[3].restitution",
        "stops[3].stiffness",
        "stops[3].damping",
    ]
    with pytest.raises(InvalidMechanism, match=r"stops\[0\]\.high: both ends are at 1: nothing moves"):
        shaft(ck.stop("shaft", low=1.0, high=1.0))
    with pytest.raises(InvalidInput, match=r"0\.2 beyond stop along shaft"):
        ck.simulate(shaft(ck.stop("shaft", low=-1.0)), start=-1.2, until=1.0)


def test_an_analysis_of_forces_says_what_holds_in_simulations_alone() -> None:
    """A driver takes a pin 270 degrees beyond its rigid stop, an elastic one pushes; and a latch does not hold."""
    arm = ck.Mechanism(
        "Arm", ck.link("frame", O=0), ck.link("arm", O=0, P=1), ck.drive("arm"), ck.mass("arm", 1.0, at="P", inertia=0),
        ck.stop("arm", high=np.pi / 2, name="wall"), ck.stop("arm", high=np.pi / 2, stiffness=5.0, name="buffer"),
        ck.stop("arm", low=0.0, name="floor"), ck.latch("arm", 1.0, name="hook"),
        units={"length": "m", "mass": "kg", "force": "N"},
    )  # fmt: skip
    text = " ".join(ck.force_analysis(ck.solve(arm, np.deg2rad([0.0, 90.0, 360.0]), speed=1.0)).text().split())
    assert "wall is passed by up to 270°: a rigid stop holds in simulations alone" in text
    assert "nothing held by hook" in text
    assert "buffer is passed" not in text
    assert "floor is passed" not in text
    swung = ck.simulate(arm, start={"arm": (1.2, 2.0)}, until=1.0)
    assert "its high end 90°" in " ".join(swung.text().split())


def test_an_impact_at_the_start() -> None:
    """A start at the stop and into it: the first speed is that of the rebound."""
    found = ck.simulate(shaft(ck.stop("shaft", low=-1.0, restitution=0.5)), start=(-1.0, -2.0), until=0.1)
    assert found.motion.drives["block"].rate[0] == pytest.approx(1.0, rel=1e-12)
    assert found.events[0].lost == pytest.approx(3.0, rel=1e-12)
    assert found.energy.worst < 1e-9
