"""The JSON Schema of study files, from the table of keys."""

from __future__ import annotations

from typing import Any

from compoundkin.files import schema
from compoundkin.files.json_schema import DIALECT, FRAGMENTS, closed_table
from compoundkin.studies.samples import SAMPLES
from compoundkin.studies.study_files import study_keys as keys

_NUMBER: dict[str, Any] = {"type": "number"}
_PLACE = {"anyOf": [FRAGMENTS["angle"], FRAGMENTS["point"]]}
_NUMBERS = {"type": "array", "items": _NUMBER}
_WHOLE = {"type": "object", "additionalProperties": {"type": "integer"}, "minProperties": 1}


def study_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) that every study file, TOML or JSON, fits.

    >>> study_schema()["required"]
    ['format', 'mechanism', 'dimensions', 'outputs']
    """
    whole = schema()
    definitions = whole.pop("$defs")
    return {
        "$schema": DIALECT,
        "title": "compoundkin study file",
        "description": "Many designs of a mechanism: what its dimensions may be, and what is found of each.",
        "type": "object",
        "properties": {
            keys.FORMAT: {"enum": list(keys.FORMATS), "description": keys.FORMAT_DOC},
            **{name: {**form, "description": keys.OTHERS[name]} for name, form in _forms().items()},
            **closed_table(keys.HEAD)["properties"],
        },
        "required": [keys.FORMAT, keys.MECHANISM, keys.DIMENSIONS, *(key.name for key in keys.HEAD if key.required)],
        "additionalProperties": False,
        "$defs": {**definitions, keys.MECHANISM: {k: v for k, v in whole.items() if k != "$schema"}},
    }


def _forms() -> dict[str, Any]:
    return {
        keys.MECHANISM: {"anyOf": [FRAGMENTS["name"], {"$ref": f"#/$defs/{keys.MECHANISM}"}]},
        keys.DIMENSIONS: {"anyOf": [_by_name({"anyOf": [_variation(*one) for one in _VARIATIONS]}), FRAGMENTS["name"]]},
        keys.SAMPLE: {"anyOf": [{"enum": list(SAMPLES)}, _WHOLE]},
        keys.MODES: {"anyOf": [FRAGMENTS["name"], _WHOLE]},
        keys.DRIVES: _by_name(closed_table(keys.DRIVEN)),
    }


def _by_name(entry: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "additionalProperties": entry, "minProperties": 1}


# What a variation says, and what it may say besides.
_VARIATIONS: tuple[tuple[dict[str, Any], dict[str, Any]], ...] = (
    ({"low": _PLACE, "high": _PLACE}, {}),
    ({"centre": _PLACE, "within": _PLACE}, {"sigmas": _NUMBER}),
    ({"values": {"anyOf": [FRAGMENTS["angle"], {"type": "array", "items": FRAGMENTS["point"]}]}}, {}),
    (
        {"distribution": FRAGMENTS["name"]},
        {"shape": _NUMBERS, "loc": _PLACE, "scale": _PLACE},
    ),
)


def _variation(needed: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {**needed, **more},
        "required": list(needed),
        "additionalProperties": False,
    }
