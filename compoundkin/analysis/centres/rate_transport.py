"""Relative twists carried along known centres, linear in the trial values, with errors.

Errors are taken from samples: every centre is used once as it is and twice slightly moved, by a known amount at
random, each time it is used anew. Bounds would be useless here: along a chain of moves most errors cancel.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation import Derivation
from compoundkin.analysis.centres.derivation_steps import Bridge, Join, Move, Turn
from compoundkin.analysis.centres.rate_sets import attach, pair_amplitudes, ring_amplitudes
from compoundkin.base.arrays import Number

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
