from __future__ import annotations

import random
from itertools import product

import networkx as nx
import pytest

from compoundkin.structure.matching import (
    FREE,
    maximum_matching,
    overdetermined,
    solving_order,
    strong_components,
    underdetermined,
)


def random_system(seed):
    r = random.Random(seed)
    freedoms = [r.choice((1, 2, 3)) for _ in range(r.randint(1, 12))]
    most = min(len(freedoms), 3)
    rows = [tuple(r.sample(range(len(freedoms)), r.randint(0, most))) for _ in range(r.randint(0, 30))]
    return rows, freedoms


def size_by_flow(rows, freedoms):
    graph = nx.DiGraph()
    graph.add_nodes_from("st")
    for k, unknowns in enumerate(rows):
        graph.add_edge("s", ("row", k), capacity=1)
        graph.add_edges_from(((("row", k), u) for u in unknowns), capacity=1)
    for u, freedom in enumerate(freedoms):
        graph.add_edge(u, "t", capacity=freedom)
    return nx.maximum_flow_value(graph, "s", "t")


@pytest.mark.parametrize("seed", range(60))
def test_matching_is_maximum_and_the_parts_are_those_of_dulmage_and_mendelsohn(seed):
    rows, freedoms = random_system(seed)
    matching = maximum_matching(rows, freedoms)
    size = sum(owner != FREE for owner in matching.owner)
    assert size == size_by_flow(rows, freedoms)
    assert [len(owned) + room for owned, room in zip(matching.owned, matching.room, strict=True)] == freedoms
    over, under = overdetermined(matching), underdetermined(matching)
    for u in range(len(freedoms)):
        less = [f - (k == u) for k, f in enumerate(freedoms)]
        more = [f + (k == u) for k, f in enumerate(freedoms)]
        assert over[u] == (size_by_flow(rows, more) > size)
        assert under[u] == (size_by_flow(rows, less) == size)


@pytest.mark.parametrize("seed", range(20))
def test_components_and_their_order(seed):
    graph = nx.gnp_random_graph(14, 0.12, seed=seed, directed=True)
    successors = [sorted(graph.successors(k)) for k in graph]
    components = strong_components(successors)
    theirs = nx.strongly_connected_components(graph)
    assert {frozenset(c) for c in components} == {frozenset(c) for c in theirs}
    order = solving_order(components, successors, [c[0] for c in components])
    place = {node: i for i, k in enumerate(order) for node in components[k]}
    assert len(place) == 14
    assert all(place[b] <= place[a] for a, b in graph.edges)


def test_long_dependency_chains_do_not_recurse():
    count = 50_000
    assert len(strong_components([[k + 1] for k in range(count - 1)] + [[]])) == count
    rows = [(k, k + 1) for k in range(count - 1)] + [(0,)]
    assert FREE not in maximum_matching(rows, [1] * count).owner


def test_small_systems_exhaustively():
    for rows in product([(0,), (1,), (0, 1), ()], repeat=3):
        matching = maximum_matching(rows, [1, 1])
        assert sum(o != FREE for o in matching.owner) == size_by_flow(rows, [1, 1])
