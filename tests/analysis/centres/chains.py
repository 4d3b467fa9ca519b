"""All kinematic chains of a number of links, and mechanisms and diagrams made of a chain at given joints."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations, combinations_with_replacement, pairwise

import networkx as nx
import numpy as np

import compoundkin as ck
from compoundkin.analysis.centres.circle_diagram import Diagram, DrivenCentre, Primary
from tests.support import drawn_values

# The numbers of links with more than two pins, by their pins, that mobility 1 allows.
MANY_PINNED = {4: [()], 6: [(3, 3)], 8: [(3, 3, 3, 3), (4, 3, 3), (4, 4)]}
DOUBLE_BUTTERFLY, SINGLE_FLIER = "G?q`qg", "G?qb_w"


def chains(links: int) -> list[nx.Graph]:
    """Every chain of mobility 1 without a rigid part, each once."""
    found: list[nx.Graph] = []
    for degrees in MANY_PINNED[links]:
        for graph in _of_degrees(degrees, links - len(degrees)):
            if nx.is_connected(graph) and not _stiff(graph) and not any(nx.is_isomorphic(graph, g) for g in found):
                found.append(graph)
    return found


def _of_degrees(degrees: tuple[int, ...], binary: int) -> Iterator[nx.Graph]:
    if not degrees:
        yield nx.cycle_graph(binary)
        return
    many = range(len(degrees))
    sides = list(combinations(many, 2))
    for chosen in combinations_with_replacement(sides, sum(degrees) // 2):
        if all(sum(side.count(k) for side in chosen) == degrees[k] for k in many):
            for split in combinations(range(binary + len(chosen) - 1), len(chosen) - 1):
                ends = (-1, *split, binary + len(chosen) - 1)
                graph = _subdivided(chosen, [b - a - 1 for a, b in pairwise(ends)], len(degrees))
                if graph is not None:
                    yield graph


def _subdivided(sides: tuple[tuple[int, int], ...], counts: list[int], first: int) -> nx.Graph | None:
    graph, fresh = nx.Graph(), first
    for (a, b), count in zip(sides, counts, strict=True):
        path = [a, *range(fresh, fresh + count), b]
        fresh += count
        if count == 0 and graph.has_edge(a, b):
            return None
        nx.add_path(graph, path)
    return graph


def _stiff(graph: nx.Graph) -> bool:
    """Whether some links, not all, hold each other rigidly: 2 pins for 3 links less one."""
    nodes, edges = list(graph), [set(edge) for edge in graph.edges]
    return any(
        2 * sum(edge <= part for edge in edges) >= 3 * (len(part) - 1)
        for size in range(2, len(nodes))
        for part in map(set, combinations(nodes, size))
    )


def diagram(graph: nx.Graph) -> Diagram:
    """A chain as a circle diagram, driven at its first pin."""
    edges = sorted(tuple(sorted(edge)) for edge in graph.edges)
    pins = tuple(Primary(f"pin {a}-{b}", f"{a}-{b}", (a, b), "point") for a, b in edges)
    return Diagram(tuple(str(k) for k in sorted(graph)), pins, (DrivenCentre("driver", *edges[0], 0, 1),))


def name(link: int | str) -> str:
    """What a link of a chain is called in its mechanism; link 0 is the frame."""
    return "frame" if int(link) == 0 else f"link{link}"


def mechanism(joints: Mapping[str, complex]) -> ck.Mechanism:
    """A chain as drawn, its joints called "0-4" and so on, with a driver at the first pin of the frame."""
    letters: dict[str, list[str]] = {}
    for joint in joints:
        for link in joint.split("-"):
            letters.setdefault(link, []).append("J" + joint.replace("-", "_"))
    crank = next(joint for joint in joints if joint.startswith("0-")).split("-")[1]
    return ck.Mechanism(
        "chain",
        *[ck.link(name(k), *letters[k]) for k in sorted(letters)],
        ck.drive(name(crank), speed=0.7),
        ck.drawn(**{"J" + joint.replace("-", "_"): place for joint, place in joints.items()}),
    )


def random_mechanism(graph: nx.Graph, seed: int) -> ck.Mechanism:
    """A chain with random joints."""
    rng = np.random.default_rng(seed)
    edges = sorted(tuple(sorted(edge)) for edge in graph.edges)
    return mechanism({f"{a}-{b}": complex(*rng.uniform(-1, 1, 2)) for a, b in edges})


def solved(drawn: ck.Mechanism) -> ck.results.Motion:
    """A mechanism in its drawn pose, with velocities."""
    return ck.solve(drawn, drawn_values(drawn), order=1)
