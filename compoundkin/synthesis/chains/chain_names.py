"""Names of chains of revolute pairs between two links, and of their inversions.

The six-bar chains are those of Watt (the ternary links are joined) and Stephenson (they are not); their
inversions are counted as in K. H. Hunt, Kinematic Geometry of Mechanisms, 1978, and J. M. McCarthy,
Geometric Design of Linkages, 2000. The two chains of eight links whose instant centres are indeterminate have
names by D. E. Foster and G. R. Pennock, J. Mechanical Design, 2003 and 2005. Other chains have numbers.
"""

from __future__ import annotations

from compoundkin.synthesis.chains.chain import Chain
from compoundkin.synthesis.chains.chain_atlas import number_of

_BARS = {3: "three", 4: "four", 5: "five", 6: "six", 7: "seven", 8: "eight", 9: "nine", 10: "ten"}
_OWN_NAMES = {"G?LTMO": "double butterfly", "G?DlU_": "single flier"}
_SIX, _TERNARY = 6, 3


def chain_name(chain: Chain, frame: int | None = None) -> str:
    """The name of a chain of revolute pairs between two links each, or of its inversion if a frame is given.

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
    """The number of the inversion that a frame gives: the class of its link in the listed chain, from 1.

    >>> inversion_number(Chain.of(4, [(0, 1), (1, 2), (2, 3), (3, 0)]), 2)
    1
    """
    # link k of the listed chain is the link of this one that comes k-th in the canonical order
    place = chain.canonical.order.index(frame)
    listed = Chain.from_code(chain.code).inversions
    return next(k for k, alike in enumerate(listed, 1) if place in alike)


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
