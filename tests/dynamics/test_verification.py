"""What verifies forces: right ones pass, and each kind of wrong one is found, by the finding that is meant for it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.wrenches import Wrench
from compoundkin.results import Forces
from tests.dynamics.cases import CASES, six_bar

LINKS, PINS, FRAME = "balance of links", "balance of pins", "balance of the frame"
CARRIED, WORK, POWER, LEAK = "what pairs can carry", "efforts by virtual work", "balance of power", "work of pairs"


@pytest.mark.parametrize("name", CASES)
def test_right_forces_pass(name: str) -> None:
    check = ck.verify(CASES[name]().forces)
    assert check.passed
    assert {finding.name for finding in check.findings} == {LINKS, PINS, FRAME, CARRIED, WORK, POWER, LEAK}
    assert all(finding.value < 1e-13 for finding in check.findings)


def changed(forces: Forces, pair: str, change: Callable[[Wrench], Wrench]) -> Forces:
    """Return forces with another wrench in one pair."""
    return replace(forces, wrenches={**forces.wrenches, pair: change(forces.wrenches[pair])})


def without_mass(forces: Forces, link: str) -> Forces:
    """Return the forces of a mechanism in which one mass is forgotten, as if they were those of the whole one."""
    mechanism = forces.mechanism
    items = [item for item in mechanism.items if item is not mechanism.masses[link]]
    other = ck.Mechanism(mechanism.title, *items, units=mechanism.units)
    found = ck.force_analysis(ck.solve(other, forces.motion.drives["crank"].value, speed=10, acceleration=20))
    return replace(found, motion=forces.motion)


def at_another_place(wrench: Wrench) -> Wrench:
    return Wrench(wrench.force, wrench.moment + 1e-3 * np.abs(wrench.force) * 0.05)


WRONG: dict[str, tuple[Callable[[Forces], Forces], set[str]]] = {
    "a pin off by 0.1 %": (lambda f: changed(f, "A", lambda w: w.times(1.001)), {LINKS}),
    "a slot off by 0.1 %": (lambda f: changed(f, "slot", lambda w: w.times(1.001)), {LINKS}),
    "a wrong sign": (lambda f: changed(f, "D", lambda w: -w), {LINKS}),
    "a pin on the frame": (lambda f: changed(f, "B", lambda w: w.times(1.001)), {LINKS, FRAME}),
    "a pin with a moment": (lambda f: changed(f, "A", at_another_place), {LINKS, CARRIED, LEAK}),
    "a force along a slot": (
        lambda f: changed(f, "slot", lambda w: Wrench(w.force * np.exp(1e-3j), w.moment)),
        {LINKS, CARRIED, LEAK},
    ),
    "a driver off by 0.1 %": (
        lambda f: changed(f, "E", lambda w: Wrench(w.force, w.moment * 1.001)),
        {LINKS, FRAME, WORK, POWER},
    ),
    "a driver's sign": (
        lambda f: changed(f, "E", lambda w: Wrench(w.force, -w.moment)),
        {LINKS, FRAME, WORK, POWER},
    ),
    "a forgotten mass": (lambda f: without_mass(f, "block"), {LINKS, FRAME, WORK, POWER}),
    "forgotten inertia": (
        lambda f: replace(ck.force_analysis(f.motion, inertia=False), inertia=True),
        {LINKS, FRAME, WORK, POWER},
    ),
    "a sum on the frame": (lambda f: replace(f, on_frame=f.on_frame.times(1.001)), {FRAME}),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_forces_are_found(name: str) -> None:
    spoil, expected = WRONG[name]
    failed = set(ck.verify(spoil(six_bar("dynamic", True).forces)).failed)
    assert failed == expected
