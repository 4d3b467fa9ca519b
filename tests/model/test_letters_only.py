"""Mechanisms of letters alone: what needs no dimensions works, and what needs them says which points have no place."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from click.testing import CliRunner

import compoundkin as ck
from compoundkin.chains import structure_name
from compoundkin.cli import cli
from compoundkin.structure import loop_count

LINKS = {"frame": "ADG", "AB": "AB", "BCE": "BCE", "CD": "CD", "EF": "EF", "FG": "FG"}
PLACES = {"A": 0.6 + 0.2j, "B": -0.1 - 2.3j, "C": 0.4 - 2.1j, "D": 0.9 + 0.6j, "E": 0.8 + 0.8j, "F": 0.3 - 0.5j,
          "G": -0.3 + 1.5j}  # fmt: skip


def stephenson(*more: Any) -> ck.Mechanism:
    """The Stephenson III whose driver makes one group of all its links but the driven one."""
    return ck.Mechanism(
        "Stephenson", *(ck.link(name, *letters) for name, letters in LINKS.items()), ck.drive("FG"), *more
    )


LETTERS, DRAWN = stephenson(), stephenson(ck.drawn(**PLACES))


def test_structure_names_and_loops_are_those_of_the_drawn_mechanism() -> None:
    letters, drawn = ck.decompose(LETTERS), ck.decompose(DRAWN)
    # outer A, D, F; inner B, C, E
    assert [group.name for group in letters.groups] == ["RRR-RRR"] == [group.name for group in drawn.groups]
    assert letters.faults == ()
    assert letters.mobility == drawn.mobility
    assert [str(loop) for loop in letters.loops] == [str(loop) for loop in drawn.loops]
    assert loop_count(letters) == 2
    assert structure_name(letters).title == structure_name(drawn).title == "Stephenson III"
    found = ck.mobility_analysis(LETTERS)
    assert (found.gruebler, found.generic, found.finite) == (1, 1, None)


def test_choices_of_frame_and_driver_are_those_of_the_drawn_mechanism() -> None:
    def table(mechanism: ck.Mechanism) -> list[tuple[Any, ...]]:
        return [(a.frame, a.drivers, a.title, a.groups, a.configurations, a.faults) for a in ck.alternatives(mechanism)]

    assert table(LETTERS) == table(DRAWN)
    assert [drive.link for drive in ck.with_driver(LETTERS, "AB").drives] == ["AB"]
    # CD joins both ternary links, EF one of them
    assert structure_name(ck.decompose(ck.with_frame(LETTERS, "CD"))).title == "Stephenson I"
    assert structure_name(ck.decompose(ck.with_frame(LETTERS, "EF"))).title == "Stephenson II"


def test_the_report_is_that_of_the_structure() -> None:
    made = ck.report(LETTERS)
    keys = ["about", "links", "pairs", "mobility", "chain", "loops", "groups", "drivers"]
    assert [section.key for section in made.sections] == keys
    text = " ".join(made.text().split())
    assert "Points of all links have no place" in text
    assert "BCE ternary B, C, E" in text
    assert "Stephenson III" in text
    assert made.json() == ck.report(ck.decompose(LETTERS)).json()
    assert "Stephenson" in made.html()


@pytest.mark.parametrize("kind", ["graph", "loops", "circle"])
def test_pictures_of_the_structure_are_drawn(kind: str) -> None:
    assert ck.draw(LETTERS, kind=kind).svg.startswith("<svg")


def test_a_file_says_the_same_and_fits_the_schema(tmp_path: Any) -> None:
    import json

    from jsonschema import validate

    from compoundkin.files.json_schema import schema

    path = tmp_path / "letters.toml"
    ck.save(LETTERS, path)
    assert 'points = ["B", "C", "E"]' in path.read_text()
    assert ck.load(path) == LETTERS
    ck.save(LETTERS, tmp_path / "letters.json")
    validate(json.loads((tmp_path / "letters.json").read_text()), schema())


NEEDS_PLACES: dict[str, Callable[[ck.Mechanism], Any]] = {
    "solve": ck.solve,
    "draw": ck.draw,
    "configurations": lambda m: ck.configurations(m, {"FG": 1.0}),
    "circuits": ck.circuits,
    "equations": ck.loop_equations,
    "animate": ck.animate,
    "structure solved": lambda m: ck.solve(ck.decompose(m)),
}


@pytest.mark.parametrize("call", NEEDS_PLACES)
def test_what_needs_dimensions_says_which_points_have_no_place(call: str) -> None:
    with pytest.raises(ck.errors.InvalidInput) as caught:
        NEEDS_PLACES[call](LETTERS)
    assert [problem.where for problem in caught.value.problems] == [f"links.{name}.points" for name in LINKS]
    assert "the points B, C, E of 'BCE' have no place" in str(caught.value)
    assert "give all coordinates as A = (x, y), or a place in the drawing" in str(caught.value)


def test_some_coordinates_and_some_letters() -> None:
    items = ck.link("frame", A=(0, 0), D=(4, 0)), ck.link("crank", A=(0, 0), B=(1, 0)), ck.link("rod", "B", "C")
    part = ck.Mechanism("Four-bar", *items, ck.link("rocker", "D", "C"), ck.drive("crank"))
    assert [group.links for group in ck.decompose(part).groups] == [("rod", "rocker")]
    assert "Points of rod and rocker have no place" in " ".join(ck.report(part).text().split())
    with pytest.raises(ck.errors.InvalidInput, match="the points B, C of 'rod' have no place") as caught:
        ck.solve(part)
    assert len(caught.value.problems) == 2
    drawn = part.replace(ck.drawn(B=(1, 0), D=(4, 0), C=(2, 3)))
    assert ck.solve(drawn, {"crank": 0.0}).assembled.all()
    # a drawing that leaves a letter out is no mistake by itself
    with pytest.raises(ck.errors.InvalidInput, match="the point C of 'rod' has no place"):
        ck.solve(part.replace(ck.drawn(B=(1, 0), D=(4, 0))))


def test_many_links_are_not_all_named() -> None:
    cranks = [ck.link(f"crank {k}", f"A{k}", f"B{k}") for k in range(40)]
    many = ck.Mechanism("Cranks", ck.link("frame", *(f"A{k}" for k in range(40))), *cranks)
    with pytest.raises(ck.errors.InvalidInput, match="29 more links") as caught:
        assert many.geometry
    assert len(caught.value.problems) == 13


def test_slides_gears_and_cams_need_no_places_either() -> None:
    slider = ck.Mechanism(
        "Slider-crank", ck.link("frame", "A", "Q"), ck.link("crank", "A", "B"), ck.link("rod", "B", "C"),
        ck.link("piston", "C"), ck.slide("piston", on="frame", at="C", through="Q"), ck.drive("crank"),
    )  # fmt: skip
    assert [group.name for group in ck.decompose(slider).groups] == ["RRP"]
    assert structure_name(ck.decompose(slider)).title == "slider-crank"
    assert ck.with_driver(slider, "piston").drives[0].values is None
    train = ck.Mechanism(
        "Gears", ck.link("frame", "A", "B"), ck.link("pinion", "A"), ck.link("wheel", "B"),
        ck.gear("pinion", "wheel", teeth=(20, 40)), ck.drive("pinion"),
    )  # fmt: skip
    assert ck.decompose(train).faults == ()
    with pytest.raises(ck.errors.InvalidInput, match="the point B of 'wheel' has no place"):
        ck.solve(train)


def test_the_command_line_reports_what_letters_tell(tmp_path: Any) -> None:
    path = tmp_path / "letters.toml"
    ck.save(LETTERS, path)
    for verb in (["structure"], ["structure", "--alternatives"], ["report"], ["draw", "--structure", "graph"]):
        found = CliRunner().invoke(cli, [verb[0], str(path), *verb[1:], "-o", str(tmp_path / "out.svg")]
                                   if verb[0] == "draw" else [verb[0], str(path), *verb[1:]])  # fmt: skip
        assert found.exit_code == 0, found.output
    for verb in (["solve"], ["check"], ["circuits"], ["configurations", "--at", "35"]):
        found = CliRunner().invoke(cli, [verb[0], str(path), *verb[1:]])
        assert found.exit_code == 2
        assert "'Stephenson' has no dimensions yet" in found.output


def test_a_letter_misspelt_in_the_drawing_is_still_a_mistake() -> None:
    with pytest.raises(ck.errors.InvalidMechanism, match="did you mean 'Zet'"):
        stephenson(ck.link("x", "A", "Zed"), ck.drawn(**PLACES, Zet=1))
