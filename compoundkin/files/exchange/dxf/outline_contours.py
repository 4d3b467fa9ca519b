"""Contours of outlines: the edge of all shapes of a link together, of straight edges and arcs, without error."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import pi
from typing import TypeAlias

from compoundkin.base.arrays import TURN
from compoundkin.files.exchange.dxf.contour_edges import ContourEdge
from compoundkin.model.outline_shapes import OutlineShape

# Places nearer to each other than this part of the outline's size are one; on which side of an edge material lies is
# looked at so much farther away.
SAME, ASIDE = 1e-9, 1e-6

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
    kept = [piece for k in range(len(parts)) for piece in _kept(parts, k, size)]
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


def _kept(parts: Sequence[_Part], own: int, size: float) -> Iterator[ContourEdge]:
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
