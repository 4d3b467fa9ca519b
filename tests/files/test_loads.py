"""Masses and loads in mechanism files: what is written reads back, what is wrong is said in one reading."""

from __future__ import annotations

import json
import tomllib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from jsonschema import Draft202012Validator

import compoundkin as ck
from compoundkin.errors import InvalidInput, InvalidMechanism
from compoundkin.files import dumps, loads
from compoundkin.files.json_schema import schema
from tests.support import examples

VALIDATOR = Draft202012Validator(schema())
LINKS = (
    ck.link("frame", A=(0, 0), D=(4, 0)),
    ck.link("crank", A=(0, 0), B=(1, 0)),
    ck.link("coupler", B=(0, 0), C=(3, 0), G=(1.5, 1)),
    ck.link("rocker", D=(0, 0), C=(3, 0)),
    ck.link("block", S=(0, 0)),
    ck.slide("block", on="coupler", through="B", toward="C", name="stroke"),
    ck.drive("crank", values=np.linspace(0.0, 1.0, 5)),
)
finite = st.floats(-1e9, 1e9)
positive = st.floats(1e-9, 1e9)
lists = st.one_of(finite, arrays(float, 5, elements=finite), arrays(float, (2, 1), elements=finite))


@st.composite
def tables(draw: st.DrawFn, *over: str) -> dict[str, Any]:
    """A table over one of some names; "" is for the coordinate of the load itself."""
    at = np.cumsum(draw(arrays(float, 3, elements=st.floats(1e-3, 2.0))))
    found = {"at": at, "values": draw(arrays(float, 3, elements=finite)), "smooth": draw(st.booleans())}
    period = draw(st.none() | st.just(6.5))
    name = draw(st.sampled_from(over))
    return found | ({"over": name} if name else {}) | ({"period": period} if period else {})


def amounts(*over: str) -> st.SearchStrategy[Any]:
    return lists | tables(*over)


points = st.tuples(finite, finite)
sides = st.sampled_from([None, "tension", "compression"])
NAMED = ("time", "crank", "D", "stroke")


@st.composite
def loaded(draw: st.DrawFn) -> ck.Mechanism:
    """A mechanism with a load of every kind."""
    words = [
        ck.mass("crank", draw(positive)),
        ck.mass("rocker", density=draw(positive), at=draw(points)),
        ck.mass("coupler", draw(positive), at="G", inertia=0.0),
        ck.gravity(draw(st.floats(-20, 20)), -9.81),
        ck.force("coupler", draw(points), at="G", fixed_in=draw(st.sampled_from(["frame", "coupler", "rocker"]))),
        ck.force("C", (draw(amounts(*NAMED)), draw(amounts(*NAMED))), name="on the pin"),
        ck.force("rocker", draw(points), at=draw(points), while_moving=draw(points.filter(any))),
        ck.torque("rocker", draw(amounts(*NAMED))),
        ck.effort("stroke", draw(amounts("", *NAMED)), only=draw(st.sampled_from([None, "forward", "back"]))),
        ck.effort("crank", draw(amounts("", *NAMED))),
        ck.spring("rocker", "C", to="crank", at=draw(points), stiffness=draw(amounts("", "time")),
                  free_length=draw(positive), preload=draw(finite), only=draw(sides)),
        ck.spring(pair="D", stiffness=draw(amounts("", "stroke")), free=draw(lists), preload=draw(lists)),
        ck.spring(pair="stroke", stiffness=draw(positive), free=draw(lists), only=draw(sides)),
        ck.damper("coupler", "G", at="D", rate=draw(positive)),
        ck.damper(pair="C", rate=draw(tables("", "D"))),
        ck.stop("stroke", low=draw(finite), restitution=draw(st.none() | st.floats(0.0, 1.0))),
        ck.stop("D", low=-1e9, high=draw(st.floats(-1e8, 1e8)), stiffness=draw(positive), damping=draw(positive)),
        ck.latch("D", draw(finite), over="stroke", value=draw(finite), strength=draw(st.none() | positive)),
        ck.release("C", until=draw(positive), strength=draw(st.none() | positive), over="D", value=draw(finite)),
        ck.latch("stroke", until=draw(positive), over="crank", value=draw(finite)),
        ck.latch("B", since=draw(positive), strength=draw(positive)),
        ck.friction("B", draw(positive), radius=draw(positive)),
        ck.friction("stroke", draw(positive), length=draw(st.none() | positive)),
    ]  # fmt: skip
    return ck.Mechanism("Loaded", *LINKS, *words, units={"length": "mm", "mass": "kg", "force": "N"})


@settings(max_examples=examples(25), deadline=None)
@given(loaded())
def test_what_is_written_reads_back(mechanism: ck.Mechanism) -> None:
    toml, text = dumps(mechanism), dumps(mechanism, "json")
    assert loads(toml) == mechanism
    assert loads(text, "json") == mechanism
    assert tomllib.loads(toml) == json.loads(text)
    VALIDATOR.validate(json.loads(text))


HEAD = """
format = 1
title = "Crank"
units = { length = "mm", mass = "kg", force = "N" }
gravity = [0, -9.81]
[links]
frame = { points = { A = [0, 0], S = [0, 9] } }
crank = { points = { A = [0, 0], B = [2, 0] } }
[[drives]]
link = "crank"
"""


def test_angles_are_in_degrees_where_the_coordinate_is_an_angle() -> None:
    found = loads(
        HEAD
        + """
[[torques]]
link = "crank"
torque = { over = "crank", at = [0, 90, 180], values = [0, 1, 0], period = 360 }
[[forces]]
link = "B"
force = { at = [0, 1], values = [[1, 2], [3, 4]] }
[[springs]]
pair = "A"
stiffness = { at = [0, 45], values = [0, 10] }
free = 30
[[springs]]
link = "crank"
point = "B"
at = "S"
stiffness = 2
"""
    )
    torque = found.loads["torque on crank"].torque
    assert np.allclose(torque.at, [0, np.pi / 2, np.pi])
    assert torque.period == pytest.approx(2 * np.pi)
    assert found.loads["spring along A"].free == pytest.approx(np.pi / 6)
    assert np.allclose(found.loads["spring along A"].stiffness.at, [0, np.pi / 4])
    x, y = found.loads["force on B"].force
    assert (x.over, x.values.tolist(), y.values.tolist()) == ("time", [1, 3], [2, 4])
    assert found.gravity == -9.81j
    assert (found.unit, found.units.force) == ("mm", "N")


def test_all_problems_are_found_in_one_reading() -> None:
    with pytest.raises(InvalidMechanism) as raised:
        loads(
            HEAD.replace('"kg"', '"kgs"')
            + """
[[masses]]
link = "crnk"
mass = 2
[[masses]]
link = "crank"
mass = "heavy"
[[forces]]
link = "crank"
force = [1, "x"]
at = "B"
[[torques]]
link = "crank"
torque = { over = "crunk", at = [0, 1], values = [1, 2] }
[[efforts]]
pair = "A"
amount = { at = [1, 0], values = [1, 2] }
[[springs]]
pair = "Q"
stiffness = 3
[[springs]]
link = "crank"
point = "B"
at = "S"
[[frictions]]
pair = "A"
coefficient = 0.1
[[dampers]]
link = "crank"
pont = "B"
at = "S"
rate = 1
"""
        )
    places = {problem.where for problem in raised.value.problems}
    assert places == {
        "units.mass", "masses[0].link", "masses[1].mass", "forces[0].force", "torques[0].torque.over",
        "efforts[0].amount.at", "springs[0].pair", "springs[1].stiffness", "frictions[0].radius", "dampers[0].pont",
    }  # fmt: skip


def test_functions_are_not_written() -> None:
    crank = loads(HEAD).replace(ck.torque("crank", np.sin, name="motor"))
    with pytest.raises(InvalidInput, match=r"torques\.motor\.torque: a Python function cannot be written to a file"):
        dumps(crank)


def test_the_unit_of_length_is_said_once() -> None:
    with pytest.raises(InvalidMechanism, match="unit: units name the unit of length already; leave unit out"):
        loads(HEAD.replace("gravity", 'unit = "mm"\ngravity'))
