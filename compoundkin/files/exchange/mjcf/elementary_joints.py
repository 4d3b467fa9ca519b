"""Pairs as chains of hinges and slides, which are all the joints that a plane model of MuJoCo needs.

A pin is a hinge and a slide a slide; a pin in a slot is a slide and a hinge, a pin in an arc two hinges. A wheel that
rolls on a line is a slide and a hinge whose coordinates are in proportion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from compoundkin.base.arrays import first_entry
from compoundkin.files.exchange.shown_mechanism import ShownMechanism
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, lower_equivalent
from compoundkin.model.pairs.travel_limits import as_travel_limited

# What an end that is open is taken as, as a part of the size: MuJoCo has no half ranges.
_OPEN = 1e3
# Pairs of wheels on a carrier: they join no links, but tie angles of some that are joined.
GEARED = ("gears", "belts")
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


def chain_of(shown: ShownMechanism, pair: Pair) -> JointChain | None:
    """Return the joints of a pair; None where no hinges and slides are one.

    >>> from compoundkin.files.exchange.shown_mechanism import shown_mechanism
    >>> from compoundkin.files import load
    >>> shown = shown_mechanism(load("quick-return-pin-in-slot"))
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


def _joints(shown: ShownMechanism, pair: Pair, ends: Ends) -> Iterator[ElementaryJoint]:
    """Yield the joints of a simple pair, or of the two that stand for it at every pose."""
    if pair.is_simple:
        yield _joint(shown, pair, ends, 0, pair.name)
        return
    lower = lower_equivalent(pair, ends)
    for k, one in enumerate(lower.pairs if lower else ()):
        side = next(i for i, name in enumerate(one.members) if name in pair.members)
        assert lower is not None
        yield _joint(shown, one, lower.ends[one.name], side, f"{pair.name} (turn)" if k else pair.name)


def _joint(shown: ShownMechanism, pair: Pair, ends: Ends, side: int, name: str) -> ElementaryJoint:
    link, end = pair.members[side], ends[side]
    if pair.free_is_angle:
        return ElementaryJoint(name, True, shown.place(link, _plain(end.point)))
    return ElementaryJoint(name, False, shown.direction(link, _plain(end.along.c[0])))


def _reach(shown: ShownMechanism, pair: Pair, ends: Ends) -> tuple[float, float] | None:
    """Return how far the guide of a pair reaches from the pose as drawn."""
    ended = as_travel_limited(pair)
    if ended is None:
        return None
    poses = tuple(shown.poses[name].trimmed(0) for name in pair.members)
    before, after = (float(first_entry(way)) for way in ended.inside(_bounds(shown, ended), ends, poses))
    far = _OPEN * shown.mechanism.geometry.size
    return -min(before, far), min(after, far)


def _bounds(shown: ShownMechanism, ended: Any) -> tuple[float, float]:
    low, high = (float(first_entry(bound)) for bound in ended.bounds(shown.mechanism.geometry))
    return low, high


def _rolling(shown: ShownMechanism, pair: Pair, ends: Ends) -> JointChain:
    """Return a slide along the line and a hinge at the wheel's middle, tied."""
    on, wheel = pair.members
    along = shown.direction(on, _plain(ends[0].along.c[0]))
    slide = ElementaryJoint(pair.name, False, along)
    hinge = ElementaryJoint(f"{pair.name} (turn)", True, shown.place(wheel, _plain(ends[1].point)))
    return JointChain(pair, (slide, hinge), {slide.name: 1.0, hinge.name: _real(ends[1].measure)})


def _rack(shown: ShownMechanism, pair: Pair, ends: Ends) -> JointChain:
    """Return a slide along the pitch line, one across it, and a hinge at the pinion's axis, tied."""
    chain = _rolling(shown, pair, ends)
    slide, hinge = chain.joints
    across = ElementaryJoint(f"{pair.name} (across)", False, 1j * slide.axis)
    return replace(chain, joints=(slide, across, hinge))


def _rolling_round(shown: ShownMechanism, pair: Pair, ends: Ends) -> JointChain:
    """Return a hinge at the circle's middle and one at the wheel's, tied."""
    places = (shown.place(link, _plain(end.point)) for link, end in zip(pair.members, ends, strict=True))
    arm, hinge = (
        ElementaryJoint(name, True, place)
        for name, place in zip((pair.name, f"{pair.name} (turn)"), places, strict=True)
    )
    return JointChain(pair, (arm, hinge), {arm.name: 1.0 - _real(ends[1].measure), hinge.name: 1.0})


_OF_WHEELS: Mapping[str, Callable[[ShownMechanism, Pair, Ends], JointChain]] = MappingProxyType(
    {"rollings": _rolling, "circular_rollings": _rolling_round, RACK: _rack}
)


def _plain(value: Any) -> complex:
    return complex(first_entry(value))


def _real(value: Any) -> float:
    return float(first_entry(value))
