"""Other lines for centres where those of the derivation nearly coincide."""

from __future__ import annotations

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple
from compoundkin.analysis.centres.derivation_steps import BY_RATES, Given
from compoundkin.analysis.centres.driver_rates import DriverRates, known, pick
from compoundkin.analysis.centres.evaluation import Evaluation
from compoundkin.analysis.centres.homogeneous import cross, norm
from compoundkin.base.series import Number

# Where errors are magnified more than this (rounding becomes 1e-11), other lines are tried for the centre.
FAIR = 1e5
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
    """All lines of all centres, at the poses where a centre is poor."""

    def __init__(self, whole: Evaluation, at: Number, poses: tuple[int, ...]) -> None:
        self.whole = whole
        self.at = at
        self.poses = poses
        self.part = Evaluation(whole.derivation, *([pick(v, at) for v in vs] for vs in (whole.units, whole.rates)))
        for c, point in whole.points.items():
            self.part.keep(c, pick(point, at), known(pick(whole.spread[c], at)))
        self.bodies = tuple(dict.fromkeys(whole.derivation.body))

    def run(self, crossed: list[Couple]) -> None:
        """Recompute until nothing gets better; at most once for each centre."""
        for _ in crossed:
            better = [self._recross(c) for c in crossed]
            if not any(better):
                break
        if any((self.part.spread[c] > POOR).any() for c in crossed):
            self._by_rates(crossed)
        for c in self.part.lines:
            self._put_back(c)

    def _recross(self, c: Couple) -> bool:
        vias = [-1 - p for p in self.whole.derivation.own_lines(c)] + [k for k in self.bodies if k not in c]
        return self._take(c, *self._best(c, vias))

    def _by_rates(self, crossed: list[Couple]) -> None:
        """Use the drivers' rates, carried by other centres, where all lines are nearly one."""
        rates = DriverRates(self.whole.derivation, self.part.points, self.part.spread)
        rates.run(self.part.units, self.part.rates)
        none = np.full(len(self.at), BY_RATES, dtype=np.int32)
        for c in crossed:
            twist, error = rates.relative(*c)
            length = norm(twist)
            spread = np.where(self.part.spread[c] > POOR, error / length, np.inf)
            self._take(c, twist / length, known(spread), none, none)

    def _take(self, c: Couple, point: Number, spread: Number, first: Number, second: Number) -> bool:
        """Keep another point where it is better; whether it is anywhere."""
        better = spread * BETTER < self.part.spread[c]
        if not better.any():
            return False
        none = np.full(len(self.at), False), *[np.zeros(len(self.at), dtype=np.int32)] * 2
        old = self.part.lines.get(c, none)
        self.part.lines[c] = (old[0] | better, np.where(better, first, old[1]), np.where(better, second, old[2]))
        self.part.keep(c, np.where(better, point, self.part.points[c]), np.where(better, spread, self.part.spread[c]))
        self.part.drawn.clear()
        return True

    def _best(self, c: Couple, vias: list[int]) -> tuple[Number, Number, Number, Number]:
        """Return the crossing of the best line with its best partner."""
        drawn = [self.part.line(*c, via) for via in vias]
        shape = (len(vias), len(self.at))
        lines = np.empty((3, *shape))
        tilts = np.empty(shape)
        for k, (line, tilt) in enumerate(drawn):
            lines[:, k], tilts[k] = line, known(tilt)
        one = np.argmin(tilts, axis=0)
        columns = np.arange(len(self.at))
        leader, lead = lines[:, one, columns], tilts[one, columns]
        met = cross(leader[:, None], lines)
        sines = norm(met)
        spreads = known(np.hypot(tilts, lead) / sines)
        other = np.argmin(spreads, axis=0)
        names = np.array(vias, dtype=np.int32)
        best = spreads[other, columns]
        point = met[:, other, columns] / sines[other, columns]
        return point, known(np.sqrt(1.0 + best * best)), names[one], names[other]

    def _put_back(self, c: Couple) -> None:
        whole, part = self.whole, self.part
        point = np.array(np.broadcast_to(whole.points[c], (3, *self.poses)))
        spread = np.array(np.broadcast_to(whole.spread[c], self.poses))
        point[:, self.at], spread[self.at] = part.points[c], part.spread[c]
        whole.keep(c, point, spread)
        chosen, first, second = part.lines[c]
        whole.lines[c] = (self.at[chosen], first[chosen], second[chosen])
