"""The Laman number of a graph, by the same recursion as that of groups: a second way to their numbers."""

from __future__ import annotations

from collections.abc import Iterable

from compoundkin.kinematics.assembly.elimination import Rank, intersections


def laman_number(edges: Iterable[tuple[int, int]]) -> int:
    """Count the realizations of a minimally rigid graph in the plane, over the complex numbers.

    Up to direct motions; mirror images are counted apart. Zero where the graph is not minimally rigid.

    >>> laman_number([(0, 1), (1, 2), (2, 0)])
    2
    """
    edges = tuple(edges)
    return intersections(len(edges), *[_graph_rank(edges)] * 2)


def _graph_rank(edges: tuple[tuple[int, int], ...]) -> Rank:
    """Return the ranks of the edges of a graph: nodes less components."""

    def rank(elements: int) -> int:
        root = {node: node for edge in edges for node in edge}

        def find(node: int) -> int:
            while root[node] != node:
                node = root[node]
            return node

        joined = 0
        for k, (a, b) in enumerate(edges):
            if elements >> k & 1 and find(a) != find(b):
                root[find(a)] = find(b)
                joined += 1
        return joined

    return rank
