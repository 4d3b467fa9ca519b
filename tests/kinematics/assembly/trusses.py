"""All Baranov trusses (Assur groups with one more link held) of a number of links, generated; random dimensions."""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator
from itertools import combinations, combinations_with_replacement, product

import networkx as nx
import numpy as np

from compoundkin.kinematics.assembly import Connection, GroupGeometry


def baranov_trusses(links: int) -> list[nx.Graph]:
    """One graph of each truss: links are nodes, pins are edges."""
    found = []
    for m in range(2, links):
        # binary links join larger ones in a truss, never each other: they subdivide a multigraph of the larger links
        binary, joints = links - m, 3 * (links - 1) // 2 - (links - m)
        if 0 <= binary <= joints:
            for contour in _different(_multigraphs(m, joints)):
                found += [graph for graph in _subdivisions(contour, joints - binary) if _is_truss(graph)]
    return list(_different(found))


def _multigraphs(nodes: int, edges: int) -> Iterator[nx.Graph]:
    """Graphs whose edges have a number, every node with three edges or more."""
    for degrees in combinations_with_replacement(range(3, 2 * edges), nodes):
        if sum(degrees) == 2 * edges:
            for joined in _joined(list(degrees), 0):
                graph = nx.Graph()
                graph.add_edges_from((a, b, {"number": n}) for a, b, n in joined)
                yield graph


def _joined(left: list[int], node: int) -> Iterator[list[tuple[int, int, int]]]:
    """All ways to give the nodes from `node` on their remaining degrees."""
    if node == len(left):
        yield []
        return
    later = len(left) - node - 1
    for numbers in product(range(left[node] + 1), repeat=later):
        rest = [*left[: node + 1], *(d - n for d, n in zip(left[node + 1 :], numbers, strict=True))]
        if sum(numbers) == left[node] and min(rest) >= 0:
            own = [(node, node + 1 + k, n) for k, n in enumerate(numbers) if n]
            for others in _joined(rest, node + 1):
                yield own + others


def _subdivisions(contour: nx.Graph, direct: int) -> Iterator[nx.Graph]:
    """A multigraph with a binary link in every edge but `direct` of them; two links share one pin at most."""
    for kept in combinations(contour.edges, direct):
        graph = nx.Graph(kept)
        graph.add_nodes_from(contour)
        for a, b, number in contour.edges(data="number"):
            for _ in range(number - ((a, b) in kept)):
                new = len(graph)
                graph.add_edges_from([(a, new), (new, b)])
        yield graph


def _different(graphs: Iterable[nx.Graph]) -> Iterator[nx.Graph]:
    """One of those that differ by the order of their nodes only."""
    seen: dict[Hashable, list[nx.Graph]] = {}
    for graph in graphs:
        degree = dict(graph.degree(weight="number"))
        key = tuple(sorted((degree[v], tuple(sorted(degree[w] for w in graph[v]))) for v in graph))
        alike = seen.setdefault(key, [])
        if not any(nx.is_isomorphic(graph, other, edge_match=_same_number) for other in alike):
            alike.append(graph)
            yield graph


def _same_number(one: dict[str, int], other: dict[str, int]) -> bool:
    return one.get("number") == other.get("number")


def _is_truss(graph: nx.Graph) -> bool:
    """Rigid, and no part of two links or more is."""
    parts = (part for size in range(2, len(graph)) for part in combinations(graph, size))
    return nx.is_connected(graph) and all(
        2 * sum(a in part and b in part for a, b in graph.edges) <= 3 * len(part) - 4 for part in parts
    )


def truss_assembly(joints: dict[tuple[int, int], complex], held: int) -> GroupGeometry:
    """A truss as drawn: the world is the frame of every link, `held` is the known one."""
    links = sorted({link for joint in joints for link in joint} - {held})
    index = {link: k for k, link in enumerate(links)}
    connections = [Connection((index.get(a), index.get(b)), (p, p)) for (a, b), p in joints.items()]
    return GroupGeometry(len(links), tuple(connections), 4.0)


def random_truss(graph: nx.Graph, rng: np.random.Generator, held: int | None = None) -> GroupGeometry:
    """A truss with random pins, drawn in one of its configurations."""
    held = max(graph, key=graph.degree) if held is None else held
    return truss_assembly({(a, b): complex(*rng.uniform(-4, 4, 2)) for a, b in sorted(graph.edges)}, held)


def from_graph6(text: str) -> nx.Graph:
    """A graph by its name in graph6."""
    return nx.from_graph6_bytes(text.encode())
