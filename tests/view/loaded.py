"""Mechanisms with loads for the tests of what people see: a crank with closed forms, and the six-bar."""

from __future__ import annotations

from functools import cache

import compoundkin as ck
from compoundkin.dynamics.forces import Forces

UNITS = {"length": "mm", "mass": "kg", "force": "N"}
# of the crank: its mass (kg) at its middle, and its speed (rad/s)
MASS, REACH, SPEED = 0.3, 40.0, 20.0


def crank() -> ck.Mechanism:
    """A crank of 80 mm with its mass centre in the middle, under gravity."""
    frame, link = ck.link("frame", A=(0, 0)), ck.link("crank", A=(0, 0), B=(80, 0))
    weight = ck.mass("crank", MASS, at=(REACH, 0), inertia=160.0), ck.gravity(0, -9.81)
    return ck.Mechanism("Crank", frame, link, ck.drive("crank"), *weight, units=UNITS)


@cache
def crank_forces() -> Forces:
    """The forces of its full turn in steps of 40 degrees, so that the extremes lie between poses."""
    return ck.force_analysis(ck.solve(crank(), {"crank": ck.deg(range(0, 361, 40))}, speed=SPEED))


def six_bar() -> ck.Mechanism:
    """The six-bar of Example 3-4 with masses on all links, a force on G and a torque on the rocker."""
    bare = ck.load("six-bar")
    masses = (
        ck.mass("crank", 0.03, at=(7, 0), inertia=1.0),
        ck.mass("plate", 0.12, at=(17, 3), inertia=20.0),
        ck.mass("rocker", 0.05, at=(14, 0), inertia=5.0),
        ck.mass("bar", 0.06, at=(27.5, 0), inertia=20.0),
        ck.mass("block", 0.02, at=(0, 0), inertia=0.5),
    )
    loads = ck.gravity(0, -9.81), ck.force("bar", (-3, -5), at="G"), ck.torque("rocker", 20.0)
    return ck.Mechanism(bare.title, *bare.items, *masses, *loads, units=UNITS, outputs=bare.outputs)


@cache
def six_bar_forces() -> Forces:
    """Its forces over a full turn."""
    return ck.force_analysis(ck.solve(six_bar(), speed=20.0))
