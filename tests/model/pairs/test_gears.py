"""Gears, belts and racks: exact ratios of trains, turns counted, structures, bad input."""

from __future__ import annotations

import warnings
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.kinematics.groups.general import GeneralSolver
from compoundkin.kinematics.one_design import motion_of_design
from tests.support import examples, reference

# Angles are sums and products of few terms: rounding of the largest of them.
EXACT = 1e-13

teeth = st.integers(12, 90)


def rates(motion: ck.results.Motion) -> dict[str, float]:
    return {name: float(np.ravel(link.angular_velocity)[-1]) for name, link in motion.links.items()}


def passes(motion: ck.results.Motion) -> bool:
    check = ck.verify(motion)
    assert check.passed, [finding for finding in check.findings if not finding.passed]
    return bool(motion.assembled.all())


def planetary(sun: int, planet: int, *drives: Any) -> ck.Mechanism:
    """A sun and a ring about O, a planet between them on an arm; the frame's own link only carries O."""
    ring = sun + 2 * planet
    return ck.Mechanism(
        "Planetary train",
        ck.link("frame", O=0),
        ck.link("sun", O=0, S=(sun / 2, 0)),
        ck.link("ring", O=0, R=(ring / 2, 0)),
        ck.link("arm", O=0, P=((sun + planet) / 2, 0)),
        ck.link("planet", P=0, Q=(planet / 2, 0)),
        ck.gear("sun", "planet", carrier="arm", teeth=(sun, planet), module=1),
        ck.gear("planet", "ring", carrier="arm", teeth=(planet, ring), internal=True, module=1),
        *drives,
    )


# --- Willis's equation, in fractions --------------------------------------------------------------------


def willis(sun: int, planet: int, known: dict[str, Fraction]) -> dict[str, Fraction]:
    """The rates of sun, ring, arm and planet from two of the first three: (sun - arm) / (ring - arm) = -R / S."""
    ring = sun + 2 * planet
    w = dict(known)
    if "arm" not in w:
        w["arm"] = (sun * w["sun"] + ring * w["ring"]) / (sun + ring)
    if "sun" not in w:
        w["sun"] = w["arm"] - Fraction(ring, sun) * (w["ring"] - w["arm"])
    if "ring" not in w:
        w["ring"] = w["arm"] - Fraction(sun, ring) * (w["sun"] - w["arm"])
    w["planet"] = w["arm"] - Fraction(sun, planet) * (w["sun"] - w["arm"])
    return w


@settings(deadline=None, max_examples=examples(40))
@given(teeth, teeth, st.permutations(("sun", "ring", "arm")), st.integers(-9, 9), st.integers(1, 9))
def test_planetary_train_by_willis(sun: int, planet: int, links: list[str], held: int, speed: int) -> None:
    """Any two of sun, ring and arm driven, the one held still or turning: rates and angles over many turns."""
    first, second, _ = links
    mechanism = planetary(sun, planet, ck.drive(first), ck.drive(second))
    turns = np.array([0.0, 0.4, -3.0, 7.5]) * 2 * np.pi
    values = {first: turns * speed, second: turns * held}
    motion = ck.solve(mechanism, values, speed={first: speed, second: held})
    expected = willis(sun, planet, {first: Fraction(speed), second: Fraction(held)})
    found = rates(motion)
    for name, rate in expected.items():
        assert found[name] == pytest.approx(float(rate), rel=EXACT, abs=EXACT * max(speed, abs(held)))
        angle = motion.links[name].angle
        assert np.max(np.abs(angle - float(rate) * turns)) < 1e-12 * max(1.0, float(np.max(np.abs(angle))))


@pytest.mark.parametrize(
    ("drives", "link", "rate"),
    [
        ({"ring": 0, "sun": 60}, "arm", 10),  # sun 20, planet 40, ring 100
        ({"arm": -200, "sun": -100}, "ring", -220),
        ({"ring": 0, "arm": 18}, "sun", 108),
    ],
)
def test_trains_of_exercises(drives: dict[str, float], link: str, rate: float) -> None:
    mechanism = planetary(20, 40, *(ck.drive(name, values=0.0, speed=speed) for name, speed in drives.items()))
    assert rates(ck.solve(mechanism))[link] == pytest.approx(rate, rel=EXACT)


def test_annulus_fixed_as_part_of_the_frame() -> None:
    """Annulus 72 fixed, planet 20, sun 32, arm at 18 rpm: the sun makes 58.5 rpm, the planet -46.8 rpm.

    Source: epicyclic worked examples after R. S. Khurmi and J. K. Gupta, Theory of Machines, example 13.5.
    """
    mechanism = ck.Mechanism(
        "Annulus fixed",
        ck.link("frame", O=0),
        ck.link("arm", O=0, P=(26, 0)),
        ck.link("planet", P=0),
        ck.link("sun", O=0),
        ck.gear("planet", "frame", carrier="arm", teeth=(20, 72), internal=True, module=1),
        ck.gear("planet", "sun", carrier="arm", teeth=(20, 32), module=1),
        ck.drive("arm", speed=18),
    )
    assert [group.name for group in ck.decompose(mechanism).groups] == ["RG", "RG"]
    motion = ck.solve(mechanism)
    assert passes(motion)
    assert rates(motion)["sun"] == pytest.approx(58.5, rel=EXACT)
    assert rates(motion)["planet"] == pytest.approx(-46.8, rel=EXACT)


def test_two_annuli_with_compound_planets() -> None:
    """C 28, D 26, E = F = 18, annuli A 64 and B 62, arm at -100: A fixed, B makes -4.1 rpm; A at 10 rpm, 5.4.

    Source: after R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 13; the fractions by Willis's equation.
    """
    mechanism = ck.Mechanism(
        "Two annuli",
        ck.link("frame", O=0),
        ck.link("A", O=0),
        ck.link("B", O=0),
        ck.link("arm", O=0, P=(2, 0), Q=(0, 2)),
        ck.link("C-D", O=0),
        ck.link("E", P=0),
        ck.link("F", Q=0),
        ck.gear("E", "A", carrier="arm", teeth=(18, 64), internal=True),
        ck.gear("E", "C-D", carrier="arm", teeth=(18, 28)),
        ck.gear("F", "C-D", carrier="arm", teeth=(18, 26)),
        ck.gear("F", "B", carrier="arm", teeth=(18, 62), internal=True),
        ck.drive("arm", values=0.0, speed=-100),
        ck.drive("A", values=0.0),
    )
    e = Fraction(64, 28) * Fraction(26, 62)
    for a, printed in ((0, -4.1), (10, 5.4)):
        found = rates(ck.solve(mechanism, speed={"A": a}))["B"]
        assert found == pytest.approx(float(-100 + e * (a + 100)), rel=1e-12)
        assert abs(found - printed) < 0.05


def test_fergusons_paradox() -> None:
    """On one thick planet a wheel of one tooth more than the fixed one creeps forward, of one fewer backward."""
    suns = {"more": 101, "fewer": 99}
    mechanism = ck.Mechanism(
        "Ferguson's paradox",
        ck.link("frame", O=0),
        ck.link("arm", O=0, P=(60, 0)),
        ck.link("planet", P=0),
        *(ck.link(name, O=0) for name in suns),
        ck.gear("frame", "planet", carrier="arm", teeth=(100, 20)),
        *(ck.gear("planet", name, carrier="arm", teeth=(20, count)) for name, count in suns.items()),
        ck.drive("arm", values=ck.deg([0, 360, 3600])),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    for name, count in suns.items():
        creep = Fraction(count - 100, count)
        np.testing.assert_allclose(
            motion.links[name].angle, np.array([0, 1, 10]) * 2 * np.pi * float(creep), atol=1e-13
        )


@settings(deadline=None, max_examples=examples(30))
@given(teeth, teeth, teeth, teeth)
def test_reverted_compound_train(fixed: int, first: int, second: int, out: int) -> None:
    """The frame's wheel, two planets on one link and the wheel out: out / arm = 1 - e, and 0 or a lock for e = 1."""
    mechanism = ck.Mechanism(
        "Reverted train",
        ck.link("frame", O=0),
        ck.link("arm", O=0, P=(1, 0)),
        ck.link("planets", P=0),
        ck.link("out", O=0),
        ck.gear("frame", "planets", carrier="arm", teeth=(fixed, first)),
        ck.gear("planets", "out", carrier="arm", teeth=(second, out)),
        ck.drive("arm"),
    )
    e = Fraction(fixed, first) * Fraction(second, out)
    assert rates(ck.solve(mechanism))["out"] == pytest.approx(float(1 - e), rel=1e-12, abs=EXACT * float(e))


def differential() -> ck.Mechanism:
    """Two equal wheels on one axis, joined by two planets that mesh with each other: a car's, of spur gears."""
    return ck.Mechanism(
        "Differential of spur gears",
        ck.link("frame", O=0),
        ck.link("left", O=0, L=(5, 0)),
        ck.link("right", O=0, R=(5, 0)),
        ck.link("case", O=0, P=ck.polar(9, -0.4), Q=ck.polar(9, 0.4)),
        ck.link("planet-1", P=0),
        ck.link("planet-2", Q=0),
        ck.gear("left", "planet-1", carrier="case", teeth=(30, 15)),
        ck.gear("planet-1", "planet-2", carrier="case", teeth=(15, 15)),
        ck.gear("planet-2", "right", carrier="case", teeth=(15, 30)),
        ck.drive("left", values=0.0),
        ck.drive("right", values=0.0),
    )


@given(st.floats(-12, 12), st.floats(-12, 12), st.floats(-9, 9), st.floats(-9, 9))
@settings(deadline=None, max_examples=examples(25))
def test_the_case_of_a_differential_is_the_mean(a: float, b: float, one: float, two: float) -> None:
    motion = ck.solve(differential(), {"left": a, "right": b}, speed={"left": one, "right": two})
    assert float(motion.links["case"].angle) == pytest.approx((a + b) / 2, abs=1e-12)
    assert rates(motion)["case"] == pytest.approx((one + two) / 2, abs=1e-12)


# --- angles over many turns ------------------------------------------------------------------------------


def two_wheels(pair: Any, **values: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Two wheels",
        ck.link("frame", A=0, B=(30, 0)),
        ck.link("one", A=0, P=(5, 0)),
        ck.link("two", B=0, Q=(5, 0)),
        pair,
        ck.drive("one", **values),
    )


@pytest.mark.parametrize(
    ("pair", "ratio"),
    [
        (ck.gear("one", "two", teeth=(20, 40)), Fraction(-1, 2)),
        (ck.gear("one", "two", teeth=(20, 40), internal=True), Fraction(1, 2)),
        (ck.gear("one", "two", radii=(10, 20)), Fraction(-1, 2)),
        (ck.gear("one", "two", teeth=(17, 53)), Fraction(-17, 53)),
        (ck.belt("one", "two", radii=(10, 4)), Fraction(5, 2)),
        (ck.belt("one", "two", radii=(10, 4), crossed=True), Fraction(-5, 2)),
    ],
)
def test_ten_turns_in_coarse_steps(pair: Any, ratio: Fraction) -> None:
    """Steps of 170 and 360 degrees alias nothing: the angle is the ratio times the driver's."""
    for step in (170, 360, 37):
        degrees = np.arange(0, 3601, step)
        motion = ck.solve(two_wheels(pair), {"one": ck.deg(degrees)}, speed=3, acceleration=-2)
        two = motion.links["two"]
        np.testing.assert_allclose(np.rad2deg(two.angle), degrees * float(ratio), rtol=1e-14, atol=1e-11)
        np.testing.assert_allclose(two.angular_velocity, 3 * float(ratio), rtol=1e-14)
        np.testing.assert_allclose(two.angular_acceleration, -2 * float(ratio), rtol=1e-14)
    assert passes(motion)


def test_phase_is_the_angle_of_the_second_where_that_of_the_first_is_zero() -> None:
    motion = ck.solve(two_wheels(ck.gear("one", "two", teeth=(20, 40), phase=0.3)), {"one": [0.0, 1.0]})
    np.testing.assert_allclose(motion.links["two"].angle, [0.3, -0.2], atol=EXACT)


@pytest.mark.parametrize("drawn_at", [-160, -20, 70, 179, 180, 200, 340])
def test_the_phase_is_read_off_a_drawing_at_any_angle(drawn_at: float) -> None:
    """Where the driver comes to the drawn pose the driven wheel is as drawn, though the ratio is no whole number."""
    one, two = ck.polar(5, ck.deg(drawn_at)), 30 + ck.polar(5, ck.deg(50))
    values = ck.deg(np.arange(drawn_at % 360 - 180, drawn_at % 360 + 181, 20))
    mechanism = two_wheels(ck.gear("one", "two", radii=(12, 18)), values=values).replace(ck.drawn(P=one, Q=two))
    motion = ck.solve(mechanism)
    at = int(np.argmin(np.abs(motion.points["P"].position - one)))
    assert abs(motion.points["P"].position[at] - one) < 1e-12
    assert abs(motion.points["Q"].position[at] - two) < 1e-12


def test_the_phase_of_a_wheel_on_a_driven_arm() -> None:
    """Crank on crank: the drawn angles of links that drivers turn together are counted on as one."""
    a, b, c = ck.polar(4, ck.deg(170)), ck.polar(3, ck.deg(220)), ck.polar(1, ck.deg(-75))
    mechanism = ck.Mechanism(
        "Two driven arms",
        ck.link("frame", O=0),
        ck.link("upper", O=0, A=(4, 0)),
        ck.link("lower", A=0, B=(3, 0)),
        ck.link("wheel", O=0, W=(1, 0)),
        ck.gear("lower", "wheel", carrier="upper", teeth=(17, 30)),
        ck.drive("upper", values=ck.deg(np.arange(350, 711, 10))),
        ck.drive("lower", on="upper", values=ck.deg(np.arange(230, 591, 10))),
        ck.drawn(A=a, B=a + b, W=c),
    )
    motion = ck.solve(mechanism, speed={"upper": 1, "lower": 1})
    assert passes(motion)
    at = int(np.argmin(np.abs(motion.points["A"].position - a)))
    assert abs(motion.points["B"].position[at] - a - b) < 1e-12
    assert abs(motion.points["W"].position[at] - c) < 1e-12


def test_a_long_motion_in_blocks_is_that_of_its_pieces() -> None:
    """More than 65,536 poses are solved in blocks; turns of a link on a coupler are counted across them."""
    crank = np.linspace(0.0, 40 * np.pi, 70_001)
    whole = ck.solve(geared_coupler(), {"crank": crank})
    piece = ck.solve(geared_coupler(), {"crank": crank[:: 35_000 // 7]})
    assert np.max(np.abs(whole.links["out"].angle[:: 35_000 // 7] - piece.links["out"].angle)) < 1e-11
    assert (
        np.max(np.abs(whole.links["out"].angular_velocity[:: 35_000 // 7] - piece.links["out"].angular_velocity))
        < 1e-11
    )
    assert np.max(np.abs(np.diff(whole.links["out"].angle))) < 0.05


def test_radii_and_phases_as_designs() -> None:
    first = np.array([[5.0], [10.0], [21.0]])
    phase = np.array([[0.0], [0.5], [-1.0]])
    crank = np.linspace(0, 19.5, 40)
    many = ck.solve(two_wheels(ck.gear("one", "two", radii=(first, 30 - first), phase=phase)), {"one": crank})
    assert many.shape == (3, 40)
    np.testing.assert_allclose(many.links["two"].angle, phase - crank * first / (30 - first), atol=1e-13)


# --- gears in linkages -----------------------------------------------------------------------------------


def five_bar(pair: Any, **drive: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Geared five-bar",
        ck.link("frame", A=0, D=(6, 0)),
        ck.link("crank", A=0, B=(1, 0)),
        ck.link("coupler", B=0, C=(7, 0)),
        ck.link("arm", E=0, C=(9, 0)),
        ck.link("wheel", D=0, E=(4, 0)),
        pair,
        ck.drive("crank", **drive),
    )


@pytest.mark.parametrize(("branch", "sign"), [("open", -1), ("crossed", 1)])
@pytest.mark.parametrize(
    "pair",
    [
        ck.belt("crank", "wheel", teeth=(40, 20), phase=ck.deg(30)),
        ck.gear("wheel", "crank", teeth=(20, 40), internal=True, phase=ck.deg(-15)),
    ],
    ids=["belt", "internal gear"],
)
def test_norton_geared_five_bar(pair: Any, branch: str, sign: int) -> None:
    """Both wheels turn alike: a belt, or an idler, or one gear inside the other."""
    entry = reference("norton_geared_fivebar_4_4")
    mechanism = five_bar(pair, values=ck.deg([60.0]), speed=50)
    assert [group.name for group in ck.decompose(mechanism).groups] == [f"R{pair.code}", "RRR"]
    found = []
    for mode in (1, -1):
        motion = ck.solve(mechanism, modes={"coupler": mode})
        assert passes(motion)
        found.append(motion)
    expected = entry["expected"]["full"][branch]
    close = [
        m for m in found if abs(np.exp(1j * (m.links["coupler"].angle[0] - ck.deg(expected["theta3_deg"]))) - 1) < 1e-9
    ]
    (motion,) = close
    for link, key in (("coupler", "3"), ("arm", "4"), ("wheel", "5")):
        rate = float(motion.links[link].angular_velocity[0])
        assert rate == pytest.approx(expected[f"omega{key}"], rel=1e-10)
        if key != "5":
            gap = motion.links[link].angle[0] - ck.deg(expected[f"theta{key}_deg"])
            assert abs(np.exp(1j * gap) - 1) < 1e-10
            assert float(motion.links[link].angular_acceleration[0]) == pytest.approx(expected[f"alpha{key}"], rel=1e-9)


def circles(a: Any, r: float, b: Any, s: float, side: int) -> Any:
    """The point at distance r from a and s from b, to the left (+1) or right of the way from a to b."""
    d = np.abs(b - a)
    x = (d * d + r * r - s * s) / (2 * d)
    return a + (b - a) / d * (x + 1j * side * np.sqrt(r * r - x * x))


def test_belt_coupled_cranks_against_circle_intersection() -> None:
    """The symmetrical geared five-bar of equal gears, driven by a crossed belt of equal pulleys instead.

    Source: dimensions of student programs for E. Constans and K. B. Dyer, Introduction to Mechanism Design.
    """
    values = ck.deg(np.arange(0, 361, 5))
    motions = []
    for pair in (
        ck.gear("crank", "wheel", teeth=(24, 24)),
        ck.belt("crank", "wheel", radii=(0.04, 0.04), crossed=True),
    ):
        mechanism = ck.Mechanism(
            "Symmetrical five-bar",
            ck.link("frame", A=0, D=(0.18, 0)),
            ck.link("crank", A=0, B=(0.12, 0)),
            ck.link("wheel", D=0, C=(0.12, 0)),
            ck.link("coupler", B=0, E=(0.25, 0)),
            ck.link("arm", C=0, E=(0.25, 0)),
            pair,
            ck.drive("crank", values=values),
            ck.drawn(E=(0.21, 0.233)),
        )
        motions.append(ck.solve(mechanism))
        assert passes(motions[-1])
    b, c = 0.12 * np.exp(1j * values), 0.18 + 0.12 * np.exp(-1j * values)
    apex = circles(b, 0.25, c, 0.25, 1)
    for motion in motions:
        assert np.max(np.abs(motion.points["E"].position - apex)) < 1e-12
    assert abs(motions[0].points["E"].position[12] - (0.3078425978978072 + 0.13669569958749356j)) < 1e-10


def geared_coupler() -> ck.Mechanism:
    """A double-crank whose coupler's gear drives a wheel on the rocker's axis, carried by the rocker."""
    return ck.Mechanism(
        "Geared double-crank",
        ck.link("frame", A=0, D=(20, 0)),
        ck.link("crank", A=0, B=(50, 0)),
        ck.link("coupler", B=0, C=(55, 0)),
        ck.link("rocker", D=0, C=(45, 0)),
        ck.link("out", D=0, H=(5, 0)),
        ck.gear("coupler", "out", carrier="rocker", teeth=(20, 31)),
        ck.drive("crank", values=ck.deg(np.arange(0, 1441, 5))),
    )


def test_gear_on_a_coupler_over_four_turns() -> None:
    """Against circle intersection, unwrapped on fine steps: the wheel turns on where orientation alone starts anew."""
    motion = ck.solve(geared_coupler())
    assert passes(motion)
    fine = np.deg2rad(np.arange(0, 1440.5, 0.5))
    b = 50 * np.exp(1j * fine)
    side = 1 if circles(b[:1], 55, 20, 45, 1)[0].imag * motion.points["C"].y[0] > 0 else -1
    c = circles(b, 55, 20, 45, side)
    assert np.max(np.abs(c[::10] - motion.points["C"].position)) < 1e-11
    coupler, rocker = np.unwrap(np.angle(c - b)), np.unwrap(np.angle(c - 20))
    assert abs(rocker[-1] - rocker[0] - 8 * np.pi) < 1e-9
    out = rocker - (coupler - rocker) * 20 / 31
    assert np.max(np.abs(motion.links["out"].angle - out[::10])) < 1e-11
    # 360 degrees a step alias nothing either
    coarse = ck.solve(geared_coupler(), {"crank": ck.deg([0, 360, 720, 1440])})
    assert np.max(np.abs(coarse.links["out"].angle - out[[0, 720, 1440, 2880]])) < 1e-11


def test_watts_sun_and_planet_against_the_law_of_cosines() -> None:
    """sun = (1 + p / s) arm - p / s rod: of equal wheels, two turns of the sun for one of the arm.

    Source: E. S. Ferguson, Kinematics of Mechanisms from the Time of Watt, figure 7.
    """
    mechanism = ck.Mechanism(
        "Sun and planet",
        ck.link("frame", A=0),
        ck.link("sun", A=0, S=(1, 0)),
        ck.link("arm", A=0, B=(2, 0)),
        ck.link("rod", B=0, C=(8, 0)),
        ck.link("crosshead", C=0),
        ck.slide("crosshead", on="frame", through="A", angle=ck.deg(90)),
        ck.gear("rod", "sun", carrier="arm", radii=(1, 1)),
        ck.drive("arm", values=ck.deg(np.arange(0, 721, 30))),
        ck.drawn(C=(0, 8)),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    arm = motion.drives["arm"].value
    rod = np.pi - np.arccos(2 * np.cos(arm) / 8)  # the rod's other end is on the vertical through A
    np.testing.assert_allclose(motion.links["rod"].angle, rod, atol=1e-12)
    sun = motion.links["sun"].angle
    np.testing.assert_allclose(sun - sun[0], 2 * arm - (rod - rod[0]), atol=1e-12)
    for at, degrees in ((1, 61.97359556858736), (3, 194.47751218592992), (5, 326.9814288032725), (12, 720.0)):
        assert float(np.rad2deg(sun[at] - sun[0])) == pytest.approx(degrees, abs=1e-9)


def test_cardan_gears_draw_a_straight_line() -> None:
    mechanism = ck.Mechanism(
        "Cardan gears",
        ck.link("frame", O=0),
        ck.link("arm", O=0, P=(2, 0)),
        ck.link("planet", P=0, Q=(2, 0), E=(0.5, 0)),
        ck.gear("planet", "frame", carrier="arm", radii=(2, 4), internal=True),
        ck.drive("arm", values=ck.deg(np.arange(0, 721, 10)), speed=3, acceleration=1),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    arm = motion.drives["arm"].value
    q, e = motion.points["Q"], motion.points["E"]
    assert np.max(np.abs(q.position - 4 * np.cos(arm))) < 1e-12
    assert np.max(np.abs(q.velocity + 12 * np.sin(arm))) < 1e-12
    assert np.max(np.abs(q.acceleration + 36 * np.cos(arm) + 4 * np.sin(arm))) < 1e-11
    assert np.max(np.abs((e.x / 2.5) ** 2 + (e.y / 1.5) ** 2 - 1)) < 1e-12


def test_belt_on_a_moving_carrier() -> None:
    """A pulley fixed to the frame, the other on an arm: of equal pulleys the second does not turn at all."""
    for radii, turned in (((3, 3), 0.0), ((3, 6), 0.5), ((6, 3), -1.0)):
        mechanism = ck.Mechanism(
            "Belt on an arm",
            ck.link("frame", O=0),
            ck.link("arm", O=0, P=(20, 0)),
            ck.link("pulley", P=0, Q=(1, 0)),
            ck.belt("frame", "pulley", carrier="arm", radii=radii),
            ck.drive("arm", values=ck.deg(np.arange(0, 1081, 45))),
        )
        motion = ck.solve(mechanism)
        assert passes(motion)
        np.testing.assert_allclose(motion.links["pulley"].angle, turned * motion.drives["arm"].value, atol=1e-13)


# --- racks -----------------------------------------------------------------------------------------------


def test_fixed_rack_with_a_pinion_on_a_moving_carrier() -> None:
    mechanism = ck.Mechanism(
        "Pinion on a rack",
        ck.link("frame", O=0),
        ck.link("carrier", C=0),
        ck.link("pinion", C=0, P=(0, -2)),
        ck.slide("carrier", on="frame", through="O", angle=0, offset=2.0),
        ck.rack("frame", "pinion", through="O", at="C", radius=2.0),
        ck.drive("carrier", values=np.linspace(-40, 40, 81), speed=3, acceleration=1),
    )
    assert [group.name for group in ck.decompose(mechanism).groups] == ["RK"]
    motion = ck.solve(mechanism)
    assert passes(motion)
    t = motion.drives["carrier"].value / 2
    cycloid = 2 * t - 2 * np.sin(t) + 1j * (2 - 2 * np.cos(t))
    assert np.max(np.abs(motion.points["P"].position - cycloid)) < 1e-12
    assert np.max(np.abs(motion.links["pinion"].angular_velocity + 1.5)) < 1e-13


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("drive", ["pinion", "bar"])
def test_moving_rack_driven_from_either_end(side: int, drive: str) -> None:
    """x = -side r angle: a rack under the pinion goes the other way than one above it."""
    slide = ck.slide("bar", on="frame", through="Q", at="R", angle=0)
    mechanism = ck.Mechanism(
        "Moving rack",
        ck.link("frame", C=0, Q=(0, -2 * side)),
        ck.link("pinion", C=0, P=(1, 0)),
        ck.link("bar", R=0, T=(5, 0)),
        slide,
        ck.rack("bar", "pinion", through="R", at="C", teeth=16, module=0.25, side=side),
        ck.drive(drive, values=np.linspace(-19.5, 19.5, 41), speed=2),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    np.testing.assert_allclose(motion.points["R"].x, 2 * side * motion.links["pinion"].angle, atol=1e-12)


def test_rack_in_a_yoke() -> None:
    """A rack on a crank's pin, its pinion held to it by a yoke on the pinion's axis: against plain geometry."""
    mechanism = ck.Mechanism(
        "Rack in a yoke",
        ck.link("frame", O=0, D=(6, 1)),
        ck.link("crank", O=0, A=2),
        ck.link("pinion", D=0, Z=(1, 0)),
        ck.link("yoke", D=0, Y=(0, 0.5)),
        ck.link("bar", A=0, T=(3, 0)),
        ck.slide("yoke", on="bar", at="D", through="A", offset=1.0, angle=0),
        ck.rack("bar", "pinion", through="A", at="D", radius=1.0),
        ck.drive("crank", values=ck.deg(np.arange(0, 721, 5))),
        ck.drawn(T=(5, 0)),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    away = 6 + 1j - 2 * np.exp(1j * motion.drives["crank"].value)
    along = np.sqrt(np.abs(away) ** 2 - 1)
    bar = np.angle(away) - np.arctan2(1, along)
    np.testing.assert_allclose(motion.links["bar"].angle, bar, atol=1e-12)
    np.testing.assert_allclose(motion.links["pinion"].angle, bar - along, atol=1e-12)


def test_a_cable_on_a_drum_lifts_a_block() -> None:
    """The load hangs on the cable that leaves the drum at its right: it rises r for a radian back."""
    mechanism = ck.Mechanism(
        "Hoist",
        ck.link("frame", C=0, G=(3, 0)),
        ck.link("drum", C=0, P=(3, 0)),
        ck.link("load", L=0),
        ck.slide("load", on="frame", through="G", angle=ck.deg(90)),
        ck.rack("load", "drum", through="L", at="C", radius=3, phase=40),
        ck.drive("drum", values=np.linspace(0, 10, 11)),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    np.testing.assert_allclose(motion.points["L"].y, -40 + 3 * (motion.links["drum"].angle - np.pi / 2), atol=1e-12)


def test_a_rack_of_a_wrong_radius_is_told() -> None:
    mechanism = ck.Mechanism(
        "Rack of a wrong radius",
        ck.link("frame", C=0, Q=(0, -2)),
        ck.link("pinion", C=0),
        ck.link("bar", R=0),
        ck.slide("bar", on="frame", through="Q", at="R", angle=0),
        ck.rack("bar", "pinion", through="R", at="C", radius=2.5),
        ck.drive("pinion"),
    )
    check = ck.verify(ck.solve(mechanism))
    (bad,) = [finding for finding in check.findings if not finding.passed]
    assert bad.name == "fit of racks and wheels"
    assert bad.pair == "bar/pinion, off by 0.5"


def test_a_rack_drawn_at_a_wrong_distance_is_told() -> None:
    links = ck.link("frame", "C", "Q"), ck.link("pinion", "C", "P"), ck.link("bar", "R", "T")
    slide = ck.slide("bar", on="frame", through="Q", at="R", angle=0)
    points = ck.drawn(C=0, Q=(0, -2), P=(1, 0), R=(1, -2), T=(3, -2))
    rack: dict[str, Any] = {"through": "R", "toward": "T", "at": "C"}
    with pytest.raises(ck.errors.InvalidMechanism, match=r"radius is 2\.5, but C is drawn 2 from the line"):
        ck.Mechanism("m", *links, slide, points, ck.rack("bar", "pinion", radius=2.5, **rack), ck.drive("pinion"))
    words = ck.rack("bar", "pinion", radius=2, side=-1, **rack)
    with pytest.raises(ck.errors.InvalidMechanism, match=r"radius is 2, but C is drawn -2 from the line.*other side"):
        ck.Mechanism("m", *links, slide, points, words, ck.drive("pinion"))
    good = ck.Mechanism("m", *links, slide, points, ck.rack("bar", "pinion", radius=2, **rack), ck.drive("pinion"))
    motion = ck.solve(good)
    assert passes(motion)
    np.testing.assert_allclose(motion.points["R"].x, 1 + 2 * motion.links["pinion"].angle, atol=1e-12)


def test_a_pinion_that_slides_across_its_rack_is_free() -> None:
    """Along the way no displacement on the rack: masked and explained, where the guide stands at right angles."""
    mechanism = ck.Mechanism(
        "Across",
        ck.link("frame", O=0),
        ck.link("bar", O=0, S=(1, 0)),
        ck.link("pinion", C=0),
        ck.slide("pinion", on="bar", through="S", angle=ck.deg(90)),
        ck.rack("frame", "pinion", through="O", at="C", radius=2),
        ck.drive("bar", values=[-1.0, 0.0, 1.0]),
    )
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(mechanism)
    assert motion.assembled.tolist() == [True, False, True]
    assert np.isnan(motion.points["C"].position[1])
    (gap,) = ck.gaps(motion)
    assert gap.reason == "pinion/bar may move without any effect on frame/pinion"


# --- instant centres -------------------------------------------------------------------------------------


def test_pitch_points_and_derived_centres() -> None:
    motion = ck.solve(
        planetary(20, 40, ck.drive("sun"), ck.drive("ring", values=0.0)), {"sun": [0.7]}, speed={"sun": 2, "ring": 0}
    )
    centres = ck.instant_centres(motion)
    arm = float(motion.links["arm"].angle[0])
    for names, radius in ((("sun", "planet"), 10), (("planet", "ring"), 50)):
        place = complex(centres[names].point[0])
        assert abs(place - radius * np.exp(1j * arm)) < 1e-11
    # the ring stands still, so that the planet turns about the same point relative to the frame
    assert abs(complex(centres["frame", "planet"].point[0]) - 50 * np.exp(1j * arm)) < 1e-9


def test_centres_of_a_rack_and_its_pinion() -> None:
    mechanism = ck.Mechanism(
        "Moving rack",
        ck.link("frame", C=0, Q=(0, -2)),
        ck.link("pinion", C=0),
        ck.link("bar", R=0),
        ck.slide("bar", on="frame", through="Q", at="R", angle=0),
        ck.rack("bar", "pinion", through="R", at="C", radius=2),
        ck.drive("pinion", values=[1.0]),
    )
    centres = ck.instant_centres(ck.solve(mechanism))
    assert abs(complex(centres["bar", "pinion"].point[0]) + 2j) < 1e-12
    assert centres["bar", "pinion"].how == "rack pair bar/pinion"


# --- structure -------------------------------------------------------------------------------------------


def test_geared_five_bar_is_a_crank_a_gear_and_a_dyad() -> None:
    expected = reference("dec_geared_fivebar", "decomposition")["expected"]
    structure = ck.decompose(five_bar(ck.gear("crank", "wheel", teeth=(40, 20))))
    assert structure.mobility.freedoms == expected["gruebler_F"]
    names = {0: "frame", 1: "crank", 2: "coupler", 3: "arm", 4: "wheel"}
    groups = [tuple(structure.ground.links[1:]), *(group.links for group in structure.groups)]
    assert groups == [tuple(names[k] for k in group) for group in expected["groups_in_solving_order"]]


@pytest.mark.parametrize(
    ("driver", "group"), [("sun", ("arm", "planet")), ("arm", ("planet",)), ("ring", ("arm", "planet"))]
)
def test_driver_exchange_of_a_planetary_train(driver: str, group: tuple[str, ...]) -> None:
    """With the ring or the sun held, the train driven at either of the others moves alike."""
    held = "sun" if driver == "ring" else "ring"
    mechanism = planetary(24, 30, ck.drive(driver), ck.drive(held, values=0.0, speed=0.0))
    structure = ck.decompose(mechanism)
    assert structure.faults == ()
    assert structure.mobility.verdict.startswith("mobility 2")
    solved = [set(group.links) for group in structure.groups]
    # an arm that is driven leaves the planet and the sun to be found one by one, else arm and planet hang together
    assert solved == ([{"planet"}, {"sun"}] if driver == "arm" else [{"arm", "planet"}])
    expected = willis(24, 30, {driver: Fraction(1), held: Fraction(0)})
    motion = ck.solve(mechanism, {driver: np.linspace(0, 12, 25)})
    assert passes(motion)
    for name, rate in expected.items():
        np.testing.assert_allclose(motion.links[name].angle, float(rate) * np.linspace(0, 12, 25), atol=1e-12)


def test_a_planetary_train_with_one_driver_is_left_free() -> None:
    structure = ck.decompose(planetary(20, 40, ck.drive("sun")))
    (fault,) = structure.faults
    assert fault.kind == "under"
    assert fault.amount == 1
    assert set(fault.links) == {"ring", "arm", "planet"}
    with pytest.raises(ck.errors.NotDetermined, match="left with 1 freedom"):
        ck.solve(structure)


def test_a_planetary_train_with_three_drivers_has_too_many() -> None:
    (fault,) = ck.decompose(planetary(20, 40, *(ck.drive(name) for name in ("sun", "ring", "arm")))).faults
    assert (fault.kind, fault.amount) == ("over", 1)


def test_two_gears_between_two_wheels_are_one_too_many() -> None:
    mechanism = two_wheels(ck.gear("one", "two", teeth=(20, 40), name="first"))
    twice = mechanism.replace(ck.gear("one", "two", teeth=(20, 30), name="second"))
    (fault,) = ck.decompose(twice).faults
    assert (fault.kind, fault.amount) == ("over", 1)
    assert "second" in fault.remedy or "first" in fault.remedy


def locking(last: int) -> ck.Mechanism:
    """The arm of a reverted train that joins two wheels fixed to the frame, driven nowhere but by its ratio."""
    return ck.Mechanism(
        "Locking train",
        ck.link("frame", O=0),
        ck.link("wheel", O=0),
        ck.link("arm", O=0, P=(1, 0)),
        ck.link("planets", P=0),
        ck.gear("frame", "planets", carrier="arm", teeth=(30, 20)),
        ck.gear("planets", "wheel", carrier="arm", teeth=(20, last)),
        ck.drive("wheel"),
    )


def test_a_train_that_locks_by_its_ratio() -> None:
    """With 30, 20, 20 and 29 teeth the wheel turns the arm; with 30 it would never turn, whatever the arm does."""
    motion = ck.solve(locking(29), speed=1)
    assert rates(motion)["arm"] == pytest.approx(-29, rel=1e-11)
    structure = ck.decompose(locking(30))
    assert structure.faults
    with pytest.raises(ck.errors.NotDetermined):
        ck.solve(locking(30))


# --- bad input -------------------------------------------------------------------------------------------

LINKS = (
    ck.link("frame", O=0, A=(30, 0)),
    ck.link("sun", O=0),
    ck.link("arm", O=0, P=(30, 0)),
    ck.link("planet", P=0, Q=(5, 0)),
    ck.link("far", A=0),
)


@pytest.mark.parametrize(
    ("pair", "place", "what"),
    [
        (ck.gear("snu", "planet", carrier="arm", teeth=(20, 40)), "gears[0].first", "no link 'snu'"),
        (ck.gear("sun", "plant", carrier="arm", teeth=(20, 40)), "gears[0].second", "no link 'plant'"),
        (ck.gear("sun", "planet", carrier="rm", teeth=(20, 40)), "gears[0].carrier", "no link 'rm'"),
        (ck.gear("sun", "planet", teeth=(20, 40)), "gears[0].carrier", "does not carry the axis of 'planet'"),
        (ck.gear("sun", "arm", carrier="arm", teeth=(20, 40)), "gears[0]", "not three different links"),
        (ck.gear("sun", "planet", carrier="arm"), "gears[0]", "has no sizes"),
        (ck.gear("sun", "planet", carrier="arm", teeth=(0, 40)), "gears[0].teeth", "0 and 40 are not two positive"),
        (ck.gear("sun", "planet", carrier="arm", teeth=(20, -4)), "gears[0].teeth", "not two positive"),
        (ck.gear("sun", "planet", carrier="arm", teeth=(20.5, 40)), "gears[0].teeth", "20.5 and 40 are not whole"),
        (ck.gear("sun", "planet", carrier="arm", radii=(-1, 31)), "gears[0].radii", "not two positive"),
        (ck.gear("sun", "planet", carrier="arm", radii=(10, 15)), "gears[0].radii", "a distance of 25, but O and P"),
        (ck.gear("sun", "planet", carrier="arm", teeth=(20, 40), module=2), "gears[0].teeth", "a distance of 60"),
        (ck.gear("sun", "planet", carrier="arm", radii=(10, 20), module=1), "gears[0].module", "without teeth"),
        (ck.gear("sun", "planet", carrier="arm", teeth=(40, 20), internal=True), "gears[0].teeth", "not larger than"),
        (ck.gear("sun", "planet", carrier="arm", radii=(9, 9), internal=True), "gears[0].radii", "not larger than"),
        (
            ck.gear("sun", "planet", carrier="arm", teeth=(20, 40), radii=(10, 10)),
            "gears[0]",
            "have different ratios",
        ),
        (ck.gear("sun", "planet", carrier="arm", teeth=(20, 40), first_at="X"), "gears[0].first_at", "the point 'X'"),
        (ck.gear("sun", "planet", carrier="arm", teeth=(20, 40), phase=np.nan), "gears[0].phase", "not finite"),
        (ck.belt("sun", "planet", carrier="arm", radii=(20, 20)), "belts[0].radii", "too near to each other"),
        (ck.belt("sun", "planet", carrier="arm"), "belts[0]", "has no sizes"),
        (ck.rack("rack", "planet", through="O", at="P", radius=3), "racks[0].rack", "no link 'rack'"),
        (ck.rack("frame", "plant", through="O", at="P", radius=3), "racks[0].pinion", "no link 'plant'"),
        (ck.rack("frame", "planet", through="O", at="X", radius=3), "racks[0].at", "has no point 'X'"),
        (ck.rack("frame", "planet", through="O", radius=3), "racks[0].at", "several points"),
        (ck.rack("frame", "planet", through="X", at="P", radius=3), "racks[0].through", "has no point 'X'"),
        (ck.rack("frame", "planet", through="O", toward="O", at="P", radius=3), "racks[0].toward", "no direction"),
        (ck.rack("frame", "planet", through="O", at="P"), "racks[0]", "no size"),
        (ck.rack("frame", "planet", through="O", at="P", teeth=20), "racks[0]", "no size"),
        (ck.rack("frame", "planet", through="O", at="P", radius=0), "racks[0].radius", "0 is not positive"),
        (ck.rack("frame", "planet", through="O", at="P", teeth=1.5, module=1), "racks[0].teeth", "whole number"),
        (
            ck.rack("frame", "planet", through="O", at="P", teeth=20, module=1, radius=9),
            "racks[0].radius",
            "do not fit",
        ),
        (ck.rack("frame", "planet", through="O", at="P", radius=3, side=0), "racks[0].side", "not a side"),
    ],
)
def test_mistakes_have_a_place(pair: Any, place: str, what: str) -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.Mechanism("m", *LINKS, pair)
    assert any(p.where == place and what in p.what for p in caught.value.problems), caught.value


def test_axes_at_one_place() -> None:
    links = ck.link("frame", A=0, B=0), ck.link("one", A=0), ck.link("two", B=0)
    with pytest.raises(ck.errors.InvalidMechanism, match="A and B"):
        ck.Mechanism("m", *links, ck.gear("one", "two", teeth=(20, 40)))


def test_one_design_of_several_that_does_not_fit() -> None:
    """It is not assembled, for the reason for which it is refused alone; the others are as they are alone."""
    radii = np.array([[10.0], [11.0], [12.0]]), np.array([[20.0], [20.0], [18.0]])
    with pytest.warns(ck.errors.UnassembledPoses, match="3 of 9 poses"):
        motion = ck.solve(two_wheels(ck.gear("one", "two", radii=radii)), [0.0, 1.0, 2.0])
    assert motion.assembled.tolist() == [[True] * 3, [False] * 3, [True] * 3]
    assert np.isnan(motion.links["two"].angle[1]).all()
    (gap,) = ck.gaps(motion)
    assert (gap.design, gap.first, gap.last, gap.group, gap.pair) == ((1,), 0, 2, "", "one/two")
    with pytest.raises(ck.errors.InvalidMechanism, match=f"gears.0..radii: {gap.reason}"):
        two_wheels(ck.gear("one", "two", radii=(11.0, 20.0)))
    for k, ratio in ((0, 2.0), (2, 1.5)):
        np.testing.assert_allclose(motion.links["two"].angle[k], -motion.links["one"].angle[k] / ratio, atol=EXACT)
    assert ck.verify(motion).passed
    own = motion_of_design(motion, 1)
    assert not own.assembled.any()
    assert [one.reason for one in ck.gaps(own)] == [gap.reason]


@pytest.mark.parametrize(
    "pair",
    [
        ck.gear("one", "two", radii=(np.array([[10.0], [11.0]]), 21.0)),
        ck.gear("one", "two", teeth=(20, np.array([[41], [42]])), module=1),
        ck.belt("one", "two", radii=(np.array([[10.0], [11.0]]), 20.0)),
    ],
    ids=["gear", "by teeth", "belt"],
)
def test_designs_of_which_none_fits(pair: Any) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="A and B"):
        two_wheels(pair)


@settings(deadline=None, max_examples=examples(60))
@given(st.lists(st.sampled_from([9.0, 10.0, 10.0001, 10.001, 30.0]), min_size=2, max_size=5), st.integers(0, 3))
def test_designs_fit_that_can_be_built_alone(first: list[float], kind: int) -> None:
    """Against each built by itself, and the reason against the text with which it is refused."""

    def made(one: Any) -> ck.Mechanism:
        if kind == 3:
            links = ck.link("frame", "C", "Q"), ck.link("pinion", "C", "P"), ck.link("bar", "R", "T")
            slide = ck.slide("bar", on="frame", through="Q", at="R", angle=0)
            shown = ck.drawn(C=0, Q=(0, -10), P=(1, 0), R=(1, -10), T=(3, -10))
            rack = ck.rack("bar", "pinion", through="R", toward="T", at="C", radius=one)
            return ck.Mechanism("m", *links, slide, shown, rack, ck.drive("pinion"))
        if kind == 2:
            return two_wheels(ck.belt("one", "two", radii=(one, 19.9)))
        sizes = ck.gear("one", "two", radii=(one, 20.0 if kind == 0 else 40.0), internal=kind == 1)
        return two_wheels(sizes)

    refused: list[str] = []
    for one in first:
        try:
            made(one)
            refused.append("")
        except ck.errors.InvalidMechanism as error:
            refused.append(error.problems[0].what)
    if all(refused):
        with pytest.raises(ck.errors.InvalidMechanism):
            made(np.reshape(first, (-1, 1)))
        return
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        motion = ck.solve(made(np.reshape(first, (-1, 1))), [0.0, 0.5])
    assert motion.assembled.all(axis=1).tolist() == [not what for what in refused]
    assert motion.assembled.any(axis=1).tolist() == [not what for what in refused]
    assert [gap.reason for gap in ck.gaps(motion)] == [what for what in refused if what]


@pytest.mark.parametrize("sizes", [20, (20,), (1, 2, 3), ("a", 2), ((1, 2), "x")])
def test_sizes_that_are_not_two_numbers(sizes: Any) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="not two numbers"):
        ck.gear("sun", "planet", teeth=sizes)


def test_a_gear_pair_cannot_be_driven() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="no pair between 'planet' and 'sun' to drive"):
        planetary(20, 40, ck.drive("planet", on="sun"))
    with pytest.raises(ck.errors.InvalidMechanism, match="no pair called 'sun/planet'"):
        planetary(20, 40, ck.drive("planet", on="sun", pair="sun/planet"))


# --- trains on links that turn ---------------------------------------------------------------------------


def test_a_wheel_on_a_multiple_pin_counts_turns_of_the_link_it_hangs_on() -> None:
    """The gears' axes are the pins of a turning coupler: whichever link carries the pin, no turn is lost."""
    base = geared_coupler()
    items = [item for item in base.items if getattr(item, "name", "") not in ("out", "coupler/out")]
    mechanism = ck.Mechanism(
        "Wheels on a coupler",
        *items,
        ck.link("two", C=0, L=(1, 0)),
        ck.gear("two", "crank", carrier="coupler", teeth=(17, 31)),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    crank, coupler = motion.links["crank"].angle, np.unwrap(motion.links["coupler"].angle)
    found = motion.links["two"].angle
    # crank - coupler = -(17 / 31) (two - coupler), for all of four turns
    two = coupler - (crank - coupler) * 31 / 17
    np.testing.assert_allclose(found - found[0], two - two[0], atol=1e-10)
    assert abs(coupler[-1] - coupler[0]) > 20


def test_a_train_agrees_with_newton_on_the_pairs_own_equations() -> None:
    """The linear equations of a train against the general solver, pose by pose and derivative by derivative."""
    mechanism = planetary(23, 31, ck.drive("sun"), ck.drive("ring"))
    motion = ck.solve(mechanism, {"sun": [0.3, 1.0], "ring": [-0.2, 0.9]}, speed={"sun": 2, "ring": -1}, order=3)
    solving_order = motion.solving_order
    (train,) = solving_order.solvers
    general = GeneralSolver(0, train.group, solving_order.size).equations
    run = motion.followed.run(motion.inputs, 3, np.arange(2.0)[None], np.zeros((1, 1), dtype=int))
    state = general.state([run.world[body.links[0]] for body in train.group.bodies])
    solution = general.newton(state + 0.05, run)
    assert solution.closed.all()
    for body, pose in zip(train.group.bodies, general.series(solution.state, run, 3), strict=True):
        for k in range(4):
            assert np.max(np.abs(pose.z.derivative(k) - run.world[body.links[0]].z.derivative(k))) < 1e-9
            assert np.max(np.abs(pose.angle.derivative(k) - run.world[body.links[0]].angle.derivative(k))) < 1e-11
