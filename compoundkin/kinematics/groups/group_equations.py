"""The equations of any group of pairs: bars, Newton's method for the position, one matrix for all derivatives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, complex_of
from compoundkin.base.linear import Elimination, Inverse, Row, stacked
from compoundkin.base.newton import ChordStop, chord_newton, elementwise_largest
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, as_series, constant
from compoundkin.kinematics.block import Block, size_in
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, Poses, constraint_scales
from compoundkin.structure.mobility_count import Body, Group

# Newton stops when no correction exceeds this (of the mechanism's size, or radians): it doubles its digits with every
# step, so that the pose is then exact to rounding.
CONVERGED = 1e-8


STEPS = 12


# After a correction below this (of the size, or radians) the matrix has hardly changed and is used once more.
CHORD = 1e-3


# A closed pose has every residual below this fraction of the size: rounding of some tens of additions, far less than
# what is left open a hundred-millionth of a radian beyond a limit position.
CLOSED = 1e-12


class Solution(NamedTuple):
    """Newton's answer: the state (..., width), whether it closes, and the largest correction made."""

    state: Number
    closed: Number
    moved: Number


class GroupEquations:
    """A group of `n` bodies joined and attached by `pairs`. `members` tells each pair's sides.

    Its state (..., width) is x, y, theta of each body in `kept`, all that are no bars, or with ``bars=False`` all: its
    angle, and where its point in `middles` is, or else its origin. An origin far away makes every turn a long way.
    """

    def __init__(
        self,
        n: int,
        pairs: tuple[Pair, ...],
        members: tuple[tuple[Member, ...], ...],
        size: float,
        middles: tuple[complex, ...] = (),
        bars: bool = True,
    ) -> None:
        self.n, self.pairs, self.members, self.size = n, pairs, members, size
        self.links = tuple(dict.fromkeys(member.link for sides in members for member in sides))
        self.middles = middles or (0j,) * n
        self.bars = bars_of(n, pairs, members) if bars else ()
        left_out = {bar.body for bar in self.bars}
        self.kept = tuple(k for k in range(n) if k not in left_out)
        pins = {pin.number for bar in self.bars for pin in bar.pins}
        self.others = tuple(k for k in range(len(pairs)) if k not in pins)
        # what makes a change of the state a pure number: parts of the size, radians
        self.weights = self._weights(size)

    @property
    def width(self) -> int:
        """How many numbers a state has."""
        return 3 * len(self.kept)

    def weights_in(self, ends: Mapping[str, Ends]) -> Number:
        """Return the weights of each design, (..., width)."""
        size = size_in(ends, self.size)
        return self.weights if size is self.size else self._weights(size)

    def _weights(self, size: Number) -> Number:
        part = np.ones(np.shape(size)) / size
        return np.moveaxis(np.array([part, part, np.ones_like(part)] * len(self.kept)), 0, -1)

    def state(self, bodies: list[Pose]) -> Number:
        """Return the state of all bodies' poses, at their leading coefficients."""
        spots = {k: bodies[k].at(self.middles[k]).c[0] for k in self.kept}
        parts = [v for k in self.kept for v in (spots[k].real, spots[k].imag, bodies[k].angle.c[0])]
        return np.stack(np.broadcast_arrays(*parts), axis=-1)

    def newton(self, state: Number, block: Block, steps: int = STEPS, longest: float = np.inf) -> Solution:
        """Correct the state until the group closes; `state` (..., width) broadcasts with the surroundings.

        No single correction is longer than `longest` (of the size, or radians).
        """
        leading, weights = block.leading(self.links), np.moveaxis(self.weights_in(block.ends), -1, 0)
        start = [np.asarray(v) for v in np.moveaxis(np.asarray(state, dtype=float), -1, 0)]
        bodies: dict[int, Pose] = {}

        def system(values: list[Number]) -> tuple[list[Number], Callable[[], Inverse]]:
            nonlocal bodies
            bodies = here = self.kept_poses(values)
            return self.residual(here, leading, 0), lambda: Inverse(self._rows(here, leading), self.width)

        stop = ChordStop(CONVERGED, CLOSED * size_in(block.ends, self.size), CHORD, steps, longest)
        found, closed = chord_newton(system, start, weights, stop)
        closed = closed & self._properly_assembled(bodies, leading)
        moved = elementwise_largest([(v - s) * w for v, s, w in zip(found, start, weights, strict=True)])
        return Solution(np.stack(np.broadcast_arrays(*found), axis=-1), closed, moved)

    def series(self, state: Number, block: Block, order: int) -> list[Pose]:
        """Return all bodies' poses to the given order, from a closed state."""
        kept = self.kept_poses([np.ascontiguousarray(v) for v in np.moveaxis(state, -1, 0)])
        if order:
            inverse = Inverse(self._rows(kept, block.leading(self.links)), self.width)
            for k in range(1, order + 1):
                kept = self.grown(kept, self.next_rates(kept, inverse, block, k))
        found = {**kept, **{bar.body: bar.pose(kept, block, order) for bar in self.bars}}
        return [found[k] for k in range(self.n)]

    def rates(self, state: Number, block: Block, order: int) -> tuple[list[Number], Number]:
        """Return the state's coefficients 1 to `order` in a block; and its side.

        Each is (..., width), the block of that order.

        The side is the sign of the determinant of the equations: it changes across a singularity.
        """
        kept = self.kept_poses([np.ascontiguousarray(v) for v in np.moveaxis(state, -1, 0)])
        inverse = Inverse(self._rows(kept, block.leading(self.links)), self.width)
        found = []
        for k in range(1, order + 1):
            step = self.next_rates(kept, inverse, block, k)
            kept = self.grown(kept, step)
            found.append(np.stack(np.broadcast_arrays(*step, state[..., 0])[:-1], axis=-1))
        return found, np.sign(inverse.determinant)

    def matrix(self, state: Number, block: Block) -> Number:
        """Return the matrix of all equations at a state, (..., width, width)."""
        kept = self.kept_poses(list(np.moveaxis(state, -1, 0)))
        return stacked(self._rows(kept, block.leading(self.links)), self.width)

    def next_rates(
        self, kept: Mapping[int, Pose], inverse: Inverse | Elimination, block: Block, k: int
    ) -> list[Number]:
        """Return the k-th coefficients of the state, from poses known to the one before."""
        trial = {j: self._turned(j, b, (0j, 0.0)) for j, b in kept.items()}
        return inverse.times([-r for r in self.residual(trial, block, k)])

    def grown(self, kept: Mapping[int, Pose], step: list[Number]) -> dict[int, Pose]:
        """Return the poses with one more coefficient."""
        return {
            j: self._turned(j, b, (step[3 * i] + 1j * step[3 * i + 1], step[3 * i + 2]))
            for i, (j, b) in enumerate(kept.items())
        }

    def _turned(self, body: int, pose: Pose, more: tuple[Number, Number]) -> Pose:
        """Return the pose of a body with one more coefficient of its middle and its angle."""
        angle = Series((*pose.angle.c, more[1]))
        return _about(Series((*pose.at(self.middles[body]).c, more[0])), angle, self.middles[body])

    def kept_poses(self, values: Sequence[Number]) -> dict[int, Pose]:
        """Return the poses of the kept bodies, from the numbers of a state."""
        found = {}
        for i, body in enumerate(self.kept):
            x, y, theta = values[3 * i : 3 * i + 3]
            found[body] = _about(constant(complex_of(x, y)), constant(theta), self.middles[body])
        return found

    def residual(self, bodies: Mapping[int, Pose], block: Block, k: int) -> list[Number]:
        """Return the k-th coefficients of all equations. The bars come first."""
        found = [bar.residual(bodies, block, k) for bar in self.bars]
        for number in self.others:
            pair = self.pairs[number]
            closure = pair.closure(block.ends[pair.name], self._links(number, bodies, block, k))
            found += [
                c.c[k] * w if len(c.c) > k else 0.0 for c, w in zip(closure, self._lengths(pair, block), strict=True)
            ]
        return found

    def _rows(self, bodies: Mapping[int, Pose], block: Block) -> list[Row]:
        """Return the Jacobian of all equations by the state."""
        first = {body: BodyColumns(3 * i, bodies[body].at(self.middles[body]).c[0]) for i, body in enumerate(self.kept)}
        rows = [bar.row(first, bodies, block) for bar in self.bars]
        for number in self.others:
            rows += self._pair_rows(number, first, bodies, block)
        return rows

    def _pair_rows(
        self, number: int, first: Mapping[int, BodyColumns], bodies: Mapping[int, Pose], block: Block
    ) -> Iterator[Row]:
        pair = self.pairs[number]
        poses = self._links(number, bodies, block, 0)
        table = pair.jacobian(block.ends[pair.name], poses)
        for r, length in enumerate(self._lengths(pair, block)):
            row: Row = {}
            for side, member in enumerate(self.members[number]):
                if member.body is not None:
                    x, y, theta = (table[..., r, 3 * side + j] * length for j in range(3))
                    start, spot = first[member.body]
                    arm = poses[side].z.c[0] - spot
                    # derivatives by a link's x, y, theta as derivatives by those of the body it is fixed in
                    add(row, start, (x, y, theta + y * arm.real - x * arm.imag))
            yield row

    def _lengths(self, pair: Pair, block: Block) -> Iterator[Number]:
        """Yield by what a pair's equations are multiplied, so that all are lengths and close alike in any unit."""
        size = size_in(block.ends, self.size)
        return (size / scale for scale in constraint_scales(pair, size))

    def _links(self, number: int, bodies: Mapping[int, Pose], block: Block, k: int) -> Poses:
        """Return the poses of a pair's members, to order k at most."""
        return tuple(member.pose(bodies, block, k) for member in self.members[number])

    def _properly_assembled(self, bodies: Mapping[int, Pose], block: Block) -> Number:
        """Whether every pair is closed in the way that is meant, such as no guide the wrong way round in its block."""
        good: Number = True
        for number in self.others:
            pair = self.pairs[number]
            good = good & pair.is_properly_assembled(block.ends[pair.name], self._links(number, bodies, block, 0))
        return good


def _about(spot: Series, angle: Series, middle: complex) -> Pose:
    """Return the pose of a body at an angle with its point `middle` at a spot."""
    u = angle.turn()
    return Pose(spot if middle == 0 else spot - u * middle, u, angle)


# After steps that are not known to have converged, a correction that moves farther than this may have left its branch.
STRAY = 0.03


class ClosedState(NamedTuple):
    """Where steps led.

    The bodies' poses there, the matrix there, and whether all is as it should be.
    """

    bodies: Mapping[int, Pose]
    matrix: Elimination
    closed: Number


class NewtonSteps(NamedTuple):
    """So many of Newton's steps, and a last one.

    Steps before the last come from states that are only near, such as those predicted from another pose. Rates have the
    matrix of where the last one led: that of the step is as good in value, but does not change with dimensions as it.
    """

    equations: GroupEquations
    before: int = 0

    def closed(self, state: Sequence[Number], block: Block, leap: float) -> ClosedState:
        """Correct a state that moves no farther than a leap."""
        equations, leading, found = self.equations, block.leading(self.equations.links), list(state)
        for _ in range(self.before + 1):
            bodies = equations.kept_poses(found)
            step = self._matrix(bodies, leading).times(equations.residual(bodies, leading, 0))
            found = [value - change for value, change in zip(found, step, strict=True)]
        moved = [value - start for value, start in zip(found, state, strict=True)]
        near = self._largest(moved) <= (min(leap, STRAY) if self.before else leap)
        exact = self._largest(step) <= CONVERGED
        bodies = equations.kept_poses(found)
        return ClosedState(bodies, self._matrix(bodies, leading), near & exact)

    def _matrix(self, bodies: Mapping[int, Pose], leading: Block) -> Elimination:
        return Elimination([*self._rows(bodies, leading)], self.equations.width)

    def _largest(self, change: Sequence[Number]) -> Number:
        return elementwise_largest([one * weight for one, weight in zip(change, self.equations.weights, strict=True)])

    def _rows(self, bodies: Mapping[int, Pose], block: Block) -> Iterator[Row]:
        """Yield the Jacobian by rows: the equations' rates as one number of the state grows at unit rate."""
        equations = self.equations
        columns = [
            equations.residual({**bodies, body: moving}, block, 1)
            for body in equations.kept
            for moving in _moved_alone(bodies[body], equations.middles[body])
        ]
        for entries in zip(*columns, strict=True):
            yield dict(enumerate(entries))

    def series(self, found: ClosedState, block: Block) -> list[Pose]:
        """Return all bodies' poses to the block's order."""
        equations, kept = self.equations, dict(found.bodies)
        for k in range(1, block.order + 1):
            kept = equations.grown(kept, equations.next_rates(kept, found.matrix, block, k))
        whole = {**kept, **{bar.body: bar.pose(kept, block, block.order) for bar in equations.bars}}
        return [whole[k] for k in range(equations.n)]


def _moved_alone(pose: Pose, middle: complex) -> Iterator[Pose]:
    """Yield a pose as it moves at unit rate in x, y, and angle about its middle. What stands still has no rates."""
    z, u = pose.z.c[0], pose.u.c[0]
    yield Pose(Series((z, 1.0 + 0j)), pose.u)
    yield Pose(Series((z, 1j)), pose.u)
    turned = 1j * u
    yield Pose(pose.z if middle == 0 else Series((z, turned * -middle)), Series((u, turned)))


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


def surroundings(equations: GroupEquations, block: Block) -> tuple[Number, Number]:
    """Return the midst of the places where a group is attached, and its reach.

    The reach is how far these places are from it, or the longest distance of two pairs on a link. It does not depend
    on where the frame has its origin or other links have their points.
    """
    attached: list[Number] = []
    on: dict[str, list[Number]] = {}
    for pair, members in zip(equations.pairs, equations.members, strict=True):
        for end, member in zip(block.ends[pair.name], members, strict=True):
            if member.body is None:
                attached.append(block.world[member.link].at(end.point).c[0])
            else:
                on.setdefault(member.link, []).append(as_series(end.point).c[0])
    centre = sum(attached) / max(len(attached), 1)
    spans = [np.abs(one - other) for own in on.values() for one, other in combinations(own, 2)]
    reach = 0.0
    for span in (*spans, *(np.abs(place - centre) for place in attached)):
        reach = np.maximum(reach, span)
    return centre, np.where(reach > 0.0, reach, size_in(block.ends, equations.size))


def middle_of(body: Body, group: Group, ends: Mapping[str, Ends]) -> complex:
    """Return the point of a body by which its state tells where it is.

    In its base's frame it is the origin, unless that lies outside the pairs on the base: then it is the midst of
    these. Points that are no numbers, but stand for some, tell of no place.
    """
    pairs = (*group.inner, *group.outer)
    sides = [(pair, side) for pair in pairs for side, name in enumerate(pair.members) if name == body.links[0]]
    points = (as_series(ends[pair.name][side].point).c[0] for pair, side in sides)
    own = [np.mean(point) for point in points if isinstance(point, (complex, float, int, np.ndarray, np.number))]
    middle = complex(np.mean(own)) if own else 0j
    # about the origin poses take fewer products, which is what most of the time goes into
    return 0j if abs(middle) <= max((abs(place - middle) for place in own), default=0.0) else middle
