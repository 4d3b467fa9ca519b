"""One code for all drawings of a graph: equal exactly for isomorphic graphs. And the symmetries of a graph.

Vertices are distinguished by colours, then by how many neighbours of each kind they have (refinement). Where
that leaves alike vertices in one cell, each of them is singled out in turn (individualisation), which makes
a tree whose leaves are orderings of the vertices; the best leaf is the canonical one. Two leaves that read
the same are a symmetry, and what symmetries show to be alike is tried once.
Source: B. D. McKay, Practical graph isomorphism, Congressus Numerantium 30 (1981) 45; B. D. McKay and
A. Piperno, Practical graph isomorphism II, J. Symbolic Computation 60 (2014) 94.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from compoundkin.base.arguments import checked
from compoundkin.synthesis.chains.coloured_graphs import (
    Canonical,
    Cells,
    Coloured,
    JoinedOrbits,
    Permutation,
    bits_of,
    orbits,
    refined,
    vertices_of,
)


@checked
def canonical(graph: Coloured) -> Canonical:
    """Return the canonical form of a graph.

    >>> path, same = [(0, 1), (1, 2), (2, 3)], [(2, 0), (0, 3), (3, 1)]
    >>> canonical(Coloured.of("aaaa", path)).code == canonical(Coloured.of("aaaa", same)).code
    True
    >>> canonical(Coloured.of("aaaa", path)).symmetries
    2
    >>> canonical(Coloured.of("aaab", path)).symmetries
    1
    >>> canonical(Coloured.of("aaa", [(0, 1), (1, 2)])).orbits
    ((0, 2), (1,))
    """
    cells = [bits_of(members) for _, members in _by_colour(graph.colours)]
    search = _CanonicalSearch(graph.masks)
    search.visit(refined(graph.masks, cells, cells), (), ())
    code = f"{_colour_text(graph.colours)}:{search.best.adjacency:x}"
    return Canonical(code, search.best.adjacency, search.best.order, tuple(search.generators), search.symmetries())


@dataclass(frozen=True)
class _Leaf:
    """An ordering of the vertices, the adjacency matrix it gives, and its trace."""

    trace: tuple[tuple[int, ...], ...]
    adjacency: int
    order: Permutation

    @property
    def key(self) -> tuple[tuple[tuple[int, ...], ...], int]:
        return self.trace, self.adjacency


@dataclass
class _CanonicalSearch:
    """The tree of orderings. The first leaf, the best one so far, and the symmetries found between leaves."""

    masks: Sequence[int]
    leaves: list[_Leaf] = field(default_factory=list)
    generators: list[Permutation] = field(default_factory=list)
    singled: list[int] = field(default_factory=list)

    @property
    def best(self) -> _Leaf:
        return self.leaves[-1]

    def visit(self, cells: Cells, prefix: tuple[int, ...], trace: tuple[tuple[int, ...], ...]) -> bool:
        """Go through a node where the vertices of `prefix` are singled out. Whether the first leaf came up again.

        It came up as the image of a symmetry that carries the whole way from the first path to here: nothing
        on that way can be new.
        """
        trace = (*trace, _profile(self.masks, cells))
        if self._hopeless(trace):
            return False
        target = next((cell for cell in cells if cell & (cell - 1)), 0)
        if not target:
            return self._leaf(_Leaf(trace, _adjacency(self.masks, cells), tuple(c.bit_length() - 1 for c in cells)))
        tried: list[int] = []
        joined = JoinedOrbits(len(self.masks))
        for vertex in vertices_of(target):
            if tried and self._alike(prefix, vertex, tried, joined):
                continue
            if not self.leaves:
                self.singled.append(vertex)
            single = 1 << vertex
            split = [part for cell in cells for part in ((single, cell ^ single) if cell & single else (cell,))]
            repeated = self.visit(refined(self.masks, split, [single]), (*prefix, vertex), trace)
            if repeated and list(prefix) != self.singled[: len(prefix)]:
                return True
            tried.append(vertex)
        return False

    def _hopeless(self, trace: tuple[tuple[int, ...], ...]) -> bool:
        """Return whether no leaf below can be best, nor like the first."""
        depth = len(trace)
        return bool(self.leaves) and trace > self.best.trace[:depth] and trace != self.leaves[0].trace[:depth]

    def _alike(self, prefix: Sequence[int], vertex: int, tried: Sequence[int], joined: JoinedOrbits) -> bool:
        """Return whether a symmetry that fixes the prefix carries a vertex that was tried to this one."""
        for generator in self.generators[joined.count :]:
            joined.join(generator if all(generator[p] == p for p in prefix) else ())
        own = joined.leader_of(vertex)
        return any(joined.leader_of(t) == own for t in tried)

    def _leaf(self, leaf: _Leaf) -> bool:
        for other in self.leaves:
            if leaf.key == other.key:
                image = dict(zip(other.order, leaf.order, strict=True))
                self.generators.append(tuple(image[v] for v in range(len(image))))
                return other is self.leaves[0]
        if not self.leaves or leaf.key < self.best.key:
            self.leaves = [*self.leaves[:1], leaf]
        return False

    def symmetries(self) -> int:
        """Return the order of the group. The product of orbits, each under the symmetries that fix those before."""
        total, fixing = 1, self.generators
        for vertex in self.singled:
            total *= next(len(members) for members in orbits(len(self.masks), fixing) if vertex in members)
            fixing = [g for g in fixing if g[vertex] == vertex]
        return total


def _profile(masks: Sequence[int], cells: Cells) -> tuple[int, ...]:
    """Return what two nodes of the tree must share for a symmetry between them.

    Sizes of cells, and how they are joined: of each cell the numbers of neighbours in the others, zeros left out.
    It orders as whole rows of numbers would: what is joined to an earlier cell is greater.
    """
    place, joined = _places(cells), list(map(int.bit_count, cells))
    for cell in cells:
        counts: dict[int, int] = {}
        for vertex in vertices_of(masks[cell.bit_length() - 1]):
            counts[place[vertex]] = counts.get(place[vertex], 0) + 1
        for other in sorted(counts):
            joined += (-other, counts[other])
        joined.append(-len(masks))
    return tuple(joined)


def _adjacency(masks: Sequence[int], cells: Cells) -> int:
    """Return the adjacency matrix above its diagonal, column by column, as one number."""
    place, bits = _places(cells), ["0"]
    for column, cell in enumerate(cells):
        rows = ["0"] * column
        for vertex in vertices_of(masks[cell.bit_length() - 1]):
            if place[vertex] < column:
                rows[place[vertex]] = "1"
        bits += rows
    return int("".join(bits), 2)


def _places(cells: Cells) -> dict[int, int]:
    """Return the place of the cell of each vertex."""
    return {vertex: k for k, cell in enumerate(cells) for vertex in vertices_of(cell)}


def _by_colour(colours: Sequence[str]) -> list[tuple[str, list[int]]]:
    members: dict[str, list[int]] = {}
    for vertex, colour in enumerate(colours):
        members.setdefault(colour, []).append(vertex)
    return sorted(members.items())


def _colour_text(colours: Sequence[str]) -> str:
    return ",".join(f"{len(members)} {colour!r}" for colour, members in _by_colour(colours))
