"""What the studio replies: a mechanism drawn edit by edit, documents that are none yet, what edits keep and refuse."""

from __future__ import annotations

import random
import re
import time
import tomllib
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.files.mechanism_files import loads
from compoundkin.files.shipped_mechanisms import resolve, shipped
from compoundkin.structure.decomposition import decomposed
from compoundkin.studio import answer, reading
from compoundkin.studio.edits import EDITS

pytestmark = pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")

START = '# drawn by hand\nformat = 1\ntitle = "Drawn"  # called so\n'
FOUR_BAR = (
    {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [10, 20]}},
    {"do": "bar", "from": {"point": "B"}, "to": {"at": [60, 30]}},
    {"do": "bar", "from": {"point": "C"}, "to": {"at": [50, 0]}},
    {"do": "ground", "point": "A"},
    {"do": "ground", "point": "D"},
    {"do": "driver", "point": "A"},
)


def edited(text: str, *edits: dict[str, Any], **how: Any) -> str:
    """The text after edits, none of which is refused."""
    for edit in edits:
        reply = answer(text, {"ask": "edit", "edit": edit, **how})
        assert reply["problems"] == [], (edit, reply["problems"])
        text = reply["text"]
    return text


def refused(text: str, **edit: Any) -> str:
    """Why an edit is refused; the text stays."""
    reply = answer(text, {"ask": "edit", "edit": edit})
    assert reply["text"] == text
    (problem,) = reply["problems"]
    return str(problem["what"])


def structure(text: str) -> dict[str, Any]:
    return answer(text, {"ask": "structure"})


def shipped_text(name: str) -> str:
    return resolve(name).read_text(encoding="utf-8")


def test_a_four_bar_drawn_from_nothing_is_the_one_written_by_hand() -> None:
    text = edited(START, *FOUR_BAR)
    by_hand = ck.Mechanism(
        "By hand",
        ck.link("frame", A=(0, 0), D=(50, 0)),
        ck.link("crank", A=0, B=np.hypot(10, 20)),
        ck.link("coupler", B=0, C=np.hypot(50, 10)),
        ck.link("rocker", D=0, C=np.hypot(10, 30)),
        ck.drive("crank"),
        ck.drawn(B=(10, 20), C=(60, 30)),
    )
    drawn, other = ck.solve(loads(text)), ck.solve(by_hand)
    for letter in "ABCD":
        np.testing.assert_allclose(drawn.points[letter].position, other.points[letter].position, atol=1e-9)
    reply = structure(text)
    assert reply["mobility"] == {"freedoms": 1, "sum": "F = 3·3 − 2·4 = 1"}
    assert [group["name"] for group in reply["groups"]] == ["RRR"]
    assert (reply["faults"], reply["problems"], reply["moves"]) == ([], [], True)
    assert text.startswith(START)


def test_the_six_bar_of_the_textbook_drawn_in_its_first_pose() -> None:
    """Its slot is a block that slides along the swinging bar: numbers are those of the published example."""
    known = ck.solve(ck.load("six-bar"), {"crank": [0.0]})
    at = {k: [known.points[k].position[0].real, known.points[k].position[0].imag] for k in known.points}
    text = edited(
        START,
        {"do": "bar", "from": {"at": at["E"]}, "to": {"at": at["D"]}},  # A, B: the crank
        {"do": "bar", "from": {"point": "B"}, "to": {"at": at["A"]}},  # C: the plate
        {"do": "point", "link": "bar2", "at": at["C"]},  # D: its third point
        {"do": "bar", "from": {"point": "C"}, "to": {"at": at["B"]}},  # E: the rocker
        {"do": "bar", "from": {"at": at["F"]}, "to": {"at": at["G"]}},  # F, G: the bar
        *({"do": "ground", "point": letter} for letter in "AEF"),
        {"do": "slide", "point": "D", "on": "bar4"},
        {"do": "driver", "point": "A"},
    )
    motion, whole = ck.solve(loads(text), speed=10), ck.solve(ck.load("six-bar"), ck.deg(range(0, 361, 5)), speed=10)
    # as drawn the direction of the crank is that of its points, as in the file; places are written with seven digits
    for drawn, own in {"B": "D", "C": "A", "D": "C", "G": "G"}.items():
        np.testing.assert_allclose(motion.points[drawn].position, whole.points[own].position, atol=2e-4)
    reply = structure(text)
    assert reply["mobility"]["sum"] == "F = 3·5 − 2·7 = 1"
    assert [group["name"] for group in reply["groups"]] == ["RRR", "RPR"]


def test_poses_are_those_of_the_solver_and_what_does_not_assemble_is_explained() -> None:
    text = edited(START, *FOUR_BAR[:5], {"do": "driver", "point": "D"})
    reply, motion = answer(text, {"ask": "motion"}), ck.solve(loads(text), ck.deg(range(361)))
    x, y = (np.array(part, float) for part in reply["points"]["B"])
    np.testing.assert_allclose(x + 1j * y, motion.points["B"].position, atol=1e-4)
    np.testing.assert_array_equal(np.array(reply["assembled"]) == 1, motion.assembled)
    assert 0 < sum(reply["assembled"]) < 361
    assert all("|" in gap["why"] for gap in reply["gaps"])
    near = [reply["points"]["B"][k][reply["start"]] for k in (0, 1)]
    assert near == pytest.approx([10, 20], abs=0.5)


@pytest.mark.parametrize(
    ("edits", "freedoms", "said"),
    [
        ((), 0, "there is no link"),
        (FOUR_BAR[:1], 3, "there is no frame"),
        (FOUR_BAR[:3], 5, "there is no frame"),
        (FOUR_BAR[:4], 3, "left with 3 freedoms"),
        (FOUR_BAR[:5], 1, "left with 1 freedom"),
        ((*FOUR_BAR, {"do": "driver", "point": "D"}), 1, "1 constraint too many"),
        ((*FOUR_BAR, {"do": "bar", "from": {"at": [80, 0]}, "to": {"at": [90, 9]}}), 1, "bar4 is loose"),
    ],
)
def test_what_is_no_mechanism_yet_is_shown_as_far_as_it_goes(edits: Any, freedoms: int, said: str) -> None:
    text = edited(START, *edits)
    reply = structure(text)
    assert reply["mobility"]["freedoms"] == freedoms
    assert any(said in fault["what"] for fault in reply["faults"])
    assert all(fault["remedy"] for fault in reply["faults"])
    assert reply["problems"] == []
    assert len(reply["points"]) == len(tomllib.loads(text).get("drawn", {}))


def test_remedies_mend() -> None:
    """Pressing the first button again and again ends in a mechanism that moves."""
    text = edited(START, *FOUR_BAR[:3], {"do": "ground", "point": "D"})
    for _ in range(6):
        fixes = [fix for fault in structure(text)["faults"] for fix in fault["fixes"]]
        if not fixes:
            break
        text = edited(text, fixes[0]["edit"])
    assert structure(text)["moves"]
    assert sum(answer(text, {"ask": "motion"})["assembled"]) > 70


def test_too_many_and_wrong_drivers_are_set_aside_by_name() -> None:
    text = edited(START, *FOUR_BAR) + '[[drives]]\nlink = "bar1"\n[[drives]]\nlink = "bar9"\n'
    reply = structure(text)
    assert [fault["where"] for fault in reply["faults"]] == ["bar1", "bar9"]
    assert reply["moves"]
    assert edited(text, reply["faults"][1]["fixes"][0]["edit"]) == text.replace('[[drives]]\nlink = "bar9"\n', "")


def test_links_that_are_held_too_often_are_told_by_kind() -> None:
    (fault,) = structure(edited(START, *FOUR_BAR, {"do": "driver", "point": "D"}))["faults"]
    assert (fault["kind"], set(fault["links"])) == ("over", {"bar1", "bar2", "bar3"})
    (fault,) = structure(edited(START, *FOUR_BAR[:5]))["faults"]
    assert fault["kind"] == "under"


def test_wrong_parts_are_named_at_their_places_and_the_rest_is_shown() -> None:
    text = edited(START, *FOUR_BAR) + '[[expected]]\nat = { bar1 = 0 }\nquantity = "Z.x"\nvalue = 1\ntolerance = 1\n'
    reply = structure("colour = 3\n" + text)
    assert {problem["where"] for problem in reply["problems"]} == {"colour", "expected[0].quantity"}
    assert reply["moves"]
    (problem,) = structure(text.replace("[drawn]", "[drawn"))["problems"]
    assert re.match(r"line \d+, column \d+", problem["where"])


def test_a_point_moves_where_it_is_put() -> None:
    """With coordinates it is the dimensions of its links that change; the solver then has it there."""
    text = shipped_text("six-bar")
    moved = edited(text, {"do": "move", "point": "A", "to": [40, -29]})
    assert structure(moved)["points"]["A"] == pytest.approx([40, -29], abs=1e-4)
    before, after = tomllib.loads(text)["links"], tomllib.loads(moved)["links"]
    assert [name for name in before if before[name] != after[name]] == ["plate", "rocker"]
    assert tomllib.loads(moved)["drawn"]["A"] == [40, -29]
    drawn = edited(START, *FOUR_BAR)
    assert edited(drawn, {"do": "move", "point": "B", "to": [11, 21.5]}) == drawn.replace("[10, 20]", "[11, 21.5]")


def test_a_polar_point_stays_polar() -> None:
    moved = edited(shipped_text("six-bar"), {"do": "move", "point": "C", "to": [29, -2]})
    assert "polar" in tomllib.loads(moved)["links"]["plate"]["points"]["C"]


def test_at_another_pose_the_drawing_becomes_that_pose() -> None:
    text = edited(START, *FOUR_BAR)
    motion = answer(text, {"ask": "motion"})
    moved = edited(text, {"do": "move", "point": "C", "to": [40, 45]}, pose=120)
    drawn = tomllib.loads(moved)["drawn"]
    assert drawn["B"] == pytest.approx([motion["points"]["B"][k][120] for k in (0, 1)], abs=1e-4)
    assert drawn["C"] == [40, 45]


def test_bars_join_tear_and_slide_in_a_file_with_coordinates() -> None:
    text = edited(
        shipped_text("crank-rocker"),
        {"do": "point", "link": "coupler", "at": [2, 3]},
        {"do": "bar", "from": {"point": "E"}, "to": {"at": [7, 3]}},
        {"do": "slide", "point": "F", "angle": 30},
    )
    reply = structure(text)
    assert reply["mobility"]["freedoms"] == 1
    assert reply["moves"]
    assert reply["points"]["E"] == pytest.approx([2, 3], abs=1e-5)
    assert reply["points"]["F"] == pytest.approx([7, 3], abs=1e-5)
    assert answer(text, {"ask": "motion"})["points"]["F"][0].count(None) < 361


def test_a_pin_is_torn_off_and_joined_again() -> None:
    text = edited(START, *FOUR_BAR)
    torn = edited(text, {"do": "tear", "point": "C", "link": "bar3", "to": [70, 40]})
    assert structure(torn)["mobility"]["freedoms"] == 3
    joined = edited(torn, {"do": "join", "point": "E", "with": "C"})
    assert tomllib.loads(joined) == tomllib.loads(text)


def test_a_driven_slide_has_values_around_where_it_is_drawn() -> None:
    text = edited(
        START,
        {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [30, 40]}},
        {"do": "bar", "from": {"point": "B"}, "to": {"at": [90, 0]}},
        {"do": "ground", "point": "A"},
        {"do": "slide", "point": "C"},
        {"do": "driver", "point": "C"},
    )
    reply = answer(text, {"ask": "motion"})
    values = reply["drives"]["block1"]["values"]
    assert min(values) < 0 < max(values)
    assert sum(reply["assembled"]) > 100


def test_reasons_of_refusals_and_unknown_names() -> None:
    text = edited(START, *FOUR_BAR)
    assert "of no length" in refused(text, do="join", point="A", **{"with": "B"})
    assert "bar1 has A and B already" in refused(text, do="bar", **{"from": {"point": "A"}, "to": {"point": "B"}})
    assert "driven already" in refused(text, do="driver", point="A")
    assert "no such point" in refused(text, do="move", point="Z", to=[1, 2])
    assert "no place" in refused(text, do="move", point="A", to=["x", 2])
    assert "no edit" in refused(text, do="dance", point="A")
    assert answer(text, {"ask": "what"})["problems"]
    assert answer("x" * 300_000, {"ask": "structure"})["problems"]


@pytest.mark.parametrize("name", ["six-bar", "jansen-leg", "toggle-press-loaded", "watt-ii", "hydraulic-digger"])
def test_deleting_a_link_takes_what_is_written_of_it_and_nothing_else(name: str) -> None:
    """Held against `Mechanism.without`; blocks that only slid on it go too."""
    mechanism, text = ck.load(name), shipped_text(name)
    blocks = {pair.members[1]: pair.members[0] for pair in mechanism.written_pairs if pair.code == "P"}
    for link in tomllib.loads(text)["links"]:
        if link == "frame":
            continue
        gone = [link, *(b for b, on in blocks.items() if on == link and len(mechanism.links[b].points) == 1)]
        left = tomllib.loads(edited(text, {"do": "delete", "link": link}))["links"]
        assert set(left) - {"frame"} == {k for k in tomllib.loads(text)["links"] if k not in gone} - {"frame"}
        assert all(left[k] == tomllib.loads(text)["links"][k] for k in left if k != "frame")
        try:
            expected = mechanism.without(*gone)
        except (ck.errors.InvalidMechanism, ck.errors.UnknownName):
            continue
        assert set(loads(edited(text, {"do": "delete", "link": link})).links) == set(expected.links)


def test_deleting_a_slide_takes_its_block_and_its_guide() -> None:
    text = edited(START, *FOUR_BAR, {"do": "bar", "from": {"point": "C"}, "to": {"at": [99, 9]}})
    slid = edited(text, {"do": "slide", "point": "E"})
    assert edited(slid, {"do": "delete", "pair": "block1/frame"}) == text
    assert edited(slid, {"do": "delete", "link": "block1"}) == text


def test_a_link_is_called_otherwise_everywhere() -> None:
    text = edited(shipped_text("six-bar"), {"do": "call", "link": "crank", "name": "arm"})
    assert "crank" not in re.sub(r'description = ".*"', "", text)
    assert ck.solve(loads(text), {"arm": [0.0]}).points["G"].position[0] == pytest.approx(
        ck.solve(ck.load("six-bar"), {"crank": [0.0]}).points["G"].position[0]
    )


def some_edit(dice: random.Random, reply: dict[str, Any]) -> dict[str, Any]:
    """An edit at random, most of them of what there is."""
    points, links = [*reply["points"], "Z"], [*(one["name"] for one in reply["links"]), "nobody"]

    def end() -> dict[str, Any]:
        here = [dice.uniform(-90, 90), dice.uniform(-90, 90)]
        known = [{"point": dice.choice(points)}, {"link": dice.choice(links), "at": here}]
        return dice.choice([{"at": here}, {"at": here}, *known])

    names = [*(one["name"] for one in reply["pairs"]), *(one["name"] for one in reply["drives"]), "none"]
    return {
        "do": dice.choice([*sorted(EDITS), *["bar"] * 12, "ground", "join", "cylinder"]),
        "from": end(), "to": dice.choice([end(), end(), [3, 4]]),
        "point": dice.choice(points), "with": dice.choice(points), "link": dice.choice(links), "at": [5, 6],
        **dice.choice([{}, {"on": dice.choice(links)}, {"pair": dice.choice(names)}, {"drive": dice.choice(names)}]),
        "name": f"other{dice.randrange(9)}", "angle": dice.choice([30, "x"]), "length": dice.choice([9, -1, None]),
        "teeth": dice.choice([[20, 40], [3]]), "radius": 40, "roller": 5, "rise": 9, "over": 90, "dwell": 0, "back": 90,
        "points": {dice.choice(points): [7, 8]},
        "locks": [{"what": dice.choice(["length", "point"]), "points": points[:2]}],
        "edits": [{"do": "ground", "point": dice.choice(points)}],
        "radii": [20, 5], "entry": dice.choice([["teeth", 0], ["profile", "base"], [1]]), "value": 7,
    }  # fmt: skip


@pytest.mark.parametrize("name", ["", "crank-rocker", "disc-cam-offset-roller", "toggle-press-loaded"])
def test_random_edits_never_raise_and_keep_every_comment_and_unknown_key(name: str) -> None:
    text = (shipped_text(name) if name else START).replace("format = 1", "format = 1  # kept\nunknown = 7", 1)
    dice, made = random.Random(f"edits {name}"), 0
    for _ in range(17 if name else 40):
        reply = structure(text)
        edit = some_edit(dice, reply)
        pose = dice.choice([None, 3])
        after = answer(text, {"ask": "edit", "edit": edit, "pose": pose})
        made += after["text"] != text
        text = after["text"]
        assert tomllib.loads(text)["unknown"] == 7
        assert "# kept" in text
    assert made > 3
    answer(text, {"ask": "motion"})


@pytest.mark.parametrize("name", ["six-bar", "jansen-leg", "hydraulic-digger", "v8-engine", "groove-cam-plate"])
def test_shipped_mechanisms_have_all_points_and_groups(name: str) -> None:
    mechanism, reply = ck.load(name), structure(shipped_text(name))
    assert name in shipped()
    assert set(reply["points"]) == {k for n in mechanism.rigid_links for k in mechanism.links[n].points}
    assert [one["name"] for one in reply["groups"]] == [group.name for group in ck.decompose(mechanism).groups]
    assert (reply["faults"], reply["problems"]) == ([], [])


def test_structure_of_a_six_bar_is_replied_within_its_time() -> None:
    """30 ms are asked for; the bound is thrice that, for machines that do other things too."""
    text = shipped_text("six-bar")
    structure(text)
    start = time.process_time()
    structure(text)
    assert time.process_time() - start < 0.09


# A cam that leads a follower which another one leads, held by a bar: once too often, and nothing of it is drawn.
HELD_BY_CAMS = """
[[cams]]
link = "follower"
on = "other"
at = "T"
radius = 5
[cams.profile]
kind = "made"
program = [{ law = "cycloidal", over = 180, rise = 20 }, { law = "cycloidal", over = 180, rise = -20 }]
base = 40
follower = "roller"
roller = 5
angle = 90
offset = 12
[links.held]
points = { C = [0, 0], D = [65, 0] }
"""


def test_what_cams_hold_too_often_is_replied_near_its_drawing() -> None:
    """Random starts take seconds: they are the motion's. Bounds are thrice what was measured."""
    text = shipped_text("disc-cam-offset-roller").replace("{ A = [0, 0]", "{ A = [0, 0], D = [0, 76], Q = [12, 0]", 1)
    text = text.replace("[[slides]]", "[links.other]\npoints = { Q = [0, 0], C = [-60, 51] }\n\n[[slides]]", 1)
    text += HELD_BY_CAMS
    structure(text)
    start = time.process_time()
    found = structure(text)
    assert time.process_time() - start < 0.6
    assert [one["kind"] for one in found["faults"]] == ["over"], found
    assert (found["moves"], found["may_move"]) == (False, True)


def test_what_moves_only_far_from_its_drawing_is_told_with_its_motion(monkeypatch: pytest.MonkeyPatch) -> None:
    """Near its drawing nothing is found: the structure says so, the motion says more."""
    text = shipped_text("constant-breadth-yoke")
    expected = structure(text)
    assert (expected["moves"], expected["may_move"]) == (True, False)
    monkeypatch.setattr(reading, "decompose_near_drawing", decomposed)
    reading.reading_of.cache_clear()
    found = structure(text)
    assert (found["moves"], found["may_move"]) == (False, True)
    reply = answer(text, {"ask": "motion"})
    assert reply["poses"] == 361
    assert {"ask": "structure", **reply["structure"]} == expected
    reading.reading_of.cache_clear()


def test_a_document_in_json_stays_one() -> None:
    text = edited('{"format": 1, "title": "m"}', *FOUR_BAR)
    assert loads(text, "json").pins["B"] == ("bar1", "bar2")


def test_a_drawing_gets_a_unit_and_loses_it_again() -> None:
    text = edited(START, *FOUR_BAR)
    for unit in structure(text)["units"]:
        assert structure(edited(text, {"do": "unit", "unit": unit}))["unit"] == unit
    inches = edited(text, {"do": "unit", "unit": "in"})
    assert (loads(inches).unit, structure(inches)["unit"]) == ("in", "in")
    assert lengths(inches) == lengths(text)
    assert edited(inches, {"do": "unit", "unit": ""}) == text
    assert "no unit of length" in refused(text, do="unit", unit="parsec")
    assert "masses and forces" in refused(shipped_text("andrews-squeezer-dynamics"), do="unit", unit="cm")


CRANE = (
    {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [100, 60]}},
    {"do": "ground", "point": "A"},
    {"do": "point", "link": "bar1", "at": [50, 30]},
    {"do": "cylinder", "from": {"at": [60, -40]}, "to": {"point": "C"}},
    {"do": "driver", "cylinder": "cylinder1"},
)


def test_a_crane_with_a_cylinder_is_the_one_written_by_hand() -> None:
    text = edited(START, *CRANE)
    by_hand = ck.Mechanism(
        "By hand",
        ck.link("frame", A=0, D=60 - 40j),
        ck.link("jib", A=0, C=abs(50 + 30j), B=abs(100 + 60j)),
        ck.cylinder("jib", "C", at="D", name="ram"),
        ck.drive("ram"),
        ck.drawn(C=50 + 30j),
    )
    motion = ck.solve(loads(text))
    values = motion.drives["cylinder1"].value
    whole = ck.solve(by_hand, {"ram": values})
    np.testing.assert_allclose(motion.points["B"].position, whole.points["B"].position, atol=1e-9)
    assert min(values) < abs(10 - 70j) < max(values)
    gone = edited(text, {"do": "delete", "pair": "cylinder1"})
    assert "drives" not in tomllib.loads(gone)
    assert "cylinders" not in tomllib.loads(gone)


def test_two_drivers_go_together_through_their_ranges() -> None:
    """A pin that turns fully, and a cylinder that has lengths: each as finely as it is shown."""
    arm = {"do": "bar", "from": {"point": "B"}, "to": {"at": [150, 20]}}
    text = edited(START, *CRANE[:4], arm, {"do": "driver", "cylinder": "cylinder1"}, {"do": "driver", "point": "B"})
    assert structure(text)["faults"] == []
    reply = answer(text, {"ask": "motion"})
    assert (reply["poses"], sum(reply["assembled"])) == (361, 361)


def test_gears_on_fixed_points_turn_as_their_teeth() -> None:
    text = edited(
        START,
        {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [0, 10]}},
        {"do": "bar", "from": {"at": [30, 0]}, "to": {"at": [40, 0]}},
        *({"do": "ground", "point": letter} for letter in "AC"),
        {"do": "gear", "point": "A", "with": "C", "teeth": [20, 40], "first": "bar1", "second": "bar2"},
        {"do": "driver", "point": "A"},
    )
    motion = ck.solve(loads(text), ck.deg(range(0, 361, 30)))
    np.testing.assert_allclose(np.diff(motion.links["bar2"].angle), -np.deg2rad(15), atol=1e-9)
    (pair,) = structure(text)["pairs"]
    assert [shape["radius"] for shape in pair["shapes"]] == pytest.approx([10, 20])
    assert "are joined so already" in refused(
        text, do="gear", point="A", **{"with": "C"}, teeth=[1, 2], first="bar1", second="bar2"
    )
    assert "no numbers of teeth" in refused(text, do="gear", point="A", **{"with": "C"}, teeth=[1.5, 2])


LIFT = {"radius": 40, "roller": 10, "rise": 30, "over": 120, "dwell": 60, "back": 120}


def test_a_belt_turns_its_pulleys_as_their_radii() -> None:
    """Open the same way round, crossed the other."""
    bars = (
        {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [20, 10]}},
        {"do": "bar", "from": {"at": [100, 0]}, "to": {"at": [110, 30]}},
        {"do": "ground", "point": "A"},
        {"do": "ground", "point": "C"},
    )
    belt = {"do": "belt", "point": "A", "with": "C", "radii": [20, 40], "first": "bar1", "second": "bar2"}
    for crossed, sign in ((False, 1), (True, -1)):
        text = edited(START, *bars, {**belt, "crossed": crossed}, {"do": "driver", "point": "A"})
        motion = ck.solve(loads(text), {"bar1": [0.2, 0.6]}, order=0)
        assert np.diff(np.ravel(motion.links["bar2"].angle)) == pytest.approx([0.4 * sign * 20 / 40])
    on = edited(START, *bars)
    assert "lie in each other" in refused(on, **{**belt, "radii": [20, 140]})
    assert "has a radius" in refused(on, **{**belt, "radii": [0, 40]})
    assert "are joined so already" in refused(edited(on, belt), **belt)


def test_a_pinion_pulls_its_rack_by_its_radius() -> None:
    """The rack goes along its guide as far as the pinion rolls."""
    text = edited(
        START,
        {"do": "bar", "from": {"at": [0, 30]}, "to": {"at": [40, 60]}},
        {"do": "ground", "point": "A"},
        {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [60, -40]}},
        {"do": "bar", "from": {"point": "D"}, "to": {"at": [120, 0]}},
        {"do": "ground", "point": "E"},
    )
    rack = {"do": "rack", "point": "A", "with": "C", "pinion": "bar1"}
    assert "does not slide on the frame" in refused(text, **rack)
    text = edited(text, {"do": "slide", "point": "C", "angle": 20}, rack, {"do": "driver", "point": "A"})
    radius = 30 * np.cos(np.deg2rad(20))
    motion = ck.solve(loads(text), {"bar1": np.deg2rad([30, 35, 40])}, order=0)
    gone = np.diff(np.ravel(motion.points["C"].position))
    np.testing.assert_allclose(gone, np.deg2rad(5) * radius * np.exp(1j * np.deg2rad(20)), rtol=1e-5)
    assert "is on the guide" in refused(
        edited(text, {"do": "delete", "pair": "block1/bar1"}, {"do": "move", "point": "A", "to": [0, 0]}), **rack
    )


def test_a_cam_lifts_a_slide_and_swings_a_bar_by_its_program() -> None:
    slid = edited(
        START,
        {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [9, 0]}},
        {"do": "ground", "point": "A"},
        {"do": "bar", "from": {"at": [12, 52]}, "to": {"at": [12, 80]}},
        {"do": "slide", "point": "C", "angle": 90},
        {"do": "delete", "link": "bar2"},
        {"do": "cam", "point": "A", "with": "C", **LIFT},
        {"do": "driver", "point": "A", "link": "cam1"},
        {"do": "delete", "link": "bar1"},
    )
    assert structure(slid)["faults"] == []
    heights = ck.solve(loads(slid), ck.deg([0, 60, 150, 350])).points["C"].position.imag
    np.testing.assert_allclose(heights - heights[0], [0, 15, 30, 0], atol=1e-6)
    swung = edited(
        START,
        {"do": "bar", "from": {"at": [90, 0]}, "to": {"at": [0, 50]}},
        {"do": "ground", "point": "A"},
        {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [9, 0]}},
        {"do": "ground", "point": "C"},
        {"do": "cam", "point": "C", "with": "B", **LIFT, "rise": 20},
        {"do": "driver", "point": "C", "link": "cam1"},
        {"do": "delete", "link": "bar2"},
    )
    assert structure(swung)["faults"] == []
    angles = ck.solve(loads(swung), ck.deg([0, 150, 350])).links["bar1"].angle
    np.testing.assert_allclose(np.abs(np.rad2deg(angles - angles[0])), [0, 20, 0], atol=1e-6)


def lengths(text: str) -> dict[str, float]:
    at = {k: complex(*p) for k, p in structure(text)["points"].items()}
    return {
        f"{name}.{a}{b}": abs(at[a] - at[b])
        for name, table in tomllib.loads(text)["links"].items()
        for a in table["points"]
        for b in table["points"]
        if a < b
    }


@pytest.mark.parametrize("source", ["drawn", "crank-rocker", "six-bar"])
def test_one_link_is_lengthened_and_no_other(source: str) -> None:
    text = edited(START, *FOUR_BAR) if source == "drawn" else shipped_text(source)
    link, letter = ("bar1", "B") if source == "drawn" else ("crank", "D" if source == "six-bar" else "B")
    before = lengths(text)
    name = next(k for k in before if k.startswith(f"{link}."))
    after = lengths(edited(text, {"do": "lengthen", "link": link, "point": letter, "length": 1.03 * before[name]}))
    assert after[name] == pytest.approx(1.03 * before[name], rel=1e-5)
    assert {k: v for k, v in after.items() if k != name} == pytest.approx(
        {k: v for k, v in before.items() if k != name}, rel=1e-5
    )
    assert "do not reach" in refused(text, do="lengthen", link=link, point=letter, length=90 * before[name])


def test_what_is_locked_is_held_while_points_move() -> None:
    text = edited(START, *FOUR_BAR)
    locks = [
        {"what": "length", "points": ["B", "C"]},
        {"what": "angle", "points": ["D", "C"]},
        {"what": "point", "points": ["D"]},
    ]
    moved = edited(text, {"do": "move", "point": "B", "to": [12, 24], "locks": locks})
    at = {k: complex(*p) for k, p in tomllib.loads(moved)["drawn"].items()}
    assert abs(at["B"] - at["C"]) == pytest.approx(abs(50 + 10j), abs=1e-5)
    assert np.angle(at["C"] - at["D"]) == pytest.approx(np.angle(10 + 30j), abs=1e-6)
    assert (at["A"], at["D"]) == (0, 50)
    assert at["B"] == pytest.approx(12 + 24j, abs=0.05)
    both = [{"what": "point", "points": ["B"]}, {"what": "length", "points": ["B", "C"]}]
    edited(text, {"do": "move", "point": "C", "to": [60, 40], "locks": both})
    fixed = [{"what": "point", "points": ["A"]}, *locks]
    moved = edited(text, {"do": "move", "points": {"B": [11, 21], "C": [61, 31]}, "locks": fixed})
    assert lengths(moved)["bar2.BC"] == pytest.approx(abs(50 + 10j), abs=1e-5)


def test_two_bars_are_welded_and_what_led_between_them_goes() -> None:
    text = edited(
        START,
        *FOUR_BAR,
        {"do": "bar", "from": {"point": "C"}, "to": {"at": [80, 60]}},
        {"do": "driver", "point": "C", "link": "bar4", "on": "bar2"},
    )
    welded = tomllib.loads(edited(text, {"do": "weld", "point": "C", "link": "bar2", "with": "bar4"}))
    assert welded["links"]["bar2"]["points"] == ["B", "C", "E"]
    assert [drive["link"] for drive in welded["drives"]] == ["bar1"]
    own = edited(shipped_text("crank-rocker"), {"do": "weld", "point": "C"})
    assert structure(own)["mobility"]["freedoms"] == 0


def test_several_edits_are_one_or_none() -> None:
    text = edited(START, *FOUR_BAR)
    many = [{"do": "delete", "point": "A"}, {"do": "delete", "link": "bar1"}, {"do": "delete", "link": "bar2"}]
    assert set(tomllib.loads(edited(text, {"do": "all", "edits": many}))["links"]) == {"frame", "bar3"}
    assert "no such point" in refused(
        text, do="all", edits=[{"do": "delete", "point": "A"}, {"do": "ground", "point": "Z"}]
    )


def test_what_may_be_done_is_told_with_its_reasons() -> None:
    text = edited(START, *FOUR_BAR)
    edits = [{"do": "driver", "point": "A"}, {"do": "slide", "point": "C"}, {"do": "weld", "point": "Z"}]
    why = answer(text, {"ask": "offers", "edits": edits})["why"]
    assert (why[1], "driven already" in why[0], "no such point" in why[2]) == ("", True, True)


def test_a_slide_turns_and_follows_its_point() -> None:
    text = edited(
        START,
        {"do": "bar", "from": {"at": [0, 0]}, "to": {"at": [30, 40]}},
        {"do": "slide", "point": "B"},
        {"do": "turn", "pair": "block1/frame", "angle": 30},
        {"do": "move", "point": "B", "to": [30, 44]},
    )
    assert tomllib.loads(text)["slides"][0]["angle"] == 30
    at = {k: complex(*p) for k, p in tomllib.loads(text)["drawn"].items()}
    assert np.angle(at["B"] - at["C"]) % np.pi == pytest.approx(np.deg2rad(30), abs=1e-5)
