"""The reader of mechanism files: from a document to links, pairs, drives and loads, all problems at once."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from typing import Any

from compoundkin.base.errors import InvalidMechanism
from compoundkin.files import document as doc
from compoundkin.files.parsed_document import failed
from compoundkin.files.read_values import bad, described, rate, single, values, wrong
from compoundkin.files.recovery import ALL, JOINED, LETTERS, Recovery, Tagged, stands_in
from compoundkin.model.attributes import ANGLE, TIME, driver_and_rate
from compoundkin.model.definition import CYLINDERS, DRIVES
from compoundkin.model.elements import Drawn, Drive, Expectation, Link, Mode, drive
from compoundkin.model.fields import Item, Kind
from compoundkin.model.geometry import FRAME
from compoundkin.model.loads import ALONG_PAIRS
from compoundkin.model.loads import WRITTEN as LOADS
from compoundkin.model.loads.contract import COORDINATE
from compoundkin.model.loads.gravity import Gravity, warn_of_unit
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outlines import OUTLINES, LinkOutline
from compoundkin.model.pairs import WRITTEN as PAIRS
from compoundkin.model.pairs import Pair
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

    >>> from compoundkin.model.pairs.prismatic import slide
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
    parts = [*doc.TABLES, doc.DRAWN.name, doc.GRAVITY.name]
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
    pairs = [_pair(PAIRS[name], *at, log) for name in PAIRS for at in tables_of(parts, name, log)]
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


def _tagged(kind: Kind, log: Recovery, raw: Any, where: str, angle: bool | None) -> Any:
    from compoundkin.files.law_tables import READERS

    return READERS[kind](log, raw, where, angle)


# Values that most files have none of: what reads them is imported with the first.
TAGGED: dict[Kind, Tagged] = {
    kind: partial(_tagged, kind)
    for kind in ("law", "path", "segments", "profile", "program", "turned", "planar", "amount")
}


# The key that tells springs and dampers along pairs from those between points.
_PAIR = "pair"


def written_loads(parts: Mapping[str, Any], log: Recovery, driven: Mechanism | None) -> Iterator[Item]:
    """Yield gravity, masses and loads. `driven` is the mechanism without them, which tells angles from lengths."""
    if driven is not None:
        log.is_angle = partial(doc.name_is_angle, driven)
    given = {key: value for key, value in parts.items() if key == doc.GRAVITY.name}
    for vector in log.table(given, (doc.GRAVITY,), "").values():
        warn_of_unit(vector)
        yield Gravity(vector)
    for name in LOADS:
        for raw, where in tables_of(parts, name, log):
            yield _load(name, raw, where, log)


def _load(name: str, raw: Any, where: str, log: Recovery) -> Item:
    """Return a load of the kind that its table is of."""
    pair = raw.get(_PAIR) if isinstance(raw, dict) else None
    kind = (LOADS if pair is None or name not in ALONG_PAIRS else ALONG_PAIRS)[name]
    is_own = getattr(kind, "own_variable", "") == COORDINATE
    over = getattr(kind, "coordinates_over", {}) if isinstance(raw, dict) else {}
    others = {key: log.is_angle(str(raw.get(name))) for key, name in over.items()}
    others |= dict.fromkeys(getattr(kind, "turning", ()), True)
    item: Item = kind(**log.table(raw, kind.keys, where, log.is_angle(str(pair)) if is_own else False, others))
    return item


def tables_of(parts: Mapping[str, Any], name: str, log: Recovery) -> list[tuple[Any, str]]:
    """Return the tables of an array with their places. A single table is read as an array of one."""
    raw = parts.get(name, [])
    if not isinstance(raw, list):
        log.report(wrong(name, raw, "an array of tables", f"write [[{name}]]"), JOINED)
        raw = [raw] if isinstance(raw, dict) else []
    return [(table, f"{name}[{index}]") for index, table in enumerate(raw)]
