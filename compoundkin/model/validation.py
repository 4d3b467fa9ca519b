"""What can be wrong with a mechanism as written; every problem is found, none hides another."""

from __future__ import annotations

import cmath
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.errors import Problem, nearest
from compoundkin.model.attributes import TIME
from compoundkin.model.elements import FRAME, Drive, Item, Link

if TYPE_CHECKING:
    from compoundkin.model.fields import Key
    from compoundkin.model.mechanism import Mechanism
    from compoundkin.model.pairs import Pair

# Two points of one link nearer than this fraction of the mechanism's size are one point: a link of no length.
ZERO_LENGTH = 1e-12

# What is no array, and is looked at without NumPy: most mechanisms hold nothing else.
_NUMBERS = (complex, float, int)
# A direction in which points of a drawing hardly ever lie one behind the other.
_OBLIQUE = cmath.rect(1.0, 1.0)


def problems_of(mechanism: Mechanism) -> Iterator[Problem]:
    """All problems, in the order of the words."""
    yield from _words(mechanism)
    yield from _names(mechanism)
    yield from _points(mechanism)
    yield from _pairs(mechanism)
    yield from _joined(mechanism)
    yield from _drives(mechanism)
    yield from _modes(mechanism)
    yield from _expectations(mechanism)
    yield from _quantities(mechanism)
    yield from _shapes(mechanism)


def _words(mechanism: Mechanism) -> Iterator[Problem]:
    """What is not a word at all."""
    for index, item in enumerate(mechanism.items):
        if not isinstance(item, Item):
            yield Problem(
                f"items[{index}]",
                f"{item!r} is not a word",
                "known: link, the pairs such as slide, drive, drawn, mode, expect",
            )


def _names(mechanism: Mechanism) -> Iterator[Problem]:
    if FRAME not in mechanism.links:
        yield Problem(
            "links",
            f"no link is called {FRAME!r}",
            f"call the fixed link {FRAME!r}; {nearest(FRAME, list(mechanism.links))}",
        )
    seen: set[tuple[str, str]] = set()
    for where, kind, name in _named(mechanism):
        if not _is_name(name):
            yield Problem(where, f"{name!r} is not a name", "use printable text without dots, commas or outer blanks")
        if (kind, name) in seen:
            one = "there is one frame: give all fixed points to it; " if (kind, name) == ("link", FRAME) else ""
            yield Problem(where, f"the name {name!r} is used twice", f"{one}names are unique")
        seen.add((kind, name))
    for letter in mechanism.carriers:
        if not _is_name(letter):
            yield Problem(
                f"points.{letter}",
                f"{letter!r} is not a name",
                "use printable text without dots, commas or outer blanks",
            )
        if letter in mechanism.links:
            yield Problem(f"links.{letter}", "a link and a point have the same name", "rename one of them")


def _named(mechanism: Mechanism) -> Iterator[tuple[str, str, str]]:
    """The place, sort and name of everything that has one; pairs of all kinds share their names."""
    for item in mechanism.items:
        if isinstance(item, Link):
            yield f"links.{item.name}", "link", item.name
    for where, pair in _placed(mechanism.written_pairs):
        yield f"{where}.name", "pair", pair.name
    for index, drive in enumerate(mechanism.drives):
        yield f"drives[{index}].name", "drive", drive.name


def _is_name(name: str) -> bool:
    return bool(name) and name == name.strip() and name.isprintable() and not set(name) & set(".,")


def _points(mechanism: Mechanism) -> Iterator[Problem]:
    size = _size(mechanism)
    for name, link in mechanism.links.items():
        if not link.points:
            yield Problem(f"links.{name}.points", "a link needs at least one point")
        for letter, p in link.points.items():
            where = f"links.{name}.points.{letter}"
            if p is None and letter not in mechanism.sketch:
                yield Problem(where, "this point is neither given nor drawn", _undrawn(letter, mechanism.sketch))
            elif p is not None and not _is_finite(p):
                yield Problem(where, f"{p!r} is empty or not finite")
        yield from _lengths(mechanism, name, size)
    for letter, p in mechanism.sketch.items():
        if letter not in mechanism.carriers:
            yield Problem(f"drawn.{letter}", "no link carries this point", nearest(letter, list(mechanism.carriers)))
        if not _is_finite(p):
            yield Problem(f"drawn.{letter}", f"{p!r} is empty or not finite")


def _is_finite(value: Any) -> bool:
    try:
        if isinstance(value, _NUMBERS):
            return cmath.isfinite(value)
        return bool(np.size(value)) and bool(np.all(np.isfinite(value)))
    except (TypeError, ValueError, OverflowError):  # a text, a ragged list, a whole number of hundreds of digits
        return False


def _undrawn(letter: str, sketch: Mapping[str, Any]) -> str:
    return f"add {letter} to the drawing" + (f"; {nearest(letter, list(sketch))}" if sketch else "")


def _lengths(mechanism: Mechanism, name: str, size: float) -> Iterator[Problem]:
    """Pinned points of one link that coincide: a link of no length between two pairs."""
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
    """The pairs of points that coincide in any design."""
    if all(isinstance(p, _NUMBERS) for p in points):
        yield from sorted(_near_in_order(points, nearer))
    else:
        for i, p in enumerate(points):
            yield from ((i, j) for j in range(i + 1, len(points)) if np.any(np.abs(points[j] - p) <= nearer))


def _near_in_order(points: list[complex], nearer: float) -> Iterator[tuple[int, int]]:
    """The pairs of points that coincide; each is held against those next to it along one direction only."""
    along = sorted(((p * _OBLIQUE).real, i) for i, p in enumerate(points) if cmath.isfinite(p))
    for here, (t, i) in enumerate(along):
        for there in range(here + 1, len(along)):
            farther, j = along[there]
            # twice: rounding of the products
            if farther - t > 2.0 * nearer:
                break
            if abs(points[j] - points[i]) <= nearer:
                yield min(i, j), max(i, j)


def _size(mechanism: Mechanism) -> float:
    values = [p for link in mechanism.links.values() for p in link.points.values() if p is not None]
    return max(map(_greatest, [*values, *mechanism.sketch.values()]), default=0.0)


def _greatest(value: Any) -> float:
    """The greatest absolute value, of what is finite."""
    if isinstance(value, _NUMBERS):
        return abs(value) if cmath.isfinite(value) else 0.0
    return float(np.max(np.abs(np.asarray(value))[np.isfinite(value)], initial=0.0))


def _pairs(mechanism: Mechanism) -> Iterator[Problem]:
    letters = {name: link.letters for name, link in mechanism.links.items()}
    for where, pair in _placed(mechanism.written_pairs):
        # what is no number cannot be compared with anything
        yield from list(_no_numbers(pair, where)) or pair.problems(letters, where)
        shared = mechanism.pins_between(*pair.members[:2])
        if shared:
            yield Problem(where, f"{pair.members[1]!r} and {pair.members[0]!r} are also pinned at {shared[0]}",
                          "give the two points different letters")  # fmt: skip


def _no_numbers(pair: Pair, where: str) -> Iterator[Problem]:
    """What a pair holds in place of real numbers, and of true or false."""
    for key in pair.keys:
        for value in _numbers_of(pair, key):
            if not _is_finite(value) or np.iscomplexobj(value):
                yield Problem(f"{where}.{key.name}", f"{value!r} is empty or not finite, or not a number")
        flag = getattr(pair, key.name, None)
        if key.kind == "flag" and not isinstance(flag, bool | np.bool_):
            yield Problem(f"{where}.{key.name}", f"{flag!r} is neither True nor False")


def _numbers_of(pair: Pair, key: Key) -> tuple[Any, ...]:
    """The numbers and arrays that a pair holds under a key."""
    value: Any = getattr(pair, key.name, None)
    if key.kind not in ("length", "angle", "two") or (value is None and key.default is None and not key.required):
        return ()
    return value if key.kind == "two" else (value,)


def misfits_of(mechanism: Mechanism) -> Iterator[Problem]:
    """What is wrong with the dimensions of pairs, in a mechanism that has no other problems."""
    for where, pair in _placed(mechanism.written_pairs):
        yield from pair.misfits(mechanism.geometry, where)


def _placed(pairs: Iterable[Pair]) -> Iterator[tuple[str, Pair]]:
    """Each written pair with its place in a file."""
    count: dict[str, int] = {}
    for pair in pairs:
        index = count.get(pair.table, 0)
        count[pair.table] = index + 1
        yield f"{pair.table}[{index}]", pair


def _joined(mechanism: Mechanism) -> Iterator[Problem]:
    """Links that no pair joins to anything: most often a misspelt letter."""
    paired = {name for names in mechanism.pins.values() for name in names}
    paired |= {name for pair in mechanism.written_pairs for name in pair.members}
    if len(mechanism.links) < 2:
        return
    for name, link in mechanism.links.items():
        if name in paired or not link.points:
            continue
        others = [k for k, names in mechanism.carriers.items() if name not in names]
        hints = [f"{k}: {nearest(k, others)}" for k in link.points if nearest(k, others).startswith("did")]
        yield Problem(f"links.{name}", f"it is joined to nothing: no other link carries {', '.join(link.points)}",
                      "; ".join(hints) or "share a letter with another link or write a slide")  # fmt: skip


def _drives(mechanism: Mechanism) -> Iterator[Problem]:
    driven: dict[tuple[str, frozenset[str]], str] = {}
    for index, drive in enumerate(mechanism.drives):
        where = f"drives[{index}]"
        unknown = [(k, n) for k, n in (("link", drive.link), ("on", drive.on)) if n not in mechanism.links]
        for key, name in unknown:
            yield Problem(f"{where}.{key}", f"there is no link {name!r}", nearest(name, list(mechanism.links)))
        if not unknown:
            choices = drivable(mechanism, drive)
            yield from _driven_pair(drive, choices, where)
            # a multiple pin may be driven once between each two of its links
            place = choices[0] if choices else "", frozenset((drive.link, drive.on))
            if len(choices) == 1 and place in driven:
                yield Problem(
                    where, f"the pair {choices[0]!r} is driven already by {driven[place]!r}", "leave one of them out"
                )
            if len(choices) == 1:
                driven[place] = drive.name
        for key in ("values", "speed", "acceleration", "jerk"):
            value = getattr(drive, key)
            if value is not None and not _is_finite(value):
                yield Problem(f"{where}.{key}", "the value is empty or not finite")
        yield from _two_laws(drive, where)
    if mechanism.time is not None and not _is_finite(mechanism.time):
        yield Problem("time", "the times are empty or not finite", "give seconds, in order of the motion")


def _two_laws(drive: Drive, where: str) -> Iterator[Problem]:
    """What is given beside a law, which says it all."""
    for key in drive.keys:
        beside = key.name in ("values", "speed", "acceleration", "jerk")
        if beside and drive.law is not None and not np.array_equal(getattr(drive, key.name), key.default):
            remedy = f"leave the {key.name} or the law out"
            yield Problem(f"{where}.{key.name}", "the driver has a law as well, which says how it moves", remedy)


def drivable(mechanism: Mechanism, drive: Drive) -> list[str]:
    """The names of the pairs between a drive's two links that it can mean."""
    pins = mechanism.pins_between(drive.link, drive.on)
    between = mechanism.pairs_between.get(frozenset((drive.link, drive.on)), ())
    others = [pair.name for pair in between if pair.is_drivable]
    return [name for name in [*pins, *others] if drive.pair in ("", name)]


def _driven_pair(drive: Drive, choices: list[str], where: str) -> Iterator[Problem]:
    what = f"{drive.link!r} and {drive.on!r}"
    if not choices:
        named = f" called {drive.pair!r}" if drive.pair else ""
        yield Problem(
            where, f"there is no pair{named} between {what} to drive", "drive a link against one it is paired with"
        )
    elif len(choices) > 1:
        yield Problem(f"{where}.pair", f"{what} share several pairs", f"name one: {', '.join(choices)}")


def _modes(mechanism: Mechanism) -> Iterator[Problem]:
    for index, mode in enumerate(mechanism.modes):
        for name in mode.links:
            if name not in mechanism.links:
                yield Problem(
                    f"modes[{index}].links", f"there is no link {name!r}", nearest(name, list(mechanism.links))
                )


def _expectations(mechanism: Mechanism) -> Iterator[Problem]:
    """Published numbers that cannot be held against anything."""
    drives = [drive.name for drive in mechanism.drives]
    # a misspelt drive takes its name from the link; that problem is reported already
    named = all(drive.link in mechanism.links for drive in mechanism.drives)
    for index, expectation in enumerate(mechanism.expectations):
        where = f"expected[{index}]"
        for key, value in expectation.at:
            driver, _, rate = key.partition(".")
            if named and driver not in drives and key != TIME:
                yield Problem(f"{where}.at.{key}", f"there is no driver {driver!r}", nearest(driver, drives))
            if rate not in ("", "speed", "acceleration", "jerk"):
                yield Problem(f"{where}.at.{key}", f"a driver has no {rate!r}", "known: speed, acceleration, jerk")
            if not _is_finite(value):
                yield Problem(f"{where}.at.{key}", f"{value!r} is not finite")
        if not _is_finite(expectation.value):
            yield Problem(f"{where}.value", f"{expectation.value!r} is not finite")
        if not (_is_finite(expectation.tolerance) and expectation.tolerance >= 0):
            what = f"{expectation.tolerance!r} is not a tolerance"
            yield Problem(f"{where}.tolerance", what, "give a number that is not negative")


def _quantities(mechanism: Mechanism) -> Iterator[Problem]:
    """Outputs and published numbers of what there is not; a multiple pin's pairs are named by their links."""
    named = [*mechanism.carriers, *mechanism.links, *(p.name for p in mechanism.written_pairs)]
    known = dict.fromkeys([*named, *(drive.name for drive in mechanism.drives)])
    asked = [(f"outputs[{k}]", name) for k, name in enumerate(mechanism.outputs)]
    asked += [(f"expected[{k}].quantity", e.quantity) for k, e in enumerate(mechanism.expectations)]
    for where, name in asked:
        owner = name.split("(")[0].split(".")[0]
        if owner not in known:
            yield Problem(where, f"there is no point, link, pair or driver {owner!r}", nearest(owner, list(known)))
    for k, e in enumerate(mechanism.expectations):
        owner, _, attribute = e.quantity.partition(".")
        # a file must tell by the word alone whether the number is in degrees
        if not attribute or (attribute == "value" and owner.split("(")[0] in mechanism.pins):
            yield Problem(f"expected[{k}].quantity", f"{e.quantity!r} does not say of what kind the number is",
                          f"write {owner}.angle, {owner}.position or another in full")  # fmt: skip


def _shapes(mechanism: Mechanism) -> Iterator[Problem]:
    """Arrays that do not broadcast together."""
    shapes: list[tuple[str, tuple[int, ...]]] = []
    for name, link in mechanism.links.items():
        arrays = ((k, p) for k, p in link.points.items() if not (p is None or isinstance(p, _NUMBERS)))
        shapes += [(f"links.{name}.points.{k}", np.shape(p)) for k, p in arrays]
    shapes += [(f"drawn.{k}", np.shape(p)) for k, p in mechanism.sketch.items()]
    for where, pair in _placed(mechanism.written_pairs):
        shapes += [(f"{where}.{key.name}", np.shape(value)) for key in pair.keys for value in _numbers_of(pair, key)]
    for index, drive in enumerate(mechanism.drives):
        shapes += [
            (f"drives[{index}].{k}", np.shape(getattr(drive, k)))
            for k in ("values", "speed", "acceleration", "jerk")
            if getattr(drive, k) is not None
        ]
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
