"""The suite's own continuation: from the drawn pose along the drivers' way, by length of arc, to its branch's limit.

A way is s -> drivers' values: straight, `values + rate * s`, or of several straight legs, each with its rate from its
corner on. The drawn pose is at s = 0; with several legs s only grows. Unknowns and s together move along a curve that
is regular at limit positions as well: there s turns back. A step is taken where the corrections are small
and contract, where the tangent has hardly turned, and where the sign of the determinant stayed, so that no other branch
that passes near is taken for this one. Proposed poses are held to the same, which costs less than finding them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from tests.stress.equations import Equations

# A correction may be this part of the step that was predicted, and each further one this part of the one before.
CLOSE, CONTRACTS = 0.1, 0.3
# Corrections smaller than this (radians, sizes) end Newton's iteration; so often is it tried.
CORRECTED, NEWTON = 1e-11, 7
# The longest step in any unknown (radians, sizes), and the longest that a proposed pose may be away.
LONGEST, PROPOSED = 0.25, 0.5
# s itself may move by LONGEST over this in a step.
SLOWEST = 0.1
# The branch is lost where no step of this length can be taken.
SHORTEST = 1e-8
# No branch is followed farther than so many steps from one pose to the next: the branch is too long to be followed.
MOST = 400

Array = Any


@dataclass
class Place:
    """A pose on the branch: s, the unknowns, their rates by s, and the sign of the Jacobian's determinant."""

    s: float
    x: Array
    rate: Array
    sign: float


@dataclass
class Reached:
    """What a continuation reached: places by their stops, and why it went no farther."""

    places: dict[float, Place] = field(default_factory=dict)
    end: float = np.inf
    why: str = ""
    last: Place | None = None


class Branch:
    """The branch through the drawn pose."""

    def __init__(self, equations: Equations, rates: Array, corners: Sequence[float] = (0.0,)) -> None:
        self.equations, self.corners = equations, np.asarray(corners, dtype=float)
        self.rates = equations.scaled(np.atleast_2d(np.asarray(rates, dtype=float)))
        ways = np.diff(self.corners)[:, None] * self.rates[:-1]
        self.values = equations.values + np.vstack((np.zeros(self.rates.shape[1]), np.cumsum(ways, axis=0)))
        self.loads = np.hstack((np.zeros((len(self.corners), equations.count)), self.rates))
        self.steps = 0
        self.start = self.place(0.0, equations.drawn)

    def leg(self, s: Array) -> Array:
        """The leg that goes on from s."""
        return np.maximum(np.searchsorted(self.corners, s, side="right") - 1, 0)

    def residual(self, x: Array, s: Array, leg: Array | None = None) -> Array:
        found, s = self.equations.residual(x), np.asarray(s)
        leg = self.leg(s) if leg is None else leg
        found[..., self.equations.count :] -= self.values[leg] + self.rates[leg] * (s - self.corners[leg])[..., None]
        return found

    def place(self, s: float, x: Array) -> Place:
        jacobian = self.equations.jacobian(x)
        try:
            rate = np.linalg.solve(jacobian, self.loads[self.leg(s)])
        except np.linalg.LinAlgError:
            return Place(s, x, np.full(x.shape, np.inf), 0.0)
        return Place(s, x, rate, float(np.linalg.slogdet(jacobian)[0]))

    # --- proposed poses, all at once ---

    def proposed(self, x: Array, s: Array) -> tuple[Array, Array, Array, Array]:
        """Correct proposed poses: unknowns, how far they were moved, rates by s, signs; NaN where it fails."""
        first = x
        for _ in range(2):
            jacobian = self.equations.jacobian(x)
            x = x - solved(jacobian, self.residual(x, s))
        jacobian = self.equations.jacobian(x)
        off = np.max(np.abs(solved(jacobian, self.residual(x, s))), axis=-1)
        moved = np.where(off < 1e-8, np.max(np.abs(x - first), axis=-1), np.nan)
        rates = solved(jacobian, self.loads[self.leg(s)])
        return x, moved, rates, np.linalg.slogdet(jacobian)[0]

    def joins(self, one: Place, other: Place) -> bool:
        """Whether the step from one place to another is one that could have been taken."""
        way = other.s - one.s
        ahead = one.rate * way
        moved = float(np.max(np.abs(ahead)))
        if not (one.sign == other.sign != 0.0 and moved < PROPOSED):
            return False
        missed = np.max(np.abs(one.x + ahead - other.x))
        turned = np.max(np.abs(other.rate - one.rate)) * abs(way)
        return bool(missed <= CLOSE * moved + CORRECTED and turned <= 2.0 * CLOSE * moved + CORRECTED)

    # --- by length of arc ---

    def follow(self, start: Place, stops: Sequence[float], known: dict[float, Place] | None = None) -> Reached:
        """Follow the branch from a place over stops in their order, by known places where these join."""
        found, here = Reached(last=start), start
        ahead = {float(c) for c in self.corners[1:] if start.s < c < max(stops, default=start.s)}
        for stop in sorted({*stops, *ahead}) if ahead else stops:
            if stop == here.s:
                there: Place | None = here
            else:
                there = (known or {}).get(stop)
                if there is None or not self.joins(here, there):
                    there = self._walk(here, stop, found)
            if there is None:
                return found
            found.places[stop] = found.last = here = there
        return found

    def _walk(self, here: Place, stop: float, found: Reached) -> Place | None:
        """Go along the curve from a place until s is at the stop; None where the curve turns back before."""
        walk = _Walk(self, here, 1.0 if stop > here.s else -1.0)
        for _ in range(MOST):
            step = walk.step()
            self.steps += 1
            if step is None:
                found.end, found.why = walk.s, "lost"
                return None
            before, after = step
            # a step may pass a limit and the next one after it, where the curve goes on as before
            turns = walk.turns_back(after) or _wavers(before, after, walk.sense)
            if walk.sense * (after[0][-1] - stop) >= 0.0 or turns:
                landed = self._landed(before, after, stop, here.sign, walk.sense)
                if landed is not None:
                    return landed
                found.end = _extreme(before, after, walk.sense)
                found.why = "limit" if turns else "not landed"
                if walk.sense * (found.end - stop) > 0.0:
                    found.why = "near limit"
                return None
        found.end, found.why = walk.s, "long"
        return None

    def _landed(self, before: Array, after: Array, stop: float, sign: float, sense: float) -> Place | None:
        """The pose at the stop, between two points of the curve."""
        shares = np.linspace(0.0, 1.0, 65)
        s = _hermite(before, after, shares)[:, -1]
        past = np.flatnonzero(sense * (s - stop) >= 0.0)
        if not past.size:
            return None
        low, high = max(int(past[0]) - 1, 0), int(past[0])
        gap = s[high] - s[low]
        share = shares[low] + (shares[high] - shares[low]) * ((stop - s[low]) / gap if gap else 0.0)
        x = _hermite(before, after, np.array([share]))[0, :-1]
        allowed = CLOSE * float(np.max(np.abs(after[0] - before[0]))) + CORRECTED
        for _ in range(NEWTON):
            step = solved(self.equations.jacobian(x), self.residual(x, stop))
            length = float(np.max(np.abs(step)))
            if not length <= allowed:
                return None
            x = x - step
            if length < CORRECTED:
                place = self.place(stop, x)
                return place if place.sign == sign else None
            allowed = max(CONTRACTS * length, CORRECTED)
        return None


class _Walk:
    """Steps along the curve of (unknowns, s)."""

    def __init__(self, branch: Branch, here: Place, sense: float) -> None:
        self.branch, self.sense, self.leg = branch, sense, branch.leg(here.s)
        self.y = np.append(here.x, here.s)
        tangent = np.append(here.rate, 1.0) * sense
        self.tangent = tangent / np.linalg.norm(tangent)
        self.side = self._side(self.y[:-1], self.tangent)
        self.length = np.inf

    @property
    def s(self) -> float:
        return float(self.y[-1])

    def turns_back(self, point: tuple[Array, Array]) -> bool:
        return bool(self.sense * point[1][-1] <= 0.0)

    def _matrix(self, x: Array, last: Array) -> Array:
        n = x.size
        matrix = np.empty((n + 1, n + 1))
        matrix[:n, :n], matrix[:n, n], matrix[n] = self.branch.equations.jacobian(x), -self.branch.loads[self.leg], last
        return matrix

    def _side(self, x: Array, tangent: Array) -> float:
        return float(np.linalg.slogdet(self._matrix(x, tangent))[0])

    def step(self) -> tuple[tuple[Array, Array], tuple[Array, Array]] | None:
        """Take a step; return the points and tangents before and after it, None where none can be taken."""
        while self.length > SHORTEST:
            fast = max(float(np.max(np.abs(self.tangent[:-1]))), SLOWEST * abs(float(self.tangent[-1])))
            length = min(self.length, LONGEST / fast)
            found = self._tried(length)
            if found is not None:
                before = (self.y, self.tangent)
                self.y, self.tangent = found
                self.length = 1.6 * length
                return before, found
            self.length = length / 3.0
        return None

    def _tried(self, length: float) -> tuple[Array, Array] | None:
        y, allowed = self.y + length * self.tangent, CLOSE * length
        matrix = self._matrix(y[:-1], self.tangent)
        try:
            inverse = np.linalg.inv(matrix)
        except np.linalg.LinAlgError:
            return None
        for number in range(NEWTON):
            residual = np.append(self.branch.residual(y[:-1], y[-1], self.leg), 0.0)
            step = inverse @ residual
            size = float(np.max(np.abs(step)))
            if not size <= allowed:
                return None
            y = y - step
            if size < CORRECTED or number == NEWTON - 1:
                break
            allowed = max(CONTRACTS * size, CORRECTED)
        return self._accepted(y)

    def _accepted(self, y: Array) -> tuple[Array, Array] | None:
        matrix = self._matrix(y[:-1], self.tangent)
        try:
            tangent = np.linalg.solve(matrix, np.append(np.zeros(y.size - 1), 1.0))
        except np.linalg.LinAlgError:
            return None
        tangent = tangent / np.linalg.norm(tangent)
        if float(tangent @ self.tangent) < 1.0 - CLOSE or float(np.linalg.slogdet(matrix)[0]) != self.side:
            return None
        return y, tangent


def solved(matrix: Array, right: Array) -> Array:
    """Solve square systems, NaN where one is singular."""
    try:
        return np.linalg.solve(matrix, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        if matrix.ndim == 2:
            return np.full(right.shape, np.nan)
        return np.array([solved(m, r) for m, r in zip(matrix, right, strict=True)])


def _hermite(before: tuple[Array, Array], after: tuple[Array, Array], share: Array) -> Array:
    """Points between two of the curve, by the cubic with their tangents."""
    t, length = share[:, None], float(np.linalg.norm(after[0] - before[0]))
    h = t * t * (3.0 - 2.0 * t)
    bend = length * (t * (1.0 - t) ** 2 * before[1] - t * t * (1.0 - t) * after[1])
    return before[0] * (1.0 - h) + after[0] * h + bend


def _wavers(before: tuple[Array, Array], after: tuple[Array, Array], sense: float) -> bool:
    """Whether s turns back between two points of the curve."""
    s = sense * _hermite(before, after, np.linspace(0.0, 1.0, 65))[:, -1]
    return bool(np.any(np.diff(s) < 0.0))


def _extreme(before: tuple[Array, Array], after: tuple[Array, Array], sense: float) -> float:
    """The farthest s between two points of the curve."""
    s = _hermite(before, after, np.linspace(0.0, 1.0, 65))[:, -1]
    return float(sense * np.max(sense * s))
