"""The RRP dyad: a rod pinned to what is known, and pinned to a block (or guide) that slides on what is known.

Source: intersection of a circle and a line; the slider-crank position equation with eccentricity, e.g.
R. L. Norton, Design of Machinery, section 4.7.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, dot, reciprocal
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Root, clipped_root
from compoundkin.kinematics.dyad_loci import LineLocus, Loci, direction_of, place_of, radius_about
from compoundkin.kinematics.groups.dyad import AssembledDyad, Closed, DyadSolver, OuterPair
from compoundkin.kinematics.groups.pair_sides import Reason, alone, heading, placed_at, spot


class RRP(DyadSolver):
    """Mode +1: the inner pin is the one farther along the guide."""

    name: ClassVar[str] = "RRP"
    modes: ClassVar[int] = 2
    sign_means: ClassVar[str] = "the inner pin is farther along the guide"

    @staticmethod
    def assemble(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, sign: Number, root: Root = clipped_root
    ) -> Closed:
        """Intersect the outer pin's circle with the line of the inner pin."""
        rod, start, guide, v = _line(first, inner, second)
        across, along = guide.cross(start), guide.dot(start)
        rod2 = rod.abs2()
        half, margin = root(rod2 - across * across, rod2.c[0])
        travel = half * sign - along
        u = (start + guide * travel) / rod
        block = placed_at(as_series(second.world.point) + guide * travel, v, second.local.point)
        return Closed((placed_at(as_series(first.world.point), u, first.local.point), block), margin)

    @staticmethod
    def transmitted(first: End, inner: End, second: End) -> Number:
        """Return the angle between the rod and the normal of the guide."""
        return np.conjugate(spot(inner) - spot(first)) * second.along.c[0] * 1j

    @staticmethod
    def first_reaction(first: End, inner: End, second: End, loads: tuple[Wrench, Wrench]) -> Wrench:
        """Return the force at the outer pin. The guide takes none along it, the rod no moment about the inner pin."""
        pin, e, (one, two) = spot(inner), heading(second), loads
        a = spot(first) - pin
        force = (1j * e * one.about(pin) + a * dot(e, one.force + two.force)) * -reciprocal(dot(a, e))
        return Wrench.at(spot(first), force)

    @staticmethod
    def loci(own: AssembledDyad) -> Loci:
        """Return the rod's circle, and the line of its other pin."""
        outer, pin, guide = own.names
        meeting = place_of(own.poses[0].at(own.inner[0].point))
        rod = radius_about(place_of(own.first.world.point), meeting, outer, pin)
        told = f"{pin}: the circle about {outer} with {rod.name} meets the line along the guide of {guide}"
        return Loci((rod, LineLocus(meeting, direction_of(own.second.world))), meeting, (told,))

    @staticmethod
    def reasons_of(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, names: tuple[str, str, str]
    ) -> tuple[Reason, ...]:
        """Say that the rod does not reach the line of its other pin."""
        rod, start, guide, _ = _line(first, inner, second)
        distance, runs = np.abs(guide.cross(start).c[0]), f"the line on which {names[1]} runs"
        return alone(f"{names[0]} is ", distance, f" from {runs} > |{names[0]}{names[1]}| = ", np.abs(rod.c[0]))


def _line(first: OuterPair, inner: tuple[End, End], second: OuterPair) -> tuple[Series, Series, Series, Series]:
    """The rod in its own frame; the line of the inner pin, a point from the outer pin and a direction; the block's
    orientation.
    """
    rod = as_series(inner[0].point - first.local.point)
    guide = second.world.along
    v = guide * second.local.along.conj()
    start = Pose(as_series(second.world.point), v).at(inner[1].point - second.local.point) - first.world.point
    return rod, start, guide, v
