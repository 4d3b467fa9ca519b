"""The RRR dyad: two links, each pinned to what is known, pinned to each other.

Source: intersection of two circles; e.g. E. Soylu, Mechanisms, section on loop closure of four-bars.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, cross, reciprocal
from compoundkin.base.poses import End
from compoundkin.base.series import Series, as_series, planar_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Root, clipped_root
from compoundkin.kinematics.dyad_loci import Loci, place_of, radius_about
from compoundkin.kinematics.groups.dyad import COINCIDENT, AssembledDyad, Closed, DyadSolver, OuterPair
from compoundkin.kinematics.groups.pair_sides import Reason, placed_at, spot


class RRR(DyadSolver):
    """Mode +1: the pins run counterclockwise.

    They are the outer pin of the first link, the inner pin, the outer pin of the second.
    """

    name: ClassVar[str] = "RRR"
    modes: ClassVar[int] = 2
    sign_means: ClassVar[str] = "outer pin, inner pin, outer pin run counterclockwise"

    @staticmethod
    def assemble(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, sign: Number, root: Root = clipped_root
    ) -> Closed:
        """Intersect the circle about each outer pin."""
        a, b, line = _sides(first, inner, second)
        line2, a2 = line.abs2(), a.abs2()
        reach2 = a2 * line2
        foot = (line2 + (a2 - b.abs2())) * 0.5  # the scalar product of the first link and the line
        apart = line2.c[0] > COINCIDENT**2 * a2.c[0]
        height, margin = root(reach2 - foot * foot, np.where(apart, reach2.c[0], np.nan))  # their cross product
        u = line * a.conj() / planar_series(foot, height * sign)
        v = (u * a - line) / b
        first_pose = placed_at(_point(first), u, first.local.point)
        return Closed((first_pose, placed_at(_point(second), v, second.local.point)), margin, line)

    @staticmethod
    def transmitted(first: End, inner: End, second: End) -> Number:
        """Return the angle between the links at the inner pin."""
        pin = spot(inner)
        return np.conjugate(pin - spot(first)) * (pin - spot(second))

    @staticmethod
    def first_reaction(first: End, inner: End, second: End, loads: tuple[Wrench, Wrench]) -> Wrench:
        """Return the force at the outer pin. Moments of both links about the inner pin give it."""
        pin, one, two = spot(inner), *loads
        a, c = spot(first) - pin, spot(second) - pin
        turning = two.about(pin) - cross(c, one.force + two.force)
        force = (a * turning + c * one.about(pin)) * -reciprocal(cross(a, c))
        return Wrench.at(spot(first), force)

    @staticmethod
    def loci(own: AssembledDyad) -> Loci:
        """Return the circles of both links about their outer pins."""
        outer, pin, other = own.names
        meeting = place_of(own.poses[0].at(own.inner[0].point))
        one = radius_about(place_of(own.first.world.point), meeting, outer, pin)
        two = radius_about(place_of(own.second.world.point), meeting, pin, other)
        told = f"{pin}: the circle about {outer} with {one.name} meets that about {other} with {two.name}"
        return Loci((one, two), meeting, (told,))

    @staticmethod
    def reasons_of(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, names: tuple[str, str, str]
    ) -> tuple[Reason, ...]:
        """Say that the pins are too far apart or too near."""
        a, b, line = (np.abs(s.c[0]) for s in _sides(first, inner, second))
        outer, pin, other = names
        between = f"|{outer}{other}| = "
        apart = (between, line, f" > |{outer}{pin}| + |{pin}{other}| = ", a, " + ", b)
        near = (between, line, f" < ||{outer}{pin}| - |{pin}{other}|| = |", a, " - ", b, "|")
        together = f"{outer} and {other} coincide, so that the direction of {outer}{pin} is not determined"
        return (
            Reason(line - (a + b) > 0, apart),
            Reason((line - np.abs(a - b) < 0) & (line > COINCIDENT * a), near),
            Reason(True, (together,)),
        )


def _sides(first: OuterPair, inner: tuple[End, End], second: OuterPair) -> tuple[Series, Series, Series]:
    """From the outer to the inner pin on each body, and from one outer pin to the other in the world."""
    return (
        as_series(inner[0].point - first.local.point),
        as_series(inner[1].point - second.local.point),
        _point(second) - _point(first),
    )


def _point(attachment: OuterPair) -> Series:
    return as_series(attachment.world.point)
