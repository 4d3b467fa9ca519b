"""The pin in a slot: a point of one link runs along a straight slot in another, free to turn in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from compoundkin.base.errors import Problem
from compoundkin.base.poses import End
from compoundkin.base.series import Number, Series
from compoundkin.model.fields import Key
from compoundkin.model.geometry import Geometry
from compoundkin.model.pairs.contact import Contact, Touch, named_problems, row
from compoundkin.model.pairs.contract import Ends, Equivalent, Osculation, Poses
from compoundkin.model.pairs.prismatic import Prismatic
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.symbols import Groove, Mark, Stud, reach


@dataclass(frozen=True, eq=False)
class Slot(Contact):
    """The point `at` of `link` runs along a straight slot in the link `on`.

    The slot is the line through the point `through` of `on`, in the direction `angle` (radians, from the x axis of
    `on`) or toward the point `toward`, moved `offset` to the left of that direction. A flat face that runs on a round
    disc is the slot of the disc's middle, offset by its radius.

    Held: the distance of the pin from the middle of the slot. Free: the displacement from `through` along the slot, and
    the angle.
    """

    name: str
    link: str
    on: str
    at: str
    through: str
    angle: Number = 0.0
    toward: str | None = None
    offset: Number = 0.0

    code: ClassVar[str] = "S"
    title: ClassVar[str] = "pin-in-slot pair"
    free: ClassVar[tuple[str, ...]] = ("displacement", "angle")
    free_is_angle: ClassVar[bool] = False
    table: ClassVar[str] = "slots"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("name", "name", "What the pair is called in reports; LINK/ON where it is left out."),
        Key("link", "name", "The link with the pin.", required=True),
        Key("on", "name", "The link with the slot.", required=True),
        Key("at", "name", "The pin's point; may be left out if its link has one point."),
        Key("through", "name", "A point of the slotted link in the slot.", required=True),
        Key("angle", "angle", "Direction of the slot from the x axis of its link.", default=0.0),
        Key("toward", "name", "A second point of the slotted link in the slot, instead of an angle."),
        Key("offset", "length", "Distance by which the slot lies to the left of `through`.", default=0.0),
    )

    @property
    def letters(self) -> tuple[str, ...]:
        """The pin and the points that fix the slot."""
        return (self.at, self.through) if self.toward is None else (self.at, self.through, self.toward)

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Unknown links and points, a slot without direction."""
        points = {"at": (self.link, self.at), "through": (self.on, self.through)}
        if self.toward is not None:
            points["toward"] = (self.on, self.toward)
        yield from named_problems(links, where, {"link": self.link, "on": self.on}, points)
        if self.toward == self.through:
            yield Problem(f"{where}.toward", f"a slot from {self.through!r} to itself has no direction")

    def misfits(self, geometry: Geometry, where: str) -> Iterator[Problem]:
        """Two points of the slot at one place."""
        points = geometry.points[self.on]
        if self.toward is not None and not np.all(np.abs(points[self.toward] - points[self.through]) > 0):
            what = f"{self.through!r} and {self.toward!r} are at one place, so that the slot has no direction"
            yield Problem(f"{where}.toward", what, "name another point or give an angle")

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> Slot:
        """With the only point of its link as the pin, where none is named."""
        points = links.get(self.link, ())
        return replace(self, at=points[0]) if not self.at and len(points) == 1 else self

    def ends(self, geometry: Geometry) -> Ends:
        """A point and the direction of the slot; the pin."""
        points = geometry.points[self.on]
        start = points[self.through]
        if self.toward is None:
            along = np.cos(self.angle) + 1j * np.sin(self.angle)
        else:
            along = (points[self.toward] - start) / np.abs(points[self.toward] - start)
        return End(start + 1j * along * self.offset, along), End(geometry.points[self.link][self.at])

    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """At the pin, across the slot."""
        slot, pin = poses[0].carry(ends[0]), poses[1].at(ends[1].point)
        return Touch(pin, slot.along * 1j, slot.along.cross(pin - slot.point))

    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """The pin passes along the slot."""
        return row(poses, poses[1].at(ends[1].point).c[0], poses[0].carry(ends[0]).along.c[0])

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """The displacement along the slot."""
        slot, pin = poses[0].carry(ends[0]), poses[1].at(ends[1].point)
        return slot.along.dot(pin - slot.point)

    def equivalent(self, ends: Ends) -> Equivalent:
        """A block in the slot, pinned to the other link."""
        block = f"{self.name} (block)"
        pairs = (
            Prismatic(f"{self.name} (slide)", block, self.on, self.at, self.through),
            Revolute(f"{self.name} (pin)", self.at, block, self.link),
        )
        return Equivalent(block, pairs, {pairs[0].name: (ends[0], End(0j, 1 + 0j)), pairs[1].name: (End(0j), ends[1])})

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """The slot is straight, the pin round."""
        return Osculation(None, poses[1].at(ends[1].point).c[0], poses[0].carry(ends[0]).along.c[0] * 1j)

    def generic(self, rng: np.random.Generator) -> Ends:
        """A slot in a random direction, the pin somewhere in it."""
        angle = rng.uniform(0.0, 2.0 * np.pi)
        along = complex(np.cos(angle), np.sin(angle))
        start = complex(*rng.standard_normal(2))
        return End(start, along), End(start + along * rng.standard_normal())

    def round_at(self, link: str) -> str | None:
        """The pin may turn in the slot."""
        return self.at if link == self.link else None

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """A groove as long as the pin's way, and the pin."""
        travel = np.linspace(*reach(self.coordinate(ends, poses).c[0]), 2)
        return Groove(0, ends[0].point + ends[0].along.c[0] * travel), Stud(1, ends[1].point)


def slot(
    link: str,
    *,
    on: str,
    through: str,
    at: str = "",
    angle: Number = 0.0,
    toward: str | None = None,
    offset: Number = 0.0,
    name: str = "",
) -> Slot:
    """A pin in a slot: the point `at` of `link` runs along a straight slot in the link `on`.

    `angle` in radians, `offset` a length; numbers or arrays. See `Slot` for their meaning.

    >>> slot("crank", on="arm", at="B", through="C").name
    'crank/arm'
    """
    return Slot(name or f"{link}/{on}", link, on, at, through, angle, toward, offset)
