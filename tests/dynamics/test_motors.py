"""Motors: torques over speed against closed forms and quadrature, gears against what they stand for, run-ups."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

import compoundkin as ck
from compoundkin.dynamics.motor_sizing import ListedMotor
from compoundkin.errors import InvalidInput, InvalidMechanism
from compoundkin.files import dumps, loads

SI = {"length": "m", "mass": "kg", "force": "N"}


def rotor(*more: object, inertia: float = 0.05) -> ck.Mechanism:
    links = ck.link("frame", O=0), ck.link("rotor", O=0, P=1), ck.drive("rotor")
    return ck.Mechanism("Rotor", *links, ck.mass("rotor", 1.0, at="O", inertia=inertia), *more, units=SI)


def torques(motor: object, speeds: np.ndarray) -> np.ndarray:
    """What a motor gives at speeds of its pair, by the effort that it leaves to the driver."""
    found = [ck.force_analysis(ck.solve(rotor(motor), [0.0], speed=speed)).drives["rotor"].effort for speed in speeds]
    return -np.ravel(found)


def test_a_direct_current_motor_runs_up_as_an_exponential() -> None:
    """J w' = M0 (1 - w / w0): w = w0 (1 - exp(-t / T)), T = J w0 / M0."""
    found = ck.simulate(rotor(ck.motor("rotor", stall=4.0, no_load=100.0)), start=0.0, until=5.0)
    lag = 0.05 * 100.0 / 4.0
    rates = 100.0 * (1.0 - np.exp(-found.times / lag))
    np.testing.assert_allclose(found.motion.drives["rotor"].rate, rates, rtol=0, atol=1e-8 * 100.0)
    assert found.energy.worst < 1e-9


def test_an_induction_motor_follows_kloss() -> None:
    """The greatest torque is at its slip, and slips whose product is its square have the same torque."""
    motor = ck.motor("rotor", breakdown=30.0, synchronous=157.0, slip=0.2)
    at = lambda s: float(torques(motor, np.array([157.0 * (1.0 - s)]))[0])  # noqa: E731
    assert at(0.2) == pytest.approx(30.0, rel=1e-14)
    assert max(at(0.199), at(0.201)) < 30.0
    for s in (0.01, 0.05, 0.5, 1.0):
        assert at(s) == pytest.approx(at(0.04 / s), rel=1e-12)
        assert at(s) == pytest.approx(60.0 / (s / 0.2 + 0.2 / s), rel=1e-13)
    assert at(0.0) == pytest.approx(0.0, abs=1e-12)
    assert at(-0.2) == pytest.approx(-30.0, rel=1e-14)  # a generator beyond the speed of its field


def test_the_run_up_of_an_induction_motor_takes_the_time_of_the_quadrature() -> None:
    """t = J int dw / (M(w) - ML)."""
    motor, load = ck.motor("rotor", breakdown=30.0, synchronous=157.0, slip=0.2), ck.torque("rotor", -8.0)
    reached = lambda state: state["rotor.angular_velocity"] - 140.0  # noqa: E731
    found = ck.simulate(rotor(motor, load), start=0.0, until=5.0, events={"reached": reached}, stop="reached")

    def surplus(w: float) -> float:
        s = 1.0 - w / 157.0
        return 60.0 / (s / 0.2 + 0.2 / s) - 8.0

    time = 0.05 * quad(lambda w: 1.0 / surplus(w), 0.0, 140.0, epsabs=0, epsrel=1e-12)[0]
    assert found.events[-1].time == pytest.approx(time, rel=1e-8)
    held = ck.simulate(rotor(motor, load), start=0.0, until=5.0).motion.drives["rotor"].rate[-1]
    slip = np.roots([8.0 / 0.2, -60.0, 8.0 * 0.2]).min()
    assert held == pytest.approx(157.0 * (1.0 - slip), rel=1e-8)


def test_a_gear_is_an_effort_and_an_inertia() -> None:
    """Behind a gear a motor has gear times the torque, and the square of the gear times the inertia."""
    geared = ck.motor("rotor", stall=0.4, no_load=1000.0, gear=10.0, inertia=2e-4)
    direct = ck.effort("rotor", lambda w: 4.0 * (1.0 - w / 100.0))
    one = ck.simulate(rotor(geared), start=0.0, until=2.0, times=[0.0, 1.0, 2.0])
    other = ck.simulate(rotor(direct, inertia=0.05 + 0.02), start=0.0, until=2.0, times=[0.0, 1.0, 2.0])
    np.testing.assert_allclose(one.motion.drives["rotor"].value, other.motion.drives["rotor"].value, rtol=1e-11)
    assert np.max(np.abs(one.forces.drives["rotor"].effort)) < 1e-9
    assert ck.verify(one.forces).passed


@pytest.mark.parametrize(("speed", "torque"), [(-5.0, 4.0 / 0.8), (5.0, 4.0 * 0.8)])
def test_the_loss_of_a_gear_is_against_the_flow_of_power(speed: float, torque: float) -> None:
    """A motor that drives loses a part in the gear; one that is driven back is the harder to turn."""
    motor = ck.motor("rotor", torque=0.4, gear=10.0, efficiency=0.8)
    assert torques(motor, np.array([speed]))[0] == pytest.approx(torque, rel=1e-14)


@pytest.mark.parametrize(("stall", "load", "begun"), [(0.4, 0.0, 0.0), (0.4, -8.0, -30.0), (0.0, 6.0, 3.0)])
def test_a_rotor_is_before_the_losses_of_its_gear(stall: float, load: float, begun: float) -> None:
    """J a = L + e n (M - n Jm a): a = (L + e n M) / (J + e n^2 Jm), with 1 / e while the load drives the motor."""
    motor = ck.motor("rotor", torque=stall, gear=10.0, efficiency=0.7, inertia=5e-4)
    loads = motor, *([ck.torque("rotor", load)] if load else [])
    e = 0.7 if begun == 0.0 else 1.0 / 0.7
    second = (load + e * 10.0 * stall) / (0.05 + e * 100.0 * 5e-4)
    passed = 10.0 * (stall - 10.0 * 5e-4 * second)
    assert passed * (begun or 1.0) * (1.0 if e == 0.7 else -1.0) > 0.0, "the closed form is of the other sense"
    until = 0.9 * abs(begun / second) if begun * second < 0.0 else 0.5
    found = ck.simulate(rotor(*loads), start=(0.0, begun), until=until)
    np.testing.assert_allclose(
        found.motion.drives["rotor"].rate, begun + second * found.times, rtol=0, atol=1e-10 * 60.0
    )
    assert np.max(np.abs(found.forces.drives["rotor"].effort)) < 1e-9
    assert found.energy.worst < 1e-9
    assert ck.verify(found.forces).passed


def test_the_run_up_of_a_motor_behind_a_lossy_gear_is_an_exponential() -> None:
    """(J + e n^2 Jm) w' = e n M0 (1 - n w / w0)."""
    motor = ck.motor("rotor", stall=0.4, no_load=1000.0, gear=10.0, efficiency=0.8, inertia=2e-4)
    found = ck.simulate(rotor(motor), start=0.0, until=3.0)
    lag = (0.05 + 0.8 * 100.0 * 2e-4) * 100.0 / (0.8 * 4.0)
    np.testing.assert_allclose(
        found.motion.drives["rotor"].rate, 100.0 * (1.0 - np.exp(-found.times / lag)), rtol=0, atol=1e-8 * 100.0
    )


def test_a_lossy_rotor_is_in_the_units_of_its_mechanism() -> None:
    """Millimetres, newtons and kilograms: a moment is a thousandth of what kg mm^2 / s^2 is."""
    motor = ck.motor("rotor", stall=400.0, no_load=1000.0, gear=10.0, efficiency=0.8, inertia=200.0)
    mechanism = rotor(motor).replace(
        ck.mass("rotor", 2.0, inertia=50e3, at=0.0), units={"length": "mm", "mass": "kg", "force": "N"}
    )
    found = ck.simulate(mechanism, start=0.0, until=3.0)
    lag = (50.0 + 0.8 * 100.0 * 0.2) * 100.0 / (0.8 * 4000.0)
    np.testing.assert_allclose(
        found.motion.drives["rotor"].rate, 100.0 * (1.0 - np.exp(-found.times / lag)), rtol=0, atol=1e-8 * 100.0
    )


def test_what_sizing_asks_of_a_motor_is_what_it_gives_in_the_run_up() -> None:
    """Torques at the shaft over the simulated motion, of the same rotor behind the same gear with the same losses."""
    motor = ck.motor("rotor", stall=0.4, no_load=1000.0, gear=10.0, efficiency=0.8, inertia=2e-4)
    run = ck.simulate(rotor(motor), start=(0.0, 1.0), until=3.0)
    listed = ListedMotor("same", 1.0, 1.0, 1e3, 1e3, 2e-4, ((0.0, 1e3), (1.0, 1.0)))
    torques, speeds = ck.figures.sizing(run.forces, [listed], gear=10.0, efficiency=0.8).at_shaft(listed, 10.0)
    np.testing.assert_allclose(torques, 0.4 * (1.0 - speeds / 1000.0), rtol=0, atol=1e-9)


def test_statics_of_a_motor_behind_a_lossy_gear_has_no_rotor() -> None:
    motor = ck.motor("rotor", torque=0.4, gear=10.0, efficiency=0.8, inertia=2e-4)
    motion = ck.solve(rotor(motor), {"rotor": [0.0]}, speed=2.0, acceleration=50.0)
    still = ck.force_analysis(motion, inertia=False)
    assert np.ravel(still.drives["rotor"].effort)[0] == pytest.approx(-3.2, rel=1e-14)
    assert ck.verify(still).passed


@pytest.mark.full
def test_a_lossy_rotor_in_a_linkage_with_two_drivers() -> None:
    """The equation of motion holds at all times: drivers are left without effort, and powers add up."""
    links = [ck.link("frame", A=0), ck.link("upper", A=0, B=1), ck.link("lower", B=0, C=0.7)]
    masses = ck.mass("upper", 2.0, at=(0.5, 0), inertia=0.2), ck.mass("lower", 1.0, at=(0.3, 0), inertia=0.05)
    drives = ck.drive("upper"), ck.drive("lower", on="upper")
    motor = ck.motor("upper", stall=2.0, no_load=200.0, gear=20.0, efficiency=0.6, inertia=2e-3)
    arm = ck.Mechanism("Arm", *links, *masses, *drives, motor, ck.gravity(0, -9.81), units=SI)
    found = ck.simulate(arm, start={"upper": (0.2, 0.0), "lower": (0.4, 0.0)}, until=1.0)
    efforts = [np.max(np.abs(found.forces.drives[name].effort)) for name in ("upper", "lower")]
    assert max(efforts) < 1e-7
    assert found.energy.worst < 1e-8


def test_a_lossy_rotor_with_friction_is_refused() -> None:
    motor = ck.motor("rotor", torque=0.4, efficiency=0.8, inertia=2e-4)
    with pytest.raises(InvalidInput, match="with friction, a rotor before a gear"):
        ck.simulate(rotor(motor, ck.friction("O", 0.1, radius=0.01)), start=0.0, until=0.1)


def test_a_table_and_its_bounds() -> None:
    table = {"at": [0.0, 50.0, 100.0], "values": [5.0, 4.0, 0.0]}
    found = torques(ck.motor("rotor", torque=table, limit=4.5, power=100.0), np.array([0.0, 20.0, 40.0, 75.0]))
    np.testing.assert_allclose(found, [4.5, 4.5, 100.0 / 40.0, 100.0 / 75.0], rtol=1e-14)


def test_a_servo_keeps_its_speed_as_far_as_its_torque_goes() -> None:
    """At full torque up to near the speed, then exponentially: J w' = k (w0 - w)."""
    servo = ck.motor("rotor", speed=20.0, gain=5.0, limit=2.0)
    found = ck.simulate(rotor(servo), start=0.0, until=1.0)
    bend = 20.0 - 2.0 / 5.0
    time = 0.05 * bend / 2.0
    rates = np.where(found.times < time, 40.0 * found.times, 20.0 - 0.4 * np.exp(-(found.times - time) * 100.0))
    np.testing.assert_allclose(found.motion.drives["rotor"].rate, rates, rtol=0, atol=1e-7)


def test_files_there_and_back() -> None:
    motors = [
        ck.motor("rotor", stall=4.0, no_load=100.0, gear=-3.0, efficiency=0.9, inertia=1e-3, limit=3.0),
        ck.motor("rotor", breakdown=30.0, synchronous=157.0, slip=0.2, power=1e3, name="second"),
        ck.motor("O", torque={"at": [0.0, 1.0], "values": [2.0, 1.0]}, name="third"),
        ck.motor("O", speed=20.0, gain=5.0, name="fourth"),
    ]
    written = rotor(*motors)
    assert loads(dumps(written)) == written
    assert loads(dumps(written)).masses["rotor"].inertia == pytest.approx(0.05 + 9e-3)
    rpm = dumps(rotor(ck.motor("rotor", stall=4.0, no_load=1.0))).replace("no_load = 1", "no_load = { rpm = 3000 }")
    assert loads(rpm).loads["motor along rotor"].no_load == pytest.approx(np.pi * 100.0)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        (ck.motor("rotor"), "nothing says which motor"),
        (ck.motor("rotor", stall=3.0), "no_load: it is missing"),
        (ck.motor("rotor", stall=3.0, no_load=-1.0), "no_load: -1 is no speed above zero"),
        (ck.motor("rotor", stall=0.0, no_load=1.0), "stall: 0 is not above zero"),
        (ck.motor("rotor", stall=3.0, no_load=1.0, slip=0.2), "slip: it belongs to another motor than stall"),
        (ck.motor("rotor", breakdown=3.0, synchronous=1.0, slip=2.0), "slip: 2 is no slip"),
        (ck.motor("rotor", torque=3.0, efficiency=1.2), "efficiency: 1.2 is no efficiency"),
        (ck.motor("rotor", torque=3.0, gear=0.0), "gear: a motor that does not turn"),
        (ck.motor("rotor", torque=3.0, inertia=-1.0), "inertia: an inertia is not below zero"),
        (ck.motor("rotr", torque=3.0), "did you mean"),
    ],
)
def test_impossible_motors_are_refused(wrong: object, told: str) -> None:
    with pytest.raises(InvalidMechanism, match=told):
        rotor(wrong)


def test_a_motor_along_a_slide_needs_the_gear_of_its_screw() -> None:
    """A screw with the lead 5 mm: 2 pi / 0.005 m; the thrust is 2 pi M / lead."""
    links = ck.link("frame", O=0), ck.link("block", P=0), ck.slide("block", on="frame", through="O", name="guide")
    parts = *links, ck.drive("block"), ck.mass("block", 2.0)
    with pytest.raises(InvalidMechanism, match="'guide' slides, and a motor turns; give the angle of its shaft"):
        ck.Mechanism("Block", *parts, ck.motor("guide", stall=2.0, no_load=100.0), units=SI)
    screw = ck.Mechanism("B", *parts, ck.motor("guide", torque=0.5, gear=2.0 * np.pi / 0.005), units=SI)
    forces = ck.force_analysis(ck.solve(screw, [0.0, 0.1], speed=0.02), inertia=False)
    assert forces.drives["block"].effort == pytest.approx(-0.5 * 2.0 * np.pi / 0.005)


# --- sizing -------------------------------------------------------------------------------------------------


def swung(times: np.ndarray, *more: object) -> ck.results.Forces:
    """An arm of J = 0.5 kg m^2 that swings as a sine, 0.4 rad at 5 rad/s."""
    links = ck.link("frame", O=0), ck.link("arm", O=0, P=1), ck.drive("arm", law=lambda t: 0.4 * np.sin(5.0 * t))
    arm = ck.Mechanism("Arm", *links, ck.mass("arm", 2.0, at="O", inertia=0.5), *more, units=SI)
    return ck.force_analysis(ck.solve(arm, time=times))


PERIOD = np.linspace(0.0, 2.0 * np.pi / 5.0, 401)


def test_the_best_gear_of_an_inertia_makes_both_inertias_equal() -> None:
    """T = J a at the load, and i Jm a + J a / i at the shaft: least where i^2 = J / Jm, twice the one part."""
    found = ck.figures.sizing(swung(PERIOD))
    assert found.inertia == pytest.approx(0.5, rel=1e-12)
    assert found.peak == pytest.approx(0.5 * 0.4 * 25.0, rel=1e-6)
    assert found.rms == pytest.approx(5.0 / np.sqrt(2.0), rel=1e-6)
    free = [one for one in found.motors if np.sqrt(0.5 / one.motor.inertia) * 2.0 < one.motor.rated_speed]
    assert len(free) > 3
    for one in free:
        assert one.gear == pytest.approx(np.sqrt(0.5 / one.motor.inertia), rel=1e-5)
        assert one.reflected == pytest.approx(1.0, rel=1e-5)
        assert one.rms == pytest.approx(2.0 * np.sqrt(0.5 * one.motor.inertia) * 10.0 / np.sqrt(2.0), rel=1e-5)


def test_no_other_gear_has_a_lesser_effective_torque() -> None:
    """Against a search, with a load that is no inertia and losses in the gear."""
    found = ck.figures.sizing(swung(PERIOD, ck.damper(pair="O", rate=3.0), ck.torque("arm", -2.0)), efficiency=0.8)
    for one in found.motors[::3]:
        tried = np.geomspace(one.gear / 30.0, one.motor.rated_speed / found.speed, 3000)
        rms = [np.sqrt(np.mean(np.square(found.at_shaft(one.motor, gear)[0][:-1]))) for gear in tried]
        assert one.rms <= min(rms) * (1.0 + 1e-6)


def test_what_motors_give_already_counts_as_needed() -> None:
    alone = ck.figures.sizing(swung(PERIOD))
    helped = ck.figures.sizing(swung(PERIOD, ck.motor("arm", torque={"at": [-5.0, 5.0], "values": [3.0, -3.0]})))
    np.testing.assert_allclose(helped.torques, alone.torques, atol=1e-9)


def test_the_rotor_of_a_motor_that_is_there_is_not_needed_twice() -> None:
    """It was in what the machine needs, and the listed motor's own came on top."""
    alone = ck.figures.sizing(swung(PERIOD))
    curve = {"at": [-99.0, 99.0], "values": [3.0, -3.0]}
    driven = ck.figures.sizing(swung(PERIOD, ck.motor("arm", torque=curve, gear=4.0, inertia=0.7)))
    np.testing.assert_allclose(driven.torques, alone.torques, atol=1e-9 * alone.peak)
    assert driven.inertia == pytest.approx(alone.inertia, rel=1e-9)


def test_a_motion_that_needs_no_torque_says_so() -> None:
    """A rotor at constant speed without loads, also where a motor gives what its driver takes again."""
    for more in ((), (ck.motor("rotor", stall=5.0, no_load=100.0, gear=3.0, efficiency=0.9, inertia=0.001),)):
        sized = ck.figures.sizing(ck.force_analysis(ck.solve(rotor(*more), speed=20.0)))
        assert sized.peak == 0.0
        assert "It needs no torque in this motion" in sized.text()


def test_a_machine_that_drives_its_shaft_is_no_load() -> None:
    """A constant torque of 3 N m drives a rotor at 20 rad/s, 60 W."""
    sized = ck.figures.sizing(ck.force_analysis(ck.solve(rotor(ck.torque("rotor", 3.0)), speed=20.0)))
    assert sized.verdict.startswith("It gives 60 W on the average")


def test_a_dwell_cools_the_motor() -> None:
    """At rest for three quarters of the time, the effective torque is half of what it is without."""
    whole = np.linspace(0.0, 4.0 * PERIOD[-1], 4001)
    law = ck.laws.motion_table(whole, *(np.where(whole < PERIOD[-1], one, 0.0) for one in (
        0.4 * np.sin(5.0 * whole), 2.0 * np.cos(5.0 * whole), -10.0 * np.sin(5.0 * whole))))  # fmt: skip
    links = ck.link("frame", O=0), ck.link("arm", O=0, P=1), ck.drive("arm", law=law)
    arm = ck.Mechanism("Arm", *links, ck.mass("arm", 2.0, at="O", inertia=0.5), units=SI)
    found = ck.figures.sizing(ck.force_analysis(ck.solve(arm, time=whole)))
    assert found.rms == pytest.approx(0.5 * ck.figures.sizing(swung(PERIOD)).rms, rel=1e-2)
    assert found.duty == pytest.approx(0.25, abs=1e-2)


def test_a_list_of_ones_own_and_what_is_wrong_with_it(tmp_path) -> None:  # type: ignore[no-untyped-def]
    path = tmp_path / "mine.toml"
    good = 'name = "m"\nrated = 10\npeak = 20\nrated_speed = 600\ntop_speed = 1200\ninertia = 0.5\n'
    path.write_text(f"[[motors]]\n{good}")
    found = ck.figures.sizing(swung(PERIOD), path)
    assert found.chosen is not None
    assert found.chosen.motor.name == "m"
    assert "The smallest that does: m" in found.text()
    for wrong, told in (
        ("motors = 3", "it has no motors"),
        ("[[motors]]\nname = 'a'", "rated: None is no number"),
        (f"[[motors]]\n{good}ratd = 2", "ratd: no motor has such a key"),
        (f"[[motors]]\n{good}curve = {{ speeds = [0, 0], torques = [1, 2] }}", "it is no curve"),
        ("[[motors", "it is no TOML"),
    ):
        path.write_text(wrong)
        with pytest.raises(InvalidInput, match=told):
            ck.figures.sizing(swung(PERIOD), path)
    with pytest.raises(InvalidInput, match="cannot be read"):
        ck.figures.sizing(swung(PERIOD), tmp_path / "none.toml")
    with pytest.raises(InvalidInput, match="no efficiency"):
        ck.figures.sizing(swung(PERIOD), efficiency=1.5)


def test_units_of_the_mechanism_do_not_matter() -> None:
    """A slide in mm and kg: thrusts in N, speeds in m/s."""
    links = ck.link("frame", O=0), ck.link("ram", P=0), ck.slide("ram", on="frame", at="P", through="O", name="way")
    drive = ck.drive("ram", law=lambda t: 100.0 * np.sin(5.0 * t))
    ram = ck.Mechanism("Ram", *links, drive, ck.mass("ram", 2.0), units={"length": "mm", "mass": "kg", "force": "N"})
    found = ck.figures.sizing(ck.force_analysis(ck.solve(ram, time=PERIOD)))
    assert found.peak == pytest.approx(2.0 * 0.1 * 25.0, rel=1e-6)
    assert found.speed == pytest.approx(0.5, rel=1e-9)
    assert found.inertia == pytest.approx(2.0, rel=1e-12)


def test_the_command() -> None:
    from click.testing import CliRunner

    from compoundkin.cli import cli

    said = CliRunner().invoke(cli, ["size", "shaper-cutting-force"], catch_exceptions=False)
    assert said.exit_code == 0
    assert "The smallest that does" in said.output


def test_how_long_more_is_asked_than_a_motor_gives() -> None:
    """A sine is above c times its peak for 1 - 2 arcsin(c) / pi of the time, at a curve that does not fall too."""
    peak = 0.5 * 0.4 * 25.0
    flat = ListedMotor("flat", 2.0, 4.0, 100.0, 100.0, 1e-12, ((0.0, 100.0), (4.0, 4.0)))
    (one,) = ck.figures.sizing(swung(PERIOD), [flat], gear=1.0).motors
    assert one.beyond_rated == pytest.approx(1.0 - 2.0 * np.arcsin(2.0 / peak) / np.pi, abs=1e-4)
    assert one.beyond_curve == pytest.approx(1.0 - 2.0 * np.arcsin(4.0 / peak) / np.pi, abs=1e-4)
    assert "for 41 % of the time" in one.reasons[-1]


def test_the_plot_has_the_motion_at_the_shaft_and_the_curves_of_the_motor() -> None:
    found = ck.figures.sizing(swung(PERIOD, ck.damper(pair="O", rate=3.0)))
    chosen = found.chosen
    assert chosen is not None
    (axes,) = ck.plots.motor_curves(found).figure.axes
    lines = {line.get_label(): line for line in axes.get_lines()}
    torques, speeds = found.at_shaft(chosen.motor, chosen.gear)
    course = lines["over the motion"]
    np.testing.assert_allclose(course.get_xdata()[:-1], speeds / (2.0 * np.pi / 60.0))
    np.testing.assert_allclose(course.get_ydata()[:-1], torques)
    limit = lines["greatest"]
    paces = np.abs(limit.get_xdata()) * 2.0 * np.pi / 60.0
    np.testing.assert_allclose(np.abs(limit.get_ydata()), np.interp(paces, *chosen.motor.curve))
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'servo 100 W'"):
        ck.plots.motor_curves(found, "servo 10 W")


# --- tables over a rate ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("load", [ck.effort, ck.torque])
def test_a_table_over_the_rate_runs_a_rotor_up(load: Any, tmp_path: Path) -> None:
    """T = 5 (1 - w / 100): w = 100 (1 - exp(-T0 t / (100 J))), the same from a file, and the torque in a motion."""
    table = {"over": "rate", "at": [-50.0, 100.0, 120.0], "values": [7.5, 0.0, -1.0]}
    driven = rotor(load("rotor", table))
    ck.save(driven, tmp_path / "rotor.toml")
    for one in (driven, ck.load(tmp_path / "rotor.toml")):
        found = ck.simulate(one, start=(0.0, 0.0), until=1.0)
        np.testing.assert_allclose(found.motion.drives["rotor"].rate, 100.0 * (1.0 - np.exp(-found.times)), atol=1e-8)
        held = ck.force_analysis(ck.solve(one, [0.0, 1.0], speed=40.0)).drives["rotor"].effort
        np.testing.assert_allclose(held, -3.0)


def test_tables_over_a_rate_belong_to_efforts_and_torques() -> None:
    table = {"over": "rate", "at": [0.0, 1.0], "values": [0.0, 1.0]}
    with pytest.raises(ck.errors.InvalidMechanism, match="no pair, pin or driver 'rate'"):
        rotor(ck.force("rotor", (0, table), at="P"))
    brake = rotor(ck.effort("rotor", table))
    with pytest.raises(ck.errors.InvalidInput, match="2 is outside its table, 0 to 1"):
        _ = ck.force_analysis(ck.solve(brake, [0.0, 1.0], speed=2.0)).drives["rotor"].effort


# --- pressure on pistons --------------------------------------------------------------------------------------


def piston(*more: object) -> ck.Mechanism:
    """A piston of 3 kg that slides along x, lengths in mm."""
    return ck.Mechanism(
        "Piston",
        ck.link("frame", O=0),
        ck.link("piston", P=0),
        ck.slide("piston", on="frame", at="P", through="O", angle=0, name="stroke"),
        ck.drive("piston"),
        ck.mass("piston", 3.0, at="P", inertia=0.0),
        *more,
        units={"length": "mm", "mass": "kg", "force": "N"},
    )


@pytest.mark.full
def test_a_piston_under_two_pressures_accelerates() -> None:
    """(p A - b (A - a)) / m from rest, and its effort held at a speed is that thrust the other way."""
    area, rod = np.pi * 50.0**2 / 4.0, np.pi * 28.0**2 / 4.0
    thrust = 0.8 * area - 0.1 * (area - rod)
    for size in ({"bore": 50}, {"area": area}):
        pushed = piston(ck.pressure("stroke", 0.8, **size, rod=28, back=0.1))
        found = ck.simulate(pushed, start=(0.0, 0.0), until=0.05)
        np.testing.assert_allclose(found.motion.drives["piston"].rate, thrust / 3.0 * 1e3 * found.times, rtol=1e-9)
        held = ck.force_analysis(ck.solve(pushed, [0.0, 10.0], speed=5.0)).drives["piston"]
        np.testing.assert_allclose(held.effort, -thrust)
        assert found.energy.work[-1] == pytest.approx(thrust * found.motion.drives["piston"].value[-1], rel=1e-9)


def test_gas_that_is_pressed_swings_as_an_adiabatic_spring(tmp_path: Path) -> None:
    """p V^n is constant: the energy of a piston let go, p0 V0 ((V0 / V)^(n - 1) - 1) / (n - 1), and the kinetic one."""
    bore, length, first, n = 40.0, 100.0, 0.3, 1.4
    gas = piston(ck.pressure("stroke", lambda q: first * (length / (length + q)) ** n, bore=bore))
    found = ck.simulate(gas, start=(-20.0, 0.0), until=0.02)
    q, v = found.motion.drives["piston"].value, found.motion.drives["piston"].rate
    volume = np.pi * bore**2 / 4.0 * length
    stored = first * volume / (n - 1.0) * (length / (length + q)) ** (n - 1.0)
    whole = stored + 3.0 * v**2 / 2e3
    np.testing.assert_allclose(whole, whole[0], rtol=1e-9)
    table = {"at": [-50.0, 0.0, 50.0], "values": [0.8, 0.3, 0.2]}
    written = piston(
        ck.pressure("stroke", table, bore=bore, rod=10, back={"over": "rate", "at": [-1, 1], "values": [0, 1]})
    )
    ck.save(written, tmp_path / "gas.toml")
    again = ck.load(tmp_path / "gas.toml")
    efforts = [ck.force_analysis(ck.solve(one, [-10.0, 20.0], speed=0.5)).drives["piston"].effort
               for one in (written, again)]  # fmt: skip
    np.testing.assert_array_equal(*efforts)


@pytest.mark.parametrize(("words", "said"), [
    ({}, "bore or the area"), ({"bore": 5, "area": 3}, "bore or the area"), ({"bore": 0}, "not above zero"),
    ({"bore": 5, "rod": 5}, "not thinner"), ({"area": -3}, "not above zero"),
])  # fmt: skip
def test_pistons_that_are_none(words: dict[str, float], said: str) -> None:
    with pytest.raises(InvalidMechanism, match=said):
        piston(ck.pressure("stroke", 1.0, **words))
    with pytest.raises(InvalidMechanism, match="a piston slides"):
        rotor(ck.pressure("O", 1.0, bore=3))
