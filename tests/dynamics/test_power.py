"""Efforts by virtual work, holding efforts, powers, energies and equivalent inertia."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dynamics.reactions.virtual_work import virtual_efforts
from tests.dynamics import cases
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


@pytest.mark.parametrize("name", ["O", "cylinder"])
def test_an_engine_held_by_its_pairs(name: str) -> None:
    """At the crank's own pin the torque is the driver's; along the cylinder it does the same work on another way."""
    case = cases.engine()
    motion = ck.solve(case.mechanism, case.values, **case.rates)
    driven, held = ck.force_analysis(motion), ck.force_analysis(motion, holding=name)
    assert held.held is not None
    rest = held.held.cannot_hold
    assert rest.any() == (name == "cylinder")
    assert np.all(np.isinf(held.held.effort[rest]))
    torque, rate = driven.drives["crank"].effort, motion.pairs[name].rate
    given = torque * motion.drives["crank"].rate
    assert np.allclose(held.held.effort[~rest] * rate[~rest], given[~rest], rtol=1e-10)
    assert np.allclose(held.held.power[~rest], driven.drives["crank"].power[~rest], rtol=1e-10)
    assert np.allclose(held.drives["crank"].effort[~rest], 0.0, atol=1e-11 * np.abs(torque).max())
    for link in ("crank", "rod", "piston"):
        assert np.max(np.abs(held.on(link).force[~rest])) < 1e-9
        assert np.max(np.abs(held.on(link).moment_about((0, 0))[~rest])) < 1e-9
    entries = held.on("crank" if name == "O" else "piston").entries
    assert [one.name for one in entries if one.kind == "driver"][-1] == name


def test_a_press_is_held_at_its_ram() -> None:
    """The ram carries its load alone: no other pair has a force. Statics of a toggle press without weights."""
    case = cases.toggle_press()
    forces = ck.force_analysis(ck.solve(case.mechanism, case.values), inertia=False, holding="press")
    assert forces.held is not None
    assert np.allclose(forces.held.effort, 1e4, rtol=1e-9)
    assert max(np.max(np.abs(forces.pairs[name].force)) for name in forces.pairs) < 1e-7
    assert ck.verify(forces).passed


def test_what_cannot_hold() -> None:
    case = cases.engine()
    motion = ck.solve(case.mechanism, case.values, **case.rates)
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'cylinder'"):
        ck.force_analysis(motion, holding="cylindre")
    rubbed = case.mechanism.replace(ck.friction("cylinder", 0.1))
    with pytest.raises(ck.errors.InvalidInput, match="without friction only"):
        ck.force_analysis(ck.solve(rubbed, case.values, **case.rates), holding="cylinder")


UNITS = {"length": "m", "mass": "kg", "force": "N"}
ANGLES = np.deg2rad(np.arange(0.0, 360.0, 15.0))


def slider_crank(*items: Any, units: dict[str, str] = UNITS) -> ck.Mechanism:
    """Return an in-line slider-crank of radius 0.05 and rod 0.2, with what else is given."""
    frame, crank = ck.link("frame", O=(0, 0)), ck.link("crank", O=(0, 0), A=(0.05, 0))
    rod, piston = ck.link("rod", A=(0, 0), B=(0.2, 0)), ck.link("piston", B=(0, 0))
    guide = ck.slide("piston", on="frame", through="O", name="cylinder")
    return ck.Mechanism("m", frame, crank, rod, piston, guide, ck.drive("crank"), *items, units=units)


def test_an_arm_of_two_links_has_the_matrix_of_the_textbook() -> None:
    """M11 = J1 + J2 + m1 r1^2 + m2 (l1^2 + r2^2 + 2 l1 r2 cos q2); Spong, Hutchinson and Vidyasagar, section 7.4."""
    bars = ck.link("upper", A=0, B=2), ck.link("fore", B=0, P=1)
    drives = ck.drive("upper"), ck.drive("fore", on="upper")
    masses = ck.mass("upper", 3.0, at=(0.8, 0), inertia=0.7), ck.mass("fore", 2.0, at=(0.5, 0), inertia=0.3)
    arm = ck.Mechanism("arm", ck.link("frame", A=0), *bars, *drives, *masses, units=UNITS)
    found = ck.figures.equivalent_inertia(ck.solve(arm, {"upper": 0.3, "fore": ANGLES}))
    h, zero = 2.0 * 2.0 * 0.5 * np.cos(ANGLES), 0.0 * ANGLES
    both = 0.3 + 2.0 * 0.25 + h
    first = 0.7 + 0.3 + 3.0 * 0.64 + 2.0 * (4.0 + 0.25) + 2.0 * h
    expected = np.array([[first, both], [both, zero + 0.3 + 0.5]])
    np.testing.assert_allclose(np.moveaxis(found.matrix, 0, -1), expected, atol=1e-13)
    slope = -2.0 * 2.0 * 0.5 * np.sin(ANGLES)
    np.testing.assert_allclose(
        np.moveaxis(found.slopes, 0, -1)[..., 1, :], [[2 * slope, slope], [slope, zero]], atol=1e-13
    )
    np.testing.assert_allclose(found.slopes[..., 0], 0.0, atol=1e-13)
    with pytest.raises(ck.errors.InvalidInput, match="matrix and"):
        _ = found.inertia


def test_a_piston_is_felt_by_its_crank_as_its_mass_by_the_square_of_its_rate() -> None:
    """x' and x'' of an in-line slider-crank by its closed form; designs of the piston's mass side by side."""
    mechanism = slider_crank(ck.mass("piston", np.array([[0.5], [1.5]])))
    found = ck.figures.equivalent_inertia(ck.solve(mechanism, np.tile(ANGLES, (2, 1))))
    r, rod, sin, cos = 0.05, 0.2, np.sin(ANGLES), np.cos(ANGLES)
    root = np.sqrt(rod**2 - (r * sin) ** 2)
    first = -r * sin - r**2 * sin * cos / root
    second = -r * cos - r**2 * (cos**2 - sin**2) / root - (r**2 * sin * cos) ** 2 / root**3
    np.testing.assert_allclose(found.inertia, np.array([[0.5], [1.5]]) * first**2, atol=1e-17)
    np.testing.assert_allclose(found.slope, np.array([[1.0], [3.0]]) * first * second, atol=1e-17)


def test_masses_are_wanted() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="no link has a mass"):
        ck.figures.equivalent_inertia(ck.solve(slider_crank(), [0.0]))
