"""The shipped lists of chains and trusses; inversions and Assur groups from them.

A chain is known by its place in the list of chains with as many links and the same mobility: "8-link chain 7".
The list is made by ``python -m compoundkin.synthesis.chains.chain_atlas``, in a few seconds; its order is part of the
names and stays.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from compoundkin.base.arguments import checked
from compoundkin.base.errors import Problem, UnknownName, suggestion
from compoundkin.synthesis.chains.chain import Chain
from compoundkin.synthesis.chains.coloured_graphs import Coloured, canonical
from compoundkin.synthesis.chains.generation import chains_of

if TYPE_CHECKING:
    import networkx as nx

FILE = Path(__file__).with_name("data") / "chains.txt"
COMMENT = "#"
# Larger chains are made where they are asked for: twelve links take half a minute.
MOST_LINKS = 10
_GROUP = re.compile(r"(\d+)-link group (\d+)")
_GROUP_LINKS = (2, 4, 6, 8)
# The groups that books call by a name.
_OWN_GROUPS = {"dyad": "2-link group 1", "triad": "4-link group 2", "class iii triad": "4-link group 2"}


@dataclass(frozen=True)
class AssurGroup:
    """A Baranov truss without one of its links. What was joined to it are the outer pairs.

    >>> triad = assur_groups(4)[1]
    >>> triad.links, triad.outer, triad.inner
    (4, 3, 3)
    """

    truss: Chain
    removed: int

    @property
    def links(self) -> int:
        """How many links the group has."""
        return self.truss.links - 1

    @property
    def outer(self) -> int:
        """How many pairs attach the group: its order."""
        return self.truss.degrees[self.removed]

    @property
    def inner(self) -> int:
        """How many pairs its links have among themselves."""
        return len(self.truss.pairs) - self.outer

    @property
    def code(self) -> str:
        """A code equal exactly for groups that differ in numbering only."""
        colours = ["outside" if link == self.removed else "link" for link in range(self.truss.links)]
        return canonical(Coloured.of(colours, self.truss.pairs)).code

    @property
    def joined(self) -> list[tuple[int | None, int]]:
        """Its pairs by the links they join, the outer ones first. None stands for what it is attached to."""
        left = [k for k in range(self.truss.links) if k != self.removed]
        outside = self.truss.neighbours[self.removed]
        inner = [(left.index(a), left.index(b)) for a, b in self.truss.pairs if self.removed not in (a, b)]
        return [*((None, left.index(k)) for k in left if k in outside), *inner]

    def graph(self) -> nx.MultiGraph:
        """Return the group as NetworkX has it. The attribute `outer` of a link says how many outer pairs it has."""
        graph = self.truss.graph()
        outside = self.truss.neighbours[self.removed]
        graph.remove_node(self.removed)
        for link in graph:
            graph.nodes[link]["outer"] = int(link in outside)
        return graph


@dataclass(frozen=True)
class Inversion:
    """A chain with one of its links as the frame. The first of those that are equivalent to it."""

    chain: Chain
    frame: int


@checked
def chains(links: int, mobility: int = 1, patient: bool = False) -> tuple[Chain, ...]:
    """Return all chains with so many links, in the order that numbers them.

    Those of mobility 3 with a bridging pair too. Raises InvalidInput for more than are made in some seconds.

    >>> [len(chains(links)) for links in (4, 6, 8, 10)]
    [1, 2, 16, 230]
    >>> len(chains(9, mobility=2)), len(chains(10, mobility=3))
    (40, 98)
    """
    return _listed().get((links, mobility)) or _generated(links, mobility, patient)


@checked
def trusses(links: int) -> tuple[Chain, ...]:
    """Return all Baranov trusses with so many links. No mobility, but every part of them has.

    >>> [len(trusses(links)) for links in (3, 5, 7, 9)]
    [1, 1, 3, 28]
    """
    return chains(links, mobility=0)


@checked
def inversions(links: int, mobility: int = 1, patient: bool = False) -> tuple[Inversion, ...]:
    """Return all mechanisms that fixing one link of a chain gives, equivalent links once.

    >>> [len(inversions(links)) for links in (4, 6, 8, 10)]
    [1, 5, 71, 1834]
    """
    return tuple(Inversion(chain, alike[0]) for chain in chains(links, mobility, patient) for alike in chain.inversions)


@checked
def assur_groups(links: int) -> tuple[AssurGroup, ...]:
    """Return all Assur groups of revolute pairs with so many links. Every truss without one link, equivalent ones once.

    Source: E. E. Peisakh, Structural analysis of planar jointed mechanisms: current state and problems,
    J. Machinery Manufacture and Reliability 37 (2008) 207.

    >>> [len(assur_groups(links)) for links in (2, 4, 6, 8)]
    [1, 2, 10, 173]
    """
    return tuple(AssurGroup(truss, alike[0]) for truss in trusses(links + 1) for alike in truss.inversions)


@checked
def assur_group(name: str, also: Iterable[str] = ()) -> AssurGroup:
    """Return a group of revolute pairs by its name.

    "4-link group 2", or "triad" for that one, the class III group of order 3.
    The number is its place in `assur_groups`. Raises UnknownName; `also` are names that the caller knows.

    >>> assur_group("triad").outer, assur_group("4-link group 1").outer
    (3, 2)
    """
    found = _GROUP.fullmatch(_OWN_GROUPS.get(name.strip().lower(), name.strip()))
    if found and int(found[1]) in _GROUP_LINKS and 1 <= int(found[2]) <= len(assur_groups(int(found[1]))):
        return assur_groups(int(found[1]))[int(found[2]) - 1]
    listed = ("2-link group 1", "4-link group 1 or 2", "6-link group 1 to 10", "8-link group 1 to 173")
    known = [*also, *_OWN_GROUPS, *listed]
    raise UnknownName(Problem(name, "there is no such Assur group", suggestion(name, known)))


@checked
def group_name(group: AssurGroup) -> str:
    """Return the name of a group by its place in its list.

    "" where it is in none.

    >>> group_name(assur_group("triad"))
    '4-link group 2'
    """
    codes = _group_codes(group.links) if group.links in _GROUP_LINKS else ()
    return f"{group.links}-link group {codes.index(group.code) + 1}" if group.code in codes else ""


@cache
def _group_codes(links: int) -> tuple[str, ...]:
    return tuple(group.code for group in assur_groups(links))


@checked
def number_of(chain: Chain) -> int | None:
    """Return the place of a chain in its list, from 1. None if its list is not shipped or does not hold it.

    >>> number_of(Chain.of(4, [(0, 1), (1, 2), (2, 3), (3, 0)]))
    1
    >>> number_of(Chain.of(3, [(0, 1), (1, 2)]))
    """
    return _numbers().get((chain.mobility, chain.code)) if chain.links <= MOST_LINKS else None


def read_lists(lines: Iterable[str]) -> dict[tuple[int, int], tuple[Chain, ...]]:
    """Return the chains of a list by links and mobility. A line "links mobility code" each, other lines are comments.

    >>> [chain.links for chain in read_lists(["# a comment", "3 0 Bw"])[3, 0]]
    [3]
    """
    return {key: tuple(map(Chain.from_code, codes)) for key, codes in _codes(lines).items()}


def _codes(lines: Iterable[str]) -> dict[tuple[int, int], list[str]]:
    found: dict[tuple[int, int], list[str]] = {}
    for line in lines:
        if line.strip() and not line.startswith(COMMENT):
            links, mobility, code = line.split()
            found.setdefault((int(links), int(mobility)), []).append(code)
    return found


def _lines() -> list[str]:
    return FILE.read_text(encoding="ascii").splitlines()


@cache
def _listed() -> dict[tuple[int, int], tuple[Chain, ...]]:
    return read_lists(_lines())


@cache
def _generated(links: int, mobility: int, patient: bool) -> tuple[Chain, ...]:
    return chains_of(links, mobility, bridged=True, patient=patient)


@cache
def _numbers() -> dict[tuple[int, str], int]:
    # the lists hold canonical forms, so that their own numbering gives the code
    return {(m, code): k for (_, m), codes in _codes(_lines()).items() for k, code in enumerate(codes, 1)}


# --- how the list is made --------------------------------------------------------------------------------------

MOBILITIES = (0, 1, 2, 3)
# A loop of n links has the mobility n - 3.
_LINKS_OF_RIGID_LOOP = 3
HEADING = (
    "Kinematic chains of revolute pairs and, with mobility 0, Baranov trusses, each once: links, mobility, graph6.",
    "Made by python -m compoundkin.synthesis.chains.chain_atlas. The order numbers the chains: never change it.",
)


def list_lines(most_links: int = MOST_LINKS) -> Iterator[str]:
    """Yield the lines of the list, by mobility, then by links.

    >>> list(list_lines(most_links=4))[2:6]
    ['3 0 Bw', '4 1 C]']
    """
    yield from (f"{COMMENT} {text}" for text in HEADING)
    for mobility in MOBILITIES:
        for links in range(mobility + _LINKS_OF_RIGID_LOOP, most_links + 1):
            for chain in chains_of(links, mobility, bridged=True):
                yield f"{links} {mobility} {chain.code}"


def write_list(path: Path = FILE) -> int:
    """Write the list to a file; the number of lines written."""
    text = [*list_lines()]
    path.write_text("\n".join(text) + "\n", encoding="ascii")
    return len(text)


if __name__ == "__main__":
    print(f"{write_list()} lines written to {FILE}")
