"""Sums of angles and of planar vectors, written with the names of a construction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.files.exchange.shortest_numbers import shortest

# So many units of its last digit an angle may be off once it has been a direction, or the last digit of a turn.
_ULPS = 4.0
_TURN = 360.0


def number(value: float) -> str:
    """Return a number as GeoGebra reads it, to the last digit.

    >>> number(2.0), number(1e-07), number(-0.1)
    ('2', '1E-07', '-0.1')
    """
    return shortest(value).replace("e", "E")


def in_degrees(radians: float) -> float:
    """Return degrees, of those that differ by rounding the ones with fewest decimals.

    >>> in_degrees(0.6108652381980153), in_degrees(1e-17)
    (35.0, 0.0)
    """
    exact = float(np.rad2deg(radians))
    near = (round(exact, digits) for digits in range(14))
    off = max(_ULPS * float(np.spacing(abs(exact))), float(np.spacing(_TURN)))
    return next((value for value in near if abs(value - exact) <= off), exact)


@dataclass(frozen=True)
class Angle:
    """A sum of named angles and of a number, in degrees."""

    names: tuple[tuple[int, str], ...] = ()
    rest: float = 0.0

    def plus(self, other: Angle, sign: int = 1) -> Angle:
        """Return the sum; what is there with both signs is left out."""
        names = list(self.names)
        for own, name in other.names:
            if (-own * sign, name) in names:
                names.remove((-own * sign, name))
            else:
                names.append((own * sign, name))
        return Angle(tuple(names), self.rest + sign * other.rest)

    def minus(self, other: Angle) -> Angle:
        """Return the difference."""
        return self.plus(other, -1)

    @property
    def is_zero(self) -> bool:
        """Whether nothing is left."""
        return not self.names and self.rest == 0.0

    @property
    def text(self) -> str:
        """The sum as it is written.

        >>> Angle(((1, "a"), (-1, "b")), 90.0).text, Angle(((-1, "a"),)).text, Angle().text
        ('a - b + 90', '-a', '0')
        """
        terms = [(sign, name) for sign, name in self.names]
        if self.rest or not terms:
            terms.append((-1 if self.rest < 0 else 1, number(abs(self.rest))))
        return signed(sorted(terms, key=lambda term: -term[0]) if terms[0][0] < 0 else terms)

    @property
    def in_degrees(self) -> str:
        """The sum with the sign of degrees.

        >>> Angle(((1, "a"),)).in_degrees, Angle(((1, "a"),), 5.0).in_degrees
        ('a°', '(a + 5)°')
        """
        one = (not self.names and self.rest >= 0) or (len(self.names) == 1 and not self.rest and self.names[0][0] > 0)
        return f"{self.text}°" if one else f"({self.text})°"


def named(name: str) -> Angle:
    """Return the angle of a name."""
    return Angle(((1, name),))


def signed(terms: list[tuple[int, str]]) -> str:
    """Return a sum of terms with signs.

    >>> signed([(-1, "a"), (1, "b"), (-1, "c")])
    '-a + b - c'
    """
    first = f"-{terms[0][1]}" if terms[0][0] < 0 else terms[0][1]
    return first + "".join(f" {'-' if sign < 0 else '+'} {text}" for sign, text in terms[1:])


@dataclass(frozen=True)
class WayTerm:
    """A point by its name, or a length in a direction."""

    sign: int
    what: str
    angle: Angle | None = None

    @property
    def text(self) -> str:
        """It without its sign."""
        if self.angle is None:
            return self.what
        return f"({self.what}, 0)" if self.angle.is_zero else f"({self.what}; {self.angle.in_degrees})"


@dataclass(frozen=True)
class Way:
    """A planar vector, or the place of a point: a sum of terms."""

    terms: tuple[WayTerm, ...] = ()

    def plus(self, other: Way, sign: int = 1) -> Way:
        """Return the sum; what is there with both signs is left out."""
        terms = list(self.terms)
        for own in other.terms:
            opposite = WayTerm(-own.sign * sign, own.what, own.angle)
            if opposite in terms:
                terms.remove(opposite)
            else:
                terms.append(WayTerm(own.sign * sign, own.what, own.angle))
        return Way(tuple(terms))

    def minus(self, other: Way) -> Way:
        """Return the difference."""
        return self.plus(other, -1)

    def turned(self, angle: Angle) -> Way:
        """Return it turned. Points of the frame do not turn, nor do they need to."""
        if angle.is_zero:
            return self
        assert all(term.angle is not None for term in self.terms)
        return Way(tuple(WayTerm(t.sign, t.what, (t.angle or Angle()).plus(angle)) for t in self.terms))

    @property
    def text(self) -> str:
        """The sum as it is written, points first.

        >>> Way((WayTerm(1, "l", named("a")),)).plus(at("B")).text
        'B + (l; a°)'
        """
        if not self.terms:
            return "(0, 0)"
        terms = sorted(self.terms, key=lambda t: (t.sign < 0, t.angle is not None))
        return signed([(term.sign, term.text) for term in terms])

    @property
    def point(self) -> str | None:
        """The name of the point that it is, if it is one."""
        if len(self.terms) == 1 and self.terms[0].angle is None and self.terms[0].sign > 0:
            return self.terms[0].what
        return None

    def rectangular(self, coordinate: str) -> str:
        """Return a coordinate of a vector without points, "0" where it is none."""
        terms = [(t.sign, _part(t.what, t.angle or Angle(), coordinate)) for t in self.terms]
        return signed(kept) if (kept := [(sign, text) for sign, text in terms if text]) else "0"


def at(name: str) -> Way:
    """Return the place of a point."""
    return Way((WayTerm(1, name),))


def along(length: str, angle: Angle) -> Way:
    """Return a length in a direction."""
    return Way((WayTerm(1, length, angle),))


def _part(length: str, angle: Angle, coordinate: str) -> str:
    """Return a coordinate of a length in a direction; nothing where it is zero whatever the numbers are."""
    if not angle.names and angle.rest % 90 == 0:
        factor = (1, 0, -1, 0) if coordinate == "x" else (0, 1, 0, -1)
        own = factor[int(angle.rest // 90) % 4]
        return "" if own == 0 else length if own > 0 else f"(-{length})"
    return f"{length} * {'cos' if coordinate == 'x' else 'sin'}({angle.in_degrees})"
