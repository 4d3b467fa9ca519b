"""Validation of links, pairs, drivers and expectations: names, numbers, shapes. No problem hides another."""

from __future__ import annotations

import cmath
from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from typing import Any

import numpy as np

from compoundkin.base.arrays import LONGEST, SHORTEST, Number
from compoundkin.base.errors import Problem, suggestion
from compoundkin.model.attributes import RATES, TIME, VALUE, driver_and_rate
from compoundkin.model.definition import CYLINDERS, DRIVES, MechanismDefinition
from compoundkin.model.elements import Drive, Link
from compoundkin.model.fields import Item, Key
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.cylinder import Cylinder
from compoundkin.model.prescribed_motion import PrescribedMotion

PRINTABLE = "use printable text without dots, commas or outer blanks"
# Two points of one link nearer than this fraction of the mechanism's size are one point: a link of no length.
ZERO_LENGTH = 1e-12
# The numbers that a driver states of its coordinate.
DRIVER_NUMBERS = ("values", *RATES)
# Numbers that are no arrays are tested without NumPy: most mechanisms hold nothing else.
_SCALARS = (complex, float, int)
# An error names so many links.
MOST_NAMED = 12
# A direction in which points of a drawing hardly ever lie one behind the other.
_OBLIQUE = cmath.rect(1.0, 1.0)


def definition_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find all problems of links, pairs, drivers and expectations, in the order of the elements."""
    yield from _element_problems(mechanism)
    yield from _naming_problems(mechanism)
    yield from point_problems(mechanism)
    yield from _auxiliary_problems(mechanism)
    yield from _pair_problems(mechanism)
    yield from _unconnected_links(mechanism)
    yield from _driver_problems(mechanism)
    yield from _mode_problems(mechanism)
    yield from _expectation_problems(mechanism)
    yield from _quantity_problems(mechanism)
    yield from shape_problems(mechanism)


def _element_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    known = "known: link, the pairs such as slide, cylinder, drive, drawn, mode, expect, mass, the loads, outline"
    for index, item in enumerate(mechanism.items):
        if not isinstance(item, Item):
            yield Problem(f"items[{index}]", f"{item!r} is not a word", known)


def _naming_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    if FRAME not in mechanism.links:
        remedy = f"call the fixed link {FRAME!r}; {suggestion(FRAME, list(mechanism.links))}"
        yield Problem("links", f"no link is called {FRAME!r}", remedy)
    seen: set[tuple[str, str]] = set()
    for where, kind, name in _named_elements(mechanism):
        if not is_name(name):
            yield Problem(where, f"{name!r} is not a name", PRINTABLE)
        if (kind, name) in seen:
            one = "there is one frame: give all fixed points to it; " if (kind, name) == ("link", FRAME) else ""
            yield Problem(where, f"the name {name!r} is used twice", f"{one}names are unique")
        seen.add((kind, name))
    for letter in mechanism.carriers:
        if not is_name(letter):
            yield Problem(f"points.{letter}", f"{letter!r} is not a name", PRINTABLE)
        if letter in mechanism.links:
            yield Problem(f"links.{letter}", "a link and a point have the same name", "rename one of them")


def _named_elements(mechanism: MechanismDefinition) -> Iterator[tuple[str, str, str]]:
    """Yield the place, sort and name of each named element. Pairs of all kinds share one namespace."""
    for item in mechanism.parts:
        if isinstance(item, Link) and item.name not in mechanism.auxiliary_links:
            yield f"links.{item.name}", "link", item.name
    for where, pair in mechanism.placed_pairs:
        yield f"{where}.name", "pair", pair.name
    items = [item for item in mechanism.items if isinstance(item, Drive | PrescribedMotion)]
    for index, drive in enumerate(items):
        yield f"{DRIVES}[{index}].name", "drive", drive.name


def is_name(name: str) -> bool:
    """Return whether a text may be a name."""
    return bool(name) and name == name.strip() and is_printable(name)


def is_printable(name: str) -> bool:
    """Return whether a text is printable and has no dots and commas."""
    return name.isprintable() and not set(name) & set(".,")


def _auxiliary_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    letters = {name: link.letters for name, link in mechanism.rigid_links.items()}
    items = [item for item in mechanism.items if isinstance(item, Cylinder)]
    for index, item in enumerate(items):
        yield from item.problems(letters, f"{CYLINDERS}[{index}]")
        if item.name in (other.name for other in items[:index]):
            remedy = "names are unique: give one of them a name"
            yield Problem(f"{CYLINDERS}[{index}].name", f"the name {item.name!r} is used twice", remedy)
    for index, drive in enumerate(item for item in mechanism.items if isinstance(item, Drive | PrescribedMotion)):
        if isinstance(drive, PrescribedMotion):
            yield from drive.problems(letters, f"{DRIVES}[{index}]")
        if isinstance(drive, Drive) and drive.link in mechanism.cylinders and (drive.on, drive.pair) != (FRAME, ""):
            what = f"the cylinder {drive.link!r} is driven by its length, against no other link"
            yield Problem(f"drives[{index}].on", what, "leave `on` and `pair` out")


def _pair_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    letters = {name: link.letters for name, link in mechanism.links.items()}
    for where, pair in mechanism.placed_pairs:
        # what is no number cannot be compared with anything
        yield from list(invalid_numbers(pair, where)) or pair.problems(letters, where)
        shared = mechanism.pins_between(*pair.members[:2])
        if shared:
            yield Problem(where, f"{pair.members[1]!r} and {pair.members[0]!r} are also pinned at {shared[0]}",
                          "give the two points different letters")  # fmt: skip


def _unconnected_links(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find links that no pair joins to another, most often by a misspelt letter."""
    paired = {name for names in mechanism.pins.values() for name in names}
    paired |= {name for pair in mechanism.written_pairs for name in pair.members}
    if len(mechanism.links) < 2:
        return
    for name, link in mechanism.links.items():
        if name in paired or not link.points:
            continue
        others = [k for k, names in mechanism.carriers.items() if name not in names]
        hints = [f"{k}: {suggestion(k, others)}" for k in link.points if suggestion(k, others).startswith("did")]
        hints += [f"{a} and {b} are two letters" for a, b in mechanism.case_slips() if {a, b} & set(link.points)]
        yield Problem(f"links.{name}", f"it is joined to nothing: no other link carries {', '.join(link.points)}",
                      "; ".join(hints) or "share a letter with another link or write a slide")  # fmt: skip


def _driver_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    driven: dict[tuple[str, frozenset[str]], str] = {}
    for where, drive in placed_drives(mechanism):
        unknown = [(k, n) for k, n in (("link", drive.link), ("on", drive.on)) if n not in mechanism.links]
        for key, name in unknown:
            known = [*mechanism.links, *mechanism.cylinders]
            yield Problem(f"{where}.{key}", f"there is no link {name!r}", suggestion(name, known))
        if not unknown:
            choices = mechanism.drivable(drive)
            yield from _driven_pair(drive, choices, where)
            # a multiple pin may be driven once between each two of its links
            place = choices[0] if choices else "", frozenset((drive.link, drive.on))
            if len(choices) == 1 and place in driven:
                yield Problem(
                    where, f"the pair {choices[0]!r} is driven already by {driven[place]!r}", "leave one of them out"
                )
            if len(choices) == 1:
                driven[place] = drive.name
        yield from drive_problems(drive, where)
    if mechanism.time is not None and not is_finite(mechanism.time):
        yield Problem("time", "the times are empty or not finite", "give seconds, in order of the motion")


def _driven_pair(drive: Drive, choices: list[str], where: str) -> Iterator[Problem]:
    what = f"{drive.link!r} and {drive.on!r}"
    if not choices:
        named = f" called {drive.pair!r}" if drive.pair else ""
        yield Problem(
            where, f"there is no pair{named} between {what} to drive", "drive a link against one it is paired with"
        )
    elif len(choices) > 1:
        yield Problem(f"{where}.pair", f"{what} share several pairs", f"name one: {', '.join(choices)}")


def _mode_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    for index, mode in enumerate(mechanism.modes):
        for name in mode.links:
            if name not in mechanism.links:
                yield Problem(
                    f"modes[{index}].links", f"there is no link {name!r}", suggestion(name, list(mechanism.links))
                )


def _expectation_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find expected values that cannot be compared with anything."""
    drives = [drive.name for drive in mechanism.drives]
    # a misspelt drive takes its name from the link; that problem is reported already
    named = all(drive.link in mechanism.links for drive in mechanism.drives)
    for index, expectation in enumerate(mechanism.expectations):
        where = f"expected[{index}]"
        for key, value in expectation.at:
            driver, rate = driver_and_rate(key, drives)
            if named and driver not in drives and key != TIME:
                yield Problem(f"{where}.at.{key}", f"there is no driver {driver!r}", suggestion(driver, drives))
            if rate not in ("", *RATES):
                yield Problem(f"{where}.at.{key}", f"a driver has no {rate!r}", "known: speed, acceleration, jerk")
            if not is_finite(value):
                yield Problem(f"{where}.at.{key}", f"{value!r} is not finite")
        if not is_finite(expectation.value):
            yield Problem(f"{where}.value", f"{expectation.value!r} is not finite")
        if not (is_finite(expectation.tolerance) and expectation.tolerance >= 0):
            what = f"{expectation.tolerance!r} is not a tolerance"
            yield Problem(f"{where}.tolerance", what, "give a number that is not negative")


def _quantity_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find outputs and expected quantities of unknown elements. A multiple pin's pairs are named by their links."""
    named = [*mechanism.carriers, *mechanism.links, *(p.name for p in mechanism.written_pairs)]
    known = dict.fromkeys([*named, *(drive.name for drive in mechanism.drives)])
    named_quantities = [(f"outputs[{k}]", name) for k, name in enumerate(mechanism.outputs)]
    named_quantities += [(f"expected[{k}].quantity", e.quantity) for k, e in enumerate(mechanism.expectations)]
    for where, name in named_quantities:
        owner = name.split("(")[0].split(".")[0]
        if owner not in known:
            yield Problem(where, f"there is no point, link, pair or driver {owner!r}", suggestion(owner, list(known)))
    for k, e in enumerate(mechanism.expectations):
        owner, _, attribute = e.quantity.partition(".")
        # a file must tell by the word alone whether the number is in degrees
        if not attribute or (attribute == VALUE and owner.split("(")[0] in mechanism.pins):
            yield Problem(f"expected[{k}].quantity", f"{e.quantity!r} does not say of what kind the number is",
                          f"write {owner}.angle, {owner}.position or another in full")  # fmt: skip


def point_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find points that are misspelt in the drawing, not numbers, or coincident."""
    size = _sizes(mechanism)
    if np.any((size > 0.0) & (size < SHORTEST)):
        yield _off_scale("links", f"the farthest point is at {np.min(size, where=size > 0.0, initial=np.inf):g}")
    for name, link in mechanism.links.items():
        if not link.points and name not in mechanism.auxiliary_links:
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
        # beside what is too far away all else would be one place
        if not is_too_great(size):
            yield from _lengths(mechanism, name, size)
    for letter, p in mechanism.sketch.items():
        if letter not in mechanism.carriers:
            yield Problem(f"drawn.{letter}", "no link carries this point", suggestion(letter, list(mechanism.carriers)))
        if not is_finite(p):
            yield Problem(f"drawn.{letter}", f"{p!r} is empty or not finite")
        elif is_too_great(p):
            yield _off_scale(f"drawn.{letter}", f"{p!r} is too far away")


def is_finite(value: Any) -> bool:
    """Return whether a value is finite numbers, one or an array of them."""
    try:
        if isinstance(value, _SCALARS):
            return cmath.isfinite(value)
        given = np.asarray(value)
        # to NumPy dates are finite
        return given.dtype.kind not in "mM" and bool(given.size) and bool(np.all(np.isfinite(given)))
    except (TypeError, ValueError, OverflowError):  # a text, a ragged list, a whole number of hundreds of digits
        return False


def is_too_great(value: Any) -> bool:
    """Return whether a finite value, or any entry of an array, is too great to compute with."""
    return bool(np.max(np.abs(value)) > LONGEST)


def _off_scale(where: str, what: str) -> Problem:
    return Problem(where, what, "choose another unit: lengths are between 1e-50 and 1e50 of it")


def _undrawn(letter: str, sketch: Mapping[str, Any]) -> str:
    return f"add {letter} to the drawing; {suggestion(letter, list(sketch))}"


def _lengths(mechanism: MechanismDefinition, name: str, size: Number) -> Iterator[Problem]:
    """Find pinned points of one link that coincide: a link of no length between two pairs."""
    link = mechanism.links[name]
    place = {k: mechanism.sketch.get(k) if p is None else p for k, p in link.points.items()}
    pinned = [(k, p) for k, p in place.items() if k in mechanism.pins and p is not None]
    for a, b in _coincident([p for _, p in pinned], ZERO_LENGTH * size):
        yield Problem(
            f"links.{name}.points.{pinned[b][0]}",
            f"{pinned[a][0]} and {pinned[b][0]} coincide: a link of zero length",
            "move one of them or give both one letter",
        )


def _coincident(points: list[Any], nearer: Number) -> Iterator[tuple[int, int]]:
    """Yield the pairs of points that coincide in any design."""
    if all(isinstance(p, _SCALARS) for p in points):
        yield from sorted(_close_along_line(points, float(np.max(nearer))))
    else:
        for i, p in enumerate(points):
            yield from ((i, j) for j in range(i + 1, len(points)) if np.any(np.abs(points[j] - p) <= nearer))


def _close_along_line(points: list[complex], nearer: float) -> Iterator[tuple[int, int]]:
    """Yield the pairs of points that coincide, comparing each with its neighbours along one direction only."""
    along = sorted(((p * _OBLIQUE).real, i) for i, p in enumerate(points) if cmath.isfinite(p))
    for here, (t, i) in enumerate(along):
        for there in range(here + 1, len(along)):
            farther, j = along[there]
            # twice: rounding of the products
            if farther - t > 2.0 * nearer:
                break
            if abs(points[j] - points[i]) <= nearer:
                yield min(i, j), max(i, j)


def _sizes(mechanism: MechanismDefinition) -> Number:
    """Return the greatest finite coordinate of each design."""
    values = [p for link in mechanism.links.values() for p in link.points.values() if p is not None]
    found = [_largest_value(value) for value in (*values, *mechanism.sketch.values())]
    single = max((one for one in found if not np.ndim(one)), default=0.0)
    try:
        return reduce(np.maximum, (one for one in found if np.ndim(one)), single)
    except ValueError:
        # designs whose shapes differ are another problem
        return max(float(np.max(one)) for one in found)


def _largest_value(value: Any) -> Number:
    """Return the greatest finite absolute value, of each design."""
    if isinstance(value, _SCALARS):
        return abs(value) if cmath.isfinite(value) else 0.0
    known = np.where(np.isfinite(value), np.abs(value), 0.0)
    return np.max(known, axis=-1, keepdims=True, initial=0.0) if known.ndim > 1 else float(np.max(known, initial=0.0))


def invalid_numbers(pair: Pair, where: str) -> Iterator[Problem]:
    """Find values of a pair that are not real numbers or flags."""
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
    """Find invalid numbers of a driver, and numbers beside a law."""
    for key in DRIVER_NUMBERS:
        value = getattr(drive, key)
        if value is not None and not is_finite(value):
            yield Problem(f"{where}.{key}", "the value is empty or not finite")
        elif value is not None and is_too_great(value):
            yield _off_scale(f"{where}.{key}", "the value is too great")
    for key, default in ((key.name, key.default) for key in drive.keys if key.name in DRIVER_NUMBERS):
        if drive.law is not None and not np.array_equal(getattr(drive, key), default):
            remedy = f"leave the {key} or the law out"
            yield Problem(f"{where}.{key}", "the driver has a law as well, which says how it moves", remedy)


def placed_drives(mechanism: MechanismDefinition) -> list[tuple[str, Drive]]:
    """Return each driver with its place in a file."""
    found: list[tuple[str, Drive]] = []
    items = [item for item in mechanism.items if isinstance(item, Drive | PrescribedMotion)]
    for index, item in enumerate(items):
        count = len(item.drivers) if isinstance(item, PrescribedMotion) else 1
        if mechanism.prescribed_motions.get(item.name) is item or (
            isinstance(item, Drive) and item.link not in mechanism.invalid_cylinders
        ):
            found += [(f"{DRIVES}[{index}]", drive) for drive in mechanism.drives[len(found) : len(found) + count]]
    return found


def shape_problems(mechanism: MechanismDefinition) -> Iterator[Problem]:
    """Find arrays that do not broadcast together."""
    shapes: list[tuple[str, tuple[int, ...]]] = []
    for name, link in mechanism.links.items():
        arrays = ((k, p) for k, p in link.points.items() if not (p is None or isinstance(p, _SCALARS)))
        shapes += [(f"links.{name}.points.{k}", np.shape(p)) for k, p in arrays]
    shapes += [(f"drawn.{k}", np.shape(p)) for k, p in mechanism.sketch.items()]
    for where, pair in mechanism.placed_pairs:
        numbers = ((key, value) for key in pair.keys for value in _numbers_of(pair, key))
        # what is not an array at all is reported already
        shapes += [(f"{where}.{key.name}", np.shape(value)) for key, value in numbers if is_finite(value)]
    for place, drive in placed_drives(mechanism):
        numbers_of_drive = ((k, getattr(drive, k)) for k in DRIVER_NUMBERS)
        shapes += [(f"{place}.{k}", np.shape(value)) for k, value in numbers_of_drive if value is not None]
    yield from broadcast_problems(shapes)


def broadcast_problems(shapes: Iterable[tuple[str, tuple[int, ...]]]) -> Iterator[Problem]:
    """Find arrays, by their places and shapes, that do not broadcast with those before them."""
    total: tuple[int, ...] = ()
    for where, shape in shapes:
        try:
            total = np.broadcast_shapes(total, shape) if shape else total
        except ValueError:
            what = f"shape {shape} does not broadcast with {total}"
            yield Problem(where, what, "give a new axis to designs: the last axis is the motion")


def point_shapes(mechanism: MechanismDefinition) -> list[tuple[str, tuple[int, ...]]]:
    """Return the shapes of points that are arrays, with their places."""
    return [(f"links.{name}.points.{letter}", np.shape(place)) for name, link in mechanism.links.items()
            for letter, place in link.points.items() if isinstance(place, np.ndarray)]  # fmt: skip


def missing_places(unplaced: Mapping[str, tuple[str, ...]]) -> Iterator[Problem]:
    """Find links with points without a place, and say how to give them one."""
    for number, (name, letters) in enumerate(unplaced.items()):
        if number == MOST_NAMED:
            yield Problem("links", f"{len(unplaced) - number} more links have points without a place")
            return
        what = f"{'the point' if len(letters) == 1 else 'the points'} {', '.join(letters)}"
        what += f" of {name!r} {'has' if len(letters) == 1 else 'have'} no place"
        remedy = f"give all coordinates as {letters[0]} = (x, y), or a place in the drawing; the structure needs none"
        yield Problem(f"links.{name}.points", what, "" if number else remedy)
