"""The belt, chain or cable pair: two pulleys on a carrier, joined by an open or a crossed belt that does not slip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass, field
from typing import ClassVar

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.errors import Problem
from compoundkin.base.series import Number
from compoundkin.model.fields import value_key, word
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Poses
from compoundkin.model.pairs.geared import Geared
from compoundkin.model.pairs.symbols import Mark, Strap, Wheel, strap_line


@dataclass(frozen=True, eq=False)
class Belt(Geared):
    """Two pulleys or sprockets with a belt, chain or cable that does not slip.

    An open belt turns them alike, a `crossed` one does not. See `Geared` for the rest.

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
    takes: ClassVar[tuple[str, ...]] = ("pretension",)

    @property
    def turns_alike(self) -> bool:
        """Unless the belt is crossed."""
        return not self.crossed

    def reach(self, one: Number, two: Number, distance: Number) -> Number:
        """Return the radii as they are; by teeth alone, some that fit."""
        return 1.0 if self.teeth is None else super().reach(one, two, distance)

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find axes that coincide, and pulleys that overlap."""
        distance = self.distance(geometry)
        if self.radii is None and np.all(distance > 0):
            return
        least = 0.0 if self.radii is None else np.asarray(self.radii[0]) + np.asarray(self.radii[1])
        if not np.all(distance > least):
            what = (
                f"{self.first_at} and {self.second_at} are too near to each other on {self.carrier!r} for the pulleys"
            )
            yield Problem(f"{where}.radii", what, "the distance of the axes must exceed both radii together")

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return the pulleys and the belt around them."""
        one, two = (abs(float(end.measure)) for end in ends[:2])
        unit = float(self.reach(one, two, self.apart(ends, poses)))
        radii = one * unit, two * unit
        back = poses[2].inverse()
        middles = [back.at(pose.at(end.point)).c[0] for pose, end in zip(poses[:2], ends[:2], strict=True)]
        first, second = (complex(first_entry(middle)) for middle in middles)
        discs = (Wheel(k, ends[k].point, radii[k]) for k in range(2))
        return *discs, Strap(2, strap_line((first, second), radii, self.crossed))


belt = word("belt", Belt)
