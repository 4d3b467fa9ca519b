"""The belt, chain or cable pair: two pulleys on a carrier, joined by an open or a crossed belt that does not slip."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidMechanism, Problem
from compoundkin.base.wrenches import Wrench
from compoundkin.model.fields import constructor, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import BeltDrive, DimensionFit, Ends, Poses
from compoundkin.model.pairs.geared import FrictionMesh, axes_of, line_of_action
from compoundkin.model.pairs.symbols import Mark, Strap, Wheel, known_range, strap_line


@dataclass(frozen=True, eq=False)
class Belt(FrictionMesh, BeltDrive):
    """Two pulleys or sprockets with a belt, chain or cable that does not slip.

    An open belt turns them alike, a `crossed` one does not. See `Geared` for the rest.

    Its first strand is the one to the left of the way from the first axis to the second, at the first pulley. What it
    transmits is the first strand's pull less the second's. Without pretension the slack strand pulls nothing, as that
    of a chain; with it both strands pull as much at rest, and their sum stays.

    >>> belt("motor", "drum", radii=(30, 90)).turns_alike
    True
    """

    _: KW_ONLY
    crossed: bool = field(
        default=False, metadata=value_key("flag", "Whether the belt is crossed: the pulleys turn against each other.")
    )

    code: ClassVar[str] = "B"
    title: ClassVar[str] = "belt pair"
    table: ClassVar[str] = "belts"
    takes: ClassVar[tuple[str, ...]] = ("pretension", "friction", "efficiency")

    @property
    def turns_alike(self) -> bool:
        """Unless the belt is crossed."""
        return not self.crossed

    def reach(self, one: Number, two: Number, distance: Number) -> Number:
        """Return the radii; by teeth alone, radii that fit."""
        if self.teeth is None or self.radii is None:
            return 1.0 if self.teeth is None else super().reach(one, two, distance)
        return self.radii[0] / self.teeth[0]

    def strands(self, ends: Ends, poses: Poses) -> tuple[Wrench, Wrench]:
        """Return the wrench of a unit pull in each strand on the second pulley."""
        axes, radii = axes_of(ends, poses), self.circles(ends, poses)
        lines = (line_of_action(axes, radii, side) for side in (1.0, -1.0))
        one, two = (Wrench.at(there, (here - there) / np.abs(here - there)) for here, there, _ in lines)
        return one, two

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return a unit difference of the strands' pulls, half of it in each.

        No effort is along the coordinate: it is not that of these two links. Raises InvalidMechanism where only teeth
        are given, which do not tell the radii.
        """
        if self.radii is None and self.teeth is not None:
            what = "the pull of its strands depends on the radii, which teeth alone do not tell"
            raise InvalidMechanism(Problem(f"{self.table}.{self.name}.radii", what, "give radii = (..., ...) as well"))
        one, two = self.strands(ends, poses)
        return (one - two).times(0.5), Wrench()

    def transmitted(self, ends: Ends, poses: Poses, wrench: Wrench) -> Number:
        """Return the first strand's pull less the second's, by the moment about the second axis."""
        axis = axes_of(ends, poses)[1]
        return wrench.about(axis) / self.wrenches(ends, poses)[0].about(axis)

    def accompanying(self, ends: Ends, poses: Poses, transmitted: Number, pretension: Number | None = None) -> Wrench:
        """Return half the sum of both pulls in each strand, on the second pulley."""
        one, two = self.strands(ends, poses)
        pulls = self.pulls(transmitted, pretension)
        return (one + two).times((pulls[0] + pulls[1]) * 0.5)

    def pulls(self, transmitted: Number, pretension: Number | None = None) -> tuple[Number, Number]:
        """Return the pulls of both strands. A negative one says that the belt is slack.

        >>> [float(pull) for pull in belt("motor", "drum", radii=(30, 90)).pulls(-10.0)]
        [0.0, 10.0]
        """
        if pretension is None:
            return np.maximum(transmitted, 0.0)[()], np.maximum(0.0 - transmitted, 0.0)[()]
        return pretension + transmitted * 0.5, pretension - transmitted * 0.5

    def fits(self, geometry: Geometry) -> tuple[DimensionFit, ...]:
        """Return two axes that are apart, and pulleys that do not overlap."""
        least = 0.0 if self.radii is None else self.radii[0] + self.radii[1]
        what = f"{self.first_at} and {self.second_at} are too near to each other on {self.carrier!r} for the pulleys"
        remedy = "the distance of the axes must exceed both radii together"
        return (DimensionFit("radii", self.distance(geometry) - least, (what,), remedy),)

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the pulleys and the belt around them."""
        one, two = (abs(end.measure) for end in ends[:2])
        unit = self.reach(one, two, self.apart(ends, poses))
        radii = one * unit, two * unit
        back = poses[2].inverse()
        middles = [back.at(pose.at(end.point)).c[0] for pose, end in zip(poses[:2], ends[:2], strict=True)]
        # the carrier is rigid: they are where they are at every pose
        first, second = (known_range(np.real(middle))[0] + known_range(np.imag(middle))[0] * 1j for middle in middles)
        discs = (Wheel(k, ends[k].point, radii[k]) for k in range(2))
        return *discs, Strap(2, strap_line((first, second), radii, self.crossed))


belt = constructor("belt", Belt)
