"""Forward dynamics, with and without friction."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.dynamics.simulation.contact_watches import begin_at_stops
from compoundkin.dynamics.simulation.coordinate_change import by_links, chart_of
from compoundkin.dynamics.simulation.driver_chart import DriverChart
from compoundkin.dynamics.simulation.forward_dynamics import simulation_start
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.dynamics.simulation.integration import integrate
from compoundkin.dynamics.simulation.simulated_course import SimulatedCourse
from compoundkin.dynamics.simulation.tabulated_chart import TabulatedChart
from compoundkin.errors import FewDigits, InvalidInput, UnknownName
from tests.dynamics.cases import SI
from tests.dynamics.moving_cases import (
    ENTRY,
    SQUEEZER,
    five_bar,
    four_bar,
    slider_crank,
    squeezer,
    squeezer_angles,
)

# The reference is good to about this: quadrature at 30 digits, integration to 1e-10.
TOLERANCE = 1e-9


def test_slider_crank_let_go() -> None:
    """Times, speeds and accelerations of the fall, by quadrature."""
    rows = ENTRY["expected"]["slider_crank"]["rows"]
    times = [0.0, *(row["time"] for row in rows)]
    found = ck.simulate(slider_crank(), start=ck.deg(60), until=times[-1], times=times, tolerance=1e-12)
    crank = found.motion.drives["crank"]
    assert crank.second[0] == pytest.approx(ENTRY["expected"]["slider_crank"]["initial_acceleration"], rel=TOLERANCE)
    np.testing.assert_allclose(crank.value[1:], ck.deg([row["crank_deg"] for row in rows]), atol=TOLERANCE)
    np.testing.assert_allclose(crank.rate[1:], [row["speed"] for row in rows], rtol=TOLERANCE)
    np.testing.assert_allclose(crank.second[1:], [row["acceleration"] for row in rows], rtol=TOLERANCE, atol=1e-6)
    np.testing.assert_allclose(found.motion.points["B"].y[1:], [row["piston_y"] for row in rows], rtol=TOLERANCE)
    assert np.max(np.abs(found.forces.drives["crank"].effort)) < 1e-9
    assert found.energy.worst < 1e-11


def test_four_bar_under_a_torque() -> None:
    """A full turn from rest: times by quadrature; the torque's work is the torque times the angle."""
    rows = ENTRY["expected"]["four_bar"]["rows"]
    times = [0.0, *(row["time"] for row in rows)]
    found = ck.simulate(four_bar(), start={"crank": 0.0}, until=times[-1], times=times, tolerance=1e-12)
    crank = found.motion.drives["crank"]
    np.testing.assert_allclose(crank.value[1:], ck.deg([row["crank_deg"] for row in rows]), atol=TOLERANCE)
    np.testing.assert_allclose(crank.rate[1:], [row["speed"] for row in rows], rtol=TOLERANCE)
    np.testing.assert_allclose(crank.second[1:], [row["acceleration"] for row in rows], rtol=TOLERANCE)
    np.testing.assert_allclose(found.motion.points["B"].position.xy[1:], [row["B"] for row in rows], atol=TOLERANCE)
    np.testing.assert_allclose(found.energy.work, 0.5 * crank.value, atol=TOLERANCE)
    np.testing.assert_allclose(found.energy.kinetic, 0.5 * crank.value, atol=TOLERANCE)


def test_five_bar_let_go() -> None:
    """Two freedoms: both coordinates, speeds and accelerations, and where the bars meet."""
    rows = ENTRY["expected"]["five_bar"]["rows"]
    times = [0.0, *(row["time"] for row in rows)]
    start = dict(zip(("left", "right"), ck.deg([100, 60]), strict=True))
    found = ck.simulate(five_bar(), start=start, until=times[-1], times=times, tolerance=1e-12)
    for k, name in enumerate(("left", "right")):
        own = found.motion.drives[name]
        assert own.second[0] == pytest.approx(ENTRY["expected"]["five_bar"]["initial_accelerations"][k], rel=TOLERANCE)
        np.testing.assert_allclose(own.value[1:], [row[f"{name}_rad"] for row in rows], atol=TOLERANCE)
        np.testing.assert_allclose(own.rate[1:], [row[f"{name}_speed"] for row in rows], rtol=TOLERANCE)
        np.testing.assert_allclose(own.second[1:], [row[f"{name}_acceleration"] for row in rows], rtol=TOLERANCE)
        assert np.max(np.abs(found.forces.drives[name].effort)) < 1e-10
    np.testing.assert_allclose(found.motion.points["Q"].position.xy[1:], [row["Q"] for row in rows], atol=TOLERANCE)


def test_dead_point_is_passed_by_another_coordinate() -> None:
    """Driven by the piston, the crank takes its place at the dead point: the same motion as by the crank."""
    by_crank = ck.simulate(slider_crank(), start={"crank": ck.deg(60)}, until=0.6, tolerance=1e-11)
    height = float(by_crank.motion.points["B"].y[0])
    by_piston = ck.simulate(slider_crank(ck.drive("piston")), start={"piston": height}, until=0.6,
                            times=by_crank.times, tolerance=1e-11)  # fmt: skip
    assert [event.name for event in by_piston.events] == ["coordinate"]
    np.testing.assert_allclose(
        by_piston.motion.points["B"].position.xy, by_crank.motion.points["B"].position.xy, atol=1e-9
    )
    np.testing.assert_allclose(
        by_piston.motion.points["A"].position.xy, by_crank.motion.points["A"].position.xy, atol=1e-8
    )
    assert by_piston.motion.assembled.all()
    assert by_piston.energy.worst < 1e-9


def test_one_driver_prescribed_and_one_free() -> None:
    """A pendulum on a support that is shaken: Kapitza's equation of motion, integrated by itself."""
    from scipy.integrate import solve_ivp

    length, sway, pace = 0.5, 0.1, 9.0
    shaken = ck.Mechanism(
        "Pendulum on a sliding support",
        ck.link("frame", O=(0, 0)),
        ck.link("block", P=(0, 0)),
        ck.link("bar", P=(0, 0), G=(length, 0)),
        ck.slide("block", on="frame", at="P", through="O", angle=0, name="way"),
        ck.drive("block"),
        ck.drive("bar", on="block"),
        ck.mass("bar", 2.0, at="G", inertia=0.0),
        ck.mass("block", 1.0, at="P", inertia=0.0),
        ck.gravity(0, -9.81),
        units=SI,
    )
    found = ck.simulate(shaken, start={"bar": (-1.0, 0.3)}, prescribed={"block": lambda t: sway * np.sin(pace * t)},
                        until=2.0, tolerance=1e-11)  # fmt: skip

    def grown(t: float, y: np.ndarray) -> list[float]:
        support = -sway * pace**2 * np.sin(pace * t)
        return [y[1], (support * np.sin(y[0]) - 9.81 * np.cos(y[0])) / length]

    known = solve_ivp(grown, (0, 2), [-1.0, 0.3], "DOP853", found.times, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(found.motion.drives["bar"].value, known.y[0], atol=1e-8)
    assert found.energy.worst < 1e-8
    assert np.max(np.abs(found.forces.drives["bar"].effort)) < 1e-6


def test_andrews_squeezer() -> None:
    """The published state after 0.03 s: angles, speeds, accelerations and the forces at P; the energy adds up."""
    first, last, allowed = (SQUEEZER["expected"][key] for key in ("t=0", "t=0.03", "tolerance"))
    found = ck.simulate(squeezer(), start=first["beta"], until=0.03, tolerance=1e-12)
    angles = [one[-1] for one in squeezer_angles(found.motion)]
    expected = np.array(last["q"])
    np.testing.assert_allclose(np.exp(1j * np.array(angles)), np.exp(1j * expected), atol=allowed["angles"])
    assert found.motion.drives["K1"].value[-1] == pytest.approx(expected[0], abs=allowed["angles"])
    assert found.motion.drives["K1"].value[-1] == pytest.approx(
        SQUEEZER["expected"]["t=0.03 computed"]["beta"], abs=1e-10
    )
    rates, second = ([one[-1] for one in squeezer_angles(found.motion, k)] for k in (1, 2))
    np.testing.assert_allclose(rates, last["qd"], rtol=allowed["speeds_relative"])
    np.testing.assert_allclose(second, last["qdd"], rtol=allowed["accelerations_relative"])
    pin = found.forces.pins["P"]
    told = [
        part for link in ("K3", "K4", "K6") for force in (pin.on(link).force[-1],) for part in (force.real, force.imag)
    ]
    np.testing.assert_allclose(told, last["multipliers"], rtol=allowed["multipliers_relative"])
    assert found.energy.worst < 1e-9
    np.testing.assert_allclose(squeezer_angles(found.motion, 2)[0][0], first["second_derivatives"][0], rtol=1e-9)


@pytest.mark.parametrize(
    ("given", "error", "told"),
    [
        ({"start": {"piston": 1.0}}, UnknownName, "start.piston"),
        ({"start": {"crank": "x"}}, InvalidInput, "start.crank"),
        ({"prescribed": {"crank": 1.0}}, InvalidInput, "prescribed too"),
        ({"prescribed": {"crank": 1.0}, "start": None}, InvalidInput, "all drivers are prescribed"),
        ({"until": 0.0}, InvalidInput, "until"),
        ({"times": [0.0, 5.0]}, InvalidInput, "times"),
        ({"tolerance": 0.0}, InvalidInput, "tolerance"),
    ],
)
def test_what_cannot_be_simulated(given: dict[str, object], error: type[Exception], told: str) -> None:
    """The message names what is wrong."""
    with pytest.raises(error, match=told):
        ck.simulate(slider_crank(), **{"start": 1.0, "until": 0.1, **given})


def test_a_driver_that_moves_no_mass_is_named() -> None:
    """So it is where all masses are on other links."""
    arm = ck.Mechanism("Arm", ck.link("frame", A=0), ck.link("upper", A=0, B=2), ck.link("fore", B=0, P=1),
                       ck.drive("upper"), ck.drive("fore", on="upper"), ck.mass("upper", 1.0, at="B"),
                       units=SI)  # fmt: skip
    with pytest.raises(InvalidInput, match="this driver moves no mass"):
        ck.simulate(arm, start={"upper": 0.0, "fore": 0.0}, until=1.0)


def test_a_mass_that_is_a_point_on_its_pivot_is_said_to_be_one() -> None:
    """A disc with one point and a mass of its own has no inertia about that point."""
    disc = ck.Mechanism("Disc", ck.link("frame", A=0), ck.link("cam", A=0), ck.drive("cam"), ck.mass("cam", 2.0),
                        ck.torque("cam", 1.0), units=SI)  # fmt: skip
    with pytest.raises(InvalidInput, match=r"only turns 'cam' about a mass centre, .*of a point mass A.*inertia"):
        ck.simulate(disc, start=0.0, until=1.0)
    turned = ck.simulate(disc.replace(ck.mass("cam", 2.0, inertia=0.5)), start=0.0, until=1.0)
    assert turned.motion.drives["cam"].value[-1] == pytest.approx(1.0, rel=1e-12)


def test_a_torque_that_goes_by_the_speed() -> None:
    """w' = (5 - 0.1 w) / J, and a motor whose torque also grows with time."""
    run_up = ck.simulate(rotor_under(ck.torque("rotor", lambda w: 5.0 - 0.1 * w)), start=0.0, until=1.0)
    np.testing.assert_allclose(
        run_up.motion.drives["rotor"].rate, 50.0 * (1.0 - np.exp(-2.0 * run_up.times)), atol=1e-8
    )
    grown = ck.simulate(rotor_under(ck.torque("rotor", lambda w, t: t - 0.1 * w)), start=0.0, until=1.0)
    exact = 10.0 * (grown.times - (1.0 - np.exp(-2.0 * grown.times)) / 2.0)
    np.testing.assert_allclose(grown.motion.drives["rotor"].rate, exact, atol=1e-8)


def test_events_of_a_user_are_found_and_stop() -> None:
    """A pendulum let go from the horizontal passes the lowest place at the time of the quarter of its period."""
    from scipy.special import ellipk

    pendulum = ck.Mechanism("Pendulum", ck.link("frame", A=0), ck.link("bar", A=0, B=1), ck.drive("bar"),
                            ck.mass("bar", 1.0, at="B", inertia=0.0), ck.gravity(0, -9.81), units=SI)  # fmt: skip
    quarter = ellipk(0.5) / np.sqrt(9.81)
    events = {"lowest": lambda state: state["B.x"], "half way": lambda state: state["bar.angle"] + np.pi / 4}
    found = ck.simulate(pendulum, start=0.0, until=5.0, events=events, stop="lowest")
    assert [event.name for event in found.events] == ["half way", "lowest"]
    assert found.events[-1].time == pytest.approx(quarter, rel=1e-9)
    assert found.times[-1] == found.events[-1].time
    assert found.motion.points["B"].y[-1] == pytest.approx(-1.0, abs=1e-12)


def test_block_falls_to_the_end_of_its_guide() -> None:
    """A block in free fall: where it meets the end, and how high it comes back with a coefficient of restitution."""
    fall = shaft()
    first = np.sqrt(2 / 9.81)
    stopped = ck.simulate(fall, start={"block": 0.0}, until=3.0)
    assert stopped.times[-1] == pytest.approx(first, rel=1e-9)
    assert [event.stops for event in stopped.events] == [True]
    # it is at the end again at twice that time, and the rest is too short for a step to tell anything
    back = ck.simulate(fall, start={"block": 0.0}, until=2.0 * first + 1e-9, restitution=0.5)
    assert [event.time for event in back.events] == pytest.approx([first, 2.0 * first], rel=1e-8)
    top = back.motion.points["P"].y[back.times > 1.2 * first].max()
    assert top == pytest.approx(-0.75, abs=1e-4)
    assert back.energy.worst < 1e-9


def test_contact_of_a_cam_lets_go_where_the_follower_falls_freely() -> None:
    """Without a spring the roller leaves the cam where its follower would have to fall faster than freely."""
    cam = ck.load("disc-cam-offset-roller").replace(
        ck.mass("cam", 2.0, at="A", inertia=500.0),
        ck.mass("follower", 0.3, at="T", inertia=0.0),
        ck.gravity(0, -9.81),
        unit="",
        units={"length": "mm", "mass": "kg", "force": "N"},
    )
    found = ck.simulate(cam, start={"cam": (-np.pi / 2, 40.0)}, until=1.0)
    assert [event.name for event in found.events] == ["roller/cam lift-off"]
    assert found.motion.points["P"].acceleration.imag[-1] == pytest.approx(-9810.0, rel=1e-8)
    slow = ck.simulate(cam, start={"cam": (-np.pi / 2, 10.0)}, until=1.0)
    assert slow.events == ()
    assert slow.energy.worst < 1e-9


def test_parallelogram_passes_its_change_points() -> None:
    """The coupler of a parallelogram does not turn: it is a pendulum, that of both cranks and the coupler's mass."""
    from scipy.special import ellipk

    linkage = ck.Mechanism(
        "Parallelogram",
        ck.link("frame", O=(0, 0), C=(2, 0)),
        ck.link("crank", O=(0, 0), A=(1, 0)),
        ck.link("coupler", A=(0, 0), B=(2, 0)),
        ck.link("rocker", C=(0, 0), B=(1, 0)),
        ck.drive("crank"),
        ck.mass("crank", 1.0, inertia=0.1),
        ck.mass("coupler", 1.0, inertia=0.1),
        ck.mass("rocker", 1.0, inertia=0.1),
        ck.gravity(0, -9.81),
        units=SI,
    )
    # half cranks and a whole coupler fall, 2 (1/4 + 0.1) + 1 = 1.7 kg m^2 turn
    swing, pace = np.pi / 2 + 0.5, np.sqrt(2.0 * 9.81 / 1.7)
    half = 2.0 / pace * ellipk(np.sin(swing / 2) ** 2)
    found = ck.simulate(linkage, start=0.5, until=2.0 * half, times=np.linspace(0.0, 2.0 * half, 101))
    assert found.motion.drives["crank"].value[50] == pytest.approx(-np.pi - 0.5, abs=1e-7)
    assert found.motion.drives["crank"].value[-1] == pytest.approx(0.5, abs=1e-7)
    assert found.energy.worst < 1e-8
    assert np.max(np.abs(found.motion.links["coupler"].angle)) < 1e-9


def test_a_roller_on_a_swinging_follower_does_not_turn() -> None:
    """Nothing turns a roller: its inertia is not felt by the driver, as in `force_analysis`."""
    cam = ck.cam("roller", on="cam", at="P", profile=ck.profiles.disc(30, (12, 0)), radius=8)
    links = ck.link("frame", A=0, O=80), ck.link("cam", A=0), ck.link("arm", O=0, P=70), ck.link("roller", P=0)
    masses = ck.mass("cam", 1, at="A", inertia=3000), ck.mass("arm", 0.4, at=(35, 0), inertia=200)
    roller = ck.mass("roller", 0.2, at="P", inertia=4000)
    units = {"length": "mm", "mass": "kg", "force": "N"}
    swinging = ck.Mechanism("m", *links, cam, ck.drive("cam"), *masses, roller, ck.gravity(0, -9.81), units=units)
    motion = ck.solve(swinging, {"cam": [1.0]}, order=2, speed=30.0)
    for chart in (DriverChart, TabulatedChart):
        found = chart(motion, ("cam",), {}).rates(0.0, np.array([1.0]), np.array([30.0]))
        moved = ck.solve(swinging, {"cam": [1.0]}, order=2, speed=30.0, acceleration=found.accelerations[0])
        forces = ck.force_analysis(moved)
        assert abs(forces.drives["cam"].effort[0]) < 1e-12 * forces.largest * motion.size
        assert found.power == 0.0


def test_energies_that_do_not_add_up_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """A warning says so, here of what is allowed else. What only rounds is no error."""
    for name in ("ENERGY_TOLERANCE", "WORSE"):
        monkeypatch.setattr(f"compoundkin.dynamics.simulation.forward_dynamics.{name}", 0.0)
    with pytest.warns(FewDigits, match="energies do not add up"):
        ck.simulate(slider_crank(), start=1.0, until=0.1)
    assert ck.simulate(ck.load("balanced-lamp"), until=0.3).energy.worst == 0.0


def shaft(*more: object) -> ck.Mechanism:
    """A block that falls in a shaft of 2 m."""
    return ck.Mechanism(
        "Block in a shaft",
        ck.link("frame", O=(0, 0), L=(0, -1), H=(0, 1)),
        ck.link("block", P=(0, 0)),
        ck.slide("block", on="frame", at="P", through="O", angle=np.pi / 2, name="shaft", reach=("L", "H")),
        ck.drive("block"),
        ck.mass("block", 2.0, at="P", inertia=0.0),
        ck.gravity(0, -9.81),
        *more,
        units=SI,
    )


def test_a_block_that_bounces_comes_to_rest() -> None:
    """All its bounces take t (1 + e) / (1 - e), however small the last are; with e = 0 it stays at once."""
    first = np.sqrt(2 / 9.81)
    found = ck.simulate(shaft(), start=0.0, until=3.0, restitution=0.5)
    assert found.times[-1] == pytest.approx(3.0 * first, rel=1e-5)
    assert [event.stops for event in found.events] == [False] * (len(found.events) - 1) + [True]
    assert found.motion.assembled.all()
    assert found.energy.worst < 1e-12
    stays = ck.simulate(shaft(), start=0.0, until=3.0, restitution=0.0)
    assert stays.times[-1] == pytest.approx(first, rel=1e-9)
    assert stays.energy.worst < 1e-12


def test_starts_that_end_at_once() -> None:
    """A block lies on the end of its guide; rates are infinite at a limit position."""
    with pytest.raises(InvalidInput, match="comes to an end of its guide at once"):
        ck.simulate(shaft(), start=-1.0, until=1.0)
    assert ck.simulate(shaft(), start=(-1.0, 3.0), until=1.0).times[-1] == pytest.approx(6.0 / 9.81, rel=1e-9)
    with pytest.raises(InvalidInput, match="limit position"):
        ck.simulate(slider_crank(ck.drive("piston")), start={"piston": 0.45}, until=0.1)


def test_events_are_told_from_those_of_the_simulation_and_give_numbers() -> None:
    """An event may be called as it likes, NaN and vectors are refused; arrays of gravity are designs."""
    found = ck.simulate(shaft(), start=0.0, until=3.0, events={"end": lambda state: state["P.y"] + 0.5})
    assert [event.stops for event in found.events] == [False, True]
    for told in (np.nan, 1j):
        with pytest.raises(InvalidInput, match=r"events\.wrong"):
            ck.simulate(shaft(), start=0.0, until=1.0, events={"wrong": lambda _, told=told: told})
    with pytest.raises(InvalidInput, match="gravity: its numbers are arrays"):
        ck.simulate(shaft().replace(ck.gravity([[0], [1]], -9.81)), start=0.0, until=1.0)


@pytest.mark.parametrize("name", ["parallelogram", "triple-rocker"])
def test_change_points_and_limits_are_passed(name: str) -> None:
    """Linkages that pass change points, or the limit of their driver: energy, and no effort of what is free."""
    plain = ck.load(name)
    size = plain.geometry.size
    masses = [ck.mass(link, 1.0, at=(0.1 * size, 0.05 * size), inertia=0.05 * size**2)
              for link in plain.links if link != "frame"]  # fmt: skip
    heavy = plain.replace(*masses, ck.gravity(0, -9.81), unit="", units=SI, time=None)
    (driver,) = ck.decompose(heavy).driven
    first = float(ck.solve(heavy).drives[driver].value[5])
    found = ck.simulate(heavy, start={driver: (first, 3.0)}, until=1.5)
    assert found.motion.assembled.all()
    assert found.energy.worst < 1e-9
    effort = next(iter(found.forces.drives.values())).effort
    assert np.max(np.abs(effort)) < 1e-9 * found.energy.peak


SLOPE, FALL, WEIGHT = np.pi / 6, 9.81, 2.0


def incline(friction: float, *more: object) -> ck.Mechanism:
    """A block on a slope of 30 degrees."""
    return ck.Mechanism(
        "Block on an incline",
        ck.link("frame", O=(0, 0)),
        ck.link("block", P=(0, 0)),
        ck.slide("block", on="frame", at="P", through="O", angle=SLOPE, name="way"),
        ck.drive("block"),
        ck.mass("block", WEIGHT, at="P", inertia=0.0),
        ck.gravity(0, -FALL),
        ck.friction("way", friction),
        *more,
        units=SI,
    )


def test_block_slides_up_and_down_again() -> None:
    """It is braked on its way up by more than it is driven down, and turns at once where friction cannot hold it."""
    up, down = (FALL * (np.sin(SLOPE) + way * 0.2 * np.cos(SLOPE)) for way in (1, -1))
    found = ck.simulate(incline(0.2), start={"block": (0.0, 2.0)}, until=2.0)
    block, turn = found.motion.drives["block"], 2.0 / up
    assert block.value[-1] == pytest.approx(2.0 / up - down * (2.0 - turn) ** 2 / 2.0, rel=1e-10)
    assert block.second[0] == pytest.approx(-up, rel=1e-12)
    assert block.second[-1] == pytest.approx(-down, rel=1e-12)
    assert found.energy.worst < 1e-10


def test_friction_holds_and_lets_go() -> None:
    """Where it comes to rest it stays, until a load that grows overcomes friction."""
    held = ck.simulate(incline(0.7), start={"block": (0.0, 2.0)}, until=2.0)
    stop = 2.0 / (FALL * (np.sin(SLOPE) + 0.7 * np.cos(SLOPE)))
    assert [(event.name, event.time) for event in held.events] == [("sticks", pytest.approx(stop, rel=1e-9))]
    assert held.motion.drives["block"].value[-1] == pytest.approx(stop, rel=1e-9)
    pushed = incline(0.7, ck.force("block", (lambda t: 60.0 * t, 0), at="P"))
    found = ck.simulate(pushed, start={"block": 0.0}, until=1.0)
    least = WEIGHT * FALL * (np.sin(SLOPE) + 0.7 * np.cos(SLOPE)) / (np.cos(SLOPE) - 0.7 * np.sin(SLOPE)) / 60.0
    assert [event.name for event in found.events] == ["sticks", "slips"]
    assert found.events[1].time == pytest.approx(least, rel=1e-9)
    # what the force has more than at release accelerates it
    pace = 60.0 * (np.cos(SLOPE) - 0.7 * np.sin(SLOPE)) / WEIGHT
    assert found.motion.drives["block"].rate[-1] == pytest.approx(pace * (1.0 - least) ** 2 / 2.0, rel=1e-8)


def test_slider_crank_loses_energy_and_has_no_effort() -> None:
    """The forces of the motion, friction among them, leave nothing for the driver; the loss is friction's work."""
    rubbed = slider_crank().replace(ck.friction("guide", 0.1), ck.friction("A", 0.2, radius=0.01))
    found = ck.simulate(rubbed, start={"crank": ck.deg(60)}, until=0.3, tolerance=1e-8)
    moving = np.abs(found.motion.drives["crank"].rate) > 1e-6
    largest = np.max(np.abs(found.forces.pairs["A"].force)) * 0.1
    assert np.max(np.abs(found.forces.drives["crank"].effort[moving])) < 1e-9 * largest
    assert np.all(np.diff(found.energy.work) <= 1e-12)
    assert found.energy.work[-1] < -0.1
    assert found.energy.worst < 1e-6


RUBBED = ck.friction("guide", 0.1), *(ck.friction(pin, 0.1, radius=0.01) for pin in "OAB")


@pytest.mark.parametrize(
    "load",
    [
        ck.torque("crank", 1.0),
        ck.torque("crank", lambda t: np.sin(5.0 * t)),
        ck.effort("guide", lambda w: -2.0 * w),
        ck.damper("rod", (0.1, 0.02), to="crank", at="A", rate=3.0),
        ck.force("rod", (lambda t: 3.0 * t, 1.0), at=(0.1, 0)),
        ck.motor("crank", stall=2.0, no_load=30.0),
        ck.spring(pair="O", stiffness=0.5),
    ],
    ids=lambda load: load.name,
)
def test_friction_by_tables_is_that_of_solved_poses(load: object) -> None:
    """The acceleration by tables over the crank, and by the forces of a pose that is solved by itself."""
    begun = simulation_start(slider_crank().replace(*RUBBED, load), {"crank": (1.0, 20.0)}, {}, None)
    chart = FrictionTable(begun.motion, ("crank",), {})
    rng = np.random.default_rng(1)
    for value, speed in zip(rng.uniform(-2.0, 4.0, 20), rng.uniform(-30.0, 30.0, 20), strict=True):
        values, speeds = np.array([value]), np.array([speed])
        chart.direction = float(np.sign(speed))
        known = chart.rates(0.3, values, speeds).accelerations
        tables, chart.pressed = chart.pressed, None
        solved = chart.state(0.3, values, speeds).accelerations
        chart.pressed = tables
        np.testing.assert_allclose(known, solved, rtol=1e-11)


def test_a_damper_that_never_moves_changes_nothing() -> None:
    """Its ends keep their distance, so that no speed of the crank is that at which it would jump."""
    rubbed, last = slider_crank().replace(*RUBBED), {"start": 1.0, "until": 0.1}
    idle = rubbed.replace(ck.damper("crank", "A", to="frame", at="O", rate=3.0))
    one, other = (ck.simulate(one, **last).motion.drives["crank"].value[-1] for one in (rubbed, idle))
    assert one == pytest.approx(other, rel=1e-9)


def test_simulations_with_friction_solve_no_pose(monkeypatch: pytest.MonkeyPatch) -> None:
    """All states are in the tables, and the work is what the frictions of the motion take."""

    def refused(*_: object) -> None:
        raise AssertionError("a pose was solved")

    monkeypatch.setattr(FrictionTable, "_solved", refused)
    rubbed = slider_crank().replace(*RUBBED)
    found = ck.simulate(rubbed, start={"crank": (1.0, 20.0)}, until=0.2, times=np.linspace(0.0, 0.2, 801))
    power = found.forces.friction.power
    steps = np.diff(found.times)[0] / 3.0 * (power[:-2:2] + 4.0 * power[1::2] + power[2::2])
    np.testing.assert_allclose(found.energy.work[2::2], np.cumsum(steps), rtol=1e-5)
    assert found.energy.worst < 1e-10
    assert set(found.losses) == {f"friction in {pair}" for pair in ("guide", "O", "A", "B")}
    assert sum(found.losses.values()) == pytest.approx(-found.energy.work[-1], rel=1e-9)
    assert pickle.loads(pickle.dumps(found)).losses == found.losses


# --- loads that count turns ---

# A rotor on a clock spring: J q'' = -k q. It makes a turn and a half to each side.
CLOCK = 0.5
SWINGS = {
    "a function of the coordinate": ck.effort("O", lambda q: -CLOCK * q),
    "a function of the driver's": ck.effort("rotor", lambda q: -CLOCK * q),
    "a table": ck.effort("O", {"at": [-40.0, 40.0], "values": [40.0 * CLOCK, -40.0 * CLOCK]}),
    "a spring": ck.spring(pair="O", stiffness=CLOCK),
    "a function of the extension": ck.spring(pair="O", stiffness=lambda q: CLOCK * q),
}


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("load", SWINGS)
def test_loads_go_by_the_angle_with_its_turns(load: str, sense: float) -> None:
    rotor = ck.Mechanism(
        "Rotor",
        *(ck.link("frame", O=0), ck.link("rotor", O=0, P=1), ck.drive("rotor")),
        *(ck.mass("rotor", 1.0, at="O", inertia=0.05), SWINGS[load]),
        units={"length": "m", "mass": "kg", "force": "N"},
    )
    swung = ck.simulate(rotor, start={"rotor": (0.0, 30.0 * sense)}, until=3.0)
    rate = np.sqrt(CLOCK / 0.05)
    exact = sense * 30.0 / rate * np.sin(rate * swung.times)
    assert np.ptp(exact) > 18.0
    assert np.abs(np.ravel(swung.motion.inputs.drives["rotor"][0]) - exact).max() < 1e-8
    assert swung.energy.worst < 1e-8


@pytest.mark.parametrize("pin", ["A", "D"])
def test_a_clock_spring_at_any_pin_that_turns_fully(pin: str) -> None:
    """The cranks of a parallelogram without masses but that of one of them turn alike."""
    parallelogram = ck.Mechanism(
        "Clock",
        *(ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), ck.link("coupler", B=0, C=4)),
        *(ck.link("rocker", D=0, C=1), ck.drive("crank"), ck.drawn(B=1j, C=4 + 1j)),
        *(ck.mass("crank", 1.0, at="A", inertia=0.05), ck.spring(pair=pin, stiffness=CLOCK)),
        units={"length": "m", "mass": "kg", "force": "N"},
    )
    swung = ck.simulate(parallelogram, start={"crank": (0.0, 30.0)}, until=2.0)
    rate = np.sqrt(CLOCK / 0.05)
    exact = 30.0 / rate * np.sin(rate * swung.times)
    assert np.abs(np.ravel(swung.motion.inputs.drives["crank"][0]) - exact).max() < 1e-7


def rotor_under(load: object) -> ck.Mechanism:
    """A rotor of J = 0.05 under one load."""
    rotor = ck.link("frame", O=0), ck.link("rotor", O=0, P=1), ck.drive("rotor")
    units = {"length": "m", "mass": "kg", "force": "N"}
    return ck.Mechanism("Rotor", *rotor, ck.mass("rotor", 1.0, at="O", inertia=0.05), load, units=units)


def test_a_torque_that_is_switched_off() -> None:
    """A jump in time: 100 rad/s2 for 0.3 s, then none."""
    mechanism = rotor_under(ck.torque("rotor", lambda t: np.where(t < 0.3, 5.0, 0.0)))
    found = ck.simulate(mechanism, start={"rotor": 0.0}, until=1.0)
    t = found.times
    exact = np.where(t < 0.3, 50.0 * t**2, 4.5 + 30.0 * (t - 0.3))
    assert np.abs(found.motion.drives["rotor"].value - exact).max() < 1e-11
    assert [event.name for event in found.events] == ["jump"]
    assert found.events[0].time == pytest.approx(0.3, abs=1e-12)


def test_a_brake_behind_a_place() -> None:
    """A jump over the coordinate: from 2 rad on -1000 rad/s2, there and back."""
    found = ck.simulate(
        rotor_under(ck.effort("O", lambda q: np.where(q > 2.0, -50.0, 0.0))), start={"rotor": (0.0, 30.0)}, until=1.0
    )
    first, back = 2.0 / 30.0, 2.0 / 30.0 + 0.06
    t = found.times
    beyond = 2.0 + 30.0 * (t - first) - 500.0 * (t - first) ** 2
    exact = np.where(t < first, 30.0 * t, np.where(t < back, beyond, 2.0 - 30.0 * (t - back)))
    assert np.abs(found.motion.drives["rotor"].value - exact).max() < 1e-11
    assert [event.time for event in found.events] == pytest.approx([first, back], abs=1e-12)
    assert found.energy.worst < 1e-10


@pytest.mark.parametrize("tolerance", [1e-6, pytest.param(1e-11, marks=pytest.mark.full)])
def test_friction_as_a_function_holds_at_rest(tolerance: float) -> None:
    """5 N m against the speed: at rest after 0.3 s and 4.5 rad, until a torque that grows by 10 N m/s exceeds it."""
    pulled = rotor_under(ck.effort("O", lambda w: -5.0 * np.sign(w)))
    found = ck.simulate(pulled, start=(0.0, 30.0), until=1.0, tolerance=tolerance)
    assert [(event.name, event.stops) for event in found.events] == [("sticks", False)]
    assert found.events[0].time == pytest.approx(0.3, abs=100.0 * tolerance)
    assert found.motion.drives["rotor"].value[-1] == pytest.approx(4.5, abs=100.0 * tolerance)
    assert found.motion.drives["rotor"].rate[-1] == pytest.approx(0.0, abs=1e-12)
    freed = pulled.replace(ck.torque("rotor", lambda t: 10.0 * t))
    found = ck.simulate(freed, start=0.0, until=1.0, tolerance=tolerance)
    assert [event.name for event in found.events] == ["sticks", "slips"]
    assert found.events[1].time == pytest.approx(0.5, rel=1e-8)
    # (10 t - 5) / 0.05 from then on
    assert found.motion.drives["rotor"].rate[-1] == pytest.approx(25.0, rel=1e-6)
    assert found.motion.drives["rotor"].value[-1] == pytest.approx(25.0 / 6.0, rel=1e-6)


@pytest.mark.full
def test_friction_and_a_spring_come_to_rest() -> None:
    """Each half swing is 2 x 0.5 rad shorter; at rest where the spring pulls by less than friction."""
    stiffness, friction = 10.0, 5.0
    damped = rotor_under(ck.effort("O", lambda w: -friction * np.sign(w))).replace(
        ck.spring(pair="O", stiffness=stiffness)
    )
    found = ck.simulate(damped, start=(4.2, 0.0), until=2.0)
    # 4.2, -3.2, 2.2, -1.2, 0.2: the spring then pulls by 2 N m
    half = np.pi / np.sqrt(stiffness / 0.05)
    assert [event.name for event in found.events] == ["jump"] * 3 + ["sticks"]
    assert [event.time for event in found.events] == pytest.approx([half, 2 * half, 3 * half, 4 * half], rel=1e-8)
    assert found.motion.drives["rotor"].value[-1] == pytest.approx(0.2, abs=1e-8)
    assert found.energy.worst < 1e-9


@pytest.mark.full
def test_a_motor_that_is_switched_by_its_speed() -> None:
    """It holds 20 rad/s, on and off, as long as it is stronger than the load, which exceeds it after 0.5 s."""
    switched = rotor_under(ck.effort("O", lambda w: np.where(w < 20.0, 5.0, 0.0)))
    held = ck.simulate(switched.replace(ck.torque("rotor", -2.0)), start=0.0, until=1.0)
    assert [event.name for event in held.events] == ["slides"]
    assert held.events[0].time == pytest.approx(1.0 / 3.0, rel=1e-9)
    assert held.motion.drives["rotor"].value[-1] == pytest.approx(10.0 / 3.0 + 20.0 * 2.0 / 3.0, rel=1e-9)
    assert held.energy.work[-1] == pytest.approx(10.0, rel=1e-9)
    left = ck.simulate(switched.replace(ck.torque("rotor", lambda t: -10.0 * t)), start=0.0, until=1.0)
    assert [event.name for event in left.events] == ["slides", "slips"]
    # 100 t - 100 t^2 = 20
    assert left.events[0].time == pytest.approx((1.0 - np.sqrt(0.2)) / 2.0, rel=1e-9)
    # the part of the motor that is needed, 2 t, may exceed 1 by 1e-9, by rounding
    assert 0.0 < left.events[1].time - 0.5 < 0.5 * 1e-9 + 1e-11
    assert left.motion.drives["rotor"].rate[-1] == pytest.approx(20.0 - 100.0 * 0.25, rel=1e-8)


def test_short_pulses_and_corners_in_time() -> None:
    """What is shorter than a step is not stepped over: a pulse of 1 ms, and a table of triangles."""
    pulse = rotor_under(ck.torque("rotor", lambda t: np.where(np.abs(t - 0.5) <= 0.0005, 5.0, 0.0)))
    found = ck.simulate(pulse, start=0.0, until=1.0)
    assert [event.time for event in found.events] == pytest.approx([0.4995, 0.5005], abs=1e-12)
    assert found.motion.drives["rotor"].rate[-1] == pytest.approx(0.1, rel=1e-9)
    table = {"at": [0.0, 0.05, 0.1], "values": [5.0, 0.0, 5.0], "period": 0.1}
    turned = ck.simulate(rotor_under(ck.torque("rotor", table)), start=0.0, until=1.0)
    assert turned.events == ()
    assert turned.motion.drives["rotor"].rate[-1] == pytest.approx(50.0, rel=1e-12)
    square = rotor_under(ck.torque("rotor", lambda t: np.sign(np.sin(40.0 * t))))
    swung = ck.simulate(square, start=0.0, until=np.pi / 10.0)
    # up and down: half the time at the mean of the greatest speed, twice
    assert swung.motion.drives["rotor"].rate[-1] == pytest.approx(0.0, abs=1e-9)
    assert swung.motion.drives["rotor"].value[-1] == pytest.approx(2.0 * 20.0 * (np.pi / 40.0) ** 2, rel=1e-9)


WINDOW = {"at": [0.0, 3.0, 3.01, 3.02, 2.0 * np.pi], "values": [0.0, 0.0, 100.0, 0.0, 0.0], "period": 2.0 * np.pi}


@pytest.mark.parametrize(
    ("load", "work", "jumps"),
    [
        (ck.effort("rotor", lambda q: np.where((q > 3.0) & (q < 3.02), 50.0, 0.0)), 1.0, 2),
        (ck.effort("rotor", lambda q, w: np.where((q > 3.0) & (q < 3.02), 50.0, 0.0)), 1.0, 2),
        (ck.effort("O", lambda q: np.exp(-(((q - 3.0) / 0.004) ** 2)) / (0.004 * np.sqrt(np.pi)) - 0.01 * q), 1.0, 0),
        (ck.spring(pair="O", stiffness=lambda q: np.where((q > 3.0) & (q < 3.02), -50.0, 0.0), free=0.5), 1.0, 2),
        (ck.torque("rotor", {"over": "rotor", **WINDOW}), 1.0, 0),
    ],
    ids=["function", "with speed", "smooth", "spring", "table"],
)
def test_a_narrow_window_over_a_coordinate_is_not_stepped_over(load: Any, work: float, jumps: int) -> None:
    """Steps of a radian went over 0.02 rad: the speed is that of the work in it."""
    found = ck.simulate(rotor_under(load), start=(0.0, 5.0), until=1.2)
    place, speed = found.motion.drives["rotor"].value, found.motion.drives["rotor"].rate
    assert 4.0 < place[-1] < 9.0
    sloped = -0.005 * place[-1] ** 2 if load.name == "effort along O" else 0.0
    assert speed[-1] == pytest.approx(np.sqrt(25.0 + 2.0 * (work + sloped) / 0.05), rel=1e-9)
    assert [event.name for event in found.events] == ["jump"] * jumps
    assert found.energy.worst < 1e-11


@pytest.mark.parametrize("friction", [0.0, 0.1])
@pytest.mark.parametrize(
    "load",
    [
        ck.effort("guide", lambda s: np.where((s > 3.5) & (s < 3.505), 200.0, 0.0)),
        ck.effort("guide", {"at": [1.0, 3.5, 3.502, 3.504, 5.0], "values": [0.0, 0.0, 500.0, 0.0, 0.0]}),
        ck.spring("piston", "B", at="O", stiffness=lambda q: np.where((q > 3.5) & (q < 3.505), -200.0, 0.0)),
    ],
    ids=["function", "table", "spring"],
)
def test_a_narrow_window_over_another_coordinate(load: Any, friction: float) -> None:
    """Inward over it by 1 J once; pieces of the table end where it does."""
    machine = press(load, *((ck.friction("guide", friction),) if friction else ()))
    found = ck.simulate(machine, start=(0.3, 8.0), until=0.3)
    assert found.motion.drives["crank"].value[-1] > 2.0
    assert found.energy.work[-1] + sum(found.losses.values()) == pytest.approx(-1.0, abs=1e-8)
    assert found.energy.worst < 1e-8


def test_a_narrow_window_under_several_drivers() -> None:
    """A block on a block, 1 J on 2 kg."""
    ways = (
        ck.slide("one", on="frame", at="P", through="O", angle=0.0, name="rail"),
        ck.slide("two", on="one", at="Q", through="P", angle=0.0, name="gap"),
    )
    blocks = ck.Mechanism(
        "Blocks",
        *(ck.link("frame", O=0), ck.link("one", P=0), ck.link("two", Q=0), *ways),
        *(ck.drive("one"), ck.drive("two", on="one")),
        *(ck.mass("one", 2.0, at="P", inertia=0), ck.mass("two", 3.0, at="Q", inertia=0)),
        ck.effort("rail", lambda s: np.where((s > 0.35) & (s < 0.3505), 2000.0, 0.0)),
        units={"length": "m", "mass": "kg", "force": "N"},
    )
    found = ck.simulate(blocks, start={"one": (0.0, 1.0), "two": 0.1}, until=0.5)
    assert found.motion.drives["one"].rate[-1] == pytest.approx(np.sqrt(2.0), rel=1e-9)
    assert [event.name for event in found.events] == ["jump", "jump"]


def test_a_buffer_is_met_and_left() -> None:
    """A function with a corner: half a period of the buffer's, then back with the same speed."""
    found = ck.simulate(
        rotor_under(ck.effort("O", lambda q: -500.0 * np.maximum(q - 1.0, 0.0))), start=(0.0, 10.0), until=1.0
    )
    back = 0.1 + np.pi / np.sqrt(500.0 / 0.05)
    assert found.motion.drives["rotor"].value[-1] == pytest.approx(1.0 - 10.0 * (1.0 - back), abs=1e-8)
    assert found.motion.drives["rotor"].rate[-1] == pytest.approx(-10.0, rel=1e-8)
    assert found.times[-1] == 1.0


def press(*loads: object) -> ck.Mechanism:
    """A slider-crank of crank 1 and rod 3."""
    return ck.Mechanism(
        "Press",
        *(ck.link("frame", O=0), ck.link("crank", O=0, A=1), ck.link("rod", A=0, B=3), ck.link("piston", B=0)),
        *(ck.slide("piston", on="frame", at="B", through="O", name="guide"), ck.drive("crank")),
        ck.drawn(A=np.exp(0.7j), B=np.cos(0.7) + np.sqrt(9.0 - np.sin(0.7) ** 2)),
        *(ck.mass("crank", 1.0, at="O", inertia=1.0), ck.mass("rod", 0.5), ck.mass("piston", 1.0)),
        *loads,
        units=SI,
    )


WEAKENING = ck.effort("crank", lambda w: 4.0 * (1.0 - w / 10.0))
AGAINST = {
    "effort": ck.effort("guide", -30.0, only="forward"),
    "force": ck.force("piston", (-30.0, 0.0), at="B", while_moving=(1.0, 0.0)),
}


@pytest.mark.parametrize("load", ["effort", pytest.param("force", marks=pytest.mark.full)])
def test_a_press_that_stalls_stands_still(load: str) -> None:
    """A motor that weakens with its speed, against work on the piston, which is done while it goes forward only."""
    stood = ck.simulate(press(WEAKENING, AGAINST[load]), start=(-2.0, 1.0), until=2.0)
    assert [event.name for event in stood.events] == ["sticks"]
    assert stood.motion.drives["crank"].rate[-1] == pytest.approx(0.0, abs=1e-12)
    assert stood.energy.worst < 1e-9


@pytest.mark.full
def test_a_press_that_stalls_has_gone_over_its_dead_point() -> None:
    """Its piston turns back there, and the press goes on."""
    found = ck.simulate(press(WEAKENING, AGAINST["effort"]), start=(-0.2, 3.0), until=3.0)
    assert found.times[-1] == 3.0
    assert "limit" not in [event.name for event in found.events]


@pytest.mark.full
def test_a_brake_that_holds_the_speed_of_a_piston() -> None:
    """It brakes above 2 m/s only: the piston keeps 2 m/s until the crank can no more."""
    braked = press(ck.effort("guide", lambda v: -20.0 * (v > 2.0)), ck.torque("crank", 4.0))
    found = ck.simulate(braked, start=(0.7, 3.0), until=2.0)
    assert [event.name for event in found.events] == ["jump", "slides", "slips"]
    first, last = (event.time for event in found.events[1:])
    during = (found.times > first) & (found.times < last)
    assert during.sum() > 5
    speed = found.motion.points["B"].velocity.real[during]
    np.testing.assert_allclose(speed, 2.0, atol=1e-8)
    assert found.energy.worst < 1e-8


WOUND = {
    "a spring": ck.spring(pair="A", stiffness=CLOCK),
    "a function of the extension": ck.spring(pair="A", stiffness=lambda q: CLOCK * q),
    "a function of the coordinate": ck.effort("crank", lambda q: -CLOCK * q),
    "a table over the driver": ck.torque("crank", {"over": "crank", "at": [-60, 60], "values": [30, -30]}),
}


@pytest.mark.parametrize("speed", [10.0, -10.0])
@pytest.mark.parametrize("load", WOUND)
def test_a_four_bar_wound_up_by_its_crank(load: str, speed: float) -> None:
    """Two inertias I = J + K (dw/dq)^2 against Hamilton's equations, integrated by SciPy; w is the rocker's angle."""
    from scipy.integrate import solve_ivp

    turning, rocking = 0.5, 2.0
    linkage = ck.Mechanism(
        "Wound four-bar",
        *(ck.link("frame", A=0, D=4), ck.link("crank", A=0, B=1), ck.link("coupler", B=0, C=4)),
        *(ck.link("rocker", D=0, C=3), ck.drive("crank"), ck.drawn(B=1j, C=4 + 3j)),
        *(ck.mass("crank", 1.0, at="A", inertia=turning), ck.mass("rocker", 1.0, at="D", inertia=rocking)),
        WOUND[load],
        units=SI,
    )

    def ratio(q: float) -> float:
        crank, frame = np.exp(1j * q), 4.0
        line = frame - crank
        along = (4.0**2 - 3.0**2 + abs(line) ** 2) / (2.0 * abs(line))
        pin = crank + line / abs(line) * (along + 1j * np.sqrt(4.0**2 - along**2))
        rod, rocker = pin - crank, pin - frame
        return float((np.conj(crank) * rod).imag / (np.conj(rocker) * rod).imag)

    def inertia(q: float) -> float:
        return turning + rocking * ratio(q) ** 2

    def grown(_: float, y: np.ndarray) -> list[float]:
        q, p = y
        slope = (inertia(q + 1e-5) - inertia(q - 1e-5)) / 2e-5
        return [p / inertia(q), p * p * slope / (2.0 * inertia(q) ** 2) - CLOCK * q]

    found = ck.simulate(linkage, start=(1.0, speed), until=4.0)
    began = [1.0, inertia(1.0) * speed]
    known = solve_ivp(grown, (0.0, 4.0), began, "DOP853", found.times, rtol=1e-11, atol=1e-11)
    assert np.ptp(known.y[0]) > 2.0 * np.pi
    np.testing.assert_allclose(found.motion.drives["crank"].value, known.y[0], atol=1e-6)
    assert found.energy.worst < 1e-8


def geared(driver: str) -> ck.Mechanism:
    """A slider-crank whose crank turns two wheels, one of them on a clock spring."""
    pin = np.exp(2.5j)
    return ck.Mechanism(
        "Geared slider-crank",
        *(ck.link("frame", O=0, G=-2, H=2j), ck.link("crank", O=0, A=1), ck.link("rod", A=0, B=3)),
        *(ck.link("piston", B=0), ck.slide("piston", on="frame", at="B", through="O", name="guide")),
        *(ck.link("quick", G=0), ck.gear("crank", "quick", teeth=(60, 10))),
        *(ck.link("wound", H=0), ck.gear("crank", "wound", teeth=(60, 20)), ck.drive(driver)),
        ck.drawn(A=pin, B=pin.real + np.sqrt(9.0 - pin.imag**2)),
        *(ck.mass("crank", 1.0, at="O", inertia=1.0), ck.mass("rod", 0.5), ck.mass("piston", 1.0)),
        *(ck.spring(pair="G", stiffness=0.1), ck.spring(pair="H", stiffness=lambda angle: 0.2 * angle)),
        units=SI,
    )


def test_turns_are_kept_where_another_pair_becomes_the_coordinate() -> None:
    """The wheel on the spring has turned by more than one turn before the piston's dead point."""
    by_crank = ck.simulate(geared("crank"), start=(2.5, -6.0), until=2.0)
    point = by_crank.motion.points["B"]
    first = float(point.x[0]), float(point.velocity.real[0])
    by_piston = ck.simulate(geared("piston"), start=first, until=2.0, times=by_crank.times)
    assert "coordinate" in [event.name for event in by_piston.events]
    turned = by_crank.motion.drives["crank"].value
    assert np.ptp(turned) > 2.0 * np.pi / 3.0
    np.testing.assert_allclose(by_piston.motion.points["A"].position, by_crank.motion.points["A"].position, atol=1e-7)
    assert by_piston.energy.worst < 1e-8


def test_a_start_beyond_a_turn_winds_the_spring() -> None:
    """The energy of a rocker on a torsion spring that starts a turn further, through the limit of its driver."""
    plain = ck.load("triple-rocker")
    size = plain.geometry.size
    masses = [ck.mass(link, 1.0, at=(0.1 * size, 0.05 * size), inertia=0.05 * size**2)
              for link in plain.links if link != "frame"]  # fmt: skip
    stiffness = 2.0 * size
    heavy = plain.replace(*masses, ck.gravity(0, -9.81), ck.spring(pair="A", stiffness=stiffness),
                          unit="", units=SI, time=None)  # fmt: skip
    (driver,) = ck.decompose(heavy).driven
    for turns in (1.0, -1.0):
        first = -1.2653 + turns * 2.0 * np.pi
        found = ck.simulate(heavy, start={driver: (first, 3.0)}, until=1.5)
        assert "coordinate" in [event.name for event in found.events]
        angle = found.motion.drives[driver].value
        assert angle[0] == pytest.approx(first, abs=1e-12)
        assert found.energy.worst < 1e-7
        lifted = sum(own.mass * 9.81 * (found.motion.links[own.link].at(own.at).y) for own in masses)
        stored = found.energy.potential - lifted - stiffness * angle**2 / 2.0
        assert np.ptp(stored) < 1e-9 * np.ptp(found.energy.potential)


@pytest.mark.parametrize("rate", [1e2, 1e4])
def test_a_stiff_damper_takes_an_implicit_method(rate: float) -> None:
    """J w' = T - c w at the hundredfold and more of the time over which it dies away."""
    rotor = rotor_under(ck.torque("rotor", 5.0)).replace(ck.damper(pair="O", rate=rate))
    found = ck.simulate(rotor, start=(0.0, 3.0), until=1.0)
    assert found.events[0].name == "stiff"
    assert found.steps < 200
    decay = 0.05 / rate
    angle = 5.0 / rate * found.times + (3.0 - 5.0 / rate) * decay * (1.0 - np.exp(-found.times / decay))
    np.testing.assert_allclose(found.motion.drives["rotor"].value, angle, rtol=0, atol=1e-10)
    assert found.energy.worst < 1e-8


def test_a_motion_in_syrup_is_that_of_the_limit_without_inertia() -> None:
    """A heavy pendulum in syrup creeps: c q' = -m g l cos q, whose solution is the Gudermannian function."""
    arm = ck.Mechanism(
        "Pendulum", ck.link("frame", O=0), ck.link("arm", O=0, G=1.0), ck.drive("arm"),
        ck.mass("arm", 1.0, at="G", inertia=0.0), ck.gravity(0, -9.81), ck.damper(pair="O", rate=1e5), units=SI,
    )  # fmt: skip
    slow = ck.simulate(arm, start=0.5, until=1e4)
    assert slow.events[0].name == "stiff"
    gudermann = 2.0 * np.arctanh(np.tan(0.25)) - 9.81e-5 * slow.times
    exact = 2.0 * np.arctan(np.tanh(gudermann / 2.0))
    np.testing.assert_allclose(slow.motion.drives["arm"].value, exact, atol=1e-8)


@pytest.mark.parametrize("order", [(0, 1, 2, 3), (3, 0, 1, 2), (3, 2, 1, 0)])
def test_springs_at_pins_do_not_depend_on_the_order_of_links(order: tuple[int, ...]) -> None:
    """A pin may be taken the other way round when it is solved: its turns are counted in its own sense."""
    links = (
        ck.link("frame", A=0, D=0.4),
        ck.link("crank", A=0, B=0.1),
        ck.link("coupler", B=0, C=0.25),
        ck.link("rocker", D=0, C=0.25),
    )
    sprung = ck.Mechanism(
        "Sprung four-bar",
        *(links[k] for k in order),
        ck.drive("crank"),
        ck.mode(1, "coupler"),
        ck.mass("crank", 0.5, inertia=0.002),
        ck.mass("coupler", 1.0, inertia=0.01),
        ck.mass("rocker", 0.8, inertia=0.004),
        ck.spring(pair="C", stiffness=0.5),
        ck.spring(pair="B", stiffness=0.3),
        units=SI,
    )
    found = ck.simulate(sprung, start={"crank": (1.0, 12.0)}, until=1.0)
    assert found.energy.worst < 1e-9
    assert np.max(np.abs(found.motion.pairs["C"].value)) > np.pi / 2


def rocker_under(*loads: object) -> ck.Mechanism:
    """A crank-rocker driven at its rocker, which has two limit positions, under gravity."""
    return ck.Mechanism(
        "Driven rocker",
        ck.link("frame", A=0, D=0.5),
        ck.link("crank", A=0, B=0.12),
        ck.link("coupler", B=0, C=0.45),
        ck.link("rocker", D=0, C=0.3),
        ck.drive("rocker"),
        ck.drawn(A=0, D=0.5, B=0.12j, C=(0.419, 0.289)),
        ck.mass("crank", 6.0, at="B", inertia=0.02),
        ck.mass("coupler", 1.0, inertia=0.01),
        ck.mass("rocker", 2.0, inertia=0.02),
        ck.gravity(0, -9.81),
        *loads,
        units=SI,
    )


@pytest.mark.parametrize("load", [
    lambda name: ck.motor(name, stall=4.0, no_load=40.0),
    *(pytest.param(load, marks=pytest.mark.full) for load in (
        lambda name: ck.damper(pair=name, rate=0.02), lambda name: ck.stop(name, high=4.0, stiffness=1e3),
        lambda name: ck.effort(name, lambda q, w: -0.1 * w - q),
    )),
])  # fmt: skip
def test_loads_of_a_driver_follow_it_where_another_pair_takes_its_place(load: Any) -> None:
    """They named a driver that was no more, so that the coordinates of all links had to take over."""
    named, of_pair = (ck.simulate(rocker_under(load(name)), until=1.5, tolerance=1e-12) for name in ("rocker", "D"))
    changes = [event.text for event in named.events if event.name == "coordinate"]
    assert changes
    assert all("takes its place as the coordinate" in text for text in changes)
    assert named.energy.worst < 1e-9
    angles = [one.motion.links["rocker"].angle for one in (named, of_pair)]
    assert np.ptp(angles[0]) > 0.1
    np.testing.assert_array_equal(*angles)
    # by the coordinates of all links
    chart = chart_of((begun := simulation_start(rocker_under(load("D")), None, {}, None)).motion, ("rocker",), {})
    links, state = by_links(chart, chart.state(0.0, np.array([begun.values["rocker"]]), np.zeros(1)))
    course = SimulatedCourse(1.5, 1e-12)
    begin_at_stops(chart, np.array([begun.values["rocker"], 0.0, 0.0]))
    links.stop_contacts = chart.stop_contacts
    integrate(links, np.append(state, 0.0), course, None)
    last = links.courses(np.array([1.5]), course.steps[-1].between(np.array([1.5])), np.zeros((len(links.free), 1)))
    assert float(last["rocker"][0][0]) == pytest.approx(angles[0][-1], abs=1e-8)


def test_the_explicit_method_comes_back_where_motions_no_longer_die_away_fast() -> None:
    """J w' = T - c(t) w, c = C exp(-b t): stiff at first, then a rotor under a torque; work by quadrature."""
    rate, fades, torque = 1e4, 40.0, 5.0
    rotor = rotor_under(
        ck.effort("rotor", lambda w, t: torque - rate * np.exp(-fades * t) * w),
    )
    found = ck.simulate(rotor, start=(0.0, 3.0), until=1.0)
    texts = [event.text for event in found.events if event.name == "stiff"]
    assert "implicit" in texts[0]
    assert "explicit" in texts[1]
    assert len(texts) == 2
    # from where the damping is nothing it is a constant acceleration
    times, speed = found.times, found.motion.drives["rotor"].rate
    late = times > 0.75
    np.testing.assert_allclose(np.diff(speed[late]), torque / 0.05 * np.diff(times[late]), rtol=1e-7)
    assert found.energy.worst < 1e-7


@pytest.mark.parametrize(("at", "width"), [(0.73, 0.003), pytest.param(1.9, 0.02, marks=pytest.mark.full)])
def test_no_step_goes_over_a_smooth_pulse(at: float, width: float) -> None:
    """What it gives is its integral over the inertia, whatever the rotor did before it."""
    parts = (
        ck.link("frame", O=0),
        ck.link("rotor", O=0, P=1),
        ck.drive("rotor"),
        ck.mass("rotor", 1.0, at="O", inertia=0.05),
    )
    pulse = ck.torque("rotor", lambda t: 500 * np.exp(-(((t - at) / width) ** 2)))
    rotor = ck.Mechanism("Rotor", *parts, pulse, units={"length": "m", "mass": "kg", "force": "N"})
    for speed in (0.0, 3.0):
        pushed = ck.simulate(rotor, start=(0.0, speed), until=2.0)
        gained = 500 * width * np.sqrt(np.pi) / 0.05
        assert pushed.motion.drives["rotor"].rate[-1] - speed == pytest.approx(gained, rel=1e-9)
        assert not pushed.events


def test_an_event_is_one_number() -> None:
    parts = (
        ck.link("frame", O=0),
        ck.link("rotor", O=0, P=1),
        ck.drive("rotor"),
        ck.mass("rotor", 1.0, at="O", inertia=0.05),
    )
    rotor = ck.Mechanism("Rotor", *parts, units={"length": "m", "mass": "kg", "force": "N"})
    with pytest.raises(ck.errors.InvalidInput, match="it returns 2 numbers"):
        ck.simulate(rotor, start=(0.0, 1.0), until=1.0, events={"both": lambda state: np.array([1.0, 2.0])})
