"""The JSON Schema of mechanism files, from the table of keys."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from typing import Any

from compoundkin.files import document as doc
from compoundkin.files import exact_numbers
from compoundkin.files.atomic import write_atomically
from compoundkin.files.document import KIND, PROGRAM
from compoundkin.files.law_tables import SEGMENT
from compoundkin.model.definition import DRIVES
from compoundkin.model.fields import Key, Kind
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import WRITTEN as LAWS
from compoundkin.model.laws.motion_programs import ProgramSegment
from compoundkin.model.loads import ALONG_PAIRS
from compoundkin.model.loads.amounts import LoadTable
from compoundkin.model.prescribed_motion import PrescribedMotion
from compoundkin.model.prescribed_paths import WRITTEN as PATHS
from compoundkin.model.profiles import WRITTEN as PROFILES
from compoundkin.model.units import KNOWN as UNITS

DIALECT = "https://json-schema.org/draft/2020-12/schema"


def schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) that every mechanism file, TOML or JSON, fits.

    >>> schema()["required"]
    ['format', 'title', 'links']
    """
    return {
        "$schema": DIALECT,
        "title": "compoundkin mechanism file",
        "description": "A planar compound mechanism: its links, pairs and drivers.",
        "type": "object",
        "properties": {
            "format": {"enum": list(doc.FORMATS), "description": doc.FORMAT_DOC},
            **{key.name: _key(key) for key in doc.HEAD},
            **{table.name: _tables(table) for table in doc.table_forms()},
            doc.DRAWN.name: _key(doc.DRAWN),
            doc.GRAVITY.name: _key(doc.GRAVITY),
        },
        "required": ["format", *(key.name for key in doc.HEAD if key.required), "links"],
        "additionalProperties": False,
        "$defs": {
            **DEFINITIONS,
            "load_table": closed_table(LoadTable.keys),
            "law": _tagged(LAWS, "How a driven coordinate moves in time."),
            "segment": closed_table(ProgramSegment.keys),
            "turned": closed_table(SEGMENT),
            "program": closed_table(PROGRAM),
            "path": _tagged(PATHS, "The path of a point in time."),
            "profile": _tagged(PROFILES, "The profile of a cam or curved slot, in the coordinates of its link."),
        },
    }


def publish(path: str | os.PathLike[str]) -> None:
    """Write the schema to a file, as in ``docs/mechanism.schema.json``."""
    text = json.dumps(schema(), indent=2, ensure_ascii=False) + "\n"
    write_atomically(path, lambda file: file.write(text.encode("utf-8")))


def _tables(table: doc.TableForm) -> dict[str, Any]:
    one = closed_table(table.keys)
    if table.name in ALONG_PAIRS:
        one = {"anyOf": [one, closed_table(ALONG_PAIRS[table.name].keys)]}
    if table.name == DRIVES:
        ways = [{"required": [key.name]} for key in PrescribedMotion.keys if key.kind in ("law", "path")]
        one = {"anyOf": [one, {**closed_table(PrescribedMotion.keys), "anyOf": ways}]}
    if table.form == "array":
        return {"type": "array", "items": one, "description": table.doc}
    return {"type": "object", "additionalProperties": one, "required": [FRAME], "description": table.doc}


def closed_table(keys: tuple[Key, ...]) -> dict[str, Any]:
    """Return the schema of a table that has these keys and no others."""
    out: dict[str, Any] = {"type": "object", "properties": {key.name: _key(key) for key in keys}}
    required = [key.name for key in keys if key.required]
    return {**out, **({"required": required} if required else {}), "additionalProperties": False}


def _tagged(kinds: Mapping[str, type[Any]], doc: str) -> dict[str, Any]:
    """Return one table for each kind of law or profile."""
    tables = [(name, closed_table(kind.keys)) for name, kind in kinds.items()]
    ways = [
        {**table, "properties": {KIND: {"const": name}, **table["properties"]},
         "required": [KIND, *table.get("required", ())]}
        for name, table in tables
    ]  # fmt: skip
    return {"description": doc, "anyOf": ways}


def _key(key: Key) -> dict[str, Any]:
    out = {**FRAGMENTS[key.kind], "description": key.doc}
    if key.default in (None, "", ()) or key.kind == "layers":
        return out
    made = {"turn": exact_numbers.degrees, "angle": exact_numbers.degrees, "place": exact_numbers.point}
    return {**out, "default": made[key.kind](key.default) if key.kind in made else key.default}


def _ref(name: str) -> dict[str, Any]:
    return {"$ref": f"#/$defs/{name}"}


def _closed(**properties: Any) -> dict[str, Any]:
    """Return a table that has exactly these keys."""
    return {"type": "object", "properties": properties, "required": list(properties), "additionalProperties": False}


def _pair_of(first: Any, second: Any) -> dict[str, Any]:
    return {"type": "array", "prefixItems": [first, second], "minItems": 2, "maxItems": 2}


def _ends(value: Any) -> dict[str, Any]:
    """Return two ends of a guide, or a table of one that there is."""
    end = {"anyOf": [value, NAME]}
    one = {"type": "object", "properties": {"from": end, "to": end}, "minProperties": 1, "additionalProperties": False}
    return {"anyOf": [_pair_of(end, end), one]}


NUMBER = {"type": "number"}
NAME = {"type": "string", "minLength": 1}
# Such as "0:360:5" and "60 rpm".
RANGE = {"type": "string", "pattern": "^[^:]+:[^:]+:[^:]+$"}
RATE = {"type": "string", "pattern": r"^\s*[-+.\dEe]+\s*(rpm|1/min|deg|deg/s|rad/s)\s*$"}

# A table of a load whose values are vectors.
_VECTORS = {"properties": {"values": {"items": _pair_of(NUMBER, NUMBER)}}, "required": ["at", "values"]}

DEFINITIONS: dict[str, Any] = {
    "numbers": {
        "description": "A number, or a nested list of numbers for an array.",
        "anyOf": [NUMBER, {"type": "array", "items": _ref("numbers"), "minItems": 1}],
    },
    "angle": {
        "description": "Degrees, or {rad = ...}.",
        "anyOf": [_ref("numbers"), _closed(rad=_ref("numbers"))],
    },
    "values": {
        "description": "Degrees for a pin, lengths for a slide; {from, to, step}; {rad = ...}.",
        "anyOf": [_ref("angle"), _closed(**{"from": NUMBER, "to": NUMBER, "step": NUMBER}), RANGE],
    },
    "times": {
        "description": "Seconds: a list or {from, to, step}.",
        "anyOf": [_ref("numbers"), _closed(**{"from": NUMBER, "to": NUMBER, "step": NUMBER}), RANGE],
    },
    "rate": {
        "description": "rad/s for a pin, length/s for a slide; {rpm = ...}; {deg = ...} (a second).",
        "anyOf": [_ref("numbers"), _closed(rpm=_ref("numbers")), _closed(deg=_ref("numbers")), RATE],
    },
    "point": {
        "description": "[x, y] or {polar = [radius, degrees]}.",
        "anyOf": [_pair_of(*[_ref("numbers")] * 2), _closed(polar=_pair_of(_ref("numbers"), _ref("angle")))],
    },
    "single": {
        "description": "A number, or {rad = ...} for an angle.",
        "anyOf": [NUMBER, _closed(rad=NUMBER)],
    },
    "units": _closed(**{name: {"enum": list(units)} for name, units in UNITS.items()}),
    "amount": {"anyOf": [_ref("numbers"), _ref("load_table")]},
    "planar": {"anyOf": [_ref("point"), _pair_of(_ref("amount"), _ref("amount")), _VECTORS]},
    "single_rate": {
        "description": "A number, {rpm = ...} or {deg = ...}.",
        "anyOf": [NUMBER, _closed(rpm=NUMBER), _closed(deg=NUMBER), RATE],
    },
}

FRAGMENTS: dict[Kind, dict[str, Any]] = {
    "name": NAME,
    "text": {"type": "string"},
    "names": {"type": "array", "items": NAME, "uniqueItems": True},
    "length": _ref("numbers"),
    **dict.fromkeys(("angle", "coordinate"), _ref("angle")),
    **dict.fromkeys(("point", "place"), _ref("point")),
    "units": _ref("units"),
    "spot": {"anyOf": [NAME, _ref("point")]},
    "spots": {"type": "array", "items": {"anyOf": [NAME, _ref("point")]}, "minItems": 2},
    "layers": {"type": ["integer", "array"], "items": {"type": "integer"}, "minItems": 1},
    "amount": _ref("amount"),
    "planar": _ref("planar"),
    "sign": {"enum": [1, -1]},
    "flag": {"type": "boolean"},
    "two": _pair_of(_ref("numbers"), _ref("numbers")),
    "points": {
        "anyOf": [
            {"type": "object", "additionalProperties": _ref("point"), "minProperties": 1},
            {"type": "array", "items": NAME, "uniqueItems": True, "minItems": 1},
        ]
    },
    "drawing": {"type": "object", "additionalProperties": _ref("point")},
    "whole": {"type": "integer"},
    "span": {"type": "number", "exclusiveMinimum": 0},
    "times": _ref("times"),
    "segments": {"type": "array", "items": _ref("segment"), "minItems": 1},
    "law": _ref("law"),
    "number": NUMBER,
    "turn": _ref("single"),
    "places": {"type": "array", "items": _ref("point"), "minItems": 4},
    "route": {"type": "array", "items": _ref("point"), "minItems": 2},
    "path": _ref("path"),
    "turned": {"type": "array", "items": _ref("turned"), "minItems": 1},
    "program": {"anyOf": [{"type": "array", "items": _ref("turned"), "minItems": 1}, _ref("program")]},
    "profile": _ref("profile"),
    "values": _ref("values"),
    "rate": _ref("rate"),
    "at": {
        "type": "object",
        "patternProperties": {r"\.": _ref("single_rate")},
        "additionalProperties": _ref("single"),
    },
    "published": {"anyOf": [_ref("single"), _pair_of(NUMBER, NUMBER)]},
    "margin": _ref("single"),
    "reach": _ends(_ref("numbers")),
    "sweep": _ends(_ref("angle")),
}
