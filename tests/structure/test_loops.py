"""Loops counted by Euler's relation, and all simple loops against a second way of finding them."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import pytest

from compoundkin.structure import decompose, independent_loops, loop_count, simple_loops
from compoundkin.synthesis.composer import random_mechanism
from tests import catalog


@catalog.each(catalog.NAMES)
def test_euler(name):
    structure = catalog.structure(name)
    pieces = nx.number_connected_components(nx.Graph(structure.graph))
    links, pairs = len(structure.mechanism.links), len(structure.pairs)
    assert loop_count(structure) == len(independent_loops(structure)) == pairs - links + pieces


@pytest.mark.parametrize("groups", [5, 40, 120])
def test_euler_for_large_ones(groups):
    structure = decompose(random_mechanism(groups, seed=groups))
    assert len(structure.loops) == len(structure.pairs) - len(structure.mechanism.links) + 1 == groups


def by_sums(structure) -> set[frozenset[str]]:
    """All simple loops as those sums of independent ones that are single closed chains."""
    basis = [frozenset(pair.name for pair in loop.pairs) for loop in independent_loops(structure)]
    found = set()
    for size in range(1, len(basis) + 1):
        for chosen in combinations(basis, size):
            total: frozenset[str] = frozenset()
            for cycle in chosen:
                total = total ^ cycle
            pairs = [pair for pair in structure.pairs if pair.name in total]
            graph = nx.MultiGraph([pair.members[:2] for pair in pairs])
            if pairs and nx.is_connected(graph) and all(degree == 2 for _, degree in graph.degree):
                found.add(total)
    return found


@pytest.mark.parametrize("name", ["six-bar", "watt-ii", "peaucellier", "geared-five-bar", "3-rrr", "toggle-press"])
def test_simple_loops_are_the_closed_sums_of_independent_ones(name):
    structure = catalog.structure(name)
    found = list(simple_loops(structure))
    assert {frozenset(pair.name for pair in loop.pairs) for loop in found} == by_sums(structure)
    assert len(found) == len({str(loop) for loop in found})
    for loop in found:
        assert len(set(loop.links)) == len(loop.links)
        for k, pair in enumerate(loop.pairs):
            assert {loop.links[k], loop.links[(k + 1) % len(loop)]} == set(pair.members[:2])


def test_they_come_one_by_one_from_a_mechanism_with_far_too_many():
    structure = decompose(random_mechanism(300, seed=3))
    assert len(list(simple_loops(structure, limit=50))) == 50
    assert all(len(loop) <= 5 for loop in simple_loops(structure, limit=5, longest=5))
