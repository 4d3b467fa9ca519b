"""Centres at many poses at once, each with its magnification of errors.

The magnification of a primary centre is 1. A line through two places P, Q has theirs over |P x Q|, a crossing that
of its lines over the sine between them: errors of first order, added in quadrature. Conditioning is its inverse.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from compoundkin.analysis.centres.circle_diagram import Couple, couple
from compoundkin.analysis.centres.derivation import Derivation
from compoundkin.analysis.centres.derivation_steps import Given, LineCrossing, SolvedCentre, Trial
from compoundkin.analysis.centres.homogeneous import cross, dot, norm, sine_between
from compoundkin.analysis.centres.rate_transport import TransportedRates, measured, transport
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
        """Apply every rule in order. `solved` are the links' twists where geometry does not do."""
        # places that coincide make no line: what is not a number there is given as such
        with np.errstate(all="ignore"):
            self._run(solved)

    def _run(self, solved: Sequence[Number] | None) -> None:
        for rule in self.derivation.rules:
            if isinstance(rule, Given):
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
        """Take a centre as found."""
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
