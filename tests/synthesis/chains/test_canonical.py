"""Canonical codes against isomorphism by another algorithm, and groups of known order."""

from __future__ import annotations

from math import factorial

import networkx as nx
import pytest
from hypothesis import given
from hypothesis import strategies as st

from compoundkin.synthesis.chains import Canonical, Coloured, canonical

# Orders of automorphism groups that are in every textbook.
GROUPS = {
    "petersen": (nx.petersen_graph(), 120),
    "heawood": (nx.heawood_graph(), 336),
    "frucht": (nx.frucht_graph(), 1),
    "cube": (nx.hypercube_graph(3), 48),
    "desargues": (nx.desargues_graph(), 240),
    "dodecahedron": (nx.dodecahedral_graph(), 120),
    "tutte": (nx.tutte_graph(), 3),
    "complete": (nx.complete_graph(7), factorial(7)),
    "utility": (nx.complete_bipartite_graph(3, 3), 72),
    "loop of 40": (nx.cycle_graph(40), 80),
    "three triangles": (nx.disjoint_union_all([nx.complete_graph(3)] * 3), 6**3 * 6),
    "rook": (nx.line_graph(nx.complete_bipartite_graph(4, 4)), 1152),
}


def shrikhande() -> nx.Graph:
    """Strongly regular as the rook's graph of a 4 by 4 board is, but another graph (S. S. Shrikhande, 1959)."""
    steps = ((1, 0), (0, 1), (1, 1))
    edges = [((i, j), ((i + a) % 4, (j + b) % 4)) for i in range(4) for j in range(4) for a, b in steps]
    return nx.Graph(edges)


# Regular of one degree, so that counting neighbours tells no two vertices apart in either.
ALIKE = {
    "hexagon and two triangles": (nx.cycle_graph(6), nx.disjoint_union(nx.cycle_graph(3), nx.cycle_graph(3))),
    "prism and utility graph": (nx.circular_ladder_graph(3), nx.complete_bipartite_graph(3, 3)),
    "dodecahedron and desargues": (nx.dodecahedral_graph(), nx.desargues_graph()),
    "rook and shrikhande": (nx.line_graph(nx.complete_bipartite_graph(4, 4)), shrikhande()),
}


def form(graph: nx.Graph) -> Canonical:
    graph = nx.convert_node_labels_to_integers(graph)
    return canonical(Coloured.of([graph.nodes[v].get("colour", "") for v in graph], graph.edges))


@st.composite
def coloured_graphs(draw, most: int = 7) -> nx.Graph:
    size = draw(st.integers(1, most))
    graph = nx.Graph()
    for vertex in range(size):
        graph.add_node(vertex, colour=draw(st.sampled_from("ab")))
    places = [(a, b) for b in range(size) for a in range(b)]
    graph.add_edges_from(draw(st.lists(st.sampled_from(places), unique=True)) if places else [])
    return graph


def renumbered(graph: nx.Graph, order: list[int]) -> nx.Graph:
    """The same graph with its vertices in another order; `order[k]` is what vertex k becomes."""
    other = nx.Graph()
    for vertex in sorted(graph, key=order.__getitem__):
        other.add_node(order[vertex], **graph.nodes[vertex])
    other.add_edges_from((order[a], order[b]) for a, b in graph.edges)
    return other


def matcher(first: nx.Graph, second: nx.Graph) -> nx.isomorphism.GraphMatcher:
    return nx.isomorphism.GraphMatcher(first, second, nx.isomorphism.categorical_node_match("colour", ""))


@given(st.data())
def test_the_code_does_not_depend_on_the_numbering(data):
    graph = data.draw(coloured_graphs(most=12))
    order = data.draw(st.permutations(range(len(graph))))
    assert form(renumbered(graph, order)).code == form(graph).code


@given(coloured_graphs(), coloured_graphs())
def test_codes_are_equal_exactly_for_isomorphic_graphs(first, second):
    assert (form(first).code == form(second).code) == matcher(first, second).is_isomorphic()


@given(coloured_graphs(most=6))
def test_the_symmetries_are_those_that_trying_all_finds(graph):
    found = form(graph)
    every = [tuple(m[v] for v in range(len(graph))) for m in matcher(graph, graph).isomorphisms_iter()]
    assert found.symmetries == len(every)
    assert set(found.generators) <= set(every)
    carried = {tuple(sorted({m[v] for m in every})) for v in graph}
    assert set(found.orbits) == carried


@pytest.mark.parametrize("name", GROUPS)
def test_groups_of_known_order(name):
    graph, order = GROUPS[name]
    assert form(graph).symmetries == order


@pytest.mark.parametrize("name", ALIKE)
def test_graphs_that_counting_neighbours_cannot_tell_apart(name):
    first, second = ALIKE[name]
    assert len({degree for graph in (first, second) for _, degree in graph.degree}) == 1
    assert len(first) == len(second)
    assert form(first).code != form(second).code


def test_colours_are_not_mistaken_for_numbers():
    assert canonical(Coloured.of(["1a"], [])).code != canonical(Coloured.of(["a"] * 11, [])).code
    assert canonical(Coloured.of(["a", "b"], [])).code != canonical(Coloured.of(["a", "a"], [])).code
