"""Losses in teeth, belts and rolling wheels against closed forms; energy of simulations with them."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidMechanism
from compoundkin.files import dumps, loads

SI = {"length": "m", "mass": "kg", "force": "N"}


def train(pair: object, efficiency: float, *more: object) -> ck.Mechanism:
    """Two wheels on the frame, 1 m apart; the first is the driver."""
    return ck.Mechanism(
        "Train",
        ck.link("frame", A=0, B=1),
        ck.link("a", A=0, P=0.1),
        ck.link("b", B=0, Q=0.1),
        pair,
        ck.drive("a"),
        ck.mass("a", 1.0, at="A", inertia=0.05),
        ck.mass("b", 1.0, at="B", inertia=0.2),
        ck.friction("a/b", efficiency=efficiency),
        *more,
        units=SI,
    )


PAIRS = {
    "gear": (ck.gear("a", "b", teeth=(20, 50)), -0.4),
    "ring": (ck.gear("a", "b", teeth=(20, 50), internal=True), 0.4),
    "belt": (ck.belt("a", "b", radii=(0.1, 0.25)), 0.4),
    "crossed": (ck.belt("a", "b", radii=(0.1, 0.25), crossed=True), -0.4),
}


@pytest.mark.parametrize("kind", PAIRS)
@pytest.mark.parametrize("speed", [2.0, -2.0])
@pytest.mark.parametrize("load", [10.0, -10.0])
def test_what_is_lost_between_two_wheels(kind: str, speed: float, load: float) -> None:
    """The driver gives load over efficiency where it drives; where it is driven it holds less, by as much."""
    pair, ratio = PAIRS[kind]
    forces = ck.force_analysis(ck.solve(train(pair, 0.9, ck.torque("b", load)), {"a": [0.3]}, speed=speed))
    given = float(forces.drives["a"].effort[0]) * speed
    told = -load * ratio * speed
    assert given == pytest.approx(told / 0.9 if told > 0.0 else told / 1.1, rel=1e-12)
    # what is lost is that part of what the second wheel's teeth or belt have
    assert float(forces.friction.pairs["a/b"].power[0]) == pytest.approx(told - given, rel=1e-12)


def test_a_planetary_train_has_the_efficiency_of_its_fixed_carrier() -> None:
    """Sun drives, ring is the frame: out of the carrier comes (1 - i0 e) / (1 - i0), i0 = -zr / zs, of the input.

    Source: the basic efficiency of simple epicyclic trains, e.g. R. H. Macmillan, Power flow and loss in differential
    mechanisms, J. Mechanical Engineering Science 3 (1961) 37.
    """
    zs, zp, e = 20, 20, 0.97
    zr = zs + 2 * zp
    axle = 1.0
    mechanism = ck.Mechanism(
        "Planetary train",
        ck.link("frame", O=0),
        ck.link("sun", O=0, S=0.1),
        ck.link("arm", O=0, P=axle),
        ck.link("planet", P=0, Q=0.1),
        ck.gear("sun", "planet", carrier="arm", teeth=(zs, zp)),
        ck.gear("planet", "frame", carrier="arm", teeth=(zp, zr), internal=True),
        ck.drive("sun"),
        ck.torque("arm", -1.0),
        ck.friction("sun/planet", efficiency=e),
        units=SI,
    )
    forces = ck.force_analysis(ck.solve(mechanism, {"sun": [0.2]}, speed=3.0), inertia=False)
    i0 = -zr / zs
    carrier = 3.0 / (1.0 - i0)
    efficiency = carrier * 1.0 / (3.0 * float(forces.drives["sun"].effort[0]))
    assert efficiency == pytest.approx((1.0 - i0 * e) / (1.0 - i0), rel=1e-12)


def test_a_wheel_that_rolls_against_its_resistance() -> None:
    """A cart's wheel of radius r, pushed at its axle along a level line: coefficient times weight."""
    wheel = ck.Mechanism(
        "Wheel",
        ck.link("frame", O=0),
        ck.link("wheel", C=0, P=0.1),
        ck.roll("wheel", on="frame", through="O", at="C", radius=0.3, name="rolls"),
        ck.drive("wheel"),
        ck.mass("wheel", 4.0, at="C", inertia=0.1),
        ck.gravity(0, -9.81),
        ck.friction("rolls", 0.02),
        units=SI,
    )
    for speed in (1.0, -1.0):
        forces = ck.force_analysis(ck.solve(wheel, {"wheel": [0.1]}, speed=speed))
        assert float(forces.drives["wheel"].effort[0]) == pytest.approx(np.sign(speed) * 0.02 * 4.0 * 9.81, rel=1e-12)
    # let go at 1 m/s it comes to rest after m' v / (c m g) s, m' = m + J / r^2
    run = ck.simulate(wheel, start={"wheel": (0.0, 1.0)}, until=20.0)
    mass = 4.0 + 0.1 / 0.09
    stops = next(one for one in run.events if one.name == "sticks")
    assert stops.time == pytest.approx(mass / (0.02 * 4.0 * 9.81), rel=1e-6)
    assert run.energy.worst < 1e-9


def test_a_train_that_runs_down() -> None:
    """Inertia drives the first wheel back where the second has more of it: its loss brakes both."""
    run = ck.simulate(train(PAIRS["gear"][0], 0.9, ck.torque("b", 3.0)), start={"a": (0.0, 50.0)}, until=0.4)
    motion = run.motion.drives["a"]
    # torque on b drives a back: J q'' = ...; by the law of the losing mesh at both signs of its torque
    ja, jb, i, load = 0.05, 0.2, -0.4, 3.0
    speed = 50.0
    # teeth carry T = jb i q'' - load on the second wheel; q'' (ja + i jb i k) = i load k with k = 1 / 0.9 or 1 / 1.1
    rates = [i * load * k / (ja + i * i * jb * k) for k in (1.0 / 0.9, 1.0 / 1.1)]
    teeth = [jb * i * rate - load for rate in rates]
    k = next(n for n, t in enumerate(teeth) if (t * i * speed > 0.0) == (n == 0))
    assert motion.second[0] == pytest.approx(rates[k], rel=1e-9)
    assert run.energy.worst < 1e-9


def rack_and_pinion(*more: object) -> ck.Mechanism:
    """A pinion of radius 0.1 m above a bar of 2 kg that slides on the frame."""
    return ck.Mechanism(
        "Rack and pinion",
        ck.link("frame", O=0, Q=(0, -0.1)),
        ck.link("pinion", O=0),
        ck.link("bar", S=(0, 0)),
        ck.slide("bar", on="frame", at="S", through="Q", angle=0, name="guide"),
        ck.rack("bar", "pinion", through="S", at="O", radius=0.1, name="mesh"),
        ck.drive("pinion"),
        ck.mass("pinion", 1.0, at="O", inertia=0.02),
        ck.mass("bar", 2.0, at="S"),
        ck.friction("mesh", efficiency=0.9),
        *more,
        units=SI,
    )


@pytest.mark.parametrize("speed", [2.0, -2.0])
@pytest.mark.parametrize("load", [10.0, -10.0])
def test_a_rack_loses_a_part_of_its_moment_on_the_pinion(load: float, speed: float) -> None:
    """Steady motion: the load's torque and a tenth of it, which is lost whichever side drives."""
    motion = ck.solve(rack_and_pinion(ck.force("bar", (load, 0), at="S")), {"pinion": [0.3]}, speed=speed)
    forces = ck.force_analysis(motion)
    into = -load * float(np.ravel(motion.points["S"].velocity.xy)[0])  # what the driver would give without losses
    given = float(forces.drives["pinion"].effort[0]) * speed
    assert given == pytest.approx(into + 0.1 * abs(into), rel=1e-12)
    assert float(forces.friction.pairs["mesh"].power[0]) == pytest.approx(-0.1 * abs(into), rel=1e-12)
    assert ck.verify(forces).passed


def test_a_pinion_that_is_let_go_is_slowed_by_its_rack() -> None:
    """A constant force draws the bar from rest, with nine tenths of the rack's force on the pinion."""
    run = ck.simulate(rack_and_pinion(ck.force("bar", (10.0, 0), at="S")), start={"pinion": 0.0}, until=0.5)
    # 10 = 2 a + F, 0.9 F 0.1 = 0.02 a / 0.1
    acceleration = 10.0 / (2.0 + 0.02 / 0.1**2 / 0.9)
    assert abs(float(run.motion.points["S"].x[-1])) == pytest.approx(acceleration * 0.5**2 / 2.0, rel=1e-8)
    assert run.energy.worst < 1e-9


def test_files_there_and_back() -> None:
    one = train(PAIRS["gear"][0], 0.9)
    assert loads(dumps(one)).frictions["a/b"].efficiency == 0.9


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (ck.friction("a/b", 0.1), "efficiency: the losses of a gear pair are told by its efficiency"),
        (ck.friction("a/b", efficiency=1.2), "1.2 is no efficiency"),
        (ck.friction("a/b", efficiency=0.0), "0.0 is no efficiency"),
        (ck.friction("a/b", efficiency=0.9, radius=3), "radius: a gear pair has none"),
        (ck.friction("A", efficiency=0.9, radius=3), "efficiency: a revolute pair has a coefficient"),
        (ck.friction("A", radius=3), "coefficient: the coefficient of a revolute pair is missing"),
    ],
    ids=str,
)
def test_losses_that_mean_nothing_are_told(wrong: object, told: str) -> None:
    pair = ck.gear("a", "b", teeth=(20, 50))
    links = ck.link("frame", A=0, B=1), ck.link("a", A=0, P=0.1), ck.link("b", B=0, Q=0.1), pair, ck.drive("a")
    with pytest.raises(InvalidMechanism, match=told):
        ck.Mechanism("Train", *links, wrong, units=SI)
