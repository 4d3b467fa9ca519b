"""Sets that are joined, and independent cycles of a multigraph. A shortest basis, or a quick one for large graphs."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from typing import Protocol, TypeAlias, TypeVar

T = TypeVar("T")
Edges: TypeAlias = Sequence[tuple[int, int]]

# Beyond this many nodes the shortest basis (work as their cube) gives way to that of a spanning tree.
SHORTEST_BASIS_UP_TO = 60


class Leaders(Protocol[T]):
    """What leads from each member of a set towards its representative. A list, or a dictionary."""

    def __getitem__(self, member: T, /) -> T:
        """Return the next one on the way."""

    def __setitem__(self, member: T, leader: T, /) -> None:
        """Shorten the way."""


def find(leader: Leaders[T], member: T) -> T:
    """Return the representative of the set that a member belongs to. Ways are halved as they are gone.

    >>> find([0, 0, 1, 3], 2), find({"a": "b", "b": "b"}, "a")
    (0, 'b')
    """
    while leader[member] != member:
        leader[member] = leader[leader[member]]
        member = leader[member]
    return member


def cycle_basis(nodes: int, edges: Edges) -> list[tuple[int, ...]]:
    """Return a basis of independent cycles, each as its edges in order.

    Each starts at its least node.
    Of least total length up to SHORTEST_BASIS_UP_TO nodes. Source: J. D. Horton, A polynomial-time algorithm
    to find the shortest cycle basis of a graph, SIAM J. Comput. 16 (1987) 358.

    >>> cycle_basis(3, [(0, 1), (1, 2), (2, 0), (0, 1)])
    [(0, 3), (0, 1, 2)]
    """
    around: list[list[int]] = [[] for _ in range(nodes)]
    for k, (a, b) in enumerate(edges):
        around[a].append(k)
        around[b].append(k)
    if nodes > SHORTEST_BASIS_UP_TO:
        chosen = _closed_by_tree(nodes, edges, around)
    else:
        wanted = len(edges) - sum(1 for k in _forest(nodes, edges, around)[0] if k >= 0)
        chosen = [_members(cycle) for cycle in _independent(_candidates(nodes, edges, around), wanted)]
    return [_in_order(cycle, edges) for cycle in chosen]


def _candidates(nodes: int, edges: Edges, around: list[list[int]]) -> list[int]:
    """Horton's cycles, shortest first. Two shortest paths from a node and the edge that joins their ends.

    Sets of edges are written as the bits of a number.
    """
    found: dict[int, None] = {}
    for root in range(nodes):
        paths = _paths(root, edges, around)
        for k, (a, b) in enumerate(edges):
            if a in paths and b in paths and (cycle := paths[a] ^ paths[b] ^ (1 << k)):
                found[cycle] = None
    return sorted(found, key=int.bit_count)


def _paths(root: int, edges: Edges, around: list[list[int]]) -> dict[int, int]:
    """Return the edges of a shortest path from a node to each other."""
    paths = {root: 0}
    queue = deque([root])
    while queue:
        node = queue.popleft()
        for k in around[node]:
            other = _across(edges[k], node)
            if other not in paths:
                paths[other] = paths[node] | 1 << k
                queue.append(other)
    return paths


def _independent(cycles: Sequence[int], wanted: int) -> list[int]:
    """Return the first cycles that are independent, by elimination modulo two."""
    pivots: dict[int, int] = {}
    chosen: list[int] = []
    for cycle in cycles:
        if len(chosen) == wanted:
            break
        vector = cycle
        while vector and vector.bit_length() in pivots:
            vector ^= pivots[vector.bit_length()]
        if vector:
            pivots[vector.bit_length()] = vector
            chosen.append(cycle)
    return chosen


def _members(cycle: int) -> list[int]:
    return [k for k in range(cycle.bit_length()) if cycle >> k & 1]


def _closed_by_tree(nodes: int, edges: Edges, around: list[list[int]]) -> list[list[int]]:
    """Return the cycles that the edges outside a breadth-first forest close."""
    parent, depth = _forest(nodes, edges, around)
    in_tree = set(parent)
    return [_closed(k, edges, parent, depth) for k in range(len(edges)) if k not in in_tree]


def _forest(nodes: int, edges: Edges, around: list[list[int]]) -> tuple[list[int], list[int]]:
    """Return each node's edge to its parent in a breadth-first forest, and depths. The edge is -1 at a root."""
    parent, depth = [-1] * nodes, [-1] * nodes
    for root in range(nodes):
        if depth[root] >= 0:
            continue
        depth[root] = 0
        queue = deque([root])
        while queue:
            node = queue.popleft()
            for k in around[node]:
                other = _across(edges[k], node)
                if depth[other] < 0:
                    depth[other], parent[other] = depth[node] + 1, k
                    queue.append(other)
    return parent, depth


def _closed(k: int, edges: Edges, parent: list[int], depth: list[int]) -> list[int]:
    cycle = [k]
    a, b = edges[k]
    while a != b:
        if depth[a] < depth[b]:
            a, b = b, a
        cycle.append(parent[a])
        a = _across(edges[parent[a]], a)
    return sorted(cycle)


def _across(edge: tuple[int, int], node: int) -> int:
    return edge[1] if edge[0] == node else edge[0]


def _in_order(cycle: Sequence[int], edges: Edges) -> tuple[int, ...]:
    """Return the edges of a cycle in order around it from its least node. It starts by its first edge."""
    meeting: dict[int, list[int]] = {}
    for k in cycle:
        for node in edges[k]:
            meeting.setdefault(node, []).append(k)
    node = min(meeting)
    ordered = [meeting[node][0]]
    while len(ordered) < len(cycle):
        node = _across(edges[ordered[-1]], node)
        first, second = meeting[node]
        ordered.append(second if first == ordered[-1] else first)
    return tuple(ordered)
