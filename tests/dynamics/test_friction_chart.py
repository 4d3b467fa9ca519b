"""Friction with several drivers, gears and belts, stops and phases, against closed forms."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.arrays import Number
from compoundkin.chains import random_mechanism
from compoundkin.dynamics.simulation.coordinate_change import by_links, chart_of
from compoundkin.dynamics.simulation.forward_dynamics import simulation_start
from compoundkin.dynamics.simulation.friction_table import FrictionTable
from compoundkin.results import Simulation
from tests.dynamics.cases import SI
from tests.dynamics.moving_cases import five_bar, slider_crank
from tests.dynamics.random_machines import machine, tried

G = 9.81
LOWER, UPPER = 2.0, 1.0


def blocks(floor: float, top: float, *more: object) -> ck.Mechanism:
    """A block on a block on the floor, both with friction."""
    return ck.Mechanism(
        "Two blocks",
        ck.link("frame", O=(0, 0)),
        ck.link("lower", P=(0, 0)),
        ck.link("upper", Q=(0, 0)),
        ck.slide("lower", on="frame", at="P", through="O", angle=0, name="floor"),
        ck.slide("upper", on="lower", at="Q", through="P", angle=0, name="top"),
        ck.drive("lower"),
        ck.drive("upper", on="lower"),
        ck.mass("lower", LOWER, at="P", inertia=0.0),
        ck.mass("upper", UPPER, at="Q", inertia=0.0),
        ck.gravity(0, -G),
        ck.friction("floor", floor),
        ck.friction("top", top),
        *more,
        units=SI,
    )


def run(mechanism: ck.Mechanism, lower: float, upper: float, until: float = 2.0) -> Simulation:
    """The motion from given speeds."""
    return ck.simulate(mechanism, start={"lower": (0.0, lower), "upper": (0.0, upper)}, until=until)


def efforts(found: Simulation) -> float:
    """The greatest effort of a driver behind the start, at which a pair may be at rest though it moves off."""
    return float(max(np.max(np.abs(one.effort[1:])) for one in found.forces.drives.values()))


def piecewise(floor: float, top: float, lower: float, upper: float) -> tuple[Number, Number]:
    """The ways of both blocks until they rest, by stretches of constant accelerations: ends and sums."""
    speeds, ends, ways = np.array([lower, upper]), np.zeros(2), np.zeros(2)
    limits = G * np.array([floor * (LOWER + UPPER), top * UPPER])
    while speeds.any():
        second = accelerations(limits, speeds)
        last = min(-v / a for v, a in zip(speeds, second, strict=True) if v * a < 0.0)
        moved = speeds * last + second * last * last / 2.0
        ends, ways, after = ends + moved, ways + np.abs(moved), speeds + second * last
        speeds = np.where((speeds * second < 0.0) & (np.abs(after) < 1e-12), 0.0, after)
    return ends, ways


def accelerations(limits: Number, speeds: Number) -> Number:
    """The only accelerations that agree with the law of friction, of all senses that blocks at rest may take."""
    for senses in product(*[(np.sign(v),) if v else (0.0, 1.0, -1.0) for v in speeds]):
        first, second = senses
        if first and second:
            by_floor, by_top = -first * limits[0], -second * limits[1]
            own = (by_floor - by_top) / LOWER
            found = np.array([own, by_top / UPPER - own])
        elif first:
            found = np.array([-first * limits[0] / (LOWER + UPPER), 0.0])
            if abs(UPPER * found[0]) > limits[1]:
                continue
        else:
            found = np.array([0.0, -second * limits[1] / UPPER])
            if second and limits[1] > limits[0]:
                continue
        if all(v or not s or s * a > 0.0 for s, v, a in zip(senses, speeds, found, strict=True)):
            return found
    raise AssertionError("no accelerations")


@pytest.mark.parametrize(
    ("floor", "top", "lower", "upper"),
    [(0.1, 0.5, 0.0, 3.0), (0.3, 0.1, 2.0, 0.0), (0.05, 0.6, 1.0, -2.0), (0.1, 0.3, 0.0, 3.0)],
)
def test_blocks_slide_on_each_other_until_they_rest(floor: float, top: float, lower: float, upper: float) -> None:
    """The ways, the work of friction by them, and no effort at the drivers while pairs slide and stick.

    In the fourth row the upper block pulls the lower one exactly by what the floor holds.
    """
    found = run(blocks(floor, top), lower, upper, until=3.0)
    ends, ways = piecewise(floor, top, lower, upper)
    drives = found.motion.drives
    np.testing.assert_allclose([drives["lower"].value[-1], drives["upper"].value[-1]], ends, rtol=1e-9, atol=1e-12)
    lost = G * (floor * (LOWER + UPPER) * ways[0] + top * UPPER * ways[1])
    assert -found.energy.work[-1] == pytest.approx(lost, rel=1e-9)
    shares = G * np.array([floor * (LOWER + UPPER), top * UPPER]) * ways
    assert found.losses == pytest.approx(dict(zip(("friction in floor", "friction in top"), shares, strict=True)))
    assert found.energy.worst < 1e-10
    assert efforts(found) < 1e-9
    assert found.events[-1].text == "friction holds the mechanism"


def test_a_growing_pull_moves_both_blocks_and_then_one_under_the_other() -> None:
    """They move together from (m1 + m2) g mu1 on; the upper one is left behind from (m1 + m2) g (mu1 + mu2) on."""
    floor, top, growth = 0.1, 0.3, 20.0
    found = run(blocks(floor, top, ck.force("lower", (lambda t: growth * t, 0), at="P")), 0.0, 0.0, until=1.0)
    moved, parted = (LOWER + UPPER) * G * np.array([floor, floor + top]) / growth
    slips = [event for event in found.events if event.name == "slips"]
    assert [event.time for event in slips] == [pytest.approx(moved, rel=1e-9), pytest.approx(parted, rel=1e-8)]
    upper = found.motion.drives["upper"].rate + found.motion.drives["lower"].rate
    together = growth * (parted - moved) ** 2 / (2.0 * (LOWER + UPPER))
    assert upper[-1] == pytest.approx(together + top * G * (1.0 - parted), rel=1e-8)
    assert efforts(found) < 1e-8


RATIO = RADIUS, WHEEL = 0.03, 0.06
PIN, RUB, DRIVEN, TURNED, TORQUE = 0.01, 0.2, 0.001, 0.004, 2.0


def wheels(pair: object, apart: float, *more: object) -> ck.Mechanism:
    """Two wheels on rubbing pins."""
    return ck.Mechanism(
        "Wheels",
        ck.link("frame", A=(0, 0), B=(apart, 0)),
        ck.link("one", A=(0, 0)),
        ck.link("two", B=(0, 0)),
        pair,
        ck.drive("one"),
        ck.mass("one", 1.0, at="A", inertia=DRIVEN),
        ck.mass("two", 1.0, at="B", inertia=TURNED),
        ck.friction("A", RUB, radius=PIN),
        ck.friction("B", RUB, radius=PIN),
        *more,
        units=SI,
    )


def geared(angle: float) -> float:
    """The acceleration of the first wheel, whose teeth push by F at its radius and load both pins by F / cos angle."""
    off = RUB * PIN / np.cos(angle)
    return TORQUE / (DRIVEN + TURNED * (RADIUS / WHEEL) / (WHEEL - off) * (RADIUS + off))


@pytest.mark.parametrize("angle", ck.deg([15.0, 25.0]))
def test_teeth_load_rubbing_pins(angle: float) -> None:
    """The tooth force at its pressure angle is the force in both pins."""
    pair = ck.gear("one", "two", radii=RATIO, pressure_angle=angle)
    found = ck.simulate(wheels(pair, RADIUS + WHEEL, ck.torque("one", TORQUE)), start=(0.0, 1.0), until=0.02)
    np.testing.assert_allclose(found.motion.drives["one"].second, geared(angle), rtol=1e-11)
    assert found.energy.worst < 1e-10
    assert efforts(found) < 1e-11


def test_a_strand_loads_rubbing_pins() -> None:
    """A belt without pretension pulls by one strand, as teeth without a pressure angle push."""
    mechanism = wheels(ck.belt("one", "two", radii=RATIO), 0.3, ck.torque("one", TORQUE))
    found = ck.simulate(mechanism, start=(0.0, 1.0), until=0.02)
    np.testing.assert_allclose(found.motion.drives["one"].second, geared(0.0), rtol=1e-11)
    assert efforts(found) < 1e-11


@pytest.mark.full
def test_a_taut_belt_holds_its_wheels_until_the_torque_overcomes_both_pins() -> None:
    """At rest each pin has the sum of both strands; the second pin's moment counts by the ratio."""
    tension, apart, growth = 100.0, 0.3, 5.0
    pair = ck.belt("one", "two", radii=RATIO, name="belt")
    loads = ck.pretension("belt", tension), ck.torque("one", lambda t: growth * t)
    found = ck.simulate(wheels(pair, apart, *loads), start=(0.0, 0.0), until=0.4)
    lean = (WHEEL - RADIUS) / apart
    slips = next(event for event in found.events if event.name == "slips")
    # both strands lean against the line of axes: T + t and T - t pull by 2 T along it, by 2 t sin across
    carried = 0.0
    for _ in range(60):
        pull = np.hypot(2.0 * tension * np.sqrt(1.0 - lean**2), carried * lean)
        carried = RUB * PIN * pull / WHEEL
    assert slips.time == pytest.approx((RUB * PIN * pull + carried * RADIUS) / growth, rel=1e-8)


def test_friction_in_the_coordinates_of_all_links_is_that_by_tables() -> None:
    """Accelerations and powers of a slider-crank at random states, by two methods."""
    rubbed = slider_crank().replace(
        ck.friction("guide", 0.1, length=0.05), *(ck.friction(pin, 0.1, radius=0.01) for pin in "OAB")
    )
    begun = simulation_start(rubbed, {"crank": (1.0, 20.0)}, {}, None)
    table = chart_of(begun.motion, ("crank",), {})
    rng = np.random.default_rng(3)
    for value, speed in zip(rng.uniform(-2.0, 4.0, 20), rng.uniform(-30.0, 30.0, 20), strict=True):
        values, speeds = np.array([value]), np.array([speed])
        table.begin(0.0, values, speeds)
        known = table.rates(0.0, values, speeds)
        links, state = by_links(table, table.state(0.0, values, speeds))
        n = len(links.free)
        links.begin(0.0, state[:n], state[n:])
        found = links.rates(0.0, state[:n], state[n:])
        turning = found.accelerations[links.free.index("crank.angle")]
        np.testing.assert_allclose([turning, found.power], [known.accelerations[0], known.power], rtol=1e-10)


def test_a_five_bar_with_rubbing_pins_loses_what_its_frictions_take() -> None:
    """The energy that is missing is the power of the frictions of the solved motion, over the time."""
    rubbed = five_bar().replace(*(ck.friction(pin, 0.05, radius=0.004) for pin in "APQRD"))
    found = ck.simulate(
        rubbed,
        start=dict(zip(("left", "right"), ck.deg([100, 60]), strict=True)),
        until=0.2,
        times=np.linspace(0, 0.2, 401),
    )
    power = found.forces.friction.power
    steps = np.diff(found.times)[0] / 3.0 * (power[2:-2:2] + 4.0 * power[3:-1:2] + power[4::2])
    np.testing.assert_allclose(found.energy.work[4::2] - found.energy.work[2], np.cumsum(steps), rtol=1e-5)
    assert found.energy.work[-1] < -1e-3
    assert abs(sum(found.losses.values()) + found.energy.work[-1]) < 1e-9 * found.energy.peak
    assert found.energy.worst < 1e-9
    assert efforts(found) < 1e-9


@pytest.mark.full
def test_blocks_bounce_off_their_stop() -> None:
    """The upper block hits the end of its way on the lower one: ways, momenta and the energy lost there."""
    floor, top, end = 0.1, 0.3, 0.5
    for restitution in (0.0, 0.5):
        stop = ck.stop("top", high=end, restitution=restitution, name="buffer")
        found = run(blocks(floor, top, stop), 0.0, 3.0)
        # the lower block stays until then, held by the floor to the last newton
        approach = np.sqrt(9.0 - 2.0 * top * G * end)
        reduced = LOWER * UPPER / (LOWER + UPPER)
        lost = reduced * approach**2 * (1.0 - restitution**2) / 2.0
        assert found.losses["buffer"] == pytest.approx(lost, rel=1e-9)
        assert sum(found.losses.values()) == pytest.approx(-found.energy.work[-1], rel=1e-10)
        first = UPPER * approach * (1.0 + restitution) / (LOWER + UPPER)
        event = found.events[0]
        assert event.time == pytest.approx((3.0 - approach) / (top * G), rel=1e-9)
        ends, _ = piecewise(floor, top, first, -restitution * approach)
        np.testing.assert_allclose(found.motion.drives["lower"].value[-1], ends[0], rtol=1e-9)
        np.testing.assert_allclose(found.motion.drives["upper"].value[-1], end + ends[1], rtol=1e-9)
        assert found.energy.worst < 1e-10


def test_an_arm_throws_its_ball_and_turns_on_in_its_rubbing_pin() -> None:
    """Its speed is w / (1 + k w t), k = p / sqrt(1 - p^2), p = mu r S / J; S and J fall where the ball is let go."""
    rub, radius, mass, centre, inertia, ball, at = 0.2, 0.02, 1.5, 0.3, 0.05, 0.3, 0.5
    mechanism = ck.Mechanism(
        "Arm",
        ck.link("frame", A=(0, 0)),
        ck.link("arm", A=(0, 0), P=(at, 0)),
        ck.link("ball", P=(0, 0)),
        ck.drive("arm"),
        ck.drive("ball", on="arm"),
        ck.mass("arm", mass, at=(centre, 0), inertia=inertia),
        ck.mass("ball", ball, at="P", inertia=1e-3),
        ck.friction("A", rub, radius=radius),
        ck.release("P", until=0.1),
        units=SI,
    )
    found = ck.simulate(mechanism, start={"arm": (0.0, 10.0), "ball": (0.0, 0.0)}, until=1.0)
    speed = 10.0
    for phase, moment, own in zip(
        found.phases,
        (mass * centre + ball * at, mass * centre),
        (inertia + mass * centre**2 + ball * at**2, inertia + mass * centre**2),
        strict=True,
    ):
        part = rub * radius * moment / own
        speed /= 1.0 + part / np.sqrt(1.0 - part**2) * speed * (phase.last - phase.first)
        assert phase.motion.links["arm"].angular_velocity[-1] == pytest.approx(speed, rel=1e-9)
    assert found.energy.worst < 1e-10


@pytest.mark.parametrize("speed", [3.0, -3.0])
def test_where_friction_has_no_motion_the_simulation_ends_and_keeps_what_was(speed: float) -> None:
    """A rod so short that it wedges the slider: there tan f is (1 + m x'^2 / J) over the coefficient.

    As its rod leans to one side a second solution comes in from infinite forces there, which the motion passes by; as
    it leans to the other its own forces grow beyond all bounds.
    """
    rod, coefficient, mass, inertia = 1.05, 0.5, 2.0, 50.0
    wedging = ck.Mechanism(
        "Short rod",
        ck.link("frame", O=0),
        ck.link("crank", O=0, A=1),
        ck.link("rod", A=0, B=rod),
        ck.link("slider", B=0),
        ck.slide("slider", on="frame", at="B", through="O", angle=0, name="guide"),
        ck.drive("crank"),
        ck.mass("crank", 1.0, at="O", inertia=inertia),
        ck.mass("slider", mass, at="B", inertia=0.0),
        ck.friction("guide", coefficient),
        units=SI,
    )
    found = ck.simulate(wedging, start={"crank": (0.1, speed)}, until=2.0)
    second, event = found.events
    assert (second.name, second.stops, event.name, event.stops) == ("may wedge", False, "wedges", True)
    assert found.times[-1] == event.time > 1.0
    assert found.energy.worst < 1e-9
    q = found.motion.drives["crank"].value
    tangent = abs(np.sin(q)) / np.sqrt(rod**2 - np.sin(q) ** 2)
    moved = np.sin(q) + np.cos(q) * np.sin(q) / np.sqrt(rod**2 - np.sin(q) ** 2)  # the slider's rate by the crank's
    beyond = coefficient * tangent / (1.0 + mass * moved**2 / inertia)
    assert beyond[-1] == pytest.approx(1.0, rel=1e-7)
    # at the end of the step in which it comes in
    assert 0.0 < second.time - found.times[np.argmax(beyond > 1.0) - 1] < 0.1


def test_speeds_are_kept_where_the_coordinates_of_all_links_take_over() -> None:
    """With friction they were lost there: contacts that were not known to slide yet counted as at rest."""
    drawn = random_mechanism(1, seed=489604)
    masses = [ck.mass(link, 1.0, inertia=0.5) for link in drawn.links if link != "frame"]
    pins = [ck.friction("A", 0.1, radius=0.2), ck.friction("B", 0.1, radius=0.2)]
    turned = drawn.replace(*masses, *pins, ck.motor("crank", stall=200.0, no_load=7.0), units=SI)
    found = ck.simulate(turned, until=2.0)
    assert "coordinate" in [event.name for event in found.events]
    assert found.energy.worst < 1e-8


def test_nothing_is_searched_for_at_rest_where_no_load_depends_on_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """A motor too weak for the friction: it is asked twice whether it moves, not two hundred times."""
    asked = []
    whole = FrictionTable.direction_from_rest
    monkeypatch.setattr(FrictionTable, "direction_from_rest", lambda *given: asked.append(1) or whole(*given))
    rotor = ck.Mechanism(
        "Rotor",
        ck.link("frame", O=0),
        ck.link("rotor", O=0, P=1),
        ck.drive("rotor"),
        ck.mass("rotor", 5.0, at="O", inertia=0.4),
        ck.gravity(0, -9.81),
        ck.friction("O", 0.2, radius=0.1),
        ck.motor("rotor", stall=0.9, no_load=10.0),
        units=SI,
    )
    held = ck.simulate(rotor, start=0.0, until=3.0)
    assert [event.name for event in held.events] == ["sticks"]
    assert held.times[-1] == 3.0
    assert len(asked) < 10
    # the friction of five kilograms holds 0.2 * 5 * 9.81 * 0.1 = 0.981 at the most, and a rising torque overcomes it
    rising = rotor.replace(ck.effort("rotor", lambda t: 0.1 * t))
    slipped = ck.simulate(rising, start=0.0, until=3.0)
    assert [event.name for event in slipped.events] == ["sticks", "slips"]
    assert slipped.events[1].time == pytest.approx(0.81, rel=1e-9)


@pytest.mark.parametrize("number", [1, 8, 12])
def test_random_machines_with_motors_stops_and_friction(number: int) -> None:
    """The command of that module tries more; 8 rests in its friction, as others that took 15 s to tell."""
    found = tried(6, number, 30.0)
    assert found is not None
    assert found.how == "done"


def test_counted_angles_are_followed_beyond_the_end_of_a_table() -> None:
    """The states of wheels behind it were those of the start, unsolvable from there: it ended in a traceback."""
    found = tried(21, 19, 60.0, 1.1)
    assert found is not None
    assert found.how == "done"


def test_pairs_that_never_slide_have_no_sense() -> None:
    """A bar from one point of a crank through a block at another: its slide slid in a random sense where no table is.

    There friction had no solution, so that machines wedged that just turned.
    """
    crank = ck.Mechanism(
        "A bar through a block on one crank",
        *(ck.link("frame", O=0), ck.link("crank", O=0, A=1, B=2 + 1j)),
        *(ck.link("bar", A=0, D=1), ck.link("block", B=0)),
        ck.slide("block", on="bar", at="B", through="A", toward="D", name="guide"),
        *(ck.drive("crank"), ck.drawn(O=0, A=1, B=2 + 1j)),
        *(ck.mass(link, 1.0, inertia=0.2) for link in ("crank", "bar", "block")),
        *(ck.friction("A", 0.1, radius=0.1), ck.friction("guide", 0.1)),
        units=SI,
    )
    chart = chart_of(ck.solve(crank, {"crank": [0.3]}), ("crank",), {})
    assert isinstance(chart, FrictionTable)
    for value in (0.3, 1.1, 2.9):
        assert not chart._solved(chart.state(0.0, np.array([value]), np.array([2.0])), 1.0).senses.any()


def test_a_friction_that_equilibrium_does_not_determine_is_refused() -> None:
    """Conjugate cams are squeezed between each other as one likes: the force in the cam's pin is anything."""
    plain = ck.load("conjugate-cams")
    masses = [ck.mass(link, 1.0, inertia=100.0) for link in ("cam", "follower")]
    rubbing = plain.replace(*masses, ck.friction("A", 0.1, radius=3.0), units=SI, unit="")
    with pytest.raises(ck.errors.InvalidInput, match="equilibrium does not determine the normal force in A"):
        ck.simulate(rubbing, until=0.01)


def solutions(chart: FrictionTable, time: float, value: float, speed: float) -> list[tuple[float, float]]:
    """All accelerations by Coulomb's law from 60 random starts of a least squares method, with their determinants."""
    from scipy.optimize import approx_fprime, least_squares

    here = chart._in_table(time, value, speed, np.sign(speed))
    assert here is not None
    normal, rng = here.normal, np.random.default_rng(1)
    layout, count = normal.layout, len(normal.senses)
    own, by = (layout.joined(one) for one in (normal.own + normal.push / normal.inertia * normal.second, normal.grown))
    scale, found = np.abs(own).max(), list[Number]()

    def off(sums: Number) -> Number:
        forces = np.abs(own / scale + (-normal.senses * sums) @ by)
        return sums - np.bincount(layout.owners, forces, count)

    for _ in range(60):
        start = 10.0 ** rng.uniform(-2, 2) * np.abs(rng.normal(size=count))
        one = least_squares(off, start, xtol=1e-14, ftol=1e-14, gtol=1e-14)
        known = any(np.allclose(one.x, other, rtol=1e-5) for other in found)
        if np.max(np.abs(one.fun)) < 1e-10 * (1.0 + np.max(np.abs(one.x))) and np.all(one.x > 0.0) and not known:
            found.append(one.x)
    rates = [(normal.push - float(normal.along @ (normal.senses * one)) * scale) / normal.inertia for one in found]
    return [(rate, float(np.linalg.det(approx_fprime(one, off)))) for rate, one in zip(rates, found, strict=True)]


def test_a_second_motion_is_passed_by_until_none_is_left() -> None:
    """Painleve's paradox: it comes in from infinite forces and is no reason to end, as machines did there.

    The motion ends where both meet, behind which there is none.
    """
    made = machine(11, 16)
    assert made is not None
    found = ck.simulate(made, until=2.0)
    assert [event.name for event in found.events] == ["may wedge", "jump", "stop", "wedges"]
    assert found.energy.worst < 1e-9
    step = found.course.steps[-1]
    chart, last = step.chart, step.last
    assert isinstance(chart, FrictionTable)
    chart.recall(step.memory)
    value, speed, _ = step.between(np.array(last)).tolist()
    before = solutions(chart, last, value - 1e-3 * speed, speed)
    assert sorted(np.sign(det) for _, det in before) == [-1.0, 1.0]
    assert before[0][0] == pytest.approx(before[1][0], rel=0.05)
    assert solutions(chart, last, value + 1e-5 * speed, speed) == []
    assert len(solutions(chart, 0.0, *found.course.steps[2].between(np.array(found.course.steps[2].last))[:2])) == 1


def test_what_starts_one_way_does_not_run_the_other() -> None:
    """Statically it would start, but its inertia presses its contacts so that it stays: it ran away backward."""
    found = tried(31, 0, 60.0)
    assert found is not None
    assert found.how == "done"
    assert "'sticks': 1" in found.detail
