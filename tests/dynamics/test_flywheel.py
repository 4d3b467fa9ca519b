"""Flywheels and figures of drives: an engine by its quadratures, and what comes out in closed form."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.wrenches import Wrench
from compoundkin.model.loads import Force
from compoundkin.model.loads.contract import LoadedPoses
from tests.dynamics.test_equivalent_inertia import UNITS, slider_crank

TURN = np.deg2rad(np.arange(0.0, 361.0, 10.0))


@dataclass(frozen=True, eq=False)
class Gas(Force):
    """The gas force of the reference engine, by the crank's angle."""

    def wrenches(self, at: LoadedPoses) -> Iterator[tuple[str, Wrench]]:
        u = at.pose("crank").u.c[0]
        yield self.link, Wrench.at(at.place(self.link, self.at).c[0], -2000 - 1500 * u.real - 1800 * u.imag + 0j)


def engine_forces() -> Any:
    masses = (ck.mass("crank", 2.0, at=(-0.01, 0), inertia=0.003), ck.mass("rod", 0.8, at=(0.06, 0), inertia=0.004))
    mechanism = slider_crank(*masses, ck.mass("piston", 0.5), Gas("piston", 0j, "B"))
    return ck.force_analysis(ck.solve(mechanism, TURN, speed=150))


def test_an_engine_has_the_flywheel_of_its_quadrature() -> None:
    """Case slider_crank_engine of the reference, from poses of ten degrees."""
    found = ck.figures.flywheel(engine_forces(), 0.02)
    np.testing.assert_allclose(found.mean, -45.0, rtol=1e-13)
    np.testing.assert_allclose(
        np.rad2deg(found.crossings.drives["crank"]), [14.660183075249252, 149.94825755803578], rtol=1e-12
    )
    np.testing.assert_allclose(found.energies, [-6.018787859193128, 226.3686421585977], rtol=1e-11)
    np.testing.assert_allclose(found.fluctuation, 232.38743001779082, rtol=1e-12)
    np.testing.assert_allclose(found.inertia, 0.5164165111506462, rtol=1e-12)


def test_parts_that_move_lend_energy_too() -> None:
    """Without gas and gravity the work is zero, and what is lent is half the range of J(q) w^2."""
    mechanism = slider_crank(ck.mass("piston", 0.5))
    motion = ck.solve(mechanism, np.deg2rad(np.arange(0.0, 361.0, 1.0)), speed=150)
    found = ck.figures.flywheel(ck.force_analysis(motion), 0.1)
    inertia = ck.figures.equivalent_inertia(motion).inertia
    np.testing.assert_allclose(found.mean, 0.0, atol=1e-11)
    np.testing.assert_allclose(found.fluctuation, np.ptp(inertia) * 150**2 / 2, rtol=1e-4)
    # J w^2 is the same throughout: the piston's alone would let the crank leap at its dead points
    assert np.isinf(found.without)
    heavy = mechanism.replace(ck.mass("crank", 1.0, at="O", inertia=2e-3))
    moved = ck.solve(heavy, TURN, speed=150)
    fine = ck.solve(heavy, np.linspace(0.0, 2.0 * np.pi, 5000), order=1)
    sizes = np.sqrt(ck.figures.equivalent_inertia(fine).inertia)
    ends = 1.0 / sizes.max(), 1.0 / sizes.min()
    alone = ck.figures.flywheel(ck.force_analysis(moved), 0.1)
    np.testing.assert_allclose(alone.without, 2.0 * (ends[1] - ends[0]) / sum(ends), rtol=1e-6)
    np.testing.assert_allclose(
        ck.figures.flywheel(ck.force_analysis(moved, inertia=False), 0.1).without, alone.without, rtol=1e-9
    )
    statics = ck.figures.drive_figures(ck.force_analysis(motion, inertia=False))
    np.testing.assert_allclose(statics.peak_effort, 0.0, atol=1e-12)


def test_units_are_converted_not_reinterpreted() -> None:
    """The arm of 2 kg at 1 m of the example, in mm: 2 m g r / (Cs w^2) = 8 kg m^2."""
    parts = ck.link("frame", A=0), ck.link("arm", A=0, B=1000), ck.drive("arm")
    loads = ck.mass("arm", 2.0, at="B", inertia=0), ck.gravity(0, -10)
    arm = ck.Mechanism("Arm", *parts, *loads, units={"length": "mm", "mass": "kg", "force": "N"})
    found = ck.figures.flywheel(ck.force_analysis(ck.solve(arm, TURN, speed=10)), 0.05)
    np.testing.assert_allclose(found.inertia, 8e6, rtol=1e-12)
    np.testing.assert_allclose(found.fluctuation, 40e3, rtol=1e-12)
    # 2 m g r = J (fastest^2 - slowest^2) / 2, of the arm alone 2 kg m^2, with the flywheel 10 kg m^2
    np.testing.assert_allclose([found.without, found.achieved], [[0.2], [0.04]], rtol=1e-9)


def test_figures_of_a_drive_in_time_are_means_over_the_time() -> None:
    """An arm swings as sin t: effort -m r^2 sin t, power -m r^2 sin t cos t."""
    arm = ck.Mechanism("Arm", ck.link("frame", A=0), ck.link("arm", A=0, B=2), ck.mass("arm", 3.0, at="B", inertia=0),
                       ck.drive("arm", law=ck.laws.FunctionLaw(np.sin)), units=UNITS)  # fmt: skip
    motion = ck.solve(arm, time=np.linspace(0.0, 2.0 * np.pi, 41))
    found = ck.figures.drive_figures(ck.force_analysis(motion), "arm")
    np.testing.assert_allclose(found.peak_effort, 12.0, rtol=1e-6)
    np.testing.assert_allclose(found.rms_effort, 12.0 / np.sqrt(2.0), rtol=1e-6)
    np.testing.assert_allclose(found.peak_power, 6.0, rtol=1e-6)
    np.testing.assert_allclose(found.rms_power, 6.0 / np.sqrt(2.0), rtol=1e-6)
    np.testing.assert_allclose([found.work, found.mean_effort], 0.0, atol=1e-5)


def test_what_has_no_flywheel_says_why() -> None:
    forces = engine_forces()
    for bad, told in ((0.0, "coefficient of fluctuation"), (np.nan, "coefficient of fluctuation")):
        with pytest.raises(ck.errors.InvalidInput, match=told):
            ck.figures.flywheel(forces, bad)
    with pytest.raises(ck.errors.UnknownName, match="there is no driver"):
        ck.figures.flywheel(forces, 0.1, driver="rod")
    half = ck.force_analysis(ck.solve(slider_crank(ck.mass("piston", 1.0)), TURN[:9], speed=1))
    with pytest.raises(ck.errors.InvalidInput, match="closed cycle"):
        ck.figures.flywheel(half, 0.1)
    still = ck.force_analysis(ck.solve(slider_crank(ck.mass("piston", 1.0)), TURN, speed=0))
    with pytest.raises(ck.errors.InvalidInput, match="speed is not constant"):
        ck.figures.flywheel(still, 0.1)


def test_a_two_stroke_engine_of_the_textbook_has_its_power_and_fluctuation() -> None:
    """T = 1000 + 300 sin 2t - 500 cos 2t N m at 250 rpm, 64 kg m^2: 26.18 kW and 1.33 %; Khurmi and Gupta, chapter 16.

    In closed form the mean is 1000 and the fluctuation of energy the amplitude of the second order.
    """
    speed = 250 * np.pi / 30.0

    def torque(t: Any) -> Any:
        return 1000 + 300 * np.sin(2 * speed * t) - 500 * np.cos(2 * speed * t)

    shaft = ck.Mechanism("Shaft", ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.torque("crank", torque),
                         ck.drive("crank", law=ck.laws.constant_speed(speed)), units=UNITS)  # fmt: skip
    forces = ck.force_analysis(ck.solve(shaft, time=np.linspace(0.0, 2.0 * np.pi / speed, 25)))
    shaft_drive = ck.figures.drive_figures(forces)
    np.testing.assert_allclose(shaft_drive.mean_power, -1000 * speed, rtol=1e-12)
    np.testing.assert_allclose(np.abs(shaft_drive.mean_power), 26.18e3, rtol=1e-4)
    spread = np.hypot(300.0, 500.0)
    found = ck.figures.flywheel(forces, spread / (64 * speed**2))
    np.testing.assert_allclose([found.fluctuation, found.inertia], [[spread], [64.0]], rtol=1e-9)
    np.testing.assert_allclose(found.coefficient, 0.0133, rtol=1e-3)


def test_corners_of_tables_between_the_poses_do_no_harm() -> None:
    """A torque of straight lines over the crank: mean and mean square in closed form, whatever the poses."""
    at, values = np.deg2rad([0.0, 33.0, 100.0, 217.5]), np.array([0.0, -30.0, -5.0, 1.0])
    torque = {"over": "crank", "at": at, "values": values, "period": 2.0 * np.pi}
    shaft = ck.Mechanism("Shaft", ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.drive("crank"),
                         ck.torque("crank", torque), units=UNITS)  # fmt: skip
    found = ck.figures.drive_figures(ck.force_analysis(ck.solve(shaft, TURN, speed=3)))
    steps, ends = np.diff([*at, 2.0 * np.pi]), np.append(values[1:], values[0])
    mean = np.sum(steps * (values + ends)) / (4.0 * np.pi)
    square = np.sum(steps * (values**2 + values * ends + ends**2)) / (6.0 * np.pi)
    np.testing.assert_allclose([found.mean_effort[0], found.rms_effort[0]], [-mean, np.sqrt(square)], rtol=1e-9)
    np.testing.assert_allclose(found.peak_effort, 30.0, rtol=1e-8)
