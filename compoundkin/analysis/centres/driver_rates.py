"""The drivers' rates carried to every body by centres alone. The theorem of angular velocity ratios.

The rates of two links relative to a third are inversely as the distances of their common centre from the two other
ones. In homogeneous coordinates: ``T_ij = a P_ik - b P_jk``, the relative twist of i and j split over two centres.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation import Derivation
from compoundkin.analysis.centres.homogeneous import cross, norm
from compoundkin.analysis.centres.rate_sets import pair_amplitudes
from compoundkin.analysis.centres.rate_transport import measured, transport
from compoundkin.base.arrays import Number

# Where the error of a twist is magnified more than this, other links are taken to carry it through.
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
        """Follow the derivation's moves. Where those are poor, go through whichever links are best."""
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
        """Return the best way to carry the twist to a body at some poses. Whether it is better than before."""
        if not (self.errors[k][at] > 0.0).any():
            return False
        error = self.errors[k][at]
        twist = self.twists[k][:, at]
        changed = False
        for candidate, spread in self._ways(k, at):
            better = spread * BETTER < error
            if better.any():
                changed = True
                twist, error = np.where(better, candidate, twist), np.where(better, spread, error)
        self.twists[k][:, at], self.errors[k][at] = twist, error
        return changed

    def _ways(self, k: int, at: Number) -> Iterator[tuple[Number, Number]]:
        """Yield a body's twist through every two others known well, with its error."""
        others = [b for b in self.errors if b != k and np.isfinite(self.errors[b][at]).any()]
        others.sort(key=lambda b: float(np.min(known(self.errors[b][at] + self._place(b, k, at)[1]))))
        for i, j in combinations(others[:OTHERS], 2):
            (p, dp), (q, dq) = self._place(i, k, at), self._place(j, k, at)
            a, b = pair_amplitudes(p, q, self.twists[j][:, at] - self.twists[i][:, at])
            one, other = self.errors[i][at], self.errors[j][at]
            loose = (one + other + np.abs(a) * dp + np.abs(b) * dq) / norm(cross(p, q))
            error = one + np.abs(a) * dp + loose
            yield self.twists[i][:, at] + a * p, known(error)

    def _place(self, i: int, k: int, at: Number) -> tuple[Number, Number]:
        point, spread = self.points[couple(i, k)], self.spread[couple(i, k)]
        return pick(point, at), pick(spread, at)


def pick(array: Number, at: Number) -> Number:
    """Return an array at some poses. As it is where one column stands for all.

    >>> pick(np.arange(4.0), np.array([1, 3])).tolist()
    [1.0, 3.0]
    """
    return array if array.shape[-1] == 1 else array[..., at]


def known(spread: Number) -> Number:
    """Return a magnification of errors, infinite where it is not a number.

    >>> known(np.array([1.0, np.nan])).tolist()
    [1.0, inf]
    """
    return np.where(np.isnan(spread), np.inf, spread)
