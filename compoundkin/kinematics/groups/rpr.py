"""The RPR dyad: a guide and a block, each pinned to what is known, that slide on each other.

Source: the inverted slider-crank with eccentricity, e.g. R. L. Norton, Design of Machinery, section 4.7.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, dot, reciprocal
from compoundkin.base.poses import End
from compoundkin.base.series import Series, as_series, planar_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Root, clipped_root
from compoundkin.kinematics.dyad_loci import CircleLocus, LineLocus, Loci, direction_of, place_of, radius_about
from compoundkin.kinematics.groups.dyad import AssembledDyad, Closed, DyadSolver, OuterPair
from compoundkin.kinematics.groups.pair_sides import Reason, heading, placed_at, spot

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
        line, across = _distances(first, inner, second)
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
        line, across = (np.abs(s.c[0]) for s in _distances(first, inner, second))
        together = f"{names[0]} and {names[2]} coincide, so that the direction of the guide of {names[1]}"
        beside = f", the distance of the two pins across the guide of {names[1]}"
        return (
            Reason(line - across >= 0, (f"{together} is not determined",)),
            Reason(True, (f"|{names[0]}{names[2]}| = ", line, " < ", across, beside)),
        )


def _distances(first: OuterPair, inner: tuple[End, End], second: OuterPair) -> tuple[Series, Series]:
    """Return the vector between the outer pins, and their distance across the guide."""
    line = as_series(second.world.point) - first.world.point
    here = as_series(first.local.point - inner[0].point) * inner[0].along.conj()
    there = as_series(second.local.point - inner[1].point) * inner[1].along.conj()
    return line, (there - here).imag
