"""PMKS: text, addresses and files, against the samples; what is refused, and there and back."""

from __future__ import annotations

import json

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.errors import InvalidInput
from compoundkin.files.exchange.known_formats import read, write
from compoundkin.files.exchange.pmks_joints import point_keys
from compoundkin.files.exchange.pmks_records import JointRecord
from compoundkin.files.exchange.posed_mechanism import posed_mechanism
from tests.files.exchange.references import driven_by, entries, entry, holds
from tests.files.exchange.shown_catalog import shown


@pytest.mark.parametrize("given", entries("pmks"), ids=lambda given: given["id"])
def test_samples_hold_as_read_and_after_they_were_written(given):
    got = read(given["text"])
    holds(got.mechanism, given)
    for form in ("pmks", "pmks-url"):
        written = write(got.mechanism, form)
        back = read(written.text)
        assert back.form == form
        holds(back.mechanism, given)
        assert write(back.mechanism, form).text == written.text


def test_names_titles_speeds_and_pairs_are_kept():
    by = {sample["id"]: (read(sample["text"]).mechanism, sample["expected"]) for sample in entries("pmks")}
    four, expected = by["pmks_text_four_bar"]
    assert {"ground" if name == "frame" else name for name in four.links} == set(expected["links"])
    assert sum(len(links) > 1 for links in four.carriers.values()) == expected["pins"]
    assert sum(len(links) == 1 for links in four.carriers.values()) == expected["tracers"]
    assert four.drives[0].link == expected["driver"]
    inclined, expected = by["pmks_text_inclined_slider"]
    assert (inclined.title, inclined.drives[0].speed) == (expected["title"], expected["speed_rad_s"])
    for name in ("pmks_text_gears", "pmks_text_internal_gears"):
        (pair,), expected = by[name][0].written_pairs, by[name][1]["gear"]
        assert (list(pair.radii), pair.internal) == (expected["radii"], expected["internal"])
        assert pair.carrier == "frame"
    (slot,) = by["pmks_text_quick_return"][0].written_pairs
    assert (slot.table, slot.members) == ("slots", ("arm", "crank"))
    (slide,) = by["pmks_url_slider_crank"][0].written_pairs
    assert (slide.table, set(slide.members)) == ("slides", {"slider", "frame"})


@pytest.mark.parametrize("case", entry("pmks_text_refused")["cases"], ids=lambda case: case["reason"])
def test_what_cannot_be_is_refused_with_its_reason(case):
    with pytest.raises(InvalidInput) as told:
        read(case["text"], "pmks")
    assert case["reason"] in str(told.value).replace("\n", " ")


def test_all_that_is_wrong_is_told_at_once_with_its_line():
    text = "ground,a,R,0,zero\na,b,R,1e999,1\nb,c,R,2,2,up\nb,a,b,R,3,1\nd=77\nc,ground,R,4,0,0\ns=fast\nground R\n"
    with pytest.raises(InvalidInput) as told:
        read(text)
    places = [problem.where for problem in told.value.problems]
    assert places == ["line 1", "line 2", "line 3", "line 8", "s", "line 4", "d"]


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("mech=\nname=nothing\n", "there are no joints"),
        (
            "0,a,R,0,0\na,b,G,4,0\nb,c,R,10,0\n",
            "line 2: a gear without a common carrier: no link holds both 'a' and 'b'",
        ),
        ("0,a,R,0,0\na,b,G,4,2\nb,0,R,10,0\n", "line 2: the contact is not on the line through the centres"),
        ("0,a,R,0,0\na,b,G,4,0\nb,a,G,4,0\nb,0,R,10,0\n", "line 3: these two wheels have another contact"),
        ("0,a,R,0,0\na,a,R,1,0\n", "line 2: a joint of the link 'a' with itself"),
        ("0,R,0,0,ffft\n0,a,R,1,0\n", "line 1: a tracer cannot drive"),
        ("0,a,R,0,0\n" * 301, "line 301: there are more than 300 joints"),
        ("0,a,R,0,0\n" * 40_000, "it has 400,000 characters"),
    ],
)
def test_what_is_wrong_is_named(text, reason):
    with pytest.raises(InvalidInput) as told:
        read(text, "pmks")
    assert reason in str(told.value)


def test_racks_are_wheels_on_a_slide():
    text = "ground,pinion,R,0,0,tfft\nground,rack,P,7,-3,0\npinion,rack,G,0,-2\nrack,R,9,-2.5\npinion,R,0,2\n"
    mechanism = read(text).mechanism
    for one in (mechanism, read(write(mechanism, "pmks").text).mechanism):
        motion = ck.solve(one, driven_by(posed_mechanism(one), 1.0), order=0)
        tip = next(k for k, links in one.carriers.items() if abs(one.sketch[k] - (9 - 2.5j)) < 1e-9)
        assert np.ravel(motion.points[tip].position)[-1] == pytest.approx(9 + 2.0 - 2.5j)


def test_pins_of_many_links_are_one_in_either_way_of_writing():
    at_once = "0 a R 0 0 tfft\na b c R 4 3\nb 0 R 8 0\nc d R 5 7\nd 0 R 9 6\n"
    in_two = "0 a R 0 0 tfft\na b R 4 3\nb c R 4 3\nb 0 R 8 0\nc d R 5 7\nd 0 R 9 6\n"
    one, two = (read(text).mechanism for text in (at_once, in_two))
    assert one.carriers == two.carriers
    assert set(one.pins["B"]) == {"a", "b", "c"}
    assert read(at_once.strip().replace(" ", ",").replace("\n", "|")).mechanism.carriers == one.carriers
    apart = [JointRecord("R", links, 1j) for links in (("a", "b"), ("c", "d"), ("b", "c"), ("e", "f"))]
    assert point_keys(apart) == {0: 0, 1: 0, 2: 0, 3: 3}


def test_a_driven_slide_goes_the_way_its_speed_tells():
    text = "ground,ram,P,3,0,20,tfft\nram,rod,R,3,0\nrod,arm,R,6,5\narm,ground,R,0,6\ns=2\n"
    mechanism = read(text).mechanism
    for one in (mechanism, read(write(mechanism, "pmks").text).mechanism):
        (drive,) = one.drives
        assert (drive.link, drive.on, drive.speed) == ("ram", "frame", 2.0)
        motion = ck.solve(one, driven_by(posed_mechanism(one), 0.5), order=0)
        moved = np.diff(np.ravel(motion.points["A"].position)[[0, -1]])[0]
        assert moved == pytest.approx(0.5 * np.exp(1j * np.deg2rad(20)))
    turned = read(text.replace(",20,", ",200,")).mechanism
    assert turned.written_pairs[0].angle == pytest.approx(np.deg2rad(20))


def test_addresses_may_have_blanks_in_any_way_and_settings():
    plain = "http://x.org/pmks.html?set=s50|f0.5&mech=0 a R 0 0 tfft|a b R 3 4|b 0 R 9 0&ts=M0,0L1,1"
    for text in (plain, plain.replace(" ", "+"), plain.replace(" ", "%20"), plain.replace(" ", ",")):
        got = read(text)
        assert got.form == "pmks-url"
        assert got.mechanism.drives[0].speed == 50.0
        assert got.mechanism.sketch["B"] == 3 + 4j
        assert any("step setting" in note for note in got.notes)
    signs = read(plain.replace(" ", ",").replace("tfft", "+--+")).mechanism
    assert signs.drives[0].link == "a"


def test_what_pmks_has_no_words_for_is_refused_all_at_once():
    mechanism = ck.Mechanism(
        "two cranks",
        ck.link("frame", A=0, D=4),
        ck.link("one", A=0, B=1),
        ck.link("two", D=0, C=1),
        ck.belt("one", "two", carrier="frame", first_at="A", second_at="D", radii=(1, 1)),
        ck.link("three", D=0, E=1),
        ck.drive("one"),
        ck.drive("three"),
    )
    with pytest.raises(InvalidInput) as told:
        write(mechanism, "pmks")
    assert "belt" in str(told.value)
    assert "2 drivers ('one', 'three'); PMKS has one" in str(told.value)


def test_files_hold_what_they_tell():
    (sample,) = entries("pmks-json")
    got = read(sample["text"])
    assert got.form == "pmks-file"
    holds(got.mechanism, sample)
    (drive,) = got.mechanism.drives
    expected = sample["expected"]
    assert (got.mechanism.title, drive.link, drive.speed) == (expected["title"], expected["driver"], 10.0)


def file_of(rows: str, driven: int = 0) -> str:
    """A file of PMKS, of the rows of a text and the angles as they stand in it."""
    joints = []
    for row in rows.splitlines():
        *links, kind, x, y, angle = row.split(",")
        joints.append({"X": float(x), "Y": float(y), "Angle": float(angle), "TypeOfJoint": kind, "Links": links})
    return json.dumps({"Joints": joints, "DrivingIndex": driven, "InputSpeed": 2, "Links": []})


def test_angles_of_files_are_relative_to_links_of_two_fixed_joints():
    sample = entry("pmks_text_quick_return")
    turned = np.deg2rad(69.443954780417) - np.angle(28.089875327071 + 74.906334205524j)
    rows = "ground,crank,R,0,0,NaN\narm,crank,RP,15,0,{}\narm,ground,R,0,-40,NaN\n{}"
    of_two = rows.format(turned, "arm,R,28.089875327071,34.906334205524,0")
    holds(read(file_of(of_two)).mechanism, sample)
    third = "arm,R,28.089875327071,34.906334205524,0\narm,R,28,30,0"
    of_three = rows.format(np.deg2rad(69.443954780417), third)
    holds(read(file_of(of_three)).mechanism, sample)


@pytest.mark.parametrize(
    ("text", "reasons"),
    [
        ('{"Joints": [], "TypeOfJoint": 0}', ["there are no joints"]),
        (
            '{"Joints": [{"TypeOfJoint": "R", "X": NaN, "Links": ["a", "b"]}]}',
            ["joint 0", "'X' is nan", "'Y' is missing"],
        ),
        (file_of("ground,a,P,0,0,NaN"), ["joint 0", "'Angle' is nan"]),
        (file_of("ground,a,Q,0,0,0"), ["joint 0: no joint type R, P, RP or G"]),
        (file_of("ground,a,R,0,0,0", 3), ["there is no joint 3"]),
        ('{"TypeOfJoint": ' + "[" * 100_000, ["nested too deeply"]),
    ],
)
def test_files_that_cannot_be_are_refused(text, reasons):
    with pytest.raises(InvalidInput) as told:
        read(text, "pmks-file")
    assert all(reason in str(told.value) for reason in reasons)


ROWS = "ground,crank,R,0,0\ncrank,rod,R,3,4\nrod,slider,R,10,0\nslider,ground,P,10,0,0\n"
TABLES = {
    "no heading": ROWS,
    "heading": f"link names,type,x,y,angle\n{ROWS}",
    "columns": "x,y,type,link 1,link 2,angle\n0,0,R,gnd,crank,\n3,4,R,crank,rod\n10,0,R,rod,slider\n10,0,P,slider,0\n",
    "names": 'name;Links;Type;X [mm];Y [mm]\nA;ground crank;R;0,0;0\nB;"crank, rod";R;3,0;4\n'
    "C;rod+slider;R;1e1;0,0\n;slider 0;P;10;0",
    "tabs": "# SAM\n" + ROWS.replace(",", "\t").replace("3\t4", "3\t4,0"),
}


@pytest.mark.parametrize("kind", TABLES)
def test_tables_of_joints_are_read_however_they_are_written(kind):
    sample = entry("pmks_url_slider_crank")
    got = read(TABLES[kind])
    assert got.form == ("pmks" if kind == "no heading" else "joints")
    holds(got.mechanism, sample)
    written = write(got.mechanism, "joints")
    back = read(written.text)
    assert back.form == "joints"
    holds(back.mechanism, sample)
    assert write(back.mechanism, "joints").text == written.text


def test_tables_may_have_several_drivers():
    five = ck.load("five-bar")
    with pytest.raises(InvalidInput, match="PMKS has one"):
        write(five, "pmks")
    back = read(write(five, "joints").text).mechanism
    assert [one.link for one in back.drives] == [one.link for one in five.drives]
    assert ck.exchange.compare(five, back).within(1e-9)
    at_one_pin = ck.load("differential")
    assert ck.exchange.compare(at_one_pin, read(write(at_one_pin, "joints").text).mechanism).within(1e-9)


def test_tables_keep_names_of_points_and_say_what_is_missing():
    text = "name,links,type,x,y,driver\nhinge,ground crank,R,0,0,no\ncrank pin,crank rod,R,3,4,\n"
    text += "wrist,rod slider,R,10,0,\n"
    mechanism = read(f"{text}end,ground slider,P,10,0,yes\ns=2\nname=press, small\n").mechanism
    assert {"hinge", "crank pin", "wrist"} <= set(mechanism.carriers)
    assert (mechanism.drives[0].link, mechanism.drives[0].speed, mechanism.title) == ("slider", 2.0, "press, small")
    again = read(write(mechanism, "joints").text).mechanism
    assert {"hinge", "crank pin", "wrist"} <= set(again.carriers)
    assert (mechanism.unit, again.unit) == ("", "")
    # a unit in the headings is kept, there and back; two are a mistake
    metric = read(f"{text}end,ground slider,P,10,0,yes\n".replace("x,y", "x [mm],y (mm)")).mechanism
    assert (metric.unit, read(write(metric, "joints").text).mechanism.unit) == ("mm", "mm")
    with pytest.raises(InvalidInput, match="different units"):
        read(f"{text}end,ground slider,P,10,0,yes\n".replace("x,y", "x [mm],y [in]"))
    with pytest.raises(InvalidInput, match="line 5: the driver 'maybe' is neither yes nor no"):
        read(f"{text}end,ground slider,P,10,0,maybe\n")
    with pytest.raises(InvalidInput, match="line 5: a coordinate is missing"):
        read(f"{text}end,ground slider,P,10,,yes\n")
    with pytest.raises(InvalidInput, match="line 2: the coordinate '' is no finite number"):
        read("links;type;x;y;angle\nground;crank;R;;5;20")


@pytest.mark.parametrize(
    "name", ["planetary-train", "rack-and-pinion-steering", "hydraulic-crane", "elliptic-trammel", "class-iii-six-bar"]
)
def test_mechanisms_of_the_catalog_come_back(name):
    one = shown(name).mechanism
    for form in ("pmks", "joints"):
        back = read(write(one, form).text).mechanism
        places = {k: shown(name).place(links[0], k) for k, links in one.carriers.items()}
        first, second = (driven_by(posed_mechanism(mechanism), 0.05) for mechanism in (one, back))
        a, b = ck.solve(one, first, order=0, hint=places), ck.solve(back, second, order=0)
        rows = {k: b.points[k].position.ravel()[[0, -1]] for k in back.carriers}
        for k, place in places.items():
            moved = [row[1] for row in rows.values() if abs(row[0] - place) < 1e-9 * a.size]
            assert min(abs(one - a.points[k].position.ravel()[-1]) for one in moved) < 1e-9 * a.size
