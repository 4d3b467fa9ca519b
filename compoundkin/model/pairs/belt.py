"""The belt, chain or cable pair: two pulleys on a carrier, joined by an open or a crossed belt that does not slip."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.errors import Problem
from compoundkin.base.series import Number
from compoundkin.model.fields import Key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Poses
from compoundkin.model.pairs.geared import Geared, two_of
from compoundkin.model.pairs.symbols import Mark, Strap, Wheel, strap_line


@dataclass(frozen=True, eq=False)
class Belt(Geared):
    """Two pulleys or sprockets joined by a belt, chain or cable that does not slip.

    An open belt turns them alike, a `crossed` one does not. See `Geared` for the rest.
    """

    crossed: bool = False

    code: ClassVar[str] = "B"
    title: ClassVar[str] = "belt pair"
    table: ClassVar[str] = "belts"
    keys: ClassVar[tuple[Key, ...]] = (
        *Geared.keys,
        Key("crossed", "flag", "Whether the belt is crossed: the pulleys turn against each other.", default=False),
    )  # fmt: skip

    @property
    def turns_alike(self) -> bool:
        """Unless the belt is crossed."""
        return not self.crossed

    def reach(self, one: Number, two: Number, distance: Number) -> Number:
        """The radii as they are; by teeth alone, some that fit."""
        return 1.0 if self.teeth is None else super().reach(one, two, distance)

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Axes that coincide, and pulleys that overlap."""
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
        """The pulleys and the belt around them."""
        one, two = (abs(float(end.measure)) for end in ends[:2])
        unit = float(self.reach(one, two, self.apart(ends, poses)))
        radii = one * unit, two * unit
        back = poses[2].inverse()
        middles = [back.at(pose.at(end.point)).c[0] for pose, end in zip(poses[:2], ends[:2], strict=True)]
        first, second = (complex(np.ravel(middle)[0]) for middle in middles)
        discs = (Wheel(k, ends[k].point, radii[k]) for k in range(2))
        return *discs, Strap(2, strap_line((first, second), radii, self.crossed))


def belt(
    first: str,
    second: str,
    *,
    carrier: str = "frame",
    radii: Any = None,
    teeth: Any = None,
    crossed: bool = False,
    phase: Number | None = None,
    first_at: str = "",
    second_at: str = "",
    name: str = "",
) -> Belt:
    """A belt pair: pulleys on `first` and `second`, two `radii` (or two `teeth`), their axes carried by `carrier`.

    >>> belt("motor", "drum", radii=(30, 90)).turns_alike
    True
    """
    sizes = two_of("teeth", teeth), two_of("radii", radii)
    return Belt(name or f"{first}/{second}", first, second, carrier, *sizes, phase, first_at, second_at, crossed)
