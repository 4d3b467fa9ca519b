"""Intermittent motion: Geneva wheels through their dwells, against closed forms and published figures."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput, UnknownName

CENTRES = 100.0


def geneva(slots: int, reach: float | None = None, *more: Any, **words: Any) -> ck.Mechanism:
    """A Geneva wheel whose pin enters its slots along them; with another `reach` of these at an angle."""
    half = np.pi / slots
    mouth = CENTRES * np.cos(half) if reach is None else reach
    radius = abs(CENTRES - mouth * np.exp(1j * half))
    return ck.Mechanism(
        "Geneva wheel",
        ck.link("frame", O=0, C=CENTRES),
        ck.link("crank", O=0, A=radius),
        ck.link("wheel", C=0, E=-mouth, W=(20, 10)),
        ck.slot("crank", on="wheel", at="A", through="C", toward="E", reach=(0.1, "E"), name="slot"),
        ck.drive("crank"),
        ck.drawn(A=radius, E=CENTRES - mouth, W=(CENTRES + 20, 10)),
        *more,
        **(words or {"unit": "mm"}),
    )


def closed_form(slots: int, crank: Any) -> Any:
    """Return the wheel's angle of a Geneva wheel, from the crank's angles over any number of turns."""
    m, half = np.sin(np.pi / slots), np.pi / 2 - np.pi / slots
    turns = np.floor((crank + half) / (2 * np.pi) + 1e-12)
    rest = crank - 2 * np.pi * turns
    engaged = -np.arctan2(m * np.sin(rest), 1 - m * np.cos(rest))
    return np.where(rest <= half, engaged, -np.pi / slots) - 2 * np.pi / slots * turns


# greatest velocity over the crank's, greatest acceleration over its square: J. H. Bickford, Mechanisms for Intermittent
# Motion, chapter 9, as many handbooks print them
PRINTED = {3: (6.46, 31.4), 4: (2.41, 5.41), 5: (1.43, 2.30), 6: (1.00, 1.35), 8: (0.62, 0.70)}


@pytest.mark.parametrize("slots", PRINTED)
def test_geneva_wheels_over_several_turns(slots: int) -> None:
    """Forward over three turns and back: angles by the closed form, extremes as printed, jumps by tan(180 deg / n)."""
    up = ck.deg(np.arange(-200, 700, 0.5))
    found = ck.figures.intermittent_motion(geneva(slots), np.concatenate([up, up[::-1]]), speed=3.0)
    half = np.pi / 2 - np.pi / slots
    np.testing.assert_allclose(found.engaged, (-half, half), atol=1e-12)
    assert found.slots == slots
    assert found.step == pytest.approx(-2 * np.pi / slots, abs=1e-12)
    table = found.table("wheel.angle", "wheel.angular_velocity", "wheel.angular_acceleration", "slot.value")
    crank = table["crank.value"].values
    np.testing.assert_allclose(table["wheel.angle"].values, closed_form(slots, crank), atol=1e-11)
    for word, power, printed in zip(("velocity", "acceleration"), (1, 2), PRINTED[slots], strict=True):
        greatest = np.abs(table[f"wheel.angular_{word}"].values).max() / 3.0**power
        assert greatest == pytest.approx(printed, rel=5e-3)
    engaged = np.array([phase.engaged for phase in found.phases])[table["phase"].values - 1]
    np.testing.assert_array_equal(np.isfinite(table["slot.value"].values), engaged)
    assert {jump.quantity for jump in found.jumps} == {"wheel.angular_acceleration", "E.acceleration", "W.acceleration"}
    for jump in (one for one in found.jumps if one.quantity.startswith("wheel")):
        moving = jump.after if jump.what == "enters" else jump.before
        assert abs(moving) == pytest.approx(9.0 * np.tan(np.pi / slots), rel=1e-9)
    for phase in found.phases[:3]:
        assert ck.verify(phase.motion).passed


def test_a_pin_that_enters_at_an_angle_jolts_the_wheel() -> None:
    """Its velocity jumps by r cos(slot, path) / mouth: by the vectors of the pin and of the slot's end."""
    wheel = geneva(4, 66.0)
    found = ck.figures.intermittent_motion(wheel, ck.deg(np.arange(-90, 91)), speed=1.0)
    place = CENTRES - 66.0 * np.exp(1j * np.pi / 4)
    velocity, across = 1j * place, 1j * (place - CENTRES)
    expected = (np.conj(across) * velocity).real / abs(across) ** 2
    (jump,) = [one for one in found.jumps if one.quantity == "wheel.angular_velocity" and one.what == "enters"]
    assert jump.at == pytest.approx(np.angle(place), abs=1e-12)
    assert jump.before == 0.0
    assert abs(jump.after) == pytest.approx(abs(expected), rel=1e-9)
    assert abs(expected) > 0.01


def test_what_the_wheel_drives_stands_still_with_it() -> None:
    """A piston on the wheel is where the wheel's angle puts it; in a dwell the lock bears its weight."""
    crank_on_wheel = (
        ck.link("rod", W=0, S=90),
        ck.link("piston", S=0),
        ck.slide("piston", on="frame", at="S", through="C", angle=0.0, name="way"),
        ck.drawn(A=CENTRES * np.sin(np.pi / 4), E=CENTRES * (1 - np.cos(np.pi / 4)), W=(120, 10), S=(210, 0)),
        ck.mass("wheel", 2.0, at="W", inertia=100.0),
        ck.gravity(0, -9.81),
    )
    units = {"length": "mm", "mass": "kg", "force": "N"}
    found = ck.figures.intermittent_motion(geneva(4, None, *crank_on_wheel, units=units), ck.deg(np.arange(0, 1441, 5)))
    table = found.table("wheel.angle", "S.x")
    place = CENTRES + (20 + 10j) * np.exp(1j * table["wheel.angle"].values)
    np.testing.assert_allclose(table["S.x"].values, place.real + np.sqrt(90**2 - place.imag**2), atol=1e-10)
    dwell = found.phases[3]
    assert not dwell.engaged
    lock = ck.force_analysis(dwell.motion).drives["wheel"].effort
    arm = (dwell.motion.points["W"].position - CENTRES).real
    np.testing.assert_allclose(lock, 2.0 * 9.81 * arm, rtol=1e-9)


def test_a_wheel_with_pins_and_an_arm_with_a_slot() -> None:
    """The other way round: the slot is in the crank, pins are on the wheel; each is where the last one was."""
    reach = abs(CENTRES - 50.0 * np.exp(0.25j * np.pi))
    arm = ck.Mechanism(
        "Pin wheel",
        ck.link("frame", O=0, C=CENTRES),
        ck.link("crank", O=0, E=reach),
        ck.link("wheel", C=0, P=-50),
        ck.slot("wheel", on="crank", at="P", through="O", toward="E", reach=(0.1, "E"), name="slot"),
        ck.drive("crank"),
        ck.drawn(E=reach, P=CENTRES - 50),
        unit="mm",
    )
    with pytest.raises(InvalidInput, match=r"wheel turns by 90 degrees, 0\.75 times the pitch of 3 slots"):
        ck.figures.intermittent_motion(arm, slots=3)
    found = ck.figures.intermittent_motion(arm, ck.deg(np.arange(0, 1441, 5)))
    assert (found.held, found.slots) == ("wheel", 4)
    angle = found.table("wheel.angle")["wheel.angle"].values
    assert abs(angle[-1] - angle[0]) == pytest.approx(2 * np.pi, abs=1e-9)
    second = found.phases[2].motion
    entering = second.points["P of the next slot"].position
    np.testing.assert_allclose(entering[0], found.phases[0].motion.points["P"].position[-1].conj(), atol=1e-9)


def test_what_is_refused() -> None:
    """Each is named: no slot, several drivers, a pin that never leaves, slots elsewhere, unknown quantities."""
    for name, said in (("crank-rocker", "0 slots with ends"), ("five-bar", "2 drivers")):
        with pytest.raises(InvalidInput, match=said):
            ck.figures.intermittent_motion(ck.load(name))
    with pytest.raises(InvalidInput, match="'guide' is no slot with ends"):
        ck.figures.intermittent_motion(geneva(4), pair="guide")
    with pytest.raises(InvalidInput, match=r"wheel turns by 90 degrees, 1\.25 times the pitch of 5 slots"):
        ck.figures.intermittent_motion(geneva(4), slots=5)
    always = geneva(4).replace(
        ck.slot("crank", on="wheel", at="A", through="C", toward="E", reach=(0.1, 500), name="slot")
    )
    with pytest.raises(InvalidInput, match="its motion has 0 gaps"):
        ck.figures.intermittent_motion(always)
    with pytest.raises(UnknownName, match="wheal"):
        ck.figures.intermittent_motion(geneva(4)).table("wheal.angle")
