"""Pins with loads on them, pins that are led, frictions at pins by each of their names, rollers that turn freely."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from tests import catalog

UNITS = {"length": "mm", "mass": "kg", "force": "N"}
GRAVITY = ck.gravity(0, -9.81)


def eight_bar_pin(*more: Any) -> ck.Mechanism:
    """A four-bar with a second dyad at its pin C, which joins three links."""
    return ck.Mechanism(
        "Three links at C",
        ck.link("frame", A=0, D=100, E=(50, -60)), ck.link("a", A=0, B=40), ck.link("b", B=0, C=120),
        ck.link("c", D=0, C=80), ck.link("d", C=0, F=130), ck.link("e", E=0, F=90), ck.drive("a", name="motor"),
        ck.mass("b", 2), ck.mass("d", 2), GRAVITY, *more, units=UNITS,
    )  # fmt: skip


def efforts(name: str) -> Any:
    plan = eight_bar_pin(ck.friction(name, 0.1, radius=5))
    return ck.force_analysis(ck.solve(plan, {"motor": [0.5, 1.5]})).drives["motor"].effort


def test_loads_on_pins_balance() -> None:
    forces = ck.force_analysis(ck.solve(eight_bar_pin(ck.force("C", (1, 200)), ck.force("B", (3, 4)))))
    assert ck.verify(forces).passed
    for letter, load in (("B", 3 + 4j), ("C", 1 + 200j)):
        pin = forces.pins[letter]
        np.testing.assert_allclose(sum(pin.on(link).force for link in pin.links), load, atol=1e-9)


def test_frictions_have_every_name_of_their_pin() -> None:
    for names in (("A", "motor", "A(frame-a)", "A(a-frame)"), ("C(b-c)", "C(c-b)")):
        first, *others = map(efforts, names)
        for other in others:
            np.testing.assert_array_equal(other, first)


def test_frictions_at_a_pin_that_no_pair_has_are_refused() -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"name C\(b-c\), C\(b-d\), or C for all"):
        efforts("C(c-d)")
    with pytest.raises(ck.errors.InvalidMechanism, match="'motor' has a friction already"):
        eight_bar_pin(ck.friction("A", 0.1, radius=5), ck.friction("motor", 0.1, radius=5))
    twice = eight_bar_pin(ck.friction("C", 0.1, radius=5), ck.friction("C(c-b)", 0.1, radius=5))
    with pytest.raises(ck.errors.InvalidInput, match=r"C\(b-c\) has a friction already, by the name 'C'"):
        ck.force_analysis(ck.solve(twice))


def led_five_bar(*more: Any) -> ck.Mechanism:
    """A five-bar whose pin P is led by both of its coordinates."""
    masses = [ck.mass(name, 1.0, at=(40, 7), inertia=800) for name in ("left", "right", "outer", "other")]
    return ck.Mechanism(
        "Led", ck.link("frame", A=0, E=118), ck.link("left", A=0, B=90), ck.link("right", E=0, D=90),
        ck.link("outer", B=0, P=90), ck.link("other", D=0, P=90), ck.drawn(B=(-20, 80), D=(130, 80), P=(60, 150)),
        ck.drive("P", x=lambda t: 60 + 10 * np.sin(t), y=lambda t: 140 + 10 * np.cos(t)),
        *masses, GRAVITY, *more, units=UNITS,
    )  # fmt: skip


def test_what_leads_a_pin_balances_it() -> None:
    rubbing = led_five_bar(ck.force("P", (3, 4)), ck.friction("A", 0.1, radius=5))
    forces = ck.force_analysis(ck.solve(rubbing, time=np.linspace(0, 1, 9)))
    assert ck.verify(forces).passed
    pin = forces.pins["P"]
    drives = forces.drives["P.x"].effort + 1j * forces.drives["P.y"].effort
    np.testing.assert_allclose(sum(pin.on(link).force for link in pin.links), 3 + 4j + drives, rtol=1e-12)


def test_what_rubs_at_a_led_pin_is_refused() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="the motion of the pin P is prescribed"):
        led_five_bar(ck.friction("P", 0.1, radius=5))
    with pytest.raises(ck.errors.InvalidMechanism, match=r"name two of them: P\(outer-other\)"):
        led_five_bar(ck.damper(pair="P", rate=0.1))


def with_roller(*items: Any) -> ck.results.Motion:
    return ck.solve(catalog.mechanism("disc-cam-offset-roller").replace(*items, unit="", units=UNITS))


def test_a_mass_centre_off_the_pin_of_a_roller_is_refused() -> None:
    for mass in (ck.mass("roller", 1.0, at=(3, 1)), ck.mass("roller", 1.0)):
        with pytest.raises(ck.errors.InvalidInput, match=r'roller turns freely about P.*put it at the pin: at="P"'):
            ck.force_analysis(with_roller(mass))


def test_what_would_turn_a_roller_is_left_aside() -> None:
    loads = ck.torque("roller", 3), ck.force("roller", (1, 0), at=(2, 2)), ck.mass("roller", 1.0, at="P", inertia=500)
    forces = ck.force_analysis(with_roller(*loads))
    assert ck.verify(forces).passed


@pytest.mark.parametrize(
    "load",
    [
        ck.damper(pair="A", rate=1),
        ck.force("b", (0, 4), at="B", while_moving=(0, -1)),
        ck.effort("D", 3, only="back"),
        ck.friction("C", 0.1, radius=3),
    ],
)
def test_loads_that_ask_for_velocities_need_some(load: Any) -> None:
    motion = ck.solve(eight_bar_pin(load), order=0)
    with pytest.raises(ck.errors.InvalidInput, match="solved to order 0, and its velocities are needed by"):
        ck.force_analysis(motion, inertia=False)


def test_complex_numbers_are_no_torque() -> None:
    motion = ck.solve(eight_bar_pin(ck.effort("D", lambda q: 1j * q)))
    with pytest.raises(ck.errors.InvalidInput, match="effort along D: the function returns complex numbers"):
        ck.force_analysis(motion)


def test_wedged_poses_are_not_verified() -> None:
    long_crank = ck.Mechanism(
        "Nearly as long as its rod",
        ck.link("frame", A=0), ck.link("crank", A=0, B=109), ck.link("rod", B=0, C=110), ck.link("ram", C=0),
        ck.slide("ram", on="frame", through="A", angle=np.pi / 2, name="stroke"), ck.drive("crank", speed=8),
        ck.mass("ram", 2.0), GRAVITY, ck.friction("stroke", 0.3, length=10), ck.friction("C", 0.1, radius=20),
        units=UNITS,
    )  # fmt: skip
    with pytest.warns(ck.errors.WedgedPoses):
        forces = ck.force_analysis(ck.solve(long_crank))
    wedged = int(np.isnan(forces.drives["crank"].effort).sum())
    check = ck.verify(forces)
    assert check.passed
    assert 0 < wedged == check.singular < check.poses
