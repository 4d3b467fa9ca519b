"""Efforts by virtual work, powers and energies."""

from __future__ import annotations

import numpy as np
import pytest

from compoundkin.dynamics.virtual_work import virtual_efforts
from tests.dynamics.cases import CASES


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
