"""Contours of links at true size: outlines united into edges, with their pin holes."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import pi, sqrt, tan
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import TURN, Number, first_entry
from compoundkin.base.curves import Curve
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.model.outline_shapes import OutlineShape, outline_shapes
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.profile_contact import as_profile_contact
from compoundkin.model.pairs.symbols import Groove, Mark, Sliding, Strap, Track, Wheel
from compoundkin.model.pairs.travel_limits import as_travel_limited, bounds_name

Circle: TypeAlias = "tuple[complex, float]"


Line: TypeAlias = "tuple[complex, ...]"


Arc: TypeAlias = "tuple[complex, float, float, float]"


Marked: TypeAlias = "tuple[Pair, Mark]"


# So many poses are looked at for each of the motion for the ends of guides, and so many at most.
FINER, MOST_POSES = 12, 6000


# The longest circular slot, radians.
MOST = 6.0


# Tables of pairs whose grooves are circles, and straight.
ARCS, SLOTS = "arcs", "slots"


@dataclass(frozen=True)
class Sheet:
    """What of a link lies on one layer: contours, slots, holes for pins."""

    layer: int
    contours: tuple[Contour, ...]
    holes: tuple[Circle, ...]


@dataclass(frozen=True)
class LinkPart:
    """A link as a part.

    Its `sheets` go from the lowest layer up, none without outlines. `profiles` are cams and curved slots, `grooves`
    arcs (centre, radius, angles from and to), `guides` straight lines, `wheels` circles, `belts` closed lines.
    """

    link: str
    points: Mapping[str, complex]
    sheets: tuple[Sheet, ...]
    profiles: tuple[Curve, ...]
    grooves: tuple[Arc, ...]
    guides: tuple[Line, ...]
    wheels: tuple[Circle, ...]
    belts: tuple[Line, ...]

    @property
    def is_cut(self) -> bool:
        """Whether there is a contour to be cut."""
        return bool(self.sheets) or any(curve.closed for curve in self.profiles)


def link_parts(shown: PosedMechanism, motion: Motion | None) -> tuple[LinkPart, ...]:
    """Return all links as parts, guides as long as their use over a motion."""
    mechanism = shown.mechanism
    shapes = outline_shapes(mechanism, shown.points)
    fine = None if motion is None or not shown.pairs else _refined(motion)
    marks = [one for pair in shown.pairs for one in _marks(shown, pair, fine)]
    return tuple(
        _part(shown, link, shapes, [(pair, mark) for on, pair, mark in marks if on == link])
        for link in shown.points
        if link not in mechanism.auxiliary_links
    )


def _part(shown: PosedMechanism, link: str, shapes: Sequence[OutlineShape], marks: Sequence[Marked]) -> LinkPart:
    profiled = [found for pair in shown.pairs if (found := as_profile_contact(pair)) is not None and found.on == link]
    grooves = {
        pair.letters[0]: _arc(shown, pair, mark)
        for pair, mark in marks
        if pair.table == ARCS and isinstance(mark, Groove)
    }
    slots = {
        pair.letters[0]: _line(mark.line) for pair, mark in marks if pair.table == SLOTS and isinstance(mark, Groove)
    }
    pins = pin_radii(shapes)
    cut = [_slot(link, line, pins[pin][1]) for pin, line in slots.items() if pin in pins]
    # one that goes all around would cut the part in two
    cut += [_curved_slot(*arc, pins[pin][1]) for pin, arc in grooves.items() if pin in pins and arc[3] - arc[2] < MOST]
    return LinkPart(
        link,
        shown.points[link],
        tuple(_sheets(link, shown.points[link], shapes, cut)),
        tuple({id(pair.curve): pair.curve for pair in profiled}.values()),
        tuple(grooves.values()),
        (*slots.values(), *(_guide(mark) for _, mark in marks if isinstance(mark, Sliding | Track))),
        tuple((complex(mark.at), float(mark.radius)) for _, mark in marks if isinstance(mark, Wheel)),
        tuple(_line(mark.line) for _, mark in marks if isinstance(mark, Strap)),
    )


def _sheets(
    link: str, points: Mapping[str, complex], shapes: Sequence[OutlineShape], slots: Sequence[Contour]
) -> Iterator[Sheet]:
    own = [shape for shape in shapes if shape.body == link]
    pins = pin_radii(shapes)
    for layer in sorted({layer for shape in own for layer in shape.layers}):
        there = [shape for shape in own if layer in shape.layers]
        holes = [(points[k], r) for k, (links, r) in pins.items() if link in links and k in points]
        yield Sheet(
            layer,
            (*contours(there), *(slot for slot in slots if covers(there, slot[0].at(0.5)))),
            tuple(hole for hole in holes if covers(there, hole[0])),
        )


def pin_radii(shapes: Sequence[OutlineShape]) -> Mapping[str, tuple[frozenset[str], float]]:
    """Return the links that each pin joins, and its radius, by letters.

    Of several radii it is the largest.
    """
    found: dict[str, tuple[frozenset[str], float]] = {}
    for shape in shapes:
        for letter in shape.letters if shape.body.startswith("pin ") else ():
            links, radius = found.get(letter, (frozenset(), 0.0))
            found[letter] = links | set(shape.links), max(radius, shape.radius)
    return found


def _marks(shown: PosedMechanism, pair: Pair, motion: Motion | None) -> Iterator[tuple[str, Pair, Mark]]:
    """Yield what there is to see of a pair, each with the link that has it."""
    if not shown.mechanism.auxiliary_links.isdisjoint(pair.members):
        return
    ends = shown.ends[pair.name]
    poses = tuple(shown.poses[name] if motion is None else _assembled(motion, name) for name in pair.members)
    marks, ended = pair.glyph(ends, poses), as_travel_limited(pair)
    if ended is not None:
        known = shown.ends.get(bounds_name(pair))
        bounds = ended.bounds(shown.mechanism.geometry) if known is None else [side.point for side in known]
        marks = ended.with_ends(marks, (first_entry(bounds[0]), first_entry(bounds[1])), ends, poses)
    for mark in marks:
        yield pair.members[0 if isinstance(mark, Sliding) else mark.member], pair, mark


def _refined(motion: Motion) -> Motion:
    """Return a motion with more poses: a slot that ends a little before its pin would stop the machine."""
    last = motion.inputs.poses - 1
    return between(motion, 0, np.linspace(0.0, last, min(FINER * last, max(MOST_POSES, last)) + 1), order=0)


def _assembled(motion: Motion, link: str) -> Pose:
    """Return the poses of a link that are assembled, (poses,)."""
    known = np.flatnonzero(motion.failed[0] == 0)

    def row(value: Number) -> Number:
        flat = np.ravel(value)
        return flat[known] if flat.size > 1 else flat[0]

    return motion.poses[link].mapped(lambda series: Series((row(series.c[0]),)))


def _arc(shown: PosedMechanism, pair: Pair, mark: Mark) -> Arc:
    """The middle line of a circular slot: of its pair the circle, of its mark from where to where."""
    assert isinstance(mark, Groove)
    circle = shown.ends[pair.name][0]
    angles = np.unwrap(np.angle(np.asarray(mark.line, complex) - complex(circle.point)))
    return complex(circle.point), float(circle.measure), float(angles.min()), float(angles.max())


def _slot(link: str, line: Line, radius: float) -> Contour:
    """The contour of a straight slot for a pin."""
    core = line if line[0] != line[-1] else line[:1]
    return contours([OutlineShape(link, (link,), core, False, radius, (), ("",) * len(core))])[0]


def _curved_slot(centre: complex, radius: float, start: float, stop: float, pin: float) -> Contour:
    """The contour of a circular slot for a pin, its ends half circles."""
    a, b = np.exp(1j * start), np.exp(1j * stop)
    ends = [centre + (radius + side * pin) * way for side, way in ((1, a), (1, b), (-1, b), (-1, a))]
    outer = ContourEdge(ends[0], ends[1], centre, stop - start)
    inner = ContourEdge(ends[2], ends[3], centre, start - stop)
    caps = (ContourEdge(x, y, centre + radius * way, np.pi) for x, y, way in ((*ends[1:3], b), (ends[3], ends[0], a)))
    return outer, next(caps), inner, next(caps)


def _line(places: Number) -> Line:
    return tuple(map(complex, places))


def _guide(mark: Sliding | Track) -> Line:
    """The line of a straight guide."""
    return complex(mark.at + mark.along * mark.low), complex(mark.at + mark.along * mark.high)


# Places nearer to each other than this part of the outline's size are one; on which side of an edge material lies is
# looked at so much farther away.
SAME, ASIDE = 1e-9, 1e-6


@dataclass(frozen=True)
class ContourEdge:
    """A straight edge, or an arc counterclockwise about a `centre`.

    It has the angle `turn`. Material is on its left.
    """

    start: complex
    stop: complex
    centre: complex | None = None
    turn: float = 0.0

    @property
    def bulge(self) -> float:
        """What DXF calls so: the tangent of a quarter of the turn.

        >>> from math import pi
        >>> round(ContourEdge(1 + 0j, -1 + 0j, 0j, pi).bulge, 12)
        1.0
        """
        return tan(self.turn / 4.0)

    @property
    def radius(self) -> float:
        """The radius of an arc."""
        return 0.0 if self.centre is None else abs(self.start - self.centre)

    def at(self, share: float) -> complex:
        """Return the place at a share of its length."""
        if self.centre is None:
            return self.start + share * (self.stop - self.start)
        return self.centre + (self.start - self.centre) * cmath.rect(1.0, share * self.turn)

    def outward(self, share: float) -> complex:
        """Return the unit vector away from the material."""
        if self.centre is None:
            return -1j * (self.stop - self.start) / abs(self.stop - self.start)
        return (self.at(share) - self.centre) / self.radius

    def share_of(self, place: complex) -> float:
        """Return the share of its length at a place on it.

        Of other places it is beyond 0 or 1, or that of their foot.
        """
        if self.centre is None:
            along = self.stop - self.start
            return ((place - self.start) * along.conjugate()).real / abs(along) ** 2
        angle = cmath.phase((place - self.centre) / (self.start - self.centre)) % TURN
        # just before the start is a little less than nothing, not a whole turn
        return (angle - TURN if angle - self.turn > (TURN - self.turn) / 2.0 else angle) / self.turn

    def piece(self, low: float, high: float) -> ContourEdge:
        """Return the piece of it between two shares."""
        return ContourEdge(self.at(low), self.at(high), self.centre, (high - low) * self.turn)

    def cuts(self, other: ContourEdge, tolerance: float) -> Iterator[float]:
        """Yield the shares at which another edge meets it."""
        for place in (*_meetings(self, other, tolerance), other.start, other.stop):
            own, its = self.share_of(place), other.share_of(place)
            if 0.0 < own < 1.0 and abs(self.at(own) - place) <= tolerance:
                its = min(1.0, max(0.0, its))
                if abs(other.at(its) - place) <= tolerance:
                    yield own


Contour: TypeAlias = tuple[ContourEdge, ...]


@dataclass(frozen=True)
class _Part:
    """All places nearer than `radius` to a convex core, or a polygon of any form without a radius."""

    core: tuple[complex, ...]
    radius: float

    @cached_property
    def edges(self) -> Contour:
        """Its edge, counterclockwise."""
        n = len(self.core)
        if n == 1:
            right, left = self.core[0] + self.radius, self.core[0] - self.radius
            halves = ((right, left), (left, right))
            return tuple(ContourEdge(a, b, self.core[0], pi) for a, b in halves)
        found: list[ContourEdge] = []
        for k, corner in enumerate(self.core):
            before, after = (_outward(self.core[k - 1], corner), _outward(corner, self.core[(k + 1) % n]))
            if self.radius > 0:
                turn = cmath.phase(after / before) % TURN
                ends = corner + self.radius * before, corner + self.radius * after
                found.append(ContourEdge(*ends, corner, turn))
            start, stop = (p + self.radius * after for p in (corner, self.core[(k + 1) % n]))
            found.append(ContourEdge(start, stop))
        return tuple(found)

    def depth(self, place: complex) -> float:
        """How far a place is outside of it; negative inside."""
        away = min(_away(place, a, b) for a, b in zip(self.core, (*self.core[1:], self.core[0]), strict=True))
        if len(self.core) > 2 and _winds(self.core, place):
            away = -away
        return away - self.radius


def contours(shapes: Sequence[OutlineShape]) -> tuple[Contour, ...]:
    """Return the edge of shapes together: closed, material on the left, holes clockwise.

    >>> disc = OutlineShape("a", ("a",), (0j,), False, 2.0, (0,), ("",))
    >>> [edge.radius for edge in contours([disc])[0]]
    [2.0, 2.0]
    """
    parts = [part for shape in shapes for part in _parts(shape)]
    if not parts:
        return ()
    places = [edge.start for part in parts for edge in part.edges]
    size = max(abs(p - places[0]) for p in places) or 1.0
    kept = [piece for k in range(len(parts)) for piece in _outer_edges(parts, k, size)]
    return tuple(_merged(loop) for loop in _loops(kept, 10.0 * SAME * size))


def _parts(shape: OutlineShape) -> Iterator[_Part]:
    core = tuple(p for k, p in enumerate(shape.core) if k == 0 or p != shape.core[k - 1])
    if shape.closed:
        core = core[:-1] if len(core) > 1 and core[0] == core[-1] else core
        area = sum((a.conjugate() * b).imag for a, b in zip(core, (*core[1:], core[0]), strict=True))
        yield _Part(core if area > 0 else core[::-1], shape.radius)
    elif len(core) == 1:
        yield _Part(core, shape.radius)
    else:
        yield from (_Part((a, b), shape.radius) for a, b in pairwise(core))


def _outward(a: complex, b: complex) -> complex:
    return -1j * (b - a) / abs(b - a)


def _away(place: complex, a: complex, b: complex) -> float:
    along = b - a
    share = ((place - a) * along.conjugate()).real / abs(along) ** 2 if along else 0.0
    return abs(place - a - min(1.0, max(0.0, share)) * along)


def _winds(corners: Sequence[complex], place: complex) -> bool:
    """Whether a polygon goes around a place: a ray from it crosses an odd number of edges."""
    crossed = False
    for a, b in zip(corners, (*corners[1:], corners[0]), strict=True):
        if (a.imag > place.imag) != (b.imag > place.imag):
            at = a.real + (place.imag - a.imag) * (b.real - a.real) / (b.imag - a.imag)
            crossed ^= at > place.real
    return crossed


def _outer_edges(parts: Sequence[_Part], own: int, size: float) -> Iterator[ContourEdge]:
    """Yield the pieces of a part's edge that no other part covers; of edges that two share that of the first."""
    for edge in parts[own].edges:
        others = [other for part in parts if part is not parts[own] for other in part.edges]
        cuts = sorted([0.0, 1.0, *(share for other in others for share in edge.cuts(other, SAME * size))])
        for low, high in pairwise(cuts):
            piece = edge.piece(low, high)
            if abs(piece.at(0.5) - piece.start) <= SAME * size:
                continue
            middle = piece.at(0.5)
            aside = middle + piece.outward(0.5) * ASIDE * size
            covered = any(part.depth(aside) < 0 for k, part in enumerate(parts) if k != own)
            inside = any(part.depth(middle) < -SAME * size for k, part in enumerate(parts) if k != own)
            again = any(part.depth(middle) <= SAME * size for part in parts[:own])
            if not (covered or inside or again):
                yield piece


def _loops(pieces: list[ContourEdge], tolerance: float) -> Iterator[list[ContourEdge]]:
    """Yield closed loops of pieces, each of which begins where another one ends."""
    rest = list(pieces)
    while rest:
        loop = [rest.pop(0)]
        while rest and abs(loop[-1].stop - loop[0].start) > tolerance:
            k = min(range(len(rest)), key=lambda k: abs(rest[k].start - loop[-1].stop))
            loop.append(rest.pop(k))
        yield loop


def _merged(loop: Sequence[ContourEdge]) -> Contour:
    """Return a loop without needless corners: pieces of one arc or one straight edge as one."""
    found: list[ContourEdge] = []
    for edge in loop:
        if found and (one := _joined(found[-1], edge)):
            found[-1] = one
        else:
            found.append(edge)
    if len(found) > 2 and (one := _joined(found[-1], found[0])):
        found[:] = [one, *found[1:-1]]
    return tuple(found)


def _joined(one: ContourEdge, other: ContourEdge) -> ContourEdge | None:
    """Two edges, one after the other, as one where they are; arcs of at most half a turn."""
    if one.centre is None and other.centre is None:
        a, b = one.stop - one.start, other.stop - other.start
        straight = abs((a.conjugate() * b).imag) <= SAME * abs(a) * abs(b) and (a.conjugate() * b).real > 0
        return ContourEdge(one.start, other.stop) if straight else None
    if one.centre is None or other.centre is None or one.turn + other.turn > pi:
        return None
    same = abs(one.centre - other.centre) <= SAME * one.radius and abs(one.radius - other.radius) <= SAME * one.radius
    return ContourEdge(one.start, other.stop, one.centre, one.turn + other.turn) if same else None


def covers(shapes: Sequence[OutlineShape], place: complex) -> bool:
    """Return whether a place is within one of some shapes."""
    return any(part.depth(place) <= 0.0 for shape in shapes for part in _parts(shape))


def _meetings(one: ContourEdge, other: ContourEdge, tolerance: float) -> Sequence[complex]:
    """The places where the whole lines or circles meet; none where they are one."""
    if one.centre is None and other.centre is None:
        return _of_lines(one, other)
    if one.centre is not None and other.centre is not None:
        return _of_circles(one, other, tolerance)
    line, arc = (one, other) if one.centre is None else (other, one)
    return _of_line_and_circle(line, arc, tolerance)


def _of_lines(one: ContourEdge, other: ContourEdge) -> Sequence[complex]:
    a, b = one.stop - one.start, other.stop - other.start
    across = (a.conjugate() * b).imag
    if abs(across) <= 1e-12 * abs(a) * abs(b):  # parallel but for rounding: they share ends or nothing
        return ()
    return (one.start + a * (((other.start - one.start).conjugate() * b).imag / across),)


def _of_line_and_circle(line: ContourEdge, arc: ContourEdge, tolerance: float) -> Sequence[complex]:
    assert arc.centre is not None
    e = (line.stop - line.start) / abs(line.stop - line.start)
    foot = line.start + e * ((arc.centre - line.start) * e.conjugate()).real
    return _beside(foot, e, arc.radius, abs(arc.centre - foot), tolerance)


def _of_circles(one: ContourEdge, other: ContourEdge, tolerance: float) -> Sequence[complex]:
    assert one.centre is not None
    assert other.centre is not None
    apart = abs(other.centre - one.centre)
    if apart <= tolerance:
        return ()
    e = (other.centre - one.centre) / apart
    along = (apart**2 + one.radius**2 - other.radius**2) / (2.0 * apart)
    return _beside(one.centre + e * along, 1j * e, one.radius, abs(along), tolerance)


def _beside(middle: complex, e: complex, radius: float, away: float, tolerance: float) -> Sequence[complex]:
    """The two places on both sides of a middle that is so far away from a circle's centre."""
    if away > radius + tolerance:
        return ()
    half = sqrt(max(0.0, radius**2 - away**2))
    return middle - e * half, middle + e * half
