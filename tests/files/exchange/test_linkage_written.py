"""Files written for the Linkage program: they come back as the same motion, and say what they cannot say."""

from __future__ import annotations

import re
import warnings
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Exported
from compoundkin.files.exchange.linkage.linkage_format import FORMAT
from compoundkin.files.exchange.linkage.linkage_records import place, plain
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from compoundkin.model.units import LENGTHS
from tests.files.exchange.pages import prints_what_it_shows
from tests.files.exchange.references import entries
from tests.support import KINDS_OF_DYAD, random_sketch

# Of the catalog one for each thing that a file of Linkage says in its own way; all others were tried by hand.
SHOWN = (
    "scotch-yoke",  # blocks that are pins, slides that are two sliders
    "oldham-coupling",  # a pin of the frame in a slot of a link
    "elliptic-trammel",
    "oscillating-cylinder",
    "geneva-wheel",
    "peaucellier",  # a link beside the one that is driven at a pin
    "hydraulic-digger",  # actuators between pins
    "rapson-slide",
    "slider-crank-driven-by-piston",  # an actuator beside a slot
    "geared-five-bar",
    "windscreen-wiper",
)
# Nothing is lost but what coordinates of some hundred units have after their twelfth digit.
TOLERANCE = 1e-10


def written(mechanism: ck.Mechanism) -> tuple[PosedMechanism, Exported]:
    shown = posed_mechanism(mechanism)
    return shown, FORMAT.write(shown)


def back(exported: Exported) -> ck.Mechanism:
    return FORMAT.read(Content(exported.content)).mechanism


def turns(shown: PosedMechanism) -> list[bool]:
    return [shown.structure.driven_angles[name] for name in shown.values]


def same_motion(one: PosedMechanism, other: PosedMechanism, step: float) -> None:
    """Compare the points of both by their names, as drawn and a step of all drivers from there."""
    scale = LENGTHS.get(one.mechanism.unit, LENGTHS["mm"]) / LENGTHS[other.mechanism.unit]
    size = one.mechanism.geometry.size
    assert turns(one) == turns(other)
    found = []
    for shown, unit in ((one, 1.0), (other, scale)):
        places = {k: shown.place(links[0], k) for k, links in shown.mechanism.carriers.items()}
        steps = [step if angle else 0.1 * step * size * unit for angle in turns(shown)]
        values = {name: value + by for (name, value), by in zip(shown.values.items(), steps, strict=True)}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            moved = ck.solve(shown.mechanism, values, hint=places, order=0)
        found.append((places, {k: complex(np.ravel(p.position)[0]) for k, p in moved.points.items()}))
    for before, after in zip(*found, strict=True):
        assert set(before) <= set(after)
        for letter, at in before.items():
            assert abs(after[letter] - at * scale) <= TOLERANCE * size * scale, letter


@pytest.mark.parametrize("name", SHOWN)
def test_mechanisms_of_the_catalog_come_back(name: str) -> None:
    mechanism = ck.load(name)
    shown, exported = written(mechanism)
    found = posed_mechanism(back(exported))
    same_motion(shown, found, 0.02)
    kept = [link for link in mechanism.links if link in found.mechanism.links]
    assert len(kept) >= len(mechanism.links) - 4
    for (one, rate), angle in zip(shown.rates.items(), turns(shown), strict=True):
        if angle:
            assert found.rates[one] == pytest.approx(rate)


@pytest.mark.parametrize("name", ["scotch-yoke", "elliptic-trammel", "oscillating-cylinder"])
def test_sliders_stay_between_their_limits(name: str) -> None:
    exported = written(ck.load(name))[1]
    root = ElementTree.fromstring(exported.text)
    letters = {one.attrib["id"]: one.attrib.get("name", one.attrib["id"]) for one in root.findall("connector")}
    motion = ck.solve(back(exported), order=0)
    sliders = [one for one in root.findall("connector") if one.attrib.get("slider")]
    assert sliders
    for slider in sliders:
        ends = [one.attrib["id"] for one in slider.findall("slidelimit")]
        pin, low, high = (motion.points[letters[id_]].position for id_ in (slider.attrib["id"], *ends))
        along = (pin - low) / (high - low)
        assert np.all((along.real > 0) & (along.real < 1))
        assert np.max(np.abs(along.imag)) < 1e-9


@pytest.mark.parametrize("seed", range(6))
def test_random_mechanisms_come_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mechanism = random_sketch(rng, rng.choice(KINDS_OF_DYAD, 3)).mechanism()
    shown, exported = written(mechanism)
    same_motion(shown, posed_mechanism(back(exported)), 1e-3)


@pytest.mark.parametrize("kept", entries("linkage2"), ids=lambda kept: str(kept["id"]))
def test_what_is_read_is_written_as_it_was(kept: dict[str, str]) -> None:
    first = FORMAT.read(Content(kept["text"].encode())).mechanism
    shown, exported = written(first)
    second = back(exported)
    same_motion(shown, posed_mechanism(second), 0.01)
    assert second.outputs == first.outputs
    assert [np.ptp(np.asarray(one.values)) for one in second.drives if one.values is not None] == pytest.approx(
        [np.ptp(np.asarray(one.values)) for one in first.drives if one.values is not None], abs=1e-9
    )
    tags = ("gear=", "actuator=") if "arc" in kept["id"] else ("slider=", "gear=", "actuator=")
    count = {tag: kept["text"].count(tag) for tag in tags}
    assert {tag: exported.text.count(tag) for tag in count} == count


def test_wheels_belts_and_arcs_come_back() -> None:
    train = ck.Mechanism(
        "train",
        ck.link("frame", A=(0, 0), B=(60, 0), C=(90, 0), S=(0, 40)),
        ck.link("one", A=(0, 0), D=(12, 5)),
        ck.link("two", B=(0, 0), E=(5, 12)),
        ck.link("three", C=(0, 0)),
        ck.link("rod", E=(0, 0), F=(40, 0)),
        ck.gear("one", "two", radii=(25.5, 34.5)),
        ck.belt("two", "three", teeth=(20, 30)),
        ck.arc("rod", on="frame", at="F", centre_at="S", radius=50),
        ck.drive("one", speed=-2.5),
        ck.drawn(F=(35, 70)),
    )
    shown, exported = written(train)
    same_motion(shown, posed_mechanism(back(exported)), 0.3)
    assert exported.text.count('gear="true"') == 3
    assert exported.text.count('type="chain"') == 1
    assert 'slideradius="' in exported.text


def test_a_driver_between_moving_links_comes_back() -> None:
    five_bar = ck.Mechanism(
        "five-bar",
        ck.link("frame", A=(0, 0), D=(80, 0)),
        ck.link("arm", C=(0, 0), B=(50, 10)),
        ck.link("crank", A=(0, 0), B=(30, 0)),
        ck.link("rod", B=(0, 0), E=(15, 0)),
        ck.link("rocker", C=(0, 0), D=(70, 0)),
        ck.drive("rod", on="crank", speed=3),
        ck.drive("crank", values=np.radians(np.linspace(60, 30, 73)), speed=-1),
        ck.drawn(B=tuple(30 * np.array([0.5, 0.75**0.5]))),
    )
    shown, exported = written(five_bar)
    found = posed_mechanism(back(exported))
    same_motion(shown, found, 0.1)
    assert [(one.link, one.on) for one in found.mechanism.drives] == [("crank", "frame"), ("rod", "crank")]
    assert found.rates == pytest.approx({"rod": 3, "crank": -1})
    assert np.ptp(np.asarray(found.mechanism.drives[0].values)) == pytest.approx(np.pi / 6)


def test_what_cannot_be_said_is_listed_at_once() -> None:
    with pytest.raises(InvalidInput) as error:
        written(
            ck.Mechanism(
                "wheels",
                ck.link("frame", A=(0, 0), B=(60, 0)),
                ck.link("one", A=(0, 0), D=(12, 5)),
                ck.link("two", B=(0, 0), E=(5, 12)),
                ck.link("bar", P=(0, 0), Q=(9, 0)),
                ck.belt("one", "two", radii=(9, 8), crossed=True, name="eight"),
                ck.roll("bar", on="frame", at="P", through="A", toward="B", radius=5, name="roller"),
                ck.drive("one"),
                ck.drive("bar", values=[1.0]),
            )
        )
    assert [problem.where for problem in error.value.problems] == ["belts[0]", "rollings[0]"]
    for name, said in (
        ("planetary-train", "gears[0]: 'planet in annulus' is a ring, which Linkage does not have"),
        ("belt-coupled-cranks", "is a crossed belt, which Linkage does not have"),
        ("rolling-wheel", "is a rolling pair, which has no place in a drawing of joints"),
        ("sun-and-planet", "Linkage turns all links at an input together"),
    ):
        with pytest.raises(InvalidInput, match=re.escape(said)):
            written(ck.load(name))


def test_class_three_and_units_are_told() -> None:
    notes = written(ck.load("class-iii-six-bar"))[1].notes
    assert notes[0] == "lengths have no unit: 1 is 1 mm there"
    assert "class III" in notes[-1]
    crane = ck.load("hydraulic-crane")
    _, exported = written(crane)
    assert exported.notes[0] == "1 m is 1000 mm there"
    assert 'units="Millimeters"' in exported.text
    assert back(exported).geometry.size == pytest.approx(1000 * crane.geometry.size, rel=0.3)


def test_the_text_is_plain_xml_in_the_order_of_the_program() -> None:
    name = "a<b>&\"c'"
    crank = ck.Mechanism(
        "names", ck.link("frame", A=(0, 0)), ck.link(name, A=(0, 0), B=(3, 4)), ck.drive(name, speed=1)
    )
    root = ElementTree.fromstring(written(crank)[1].text)
    assert [child.tag for child in root][:2] == ["program", "connector"]
    assert root.find("Link").attrib["name"] == name  # type: ignore[union-attr]
    assert list(back(written(crank)[1]).links) == ["frame", name]


def test_numbers_are_written_without_exponents() -> None:
    rng = np.random.default_rng(0)
    for value in [0.0, -0.0, 1e-300, *(rng.choice([-1, 1], 300) * 10.0 ** rng.uniform(-12, 9, 300))]:
        assert float(plain(value)) == value
        assert re.fullmatch(r"-?\d+(\.\d+)?", plain(value))
        assert abs(float(place(value)) - value) <= 1e-12 + 1e-15 * abs(value)


def test_the_page_prints_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    prints_what_it_shows("linkage.md", capsys)
