"""The revolute pair: two links pinned at a point that both carry under the same letter."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End, Pose
from compoundkin.base.series import Series, as_series
from compoundkin.base.wrenches import Wrench
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import FrictionPin
from compoundkin.model.pairs.contract import Drivable, Ends, Point, Poses, jacobian_of_rows
from compoundkin.model.pairs.symbols import Mark, Pin

if TYPE_CHECKING:
    from compoundkin.model.pairs.loop_terms import LoopTerms

# At a multiple pin the first that occurs in no name of its links joins two of them, so that pair names are unique.
SEPARATORS = ("-", "/", ":", " to ", " - ")


@dataclass(frozen=True)
class Revolute(FrictionPin, Drivable):
    """A pin at the letter `at` between the links `first` and `second`.

    Held: the distance in x and in y between the two sides of the pin. Free: the angle from first to second.
    """

    name: str = field()
    at: str
    first: str
    second: str

    code: ClassVar[str] = "R"
    title: ClassVar[str] = "revolute pair"
    held: ClassVar[int] = 2
    free: ClassVar[tuple[str, ...]] = ("angle",)
    free_is_angle: ClassVar[bool] = True
    is_simple: ClassVar[bool] = True

    @property
    def members(self) -> tuple[str, ...]:
        """The two links."""
        return self.first, self.second

    @property
    def letters(self) -> tuple[str, ...]:
        """The letter of the pin."""
        return (self.at,)

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find no problems: a pin exists only where two links share a letter."""
        return iter(())

    def ends(self, geometry: Geometry) -> Ends:
        """Return the pin on each link."""
        return End(geometry.points[self.first][self.at]), End(geometry.points[self.second][self.at])

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the gap in x, the gap in y."""
        gap = poses[1].at(ends[1].point) - poses[0].at(ends[0].point)
        return gap.real, gap.imag

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the angle from the first link to the second."""
        first, second = poses
        if first.theta is not None and second.theta is not None:
            return second.theta - first.theta
        return (second.u * first.u.conj()).angle()

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of gap x, gap y and angle."""
        arm = [pose.u.c[0] * as_series(end.point).c[0] for pose, end in zip(poses, ends, strict=True)]
        return jacobian_of_rows(
            (-1.0, 0.0, arm[0].imag, 1.0, 0.0, -arm[1].imag),
            (0.0, -1.0, -arm[0].real, 0.0, 1.0, arm[1].real),
            (0.0, 0.0, -1.0, 0.0, 0.0, 1.0),
        )

    def wrenches(self, ends: Ends, poses: Poses) -> tuple[Wrench, ...]:
        """Return forces in x and in y at the pin, and a couple."""
        pin = poses[0].at(ends[0].point).c[0]
        return Wrench.at(pin, 1.0 + 0j), Wrench.at(pin, 1j), Wrench(0j, 1.0)

    def centre(self, ends: Ends, poses: Poses) -> Point:
        """Return the pin."""
        pin = poses[0].at(ends[0].point).c[0]
        return Point(pin.real, pin.imag, 1.0)

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the pin, through which a loop passes."""
        from compoundkin.model.pairs.loop_terms import LoopTerms

        return LoopTerms((ends[0].point, ends[1].point), (self.at, self.at))

    def placed(self, ends: Ends, free: Series) -> Pose:
        """Return the second link turned about the pin by the given angle."""
        u = free.turn()
        return Pose(Pose(as_series(ends[0].point), u).at(-ends[1].point), u, free)

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw a pin at a random place."""
        pin = complex(*rng.standard_normal(2))
        return End(pin), End(pin)

    def driven_by(self, link: str) -> int:
        """Return the angle of the driven link from the other one."""
        return 1 if link == self.second else -1

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return a pin."""
        return (Pin(0, ends[0].point),)
