"""The kinematic graph, links as nodes and pairs as edges, and its loops. Closed chains of links and pairs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Protocol

from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.pairs import Pair
from compoundkin.structure.cycles import cycle_basis, find

if TYPE_CHECKING:
    import networkx as nx


class LinksAndPairs(Protocol):
    """A mechanism with all its pairs, as a structure holds them. A multiple pin of k links is k - 1 pairs."""

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism as written."""

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """All its pairs, the pins among them."""


@dataclass(frozen=True)
class Loop:
    """A closed chain of links, `pairs[k]` between `links[k]` and the next.

    It starts at the frame where it contains it.
    """

    links: tuple[str, ...]
    pairs: tuple[Pair, ...]

    def __len__(self) -> int:
        return len(self.links)

    def __str__(self) -> str:
        steps = (f"{link} -{pair.name}- " for link, pair in zip(self.links, self.pairs, strict=True))
        return "".join(steps) + self.links[0]


def kinematic_graph(structure: LinksAndPairs) -> nx.MultiGraph:
    """Return the graph of links as nodes and pairs as edges.

    Attribute `pairs` says how many a link has. Edges are keyed by the pairs' names.
    Edges have the attributes `pair` and `code`. A multiple pin of k links is k - 1 edges.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> structure = decompose(Mechanism("m", link("frame", A=0), link("crank", A=0, B=1)))
    >>> list(kinematic_graph(structure).edges(keys=True, data="code"))
    [('frame', 'crank', 'A', 'R')]
    """
    import networkx

    graph = networkx.MultiGraph(title=structure.mechanism.title)
    for name, count in pair_counts(structure).items():
        graph.add_node(name, pairs=count)
    for pair in structure.pairs:
        first, second = pair.members[:2]
        graph.add_edge(first, second, key=pair.name, pair=pair, code=pair.code)
    return graph


def pair_counts(structure: LinksAndPairs) -> dict[str, int]:
    """Return how many pairs each link has. At a pin of several links each of them counts one.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> links = [link(name, J=0) for name in ("frame", "crank", "rod")]
    >>> pair_counts(decompose(Mechanism("m", *links)))
    {'frame': 1, 'crank': 1, 'rod': 1}
    """
    mechanism = structure.mechanism
    counts = dict.fromkeys(mechanism.links, 0)
    for names in mechanism.pins.values():
        for name in names:
            counts[name] += 1
    for pair in mechanism.written_pairs:
        for name in pair.members[:2]:
            counts[name] += 1
    return counts


def links_by_pairs(structure: LinksAndPairs) -> dict[int, tuple[str, ...]]:
    """Return the links by their number of pairs: singular, binary, ternary and so on.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> bars = link("frame", A=0, B=1), link("crank", A=0, C=1), link("rod", C=0)
    >>> links_by_pairs(decompose(Mechanism("m", *bars)))
    {1: ('frame', 'rod'), 2: ('crank',)}
    """
    counts = pair_counts(structure)
    return {k: tuple(n for n, c in counts.items() if c == k) for k in sorted(set(counts.values()))}


def independent_loops(structure: LinksAndPairs) -> tuple[Loop, ...]:
    """Return a basis of independent loops, p - n + 1 if connected.

    Of least total length for up to 60 links; beyond, those that pairs outside a spanning tree close.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> bars = link("frame", A=0, D=4), link("crank", A=0, B=1), link("rod", B=0, C=3), link("arm", C=0, D=3)
    >>> print(*independent_loops(decompose(Mechanism("m", *bars))))
    frame -A- crank -B- rod -C- arm -D- frame
    """
    return loops_through(structure, structure.pairs)


def loops_through(structure: LinksAndPairs, pairs: Sequence[Pair]) -> tuple[Loop, ...]:
    """Return a basis of the independent loops that some of the pairs close.

    >>> from compoundkin.files import load
    >>> from compoundkin.structure import decompose
    >>> structure = decompose(load("geared-five-bar"))
    >>> len(loops_through(structure, [pair for pair in structure.pairs if pair.held == 2]))
    1
    """
    names = _numbered(structure)
    number = {name: k for k, name in enumerate(names)}
    edges = [(number[pair.members[0]], number[pair.members[1]]) for pair in pairs]
    return tuple(_loop(number, [pairs[k] for k in cycle]) for cycle in cycle_basis(len(names), edges))


def simple_loops(structure: LinksAndPairs, limit: int | None = None, longest: int | None = None) -> Iterator[Loop]:
    """Yield the loops that pass no link twice, at most `limit` of them.

    Their number may be enormous.
    `longest` leaves out loops of more links. A multiple pin of k links is k - 1 pairs, as everywhere.
    Source: D. B. Johnson, Finding all the elementary circuits of a directed graph, SIAM J. Comput. 4 (1975) 77.

    >>> from compoundkin.files import load
    >>> from compoundkin.structure import decompose
    >>> [len(loop) for loop in simple_loops(decompose(load("stephenson-iii")))]
    [4, 5, 5]
    """
    import networkx

    names = _numbered(structure)
    number = {name: k for k, name in enumerate(names)}
    place = {pair.name: k for k, pair in enumerate(structure.pairs)}
    # with pairs as nodes, two pairs between the same links are two ways
    graph = networkx.Graph()
    graph.add_nodes_from(range(len(names)))
    for k, pair in enumerate(structure.pairs, len(names)):
        graph.add_edges_from((number[name], k) for name in pair.members[:2])
    bound = None if longest is None else 2 * longest
    cycles = networkx.simple_cycles(graph, length_bound=bound)
    for cycle in islice(cycles, limit):
        yield _turned(number, place, [structure.pairs[k - len(names)] for k in cycle if k >= len(names)])


def _turned(order: Mapping[str, int], place: Mapping[str, int], pairs: Sequence[Pair]) -> Loop:
    """Return a loop from its first link on, whichever pair is named first. Links and pairs have their `place`."""
    first = min((name for pair in pairs for name in pair.members[:2]), key=order.__getitem__)
    at = next(k for k in range(len(pairs)) if all(first in pairs[j].members[:2] for j in (k, k - 1)))
    around = [*pairs[at:], *pairs[:at]]
    if len(around) > 2 and place[around[-1].name] < place[around[0].name]:
        around.reverse()
    return _loop(order, around)


def _numbered(structure: LinksAndPairs) -> list[str]:
    """Return the links, the frame first."""
    return [FRAME, *(name for name in structure.mechanism.links if name != FRAME)]


def loop_count(structure: LinksAndPairs) -> int:
    """Return the number of independent loops by Euler's formula. L = p - n + 1, one more for each further piece.

    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.elements import link
    >>> from compoundkin.structure import decompose
    >>> loop_count(decompose(Mechanism("m", link("frame", A=0, B=1), link("bar", A=0, B=1))))
    1
    """
    leader = {name: name for name in structure.mechanism.links}
    pieces = len(leader)
    for pair in structure.pairs:
        first, second = (find(leader, name) for name in pair.members[:2])
        pieces -= first != second
        leader[second] = first
    return len(structure.pairs) - len(leader) + pieces


def _loop(order: Mapping[str, int], pairs: Sequence[Pair]) -> Loop:
    """Return the loop of pairs that are given in order around it. `order` is that of the links."""
    shared = set(pairs[-1].members[:2]) & set(pairs[0].members[:2])
    link = min(shared, key=order.__getitem__)
    links = []
    for pair in pairs:
        links.append(link)
        link = pair.members[1] if link == pair.members[0] else pair.members[0]
    return Loop(tuple(links), tuple(pairs))
