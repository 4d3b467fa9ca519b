"""Gears, belts, racks and rolling wheels are read from a file as they were written, arrays and all."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from jsonschema import Draft202012Validator

from compoundkin.base.errors import InvalidMechanism
from compoundkin.files import dumps, loads
from compoundkin.files.json_schema import schema
from compoundkin.model.elements import drive, link
from compoundkin.model.geometry import deg
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.belt import belt
from compoundkin.model.pairs.gear import gear
from compoundkin.model.pairs.rack import rack
from compoundkin.model.pairs.rolling import roll, roll_around
from tests.support import examples

SHAPES = ((), (), (), (5,), (2, 1), (2, 5))
VALIDATOR = Draft202012Validator(schema())


def values(of: st.SearchStrategy[float]) -> st.SearchStrategy[Any]:
    """A number or an array; all arrays broadcast together."""
    return st.sampled_from(SHAPES).flatmap(lambda shape: arrays(float, shape, elements=of) if shape else of)


sizes = values(st.floats(0.1, 1e4))
small = values(st.floats(0.1, 10.0))
counts = values(st.integers(8, 200).map(float))
lengths = values(st.floats(-1e5, 1e5))
angles = values(st.one_of(st.floats(-1e4, 1e4), st.decimals(-720, 720, places=2).map(deg)))
sides = st.sampled_from([1, -1])
on_line = {"phase": lengths, "angle": angles, "side": sides, "toward": st.just("Q")}
on_frame = {"at": st.just("P"), "through": st.just("A")}


def some(**optional: st.SearchStrategy[Any]) -> st.SearchStrategy[dict[str, Any]]:
    return st.fixed_dictionaries({}, optional=optional)


def word(make: Any, *names: str, **given_words: st.SearchStrategy[Any]) -> st.SearchStrategy[Pair]:
    required = {key: given_words.pop(key) for key in list(given_words) if key in REQUIRED}
    optional = some(name=st.just("mesh"), **given_words)
    both = st.tuples(st.fixed_dictionaries(required), optional)
    return both.map(lambda pair: make(*names, **pair[0], **pair[1]))


REQUIRED = ("teeth", "on", "through", "at", "radius", "circle", "centre_at")
PAIRS = st.one_of(
    word(gear, "one", "two", teeth=st.tuples(counts, counts), phase=angles),
    word(belt, "one", "two", teeth=st.tuples(counts, counts), phase=angles, crossed=st.booleans()),
    word(rack, "frame", "three", **on_frame, radius=sizes, **on_line),
    word(roll, "three", on=st.just("frame"), **on_frame, radius=sizes, **on_line),
    word(
        roll_around,
        "three",
        on=st.just("frame"),
        at=st.just("P"),
        centre_at=st.just("A"),
        circle=sizes.map(lambda size: size + 20.0),
        radius=small,
        inside=st.booleans(),
        phase=angles,
    ),
)


@settings(max_examples=examples(150), deadline=None)
@given(PAIRS, st.sampled_from(["toml", "json"]))
def test_every_pair_is_read_as_it_was_written(pair: Pair, syntax: Any) -> None:
    links = (
        link("frame", A=0, B=(30, 0), Q=(1, 1)),
        link("one", A=0, C=(1, 0)),
        link("two", B=0),
        link("three", P=(1, 0), C=0),
    )
    mechanism = Mechanism("m", *links, pair, drive("one"))
    text = dumps(mechanism, syntax)
    assert loads(text, syntax) == mechanism
    if syntax == "toml":
        VALIDATOR.validate(tomllib.loads(text))


def test_the_file_says_what_python_says() -> None:
    text = """
format = 1
title = "m"

[links.frame]
points = { A = [0, 0], B = [30, 0] }

[links.one]
points = { A = [0, 0] }

[links.two]
points = { B = [0, 0], P = [1, 0] }

[links.bar]
points = { R = [0, 0] }

[[slides]]
link = "bar"
on = "frame"
through = "A"

[[gears]]
first = "one"
second = "two"
teeth = [20, 40]
phase = 90

[[racks]]
rack = "bar"
pinion = "one"
through = "R"
radius = [[3], [4]]
side = -1

[[drives]]
link = "one"
"""
    written = Mechanism(
        "m",
        link("frame", A=0, B=(30, 0)),
        link("one", A=0),
        link("two", B=0, P=(1, 0)),
        link("bar", R=0),
        *(word for word in loads(text).items if getattr(word, "name", "") == "bar/frame"),
        gear("one", "two", teeth=(20, 40), phase=deg(90)),
        rack("bar", "one", through="R", radius=np.array([[3.0], [4.0]]), side=-1),
        drive("one"),
    )
    assert loads(text) == written


@pytest.mark.parametrize(
    ("table", "what"),
    [
        ('[[gears]]\nfirst = "one"\nsecond = "two"\nteeth = 20', r"gears\[0\]\.teeth"),
        ('[[gears]]\nfirst = "one"\nteeth = [20, 40]', r"gears\[0\]\.second"),
        ('[[gears]]\nfirst = "one"\nsecond = "two"\nteeth = [20, 40]\ninternal = 1', r"gears\[0\]\.internal"),
        (
            '[[racks]]\nrack = "frame"\npinion = "two"\nthrough = "A"\nat = "P"\nradius = 3\nside = 0',
            r"racks\[0\]\.side",
        ),
        ('[[rollings]]\nlink = "two"\non = "frame"\nthrough = "A"\nat = "P"', r"rollings\[0\]\.radius"),
    ],
)
def test_mistakes_in_files_have_a_place(table: str, what: str) -> None:
    links = "".join(
        f"[links.{name}]\npoints = {{ {points} }}\n"
        for name, points in (
            ("frame", "A = [0, 0], B = [30, 0]"),
            ("one", "A = [0, 0]"),
            ("two", "B = [0, 0], P = [1, 0]"),
        )
    )
    with pytest.raises((InvalidMechanism, ValueError), match=what):
        loads(f'format = 1\ntitle = "m"\n{links}{table}\n')
