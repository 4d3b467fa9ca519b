"""What can be wrong with the words of a mechanism. Every problem is found, none hides another."""

from __future__ import annotations

from collections.abc import Iterator

from compoundkin.base.errors import Problem, nearest
from compoundkin.model.attributes import RATES, TIME, VALUE, rated
from compoundkin.model.elements import FRAME, Drive, Item, Lead, Link
from compoundkin.model.number_problems import (
    drive_problems,
    is_finite,
    no_numbers,
    placed_drives,
    point_problems,
    shape_problems,
)
from compoundkin.model.pairs.cylinder import Cylinder
from compoundkin.model.written import CYLINDERS, DRIVES, Written

_PRINTABLE = "use printable text without dots, commas or outer blanks"


def problems_of(mechanism: Written) -> Iterator[Problem]:
    """Find all problems, in the order of the words."""
    yield from _words(mechanism)
    yield from _names(mechanism)
    yield from point_problems(mechanism)
    yield from _thought(mechanism)
    yield from _pairs(mechanism)
    yield from _joined(mechanism)
    yield from _drives(mechanism)
    yield from _modes(mechanism)
    yield from _expectations(mechanism)
    yield from _quantities(mechanism)
    yield from shape_problems(mechanism)


def _words(mechanism: Written) -> Iterator[Problem]:
    """Find what is not a word at all."""
    for index, item in enumerate(mechanism.items):
        if not isinstance(item, Item):
            yield Problem(
                f"items[{index}]",
                f"{item!r} is not a word",
                "known: link, the pairs such as slide, cylinder, drive, drawn, mode, expect, mass, the loads, outline",
            )


def _names(mechanism: Written) -> Iterator[Problem]:
    if FRAME not in mechanism.links:
        yield Problem(
            "links",
            f"no link is called {FRAME!r}",
            f"call the fixed link {FRAME!r}; {nearest(FRAME, list(mechanism.links))}",
        )
    seen: set[tuple[str, str]] = set()
    for where, kind, name in _named(mechanism):
        if not _is_name(name):
            yield Problem(where, f"{name!r} is not a name", _PRINTABLE)
        if (kind, name) in seen:
            one = "there is one frame: give all fixed points to it; " if (kind, name) == ("link", FRAME) else ""
            yield Problem(where, f"the name {name!r} is used twice", f"{one}names are unique")
        seen.add((kind, name))
    for letter in mechanism.carriers:
        if not _is_name(letter):
            yield Problem(
                f"points.{letter}",
                f"{letter!r} is not a name",
                _PRINTABLE,
            )
        if letter in mechanism.links:
            yield Problem(f"links.{letter}", "a link and a point have the same name", "rename one of them")


def _named(mechanism: Written) -> Iterator[tuple[str, str, str]]:
    """Yield the place, sort and name of everything that has one. Pairs of all kinds share their names."""
    for item in mechanism.parts:
        if isinstance(item, Link) and item.name not in mechanism.led_links:
            yield f"links.{item.name}", "link", item.name
    for where, pair in mechanism.placed_pairs:
        yield f"{where}.name", "pair", pair.name
    items = [item for item in mechanism.items if isinstance(item, Drive | Lead)]
    for index, drive in enumerate(items):
        yield f"{DRIVES}[{index}].name", "drive", drive.name


def _is_name(name: str) -> bool:
    return bool(name) and name == name.strip() and name.isprintable() and not set(name) & set(".,")


def _thought(mechanism: Written) -> Iterator[Problem]:
    letters = {name: link.letters for name, link in mechanism.rigid_links.items()}
    items = [item for item in mechanism.items if isinstance(item, Cylinder)]
    for index, item in enumerate(items):
        yield from item.problems(letters, f"{CYLINDERS}[{index}]")
        if item.name in (other.name for other in items[:index]):
            remedy = "names are unique: give one of them a name"
            yield Problem(f"{CYLINDERS}[{index}].name", f"the name {item.name!r} is used twice", remedy)
    for index, drive in enumerate(item for item in mechanism.items if isinstance(item, Drive | Lead)):
        if isinstance(drive, Lead):
            yield from drive.problems(letters, f"{DRIVES}[{index}]")
        if isinstance(drive, Drive) and drive.link in mechanism.cylinders and (drive.on, drive.pair) != (FRAME, ""):
            what = f"the cylinder {drive.link!r} is driven by its length, against no other link"
            yield Problem(f"drives[{index}].on", what, "leave `on` and `pair` out")


def _pairs(mechanism: Written) -> Iterator[Problem]:
    letters = {name: link.letters for name, link in mechanism.links.items()}
    for where, pair in mechanism.placed_pairs:
        # what is no number cannot be compared with anything
        yield from list(no_numbers(pair, where)) or pair.problems(letters, where)
        shared = mechanism.pins_between(*pair.members[:2])
        if shared:
            yield Problem(where, f"{pair.members[1]!r} and {pair.members[0]!r} are also pinned at {shared[0]}",
                          "give the two points different letters")  # fmt: skip


def _joined(mechanism: Written) -> Iterator[Problem]:
    """Find links that no pair joins to anything: most often a misspelt letter."""
    paired = {name for names in mechanism.pins.values() for name in names}
    paired |= {name for pair in mechanism.written_pairs for name in pair.members}
    if len(mechanism.links) < 2:
        return
    for name, link in mechanism.links.items():
        if name in paired or not link.points:
            continue
        others = [k for k, names in mechanism.carriers.items() if name not in names]
        hints = [f"{k}: {nearest(k, others)}" for k in link.points if nearest(k, others).startswith("did")]
        hints += [f"{a} and {b} are two letters" for a, b in mechanism.case_slips() if {a, b} & set(link.points)]
        yield Problem(f"links.{name}", f"it is joined to nothing: no other link carries {', '.join(link.points)}",
                      "; ".join(hints) or "share a letter with another link or write a slide")  # fmt: skip


def _drives(mechanism: Written) -> Iterator[Problem]:
    driven: dict[tuple[str, frozenset[str]], str] = {}
    for where, drive in placed_drives(mechanism):
        unknown = [(k, n) for k, n in (("link", drive.link), ("on", drive.on)) if n not in mechanism.links]
        for key, name in unknown:
            known = [*mechanism.links, *mechanism.cylinders]
            yield Problem(f"{where}.{key}", f"there is no link {name!r}", nearest(name, known))
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


def _modes(mechanism: Written) -> Iterator[Problem]:
    for index, mode in enumerate(mechanism.modes):
        for name in mode.links:
            if name not in mechanism.links:
                yield Problem(
                    f"modes[{index}].links", f"there is no link {name!r}", nearest(name, list(mechanism.links))
                )


def _expectations(mechanism: Written) -> Iterator[Problem]:
    """Published numbers that cannot be held against anything."""
    drives = [drive.name for drive in mechanism.drives]
    # a misspelt drive takes its name from the link; that problem is reported already
    named = all(drive.link in mechanism.links for drive in mechanism.drives)
    for index, expectation in enumerate(mechanism.expectations):
        where = f"expected[{index}]"
        for key, value in expectation.at:
            driver, rate = rated(key, drives)
            if named and driver not in drives and key != TIME:
                yield Problem(f"{where}.at.{key}", f"there is no driver {driver!r}", nearest(driver, drives))
            if rate not in ("", *RATES):
                yield Problem(f"{where}.at.{key}", f"a driver has no {rate!r}", "known: speed, acceleration, jerk")
            if not is_finite(value):
                yield Problem(f"{where}.at.{key}", f"{value!r} is not finite")
        if not is_finite(expectation.value):
            yield Problem(f"{where}.value", f"{expectation.value!r} is not finite")
        if not (is_finite(expectation.tolerance) and expectation.tolerance >= 0):
            what = f"{expectation.tolerance!r} is not a tolerance"
            yield Problem(f"{where}.tolerance", what, "give a number that is not negative")


def _quantities(mechanism: Written) -> Iterator[Problem]:
    """Outputs and published numbers of what there is not. A multiple pin's pairs are named by their links."""
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
        if not attribute or (attribute == VALUE and owner.split("(")[0] in mechanism.pins):
            yield Problem(f"expected[{k}].quantity", f"{e.quantity!r} does not say of what kind the number is",
                          f"write {owner}.angle, {owner}.position or another in full")  # fmt: skip
