"""Graphs with coloured vertices. Their canonical forms as data, the orbits of their symmetries, and refinement."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

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
