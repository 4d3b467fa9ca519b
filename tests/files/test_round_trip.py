"""What is saved is loaded as an equal mechanism: every float, every angle, every array."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from compoundkin.base.errors import InvalidInput, InvalidMechanism
from compoundkin.files import dumps, exact_numbers, load, loads
from compoundkin.model.elements import Expectation, Link, drawn, drive, expect, link, mode
from compoundkin.model.geometry import deg, polar
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from tests.catalog import FILES, each
from tests.support import examples

finite = st.floats(-1e6, 1e6)
radians = st.one_of(
    finite,
    st.floats(allow_nan=False, allow_infinity=False),
    st.integers(-720, 720).map(deg),
    st.decimals(-360, 360, places=3).map(deg),
)
# texts of which every character shows; others are refused
shown = st.text(st.characters(exclude_categories=("C", "Zl", "Zp")), max_size=12)
names = st.text(st.characters(exclude_categories=("C", "Z"), exclude_characters=".,"), min_size=1, max_size=8)
SHAPES = ((), (), (), (5,), (2, 1), (2, 5))


def values(of: st.SearchStrategy[float]) -> st.SearchStrategy[Any]:
    """A number or an array; all arrays broadcast together."""
    return st.sampled_from(SHAPES).flatmap(lambda shape: arrays(float, shape, elements=of) if shape else of)


points = st.tuples(values(finite), values(finite))


def dimensions(block: str) -> st.SearchStrategy[dict[str, Any]]:
    if not block:
        return st.just({})
    return st.fixed_dictionaries({}, optional={"offset": values(finite), "turn": values(radians)})


OUTPUTS = ("B.x", "B.velocity", "crank.angle", "crank", "B.y")


@st.composite
def mechanisms(draw: st.DrawFn) -> Mechanism:
    """A four-bar with a driven slide on its coupler, any of its parts as drawn."""
    letters = dict.fromkeys("ABCD")
    place = {letter: draw(points) for letter in letters}

    def bar(name: str, *own: str) -> Link:
        return link(name, *own) if draw(st.booleans()) else link(name, **{k: place[k] for k in own})

    guide = draw(st.sampled_from([{"toward": "C"}, {"angle": 0}, {"angle": draw(values(radians))}]))
    name = draw(names)
    items = [
        bar("frame", "A", "D"),
        bar("crank", "A", "B"),
        bar("coupler", "B", "C"),
        bar("rocker", "C", "D"),
        link("block", P=draw(points)),
        slide("block", on="coupler", through="B", **guide, **draw(dimensions("block"))),
        slide("block", on="frame", at="P", through="A", angle=draw(radians), name=name),
        drive("crank", values=draw(st.none() | values(radians)), speed=draw(values(radians))),
        drive("block", on="coupler", values=draw(values(finite)), acceleration=draw(values(finite)), name="ram"),
        drawn(**place),
        mode(draw(st.sampled_from([1, -1])), "coupler", "rocker"),
        expect("B.velocity", complex(draw(finite), draw(finite)), draw(st.floats(0, 1)), crank=draw(radians)),
        Expectation("coupler.angle", complex(draw(radians)), abs(draw(radians)), (("crank.speed", 1.5), ("ram", 2.0))),
    ]
    about = {key: draw(shown) for key in ("unit", "source", "description")}
    try:
        return Mechanism(draw(shown), *items, outputs=draw(st.lists(st.sampled_from(OUTPUTS), unique=True)), **about)
    except InvalidMechanism:
        assume(False)
        raise


@settings(max_examples=examples(60), deadline=None)
@given(mechanisms(), st.sampled_from(["toml", "json"]))
def test_every_mechanism_is_read_as_it_was_written(mechanism: Mechanism, syntax: Any) -> None:
    assert loads(dumps(mechanism, syntax), syntax) == mechanism


@each(FILES)
def test_files_are_read_as_written(sample: Path) -> None:
    mechanism = load(sample)
    assert loads(dumps(mechanism)) == mechanism
    assert loads(dumps(mechanism, "json"), "json") == mechanism
    assert dumps(loads(dumps(mechanism))) == dumps(mechanism)


def test_the_file_says_what_python_says(text: str) -> None:
    written = Mechanism(
        "Six-bar of Example 3-4",
        drive("crank", values=deg(range(0, 361, 5)), speed=700 * (math.pi / 30)),
        link("frame", E=(0, 0), B=(41, 0), F=(0, -34)),
        link("crank", E=(0, 0), D=(14, 0)),
        link("plate", D=(0, 0), A=(39, 0), C=polar(15, deg(35))),
        link("rocker", B=(0, 0), A=(28, 0)),
        link("bar", F=(0, 0), G=(55, 0)),
        link("block", C=(0, 0)),
        slide("block", on="bar", at="C", through="F", angle=0),
        drawn(A=(30, -26)),
        mode(1, "plate", "rocker"),
        expect("G.velocity", (1, 2), 5e-4, **{"crank": deg(35), "crank.speed": 10}),
        expect("bar.angle", deg(62.5), deg(0.01), crank=deg(35)),
        unit="mm",
        source="an exercise",
        description="The slide on the bar.",
        outputs=["G.position", "bar.angle"],
    )
    assert loads(text) == written


def test_written_text_is_the_text_a_user_would_write(text: str) -> None:
    blank = [line for line in text.replace("1.0, 2.0", "1, 2").replace("5e-4", "0.0005").splitlines() if line]
    again = [line for line in dumps(loads(text)).splitlines() if line]
    assert again == [line for line in blank if line != "angle = 0"]


@given(radians)
def test_degrees_are_exact_or_written_as_radians(angle: float) -> None:
    written = exact_numbers.degrees(angle)
    if isinstance(written, dict):
        assert written["rad"] == angle
    else:
        assert np.deg2rad(written) == angle


@given(st.decimals(-400, 400, places=4))
def test_degrees_of_few_digits_come_back_as_they_were(written: Any) -> None:
    assert exact_numbers.degrees(deg(float(written))) == float(written)


@given(st.integers(-90, 90), st.sampled_from([0.1, 0.25, 0.5, 1, 5, -2.5]), st.integers(4, 400))
def test_even_steps_are_written_as_steps(start: int, step: float, count: int) -> None:
    written = exact_numbers.values(deg(start + step * np.arange(count)), True)
    assert written.keys() == {"from", "to", "step"}
    assert written["step"] == step


def test_long_arrays_are_wrapped_and_exact() -> None:
    rng = np.random.default_rng(1)
    m = Mechanism(
        "m",
        link("frame", A=0),
        link("crank", A=0, B=(rng.normal(size=60), 0)),
        drive("crank", values=rng.normal(size=60)),
    )
    assert max(map(len, dumps(m).splitlines())) <= 100
    assert loads(dumps(m)) == m


@pytest.mark.full
def test_a_range_beyond_the_readers_limit_is_written_out() -> None:
    m = Mechanism("m", link("frame", A=0), link("c", A=0, B=1), drive("c", values=np.arange(1_000_001.0)))
    assert loads(dumps(m, "json"), "json") == m


def test_rates_are_written_in_the_shorter_unit() -> None:
    assert exact_numbers.rate(700 * (math.pi / 30), True) == {"rpm": 700}
    assert exact_numbers.rate(deg(61), True) == {"deg": 61}
    assert exact_numbers.rate(0.1234567891, True) == 0.1234567891


def test_partly_drawn_links_cannot_be_written() -> None:
    m = Mechanism("m", Link("frame", {"A": 0j, "B": None}), link("c", A=0), drawn(B=1))
    with pytest.raises(InvalidInput, match=r"links.frame: only some .* B has none"):
        dumps(m)


def test_texts_of_several_lines_stay_readable() -> None:
    m = Mechanism("m", link("frame", A=0), description='one\ntwo "quoted"\\')
    assert tomllib.loads(dumps(m))["description"] == m.description
    assert "\none\ntwo " in dumps(m)
