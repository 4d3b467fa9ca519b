"""The gear pair: two gears in mesh, external or internal, whose axes a carrier holds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.errors import Problem
from compoundkin.base.wrenches import Wrench
from compoundkin.model.attributes import TANGENTIAL
from compoundkin.model.fields import constructor, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import DimensionFit, Ends, Poses, TransmittingPair
from compoundkin.model.pairs.geared import FrictionMesh, axes_of, pressure_problems
from compoundkin.model.pairs.symbols import Mark, Wheel

# The pressure angle of standard involute teeth.
STANDARD = float(np.deg2rad(20.0))
# How many teeth the smaller gear shows where only radii are known.
UNCOUNTED = 18


@dataclass(frozen=True, eq=False)
class Gear(FrictionMesh, TransmittingPair):
    """Two gears in mesh. `internal` where the second is an internal gear (a ring) around the first.

    With a `module`, or with radii, the pitch circles must fit the distance of the axes; by teeth alone they take it.
    The `pressure_angle` (radians) shows in forces and in the equivalent linkage, not in any motion. See `Geared` for
    the rest.

    The tooth force acts at the pitch point, along the pressure line of the flank that the load requires: a
    tangential force, and one that parts the wheels. Where a train has several planets, these are forces of all of them
    together: one planet of n carries the n-th part if all share alike, and the bearings of the sun carry nothing.

    >>> gear("sun", "planet", carrier="arm", teeth=(20, 40)).name
    'sun/planet'
    """

    _: KW_ONLY
    internal: bool = field(
        default=False, metadata=value_key("flag", "Whether the second is an internal gear (a ring) around the first.")
    )
    module: Number | None = field(
        default=None, metadata=value_key("length", "Pitch diameter by number of teeth; checked against the axes.")
    )

    pressure_angle: Number = field(
        default=STANDARD, metadata=value_key("angle", "Angle between the teeth's force and the common tangent.")
    )

    code: ClassVar[str] = "G"
    title: ClassVar[str] = "gear pair"
    force_words: ClassVar[tuple[str, ...]] = (TANGENTIAL,)
    table: ClassVar[str] = "gears"
    takes: ClassVar[tuple[str, ...]] = ("friction", "efficiency")

    @property
    def turns_alike(self) -> bool:
        """Whether they are a gear and the ring around it."""
        return self.internal

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find also a ring that is not larger than the gear in it. A module without teeth is one more problem."""
        yield from super().problems(links, where)
        yield from pressure_problems(self.pressure_angle, where)
        for key, sizes in (("teeth", self.teeth), ("radii", self.radii)):
            if self.internal and sizes is not None and not np.all(np.asarray(sizes[1]) > np.asarray(sizes[0])):
                what = "an internal gear is not larger than the pinion in it"
                yield Problem(f"{where}.{key}", what, "name the pinion first and the ring second")
        if self.module is not None and not np.all(np.asarray(self.module) > 0):
            yield Problem(f"{where}.module", f"{self.module!r} is not a positive length", "give a positive number")
        if self.module is not None and self.teeth is None:
            yield Problem(f"{where}.module", "a module says nothing without teeth", "give teeth = (20, 40)")

    def fits(self, geometry: Geometry) -> tuple[DimensionFit, ...]:
        """Return two axes that are apart, and pitch circles that fit their distance."""
        distance = self.distance(geometry)
        what = f"{self.first_at} and {self.second_at} are at one place on {self.carrier!r}"
        apart = DimensionFit("carrier", distance, (what,), "gears in mesh have two axes")
        sign = -1.0 if self.internal else 1.0
        if self.module is not None and self.teeth is not None:
            required = np.abs(self.teeth[1] + sign * self.teeth[0]) * self.module / 2.0
            return apart, self.distance_fit("teeth", distance, required, "teeth and module require a distance of")
        if self.radii is not None:
            required = np.abs(self.radii[1] + sign * self.radii[0])
            return apart, self.distance_fit("radii", distance, required, "pitch circles require a distance of")
        return (apart,)

    def reach(self, one: Number, two: Number, distance: Number) -> Number:
        """Return the factors from teeth or radii to base circles."""
        return distance / (one + two) * np.cos(self.pressure_angle)

    def mesh(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return the pitch point, and the direction from the first axis to the second."""
        (first, second), (one, two) = axes_of(ends, poses), (end.measure for end in ends[:2])
        return (first * two + second * one) / (one + two), (second - first) / np.abs(second - first)

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return the tangential force at the pitch point.

        It is to the left of the way from the first axis to the second. Nothing acts on the carrier, and no effort is
        along the coordinate: it is not that of these two links.
        """
        place, across = self.mesh(ends, poses)
        return Wrench.at(place, 1j * across), Wrench()

    @property
    def acts_at(self) -> str:
        """The pitch point."""
        return "pitch point"

    def acting_place(self, ends: Ends, poses: Poses) -> Number:
        """Return the pitch point."""
        return self.mesh(ends, poses)[0]

    def transmitted(self, ends: Ends, poses: Poses, wrench: Wrench) -> Number:
        """Return the tangential force on the second wheel."""
        return dot(1j * self.mesh(ends, poses)[1], wrench.force)

    def accompanying(self, ends: Ends, poses: Poses, transmitted: Number, pretension: Number | None = None) -> Wrench:
        """Return the separating force on the second wheel. It parts the axes, or brings them together inside a ring."""
        place, across = self.mesh(ends, poses)
        apart = -1.0 if self.internal else 1.0
        return Wrench.at(place, across * (np.abs(transmitted) * (apart * np.tan(self.pressure_angle))))

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the pitch circles."""
        one, two = (abs(end.measure) for end in ends[:2])
        unit = self.apart(ends, poses) / (two - one if self.internal else two + one)
        tooth = 1.0 if self.teeth is not None else min(one, two) / UNCOUNTED
        return (
            Wheel(0, ends[0].point, one * unit, round(one / tooth)),
            Wheel(1, ends[1].point, two * unit, round(two / tooth), self.internal),
        )


gear = constructor("gear", Gear)
