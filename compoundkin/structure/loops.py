"""Independent loops: closed chains of links and pairs."""

from __future__ import annotations

from dataclasses import dataclass

from compoundkin.pairs import Pair
from compoundkin.structure.composites import find
from compoundkin.structure.cycles import cycle_basis
from compoundkin.structure.model import Structure
from compoundkin.words import FRAME


@dataclass(frozen=True)
class Loop:
    """A closed chain: `pairs[k]` joins `links[k]` to the next link, the last one to the first.

    It starts at the frame where it contains it.
    """

    links: tuple[str, ...]
    pairs: tuple[Pair, ...]

    def __len__(self) -> int:
        return len(self.links)

    def __str__(self) -> str:
        steps = (f"{link} -{pair.name}- " for link, pair in zip(self.links, self.pairs, strict=True))
        return "".join(steps) + self.links[0]


def independent_loops(structure: Structure) -> tuple[Loop, ...]:
    """A basis of independent loops, p - n + 1 of them in a connected mechanism.

    Of least total length for up to 60 links; beyond, those that pairs outside a spanning tree close.

    >>> from compoundkin.mechanism import Mechanism
    >>> from compoundkin.words import link
    >>> from compoundkin.structure import decompose
    >>> bars = link("frame", A=0, D=4), link("crank", A=0, B=1), link("rod", B=0, C=3), link("arm", C=0, D=3)
    >>> print(*independent_loops(decompose(Mechanism("m", *bars))))
    frame -A- crank -B- rod -C- arm -D- frame
    """
    names = [FRAME, *(name for name in structure.mechanism.links if name != FRAME)]
    number = {name: k for k, name in enumerate(names)}
    edges = [(number[pair.members[0]], number[pair.members[1]]) for pair in structure.pairs]
    return tuple(_loop(structure, cycle) for cycle in cycle_basis(len(names), edges))


def loop_count(structure: Structure) -> int:
    """The number of independent loops by Euler's formula: L = p - n + 1, one more for each further piece.

    >>> from compoundkin.mechanism import Mechanism
    >>> from compoundkin.words import link
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


def _loop(structure: Structure, cycle: tuple[int, ...]) -> Loop:
    pairs = tuple(structure.pairs[k] for k in cycle)
    shared = [set(pairs[k - 1].members[:2]) & set(pairs[k].members[:2]) for k in range(len(pairs))]
    order = {name: k for k, name in enumerate([FRAME, *structure.mechanism.links])}
    link = min(shared[0], key=lambda name: 0 if name == FRAME else order[name])
    links = []
    for pair in pairs:
        links.append(link)
        link = pair.members[1] if link == pair.members[0] else pair.members[0]
    return Loop(tuple(links), pairs)
