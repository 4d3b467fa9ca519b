"""A text of TOML is changed where another document wants it: what it then says, and that its comments stay."""

from __future__ import annotations

import copy
import json
import random
import tomllib
from typing import Any

import pytest

from compoundkin.errors import InvalidInput
from compoundkin.files.shipped_mechanisms import resolve
from compoundkin.files.toml_text import changed, dumps

TEXT = """\
# head
format = 1
title = "Crank"  # called so
outputs = [
    "A.position",  # the first
    'B.position',
]

[links]  # all of them
frame.points = ["O", "Q"]  # fixed
crank.points = { O = [0, 0], "A 1" = { polar = [2, 30] } }  # turns
# above the rod
[links.rod]
points = ["A 1",
          "B"]  # two

[[slides]]  # one
link = "rod"
on = "frame"
# the last
[[slides]]
link = "crank"

[drawn]
O = [0, 0]  # here
Q = [12.50, 0]
"""


def comments(text: str) -> list[str]:
    return [line.partition("#")[2] for line in text.splitlines() if "#" in line]


def test_values_change_at_their_places_and_nothing_else() -> None:
    wanted = tomllib.loads(TEXT)
    wanted["drawn"]["O"] = [0, 1.5]
    wanted["links"]["crank"]["points"]["A 1"]["polar"] = [2, 31]
    wanted["slides"][1]["link"] = "rod"
    expected = TEXT.replace("O = [0, 0]  # here", "O = [0, 1.5]  # here").replace("[2, 30]", "[2, 31]")
    assert changed(TEXT, wanted) == expected.replace('link = "crank"', 'link = "rod"')


def test_what_is_new_stands_beside_its_kind_and_what_is_gone_leaves_the_rest() -> None:
    wanted = tomllib.loads(TEXT)
    wanted["links"]["bar"] = {"points": ["B", "C"]}
    wanted["links"]["frame"]["points"] = ["O", "P", "Q"]
    wanted["drawn"]["C"] = [3, 4]
    del wanted["slides"][0]
    del wanted["outputs"][1]
    wanted["drives"] = [{"link": "crank"}]
    new = changed(TEXT, wanted)
    assert tomllib.loads(new) == wanted
    assert set(comments(TEXT)) - set(comments(new)) == {" one"}
    assert new.index("[links.rod]") < new.index("[links.bar]") < new.index("[[slides]]") < new.index("[[drives]]")


def test_a_text_without_an_end_of_line_and_an_empty_one() -> None:
    assert changed("a = 1", {"a": 1, "b": 2}) == "a = 1\nb = 2\n"
    assert tomllib.loads(changed("", {"links": {"frame": {"points": ["A"]}}})) == {
        "links": {"frame": {"points": ["A"]}}
    }
    assert changed("a = 1  # one", {"a": 1}) == "a = 1  # one"


def test_what_has_no_place_in_the_text_is_refused() -> None:
    """The table of a key with dots is written nowhere."""
    with pytest.raises(InvalidInput, match="change it in the text"):
        changed("a.b.c = 1\n", {"a": {"b": {"c": 1, "d": 2}}})


def altered(value: Any, dice: random.Random, depth: int = 0) -> None:
    """Change something of a document at random: a value, a key, a table or an item more or less."""
    what = dice.random()
    if isinstance(value, dict):
        keys = list(value)
        if depth and keys and what < 0.2:
            del value[dice.choice(keys)]
        elif what < 0.35 or not keys:
            more = [1, 2.5], 'te"xt', {"a": 1}, [{"x": 1, "y": [2, 3]}] if not depth else 3, {"p": {"q": 1}}
            value[f"new {dice.randrange(99)}"] = copy.deepcopy(dice.choice(more))
        else:
            _alter_one(value, dice.choice(keys), dice, depth)
    elif what < 0.3 and len(value) > 1:
        del value[dice.randrange(len(value))]
    elif what < 0.5:
        value.insert(dice.randrange(len(value) + 1), copy.deepcopy(dice.choice(value)))
    else:
        _alter_one(value, dice.randrange(len(value)), dice, depth)


def _alter_one(holder: Any, key: Any, dice: random.Random, depth: int) -> None:
    if isinstance(holder[key], dict | list) and holder[key]:
        altered(holder[key], dice, depth + 1)
    else:
        holder[key] = dice.choice([3, 4.5, "word", [1, "a"]])


@pytest.mark.parametrize("name", ["", "six-bar", "disc-cam-roller-program", "toggle-press-loaded", "v-engine"])
def test_random_changes_are_made_and_undone(name: str) -> None:
    """Nearly all have a place; what is made says what is wanted, and changing it back says what was said."""
    text = resolve(name).read_text(encoding="utf-8") if name else TEXT
    before, dice, made = tomllib.loads(text), random.Random(name), 0
    for _ in range(60):
        wanted = copy.deepcopy(before)
        for _ in range(dice.choice([1, 1, 2, 4])):
            altered(wanted, dice)
        try:
            new = changed(text, wanted)
            back = changed(new, before)
        except InvalidInput:
            continue
        assert tomllib.loads(new) == wanted
        assert tomllib.loads(back) == before
        made += 1
    assert made > 50


def test_what_is_changed_from_nothing_reads_like_what_is_written() -> None:
    wanted = tomllib.loads(TEXT)
    assert tomllib.loads(changed("format = 1\n", wanted)) == tomllib.loads(dumps(wanted))


def test_line_ends_stay_as_they_are() -> None:
    """Of a text from Windows also those of what is new, and a last line without an end."""
    wanted = tomllib.loads(TEXT)
    wanted["links"]["bar"] = {"points": ["B", "C"]}
    wanted["drawn"]["C"] = [3, 4]
    del wanted["slides"][0]
    new = changed(TEXT.replace("\n", "\r\n"), wanted)
    assert new.count("\n") == new.count("\r\n")
    assert new == changed(TEXT, wanted).replace("\n", "\r\n")
    assert changed("a = 1\nb = 2", {"a": 3, "b": 2}) == "a = 3\nb = 2"


def test_an_item_stands_as_its_neighbours_do() -> None:
    wanted = tomllib.loads(TEXT)
    wanted["outputs"].append("C.position")
    expected = TEXT.replace("    'B.position',\n", "    'B.position',\n    \"C.position\",\n")
    assert changed(TEXT, wanted) == expected


def test_a_text_of_json_keeps_its_layout() -> None:
    text = '{\n  "title": "m",\n  "links": {"frame": {"points": {"A": [0.50, 0]}}},\n  "own":  7\n}\n'
    wanted = json.loads(text)
    wanted["links"]["frame"]["points"]["A"] = [0.5, 1]
    wanted["drawn"] = {"A": [1, 2]}
    expected = text.replace("0.50, 0", "0.50, 1").replace('"own":  7', '"own":  7,\n  "drawn": {"A": [1, 2]}')
    assert changed(text, wanted, "json") == expected


@pytest.mark.parametrize("indent", [None, 2])
def test_random_changes_of_json_are_made_and_undone(indent: int | None) -> None:
    before, dice = tomllib.loads(TEXT), random.Random(3)
    text = json.dumps(before, indent=indent)
    for _ in range(60):
        wanted = copy.deepcopy(before)
        altered(wanted, dice)
        new = changed(text, wanted, "json")
        assert json.loads(new) == wanted
        assert json.loads(changed(new, before, "json")) == before
