"""Outlines as they are written: shapes in the links' frames, problems, files, other mechanisms made of one."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files import dumps, loads
from compoundkin.model.outline_shapes import OutlineShape, outline_shapes

BAR = ck.Mechanism(
    "Crank-rocker",
    ck.link("frame", A=(0, 0), D=(60, 0)),
    ck.link("crank", A=(0, 0), B=(25, 0)),
    ck.link("coupler", B=(0, 0), C=(55, 0), E=(30, 22), F=(30, 2)),
    ck.link("rocker", D=(0, 0), C=(45, 0)),
    ck.drive("crank"),
)
FULL = BAR.replace(
    ck.outline("crank", 10, pin=5, layer=1),
    ck.outline("coupler", 9, layer=3),
    ck.outline("coupler", at="E", radius=8, layer=[3, 4]),
    ck.outline("rocker", 6, through=["D", (20, 9), "C"]),
    ck.outline("frame", polygon=["A", (70, -10), (70, -4)], name="bed"),
    ck.outline("rocker", at="C", pin=4, layer=0, name="bolt"),
)


def shapes(mechanism: ck.Mechanism) -> list[OutlineShape]:
    return [*outline_shapes(mechanism, mechanism.geometry.points)]


def test_shapes_are_in_the_links_frames() -> None:
    found = {(one.body, one.core): one for one in shapes(FULL)}
    assert found["crank", (0j, 25 + 0j)].radius == 5.0
    # the plate around the points; F is within it
    plate = next(one for one in found.values() if one.closed and one.body == "coupler")
    assert set(plate.core) == {0j, 55 + 0j, 30 + 22j}
    assert found["rocker", (0j, 20 + 9j, 45 + 0j)].closed is False
    assert found["frame", (0j, 70 - 10j, 70 - 4j)].closed
    assert found["coupler", (30 + 22j,)].layers == (3, 4)


def test_pins_pass_through_the_layers_between() -> None:
    pins = {one.body: one for one in shapes(FULL) if one.is_pin}
    # nothing lies on layer 2
    assert {name: one.layers for name, one in pins.items()} == {
        "pin A": (0, 1), "pin B": (1, 3, 4), "pin C": (0, 1, 3, 4)
    }  # fmt: skip
    assert pins["pin B"].links == ("crank", "coupler")


def test_files_keep_them() -> None:
    for form in ("toml", "json"):
        assert loads(dumps(FULL, form), form) == FULL
    assert loads(dumps(FULL)).outlines["bed"].polygon[0] == "A"
    assert FULL != BAR


def test_other_mechanisms_keep_them() -> None:
    inverted = ck.with_frame(FULL, "coupler")
    assert inverted.outlines["frame at E"].radius == 8.0
    assert inverted.outlines["bed"].link == "old frame"
    # relative places are kept: the middle of the eye from both ends of the rocker, at one pose of the inverted chain
    assert [one.core for one in shapes(inverted)] == [one.core for one in shapes(FULL)]
    assert [*ck.with_driver(FULL, "rocker").outlines] == [*FULL.outlines]
    wider = FULL.replace(ck.outline("crank", 12, layer=1))
    assert wider.outlines["crank"].width == 12.0
    assert len(wider.outlines) == len(FULL.outlines)


def test_designs_have_outlines_of_their_own() -> None:
    both = BAR.replace(ck.outline("crank", [[8.0], [12.0]]), ck.outline("frame", at=([[9.0], [11.0]], 30), radius=2))
    motion = ck.solve(both)
    assert motion.shape == (2, 73)
    found = [outline_shapes(both, both.geometry.points, motion.shape, k) for k in range(2)]
    assert [one[0].radius for one in found] == [4.0, 6.0]
    assert [one[1].core for one in found] == [(9 + 30j,), (11 + 30j,)]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ({"link": "cranq", "width": 1}, "outlines[0].link: there is no link 'cranq'; did you mean 'crank'?"),
        ({"link": "crank"}, "outlines[0]: it says no shape"),
        ({"link": "crank", "width": -1}, "outlines[0].width: a width is above zero, not -1"),
        ({"link": "crank", "width": np.nan}, "outlines[0].width: the value is empty or not finite"),
        ({"link": "crank", "width": [8, 9]}, "outlines[0].width: it holds 2 numbers along the motion"),
        ({"link": "crank", "radius": 1}, "outlines[0].at: a disc needs its middle; name a point: A, B"),
        ({"link": "crank", "width": 1, "at": "A"}, "outlines[0].at: it is the middle of no disc and of no pin"),
        ({"link": "crank", "at": "Z", "radius": 1}, "outlines[0].at: link 'crank' has no point 'Z'"),
        ({"link": "coupler", "at": "E", "pin": 1}, "outlines[0].pin: no pin joins 'coupler' to another link at E"),
        ({"link": "crank", "at": (0, 0), "pin": 1}, "outlines[0].at: a pin is at a point"),
        ({"link": "crank", "width": 1, "through": ["A", "Q"]}, "outlines[0].through[1]: link 'crank' has no point 'Q'"),
        ({"link": "crank", "through": ["A", "B"]}, "outlines[0].width: bars through points need a width"),
        ({"link": "crank", "polygon": ["A", "B"]}, "outlines[0].polygon: 2 places are too few; give 3 or more"),
        ({"link": "crank", "polygon": [(0, 0), (1, 1), (1, 0), (0, 1)]}, "outlines[0].polygon: its sides cross"),
        ({"link": "crank", "polygon": ["A", "B", (9, 0)]}, "outlines[0].polygon: its sides cross, touch"),
    ],
)
def test_what_is_wrong_is_told(words: dict[str, Any], told: str) -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        BAR.replace(ck.outline(**words))
    assert told in str(caught.value)


def test_one_name_twice_is_told() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="the name 'crank' is used twice"):
        ck.Mechanism("m", *BAR.items, ck.outline("crank", 8), ck.outline("crank", 9))


@pytest.mark.parametrize("layer", ["x", 1.5, True, []])
def test_layers_are_whole_numbers(layer: Any) -> None:
    with pytest.raises(ck.errors.CompoundkinError, match="layer"):
        ck.outline("crank", 8, layer=layer)


def test_files_tell_all_problems_at_once() -> None:
    text = dumps(FULL).replace("layer = 1\n", 'layer = "top"\n').replace('at = "E"', 'at = "Q"')
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        loads(text)
    assert "the text 'top' is not a whole number" in str(caught.value)
    assert "has no point 'Q'" in str(caught.value)
