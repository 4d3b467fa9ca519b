"""pylinkage: its files and objects are read, and what is written for it, it loads and steps to the same positions."""

from __future__ import annotations

import json
import math
import sys
import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import InvalidInput
from compoundkin.files.exchange.content import Content
from compoundkin.files.exchange.contract import Imported
from compoundkin.files.exchange.drawing import drawing_of
from compoundkin.files.exchange.foreign_texts import legal
from compoundkin.files.exchange.posed_mechanism import PosedMechanism, posed_mechanism
from compoundkin.files.exchange.pylinkage_format import FORMAT, from_pylinkage
from tests.catalog import mechanism as loaded
from tests.files.exchange.pages import prints_what_it_shows
from tests.files.exchange.references import entries, entry, letter_at

numba = sys.modules.get("numba")
sys.modules["numba"] = None  # type: ignore[assignment]  # without it pylinkage computes the same, and is loaded soon
pl = pytest.importorskip("pylinkage.mechanism")
if numba is None:
    del sys.modules["numba"]
else:
    sys.modules["numba"] = numba

# Positions as its samples print them.
PRINTED = 1e-11


def read(text: str) -> Imported:
    content = Content(text.encode())
    assert FORMAT.recognises(content)
    return FORMAT.read(content)


def ours(shown: PosedMechanism, count: int) -> ck.Motion:
    """The motion over so many steps from the pose drawn, a step being a second."""
    steps = np.arange(1, count + 1)
    values = {name: value + shown.rates[name] * steps for name, value in shown.values.items()}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return ck.solve(shown.mechanism, values, order=0)


def held(mechanism: ck.Mechanism, theirs: Any, count: int, tolerance: float = 1e-12) -> None:
    """Compare all joints of a mechanism with what pylinkage steps to."""
    shown = posed_mechanism(mechanism)
    motion, rows = ours(shown, count), list(theirs.step(count))
    assert np.all(motion.assembled)
    for k, joint in enumerate(theirs.joints):
        found = motion.points[legal(joint.id)].position
        wanted = [complex(*row[k]) for row in rows]
        np.testing.assert_allclose(np.broadcast_to(found, count), wanted, rtol=0, atol=tolerance * motion.size)


@pytest.mark.parametrize("case", entries("pylinkage-json"), ids=lambda case: case["id"])
def test_samples_have_their_positions(case: dict[str, Any]) -> None:
    mechanism = read(case["text"]).mechanism
    expected, shown = case["expected"], posed_mechanism(mechanism)
    drawn = {one["id"]: complex(*one["position"]) for one in json.loads(case["text"])["joints"]}
    letters = {name: letter_at(shown, place, 1e-9) for name, place in drawn.items()}
    motion = ours(shown, len(expected["rows"]))
    for k, row in enumerate(expected["rows"]):
        for name, place in row.items():
            found = np.broadcast_to(motion.points[letters[name]].position, len(expected["rows"]))[k]
            assert abs(found - complex(*place)) < PRINTED
    assert [one.link for one in mechanism.drives] == [expected["driver"]]
    if "slot" in expected:
        (pair,) = mechanism.written_pairs
        line = pair.ends(mechanism.geometry)[0]
        assert (pair.table, pair.on, letters[expected["slot"]["pin"]]) == ("slots", "frame", pair.at)
        assert complex(*expected["slot"]["direction"]) == pytest.approx(complex(line.along.c[0]))
        assert complex(*expected["slot"]["through"]) == pytest.approx(complex(np.asarray(line.point)))
    if "tracer" in expected:
        assert mechanism.carriers[letters[expected["tracer"]]] == ("coupler",)


# Mechanisms of pins and of slots of the frame: class II, with ternary cranks, tracers, several drivers, arcs.
STEPPED = ("five-bar-pendulum", "hart-inversor", "sewing-machine-needle-drive",
           "slider-crank-offset", "stephenson-i", "v-engine", "watt-ii-driven-at-ternary")  # fmt: skip


@pytest.mark.parametrize("name", STEPPED)
def test_what_is_written_pylinkage_steps(name: str) -> None:
    mechanism = loaded(name)
    shown = posed_mechanism(mechanism)
    written = FORMAT.write(shown)
    back = read(written.text).mechanism
    places = posed_mechanism(back)
    for point in drawing_of(shown).points:
        assert (
            abs(places.place(back.carriers[point.key][0], point.key) - point.at) < 1e-12 * shown.mechanism.geometry.size
        )
    theirs = pl.mechanism_from_dict(json.loads(written.text))
    held(back, theirs, 5)
    assert theirs.indeterminacy() == ck.decompose(back).mobility.freedoms
    assert "a step of pylinkage is" in written.notes[0]


def test_the_catalog_comes_back_digit_by_digit() -> None:
    """Where the drawing is exact nothing needs to be solved, which makes it quick."""
    said = 0
    for name in ck.exchange.shipped():
        mechanism = loaded(name)
        try:
            if not {*mechanism.links} <= {*mechanism.drawn_poses}:
                continue
            poses = {k: pose.entry((0, 0)) for k, pose in mechanism.drawn_poses.items()}
            rates = {drive.name: 1.0 for drive in mechanism.drives}
            whole: Any = SimpleNamespace(mechanism=mechanism)  # of the structure nothing else is asked
            shown = PosedMechanism(whole, poses, rates, rates)
            back = read(FORMAT.write(shown).text).mechanism
        except InvalidInput:
            continue
        said += 1
        for point in drawing_of(shown).points:
            assert abs(back.sketch[legal(point.key)] - point.at) < 1e-14 * mechanism.geometry.size
            left = {link for link in point.links if link not in back.links}
            assert {*back.carriers[legal(point.key)]} == {*point.links} - left
            assert all(any(pair.link == link for pair in mechanism.written_pairs) for link in left)
    assert said > 50


def random_mechanism(rng: np.random.Generator) -> Any:
    """A mechanism as its users make one: dyads, sliders and ternary links on what is there, trackers."""
    spot = lambda: tuple(rng.uniform(-4.0, 4.0, 2))  # noqa: E731
    ground = [pl.GroundJoint(f"G{k}", position=spot()) for k in range(3)]
    tip = pl.RevoluteJoint("A", position=spot())
    turn = math.atan2(tip.y - ground[0].y, tip.x - ground[0].x)
    crank = pl.DriverLink("crank", [ground[0], tip], motor_joint=ground[0], angular_velocity=1e-3, initial_angle=turn)
    joints, links = [*ground, tip], [crank]
    for k in range(3):
        first, second = rng.choice(joints[k and 1 :], 2, replace=False)
        if k == 1:
            line = {"axis": spot(), "line_point": spot()}
            along = complex(*line["axis"])
            place = complex(*line["line_point"]) + rng.uniform(-4, 4) * along / abs(along)
            new = pl.PrismaticJoint(f"J{k}", position=(place.real, place.imag), **line)
            links.append(pl.Link(f"L{k}", [joints[-1], new]))
        else:
            new = pl.RevoluteJoint(f"J{k}", position=spot())
            links += [pl.Link(f"L{k}", [first, new]), pl.Link(f"R{k}", [second, new])]
            more = pl.RevoluteJoint(f"K{k}", position=spot())
            links[-1].joints.append(more)
            joints.append(more)
        joints.append(new)
    tracker = pl.TrackerJoint(
        "T", ref_joint1_id="G0", ref_joint2_id="A", distance=rng.uniform(1, 2), angle=rng.uniform(-3, 3)
    )
    return pl.Mechanism("random", [*joints, tracker], [pl.GroundLink("ground", ground), *links])


@pytest.mark.parametrize("seed", range(8))
def test_random_mechanisms_both_ways(seed: int) -> None:
    made = random_mechanism(np.random.default_rng(seed))
    found = from_pylinkage(made)
    assert found.mechanism == read(json.dumps(pl.mechanism_to_dict(made))).mechanism
    written = FORMAT.write(posed_mechanism(found.mechanism), steps=6283)
    back = read(written.text).mechanism
    theirs = pl.mechanism_from_dict(json.loads(written.text))
    held(back, theirs, 4, 1e-10)
    held(found.mechanism, made, 1, 1.0)


def test_class_iii_groups_are_written_and_said_to_stop_pylinkage() -> None:
    written = FORMAT.write(posed_mechanism(loaded("class-iii-six-bar")))
    assert any("B1, B2, B3 one after another (a group of class III)" in note for note in written.notes)
    theirs = pl.mechanism_from_dict(json.loads(written.text))
    back = from_pylinkage(theirs).mechanism
    assert [group.class_ for group in ck.decompose(back).groups] == [3]
    # it depends on the order of a set whether it says so or leaves the joints where they are
    with pytest.raises((ValueError, AssertionError), match=r"Triad|Mismatched"):
        held(back, theirs, 5, 1e-3)
    assert np.all(ours(posed_mechanism(back), 5).assembled)


def test_bodies_of_several_links_are_one() -> None:
    written = FORMAT.write(posed_mechanism(loaded("sewing-machine-needle-drive")))
    assert [link["id"] for link in json.loads(written.text)["links"] if "crank" in link["id"]] == [
        "crank", "crank 2", "crank 3"]  # fmt: skip
    found = read(written.text)
    assert len(found.mechanism.links) == len(loaded("sewing-machine-needle-drive").links)
    assert "3 links are one rigid body, crank: crank, crank 2, crank 3" in found.notes
    data = json.loads(next(one["text"] for one in entries("pylinkage-json")))
    data["links"].append({"id": "strut", "type": "link", "joints": data["links"][0]["joints"]})
    held_fast = read(json.dumps(data))
    assert "strut" not in held_fast.mechanism.links
    assert "two joints of the ground hold, and make a part of the frame: strut" in held_fast.notes


def slider_crank() -> dict[str, Any]:
    data: dict[str, Any] = json.loads(entries("pylinkage-json")[1]["text"])
    return data


def test_a_link_with_two_parallel_slots_slides() -> None:
    data = slider_crank()
    data["joints"].append(
        {"id": "P", "type": "prismatic", "position": [-3.0, 1.0], "axis": [-2, 0], "line_point": [0, 1]}
    )
    data["links"].append({"id": "block", "type": "link", "joints": ["rod.1", "P"]})
    found = read(json.dumps(data)).mechanism
    assert [(pair.table, pair.members) for pair in found.written_pairs] == [("slides", ("frame", "block"))]
    held(found, pl.mechanism_from_dict(slider_crank()), 3)
    written = FORMAT.write(posed_mechanism(found))
    (pair,) = read(written.text).mechanism.written_pairs
    assert pair.table == "slides"
    held(read(written.text).mechanism, pl.mechanism_from_dict(json.loads(written.text)), 3)
    assert not any("no link is needed" in note for note in written.notes)
    data["joints"][-1]["line_point"] = [0, 1.25]
    found = read(json.dumps(data))
    assert {pair.table for pair in found.mechanism.written_pairs} == {"slots"}
    assert "drawn beside the lines on which pylinkage puts them: P (0.25)" in found.notes
    motion = ck.solve(found.mechanism, np.arange(3) * 0.5235987755982988)
    rows = list(pl.mechanism_from_dict(data).step(2))
    assert [complex(*row[-1]) for row in rows] == pytest.approx(motion.points["P"].position[1:])


def test_arcs_that_begin_backwards_are_told() -> None:
    notes = ck.exchange.write(ck.load("3-rrr"), "pylinkage").notes
    assert "goes to the end of its arc first in pylinkage, and to its beginning here: crank-3" in notes


def test_an_arc_is_a_range_from_the_drawn_pose_and_a_turn_is_told_where_it_starts() -> None:
    four_bar = pl.fourbar(crank=1, coupler=3, rocker=3, ground=4, initial_angle=0.5)
    (crank,) = (link for link in four_bar.links if link.id == "crank")
    list(four_bar.step(10))
    assert any(
        "crank starts from 28.6479 degrees in pylinkage, and is drawn at 64.6" in n
        for n in from_pylinkage(four_bar).notes
    )
    arc = pl.ArcDriverLink("crank", crank.joints, motor_joint=crank.motor_joint, arc_start=0.2, arc_end=2.2,
                           initial_angle=crank.current_angle, angular_velocity=0.01)  # fmt: skip
    links = [arc if link is crank else link for link in four_bar.links]
    made = pl.Mechanism("arc", four_bar.joints, links)
    found = from_pylinkage(made).mechanism
    assert [drive.speed for drive in found.drives] == [0.01]
    motion = ck.solve(found)
    assert motion.drives["crank"].value[[0, -1]] == pytest.approx([0.2, 2.2])
    held(found, made, 20)


REFUSED = [
    (lambda d: d["joints"][0].update(position=[math.nan, 0]), "joint crank.tip_rod.0: 'position' is nan"),
    (lambda d: d["joints"][0].update(position=[None, None]), "it has no position; build the mechanism, or step"),
    (lambda d: d["joints"][0].update(type="spherical"), "'spherical' is no type of joint"),
    (lambda d: d["joints"][0].update(type="Crank"), "this is a Linkage of pylinkage before 1.0"),
    (lambda d: d["joints"][1].update(axis=[0, 0]), "joint rod.1: its axis has no direction"),
    (lambda d: d["joints"][1].update(id="crank.tip_rod.0"), "this id is given twice"),
    (lambda d: d["links"][2].update(joints=["nowhere", "rod.1"]), "link rod: there is no joint 'nowhere'"),
    (lambda d: d["links"][1].pop("motor_joint"), "link crank: it has no motor_joint"),
    (lambda d: d["links"][1].update(type="arc_driver", arc_start=2, arc_end=1), "its arc ends at 1, before it begins"),
    (lambda d: d.update(ground="rod"), "ground: 'rod' is no link of type ground"),
    (lambda d: d.update(links=[]), "there are no links"),
    (lambda d: d["links"][2].update(joints=5), "link rod: 'joints' is 5, no list of names"),
    (lambda d: d["joints"].append({"id": "T", "type": "tracker", "ref_joint1_id": "rod.1", "ref_joint2_id": "X"}),
     "there is no joint 'X'"),
    (lambda d: d["joints"].append({"id": "T", "type": "tracker", "distance": 1, "ref_joint1_id": "rod.1",
                                   "ref_joint2_id": "crank.motor_ground.O"}), "joint T: its reference joints 'rod.1'"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_what_cannot_be_meant_is_refused_by_name(change: Any, words: str) -> None:
    data = slider_crank()
    change(data)
    with pytest.raises(InvalidInput) as error:
        read(json.dumps(data))
    assert words in str(error.value)


def test_structures_and_older_objects_are_refused_with_the_way_to_convert() -> None:
    from pylinkage.actuators import Crank
    from pylinkage.assur.mechanism_conversion import mechanism_to_graph
    from pylinkage.assur.serialization import graph_to_dict
    from pylinkage.components import Ground
    from pylinkage.dyads import FixedDyad, RRRDyad
    from pylinkage.hypergraph import to_mechanism
    from pylinkage.simulation import Linkage

    grounds = [Ground(0.0, 0.0, name="O1"), Ground(2.0, 0.0, name="O2")]
    crank = Crank(anchor=grounds[0], radius=1.0, angular_velocity=0.1, name="crank")
    rocker = RRRDyad(crank.output, grounds[1], distance1=2.0, distance2=1.5, name="rocker")
    linkage = Linkage([*grounds, crank, rocker, FixedDyad(crank.output, rocker, distance=1.0, angle=0.4, name="T")])
    list(linkage.step(1))
    with pytest.raises(InvalidInput, match=r"to_mechanism\(\*linkage.to_hypergraph\(\)\)"):
        from_pylinkage(linkage)
    found = from_pylinkage(to_mechanism(*linkage.to_hypergraph()))
    assert sorted(map(len, found.mechanism.carriers.values())) == [1, 2, 2, 2, 2]
    held(found.mechanism, to_mechanism(*linkage.to_hypergraph()), 3)
    graph, _ = mechanism_to_graph(pl.mechanism_from_dict(slider_crank()))
    with pytest.raises(InvalidInput, match="topology only"):
        read(json.dumps(graph_to_dict(graph)))
    with pytest.raises(InvalidInput, match="topology only"):
        from_pylinkage(graph)


def test_changed_lengths_are_told() -> None:
    four_bar = pl.fourbar(crank=1, coupler=3, rocker=3, ground=4)
    four_bar.set_constraints([1.0, 3.2, 3.0])
    with pytest.raises(InvalidInput, match=r"its length is now 3.2; let it move there first"):
        from_pylinkage(four_bar)
    next(four_bar.step(1, dt=0))
    held(from_pylinkage(four_bar).mechanism, four_bar, 3)


@pytest.mark.parametrize("speed", [1e-320, 1e49, 0.0])
def test_speeds_that_are_none_are_written_as_numbers(speed: float) -> None:
    bar = loaded("crank-rocker")
    made = bar.replace(ck.drive("crank", speed=speed))
    links = json.loads(FORMAT.write(posed_mechanism(made)).text)["links"]
    (rate,) = (link["angular_velocity"] for link in links if link["id"] == "crank")
    assert math.isfinite(rate)


def test_what_pylinkage_cannot_say_is_refused_at_once() -> None:
    with pytest.raises(InvalidInput) as error:
        FORMAT.write(posed_mechanism(loaded("geared-press")))
    assert len(error.value.problems) > 1
    assert "mesh: a gear or belt" in str(error.value)
    with pytest.raises(InvalidInput, match="0 is no count"):
        FORMAT.write(posed_mechanism(loaded("triple-rocker")), steps=0)


@pytest.mark.parametrize(
    "raw", [b'{"joints": ' + b"[" * 90_000, b'{"joints": [], "links": 1e999}', b"{}", b'{"joints":[5],"links":[[]]}']
)
def test_nothing_that_is_no_file_of_theirs_is_a_traceback(raw: bytes) -> None:
    with pytest.raises(InvalidInput):
        FORMAT.read(Content(raw))


def test_large_files_answer_soon() -> None:
    joints = [
        {"id": f"J{k}", "type": "ground" if k < 2 else "revolute", "position": [k, k * k % 7]} for k in range(1000)
    ]
    star = [{"id": f"L{k}", "joints": ["J2", f"J{k}"]} for k in range(3, 500)]
    tracked = [{"id": f"T{k}", "type": "tracker", "ref_joint1_id": f"T{k-1}" if k else "J2", "distance": 1,
                "ref_joint2_id": f"T{k-2}" if k > 1 else "J3"} for k in range(450)]  # fmt: skip
    every = [{"id": f"L{k}", "joints": [f"J{j}" for j in range(500)]} for k in range(500)]
    for data in ({"joints": joints, "links": star}, {"joints": joints, "links": every},
                 {"joints": joints[:5] + tracked, "links": star[:2]}):  # fmt: skip
        with pytest.raises(InvalidInput):
            read(json.dumps(data))


def test_its_page_prints_what_it_shows(capsys: pytest.CaptureFixture[str]) -> None:
    prints_what_it_shows("pylinkage.md", capsys)


def test_a_tracker_that_is_drawn_elsewhere_than_it_is_told_is_noted() -> None:
    sample = entry("pylinkage_tracker")["text"]
    moved = sample.replace("2.562819251291184", "2.862819251291184")
    assert moved != sample
    found = ck.exchange.read(moved, "pylinkage")
    assert any("P (0.3 away)" in note for note in found.notes)
    assert not any("away" in note for note in ck.exchange.read(sample, "pylinkage").notes)
