"""What can be wrong with the outlines of links."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from compoundkin.base.arrays import cross
from compoundkin.base.errors import Problem, nearest
from compoundkin.base.series import Number
from compoundkin.model.fields import NameWording, name_problems
from compoundkin.model.loads.contract import WrittenNames
from compoundkin.model.number_problems import is_finite, is_too_great
from compoundkin.model.outlines.link_outline import OUTLINES, LinkOutline
from compoundkin.model.written import Written

_LENGTHS = ("width", "radius", "pin")
# How many places each list needs.
_FEWEST = {"through": 2, "polygon": 3}


def outline_problems(mechanism: Written, names: WrittenNames) -> list[Problem]:
    """Return what is wrong with outlines, well written or not."""
    found: list[Problem] = []
    for where, item in placed_outlines(mechanism):
        numbers = list(_no_numbers(where, item))
        found += numbers or [*_wrong(where, item, names), *_wrong_place(where, item, mechanism)]
    return [*found, *_used_twice(mechanism), *_shapes(mechanism)]


def placed_outlines(mechanism: Written) -> Iterator[tuple[str, LinkOutline]]:
    """Yield each outline with its place in a file."""
    items = [item for item in mechanism.items if isinstance(item, LinkOutline)]
    yield from ((f"{OUTLINES}[{index}]", item) for index, item in enumerate(items))


def outline_designs(mechanism: Written) -> Iterator[tuple[str, Number]]:
    """Yield the arrays of outlines over designs with their places."""
    for where, item in placed_outlines(mechanism):
        yield from ((f"{where}.{key}", value) for key, value in _numbers(item) if np.ndim(value) > 1)


def _numbers(item: LinkOutline) -> Iterator[tuple[str, Any]]:
    """Yield the numbers and places that an outline holds, by their keys."""
    yield from ((key, getattr(item, key)) for key in _LENGTHS if getattr(item, key) is not None)
    if item.at is not None and not isinstance(item.at, str):
        yield "at", item.at
    for key in _FEWEST:
        yield from ((f"{key}[{k}]", one) for k, one in enumerate(getattr(item, key)) if not isinstance(one, str))


def _no_numbers(where: str, item: LinkOutline) -> Iterator[Problem]:
    """Find what is empty or not finite, not above zero, or would change along the motion."""
    for key, value in _numbers(item):
        if not is_finite(value):
            yield Problem(f"{where}.{key}", "the value is empty or not finite")
        elif is_too_great(value):
            yield Problem(f"{where}.{key}", "it is too great", "choose another unit")
        elif np.ndim(value) and np.shape(value)[-1] > 1:
            what = f"it holds {np.shape(value)[-1]} numbers along the motion, in which an outline cannot change"
            yield Problem(f"{where}.{key}", what, "give one number, or one for each design: [[8], [10]]")
        elif key in _LENGTHS and not np.all(np.asarray(value) > 0.0):
            yield Problem(f"{where}.{key}", f"a {key} is above zero, not {float(np.min(value)):g}")


def _wrong(where: str, item: LinkOutline, names: WrittenNames) -> Iterator[Problem]:
    """Find unknown links and points, and what an outline leaves out."""
    yield from name_problems(item, names.letters, where, NameWording())
    letters = names.letters.get(item.link, ())
    for key, fewest in _FEWEST.items():
        given = getattr(item, key)
        if given and len(given) < fewest:
            yield Problem(f"{where}.{key}", f"{len(given)} places are too few", f"give {fewest} or more")
        for k, one in enumerate(given if letters else ()):
            if isinstance(one, str) and one not in letters:
                what = f"link {item.link!r} has no point {one!r}"
                yield Problem(f"{where}.{key}[{k}]", what, nearest(one, list(letters)))
    if not item.polygon and all(getattr(item, key) is None for key in _LENGTHS):
        yield Problem(where, "it says no shape", "give a width, a radius, a polygon or the diameter of pins")
    if item.through and item.width is None:
        yield Problem(f"{where}.width", "bars through points need a width", "give the width")


def _wrong_place(where: str, item: LinkOutline, mechanism: Written) -> Iterator[Problem]:
    """Find a disc without a middle, a middle of nothing, and a pin that joins nothing."""
    letters = mechanism.links[item.link].letters if item.link in mechanism.links else ()
    choice = f"name a point: {', '.join(letters)}"
    if item.radius is not None and item.at is None:
        yield Problem(f"{where}.at", "a disc needs its middle", choice)
    if item.at is not None and item.radius is None and item.pin is None:
        yield Problem(f"{where}.at", "it is the middle of no disc and of no pin", "give a radius, or leave it out")
    if item.pin is None or not letters:
        return
    joined = [letter for letter in letters if is_joined(mechanism, letter)]
    if item.at is not None and not isinstance(item.at, str):
        yield Problem(f"{where}.at", "a pin is at a point", choice)
    elif not joined or (item.at in letters and item.at not in joined):
        what = f"no pin joins {item.link!r} to another link{f' at {item.at}' if item.at else ''}"
        yield Problem(f"{where}.pin", what, "leave it out, or write a disc with a radius")


def is_joined(mechanism: Written, letter: str) -> bool:
    """Tell whether a pin or another pair joins links at a point."""
    return letter in mechanism.real_pins or any(letter in pair.letters for pair in mechanism.real_pairs)


def _used_twice(mechanism: Written) -> Iterator[Problem]:
    seen = set[str]()
    for where, item in placed_outlines(mechanism):
        if not (item.name.isprintable() and not set(item.name) & set(".,")):
            yield Problem(f"{where}.name", f"{item.name!r} is not a name", "use printable text without dots, commas")
        if item.name in seen:
            yield Problem(where, f"the name {item.name!r} is used twice", "give one of both outlines a name")
        seen.add(item.name)


def _shapes(mechanism: Written) -> Iterator[Problem]:
    """Find arrays of outlines that do not broadcast with each other and with the points of links."""
    total: tuple[int, ...] = ()
    points = [(f"links.{name}.points.{letter}", np.shape(place)) for name, link in mechanism.links.items()
              for letter, place in link.points.items() if isinstance(place, np.ndarray)]  # fmt: skip
    held = [(where, np.shape(value)) for where, value in outline_designs(mechanism)]
    for place, shape in [*points, *held] if held else ():
        try:
            total = np.broadcast_shapes(total, shape)
        except ValueError:
            what = f"shape {shape} does not broadcast with {total}"
            yield Problem(place, what, "give a new axis to designs: the last axis is the motion")


def crossed_polygons(mechanism: Any) -> Iterator[Problem]:
    """Find polygons that cross themselves, or that have no area, in any design."""
    for where, item in placed_outlines(mechanism):
        points = mechanism.geometry.points.get(item.link, {})
        if not item.polygon:
            continue
        corners = [points[one] if isinstance(one, str) else one for one in item.polygon]
        if _crosses(np.stack(np.broadcast_arrays(*corners))):
            yield Problem(
                f"{where}.polygon", "its sides cross, touch, or have no length", "give its corners in order all around"
            )


def _crosses(corners: Number) -> bool:
    """Tell whether two sides of a polygon, (corners, ...), have a point in common that is no common corner."""
    count = len(corners)
    start, stop = corners, np.roll(corners, -1, axis=0)
    one, other = np.triu_indices(count, 1)
    apart = (other - one > 1) & (other - one < count - 1)
    sides: Number = np.abs(stop - start)
    if np.any(sides == 0.0):
        return True
    back = np.conjugate(np.roll(start, 1, axis=0) - start) * (stop - start)
    # a corner at which the line runs back over itself
    if np.any((back.imag == 0.0) & (back.real > 0.0)):
        return True
    a, b, c, d = start[one[apart]], stop[one[apart]], start[other[apart]], stop[other[apart]]
    split = cross(b - a, c - a) * cross(b - a, d - a) <= 0.0
    return bool(np.any(split & (cross(d - c, a - c) * cross(d - c, b - c) <= 0.0) & _near(a, b, c, d)))


def _near(a: Number, b: Number, c: Number, d: Number) -> Number:
    """Tell which sides have boxes that meet: on one line the products above say nothing."""
    return (
        (np.minimum(a.real, b.real) <= np.maximum(c.real, d.real))
        & (np.minimum(c.real, d.real) <= np.maximum(a.real, b.real))
        & (np.minimum(a.imag, b.imag) <= np.maximum(c.imag, d.imag))
        & (np.minimum(c.imag, d.imag) <= np.maximum(a.imag, b.imag))
    )
