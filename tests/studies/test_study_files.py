"""Studies as files: what is read is what was written, the schema fits, and every problem is told with its place."""

from __future__ import annotations

import copy
import datetime
import json
import random
import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files import dumps
from compoundkin.studies.samples import sample_of
from compoundkin.studies.samples.value_ranges import around
from compoundkin.studies.samples.variations import VARIATIONS, variation_from, variation_of
from compoundkin.studies.study_document import (
    is_angle_dimension,
    study_arguments,
    study_schema,
    study_text,
    variation_entry,
)

VALIDATOR = Draft202012Validator(study_schema())
TEXT = """
format = 1
mechanism = "six-bar"                  # a shipped one, or the path of a file
outputs = ["G.x.stroke", "G.velocity"]
sample = "latin-hypercube"
count = 300
seed = 7

[dimensions]
"crank.D" = { centre = [15, 0], within = 0.05, sigmas = 3 }
"rocker.A.x" = { low = 27, high = 29 }
"slot.angle" = { distribution = "norm", loc = { rad = 0.001 }, scale = 0.5 }
"plate.C" = { values = [[12.3, 8.6], { polar = [15, 35] }] }

[drives.crank]
values = { from = 0, to = 90, step = 10 }
speed = "700 rpm"

[modes]
plate = -1
"""


@dataclass(frozen=True)
class Said:
    """A study as the writer reads it."""

    mechanism: ck.Mechanism
    dimensions: dict[str, Any]
    outputs: Any
    sample: Any
    values: Any = None
    speed: Any = None
    time: Any = None
    modes: Any = None


def said_of(arguments: dict[str, Any]) -> Said:
    given = dict(arguments)
    sample, count, seed = given.pop("sample", "sobol"), given.pop("count", None), given.pop("seed", 0)
    return Said(**given, sample=sample_of(sample, count, seed, given["dimensions"]))


def read(text: str, folder: Path = Path(), syntax: str = "toml") -> dict[str, Any]:
    return study_arguments(tomllib.loads(text) if syntax == "toml" else json.loads(text), folder, "a.toml")


def problems(*changes: tuple[str, str]) -> list[str]:
    text = TEXT
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    with pytest.raises(InvalidInput) as caught:
        read(text)
    assert (
        caught.value.heading == f"a.toml: {len(caught.value.problems)} problem{'s'[: len(caught.value.problems) > 1]}"
    )
    return [str(problem) for problem in caught.value.problems]


def test_a_file_says_what_python_says() -> None:
    found = read(TEXT)
    bar = found["dimensions"]
    assert found["mechanism"] == ck.load("six-bar")
    assert (found["sample"], found["count"], found["seed"]) == ("latin-hypercube", 300, 7)
    assert bar["crank.D"] == around((15, 0), 0.05, sigmas=3)
    assert bar["rocker.A.x"].data == {"low": 27, "high": 29}
    # degrees are radians in Python, whatever the kind of variation
    assert bar["slot.angle"].data == {"distribution": "norm", "loc": 0.001, "scale": np.deg2rad(0.5)}
    assert np.allclose(bar["plate.C"].listed, [12.3 + 8.6j, 15 * np.exp(1j * np.deg2rad(35))], rtol=1e-15)
    assert np.allclose(found["values"]["crank"], np.deg2rad(np.arange(0, 91, 10)), rtol=1e-15)
    assert found["speed"] == {"crank": pytest.approx(700 * np.pi / 30, rel=1e-15)}
    assert found["modes"] == {"plate": -1}


@pytest.mark.parametrize("syntax", ["toml", "json"])
def test_what_is_written_is_read_as_the_same(syntax: str) -> None:
    VALIDATOR.validate(tomllib.loads(TEXT))
    own = said_of(read(TEXT))
    text = study_text(own, syntax)
    VALIDATOR.validate(tomllib.loads(text) if syntax == "toml" else json.loads(text))
    again = said_of(read(text, syntax=syntax))
    assert again.dimensions == own.dimensions
    assert (again.mechanism, again.outputs, again.modes) == (own.mechanism, own.outputs, own.modes)
    assert again.sample.data == own.sample.data
    assert np.array_equal(again.values["crank"], own.values["crank"])
    assert again.speed == own.speed
    assert study_text(again, syntax) == text


def test_the_mechanism_is_found_from_the_file(tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(dumps(ck.load("crank-rocker")), "utf-8")
    text = 'format = 1\nmechanism = "own.toml"\noutputs = ["C"]\n[dimensions]\n"coupler.C.x" = { low = 1, high = 2 }'
    assert read(text, tmp_path)["mechanism"].title == ck.load("crank-rocker").title
    (tmp_path / "own.toml").write_text("format = 1\ntitle = 3", "utf-8")
    with pytest.raises(InvalidInput, match=r"mechanism title .line 2, column 1.: 3 is not a text"):
        read(text, tmp_path)


def test_angles_are_known_before_anything_is_solved() -> None:
    """By the units that programs know, in every shipped mechanism; points and lengths are none."""
    for name in ("six-bar", "planetary-gear", "crane", "disc-cam-offset-roller"):
        if name not in ck.exchange.shipped():
            continue
        mechanism = ck.load(name)
        stated = ck.compile(mechanism, mechanism.outputs or ["frame.angle"], free=[]).programs.stated
        for one in stated.known.values():
            if not one.is_of_law:
                assert is_angle_dimension(mechanism, {}, one.name) == (stated.unit(one) == "rad"), one.name


def test_angles_of_laws_follow_their_driver() -> None:
    turned = ck.laws.program(ck.laws.rise(1.2, over=1.0), ck.laws.dwell(0.5))
    mechanism = ck.load("six-bar").replace(ck.drive("crank", law=turned))
    for is_angle in (True, False):
        words = ("start", "segments.0.rise", "segments.0.over", "segments.0.speed")
        found = [is_angle_dimension(mechanism, {"crank": is_angle}, f"crank.law.{word}") for word in words]
        assert found == [is_angle, is_angle, False, False]


def test_every_kind_of_variation_fits_the_schema() -> None:
    Draft202012Validator.check_schema(study_schema())
    ranged = (variation_of("a", one) for one in ((1.0, 2.0), ((0, 0), (1, 1))))
    found = [*ranged, *read(TEXT)["dimensions"].values()]
    assert {type(one) for one in found} == set(VARIATIONS)
    for one in found:
        entry = variation_entry(one.data, False)
        VALIDATOR.validate({**tomllib.loads(TEXT), "dimensions": {"crank.D": entry}})
        assert variation_from("a", entry) == one


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("format = 1", "format = 2", "format: 2 is not a known version of the format; known: format = 1"),
        ("format = 1", "", "format: it is missing; known: format = 1"),
        ('"six-bar"', '"six-bra"', "mechanism six-bra: neither a file nor in the catalog; did you mean 'six-bar'?"),
        ('"six-bar"', '"no/six-bar.toml"', "mechanism no/six-bar.toml: there is no such file"),
        ('mechanism = "six-bar"', "", "mechanism: it is missing; write"),
        ('"six-bar"', "3", "mechanism: 3 is not a name; write"),
        ("outputs", "output", "output: there is no such key here; did you mean 'outputs'?"),
        ("count = 300", "count = 3.5", "count: 3.5 is not a whole number"),
        ("seed = 7", 'seed = "x"', "seed: the text 'x' is not a whole number"),
        ('"latin-hypercube"', "{ a = 1.5 }", "sample.a: 1.5 is not a number of levels"),
        ('"latin-hypercube"', "7", "sample: 7 is not a table; "),
        ("plate = -1", "plate = true", "modes.plate: true is not an assembly mode"),
        ("[drives.crank]", "[drives.crnk]", "drives.crnk: there is no driver 'crnk'; did you mean 'crank'?"),
        ("step = 10", "step = 0", "drives.crank.values.step: steps of 0 do not lead from 0 to 90"),
        ("speed =", "sped =", "drives.crank.sped: there is no such key here; did you mean 'speed'?"),
        ("{ low = 27, high = 29 }", "[27, 29]", "dimensions.rocker.A.x: a list is not a table; write { low"),
        ("scale = 0.5", 'scale = "x"', "dimensions.slot.angle.scale: the text 'x' is not a number"),
        (
            '"rocker.A.x"',
            "rocker.A.x",
            'dimensions.rocker: this is a table of tables; write the name in quotes: "rocker.A.x"',
        ),
        ("low = 27, high = 29", "low = 29, high = 27", "dimensions.rocker.A.x: the range 29"),
        ("low = 27, high = 29", "lo = 27, high = 29", "dimensions.rocker.A.x"),
        (
            '"norm"',
            '"nrom"',
            "dimensions.slot.angle: scipy.stats has no distribution 'nrom'; did you mean 'norm'?",
        ),
    ],
)
def test_a_problem_is_told_with_its_place(old: str, new: str, told: str) -> None:
    found = problems((old, new))
    assert any(one.startswith(told) for one in found), found
    # nothing else is made of it
    assert len(found) == 1 or "outputs" in old, found


def test_all_problems_are_told_at_once() -> None:
    found = problems(("format = 1", "format = 9"), ("count = 300", "count = []"), ("plate = -1", "plate = 0.5"))
    assert [re.split("[:]", one)[0] for one in found] == ["format", "count", "modes.plate"]


@pytest.mark.parametrize(
    ("sample", "dimensions"),
    [
        ('"random"\ncount = 10\nseed = 3', "low = 1, high = 2"),
        ('"grid"\ncount = 25', "low = 1, high = 2"),
        ('{ "crank.D.x" = 3, "crank.D.y" = 4 }', "low = 1, high = 2"),
        ('"table"', "values = [1, 2.5, 3]"),
        ('"sobol"\ncount = 8', "centre = 1, within = 0.5"),
    ],
)
def test_every_sample_is_written_and_read(sample: str, dimensions: str) -> None:
    head = f'format = 1\nmechanism = "six-bar"\noutputs = ["G"]\nsample = {sample}\n[dimensions]\n'
    text = head + "".join(f'"crank.D.{part}" = {{ {dimensions} }}\n' for part in "xy")
    VALIDATOR.validate(tomllib.loads(text))
    own = said_of(read(text))
    again = said_of(read(study_text(own, "toml")))
    assert again.sample.data == own.sample.data
    rows = (one.sample.designs(one.dimensions, range(own.sample.count)) for one in (own, again))
    first, second = rows
    assert all(np.array_equal(first[name], second[name]) for name in first)


def test_dimensions_may_be_the_columns_of_a_table(tmp_path: Path) -> None:
    (tmp_path / "designs.csv").write_text("crank.D.x,slot.angle [deg]\n13,-1\n14,2\n", "utf-8")
    text = 'format = 1\nmechanism = "six-bar"\noutputs = ["G"]\nsample = "table"\ndimensions = "designs.csv"'
    VALIDATOR.validate(tomllib.loads(text))
    own = said_of(read(text, tmp_path))
    found = own.sample.designs(own.dimensions, range(2))
    assert found["crank.D.x"].tolist() == [13.0, 14.0]
    assert np.allclose(found["slot.angle"], np.deg2rad([-1.0, 2.0]), rtol=1e-15)
    with pytest.raises(InvalidInput, match='sample: the dimensions are the columns of a table; write sample = "table"'):
        read(text.replace('sample = "table"', ""), tmp_path)
    with pytest.raises(InvalidInput, match=r"other\.csv"):
        read(text.replace("designs.csv", "other.csv"), tmp_path)


def places(value: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, one in inner:
        yield (*at, key)
        yield from places(one, (*at, key))


def test_whatever_is_wrong_is_told_in_one_error() -> None:
    wrong = [True, -7.5, "x y", "", [], {}, None, [[1], 2], [{}], {"rad": "x"}, {"polar": [[1, 2], 3]}, float("inf"),
             10**400, datetime.date(2026, 1, 1), "\ud800", ["x", 1], "0:1:0"]  # fmt: skip
    whole = tomllib.loads(TEXT)
    pairs = [(place, value) for place in places(whole) for value in wrong]
    for place, value in random.Random(1).sample(pairs, 40):
        document = copy.deepcopy(whole)
        inner: Any = document
        for key in place[:-1]:
            inner = inner[key]
        inner[place[-1]] = value
        told = ""
        try:
            assert study_arguments(document, Path(), "a.toml")
        except InvalidInput as error:
            told = str(error)
        # nothing else is raised, and the place is told
        assert not told or str(place[0]) in told, (place, value)


def test_functions_are_no_outputs_of_files() -> None:
    own = said_of(read(TEXT))
    with pytest.raises(InvalidInput, match="a Python function cannot be written"):
        study_text(Said(own.mechanism, own.dimensions, {"error": abs}, own.sample), "toml")
