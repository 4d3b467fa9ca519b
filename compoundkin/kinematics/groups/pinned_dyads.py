"""The dyads of which one outer pair is a pin: RRR, RRP, RPR and RPP.

Sources: RRR, two links pinned to each other, is the intersection of two circles, e.g. E. Soylu, Mechanisms, section on
loop closure of four-bars. RRP, a rod and a block (or guide) that slides on what is known, is that of a circle and a
line: the slider-crank with eccentricity, e.g. R. L. Norton, Design of Machinery, section 4.7. RPR, a guide and a block
that slide on each other, is the inverted slider-crank with eccentricity, the same section. RPP, a link that slides on a
second one that slides on what is known, has all its orientations known, so the closure is linear, as in the Scotch
yoke.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, cross, dot, reciprocal
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series, planar_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Root, clipped_root
from compoundkin.kinematics.dyad_loci import CircleLocus, LineLocus, Loci, direction_of, place_of, radius_about
from compoundkin.kinematics.groups.dyad import COINCIDENT, AssembledDyad, Closed, DyadSolver, OuterPair
from compoundkin.kinematics.groups.pair_sides import Reason, alone, heading, placed_at, spot
from compoundkin.kinematics.groups.prp import separated


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
        first_pose = placed_at(_pin_of(first), u, first.local.point)
        return Closed((first_pose, placed_at(_pin_of(second), v, second.local.point)), margin, line)

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
        _pin_of(second) - _pin_of(first),
    )


def _pin_of(attachment: OuterPair) -> Series:
    return as_series(attachment.world.point)


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
        rod, start, guide, v = _rod_and_line(first, inner, second)
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
        rod, start, guide, _ = _rod_and_line(first, inner, second)
        distance, runs = np.abs(guide.cross(start).c[0]), f"the line on which {names[1]} runs"
        return alone(f"{names[0]} is ", distance, f" from {runs} > |{names[0]}{names[1]}| = ", np.abs(rod.c[0]))


def _rod_and_line(first: OuterPair, inner: tuple[End, End], second: OuterPair) -> tuple[Series, Series, Series, Series]:
    """The rod in its own frame; the line of the inner pin, a point from the outer pin and a direction; the block's
    orientation.
    """
    rod = as_series(inner[0].point - first.local.point)
    guide = second.world.along
    v = guide * second.local.along.conj()
    start = Pose(as_series(second.world.point), v).at(inner[1].point - second.local.point) - first.world.point
    return rod, start, guide, v


# A pin nearer to the guide's line than this part of the pins' distance is on it.
NO_OFFSET = 1e-9


class RPR(DyadSolver):
    """Mode +1: the block's outer pin lies beyond that of the guide. It does so along the guide's direction."""

    name: ClassVar[str] = "RPR"
    modes: ClassVar[int] = 2
    sign_means: ClassVar[str] = "the block's outer pin is farther along the guide than the guide's own"
    follows_inner: ClassVar[bool] = True

    @staticmethod
    def assemble(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, sign: Number, root: Root = clipped_root
    ) -> Closed:
        """Turn the guide so that the pins have their known distance across it."""
        line, across = _rpr_distances(first, inner, second)
        line2 = line.abs2()
        along, margin = root(line2 - across * across, line2.c[0])
        guide = line / planar_series(along * sign, across)
        u, v = guide * inner[0].along.conj(), guide * inner[1].along.conj()
        first_pose = placed_at(as_series(first.world.point), u, first.local.point)
        second_pose = placed_at(as_series(second.world.point), v, second.local.point)
        return Closed((first_pose, second_pose), margin, line)

    @staticmethod
    def transmitted(first: End, inner: End, second: End) -> Number:
        """Return the angle between the guide and the normal of the line of pins.

        The force goes across the guide through an outer pin, which moves across that line.
        """
        return np.conjugate(spot(second) - spot(first)) * inner.along.c[0] * 1j

    @staticmethod
    def first_reaction(first: End, inner: End, second: End, loads: tuple[Wrench, Wrench]) -> Wrench:
        """Return the force at the outer pin. The guide takes nothing along it; all moments are about the other pin."""
        pin, e, (one, two) = spot(second), heading(inner), loads
        d = spot(first) - pin
        turning = one.about(pin) + two.about(pin)
        force = (1j * e * turning + d * dot(e, one.force)) * -reciprocal(dot(d, e))
        return Wrench.at(spot(first), force)

    @staticmethod
    def loci(own: AssembledDyad) -> Loci:
        """Return the guide, and the circles that it touches.

        They are about the pins; the one over the distance of these gives the place.
        """
        pins = place_of(own.first.world.point), place_of(own.second.world.point)
        along = direction_of(own.poses[0].carry(own.inner[0]))
        on_guide = place_of(own.poses[0].at(own.inner[0].point))
        feet = tuple(on_guide + along * (np.conj(along) * (pin - on_guide)).real for pin in pins)
        span = abs(pins[1] - pins[0])
        apart = [k for k in (0, 1) if abs(feet[k] - pins[k]) > NO_OFFSET * span]
        circles = [radius_about(pins[k], feet[k], "e") for k in apart]
        over = [CircleLocus((pins[0] + pins[1]) / 2.0, span / 2.0)] if len(apart) == 1 else []
        guide = LineLocus(on_guide, along)
        at, through = (own.names[2 * k] for k in (apart[0], 1 - apart[0])) if apart else (own.names[0], own.names[2])
        guide_of = f"the guide of {own.names[1]}"
        told = (
            (f"{guide_of} runs through {at} and {through}",),
            (f"{guide_of} touches the circle about {at}", f"the touching point is on the circle over {at}{through}"),
            (f"{guide_of} touches the circles about {at} and {through}",),
        )[len(apart)]
        return Loci((*circles, *over, guide), feet[apart[0] if apart else 1], told)

    @staticmethod
    def reasons_of(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, names: tuple[str, str, str]
    ) -> tuple[Reason, ...]:
        """Say that the pins are nearer to each other than their eccentricity."""
        line, across = (np.abs(s.c[0]) for s in _rpr_distances(first, inner, second))
        together = f"{names[0]} and {names[2]} coincide, so that the direction of the guide of {names[1]}"
        beside = f", the distance of the two pins across the guide of {names[1]}"
        return (
            Reason(line - across >= 0, (f"{together} is not determined",)),
            Reason(True, (f"|{names[0]}{names[2]}| = ", line, " < ", across, beside)),
        )


def _rpr_distances(first: OuterPair, inner: tuple[End, End], second: OuterPair) -> tuple[Series, Series]:
    """Return the vector between the outer pins, and their distance across the guide."""
    line = as_series(second.world.point) - first.world.point
    here = as_series(first.local.point - inner[0].point) * inner[0].along.conj()
    there = as_series(second.local.point - inner[1].point) * inner[1].along.conj()
    return line, (there - here).imag


class RPP(DyadSolver):
    """A pinned link on a slide that slides on a known guide. It has one mode: a sign has no effect."""

    name: ClassVar[str] = "RPP"
    modes: ClassVar[int] = 1
    sign_means: ClassVar[str] = "there is only one mode"

    @staticmethod
    def assemble(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, sign: Number, root: Root = clipped_root
    ) -> Closed:
        """Slide the second body along its guide until the first's passes through."""
        track = second.world.along
        v = track * second.local.along.conj()
        guide = v * inner[1].along
        pose = placed_at(as_series(first.world.point), guide * inner[0].along.conj(), first.local.point)
        start = placed_at(as_series(second.world.point), v, second.local.point)
        gap = start.at(inner[1].point) - pose.at(inner[0].point)
        sine, margin = separated(guide.cross(track))
        travel = gap.cross(guide) / sine
        moved = placed_at(as_series(second.world.point) + track * travel, v, second.local.point)
        return Closed((pose, moved), margin)

    @staticmethod
    def transmitted(first: End, inner: End, second: End) -> Number:
        """Return the angle between the guides."""
        return np.conjugate(inner.along.c[0]) * second.along.c[0]

    @staticmethod
    def first_reaction(first: End, inner: End, second: End, loads: tuple[Wrench, Wrench]) -> Wrench:
        """Return the force at the outer pin. Neither guide takes anything along it."""
        e, g, (one, two) = heading(inner), heading(second), loads
        lacking = g * dot(e, one.force) - e * dot(g, one.force + two.force)
        return Wrench.at(spot(first), 1j * lacking * reciprocal(cross(e, g)))

    @staticmethod
    def loci(own: AssembledDyad) -> Loci:
        """Return the line of the inner guide, and the way of its point."""
        meeting = place_of(own.poses[1].at(own.inner[1].point))
        held = LineLocus(place_of(own.poses[0].at(own.inner[0].point)), direction_of(own.poses[0].carry(own.inner[0])))
        way = LineLocus(meeting, direction_of(own.second.world))
        pin, inner, outer = own.names
        told = f"the line of the guide of {inner}, held by {pin}, meets the line along the guide of {outer}"
        return Loci((held, way), meeting, (told,))

    @staticmethod
    def reasons_of(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, names: tuple[str, str, str]
    ) -> tuple[Reason, ...]:
        """Say that the guides are parallel."""
        guides = f"the guides of {names[1]} and {names[2]} are parallel"
        return alone(f"{guides}, so that the position along them is not fixed")
