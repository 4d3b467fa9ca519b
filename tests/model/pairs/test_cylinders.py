"""Cylinders: one element of barrel and rod, driven by its length, within its stroke."""

from __future__ import annotations

import math
import pickle
import tomllib
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.cli import cli
from compoundkin.files.json_schema import schema
from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.model.fields import Item
from compoundkin.view.sketch.shapes import Polygon, leaves

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")

FOUND = 1e-9
STROKE = (1.3, 2.3)
# the pivot of the barrel, and the place of the rod's pin on the jib
FOOT, EYE = 0.8 - 0.9j, 1.8 - 0.1j


def crane(*more: Item, stroke: Any = STROKE, **words: Any) -> ck.Mechanism:
    """A jib lifted by a cylinder: the dimensions of the catalog's hydraulic crane."""
    return ck.Mechanism(
        "Crane",
        ck.link("frame", O=(0, 0), D=(0.8, -0.9)),
        ck.link("jib", O=(0, 0), E=(1.8, -0.1), T=(5, 0)),
        ck.cylinder("jib", "E", to="frame", at="D", stroke=stroke, **words),
        *more,
        unit="m",
    )


def lifted(values: Any) -> ck.Mechanism:
    return crane(ck.drive("jib cylinder", values=values), ck.drawn(E=(1.7, 0.6), T=(4.6, 1.9)))


def length_at(jib: Any) -> Any:
    """The cylinder's length at an angle of the jib."""
    return np.abs(EYE * np.exp(1j * np.asarray(jib)) - FOOT)


# --- one element, driven by its length ---------------------------------------------------------------------


def test_a_cylinder_is_one_thing_that_is_written() -> None:
    mechanism = lifted(np.linspace(*STROKE, 41))
    assert repr(mechanism) == "Mechanism('Crane': 2 links and 1 cylinder, 1 driver)"
    assert list(mechanism.rigid_links) == ["frame", "jib"]
    assert list(mechanism.links) == ["frame", "jib", "jib cylinder barrel", "jib cylinder rod"]
    assert mechanism.cylinders["jib cylinder"].stroke == STROKE


def test_a_cylinder_moves_as_two_links_a_slide_and_a_driver_do() -> None:
    values = np.linspace(*STROKE, 41)
    motion = ck.solve(lifted(values), speed=0.05)
    by_hand = ck.solve(ck.load("hydraulic-crane"), {"rod": values})
    np.testing.assert_allclose(motion.points["T"].acceleration, by_hand.points["T"].acceleration, atol=1e-12)
    np.testing.assert_allclose(length_at(motion.links["jib"].angle), values, atol=1e-12)
    assert [group.name for group in motion.structure.groups] == ["RRR"]
    assert ck.verify(motion).passed


def test_a_cylinder_stops_at_its_stroke() -> None:
    values = np.linspace(1.2, 2.4, 13)
    motion = ck.solve(lifted(STROKE), {"jib cylinder": values})
    found = ck.gaps(motion)
    assert [gap.reason for gap in found] == [
        "jib cylinder is 1.2 long, less than its stroke allows, 1.3",
        "jib cylinder is 2.4 long, more than its stroke allows, 2.3",
    ]
    edges = [one for gap in found for one in (gap.begin["jib cylinder"], gap.end["jib cylinder"])]
    np.testing.assert_allclose(edges, [1.2, 1.3, 2.3, 2.4], atol=FOUND)
    assert ck.solve(lifted(STROKE), {"jib cylinder": STROKE}).assembled.all()


def test_a_passive_cylinder_follows_and_limits() -> None:
    motion = ck.solve(crane(ck.drive("jib")))
    free = ck.solve(crane(ck.drive("jib"), stroke=None))
    np.testing.assert_allclose(free.pairs["jib cylinder"].value, length_at(free.links["jib"].angle), atol=1e-12)
    assert free.assembled.all()
    length = length_at(free.links["jib"].angle)
    np.testing.assert_array_equal(motion.assembled, (length >= STROKE[0]) & (length <= STROKE[1]))
    for gap in ck.gaps(motion)[1:2]:
        np.testing.assert_allclose(length_at([gap.begin["jib"], gap.end["jib"]]), [2.3, 2.3], atol=1e-9)
    assert [group.name for group in motion.structure.groups] == ["RPR"]
    spans = [(branch.low, branch.high) for branch in ck.circuits(crane(ck.drive("jib"))).branches]
    np.testing.assert_allclose(np.sort(length_at(spans), axis=1), [STROKE] * 2, atol=1e-9)


def test_a_locked_cylinder_holds() -> None:
    angle = ck.solve(crane(ck.drive("jib cylinder", values=2.0))).links["jib"].angle
    assert abs(length_at(angle) - 2.0) < 1e-12


@pytest.mark.filterwarnings("ignore::compoundkin.errors.DrawnBeyondEnd")
def test_a_passive_cylinder_on_a_tracked_group_masks_it_only() -> None:
    """Beyond its stroke nothing is lost: the group without a closed form comes back on its branch."""
    whole = ck.load("class-iii-six-bar")
    free = ck.solve(whole)
    length = np.abs(free.points["B2"].position - free.points["A1"].position)
    stroke = (float(np.quantile(length, 0.3)), float(np.quantile(length, 0.7)))
    gas_spring = ck.cylinder("plate", "B2", to="frame", at="A1", stroke=stroke, name="spring")
    motion = ck.solve(ck.Mechanism("Sprung", *whole.items, gas_spring))
    inside = (length >= stroke[0] - FOUND) & (length <= stroke[1] + FOUND)
    np.testing.assert_array_equal(motion.assembled, inside & free.assembled)
    assert len(ck.gaps(motion)) > 1
    there = motion.points["B2"].position[motion.assembled]
    np.testing.assert_allclose(there, free.points["B2"].position[motion.assembled], atol=1e-9)


# --- the digger of the issue ---------------------------------------------------------------------------------


def test_the_digger_is_written_with_six_links_and_three_cylinders() -> None:
    digger = ck.load("hydraulic-digger")
    assert list(digger.rigid_links) == ["frame", "boom", "stick", "bucket", "rocker", "link"]
    assert list(digger.cylinders) == ["boom-cylinder", "stick-cylinder", "bucket-cylinder"]
    mobility = ck.decompose(digger).mobility
    # barrels and rods are counted, each with its pins and its slide: 3 (12 - 1) - 2 * 15
    assert (len(digger.links), mobility.freedoms) == (12, 3)
    assert mobility.freedoms == 3 * (6 - 1) - 2 * 6
    text = " ".join(ck.report(digger).text().split())
    assert "In short: 6 links and 3 cylinders, mobility 3, 4 groups, class II." in text
    assert "All 41 poses assembled" in text
    assert "7 of 7 published numbers reproduced" in text


def test_the_digger_ends_where_its_cylinders_do() -> None:
    digger = ck.load("hydraulic-digger")
    for name, item in digger.cylinders.items():
        values = {one: float(np.mean(other.stroke)) for one, other in digger.cylinders.items()}
        motion = ck.solve(
            digger, {**values, name: np.array([item.stroke[0] - 0.01, *item.stroke, item.stroke[1] + 0.01])}
        )
        assert motion.assembled.tolist() == [False, True, True, False]
        assert {gap.pair for gap in ck.gaps(motion)} == {name}


# --- files ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "mechanism",
    [
        lifted(np.linspace(*STROKE, 41)),
        crane(ck.drive("jib"), stroke=None, name="ram"),
        crane(ck.drive("ram", values=2.0, speed=0.1), stroke=(1.0, np.array([2.5, 3.0])), name="ram"),
    ],
    ids=["driven", "passive", "designs"],
)
def test_cylinders_are_written_and_read(mechanism: ck.Mechanism) -> None:
    jsonschema = pytest.importorskip("jsonschema")
    text = dumps(mechanism)
    assert "[[cylinders]]" in text
    assert "[[slides]]" not in text
    assert "barrel" not in text
    assert loads(text) == mechanism
    assert loads(dumps(mechanism, "json"), "json") == mechanism
    assert not list(jsonschema.Draft202012Validator(schema()).iter_errors(tomllib.loads(text)))
    assert pickle.loads(pickle.dumps(mechanism)) == mechanism


def test_a_default_name_is_not_written() -> None:
    assert "name" not in dumps(lifted(2.0))


def test_cylinders_stand_other_frames_and_drivers() -> None:
    mechanism = lifted(np.linspace(*STROKE, 5))
    turned = ck.with_frame(mechanism, "jib")
    np.testing.assert_allclose(ck.solve(turned).pairs["jib cylinder"].value, np.linspace(*STROKE, 5), atol=1e-12)
    assert list(turned.cylinders) == ["jib cylinder"]
    on_barrel = ck.with_frame(mechanism, "jib cylinder barrel")
    assert not on_barrel.cylinders
    assert loads(dumps(on_barrel)) == on_barrel
    assert ck.solve(on_barrel).assembled.all()
    driven = ck.with_driver(
        crane(ck.drive("jib", values=[0.3, 0.4]), ck.drawn(E=(1.7, 0.6), T=(4.6, 1.9))), "jib cylinder"
    )
    assert [one.name for one in driven.drives] == ["jib cylinder"]
    assert ck.solve(driven).assembled.all()


@pytest.mark.parametrize("verb", ["check", "structure", "solve", "report", "centres", "circuits"])
def test_every_verb_takes_cylinders(verb: str, tmp_path: Any) -> None:
    path = tmp_path / "crane.toml"
    path.write_text(dumps(lifted(np.linspace(*STROKE, 5))))
    found = CliRunner().invoke(cli, [verb, str(path)])
    assert found.exit_code == 0, found.output
    drawn = CliRunner().invoke(cli, ["draw", str(path), "-o", str(tmp_path / "crane.svg")])
    assert drawn.exit_code == 0, drawn.output


# --- wrong input ---------------------------------------------------------------------------------------------

WRONG: list[tuple[dict[str, Any], str]] = [
    ({"stroke": (2.3, 1.3)}, "stroke: a stroke from 2.3 to 1.3 is not possible"),
    ({"stroke": (0, 1.3)}, "stroke: a stroke from 0 to 1.3 is not possible"),
    ({"stroke": (-1, 1.3)}, "stroke: a stroke from -1 to 1.3 is not possible"),
    ({"stroke": (math.nan, 1.3)}, "stroke: (nan, 1.3) is empty or not finite"),
    ({"stroke": 1.3}, "stroke: 1.3 is not two lengths"),
    ({"stroke": "ab"}, "stroke: 'ab' is not two lengths"),
    ({"stroke": (1, 2, 3)}, "stroke: (1, 2, 3) is not two lengths"),
    ({"name": "jib"}, "name: a link is called 'jib' as well; give the cylinder another name, such as 'jib cylinder'"),
    ({"name": "a.b"}, "name: 'a.b' is not a name"),
]


@pytest.mark.parametrize(("words", "what"), WRONG)
def test_a_wrong_cylinder_is_named(words: dict[str, Any], what: str) -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as error:
        crane(**words)
    assert f"cylinders[0].{what}" in str(error.value)


@pytest.mark.parametrize(
    ("item", "problems"),
    [
        (
            ck.cylinder("gib", "E", to="frame", at="D"),
            ["cylinders[0].link: there is no link 'gib'; did you mean 'jib'?"],
        ),
        (
            ck.cylinder("jib", "X", to="frame", at="D"),
            ["cylinders[0].point: link 'jib' has no point 'X'; known: O, E, T"],
        ),
        (ck.cylinder("jib", "E", to="jib", at="T"), ["cylinders[0].to: 'jib' cannot push on itself; name two links"]),
        (ck.cylinder("jib", "O", to="frame", at="O"), ["cylinders[0].at: both ends are at 'O'"]),
    ],
)
def test_a_badly_joined_cylinder_has_one_problem(item: Any, problems: list[str]) -> None:
    """Its driver and its barrel and rod are not blamed."""
    frame, jib = ck.link("frame", O=(0, 0), D=(0.8, -0.9)), ck.link("jib", O=(0, 0), E=(1.8, -0.1), T=(5, 0))
    with pytest.raises(ck.errors.InvalidMechanism) as error:
        ck.Mechanism("Crane", frame, jib, item, ck.drive(item.name))
    assert [str(problem).startswith(told) for problem, told in zip(error.value.problems, problems, strict=True)] == [
        True
    ]


def test_two_cylinders_of_one_name_are_one_problem() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="'jib cylinder' is used twice") as error:
        crane(ck.cylinder("jib", "T", to="frame", at="D"))
    assert len(error.value.problems) == 1


def test_a_cylinder_is_driven_by_its_length_alone() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match=r"drives\[0\]\.on: the cylinder 'jib cylinder' is driven by"):
        crane(ck.drive("jib cylinder", on="jib"))
    with pytest.raises(ck.errors.InvalidMechanism, match="did you mean 'jib cylinder'"):
        crane(ck.drive("jib cylindr"))
    with pytest.raises(ck.errors.InvalidInput, match="it has no values"):
        ck.solve(crane(ck.drive("jib cylinder")))


@pytest.mark.parametrize("line", ["stroke = 1.3", "stroke = [1.3]", "stroke = [2.3, 1.3]", "storke = [1.3, 2.3]"])
def test_a_wrong_cylinder_in_a_file_is_named(line: str) -> None:
    text = dumps(lifted(2.0)).replace("stroke = [1.3, 2.3]", line)
    with pytest.raises(ck.errors.InvalidMechanism, match=r"cylinders\[0\]\.sto?r"):
        loads(text)


# --- pictures ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("mechanism", [lifted(np.linspace(*STROKE, 5)), crane(ck.drive("jib", values=[0.3, 0.5]))])
def test_a_cylinder_is_drawn_with_a_barrel_driven_or_not(mechanism: ck.Mechanism) -> None:
    """A barrel is a long box that no slide of the same links has."""
    boxes = [
        shape for shape in leaves(ck.draw(mechanism).shapes) if isinstance(shape, Polygon) and len(shape.points) == 4
    ]
    longest = max(abs(np.diff(shape.points)).max() / abs(np.diff(shape.points)).min() for shape in boxes)
    assert longest > 5
