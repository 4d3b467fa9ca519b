"""The spanning tree of a mechanism's joints, what is left to close its loops, and which joints are tied.

A tie is of wheels whose turns, and the ways of what they roll on, are in proportion: a sum over joints of the tree.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.mjcf.elementary_joints import RACK, ElementaryJoint, JointChain
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends

# Hinges nearer to an axis than this part of the way from it are at it; numbers below are zero.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class CarriedLink:
    """A link that its parent carries by the joints of a chain.

    `sign` is 1 where the link is the second of its pair, else -1: the first joint's coordinate is that of the pair,
    from the pose as drawn, times this.
    """

    link: str
    parent: str
    chain: JointChain
    sign: int

    @property
    def joints(self) -> tuple[ElementaryJoint, ...]:
        """Its joints from the parent outward."""
        own = self.chain.joints
        return own if self.sign > 0 else tuple(joint.backward for joint in reversed(own))


@dataclass(frozen=True)
class JointTree:
    """The carried links, each after its parent, and the chains that close loops."""

    carried: Mapping[str, CarriedLink]
    closing: tuple[JointChain, ...]

    def path(self, link: str) -> list[CarriedLink]:
        """Return the links from the frame to one of them."""
        found: list[CarriedLink] = []
        while link != FRAME:
            found.append(self.carried[link])
            link = found[-1].parent
        return found[::-1]

    def between(self, first: str, second: str) -> Iterator[tuple[ElementaryJoint, int]]:
        """Yield the joints between two links, with the signs of their moves."""
        one, two = self.path(first), self.path(second)
        common = sum(1 for a, b in zip(one, two, strict=False) if a.link == b.link)
        for own in reversed(one[common:]):
            yield from ((joint, -1) for joint in reversed(own.joints))
        for own in two[common:]:
            yield from ((joint, 1) for joint in own.joints)

    @property
    def depth(self) -> int:
        """How many links stand on each other."""
        found = {FRAME: 0}
        for link, own in self.carried.items():
            found[link] = found[own.parent] + 1
        return max(found.values())


def tree_of(chains: Iterable[JointChain], driven: set[str]) -> JointTree:
    """Return the tree of some pairs, and the others.

    Driven pairs are taken first, then those that are dear to close, then pins, those of the frame before others.
    To close a loop at a pin takes one constraint of MuJoCo, at any other pair half a link more.
    """

    def worth(chain: JointChain) -> int:
        pair = chain.pair
        if pair.name in driven:
            return 0
        if pair.table:
            return 4 if pair.table == RACK else 1
        return 2 if FRAME in chain.members else 3

    root: dict[str, str] = {}
    taken: list[JointChain] = []
    closing: list[JointChain] = []
    for chain in sorted(chains, key=worth):
        one, two = (_root(root, name) for name in chain.members)
        (taken if one != two else closing).append(chain)
        root[one] = two
    return JointTree(_branches(taken), tuple(closing))


def _root(root: Mapping[str, str], name: str) -> str:
    while root.get(name, name) != name:
        name = root[name]
    return name


def _branches(taken: Iterable[JointChain]) -> dict[str, CarriedLink]:
    """Return the carried links from the frame outward."""
    around: dict[str, list[JointChain]] = {}
    for chain in taken:
        for name in chain.members:
            around.setdefault(name, []).append(chain)
    found: dict[str, CarriedLink] = {}
    reached = [FRAME]
    for parent in reached:
        for chain in around.get(parent, ()):
            first, second = chain.members
            link, sign = (second, 1) if parent == first else (first, -1)
            if link != FRAME and link not in found:
                found[link] = CarriedLink(link, parent, chain, sign)
                reached.append(link)
    return found


def geared_tie(tree: JointTree, pair: Pair, ends: Ends) -> Mapping[str, float]:
    """Return the tie of two wheels.

    Seen from the carrier, the second turns back by the ratio for one turn of the first.
    """
    first, second, carrier = pair.members
    ratio = float(first_entry(ends[0].measure) / first_entry(ends[1].measure))
    terms = [(joint, ratio * sign) for joint, sign in tree.between(carrier, first)]
    terms += [(joint, 1.0 * sign) for joint, sign in tree.between(carrier, second)]
    return _summed((joint.name, number) for joint, number in terms if joint.is_hinge)


def still_tie(tree: JointTree, link: str, on: str) -> Mapping[str, float]:
    """Return the tie of a link that does not turn on another."""
    return _summed((joint.name, 1.0 * sign) for joint, sign in tree.between(on, link) if joint.is_hinge)


def straight_tie(tree: JointTree, chain: JointChain) -> Mapping[str, float] | None:
    """Return the tie of a rack and its pinion.

    The way between them is of slides, then of hinges at its axis. None where it is another way, on
    which what the pinion rolls is no sum of coordinates.
    """
    along, *_, axis = chain.joints
    way = list(tree.between(*chain.members))
    slides = [joint for joint, _ in way if not joint.is_hinge]
    hinges = [joint for joint, _ in way if joint.is_hinge]
    if along.is_hinge or [joint for joint, _ in way] != slides + hinges or not _at(hinges, axis.axis):
        return None
    terms = []
    for joint, sign in way:
        part = chain.tie[axis.name] if joint.is_hinge else float((along.axis.conjugate() * joint.axis).real)
        terms.append((joint.name, sign * part))
    return _summed(terms)


def _at(hinges: Iterable[ElementaryJoint], place: complex) -> bool:
    return all(abs(joint.axis - place) <= _ROUNDING * max(abs(joint.axis), abs(place)) for joint in hinges)


def _summed(terms: Iterable[tuple[str, float]]) -> dict[str, float]:
    found: dict[str, float] = {}
    for name, number in terms:
        found[name] = found.get(name, 0.0) + number
    return {name: number for name, number in found.items() if not np.isclose(number, 0.0, rtol=0.0, atol=_ROUNDING)}
