"""Mechanisms that cannot be meant or solved: each is named with its links and a way to mend it."""

from __future__ import annotations

import pytest

from compoundkin.base.errors import InvalidMechanism
from compoundkin.model.elements import drive
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose
from compoundkin.synthesis.chains import structure_name

FOUR = {"frame": "AD", "crank": "AB", "coupler": "BC", "rocker": "CD"}


def refused(*items) -> list[tuple[str, str, str]]:
    with pytest.raises(InvalidMechanism) as caught:
        Mechanism("m", *items)
    return [(problem.where, problem.what, problem.remedy) for problem in caught.value.problems]


def test_a_piece_that_is_joined_to_nothing_else(bars):
    structure = decompose(Mechanism("m", *bars(**FOUR, e="EH", f="EF", g="FG", h="GH"), drive("crank")))
    (fault,) = structure.faults
    assert fault.links == ("e", "f", "g", "h")
    assert fault.remedy == "join e, f, g, h to the frame by a pair"
    assert structure_name(structure).title == "8 links in 2 separate pieces"


def test_a_link_that_is_joined_to_nothing(bars):
    ((where, what, remedy),) = refused(*bars(**FOUR, e="XY"), drive("crank"))
    assert where == "links.e"
    assert "no other link carries X, Y" in what
    assert "share a letter" in remedy


def test_two_frames(bars):
    problems = refused(*bars(**FOUR), *bars(frame="Q"), drive("crank"))
    assert problems[0][:2] == ("links.frame", "the name 'frame' is used twice")
    assert "give all fixed points to it" in problems[0][2]


def test_no_frame(bars):
    problems = refused(*bars(base="AD", crank="AB", coupler="BC", rocker="CD"), drive("crank", on="base"))
    assert problems[0][1] == "no link is called 'frame'"
    assert "call the fixed link 'frame'" in problems[0][2]


def test_moving_links_pinned_twice_to_one_another(bars):
    links = bars(frame="AD", crank="AB", coupler="BXC", rocker="CXD")
    structure = decompose(Mechanism("m", *links, drive("crank")))
    (fault,) = structure.faults
    assert (fault.kind, fault.links, fault.amount) == ("over", ("crank", "coupler", "rocker"), 2)
    assert fault.remedy == "remove the driver crank or free 2 of the pairs B, X, C, D"
    assert structure.mobility.freedoms == -1


def test_a_driven_link_pinned_twice_to_the_frame(bars):
    links = bars(frame="ADX", crank="ABX", coupler="BC", rocker="CD")
    assert refused(*links, drive("crank")) == [
        ("drives[0].pair", "'crank' and 'frame' share several pairs", "name one: A, X")
    ]
    (fault,) = decompose(Mechanism("m", *links, drive("crank", pair="A"))).faults
    assert (fault.kind, fault.amount) == ("over", 2)
    assert fault.remedy.endswith("take apart X")


def test_a_structure_without_a_driver_is_no_fault_but_does_not_move(bars):
    structure = decompose(Mechanism("m", *bars(frame="AD", a="AB", b="BD")))
    assert structure.faults == ()
    assert structure.mobility.verdict == "mobility 0 and no driver: a structure that does not move"
    assert structure_name(structure).title.startswith("3-link truss 1")


def test_mobility_zero_with_a_driver(bars):
    structure = decompose(Mechanism("m", *bars(frame="AD", a="AB", b="BD"), drive("a")))
    (fault,) = structure.faults
    assert (fault.kind, fault.links, fault.amount) == ("over", ("a", "b"), 1)
    assert fault.remedy.startswith("remove the driver a")
    assert structure.mobility.verdict == "mobility 0 and 1 driver: 1 driver is too many"


def test_negative_mobility(bars):
    structure = decompose(Mechanism("m", *bars(frame="ADE", a="AB", b="BD", c="BE")))
    (fault,) = structure.faults
    assert (fault.kind, fault.links, fault.amount) == ("over", ("a", "b", "c"), 1)
    assert fault.remedy == "free one of the pairs A, B, D, E or take out a link"
    assert structure.mobility.verdict.endswith("1 constraint too many for a structure that just holds")


def test_more_drivers_than_freedoms(bars):
    structure = decompose(Mechanism("m", *bars(**FOUR), drive("crank"), drive("rocker")))
    (fault,) = structure.faults
    assert fault.remedy.startswith("remove one of the drivers crank, rocker")


def test_one_pair_driven_twice(bars):
    ((where, what, remedy),) = refused(*bars(**FOUR), drive("crank"), drive("crank", name="again"))
    assert (where, what, remedy) == ("drives[1]", "the pair 'A' is driven already by 'crank'", "leave one of them out")


def test_drivers_that_fight_in_one_part_while_another_has_none(bars):
    """The count is right as a whole: two freedoms, two drivers, both of them in the four-bar."""
    links = bars(frame="ADX", crank="AB", coupler="BC", rocker="CD", swing="XP")
    structure = decompose(Mechanism("m", *links, drive("crank"), drive("rocker")))
    assert structure.mobility.is_determinate
    over, under = structure.faults
    assert (over.kind, over.links) == ("over", ("crank", "coupler", "rocker"))
    assert over.remedy.startswith("remove one of the drivers crank, rocker")
    assert (under.kind, under.links) == ("under", ("swing",))
    assert under.remedy == "add a driver on one of: swing on frame (pin X)"


def test_a_loose_link_is_named_and_the_name_of_the_chain_does_not_hide_it(bars):
    structure = decompose(Mechanism("m", *bars(**FOUR, t="CT"), drive("crank")))
    (fault,) = structure.faults
    assert (fault.links, fault.amount) == (("t",), 1)
    assert structure_name(structure).title == "5-link chain of mobility 2, one link of it loose, with one double pin"


def test_what_is_rigid_by_count_is_not_called_a_chain(bars):
    """A parallelogram with two couplers moves, but by its dimensions: the name is that of a truss."""
    links = bars(frame="ADF", a="AB", c="DC", m="FG", coupler="BCG")
    structure = decompose(Mechanism("m", *links, drive("a")))
    assert structure_name(structure).title.startswith("5-link truss 1")
    assert structure_name(structure).mobility == 0
