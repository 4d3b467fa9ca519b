"""Points that are led and links that are turned: as files say them, and what is wrong with them."""

from __future__ import annotations

import pickle
import tomllib
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.json_schema import schema
from compoundkin.files.mechanism_files import dumps, loads
from tests.kinematics.test_led_motions import four_bar, redriven

LAW = ck.laws.constant_speed(2.0)
ROUND = 3 * np.exp(2j * np.pi * np.arange(9) / 8)
DRIVES = {
    "curve": ck.drive("G", along=ck.profiles.disc(2, (1, 1)), law=LAW),
    "closed": ck.drive("G", along=ROUND, law=LAW),
    "line": ck.drive("G", along=[(0, 1), (2, 3)], law=ck.laws.program(ck.laws.rise(2.0, over=1.0)), name="tip"),
    "places": ck.drive("G", along=[0, 1, 2 + 1j], time=[0, 0.5, 1], on="crank"),
    "again": ck.drive("G", along=ck.laws.place_table(np.arange(9.0), ROUND, repeat=True)),
    "one": ck.drive("G", x=LAW),
    "both": ck.drive("G", x=LAW, y=ck.laws.time_table([0, 1], [2, 3])),
    "angle": ck.drive("coupler", angle=ck.laws.motion_table([0, 1], [0, 1], [0, 0], [0, 0]), on="crank"),
}


@pytest.mark.parametrize("name", DRIVES)
def test_what_is_written_is_read_back(name: str) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    mechanism = four_bar(DRIVES[name])
    for form in ("toml", "json"):
        assert loads(dumps(mechanism, form), form) == mechanism
    document = tomllib.loads(dumps(mechanism))
    jsonschema.validate(document, schema())
    assert not {"carriage", "holder", "turntable"} & set(document["links"])
    assert pickle.loads(pickle.dumps(mechanism)) == mechanism
    assert mechanism != four_bar()
    assert repr(mechanism).startswith("Mechanism('Four-bar': 4 links, ")


def test_published_numbers_name_the_drivers_of_points() -> None:
    at = {"G.x": 1.0, "G.y": 2.0, "G.y.speed": 3.0}
    mechanism = redriven("five-bar", ck.drive("P", x=LAW, y=LAW), ck.expect("P.x", 80, 1e-9, **{"P.x": 80.0}))
    assert loads(dumps(mechanism)) == mechanism
    with pytest.raises(ck.errors.InvalidMechanism, match=r"there is no driver 'G.x'; did you mean 'P.x'"):
        redriven("five-bar", ck.drive("P", x=LAW, y=LAW), ck.expect("P.x", 80, 1e-9, **at))


def test_a_python_function_is_not_written() -> None:
    for drive in (
        ck.drive("G", along=lambda t: 1j * t),
        ck.drive("G", x=np.sin),
        ck.drive("G", along=ck.profiles.disc(1), law=np.sin),
        ck.drive("G", along=ck.profiles.formula(np.exp, 0, 1, closed=False), law=LAW),
    ):
        with pytest.raises(ck.errors.InvalidInput, match="a Python function cannot be written"):
            dumps(four_bar(drive))


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ('point = "Q"\nx = { kind = "constant-speed", speed = 1 }', ["drives[0].point: there is no point 'Q'"]),
        ('point = "G"\nx = { kind = "lin" }', ["drives[0].x.kind: there is no law the text 'lin'"]),
        ('point = "G"\nalng = 3', ["drives[0].alng: there is no such key here; did you mean 'along'?"]),
        ('point = "G"\nalong = { kind = "line", places = [[0, 0]] }', ["law: it is missing"]),
        (
            'point = "G"\nalong = { kind = "time-table", times = [0, 1], places = [[0, 0], [1, 1], [2, 2]] }',
            ["drives[0].along: its times and places have shapes (2,) and (3,); give two lists of one length"],
        ),
        ('link = "coupler"\nangle = 3', ["drives[0].angle: 3 is not a law"]),
        ('point = "A"\nx = { kind = "constant-speed", speed = 1 }', ["drives[0].point: A is a point of 'frame'"]),
    ],
)
def test_mistakes_in_files_are_said_once_with_their_place(table: str, said: list[str]) -> None:
    text = dumps(four_bar()) + f"\n[[drives]]\n{table}\n"
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        loads(text)
    problems = [str(problem) for problem in caught.value.problems]
    for one in said:
        assert any(one in problem for problem in problems), problems
    assert not any("the motion of" in problem for problem in problems)


LINE: dict[str, Any] = {"along": [1, 2, 3], "time": [0, 1, 2]}


@pytest.mark.parametrize(
    ("what", "words", "said"),
    [
        ("Q", {"x": LAW}, "there is no point 'Q'; known: A, D, B, C, G"),
        ("coupler", {"x": LAW}, "'coupler' is a link; name one of its points: B, C, G"),
        ("G", {"angle": LAW}, "G is a point, which has no angle"),
        ("coupler", {"angle": LAW, "on": "coupler"}, "cannot turn on itself"),
        ("G", {"x": LAW, "on": "nobody"}, "there is no link 'nobody'"),
        ("G", {"along": [1, 2, 3], "law": LAW}, "drives.G.along.places: a line goes from one place to another"),
        ("G", {"along": [1, 2, 3]}, "places are not a motion; give its times"),
        ("G", {"along": np.zeros((3, 3)), "time": [0, 1, 2]}, "are not two places or more"),
        ("G", {"along": [1, 2, np.nan], "time": [0, 1, 2]}, "are not two places or more"),
        ("G", {"along": [1, 2, 3], "time": [0, 1, 1]}, "drives.G.along.times: they do not increase"),
        ("G", {"along": ck.profiles.disc(1)}, "a curve is not a motion; give law="),
        ("G", {**LINE, "law": LAW}, "times and a law both prescribe the motion along it"),
        ("G", {**LINE, "speed": 3}, "drives.G.speed: its motion is prescribed already; leave speed out"),
        ("G", {**LINE, "x": LAW}, "a path prescribes both coordinates"),
        ("G", {"x": [1, 2]}, "several values are not a motion without times"),
        ("G", {"x": "one"}, "a text is no number"),
        ("G", {"time": [0, 1]}, "times and a law of the length of arc are those of a path"),
    ],
)
def test_mistakes_in_words_are_said(what: str, words: dict[str, Any], said: str) -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        four_bar(ck.drive(what, **words))
    assert said in str(caught.value)


def test_a_law_beyond_its_path_says_where() -> None:
    led = redriven("five-bar", ck.drive("P", along=[60 + 120j, 60 + 140j], law=ck.laws.constant_speed(10.0)))
    with pytest.raises(ck.errors.InvalidInput, match=r"at 3 s the law is at the length 30 of a path that is 20 long"):
        ck.solve(led, time=[0.0, 1.0, 3.0])


def test_names_of_what_is_only_thought_are_refused_and_not_shown() -> None:
    led = redriven("five-bar", ck.drive("P", x=60.0, y=LAW))
    taken = [*led.items, ck.link("P carriage", P=0)]
    with pytest.raises(ck.errors.InvalidMechanism, match="a link is called 'P carriage', as an auxiliary link of 'P'"):
        ck.Mechanism("m", *taken)
    motion = ck.solve(led, time=np.linspace(130.0 / 2, 140.0 / 2, 5))
    picture = ck.draw(motion).svg
    text = ck.report(motion).text()
    assert "carriage" not in picture
    assert "5 links, the frame among them: 5 binary." in text
    assert "P     R, revolute  outer-left - outer-right  P" in text
    assert "five-bar\n" in text
    assert {link.name for link in led.rigid_links.values()} == {*led.links} - led.auxiliary_links
    assert next(str(one.drivers[0]) for one in ck.alternatives(led, frames=["frame"])) == "left on frame (A)"
    inverted = ck.with_frame(led, "left")
    back = ck.solve(inverted, time=motion.time)
    gap = motion.points["P"].position - motion.points["B"].position
    np.testing.assert_allclose(np.abs(back.points["P"].position - back.points["B"].position), np.abs(gap), atol=1e-9)
    assert back.drives.keys() == {"P.x", "P.y"}
