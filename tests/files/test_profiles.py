"""Cams in files: every profile is read as it was written, and mistakes in one have their places."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from compoundkin.base.errors import InvalidInput, InvalidMechanism
from compoundkin.files import dumps, loads
from compoundkin.files.json_schema import schema
from compoundkin.files.writer import document
from compoundkin.kinematics import solve
from compoundkin.model.elements import drive, link, mode
from compoundkin.model.geometry import deg
from compoundkin.model.laws.cam_laws import LAWS
from compoundkin.model.laws.motion_programs import Program, ProgramSegment, dwell, fall, program, rise
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.arc import arc
from compoundkin.model.pairs.cam import cam
from compoundkin.model.pairs.face import face
from compoundkin.model.pairs.prismatic import slide
from compoundkin.model.pairs.slot import slot
from compoundkin.model.profiles import Profile
from compoundkin.model.profiles.profile import disc, formula, profile
from compoundkin.model.profiles.synthesised import Synthesised
from tests.support import examples

lengths = st.floats(0.001, 1e6)
real = st.floats(-1e6, 1e6)
angles = st.one_of(st.integers(-360, 360).map(deg), st.floats(-7.0, 7.0))
places = st.builds(complex, real, real)


@st.composite
def programs(draw: st.DrawFn) -> Program:
    """Segments of any spans; whether a cam can have them is told elsewhere."""
    spans = draw(st.lists(st.one_of(st.integers(1, 180).map(deg), st.floats(0.01, 3.0)), min_size=1, max_size=4))
    laws = st.sampled_from([law for law in LAWS if law != "dwell"])
    segments = [draw(st.one_of(st.builds(ProgramSegment, laws, st.just(s), real), st.just(dwell(s)))) for s in spans]
    return Program(tuple(segments), draw(st.one_of(st.just(0.0), real)))


made = st.builds(
    Synthesised,
    programs(),
    lengths,
    st.sampled_from(["knife", "roller", "flat"]),
    lengths,
    real,
    angles,
    st.none() | places,
    lengths,
    real,
    st.sampled_from([1, -1]),
    st.booleans(),
    angles,
)


class Unchecked(Mechanism):
    """Its profiles need not be possible: only their writing and reading is asked for."""

    def __init__(self, *items: Any) -> None:
        self.title, self.items = "m", items
        self.unit = self.source = self.description = ""
        self.outputs, self.time, self.units = (), None, None


@settings(max_examples=examples(200), deadline=None)
@given(made)
def test_a_made_profile_is_read_as_it_was_written(item: Synthesised) -> None:
    from compoundkin.files.law_tables import profile as read_profile
    from compoundkin.files.reader import TAGGED
    from compoundkin.files.recovery import Recovery

    whole = document(Unchecked(link("frame", A=0), cam("follower", on="cam", at="P", profile=item)))
    log = Recovery(TAGGED)
    assert read_profile(log, whole["cams"][0]["profile"], "cams[0].profile", None) == item
    assert log.problems == []


ring = st.lists(st.integers(5, 40), min_size=4, max_size=12).map(
    lambda radii: profile(np.array(radii) * np.exp(2j * np.pi * np.arange(len(radii)) / len(radii)))
)
open_ = st.lists(st.floats(-5, 5), min_size=4, max_size=9).map(
    lambda ys: profile(10.0 * np.arange(len(ys)) + 1j * np.array(ys), closed=False)
)
shapes = st.one_of(st.builds(disc, st.floats(1, 40), st.tuples(st.floats(-9, 9), st.floats(-9, 9))), ring, open_)


@st.composite
def mechanisms(draw: st.DrawFn) -> Mechanism:
    """One follower on a cam, one flat, a pin in a straight and one in a round slot."""
    radius = draw(st.one_of(st.floats(0, 9), st.lists(st.floats(0, 9), min_size=3, max_size=3).map(np.array)))
    items = [
        link("frame", A=0, B=(300, 0), C=(600, 0), D=(900, 0)),
        link("cam", A=0),
        link("roller", P=0),
        slide("roller", on="frame", through="A", angle=draw(angles)),
        cam("roller", on="cam", profile=draw(shapes), radius=radius, inside=draw(st.booleans())),
        link("flat", B=0, E=(9, 1)),
        face("flat", on="cam", at="E", profile=draw(shapes), angle=draw(angles), side=draw(st.sampled_from([1, -1]))),
        link("arm", C=0, F=(80, 0)),
        slot("cam", on="arm", at="A", through="C", angle=draw(angles), offset=draw(real)),
        link("lever", D=0, G=(80, 0)),
        arc("cam", on="lever", at="A", centre_at="G", radius=draw(lengths)),
        drive("cam"),
        mode(draw(st.sampled_from([1, -1])), "flat"),
    ]
    try:
        return Mechanism("m", *items)
    except InvalidMechanism:
        assume(False)
        raise


@settings(max_examples=examples(60), deadline=None)
@given(mechanisms(), st.sampled_from(["toml", "json"]))
def test_mechanisms_with_contacts_are_read_as_they_were_written(mechanism: Mechanism, syntax: Any) -> None:
    assert loads(dumps(mechanism, syntax), syntax) == mechanism
    Draft202012Validator(schema()).validate(document(mechanism))


def cam_file(text: str) -> str:
    return f"""
format = 1
title = "Cam"
links.frame.points = {{ A = [0, 0] }}
links.cam.points = {{ A = [0, 0] }}
links.follower.points = {{ P = [0, 0] }}
[[slides]]
link = "follower"
on = "frame"
through = "A"
angle = 90
[[cams]]
link = "follower"
on = "cam"
profile = {text}
[[drives]]
link = "cam"
"""


GOOD = '[{ law = "cycloidal", over = 180, rise = 10 }, { law = "3-4-5", over = 180, rise = -10 }]'


def test_degrees_in_the_file_are_radians_in_python() -> None:
    item = loads(cam_file(f'{{ kind = "made", program = {GOOD}, base = 30, start = 90 }}')).written_pairs[-1]
    assert item.profile == Synthesised(  # type: ignore[attr-defined]
        program(rise(10, np.pi), fall(10, np.pi, "3-4-5")), 30.0, start=np.pi / 2
    )
    turning = '[{ law = "cycloidal", over = 180, rise = 10 }, { law = "cycloidal", over = 180, rise = -10 }]'
    text = cam_file(f'{{ kind = "made", program = {turning}, base = 30, pivot = [80, 0], arm = 70 }}')
    frame, rest = text.split("links.cam")
    frame = frame.replace("A = [0, 0]", "A = [0, 0], H = [80, 0]")
    rest = rest.replace("P = [0, 0]", "H = [0, 0], P = [70, 0]")
    slides, cams = rest.index("[[slides]]"), rest.index("[[cams]]")
    rest = rest[:slides] + rest[cams:].replace('"cam"', '"cam"\nat = "P"', 1)
    text = f"{frame}links.cam{rest}"
    swung = loads(text).written_pairs[-1].profile  # type: ignore[attr-defined]
    assert swung.program.lift == pytest.approx(np.deg2rad(10), abs=1e-15)
    assert solve(loads(text)).assembled.all()


@pytest.mark.parametrize(
    ("text", "place", "what"),
    [
        ("3", "cams[0].profile", "3 is not a profile"),
        ("{ radius = 3 }", "cams[0].profile.kind", "it is missing"),
        ('{ kind = "disk", radius = 3 }', "cams[0].profile.kind", "no profile the text 'disk'"),
        ('{ kind = "disc" }', "cams[0].profile.radius", "it is missing"),
        ('{ kind = "disc", radius = [3, 4] }', "cams[0].profile.radius", "not a single number"),
        ('{ kind = "disc", radius = -3 }', "cams[0].profile.radius", "not a positive length"),
        ('{ kind = "disc", radius = 3, midle = [0, 0] }', "cams[0].profile.midle", "no such key"),
        ('{ kind = "disc", radius = 3, middle = [[1, 2], 0] }', "cams[0].profile.middle", "not a single number"),
        ('{ kind = "points", points = [[1, 0], [0, 1], [1]] }', "cams[0].profile.points[2]", "not a point"),
        ('{ kind = "points", points = [[1, 0], [0, 1], [1, 1]] }', "cams[0].profile.points", "too few"),
        ('{ kind = "points", points = 3 }', "cams[0].profile.points", "not a list of points"),
        ('{ kind = "made", base = 30 }', "cams[0].profile.program", "it is missing"),
        (f'{{ kind = "made", program = {GOOD}, base = 30, offset = 40 }}', "cams[0].profile.offset", "does not meet"),
        (f'{{ kind = "made", program = {GOOD}, base = 30, follower = "flt" }}', "cams[0].profile.follower", "'flt'"),
        (
            '{ kind = "made", base = 30, program = [{ law = "cycloidl", over = 360 }] }',
            "cams[0].profile.program.segments[0].law",
            "no law 'cycloidl'",
        ),
        (
            '{ kind = "made", base = 30, program = [{ law = "dwell", over = 300 }] }',
            "cams[0].profile.program",
            "add up to 300 degrees",
        ),
    ],
)
def test_mistakes_in_a_profile_have_their_places(text: str, place: str, what: str) -> None:
    with pytest.raises(InvalidMechanism) as caught:
        loads(cam_file(text))
    assert [(p.where, what in str(p)) for p in caught.value.problems] == [(place, True)], caught.value


def test_a_python_function_cannot_be_written() -> None:
    oval: Profile = formula(lambda s: 3 * np.cos(s) + 2j * np.sin(s), 0.0, 2 * np.pi)
    items = link("frame", A=0), link("cam", A=0), link("f", P=0), slide("f", on="frame", through="A"), drive("cam")
    with pytest.raises(InvalidInput, match="a Python function cannot be written to a file"):
        dumps(Mechanism("m", *items, cam("f", on="cam", profile=oval)))
