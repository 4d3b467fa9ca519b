"""Other lines for centres where those of the derivation nearly coincide."""

from __future__ import annotations

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple
from compoundkin.analysis.centres.derivation_steps import BY_RATES, Given
from compoundkin.analysis.centres.driver_rates import DriverRates, known, pick
from compoundkin.analysis.centres.evaluation import Evaluation, joining
from compoundkin.analysis.centres.homogeneous import cross, norm
from compoundkin.analysis.centres.rate_transport import LINEAR, MOVED
from compoundkin.base.arrays import Number

# Where errors are magnified more than this (rounding becomes 1e-11), other lines are tried for the centre.
FAIR = 1e5
# Lines of all poses together that are drawn, in some four seconds, and rounds that are gone whatever they take. Centres
# that remain poor say so by their conditioning.
MOST_LINES = 25_000_000
ROUNDS = 4
# Centres with less than this at all poses are left alone: through them no other gets poor.
GOOD = 1e2
# Where all lines leave errors magnified more than this (rounding becomes 1e-10), the rates are tried.
POOR = 1e6
# What is found otherwise is taken if it is better by this factor: less is not worth the change.
BETTER = 2.0


def recompute(evaluation: Evaluation) -> None:
    """Repeat the best crossing for poor centres until none gets better.

    Magnification grows along every chain of crossings, so that no centre comes to rest on itself.
    """
    rules = evaluation.derivation.rules
    given = {rule.found for rule in rules if isinstance(rule, Given)}
    crossed = [c for c in evaluation.points if c not in given]
    poses = np.broadcast_shapes(*[unit.shape[1:] for unit in evaluation.units])
    poor = np.zeros(poses, dtype=bool)
    for c in crossed:
        # NaN counts as poor
        poor |= ~(evaluation.spread[c] <= FAIR)
    for unit in evaluation.units:
        poor &= ~np.isnan(unit[0])
    at = np.flatnonzero(poor)
    if at.size:
        with np.errstate(all="ignore"):
            _PoorPoses(evaluation, at, poses).run(crossed)


class _PoorPoses:
    """All lines of all centres, at the poses where a centre is poor.

    `points` (3, bodies, bodies, poses) and `spread` (bodies, bodies, poses) hold each centre in both orders, so that
    all lines of one are drawn at once.
    """

    def __init__(self, whole: Evaluation, at: Number, poses: tuple[int, ...]) -> None:
        self.whole, self.at, self.poses = whole, at, poses
        self.units, self.rates = ([pick(v, at) for v in vs] for vs in (whole.units, whole.rates))
        bodies = tuple(dict.fromkeys(whole.derivation.body))
        self.names = np.array(bodies, dtype=np.int32)
        self.place = {body: k for k, body in enumerate(bodies)}
        self.points = np.full((3, len(bodies), len(bodies), len(at)), np.nan)
        self.spread = np.full(self.points.shape[1:], np.inf)
        self.lines: dict[Couple, tuple[Number, Number, Number]] = {}
        for c, point in whole.points.items():
            self._keep(c, pick(point, at), known(pick(whole.spread[c], at)))

    def run(self, crossed: list[Couple]) -> None:
        """Recompute until nothing gets better, or as often as that takes some seconds."""
        lines = len(crossed) * self.spread.shape[1] * len(self.at)
        for _ in crossed[: max(ROUNDS, MOST_LINES // lines)]:
            better = [self._take(c, *self._best(c)) for c in crossed if (self._spread(c) > GOOD).any()]
            if not any(better):
                break
        if any((self._spread(c) > POOR).any() for c in crossed):
            self._by_rates(crossed)
        for c in self.lines:
            self._put_back(c)

    def _keep(self, c: Couple, point: Number, spread: Number) -> None:
        i, j = (self.place[body] for body in c)
        self.points[:, i, j] = self.points[:, j, i] = point
        self.spread[i, j] = self.spread[j, i] = spread

    def _point(self, c: Couple) -> Number:
        return self.points[:, self.place[c[0]], self.place[c[1]]]

    def _spread(self, c: Couple) -> Number:
        return self.spread[self.place[c[0]], self.place[c[1]]]

    def _by_rates(self, crossed: list[Couple]) -> None:
        """Use the drivers' rates, carried by other centres, where all lines are nearly one."""
        points, spread = ({c: held(c) for c in self.whole.points} for held in (self._point, self._spread))
        rates = DriverRates(self.whole.derivation, points, spread)
        rates.run(self.units, self.rates)
        none = np.full(len(self.at), BY_RATES, dtype=np.int32)
        for c in crossed:
            twist, error = rates.relative(*c)
            length = norm(twist)
            spread = error / length
            found = np.where((self._spread(c) > POOR) & (spread < LINEAR / MOVED), spread, np.inf)
            self._take(c, twist / length, known(found), none, none)

    def _take(self, c: Couple, point: Number, spread: Number, first: Number, second: Number) -> bool:
        """Keep another point where it is better; whether it is anywhere."""
        better = spread * BETTER < self._spread(c)
        if not better.any():
            return False
        none = np.full(len(self.at), False), *[np.zeros(len(self.at), dtype=np.int32)] * 2
        old = self.lines.get(c, none)
        self.lines[c] = (old[0] | better, np.where(better, first, old[1]), np.where(better, second, old[2]))
        self._keep(c, np.where(better, point, self._point(c)), np.where(better, spread, self._spread(c)))
        return True

    def _drawn(self, c: Couple) -> tuple[Number, Number, Number]:
        """Return the names of all lines of a centre, the lines (3, names, poses), and their magnification."""
        i, j = (self.place[body] for body in c)
        lines, tilts = joining(self.points[:, i], self.spread[i], self.points[:, :, j], self.spread[:, j])
        own = self.whole.derivation.own_lines(c)
        units = np.empty((3, len(own), len(self.at)))
        for k, primary in enumerate(own):
            units[:, k] = self.units[primary]
        names = np.concatenate([-1 - np.array(own, dtype=np.int32), self.names])
        tilts = np.concatenate([np.ones(units.shape[1:]), known(tilts)])
        return names, np.concatenate([units, lines], axis=1), tilts

    def _best(self, c: Couple) -> tuple[Number, Number, Number, Number]:
        """Return the crossing of the best line with its best partner."""
        names, lines, tilts = self._drawn(c)
        one = np.argmin(tilts, axis=0)
        columns = np.arange(len(self.at))
        leader, lead = lines[:, one, columns], tilts[one, columns]
        met = cross(leader[:, None], lines)
        sines = norm(met)
        spreads = known(np.hypot(tilts, lead) / sines)
        other = np.argmin(spreads, axis=0)
        best = spreads[other, columns]
        point = met[:, other, columns] / sines[other, columns]
        return point, known(np.sqrt(1.0 + best * best)), names[one], names[other]

    def _put_back(self, c: Couple) -> None:
        whole = self.whole
        point = np.array(np.broadcast_to(whole.points[c], (3, *self.poses)))
        spread = np.array(np.broadcast_to(whole.spread[c], self.poses))
        point[:, self.at], spread[self.at] = self._point(c), self._spread(c)
        whole.keep(c, point, spread)
        chosen, first, second = self.lines[c]
        whole.lines[c] = (self.at[chosen], first[chosen], second[chosen])
