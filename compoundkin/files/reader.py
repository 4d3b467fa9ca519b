"""From a parsed document to a mechanism. All problems of a file are found in one reading."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from compoundkin.base.errors import InvalidMechanism
from compoundkin.files import document as doc
from compoundkin.files.load_entries import tables_of, written_loads
from compoundkin.files.parsed_document import failed
from compoundkin.files.recovery import ALL, JOINED, LETTERS, Recovery, stands_in
from compoundkin.files.single_values import bad, described, single, wrong
from compoundkin.files.tagged_tables import TAGGED
from compoundkin.files.written_quantities import rate, values
from compoundkin.model.attributes import ANGLE, TIME, driver_and_rate
from compoundkin.model.definition import CYLINDERS, DRIVES
from compoundkin.model.elements import Drawn, Drive, Expectation, Item, Link, Mode, drive
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outlines import OUTLINES, LinkOutline
from compoundkin.model.pairs import WRITTEN, Pair
from compoundkin.model.pairs.cylinder import Cylinder
from compoundkin.model.prescribed_motion import PrescribedMotion


def read(document: Mapping[str, Any], where: str = "") -> Mechanism:
    """Return the mechanism that the document of a file says. Raises InvalidMechanism listing all problems.

    >>> read({"format": 1, "title": "Pin", "links": {"frame": {"points": {"A": [0, 0]}}}}).title
    'Pin'
    """
    log = Recovery(TAGGED)
    if not _version(document.get("format"), log):
        raise failed(log.problems, where)
    about, parts = _parts(document, log)
    try:
        mechanism = Mechanism(about.pop("title"), *_items(parts, log), **about)
    except InvalidMechanism as error:
        raise failed(log.problems + log.new(error.problems), where) from None
    if log.problems:
        raise failed(log.problems, where)
    return mechanism


def default_name(pair: Pair | Cylinder) -> str:
    """Say what a pair is called that is given no name.

    >>> from compoundkin.model.pairs import slide
    >>> default_name(slide("block", on="bar", through="F", at="C"))
    'block/bar'
    """
    return pair.called


def _version(version: Any, log: Recovery) -> bool:
    """Return whether to read on. A file of another version would be full of false problems."""
    is_number = isinstance(version, int) and not isinstance(version, bool)
    if is_number and version in doc.FORMATS:
        return True
    what = "it is missing" if version is None else f"{described(version)} is not a known version of the format"
    log.report(bad("format", what, "known: " + ", ".join(f"format = {known}" for known in doc.FORMATS)))
    return not is_number


def _parts(document: Mapping[str, Any], log: Recovery) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what the file says on the whole, and its links, pairs, drives ... as written."""
    parts = [*(table.name for table in doc.TABLES), doc.DRAWN.name, doc.GRAVITY.name]
    given = log.recognized(document, ["format", *(key.name for key in doc.HEAD), *parts], "")
    head = {key.name: given[key.name][0] for key in doc.HEAD if key.name in given}
    found = {name: given[name][0] for name in parts if name in given}
    links = found.get("links")
    if not isinstance(links, dict) or not links:
        missing = "links" not in found or links == {}
        remedy = "write a table [links.NAME] for every link"
        log.report(
            bad("links", "there is no link", remedy) if missing else wrong("links", links, "a table", remedy),
            ALL,
        )
        found["links"] = {}
    return log.table(head, doc.HEAD, ""), found


def _items(parts: Mapping[str, Any], log: Recovery) -> Iterator[Item]:
    """Yield the words of the mechanism. What a driver's numbers mean depends on the pairs read before."""
    links = [_link(name, table, log) for name, table in parts.get("links", {}).items()]
    pairs = [_pair(kind, *at, log) for name, kind in WRITTEN.items() for at in tables_of(parts, name, log)]
    cylinders = [Cylinder(**log.table(raw, Cylinder.keys, where)) for raw, where in tables_of(parts, CYLINDERS, log)]
    shown = {key: value for key, value in parts.items() if key == doc.DRAWN.name}
    drawn = [Drawn(points) for points in log.table(shown, (doc.DRAWN,), "").values()]
    base = _valid(links, pairs, cylinders, drawn)
    drives = [_drive(base, *at, log) for at in tables_of(parts, DRIVES, log)]
    if any(problem.where.startswith(DRIVES) for problem in log.problems):
        log.doubts.append(r"expected\[\d+\]\.at\.")
    angles = dict(_driven(base, drives)) if base else {}
    yield from links
    yield from pairs
    yield from cylinders
    yield from drives
    yield from drawn
    yield from written_loads(parts, log, _valid(base.items if base else (), drives))
    yield from (
        LinkOutline(**log.table(raw, LinkOutline.keys, where)) for raw, where in tables_of(parts, OUTLINES, log)
    )
    yield from (Mode(**log.table(raw, doc.MODE, where)) for raw, where in tables_of(parts, "modes", log))
    yield from (_expected(angles, *at, log) for at in tables_of(parts, "expected", log))


def _valid(*items: Iterable[Item]) -> Mechanism | None:
    """Return the mechanism without drivers, which tells what each would drive. None where it cannot be built."""
    try:
        return Mechanism("", *(item for some in items for item in some))
    except InvalidMechanism:
        return None


def _link(name: str, raw: Any, log: Recovery) -> Link:
    points = log.table(raw, doc.LINK, f"links.{name}")["points"]
    if stands_in(points):
        log.doubts += LETTERS
    return Link(name, points)


def _pair(kind: type[Pair], raw: Any, where: str, log: Recovery) -> Pair:
    table = log.table(raw, kind.keys, where)
    if any(map(stands_in, table.values())):
        log.doubts += JOINED
    return kind(**table)


# The keys that only drivers of points and of links' angles have.
LED = {key.name for key in PrescribedMotion.keys} - {key.name for key in Drive.keys}


def _driven(base: Mechanism, drives: Iterable[Drive | PrescribedMotion]) -> Iterator[tuple[str, bool | None]]:
    """Yield what is driven, and whether it is an angle."""
    for item in drives:
        if isinstance(item, PrescribedMotion):
            yield from ((name, word == ANGLE) for word, name in item.drivers.items())
        else:
            yield item.name, doc.is_angle(base, item)


def _drive(base: Mechanism | None, raw: Any, where: str, log: Recovery) -> Drive | PrescribedMotion:
    if isinstance(raw, dict) and not LED.isdisjoint(raw):
        before = len(log.problems)
        led = log.table(raw, PrescribedMotion.keys, where, ANGLE in raw)
        if len(log.problems) > before:
            log.doubts.append(f"{re.escape(where)}$")
        return PrescribedMotion(led.pop("name", led.get("point", led.get("link", ""))), **led)
    said = {k: v for k, v in raw.items() if isinstance(v, str)} if isinstance(raw, dict) else {}
    meant = Drive("", said.get("link", ""), said.get("on", FRAME), said.get("pair", ""))
    found = log.table(raw, Drive.keys, where, doc.is_angle(base, meant) if base else None)
    made: Drive | PrescribedMotion = drive(found.pop("link"), **found)
    return made


def _expected(angles: Mapping[str, bool | None], raw: Any, where: str, log: Recovery) -> Expectation:
    quantity = raw.get("quantity") if isinstance(raw, dict) else None
    found = log.table(raw, doc.EXPECTED, where, doc.quantity_is_angle(quantity))
    at = found.pop("at", {}).items()
    return Expectation(**found, at=tuple((k, _at(angles, k, v, f"{where}.at.{k}", log)) for k, v in at))


def _at(angles: Mapping[str, bool | None], key: str, raw: Any, where: str, log: Recovery) -> float:
    name, word = driver_and_rate(key, list(angles))
    try:
        if key == TIME and key not in angles:
            return single(raw, where)
        if isinstance(raw, dict) and not word and "rad" not in raw:
            raise wrong(where, raw, "a number", f'for rates write "{key}.speed" in quotes')
        out = (rate if word else values)(raw, where, angles.get(name))
        if isinstance(out, float):
            return out
        raise wrong(where, raw, "a single number")
    except InvalidMechanism as error:
        log.report(error)
        return 0.0
