"""Where the links of a construction are: each body by one point that is known, and the angle of its axes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.pair_sides import NamedEnd
from compoundkin.files.exchange.geogebra.point_dimensions import LinkPoints
from compoundkin.files.exchange.geogebra.polar_sums import Angle, Way, at
from compoundkin.structure.mobility_count import Body


class InsideBody(NamedTuple):
    """Where a link is in its body's axes, from the base's first point on."""

    offset: Way
    angle: Angle


class Held(NamedTuple):
    """A known body: its place `own` is at the point `at`, turned by `angle`."""

    at: str
    own: Way
    angle: Angle


class PlacedBodies:
    """The bodies placed so far; the frame's are from the beginning."""

    def __init__(self, build: Construction, links: Mapping[str, LinkPoints]) -> None:
        self.build, self._links = build, links
        self._body: dict[str, str] = {}
        self._inside: dict[str, InsideBody] = {}
        self._held: dict[str, Held | None] = {}
        self.points: dict[str, str] = {}

    def join(self, body: Body, inside: Mapping[str, InsideBody]) -> None:
        """Note the links of a body."""
        for name in body.links:
            self._body[name], self._inside[name] = body.links[0], inside[name]

    def hold(self, body: Body, held: Held | None) -> None:
        """Note where a body is, None for the frame; add its links' points."""
        self._held[body.links[0]] = held
        for name in body.links:
            for letter, way in self._links[name].ways.items() if name in self._links else ():
                if letter not in self.points:
                    self.points[letter] = self._point(letter, self.place(name, way))

    def _point(self, letter: str, place: Way) -> str:
        return place.point if place.point and self._is_own(letter, place) else self.build.point(letter, place.text)

    def _is_own(self, letter: str, place: Way) -> bool:
        """Whether a place is the very point, not another one at the same place."""
        return place.point is not None and place.point not in self.points.values()

    def in_body(self, link: str, way: Way) -> Way:
        """Return a place of a link from its body's first point on."""
        inside = self._inside[link]
        return inside.offset.plus(way.turned(inside.angle))

    def angle_in_body(self, link: str, angle: Angle) -> Angle:
        """Return a direction of a link in the axes of its body."""
        return angle.plus(self._inside[link].angle)

    def place(self, link: str, way: Way) -> Way:
        """Return a place of a link in the plane."""
        held, own = self._held[self._body[link]], self.in_body(link, way)
        return own if held is None else at(held.at).plus(own.minus(held.own).turned(held.angle))

    def angle(self, link: str) -> Angle:
        """Return the angle of a link."""
        held, own = self._held[self._body[link]], self._inside[link].angle
        return own if held is None else held.angle.plus(own)

    def spot(self, link: str, end: NamedEnd, index: str) -> str:
        """Return the point of a side of a pair, a helper without a letter."""
        if end.letter in self.points:
            return self.points[end.letter]
        place = self.place(link, end.way)
        return place.point or self.build.helping_point("Q", index, place.text)
