"""Noncircular gears: closed forms, the power of the shaft anew in time, pitch curves that roll on each other."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput

SI = {"length": "m", "mass": "kg", "force": "N"}
TURN = 2.0 * np.pi


def arm(*items: object) -> ck.Mechanism:
    return ck.Mechanism("Arm", ck.link("frame", A=0), ck.link("arm", A=0, B=1), ck.drive("arm"), *items, units=SI)


def turning(mechanism: ck.Mechanism, speed: float = 3.0, **more: object) -> object:
    values = np.linspace(0.0, np.copysign(TURN, speed), 73)
    return ck.force_analysis(ck.solve(mechanism, values, speed=speed), **more)


@cache
def crusher() -> object:
    return ck.figures.noncircular_drive(ck.force_analysis(ck.solve(ck.load("jaw-crusher-loaded"))))


@pytest.mark.parametrize("speed", [3.0, -3.0])
def test_without_inertia_the_ratio_is_the_mean_torque_over_the_one_needed(speed: float) -> None:
    load = ck.effort("arm", lambda q: -np.sign(speed) * (2.0 + np.cos(q)))
    found = ck.figures.noncircular_drive(turning(arm(load), speed))
    assert found.torque == pytest.approx(2.0, rel=1e-8)
    np.testing.assert_allclose(found.ratio, 2.0 / (2.0 + np.cos(found.values)), rtol=1e-6)
    # 2 q + sin q = 2 angle
    way = np.abs(found.values)
    np.testing.assert_allclose(2.0 * way + np.sin(way), 2.0 * found.angles, atol=1e-7)


def test_inertia_helps_where_the_torque_changes_its_sense() -> None:
    """Half of J w^2 and the work of the loads and the shaft are the same at all angles: energy, by the law alone."""
    load = ck.effort("arm", lambda q: -2.0 - 3.0 * np.cos(q))
    found = ck.figures.noncircular_drive(turning(arm(load, ck.mass("arm", 1.0, at="A", inertia=0.5))))
    rates = found.ratio * found.speed
    energy = 0.25 * rates**2 + 2.0 * found.values + 3.0 * np.sin(found.values) - 2.0 * found.angles
    # loads are read between 720 places without overshoot, to the square of their distance at extremes
    assert np.ptp(energy) < 1e-6
    assert found.unevenness < 1e-8
    assert float(np.min(found.before)) == pytest.approx(-1.0, rel=1e-6)


def test_loads_that_depend_on_speeds() -> None:
    """A damper alone needs a torque that grows with the ratio: the even law is the even speed."""
    found = ck.figures.noncircular_drive(turning(arm(ck.damper(pair="A", rate=0.5))))
    np.testing.assert_allclose(found.ratio, 1.0, atol=1e-9)
    both = arm(ck.damper(pair="A", rate=0.5), ck.effort("arm", lambda q: -2.0 - np.cos(q)))
    assert ck.figures.noncircular_drive(turning(both)).unevenness < 1e-6


def test_the_power_of_the_shaft_is_even_between_the_angles_too() -> None:
    """The machine driven by the law, in time: effort times speed of the crank, at times of no table."""
    found = crusher()
    times = np.linspace(0.0, TURN / found.speed, 100)[1:-1]
    motion = ck.solve(found.mechanism, time=times)
    crank = motion.drives["eccentric"]
    power = np.asarray(ck.force_analysis(motion).drives["eccentric"].effort) * crank.rate
    # but for the place where the load jumps on, which lies between two angles of the table
    np.testing.assert_allclose(power, found.torque * found.speed, rtol=1e-4)
    assert np.median(np.abs(power / (found.torque * found.speed) - 1.0)) < 1e-6
    assert np.max(np.abs(found.before)) > 3.0 * found.torque


def test_pitch_curves_touch_on_the_line_of_axes_and_roll() -> None:
    found = crusher()
    one, two = found.pitch_curves(300.0)
    np.testing.assert_allclose(np.abs(one) + np.abs(two), 300.0)
    # turned by the shaft and by the driver, against each other, both points lie on the line of axes
    np.testing.assert_allclose(one * np.exp(1j * found.angles), np.abs(one), atol=1e-9)
    turned = two * np.exp(-1j * (found.values - found.values[0]))
    np.testing.assert_allclose(turned + 300.0, np.abs(one), atol=1e-9)
    lengths = [np.sum(np.abs(np.diff(curve))) for curve in (one, two)]
    assert lengths[0] == pytest.approx(lengths[1], rel=1e-4)
    with pytest.raises(InvalidInput, match="no distance of axes"):
        found.pitch_curves(0.0)


def test_text_tells_torques_in_newton_metres() -> None:
    assert "torque of the shaft" in crusher().text()
    assert "N m" in crusher().text()


def test_what_has_no_such_gears_is_told() -> None:
    swings = ck.effort("arm", lambda q: -2.0 - 3.0 * np.cos(q))
    heavy = ck.mass("arm", 1.0, at="A", inertia=0.5)
    machine, light = arm(swings, heavy), arm(swings, ck.mass("arm", 1e-12, at="B", inertia=1e-12))

    def over(values: object, speed: float = 3.0) -> object:
        return ck.force_analysis(ck.solve(machine, values, speed=speed))

    wrong = {
        "one sense throughout": turning(arm(swings)),
        "no work over the cycle": turning(arm(ck.effort("arm", lambda q: 2.0 + np.cos(q)), heavy)),
        "too small against the loads": turning(light),
        "closed cycle": over(np.linspace(0.0, 3.0, 20)),
        "does not turn once": over(np.linspace(0.0, 2.0 * TURN, 90)),
        "in the sense of its values": over(np.linspace(0.0, TURN, 90), -3.0),
    }
    for said, forces in wrong.items():
        with pytest.raises(InvalidInput, match=said):
            ck.figures.noncircular_drive(forces)
