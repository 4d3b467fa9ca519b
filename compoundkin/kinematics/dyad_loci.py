"""The construction of a dyad by circles and lines: the loci that meet where its inner pair is, at one pose."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np

from compoundkin.base.poses import End
from compoundkin.base.series import Number, as_series


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


def radius_about(centre: complex, end: complex, name: str) -> CircleLocus:
    """Return the circle about a place through another, its radius named and measured.

    >>> radius_about(0j, 3 + 4j, "|AC|").name
    '|AC| = 5'
    """
    radius = abs(end - centre)
    return CircleLocus(centre, radius, f"{name} = {radius:.5g}", end)
