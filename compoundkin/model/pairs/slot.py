"""The pin in a slot: a point of one link runs along a straight slot in another, free to turn in it.

It is also the remainder of a slide, or of a pin, with a redundant constraint released.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import ClassVar, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.errors import Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Series
from compoundkin.model.fields import constructor, link_key, point_key, value_key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import FrictionContact, Touch, passing_rates
from compoundkin.model.pairs.contract import Ends, Equivalent, Guided, Osculation, Pair, Poses, StraightLine
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.symbols import Groove, Mark, Stud, known_range, point_array
from compoundkin.model.pairs.travel_limits import Reach, TravelLimited, reach_key


@dataclass(frozen=True, eq=False)
class Slot(FrictionContact, Guided, TravelLimited, StraightLine):
    """The point `at` of `link` runs along a straight slot in the link `on`.

    The slot is the line through the point `through` of `on`, in the direction `angle` (radians, from the x axis of
    `on`) or toward the point `toward`, moved `offset` to the left of that direction. A flat face that runs on a round
    disc is the slot of the disc's middle, offset by its radius.

    Held: the distance of the pin from the middle of the slot. Free: the displacement from `through` along the slot, and
    the angle.

    >>> slot("crank", on="arm", at="B", through="C").name
    'crank/arm'
    """

    link: str = field(metadata=link_key("The link with the pin."))
    _: KW_ONLY
    on: str = field(metadata=link_key("The link with the slot."))
    at: str = field(
        default="", metadata=point_key("link", "The pin's point; may be left out if its link has one point.")
    )
    through: str = field(metadata=point_key("on", "A point of the slotted link in the slot."))
    angle: Number = field(
        default=0.0, metadata=value_key("angle", "Direction of the slot from the x axis of its link.")
    )
    toward: str | None = field(
        default=None, metadata=point_key("on", "A second point of the slotted link in the slot, instead of an angle.")
    )
    offset: Number = field(
        default=0.0, metadata=value_key("length", "Distance by which the slot lies to the left of `through`.")
    )
    reach: Reach = field(default=None, metadata=reach_key("reach", "From where to where the pin may go."))

    code: ClassVar[str] = "S"
    title: ClassVar[str] = "pin-in-slot pair"
    free: ClassVar[tuple[str, ...]] = ("displacement", "angle")
    free_is_angle: ClassVar[bool] = False
    table: ClassVar[str] = "slots"
    line_word: ClassVar[str] = "slot"
    takes: ClassVar[tuple[str, ...]] = ("effort", "friction")

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Find unknown links and points, a slot without direction."""
        yield from super().problems(links, where)
        yield from self.reach_problems(links, where)

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Find two coincident points of the slot, and travel limits in the wrong order."""
        problems = list(self.line_problems(geometry, where))
        yield from problems or self.reach_misfits(geometry, where)

    def ends(self, geometry: Geometry) -> Ends:
        """Return a point and the direction of the slot; the pin."""
        start, along = self.line(geometry)
        return End(start + 1j * along * self.offset, along), End(geometry.points[self.link][self.at])

    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """Return the contact at the pin, across the slot."""
        slot, pin = poses[0].carry(ends[0]), poses[1].at(ends[1].point)
        return Touch(pin, slot.along * 1j, slot.along.cross(pin - slot.point))

    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """Return the row of the pin along the slot."""
        return passing_rates(poses, poses[1].at(ends[1].point).c[0], poses[0].carry(ends[0]).along.c[0])

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """Return the displacement along the slot."""
        slot, pin = poses[0].carry(ends[0]), poses[1].at(ends[1].point)
        return slot.along.dot(pin - slot.point)

    def equivalent(self, ends: Ends) -> Equivalent:
        """Return a block in the slot, pinned to the other link."""
        block = f"{self.name} (block)"
        pairs = (
            Prismatic(block, on=self.on, at=self.at, through=self.through, name=f"{self.name} (slide)"),
            Revolute(f"{self.name} (pin)", self.at, block, self.link),
        )
        return Equivalent(block, pairs, {pairs[0].name: (ends[0], End(0j, 1 + 0j)), pairs[1].name: (End(0j), ends[1])})

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """Return the straight slot and the round pin."""
        return Osculation(None, poses[1].at(ends[1].point).c[0], poses[0].carry(ends[0]).along.c[0] * 1j)

    def generic(self, rng: np.random.Generator) -> Ends:
        """Draw a slot in a random direction, the pin somewhere in it."""
        angle = rng.uniform(0.0, 2.0 * np.pi)
        along = complex(np.cos(angle), np.sin(angle))
        start = complex(*rng.standard_normal(2))
        return End(start, along), End(start + along * rng.standard_normal())

    def round_at(self, link: str) -> str | None:
        """Return the pin, which may turn in the slot."""
        return self.at if link == self.link else None

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """Return a groove as long as the pin's path, and the pin."""
        return Groove(0, _centre_line(ends, *known_range(self.coordinate(ends, poses).c[0]))), Stud(1, ends[1].point)

    def with_ends(
        self, marks: tuple[Mark, ...], bounds: tuple[Number, Number], ends: Ends, poses: Poses
    ) -> tuple[Mark, ...]:
        """Return the whole groove, and the pin."""
        low, high, stops = self.drawn_extent(bounds, self.coordinate(ends, poses).c[0])
        return (Groove(0, _centre_line(ends, low, high), stops), *marks[1:])


def _centre_line(ends: Ends, low: float, high: float) -> Number:
    """Return the centre line of a slot, as far as it is used."""
    return point_array(ends[0].point + ends[0].along.c[0] * place for place in (low, high))


def slot_with_ends(pair: Pair) -> TravelLimited | None:
    """Return a pair as a pin in a slot that has ends, or None."""
    return pair if isinstance(pair, Slot) and pair.reach is not None else None


def letter_in_slot(pair: Pair, link: str) -> str:
    """Return the point of a link that a slot has: of its line, or its pin."""
    assert isinstance(pair, Slot)
    return pair.at if link == pair.link else pair.through


def slot_elsewhere(pair: Pair, link: str, letter: str, turned: complex, geometry: Geometry) -> Pair:
    """Return a slot at another point of one of its links: its line, turned by a unit vector, or its pin."""
    assert isinstance(pair, Slot)
    if link == pair.link:
        return replace(pair, at=letter)
    low, high = (float(np.ravel(one)[0]) for one in pair.bounds(geometry))
    reach = (low if np.isfinite(low) else None, high if np.isfinite(high) else None)
    angle = float(np.angle(complex(pair.line(geometry)[1]) * turned))
    return replace(pair, through=letter, angle=angle, toward=None, reach=reach)


slot = constructor("slot", Slot)


class ReleasedPair(NamedTuple):
    """A pair with some held coordinates released: their indices, their name in words, and the remaining pair."""

    coordinates: tuple[int, ...]
    freed: str
    kept: Pair | None


@dataclass(frozen=True, eq=False)
class TurningBlock(Slot):
    """A slide whose block may turn: its point still runs along the guide."""

    slide: Prismatic | None = field(default=None, kw_only=True)

    def ends(self, geometry: Geometry) -> Ends:
        """Return the guide as the slide has it; the point that slides. Offsets read off a drawing are included."""
        assert self.slide is not None
        guide, block = self.slide.ends(geometry)
        return guide, End(block.point)


def releases(pair: Pair) -> Iterator[ReleasedPair]:
    """Yield the possible releases of a pair's held coordinates, the smallest first.

    >>> from compoundkin.model.pairs.prismatic import slide
    >>> [(way.coordinates, way.freed) for way in releases(slide("w", on="v", at="A", through="B"))]
    [((1,), 'in turning'), ((0, 1), 'as a whole')]
    """
    if isinstance(pair, Prismatic):
        words = {name: getattr(pair, name) for name in ("link", "on", "at", "through", "angle", "toward")}
        yield ReleasedPair((1,), "in turning", TurningBlock(**words, name=f"{pair.name} (turning)", slide=pair))
    yield ReleasedPair(tuple(range(pair.held)), "as a whole", None)


def pin_in_slot(letter: str, pinned: str, slotted: str, through: str) -> Pair:
    """Return a pin that may move along a line. The line goes from another point of one of its links.

    >>> pin_in_slot("E", "coupler", "crank", "D").letters
    ('E', 'D', 'E')
    """
    name = f"{letter}({pinned} in {slotted})"
    return Slot(pinned, on=slotted, at=letter, through=through, toward=letter, name=name)
