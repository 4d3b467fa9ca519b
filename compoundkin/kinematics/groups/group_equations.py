"""The equations of any group of pairs: Newton for the position, one matrix for all derivatives.

The unknowns are x, y, theta of every body that is no bar; the equations are the lengths of the bars and the other
pairs' own closures, the matrix their own Jacobians. Each further coefficient of the time series comes from ONE linear
solve with the matrix of the position: the residual's next coefficient, taken with the unknown one set to zero, is the
right-hand side.

Source: the velocity and acceleration equations share their coefficient matrix, e.g. P. E. Nikravesh,
Computer-Aided Analysis of Mechanical Systems, section 3.2; for all orders A. Griewank and A. Walther,
Evaluating Derivatives, section 13.3.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, complex_of
from compoundkin.base.linear import Elimination, Inverse, Row, stacked
from compoundkin.base.newton import ChordStop, chord_newton, elementwise_largest
from compoundkin.base.poses import Pose
from compoundkin.base.series import Series, constant
from compoundkin.kinematics.block import Block
from compoundkin.kinematics.groups.bars import BodyColumns, Member, add, bars_of
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Poses, constraint_scales

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
        self.middles = middles or (0j,) * n
        self.bars = bars_of(n, pairs, members) if bars else ()
        left_out = {bar.body for bar in self.bars}
        self.kept = tuple(k for k in range(n) if k not in left_out)
        pins = {pin.number for bar in self.bars for pin in bar.pins}
        self.others = tuple(k for k in range(len(pairs)) if k not in pins)
        # what makes a change of the state a pure number: parts of the size, radians
        self.weights = np.tile([1.0 / size, 1.0 / size, 1.0], len(self.kept))

    @property
    def width(self) -> int:
        """How many numbers a state has."""
        return 3 * len(self.kept)

    def state(self, bodies: list[Pose]) -> Number:
        """Return the state of all bodies' poses, at their leading coefficients."""
        spots = {k: bodies[k].at(self.middles[k]).c[0] for k in self.kept}
        parts = [v for k in self.kept for v in (spots[k].real, spots[k].imag, bodies[k].angle.c[0])]
        return np.stack(np.broadcast_arrays(*parts), axis=-1)

    def newton(self, state: Number, block: Block, steps: int = STEPS, longest: float = np.inf) -> Solution:
        """Correct the state until the group closes; `state` (..., width) broadcasts with the surroundings.

        No single correction is longer than `longest` (of the size, or radians).
        """
        leading, weights = block.leading(), self.weights
        start = [np.asarray(v) for v in np.moveaxis(np.asarray(state, dtype=float), -1, 0)]
        bodies: dict[int, Pose] = {}

        def system(values: list[Number]) -> tuple[list[Number], Callable[[], Inverse]]:
            nonlocal bodies
            bodies = here = self.kept_poses(values)
            return self.residual(here, leading, 0), lambda: Inverse(self._rows(here, leading), self.width)

        stop = ChordStop(CONVERGED, CLOSED * self.size, CHORD, steps, longest)
        found, closed = chord_newton(system, start, weights, stop)
        closed = closed & self._properly_assembled(bodies, leading)
        moved = elementwise_largest([(v - s) * w for v, s, w in zip(found, start, weights, strict=True)])
        return Solution(np.stack(np.broadcast_arrays(*found), axis=-1), closed, moved)

    def series(self, state: Number, block: Block, order: int) -> list[Pose]:
        """Return all bodies' poses to the given order, from a closed state."""
        kept = self.kept_poses([np.ascontiguousarray(v) for v in np.moveaxis(state, -1, 0)])
        if order:
            inverse = Inverse(self._rows(kept, block.leading()), self.width)
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
        inverse = Inverse(self._rows(kept, block.leading()), self.width)
        found = []
        for k in range(1, order + 1):
            step = self.next_rates(kept, inverse, block, k)
            kept = self.grown(kept, step)
            found.append(np.stack(np.broadcast_arrays(*step, state[..., 0])[:-1], axis=-1))
        return found, np.sign(inverse.determinant)

    def matrix(self, state: Number, block: Block) -> Number:
        """Return the matrix of all equations at a state, (..., width, width)."""
        kept = self.kept_poses(list(np.moveaxis(state, -1, 0)))
        return stacked(self._rows(kept, block.leading()), self.width)

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
            found += [c.c[k] * w if len(c.c) > k else 0.0 for c, w in zip(closure, self._lengths(pair), strict=True)]
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
        for r, length in enumerate(self._lengths(pair)):
            row: Row = {}
            for side, member in enumerate(self.members[number]):
                if member.body is not None:
                    x, y, theta = (table[..., r, 3 * side + j] * length for j in range(3))
                    start, spot = first[member.body]
                    arm = poses[side].z.c[0] - spot
                    # derivatives by a link's x, y, theta as derivatives by those of the body it is fixed in
                    add(row, start, (x, y, theta + y * arm.real - x * arm.imag))
            yield row

    def _lengths(self, pair: Pair) -> Iterator[float]:
        """Yield by what a pair's equations are multiplied, so that all are lengths and close alike in any unit."""
        return (self.size / scale for scale in constraint_scales(pair, self.size))

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
