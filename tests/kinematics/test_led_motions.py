"""Points led along paths and links turned by prescribed angles, held against closed forms of inverse kinematics."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.model.elements import Drawn, Drive, Expectation
from compoundkin.model.fields import Item
from tests.catalog import mechanism as loaded

LENGTH, TURN = 90.0, 2.0 * np.pi
MIDDLE, RADIUS, SPAN = 60 + 135j, 20.0, 2.0
TIMES = np.linspace(0.0, SPAN, 41)
# Closed forms and the solution are a few operations on numbers of the mechanism's size apart.
EXACT = 1e-10


def redriven(name: str, *drives: Item, **words: Any) -> ck.Mechanism:
    """A shipped mechanism with other drivers."""
    whole = loaded(name)
    items = [item for item in whole.items if not isinstance(item, Drive | Expectation)]
    return ck.Mechanism(whole.title, *items, *drives, **words)


def circle(t: Any) -> Any:
    return MIDDLE + RADIUS * np.exp(1j * TURN / SPAN * np.asarray(t))


def arm(tip: Any, velocity: Any, acceleration: Any, foot: float, elbow: int) -> tuple[Any, Any, Any]:
    """Angle, speed and acceleration of the first link of an arm of two equal links.

    By the cosine theorem, and by the tip's velocity and acceleration along the second link; J. J. Craig, Introduction
    to Robotics, 3rd ed., section 4.4 (geometric solution) and M. W. Spong, Robot Dynamics and Control, section 1.3.
    """
    reach = tip - foot
    angle = np.angle(reach) + elbow * np.arccos(np.abs(reach) / (2.0 * LENGTH))
    first = LENGTH * np.exp(1j * angle)
    second = reach - first
    along = (np.conj(second) * 1j * first).real
    speed = (np.conj(second) * velocity).real / along
    # |second| is constant: its velocity is at right angles to it, and its acceleration along it is centripetal
    relative = velocity - 1j * first * speed
    own = acceleration + first * speed**2
    return angle, speed, ((np.conj(second) * own).real + np.abs(relative) ** 2) / along


PATHS = {
    "curve": {"along": ck.profiles.disc(RADIUS, (60, 135)), "law": ck.laws.constant_speed(TURN * RADIUS / SPAN)},
    "function": {"along": circle},
    "parts": {"x": lambda t: 60 + 20 * np.cos(np.pi * t), "y": lambda t: 135 + 20 * np.sin(np.pi * t)},
    "places": {"along": np.stack([circle(TIMES).real, circle(TIMES).imag], -1), "time": TIMES},
}


@pytest.mark.parametrize("how", PATHS)
def test_a_five_bar_is_led_round_a_circle(how: str) -> None:
    motion = ck.solve(redriven("five-bar", ck.drive("P", **PATHS[how]), time=TIMES))
    w, tip = TURN / SPAN, circle(TIMES)
    velocity, acceleration = 1j * w * (tip - MIDDLE), -(w**2) * (tip - MIDDLE)
    near = (EXACT, EXACT, EXACT) if how != "places" else (1e-6, 1e-5, 1e-3)
    np.testing.assert_allclose(np.abs(motion.points["P"].position - tip), 0.0, atol=100 * near[0])
    for name, foot, elbow in (("left", 0.0, 1), ("right", 118.0, -1)):
        link = motion.links[name]
        found = link.angle, link.angular_velocity, link.angular_acceleration
        for one, told, off in zip(found, arm(tip, velocity, acceleration, foot, elbow), near, strict=True):
            np.testing.assert_allclose(one, told, atol=off)
    assert list(motion.drives) == ["P.x", "P.y"]
    assert [group.name for group in motion.structure.groups] == ["RRR", "RRR"]
    assert motion.structure.mobility.formula.startswith("F = 3 (n - 1) - 2 p = 3 (5 - 1) - 2 * 5 = 2")
    assert ck.verify(motion).passed


def test_a_line_is_run_along_by_a_law() -> None:
    law = ck.laws.program(ck.laws.rise(50.0, over=1.0, law="cycloidal"))
    line = ck.drive("P", along=[(40, 120), (80, 150)], law=law)
    motion = ck.solve(redriven("five-bar", line), order=3)
    gone = law.coordinate(motion.time, 3)
    way = 0.8 + 0.6j
    np.testing.assert_allclose(motion.points["P"].position, 40 + 120j + way * gone.c[0], atol=1e-11)
    for k in (1, 2, 3):
        np.testing.assert_allclose(motion.points["P"].derivative(k), way * gone.derivative(k), atol=1e-8)


def test_a_closed_curve_is_run_at_a_constant_speed() -> None:
    ellipse = ck.profiles.formula(lambda s: MIDDLE + 24 * np.cos(s) + 12j * np.sin(s), 0, TURN)
    led = redriven("five-bar", ck.drive("P", along=ellipse, law=ck.laws.constant_speed(40.0)))
    motion = ck.solve(led, time=np.linspace(0.0, 6.0, 61))
    # round it once and more: it stays on the ellipse, at that speed
    off = motion.points["P"].position - MIDDLE
    np.testing.assert_allclose((off.real / 24) ** 2 + (off.imag / 12) ** 2, 1.0, atol=1e-10)
    np.testing.assert_allclose(motion.points["P"].speed, 40.0, atol=1e-9)


def test_a_platform_is_led_in_place_and_angle() -> None:
    at = (5.03 + 2.9j) + 0.3 * np.exp(1j * TIMES)
    turn = 0.1 * np.sin(TIMES)
    led = redriven(
        "3-rrr",
        ck.drive("P", along=at, time=TIMES),
        ck.drive("platform", angle=ck.laws.time_table(TIMES, turn)),
        time=TIMES,
    )
    motion = ck.solve(led)
    assert [group.name for group in motion.structure.groups][1:] == ["RRR"] * 3
    points = loaded("3-rrr").geometry.points["platform"]
    feet = {"1": 0j, "2": 10 + 0j, "3": 5 + 8.660254037844386j}
    for leg, foot in feet.items():
        tip = at + np.exp(1j * turn) * (points[f"C{leg}"] - points["P"])
        two = [np.angle(tip - foot) + s * np.arccos(np.abs(tip - foot) / 8.0) for s in (1, -1)]
        angle = motion.links[f"crank-{leg}"].angle
        gaps = [np.max(np.abs(np.exp(1j * angle) - np.exp(1j * one))) for one in two]
        assert min(gaps) < 1e-9
    assert ck.verify(motion).passed


def four_bar(*more: Item, **words: Any) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=0, D=4),
        ck.link("crank", A=0, B=1),
        ck.link("coupler", B=0, C=3, G=(1, 1)),
        ck.link("rocker", D=0, C=3),
        *more,
        **words,
    )


@pytest.mark.parametrize("what", ["coupler", "x", "y", "rocker"])
def test_a_four_bar_is_asked_for_the_other_way_round(what: str) -> None:
    """What was prescribed is taken from a motion of the crank, which must come out again."""
    times = np.linspace(0.0, 1.0, 21)
    crank = 1.2 + 0.25 * times
    ahead = ck.solve(four_bar(ck.drive("crank", law=ck.laws.constant_speed(0.25, 1.2))), time=times)
    drawing = ck.drawn(**{letter: point.position[0] for letter, point in ahead.points.items()})
    point = ahead.points["G"].position
    told = {"x": point.real, "y": point.imag}
    values = told[what] if what in told else ahead.links[what].angle
    law = ck.laws.time_table(times, values)
    if what == "rocker":
        drive: Item = ck.drive("rocker", law=law)
    else:
        drive = ck.drive("G", x=law) if what == "x" else ck.drive("coupler", angle=law)
        drive = ck.drive("G", y=law) if what == "y" else drive
    motion = ck.solve(four_bar(drive, drawing), time=times)
    np.testing.assert_allclose(motion.links["crank"].angle, crank, atol=1e-9)
    np.testing.assert_allclose(motion.links["crank"].angular_velocity, 0.25, atol=1e-5)
    assert ck.verify(motion).passed


def test_the_crank_of_a_prescribed_piston_is_in_closed_form() -> None:
    """A slider-crank whose piston moves harmonically: the cosine theorem gives the crank, the chain rule its speed."""
    r, rod = 2.0, 5.0
    stroke = ck.drive("piston", law=lambda t: 5.0 + 1.5 * np.sin(t))
    slider_crank = ck.Mechanism(
        "Slider-crank",
        ck.link("frame", O=0),
        ck.link("crank", O=0, A=r),
        ck.link("rod", A=0, B=rod),
        ck.link("piston", B=0),
        ck.slide("piston", on="frame", through="O"),
        stroke,
        ck.drawn(A=(1, 1.7), B=(5.4, 0)),
    )
    times = np.linspace(0.0, 3.0, 31)
    motion = ck.solve(slider_crank, time=times)
    s, rate = 5.0 + 1.5 * np.sin(times), 1.5 * np.cos(times)
    angle = np.arccos((s**2 + r**2 - rod**2) / (2.0 * s * r))
    # d(s**2 + r**2 - rod**2 - 2 s r cos a) = 0
    speed = (r * np.cos(angle) - s) * rate / (s * r * np.sin(angle))
    np.testing.assert_allclose(motion.links["crank"].angle, angle, atol=EXACT)
    np.testing.assert_allclose(motion.links["crank"].angular_velocity, speed, atol=EXACT)


def test_the_cylinders_of_a_digger_follow_its_bucket() -> None:
    """The edge of the bucket on a line at a constant angle: each cylinder is as long as its pins are apart."""
    whole = loaded("hydraulic-digger")
    ahead = ck.solve(whole, {k: float(np.mean(c.stroke)) for k, c in whole.cylinders.items()}, order=0)
    start, angle = complex(ahead.points["M"].position), float(ahead.links["bucket"].angle)
    items = [item for item in whole.items if not isinstance(item, Drive | Expectation | Drawn)]
    drawing = ck.drawn(**{k: complex(p.position) for k, p in ahead.points.items()})
    line = ck.drive("M", along=[start, start - 0.2 + 0.1j], time=[0, 1])
    led = ck.Mechanism("led", *items, line, ck.drive("bucket", angle=angle), drawing)
    motion = ck.solve(led, time=np.linspace(0.0, 1.0, 11))
    assert motion.assembled.all()
    assert ck.verify(motion).passed
    for name, cylinder in whole.cylinders.items():
        apart = np.abs(motion.points[cylinder.point].position - motion.points[cylinder.at].position)
        np.testing.assert_allclose(motion.pairs[name].value, apart, atol=1e-12)
    np.testing.assert_allclose(motion.links["bucket"].angle, angle, atol=1e-12)
    np.testing.assert_allclose(motion.points["M"].position[-1], start - 0.2 + 0.1j, atol=1e-11)


def test_a_point_is_led_on_a_link_that_moves() -> None:
    """In another link's axes: the same motion as that of the whole, turned back."""
    led = redriven(
        "five-bar", ck.drive("left", law=ck.laws.constant_speed(0.1, 1.57)),
        ck.drive("P", on="left", x=ck.laws.constant_speed(-4.0, 158.0)),
    )  # fmt: skip
    motion = ck.solve(led, time=np.linspace(0.0, 1.0, 11))
    turned = motion.points["P"].position * np.exp(-1j * motion.links["left"].angle)
    np.testing.assert_allclose(turned.real, 158.0 - 4.0 * motion.time, atol=1e-10)


@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
def test_a_path_that_cannot_be_followed_says_from_when_to_when_and_why() -> None:
    far = ck.drive("P", along=[(60, 130), (60, 190)], time=[0, 1])
    motion = ck.solve(redriven("five-bar", far), time=np.linspace(0.0, 1.0, 21))
    gap, *_ = ck.gaps(motion)
    assert gap.times is not None
    # both arms reach twice the length; the left one is nearer to the line's foot
    leaves = (np.sqrt((2 * LENGTH) ** 2 - 60**2) - 130) / 60
    assert gap.times[0] == pytest.approx(leaves, abs=1e-9)
    assert gap.reason.startswith("|AP| =")
    text = " ".join(ck.report(motion).text().split())
    told = f"From {leaves:.6g} s to the end, 1 s (P.y {130 + 60 * leaves:.6g} to 190), the RRR group of"
    assert told in text


# --- too many drivers, too few ----------------------------------------------------------------------------------


def law() -> ck.laws.Law:
    return ck.laws.constant_speed(1.0)


def test_as_many_coordinates_are_prescribed_as_there_are_freedoms() -> None:
    path = {"along": [1 + 1j, 2 + 1j], "time": [0, 1]}
    with pytest.raises(ck.errors.NotDetermined, match=r"one of the drivers G.x, G.y \(lead G by x or y alone\)"):
        ck.solve(four_bar(ck.drive("G", **path)))
    with pytest.raises(ck.errors.NotDetermined, match=r"remove one of the drivers left, P.x, P.y"):
        ck.solve(redriven("five-bar", ck.drive("left"), ck.drive("P", **path)))
    with pytest.raises(ck.errors.NotDetermined, match=r"left with 1 freedom") as caught:
        ck.solve(redriven("five-bar", ck.drive("P", x=law())))
    assert "carriage" not in str(caught.value)
