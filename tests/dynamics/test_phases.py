"""Pairs that come apart and close again: phases of a simulation, against closed forms and hand-written equations."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, InvalidMechanism
from compoundkin.files import dumps, loads
from compoundkin.view.report.simulation_report import simulation_report
from tests.dynamics.cases import SI

G = 9.81


def pendulum(*more: Any) -> ck.Mechanism:
    """A point mass of 2 kg on a bar of 1 m."""
    return ck.Mechanism(
        "Pendulum",
        ck.link("frame", A=0),
        ck.link("bar", A=0, B=1),
        ck.drive("bar"),
        ck.mass("bar", 2.0, at="B", inertia=0.0),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def test_a_pendulum_that_breaks() -> None:
    """Let go at the level it carries 3 m g sin(a) at the angle a: half the greatest at 30 degrees; then it falls."""
    found = ck.simulate(pendulum(ck.release("A", strength=1.5 * 2.0 * G)), start=0.0, until=1.0)
    event = found.events[0]
    assert event.name == "opens"
    before, after = (phase.motion.points["B"] for phase in found.phases)
    assert np.angle(before.position[-1]) == pytest.approx(-np.pi / 6, abs=1e-9)
    speed = np.sqrt(2.0 * G * 0.5) * np.exp(-1j * np.pi * 2.0 / 3.0)
    assert after.velocity[0] == pytest.approx(speed, rel=1e-9)
    since = found.phases[1].motion.time - event.time
    flown = np.exp(-1j * np.pi / 6) + speed * since - 0.5j * G * since**2
    np.testing.assert_allclose(after.position, flown, atol=1e-9)
    assert found.energy.worst < 1e-9
    assert [phase.first for phase in found.phases] == [0.0, event.time]
    assert found.phases[1].last == 1.0
    with pytest.raises(InvalidInput, match=r"phases\[0\]"):
        _ = found.motion
    assert "2 phases" in simulation_report(found).text()
    assert "2 phases" in found._repr_html_()


def test_a_block_flies_off_a_turning_arm() -> None:
    """On the arm it goes as cosh; off it straight on, turning as it did. The arm is prescribed."""
    turning, first, inertia = 3.0, 0.2, 0.05
    arm = ck.Mechanism(
        "Block on an arm",
        ck.link("frame", O=0),
        ck.link("arm", O=0, E=2),
        ck.link("block", Q=0),
        ck.slide("block", on="arm", at="Q", through="O", toward="E", name="way"),
        ck.drive("arm"),
        ck.drive("block", on="arm"),
        ck.mass("block", 0.7, at="Q", inertia=inertia),
        ck.release("way", until=0.4),
        units=SI,
    )
    found = ck.simulate(arm, start={"block": first}, prescribed={"arm": lambda t: turning * t}, until=1.0)
    r, u = first * np.cosh(turning * 0.4), np.exp(1j * turning * 0.4)
    velocity = (first * turning * np.sinh(turning * 0.4) + 1j * turning * r) * u
    block = found.phases[1].motion
    np.testing.assert_allclose(block.points["Q"].position, r * u + velocity * (block.time - 0.4), atol=1e-9)
    np.testing.assert_allclose(block.links["block"].angular_velocity, turning, rtol=1e-9)
    assert found.energy.worst < 1e-9
    kinetic = 0.7 * abs(velocity) ** 2 / 2.0 + inertia * turning**2 / 2.0
    assert found.energy.kinetic[-1] == pytest.approx(kinetic, rel=1e-9)


def four_bar(*more: Any) -> ck.Mechanism:
    """A four-bar under gravity."""
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(0.4, 0)),
        ck.link("crank", A=0, B=0.1),
        ck.link("coupler", B=0, C=0.35),
        ck.link("rocker", D=0, C=0.25),
        ck.drive("crank"),
        ck.mass("crank", 0.5, inertia=0.002),
        ck.mass("coupler", 1.0, inertia=0.01),
        ck.mass("rocker", 0.8, inertia=0.004),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def test_a_loop_that_opens_is_two_trees() -> None:
    """Without its pin the rocker is a pendulum of its own, whose motion is that of one simulated alone."""
    found = ck.simulate(four_bar(ck.release("C", until=0.1)), start={"crank": (1.0, 4.0)}, until=0.6, tolerance=1e-12)
    before, after = (phase.motion for phase in found.phases)
    assert found.phases[1].mechanism.drives[0].name == "crank"
    assert len(after.drives) == 3
    for name in ("crank", "coupler", "rocker"):
        assert after.links[name].angular_velocity[0] == pytest.approx(before.links[name].angular_velocity[-1], rel=1e-9)
    assert found.energy.worst < 1e-9
    alone = ck.Mechanism(
        "Rocker",
        ck.link("frame", D=(0.4, 0)),
        ck.link("rocker", D=0, C=0.25),
        ck.drive("rocker"),
        ck.mass("rocker", 0.8, inertia=0.004),
        ck.gravity(0, -G),
        units=SI,
    )
    state = before.links["rocker"]
    own = ck.simulate(alone, start=(state.angle[-1], state.angular_velocity[-1]), until=0.5, tolerance=1e-12)
    assert after.points["C"].position[0] == pytest.approx(before.points["C"].position[-1], abs=1e-12)
    end = after.links["rocker"].angle[-1]
    assert np.exp(1j * end) == pytest.approx(np.exp(1j * own.motion.links["rocker"].angle[-1]), abs=1e-8)


def slider_crank(*more: Any) -> ck.Mechanism:
    """A slider-crank under gravity."""
    return ck.Mechanism(
        "Slider-crank",
        ck.link("frame", O=0),
        ck.link("crank", O=0, A=0.1),
        ck.link("rod", A=0, B=0.35),
        ck.link("piston", B=0),
        ck.slide("piston", on="frame", at="B", through="O", angle=np.pi / 2, name="guide"),
        ck.drawn(O=0, A=0.1, B=(0, 0.335)),
        ck.drive("crank"),
        ck.mass("crank", 3.0, at=(0.02, 0), inertia=0.02),
        ck.mass("rod", 1.0, at=(0.15, 0), inertia=0.012),
        ck.mass("piston", 2.0, at="B", inertia=0.01),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def five_bar(*more: Any) -> ck.Mechanism:
    """A five-bar under gravity, driven at both fixed pins."""
    return ck.Mechanism(
        "Five-bar",
        ck.link("frame", A=0, E=0.6),
        ck.link("a", A=0, B=0.4),
        ck.link("b", B=0, C=0.5),
        ck.link("c", C=0, D=0.5),
        ck.link("d", E=0, D=0.4),
        ck.drive("a"),
        ck.drive("d"),
        *(ck.mass(name, 1.0, inertia=0.02) for name in "abcd"),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


@pytest.mark.parametrize(
    ("linkage", "pair", "start"),
    [(four_bar, letter, {"crank": (1.0, 4.0)}) for letter in "ABCD"]
    + [(slider_crank, pair, {"crank": (1.0, 4.0)}) for pair in ("O", "A", "B", "guide")]
    + [(five_bar, letter, {"a": (2.0, 1.0), "d": (1.2, -1.0)}) for letter in "ABCDE"],
)
def test_any_pair_of_a_linkage_may_open(linkage: Any, pair: str, start: Any) -> None:
    """Poses and velocities of all links go on, no energy is lost, and what is left is a motion that closes."""
    found = ck.simulate(linkage(ck.release(pair, until=0.1)), start=start, until=0.4)
    before, after = (phase.motion for phase in found.phases)
    for name in before.mechanism.links:
        one, other = before.links[name], after.links[name]
        assert np.exp(1j * one.angle[-1]) == pytest.approx(np.exp(1j * other.angle[0]), abs=1e-9)
        assert one.angular_velocity[-1] == pytest.approx(other.angular_velocity[0], abs=1e-7)
    assert found.losses == {}
    assert found.energy.worst < 1e-9
    assert ck.verify(after).passed
    forces = ck.force_analysis(after)
    assert max(np.max(np.abs(drive.effort)) for drive in forces.drives.values()) < 1e-6


def trebuchet(*more: Any) -> ck.Mechanism:
    """A beam with a hung counterweight, and a sling without mass that holds a stone."""
    return ck.Mechanism(
        "Trebuchet",
        ck.link("frame", O=0),
        ck.link("beam", O=0, B=-1, T=4),
        ck.link("weight", B=0, W=0.8),
        ck.link("sling", T=0, S=3),
        ck.drive("beam"),
        ck.drive("weight", on="beam"),
        ck.drive("sling", on="beam"),
        ck.mass("beam", 5.0, at=(1.5, 0), inertia=12.0),
        ck.mass("weight", 200.0, at="W", inertia=2.0),
        ck.mass("sling", 1.5, at="S", inertia=0.0),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def trebuchet_rates(t: float, y: Any) -> Any:
    """Return the rates of the three angles from the frame, by Lagrange's equations."""
    a, c, s = y[:3]
    ea, ec, es = np.exp(1j * a), np.exp(1j * c), np.exp(1j * s)
    # mass, its velocities by each angle, and its centripetal acceleration
    parts = (
        (5.0, [1.5j * ea, 0, 0], -1.5 * ea * y[3] ** 2),
        (200.0, [-1j * ea, 0.8j * ec, 0], ea * y[3] ** 2 - 0.8 * ec * y[4] ** 2),
        (1.5, [4j * ea, 0, 3j * es], -4 * ea * y[3] ** 2 - 3 * es * y[5] ** 2),
    )
    matrix, push = np.diag([12.0, 2.0, 0.0]), np.zeros(3)
    for mass, by, second in parts:
        row = np.array(by)
        matrix = matrix + mass * np.real(np.outer(np.conj(row), row))
        push += mass * np.real(np.conj(row) * (-1j * G - second))
    return np.concatenate([y[3:], np.linalg.solve(matrix, push)])


def test_a_trebuchet_against_another_integrator() -> None:
    """Where the sling is in line with the beam the stone flies: hand-written equations, SciPy, and the parabola."""
    from scipy.integrate import solve_ivp

    start = {"beam": ck.deg(-45), "weight": ck.deg(-45), "sling": ck.deg(-135)}
    thrown = trebuchet(ck.release("T", over="sling", value=0.0))
    found = ck.simulate(thrown, start=start, until=1.5, tolerance=1e-12)

    def in_line(t: float, y: Any) -> float:
        return float(y[2] - y[0])

    in_line.terminal = True  # type: ignore[attr-defined]
    first = [ck.deg(-45), ck.deg(-90), ck.deg(-180), 0.0, 0.0, 0.0]
    own = solve_ivp(trebuchet_rates, (0.0, 1.5), first, "DOP853", rtol=1e-12, atol=1e-13, events=in_line)
    a, _, s, u, _, w = own.y[:, -1]
    time, place = own.t[-1], 4 * np.exp(1j * a) + 3 * np.exp(1j * s)
    velocity = 4j * u * np.exp(1j * a) + 3j * w * np.exp(1j * s)
    assert [event.name for event in found.events] == ["opens"]
    assert found.events[0].time == pytest.approx(time, abs=1e-8)
    stone, since = found.phases[1].motion.points["S"], 1.5 - time
    assert stone.velocity[0] == pytest.approx(velocity, rel=1e-6)
    assert stone.position[-1] == pytest.approx(place + velocity * since - 0.5j * G * since**2, abs=1e-6)
    # the beam goes on with its weight
    after = solve_ivp(
        lambda t, y: trebuchet_rates_alone(y), (time, 1.5), own.y[[0, 1, 3, 4], -1], "DOP853", rtol=1e-12, atol=1e-13
    )
    beam = found.phases[1].motion.drives["beam"]
    assert beam.value[-1] == pytest.approx(after.y[0, -1], abs=1e-6)
    assert found.energy.worst < 1e-9


def trebuchet_rates_alone(y: Any) -> Any:
    """Return the rates of the beam and its weight."""
    ea, ec = np.exp(1j * y[0]), np.exp(1j * y[1])
    parts = (
        (5.0, [1.5j * ea, 0], -1.5 * ea * y[2] ** 2),
        (200.0, [-1j * ea, 0.8j * ec], ea * y[2] ** 2 - 0.8 * ec * y[3] ** 2),
    )
    matrix, push = np.diag([12.0, 2.0]), np.zeros(2)
    for mass, by, second in parts:
        row = np.array(by)
        matrix = matrix + mass * np.real(np.outer(np.conj(row), row))
        push += mass * np.real(np.conj(row) * (-1j * G - second))
    return np.concatenate([y[2:], np.linalg.solve(matrix, push)])


ECCENTRIC, REACH, MASS, INERTIA = 0.012, 0.038, 0.3, 5e-4


def lift(q: float) -> tuple[float, float, float]:
    """Return the lift of a roller over an eccentric disc, and its derivatives."""
    c, s = ECCENTRIC * np.cos(q), ECCENTRIC * np.sin(q)
    root = np.sqrt(REACH**2 - c**2)
    first = c * s / root
    return s + root, c + first, -s + (c * c - s * s) / root - first**2 / root


def contact_rates(t: float, y: Any) -> Any:
    """Return the rates of a cam with its follower."""
    _, first, second = lift(y[0])
    felt = INERTIA + MASS * first**2
    return [y[1], -(MASS * first * second * y[1] ** 2 + MASS * G * first) / felt]


def pressed(t: float, y: Any) -> float:
    """Return the acceleration by which the follower does not fall freely."""
    _, first, second = lift(y[0])
    return float(first * contact_rates(t, y)[1] + second * y[1] ** 2 + G)


def flies_until(t: float, y: Any, until: float) -> tuple[float, Any]:
    """Return when a free follower meets the cam again, and the cam's state after that; or where they are at the end."""
    from scipy.optimize import brentq

    h, first, _ = lift(y[0])
    speed = first * y[1]

    def gap(since: float) -> float:
        return float(h + speed * since - G * since**2 / 2.0 - lift(y[0] + y[1] * since)[0])

    steps = np.linspace(1e-4, until - t, 4000)
    late = next((k for k in range(1, len(steps)) if gap(steps[k]) < 0.0), None)
    if late is None:
        return until, y
    since = brentq(gap, steps[late - 1], steps[late], xtol=1e-15)
    q, fall = y[0] + y[1] * since, speed - G * since
    first = lift(q)[1]
    return t + since, [q, (INERTIA * y[1] + MASS * first * fall) / (INERTIA + MASS * first**2)]


def test_a_follower_lifts_off_and_lands_against_another_integrator() -> None:
    """A roller on an eccentric disc that turns freely: contact by SciPy, flight and landing by hand."""
    from scipy.integrate import solve_ivp

    cam = ck.Mechanism(
        "Eccentric disc",
        ck.link("frame", A=0),
        ck.link("cam", A=0),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", at="P", through="A", angle=np.pi / 2, name="guide"),
        ck.cam("follower", on="cam", at="P", profile=ck.profiles.disc(0.03, (ECCENTRIC, 0)), radius=0.008, name="nose"),
        ck.mode(1, "follower"),
        ck.drive("cam"),
        ck.mass("cam", 2.0, at="A", inertia=INERTIA),
        ck.mass("follower", MASS, at="P", inertia=0.0),
        ck.gravity(0, -G),
        ck.release("nose"),
        units=SI,
    )
    until = 0.3
    found = ck.simulate(cam, start={"cam": (-np.pi / 2, 40.0)}, until=until, tolerance=1e-12)
    pressed.terminal, pressed.direction = True, -1.0  # type: ignore[attr-defined]
    t, y, times = 0.0, [-np.pi / 2, 40.0], list[float]()
    while t < until:
        own = solve_ivp(contact_rates, (t, until), y, "DOP853", rtol=1e-12, atol=1e-13, events=pressed)
        t, y = float(own.t[-1]), own.y[:, -1]
        if t < until:
            times.append(t)
            t, y = flies_until(t, y, until)
        if t < until:
            times.append(t)
    assert len(times) >= 3
    assert [event.name for event in found.events] == ["opens", "lands"] * (len(times) // 2) + ["opens"] * (
        len(times) % 2
    )
    np.testing.assert_allclose([event.time for event in found.events], times, atol=1e-7)
    assert found.phases[2].motion.drives["cam"].rate[0] < found.phases[1].motion.drives["cam"].rate[-1]
    assert found.energy.work[-1] == pytest.approx(-found.losses["nose"], rel=1e-9)
    assert found.energy.worst < 1e-9


@pytest.mark.full
def test_conjugate_cams_hold_each_other() -> None:
    """Gravity pulls the follower off one cam, and on the other: by the cycloidal law itself, SciPy's way to go on."""
    from scipy.integrate import solve_ivp

    mass, arm, inertia, cam, at = 0.2, 65.0, 200.0, 2000.0, 10.0
    loaded = ck.load("conjugate-cams").replace(
        ck.mass("cam", 2.0, at="A", inertia=cam),
        ck.mass("follower", mass, at="P", inertia=inertia),
        ck.gravity(0, -G),
        units={"length": "mm", "mass": "kg", "force": "N"},
    )
    alone = loaded.replace()
    alone = ck.Mechanism("Front alone", *(item for item in alone.items if getattr(item, "name", "") != "back"),
                         units=alone.units)  # fmt: skip
    with pytest.raises(InvalidInput, match=r"front lets go at once: it would have to pull.*release\(.front.\)"):
        ck.simulate(alone, start={"cam": (0.0, at)}, until=0.1)
    found = ck.simulate(loaded, start={"cam": (0.0, at)}, until=0.1)
    assert found.events == ()

    def rates(t: float, y: Any) -> list[float]:
        rise, over = ck.deg(24), ck.deg(110)
        u = y[0] / over
        lift = rise * (u - np.sin(2 * np.pi * u) / (2 * np.pi))
        first = rise / over * (1 - np.cos(2 * np.pi * u))
        second = rise / over**2 * 2 * np.pi * np.sin(2 * np.pi * u)
        whole = inertia + mass * arm**2
        weight = -mass * G * 1e3 * arm * np.cos(ck.deg(-145.862407) + lift) * first
        return [y[1], (weight - whole * first * second * y[1] ** 2) / (cam + whole * first**2)]

    own = solve_ivp(rates, (0.0, 0.1), [0.0, at], "DOP853", rtol=1e-12, atol=1e-13)
    assert found.motion.drives["cam"].value[-1] == pytest.approx(own.y[0, -1], rel=1e-8)
    assert found.motion.drives["cam"].rate[-1] == pytest.approx(own.y[1, -1], rel=1e-8)
    assert found.energy.worst < 1e-9


def eccentric_disc(*more: Any, inertia: float = INERTIA) -> ck.Mechanism:
    """An eccentric disc that lifts a roller follower by its weight."""
    return ck.Mechanism(
        "Eccentric disc",
        ck.link("frame", A=0),
        ck.link("cam", A=0),
        ck.link("follower", P=0),
        ck.slide("follower", on="frame", at="P", through="A", angle=np.pi / 2, name="guide"),
        ck.cam("follower", on="cam", at="P", profile=ck.profiles.disc(0.03, (ECCENTRIC, 0)), radius=0.008, name="nose"),
        ck.mode(1, "follower"),
        ck.drive("cam"),
        *((ck.mass("cam", 2.0, at="A", inertia=inertia),) if inertia else ()),
        ck.mass("follower", MASS, at="P", inertia=0.0),
        ck.gravity(0, -G),
        *more,
        units=SI,
    )


def test_contacts_side_by_side_do_not_hold_each_other() -> None:
    """Two equal discs under one roller lift off when a single one does."""
    profile = ck.profiles.disc(0.03, (ECCENTRIC, 0))
    second = ck.cam("follower", on="cam", at="P", profile=profile, radius=0.008, name="second")
    start = {"cam": (-np.pi / 2, 40.0)}
    one, two = (ck.simulate(eccentric_disc(*more), start=start, until=0.1) for more in ((), (second,)))
    assert one.events[0].name == two.events[0].name == "nose lift-off"
    assert two.events[0].time == pytest.approx(one.events[0].time, abs=1e-9)


def test_a_cam_without_inertia_presses_nothing() -> None:
    """Then the follower falls freely, and the event says why."""
    found = ck.simulate(eccentric_disc(inertia=0.0), start={"cam": (0.3, 1.0)}, until=0.1)
    assert found.events[-1].stops
    assert "has neither inertia nor load" in found.events[-1].text


def test_the_table_of_several_phases() -> None:
    """It names the phase of each row; what a phase has not is NaN there."""
    found = ck.simulate(four_bar(ck.release("C", until=0.1)), start={"crank": (1.0, 4.0)}, until=0.3)
    table = found.table("B.x", "rocker.angle", "C on rocker.y")
    phase, times = table["phase"].values, table["time"].values
    assert set(phase) == {1, 2}
    assert np.all(np.diff(phase) >= 0)
    np.testing.assert_array_equal(times, found.times)
    np.testing.assert_array_equal(table["B.x"].values[phase == 2], found.phases[1].motion.points["B"].x)
    assert np.isnan(table["C on rocker.y"].values[phase == 1]).all()
    assert np.isfinite(table["C on rocker.y"].values[phase == 2]).all()
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'B"):
        found.table("B.xx")


def flight_gap(q: float, omega: float, h: float, speed: float, since: float) -> float:
    """Return the distance of a follower that flies from a cam that turns evenly."""
    return float(h + speed * since - G * since**2 / 2.0 - lift(q + omega * since)[0])


def bounces(t: float, y: Any, until: float, restitution: float) -> tuple[list[float], float, Any]:
    """Return when a follower meets the cam from its lift-off on, when that ends, and the cam's state then."""
    from scipy.optimize import brentq

    times, fastest = list[float](), 0.0
    q, omega = y
    h, first, _ = lift(q)
    speed = first * omega
    while True:
        gap = partial(flight_gap, q, omega, h, speed)
        # at the lift-off the gap is of the third order; a bounce is as long as the speed of parting over the weight
        early = np.geomspace(1e-9, 1e-4, 200) if times else np.empty(0)
        steps = np.concatenate([early, np.linspace(1e-4, until - t, 6000)[len(early) > 0 :]])
        late = next((k for k in range(1, len(steps)) if gap(steps[k]) < 0.0 < gap(steps[k - 1])), None)
        if late is None:
            return times, until, None
        since = brentq(gap, steps[late - 1], steps[late], xtol=1e-16)
        t, q, h, speed = t + since, q + omega * since, lift(q + omega * since)[0], speed - G * since
        times.append(t)
        first = lift(q)[1]
        approach = first * omega - speed
        fastest = max(fastest, approach)
        e = restitution if approach > 1e-6 * fastest else 0.0
        impulse = (1.0 + e) * approach / (first**2 / INERTIA + 1.0 / MASS)
        omega, speed = omega - first * impulse / INERTIA, speed + impulse / MASS
        if not e:
            return times, t, [q, omega]


def test_a_follower_rebounds_against_another_integrator() -> None:
    """Each flight is a parabola over a cam that turns evenly; the bounces end, and contact goes on by SciPy."""
    from scipy.integrate import solve_ivp

    until, e = 0.34, 0.3
    found = ck.simulate(
        eccentric_disc(ck.release("nose", restitution=e)),
        start={"cam": (-np.pi / 2, 40.0)},
        until=until,
        tolerance=1e-12,
    )
    pressed.terminal, pressed.direction = True, -1.0  # type: ignore[attr-defined]
    own = solve_ivp(contact_rates, (0.0, until), [-np.pi / 2, 40.0], "DOP853", rtol=1e-12, atol=1e-13, events=pressed)
    times, last, y = bounces(float(own.t[-1]), own.y[:, -1], until, e)
    met = [event for event in found.events if event.name in ("rebounds", "lands")]
    assert len(times) > 4
    assert [event.name for event in met[: len(times) - 1]] == ["rebounds"] * (len(times) - 1)
    np.testing.assert_allclose([event.time for event in met[: len(times)]], times, atol=1e-7)
    assert y is not None
    landing = next(event for event in met if event.name == "lands")
    assert landing.time == pytest.approx(last, abs=1e-6)
    opened = [event.time for event in found.events if event.name == "opens"]
    own = solve_ivp(contact_rates, (last, until), y, "DOP853", rtol=1e-12, atol=1e-13, events=pressed)
    if len(opened) > 1:
        assert opened[1] == pytest.approx(float(own.t[-1]), abs=1e-6)
    else:
        assert found.phases[-1].motion.drives["cam"].rate[-1] == pytest.approx(own.y[1, -1], rel=1e-6)
    assert found.energy.work[-1] == pytest.approx(-found.losses["nose"], rel=1e-9)
    assert found.energy.worst < 1e-9


def two_followers(which: tuple[int, ...], restitution: float | None) -> ck.Mechanism:
    """Followers over eccentric discs, turned against each other, on a shaft too heavy to feel them."""
    items: list[Any] = [
        *(ck.link("frame", A=0), ck.link("cam", A=0), ck.drive("cam"), ck.mass("cam", 2.0, at="A", inertia=1e4)),
        ck.gravity(0, -G),
    ]
    for k in which:
        point, link, profile = f"P{k}", f"follower {k}", ck.profiles.disc(0.03, ECCENTRIC * np.exp(1j * k))
        items += [
            ck.link(link, **{point: 0}),
            ck.slide(link, on="frame", at=point, through="A", angle=np.pi / 2, name=f"guide {k}"),
            ck.cam(link, on="cam", at=point, profile=profile, radius=0.008, name=f"nose {k}"),
            *(
                ck.mode(1, link),
                ck.mass(link, MASS, at=point, inertia=0),
                ck.release(f"nose {k}", restitution=restitution),
            ),
        ]
    return ck.Mechanism("Two followers", *items, units=SI)


@pytest.mark.parametrize("restitution", [pytest.param(None, marks=pytest.mark.full), 0.4])
def test_contacts_that_are_open_together(restitution: float | None) -> None:
    """The first to let go lands while the second still flies; each does what it does alone."""
    runs = {
        which: ck.simulate(two_followers(which, restitution), start={"cam": (-np.pi / 2, 40.0)}, until=0.24)
        for which in ((0,), (1,), (0, 1))
    }
    alone = sorted((event.time, event.name) for which in ((0,), (1,)) for event in runs[which].events)
    both = [(event.time, event.name) for event in runs[0, 1].events]
    assert [name for _, name in both] == [name for _, name in alone]
    np.testing.assert_allclose([time for time, _ in both], [time for time, _ in alone], atol=1e-7)
    assert both[2][1] == ("lands" if restitution is None else "rebounds")
    losses = {**runs[0,].losses, **runs[1,].losses}
    for name, lost in runs[0, 1].losses.items():
        assert lost == pytest.approx(losses[name], rel=1e-6)
    assert all(run.energy.worst < 1e-9 for run in runs.values())


def test_what_a_spring_along_an_opening_pair_holds_is_lost() -> None:
    """A torsion spring at the pin of a pendulum comes off with it, wound by its angle; then the pendulum falls."""
    stiffness = 3.0
    found = ck.simulate(
        pendulum(ck.spring(pair="A", stiffness=stiffness), ck.damper(pair="A", rate=0.1), ck.release("A", until=0.4)),
        start=0.0,
        until=1.0,
    )
    wound = found.phases[0].motion.drives["bar"].value[-1]
    assert found.losses == {"A": pytest.approx(stiffness * wound**2 / 2.0, rel=1e-12)}
    tip = found.phases[1].motion.points["B"]
    np.testing.assert_allclose(tip.acceleration, -1j * G, atol=1e-9)
    assert found.energy.worst < 1e-9


def test_releases_that_cannot_be() -> None:
    """Each is named: unknown pairs, nothing that opens them, loads along what opens."""
    with pytest.raises(InvalidMechanism) as refused:
        pendulum(ck.release("C", until=1.0), ck.release("A", name="b"), ck.release("A", over="bar", name="c"))
    assert [problem.where for problem in refused.value.problems] == [
        "releases[0].pair",
        "releases[1]",
        "releases[2].over",
    ]
    with pytest.raises(InvalidMechanism, match="no contact that lands again"):
        pendulum(ck.release("A", until=0.1, restitution=0.5))
    with pytest.raises(InvalidMechanism, match=r"1\.2 is no coefficient of restitution"):
        eccentric_disc(ck.release("nose", restitution=1.2))
    never = ck.simulate(pendulum(ck.release("A", strength=100.0)), start=0.0, until=0.5)
    assert [event.name for event in never.events] == ["idle"]
    assert never.motion is never.phases[0].motion


def test_releases_in_files() -> None:
    """They read back, the other coordinate in degrees."""
    written = pendulum(ck.release("A", strength=4.0, over="bar", value=ck.deg(-30)))
    assert loads(dumps(written)) == written
    assert "value = -30" in dumps(written)
    bouncing = eccentric_disc(ck.release("nose", restitution=0.3))
    assert loads(dumps(bouncing)) == bouncing
