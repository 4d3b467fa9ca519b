"""Bars: bodies of a group that only keep two points of others at a distance, so that they need no unknowns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.linear import Row
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, as_series
from compoundkin.kinematics.block import Block
from compoundkin.model.pairs import Pair


@dataclass(frozen=True)
class Member:
    """One side of a pair. The link, and the index of its body in the group or None for a known link."""

    link: str
    body: int | None

    def pose(self, bodies: Mapping[int, Pose], block: Block, k: int) -> Pose:
        """Return the link's pose, to order k at most."""
        if self.body is None:
            return block.world[self.link].trimmed(k)
        local = block.local.get(self.link)
        return bodies[self.body] if local is None else bodies[self.body].compose(local.trimmed(k))


class BodyColumns(NamedTuple):
    """Where a body's numbers begin in a state, and about which place it turns."""

    start: int
    spot: Number


@dataclass(frozen=True)
class BarPin:
    """A pin of a bar. Its number among the group's pairs, its sides, and which of them is the bar's."""

    number: int
    pair: Pair
    members: Sequence[Member]
    own: int

    def at_other(self, bodies: Mapping[int, Pose], block: Block, k: int) -> tuple[int | None, Series]:
        """Return the body at its other side, and where that has the pin."""
        member = self.members[1 - self.own]
        end = block.ends[self.pair.name][1 - self.own]
        return member.body, member.pose(bodies, block, k).at(end.point)

    def in_bar(self, block: Block) -> Series:
        """Return where it is in the bar's frame."""
        local = block.local.get(self.members[self.own].link)
        point = block.ends[self.pair.name][self.own].point
        return as_series(point) if local is None else local.at(point)


@dataclass(frozen=True)
class Bar:
    """A body with two pins. It holds one coordinate, the distance of the points at their other sides."""

    body: int
    pins: tuple[BarPin, BarPin]

    def residual(self, bodies: Mapping[int, Pose], block: Block, k: int) -> Number:
        """Return the k-th coefficient of half the squared distance, by the length.

        The squared length is subtracted from that of the distance.
        """
        (_, one), (_, two) = (pin.at_other(bodies, block, k) for pin in self.pins)
        length2 = self._length2(block)
        gap = (two - one).abs2() - Series(length2.c[: k + 1])
        return gap.c[k] * (0.5 / np.sqrt(length2.c[0])) if len(gap.c) > k else 0.0

    def row(self, first: Mapping[int, BodyColumns], bodies: Mapping[int, Pose], block: Block) -> Row:
        """Return the derivatives by the state; `first` are the columns of the bodies."""
        (_, one), (_, two) = ends = tuple(pin.at_other(bodies, block, 0) for pin in self.pins)
        along = (two - one).c[0] / np.sqrt(self._length2(block).c[0])
        row: Row = {}
        for (body, place), sign in zip(ends, (-1.0, 1.0), strict=True):
            if body is not None:
                add_point(row, first[body].start, along * sign, place.c[0] - first[body].spot)
        return row

    def pose(self, bodies: Mapping[int, Pose], block: Block, order: int) -> Pose:
        """Return its pose between its two pins."""
        (_, one), (_, two) = (pin.at_other(bodies, block, order) for pin in self.pins)
        first, second = (pin.in_bar(block) for pin in self.pins)
        u = (two - one) / (second - first)
        return Pose(one - u * first, u)

    def _length2(self, block: Block) -> Series:
        one, two = (pin.in_bar(block) for pin in self.pins)
        return (two - one).abs2()


def bars_of(n: int, pairs: Sequence[Pair], members: Sequence[Sequence[Member]]) -> tuple[Bar, ...]:
    """Return as many two-pin bodies as can be left out together. They are of `n` bodies; no two of them are on one pin.

    Those with fewest such neighbours first; the others remain bodies like any.
    """
    on: list[list[int]] = [[] for _ in range(n)]
    for k, sides in enumerate(members):
        for side in sides:
            if side.body is not None:
                on[side.body].append(k)
    found = {body: _bar(body, on[body], pairs, members) for body in range(n) if _has_two_pins(on[body], pairs)}
    beside = {body: [other for other in _neighbours(bar) if other in found] for body, bar in found.items()}
    chosen: dict[int, Bar] = {}
    for body in sorted(found, key=lambda body: (len(beside[body]), body)):
        if not any(other in chosen for other in beside[body]):
            chosen[body] = found[body]
    return tuple(chosen[body] for body in sorted(chosen))


def _has_two_pins(on: Sequence[int], pairs: Sequence[Pair]) -> bool:
    return len(on) == 2 and on[0] != on[1] and all(pairs[k].is_simple and pairs[k].free_is_angle for k in on)


def _bar(body: int, on: Sequence[int], pairs: Sequence[Pair], members: Sequence[Sequence[Member]]) -> Bar:
    one, two = (BarPin(k, pairs[k], members[k], 0 if members[k][0].body == body else 1) for k in on)
    return Bar(body, (one, two))


def _neighbours(bar: Bar) -> list[int]:
    others = (pin.members[1 - pin.own].body for pin in bar.pins)
    return [body for body in others if body is not None]


def add_point(row: Row, column: int, along: Number, arm: Number) -> None:
    """Add what a body's x, y, theta move its point in a direction. The point is at an arm from where the body turns."""
    add(row, column, (along.real, along.imag, along.imag * arm.real - along.real * arm.imag))


def add(row: Row, column: int, entries: tuple[Number, Number, Number]) -> None:
    """Add three entries to a row of a matrix."""
    for j, entry in enumerate(entries, column):
        row[j] = row[j] + entry if j in row else entry
