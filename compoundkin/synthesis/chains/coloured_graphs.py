"""Graphs with coloured vertices: their canonical forms, equal exactly for isomorphic graphs, and their symmetries.

Vertices are distinguished by colours, then by how many neighbours of each kind they have (refinement). Where that
leaves alike vertices in one cell, each of them is singled out in turn (individualisation), which makes a tree whose
leaves are orderings of the vertices; the best leaf is the canonical one. Two leaves that read the same are a symmetry,
and what symmetries show to be alike is tried once.

Source: B. D. McKay, Practical graph isomorphism, Congressus Numerantium 30 (1981) 45; B. D. McKay and A. Piperno,
Practical graph isomorphism II, J. Symbolic Computation 60 (2014) 94.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.structure.cycles import find

# Cells of vertices, each cell the bits of an integer; an ordering of the vertices where all cells are single.
Cells: TypeAlias = list[int]
Permutation: TypeAlias = tuple[int, ...]
# graph6 writes numbers of up to six bits as printable characters (B. D. McKay, the formats graph6 and sparse6).
_SIX, _PRINTABLE = 6, 63
_ORDINALS = ("", "singular", "binary", "ternary", "quaternary", "quinary", "senary", "septenary", "octonary")


@dataclass(frozen=True)
class Coloured:
    """A graph with coloured vertices 0, 1, .... The colour of each, and its neighbours as the bits of an integer."""

    colours: tuple[str, ...]
    masks: tuple[int, ...]

    @classmethod
    def of(cls, colours: Iterable[str], edges: Iterable[tuple[int, int]]) -> Coloured:
        """Return the graph with these colours and edges; no edge may be there twice.

        >>> Coloured.of("aab", [(0, 1), (1, 2)]).masks
        (2, 5, 2)
        """
        names = tuple(colours)
        masks = [0] * len(names)
        for first, second in edges:
            masks[first] |= 1 << second
            masks[second] |= 1 << first
        return cls(names, tuple(masks))


@dataclass(frozen=True)
class Canonical:
    """The canonical form of a graph. Its code, the vertices in canonical order, and its symmetries.

    `adjacency` is the adjacency matrix in canonical order above its diagonal, column by column, as one number;
    `code` puts the colours with their numbers of vertices before it. A generator g moves vertex v to g[v];
    `symmetries` is the order of the automorphism group.
    """

    code: str
    adjacency: int
    order: Permutation
    generators: tuple[Permutation, ...]
    symmetries: int

    @property
    def orbits(self) -> tuple[tuple[int, ...], ...]:
        """The vertices that symmetries carry into each other, together."""
        return orbits(len(self.order), self.generators)


class JoinedOrbits:
    """The classes into which permutations part their points, while more permutations are found."""

    def __init__(self, size: int) -> None:
        self.count = 0
        self._leader = list(range(size))

    def join(self, generator: Sequence[int]) -> None:
        """Take one more permutation into account; an empty one changes nothing but the count."""
        self.count += 1
        for point, image in enumerate(generator):
            if point != image:
                first, second = find(self._leader, point), find(self._leader, image)
                self._leader[max(first, second)] = min(first, second)

    def leader_of(self, point: int) -> int:
        """Return the least point of a point's class."""
        return find(self._leader, point)


def orbits(size: int, generators: Sequence[Sequence[int]]) -> tuple[tuple[int, ...], ...]:
    """Return the classes into which permutations of 0, 1, ... part their points. They are in the order of their least.

    >>> orbits(4, [(1, 0, 2, 3), (0, 1, 3, 2)])
    ((0, 1), (2, 3))
    """
    joined = JoinedOrbits(size)
    for generator in generators:
        joined.join(generator)
    classes: dict[int, list[int]] = {}
    for point in range(size):
        classes.setdefault(joined.leader_of(point), []).append(point)
    return tuple(tuple(members) for members in classes.values())


def refined(masks: Sequence[int], cells: Cells, splitters: Sequence[int]) -> Cells:
    """Return the coarsest splitting in which vertices of a cell have equal neighbours."""
    cells, waiting = list(cells), list(splitters)
    while waiting:
        splitter = waiting.pop(0)
        parted: Cells = []
        near = 0
        for vertex in vertices_of(splitter):
            near |= masks[vertex]
        for cell in cells:
            # a cell that nothing joins to the splitter has no neighbours there, all alike
            parts = _parts(masks, cell, splitter) if cell & near and cell & (cell - 1) else [cell]
            parted += parts
            if len(parts) > 1:
                waiting += parts
        cells = parted
    return cells


def _parts(masks: Sequence[int], cell: int, splitter: int) -> list[int]:
    """Return a cell's vertices by their number of neighbours among the splitter's, fewest first."""
    parts: dict[int, int] = {}
    for vertex in vertices_of(cell):
        count = (masks[vertex] & splitter).bit_count()
        parts[count] = parts.get(count, 0) | 1 << vertex
    return [parts[count] for count in sorted(parts)]


def vertices_of(bits: int) -> list[int]:
    """Return the vertices of a cell, least first."""
    found = []
    while bits:
        low = bits & -bits
        found.append(low.bit_length() - 1)
        bits ^= low
    return found


def bits_of(vertices: Iterable[int]) -> int:
    """Return the cell of some vertices."""
    return sum(1 << vertex for vertex in vertices)


def graph6_text(links: int, adjacency: int) -> str:
    """Return the graph6 text of an adjacency matrix given as a number."""
    places = links * (links - 1) // 2
    filled = places + -places % _SIX
    number = adjacency << (filled - places)
    shifts = range(filled - _SIX, -1, -_SIX)
    return chr(_PRINTABLE + links) + "".join(chr(_PRINTABLE + (number >> shift) % 2**_SIX) for shift in shifts)


def read_graph6(code: str) -> tuple[int, list[tuple[int, int]]]:
    """Return the vertices and edges of a graph6 text, at most 62 vertices.

    >>> read_graph6("Bw")
    (3, [(0, 1), (0, 2), (1, 2)])
    """
    if not code or not all(_PRINTABLE <= ord(letter) < _PRINTABLE + 2**_SIX for letter in code):
        raise InvalidInput(Problem("code", f"{code!r} is no graph6 text", "chain.graph6 gives one, such as 'Bw'"))
    size = ord(code[0]) - _PRINTABLE
    bits = "".join(f"{ord(letter) - _PRINTABLE:06b}" for letter in code[1:])
    places = ((row, column) for column in range(size) for row in range(column))
    return size, [place for place, bit in zip(places, bits, strict=False) if bit == "1"]


def is_connected(size: int, edges: Sequence[tuple[int, int]]) -> bool:
    """Return whether edges join the vertices 0, 1, ... to one piece.

    >>> is_connected(3, [(0, 1)]), is_connected(3, [(0, 1), (2, 1)])
    (False, True)
    """
    leader, pieces = list(range(size)), size
    for first, second in edges:
        a, b = find(leader, first), find(leader, second)
        leader[a] = b
        pieces -= a != b
    return pieces == 1


def ordinal(degree: int) -> str:
    """Say what a link with so many pairs is called.

    >>> ordinal(3), ordinal(9)
    ('ternary', 'of 9 pairs')
    """
    return _ORDINALS[degree] if degree < len(_ORDINALS) else f"of {degree} pairs"


def assorted(degrees: Sequence[int]) -> str:
    """Say how many links have how many pairs: "4 binary, 2 ternary"."""
    return ", ".join(f"{degrees.count(degree)} {ordinal(degree)}" for degree in sorted(set(degrees)))


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
