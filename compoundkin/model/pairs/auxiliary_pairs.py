"""The pairs of auxiliary links that prescribed motions are made of: cross slides, their slots, turntables."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.poses import End, Pose
from compoundkin.model.geometry import FRAME, Geometry
from compoundkin.model.pairs.contract import Ends, Poses
from compoundkin.model.pairs.loop_terms import LoopTerms
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.slot import Slot
from compoundkin.model.pairs.symbols import Mark


@dataclass(frozen=True, eq=False)
class CrossSlide(Prismatic):
    """A slide along an axis through the origin of its link. Its displacement is a coordinate of a point."""

    axis: complex = field(default=1 + 0j, kw_only=True)
    against: str = field(default=FRAME, kw_only=True)

    @property
    def letters(self) -> tuple[str, ...]:
        """The point with the prescribed motion."""
        return (self.at,)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the axis through both origins."""
        return End(0j, self.axis), End(0j, self.axis)

    def drawn_value(self, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]) -> Number | None:
        """Return where the point is drawn along the axis."""
        if self.at not in sketch or self.against not in drawn:
            return None
        place = drawn[self.against].inverse().at(sketch[self.at]).c[0]
        return (np.conjugate(self.axis) * place).real

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the vector along the axis, from the origin."""
        return replace(super().loop_terms(ends), labels=("origin", self.at))

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return no symbols: the pair is auxiliary."""
        return ()


@dataclass(frozen=True, eq=False)
class CrossSlot(Slot):
    """A slot along an axis through the origin of a carriage. A point with one prescribed coordinate runs in it."""

    axis: complex = field(default=1 + 0j, kw_only=True)

    @property
    def letters(self) -> tuple[str, ...]:
        """The point with the prescribed motion."""
        return (self.at,)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the axis through the carriage's origin; the point."""
        return End(0j, self.axis), End(geometry.points[self.link][self.at])

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return no symbols: the pair is auxiliary."""
        return ()


@dataclass(frozen=True)
class Turntable(Revolute):
    """A pin at the origin of its link. Its angle is that of `turned_link`, which shifts on it without turning."""

    turned_link: str

    def ends(self, geometry: Geometry) -> Ends:
        """Return the two origins."""
        return End(0j), End(0j)

    def drawn_value(self, drawn: Mapping[str, Pose], sketch: Mapping[str, Number]) -> Number | None:
        """Return the angle at which the link is drawn."""
        if self.turned_link not in drawn or self.first not in drawn:
            return None
        return np.angle(drawn[self.turned_link].u.c[0] * np.conjugate(drawn[self.first].u.c[0]))

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return no symbols: the pair is auxiliary."""
        return ()
