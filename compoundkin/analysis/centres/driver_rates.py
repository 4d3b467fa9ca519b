"""The drivers' rates carried to every body along known centres, with errors.

The theorem of angular velocity ratios: the rates of two links relative to a third are inversely as the distances of
their common centre from the two other ones. In homogeneous coordinates ``T_ij = a P_ik - b P_jk``, the relative twist
of i and j split over two centres; twists are linear in trial values.

Errors are taken from samples: every centre is used once as it is and twice slightly moved, by a known amount at random,
each time it is used anew. Bounds would be useless here: along a chain of moves most errors cancel.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation import (
    Bridge,
    Derivation,
    Join,
    Move,
    Turn,
    attach,
    pair_amplitudes,
    ring_amplitudes,
)
from compoundkin.analysis.centres.homogeneous import cross, norm
from compoundkin.base.arrays import Number

# Beyond this magnification of a twist's error other links carry it.
FAIR = 1e5
# A twist is tried through every two of so many others, those known best, and so many times at most: each body's twist
# gets better through those next to it, and with a hundred links every two of all of them would take minutes.
OTHERS = 14
ROUNDS = 14
# Other links are taken if they are better by this factor.
BETTER = 2.0


class DriverRates:
    """Twists of the bodies relative to each other, {body. (3, poses)}, and their errors in units of rounding.

    With one driver the driven pair turns at rate 1; the actual rate multiplies all.
    """

    def __init__(
        self, derivation: Derivation, points: Mapping[Couple, Number], spread: Mapping[Couple, Number]
    ) -> None:
        self.derivation = derivation
        self.points = points
        self.spread = spread
        self.twists: dict[int, Number] = {}
        self.errors: dict[int, Number] = {}

    def run(self, units: Sequence[Number], rates: Sequence[Number]) -> None:
        """Follow the derivation's moves, and where those are ill-conditioned the best links."""
        given = [np.ones(1)] if len(rates) == 1 else list(rates)
        carried = transport(self.derivation.moves, self.derivation, self.points, self.spread, units, given)
        poses = np.broadcast_shapes(*[unit.shape[1:] for unit in units])
        alone = {b: sum(1 for o in carried.member.values() if o == m) == 1 for b, m in carried.member.items()}
        self.twists = {b: np.array(np.broadcast_to(t[:, 0, 0], (3, *poses))) for b, t in carried.twists.items()}
        scale = self.fastest()
        for b, twist in carried.twists.items():
            moved = np.max(norm(twist[:, 0, 1:] - twist[:, 0, :1]), axis=0)
            error = np.inf if alone[b] else measured(moved / scale) * scale
            self.errors[b] = np.array(np.broadcast_to(error, poses))
        self._improve()

    def relative(self, i: int, j: int) -> tuple[Number, Number]:
        """Return the twist of body j relative to body i, and its error."""
        return self.twists[j] - self.twists[i], self.errors[i] + self.errors[j]

    def fastest(self) -> Number:
        """Return the largest length of a twist relative to the first body."""
        base = self.twists[self.derivation.body[0]]
        return np.fmax.reduce([norm(twist - base) for twist in self.twists.values()])

    def _improve(self) -> None:
        scale = self.fastest()
        poor = np.zeros(scale.shape, dtype=bool)
        for error in self.errors.values():
            poor |= ~(error <= FAIR * scale)
        at = np.flatnonzero(poor)
        if not at.size:
            return
        for _ in range(min(len(self.errors), ROUNDS)):
            better = [self._recarry(k, at) for k in self.errors]
            if not any(better):
                break

    def _recarry(self, k: int, at: Number) -> bool:
        """Improve the twist of a body at some poses by the best links; return whether it is better."""
        if not (self.errors[k][at] > 0.0).any():
            return False
        error = self.errors[k][at]
        twist = self.twists[k][:, at]
        changed = False
        for candidate, spread in self._carried_twists(k, at):
            better = spread * BETTER < error
            if better.any():
                changed = True
                twist, error = np.where(better, candidate, twist), np.where(better, spread, error)
        self.twists[k][:, at], self.errors[k][at] = twist, error
        return changed

    def _carried_twists(self, k: int, at: Number) -> Iterator[tuple[Number, Number]]:
        """Yield a body's twist through every two others known well, with its error."""
        others = [b for b in self.errors if b != k and np.isfinite(self.errors[b][at]).any()]
        others.sort(key=lambda b: float(np.min(or_infinite(self.errors[b][at] + self._place(b, k, at)[1]))))
        for i, j in combinations(others[:OTHERS], 2):
            (p, dp), (q, dq) = self._place(i, k, at), self._place(j, k, at)
            a, b = pair_amplitudes(p, q, self.twists[j][:, at] - self.twists[i][:, at])
            one, other = self.errors[i][at], self.errors[j][at]
            loose = (one + other + np.abs(a) * dp + np.abs(b) * dq) / norm(cross(p, q))
            error = one + np.abs(a) * dp + loose
            yield self.twists[i][:, at] + a * p, or_infinite(error)

    def _place(self, i: int, k: int, at: Number) -> tuple[Number, Number]:
        point, spread = self.points[couple(i, k)], self.spread[couple(i, k)]
        return at_poses(point, at), at_poses(spread, at)


def at_poses(array: Number, at: Number | slice) -> Number:
    """Return an array at some poses, unchanged if it has one column for all.

    >>> at_poses(np.arange(4.0), np.array([1, 3])).tolist()
    [1.0, 3.0]
    """
    return array if array.shape[-1] == 1 else array[..., at]


def or_infinite(spread: Number) -> Number:
    """Return a magnification of errors, infinite where it is not a number.

    >>> or_infinite(np.array([1.0, np.nan])).tolist()
    [1.0, inf]
    """
    return np.where(np.isnan(spread), np.inf, spread)


# Samples besides the exact one: that both underestimate an error tenfold is rarer than one in a thousand.
SAMPLES = 2
# What a sample is moved by, for an error of one rounding: far above rounding, and linear up to a spread of 1e7.
MOVED = 1e-9
# Samples that differ by more than this part say no more than that the error is large.
LINEAR = 0.1


class TransportedRates:
    """Twists of bodies, each in the set that it is known with. Shape (3, values + 1, 1 + SAMPLES, poses)."""

    def __init__(
        self, bodies: Sequence[int], values: int, points: Mapping[Couple, Number], spread: Mapping[Couple, Number]
    ) -> None:
        self.member = {b: b for b in bodies}
        self.twists: dict[int, Number] = {b: np.zeros((3, values + 1, 1 + SAMPLES, 1)) for b in bodies}
        self.points = points
        self.spread = spread
        self._noise = np.random.default_rng(0)

    def relative(self, i: int, j: int) -> Number:
        """Return the twist of j relative to i."""
        return self.twists[j] - self.twists[i]

    def turn(self, turn: Turn, place: Number, amplitude: Number) -> None:
        """Add a twist of the given amplitude (poses) on a parameter."""
        twist = self.sampled(place, self.spread[couple(turn.i, turn.k)]) * amplitude
        relative = np.zeros((3, self.twists[turn.i].shape[1], *twist.shape[1:]))
        relative[:, turn.parameter] = twist
        attach(self.twists, self.member, turn.i, turn.k, relative)

    def join(self, join: Join) -> None:
        """Join two sets through two centres."""
        i, k, j, m = join.i, join.k, join.j, join.m
        p, q = self._place(i, k), self._place(j, m)
        a, _ = pair_amplitudes(p, q, self.relative(i, j) - self.relative(k, m))
        attach(self.twists, self.member, i, k, p * a)

    def bridge(self, bridge: Bridge) -> None:
        """Join three sets through three centres."""
        p, r = self._place(bridge.i, bridge.k), self._place(bridge.l, bridge.m)
        q = self._place(bridge.n, bridge.j)
        gap = self.relative(bridge.i, bridge.j) - self.relative(bridge.k, bridge.l) - self.relative(bridge.m, bridge.n)
        a, _, b = ring_amplitudes(p, r, q, gap)
        attach(self.twists, self.member, bridge.i, bridge.k, p * a)
        attach(self.twists, self.member, bridge.j, bridge.n, -q * b)

    def sampled(self, vector: Number, spread: Number) -> Number:
        """Return a point or line (3, poses) as it is and moved. (3, 1 + SAMPLES, poses)."""
        noise = self._noise.standard_normal((3, SAMPLES, 1)) * MOVED
        poses = np.broadcast_shapes(vector.shape[1:], spread.shape)
        out = np.empty((3, 1 + SAMPLES, *poses))
        out[:, 0] = vector
        out[:, 1:] = vector[:, None] + noise * spread
        return out

    def _place(self, i: int, j: int) -> Number:
        """Return a known centre, (3, 1, 1 + SAMPLES, poses)."""
        return self.sampled(self.points[couple(i, j)], self.spread[couple(i, j)])[:, None]


def transport(
    moves: Sequence[Move],
    derivation: Derivation,
    points: Mapping[Couple, Number],
    spread: Mapping[Couple, Number],
    units: Sequence[Number],
    rates: Sequence[Number],
) -> TransportedRates:
    """Return the moves in order, over a block of poses.

    `units` are the primary centres, `rates` the drivers' amplitudes.
    """
    values = max((move.parameter for move in moves if isinstance(move, Turn)), default=0)
    carried = TransportedRates(tuple(dict.fromkeys(derivation.body)), values, points, spread)
    for move in moves:
        if isinstance(move, Join):
            carried.join(move)
        elif isinstance(move, Bridge):
            carried.bridge(move)
        elif move.driver >= 0:
            primary = derivation.diagram.drives[move.driver].primary
            carried.turn(move, units[primary], rates[move.driver])
        else:
            carried.turn(move, points[couple(move.i, move.k)], np.ones(1))
    return carried


def measured(difference: Number) -> Number:
    """Return the magnification of errors from the largest relative difference between the samples.

    >>> measured(np.array([2e-9, 0.5])).tolist()
    [2.0, inf]
    """
    return np.where(difference < LINEAR, difference / MOVED, np.inf)
