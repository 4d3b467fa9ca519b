"""The RPP dyad: a link pinned to what is known, sliding on a second one that slides on what is known.

Source: all orientations are known, so the closure is linear; as in the Scotch yoke.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, cross, dot, reciprocal
from compoundkin.base.poses import End
from compoundkin.base.series import as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.kinematics.block import Root, clipped_root
from compoundkin.kinematics.dyad_loci import LineLocus, Loci, direction_of, place_of
from compoundkin.kinematics.groups.dyad import AssembledDyad, Closed, DyadSolver, OuterPair
from compoundkin.kinematics.groups.pair_sides import Reason, alone, heading, placed_at, spot
from compoundkin.kinematics.groups.prp import separated


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
