"""Chains by contraction against published numbers, and against all graphs there are."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

import compoundkin as ck
from compoundkin.synthesis.chains import Chain, Coloured, canonical, chains, chains_of, generation, inversions, trusses
from tests.synthesis.chains.counts import COUNTS

# E. R. Tuttle, Mechanism and Machine Theory 31 (1996) 729: chains that are not fractionated, by mobility and links.
NOT_FRACTIONATED = {(2, 5): 1, (2, 7): 3, (2, 9): 35, (2, 11): 753, (3, 6): 1, (3, 8): 5, (3, 10): 74}


def moves(graph: nx.Graph, mobility: int) -> bool:
    """Whether a graph is a chain of a mobility without a rigid part, each set of links looked at."""
    if not nx.is_connected(graph) or min(dict(graph.degree).values()) < 2:
        return False
    if 3 * (len(graph) - 1) - 2 * graph.number_of_edges() != mobility:
        return False
    parts = (part for size in range(2, len(graph)) for part in combinations(graph, size))
    return all(3 * (len(part) - 1) - 2 * graph.subgraph(part).number_of_edges() > 0 for part in parts)


@pytest.mark.parametrize("mobility", range(4))
def test_up_to_seven_links_they_are_all_that_there_are(mobility):
    every = [g for g in nx.graph_atlas_g() if len(g) > 2 and moves(g, mobility)]
    expected = sorted(Chain.of(len(g), g.edges).code for g in every)
    found = [chain for links in range(3, 8) for chain in chains_of(links, mobility, bridged=True)]
    assert sorted(chain.code for chain in found) == expected
    assert len(set(expected)) == len(expected) > 0


@pytest.mark.parametrize("links", [4, 6, 8, 10])
def test_chains_of_mobility_one_by_assortment(links):
    chains = chains_of(links)
    expected = COUNTS["counts_1dof_chains"]["by_assortment(n2,n3,n4,...)"][str(links)]
    found = [str(chain.assortment) for chain in chains]
    assert {text: found.count(text) for text in found} == expected
    assert len(chains) == COUNTS["counts_1dof_chains"][str(links)]
    assert len({chain.code for chain in chains}) == len(chains)


@pytest.mark.parametrize("links", [3, 5, 7, 9])
def test_trusses_are_those_of_another_enumeration(links):
    trusses = chains_of(links, mobility=0)
    listed = COUNTS["counts_baranov"]["graph6_5_7_9"][str(links)]
    assert {chain.code for chain in trusses} == {Chain.from_code(text).code for text in listed}
    assert len(trusses) == len(listed) == COUNTS["counts_baranov"][str(links)]


@pytest.mark.parametrize(("mobility", "links"), NOT_FRACTIONATED)
def test_chains_of_higher_mobility_that_are_not_fractionated(mobility, links):
    chains = chains_of(links, mobility)
    whole = [chain for chain in chains if not chain.joints_of_parts]
    assert len(whole) == NOT_FRACTIONATED[mobility, links]
    assert all(nx.is_biconnected(nx.Graph(chain.graph())) for chain in whole)


def test_fractionated_chains_are_all_ways_of_joining_smaller_ones():
    """Two chains share a link: one of the equivalent links of the one with one of the other."""
    apart = [chain for chain in chains_of(9, mobility=2) if chain.joints_of_parts]
    four, six = chains_of(4), chains_of(6)
    joined = sum(len(chain.inversions) for chain in six) * sum(len(chain.inversions) for chain in four)
    assert len(apart) == joined == 5


def test_bridged_chains_are_all_ways_of_pinning_smaller_ones_together():
    four, six = chains_of(4), chains_of(6)
    bridged = len(chains_of(10, mobility=3, bridged=True)) - len(chains_of(10, mobility=3))
    assert bridged == sum(len(chain.inversions) for chain in six) * len(four[0].inversions) == 5


@pytest.mark.parametrize(("links", "mobility"), [(5, 1), (4, 2), (3, 1), (2, 1)])
def test_there_are_none_where_the_count_does_not_come_out(links, mobility):
    assert chains_of(links, mobility) == ()


@pytest.mark.parametrize("chain", chains_of(8), ids=lambda chain: chain.code)
def test_inversions_are_the_different_ways_of_marking_a_link(chain):
    """Marked graphs compared by another algorithm."""
    marked = []
    for link in range(chain.links):
        graph = nx.Graph(chain.pairs)
        nx.set_node_attributes(graph, {k: k == link for k in graph}, "frame")
        if not any(nx.is_isomorphic(graph, m, node_match=lambda a, b: a["frame"] == b["frame"]) for m in marked):
            marked.append(graph)
    assert len(chain.inversions) == len(marked)


@given(st.sampled_from(chains_of(8)), st.integers(0, 7))
def test_places_of_a_driver_are_the_different_ways_of_marking_a_pair(chain, frame):
    codes = set()
    for first, second in chain.pairs:
        marks = [str((link == frame, link in (first, second))) for link in range(chain.links)]
        # the marked pair as a vertex of its own: which pair of two marked links is meant
        edges = [*chain.pairs, (first, chain.links), (second, chain.links)]
        codes.add(canonical(Coloured.of([*marks, "driven"], edges)).code)
    assert len(chain.equivalent_pairs(frame)) == len(codes)


@given(st.sampled_from(chains_of(8)), st.permutations(range(8)))
def test_a_chain_keeps_its_code_when_it_is_renumbered(chain, order):
    other = Chain.of(8, [(order[a], order[b]) for a, b in chain.pairs])
    assert (other.code, other.symmetries, other.assortment) == (chain.code, chain.symmetries, chain.assortment)
    assert other.variety == chain.variety == 0


@given(st.integers(1, 9), st.data())
def test_graph6_is_read_and_written_as_others_do(links, data):
    places = [(a, b) for b in range(links) for a in range(b)]
    pairs = data.draw(st.lists(st.sampled_from(places), unique=True)) if places else []
    graph = nx.empty_graph(links)
    graph.add_edges_from(pairs)
    text = nx.to_graph6_bytes(graph, header=False).decode().strip()
    assert Chain.of(links, pairs).graph6 == text
    assert Chain.from_code(text) == Chain.of(links, pairs)


@pytest.mark.parametrize("chain", chains_of(7, mobility=2), ids=lambda chain: chain.code)
def test_variety_of_seven_links_tells_whether_there_is_a_four_bar_loop(chain):
    shortest = min(len(loop) for loop in nx.minimum_cycle_basis(nx.Graph(chain.pairs)))
    assert chain.variety == (1 if shortest == 4 else 0)


def test_a_rigid_part_is_found():
    triangle = Chain.of(5, [(0, 1), (1, 2), (2, 0), (2, 3), (3, 4), (4, 0)])
    assert triangle.has_rigid_part
    assert not any(chain.has_rigid_part for chain in chains_of(8))


@pytest.mark.parametrize(
    "call",
    [
        lambda: trusses(13),
        lambda: chains(12),
        lambda: chains(100),
        lambda: inversions(14),
        lambda: chains_of(13, mobility=0),
        lambda: chains_of(20, mobility=5),
    ],
)
def test_more_chains_than_are_made_in_seconds_are_refused(call) -> None:
    with pytest.raises(ck.errors.InvalidInput, match=r"take half a minute to hours; ask for 1[01], or be patient=True"):
        call()


def test_the_patient_get_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(generation, "MOST_MADE", {1: 6})
    with pytest.raises(ck.errors.InvalidInput, match="ask for 6"):
        chains_of(8)
    assert len(chains_of(8, patient=True)) == 16
