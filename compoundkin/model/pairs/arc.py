"""The pin in a circular slot: a point of one link keeps its distance from a point of another."""

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
from compoundkin.model.pairs.revolute import Revolute
from compoundkin.model.pairs.symbols import Groove, Mark, Stud, arc_line, reach


@dataclass(frozen=True, eq=False)
class ArcSlot(Contact):
    """The point `at` of `link` runs along a circular slot in the link `on`: on the circle of `radius` about `centre`.

    A roller on a round disc is the same with the sum of both radii. Held: the distance of the pin from the circle.
    Free: the angle at which the pin is seen from the centre, from the x axis of `on`, and the angle between the links.
    """

    name: str
    link: str
    on: str
    at: str
    centre_at: str
    radius: Number = 1.0

    code: ClassVar[str] = "A"
    title: ClassVar[str] = "pin-in-arc pair"
    free: ClassVar[tuple[str, ...]] = ("direction", "angle")
    free_is_angle: ClassVar[bool] = True
    table: ClassVar[str] = "arcs"
    keys: ClassVar[tuple[Key, ...]] = (
        Key("name", "name", "What the pair is called in reports; LINK/ON where it is left out."),
        Key("link", "name", "The link with the pin.", required=True),
        Key("on", "name", "The link with the circular slot.", required=True),
        Key("at", "name", "The pin's point; may be left out if its link has one point."),
        Key("centre_at", "name", "The point of the slotted link about which the slot is curved.", required=True),
        Key("radius", "length", "Radius of the circle on which the middle of the pin runs.", required=True),
    )

    @property
    def letters(self) -> tuple[str, ...]:
        """The pin and the centre of its circle."""
        return self.at, self.centre_at

    def problems(self, links: Mapping[str, tuple[str, ...]], where: str) -> Iterator[Problem]:
        """Unknown links and points, a radius that is none."""
        points = {"at": (self.link, self.at), "centre_at": (self.on, self.centre_at)}
        yield from named_problems(links, where, {"link": self.link, "on": self.on}, points)
        if not np.all(np.asarray(self.radius) > 0):
            yield Problem(f"{where}.radius", f"{self.radius!r} is not a positive length")

    def completed(self, links: Mapping[str, tuple[str, ...]]) -> ArcSlot:
        """With the only point of its link as the pin, where none is named."""
        points = links.get(self.link, ())
        return replace(self, at=points[0]) if not self.at and len(points) == 1 else self

    def ends(self, geometry: Geometry) -> Ends:
        """The centre with the radius; the pin."""
        centre = geometry.points[self.on][self.centre_at]
        return End(centre, 1 + 0j, self.radius), End(geometry.points[self.link][self.at])

    def touch(self, ends: Ends, poses: Poses) -> Touch:
        """At the pin, in the direction from the centre."""
        pin = poses[1].at(ends[1].point)
        arm = pin - poses[0].at(ends[0].point)
        length = arm.abs2().sqrt()
        return Touch(pin, arm / length, length - ends[0].measure)

    def sliding(self, ends: Ends, poses: Poses) -> tuple[Number, ...]:
        """The pin passes along the circle, by its distance from the centre."""
        pin = poses[1].at(ends[1].point).c[0]
        arm = pin - poses[0].at(ends[0].point).c[0]
        return row(poses, pin, 1j * arm / np.abs(arm) ** 2)

    def coordinate(self, ends: Ends, poses: Poses) -> Series:
        """The direction from the centre to the pin."""
        arm = poses[1].at(ends[1].point) - poses[0].at(ends[0].point)
        return (arm.unit() * poses[0].carry(ends[0]).along.conj()).angle()

    def equivalent(self, ends: Ends) -> Equivalent:
        """A bar from the centre to the pin."""
        bar = f"{self.name} (bar)"
        pairs = (
            Revolute(f"{self.name} (centre)", self.centre_at, self.on, bar),
            Revolute(f"{self.name} (pin)", self.at, bar, self.link),
        )
        far = End(ends[0].measure + 0j)
        return Equivalent(bar, pairs, {pairs[0].name: (End(ends[0].point), End(0j)), pairs[1].name: (far, ends[1])})

    def osculation(self, ends: Ends, poses: Poses) -> Osculation:
        """The middle of the circle, and the pin."""
        centre, pin = (pose.at(end.point).c[0] for pose, end in zip(poses, ends, strict=True))
        return Osculation(centre, pin, (pin - centre) / np.abs(pin - centre))

    def generic(self, rng: np.random.Generator) -> Ends:
        """A random circle with the pin somewhere on it."""
        centre, arm = complex(*rng.standard_normal(2)), complex(*rng.standard_normal(2))
        return End(centre, 1 + 0j, abs(arm)), End(centre + arm)

    def round_at(self, link: str) -> str | None:
        """The pin may turn in the slot, and the slot about its centre."""
        return self.at if link == self.link else self.centre_at

    def glyph(self, ends: Ends, poses: Poses) -> tuple[Mark, ...]:
        """A groove as long as the pin's way, and the pin."""
        way = reach(np.unwrap(np.ravel(self.coordinate(ends, poses).c[0])))
        return Groove(0, arc_line(ends[0].point, ends[0].measure, *way)), Stud(1, ends[1].point)


def arc(link: str, *, on: str, centre_at: str, radius: Number, at: str = "", name: str = "") -> ArcSlot:
    """A pin in a circular slot: the point `at` of `link` keeps its distance from the point `centre_at` of `on`.

    >>> arc("rocker", on="frame", at="B", centre_at="C", radius=40).letters
    ('B', 'C')
    """
    return ArcSlot(name or f"{link}/{on}", link, on, at, centre_at, radius)
