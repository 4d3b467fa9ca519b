"""Latches: release of a spring, capture, detents, ratchets, and a clamp that snaps over its centre."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, InvalidMechanism
from compoundkin.files import dumps, loads
from tests.dynamics.cases import SI


def rail(*more: Any) -> ck.Mechanism:
    """A cart of 2 kg on a rail."""
    return ck.Mechanism(
        "Cart",
        ck.link("frame", O=(0, 0)),
        ck.link("cart", P=(0, 0)),
        ck.slide("cart", on="frame", at="P", through="O", angle=0.0, name="rail"),
        ck.drive("cart"),
        ck.mass("cart", 2.0, at="P", inertia=0.0),
        *more,
        units=SI,
    )


def train(*more: Any) -> ck.Mechanism:
    """A cart of 2 kg and one of 3 kg, whose coordinate is its distance from the first."""
    return ck.Mechanism(
        "Two carts",
        ck.link("frame", O=(0, 0)),
        ck.link("one", P=(0, 0)),
        ck.link("two", Q=(0, 0)),
        ck.slide("one", on="frame", at="P", through="O", angle=0.0, name="rail"),
        ck.slide("two", on="one", at="Q", through="P", angle=0.0, name="gap"),
        ck.drive("one"),
        ck.drive("two", on="one"),
        ck.mass("one", 2.0, at="P", inertia=0.0),
        ck.mass("two", 3.0, at="Q", inertia=0.0),
        *more,
        units=SI,
    )


def test_a_spring_is_released() -> None:
    """It rests until its time, and swings as a cosine from there on; the latch has held the force of the spring."""
    held = rail(ck.spring(pair="rail", stiffness=800.0), ck.latch("rail", until=0.25))
    found = ck.simulate(held, start=-0.1, until=1.0)
    t = found.times
    x = np.where(t < 0.25, -0.1, -0.1 * np.cos(20.0 * (t - 0.25)))
    np.testing.assert_allclose(found.motion.points["P"].x, x, atol=1e-9)
    assert [(event.name, event.time) for event in found.events] == [("opens", pytest.approx(0.25, abs=1e-12))]
    hold = found.motion.mechanism.loads["hold of latch along rail"]
    np.testing.assert_allclose(hold.amount[t < 0.25], -80.0, rtol=1e-12)
    assert not np.any(hold.amount[t > 0.25])
    assert np.max(np.abs(found.forces.drives["cart"].effort)) < 1e-9
    assert found.energy.worst < 1e-9
    assert found.losses == {}


def test_a_capture_keeps_the_momentum() -> None:
    """Two carts that lock at a distance go on with their common momentum; the reduced mass tells what is lost."""
    found = ck.simulate(train(ck.latch("gap", at=0.5)), start={"one": (0.0, 1.0), "two": (1.5, -5.0)}, until=1.0)
    event = found.events[0]
    assert (event.name, event.time) == ("catches", pytest.approx(0.2, rel=1e-12))
    common = (2.0 * 1.0 + 3.0 * -4.0) / 5.0
    assert found.motion.drives["one"].rate[-1] == pytest.approx(common, rel=1e-12)
    np.testing.assert_allclose(found.motion.drives["two"].value[found.times >= 0.2], 0.5, atol=1e-12)
    assert found.losses["latch along gap"] == pytest.approx(2.0 * 3.0 / 5.0 * 5.0**2 / 2.0, rel=1e-12)
    assert found.energy.worst < 1e-9


def test_a_clutch_is_closed_and_opened() -> None:
    """Two flywheels turn as one between two times: momentum, what is lost, and a torque that both share."""
    wheels = ck.Mechanism(
        "Flywheels with a clutch",
        ck.link("frame", O=0),
        ck.link("driving", O=0, P=1),
        ck.link("driven", O=0, Q=1),
        ck.drive("driving"),
        ck.drive("driven"),
        ck.mass("driving", 1.0, at="O", inertia=0.3),
        ck.mass("driven", 1.0, at="O", inertia=0.2),
        ck.torque("driving", 1.5),
        ck.latch("O(driving-driven)", since=0.4, until=1.0, name="clutch"),
        units=SI,
    )
    found = ck.simulate(wheels, start={"driving": (0.0, 20.0)}, until=1.5)
    assert [(event.name, event.time) for event in found.events] == [
        ("catches", pytest.approx(0.4, abs=1e-12)),
        ("opens", pytest.approx(1.0, abs=1e-12)),
    ]
    slip = 20.0 + 5.0 * 0.4
    common = 0.3 * slip / 0.5 + 3.0 * 0.6
    assert found.motion.drives["driven"].rate[-1] == pytest.approx(common, rel=1e-9)
    assert found.motion.drives["driving"].rate[-1] == pytest.approx(common + 5.0 * 0.5, rel=1e-9)
    assert found.losses["clutch"] == pytest.approx(0.3 * 0.2 / 0.5 * slip**2 / 2.0, rel=1e-9)
    assert found.energy.worst < 1e-9
    # the driven flywheel is turned by the clutch alone
    hold = found.motion.mechanism.loads["hold of clutch"].amount
    within = (found.times > 0.45) & (found.times < 0.95)
    np.testing.assert_allclose(np.abs(hold[within]), 0.2 * 3.0, rtol=1e-9)


def test_a_detent_opens_where_its_force_is_too_great() -> None:
    """Two fifths of what pulls the second cart pass through it: 30 N of 75 N."""
    pull = ck.force("two", (lambda t: 60.0 * t, 0), at="Q")
    found = ck.simulate(train(ck.latch("gap", strength=30.0), pull), until=2.0)
    assert [event.name for event in found.events] == ["opens"]
    assert found.events[0].time == pytest.approx(1.25, abs=1e-9)
    # what has come apart is pulled by 60 t / 3 from there on, the first cart rolls on
    speed = 60.0 * 1.25**2 / 2.0 / 5.0
    assert found.motion.drives["one"].rate[-1] == pytest.approx(speed, rel=1e-9)
    assert found.motion.drives["two"].rate[-1] == pytest.approx(10.0 * (4.0 - 1.25**2), rel=1e-9)


def test_a_latch_opens_at_a_coordinate_of_another_pair() -> None:
    """The second cart is let go where the first has gone 2 m."""
    found = ck.simulate(train(ck.latch("gap", over="rail", value=2.0)), start={"one": (0.0, 4.0)}, until=1.0)
    assert [event.name for event in found.events] == ["opens"]
    assert found.events[0].time == pytest.approx(0.5, rel=1e-12)


def test_a_ratchet_holds_at_its_last_tooth() -> None:
    """The spring takes the cart from -0.1 to 0.1; it falls back to the tooth at 0.08, and loses what it had above."""
    found = ck.simulate(
        rail(ck.spring(pair="rail", stiffness=800.0), ck.latch("rail", teeth=0.03)), start=-0.1, until=1
    )
    assert [event.name for event in found.events] == ["tooth"] * 6 + ["rests"]
    turn = np.pi / 20.0
    assert found.events[-1].time == pytest.approx(turn + np.arccos(0.8) / 20.0, rel=1e-9)
    assert found.motion.points["P"].x[-1] == pytest.approx(0.08, abs=1e-10)
    assert found.losses["latch along rail"] == pytest.approx(400.0 * (0.1**2 - 0.08**2), rel=1e-8)
    assert found.energy.worst < 1e-9


def test_an_over_centre_clamp_snaps_through() -> None:
    """Released above its dead centre it goes through, against a stop: hand-written equation and SciPy."""
    from scipy.integrate import solve_ivp

    r, rod, inertia, mass, k, torque = 0.05, 0.12, 2e-3, 0.8, 4e3, -6.0
    begin, end, start = 0.35, -0.4, 0.1
    clamp = ck.Mechanism(
        "Over-centre clamp",
        ck.link("frame", O=(0, 0)),
        ck.link("lever", O=(0, 0), A=(r, 0)),
        ck.link("rod", A=(0, 0), B=(rod, 0)),
        ck.link("jaw", B=(0, 0)),
        ck.slide("jaw", on="frame", at="B", through="O", angle=0.0, name="guide"),
        ck.drawn(O=(0, 0), A=(r * np.cos(begin), r * np.sin(begin)), B=(0.16, 0)),
        ck.drive("lever"),
        ck.mass("lever", 0.1, at="O", inertia=inertia),
        ck.mass("jaw", mass, at="B", inertia=0.0),
        ck.spring(pair="guide", stiffness=k, free=0.16),
        ck.torque("lever", torque),
        ck.latch("lever", until=start, name="catch"),
        ck.stop("lever", low=end, name="anvil"),
        units=SI,
    )
    found = ck.simulate(clamp, start=begin, until=0.3, tolerance=1e-12)

    def rates(t: float, y: Any) -> Any:
        q, w = y
        s, c = r * np.sin(q), r * np.cos(q)
        root = np.sqrt(rod**2 - s**2)
        x, first = c + root, -s - s * c / root
        second = -c - (c * c - s * s) / root - (s * c) ** 2 / root**3
        return [w, (torque - k * (x - 0.16) * first - mass * first * second * w * w) / (inertia + mass * first**2)]

    def hits(t: float, y: Any) -> float:
        return float(y[0]) - end

    hits.terminal = True  # type: ignore[attr-defined]
    times = found.times[found.times > start]
    own = solve_ivp(rates, (start, 1.0), [begin, 0.0], "DOP853", rtol=1e-12, atol=1e-13, events=hits, dense_output=True)
    hit = float(own.t_events[0][0])
    assert [event.name for event in found.events] == ["opens", "rests"]
    assert found.events[1].time == pytest.approx(hit, abs=1e-9)
    moving = times[times < hit]
    assert len(moving) > 5
    lever = found.motion.drives["lever"]
    np.testing.assert_allclose(lever.value[np.isin(found.times, moving)], own.sol(moving)[0], atol=1e-7)
    assert np.max(lever.value) == pytest.approx(begin, abs=1e-12)
    assert lever.value[-1] == pytest.approx(end, abs=1e-9)
    assert found.energy.worst < 1e-9
    assert np.max(np.abs(found.forces.drives["lever"].effort)) < 1e-6


def test_latches_that_cannot_be_and_one_that_never_meets() -> None:
    """Each is named; one that has not caught says so at the end."""
    wrong = (
        ck.latch("rial", over="crank", name="a"),
        ck.latch("rail", teeth=0.0, strength=-1.0, until=-1.0, name="b"),
    )
    with pytest.raises(InvalidMechanism) as refused:
        rail(*wrong)
    assert [problem.where for problem in refused.value.problems] == [
        "latches[0].pair",
        "latches[0].over",
        "latches[0].over",
        "latches[1].strength",
        "latches[1].until",
        "latches[1].teeth",
        "latches[1].teeth",
    ]
    with pytest.raises(InvalidInput, match="holds rail, which starts with the speed 1"):
        ck.simulate(rail(ck.latch("rail")), start=(0.0, 1.0), until=1.0)
    found = ck.simulate(rail(ck.latch("rail", at=0.3)), start=(0.0, 0.1), until=1.0)
    assert [(event.name, event.time) for event in found.events] == [("idle", 1.0)]
    assert "has not caught" in found.events[0].text


def test_latches_in_files() -> None:
    """Coordinates of angles are in degrees, also that of the other pair."""
    arm = ck.Mechanism(
        "Arm",
        ck.link("frame", O=0),
        ck.link("arm", O=0, P=1),
        ck.link("block", Q=0),
        ck.slide("block", on="arm", at="Q", through="O", toward="P", name="way"),
        ck.drive("arm"),
        ck.drive("block", on="arm"),
        ck.latch("way", at=0.5, over="arm", value=ck.deg(120)),
        ck.latch("O", at=ck.deg(90), until=2.0, strength=3.0),
        units=SI,
    )
    assert loads(dumps(arm)) == arm
    assert "value = 120" in dumps(arm)
    assert "at = 90" in dumps(arm)
