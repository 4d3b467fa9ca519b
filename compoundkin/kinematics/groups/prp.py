"""The PRP dyad: two blocks on known guides, pinned to each other.

Source: intersection of two lines, as in the elliptic trammel.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, cross, dot, reciprocal
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Root, clipped_root
from compoundkin.kinematics.dyad_loci import LineLocus, Loci, direction_of, place_of
from compoundkin.kinematics.groups.dyad import AssembledDyad, Closed, DyadSolver, OuterPair
from compoundkin.kinematics.groups.pair_sides import Reason, alone, heading, placed_at, spot

# Guides nearer to parallel than this (the sine of the angle between them) fix no point: their meeting
# point would lie beyond a billion times the mechanism's size, and carry no correct digit.
PARALLEL = 1e-9


class PRP(DyadSolver):
    """Two blocks on known guides, pinned to each other. It has one assembly mode: a sign has no effect."""

    name: ClassVar[str] = "PRP"
    modes: ClassVar[int] = 1
    sign_means: ClassVar[str] = "there is only one mode"

    @staticmethod
    def assemble(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, sign: Number, root: Root = clipped_root
    ) -> Closed:
        """Meet the two lines on which the inner pin runs."""
        (here, u), (there, v) = _line(first, inner[0]), _line(second, inner[1])
        one, two = first.world.along, second.world.along
        gap = there - here
        sine, margin = separated(one.cross(two))
        pose = placed_at(as_series(first.world.point) + one * (gap.cross(two) / sine), u, first.local.point)
        other = placed_at(as_series(second.world.point) + two * (gap.cross(one) / sine), v, second.local.point)
        return Closed((pose, other), margin)

    @staticmethod
    def transmitted(first: End, inner: End, second: End) -> Number:
        """Return the angle between the guides."""
        return np.conjugate(first.along.c[0]) * second.along.c[0]

    @staticmethod
    def first_reaction(first: End, inner: End, second: End, loads: tuple[Wrench, Wrench]) -> Wrench:
        """Return the force across the first guide, and the moment. The pin takes no moment."""
        pin, e, g, (one, two) = spot(inner), heading(first), heading(second), loads
        across = dot(g, one.force + two.force) * reciprocal(cross(g, e))
        return Wrench.at(pin, 1j * e * across, -one.about(pin))

    @staticmethod
    def loci(own: AssembledDyad) -> Loci:
        """Return the two lines on which the inner pin runs."""
        meeting = place_of(own.poses[0].at(own.inner[0].point))
        lines = (LineLocus(meeting, direction_of(side.world)) for side in (own.first, own.second))
        told = f"{own.names[1]}: the lines on which it runs along its two guides meet"
        return Loci(tuple(lines), meeting, (told,))

    @staticmethod
    def reasons_of(
        first: OuterPair, inner: tuple[End, End], second: OuterPair, names: tuple[str, str, str]
    ) -> tuple[Reason, ...]:
        """Say that the guides are parallel."""
        return alone(f"the guides of {names[0]} and {names[2]} are parallel, so that {names[1]} is not fixed")


def _line(attachment: OuterPair, pin: End) -> tuple[Series, Series]:
    """Return a point of the line on which the inner pin runs, and the orientation of the block that carries it."""
    u = attachment.world.along * attachment.local.along.conj()
    return Pose(as_series(attachment.world.point), u).at(pin.point - attachment.local.point), u


def separated(sine: Series) -> tuple[Series, Number]:
    """Return the sine, NaN where the guides are parallel; and the margin."""
    margin = np.abs(sine.c[0]) - PARALLEL
    return Series((np.where(margin >= 0, sine.c[0], np.nan), *sine.c[1:])), margin
