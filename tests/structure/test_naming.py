from __future__ import annotations

import pytest

from compoundkin.model.elements import drive, link
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs.prismatic import slide
from compoundkin.structure import decompose, roman


def only_group(*items):
    (group,) = decompose(Mechanism("m", *items)).groups
    return group


def described(group):
    return group.name, group.class_, group.order


def test_stephenson_driven_at_its_far_side_is_a_class_iii_triad(bars):
    links = bars(frame="ADG", ab="AB", bce="BCE", cd="CD", ef="EF", fg="FG")
    group = only_group(*links, drive("fg"))
    assert described(group) == ("RRR-RRR", 3, 3)
    assert group.links == ("ab", "bce", "cd", "ef")
    assert group.uses == ("frame", "fg")


def test_tetrad_is_class_iv_of_order_two(bars):
    group = only_group(*bars(frame="AB", s="ACD", t="BEF", c="CE", d="DF"))
    assert described(group) == ("RR-RRRR", 4, 2)


@pytest.mark.parametrize(
    ("near", "between", "far", "name"),
    [("R", "R", "R", "RRR"), ("R", "R", "P", "RRP"), ("P", "R", "R", "RRP"), ("R", "P", "R", "RPR"),
     ("P", "R", "P", "PRP"), ("R", "P", "P", "RPP"), ("P", "P", "R", "RPP")],
)  # fmt: skip
def test_dyads_are_named_from_the_end_that_comes_first(near, between, far, name):
    points = {"frame": {"O": 0j}, "x": {"u": 0j}, "y": {"v": 0j}}
    items = []
    for k, (kind, a, b) in enumerate([(near, "frame", "x"), (between, "x", "y"), (far, "frame", "y")]):
        if kind == "R":
            points[a][f"P{k}"] = points[b][f"P{k}"] = complex(k + 1, k * k)
        else:
            points[a][f"S{k}"], points[b][f"T{k}"] = complex(k, 3), complex(k, -2)
            items.append(slide(b, on=a, at=f"T{k}", through=f"S{k}", angle=float(k), name=f"s{k}"))
    group = only_group(*(link(n, **p) for n, p in points.items()), *items)
    assert described(group) == (name, 2, 2)
    assert "".join(p.code for p in (group.outer[0], group.inner[0], group.outer[1])) == name
    for body, pair in zip(group.bodies, group.outer, strict=True):
        assert body.links[0] in pair.members
    if name[0] == name[2]:
        assert group.links == ("x", "y")


def test_roman():
    assert [roman(k) for k in (1, 3, 4, 6, 9, 14)] == ["I", "III", "IV", "VI", "IX", "XIV"]
