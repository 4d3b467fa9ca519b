"""Centres at many poses at once, each with its magnification of errors, and recomputed where lines nearly coincide.

The magnification of a primary centre is 1. A line through two places P, Q has theirs over |P x Q|, a crossing that of
its lines over the sine between them: errors of first order, added in quadrature. Conditioning is its inverse. Where the
two lines of the derivation nearly coincide, the best other crossing is taken.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation import BY_RATES, Derivation, LineCrossing, PairCentre, SolvedCentre, Trial
from compoundkin.analysis.centres.driver_rates import (
    LINEAR,
    MOVED,
    DriverRates,
    TransportedRates,
    at_poses,
    measured,
    or_infinite,
    transport,
)
from compoundkin.analysis.centres.homogeneous import cross, dot, norm, sine_between
from compoundkin.base.arrays import Number


class Evaluation:
    """A derivation run over a block of poses.

    `points[c]` are unit vectors (3, poses), `spread[c]` their magnification of errors, `lines[c]` the two lines used
    where other ones than the derivation's were taken: (poses with other lines, first, second).
    """

    def __init__(self, derivation: Derivation, units: Sequence[Number], rates: Sequence[Number]) -> None:
        self.derivation = derivation
        self.units = units
        self.rates = rates
        self.points: dict[Couple, Number] = {}
        self.spread: dict[Couple, Number] = {}
        self.lines: dict[Couple, tuple[Number, Number, Number]] = {}
        self.drawn: dict[tuple[int, int, int], tuple[Number, Number]] = {}

    def run(self, solved: Sequence[Number] | None) -> None:
        """Apply every rule in order. `solved` are the links' twists where geometry does not suffice."""
        # coincident places have no line, and give NaN
        with np.errstate(all="ignore"):
            self._run(solved)

    def _run(self, solved: Sequence[Number] | None) -> None:
        for rule in self.derivation.rules:
            if isinstance(rule, PairCentre):
                self.keep(rule.found, self.units[rule.primary], np.ones(1))
            elif isinstance(rule, LineCrossing):
                (p, dp), (q, dq) = (self.line(*rule.found, via) for via in rule.lines)
                self.keep(rule.found, *crossing(p, dp, q, dq))
            elif isinstance(rule, Trial):
                self._try(rule)
            elif isinstance(rule, SolvedCentre) and solved is not None:
                self._from(rule.found, solved[rule.found[1]] - solved[rule.found[0]], np.ones(1))
            else:
                self.keep(rule.found, np.full((3, 1), np.nan), np.full(1, np.inf))

    def line(self, i: int, j: int, via: int) -> tuple[Number, Number]:
        """Return a line that holds the centre of i and j, and its magnification."""
        if via < 0:
            return self.units[-1 - via], np.ones(1)
        key = (*couple(i, j), via)
        if key not in self.drawn:
            one, other = couple(i, via), couple(via, j)
            self.drawn[key] = joining(self.points[one], self.spread[one], self.points[other], self.spread[other])
        return self.drawn[key]

    def keep(self, found: Couple, point: Number, spread: Number) -> None:
        """Store a centre."""
        self.points[found] = point
        self.spread[found] = spread

    def _from(self, found: Couple, twist: Number, error: Number) -> None:
        length = norm(twist)
        self.keep(found, twist / length, error / length)

    def _try(self, trial: Trial) -> None:
        carried = transport(trial.moves, self.derivation, self.points, self.spread, self.units, self.rates)
        values = self._values(trial, carried)
        for i, j in trial.found:
            twists = (carried.relative(i, j) * values).sum(axis=1)
            exact = twists[:, 0] / norm(twists[:, 0])
            moved = np.max(sine_between(exact[:, None], twists[:, 1:]), axis=0)
            self.keep((i, j), exact, np.hypot(1.0, measured(moved)))

    def _values(self, trial: Trial, carried: TransportedRates) -> Number:
        """Return the trial values that bring each locus onto its line. A unit vector (values + 1, samples, poses)."""
        if not trial.meetings:
            return np.ones((1, 1, 1))
        rows = []
        for meeting in trial.meetings:
            columns = carried.relative(meeting.i, meeting.j)
            line = carried.sampled(*self.line(*couple(meeting.i, meeting.j), meeting.k))
            rows.append(dot(line[:, None], columns) / np.sqrt((columns * columns).sum(axis=(0, 1))))
        return _null(np.array(np.broadcast_arrays(*rows)))


def joining(p: Number, dp: Number, q: Number, dq: Number) -> tuple[Number, Number]:
    """Return the line through two places, and its magnification of errors."""
    line = cross(p, q)
    length = norm(line)
    return line / length, np.hypot(dp, dq) / length


def crossing(p: Number, dp: Number, q: Number, dq: Number) -> tuple[Number, Number]:
    """Return where two lines cross, and its magnification of errors."""
    point, spread = joining(p, dp, q, dq)
    return point, np.sqrt(1.0 + spread * spread)


def _null(rows: Number) -> Number:
    """Return the unit null vector of (values, values + 1, samples, poses)."""
    if len(rows) == 1:
        return np.array([-rows[0, 1], rows[0, 0]]) / np.hypot(rows[0, 0], rows[0, 1])
    good = np.isfinite(rows).all(axis=(0, 1))
    vh = np.linalg.svd(np.moveaxis(np.where(good, rows, 0.0), (0, 1), (-2, -1)))[2]
    return np.where(good, np.moveaxis(vh[..., -1, :], -1, 0), np.nan)


# Beyond this magnification of errors (rounding becomes 1e-11) other lines are tried for the centre.
FAIR = 1e5
# Lines of all poses together that are drawn, in some four seconds, and rounds that are gone whatever they take. Centres
# that remain poor say so by their conditioning.
MOST_LINES = 25_000_000
ROUNDS = 4
# Centres below this magnification at all poses stay: they make no other centre ill-conditioned.
GOOD = 1e2
# Beyond this magnification by all lines (rounding becomes 1e-10) the rates are tried.
ILL_CONDITIONED = 1e6
# Another result is taken if it is better by this factor.
BETTER = 2.0


def recompute(evaluation: Evaluation) -> None:
    """Repeat the best crossing for ill-conditioned centres until none gets better.

    Magnification grows along every chain of crossings, so that no centre comes to rest on itself.
    """
    rules = evaluation.derivation.rules
    given = {rule.found for rule in rules if isinstance(rule, PairCentre)}
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
            _IllConditionedPoses(evaluation, at, poses).run(crossed)


class _IllConditionedPoses:
    """All lines of all centres, at the poses where a centre is ill-conditioned.

    `points` (3, bodies, bodies, poses) and `spread` (bodies, bodies, poses) hold each centre in both orders, so that
    all lines of one are drawn at once.
    """

    def __init__(self, whole: Evaluation, at: Number, poses: tuple[int, ...]) -> None:
        self.whole, self.at, self.poses = whole, at, poses
        self.units, self.rates = ([at_poses(v, at) for v in vs] for vs in (whole.units, whole.rates))
        bodies = tuple(dict.fromkeys(whole.derivation.body))
        self.names = np.array(bodies, dtype=np.int32)
        self.place = {body: k for k, body in enumerate(bodies)}
        self.points = np.full((3, len(bodies), len(bodies), len(at)), np.nan)
        self.spread = np.full(self.points.shape[1:], np.inf)
        self.lines: dict[Couple, tuple[Number, Number, Number]] = {}
        for c, point in whole.points.items():
            self._keep(c, at_poses(point, at), or_infinite(at_poses(whole.spread[c], at)))

    def run(self, crossed: list[Couple]) -> None:
        """Recompute until nothing gets better, for some seconds at most."""
        lines = len(crossed) * self.spread.shape[1] * len(self.at)
        for _ in crossed[: max(ROUNDS, MOST_LINES // lines)]:
            better = [self._take(c, *self._best(c)) for c in crossed if (self._spread(c) > GOOD).any()]
            if not any(better):
                break
        if any((self._spread(c) > ILL_CONDITIONED).any() for c in crossed):
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
            found = np.where((self._spread(c) > ILL_CONDITIONED) & (spread < LINEAR / MOVED), spread, np.inf)
            self._take(c, twist / length, or_infinite(found), none, none)

    def _take(self, c: Couple, point: Number, spread: Number, first: Number, second: Number) -> bool:
        """Store another point where it is better; return whether it is at any pose."""
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
        tilts = np.concatenate([np.ones(units.shape[1:]), or_infinite(tilts)])
        return names, np.concatenate([units, lines], axis=1), tilts

    def _best(self, c: Couple) -> tuple[Number, Number, Number, Number]:
        """Return the crossing of the best line with its best partner."""
        names, lines, tilts = self._drawn(c)
        one = np.argmin(tilts, axis=0)
        columns = np.arange(len(self.at))
        leader, lead = lines[:, one, columns], tilts[one, columns]
        met = cross(leader[:, None], lines)
        sines = norm(met)
        spreads = or_infinite(np.hypot(tilts, lead) / sines)
        other = np.argmin(spreads, axis=0)
        best = spreads[other, columns]
        point = met[:, other, columns] / sines[other, columns]
        return point, or_infinite(np.sqrt(1.0 + best * best)), names[one], names[other]

    def _put_back(self, c: Couple) -> None:
        whole = self.whole
        point = np.array(np.broadcast_to(whole.points[c], (3, *self.poses)))
        spread = np.array(np.broadcast_to(whole.spread[c], self.poses))
        point[:, self.at], spread[self.at] = self._point(c), self._spread(c)
        whole.keep(c, point, spread)
        chosen, first, second = self.lines[c]
        whole.lines[c] = (self.at[chosen], first[chosen], second[chosen])
