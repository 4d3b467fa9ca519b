"""Results in the studio are the package's own; configurations that are chosen; what does not meet; files of others."""

from __future__ import annotations

import re
from base64 import b64decode, b64encode
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import dumps, loads
from compoundkin.studio import answer
from compoundkin.studio.answers import _shown
from compoundkin.studio.reading import reading_of
from tests.studio.test_answers import FOUR_BAR, START, edited, shipped_text

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")


def reply(text: str, ask: str, **more: Any) -> dict[str, Any]:
    found = answer(text, {"ask": ask, **more})
    assert found["problems"] == []
    return found


def test_the_report_is_the_packages_own_and_without_styles() -> None:
    text = shipped_text("slider-crank")
    found, own = reply(text, "results"), ck.report(loads(text))
    assert [one["key"] for one in found["sections"]] == [one.key for one in own.sections]
    html = "".join(one["html"] for one in found["sections"])
    assert "<table" in html
    assert " style=" not in html
    assert "<script" not in html
    # every name can be asked for
    motion = ck.solve(loads(text))
    for name in found["quantities"]:
        ck.quantity(motion, name)


def test_titles_cannot_bring_elements_into_the_page() -> None:
    text = shipped_text("slider-crank").replace('title = "', 'title = "<img src=x onerror=alert(1)>', 1)
    html = "".join(one["html"] for one in reply(text, "results")["sections"])
    assert "<img" not in html


@pytest.mark.parametrize("drawn", [True, False])
def test_a_chosen_configuration_is_the_one_that_is_solved(drawn: bool) -> None:
    text = edited(START, *FOUR_BAR) if drawn else answer("", {"ask": "open", "name": "four-bar:60,20,50,40"})["text"]
    pose = 40
    both = reply(text, "configurations", pose=pose)["configurations"]
    assert [one["is_shown"] for one in both].count(True) == 1
    other = next(one["name"] for one in both if not one["is_shown"])
    changed = edited(text, {"do": "configuration", "name": other}, pose=pose)
    before, after = ck.solve(loads(text)), ck.solve(loads(changed))
    for name, link in before.mechanism.geometry.points.items():
        for letter in link:
            here, there = (list(one.mechanism.geometry.points[name]) for one in (before, after))
            assert here == there
            lengths = [
                abs(
                    np.ravel(one.mechanism.geometry.points[name][letter] - one.mechanism.geometry.points[name][here[0]])
                )
                for one in (before, after)
            ]
            np.testing.assert_allclose(*lengths, atol=1e-9)
    # the loop is mirrored in the line from B to D: C lies on its other side
    sides = []
    for one in (before, after):
        b, c, d = (one.points[letter].position for letter in "BCD")
        sides.append(np.sign(((c - b) * np.conj(d - b)).imag[0]))
    assert sides[0] == -sides[1]
    if drawn:
        assert changed.startswith(START)


def test_where_it_cannot_be_assembled_the_circles_miss() -> None:
    text = edited(START, *FOUR_BAR[:5], {"do": "driver", "point": "D"})
    motion = reply(text, "motion")
    (gap, *_) = motion["gaps"]
    k = gap["from"]
    (one, other) = gap["circles"]
    assert {one["point"], other["point"]} == {"A", "C"}
    at = {letter: complex(x[k], y[k]) for letter, (x, y) in motion["points"].items() if x[k] is not None}
    assert "B" not in at
    apart = abs(at["A"] - at["C"])
    assert apart > one["radius"] + other["radius"] or apart < abs(one["radius"] - other["radius"])
    # what is known is where the driver has it: the bar goes from C to D
    value = np.deg2rad(motion["drives"]["bar3"]["values"][k])
    assert np.angle(at["D"] - at["C"]) == pytest.approx(value - 2 * np.pi * round(value / 2 / np.pi), abs=1e-5)


def test_velocities_and_centres_are_those_of_the_motion() -> None:
    text = shipped_text("six-bar")
    found, k = reply(text, "overlays"), 60
    motion = ck.solve(ck.load("six-bar"), {"crank": np.deg2rad(np.arange(361.0))})
    v = {letter: motion.points[letter].velocity[k] for letter in "DACG"}
    told = {letter: complex(*(part[k] for part in found["velocities"][letter])) for letter in v}
    scale = abs(v["D"]) / abs(told["D"])
    for letter, value in v.items():
        assert told[letter] * scale == pytest.approx(value, rel=1e-4)
    centre = next(xy for links, xy in found["centres"].items() if set(links.split(", ")) == {"frame", "plate"})
    # all velocities of the plate are at right angles to the way from its centre
    for letter in "DAC":
        arm = motion.points[letter].position[k] - complex(centre[0][k], centre[1][k])
        assert (arm * np.conj(v[letter])).real == pytest.approx(0, abs=1e-3 * abs(arm) * abs(v[letter]))


def test_every_form_is_offered_and_written_or_refused_with_reasons() -> None:
    text, refused = shipped_text("slider-crank"), dict[str, str]()
    for form in reply("", "forms")["forms"]:
        found = answer(text, {"ask": "export", "to": form["name"], "name": "mine"})
        if found["problems"]:
            refused[form["name"]] = found["problems"][0]["what"]
        else:
            assert found["suffix"] == form["suffix"]
            assert len(b64decode(found["content"])) > 20
    # what needs an extra may be refused too
    assert {name: why for name, why in refused.items() if name != "dxf"} == {"cam-profile": "it has no cam"}
    assert answer(text, {"ask": "export", "to": "pyton"})["problems"][0]["remedy"] == "did you mean 'python'?"


def test_what_another_program_reads_comes_back_as_it_went() -> None:
    text = shipped_text("slider-crank")
    written = reply(text, "export", to="linkage")
    back = reply("", "open", name="it.linkage2", content=written["content"])["text"]
    assert ck.decompose(loads(back)).mobility.freedoms == 1
    assert ck.decompose(loads(back)).faults == ()


def test_nothing_of_this_machine_is_opened(tmp_path: Any) -> None:
    path = tmp_path / "secret.toml"
    path.write_text(dumps(ck.load("crank-rocker")))
    found = answer("", {"ask": "open", "name": str(path)})
    assert "no name of the catalog" in found["problems"][0]["what"]
    assert answer("", {"ask": "open", "name": "x", "content": "?"})["problems"]
    content = b64encode(b"nothing of any program").decode()
    assert answer("", {"ask": "open", "name": str(path), "content": content})["problems"]


def test_what_does_not_move_yet_is_told_so() -> None:
    for ask in ("plots", "configurations", "circuits", "overlays"):
        assert answer(START, {"ask": ask, "names": []})["problems"], ask


@pytest.mark.parametrize("pose", [None, 70])
@pytest.mark.parametrize("drawn", [True, False])
def test_one_dimension_is_changed_and_no_other(drawn: bool, pose: int | None) -> None:
    text = edited(START, *FOUR_BAR) if drawn else answer("", {"ask": "open", "name": "four-bar:60,20,50,40"})["text"]
    name = "bar2" if drawn else "coupler"
    before = loads(text).geometry.points
    changed = edited(text, {"do": "dimensions", "values": {f"{name}.C.x": 47.5}}, pose=pose)
    after = loads(changed).geometry.points
    for link, points in before.items():
        first, *others = points
        for letter in others:
            lengths = [abs(np.ravel(one[link][letter] - one[link][first])[0]) for one in (before, after)]
            wanted = 47.5 if link == name else lengths[0]
            assert lengths[1] == pytest.approx(wanted, abs=1e-9)
    if drawn:
        assert changed.startswith(START)


def test_dimensions_that_cannot_be_are_refused() -> None:
    text = edited(START, *FOUR_BAR)
    for values in ({"bar2.C.x": 500}, {"bar2.Q.x": 5}, {"bar2.C.x": "5"}, {"bar2.C.x": float("nan")}, None):
        found = answer(text, {"ask": "edit", "edit": {"do": "dimensions", "values": values}})
        assert found["text"] == text
        assert found["problems"], values


@pytest.mark.parametrize(
    ("name", "values", "pose"),
    [
        ("slider-crank", {"stroke.angle": 0.1}, 40),
        ("disc-cam-offset-roller", {"guide.offset": 9.5, "roller/cam.radius": 7.0}, 3),
        ("hydraulic-digger", {"boom-cylinder.stroke.1": 1.4}, 2),
    ],
)
def test_numbers_of_pairs_are_changed_where_they_are_written(name: str, values: dict[str, float], pose: int) -> None:
    """The file then solves as the mechanism with those numbers; nothing else of it changes but the drawing."""
    text = shipped_text(name)
    new = edited(text, {"do": "dimensions", "values": values}, pose=pose)
    before, after = (re.sub(r"(?s)\n\[drawn\].*?(?=\n\[|\Z)", "", one).splitlines() for one in (text, new))
    assert len([one for one in before if one not in after]) == len(values)
    changed, expected = loads(new), ck.with_dimensions(loads(text), values)
    one, other = (ck.solve(m, _shown(reading_of(text)).values, order=0) for m in (changed, expected))
    for letter in one.points:
        np.testing.assert_allclose(one.points[letter].position, other.points[letter].position, atol=1e-9 * one.size)


def test_a_branch_that_is_chosen_is_drawn_in_its_middle() -> None:
    """A triple rocker's two branches: the driver is taken to the middle of the range, and the loop is closed there."""
    text = answer("", {"ask": "open", "name": "four-bar:70,40,50,30"})["text"]
    branches = answer(text, {"ask": "circuits"})["branches"]
    assert [one["is_shown"] for one in branches].count(True) == 1
    for one in branches:
        found = answer(text, {"ask": "edit", "edit": {"do": "branch", "number": one["number"]}})
        again = answer(found["text"], {"ask": "circuits"})["branches"]
        assert [two["is_shown"] for two in again] == [two["number"] == one["number"] for two in branches]
        driver = answer(text, {"ask": "motion"})["drives"]["crank"]["values"][found["made"]["pose"]]
        assert (driver - sum(one["range"]) / 2 + 180) % 360 - 180 == pytest.approx(0, abs=3)
    refused = answer(text, {"ask": "edit", "edit": {"do": "branch", "number": 99}})
    assert "no such branch" in refused["problems"][0]["what"]


def test_forces_are_those_of_the_analysis() -> None:
    """At each pose, to the digits of the canvas; where nothing acts, it is said how something can."""
    text = shipped_text("toggle-press-loaded")
    shown = answer(text, {"ask": "overlays"})["forces"]
    motion = ck.solve(loads(text), _shown(reading_of(text)).values)
    analysed = ck.force_analysis(motion)
    known = {one["words"]: one for one in shown["arrows"]}
    x, y = np.array(known["pair O on crank by frame"]["force"], float) * shown["greatest"]
    sign = 1 if analysed.pairs["O"].pair.members[1] == "crank" else -1
    np.testing.assert_allclose(x + 1j * y, sign * np.ravel(analysed.pairs["O"].force), atol=1e-5 * shown["greatest"])
    load = np.hypot(*np.array(known["force work on slider"]["force"], float)) * shown["greatest"]
    (own,) = (one for one in analysed.on("slider").entries if one.kind == "force")
    assert load.max() == pytest.approx(np.abs(own.force).max(), rel=1e-5)
    found = reply(text, "forces")
    assert (len(found["pictures"]), "crank" in found["html"]) == (2, True)
    assert "crank.effort" in answer(text, {"ask": "results"})["quantities"]
    assert "nothing acts" in answer(shipped_text("six-bar"), {"ask": "forces"})["problems"][0]["what"]


@pytest.mark.parametrize(
    ("name", "lift", "is_angle"),
    [("disc-cam-roller-program", 30.0, False), ("oscillating-roller-follower", 25.0, True)],
)
def test_the_lift_of_a_law_is_a_dimension(name: str, lift: float, is_angle: bool) -> None:
    """All rises and returns grow in one ratio, so that the follower comes back to where it was."""
    text = shipped_text(name)
    (found,) = (one for one in reply(text, "dimensions")["counts"] if one["told"].startswith("lift"))
    assert (found["value"], found["is_angle"]) == (lift, is_angle)
    changed = edited(text, {"do": "count", "pair": found["pair"], "entry": found["entry"], "value": 12.3})
    (again,) = (one for one in reply(changed, "dimensions")["counts"] if one["told"].startswith("lift"))
    assert again["value"] == pytest.approx(12.3)
    motion = ck.solve(loads(changed), order=0)
    link = motion.links["follower"]
    course = np.rad2deg(link.angle) if is_angle else link.origin.position.imag
    assert np.ptp(course) == pytest.approx(12.3, abs=1e-6)
    assert course[-1] == pytest.approx(course[0], abs=1e-6)


def test_teeth_and_radii_of_profiles_are_changed_in_the_text() -> None:
    """The ratio, the lift of the follower are then those of the other number; what is wrong is refused."""
    bars = [{"do": "bar", "from": {"at": [x, 0]}, "to": {"at": [x, 20]}} for x in (0, 100)]
    grounds = [{"do": "ground", "point": one} for one in "AC"]
    gears = {"do": "gear", "point": "A", "with": "C", "teeth": [20, 40], "first": "bar1", "second": "bar2"}
    text = edited(START, *bars, *grounds, gears, {"do": "driver", "point": "A"})
    (_, count) = reply(text, "dimensions")["counts"]
    assert (count["told"], count["value"], count["is_whole"]) == ("teeth of bar2", 40, True)
    edit = {"do": "count", "pair": count["pair"], "entry": count["entry"]}
    motion = ck.solve(loads(edited(text, {**edit, "value": 50})), {"bar1": [0.0, 0.5]}, order=0)
    assert np.diff(np.ravel(motion.links["bar2"].angle)) == pytest.approx([-0.5 * 20 / 50])
    assert "teeth cannot be" in answer(text, {"ask": "edit", "edit": {**edit, "value": 3.5}})["problems"][0]["what"]
    for wrong in ({"pair": "x"}, {"entry": ["teeth", 2]}, {"entry": ["first", 0]}):
        assert (
            "no such number"
            in answer(text, {"ask": "edit", "edit": {**edit, "value": 3, **wrong}})["problems"][0]["what"]
        )
    for entry in (["teeth", 1.0], ["teeth", [1]], [["teeth"], 1], ["teeth"], "teeth"):
        reason = answer(text, {"ask": "edit", "edit": {**edit, "value": 3, "entry": entry}})["problems"][0]["what"]
        assert "is no entry of a table" in reason
    cam = shipped_text("disc-cam-offset-roller")
    (radius,) = reply(cam, "dimensions")["counts"]
    changed = edited(cam, {"do": "count", "pair": radius["pair"], "entry": radius["entry"], "value": 40})
    before, after = (ck.solve(loads(one), order=0).points["P"].position for one in (cam, changed))
    # the roller's middle goes as a rod of 38 and 48 would lead it
    crank = 12 * np.exp(1j * np.deg2rad(np.arange(0, 361, 5)))
    for rod, found in ((38, before), (48, after)):
        np.testing.assert_allclose(np.abs(np.ravel(found) - crank), rod, atol=1e-6)
