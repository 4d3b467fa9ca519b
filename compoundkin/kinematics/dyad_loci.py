"""The construction of a dyad by circles and lines: the loci that meet where its inner pair is, at one pose."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.arrays import Number, dot
from compoundkin.base.poses import End
from compoundkin.base.series import as_series

# Lines of one picture whose directions differ by less than this (the sine of the angle) are parallel.
PARALLEL = 1e-6


class CircleLocus(NamedTuple):
    """A circle, with a radius by its name and end.

    A circle that only helps has none.
    """

    centre: complex
    radius: float
    name: str = ""
    end: complex = 0j


class LineLocus(NamedTuple):
    """A line through a place in a direction."""

    at: complex
    along: complex


Locus: TypeAlias = CircleLocus | LineLocus


class Loci(NamedTuple):
    """The loci of a dyad in one of its modes.

    The place where they meet, and the construction in sentences.
    """

    curves: tuple[Locus, ...]
    meeting: complex
    told: tuple[str, ...]


def place_of(value: Number) -> complex:
    """Return the leading number of a series, or of an array of one entry."""
    return complex(np.ravel(as_series(value).c[0])[0])


def direction_of(end: End) -> complex:
    """Return the direction of a side of a pair."""
    return place_of(end.along)


def radius_about(centre: complex, end: complex, name: str, other: str = "") -> CircleLocus:
    """Return the circle about a place through another, its radius named and measured.

    It is called by the letters of both, or as it is named; places without letters make it a plain r.

    >>> radius_about(0j, 3 + 4j, "A", "C").name, radius_about(0j, 3 + 4j, "e").name
    ('|AC| = 5', 'e = 5')
    """
    radius, both = abs(end - centre), f"|{name}{other}|" if other else name
    return CircleLocus(centre, radius, f"{'r' if ' ' in both else both} = {radius:.5g}", end)


def same_locus(one: Locus, two: Locus, nothing: float) -> bool:
    """Tell whether two loci are one, but for so small a length.

    >>> line = LineLocus(0j, 1 + 0j)
    >>> same_locus(line, LineLocus(5 + 0j, -1 + 0j), 1e-9), same_locus(line, CircleLocus(0j, 1.0), 1e-9)
    (True, False)
    """
    if isinstance(one, CircleLocus) and isinstance(two, CircleLocus):
        return abs(one.centre - two.centre) <= nothing and abs(one.radius - two.radius) <= nothing
    if isinstance(one, CircleLocus) or isinstance(two, CircleLocus):
        return False
    across = 1j * one.along
    is_parallel = abs(dot(across, two.along)) <= PARALLEL
    return bool(is_parallel and abs(dot(across, two.at - one.at)) <= nothing)
