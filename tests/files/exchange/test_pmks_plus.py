"""Share links of PMKS+: numbers, all ages of links, what is refused, and that what is written is read again."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Exported, Imported
from compoundkin.files.exchange.drawing import drawing_of
from compoundkin.files.exchange.pmks_plus_format import FORMAT, share_scale
from compoundkin.files.exchange.pmks_plus_text import (
    check_character,
    hash_of,
    packed_decimal,
    packed_flags,
    unpacked_decimal,
    unpacked_flags,
    unpacked_integer,
)
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from compoundkin.model.loads.force import Force
from tests.files.exchange.pmks_plus_links import check_link
from tests.files.exchange.references import entries, entry, holds
from tests.files.exchange.shown_catalog import shown
from tests.support import KINDS_OF_DYAD, random_sketch

ADDRESS = "https://app.pmksplus.com/?"


def read(body: str) -> Imported:
    """Read a share string without its check character, or a whole link."""
    text = body if body.startswith("http") else body + check_character(body)
    assert FORMAT.recognises(Content(text.encode()))
    return FORMAT.read(Content(text.encode()))


def body_of(name: str) -> str:
    return str(entry(name)["text"]).removeprefix(ADDRESS)[:-1]


FOUR_BAR = body_of("pmksplus_old_four_bar")
SLOT = body_of("pmksplus_floating_slot")
BOOM = body_of("pmksplus_cylinder_boom")
SLIDER = body_of("pmksplus_inclined_slider")


@pytest.mark.parametrize("case", entry("pmksplus_numbers")["cases"], ids=str)
def test_numbers_and_flags_are_those_of_the_grammar(case: dict[str, object]) -> None:
    text, value = str(case.get("text")), case.get("value")
    if "flags" in case:
        bits = case["bits"]
        assert isinstance(bits, list)
        assert packed_flags(bits) == case["flags"]
        assert list(unpacked_flags(str(case["flags"]), len(bits))) == [bool(bit) for bit in bits]
    elif "length" in case:
        assert check_character("x" * int(str(case["length"]))) == case["checksum"]
    else:
        assert (unpacked_decimal(text), packed_decimal(float(str(value)))) == (value, text)


def test_every_number_of_three_decimals_comes_back() -> None:
    rng = np.random.default_rng(1)
    for value in [*rng.integers(-(2**47), 2**47, 200).tolist(), *range(-70, 70)]:
        assert unpacked_decimal(packed_decimal(value / 1000.0)) == value / 1000.0
    for wrong in ("", "!", "a b", "F" * 12, "_" * 11, "1.5", "é"):
        with pytest.raises(ValueError, match=r"^"):
            unpacked_integer(wrong)


def test_the_hash_is_that_of_fowler_noll_and_vo() -> None:
    # published for "" and "foobar": 811c9dc5 and bf9cf968; here in six digits of base 62
    digits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"
    for text, published in (("", 0x811C9DC5), ("foobar", 0xBF9CF968)):
        value = 0
        for digit in hash_of(text):
            value = value * 62 + digits.index(digit)
        assert value == published


@pytest.mark.parametrize("published", entries("pmks+"), ids=lambda published: published["id"])
def test_links_of_all_ages(published: dict[str, object]) -> None:
    mechanism = read(str(published["text"])).mechanism
    holds(mechanism, published)
    expected = published["expected"]
    assert isinstance(expected, dict)
    assert expected.get("unit", mechanism.unit) == mechanism.unit
    assert list(expected.get("links", mechanism.links)) == list(mechanism.links)
    assert len(mechanism.links) == expected.get("links_after_welding", len(mechanism.links))
    (driver,) = mechanism.drives
    assert expected.get("driver", driver.link) == driver.link
    speed = expected.get("speed_rad_s", expected.get("speed"))
    if speed is not None:
        np.testing.assert_allclose(driver.speed, speed, rtol=1e-15)
    if "outputs" in expected:
        assert mechanism.outputs == tuple(f"{name}.position" for name in expected["outputs"])
    if "mobility" in expected:
        assert ck.decompose(mechanism).mobility.freedoms == expected["mobility"]


@pytest.mark.parametrize("case", entry("pmksplus_refused")["cases"], ids=lambda case: case["reason"])
def test_refusals_with_their_words(case: dict[str, str]) -> None:
    words = {"cut off": "cut off", "check character": "check character"}
    words |= {"a slot lacks one of carrier and two joints": "slot lacks one of carrier and two joints"}
    words |= {"a link names a joint that is not there": "names a joint 'Z' that is not there"}
    assert FORMAT.recognises(Content(case["text"].encode()))
    with pytest.raises(InvalidInput, match=words[case["reason"]]):
        FORMAT.read(Content(case["text"].encode()))


# What is changed in a sound string, and what is then said; the program refuses the same, by its own tests of slots.
WRONG = {
    "unknown carrier": (SLOT, ",CD,C,D", ",ZZ,C,D", "joint P: its slot is on a link 'ZZ' that is not there"),
    "unknown end": (SLOT, ",CD,C,D", ",CD,C,Q", "joint P: its slot is through a joint 'Q' that is not there"),
    "a part of nothing": (SLOT, "YRCD", "NRCD", "joint P: its slot is on 'CD', a part that no link has"),
    "one end twice": (SLOT, ",CD,C,D", ",CD,C,C", "its slot is through the joint 'C' twice"),
    "ends of another link": (SLOT, ",CD,C,D", ",AB,C,D", "through 'C' and 'D', not of its carrier 'AB'"),
    "through itself": (SLOT, ",CD,C,D", ",CD,C,P", "its slot is through itself"),
    "grounded and carried": (SLOT, "1P,P", "5P,P", "it slides both on the frame and on the link 'CD'"),
    "a slot of a pin": (SLOT, "0B,B,NS,0,0", "0B,B,NS,0,0,CD,C,D", "it has a slot and does not slide"),
    "a cylinder on the frame": (SLIDER, "5P,P", "bP,P", "it is of a cylinder and does not slide on a link"),
    "joints of one id": (FOUR_BAR, "0C,C", "0B,C", "joint B: 2 joints have this id"),
    "links of one id": (FOUR_BAR, "YRCD,", "YRAB,", "link AB: 2 links have this id"),
    "a link of no joints": (FOUR_BAR, "c5cae9,C,D,,", "c5cae9,,", "link CD: it has no joint"),
    "a joint twice": (FOUR_BAR, "c5cae9,C,D,,", "c5cae9,C,C,,", "link CD: it names a joint twice"),
    "a block of three": (SLIDER, ",C,P,,", ",B,C,P,,", "link CP: it is a block and has not one pin and one sliding"),
    "no block": (SLIDER, "YPCP", "YRCP", "link CP: it has the sliding joint 'P' and is no block"),
    "a number": (FOUR_BAR, "0B,B,Fe,VG,0", "0B,B,F!,VG,0", "joint B: its x 'F!' is no number"),
    "no number": (FOUR_BAR, "0B,B,Fe,VG,0", "0B,B,Fe", "joint B: its y is missing"),
    "a link of a later age": (FOUR_BAR, "YRCD", "ZRCD", "link CD: its beginning 'ZR' is none that is known"),
    "an entry of a later age": (FOUR_BAR, "...JA", "...JA.QAB~CD", "the entry 'QAB~CD' is of a kind"),
    "a unit": (FOUR_BAR, "0.101.", "0.701.", "its unit of length '7' is none that is known"),
    "driven at a tracer": (FOUR_BAR, ".GP,P", ".IP,P", "joint P: it is driven and joins 1 links"),
    "a force on nothing": (FOUR_BAR, "...JA", "..2F1,XY,F1,0,0,0,Fe,Fe..JA", "force F1: it is on a link 'XY'"),
    "a force without direction": (FOUR_BAR, "...JA", "..2F1,CD,F1,0,0,0,0,Fe..JA", "force F1: it has no direction"),
    "a force below zero": (FOUR_BAR, "...JA", "..2F1,CD,F1,0,0,0,Fe,0Fe..JA", "force F1: its size -1 is negative"),
    "a guide on itself": (BOOM, "0,GN,G,N", "0,PC,P,C", "link 'PC' slides on itself"),
    "no links": (FOUR_BAR, FOUR_BAR[FOUR_BAR.index("YR") :], "...N", "it has no links"),
    "no frame": (FOUR_BAR.replace("4D,D", "0D,D"), "6A,A", "2A,A", "no joint is grounded: it has no frame"),
    "no joints": (FOUR_BAR, FOUR_BAR[20:], "", "it is cut off"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_cannot_be_meant_is_told_with_its_element(case: str) -> None:
    body, old, new, words = WRONG[case]
    assert old in body
    with pytest.raises(InvalidInput) as caught:
        read(body.replace(old, new, 1))
    assert words in str(caught.value)


def test_all_problems_are_told_at_once() -> None:
    wrong = FOUR_BAR.replace("0B,B,Fe,VG,0", "0B,B,F!,VG,0").replace("YRCD", "ZRCD").replace("A,B,,", "A,Z,,")
    with pytest.raises(InvalidInput) as caught:
        read(wrong)
    assert [problem.where for problem in caught.value.problems] == ["joint B", "link CD", "link AB"]


def test_inputs_that_turn_and_slide_have_their_own_speeds() -> None:
    # 7.5 rpm of its own on a floating pin: the second link of the list against the first, as the app has it
    floating = FOUR_BAR.replace(".6A,A", ".4A,A").replace("0C,C,1Tm,_W,0", "2C,C,1Tm,_W,0,,,,01rC")
    (driver,) = read(floating).mechanism.drives
    assert (driver.link, driver.on) == ("CD", "BCP")
    assert driver.speed == pytest.approx(-7.5 * np.pi / 30.0, rel=1e-15)
    both = read(BOOM.replace("4O,O", "6O,O")).mechanism
    assert [(one.link, one.on, float(one.speed or 0)) for one in both.drives] == [
        ("OC", "frame", pytest.approx(20 * np.pi / 30)),
        ("PC", "GN", 5.0),
    ]
    still = read(FOUR_BAR.replace(".K,0.", ".0,0.")).mechanism
    assert still.drives[0].speed is None or float(still.drives[0].speed) == 1.0


def test_welds_are_of_the_parts_of_a_link_or_of_all_links() -> None:
    # C welded, two links there: one link. With parts that meet there, the weld is theirs and a third link is pinned.
    welded = FOUR_BAR.replace("0C,C", "8C,C").replace("4D,D", "0D,D")
    assert list(read(welded).mechanism.links) == ["frame", "AB", "BCP"]
    parts = "YRBCP,BCP,Fe,Fe,0,0,c5cae9,B,C,P,,BC,CP.NRBC,BC,0,0,0,0,,B,C,,.NRCP,CP,0,0,0,0,,C,P,,."
    compound = FOUR_BAR.replace("0C,C", "8C,C").replace("YRBCP,BCP,Fe,Fe,0,0,c5cae9,B,C,P,,.", parts)
    found = read(compound)
    assert list(found.mechanism.links) == ["frame", "AB", "BCP", "CD"]
    assert "at C parts of link BCP are welded; CD is pinned there" in found.notes


def test_links_of_two_pins_in_common_are_one() -> None:
    twin = FOUR_BAR.replace("YRCD", "YRBC2,BC2,Fe,Fe,0,0,c5cae9,B,C,,.YRCD")
    found = read(twin)
    assert len(found.mechanism.links) == 4
    assert "with two pins in common, and so one link: BC2 and BCP" in found.notes
    rail = FOUR_BAR.replace(".GP,P", ".4P,P").replace("B,C,P", "B,C").replace("C,D,,", "C,D,,.YRDP,,0,0,0,0,,D,P,,")
    found = read(rail)
    assert list(found.mechanism.links) == ["frame", "AB", "BCP", "CD"]
    assert "pinned to the frame twice, and so part of it: DP" in found.notes


def test_masses_and_forces_are_in_the_units_of_the_program() -> None:
    body = FOUR_BAR.replace("YRCD,CD,Fe,Fe,0,0", "YRCD,CD,VG,ku,1Tm,VG").replace("0P.", "0R.", 1)
    body = body.replace("...JA", "..2F1,CD,push,1Tm,_W,2aM,_W,NS.1F2,AB,pull,Fe,VG,Fe,_W,Fe..JA")
    mechanism = read(body).mechanism
    assert mechanism.units is not None
    assert (mechanism.units.length, mechanism.units.mass, mechanism.units.force) == ("cm", "g", "N")
    rocker = mechanism.masses["CD"]
    # 2 g, 3 kg cm^2 = 3000 g cm^2, at (6, 2) as drawn
    assert (float(rocker.mass), float(rocker.inertia)) == (2.0, 3000.0)
    centre = complex(mechanism.mass_centre(rocker))
    assert posed_mechanism(mechanism).place("CD", centre) == pytest.approx(6.0 + 2.0j)
    assert complex(mechanism.gravity) == pytest.approx(-9.81j)
    push, pull = mechanism.loads["push"], mechanism.loads["pull"]
    assert isinstance(push, Force)
    assert isinstance(pull, Force)
    assert (complex(push.force), push.fixed_in) == (1.5 + 0j, "frame")
    # drawn up the crank from its pin, which points in and turns with it
    assert abs(complex(pull.force)) == pytest.approx(1.0)
    assert pull.fixed_in == "AB"


def test_names_and_hashes_of_links_are_read_as_browsers_write_them() -> None:
    named = FOUR_BAR.replace("YRCD,CD", "YRCD,Rocker arm é")
    link = ADDRESS + (named + check_character(named)).replace(" ", "%20").replace("é", "%C3%A9")
    assert "Rocker arm é" in read(link).mechanism.links
    whole = FOUR_BAR + check_character(FOUR_BAR)
    assert read(f"{ADDRESS}{whole}*{hash_of(whole)}").mechanism == read(FOUR_BAR).mechanism
    with pytest.raises(InvalidInput, match="check character"):
        read(f"{ADDRESS}{whole}*{hash_of(whole + 'x')}")


def test_joints_of_one_link_at_one_place_are_one_pin() -> None:
    # two cranks drawn at one grounded place, by two joints; and a sliding joint that stands beside the pin of its block
    twice = FOUR_BAR.replace(".4D,D", ".4E,E,0,0,0.0F,F,0,Fe,0.4D,D").replace("YRCD", "YREF,,0,0,0,0,,E,F,,.YRCD")
    assert set(read(twice).mechanism.carriers["A"]) == {"frame", "AB", "EF"}
    beside = read(SLIDER.replace("5P,P,2aM,Jm", "5P,P,2aM,L0")).mechanism
    assert {*beside.links["CP"].points} == {"C", "P"}
    (slide,) = (pair for pair in beside.written_pairs if pair.table == "slides")
    assert slide.letters[0] == "P"


def write(mechanism: ck.Mechanism, **options: object) -> Exported:
    return FORMAT.write(posed_mechanism(mechanism), **options)


@pytest.mark.parametrize("published", entries("pmks+"), ids=lambda published: published["id"])
def test_what_was_read_is_written_digit_by_digit(published: dict[str, object]) -> None:
    found = read(str(published["text"])).mechanism
    written = write(found)
    assert not any("rounded" in note or "times" in note for note in written.notes)
    assert check_link(written.text) == 1
    again = read(written.text).mechanism
    holds(again, published)
    assert (again.sketch, again.unit, again.outputs) == (found.sketch, found.unit, found.outputs)
    assert [(d.link, d.on, d.speed) for d in again.drives] == [(d.link, d.on, d.speed) for d in found.drives]
    assert write(again).text == written.text


def as_drawn(first: PosedMechanism, back: ck.Mechanism) -> float:
    """Return by how much the pins of a mechanism and of what was written are apart as drawn, as a part of the size."""
    scale = share_scale(drawing_of(first), None)
    return (
        max((abs(back.sketch[k] - scale.factor * _place(first, k)) for k in pins(first, back)), default=0) / scale.size
    )


def moved(first: PosedMechanism, second: PosedMechanism, step: float) -> float:
    """Return by how much they are apart when their drivers have made a step."""
    scale = share_scale(drawing_of(first), None)
    motions = []
    assert len(first.values) == len(second.values)
    for one, factor in ((first, 1.0), (second, scale.factor)):
        length = step * first.mechanism.geometry.size * factor
        turns = one.structure.driven_angles
        values = {name: value + (step if turns[name] else length) for name, value in one.values.items()}
        hint = {k: _place(one, k) for k in one.mechanism.carriers}
        motions.append(ck.solve(one.mechanism, values, hint=hint, order=0))
    off = 0.0
    for k in pins(first, second.mechanism):
        here, there = (complex(np.ravel(motion.points[k].position)[0]) for motion in motions)
        off = max(off, abs(there - scale.factor * here) / scale.size)
    return off


def pins(first: PosedMechanism, back: ck.Mechanism) -> list[str]:
    return [k for k, links in first.mechanism.carriers.items() if len(links) > 1 and k in back.sketch]


def _place(one: PosedMechanism, letter: str) -> complex:
    return one.place(one.mechanism.carriers[letter][0], letter)


# What needs dimensions that are more exact than three decimals: it is held more than once, and the note says so.
HELD_TWICE = {"double-parallelogram-lift", "roberts-cognates"}
# The kinds of pair that PMKS+ has no word for.
UNSAID = {"arcs", "belts", "cams", "drives", "faces", "gears", "racks", "roll_arounds", "rollings"}


def test_the_catalog_comes_back_as_far_as_it_can_be_said() -> None:
    written, refused = 0, set()
    for name in ck.exchange.shipped():
        first = shown(name)
        try:
            link = FORMAT.write(first)
        except InvalidInput as error:
            refused |= {problem.where.split("[")[0].split(".")[0] for problem in error.problems}
            continue
        written += 1
        assert check_link(link.text) == len(first.mechanism.drives)
        if name in HELD_TWICE:
            assert any("held more than once" in note for note in link.notes)
            continue
        back = read(link.text).mechanism
        slots = sum(guide.kind == "slot" for guide in drawing_of(first).guides)
        assert len(back.links) == len(first.mechanism.links) + slots
        assert set(first.mechanism.links) <= set(back.links)
        # three decimals of 100 units or more; mechanisms with masses are left as small as they are
        assert as_drawn(first, back) <= (5e-5 if drawing_of(first).masses else 1e-5)
        theirs = {one.link: one for one in back.drives}
        for one in first.mechanism.drives:
            scale = 1.0 if first.structure.driven_angles[one.name] else share_scale(drawing_of(first), None).factor
            told = theirs[one.link].speed
            assert told is not None
            assert float(told) == pytest.approx(first.rates[one.name] * scale, abs=0.0005)
    assert written >= 70
    assert refused <= UNSAID


# Of each kind of pair and driver some, and of each class of group.
MOVED = ("3-rrr", "class-iii-six-bar", "dixon-mechanism", "elliptic-trammel", "hand-pump", "hydraulic-digger",
         "marghitu-r-rtr-rrt", "oldham-coupling", "pantograph", "scissor-lift", "slider-crank-driven-by-piston",
         "stephenson-iii-floating-driver", "wedge-press", "whitworth-quick-return")  # fmt: skip


@pytest.mark.parametrize("name", MOVED)
def test_what_was_written_moves_as_ours(name: str) -> None:
    back = read(FORMAT.write(shown(name)).text).mechanism
    assert moved(shown(name), posed_mechanism(back), 1e-2) <= 1e-5


@pytest.mark.parametrize("seed", range(8))
def test_random_mechanisms_come_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    first = posed_mechanism(random_sketch(rng, rng.choice(KINDS_OF_DYAD, 3)).mechanism())
    link = FORMAT.write(first, on_rails=True)
    assert check_link(link.text) == 1
    second = posed_mechanism(read(link.text).mechanism)
    assert as_drawn(first, second.mechanism) <= 1e-5
    # dyads near their limits move a hundred times as far as places are rounded
    assert moved(first, second, 1e-3) <= 1e-4


def test_what_cannot_be_said_is_refused_by_name_and_all_at_once() -> None:
    with pytest.raises(InvalidInput) as caught:
        FORMAT.write(shown("geared-five-bar"))
    assert "is a belt; PMKS+ has pins, slides and slots only" in str(caught.value)
    with pytest.raises(InvalidInput) as caught:
        FORMAT.write(shown("planetary-train"))
    assert len(caught.value.problems) == sum(pair.table == "gears" for pair in shown("planetary-train").pairs)


def test_guides_of_the_frame_are_rounded_and_said_or_laid_on_rails() -> None:
    engine = shown("v-engine")
    plain, exact = FORMAT.write(engine), FORMAT.write(engine, on_rails=True)
    assert any("the guide of" in note and "degrees" in note for note in plain.notes)
    assert not any("the guide of" in note for note in exact.notes)
    back = read(exact.text)
    assert any("pinned to the frame twice, and so part of it" in note for note in back.notes)
    assert moved(engine, posed_mechanism(back.mechanism), 0.5) <= 5e-6
    # a quarter turn is nearest to three decimals a turn further: 7.854 rad
    upright = read(SLIDER.replace("5T", "OZ"))
    assert any("may have meant 90 degrees" in note for note in upright.notes)
    items = ck.link("frame", A=0), ck.link("crank", A=0, B=1), ck.link("rod", B=0, C=3), ck.link("piston", C=0)
    slide = ck.slide("piston", on="frame", at="C", through="A", angle=np.pi / 2)
    assert f",{packed_decimal(7.854)}..YR" in write(ck.Mechanism("pump", *items, slide, ck.drive("crank"))).text


def test_the_scale_is_ours_to_give() -> None:
    small = shown("scotch-yoke")
    assert FORMAT.write(small).notes[0].startswith("all lengths are 1000 times as large as they are, in cm")
    same = FORMAT.write(small, scale=1)
    assert not any("times as large" in note for note in same.notes)
    assert any("rounded" in note for note in same.notes)
    for wrong in (0, -1, "many", float("nan"), float("inf")):
        with pytest.raises(InvalidInput, match="is no positive number"):
            FORMAT.write(small, scale=wrong)
    with pytest.raises(InvalidInput, match="give a smaller scale"):
        FORMAT.write(small, scale=1e15)


def test_loads_are_written_in_the_units_of_the_program() -> None:
    loaded = ck.load("jaw-crusher-loaded")
    back = read(write(loaded).text).mechanism
    assert back.units is not None
    one, two = posed_mechanism(loaded), posed_mechanism(back)
    kilograms = {"kg": 1.0, "g": 1e-3}
    assert loaded.units is not None
    for name, item in loaded.masses.items():
        if name not in back.masses:
            continue
        ours, theirs = (
            float(m.mass) * kilograms[u.mass] for m, u in ((item, loaded.units), (back.masses[name], back.units))
        )
        assert theirs == pytest.approx(ours, rel=1e-3)
        centre = two.place(name, complex(back.mass_centre(back.masses[name])))
        metres = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
        assert centre * metres[back.unit] == pytest.approx(
            one.place(name, complex(loaded.mass_centre(item))) * metres[loaded.unit], abs=1e-5
        )


# Strings that are too long, too large or of nothing: what is said, or how many links are read.
ODD: dict[str, tuple[str, str | int]] = {
    "many records": (FOUR_BAR.replace("0B,B", "0Z,Z,0,0,0." * 1000 + "0B,B", 1), "more than 1000 joints"),
    "no number ends": (FOUR_BAR.replace("Fe,VG,0.", "F" * 100_000 + ",VG,0.", 1), "its x 'FFFFFFFFFFFFFFFFFFFF' is no"),
    "beyond doubles": (FOUR_BAR.replace("Fe,VG,0.", "---------,VG,0.", 1), "its x '---------' is no number"),
    "large": (FOUR_BAR.replace("Fe,Fe,", "0,0,").replace("0.0B,B,Fe,VG", "0.0B,B,U-------,VG", 1), 4),
    "dots": ("0P.Fe.K,0.101." + "." * 100_000, "it has no links"),
    "long": (FOUR_BAR + "http://pmks" * 100_000, "a link has at most 200,000"),
    "marks": (FOUR_BAR + "." + "LAB," * 30_000, 4),
    "many links of the same joints": (
        FOUR_BAR.replace("YRCD", "".join(f"YRx{k},,0,0,0,0,,B,C,P,,." for k in range(900)) + "YRCD"),
        4,
    ),
    "all at one place": ("0P.Fe.K,0.101.6A,A,0,0,0.0B,B,0,0,0..YRAB,,0,0,0,0,,A,B,,...N", 2),
}


@pytest.mark.parametrize("case", ODD)
def test_odd_strings_are_answered(case: str) -> None:
    body, expected = ODD[case]
    if isinstance(expected, int):
        assert len(read(body).mechanism.links) == expected
    else:
        with pytest.raises(InvalidInput, match=expected):
            read(body)


@pytest.mark.filterwarnings("ignore::compoundkin.base.errors.LikelySlip")
def test_changed_strings_are_read_or_refused_with_words() -> None:
    rng = np.random.default_rng(3)
    digits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_-,.~* é%"
    bodies = [body_of(str(one["id"])) for one in entries("pmks+")]
    for _ in range(300):
        body = bodies[rng.integers(len(bodies))]
        for _ in range(rng.integers(1, 4)):
            start, length = int(rng.integers(14, len(body))), int(rng.integers(0, 12))
            new = "".join(digits[k] for k in rng.integers(0, len(digits), rng.integers(0, 3)))
            body = body[:start] + (new if rng.integers(2) else body[start - length : start]) + body[start + length :]
        with suppress(InvalidInput):
            assert FORMAT.read(Content((body + check_character(body)).encode())).mechanism.links


def test_the_page_prints_what_it_shows(capsys: pytest.CaptureFixture[str]) -> None:
    text = (Path(__file__).parents[3] / "docs" / "exchange" / "pmks-plus.md").read_text("utf-8")
    names: dict[str, object] = {}
    blocks = re.findall(r"```python\n(.*?)```\n\n```text\n(.*?)```", text, re.DOTALL)
    assert len(blocks) == text.count("```python")
    for code, shown_text in blocks:
        exec(code, names)
        assert capsys.readouterr().out == shown_text


def test_pasted_strings_are_read_by_the_face_of_the_house() -> None:
    whole = FOUR_BAR + check_character(FOUR_BAR)
    shortcut = f"[InternetShortcut]\nURL={ADDRESS}{whole}\n"
    for text in (ADDRESS + whole, whole, f"  {whole}\n", f"app.pmksplus.com/?{whole}", shortcut):
        assert ck.exchange.read(text).form == "pmks+"


def test_links_are_read_as_mails_and_notes_hold_them() -> None:
    link = ADDRESS + FOUR_BAR + check_character(FOUR_BAR)
    sent = (
        *(
            f"<{link}>",
            f"[my four-bar]({link})",
            f'"{link}".',
            f"{link[:60]}\n{link[60:]}\n",
            f"{link[:60]} \r\n{link[60:]}",
        ),
        *(link.replace(",", "%2C"), f"{link}&utm_source=mail&utm_medium=link", f"{link}&fbclid=IwAR0x"),
    )
    meant = read(link).mechanism
    assert all(ck.exchange.read(text).mechanism == meant for text in sent)
    for cut in (f"<{link[:-9]}>", f"{link[:-9]}&utm_source=mail"):
        with pytest.raises(InvalidInput, match="cut off"):
            ck.exchange.read(cut)


def test_inputs_without_a_speed_are_told() -> None:
    still = FOUR_BAR.replace(".K,0.", ".0,0.")
    found = read(still)
    assert (found.mechanism.drives[0].speed, found.notes[0]) == (1.0, "A has no speed there: it turns at 1 rad/s here")


def test_names_of_all_kinds_come_back() -> None:
    names = "50% é 雪 🚀", "a/b&c?d=e+f*", "no #1~2", "plain"
    items = [ck.link("frame", A=0, D=4), ck.link(names[0], A=0, B=1), ck.link(names[1], B=0, C=3)]
    mechanism = ck.Mechanism("names", *items, ck.link(names[2], C=0, D=3, E=4), ck.drive(names[0]))
    written = write(mechanism)
    assert written.text.isascii()
    # the app decodes links with decodeURI, which leaves these as they are
    assert "a/b&c?d=e+f*" in written.text
    assert " " not in written.text
    assert any("'no #1~2' is 'no -1-2'" in note for note in written.notes)
    assert list(read(written.text).mechanism.links) == ["frame", *names[:2], "no -1-2"]
