"""Efforts by virtual work, powers and energies."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dynamics.reactions.virtual_work import virtual_efforts
from tests.dynamics.cases import CASES, SI, engine, six_bar
from tests.support import reference


@pytest.mark.parametrize("name", CASES)
def test_efforts_by_virtual_work(name: str) -> None:
    """They are those of the reference, without a single reaction."""
    case = CASES[name]()
    ((_, found),) = virtual_efforts(case.motion, case.inertia).items()
    expected = np.array([row["driver"] for row in case.rows])
    assert np.all(np.abs(found[0] - expected) < 1e-9 * np.max(np.abs(expected)))


@pytest.mark.parametrize("name", CASES)
def test_the_powers_of_all_that_acts_come_to_nothing(name: str) -> None:
    power = CASES[name]().forces.power
    greatest = max(np.max(np.abs(part)) for part in (*power.drives.values(), *power.loads.values(), power.gravity))
    assert np.max(np.abs(power.sum)) <= 1e-12 * greatest
    assert np.max(np.abs(power.friction)) <= 1e-12 * greatest


def test_energies_change_by_the_powers() -> None:
    """Differences of energies in time; a spring's with them, and the damper's not."""
    mechanism = six_bar("dynamic", True).mechanism.replace(
        ck.spring("plate", "C", at="B", stiffness=300.0, free_length=0.02),
        ck.damper("plate", "C", at="B", rate=20.0, name="damper"),
    )
    step = 1e-5
    motion = ck.solve(mechanism, {"crank": 0.7}, time=[0.1 - step, 0.1, 0.1 + step], speed=10.0, acceleration=20.0)
    power = ck.force_analysis(motion).power
    spring = power.loads["spring on plate"]
    rates = [(energy[2] - energy[0]) / (2 * step) for energy in (power.kinetic, power.potential)]
    for found, expected in zip(rates, (power.kinetic_rate[1], -power.gravity[1] - spring[1]), strict=True):
        assert abs(found - expected) < 1e-7 * abs(expected)
    assert power.loads["damper"][1] < 0.0
    assert power.table["sum"].unit == "W"
    assert power.table["kinetic.energy"].unit == "N m"


def test_work_over_a_cycle() -> None:
    """What the gas gives in a turn the driver takes; neither inertia nor weight keeps any of it."""
    expected = reference("slider_crank_engine", "forces")["expected"]["flywheel"]
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    gas = -2000 - 1500 * np.cos(angle) - 1800 * np.sin(angle) + 0j
    plain = engine().mechanism
    items = [item for item in plain.items if item not in plain.loads.values()]
    mechanism = ck.Mechanism(
        "Engine", *items, ck.force("piston", gas, at="B", name="gas"), ck.gravity(0, -9.81), units=SI
    )
    power = ck.force_analysis(ck.solve(mechanism, {"crank": angle}, speed=150.0)).power

    def mean(values: np.ndarray) -> float:
        return float(np.mean(values[:-1])) / 150.0  # by the angle

    assert abs(mean(power.drives["crank"]) - expected["driver_mean"]) < 1e-10
    assert abs(mean(power.loads["gas"]) * 2 * np.pi - expected["work_of_the_gas_per_turn"]) < 1e-9
    assert abs(mean(power.gravity)) < 1e-10
    assert abs(mean(power.kinetic_rate)) < 1e-10
