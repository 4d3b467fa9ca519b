"""The rack pair: a rack and its pinion, or a cable that a drum winds up."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, dot, first_entry
from compoundkin.base.errors import Problem
from compoundkin.base.series import Series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import TANGENTIAL
from compoundkin.model.fields import constructor, link_key, point_key, value_key
from compoundkin.model.pairs.contract import Ends, Pair, Poses, TransmittingPair, jacobian_of_rows
from compoundkin.model.pairs.gear import STANDARD, UNCOUNTED
from compoundkin.model.pairs.geared import FITS, ToothFriction, pressure_problems, radius_problems
from compoundkin.model.pairs.loop_terms import Auxiliary, LoopTerms, angle_of, difference, end_angle
from compoundkin.model.pairs.pitch_line import PitchLinePair
from compoundkin.model.pairs.revolute import Revolute


@dataclass(frozen=True, eq=False)
class Rack(PitchLinePair, TransmittingPair, ToothFriction):
    """The link `pinion` rolls without slip along the pitch line of the link `rack`.

    The pitch line runs through the point `through` of the rack, in the direction `angle` (radians, from the rack's x
    axis) or toward the point `toward`; the pinion turns about its point `at`, which lies at its pitch `radius`, or
    ``teeth * module / 2``, to the left of that direction where `side` is +1, to the right where it is -1. `phase` is
    the displacement of the axis from `through` where the pinion's angle from the rack is zero; it is read off a
    drawing that shows both, or zero.

    Held: ``displacement + side * radius * (pinion - rack) - phase``. Free: the displacement. Nothing holds the axis at
    its distance but other pairs: a pin and a slide on the frame, a carrier, a yoke; `verify` reports where they do not.
    The tooth force acts at the pitch point, along the line, and parts the two by the tangent of the `pressure_angle`
    (radians). A cable that a drum winds up and that pulls a block is the same pair, of pressure angle 0. Source: e.g.
    J. J. Uicker, G. R. Pennock and J. E. Shigley, Theory of Machines and Mechanisms, chapter 7 (a rack is a gear of
    infinite radius). Teeth with an efficiency lose a part of their moment about the axis, against the pinion's turning
    on the rack.

    >>> rack("bar", "wheel", through="Q", at="C", radius=12).size
    12
    """

    rack: str = field(metadata=link_key("The link with the rack, or the block that a cable pulls."))
    pinion: str = field(metadata=link_key("The link with the pinion, or the drum."))
    _: KW_ONLY
    through: str = field(metadata=point_key("rack", "A point of the rack on its pitch line."))
    at: str = field(
        default="", metadata=point_key("pinion", "The axis of the pinion; may be left out if its link has one point.")
    )
    angle: Number = field(
        default=0.0, metadata=value_key("angle", "Direction of the pitch line from the x axis of the rack.")
    )
    toward: str | None = field(
        default=None, metadata=point_key("rack", "A second point of the rack on the pitch line, instead of an angle.")
    )
    radius: Number | None = field(default=None, metadata=value_key("length", "Pitch radius of the pinion."))
    teeth: Number | None = field(
        default=None, metadata=value_key("length", "Number of teeth of the pinion, instead of a radius.")
    )
    module: Number | None = field(default=None, metadata=value_key("length", "Pitch diameter by number of teeth."))
    side: int = field(
        default=1, metadata=value_key("sign", "1 where the pinion is to the left of the pitch line, -1 to the right.")
    )
    pressure_angle: Number = field(
        default=STANDARD, metadata=value_key("angle", "Angle between the teeth's force and the pitch line.")
    )
    phase: Number | None = field(
        default=None, metadata=value_key("length", "Displacement of the axis where the pinion's angle is zero.")
    )

    code: ClassVar[str] = "K"
    title: ClassVar[str] = "rack pair"
    held: ClassVar[int] = 1
    force_words: ClassVar[tuple[str, ...]] = (TANGENTIAL,)
    table: ClassVar[str] = "racks"
    takes: ClassVar[tuple[str, ...]] = ("friction", "efficiency")

    @property
    def members(self) -> tuple[str, ...]:
        """The rack and the pinion."""
        return self.rack, self.pinion

    @property
    def size(self) -> Number:
        """The pitch radius."""
        if self.radius is not None:
            return self.radius
        return 1.0 if self.teeth is None or self.module is None else self.teeth * self.module / 2.0

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, a pinion without a size or with two."""
        yield from super().problems(links, where)
        yield from pressure_problems(self.pressure_angle, where)
        for key in ("radius", "teeth", "module"):
            yield from radius_problems(where, key, getattr(self, key))
        if self.teeth is not None and not np.all(np.asarray(self.teeth) == np.round(self.teeth)):
            yield Problem(f"{where}.teeth", f"{self.teeth!r} is not a whole number", "give a radius instead")
        counted = self.teeth is not None and self.module is not None
        if self.radius is None and not counted:
            yield Problem(where, "the pinion has no size", "give a radius, or teeth and module")
        elif self.radius is not None and (self.teeth is not None or self.module is not None):
            wanted = self.teeth * self.module / 2.0 if self.teeth is not None and self.module is not None else np.nan
            if not np.all(np.abs(wanted - self.radius) <= FITS * np.abs(self.radius)):
                what = "the radius is given, and teeth or module that do not fit it"
                yield Problem(f"{where}.radius", what, "give the radius, or teeth and module")

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the slip."""
        return (self.slip(ends, poses),)

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of slip and displacement."""
        return jacobian_of_rows(*self.rows(ends, poses)[1:])

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return forces along the pitch line. At the pitch point, and at the axis."""
        place, e = self.pitch_point(ends, poses)
        return Wrench.at(place, e), Wrench.at(poses[1].at(ends[1].point).c[0], e)

    @property
    def acts_at(self) -> str:
        """The pitch point."""
        return "pitch point"

    def acting_place(self, ends: Ends, poses: Poses) -> Number:
        """Return the pitch point."""
        return self.pitch_point(ends, poses)[0]

    def transmitted(self, ends: Ends, poses: Poses, wrench: Wrench) -> Number:
        """Return the force along the pitch line on the pinion."""
        return dot(self.pitch_point(ends, poses)[1], wrench.force)

    def accompanying(self, ends: Ends, poses: Poses, transmitted: Number, pretension: Number | None = None) -> Wrench:
        """Return the separating force on the pinion, away from the pitch line."""
        place, e = self.pitch_point(ends, poses)
        apart = np.sign(ends[1].measure) * np.tan(self.pressure_angle)
        return Wrench.at(place, 1j * e * (np.abs(transmitted) * apart))

    def normal_forces(self, ends: Ends, poses: Poses, wrench: Wrench, length: Number | None) -> tuple[Number, ...]:
        """Return the moment of the teeth about the axis of the pinion."""
        return (wrench.about(poses[1].at(ends[1].point).c[0]),)

    def distance_error(self, ends: Ends, poses: Poses) -> Series:
        """Return the distance of the axis from the pitch line less the radius."""
        return self.distance(ends, poses)

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the way along the pitch line, and the pinion's turn. Other pairs lead the axis on this way."""
        rack, pinion = (angle_of(name) for name in self.members)
        turned = difference(rack, pinion).times(ends[1].measure).plus(-ends[0].measure)
        rolled = Auxiliary(self.name, turned, along=rack.plus(end_angle(ends[0])), counts_turns=True)
        points = ends[0].point, ends[1].point
        return LoopTerms(points, ("line", "axis"), equations=(rolled,), is_crossed=False)

    def is_affine(self, lower: Pair, own: int) -> bool:
        """Tell whether a member only slides, or the pinion only turns about its axis."""
        if not lower.free_is_angle:
            return lower.free == ("displacement",) and lower.is_simple
        return isinstance(lower, Revolute) and own == 1 and lower.at == self.at and self.pinion in lower.members

    def pitch(self, radius: Number) -> Number:
        """Return the distance of teeth. Without a module it is that of a gear whose teeth are unknown."""
        if self.module is not None:
            return float(np.pi * first_entry(self.module))
        return 2.0 * np.pi * radius / UNCOUNTED


rack = constructor("rack", Rack)
