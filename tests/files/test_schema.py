"""The published JSON Schema fits what the reader reads."""

from __future__ import annotations

import copy
import json
import tomllib
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from compoundkin.files import dumps, load
from compoundkin.files.json_schema import schema
from tests.catalog import FILES, each

PUBLISHED = Path(__file__).parents[2] / "docs" / "mechanism.schema.json"
VALIDATOR = Draft202012Validator(schema())


def test_the_published_schema_is_up_to_date() -> None:
    Draft202012Validator.check_schema(schema())
    # mend with: compoundkin.files.json_schema.publish("docs/mechanism.schema.json")
    assert json.loads(PUBLISHED.read_text("utf-8")) == schema()


@each(FILES)
def test_every_file_fits(sample: Path) -> None:
    VALIDATOR.validate(tomllib.loads(sample.read_text("utf-8")))
    VALIDATOR.validate(tomllib.loads(dumps(load(sample))))
    VALIDATOR.validate(json.loads(dumps(load(sample), "json")))


def test_every_key_is_described() -> None:
    for name, fragment in schema()["properties"].items():
        assert fragment["description"], name


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("format",), 2),
        (("format",), None),
        (("title",), 3),
        (("titel",), "x"),
        (("links",), {}),
        (("links", "crank"), {}),
        (("links", "crank", "points"), []),
        (("links", "crank", "points", "D"), [1, True]),
        (("links", "crank", "points", "D"), [1]),
        (("links", "crank", "points", "D"), {"polar": [1, 2], "x": 1}),
        (("slides", 0, "on"), None),
        (("slides", 0, "angle"), "0"),
        (("slides", 0, "agle"), 0),
        (("drives", 0, "values"), {"from": 0, "to": 1}),
        (("drives", 0, "speed"), {"rmp": 1}),
        (("drives",), {}),
        (("drawn", "A"), 3),
        (("modes", 0, "sign"), 0),
        (("expected", 0, "at", "crank"), [1]),
        (("expected", 0, "value"), [1, 2, 3]),
        (("expected", 0, "tolerance"), None),
    ],
)
def test_bad_documents_do_not_fit(document: dict[str, Any], place: tuple[Any, ...], value: Any) -> None:
    assert VALIDATOR.is_valid(document)
    inner: Any = copy.deepcopy(document)
    whole = inner
    for key in place[:-1]:
        inner = inner[key]
    if value is None:
        del inner[place[-1]]
    else:
        inner[place[-1]] = value
    assert not VALIDATOR.is_valid(whole)
