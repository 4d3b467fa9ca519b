from __future__ import annotations

import random

import networkx as nx
import pytest

from compoundkin.model.elements import drive
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure import decompose, links_by_pairs, loop_count, pair_counts
from compoundkin.structure.cycles import cycle_basis
from compoundkin.structure.mobility_count import Mobility, PairCount


def six_bar(bars):
    links = bars(frame="ADG", ab="AB", bce="BCE", cd="CD", ef="EF", fg="FG")
    return decompose(Mechanism("Stephenson", *links, drive("ab")))


def test_graph(bars):
    structure = six_bar(bars)
    graph = structure.graph
    assert list(graph) == list(structure.mechanism.links)
    assert {key: data["pair"] for *_, key, data in graph.edges(keys=True, data=True)} == {
        pair.name: pair for pair in structure.pairs
    }
    assert dict(graph.degree) == dict(graph.nodes(data="pairs"))
    assert links_by_pairs(structure) == {2: ("ab", "cd", "ef", "fg"), 3: ("frame", "bce")}


def test_links_on_a_multiple_pin_have_one_pair_there(bars):
    structure = decompose(Mechanism("m", *bars(frame="AB", p="AJ", q="BJ", r="JK")))
    assert pair_counts(structure) == {"frame": 2, "p": 2, "q": 2, "r": 1}


def test_loops_read_from_the_frame(bars):
    structure = six_bar(bars)
    assert [str(loop) for loop in structure.loops] == [
        "frame -A- ab -B- bce -C- cd -D- frame",
        "frame -A- ab -B- bce -E- ef -F- fg -G- frame",
    ]
    assert [len(loop) for loop in structure.loops] == [4, 5]
    assert loop_count(structure) == 2


def test_two_pairs_between_two_links_are_a_loop(bars):
    structure = decompose(Mechanism("m", *bars(frame="AB", x="AB")))
    assert [str(loop) for loop in structure.loops] == ["frame -A- x -B- frame"]


def test_loops_of_a_disconnected_mechanism(bars):
    structure = decompose(Mechanism("m", *bars(frame="A", x="A", p="BC", q="BC", r="C")))
    assert loop_count(structure) == len(structure.loops) == 1
    assert str(structure.loops[0]).startswith("p -B- q -")


def test_loops_of_a_large_mechanism_are_closed_and_independent(random_plans):
    plan, _ = random_plans(random.Random(2), 80)
    structure = decompose(plan.build())
    assert len(structure.mechanism.links) > 60
    assert len(structure.loops) == loop_count(structure)
    for loop in structure.loops:
        for k, pair in enumerate(loop.pairs):
            assert set(pair.members) == {loop.links[k], loop.links[(k + 1) % len(loop)]}


@pytest.mark.parametrize("seed", range(25))
def test_basis_is_as_short_as_that_of_networkx(seed):
    graph = nx.gnm_random_graph(9, 14, seed=seed)
    edges = list(graph.edges)
    ours = cycle_basis(9, edges)
    theirs = nx.minimum_cycle_basis(graph)
    assert sorted(map(len, ours)) == sorted(map(len, theirs))
    for cycle in ours:
        assert all(degree == 2 for _, degree in nx.Graph([edges[k] for k in cycle]).degree)
    tree = nx.cycle_basis(graph)
    assert len(ours) == len(tree)


def test_formula_and_verdict(bars):
    mobility = six_bar(bars).mobility
    assert mobility.formula == "F = 3 (n - 1) - 2 p = 3 (6 - 1) - 2 * 7 = 1, p = 7 R"
    assert mobility.verdict == "mobility 1 and 1 driver: the motion is determined"
    geared = Mobility(3, (PairCount("R", 2, 2), PairCount("gear", 1, 1)), 0)
    assert geared.formula == ("F = 3 (n - 1) - 2 p1 - p2 = 3 (3 - 1) - 2 * 2 - 1 = 1, p1 = 2 R, p2 = 1 gear")
    assert Mobility(1, (), 0).formula == "F = 3 (n - 1) = 3 (1 - 1) = 0"
    four_bar = Mobility(4, (PairCount("R", 2, 4),), 4)
    assert four_bar.verdict == "mobility 1 and 4 drivers: 3 drivers are too many"
