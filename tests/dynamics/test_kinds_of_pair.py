"""Forces in every kind of pair, held against Newton and Euler, virtual work and power by `ck.verify`."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.model.pairs import KINDS
from tests import catalog

SI = {"length": "m", "mass": "kg", "force": "N"}
GRAVITY = ck.gravity(0, -9.81)


def in_a_ring() -> ck.Mechanism:
    """A driven wheel that rolls in a ring and moves a slider by a rod."""
    return ck.Mechanism(
        "In a ring",
        ck.link("frame", O=0), ck.link("wheel", P=0, Q=0.3), ck.link("rod", Q=0, R=2), ck.link("slider", R=0),
        ck.roll_around("wheel", on="frame", centre_at="O", at="P", circle=1.5, radius=0.5, inside=True),
        ck.slide("slider", on="frame", at="R", through="O"),
        ck.drive("wheel", on="frame", values=np.linspace(0, 6, 9), speed=3.0),
        ck.mass("wheel", 2.0, at=(0.05, 0.1), inertia=0.3), ck.mass("rod", 1.0, at=(1, 0), inertia=0.2),
        GRAVITY, units=SI,
    )  # fmt: skip


def pulled(inside: bool, on_line: bool) -> ck.Mechanism:
    """A wheel that rolls on a line or a circle, pulled at its middle by a crank and a rod."""
    line = ck.roll("wheel", on="frame", through="O", at="P", radius=0.5, phase=0.0)
    around = ck.roll_around(
        "wheel", on="frame", centre_at="O", at="P", circle=1.6 if inside else 1.0, radius=0.6 if inside else 0.5,
        inside=inside, phase=0.0,
    )  # fmt: skip
    return ck.Mechanism(
        "Pulled wheel",
        ck.link("frame", O=0, A=(3, 1) if on_line else (3, 0)), ck.link("crank", A=0, B=0.3),
        ck.link("rod", B=0, P=2.5 if inside else 2.0), ck.link("wheel", P=0),
        line if on_line else around,
        ck.drive("crank", values=np.linspace(0, 6, 9), speed=3.0),
        ck.mass("wheel", 2.0, at=(0.1, 0), inertia=0.3), ck.mass("rod", 1.0, at=(1, 0), inertia=0.2),
        GRAVITY, units=SI,
    )  # fmt: skip


def in_an_arc() -> ck.Mechanism:
    """A rod led by a circular slot, and a rocker with a straight one that it moves."""
    return ck.Mechanism(
        "In an arc",
        ck.link("frame", O=0, C=(2, 0), D=(0.7, -1.2)), ck.link("crank", O=0, A=0.3),
        ck.link("rod", A=0, B=1.5, E=(0.7, 0.2)), ck.link("rocker", D=0, F=1.0),
        ck.arc("rod", on="frame", at="B", centre_at="C", radius=1.0),
        ck.slot("rod", on="rocker", at="E", through="D", toward="F"),
        ck.drive("crank", values=np.linspace(0, 6, 9), speed=3.0),
        ck.mass("rod", 1.0, at=(0.4, 0.2), inertia=0.2), ck.mass("rocker", 1.0, at=(0.4, 0.2), inertia=0.2),
        GRAVITY, units=SI,
    )  # fmt: skip


def with_belt() -> ck.Mechanism:
    """A belt between pulleys on a crank that turns about the first one."""
    return ck.Mechanism(
        "Belt on a crank",
        ck.link("frame", O=0), ck.link("crank", O=0, P=1.0), ck.link("pulley", P=0),
        ck.belt("frame", "pulley", carrier="crank", radii=(0.2, 0.3), name="belt"), ck.pretension("belt", 40.0),
        ck.drive("crank", values=np.linspace(0, 6, 9), speed=3.0, acceleration=2.0),
        ck.mass("pulley", 2.0, at=(0.1, 0), inertia=0.3), GRAVITY, units=SI,
    )  # fmt: skip


def weighty(name: str) -> ck.Mechanism:
    """A mechanism of the catalog with masses off all pins, but for rollers, which turn freely."""
    plan, rng = catalog.mechanism(name), np.random.default_rng(3)
    size, free = plan.geometry.size, {spin.link for spin in ck.decompose(plan).passive}
    masses = [
        ck.mass(link, rng.uniform(0.5, 2.0), at=(0, 0) if link in free else tuple(rng.normal(size=2) * 0.1 * size),
                inertia=0.0 if link in free else rng.uniform(0.5, 2.0) * 0.05 * size**2)
        for link in plan.links if link != "frame"
    ]  # fmt: skip
    return ck.Mechanism(plan.title, *plan.items, *masses, GRAVITY, units=SI)


SHOWN: dict[str, Callable[[], ck.Mechanism]] = {
    "in a ring": in_a_ring,
    "on a circle": lambda: pulled(False, False),
    "inside a circle": lambda: pulled(True, False),
    "on a line": lambda: pulled(False, True),
    "in an arc": in_an_arc,
    "belt": with_belt,
    **{
        name: lambda name=name: weighty(name)  # type: ignore[misc]
        for name in (
            "disc-cam-offset-roller", "disc-cam-roller-program", "oscillating-flat-follower", "flat-faced-follower",
            "quick-return-pin-in-slot", "rack-and-pinion-steering", "rack-driven-double-slider", "differential",
            "planetary-train", "3-rrr", "excavator-arm",
        )
    },
}  # fmt: skip


@pytest.mark.parametrize("name", SHOWN)
def test_forces_in_every_kind_of_pair_are_verified(name: str) -> None:
    forces = ck.force_analysis(ck.solve(SHOWN[name]()))
    check = ck.verify(forces)
    assert check.passed, check


def test_every_kind_is_among_them() -> None:
    used = set()
    for make in SHOWN.values():
        used |= {type(pair) for pair in ck.decompose(make()).pairs}
    assert used >= set(KINDS.values())
