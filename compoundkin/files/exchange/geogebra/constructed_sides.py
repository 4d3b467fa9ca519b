"""Sides of pairs in a construction: points and lines of bodies, the intersection taken, bodies placed by them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, degrees, hypot
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.series import Series
from compoundkin.files.exact_numbers import point as as_written
from compoundkin.files.exchange.geogebra.dragged_construction import (
    Angle,
    Construction,
    PolarSum,
    along,
    at,
    in_degrees,
    named,
    number,
)
from compoundkin.kinematics import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends
from compoundkin.structure.mobility_count import Body

# Places nearer to each other than this part of the size are one, and parts smaller than it are none: rounding.
_SAME = 1e-12


class NamedEnd(NamedTuple):
    """A side of a pair: way from the link's first point, direction, letter, measure."""

    way: PolarSum
    angle: Angle
    letter: str
    measure: float
    reach: float  # how long its direction is written: 1, or a distance


class PairSides:
    """The sides of all pairs. Numbers of a pair become dimensions when first asked for."""

    def __init__(
        self,
        build: Construction,
        links: Mapping[str, LinkPoints],
        ends: Mapping[str, Ends],
        pairs: Sequence[Pair],
        size: float,
    ) -> None:
        self._build, self._links, self._ends, self._size = build, links, ends, size
        self._toward = {
            (pair.members[0], pair.letters[1]): toward for pair in pairs if (toward := getattr(pair, "toward", None))
        }
        self._found: dict[tuple[str, int], NamedEnd] = {}

    def of(self, pair: Pair, side: int) -> NamedEnd:
        """Return the side of a pair on one of its members."""
        key = pair.name, side
        if key not in self._found:
            self._found[key] = self._end(pair, side)
        return self._found[key]

    def _end(self, pair: Pair, side: int) -> NamedEnd:
        end, link = self._ends[pair.name][side], pair.members[side]
        points = self._links.get(link, LinkPoints({}, {}, 0j))
        place = complex(_number(end.point))
        turned = None if end.direction is None else complex(_number(end.direction))
        letter = self._letter(points, pair.letters, place)
        measure = 0.0 if end.measure is None else float(_number(end.measure))
        angle = Angle() if turned is None else self._angle(pair, link, points, turned)
        way = points.ways[letter] if letter else self._beside(pair, points, place, turned, angle)
        return NamedEnd(way, angle, letter, measure, 1.0 if turned is None else abs(turned))

    def _letter(self, points: LinkPoints, letters: Sequence[str], place: complex) -> str:
        """Return the point of a link that is at a place, one of the pair's own first."""
        near = [k for k, own in points.places.items() if abs(own - place) <= _SAME * self._size]
        return next((k for k in letters if k in near), next(iter(near), ""))

    def _beside(self, pair: Pair, points: LinkPoints, place: complex, turned: complex | None, angle: Angle) -> PolarSum:
        """Return a place that is no point: beside a point of the pair, or wherever it is."""
        from_letter = next((k for k in reversed(pair.letters) if k in points.ways), "")
        gap = place - (points.places[from_letter] if from_letter else points.base)
        start = points.ways[from_letter] if from_letter else PolarSum()
        if turned is None or abs((gap * turned.conjugate()).real) > _SAME * self._size:
            return start.plus(dimensioned(self._build, pair.name, gap, pair.name))
        offset = (gap * turned.conjugate()).imag
        if abs(offset) <= _SAME * self._size:
            return start
        name = self._build.dimension("e", pair.name, offset, f"how far {pair.name} is to the left of {from_letter}")
        return start.plus(along(name, angle.plus(Angle(rest=90.0))))

    def _angle(self, pair: Pair, link: str, points: LinkPoints, turned: complex) -> Angle:
        """Return a direction in the link's axes: that of two of its points, or a number."""
        through = pair.letters[1] if len(pair.letters) > 1 else ""
        toward = self._toward.get((link, through), "")
        if toward in points.ways and through in points.ways:
            line = points.places[toward] - points.places[through]
            if abs(line / abs(line) - turned) <= _SAME and points.ways[toward].minus(points.ways[through]).terms:
                return direction(self._build, points.ways[toward].minus(points.ways[through]), pair.name)
        found = in_degrees(atan2(turned.imag, turned.real))
        if found == 0.0:
            return Angle()
        return named(self._build.dimension("β", pair.name, found, f"direction of {pair.name} on {link}, degrees"))


def length_of(build: Construction, way: PolarSum, index: str) -> tuple[str, Angle]:
    """Return the length and direction of a way, computed if it has several parts."""
    if len(way.terms) == 1 and way.terms[0].angle is not None:
        (term,) = way.terms
        return term.what, term.angle.plus(Angle(rest=0.0 if term.sign > 0 else 180.0)) if term.angle else Angle()
    whole = build.vector(index, way.text)
    return build.measured("a", index, "Length", (whole,)), named(build.helper("ε", index, f"{seen(whole)}"))


def direction(build: Construction, way: PolarSum, index: str) -> Angle:
    """Return the direction of a way."""
    return length_of(build, way, index)[1]


def seen(vector: str) -> str:
    """Return the direction of a vector in degrees, as an expression."""
    return f"atan2(y({vector}), x({vector})) / °"


def seen_from(start: str, end: str) -> str:
    """Return the direction of a point from another, in degrees, as an expression."""
    return f"atan2(y({end}) - y({start}), x({end}) - x({start})) / °"


def _number(value: Number) -> Number:
    return first_entry(value.c[0] if isinstance(value, Series) else value)


class ChosenSides:
    """The signs and turns that a motion shows at its assembled poses."""

    def __init__(self, build: Construction, motion: Motion, sliders: Mapping[str, str]) -> None:
        self._build, self._motion, self._sliders = build, motion, sliders
        self._known = np.flatnonzero(np.ravel(motion.failed) == 0)
        self._counted: dict[str, Angle] = {}
        self._whole = set(sliders.values())

    def is_told(self, k: int) -> bool:
        """Return whether a group has one sign, or one that a single driver tells."""
        return len(set(self._signs(k).tolist())) < 2 or (self._moving is not None and self._turns_once(k))

    def mode(self, k: int, index: str) -> str:
        """Add the number that says which way a group stands; return its name."""
        signs = self._signs(k)
        caption = f"mode of the group of {index}: 1 or -1"
        if len(set(signs.tolist())) < 2:
            return self._build.dimension("m", index, float(signs[0]), caption)
        places = self._values[np.argsort(self._values)]
        ordered = signs[np.argsort(self._values)]
        text = number(ordered[-1])
        for j in reversed(range(len(ordered) - 1)):
            if ordered[j] != ordered[j + 1]:
                between = self._between(k, places[j], places[j + 1])
                if not places[0] < between < places[-1]:  # at the very end of the range both are the same
                    continue
                text = f"If({self._moving} < {number(between)}, {number(ordered[j])}, {text})"
        return self._build.helper("m", index, text, caption)

    def _between(self, k: int, low: float, high: float) -> float:
        """Return where a group changes over between two values of the driver."""
        s = np.ravel(self._motion.change_points[k])
        row = np.interp(s[np.isfinite(s)], self._known, self._values)
        inside = row[(row >= low) & (row <= high)]
        near = float(np.round(inside[0], 9)) if len(inside) else (low + high) / 2.0
        return near

    def _turns_once(self, k: int) -> bool:
        """Whether equal values of the driver go with equal signs: the motion does not come back otherwise."""
        order = np.argsort(self._values, kind="stable")
        same = np.diff(self._values[order]) == 0.0
        return not bool(np.any(same & (np.diff(self._signs(k)[order]) != 0.0)))

    def _signs(self, k: int) -> Number:
        found = self._motion.followed.sign(k, np.array([[0]]), self._known[None].astype(float))
        return np.broadcast_to(np.ravel(found), self._known.shape)

    @property
    def _moving(self) -> str | None:
        """The slider of the only driver that moves."""
        moving = [name for name, values in self._driven.items() if np.ptp(values) > 0.0]
        return self._sliders[moving[0]] if len(moving) == 1 else None

    @property
    def _values(self) -> Number:
        """The values of that driver, in degrees or lengths."""
        return next(values for values in self._driven.values() if np.ptp(values) > 0.0)

    @property
    def _driven(self) -> dict[str, Number]:
        angles = self._motion.structure.driven_angles
        rows = {name: np.ravel(drive.value) for name, drive in self._motion.drives.items()}
        found = {
            name: row[self._known] if row.size > 1 else np.repeat(row, len(self._known)) for name, row in rows.items()
        }
        return {name: np.rad2deg(row) if angles[name] else row for name, row in found.items()}

    def counted(self, link: str, angle: Angle) -> Angle:
        """Return the angle of a link with full turns counted; `angle` lacks these."""
        if self._is_counted(angle):
            return angle
        if link not in self._counted:
            per, middle = self._course(link) or (0.0, 0.0)
            off = angle.minus(Angle(rest=middle)).text + (f" - {number(per)} * {self._moving}" if per else "")
            text = f"{angle.text} - 360 * floor(({off}) / 360 + 0.5)"
            self._counted[link] = named(self._build.helper("τ", link, text, f"angle of {link} with full turns"))
            self.note_counted(self._counted[link])
        return self._counted[link]

    def can_count(self, link: str) -> bool:
        """Return whether a link keeps within a turn of some multiple of the driver."""
        return self._course(link) is not None

    def note_counted(self, angle: Angle) -> None:
        """Note that an angle has its full turns."""
        self._whole.update(name for _, name in angle.names)

    def _is_counted(self, angle: Angle) -> bool:
        return {name for _, name in angle.names} <= self._whole

    def _course(self, link: str) -> tuple[float, float] | None:
        """Return how many turns a link makes for one of the driver, and the middle of what is left."""
        theta = np.rad2deg(np.ravel(self._motion.poses[link].angle.c[0]))
        theta = theta[self._known] if theta.size > 1 else np.repeat(theta, len(self._known))
        for per in (0.0, 1.0, -1.0, 2.0, -2.0) if self._moving else (0.0,):
            left = theta - (per * self._values if per else 0.0)
            if np.ptp(left) < 350.0:
                return per, float(np.round((left.min() + left.max()) / 2.0))
        return None


def steps_of(values: Number) -> float:
    """Return a step for a slider, a plain part of its range."""
    span = float(np.ptp(values))
    power = 10.0 ** np.floor(np.log10(span / 200.0))
    return float(next(factor * power for factor in (1, 2, 5, 10) if factor * power >= span / 500.0))


# Numbers with at most so many characters are those that somebody wrote.
_WRITTEN = 9


class LinkPoints:
    """The points of a link from the first of them on.

    `places` are the numbers, from the origin of the link's frame; `base` is the place of the first point.
    """

    def __init__(self, places: Mapping[str, complex], ways: Mapping[str, PolarSum], base: complex) -> None:
        self.places, self.ways, self.base = places, ways, base


def link_points(build: Construction, name: str, places: Mapping[str, complex]) -> LinkPoints:
    """Return a link's points, which are free in the frame, else dimensions."""
    if name == FRAME:
        return LinkPoints(places, {k: at(build.free_point(k, place)) for k, place in places.items()}, 0j)
    first = next((k for k, place in places.items() if place == 0), next(iter(places), ""))
    base = places.get(first, 0j)
    ways = {k: PolarSum() if k == first else dimensioned(build, first + k, p - base, name) for k, p in places.items()}
    return LinkPoints(places, ways, base)


def dimensioned(build: Construction, index: str, place: complex, of: str) -> PolarSum:
    """Return a way by new numbers: length and angle, or coordinates if written so."""
    x, y = place.real, place.imag
    if not x and not y:
        return PolarSum()
    if not x or not y:
        quarter = degrees(atan2(y, x)) % 360
        return along(build.dimension("l", index, abs(x + y), f"{index} of {of}"), Angle(rest=quarter))
    written = as_written(place)
    if isinstance(written, dict):
        length, turned = written["polar"]
    elif max(len(repr(value)) for value in written) <= _WRITTEN:
        x_name = build.dimension("x", index, x, f"{index} of {of} along its axis")
        y_name = build.dimension("y", index, y, f"{index} of {of} to the left of its axis")
        return along(x_name, Angle()).plus(along(y_name, Angle(rest=90.0)))
    else:
        length, turned = hypot(x, y), degrees(atan2(y, x))
    r_name = build.dimension("l", index, length, f"{index} of {of}")
    return along(r_name, named(build.dimension("α", index, turned, f"direction of {index} of {of}, degrees")))


class InsideBody(NamedTuple):
    """Where a link is in its body's axes, from the base's first point on."""

    offset: PolarSum
    angle: Angle


class ConstructedBody(NamedTuple):
    """A known body: its place `own` is at the point `at`, turned by `angle`."""

    at: str
    own: PolarSum
    angle: Angle


class PlacedBodies:
    """The bodies placed so far; the frame's are from the beginning."""

    def __init__(self, build: Construction, links: Mapping[str, LinkPoints]) -> None:
        self.build, self._links = build, links
        self._body: dict[str, str] = {}
        self._inside: dict[str, InsideBody] = {}
        self._held: dict[str, ConstructedBody | None] = {}
        self.points: dict[str, str] = {}

    def join(self, body: Body, inside: Mapping[str, InsideBody]) -> None:
        """Note the links of a body."""
        for name in body.links:
            self._body[name], self._inside[name] = body.links[0], inside[name]

    def hold(self, body: Body, held: ConstructedBody | None) -> None:
        """Note where a body is, None for the frame; add its links' points."""
        self._held[body.links[0]] = held
        for name in body.links:
            for letter, way in self._links[name].ways.items() if name in self._links else ():
                if letter not in self.points:
                    self.points[letter] = self._point(letter, self.place(name, way))

    def _point(self, letter: str, place: PolarSum) -> str:
        # the very point, not another one at the same place
        if place.point and place.point not in self.points.values():
            return place.point
        return self.build.point(letter, place.text)

    def in_body(self, link: str, way: PolarSum) -> PolarSum:
        """Return a place of a link from its body's first point on."""
        inside = self._inside[link]
        return inside.offset.plus(way.turned(inside.angle))

    def angle_in_body(self, link: str, angle: Angle) -> Angle:
        """Return a direction of a link in the axes of its body."""
        return angle.plus(self._inside[link].angle)

    def place(self, link: str, way: PolarSum) -> PolarSum:
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
