"""The points of links as dimensions by name: how far from the link's first point, and in which direction."""

from __future__ import annotations

from collections.abc import Mapping
from math import atan2, degrees, hypot

from compoundkin.files.exact_numbers import point as as_written
from compoundkin.files.exchange.geogebra.dragged_construction import Construction
from compoundkin.files.exchange.geogebra.polar_sums import Angle, Way, along, at, named
from compoundkin.model.geometry import FRAME

# Numbers with at most so many characters are those that somebody wrote.
_WRITTEN = 9


class LinkPoints:
    """The points of a link from the first of them on.

    `places` are the numbers, from the origin of the link's frame; `base` is the place of the first point.
    """

    def __init__(self, places: Mapping[str, complex], ways: Mapping[str, Way], base: complex) -> None:
        self.places, self.ways, self.base = places, ways, base


def link_points(build: Construction, name: str, places: Mapping[str, complex]) -> LinkPoints:
    """Return a link's points, which are free in the frame, else dimensions."""
    if name == FRAME:
        return LinkPoints(places, {k: at(build.free_point(k, place)) for k, place in places.items()}, 0j)
    first = next((k for k, place in places.items() if place == 0), next(iter(places), ""))
    base = places.get(first, 0j)
    ways = {k: Way() if k == first else dimensioned(build, first + k, p - base, name) for k, p in places.items()}
    return LinkPoints(places, ways, base)


def dimensioned(build: Construction, index: str, place: complex, of: str) -> Way:
    """Return a way by new numbers: length and angle, or coordinates if written so."""
    x, y = place.real, place.imag
    if not x and not y:
        return Way()
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
