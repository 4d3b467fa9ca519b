"""The shipped list is what the generator makes; numbers of inversions and Assur groups are the published ones."""

from __future__ import annotations

import networkx as nx
import pytest

from compoundkin.synthesis.chains import Chain, assur_groups, chains, inversions, number_of, trusses
from compoundkin.synthesis.chains.chain_atlas import FILE, MOBILITIES, MOST_LINKS, list_lines, read_lists, write_list
from tests.synthesis.chains.counts import COUNTS


def test_the_shipped_list_is_what_is_made(tmp_path):
    copy = tmp_path / "chains.txt"
    assert write_list(copy) == len(list(list_lines()))
    assert copy.read_text(encoding="ascii") == FILE.read_text(encoding="ascii")


def test_its_lines_are_what_they_say():
    for (links, mobility), listed in read_lists(FILE.read_text(encoding="ascii").splitlines()).items():
        assert all((chain.links, chain.mobility, chain.is_connected) == (links, mobility, True) for chain in listed)
        assert mobility in MOBILITIES
        assert links <= MOST_LINKS


# The numbers are names: these stay what they are.
@pytest.mark.parametrize(
    ("code", "number"), [("G?DlU_", 1), ("G?LTMO", 3), ("G@Q?~C", 16), ("C]", 1), ("DFw", 1), ("FK`fO", None)]
)
def test_numbers_stay(code, number):
    assert number_of(Chain.from_code(code)) == number


def test_a_number_is_found_for_any_numbering_of_the_links():
    for number, chain in enumerate(chains(8), 1):
        assert number_of(Chain.of(8, [(7 - a, 7 - b) for a, b in chain.pairs])) == number


def test_a_chain_in_no_list_has_no_number():
    assert number_of(Chain.of(12, [(k, (k + 1) % 12) for k in range(12)])) is None


@pytest.mark.parametrize("links", [4, 6, 8, 10])
def test_numbers_of_inversions(links):
    assert len(inversions(links)) == COUNTS["counts_inversions"][str(links)]


@pytest.mark.parametrize("links", [2, 4, 6, 8])
def test_numbers_of_assur_groups(links):
    groups = assur_groups(links)
    assert len(groups) == COUNTS["counts_assur_groups"][str(links)]
    assert len({group.code for group in groups}) == len(groups)


@pytest.mark.parametrize("group", [g for n in (2, 4, 6) for g in assur_groups(n)], ids=lambda g: g.code)
def test_a_group_takes_no_mobility_and_no_part_of_it_does(group):
    """Attached to one frame it is rigid; any part that is attached alone, with all else away, has mobility."""
    graph = group.graph()
    assert 3 * len(graph) == 2 * (graph.number_of_edges() + sum(n for _, n in graph.nodes(data="outer")))
    assert (graph.number_of_edges(), len(graph)) == (group.inner, group.links)
    for links in nx.connected_components(graph):
        assert links == set(graph)
    for number in range(1, 2 ** len(graph) - 1):
        part = [link for k, link in enumerate(graph) if number >> k & 1]
        held = graph.subgraph(part).number_of_edges() + sum(graph.nodes[link]["outer"] for link in part)
        assert 3 * len(part) > 2 * held


def test_larger_lists_are_made_when_they_are_asked_for():
    assert len(chains(9, mobility=4)) == 10
    assert chains(9, mobility=4) is chains(9, mobility=4)


def test_trusses_are_rigid_only_as_a_whole():
    assert all(truss.mobility == 0 and not truss.joints_of_parts for truss in trusses(9))
