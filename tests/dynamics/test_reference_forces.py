"""Independently computed forces, mechanism by mechanism: `tests/reference/forces.json`."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from tests.dynamics.cases import CASES, arm, misfits, planetary_train, toggle_press
from tests.support import reference


@pytest.mark.parametrize("name", CASES)
def test_driver_pairs_and_frame(name: str) -> None:
    """Driver effort, force and moment of every pair, force and moment on the frame, to 1e-9."""
    assert misfits(CASES[name]()) == []


def test_pin_of_three_links() -> None:
    """The force of the pin on each of its links."""
    case = toggle_press()
    pin = case.forces.pins["B"]
    for pose, row in enumerate(case.rows):
        for link, force in row["pin_B_on"].items():
            assert abs(pin.on(link).force[pose] - complex(*force)) < 1e-9 * abs(complex(*force))


def test_spring_that_balances_an_arm() -> None:
    """A spring without free length takes all the torque in every position."""
    stiffness = reference("spring_balanced_arm", "forces")["dimensions"]["balance_stiffness"]
    case = arm(ck.spring("arm", "A", at="S", stiffness=stiffness))
    assert np.max(np.abs(case.forces.drives["arm"].effort)) < 1e-13 * stiffness
    assert ck.verify(case.forces).passed
    # so that its energy and that of the weight have one sum
    assert np.ptp(case.forces.power.potential) < 1e-13 * stiffness


def test_spring_and_damper() -> None:
    own = reference("spring_balanced_arm", "forces")["dimensions"]
    spring = ck.spring("arm", "A", at="S", stiffness=own["stiffness"], free_length=own["free_length"])
    damper = ck.damper("arm", "A", at="S", rate=own["damping"])
    case = arm(spring, damper, speed=own["speed"], acceleration=own["acceleration"])
    for pose, row in enumerate(case.rows):
        expected = row["spring_and_damper"]
        assert abs(case.forces.drives["arm"].effort[pose] / expected["driver"] - 1.0) < 1e-12
        force = complex(*expected["pin"]["force"])
        assert abs(case.forces.pairs["O"].on("arm").force[pose] - force) < 1e-12 * abs(force)
        # what each takes is its pull times the rate of its length
        rate, power = expected["spring_length_rate"], case.forces.power.loads
        assert abs(power["spring on arm"][pose] + expected["spring_tension"] * rate) < 1e-9
        assert abs(power["damper on arm"][pose] + expected["damper_tension"] * rate) < 1e-9


@pytest.mark.parametrize("number", range(4))
def test_planetary_train(number: int) -> None:
    """Tooth forces at the pitch points, the planet's pin, the driver; the flank changes with the load."""
    row = reference("planetary_train_torques", "forces")["expected"]["rows"][number]
    forces = planetary_train(row).forces
    assert abs(forces.drives["arm"].effort[0] - row["driver_torque_on_arm"]) < 1e-12 * abs(row["driver_torque_on_arm"])
    for name, key in (("sun gear", "sun"), ("ring", "ring")):
        force = complex(*row[f"tooth_force_on_planet_from_{key}"]["force"])
        assert abs(forces.pairs[name].on("planet").force[0] - force) < 1e-12 * abs(force)
    pin = complex(*row["planet_pin"]["force"])
    assert abs(forces.pairs["P"].on("planet").force[0] - pin) < 1e-12 * abs(pin)
    assert ck.verify(forces).passed
