"""Files of the Linkage program: samples with their numbers, what each element means, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Imported
from compoundkin.files.exchange.linkage.linkage_format import FORMAT
from tests.files.exchange.references import entries, entry, holds


def read(*elements: str, program: str = "", where: str = "") -> Imported:
    """Read a file of these elements."""
    text = f"<linkage2><program {program}/>\n" + "\n".join(elements) + "\n</linkage2>"
    assert FORMAT.recognises(Content(text.encode()))
    return FORMAT.read(Content(text.encode(), where))


def connector(number: int, x: float, y: float, more: str = "", inside: str = "") -> str:
    return f'<connector id="{number}" x="{x}" y="{y}" {more}>{inside}</connector>'


def link(number: int, *connectors: int, more: str = "") -> str:
    return f'<Link id="{number}" {more}>' + "".join(f'<connector id="{c}"/>' for c in connectors) + "</Link>"


def limits(one: int, two: int) -> str:
    return f'<slidelimit id="{one}"/><slidelimit id="{two}"/>'


ANCHOR, INPUT = 'anchor="true"', 'anchor="true" input="true" rpm="30"'
FOUR_BAR = (
    connector(0, 0, 0, INPUT),
    connector(1, 10, 30),
    connector(2, 70, 50),
    connector(3, 60, 0, ANCHOR),
    link(0, 0, 1),
    link(1, 1, 2),
    link(2, 2, 3),
)


@pytest.mark.parametrize("kept", entries("linkage2"), ids=lambda kept: str(kept["id"]))
def test_samples_have_their_numbers(kept: dict[str, object]) -> None:
    holds(FORMAT.read(Content(str(kept["text"]).encode())).mechanism, kept)


def test_samples_have_their_structure() -> None:
    found = {one["id"]: FORMAT.read(Content(one["text"].encode())).mechanism for one in entries("linkage2")}
    expected = {one["id"]: one["expected"] for one in entries("linkage2")}
    four_bar = found["linkage_four_bar"]
    (driver,) = four_bar.drives
    told = expected["linkage_four_bar"]
    assert (driver.link, four_bar.unit) == (told["driver"], told["unit"])
    assert driver.speed == pytest.approx(told["speed_rad_s"])
    assert four_bar.outputs == ("4.position",)
    assert found["linkage_slider_crank"].drives[0].speed == pytest.approx(
        expected["linkage_slider_crank"]["speed_rad_s"]
    )
    assert list(found["linkage_scotch_yoke"].links) == ["frame", "link 0", "link 1"]
    assert [pair.table for pair in found["linkage_scotch_yoke"].written_pairs] == ["slots", "slides"]
    (round_slot,) = found["linkage_arc_slot"].written_pairs
    told = expected["linkage_arc_slot"]["arc"]
    centre = complex(found["linkage_arc_slot"].sketch[round_slot.centre_at])  # type: ignore[attr-defined]
    assert centre == pytest.approx(complex(*told["centre"]), abs=1e-6)
    assert round_slot.radius == pytest.approx(told["radius"], abs=1e-6)  # type: ignore[attr-defined]
    assert ck.decompose(found["linkage_scotch_yoke"]).mobility.freedoms == expected["linkage_scotch_yoke"]["mobility"]
    assert list(found["linkage_gears"].links) == ["frame", "link 0+1", "link 2+3"]
    assert found["linkage_gears"].written_pairs[0].teeth == (20, 40)  # type: ignore[attr-defined]
    (ram,) = found["linkage_actuator"].drives
    assert ram.speed == pytest.approx(expected["linkage_actuator"]["speed"])
    assert np.ptp(np.asarray(ram.values)) == pytest.approx(expected["linkage_actuator"]["stroke"], abs=1e-6)


@pytest.mark.parametrize("case", entry("linkage_refused")["cases"], ids=lambda case: str(case["reason"]))
def test_what_is_refused_has_its_words(case: dict[str, str]) -> None:
    with pytest.raises(InvalidInput, match=case["reason"]):
        FORMAT.read(Content(case["text"].encode()))


def test_all_problems_are_told_at_once_with_their_lines() -> None:
    wrong = (
        connector(0, 0, 0, 'anchor="yes" slider="true"', limits(1, 9)),
        connector(1, 1, 0, 'rpm="nan" slideradius="1e99"'),
        connector(1, 1, 0),
        link(0, 0, 1, 7),
        link(1, 1, more='fastenlink="8"'),
        '<ratios><ratio type="gears"><link id="0" size="1"/><link id="5" size="-1"/></ratio></ratios>',
    )
    with pytest.raises(InvalidInput) as error:
        read(*wrong, program='units="Feet"', where="a.linkage2")
    said = str(error.value)
    for part in (
        "a.linkage2: 10 problems",
        "line 1, program: there is no unit 'Feet'",
        "line 2, connector 0: anchor 'yes' is neither true nor false",
        "line 3, connector 1: rpm 'nan' is not a number",
        "line 3, connector 1: slideradius '1e99' is beyond all drawings",
        "line 4, connector 1: there are two connectors 1, the first in line 3",
        "line 5, link 0: connector 7 is not there",
        "line 6, link 1: it is fastened to link 8, which is not there",
        "line 2, connector 0: slidelimit 9 is not there",
        "line 7, ratio: it is not of two links with positive sizes",
        "no connector is an anchor",
    ):
        assert part in said, said


@pytest.mark.parametrize(
    "text",
    [
        '<!DOCTYPE a [<!ENTITY b "c">]><linkage2>&b;</linkage2>',
        '<!DOCTYPE linkage2 SYSTEM "file:///etc/passwd"><linkage2/>',
        '<?xml version="1.0"?><!DOCTYPE a><linkage2/>',
    ],
)
def test_document_types_and_entities_are_refused(text: str) -> None:
    with pytest.raises(InvalidInput, match="it declares a document type or entities, which are not read"):
        FORMAT.read(Content(text.encode()))


def test_bounds_hold() -> None:
    for factor in ("1e-320", "-1", "1e12"):
        with pytest.raises(InvalidInput, match=r"line 1, program: scalefactor .* cannot be meant"):
            read(*FOUR_BAR, program=f'scalefactor="{factor}"')
    deep = "<linkage2>" + "<a>" * 100_000
    wide = "<linkage2>" + "<a/>" * 100_000 + "</linkage2>"
    for text, said in ((deep, "nested deeper"), (wide, "more than 20,000 elements"), ("<linkage2>&a;", "not XML")):
        with pytest.raises(InvalidInput, match=said):
            FORMAT.read(Content(text.encode()))


def test_lengths_are_in_the_units_that_are_shown() -> None:
    four_bar = (one.replace("x=", "name='p' x=") if 'id="2" x' in one else one for one in FOUR_BAR)
    found = read(*four_bar, program='units="Inches" scalefactor="2"').mechanism
    assert found.unit == "in"
    assert complex(found.sketch["p"]) == pytest.approx((70 + 50j) / 48)


def test_class_three_is_told() -> None:
    plate = (
        connector(0, 0, 0, INPUT),
        connector(1, 20, 10),
        connector(2, 100, 0, ANCHOR),
        connector(3, -30, 90, ANCHOR),
        connector(4, 30, 50),
        connector(5, 80, 50),
        connector(6, 55, 80),
        link(0, 0, 1),
        link(1, 1, 4),
        link(2, 2, 5),
        link(3, 3, 6),
        link(4, 4, 5, 6),
    )
    found = read(*plate)
    (note,) = found.notes
    assert "an Assur group of class III (RRR-RRR)" in note
    assert len(ck.configurations(found.mechanism, {"link 0": 0.4})) >= 2


def test_connectors_that_may_be_meant_to_be_joined_are_named() -> None:
    apart = (*FOUR_BAR[:5], connector(7, 70, 50), link(1, 1, 7), link(2, 2, 3))
    assert read(*apart).notes[-1] == "did you mean to join connectors 2 and 7?"
    floating = (*FOUR_BAR, connector(7, 70, 50), connector(8, 90, 90), link(3, 7, 8))
    with pytest.raises(InvalidInput, match=r"link 3 floats.*did you mean to join connectors 2 and 7\?"):
        read(*floating)


def test_links_that_cannot_move_against_each_other_are_one() -> None:
    found = read(*FOUR_BAR, connector(4, 40, 70), link(3, 1, 2, 4), connector(5, 90, 0, ANCHOR), link(4, 3, 5))
    assert list(found.mechanism.links) == ["frame", "link 0", "link 1+3", "link 2"]
    assert found.notes == ("link 1 and link 3 share connectors 1 and 2: they are one link",)


def test_two_links_of_one_id_are_two() -> None:
    found = read(*FOUR_BAR[:5], link(1, 1, 2), link(1, 2, 3))
    assert list(found.mechanism.links) == ["frame", "link 0", "link 1", "link 1-2"]
    with pytest.raises(InvalidInput, match="fastened to link 1, and 2 links have this id"):
        read(*FOUR_BAR[:5], link(1, 1, 2), link(1, 2, 3), connector(9, 0, 0), link(5, 3, 9, more='fastenlink="1"'))


def test_an_input_without_anchor_drives_against_the_link_listed_first() -> None:
    five_bar = (
        *(one.replace(INPUT, ANCHOR) for one in FOUR_BAR[:2]),
        connector(2, 40, 60, 'input="true" rpm="-6"'),
        connector(3, 60, 0, ANCHOR),
        link(5, 2, 1),
        link(1, 0, 1),
        link(2, 2, 3),
    )
    (driver,) = read(*five_bar).mechanism.drives
    assert (driver.link, driver.on) == ("link 2", "link 5")
    assert driver.speed == pytest.approx(np.pi / 5)


def test_an_input_at_a_frame_link_turns_the_other_link() -> None:
    """The crank is listed first: the frame turns clockwise against it."""
    loose = (connector(0, 0, 0, 'input="true" rpm="30" limitangle="9"'), *FOUR_BAR[1:4])
    ground = (connector(8, -30, -30, ANCHOR), connector(9, 30, -30, ANCHOR))
    first = read(*loose, *ground, *FOUR_BAR[4:], link(9, 8, 9, 0)).mechanism.drives[0]
    last = read(*loose, *ground, link(9, 8, 9, 0), *FOUR_BAR[4:]).mechanism.drives[0]
    assert (first.link, first.on, first.speed) == (last.link, last.on, -last.speed)
    assert (first.link, first.on, first.speed) == ("link 0", "frame", pytest.approx(np.pi))
    np.testing.assert_allclose(np.ptp(np.asarray([first.values, last.values]), axis=1), np.radians(9))


def test_a_wheel_fastened_to_the_frame_holds_a_planet() -> None:
    """Willis: about a fixed wheel of twice its teeth a planet turns three times as far as its arm."""
    found = read(
        connector(0, 0, 0, INPUT),
        connector(1, 96, 0),
        connector(2, -48, 0, ANCHOR),
        connector(3, 96, 48),
        link(0, 0, 1),
        link(1, 0, more='gear="true" fastenlink="5"'),
        link(2, 1, more='gear="true" fastenlink="3"'),
        link(3, 1, 3),
        link(5, 2, 0),
        '<ratios><ratio type="gears"><link id="1" size="30"/><link id="2" size="15"/></ratio></ratios>',
        program='units="Inches"',
    )
    motion = ck.solve(found.mechanism, {"link 0": 0.3}, order=0)
    expected = np.exp(0.3j) + 0.5j * np.exp(0.9j)
    assert complex(np.ravel(motion.points["3"].position)[0]) == pytest.approx(expected)


def test_oscillating_and_manual_inputs() -> None:
    swing = (FOUR_BAR[0].replace(">", ' limitangle="40">', 1), *FOUR_BAR[1:])
    (driver,) = read(*swing).mechanism.drives
    drawn = np.angle(10 + 30j)
    np.testing.assert_allclose(np.asarray(driver.values)[[0, -1]], [drawn, drawn - np.radians(40)], atol=1e-12)
    (note,) = read(*swing).notes
    assert note == "connector 0 oscillates over 40 degrees: that is its range here, at constant speed"
    found = read(FOUR_BAR[0].replace(">", ' alwaysmanual="true">', 1), *FOUR_BAR[1:])
    (manual,) = found.mechanism.drives
    assert found.notes == ("connector 0 has no speed of its own there: it turns at 1 rad/s here",)
    plain = ck.drive("link 0")
    assert (manual.values, manual.speed, manual.name) == (None, plain.speed, plain.name)


def test_a_slider_of_a_fixed_pin_is_that_pin() -> None:
    fixed = connector(9, 20, 0, 'anchor="true" slider="true"', limits(0, 3))
    found = read(*FOUR_BAR, fixed, link(9, 9), link(8, 2, more='gear="true"'))
    assert list(found.mechanism.links) == ["frame", "link 0", "link 1", "link 2"]
    assert found.notes == ("left out, for it does not move anything: 1 slider of a fixed pin",)


def test_names_of_old_files_are_read() -> None:
    text = f"<linkage2>{''.join(FOUR_BAR)}</linkage2>".replace('id="1" ><', 'id="1" name="Schwinge f\xfcr B"><')
    found = FORMAT.read(Content(text.encode("cp1252")))
    assert "Schwinge f\xfcr B" in found.mechanism.links
    assert found.notes == ("it is not UTF-8: its names are read as Windows-1252",)


def test_an_actuator_that_shortens_first() -> None:
    boom = (
        connector(0, 0, 0, ANCHOR),
        connector(1, 0, 96),
        connector(2, 72, 0, ANCHOR),
        link(0, 0, 1),
        link(1, 2, 1, more='actuator="true" throw="9.6" cpm="-30" name="ram"'),
    )
    (driver,) = read(*boom, program='units="Inches"').mechanism.drives
    assert (driver.link, driver.on, driver.name) == ("ram rod", "ram", "ram")
    np.testing.assert_allclose(np.asarray(driver.values)[[0, -1]], [1.25, 1.15])
    assert driver.speed == pytest.approx(-0.1)


def test_a_chain_turns_its_wheels_the_same_way() -> None:
    wheels = (
        connector(0, 0, 0, INPUT),
        connector(1, 96, 0, ANCHOR),
        connector(2, 96, 48),
        link(0, 0, more='gear="true"'),
        link(1, 1, more='gear="true" fastenlink="2"'),
        link(2, 1, 2),
        '<ratios><ratio type="chain" sizeassize="true">',
        '<link id="0" size="12"/><link id="1" size="24"/></ratio></ratios>',
    )
    found = read(*wheels, program='units="Inches"').mechanism
    (pair,) = found.written_pairs
    assert (pair.table, pair.radii) == ("belts", (0.125, 0.25))  # type: ignore[attr-defined]
    motion = ck.solve(found, {"link 0": np.pi}, order=0)
    assert complex(np.ravel(motion.points["2"].position)[0]) == pytest.approx(0.5 + 0j)


def test_pictures_and_measurements_are_counted() -> None:
    found = read(
        *FOUR_BAR,
        connector(10, 1, 1, 'layer="1" fastenlink="1"'),
        connector(11, 1, 1, 'measurementelement="true"'),
        connector(12, 1, 1, 'layer="16"'),
        link(3, 10, 11, more='layer="1"'),
        link(4, 1, 2, more='measurementelement="true"'),
        link(5, 12),
        "<background a='1'/><selected/><sundial/>",
        connector(13, 1, 1, 'layer="1" anchr="true" color="7"'),
    )
    assert list(found.mechanism.links) == ["frame", "link 0", "link 1", "link 2"]
    said = "2 drawing connectors, 2 measuring elements, 1 drawing link, 1 lone connector"
    assert found.notes == (
        "Line 15: 'sundial' is not known and left out.",
        "attributes that are not known are not looked at: anchr (line 16)",
        f"left out, for it does not move anything: {said}",
    )
