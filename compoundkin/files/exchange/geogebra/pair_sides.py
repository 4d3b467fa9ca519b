"""The sides of pairs in their links' axes, said with the names of dimensions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2
from typing import NamedTuple

from compoundkin.base.arrays import Number, first_entry
from compoundkin.base.series import Series
from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.point_dimensions import LinkPoints, dimensioned
from compoundkin.files.exchange.geogebra.polar_sums import Angle, Way, along, in_degrees, named
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends

# Places nearer to each other than this part of the size are one, and parts smaller than it are none: rounding.
_SAME = 1e-12


class NamedEnd(NamedTuple):
    """A side of a pair: way from the link's first point, direction, letter, measure."""

    way: Way
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

    def _beside(self, pair: Pair, points: LinkPoints, place: complex, turned: complex | None, angle: Angle) -> Way:
        """Return a place that is no point: beside a point of the pair, or wherever it is."""
        from_letter = next((k for k in reversed(pair.letters) if k in points.ways), "")
        gap = place - (points.places[from_letter] if from_letter else points.base)
        start = points.ways[from_letter] if from_letter else Way()
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


def length_of(build: Construction, way: Way, index: str) -> tuple[str, Angle]:
    """Return the length and direction of a way, computed if it has several parts."""
    if len(way.terms) == 1 and way.terms[0].angle is not None:
        (term,) = way.terms
        return term.what, term.angle.plus(Angle(rest=0.0 if term.sign > 0 else 180.0)) if term.angle else Angle()
    whole = build.vector(index, way.text)
    return build.measured("a", index, "Length", (whole,)), named(build.helper("ε", index, f"{seen(whole)}"))


def direction(build: Construction, way: Way, index: str) -> Angle:
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
