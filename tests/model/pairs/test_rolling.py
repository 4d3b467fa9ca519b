"""Wheels that roll on lines and circles: cycloids in closed form, linkages with a rolling wheel, bad input."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import compoundkin as ck
from tests.support import examples

SIZES = st.floats(0.3, 5.0)
ANGLES = st.floats(-3.0, 3.0)


def passes(motion: ck.results.Motion) -> bool:
    check = ck.verify(motion)
    assert check.passed, [finding for finding in check.findings if not finding.passed]
    return bool(motion.assembled.all())


def derivatives(terms: list[tuple[complex, float]], drift: complex, q: Any, rates: tuple[float, ...]) -> list[Any]:
    """Position, velocity, acceleration of ``drift q + sum(a exp(i k q))`` where q has two rates."""
    speed, acceleration = rates
    waves = [(a * np.exp(1j * k * q), 1j * k) for a, k in terms]
    first = drift + sum(w * k for w, k in waves)
    second = sum(w * k * k for w, k in waves)
    return [drift * q + sum(w for w, _ in waves), first * speed, second * speed**2 + first * acceleration]


def agree(motion: ck.results.Motion, letter: str, expected: list[Any]) -> None:
    for k, value in enumerate(expected):
        found = motion.points[letter].derivative(k)
        assert np.max(np.abs(found - value)) < 1e-12 * max(1.0, float(np.max(np.abs(value))))


@settings(deadline=None, max_examples=examples(40))
@given(SIZES, st.floats(0.0, 8.0), ANGLES, ANGLES, st.sampled_from([1, -1]))
def test_cycloids_and_trochoids(radius: float, arm: float, slope: float, phase: float, side: int) -> None:
    """c = e s + i side r e, angle = (phase - s) / (side r): the tracing point is c + arm exp(i angle)."""
    travel = np.linspace(-9.0, 13.9, 24)
    mechanism = ck.Mechanism(
        "Wheel on a line",
        ck.link("frame", O=(1, 2)),
        ck.link("wheel", C=0, P=(arm, 0)),
        ck.roll("wheel", on="frame", through="O", at="C", radius=radius, angle=slope, side=side, phase=phase),
        ck.drive("wheel", values=travel, speed=3, acceleration=-2),
    )
    motion = ck.solve(mechanism)
    e, m = np.exp(1j * slope), side * radius
    terms = [(1 + 2j + 1j * e * m, 0.0), (arm * np.exp(1j * phase / m), -1 / m)]
    agree(motion, "P", derivatives(terms, e, travel, (3, -2)))
    np.testing.assert_allclose(motion.links["wheel"].angle, (phase - travel) / m, atol=1e-12)
    np.testing.assert_allclose(motion.pairs["wheel/frame"].value, travel, atol=1e-12)


def test_the_cycloid_of_a_rim_point() -> None:
    """At rest on the line with acceleration r w^2 towards the middle; curvature radius 4 r sin(t / 2)."""
    t = ck.deg(np.array([0.0, 100.0, 360.0]))
    mechanism = ck.Mechanism(
        "Cycloid",
        ck.link("frame", O=0),
        ck.link("wheel", C=0, P=(0, -2)),
        ck.roll("wheel", on="frame", through="O", at="C", radius=2),
        ck.drive("wheel", values=2 * t, speed=2),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    p = motion.points["P"]
    assert abs(p.position[1] - (1.5210429979642428 + 2.3472963553338606j)) < 1e-12
    assert np.max(np.abs(p.velocity[[0, 2]])) < 1e-14
    np.testing.assert_allclose(p.acceleration[[0, 2]], 2j, atol=1e-13)
    v, a = p.velocity[1], p.acceleration[1]
    assert abs(abs(v) ** 3 / abs((np.conj(v) * a).imag) - 6.1283555449518) < 1e-10


@settings(deadline=None, max_examples=examples(40))
@given(SIZES, SIZES, st.floats(0.0, 8.0), ANGLES, st.booleans())
def test_epicycloids_and_hypocycloids(circle: float, radius: float, arm: float, phase: float, inside: bool) -> None:
    """c = (R +- r) exp(i q), angle = (1 +- R / r) q + phase, over several turns."""
    if inside:
        radius = 0.2 * circle if radius >= 0.9 * circle else radius
    q = np.linspace(-9.0, 13.9, 24)
    mechanism = ck.Mechanism(
        "Wheel on a circle",
        ck.link("frame", O=(1, 2)),
        ck.link("wheel", C=(0.5, 0), P=(0.5 + arm, 0)),
        ck.roll_around(
            "wheel", on="frame", centre_at="O", at="C", circle=circle, radius=radius, inside=inside, phase=phase
        ),
        ck.drive("wheel", values=q, speed=3, acceleration=-2),
    )
    motion = ck.solve(mechanism)
    r = -radius if inside else radius
    k = 1 + circle / r
    terms = [(1 + 2j, 0.0), (circle + r + 0j, 1.0), (arm * np.exp(1j * phase), k)]
    for j, value in enumerate(derivatives(terms, 0j, q, (3, -2))):
        found = motion.points["P"].derivative(j)
        assert np.max(np.abs(found - value)) < 1e-12 * max(1.0, float(np.max(np.abs(value)))) * max(1.0, abs(k) ** 2)
    np.testing.assert_allclose(motion.pairs["wheel/frame"].value, q, atol=1e-11)


def test_a_wheel_rolls_as_the_gear_of_a_planetary_train_does() -> None:
    """Rolling on a circle of the frame against a gear pair on an arm."""
    q = np.linspace(0.0, 29.5, 60)
    for inside, (circle, radius) in ((False, (3, 2)), (True, (5, 2))):
        away = circle - radius if inside else circle + radius
        gear = ck.gear("wheel", "frame", carrier="arm", radii=(radius, circle), internal=inside)
        links = ck.link("frame", O=0), ck.link("wheel", C=0, P=(1.5, 0))
        train = ck.Mechanism("Train", *links, ck.link("arm", O=0, C=(away, 0)), gear, ck.drive("arm", values=q))
        roll = ck.roll_around("wheel", on="frame", centre_at="O", at="C", circle=circle, radius=radius, inside=inside)
        wheel = ck.Mechanism("Wheel", *links, roll, ck.drive("wheel", values=q))
        one, two = ck.solve(train), ck.solve(wheel)
        assert passes(one)
        assert passes(two)
        assert np.max(np.abs(one.points["P"].position - two.points["P"].position)) < 1e-12
        np.testing.assert_allclose(one.links["wheel"].angle, two.links["wheel"].angle, atol=1e-12)


def test_a_wheel_on_a_turning_circle_takes_its_turning_over() -> None:
    """The circle turns by a, the line of centres by q on it: the wheel by a + k q."""
    mechanism = ck.Mechanism(
        "Wheel on a turntable",
        ck.link("frame", O=0),
        ck.link("table", O=0, T=(5, 0)),
        ck.link("wheel", C=0, P=(1, 0)),
        ck.roll_around("wheel", on="table", centre_at="O", at="C", circle=3, radius=1.5),
        ck.drive("table", values=np.linspace(0, 19.5, 9)),
        ck.drive("wheel", on="table", values=np.linspace(0, -12, 9)),
    )
    motion = ck.solve(mechanism, speed={"table": 2, "wheel": 1})
    assert passes(motion)
    a, q = motion.drives["table"].value, motion.drives["wheel"].value
    np.testing.assert_allclose(motion.links["wheel"].angle, a + 3 * q, atol=1e-12)
    assert np.max(np.abs(motion.points["C"].position - 4.5 * np.exp(1j * (a + q)))) < 1e-12


# --- in linkages -----------------------------------------------------------------------------------------


def rim_rod(**change: Any) -> ck.Mechanism:
    """A crank whose rod is pinned to the rim of a rolling wheel: no closed form."""
    return ck.Mechanism(
        "Crank and rolling wheel",
        ck.link("frame", O=0, L=(0, -2)),
        ck.link("crank", O=0, A=1),
        ck.link("rod", A=0, B=6),
        ck.link("wheel", C=0, B=(0, 1.5)),
        ck.roll("wheel", on="frame", through="L", at="C", radius=2, phase=6),
        ck.drive("crank", values=ck.deg(np.arange(0, 721, 5))),
        ck.drawn(C=(6, 0), B=(6, 1.5)),
        **change,
    )


def test_a_rod_on_the_rim_of_a_rolling_wheel() -> None:
    """Against an independent root of the rod's length as a function of the wheel's travel, by bisection."""
    motion = ck.solve(rim_rod())
    assert passes(motion)
    a = motion.points["A"].position

    def length(s: Any) -> Any:
        return np.abs(s + 1.5 * np.exp(1j * (np.pi / 2 + (6 - s) / 2)) - a) - 6

    low, high = motion.points["C"].x - 0.2, motion.points["C"].x + 0.2
    assert np.all(length(low) * length(high) < 0)
    for _ in range(60):
        middle = (low + high) / 2
        same = length(low) * length(middle) > 0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    assert np.max(np.abs(low - motion.points["C"].x)) < 1e-12
    assert np.max(np.abs(np.diff(motion.points["C"].x))) < 0.3
    np.testing.assert_allclose(motion.links["wheel"].angle, (6 - motion.points["C"].x) / 2, atol=1e-12)


def test_the_phase_of_a_drawing_is_that_of_the_words() -> None:
    """Unstated, it is read off: with the drawing exact at home the motion is the same; a turn farther too."""
    one = ck.solve(rim_rod())
    at_home = {"B": complex(one.points["B"].position[0]), "C": complex(one.points["C"].position[0])}
    for phase in (None, 6 + 4 * np.pi, 6 - 8 * np.pi):
        roll = ck.roll("wheel", on="frame", through="L", at="C", radius=2, phase=phase)
        two = ck.solve(rim_rod().replace(roll, ck.drawn(**at_home)))
        assert np.max(np.abs(one.points["B"].position - two.points["B"].position)) < 1e-11


@pytest.mark.parametrize("direction", [-170, -20, 60, 179, 200, 300, 700])
def test_a_driven_wheel_comes_to_where_it_is_drawn(direction: float) -> None:
    """On a circle, after a turn about which the wheel is turned otherwise."""
    middle = ck.polar(5, ck.deg(direction))
    rim = middle + ck.polar(1.5, ck.deg(75))
    mechanism = ck.Mechanism(
        "Wheel drawn on a circle",
        ck.link("frame", O=0),
        ck.link("wheel", C=0, P=(1.5, 0)),
        ck.roll_around("wheel", on="frame", centre_at="O", at="C", circle=3, radius=2),
        ck.drive("wheel", values=ck.deg(np.arange(direction - 90, direction + 91, 10))),
        ck.drawn(C=middle, P=rim),
    )
    motion = ck.solve(mechanism)
    assert abs(motion.points["C"].position[9] - middle) < 1e-12
    assert abs(motion.points["P"].position[9] - rim) < 1e-12
    turned = motion.links["wheel"].angle
    np.testing.assert_allclose(np.diff(turned), 2.5 * ck.deg(10), atol=1e-12)


def test_centres_of_a_rolling_wheel() -> None:
    motion = ck.solve(rim_rod(), {"crank": [0.4]})
    centres = ck.instant_centres(motion)
    contact = complex(centres["frame", "wheel"].point[0])
    assert abs(contact - (motion.points["C"].x[0] - 2j)) < 1e-11
    # the rod turns about the crossing of the crank's line and the line from the contact to the pin
    a, b, p = motion.points["A"].position[0], motion.points["B"].position[0], complex(centres["frame", "rod"].point[0])
    assert abs((np.conj(a) * p).imag) < 1e-9 * abs(p)
    assert abs((np.conj(b - contact) * (p - contact)).imag) < 1e-9 * abs(p - contact)


def test_a_wheel_led_round_by_a_linkage_counts_its_turns() -> None:
    """The wheel on the circle is pulled round by a long crank and rod twice; the angle goes on."""
    mechanism = ck.Mechanism(
        "Wheel pulled round",
        ck.link("frame", O=0, D=(0.4, 0.1)),
        ck.link("crank", D=0, A=6),
        ck.link("rod", A=0, C=2.5),
        ck.link("wheel", C=0, P=(1.5, 0)),
        ck.roll_around("wheel", on="frame", centre_at="O", at="C", circle=3, radius=2),
        ck.drive("crank", values=ck.deg(np.arange(0, 721, 5))),
        ck.drawn(C=(4.5, 2), A=(6.4, 0.1)),
    )
    motion = ck.solve(mechanism)
    assert passes(motion)
    q = np.unwrap(np.angle(motion.points["C"].position))
    assert abs(q[-1] - q[0] - 4 * np.pi) < 1e-9
    turned = motion.links["wheel"].angle
    np.testing.assert_allclose(turned - turned[0], 2.5 * (q - q[0]), atol=1e-10)


def test_radii_as_designs() -> None:
    radius = np.array([[1.0], [2.0], [3.0]])
    mechanism = ck.Mechanism(
        "Wheels of three sizes",
        ck.link("frame", O=0),
        ck.link("wheel", C=0, P=(1, 0)),
        ck.roll_around("wheel", on="frame", centre_at="O", at="C", circle=6, radius=radius),
        ck.drive("wheel", values=np.linspace(0, 9, 10)),
    )
    motion = ck.solve(mechanism)
    assert motion.shape == (3, 10)
    np.testing.assert_allclose(motion.links["wheel"].angle, (1 + 6 / radius) * np.linspace(0, 9, 10), rtol=1e-13)


# --- bad input -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("words", "place", "what"),
    [
        ({"link": "whel"}, "rollings[0].link", "no link 'whel'"),
        ({"on": "fram"}, "rollings[0].on", "no link 'fram'"),
        ({"through": "X"}, "rollings[0].through", "has no point 'X'"),
        ({"toward": "X"}, "rollings[0].toward", "has no point 'X'"),
        ({"toward": "O"}, "rollings[0].toward", "no direction"),
        ({"at": ""}, "rollings[0].at", "several points"),
        ({"at": "X"}, "rollings[0].at", "has no point 'X'"),
        ({"on": "wheel", "through": "P"}, "rollings[0].on", "cannot"),
        ({"radius": 0}, "rollings[0].radius", "0 is not positive"),
        ({"radius": [[2.0], [-1.0]]}, "rollings[0].radius", "[[2.0], [-1.0]] is not positive"),
        ({"radius": np.inf}, "rollings[0].radius", "not finite"),
        ({"side": 2}, "rollings[0].side", "not a side"),
        ({"phase": np.nan}, "rollings[0].phase", "not finite"),
    ],
)
def test_mistakes_on_a_line_have_a_place(words: dict[str, Any], place: str, what: str) -> None:
    links = ck.link("frame", O=0, Q=1), ck.link("wheel", C=0, P=1)
    given_words = {"link": "wheel", "on": "frame", "through": "O", "at": "C", "radius": 2.0, **words}
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.Mechanism("m", *links, ck.roll(**given_words))
    assert any(p.where == place and what in p.what for p in caught.value.problems), caught.value


@pytest.mark.parametrize(
    ("words", "place", "what"),
    [
        ({"link": "whel"}, "circular_rollings[0].link", "no link 'whel'"),
        ({"on": "fram"}, "circular_rollings[0].on", "no link 'fram'"),
        ({"centre_at": "X"}, "circular_rollings[0].centre_at", "has no point 'X'"),
        ({"at": ""}, "circular_rollings[0].at", "several points"),
        ({"radius": 0}, "circular_rollings[0].radius", "0 is not positive"),
        ({"circle": -4}, "circular_rollings[0].circle", "-4 is not positive"),
        ({"radius": 4.0, "inside": True}, "circular_rollings[0].radius", "not smaller"),
        ({"radius": 5.0, "inside": True}, "circular_rollings[0].radius", "not smaller"),
    ],
)
def test_mistakes_on_a_circle_have_a_place(words: dict[str, Any], place: str, what: str) -> None:
    links = ck.link("frame", O=0, Q=1), ck.link("wheel", C=0, P=1)
    given_words = {"link": "wheel", "on": "frame", "centre_at": "O", "at": "C", "circle": 4.0, "radius": 2.0, **words}
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.Mechanism("m", *links, ck.roll_around(**given_words))
    assert any(p.where == place and what in p.what for p in caught.value.problems), caught.value


def test_a_line_between_two_points_at_one_place() -> None:
    links = ck.link("frame", O=0, Q=0), ck.link("wheel", C=0)
    with pytest.raises(ck.errors.InvalidMechanism, match="at one place, so that the line has no direction"):
        ck.Mechanism("m", *links, ck.roll("wheel", on="frame", through="O", toward="Q", radius=1))


def test_a_rolling_wheel_needs_a_driver() -> None:
    links = ck.link("frame", O=0), ck.link("wheel", C=0)
    (fault,) = ck.decompose(ck.Mechanism("m", *links, ck.roll("wheel", on="frame", through="O", radius=1))).faults
    assert fault.kind == "under"
    assert "wheel" in fault.remedy
