"""Names of chains of revolute pairs, of inversions, and of what derives from them.

The six-bar chains are those of Watt (the ternary links are joined) and Stephenson (they are not); their
inversions are counted as in K. H. Hunt, Kinematic Geometry of Mechanisms, 1978, and J. M. McCarthy,
Geometric Design of Linkages, 2000. The two chains of eight links whose instant centres are indeterminate have
names by D. E. Foster and G. R. Pennock, J. Mechanical Design, 2003 and 2005. Other chains have numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache
from itertools import product

from compoundkin.base.arguments import checked
from compoundkin.synthesis.chains.chain import Chain
from compoundkin.synthesis.chains.chain_atlas import MOST_LINKS, number_of
from compoundkin.synthesis.chains.joints import Joints

_BARS = {3: "three", 4: "four", 5: "five", 6: "six", 7: "seven", 8: "eight", 9: "nine", 10: "ten"}
_OWN_NAMES = {"G?LTMO": "double butterfly", "G?DlU_": "single flier"}
_SIX, _BINARY, _TERNARY = 6, 2, 3
# A pin of five links alone stands for 125 chains; above this number they are not told one by one.
MOST_CHAINS = 2000


@checked
def chain_name(chain: Chain, frame: int | None = None) -> str:
    """Return the name of a chain, or of its inversion with a frame.

    "" for a chain that is in no list: too large, rigid in a part, open.

    >>> chain_name(Chain.of(4, [(0, 1), (1, 2), (2, 3), (3, 0)]))
    'four-bar'
    >>> watt = Chain.of(6, [(0, 1), (0, 2), (2, 3), (3, 1), (0, 4), (4, 5), (5, 1)])
    >>> chain_name(watt), chain_name(watt, 0), chain_name(watt, 3)
    ('Watt chain', 'Watt II', 'Watt I')
    """
    if chain.is_loop and chain.mobility > 0:
        return f"{_BARS[chain.links]}-bar" if chain.links in _BARS else f"{chain.links}-bar"
    number = number_of(chain)
    if number is None:
        return ""
    if chain.mobility == 1 and chain.links == _SIX:
        return _six_bar(chain, frame)
    kind = "chain" if chain.mobility else "truss"
    name = f"{chain.links}-link {kind} {number}" + (f" of mobility {chain.mobility}" if chain.mobility > 1 else "")
    if chain.code in _OWN_NAMES:
        name = f"{_OWN_NAMES[chain.code]} ({name})"
    return name if frame is None else f"{name}, inversion {inversion_number(chain, frame)}"


def inversion_number(chain: Chain, frame: int) -> int:
    """Return the number of the inversion that a frame gives. The class of its link in the listed chain, from 1.

    >>> inversion_number(Chain.of(4, [(0, 1), (1, 2), (2, 3), (3, 0)]), 2)
    1
    """
    # link k of the listed chain is the link of this one that comes k-th in the canonical order
    place = chain.canonical.order.index(frame)
    return next(k for k, alike in enumerate(_listed_inversions(chain.code), 1) if place in alike)


@lru_cache(maxsize=1024)
def _listed_inversions(code: str) -> tuple[tuple[int, ...], ...]:
    """Return the links of a listed chain that give one inversion each."""
    return Chain.from_code(code).inversions


def _six_bar(chain: Chain, frame: int | None) -> str:
    first, second = (link for link in range(chain.links) if chain.degrees[link] == _TERNARY)
    joined = (first, second) in chain.pairs
    name = "Watt" if joined else "Stephenson"
    if frame is None:
        return f"{name} chain"
    if frame in (first, second):
        return f"{name} II" if joined else f"{name} III"
    if joined or {first, second} == set(chain.neighbours[frame]):
        return f"{name} I"
    return f"{name} II"


def number_of_derived_chains(joints: Joints) -> int:
    """Count the simple-jointed chains that the multiple pins stand for, isomorphic ones apart.

    Source: A. Cayley, A theorem on trees, Quarterly J. Pure and Applied Mathematics 23 (1889) 376.
    """
    number = 1
    for joint in joints.multiple:
        number *= len(joint.links) ** (len(joint.links) - 2)
    return number


def derived_chains(joints: Joints) -> Iterator[Chain]:
    """Yield the chains of revolute pairs it derives from. Links keep their numbers, new ones come after them.

    Chains in which two links would be joined twice are left out.

    >>> from compoundkin.synthesis.chains.joints import Joint
    >>> joints = Joints(("a", "b", "c", "d"), (Joint((0, 1, 2)), Joint((0, 3))))
    >>> [chain.pairs for chain in derived_chains(joints)]
    [((0, 1), (0, 2), (0, 3)), ((0, 1), (0, 3), (1, 2)), ((0, 2), (0, 3), (1, 2))]
    """
    links, simple = len(joints.links), []
    for joint in joints.joints:
        first, second = joint.links[0], joint.links[-1]
        if joint.pairs == 1 and joint.is_higher:
            simple += [(first, links), (links, second)]
            links += 1
        elif joint.pairs == 1:
            simple.append((first, second))
    for chosen in product(*(tuple(trees(joint.links)) for joint in joints.multiple)):
        chain = Chain.of(links, [*simple, *(pair for tree in chosen for pair in tree)])
        if len(set(chain.pairs)) == len(chain.pairs):
            yield chain


def trees(links: Sequence[int]) -> Iterator[tuple[tuple[int, int], ...]]:
    """Yield all trees on some links, by their Pruefer sequences.

    >>> len(list(trees(range(4))))
    16
    """
    for sequence in product(links, repeat=len(links) - 2):
        yield _tree(list(links), sequence)


def _tree(links: list[int], sequence: Sequence[int]) -> tuple[tuple[int, int], ...]:
    left = {link: 1 + sequence.count(link) for link in links}
    pairs = []
    for inner in sequence:
        leaf = next(link for link in links if left[link] == 1)
        pairs.append((leaf, inner))
        left[leaf] -= 1
        left[inner] -= 1
    first, second = (link for link in links if left[link] == 1)
    return (*pairs, (first, second))


def derived_names(joints: Joints, frame: int | None) -> tuple[str, ...]:
    """Return the names of the chains it derives from, sorted."""
    if number_of_derived_chains(joints) > MOST_CHAINS or 1 in joints.degrees or joints.pieces > 1:
        return ()
    if len(joints.links) > MOST_LINKS and max(joints.degrees) > _BINARY:
        # of chains so large only single loops have names
        return ()
    names = {chain_name(chain, frame): None for chain in _chains_to_name(joints)}
    return tuple(sorted((name for name in names if name), key=_by_number))


# One report names a mechanism, its chain and its inversion: thousands of chains would be compared for each.
@lru_cache(maxsize=16)
def _chains_to_name(joints: Joints) -> tuple[Chain, ...]:
    return tuple(chain for chain in derived_chains(joints) if chain.links)


def variety_of(joints: Joints) -> int | None:
    """Return the degree of variety of the one chain it derives from. None where there is none or several."""
    if joints.mobility < 1 or number_of_derived_chains(joints) > 1 or joints.has_loop_of_slides:
        return None
    chains = [chain for chain in derived_chains(joints) if chain.links <= MOST_LINKS and chain.is_connected]
    return chains[0].variety if chains else None


def has_rigid_part(joints: Joints) -> bool:
    """Return whether a small movable mechanism has a rigid part in any case."""
    if joints.mobility < 1 or len(joints.links) > MOST_LINKS or number_of_derived_chains(joints) > MOST_CHAINS:
        return False
    return all(chain.has_rigid_part for chain in derived_chains(joints))


def _by_number(name: str) -> list[tuple[int, str]]:
    return [(int(word), "") if word.isdigit() else (0, word) for word in name.replace(",", " ").split()]
