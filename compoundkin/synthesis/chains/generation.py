"""All kinematic chains, or all Baranov trusses, of a number of links. Each once, none twice.

The links with more than two pairs, joined by strings of binary links, are a small multigraph, the contracted
chain. There is one way back: put a number of binary links on each of its edges. Two chains are the same
exactly if their contracted chains are, and a symmetry of it carries one way of putting binary links into the
other; so that only the least way of each class is kept, and no two chains are ever compared.
A part of a chain with v links, e strings and b binary links on them has the mobility 3 (v - 1) + b - 2 e,
which must not be less than one.

Sources: F. R. E. Crossley and T. H. Davies, Structural analysis of plane linkages by Franke's condensed
notation, J. Mechanisms 1 (1966) 171; E. R. Tuttle, Generation of planar kinematic chains, Mechanism and
Machine Theory 31 (1996) 729. Chains of mobility 1 are the (3/2, 2)-tight graphs of A. Lee and I. Streinu,
Discrete Mathematics 308 (2008) 1425.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations, combinations_with_replacement, pairwise

import numpy as np
import numpy.typing as npt

from compoundkin.base.arguments import checked
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.synthesis.chains.chain import Chain
from compoundkin.synthesis.chains.coloured_graphs import Canonical, Coloured, Permutation, canonical, is_connected

MOST_MADE = {0: 11, 1: 11, 2: 11, 3: 10}  # links, by mobility: what is made within some ten seconds
Integers = npt.NDArray[np.int64]


@checked
def chains_of(links: int, mobility: int = 1, bridged: bool = False, patient: bool = False) -> tuple[Chain, ...]:
    """Return all connected chains of a mobility without loose links or rigid parts.

    For mobility 0 these are the Baranov trusses: rigid, but no part of them is. Fractionated chains, which
    there are from mobility 2 on, are among them; those with a pair that lies in no loop, which there are from
    mobility 3 on, if `bridged` says so. The order is that of the assortments, then of the codes.
    Raises InvalidInput for so many links that they take more than some seconds, unless one is `patient`.

    >>> [len(chains_of(links)) for links in (4, 6, 8)]
    [1, 2, 16]
    >>> [len(chains_of(links, mobility=0)) for links in (3, 5, 7)]
    [1, 1, 3]
    >>> len(chains_of(8, mobility=3)), len(chains_of(8, mobility=3, bridged=True))
    (6, 7)
    """
    if links > (most := MOST_MADE.get(mobility, min(MOST_MADE.values()))) and not patient:
        what, remedy = f"all chains of {links} links take half a minute to hours", f"ask for {most}, or be patient=True"
        raise InvalidInput(Problem("links", what, remedy))
    found: list[Chain] = []
    for degrees in assortments(links, mobility):
        if not degrees:
            found.append(Chain.of(links, [(k, (k + 1) % links) for k in range(links)]))
        # two parts that share one link only have their mobilities added, so there are none below mobility 2
        for contracted in contracted_chains(degrees, looped=mobility > 1) if degrees else ():
            if bridged or contracted.is_closed:
                found += _filled(contracted, links, mobility)
    return tuple(sorted((Chain.from_code(chain.code) for chain in found), key=classical_order))


def classical_order(chain: Chain) -> tuple[int, tuple[int, ...], str]:
    """Return chains with few binary links first, as atlases have them. Then by their codes."""
    return chain.links, chain.assortment, chain.code


def assortments(links: int, mobility: int = 1) -> tuple[tuple[int, ...], ...]:
    """Return the numbers of pairs that the links with more than two can have. One tuple for each assortment.

    >>> assortments(8)
    ((3, 3, 3, 3), (3, 3, 4), (3, 5), (4, 4), (6,))
    """
    ends = 3 * (links - 1) - mobility
    if ends % 2 or ends < 2 * links:
        return ()
    return tuple(tuple(part + 2 for part in parts) for parts in _partitions(ends - 2 * links) if len(parts) <= links)


@dataclass(frozen=True)
class Contracted:
    """A contracted chain: links with more than two pairs, and the strings between them. The same link twice is a loop.

    >>> Contracted(2, ((0, 1), (0, 1), (0, 1))).canonical.symmetries
    12
    """

    links: int
    strings: tuple[tuple[int, int], ...]

    @cached_property
    def canonical(self) -> Canonical:
        """The canonical form with the strings as vertices of a second colour."""
        colours = ["link"] * self.links + ["string"] * len(self.strings)
        ends = [(end, self.links + k) for k, string in enumerate(self.strings) for end in string]
        return canonical(Coloured.of(colours, ends))

    def string_permutations(self) -> Integers:
        """Return all ways in which symmetries permute the strings, a row each."""
        generators = [tuple(v - self.links for v in g[self.links :]) for g in self.canonical.generators]
        return np.array(_closure(len(self.strings), generators))

    @property
    def is_closed(self) -> bool:
        """Whether it is connected and stays so when any one string is cut."""
        return all(is_connected(self.links, self.strings[:k] + self.strings[k + 1 :]) for k in range(len(self.strings)))

    def expanded(self, numbers: Sequence[int]) -> Chain:
        """Return the chain with these numbers of binary links on the strings."""
        pairs, free = [], self.links
        for (first, second), number in zip(self.strings, numbers, strict=True):
            string = [first, *range(free, free + number), second]
            pairs += list(pairwise(string))
            free += number
        return Chain.of(free, pairs)


def contracted_chains(degrees: Sequence[int], looped: bool = True) -> tuple[Contracted, ...]:
    """Return the contracted chains whose links have these numbers of pairs.

    >>> len(contracted_chains((3, 3))), len(contracted_chains((3, 3), looped=False))
    (2, 1)
    """
    found: dict[str, Contracted] = {}
    for strings in _multigraphs(degrees, [True] * len(degrees), looped):
        contracted = Contracted(len(degrees), strings)
        if is_connected(len(degrees), strings):
            found.setdefault(contracted.canonical.code, contracted)
    return tuple(found.values())


def _filled(contracted: Contracted, links: int, mobility: int) -> list[Chain]:
    """Return the chains with so many links that contract to this one, each once."""
    ways = _placements(links - contracted.links, len(contracted.strings))
    ways = ways[_moves(contracted, ways, mobility)]
    if not len(ways):
        return []
    least = _is_least(ways, contracted.string_permutations())
    return [contracted.expanded(numbers.tolist()) for numbers in ways[least]]


def _moves(contracted: Contracted, ways: Integers, mobility: int) -> npt.NDArray[np.bool_]:
    """Return whether every part has a mobility of one at least. The whole may have less, if that is asked for."""
    strings = len(contracted.strings)
    parts = (np.arange(1, 2**strings)[:, None] >> np.arange(strings)) & 1
    touched = np.array([[link in string for string in contracted.strings] for link in range(contracted.links)])
    joined = (parts @ touched.T.astype(np.int64) > 0).sum(axis=1)
    least = np.full(len(parts), 1)
    least[-1] = min(mobility, 1)
    needed = least - 3 * (joined - 1) + 2 * parts.sum(axis=1)
    moves: npt.NDArray[np.bool_] = np.all(ways @ parts.T >= needed, axis=1)
    return moves


def _is_least(ways: Integers, permutations: Integers) -> npt.NDArray[np.bool_]:
    """Return whether a way is the least of those that symmetries make."""
    base = int(ways.max(initial=0)) + 1
    digits = base ** np.arange(ways.shape[1])
    images = np.array([ways[:, permutation] @ digits for permutation in permutations])
    least: npt.NDArray[np.bool_] = ways @ digits == images.min(axis=0)
    return least


def _placements(number: int, places: int) -> Integers:
    """Return all ways of putting binary links on strings, a row each."""
    chosen = np.array([*combinations(range(number + places - 1), places - 1)], dtype=np.int64)
    chosen = chosen.reshape(-1, places - 1)
    first, last = np.full((len(chosen), 1), -1), np.full((len(chosen), 1), number + places - 1)
    return np.diff(np.hstack([first, chosen, last]), axis=1) - 1


def _multigraphs(free: Sequence[int], untouched: Sequence[bool], looped: bool) -> Iterator[tuple[tuple[int, int], ...]]:
    """Yield the sets of strings that use up all free ends. Some come up in several numberings."""
    if not free:
        yield ()
        return
    own, rest, alike = free[0], free[1:], untouched[1:]
    for loops in range(own // 2 + 1 if looped else 1):
        for others in combinations_with_replacement(range(len(rest)), own - 2 * loops):
            used = [others.count(k) for k in range(len(rest))]
            if all(u <= f for u, f in zip(used, rest, strict=True)) and _in_order(used, rest, alike):
                here = ((0, 0),) * loops + tuple((0, k + 1) for k in others)
                left = [f - u for u, f in zip(used, rest, strict=True)]
                for inner in _multigraphs(left, [a and not u for u, a in zip(used, alike, strict=True)], looped):
                    yield here + tuple((a + 1, b + 1) for a, b in inner)


def _in_order(used: Sequence[int], free: Sequence[int], untouched: Sequence[bool]) -> bool:
    """Return whether the first ones of links not yet distinguished are taken. The others would be repetitions."""
    return all(
        used[k] >= used[k + 1]
        for k in range(len(used) - 1)
        if untouched[k] and untouched[k + 1] and free[k] == free[k + 1]
    )


def _partitions(number: int, least: int = 1) -> Iterator[tuple[int, ...]]:
    """Yield all ways of writing a number as a sum, long ones first."""
    if number == 0:
        yield ()
    for first in range(least, number + 1):
        for rest in _partitions(number - first, first):
            yield first, *rest


def _closure(size: int, generators: Sequence[Permutation]) -> list[Permutation]:
    group = {tuple(range(size)): None}
    waiting = [*group]
    while waiting:
        element = waiting.pop()
        for generator in generators:
            product = tuple(generator[k] for k in element)
            if product not in group:
                group[product] = None
                waiting.append(product)
    return [*group]
