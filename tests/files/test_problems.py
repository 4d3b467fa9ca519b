"""A bad file is one error that names every problem with its place, and nothing that is not one."""

from __future__ import annotations

import copy
import datetime
import json
import warnings
from collections.abc import Iterator
from typing import Any

import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidMechanism
from compoundkin.files import dumps, loads
from compoundkin.files.reader import read
from tests.support import EVERYTHING

Place = tuple[str | int, ...]
DELETED = object()
WRONG = [
    True, 3, -7.5, "x y", "", [], {}, None, [[1], 2], [1, 2, 3], [{}], [True, 1], {"rad": "x"}, {"zz": 1},
    float("nan"), float("inf"), 10**400, datetime.date(2020, 1, 1), DELETED,
]  # fmt: skip


def problems(text: str, *changes: tuple[str, str], syntax: Any = "toml") -> list[str]:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    with pytest.raises(InvalidMechanism) as caught:
        loads(text, syntax, "six.toml")
    return [str(problem) for problem in caught.value.problems]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("format = 1", "", "format: it is missing; known: format = 1"),
        ("format = 1", "format = 2", "format: 2 is not a known version of the format; known: format = 1"),
        (
            "format = 1",
            "format = true",
            "format: true is not a known version of the format; known: format = 1",
        ),
        ('unit = "mm"', "unit = 3", "unit: 3 is not a text; write it in quotes"),
        ('unit = "mm"', 'unt = "mm"', "unt: there is no such key here; did you mean 'unit'?"),
        ("E = [0, 0], B", "E = [true, 0], B", "links.frame.points.E: true is not a number"),
        ("E = [0, 0], B", "E = [nan, 0], B", "links.frame.points.E: nan is not finite"),
        (
            "E = [0, 0], B",
            "E = [[1, 2], [3, 4, 5]], B",
            "links.frame.points.E: the two lists differ in shape",
        ),
        (
            "E = [0, 0], B",
            "E = [0], B",
            "links.frame.points.E: a list is not a point; write [x, y] or {polar = [radius, degrees]}",
        ),
        (
            "points = { F",
            "pionts = { F",
            "links.bar.pionts: there is no such key here; did you mean 'points'?",
        ),
        (
            'on = "bar"',
            "",
            "slides[0].on: it is missing; The link that carries the guide.",
        ),
        ('on = "bar"', 'on = ""', "slides[0].on: the name is empty"),
        ("angle = 0", 'angle = "0"', "slides[0].angle: the text '0' is not a number"),
        ("angle = 0", "angle = { rad = [] }", "slides[0].angle.rad: the list is empty"),
        ("[[slides]]", "[slides]", "slides: a table is not an array of tables; write [[slides]]"),
        (
            "{ rpm = 700 }",
            "{ rmp = 700 }",
            "drives[0].speed: a table of rmp means nothing here; write a number or {rpm = ...} or {deg = ...}",
        ),
        ("step = 5", "step = -5", "drives[0].values.step: steps of -5 do not lead from 0 to 360"),
        ("step = 5", "step = 0", "drives[0].values.step: steps of 0 do not lead from 0 to 360"),
        ("step = 5", "step = 1e-9", "drives[0].values.step: more than 1000000 values; take a greater step"),
        ("step = 5", "by = 5", "drives[0].values.by: it has no place here; known: from, to, step"),
        (", step = 5", "", "drives[0].values.step: it is missing; known: from, to, step"),
        ("sign = 1", "sign = 2", "modes[0].sign: 2 is not an assembly mode; write 1 or -1"),
        ("sign = 1", "sign = true", "modes[0].sign: true is not an assembly mode; write 1 or -1"),
        ('["plate", "rocker"]', '["plate", "plate"]', "modes[0].links: 'plate' is listed twice"),
        (
            '{ crank = 35, "crank.speed" = 10 }',
            "{ crank.speed = 10 }",
            'expected[0].at.crank: a table is not a number; for rates write "crank.speed" in quotes',
        ),
        (
            "{ crank = 35 }",
            "{ crnk = 35 }",
            "expected[1].at.crnk: there is no driver 'crnk'; did you mean 'crank'?",
        ),
        ("value = 62.5", "value = [1, 2]", "expected[1].value: a list is not an angle; write degrees"),
        (
            "tolerance = 0.01",
            "tolerance = -1",
            "expected[1].tolerance: -0.017453292519943295 is not a tolerance; give a number that is not negative",
        ),
        ("A = [30", "Q = [30", "drawn.Q: no link carries this point; known: E, B, F, D, A, C, G"),
        ('link = "crank"', 'link = "crnk"', "drives[0].link: there is no link 'crnk'; did you mean 'crank'?"),
    ],
)
def test_one_mistake_is_one_problem(text: str, old: str, new: str, expected: str) -> None:
    assert problems(text, (old, new)) == [expected]


def test_all_problems_come_at_once_with_the_name_of_the_file(text: str) -> None:
    changes = [
        ("D = [14, 0]", 'D = [14, "0"]'),
        ("angle = 0", "agle = 0"),
        ("values = { from", "values = { form"),
        ('at = "C"', 'at = "G"'),
        ("sign = 1", "sign = 0"),
        ("A = [30, -26]", "A = [30, -26]\nZ = [0, 0]"),
    ]
    assert {p.split(":")[0] for p in problems(text, *changes)} == {
        "links.crank.points.D",
        "slides[0].agle",
        "slides[0].at",
        "drives[0].values.form",
        "modes[0].sign",
        "drawn.Z",
    }
    with pytest.raises(InvalidMechanism, match=r"^six.toml: 2 problems:\n  format"):
        loads("[links.frame]\npoints = { A = [0, 0] }", where="six.toml")


def test_units_that_the_driven_pair_does_not_have(text: str) -> None:
    changes = [
        ('link = "crank"', 'link = "block"\non = "bar"'),
        ("{ from = 0, to = 360, step = 5 }", "{ rad = 1 }"),
        ("{ crank = 35, ", "{ "),
        ("crank.speed", "block.speed"),
        ("crank = 35", "block = 3"),
    ]
    what = "this coordinate is a length, not an angle; write lengths"
    assert problems(text, *changes) == [
        f"drives[0].values.rad: {what}",
        f"drives[0].speed.rpm: {what}",
    ]  # fmt: skip


def places(value: Any, place: Place = ()) -> Iterator[Place]:
    if place:
        yield place
    entries = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, entry in entries:
        yield from places(entry, (*place, key))


def changed(document: dict[str, Any], place: Place, value: Any) -> dict[str, Any]:
    out = copy.deepcopy(document)
    inner: Any = out
    for key in place[:-1]:
        inner = inner[key]
    if value is DELETED:
        del inner[place[-1]]
    else:
        inner[place[-1]] = value
    return out


def written(place: Place) -> str:
    return "".join(f"[{key}]" if isinstance(key, int) else f".{key}" for key in place)[1:]


def test_any_value_of_any_sort_anywhere_is_read_or_refused(document: dict[str, Any]) -> None:
    refused: list[InvalidMechanism] = []
    thin = 1 if EVERYTHING else 5
    for number, place in enumerate(places(document)):
        for value in WRONG[number % thin :: thin]:
            try:
                read(changed(document, place, value))
            except InvalidMechanism as error:
                refused.append(error)
    for error in refused:
        texts = [str(problem) for problem in error.problems]
        assert len(set(texts)) == len(texts)
        assert "\ufffd" not in str(error)


@pytest.mark.parametrize("value", [True, None, datetime.date(2020, 1, 1), 10**400, float("nan")])
def test_a_value_of_the_wrong_sort_causes_no_problem_elsewhere(document: dict[str, Any], value: Any) -> None:
    for place in places(document):
        where = written(place)
        with pytest.raises(InvalidMechanism) as caught:
            read(changed(document, place, value))
        for problem in caught.value.problems:
            assert problem.where.startswith(where) or where.startswith(problem.where), (where, str(problem))


def test_syntax_errors_tell_line_and_column(text: str) -> None:
    assert problems(text, ('title = "S', "title = S"))[0].startswith("line 2, column 9: this is not TOML")
    assert problems('format = 1\ntitle = "')[0].startswith("line 2, column 10: this is not TOML")
    assert problems('{\n"format" 1}', syntax="json")[0].startswith("line 2, column 10: this is not JSON")
    assert "twice" in problems(text, ("[links.crank]", "[links.frame]"))[0]


def test_json_names_keys_given_twice_with_their_places() -> None:
    text = '{"format": 1, "links": {"a": {"points": {}, "points": {}}, "a": 1}, "drives": [{"on": 1, "on": 2}]}'
    found = problems(text, syntax="json")
    assert [p.split(":")[0] for p in found] == ["links.a", "drives[0].on"]


@pytest.mark.parametrize(
    ("text", "syntax"),
    [
        ("", "toml"),
        ("[]", "json"),
        ("3", "json"),
        ('{"format": NaN}', "json"),
        ("[" * 100_000, "json"),
        ("a = " + "[" * 100_000, "toml"),
        ('{"format": ' + "9" * 5000 + "}", "json"),
        ("format = " + "9" * 5000, "toml"),
    ],
)
def test_strange_texts_are_refused(text: str, syntax: Any) -> None:
    assert problems(text, syntax=syntax)


def test_a_table_for_the_pair_of_a_load_in_json_is_refused() -> None:
    document = json.loads(dumps(ck.load("engine-gas-pressure"), "json"))
    document["efforts"] = [{"name": "e", "pair": "A", "amount": {"over": {}, "at": [0, 1], "values": [0, 1]}}]
    with pytest.raises(InvalidMechanism, match="over"):
        loads(json.dumps(document), "json")


def test_points_that_differ_by_the_least_number_have_no_direction() -> None:
    """Products of their coordinates overflowed."""
    document = json.loads(dumps(ck.load("scissor-lift-loaded"), "json"))
    document["links"]["platform"]["points"]["T"] = [5e-324, 0.0]
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        assert loads(json.dumps(document), "json").links["platform"].points["T"] == 5e-324
