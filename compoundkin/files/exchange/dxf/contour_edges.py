"""Edges of contours: straight ones and arcs of circles, where they meet, and pieces of them."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import sqrt, tan

from compoundkin.base.arrays import TURN


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
