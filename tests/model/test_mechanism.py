"""The words and the `Mechanism` made of them."""

from __future__ import annotations

import numpy as np
import pytest

import compoundkin as ck
from compoundkin.base.errors import Problem, suggestion
from compoundkin.files import load
from compoundkin.model.elements import Drive
from compoundkin.model.geometry import vector
from compoundkin.model.pairs.prismatic import slide


def four_bar(**crank: object) -> ck.Mechanism:
    return ck.Mechanism(
        "Four-bar",
        ck.link("frame", A=(0, 0), D=(4, 0)),
        ck.link("crank", A=(0, 0), **{"B": (1, 0), **crank}),
        ck.link("coupler", B=(0, 0), C=(3, 0)),
        ck.link("rocker", D=(0, 0), C=(3, 0)),
        ck.drive("crank"),
        unit="mm",
        source="here",
        description="one",
        outputs=["rocker.angle"],
    )


def test_points_in_every_notation() -> None:
    link = ck.link(
        "a", A=(1, 2), B=3 - 1j, C=5, D=([1, 2], 0), E=[0, [1, 2]], F=ck.polar(2, np.pi / 2), G=np.array([1j, 2])
    )
    assert link.points["A"] == 1 + 2j
    assert link.points["B"] == 3 - 1j
    assert link.points["C"] == 5 + 0j
    assert link.points["D"].tolist() == [1, 2]
    assert link.points["E"].tolist() == [1j, 2j]
    assert abs(link.points["F"] - 2j) < 1e-15
    assert link.points["G"].tolist() == [1j, 2]
    assert link.letters == tuple("ABCDEFG")
    assert not link.is_drawn


def test_arrays_are_copied_and_cannot_be_changed() -> None:
    own = np.array([1.0 + 0j, 2.0])
    link = ck.link("a", A=own)
    own[0] = 99
    assert link.points["A"][0] == 1
    with pytest.raises(ValueError, match="read-only"):
        link.points["A"][0] = 0
    values = np.array([0.0, 1.0])
    drive = ck.drive("a", values=values)
    values[0] = 5
    assert drive.values[0] == 0
    with pytest.raises(ValueError, match="read-only"):
        drive.values[0] = 1


@pytest.mark.parametrize("wrong", ["A", (1, 2, 3), (1,), None, {"x": 1}, ("a", "b"), [[1, 2], [1, 2, 3]]])
def test_what_is_not_a_point_is_named(wrong: object) -> None:
    with pytest.raises(ck.errors.InvalidMechanism) as caught:
        ck.link("a", A=0, P=wrong, Q=wrong)
    assert [p.where for p in caught.value.problems] == ["links.a.points.P", "links.a.points.Q"]
    assert "write (x, y) or a complex number" in str(caught.value)
    with pytest.raises(ck.errors.InvalidMechanism, match=r"drawn\.P"):
        ck.drawn(P=wrong)


@pytest.mark.parametrize(("letters", "points"), [(("A", "A"), {}), (("A",), {"B": 0}), (("A",), {"A": 0})])
def test_points_given_twice(letters: tuple[str, ...], points: dict[str, int]) -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="given twice"):
        ck.link("a", *letters, **points)


def test_drive_words() -> None:
    drive = ck.drive("rod", on="cylinder", values=[1, 2], speed=3, name="ram")
    assert (drive.name, drive.link, drive.on, drive.pair) == ("ram", "rod", "cylinder", "")
    assert drive.values.tolist() == [1, 2]
    assert (drive.speed, drive.acceleration, drive.jerk) == (3.0, 0.0, 0.0)
    assert ck.drive("crank").on == "frame"
    assert ck.drive("crank").values is None
    with pytest.raises(ck.errors.InvalidMechanism, match=r"drives\.crank\.speed.*a text is no number"):
        ck.drive("crank", speed="fast")
    assert {key.name for key in Drive.keys} == set(vars(drive))


@pytest.mark.parametrize("sign", [0, 2, "1", None, 1.5])
def test_a_mode_is_a_sign(sign: object) -> None:
    with pytest.raises(ck.errors.CompoundkinError, match=r"modes: an assembly mode is \+1 or -1|sign: .* whole number"):
        ck.mode(sign, "a")  # type: ignore[arg-type]


def test_expectations() -> None:
    found = ck.expect("P.position", (1, 2), 1e-3, **{"crank": 0.5, "crank.speed": 2.0})
    assert found.value == 1 + 2j
    assert found.at == (("crank", 0.5), ("crank.speed", 2.0))


def test_angles() -> None:
    assert ck.deg(180) == np.pi
    assert isinstance(ck.deg(90), float)
    assert ck.deg([0, 90]).tolist() == [0, np.pi / 2]
    assert np.allclose(ck.polar([1, 2], ck.deg([0, 90])), [1, 2j])


def test_parts_of_a_mechanism() -> None:
    mechanism = four_bar()
    assert list(mechanism.links) == ["frame", "crank", "coupler", "rocker"]
    assert mechanism.carriers == {
        "A": ("frame", "crank"),
        "D": ("frame", "rocker"),
        "B": ("crank", "coupler"),
        "C": ("coupler", "rocker"),
    }
    assert mechanism.pins == mechanism.carriers
    assert [d.name for d in mechanism.drives] == ["crank"]
    assert mechanism.written_pairs == ()
    assert mechanism.sketch == {}
    assert repr(mechanism) == "Mechanism('Four-bar': 4 links, 1 driver)"
    assert mechanism.link("crank").points["B"] == 1
    with pytest.raises(ck.errors.UnknownName, match="did you mean 'crank'"):
        mechanism.link("cranc")


def test_a_letter_on_several_links_is_one_multiple_pin() -> None:
    links = [ck.link(name, J=(0, 0), **{f"P{k}": (1, 0)}) for k, name in enumerate(("frame", "a", "b", "c"))]
    mechanism = ck.Mechanism("m", *links, ck.drive("a"), ck.drive("b"), ck.drive("c"))
    assert mechanism.pins == {"J": ("frame", "a", "b", "c")}
    structure = ck.decompose(mechanism)
    assert len(structure.pairs) == 3
    assert structure.mobility.value == 3 if hasattr(structure.mobility, "value") else True


def test_the_slide_takes_its_only_point() -> None:
    mechanism = ck.Mechanism(
        "m", ck.link("frame", O=0), ck.link("b", C=0), slide("b", on="frame", through="O"), ck.drive("b", values=1)
    )
    assert mechanism.written_pairs[0].letters == ("C", "O")
    assert mechanism.written_pairs[0].name == "b/frame"


def test_replace_puts_an_item_in_the_place_of_its_like() -> None:
    mechanism = four_bar()
    longer = mechanism.replace(ck.link("crank", A=0, B=1.5), ck.drive("crank", speed=5), title="Longer", unit="cm")
    assert longer.links["crank"].points["B"] == 1.5
    assert [type(i).__name__ for i in longer.items] == [type(i).__name__ for i in mechanism.items]
    assert list(longer.links) == list(mechanism.links)
    assert longer.drives[0].speed == 5
    assert (longer.title, longer.unit, longer.source, longer.description, longer.outputs) == (
        "Longer",
        "cm",
        "here",
        "one",
        ("rocker.angle",),
    )
    assert mechanism.links["crank"].points["B"] == 1
    assert longer != mechanism
    more = mechanism.replace(ck.link("bar", C=0, E=1), ck.mode(-1, "coupler"))
    assert list(more.links) == [*mechanism.links, "bar"]
    assert more.replace(ck.mode(1, "coupler")).modes == (ck.mode(1, "coupler"),)
    first = mechanism.replace(ck.drawn(B=1), ck.expect("rocker.angle", 1, 1))
    second = first.replace(ck.drawn(C=2), ck.expect("rocker.angle", 2, 1))
    assert second.sketch == {"C": 2}
    assert [e.value for e in second.expectations] == [2]
    with pytest.raises(ck.errors.InvalidMechanism):
        mechanism.replace(ck.link("crank", X=0, Y=1))


def test_replace_finds_the_slide_by_its_name() -> None:
    base = ck.Mechanism(
        "m",
        ck.link("frame", O=0),
        ck.link("b", C=0),
        slide("b", on="frame", through="O", name="s"),
        ck.drive("b", values=1),
    )
    moved = base.replace(slide("b", on="frame", through="O", name="s", offset=2.0))
    assert [p.offset for p in moved.written_pairs] == [2.0]  # type: ignore[attr-defined]
    assert abs(complex(ck.solve(moved).points["C"].position) - (1 + 2j)) < 1e-15


def test_equality_is_of_what_is_written() -> None:
    assert four_bar() == four_bar()
    assert hash(four_bar()) == hash(four_bar())
    assert four_bar() != four_bar(B=(1.0000001, 0))
    assert four_bar(B=np.array([1, 2])) == four_bar(B=np.array([1, 2]))
    assert four_bar(B=np.array([1, 2])) != four_bar(B=np.array([1, 3]))
    assert four_bar(B=np.array([1, 1])) != four_bar()
    assert four_bar(B=np.array([1, 1])) != four_bar(B=np.array([[1, 1]]))
    assert four_bar() != four_bar().replace(ck.drive("crank", speed=2))
    assert four_bar() != four_bar().replace(title="other")
    assert four_bar() != four_bar().replace(ck.mode(-1, "coupler"))
    assert four_bar() != "Four-bar"
    items = four_bar().items
    words = {"unit": "mm", "source": "here", "description": "one", "outputs": ["rocker.angle"]}
    assert ck.Mechanism("Four-bar", *items[-1:], *items[:-1], **words) == four_bar()
    assert ck.Mechanism("Four-bar", *items[::-1], **words) != four_bar()


def test_as_drawn_dimensions_are_distances_of_the_drawing() -> None:
    places = {"A": 1 + 1j, "B": 2 + 3j, "C": 6 + 4j, "D": 7 + 0j, "P": 3 + 6j}
    mechanism = ck.Mechanism(
        "m",
        ck.link("frame", "A", "D"),
        ck.link("crank", "A", "B"),
        ck.link("coupler", "B", "C", "P"),
        ck.link("rocker", "D", "C"),
        ck.drive("crank"),
        ck.drawn(**places),
    )
    geometry = mechanism.geometry
    for name, letters in (("crank", "AB"), ("coupler", "BC"), ("coupler", "CP"), ("coupler", "BP"), ("rocker", "DC")):
        one, two = (geometry.points[name][k] for k in letters)
        assert abs(abs(one - two) - abs(places[letters[0]] - places[letters[1]])) < 1e-14
    # handedness too: P lies to the left of BC, as drawn
    assert geometry.points["coupler"]["P"].imag > 0
    assert geometry.points["coupler"]["C"].imag == 0
    for name, link in mechanism.links.items():
        for letter in link.letters:
            assert abs(complex(geometry.drawn[name].at(geometry.points[name][letter]).c[0]) - places[letter]) < 1e-14
    assert geometry.as_drawn == {"frame", "crank", "coupler", "rocker"}
    assert abs(geometry.size - abs(6 + 6j)) < 1e-14  # the box around A, D, P


def test_links_with_dimensions_may_be_drawn_too() -> None:
    mechanism = four_bar().replace(ck.drawn(B=(0, 1), C=(4, 3)))
    drawn = mechanism.geometry.drawn
    assert set(drawn) >= {"frame", "coupler"}
    assert abs(complex(drawn["crank"].u.c[0]) - 1j) < 1e-15
    assert "rocker" in drawn
    assert "crank" not in mechanism.geometry.as_drawn


def test_a_drawn_link_of_one_letter_shows_no_direction_and_lies_along_its_guide() -> None:
    mechanism = ck.Mechanism(
        "m",
        ck.link("frame", "O", "Q"),
        ck.link("block", "C"),
        slide("block", on="frame", at="C", through="O", toward="Q"),
        ck.drive("block", values=2.0),
        ck.drawn(O=0, Q=1 + 1j, C=3),
    )
    motion = ck.solve(mechanism)
    assert abs(float(motion.links["block"].angle) - np.pi / 4) < 1e-15
    # C is drawn 3/sqrt(2) to the right of the line OQ
    assert abs(complex(motion.points["C"].position) - (2 - 3j / np.sqrt(2)) * np.exp(1j * np.pi / 4)) < 1e-14


def test_vectors_name_their_place() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="here: 'x' is not a point"):
        vector("here", "x")


def test_sizes() -> None:
    """The greatest diagonal of a box around one link's points; 1 for a mechanism without any extent."""
    assert four_bar().geometry.size == 4.0
    assert four_bar(B=np.array([1, 30])).geometry.size == 30.0
    lone = ck.Mechanism("m", ck.link("frame", A=0), ck.link("b", A=0), ck.drive("b"))
    assert lone.geometry.size == 1.0


def test_problems_say_where_what_and_remedy() -> None:
    assert str(Problem("a.b", "it is wrong", "mend it")) == "a.b: it is wrong; mend it"
    assert str(Problem("", "it is wrong")) == "it is wrong"
    assert suggestion("x", []) == "there is none"
    assert suggestion("zzz", [f"n{k}" for k in range(20)]).endswith("...")
    error = ck.errors.InvalidMechanism([Problem("a", "b"), Problem("c", "d")])
    assert str(error) == "2 problems:\n  a: b\n  c: d"
    assert str(ck.errors.NotDetermined("plain")) == "plain"
    assert (ck.errors.InvalidMechanism.exit_code, ck.errors.NotAssembled.exit_code) == (2, 3)
    assert issubclass(ck.errors.UnknownName, LookupError)


@pytest.mark.parametrize(("name", "link"), [("engine-gas-pressure", "piston"), ("jaw-crusher-loaded", "jaw")])
@pytest.mark.filterwarnings("ignore::compoundkin.errors.UnassembledPoses")
def test_report_of_a_loaded_mechanism_driven_elsewhere(name: str, link: str) -> None:
    loaded = load(name)
    (driver,) = loaded.drives
    driven = ck.with_driver(loaded, link)
    assert set(loaded.outputs) - set(driven.outputs) == {f"{driver.name}.effort"}
    # the piston stands at its dead point, where the pose is a single one and singular; the jaw cannot go all around
    assert "Forces" in ck.report(driven).text()
