"""A kinematic chain of links and revolute pairs, each pair between two links. Its count, its symmetry, its parts.

Links are numbered from 0; no link is the frame before one is chosen (an inversion of the chain).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import TYPE_CHECKING

from compoundkin.base.arguments import checked
from compoundkin.synthesis.chains.coloured_graphs import (
    Canonical,
    Coloured,
    Permutation,
    assorted,
    canonical,
    graph6_text,
    is_connected,
    orbits,
    read_graph6,
)
from compoundkin.synthesis.chains.joints import biconnected

if TYPE_CHECKING:
    import networkx as nx


@dataclass(frozen=True, repr=False)
class Chain:
    """A chain: how many links, and between which two of them each pair is.

    >>> four_bar = Chain.of(4, [(0, 1), (1, 2), (2, 3), (3, 0)])
    >>> four_bar.mobility, four_bar.loops, four_bar.assortment_text, four_bar.symmetries
    (1, 1, '4 binary', 8)
    """

    links: int
    pairs: tuple[tuple[int, int], ...]

    def __repr__(self) -> str:
        return f"Chain({self.links} links, {len(self.pairs)} pairs, mobility {self.mobility}, {self.graph6!r})"

    @classmethod
    @checked
    def of(cls, links: int, pairs: Iterable[tuple[int, int]]) -> Chain:
        """Return the chain of these pairs, named in any order."""
        return cls(links, tuple(sorted((min(pair), max(pair)) for pair in pairs)))

    @classmethod
    @checked
    def from_code(cls, code: str) -> Chain:
        """Return the chain that a graph6 text stands for, at most 62 links.

        >>> Chain.from_code("Bw").pairs
        ((0, 1), (0, 2), (1, 2))
        """
        return cls.of(*read_graph6(code))

    @property
    def mobility(self) -> int:
        """The mobility F = 3 (n - 1) - 2 p."""
        return 3 * (self.links - 1) - 2 * len(self.pairs)

    @property
    def loops(self) -> int:
        """The number of independent loops, L = p - n + 1 if connected."""
        return len(self.pairs) - self.links + 1

    @property
    def is_loop(self) -> bool:
        """Whether all its links form one loop."""
        return set(self.degrees) == {2} and self.is_connected

    @cached_property
    def is_connected(self) -> bool:
        """Whether every link can be reached from every other."""
        return is_connected(self.links, self.pairs)

    @cached_property
    def degrees(self) -> tuple[int, ...]:
        """How many pairs each link has."""
        return tuple(len(neighbours) for neighbours in self.neighbours)

    @cached_property
    def assortment(self) -> tuple[int, ...]:
        """How many links are binary, ternary, quaternary and so on.

        >>> Chain.from_code("DFw").assortment
        (3, 2)
        """
        return tuple(self.degrees.count(degree) for degree in range(2, max(self.degrees, default=1) + 1))

    @property
    def assortment_text(self) -> str:
        """The link assortment in words.

        >>> Chain.from_code("DFw").assortment_text
        '3 binary, 2 ternary'
        """
        return assorted(self.degrees)

    @cached_property
    def neighbours(self) -> tuple[tuple[int, ...], ...]:
        """The links that each link is joined to, in their order."""
        found: list[list[int]] = [[] for _ in range(self.links)]
        for first, second in self.pairs:
            found[first].append(second)
            found[second].append(first)
        return tuple(tuple(sorted(links)) for links in found)

    @cached_property
    def canonical(self) -> Canonical:
        """The canonical form of the chain as a graph of one colour."""
        return canonical(Coloured.of([""] * self.links, self.pairs))

    @cached_property
    def code(self) -> str:
        """The graph6 text of the canonical form. Equal exactly for chains that are the same but for their numbering.

        >>> Chain.of(3, [(0, 1), (1, 2)]).code == Chain.of(3, [(1, 0), (0, 2)]).code
        True
        """
        return graph6_text(self.links, self.canonical.adjacency)

    @property
    def graph6(self) -> str:
        """The graph6 text of the chain as its links are numbered.

        >>> Chain.of(3, [(0, 1), (1, 2)]).graph6
        'Bg'
        """
        places = [(row, column) for column in range(self.links) for row in range(column)]
        return graph6_text(self.links, sum(1 << k for k, place in enumerate(reversed(places)) if place in self.pairs))

    @property
    def symmetries(self) -> int:
        """The order of the automorphism group. In so many ways the chain maps onto itself."""
        return self.canonical.symmetries

    @property
    def inversions(self) -> tuple[tuple[int, ...], ...]:
        """Classes of equivalent links. Fixing either of two links of one class gives the same mechanism.

        >>> len(Chain.from_code("DFw").inversions)
        2
        """
        return self.canonical.orbits

    def equivalent_pairs(self, frame: int | None = None) -> tuple[tuple[tuple[int, int], ...], ...]:
        """Return classes of pairs that symmetries carry into each other. With a frame, those that leave it where it is.

        With a frame the classes are the essentially different places for a driver.

        >>> watt = Chain.of(6, [(0, 1), (0, 2), (2, 3), (3, 1), (0, 4), (4, 5), (5, 1)])
        >>> [len(pairs) for pairs in watt.equivalent_pairs()], len(watt.equivalent_pairs(frame=2))
        ([1, 4, 2], 7)
        """
        place = {pair: k for k, pair in enumerate(self.pairs)}
        moved = [tuple(place[min(g[a], g[b]), max(g[a], g[b])] for a, b in self.pairs) for g in self._generators(frame)]
        return tuple(tuple(self.pairs[k] for k in members) for members in orbits(len(self.pairs), moved))

    def _generators(self, frame: int | None) -> tuple[Permutation, ...]:
        if frame is None:
            return self.canonical.generators
        colours = ["frame" if link == frame else "" for link in range(self.links)]
        return canonical(Coloured.of(colours, self.pairs)).generators

    @cached_property
    def joints_of_parts(self) -> tuple[int, ...]:
        """The links at which a fractionated chain falls apart into movable chains.

        >>> Chain.of(7, [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (4, 5), (5, 6), (6, 0)]).joints_of_parts
        (0,)
        """
        blocks = Counter(link for block in biconnected(self.links, self.pairs) for link in block)
        return tuple(sorted(link for link, count in blocks.items() if count > 1))

    @cached_property
    def variety(self) -> int:
        """The degree of variety. By how much the least mobility of a part with a loop is below the chain's.

        In a chain of variety 0 no driver can be without effect on any loop.
        Source: C. R. Tischler, A. E. Samuel and K. H. Hunt, Kinematic chains for robot hands I, Mechanism and
        Machine Theory 30 (1995) 1193. The work doubles with each link.

        >>> Chain.of(5, [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0)]).variety
        0
        """
        return self.mobility - min((m for m, _ in self._parts_with_loops()), default=self.mobility)

    @property
    def has_rigid_part(self) -> bool:
        """Whether some of its links cannot move among themselves."""
        return any(mobility < 1 for mobility, _ in self._parts_with_loops())

    def _parts_with_loops(self) -> Iterable[tuple[int, tuple[int, ...]]]:
        """Yield the mobility of every set of links that has a loop."""
        for size in range(2, self.links + 1):
            for chosen in combinations(range(self.links), size):
                members = frozenset(chosen)
                inside = sum(first in members and second in members for first, second in self.pairs)
                if inside >= size:
                    yield 3 * (size - 1) - 2 * inside, chosen

    def graph(self) -> nx.Graph:
        """Return the chain as NetworkX has it. Links are nodes, pairs are edges with the attribute `code`."""
        import networkx

        graph = networkx.MultiGraph()
        graph.add_nodes_from(range(self.links))
        graph.add_edges_from(self.pairs, code="R")
        return graph
