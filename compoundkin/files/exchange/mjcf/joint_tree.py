"""The tree of joints: pairs as hinges and slides, loops cut where a constraint closes them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.posed_mechanism import PosedMechanism
from compoundkin.model.geometry import FRAME
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, lower_equivalent
from compoundkin.model.pairs.travel_limits import as_travel_limited

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


# What an end that is open is taken as, as a part of the size: MuJoCo has no half ranges.
_OPEN = 1e3


# A rack holds nothing but its pinion's turn: alone it keeps two links together by three joints.
RACK = "racks"


@dataclass(frozen=True)
class ElementaryJoint:
    """A hinge about a place, or a slide in a direction.

    Both are in space as drawn. `reach` is from where to where it may go, from the pose as drawn.
    """

    name: str
    is_hinge: bool
    axis: complex
    reach: tuple[float, float] | None = None

    @property
    def backward(self) -> ElementaryJoint:
        """The same joint where the second link carries the first."""
        return self if self.reach is None else replace(self, reach=(-self.reach[1], -self.reach[0]))


@dataclass(frozen=True)
class JointChain:
    """The joints of a pair, from its first link to its second.

    The first of them has the pair's own coordinate.
    `tie` are numbers by the joints' names: the joints' coordinates times these add up to zero.
    """

    pair: Pair
    joints: tuple[ElementaryJoint, ...]
    tie: Mapping[str, float] = field(default_factory=dict)

    @property
    def members(self) -> tuple[str, str]:
        """Its two links."""
        first, second = self.pair.members
        return first, second


def chain_of(shown: PosedMechanism, pair: Pair) -> JointChain | None:
    """Return the joints of a pair; None where no hinges and slides are one.

    >>> from compoundkin.files.exchange.posed_mechanism import posed_mechanism
    >>> from compoundkin.files import load
    >>> shown = posed_mechanism(load("quick-return-pin-in-slot"))
    >>> [joint.is_hinge for pair in shown.pairs for joint in chain_of(shown, pair).joints]
    [False, True]
    """
    if not pair.table:
        return JointChain(pair, (ElementaryJoint(pair.name, True, shown.place(pair.members[0], pair.letters[0])),))
    ends = shown.ends[pair.name]
    make = _OF_WHEELS.get(pair.table)
    if make is not None:
        return make(shown, pair, ends)
    joints = tuple(_joints(shown, pair, ends))
    return JointChain(pair, (replace(joints[0], reach=_reach(shown, pair, ends)), *joints[1:])) if joints else None


def _joints(shown: PosedMechanism, pair: Pair, ends: Ends) -> Iterator[ElementaryJoint]:
    """Yield the joints of a simple pair, or of the two that stand for it at every pose."""
    if pair.is_simple:
        yield _joint(shown, pair, ends, 0, pair.name)
        return
    lower = lower_equivalent(pair, ends)
    for k, one in enumerate(lower.pairs if lower else ()):
        side = next(i for i, name in enumerate(one.members) if name in pair.members)
        assert lower is not None
        yield _joint(shown, one, lower.ends[one.name], side, f"{pair.name} (turn)" if k else pair.name)


def _joint(shown: PosedMechanism, pair: Pair, ends: Ends, side: int, name: str) -> ElementaryJoint:
    link, end = pair.members[side], ends[side]
    if pair.free_is_angle:
        return ElementaryJoint(name, True, shown.place(link, _plain(end.point)))
    return ElementaryJoint(name, False, shown.direction(link, _plain(end.along.c[0])))


def _reach(shown: PosedMechanism, pair: Pair, ends: Ends) -> tuple[float, float] | None:
    """Return how far the guide of a pair reaches from the pose as drawn."""
    ended = as_travel_limited(pair)
    if ended is None:
        return None
    poses = tuple(shown.poses[name].trimmed(0) for name in pair.members)
    before, after = (float(first_entry(way)) for way in ended.inside(_bounds(shown, ended), ends, poses))
    far = _OPEN * shown.mechanism.geometry.size
    return -min(before, far), min(after, far)


def _bounds(shown: PosedMechanism, ended: Any) -> tuple[float, float]:
    low, high = (float(first_entry(bound)) for bound in ended.bounds(shown.mechanism.geometry))
    return low, high


def _rolling(shown: PosedMechanism, pair: Pair, ends: Ends) -> JointChain:
    """Return a slide along the line and a hinge at the wheel's middle, tied."""
    on, wheel = pair.members
    along = shown.direction(on, _plain(ends[0].along.c[0]))
    slide = ElementaryJoint(pair.name, False, along)
    hinge = ElementaryJoint(f"{pair.name} (turn)", True, shown.place(wheel, _plain(ends[1].point)))
    return JointChain(pair, (slide, hinge), {slide.name: 1.0, hinge.name: _real(ends[1].measure)})


def _rack(shown: PosedMechanism, pair: Pair, ends: Ends) -> JointChain:
    """Return a slide along the pitch line, one across it, and a hinge at the pinion's axis, tied."""
    chain = _rolling(shown, pair, ends)
    slide, hinge = chain.joints
    across = ElementaryJoint(f"{pair.name} (across)", False, 1j * slide.axis)
    return replace(chain, joints=(slide, across, hinge))


def _rolling_round(shown: PosedMechanism, pair: Pair, ends: Ends) -> JointChain:
    """Return a hinge at the circle's middle and one at the wheel's, tied."""
    places = (shown.place(link, _plain(end.point)) for link, end in zip(pair.members, ends, strict=True))
    arm, hinge = (
        ElementaryJoint(name, True, place)
        for name, place in zip((pair.name, f"{pair.name} (turn)"), places, strict=True)
    )
    return JointChain(pair, (arm, hinge), {arm.name: 1.0 - _real(ends[1].measure), hinge.name: 1.0})


def _plain(value: Any) -> complex:
    return complex(first_entry(value))


def _real(value: Any) -> float:
    return float(first_entry(value))


_OF_WHEELS: Mapping[str, Callable[[PosedMechanism, Pair, Ends], JointChain]] = MappingProxyType(
    {"rollings": _rolling, "circular_rollings": _rolling_round, RACK: _rack}
)
