"""What can be wrong with the numbers of a mechanism. Points, dimensions, rates, and shapes of arrays."""

from __future__ import annotations

import cmath
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from compoundkin.base.arrays import LONGEST, SHORTEST
from compoundkin.base.errors import Problem, nearest
from compoundkin.model.attributes import RATES
from compoundkin.model.elements import Drive, Lead
from compoundkin.model.fields import Key
from compoundkin.model.pairs import Pair
from compoundkin.model.written import DRIVES, Written

# Two points of one link nearer than this fraction of the mechanism's size are one point: a link of no length.
ZERO_LENGTH = 1e-12

# What a driver says of its coordinate in numbers.
DRIVEN = ("values", *RATES)

# What is no array, and is looked at without NumPy: most mechanisms hold nothing else.
_NUMBERS = (complex, float, int)
# An error names so many links.
MOST_NAMED = 12
# A direction in which points of a drawing hardly ever lie one behind the other.
_OBLIQUE = cmath.rect(1.0, 1.0)


def point_problems(mechanism: Written) -> Iterator[Problem]:
    """Find points that are misspelt in the drawing, no numbers, or coincident."""
    size = _size(mechanism)
    if 0.0 < size < SHORTEST:
        yield _off_scale("links", f"the farthest point is at {size:g}")
    for name, link in mechanism.links.items():
        if not link.points and name not in mechanism.led_links:
            yield Problem(f"links.{name}.points", "a link needs at least one point")
        for letter, p in link.points.items():
            where = f"links.{name}.points.{letter}"
            if p is None and letter not in mechanism.sketch and not set(mechanism.sketch) <= set(mechanism.carriers):
                # the drawing has a letter that no link has: one of the two is misspelt
                yield Problem(where, "this point is neither given nor drawn", _undrawn(letter, mechanism.sketch))
            elif p is not None and not is_finite(p):
                yield Problem(where, f"{p!r} is empty or not finite")
            elif p is not None and is_too_great(p):
                yield _off_scale(where, f"{p!r} is too far away")
        yield from _lengths(mechanism, name, size)
    for letter, p in mechanism.sketch.items():
        if letter not in mechanism.carriers:
            yield Problem(f"drawn.{letter}", "no link carries this point", nearest(letter, list(mechanism.carriers)))
        if not is_finite(p):
            yield Problem(f"drawn.{letter}", f"{p!r} is empty or not finite")
        elif is_too_great(p):
            yield _off_scale(f"drawn.{letter}", f"{p!r} is too far away")


def is_finite(value: Any) -> bool:
    """Return whether a value is finite numbers, one or an array of them."""
    try:
        if isinstance(value, _NUMBERS):
            return cmath.isfinite(value)
        given = np.asarray(value)
        # to NumPy dates are finite
        return given.dtype.kind not in "mM" and bool(given.size) and bool(np.all(np.isfinite(given)))
    except (TypeError, ValueError, OverflowError):  # a text, a ragged list, a whole number of hundreds of digits
        return False


def is_too_great(value: Any) -> bool:
    """Return whether a finite value is beyond what can be computed with. Of an array, any."""
    return bool(np.max(np.abs(value)) > LONGEST)


def _off_scale(where: str, what: str) -> Problem:
    return Problem(where, what, "choose another unit: lengths are between 1e-50 and 1e50 of it")


def _undrawn(letter: str, sketch: Mapping[str, Any]) -> str:
    return f"add {letter} to the drawing; {nearest(letter, list(sketch))}"


def _lengths(mechanism: Written, name: str, size: float) -> Iterator[Problem]:
    """Pinned points of one link that coincide. A link of no length between two pairs."""
    link = mechanism.links[name]
    place = {k: mechanism.sketch.get(k) if p is None else p for k, p in link.points.items()}
    pinned = [(k, p) for k, p in place.items() if k in mechanism.pins and p is not None]
    for a, b in _coincident([p for _, p in pinned], ZERO_LENGTH * size):
        yield Problem(
            f"links.{name}.points.{pinned[b][0]}",
            f"{pinned[a][0]} and {pinned[b][0]} coincide: a link of zero length",
            "move one of them or give both one letter",
        )


def _coincident(points: list[Any], nearer: float) -> Iterator[tuple[int, int]]:
    """Yield the pairs of points that coincide in any design."""
    if all(isinstance(p, _NUMBERS) for p in points):
        yield from sorted(_near_in_order(points, nearer))
    else:
        for i, p in enumerate(points):
            yield from ((i, j) for j in range(i + 1, len(points)) if np.any(np.abs(points[j] - p) <= nearer))


def _near_in_order(points: list[complex], nearer: float) -> Iterator[tuple[int, int]]:
    """Yield the pairs of points that coincide. Each is held against those next to it along one direction only."""
    along = sorted(((p * _OBLIQUE).real, i) for i, p in enumerate(points) if cmath.isfinite(p))
    for here, (t, i) in enumerate(along):
        for there in range(here + 1, len(along)):
            farther, j = along[there]
            # twice: rounding of the products
            if farther - t > 2.0 * nearer:
                break
            if abs(points[j] - points[i]) <= nearer:
                yield min(i, j), max(i, j)


def _size(mechanism: Written) -> float:
    values = [p for link in mechanism.links.values() for p in link.points.values() if p is not None]
    return max(map(_greatest, [*values, *mechanism.sketch.values()]), default=0.0)


def _greatest(value: Any) -> float:
    """Return the greatest absolute value, of what is finite."""
    if isinstance(value, _NUMBERS):
        return abs(value) if cmath.isfinite(value) else 0.0
    return float(np.max(np.abs(np.asarray(value))[np.isfinite(value)], initial=0.0))


def no_numbers(pair: Pair, where: str) -> Iterator[Problem]:
    """Find what a pair holds in place of real numbers or flags."""
    for key in pair.keys:
        for value in _numbers_of(pair, key):
            if not is_finite(value) or np.iscomplexobj(value):
                yield Problem(f"{where}.{key.name}", f"{value!r} is empty or not finite, or not a number")
            elif is_too_great(value):
                yield _off_scale(f"{where}.{key.name}", f"{value!r} is too great")
        flag = getattr(pair, key.name, None)
        if key.kind == "flag" and not isinstance(flag, bool | np.bool_):
            yield Problem(f"{where}.{key.name}", f"{flag!r} is neither True nor False")


def _numbers_of(pair: Pair, key: Key) -> tuple[Any, ...]:
    """Return the numbers and arrays that a pair holds under a key."""
    value: Any = getattr(pair, key.name, None)
    if key.kind in ("reach", "sweep"):
        ends = value if isinstance(value, tuple | list) else (value,)
        return tuple(end for end in ends if end is not None and not isinstance(end, str))
    if key.kind not in ("length", "angle", "two") or (value is None and key.default is None and not key.required):
        return ()
    return value if key.kind == "two" else (value,)


def drive_problems(drive: Drive, where: str) -> Iterator[Problem]:
    """Find a driver's numbers that are none, or that stand beside a law."""
    for key in DRIVEN:
        value = getattr(drive, key)
        if value is not None and not is_finite(value):
            yield Problem(f"{where}.{key}", "the value is empty or not finite")
        elif value is not None and is_too_great(value):
            yield _off_scale(f"{where}.{key}", "the value is too great")
    for key, default in ((key.name, key.default) for key in drive.keys if key.name in DRIVEN):
        if drive.law is not None and not np.array_equal(getattr(drive, key), default):
            remedy = f"leave the {key} or the law out"
            yield Problem(f"{where}.{key}", "the driver has a law as well, which says how it moves", remedy)


def placed_drives(mechanism: Written) -> list[tuple[str, Drive]]:
    """Return each driver with its place in a file."""
    found: list[tuple[str, Drive]] = []
    items = [item for item in mechanism.items if isinstance(item, Drive | Lead)]
    for index, item in enumerate(items):
        count = len(item.drivers) if isinstance(item, Lead) else 1
        if mechanism.leads.get(item.name) is item or (
            isinstance(item, Drive) and item.link not in mechanism.bad_cylinders
        ):
            found += [(f"{DRIVES}[{index}]", drive) for drive in mechanism.drives[len(found) : len(found) + count]]
    return found


def shape_problems(mechanism: Written) -> Iterator[Problem]:
    """Find arrays that do not broadcast together."""
    shapes: list[tuple[str, tuple[int, ...]]] = []
    for name, link in mechanism.links.items():
        arrays = ((k, p) for k, p in link.points.items() if not (p is None or isinstance(p, _NUMBERS)))
        shapes += [(f"links.{name}.points.{k}", np.shape(p)) for k, p in arrays]
    shapes += [(f"drawn.{k}", np.shape(p)) for k, p in mechanism.sketch.items()]
    for where, pair in mechanism.placed_pairs:
        numbers = ((key, value) for key in pair.keys for value in _numbers_of(pair, key))
        # what is no array at all is told of already
        shapes += [(f"{where}.{key.name}", np.shape(value)) for key, value in numbers if is_finite(value)]
    for place, drive in placed_drives(mechanism):
        shapes += [(f"{place}.{k}", np.shape(getattr(drive, k))) for k in DRIVEN if getattr(drive, k) is not None]
    total: tuple[int, ...] = ()
    for where, shape in shapes:
        if not shape:
            continue
        try:
            total = np.broadcast_shapes(total, shape)
        except ValueError:
            yield Problem(
                where,
                f"shape {shape} does not broadcast with {total}",
                "give a new axis to designs: the last axis is the motion",
            )


def places_wanted(unplaced: Mapping[str, tuple[str, ...]]) -> Iterator[Problem]:
    """Name links whose points have no place, and say how to give them one."""
    for number, (name, letters) in enumerate(unplaced.items()):
        if number == MOST_NAMED:
            yield Problem("links", f"{len(unplaced) - number} more links have points without a place")
            return
        what = f"{'the point' if len(letters) == 1 else 'the points'} {', '.join(letters)}"
        what += f" of {name!r} {'has' if len(letters) == 1 else 'have'} no place"
        remedy = f"give all coordinates as {letters[0]} = (x, y), or a place in the drawing; the structure needs none"
        yield Problem(f"links.{name}.points", what, "" if number else remedy)
