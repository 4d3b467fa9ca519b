"""From a mechanism to the document of its file, by the table of keys."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any

from compoundkin.base.arrays import Number
from compoundkin.base.copies import nested_equal
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.files import document as doc
from compoundkin.files import exact_numbers
from compoundkin.files.document import DWELL, KIND, PROGRAM
from compoundkin.files.reader import default_name
from compoundkin.model.attributes import ANGLE, OF_POINTS, driver_and_rate
from compoundkin.model.definition import CYLINDERS, DRIVES
from compoundkin.model.elements import Drive, Expectation, Link
from compoundkin.model.fields import Key, Kind
from compoundkin.model.loads import WRITTEN as LOADS
from compoundkin.model.loads.gravity import Gravity
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.outlines import OUTLINES
from compoundkin.model.pairs import WRITTEN as PAIRS
from compoundkin.model.prescribed_motion import PrescribedMotion

if TYPE_CHECKING:
    from compoundkin.model.laws.motion_programs import Program, ProgramSegment


def document(mechanism: Mechanism) -> dict[str, Any]:
    """Return the document that says what a mechanism says.

    Raises InvalidInput for what files cannot say: a link of which only some points have coordinates, a Python function.

    >>> from compoundkin.model.elements import link
    >>> document(Mechanism("Pin", link("frame", A=(0, 0))))["links"]
    {'frame': {'points': {'A': [0, 0]}}}
    """
    out: dict[str, Any] = {"format": doc.FORMATS[-1], **_head(mechanism)}
    out["links"] = {name: _link(item) for name, item in mechanism.rigid_links.items()}
    for name in PAIRS:
        out[name] = [_pair(item) for item in mechanism.items if getattr(item, "table", "") == name]
    out[CYLINDERS] = [_pair(item) for item in mechanism.cylinders.values()]
    out[DRIVES] = [
        _lead(item) if isinstance(item, PrescribedMotion) else _drive(mechanism, item)
        for item in mechanism.items
        if isinstance(item, Drive | PrescribedMotion)
    ]
    out[doc.DRAWN.name] = _points(mechanism.sketch)
    for name in (*LOADS, OUTLINES):
        out[name] = [_load(mechanism, item) for item in mechanism.items if getattr(item, "table", "") == name]
    out["modes"] = [_table(item, doc.MODE) for item in mechanism.modes]
    out["expected"] = [_expected(mechanism, item) for item in mechanism.expectations]
    return {key: value for key, value in out.items() if value not in ([], {})}


def _head(mechanism: Mechanism) -> dict[str, Any]:
    """Return what is said of the whole. Units of length, mass and force stand in the place of the one of length."""
    said = _table(mechanism, tuple(key for key in doc.HEAD if key.name != "unit" or mechanism.units is None))
    given = [item.vector for item in mechanism.items if isinstance(item, Gravity)]
    return {**said, doc.GRAVITY.name: exact_numbers.point(given[0])} if given else said


def _load(mechanism: Mechanism, item: Any) -> dict[str, Any]:
    """Return a mass, a load or an outline; its name where it has one of its own."""
    amounts = _amounts(mechanism, item) if getattr(item, "amounts", ()) else {}
    angle = any(key.kind == "coordinate" for key in item.keys) and bool(doc.name_is_angle(mechanism, item.pair))
    out = {**_table(item, tuple(key for key in item.keys if key.name not in amounts), angle), **amounts}
    for key, over in getattr(item, "coordinates_over", {}).items():
        if key in out:
            out[key] = exact_numbers.coordinate(
                getattr(item, key), bool(doc.name_is_angle(mechanism, getattr(item, over)))
            )
    said = [key.name for key in item.keys if key.name in out and (key.name != "name" or out["name"] != item.called)]
    return {name: out[name] for name in said}


def _amounts(mechanism: Mechanism, item: Any) -> dict[str, Any]:
    from compoundkin.files.law_tables import load_table

    return load_table(mechanism, item)


def _table(item: Any, keys: tuple[Key, ...], angle: bool = False) -> dict[str, Any]:
    """Return what an item holds by key; defaults are left out."""
    said = [(key, getattr(item, key.name)) for key in keys]
    return {key.name: WRITERS[key.kind](held, angle) for key, held in said if not _left_out(key, held)}


def _left_out(key: Key, value: Any) -> bool:
    if key.required:
        return False
    return value is None or nested_equal(value, key.default) or (isinstance(value, str | tuple) and not value)


def _link(item: Link) -> dict[str, Any]:
    drawn = [letter for letter, p in item.points.items() if p is None]
    if drawn and len(drawn) < len(item.points):
        what = f"only some of its points have coordinates; {drawn[0]} has none"
        remedy = "give all by letters or all by coordinates"
        raise InvalidInput(Problem(f"links.{item.name}", what, remedy))
    return {"points": drawn or _points(item.points)}


def _points(points: Mapping[str, Number]) -> dict[str, Any]:
    return {letter: exact_numbers.point(p) for letter, p in points.items()}


def _pair(item: Any) -> dict[str, Any]:
    for key in item.keys:
        if key.kind == "profile" and not getattr(item, key.name).keys:
            what, remedy = "a Python function cannot be written to a file", "write a profile of its points instead"
            raise InvalidInput(Problem(f"{item.table}.{item.name}.{key.name}", what, remedy))
    out = _table(item, item.keys)
    return {key: value for key, value in out.items() if key != "name" or value != default_name(item)}


def _lead(item: PrescribedMotion) -> dict[str, Any]:
    """Return what leads a point or turns a link. Raises InvalidInput where a Python function does."""
    for key in item.keys:
        held = getattr(item, key.name)
        if key.kind in ("law", "path") and not _is_writable(held):
            what = "a Python function cannot be written to a file"
            remedy = "write a time_table of its values, or places at times, instead"
            raise InvalidInput(Problem(f"{DRIVES}.{item.name}.{key.name}", what, remedy))
    out = _table(item, item.keys, item.angle is not None)
    return {key: value for key, value in out.items() if key != "name" or value not in (item.point, item.link)}


def _is_writable(held: Any) -> bool:
    """Return whether a law or a path holds no Python function, nor anything that does."""
    if held is None:
        return True
    keys = getattr(held, "keys", ())
    return bool(keys) and all(_is_writable(getattr(held, key.name)) for key in keys if key.kind in ("law", "profile"))


def _drive(mechanism: Mechanism, item: Drive) -> dict[str, Any]:
    if not _is_writable(item.law):
        what, remedy = "a Python function cannot be written to a file", "write a time_table of its values instead"
        raise InvalidInput(Problem(f"drives.{item.name}.law", what, remedy))
    out = _table(item, type(item).keys, bool(doc.is_angle(mechanism, item)))
    return {key: value for key, value in out.items() if key != "name" or value != item.link}


def _tagged(item: Any, angle: bool) -> dict[str, Any]:
    return {KIND: item.kind, **_table(item, item.keys, angle)}


def _segment(item: ProgramSegment, keys: tuple[Key, ...], angle: bool) -> dict[str, Any]:
    """Whatever is not a dwell says how far it rises, even by nothing. The least time follows from its limits."""
    rise = {} if item.law == DWELL else {"rise": exact_numbers.coordinate(item.rise, angle)}
    said = tuple(key for key in keys if key.name != "over" or not item.is_fastest)
    return _table(item, said, angle) | rise


def _turned(value: Iterable[ProgramSegment], angle: bool) -> list[dict[str, Any]]:
    from compoundkin.files.law_tables import SEGMENT

    return [_segment(one, SEGMENT, angle) for one in value]


def _program(item: Program, angle: bool) -> Any:
    """Return a cam's program: its segments alone where it starts on the base circle."""
    table = _table(item, PROGRAM, angle)
    return table if len(table) > 1 else table["segments"]


def _expected(mechanism: Mechanism, item: Expectation) -> dict[str, Any]:
    angles = {d.name: bool(doc.is_angle(mechanism, d)) for d in mechanism.drives}
    angles |= {item.drivers[ANGLE]: True for item in mechanism.prescribed_motions.values() if item.angle is not None}
    out = _table(item, doc.EXPECTED, doc.quantity_is_angle(item.quantity))
    if item.at:
        out["at"] = {key: _at(angles, key, value) for key, value in item.at}
    owner, _, attribute = item.quantity.partition(".")
    if owner in mechanism.carriers and attribute in OF_POINTS:
        out["value"] = exact_numbers.point(item.value)
    return out


def _at(angles: Mapping[str, bool], key: str, value: float) -> Any:
    name, word = driver_and_rate(key, list(angles))
    return (exact_numbers.rate if word else exact_numbers.coordinate)(value, angles.get(name, False))


def _published(value: complex, angle: bool) -> Any:
    return exact_numbers.point(value) if value.imag else exact_numbers.coordinate(value.real, angle)


def _reach(value: Any, angle: bool) -> Any:
    """Return both ends of a guide; a table of the one that there is where the other is open."""
    said = {
        key: end if isinstance(end, str) else exact_numbers.coordinate(end, angle)
        for key, end in zip(("from", "to"), value, strict=True)
        if end is not None
    }
    return list(said.values()) if len(said) == len(value) else said


WRITERS: dict[Kind, Callable[[Any, bool], Any]] = {
    "name": lambda value, _: value,
    "text": lambda value, _: value,
    "names": lambda value, _: list(value),
    "sign": lambda value, _: int(value),
    "flag": lambda value, _: bool(value),
    "two": lambda value, _: [exact_numbers.plain(entry) for entry in value],
    "length": lambda value, _: exact_numbers.plain(value),
    "angle": lambda value, _: exact_numbers.degrees(value),
    "point": lambda value, _: exact_numbers.point(value),
    "spot": lambda value, _: exact_numbers.spot(value),
    "spots": lambda value, _: [exact_numbers.spot(one) for one in value],
    "layers": lambda value, _: value[0] if len(value) == 1 else list(value),
    "units": lambda value, _: {"length": value.length, "mass": value.mass, "force": value.force},
    "whole": lambda value, _: int(value),
    "span": lambda value, _: exact_numbers.plain(value),
    "times": lambda value, _: exact_numbers.values(value, False),
    "segments": lambda value, angle: [_segment(one, one.keys, angle) for one in value],
    "law": _tagged,
    "number": lambda value, _: exact_numbers.plain(value),
    "turn": lambda value, _: exact_numbers.degrees(value),
    "place": lambda value, _: exact_numbers.point(value),
    "places": lambda value, _: [exact_numbers.point(one) for one in value],
    "route": lambda value, _: [exact_numbers.point(one) for one in value],
    "path": _tagged,
    "turned": lambda value, angle: _turned(value, angle),
    "program": lambda value, angle: _program(value, angle),
    "profile": lambda value, _: _tagged(value, value.oscillates),
    "coordinate": exact_numbers.coordinate,
    "values": exact_numbers.values,
    "rate": exact_numbers.rate,
    "at": lambda value, _: None,
    "published": _published,
    "margin": exact_numbers.coordinate,
    "reach": lambda value, _: _reach(value, False),
    "sweep": lambda value, _: _reach(value, True),
}
