"""Validation of outlines: their numbers, their places, and polygons that cross themselves."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from compoundkin.base.arrays import Number, cross
from compoundkin.base.errors import Problem, suggestion
from compoundkin.model.definition import MechanismDefinition
from compoundkin.model.fields import NameWording, name_problems
from compoundkin.model.loads.contract import NamedParts
from compoundkin.model.outlines import OUTLINES, LinkOutline
from compoundkin.model.validation import (
    PRINTABLE,
    broadcast_problems,
    is_finite,
    is_printable,
    is_too_great,
    point_shapes,
)

_OUTLINE_LENGTHS = ("width", "radius", "pin")
# How many places each list needs.
_FEWEST_CORNERS = {"through": 2, "polygon": 3}


def outline_problems(mechanism: MechanismDefinition, names: NamedParts) -> list[Problem]:
    """Return the problems of outlines."""
    found: list[Problem] = []
    for where, item in placed_outlines(mechanism):
        numbers = list(_invalid_outline_numbers(where, item))
        found += numbers or [
            *_outline_reference_problems(where, item, names),
            *_outline_place_problems(where, item, mechanism),
        ]
    return [*found, *_repeated_outlines(mechanism), *_outline_shape_problems(mechanism)]


def placed_outlines(mechanism: MechanismDefinition) -> Iterator[tuple[str, LinkOutline]]:
    """Yield each outline with its place in a file."""
    items = [item for item in mechanism.items if isinstance(item, LinkOutline)]
    yield from ((f"{OUTLINES}[{index}]", item) for index, item in enumerate(items))


def outline_designs(mechanism: MechanismDefinition) -> Iterator[tuple[str, Number]]:
    """Yield the arrays of outlines over designs with their places."""
    for where, item in placed_outlines(mechanism):
        yield from ((f"{where}.{key}", value) for key, value in _outline_numbers(item) if np.ndim(value) > 1)


def _outline_numbers(item: LinkOutline) -> Iterator[tuple[str, Any]]:
    """Yield the numbers and places that an outline holds, by their keys."""
    yield from ((key, getattr(item, key)) for key in _OUTLINE_LENGTHS if getattr(item, key) is not None)
    if item.at is not None and not isinstance(item.at, str):
        yield "at", item.at
    for key in _FEWEST_CORNERS:
        yield from ((f"{key}[{k}]", one) for k, one in enumerate(getattr(item, key)) if not isinstance(one, str))


def _invalid_outline_numbers(where: str, item: LinkOutline) -> Iterator[Problem]:
    """Find values that are empty, not finite, not positive, or that would change along the motion."""
    for key, value in _outline_numbers(item):
        if not is_finite(value):
            yield Problem(f"{where}.{key}", "the value is empty or not finite")
        elif is_too_great(value):
            yield Problem(f"{where}.{key}", "it is too great", "choose another unit")
        elif np.ndim(value) and np.shape(value)[-1] > 1:
            what = f"it holds {np.shape(value)[-1]} numbers along the motion, in which an outline cannot change"
            yield Problem(f"{where}.{key}", what, "give one number, or one for each design: [[8], [10]]")
        elif key in _OUTLINE_LENGTHS and not np.all(np.asarray(value) > 0.0):
            yield Problem(f"{where}.{key}", f"a {key} is above zero, not {float(np.min(value)):g}")


def _outline_reference_problems(where: str, item: LinkOutline, names: NamedParts) -> Iterator[Problem]:
    """Find unknown links and points, and missing dimensions."""
    yield from name_problems(item, names.letters, where, NameWording())
    letters = names.letters.get(item.link, ())
    for key, fewest in _FEWEST_CORNERS.items():
        given = getattr(item, key)
        if given and len(given) < fewest:
            yield Problem(f"{where}.{key}", f"{len(given)} places are too few", f"give {fewest} or more")
        for k, one in enumerate(given if letters else ()):
            if isinstance(one, str) and one not in letters:
                what = f"link {item.link!r} has no point {one!r}"
                yield Problem(f"{where}.{key}[{k}]", what, suggestion(one, list(letters)))
    if not item.polygon and all(getattr(item, key) is None for key in _OUTLINE_LENGTHS):
        yield Problem(where, "it says no shape", "give a width, a radius, a polygon or the diameter of pins")
    if item.through and item.width is None:
        yield Problem(f"{where}.width", "bars through points need a width", "give the width")


def _outline_place_problems(where: str, item: LinkOutline, mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find a disc without a centre, a centre without a disc, and a pin that joins nothing."""
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


def is_joined(mechanism: MechanismDefinition, letter: str) -> bool:
    """Tell whether a pin or another pair joins links at a point."""
    return letter in mechanism.real_pins or any(letter in pair.letters for pair in mechanism.real_pairs)


def _repeated_outlines(mechanism: MechanismDefinition) -> Iterator[Problem]:
    seen = set[str]()
    for where, item in placed_outlines(mechanism):
        if not is_printable(item.name):
            yield Problem(f"{where}.name", f"{item.name!r} is not a name", PRINTABLE)
        if item.name in seen:
            yield Problem(where, f"the name {item.name!r} is used twice", "give one of both outlines a name")
        seen.add(item.name)


def _outline_shape_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find arrays of outlines that do not broadcast with each other and with the points of links."""
    shapes = [(where, np.shape(value)) for where, value in outline_designs(mechanism)]
    if shapes:
        yield from broadcast_problems([*point_shapes(mechanism), *shapes])


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
    """Return whether two sides of a polygon (corners, ...) share a point other than their common corner."""
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
    return bool(np.any(split & (cross(d - c, a - c) * cross(d - c, b - c) <= 0.0) & _boxes_overlap(a, b, c, d)))


def _boxes_overlap(a: Number, b: Number, c: Number, d: Number) -> Number:
    """Return which sides have bounding boxes that meet; for sides on one line the products above vanish."""
    return (
        (np.minimum(a.real, b.real) <= np.maximum(c.real, d.real))
        & (np.minimum(c.real, d.real) <= np.maximum(a.real, b.real))
        & (np.minimum(a.imag, b.imag) <= np.maximum(c.imag, d.imag))
        & (np.minimum(c.imag, d.imag) <= np.maximum(a.imag, b.imag))
    )
