"""A follower drawn at a contact between the two outer ones stays on it: against roots of the contact's own equation.

Profiles are formulas, so that the second way needs nothing but them: all parameters at which the way of the follower's
point meets the moved profile, and of these the one that goes on from the last.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import compoundkin as ck

# The second way goes on by so many radians, to a contact not farther than this.
FINE, NEIGHBOUR = 5e-3, 0.25
OFFSET, ARM, PIN = 0.4, 6.5, 0.5 - 6.0j


def bent(t: np.ndarray) -> np.ndarray:
    """A bean: lines across it meet it four times."""
    return 4.0 * np.cos(t) + 1j * (1.5 * np.sin(t) + 1.2 * np.cos(2.0 * t))


def on_slide(place: np.ndarray) -> np.ndarray:
    return place.imag - OFFSET


def on_arm(place: np.ndarray) -> np.ndarray:
    return np.abs(place - PIN) - ARM


def met(way: Callable[[np.ndarray], np.ndarray], angle: float) -> np.ndarray:
    """Where a way meets the bean turned by an angle, by halving."""

    def level(t: np.ndarray) -> np.ndarray:
        return way(bent(t) * np.exp(1j * angle))

    t = np.linspace(0.0, 2.0 * np.pi, 2001)
    values = level(t)
    side = np.flatnonzero(values[:-1] * values[1:] < 0.0)
    low, high = t[side], t[side + 1]
    # forty-five halvings of a two-thousandth of a turn: less than rounding
    for _ in range(45):
        middle = 0.5 * (low + high)
        same = values[side] * level(middle) > 0.0
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return bent(low) * np.exp(1j * angle)


def followed(way: Callable[[np.ndarray], np.ndarray], start: complex, to: float) -> list[tuple[float, complex]]:
    """A contact from where it is drawn, at angle 0, to another angle of the cam, or to its end."""
    found = [(0.0, start)]
    for angle in np.linspace(0.0, to, 2 + int(abs(to) / FINE))[1:]:
        # what is ahead on a straight line, for contacts that come near each other at an end
        ahead = found[-1][1] + (found[-1][1] - found[-2][1] if len(found) > 1 else 0.0)
        here = met(way, angle)
        near = np.abs(here - ahead)
        if not len(here) or near.min() > NEIGHBOUR:
            break
        found.append((float(angle), complex(here[np.argmin(near)])))
    return found


def mechanism(place: complex, follower: list[object]) -> ck.Mechanism:
    profile = ck.profiles.formula(bent, 0.0, 2.0 * np.pi)
    return ck.Mechanism(
        "Bean", ck.link("frame", A=0, H=PIN), ck.link("cam", A=0, K=1), *follower,
        ck.cam("follower", on="cam", at="P", profile=profile), ck.drive("cam"), ck.drawn(A=0, H=PIN, K=1, P=place),
    )  # fmt: skip


SLIDING = [ck.link("follower", P=0), ck.slide("follower", on="frame", through="A", angle=0.0, offset=OFFSET)]
TURNING = [ck.link("follower", H=0, P=ARM)]


@pytest.mark.parametrize(("way", "follower"), [(on_slide, SLIDING), (on_arm, TURNING)])
def test_inner_contacts_are_followed_both_ways(way: Callable[[np.ndarray], np.ndarray], follower: list[object]) -> None:
    """As far as each contact lasts; the two outer ones are solved as ever."""
    drawn = met(way, 0.0)
    assert len(drawn) == 4
    inner = 0
    for place in drawn:
        ends = [followed(way, place, side) for side in (-0.6, 0.6)]
        angles = np.linspace(ends[0][-1][0] * 0.95, ends[1][-1][0] * 0.95, 12)
        motion = ck.solve(mechanism(complex(place), follower), {"cam": angles}, order=0)
        if not motion.solving_order.solvers[0].is_numbered:
            continue
        inner += 1
        known = sorted(ends[0][:0:-1] + ends[1], key=lambda one: one[0])
        nearest = [min(known, key=lambda one: abs(one[0] - angle)) for angle in angles]
        expected = [
            min(met(way, angle), key=lambda p: abs(p - near)) for angle, (_, near) in zip(angles, nearest, strict=True)
        ]
        assert np.abs(motion.points["P"].position - expected).max() < 1e-9
    assert inner == 2


@pytest.mark.parametrize(("way", "follower"), [(on_slide, SLIDING), (on_arm, TURNING)])
@pytest.mark.parametrize("side", [1.0, pytest.param(-1.0, marks=pytest.mark.full)])
def test_an_outer_contact_does_not_leap_to_another_one(
    way: Callable[[np.ndarray], np.ndarray], follower: list[object], side: float
) -> None:
    """Where it ends another one is the outer one; the drawn one is reached the other way round only."""
    drawn = met(way, 0.0)
    start = complex(drawn[np.argmax(side * drawn.real)])
    last = followed(way, start, -1.0 * side)[-1][0]
    assert abs(last) < 0.8
    around = followed(way, start, side * (2.0 * np.pi - 1.0))
    assert abs(around[-1][0]) > 5.2
    angles = np.linspace(0.0, -1.0 * side, 11)
    motion = ck.solve(mechanism(start, follower), {"cam": angles}, order=0)
    assert motion.solving_order.numbered == (0,)
    for angle, position in zip(angles, motion.points["P"].position, strict=True):
        before = abs(angle) <= abs(last)
        known = (
            followed(way, start, float(angle))[-1]
            if before
            else min(around, key=lambda one: abs(one[0] - angle - side * 2.0 * np.pi))
        )
        here = met(way, float(angle))
        assert abs(position - here[np.argmin(np.abs(here - known[1]))]) < 1e-9


def wave(**drawn: complex) -> ck.Mechanism:
    """A plate with a groove like a W, moved across a slide: contacts at squares 1 +- sqrt(1 - s)."""
    groove = ck.profiles.formula(lambda t: t + 1j * (t**4 - 2.0 * t**2), -1.7, 1.7, closed=False)
    return ck.Mechanism(
        "W", ck.link("frame", A=0), ck.link("plate", Q=0), ck.link("follower", P=0),
        ck.slide("plate", on="frame", at="Q", through="A", angle=np.pi / 2, turn=-np.pi / 2, name="lift"),
        ck.slide("follower", on="frame", at="P", through="A", angle=0.0),
        ck.cam("follower", on="plate", at="P", profile=groove), ck.drive("plate", on="frame", pair="lift"),
        ck.drawn(A=0, **drawn),
    )  # fmt: skip


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_inner_contact_ends_where_it_meets_others(side: float) -> None:
    """At 0 with the other inner one, at 1 with an outer one: gaps, and no leap to the outer ones that go on."""
    lift = np.linspace(-0.49, 1.49, 41)
    there = (lift > 0.0) & (lift < 1.0)
    place = side * np.sqrt(1.0 - np.sqrt(1.0 - 0.36))
    with pytest.warns(ck.errors.UnassembledPoses):
        motion = ck.solve(wave(Q=0.36j, P=place), {"plate": lift}, order=1)
    assert np.array_equal(motion.assembled, there)
    s = lift[there]
    expected = side * np.sqrt(1.0 - np.sqrt(1.0 - s))
    found = motion.points["P"]
    assert np.abs(found.position[there] - expected).max() < 1e-9
    # 2 x x' = 1 / (2 sqrt(1 - s))
    rate = 1.0 / (4.0 * expected * np.sqrt(1.0 - s))
    assert np.abs(found.velocity[there] / rate - 1.0).max() < 1e-7
    assert all("ends at a limit position" in gap.reason for gap in ck.gaps(motion))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_outer_contacts_are_not_tracked(side: float) -> None:
    """Drawn at an outer contact, roughly too, it is found anew at every pose."""
    lift = np.linspace(-0.5, 0.9, 29)
    for off in (0.0, 1e-3, 0.05):
        place = side * np.sqrt(1.0 + np.sqrt(1.0 - 0.36)) * (1.0 + off)
        motion = ck.solve(wave(Q=0.36j, P=place), {"plate": lift}, order=0)
        assert not motion.solving_order.numbered
        assert np.abs(motion.points["P"].position - side * np.sqrt(1.0 + np.sqrt(1.0 - lift))).max() < 1e-9


def test_a_written_mode_is_an_outer_contact() -> None:
    """It goes before the drawing, which shows an inner one here; a hint shows one as a drawing does."""
    inner, outer = (np.sqrt(1.0 + k * np.sqrt(1.0 - 0.36)) for k in (-1.0, 1.0))
    drawn = wave(Q=0.36j, P=inner)
    values = {"plate": np.array([0.36, 0.4])}
    assert ck.solve(drawn, values, modes={"follower": 1}).points["P"].position[0] == pytest.approx(outer)
    hinted = ck.solve(wave(Q=0.36j, P=-outer), values, hint={"P": -inner})
    assert hinted.points["P"].position[0] == pytest.approx(-inner)


def test_verifying_sees_that_an_inner_contact_is_meant() -> None:
    """A motion in an outer contact, as if nothing had followed the one drawn, is not where the drawing is."""
    inner = np.sqrt(1.0 - np.sqrt(1.0 - 0.36))
    values = {"plate": np.linspace(0.2, 0.5, 13)}
    followed = ck.solve(wave(Q=0.36j, P=inner), values)
    assert ck.verify(followed).passed
    motion = ck.solve(wave(Q=0.36j, P=np.sqrt(1.0 + np.sqrt(1.0 - 0.36))), values)
    assert ck.verify(motion).passed
    curve = motion.followed.curve
    shown = replace(curve.shown, points={**curve.shown.points, "P": np.array([[inner + 0j]])})
    motion = replace(motion, followed=replace(motion.followed, curve=replace(curve, shown=shown)))
    assert [finding.name for finding in ck.verify(motion).findings if not finding.passed] == ["nearest to the drawing"]


def test_a_random_drawing_at_an_inner_contact() -> None:
    """A roller on a pin, 1 of 500 random exact drawings, was led to an outer contact without a word."""
    from tests.kinematics.test_exact_drawings import fault

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert not fault(1203)
