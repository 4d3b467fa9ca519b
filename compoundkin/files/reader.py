"""The reader of mechanism files: from a document to links, pairs, drives and loads, all problems at once."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from compoundkin.base.errors import InvalidInput, InvalidMechanism, Problem, suggestion
from compoundkin.files import document as doc
from compoundkin.files import exact_numbers
from compoundkin.files.document import DWELL, KIND, PROGRAM, RISING, SEGMENT
from compoundkin.files.parsed_document import failed
from compoundkin.files.read_values import bad, described, numbers, point, rate, single, values, wrong
from compoundkin.files.recovery import ALL, JOINED, LETTERS, PROFILE, Recovery, Tagged, stands_in
from compoundkin.model import laws, prescribed_motion, profiles
from compoundkin.model.attributes import ANGLE, TIME, driver_and_rate
from compoundkin.model.definition import CYLINDERS, DRIVES
from compoundkin.model.elements import Drawn, Drive, Expectation, Item, Link, Mode, drive
from compoundkin.model.fields import Key, Kind
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import Law
from compoundkin.model.laws.motion_programs import Program, ProgramSegment
from compoundkin.model.loads import WRITTEN as LOADS
from compoundkin.model.loads.amounts import RATE, LoadFunction, LoadTable
from compoundkin.model.loads.attachments import COORDINATE
from compoundkin.model.loads.gravity import Gravity, warn_of_unit
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outlines import OUTLINES, LinkOutline
from compoundkin.model.pairs import WRITTEN, Pair
from compoundkin.model.pairs.cylinder import Cylinder
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.model.prescribed_paths import Path
from compoundkin.model.profiles import Profile


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


def law(log: Recovery, raw: Any, where: str, angle: bool | None) -> Law | None:
    """Return the law that a table says. None where it is broken, which is reported."""
    return of_kind(log, "law", laws.WRITTEN, raw, where, angle)


def of_kind(
    log: Recovery, word: str, known: Mapping[str, type[Any]], raw: Any, where: str, angle: bool | None
) -> Any | None:
    """Return an object from a table that says its kind, one of those known.

    None where it is broken, which is reported.
    """
    how = f'write {{ {KIND} = "...", ... }}, the kind one of {", ".join(known)}'
    if not isinstance(raw, dict):
        log.report(wrong(where, raw, f"a {word}", how))
        return None
    kind = raw.get(KIND)
    if not isinstance(kind, str) or kind not in known:
        what = f"there is no {word} {described(kind)}" if KIND in raw else "it is missing"
        log.report(bad(f"{where}.{KIND}", what, suggestion(str(kind), list(known))))
        return None
    entries = {key: value for key, value in raw.items() if key != KIND}
    return made(log, known[kind], entries, where, angle)


def path(log: Recovery, raw: Any, where: str, angle: bool | None) -> Path | None:
    """Return the path that a table says. None where it is broken, which is reported."""
    return of_kind(log, "path", prescribed_motion.WRITTEN, raw, where, False)


def segments(
    log: Recovery, raw: Any, where: str, angle: bool | None, keys: tuple[Key, ...] = ProgramSegment.keys
) -> tuple[ProgramSegment, ...]:
    """Return the segments of a program. Those that are broken are left out, which is reported."""
    if not isinstance(raw, list):
        log.report(wrong(where, raw, "a list of segments", 'write [{ law = "cycloidal", over = 1, rise = 90 }]'))
        return ()
    found = [made(log, ProgramSegment, table, f"{where}[{index}]", angle, keys) for index, table in enumerate(raw)]
    for index, table in enumerate(raw):
        if isinstance(table, dict) and "rise" not in table and table.get("law") in RISING:
            log.report(bad(f"{where}[{index}].rise", "it is missing", f'write rise = 30, or law = "{DWELL}"'))
    return tuple(segment for segment in found if segment is not None)


def profile(log: Recovery, raw: Any, where: str, angle: bool | None) -> Profile:
    """Return the profile that a table says. A disc where it is broken, which is reported.

    Where the follower turns about a pivot, the rises of its program are angles.
    """
    found: Profile | None = of_kind(
        log, "profile", profiles.WRITTEN, raw, where, isinstance(raw, dict) and "pivot" in raw
    )
    return PROFILE if found is None else found


def program(log: Recovery, raw: Any, where: str, angle: bool | None) -> Program | None:
    """Return a program over a turn of a cam. Its segments alone, or a table that also says where it starts."""
    table = raw if isinstance(raw, dict) else {"segments": raw}
    found: Program | None = made(log, Program, table, where, angle, PROGRAM)
    return found


def turned(log: Recovery, raw: Any, where: str, angle: bool | None) -> tuple[ProgramSegment, ...]:
    """Return the segments of a cam's program."""
    return segments(log, raw, where, angle, SEGMENT)


def made(
    log: Recovery, kind: type[Any], raw: Any, where: str, angle: bool | None, keys: tuple[Key, ...] | None = None
) -> Any:
    """Return an object of a kind from its table. None where the table is broken or what it says cannot be meant."""
    before = len(log.problems)
    found = log.table(raw, kind.keys if keys is None else keys, where, angle)
    if len(log.problems) > before:
        return None
    try:
        return kind(**found)
    except InvalidMechanism as error:
        log.report(InvalidMechanism([_placed(problem, where) for problem in error.problems]))
        return None


def _placed(problem: Problem, where: str) -> Problem:
    """Return a problem of an object, "segment.over", at the place of its table."""
    _, dot, rest = problem.where.partition(".")
    return replace(problem, where=where + dot + rest)


def amount(log: Recovery, raw: Any, where: str, angle: bool | None, over: str = "") -> Any:
    """Return an amount of a load: a number, an array or a table. Zero where it is broken, which is reported."""
    if isinstance(raw, dict):
        told = raw.get("over", over)
        known = {TIME: False, RATE: False, "": angle}
        is_angle = known[told] if isinstance(told, str) and told in known else log.is_angle(str(told))
        table = made(log, LoadTable, {"over": over, **raw}, where, is_angle)
        return 0.0 if table is None else table
    try:
        return numbers(raw, where)
    except InvalidMechanism as error:
        log.report(error)
        return 0.0


def planar(log: Recovery, raw: Any, where: str, angle: bool | None) -> Any:
    """Return a vector of a load.

    It is a point, a table of points, or two amounts, x and y.
    """
    if isinstance(raw, dict) and isinstance(raw.get("values"), list):
        entries = raw["values"]
        if not all(isinstance(entry, list) and len(entry) == 2 for entry in entries):
            log.report(wrong(f"{where}.values", entries, "a list of vectors", "write [[x, y], [x, y]]"))
            return 0j
        raw = [{**raw, "values": [entry[k] for entry in entries]} for k in range(2)]
    if isinstance(raw, list) and len(raw) == 2 and any(isinstance(one, dict) for one in raw):
        return tuple(amount(log, one, f"{where}[{k}]", angle, TIME) for k, one in enumerate(raw))
    try:
        return point(raw, where)
    except InvalidMechanism as error:
        log.report(error)
        return 0j


# What is read table by table, each with its own problems.
TAGGED: dict[Kind, Tagged] = {
    "law": law,
    "path": path,
    "segments": segments,
    "profile": profile,
    "program": program,
    "turned": turned,
    "planar": planar,
    "amount": amount,
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
    for name, kinds in LOADS.items():
        for raw, where in tables_of(parts, name, log):
            yield _load(kinds, raw, where, log)


def _load(kinds: tuple[type[Any], ...], raw: Any, where: str, log: Recovery) -> Item:
    """Return a load of the kind that its table is of."""
    pair = raw.get(_PAIR) if isinstance(raw, dict) else None
    kind = next((kind for kind in kinds if any(key.name == _PAIR for key in kind.keys) == (pair is not None)), kinds[0])
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


def load_table(mechanism: Mechanism, item: Any) -> dict[str, Any]:
    """Return the amounts of a load as a file writes them. Raises InvalidInput for a Python function."""
    own = getattr(item, "own_variable", "") == COORDINATE and doc.name_is_angle(mechanism, item.pair)
    return {key: _amount(mechanism, f"{item.where}.{key}", getattr(item, key), bool(own))
            for key in getattr(item, "amounts", ()) if getattr(item, key) is not None}  # fmt: skip


def _amount(mechanism: Mechanism, where: str, held: Any, own: bool) -> Any:
    if isinstance(held, LoadFunction):
        what = "a Python function cannot be written to a file"
        raise InvalidInput(Problem(where, what, "write a table of its values instead"))
    if isinstance(held, tuple):
        return [_amount(mechanism, where, part, own) for part in held]
    if isinstance(held, LoadTable):
        return _table(
            held, {"": own, TIME: False, RATE: False}.get(held.over, bool(doc.name_is_angle(mechanism, held.over)))
        )
    return (exact_numbers.point if np.iscomplexobj(held) else exact_numbers.plain)(held)


def _table(held: LoadTable, angle: bool) -> dict[str, Any]:
    """Return a table; what it does not say is left out."""
    out: dict[str, Any] = {"over": held.over} if held.over else {}
    out |= {"at": exact_numbers.coordinate(held.at, angle), "values": exact_numbers.plain(held.values)}
    if held.period is not None:
        out["period"] = exact_numbers.coordinate(held.period, angle)
    return {**out, "smooth": True} if held.smooth else out
