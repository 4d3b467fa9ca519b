"""Machines: flywheels, harmonics, equilibrium positions and counterweights, against formulas and textbooks."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.wrenches import Wrench
from compoundkin.model.loads.contract import LoadedPoses
from compoundkin.model.loads.force import Force
from tests import catalog
from tests.dynamics.test_power import UNITS, slider_crank

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


SHIFTED_TURN = np.deg2rad(np.arange(10.0, 371.0, 10.0))


def test_a_piston_shakes_by_the_series_of_the_slider_crank() -> None:
    """cos t + A2 cos 2t - A4 cos 4t + A6 cos 6t; Den Hartog, Mechanical Vibrations, section 5.1, with l = r / rod."""
    forces = ck.force_analysis(ck.solve(slider_crank(ck.mass("piston", 0.5)), SHIFTED_TURN, speed=150))
    found = ck.figures.harmonics(forces)
    ratio = 0.25
    second = ratio + ratio**3 / 4 + 15 * ratio**5 / 128
    fourth, sixth = ratio**3 / 4 + 3 * ratio**5 / 16, 9 * ratio**5 / 128
    along = found.part("x")
    signed = along.amplitude * np.cos(along.phase) / (0.5 * 0.05 * 150**2)
    np.testing.assert_allclose(signed, [[0.0, 1.0, second, 0.0, -fourth, 0.0, sixth]], atol=1e-5)
    np.testing.assert_allclose(signed[0, 1], 1.0, rtol=1e-13)
    np.testing.assert_allclose(found.part("y").amplitude, 0.0, atol=1e-11)
    # to and fro is half with the crank, half against it
    np.testing.assert_allclose(found.forward, np.conj(found.backward), atol=1e-11)
    effort = ck.figures.harmonics(forces, "crank.effort", orders=2)
    values = np.asarray(forces.drives["crank"].effort)[:-1]
    np.testing.assert_allclose(
        effort.amplitude[0, 2], 2 * np.abs(np.mean(values * np.exp(-2j * SHIFTED_TURN[:-1]))), rtol=1e-9
    )


def test_a_crank_pulls_with_a_vector_that_turns_forward() -> None:
    mechanism = slider_crank(ck.mass("crank", 2.0, at=(0.03, 0.04), inertia=0.1))
    found = ck.figures.harmonics(ck.force_analysis(ck.solve(mechanism, SHIFTED_TURN, speed=10)))
    np.testing.assert_allclose(found.forward[0, :3], [0.0, 200.0 * (0.03 + 0.04j), 0.0], atol=1e-12)
    np.testing.assert_allclose(found.backward, 0.0, atol=1e-12)
    with pytest.raises(ck.errors.InvalidInput, match="a vector has no amplitude"):
        _ = found.amplitude
    with pytest.raises(ck.errors.InvalidInput, match="closed cycle"):
        ck.figures.harmonics(ck.solve(mechanism, SHIFTED_TURN[:9]), "A.x")


def test_forces_without_friction_are_in_the_inverse_ratio_of_rates() -> None:
    """The reverse pass against velocities, for links, slides, points and drivers; units do not matter."""
    for name, outputs in {
        "crank-rocker": ("rocker", ck.figures.TorquePort("coupler"), ck.figures.ForcePort("coupler", "C", 0.3)),
        "slider-crank-offset": ("stroke", ck.figures.ForcePort("rod", "B", 0.0)),
        "six-bar": ("bar", ck.figures.TorquePort("bar", "rocker")),
    }.items():
        mechanism = catalog.mechanism(name)
        motion = ck.solve(mechanism, np.deg2rad(np.arange(20.0, 380.0, 24.0)))
        for output in outputs:
            by_rates = ck.figures.mechanical_advantage(motion, output, next(iter(motion.drives))).advantage
            np.testing.assert_allclose(ck.figures.force_ratio(motion, output), by_rates, rtol=1e-9)


def test_friction_takes_its_share_of_the_ratio_of_forces() -> None:
    """In the guide of a slider-crank 1 - mu tan of the rod's angle, whichever way the piston goes; weights are none."""
    rubbed = slider_crank(ck.friction("cylinder", 0.2), ck.mass("piston", 3.0), ck.gravity(0, -9.81))
    for speed in (2.0, -2.0):
        motion = ck.solve(rubbed, np.deg2rad(np.arange(15.0, 360.0, 30.0)), speed=speed)
        by_rates = ck.figures.mechanical_advantage(motion, "cylinder", "crank").advantage
        share = 1.0 - 0.2 * np.abs(np.tan(motion.links["rod"].angle))
        np.testing.assert_allclose(ck.figures.force_ratio(motion, "cylinder"), by_rates * share, rtol=1e-9)


DOWN = ck.gravity(0, -9.81)


def arm(*items: object) -> ck.Mechanism:
    """Return the arm of case spring_balanced_arm of the reference."""
    parts = (ck.link("frame", O=(0, 0), S=(0, 0.5)), ck.link("arm", O=0, A=(0.3, 0)), ck.drive("arm"))
    return ck.Mechanism("m", *parts, ck.mass("arm", 5, at=(0.45, 0), inertia=0.4), DOWN, *items, units=UNITS)  # type: ignore[arg-type]


def test_a_pendulum_hangs_and_stands() -> None:
    """At 270 degrees stable, at 90 not, with a stiffness of m g l; poses beside the positions and at them."""
    for first in (0.0, 7.0):
        hangs, stands = sorted(
            ck.figures.equilibria(arm(), {"arm": ck.deg(first + np.arange(0.0, 361.0, 15.0))}),
            key=lambda one: one.stability,
        )
        assert (hangs.stability, stands.stability) == ("stable", "unstable")
        np.testing.assert_allclose(np.rad2deg([hangs.values["arm"], stands.values["arm"]]), [270.0, 90.0], rtol=1e-13)
        np.testing.assert_allclose([hangs.stiffness[0, 0], stands.stiffness[0, 0]], [22.0725, -22.0725], rtol=1e-11)


def test_a_lamp_balanced_by_a_spring_without_length_stays_everywhere() -> None:
    found = ck.figures.equilibria(arm(ck.spring("arm", "A", to="frame", at="S", stiffness=147.15)))
    assert found.indifferent
    assert not found.positions
    assert found.text().startswith("Indifferent equilibrium: arm")


def test_a_spring_of_length_holds_an_arm_where_its_moment_is_that_of_the_weight() -> None:
    """With k (1 - l0 / l) b h = m g c: l = l0 / (1 - 147.15 / 900); cosine theorem for the angle; either side of 90."""
    found = ck.figures.equilibria(arm(ck.spring("arm", "A", to="frame", at="S", stiffness=900, free_length=0.2)))
    length = 0.2 / (1.0 - 147.15 / 900.0)
    away = np.rad2deg(np.arccos((0.3**2 + 0.5**2 - length**2) / (2.0 * 0.3 * 0.5)))
    values = np.rad2deg([one.values["arm"] for one in found])
    np.testing.assert_allclose(values, [90.0 - away, 90.0, 90.0 + away, 270.0], rtol=1e-12)
    assert [one.stability for one in found] == ["stable", "unstable", "stable", "unstable"]
    np.testing.assert_allclose(found[3].stiffness, -900.0 * 0.15 * (1 - 0.2 / 0.8) + 22.0725, rtol=1e-10)


def test_a_toggle_is_snapped_through_by_its_spring() -> None:
    """Free where the piston is at x0: stable at both sides of the toggle positions, of which none is."""
    free = float(0.05 * np.cos(0.7) + np.sqrt(0.2**2 - (0.05 * np.sin(0.7)) ** 2))
    mechanism = slider_crank(ck.spring("piston", "B", to="frame", at="O", stiffness=1e4, free_length=free))
    found = ck.figures.equilibria(mechanism, {"crank": np.linspace(-1.0, 2.0 * np.pi - 1.0, 50)})
    np.testing.assert_allclose([one.values["crank"] for one in found], [-0.7, 0.0, 0.7, np.pi], atol=1e-12)
    assert [one.stability == "stable" for one in found] == [True, False, True, False]
    slope = -0.05 * np.sin(0.7) - 0.05**2 * np.sin(0.7) * np.cos(0.7) / np.sqrt(0.2**2 - (0.05 * np.sin(0.7)) ** 2)
    np.testing.assert_allclose(found[0].stiffness, 1e4 * slope**2, rtol=1e-10)


def test_a_double_pendulum_has_four_positions_of_which_one_is_stable() -> None:
    """The stiffness is the closed form of m g (2 sin a + sin(a + b)), which has two saddles."""
    bars = ck.link("upper", A=0, B=1), ck.link("fore", B=0, P=1)
    masses = ck.mass("upper", 1.0, at="B"), ck.mass("fore", 1.0, at="P")
    drives = ck.drive("upper"), ck.drive("fore", on="upper")
    mechanism = ck.Mechanism("m", ck.link("frame", A=0), *bars, *drives, *masses, DOWN, units=UNITS)
    grid = ck.deg(range(-180, 181, 30))
    found = ck.figures.equilibria(mechanism, {"upper": grid, "fore": grid})
    kinds = {tuple(np.round(np.rad2deg(list(one.values.values())) % 360.0 % 360.0, 6)): one for one in found}
    assert {at: one.stability for at, one in kinds.items()} == {
        (270.0, 0.0): "stable", (90.0, 0.0): "unstable", (270.0, 180.0): "saddle", (90.0, 180.0): "saddle"
    }  # fmt: skip
    np.testing.assert_allclose(kinds[270.0, 0.0].stiffness, 9.81 * np.array([[3.0, 1.0], [1.0, 1.0]]), rtol=1e-9)
    straight = ck.figures.equilibria(mechanism, {"upper": grid, "fore": 0.0})
    assert [one.stability for one in straight] == ["stable", "unstable"]


def test_what_has_no_equilibrium_positions_says_why() -> None:
    with pytest.raises(ck.errors.InvalidInput, match="nothing acts on the mechanism"):
        ck.figures.equilibria(slider_crank())
    with pytest.raises(ck.errors.InvalidInput, match="no driver is released"):
        ck.figures.equilibria(arm(), {"arm": 1.0})
    none = ck.figures.equilibria(arm(), {"arm": ck.deg([0, 40])})
    assert (len(none), none.indifferent, none.text()) == (0, False, "No equilibrium position in the range.")


FINE_TURN = np.deg2rad(np.arange(0.0, 361.0, 5.0))


def four_bar(crank: complex, rocker: complex) -> ck.Mechanism:
    """Return the linkage of balanced_four_bar, of the reference, with its mass centres of crank and rocker."""
    masses = (
        ck.mass("crank", 1.0, at=crank, inertia=0.002),
        ck.mass("coupler", 0.4, at=(0.06893654271085456, 0.012155372436685125), inertia=0.001),
        ck.mass("rocker", 1.5, at=rocker, inertia=0.004),
    )
    links = (ck.link("frame", O=(0, 0), C=(0.14, 0)), ck.link("crank", O=(0, 0), A=(0.05, 0)),
             ck.link("coupler", A=(0, 0), B=(0.15, 0)), ck.link("rocker", C=(0, 0), B=(0.12, 0)))  # fmt: skip
    return ck.Mechanism("Four-bar", *links, ck.drive("crank"), *masses, units=UNITS)


def shaking(mechanism: ck.Mechanism, **given: Any) -> Any:
    """Return the greatest shaking force by the reverse pass, in parts of what a link alone would do."""
    motion = ck.solve(mechanism, **given)
    forces = ck.force_analysis(motion)
    largest = max(np.abs(np.asarray(one.force)).max() for one in forces.pairs.values())
    return np.abs(np.asarray(forces.shaking.force)).max() / largest


def test_a_four_bar_is_balanced_by_the_conditions_of_berkof_and_lowen() -> None:
    """m2 c2 = -m3 a2 (1 - p3 / a3) and m4 c4 = -m3 p3 a4 / a3; figures of case balanced_four_bar of the reference."""
    motion = ck.solve(four_bar(0.02 + 0j, 0.05 + 0j), FINE_TURN, speed=100)
    found = ck.figures.counterweights(motion, mass=0.5, about="O")
    assert found.is_full
    assert not found.unreached
    crank, rocker = found.counterweights
    np.testing.assert_allclose(crank.moment, -0.010808460971886058 + 0.0016207163248913498j - 0.02, rtol=1e-13)
    wanted = 1.5 * (-0.014706462444982306 - 0.00259314611982616j - 0.05)
    np.testing.assert_allclose(rocker.moment, wanted, rtol=1e-13)
    np.testing.assert_allclose(crank.at * 0.5, crank.moment, rtol=1e-14)
    assert shaking(found.mechanism, values=FINE_TURN, speed=100) < 1e-14
    force, moment, effort = found.before
    exact = ck.force_analysis(motion)
    np.testing.assert_allclose(force.greatest, np.abs(np.asarray(exact.shaking.force)).max(), rtol=1e-2)
    np.testing.assert_allclose(moment.greatest, np.abs(exact.shaking.moment_about("O")).max(), rtol=1e-2)
    np.testing.assert_allclose(effort.rms, ck.figures.drive_figures(exact).rms_effort, rtol=1e-9)
    # the price: shaking moment and torque rise
    assert all(new.greatest > old.greatest for old, new in zip(found.before[1:], found.after[1:], strict=True))
    assert "Full force balance by 2 counterweights." in found.text()
    assert "shaking moment, greatest [N m]" in found.text()


def test_a_balanced_linkage_needs_no_counterweight() -> None:
    balanced = four_bar(-0.010808460971886058 + 0.0016207163248913498j, -0.014706462444982306 - 0.00259314611982616j)
    found = ck.figures.counterweights(ck.solve(balanced, FINE_TURN, speed=100))
    assert (found.is_full, found.counterweights) == (True, ())


def heavy(name: str) -> ck.Mechanism:
    """Return a mechanism of the catalog with random masses off all pins."""
    mechanism, rng = catalog.mechanism(name), np.random.default_rng(7)
    size = ck.solve(mechanism, order=0).size
    masses = [
        ck.mass(link, float(rng.uniform(0.5, 2.0)), at=complex(*rng.uniform(-0.2, 0.2, 2)) * size, inertia=size**2 / 9)
        for link in mechanism.links
        if link != "frame" and link not in mechanism.auxiliary_links
    ]
    return mechanism.replace(*masses, units=UNITS)


@pytest.mark.parametrize(("name", "count"), [("six-bar", 3), ("stephenson-iii", 3), ("andrews-squeezer", 4)])
def test_linkages_of_n_links_take_half_as_many_counterweights(name: str, count: int) -> None:
    """Six links take three, eight take four: Berkof and Lowen 1969, Walker and Oldham 1978."""
    mechanism = heavy(name)
    found = ck.figures.counterweights(mechanism)
    assert found.is_full
    assert len(found.counterweights) == count
    assert shaking(found.mechanism) < 1e-12


def test_links_that_turn_alike_share_a_counterweight() -> None:
    """In a parallelogram the coupler does not turn, and both cranks do as one: the motion shows it."""
    links = (ck.link("frame", O=(0, 0), C=(4, 0)), ck.link("crank", O=(0, 0), A=(1, 0)),
             ck.link("coupler", A=(0, 0), B=(4, 0)), ck.link("rocker", C=(0, 0), B=(1, 0)))  # fmt: skip
    masses = ck.mass("crank", 1.0, at=(0.4, 0)), ck.mass("coupler", 2.0, at=(1, 1)), ck.mass("rocker", 1.0, at=(0.3, 0))
    mechanism = ck.Mechanism("m", *links, ck.drive("crank"), *masses, ck.drawn(A=(0, 1), B=(4, 1)), units=UNITS)
    found = ck.figures.counterweights(ck.solve(mechanism, {"crank": FINE_TURN + 0.3}))
    assert found.is_full
    (only,) = found.counterweights
    np.testing.assert_allclose(only.moment, -(0.4 + 2.0 + 0.3), rtol=1e-9)


def test_a_slider_crank_is_balanced_wholly_by_its_rod_or_half_by_its_crank() -> None:
    """Half of what goes to and fro is best where the piston's first harmonic is the crank's radius: always in line."""
    masses = ck.mass("crank", 2.0, at=(0.01, 0)), ck.mass("rod", 0.8, at=(0.06, 0.01)), ck.mass("piston", 0.5)
    motion = ck.solve(slider_crank(*masses), FINE_TURN, speed=150)
    whole = ck.figures.counterweights(motion, radius={"crank": 0.03, "rod": 0.08}, disc=0.01)
    assert whole.is_full
    crank, rod = whole.counterweights
    np.testing.assert_allclose(rod.moment, -(0.8 * (0.06 + 0.01j) + 0.5 * 0.2), rtol=1e-13)
    np.testing.assert_allclose(crank.moment, -(0.02 + 0.05 * (0.8 + 0.5 + rod.mass)), rtol=1e-13)
    np.testing.assert_allclose(rod.inertia, rod.mass * 0.01**2 / 2)
    assert shaking(whole.mechanism, values=FINE_TURN, speed=150) < 1e-13
    least = ck.figures.counterweights(motion, "crank")
    half = ck.figures.counterweights(motion, fraction=0.5)
    assert not least.is_full
    assert not half.is_full
    np.testing.assert_allclose(
        half.counterweights[0].moment,
        -(0.02 + 0.05 * (0.8 * 0.7 + 0.5 * (0.24 + 0.5)) - 0.05j * 0.8 * 0.05 * 0.5),
        rtol=1e-12,
    )
    in_line = ck.solve(slider_crank(ck.mass("crank", 2.0, at=(0.01, 0)), ck.mass("piston", 0.5)), FINE_TURN, speed=150)
    best, halved = (ck.figures.counterweights(in_line, **given) for given in ({"links": "crank"}, {"fraction": 0.5}))
    np.testing.assert_allclose(best.counterweights[0].moment, halved.counterweights[0].moment, rtol=1e-12)
    assert best.after[0].rms < 0.6 * best.before[0].rms


def test_what_only_slides_cannot_be_balanced_and_is_named() -> None:
    """Tepper and Lowen: a yoke that only slides has no chain of pins to the frame; half its mass is the best."""
    links = (ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.link("block", A=0), ck.link("yoke", Y=0))
    slides = (
        ck.slide("yoke", on="frame", through="O", angle=0),
        ck.slide("block", on="yoke", through="Y", angle=np.pi / 2),
    )
    mechanism = ck.Mechanism("m", *links, *slides, ck.drive("crank"), ck.mass("yoke", 3.0), units=UNITS)
    found = ck.figures.counterweights(ck.solve(mechanism, FINE_TURN, speed=2))
    assert not found.is_full
    assert found.unreached == ("yoke",)
    np.testing.assert_allclose(found.counterweights[0].moment, -1.5, rtol=1e-12)
    assert "does not exist: no chain of pins alone joins yoke to the frame" in found.text()
    np.testing.assert_allclose(found.after[0].greatest, 6.0, rtol=1e-12)


def numbers(text: str, line: str) -> list[float]:
    """The numbers of the first line of a text that begins so, after these words."""
    (found, *_) = (row for row in text.splitlines() if row.startswith(line))
    return [
        float(word) for word in re.findall(r"(?<![\w^])-?\d+(?:\.\d+)?(?:e[-+]\d+)?(?![\w^])", found.removeprefix(line))
    ]


def pendulum(**units: str) -> ck.Mechanism:
    """An arm of 2 kg at its end, 1000 mm from the pin, under 10 m/s^2."""
    parts = ck.link("frame", A=0), ck.link("arm", A=0, B=1000), ck.drive("arm"), ck.mass("arm", 2, at="B")
    return ck.Mechanism("Arm", *parts, ck.gravity(0, -10), units={"length": "mm", "mass": "kg", "force": "N"} | units)


def test_the_texts_of_drives_and_flywheels_are_in_customary_units_too() -> None:
    """The torque of the arm is 20 N m cos: no work, a fluctuation of 40 J, at 3 rad/s at most 60 W."""
    forces = ck.force_analysis(ck.solve(pendulum(), TURN, speed=3))
    text = ck.figures.drive_figures(forces).text()
    assert text.splitlines()[0] == "driver arm at 3 rad/s (28.6479 rpm)"
    assert numbers(text, "greatest torque") == [20000, 20, 0]
    assert numbers(text, "least torque") == [-20000, -20, 180]
    assert numbers(text, "rms torque") == pytest.approx([20000 / np.sqrt(2), 20 / np.sqrt(2)], rel=1e-5)
    assert numbers(text, "greatest power") == [60000, 60, 0]
    assert numbers(text, "mean torque") == numbers(text, "work") == numbers(text, "mean power") == [0, 0]
    assert re.search(r"greatest power .* mW .* W ", text)
    wheel = ck.figures.flywheel(forces, 0.05).text()
    assert numbers(wheel, "mean speed") == pytest.approx([3, 90 / np.pi], rel=1e-5)
    assert numbers(wheel, "mean torque") == [0, 0]
    assert numbers(wheel, "fluctuation of energy") == [40000, 40]
    assert numbers(wheel, "flywheel") == pytest.approx([40 / (0.05 * 9) * 1e6], rel=1e-5)
    assert re.search(r"fluctuation of energy .* N mm .* J\nco", wheel)
    assert "kg mm^2" in wheel


def test_the_text_of_a_thrust_has_no_torque() -> None:
    """A mass lifted by 2 to and fro at constant force m g."""
    parts = (
        ck.link("frame", A=0),
        ck.link("ram", B=0),
        ck.slide("ram", on="frame", through="A", angle=np.pi / 2, name="s"),
    )
    items = ck.drive("ram", values=[0.0, 1.0, 2.0], speed=0.5), ck.mass("ram", 3), ck.gravity(0, -10)
    lift = ck.Mechanism("Lift", *parts, *items, units=UNITS)
    text = ck.figures.drive_figures(ck.force_analysis(ck.solve(lift))).text()
    assert text.splitlines()[0] == "driver ram at 0.5 m/s"
    assert numbers(text, "mean thrust") == [30]
    assert numbers(text, "work") == [60, 60]
    assert numbers(text, "mean power") == [15]
    inertia = ck.figures.equivalent_inertia(ck.solve(lift)).text()
    assert numbers(inertia, "equivalent inertia at ram, greatest") == [3, 0]
    assert "kg/m" in inertia


def test_the_text_of_harmonics_has_phases_in_degrees() -> None:
    """m r w^2 turns with the crank; its moment of weight is 20 N m cos, its torque the first order alone."""
    forces = ck.force_analysis(ck.solve(pendulum(), TURN, speed=3))
    torque = ck.figures.harmonics(forces, "arm.effort", orders=2).text()
    assert torque.splitlines()[0] == "arm.effort [N mm, N m, °]"
    assert numbers(torque, "1") == [20000, 20, 0]
    assert numbers(torque, "2") == [0, 0, 0]
    shaking = ck.figures.harmonics(forces, orders=2).text()
    assert numbers(shaking, "0") == [20, -90, 20, -90], "the weight"
    assert numbers(shaking, "1") == [18, 0, 0, 0], "2 kg x 1 m x 9 rad/s^2, in line with the arm"


def test_the_text_of_an_equivalent_inertia_names_places_and_drivers() -> None:
    """J = m_p (ds/dq)^2 of a yoke: 3 kg x 1^2 at a right angle, none at a dead point."""
    links = ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.link("block", A=0), ck.link("yoke", Y=0)
    first = ck.slide("yoke", on="frame", through="O", angle=0)
    second = ck.slide("block", on="yoke", through="Y", angle=np.pi / 2)
    yoke = ck.Mechanism("m", *links, first, second, ck.drive("crank"), ck.mass("yoke", 3.0), units=UNITS)
    text = ck.figures.equivalent_inertia(ck.solve(yoke, TURN)).text()
    assert numbers(text, "equivalent inertia at crank, greatest") == [3, 90]
    assert numbers(text, "equivalent inertia at crank, least") == [0, 0]
    at_one = ck.figures.equivalent_inertia(ck.solve(yoke, [np.pi / 6])).text()
    assert numbers(at_one, "equivalent inertia at crank") == pytest.approx([3 / 4])
    assert numbers(at_one, "its derivative by crank") == pytest.approx([3 * 2 * 0.5 * np.sqrt(3) / 2], rel=1e-5)


def test_the_text_of_an_efficiency_is_that_of_the_drawer() -> None:
    """A load of 10 lifted on a plane of 30 degrees: 1 / (1 + mu / tan 30) up; it locks itself where mu > tan 30."""
    slope, load = np.deg2rad(30), ck.force("block", (0, -10), at="B")
    for friction in (0.2, 0.7):
        parts = (
            ck.link("frame", A=0),
            ck.link("block", B=0),
            ck.slide("block", on="frame", through="A", angle=slope, name="s"),
        )
        items = ck.drive("block", values=[0.0, 1.0], speed=1), load, ck.friction("s", friction)
        forces = ck.force_analysis(ck.solve(ck.Mechanism("Plane", *parts, *items, units=UNITS)), inertia=False)
        text = forces.efficiency.text()
        assert numbers(text, "efficiency over the motion") == pytest.approx(
            [1 / (1 + friction / np.tan(slope))], rel=1e-5
        )
        assert ("not self-locking" in text) == (friction < np.tan(slope))


def test_texts_of_several_designs_are_blocks() -> None:
    arms = pendulum().replace(ck.mass("arm", [[2.0], [4.0]], at="B"))
    text = ck.figures.drive_figures(ck.force_analysis(ck.solve(arms, TURN, speed=3))).text()
    first, second = text.split("\n\n")
    assert (first.splitlines()[0], second.splitlines()[0]) == ("design 0", "design 1")
    assert numbers(second, "greatest torque") == [40000, 40, 0]


def test_what_is_wrong_is_said() -> None:
    mechanism = slider_crank(ck.mass("piston", 0.5))
    motion = ck.solve(mechanism, FINE_TURN)
    cases: list[tuple[dict[str, Any], str]] = [
        ({"links": "piston", "mass": 1.0, "radius": 1.0}, "mass and radius are both given"),
        ({"links": "rodd"}, "did you mean 'rod'"),
        ({"mass": -1.0}, "is no mass of a counterweight"),
        ({"about": "Q"}, "the frame has no point 'Q'"),
    ]
    for given, told in cases:
        with pytest.raises(ck.errors.CompoundkinError, match=told):
            ck.figures.counterweights(motion, **given)
    with pytest.raises(ck.errors.InvalidInput, match="only a slider-crank"):
        ck.figures.counterweights(ck.solve(four_bar(0j, 0j), FINE_TURN), fraction=0.5)
    with pytest.raises(ck.errors.InvalidInput, match="only one design"):
        ck.figures.counterweights(ck.solve(mechanism, np.tile(FINE_TURN, (2, 1))))


FOUR_BAR = ck.Mechanism(
    "Four-bar",
    ck.link("frame", O=0, C=140),
    ck.link("crank", O=0, A=50),
    ck.link("coupler", A=0, B=150),
    ck.link("rocker", C=0, B=120),
    ck.drive("crank", speed=100),
    ck.mass("crank", 1.0, at=20, inertia=2000),
    ck.mass("coupler", 0.4, at=69 + 12j, inertia=1000),
    ck.mass("rocker", 1.5, at=50, inertia=4000),
    units={"length": "mm", "mass": "kg", "force": "N"},
)


@pytest.mark.parametrize("most", [{"rocker": 0.8}, 0.3, {"crank": 0.1, "rocker": 0.5}], ids=str)
def test_bounded_counterweights_are_the_best_within_their_bounds(most: object) -> None:
    """No smaller, turned or exchanged counterweights leave less shaking force: all neighbours within are tried."""
    found = ck.figures.counterweights(FOUR_BAR, radius=60, most_mass=most)
    bounds = most if isinstance(most, dict) else dict.fromkeys(("crank", "rocker"), most)
    masses = {one.link: one.mass for one in found.counterweights}
    assert all(masses[name] <= bound * (1.0 + 1e-12) for name, bound in bounds.items())
    assert any(masses[name] == pytest.approx(bound, rel=1e-9) for name, bound in bounds.items())

    def rest(moments: dict[str, complex]) -> float:
        items = {one.link: one for one in FOUR_BAR.masses.values()}
        changed = []
        for name, moment in moments.items():
            own, added = items[name], abs(moment) / 60.0
            place = 60.0 * moment / abs(moment) if moment else 0.0
            centre = (own.mass * own.at + added * place) / (own.mass + added)
            changed.append(ck.mass(name, own.mass + added, at=centre, inertia=own.inertia))
        motion = ck.solve(FOUR_BAR.replace(*changed), {"crank": np.linspace(0.0, 2.0 * np.pi, 721)}, speed=100)
        return float(np.mean(np.abs(ck.force_analysis(motion).shaking.force[:-1]) ** 2))

    own = {one.link: complex(one.mass * one.at) for one in found.counterweights}
    least = rest(own)
    for name, moment in own.items():
        for factor in (
            0.99,
            np.exp(0.01j),
            np.exp(-0.01j),
            *([1.01] if masses[name] < bounds.get(name, 9.9) * 0.99 else []),
        ):
            assert rest({**own, name: moment * factor}) >= least * (1.0 - 1e-9)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"mass": 0.4, "most_mass": 1.0}, "most_mass: the mass on crank is given"),
        ({"most_radius": 50}, "most_radius: crank has its counterweight at a given radius"),
        ({"most_mass": -1.0}, "most_mass"),
        ({"most_mass": {"crnk": 1.0}}, "crnk"),
    ],
    ids=str,
)
def test_bounds_that_mean_nothing_are_told(given: dict[str, object], told: str) -> None:
    with pytest.raises(ck.errors.CompoundkinError, match=told):
        ck.figures.counterweights(FOUR_BAR, **given)
