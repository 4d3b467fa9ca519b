from __future__ import annotations

import pytest

from compoundkin.model.elements import drive, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from compoundkin.structure import decompose

FOUR = {"frame": "AD", "crank": "AB", "coupler": "BC", "rocker": "CD"}


def faults(*items):
    return [(f.kind, f.links, f.amount) for f in decompose(Mechanism("m", *items)).faults]


def test_no_driver(bars):
    (fault,) = decompose(Mechanism("m", *bars(**FOUR))).faults
    assert (fault.kind, fault.links, fault.amount) == ("under", ("crank", "coupler", "rocker"), 1)
    assert fault.text == "crank, coupler, rocker are left with 1 freedom"
    assert fault.remedy.startswith("add a driver on one of: crank on frame (pin A), rocker on frame (pin D)")


def test_following_the_remedy_mends_it(bars):
    assert decompose(Mechanism("m", *bars(**FOUR), drive("rocker", on="coupler"))).faults == ()


def test_too_many_drivers(bars):
    structure = decompose(Mechanism("m", *bars(**FOUR), drive("crank"), drive("rocker")))
    (fault,) = structure.faults
    assert (fault.kind, fault.links, fault.amount) == ("over", ("crank", "coupler", "rocker"), 1)
    assert fault.remedy == "remove one of the drivers crank, rocker or free one of the pairs B, C"
    assert structure.mobility.verdict == "mobility 1 and 2 drivers: 1 driver is too many"
    assert [pair.name for pair in structure.pairs] == ["A", "D", "B", "C"]


def test_driver_that_closes_a_driven_ring(bars):
    three = drive("crank"), drive("rocker"), drive("coupler", on="crank")
    (fault,) = decompose(Mechanism("m", *bars(**FOUR), *three)).faults
    assert (fault.kind, fault.amount) == ("over", 2)
    assert fault.remedy == "remove 2 of the drivers crank, rocker, coupler or take apart C"
    ring = (*three, drive("coupler", on="rocker", name="fourth"))
    (fault,) = decompose(Mechanism("m", *bars(**FOUR), *ring)).faults
    assert fault.amount == 3
    assert "fourth" in fault.remedy


def test_slide_across_driven_links(bars):
    links = bars(frame="AG", arm="AB", hand="BT")
    items = slide("hand", on="frame", at="T", through="G"), drive("arm"), drive("hand", on="arm")
    (fault,) = decompose(Mechanism("m", *links, *items)).faults
    assert (fault.kind, fault.amount) == ("over", 2)
    assert fault.remedy.endswith("take apart hand/frame")


def test_drivers_around_one_pin_close(bars):
    links = bars(frame="J", a="JA", b="JB")
    driven = drive("a"), drive("b"), drive("b", on="a", name="third")
    (fault,) = decompose(Mechanism("m", *links, *driven)).faults
    assert (fault.kind, fault.amount, fault.links) == ("over", 1, ("frame", "a", "b"))
    assert fault.remedy == "remove one of the drivers a, b, third"


def test_hidden_rigid_subchain_is_over_and_under_at_once(bars):
    left, right = ("PQR", "STU", "VWX"), ("PSV", "QTW", "RUX")
    six = dict(zip("abcxyz", (*left, *right), strict=True))
    links = bars(frame="O", crank="O", **six)
    structure = decompose(Mechanism("m", *links, drive("crank")))
    assert structure.mobility.is_determinate
    over, under = structure.faults
    assert (over.kind, over.links, over.amount) == ("over", tuple(six), 3)
    assert (under.kind, under.links, under.amount) == ("under", tuple(six), 3)
    assert under.remedy == "join a, b, c, x, y, z to the frame by a pair"


def test_driver_is_asked_for_only_where_something_moves(bars):
    links = bars(frame="A", crank="AC", p="CDEF", q="DGH", r="EGI", s="FHI", t="C")
    found = decompose(Mechanism("m", *links, drive("crank"), drive("t", on="crank"))).faults
    assert [(f.kind, f.amount) for f in found] == [("over", 3), ("under", 1)]
    assert found[0].links == ("p", "q", "r", "s")
    assert found[1].remedy == "add a driver on one of: p on crank (pin C)"


def wedges(bars):
    links = bars(frame="AC", w="ab", v="cd")
    return [*links, slide("w", on="frame", at="a", through="A"), slide("v", on="w", at="c", through="b"),
            slide("v", on="frame", at="d", through="C", name="top")]  # fmt: skip


def test_loop_of_slides(bars):
    assert faults(*wedges(bars)) == [("over", ("w", "v"), 1), ("under", ("w", "v"), 1)]
    assert faults(*wedges(bars), drive("w")) == [("over", ("w", "v"), 1)]


def test_links_pinned_together_twice_on_the_frame(bars):
    assert faults(*bars(frame="A", x="AB", y="AB")) == [("over", ("x", "y"), 1), ("under", ("x", "y"), 1)]


def test_part_that_is_not_joined_to_the_frame_leaves_the_rest_decomposed(bars):
    loose = bars(e="EH", f="EF", g="FG", h="GH")
    structure = decompose(Mechanism("m", *bars(**FOUR), *loose, drive("crank")))
    assert [group.links for group in structure.groups] == [("coupler", "rocker")]
    (fault,) = structure.faults
    assert (fault.kind, fault.links, fault.amount) == ("under", ("e", "f", "g", "h"), 4)
    assert "to the frame" in fault.remedy
    assert len(structure.pairs) == 8


def test_group_on_an_overdetermined_pin_is_still_found(bars):
    links = bars(frame="AD", crank="AB", coupler="BJ", rocker="JD", tie="JE", end="EF")
    links[0] = link("frame", A=0, D=4, F=9)
    structure = decompose(Mechanism("m", *links, drive("crank"), drive("rocker")))
    assert [group.links for group in structure.groups] == [("tie", "end")]
    assert {f.kind for f in structure.faults} == {"over"}


def test_multiple_pin_in_an_overdetermined_part(bars):
    links = bars(frame="ABCD", p="AJ", q="BJ", r="CJ", s="JE", t="ED")
    structure = decompose(Mechanism("m", *links))
    assert [group.links for group in structure.groups] == [("s", "t")]
    assert structure.groups[0].outer[0].name == "J(p-s)"
    (fault,) = structure.faults
    assert (fault.kind, fault.links, fault.amount) == ("over", ("p", "q", "r"), 1)
    assert len(structure.pairs) == 3 + 3 + 1 + 1
    assert len({pair.name for pair in structure.pairs}) == len(structure.pairs)


def test_several_passive_links_are_separate_faults(bars):
    links = bars(**{**FOUR, "r1": "C", "r2": "B"})
    found = faults(*links, drive("crank"))
    assert sorted(found) == [("under", ("r1",), 1), ("under", ("r2",), 1)]


def test_large_part_without_a_driver_is_named_by_count(plan):
    chain = [[k, k + 1] for k in range(300)]
    (fault,) = decompose(plan(300, chain).build()).faults
    assert (fault.kind, fault.amount, len(fault.links)) == ("under", 300, 300)
    assert fault.text == "k1, k2, k3, k4, k5, k6 and 294 more are left with 300 freedoms"
    assert fault.remedy.startswith("add 300 drivers among: k1 on frame (pin P0), ")


@pytest.mark.parametrize("drivers", [0, 1])
def test_frame_alone_and_one_crank(bars, drivers):
    items = [drive("crank")] * drivers
    structure = decompose(Mechanism("m", *bars(frame="A", crank="AB"), *items))
    assert len(structure.faults) == 1 - drivers
    assert structure.groups == ()
