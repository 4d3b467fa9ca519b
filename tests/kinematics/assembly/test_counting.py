"""The exact number against a second way: the Laman number of the triangulated graph; and all nine-link trusses."""

from collections import Counter
from itertools import pairwise

import networkx as nx
import numpy as np
import pytest

from compoundkin.kinematics.assembly import Connection, GroupGeometry, all_configurations, exact_count
from tests.kinematics.assembly.laman import laman_number
from tests.kinematics.assembly.trusses import baranov_trusses, random_truss
from tests.support import reference


def triangulated(links: list[list[int]]) -> tuple[list[tuple[int, int]], int]:
    """A graph of joints in which each link, given by its joints, is a fan; and in how many ways the fans fold."""
    edges = [(joints[0], joint) for joints in links for joint in joints[1:]]
    edges += [pair for joints in links for pair in pairwise(joints[1:])]
    return edges, 2 ** sum(len(joints) - 2 for joints in links)


def merged(graph: nx.Graph, link: int, one: int, other: int) -> tuple[GroupGeometry, list[list[int]]]:
    """A truss in which two pins of a link are one, a multiple pin; and the joints of every link."""
    rng = np.random.default_rng(0)
    joints = {edge: k for k, edge in enumerate(sorted(tuple(sorted(e)) for e in graph.edges))}
    joints[tuple(sorted((link, other)))] = joints[tuple(sorted((link, one)))]
    at = rng.standard_normal((len(joints), 2)) @ [1, 1j]
    links = [sorted({k for edge, k in joints.items() if v in edge}) for v in graph]
    held = next(v for v in graph if v not in (link, one, other) and len(links[v]) > 2)
    index = {v: k for k, v in enumerate(v for v in graph if v != held)}
    connections = [Connection((index.get(a), index.get(b)), (at[k], at[k])) for (a, b), k in joints.items()]
    return GroupGeometry(len(index), tuple(connections), 1.0), links


@pytest.mark.parametrize("links", [5, 7])
def test_multiple_pins(links):
    graph = baranov_trusses(links)[0]
    link = max(graph, key=graph.degree)
    one, other = sorted(graph[link])[:2]
    geometry, joints = merged(graph, link, one, other)
    edges, folds = triangulated(joints)
    number = laman_number(edges)
    assert number > 0
    assert exact_count(geometry.graph()) == number // folds
    assert all_configurations(geometry).count == number // folds


def test_a_truss_by_its_triangulated_graph():
    [graph] = baranov_trusses(5)
    numbers = {tuple(sorted(edge)): k for k, edge in enumerate(graph.edges)}
    edges, folds = triangulated([[k for edge, k in numbers.items() if v in edge] for v in graph])
    assert laman_number(edges) == folds * exact_count(random_truss(graph, np.random.default_rng(0)).graph())


def test_graphs_that_are_not_rigid_have_none():
    assert laman_number([(0, 1), (1, 2), (2, 3), (3, 0)]) == 0
    assert laman_number([(a, b) for a in range(4) for b in range(a)]) == 0


@pytest.mark.full
def test_all_nine_link_trusses():
    """The distribution of their numbers of modes, and every one solved with random dimensions."""
    text = reference("counts_assembly_modes_baranov", "assembly_modes")["how_checked"].split("multiset: ")[1]
    expected = Counter()
    for item in text.split(","):
        modes, _, times = item.partition("x")
        expected[int(modes)] += int(times or 1)
    trusses = baranov_trusses(9)
    assert len(trusses) == reference("counts_baranov", "counts")["expected"]["9"]
    found = [all_configurations(random_truss(graph, np.random.default_rng(k))) for k, graph in enumerate(trusses)]
    assert Counter(one.possible for one in found) == expected
    assert all(one.certified for one in found)
