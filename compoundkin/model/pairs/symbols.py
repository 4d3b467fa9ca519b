"""Symbols of pairs: marks on their members, in the members' own frames, without a size on paper.

`Pair.glyph` returns the symbols of a pair; `view/sketch/` draws them.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number

# A circle is given by so many points: its chords are then within 0.1 % of its radius.
AROUND = 72


class Pin(NamedTuple):
    """A pin at a point of a member."""

    member: int
    at: Number


class Stud(NamedTuple):
    """A pin that runs in a groove, or a knife edge on a profile."""

    member: int
    at: Number


class Sliding(NamedTuple):
    """A straight guide on the first member, and a block on the second.

    It is used from `low` to `high` as seen from `at`; `stops` tell at which of both it ends.

    Of a cylinder it is drawn as barrel and rod. `turn` is the direction of the guide as the sliding member carries it.
    """

    at: Number
    along: Number
    low: float
    high: float
    block: Number
    turn: Number
    stops: tuple[bool, bool] = (False, False)
    is_cylinder: bool = False


class Groove(NamedTuple):
    """The middle line of a groove in a member, an array of points. `stops` tell at which of both ends it ends."""

    member: int
    line: Number
    stops: tuple[bool, bool] = (False, False)


class Wheel(NamedTuple):
    """A wheel, a pulley, a roller. One with `teeth` is a gear and shows its pitch circle, `is_ring` an internal one."""

    member: int
    at: Number
    radius: Number
    teeth: int = 0
    is_ring: bool = False


class Track(NamedTuple):
    """A straight side of a member: a rack, a road, a flat face. It is used from `low` to `high` as seen from `at`.

    What runs on it is to the left of `along` where `side` is +1. `pitch` is the distance of teeth, 0 if there are none.
    """

    member: int
    at: Number
    along: Number
    low: float
    high: float
    side: float
    pitch: float = 0.0


class Strap(NamedTuple):
    """A belt, chain or cable as a closed line, in a member's frame."""

    member: int
    line: Number


class Outline(NamedTuple):
    """A profile of a member, an array of points. A hollow one has its material outside, as a ring."""

    member: int
    line: Number
    closed: bool
    is_hollow: bool = False


Mark: TypeAlias = Pin | Stud | Sliding | Groove | Wheel | Track | Strap | Outline


def known_range(values: Number) -> tuple[float, float]:
    """Return the least and the greatest known value; zeros where none is.

    >>> known_range(np.array([2.0, np.nan, 1.0]))
    (1.0, 2.0)
    """
    known = np.ravel(values)
    known = known[np.isfinite(known)]
    return (known.min().item(), known.max().item()) if known.size else (0.0, 0.0)


def point_array(points: Iterable[Number]) -> Number:
    """Return points as an array. Numbers of another kind, such as those with notes, stay so.

    >>> point_array([0j, 1.0])
    array([0.+0.j, 1.+0.j])
    """
    found = list(points)
    is_plain = all(type(point) in (int, float, complex) or isinstance(point, np.generic) for point in found)
    return np.array(found, dtype=complex if is_plain else object)


def arc_line(centre: Number, radius: Number, start: float, stop: float) -> Number:
    """Return points of an arc between two angles (radians). They run counterclockwise where stop is the greater one.

    >>> arc_line(0j, 1.0, 0.0, np.pi).round(6)[[0, -1]].tolist()
    [(1+0j), (-1+0j)]
    """
    count = max(2, int(np.ceil(abs(stop - start) / (2.0 * np.pi) * AROUND)) + 1)
    shares = np.linspace(0.0, 1.0, count)
    return point_array(centre + radius * _unit(start + (stop - start) * share) for share in shares)


def _unit(angle: Number) -> Number:
    return np.cos(angle) + np.sin(angle) * 1j


def strap_line(centres: tuple[complex, complex], radii: tuple[float, float], crossed: bool) -> Number:
    """Return a belt around two pulleys.

    It has the common tangents, the inner ones where it is crossed, and the arcs between them.

    >>> strap_line((0j, 4 + 0j), (1.0, 1.0), False).imag.max().round(6)
    np.float64(1.0)
    """
    line = centres[1] - centres[0]
    toward = np.angle(line)
    cosine = (radii[0] + radii[1] if crossed else radii[0] - radii[1]) / abs(line)
    half = np.arccos(np.clip(cosine, -1.0, 1.0))
    around = arc_line(centres[0], radii[0], toward + half, toward + 2.0 * np.pi - half)
    if crossed:
        # from the lower side of the first pulley to the upper side of the second, and around it clockwise
        other = arc_line(centres[1], radii[1], toward + np.pi - half, toward - np.pi + half)
    else:
        other = arc_line(centres[1], radii[1], toward - half, toward + half)
    return np.concatenate([around, other, around[:1]])
