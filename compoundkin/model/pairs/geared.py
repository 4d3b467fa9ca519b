"""What gears, belts and chains have in common: two links turn on a common carrier in a fixed ratio."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Number, Series
from compoundkin.model.fields import link_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contract import Ends, Pair, Point, Poses, table
from compoundkin.model.pairs.loop_terms import Auxiliary, LoopTerms
from compoundkin.model.pairs.loop_vectors import angle_of, difference
from compoundkin.model.pairs.optional_answers import DrawnPair, Osculation, Replaceable, TurnCounting, as_drivable
from compoundkin.model.pairs.symbols import reach
from compoundkin.model.pairs.wheel_lines import axes_of, line_of_action, ratio
from compoundkin.model.pairs.wheel_sizes import Sizes, Two, size_problems, two_of, wheel_problems


@dataclass(frozen=True, eq=False)
class Geared(TurnCounting, Replaceable):
    """Links `first` and `second`, which turn on the link `carrier` in a fixed ratio.

    An axis is the point that a link shares with the carrier; `first_at` and `second_at` name it where there are
    several. The ratio is that of `teeth` or of `radii`, numbers for first and second. With both angles taken from
    the carrier, ``second = phase - ratio * first`` where `ratio` is `sizes` one over the other, negative for wheels
    that turn alike; `phase` (radians) is read off the drawing where it is not stated, or zero.

    Held: that sum of angles. Free: the angle of the first from the carrier. Source: e.g. R. L. Norton, Design of
    Machinery, chapter 9 (gear trains by Willis's equation).
    """

    first: str = field(metadata=link_key("The link with the first wheel."))
    second: str = field(metadata=link_key("The link with the second wheel."))
    _: KW_ONLY
    carrier: str = field(default="frame", metadata=link_key("The link that carries both axes."))
    teeth: Sizes = field(default=None, metadata=value_key("two", "Numbers of teeth of the two wheels."))
    radii: Sizes = field(default=None, metadata=value_key("two", "Radii of the wheels, of pitch circles for gears."))
    phase: Number | None = field(
        default=None,
        metadata=value_key("angle", "Angle of the second from the carrier where that of the first is zero."),
    )
    first_at: str = field(
        default="",
        metadata=value_key("name", "The axis of the first link, where it shares several points with the carrier."),
    )
    second_at: str = field(
        default="",
        metadata=value_key("name", "The axis of the second link, where it shares several points with the carrier."),
    )

    held: ClassVar[int] = 1
    held_angles: ClassVar[tuple[int, ...]] = (0,)
    free: ClassVar[tuple[str, ...]] = ("angle",)
    free_is_angle: ClassVar[bool] = True

    def __post_init__(self) -> None:
        """Two sizes are numbers or arrays."""
        super().__post_init__()
        for name in ("teeth", "radii"):
            object.__setattr__(self, name, two_of(name, getattr(self, name)))

    @property
    def turns_alike(self) -> bool:
        """Whether, seen from the carrier, both wheels turn in one direction."""
        raise NotImplementedError

    @property
    def members(self) -> tuple[str, ...]:
        """The two wheels and their carrier."""
        return self.first, self.second, self.carrier

    @property
    def letters(self) -> tuple[str, ...]:
        """The axes of the two wheels."""
        return self.first_at, self.second_at

    @property
    def sizes(self) -> Two:
        """The two numbers whose ratio counts, the second negative for wheels that turn alike."""
        one, two = self.teeth or self.radii or (1.0, 1.0)
        return one, -two if self.turns_alike else two

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links, one link twice, axes the carrier lacks, sizes that are none."""
        yield from wheel_problems(links, self.members, self.letters, where)
        yield from size_problems(self.teeth, self.radii, where)

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> Geared:
        """Return the pair with axes found. An unnamed one is the only point its wheel shares with the carrier."""
        found: dict[str, Any] = {}
        for key, name in (("first_at", self.first), ("second_at", self.second)):
            shared = [letter for letter in links.get(name, ()) if letter in links.get(self.carrier, ())]
            if not getattr(self, key) and len(shared) == 1:
                found[key] = shared[0]
        return replace(self, **found) if found else self

    @property
    def axes(self) -> str:
        """Where its axes are, in words."""
        return f"{self.first_at} and {self.second_at} on {self.carrier!r}"

    def distance(self, geometry: Geometry) -> Number:
        """Return the distance between the two axes on the carrier."""
        axes = geometry.points[self.carrier]
        return np.abs(axes[self.second_at] - axes[self.first_at])

    def ends(self, geometry: Geometry) -> Ends:
        """Return axes and sizes on wheels; the phase on the carrier. A drawing of all three links tells it."""
        one, two = self.sizes
        first = End(geometry.points[self.first][self.first_at], None, one)
        second = End(geometry.points[self.second][self.second_at], None, two)
        return first, second, End(geometry.points[self.carrier][self.first_at], None, self._phase(geometry))

    def _phase(self, geometry: Geometry) -> Number:
        if self.phase is not None or any(name not in geometry.drawn for name in self.members):
            return 0.0 if self.phase is None else self.phase
        first, second, carrier = (geometry.drawn[name].angle.c[0] for name in self.members)
        one, two = self.sizes
        return (second - carrier) + (first - carrier) * (one / two)

    def drawn_angle(self, seen: DrawnPair, own: int) -> Number | None:
        """Return the second wheel's angle. The first one's may be any of several: no angle is drawn with its turns."""
        first, _, carrier = seen.poses
        if own != 1 or first is None or carrier is None:
            return None
        return carrier.angle.c[0] + seen.ends[2].measure - ratio(seen.ends) * (first.angle - carrier.angle).c[0]

    def with_link_turns(self, ends: Ends, geometry: Geometry, turns: tuple[Number, ...]) -> Ends:
        """Return the ends with a drawn phase taken on by turns since. The turns are those of wheels and carrier."""
        if self.phase is not None or any(name not in geometry.drawn for name in self.members):
            return ends
        one, two, carrier = turns
        ahead = 2.0 * np.pi * ((two - carrier) + (one - carrier) * ratio(ends))
        return *ends[:2], ends[2]._replace(measure=ends[2].measure + ahead)

    def closure(self, ends: Ends, poses: Poses) -> tuple[Series, ...]:
        """Return the angle of the second wheel ahead of its turn by the first."""
        first, second, carrier = (pose.angle for pose in poses)
        return ((second - carrier) + (first - carrier) * ratio(ends) - ends[2].measure,)

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the angle of the first wheel from the carrier."""
        return poses[0].angle - poses[2].angle

    def jacobian(self, ends: Ends, poses: Poses) -> Number:
        """Return the rows of the sum of angles and of the first angle."""
        turned = ratio(ends)
        return table(
            (0.0, 0.0, turned, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0 - turned),
            (0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0),
        )

    def centre(self, ends: Ends, poses: Poses) -> Point:
        """Return the pitch point, which divides the line of axes. Equal wheels that turn alike have it at infinity."""
        one, two = ends[0].measure, ends[1].measure
        first, second = axes_of(ends, poses)
        place = first * two + second * one
        return Point(-place.real / two, -place.imag / two, -(one + two) / two)

    def loop_terms(self, ends: Ends) -> LoopTerms:
        """Return the angles that it ties; no loop runs through it."""
        first, second, carrier = (angle_of(name) for name in self.members)
        turned = difference(carrier, first).times(-ratio(ends))
        tied = difference(turned, difference(carrier, second)).plus(-ends[2].measure)
        equation = Auxiliary(self.name, tied, counts_turns=True)
        return LoopTerms(
            (ends[0].point, ends[1].point), (self.first_at, self.second_at), equations=(equation,), is_crossed=False
        )

    def reach(self, one: Number, two: Number, distance: Number) -> Number:
        """Return the factors from the sizes to radii of circles. The line of action touches these circles."""
        return distance / (2.0 * (np.abs(one) + np.abs(two)))

    def circles(self, ends: Ends, poses: Poses) -> tuple[Number, Number]:
        """Return the radii of the circles that a line of action touches.

        The second is negative for outer tangents.
        """
        first, second = axes_of(ends, poses)
        one, two = (end.measure for end in ends[:2])
        reach = self.reach(one, two, np.abs(second - first))
        return one * reach, two * reach

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """Return where the line of action touches the circles about the axes. It is of involutes or of a belt."""
        line = line_of_action(axes_of(ends, poses), self.circles(ends, poses))
        return Osculation(line.first, line.second, line.across * 1j)

    def is_affine(self, lower: Pair, own: int) -> bool:
        """Tell whether a pair is a pin: there any member turns in proportion."""
        return lower.free_is_angle and as_drivable(lower) is not None

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw axes at random places. The ratio stays as it is: it may make a train lock."""
        one, two = (float(first_entry(size)) for size in self.sizes)
        places = (complex(*rng.standard_normal(2)) for _ in range(2))
        return *(End(place, None, size) for place, size in zip(places, (one, two), strict=True)), End(0j, None, 0.0)

    @property
    def rank_key(self) -> Hashable:
        """The kind and the ratio."""
        one, two = (float(first_entry(size)) for size in self.sizes)
        return type(self), one / two

    def apart(self, ends: Ends, poses: Poses) -> float:
        """Return the distance of the axes, the same at all poses."""
        first, second = axes_of(ends, poses)
        return reach(abs(second - first))[0]


def as_geared(pair: Pair) -> Geared | None:
    """Return a pair as one whose closure is a sum of angles, or None. The angles are its members', times constants."""
    return pair if isinstance(pair, Geared) else None
