"""The package's answer in the unknowns of the suite's own equations, read from a motion through its public face."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from tests.stress.continuation import Branch, Place
from tests.stress.equations import Equations
from tests.stress.sketch import FRAME, Oval, Placed

# The contact is first looked for at so many places of an oval.
SAMPLES = 128


class Answer:
    """`raw` are the unknowns as the package has them, `first` and `second` their derivatives in time; NaN for gaps.

    `known` are poses of it, corrected by the suite's own equations, for its continuation to join.
    """

    def __init__(self, motion: Any, equations: Equations, placed: Placed, branch: Branch, s: np.ndarray) -> None:
        self.equations, self.placed, self.branch, self.s = equations, placed, branch, s
        self.assembled = np.broadcast_to(np.asarray(motion.assembled), s.shape)
        self.raw = np.full((s.size, equations.unknowns), np.nan)
        rows = 3 * len(equations.links)
        self.first, self.second = (np.full((s.size, rows), np.nan) for _ in range(2))
        for link, k in equations.index.items():
            found, at = motion.links[link], slice(3 * k, 3 * k + 3)
            self.raw[:, at] = self._xyt(found.origin.position, found.angle)
            self.first[:, at] = self._xyt(found.origin.velocity, found.angular_velocity)
            self.second[:, at] = self._xyt(found.origin.acceleration, found.angular_acceleration)
        geared = {k for j in placed.sketch.joints if j.kind in "GBKLO" for k in j.links}
        self.counted = [k for k in equations.index if k in geared]
        self.turned = self._turned()
        self._contacts()
        self.known = self._known()

    def _xyt(self, place: Any, angle: Any) -> np.ndarray:
        place = np.asarray(place) / self.equations.unit
        shape = self.s.shape
        return np.stack([np.broadcast_to(v, shape) for v in (place.real, place.imag, np.asarray(angle))], axis=-1)

    def _turned(self) -> np.ndarray:
        """The unknowns with angles counted from the drawn pose: counted links as they are, others by nearest turns."""
        x = self.raw.copy()
        at = np.flatnonzero(self.assembled)
        if not at.size:
            return x
        order = at[np.argsort(np.abs(self.s[at]), kind="stable")]
        start = self.branch.start
        first = order[0]
        for link, k in self.equations.index.items():
            c = 3 * k + 2
            there = start.x[c] + start.rate[c] * self.s[first]
            if not np.isfinite(there):
                continue
            if link in self.counted:
                x[:, c] -= _turns(x[first, c] - there)
                continue
            for group in (order[self.s[order] >= 0.0], order[self.s[order] < 0.0]):
                last = start.x[c] if abs(self.s[first]) > 1.0 else there
                angles = x[group, c]
                x[group, c] = np.unwrap(np.concatenate(([last], angles)))[1:]
        return x

    def _contacts(self) -> None:
        with np.errstate(invalid="ignore"):
            self._find_contacts()

    def _find_contacts(self) -> None:
        """Parameters of contacts: where the profile is nearest, which the corrections then make exact."""
        n = 3 * len(self.equations.links)
        for number, joint in enumerate(self.equations.contacts):
            numbers = self.placed.joints[joint.name]
            oval: Oval = numbers["oval"]
            (z0, u0), (z1, u1) = (self._pose(link) for link in joint.links)
            if joint.kind == "F":
                normal = u1 * np.exp(1j * numbers["angle"]) * (-1j * numbers["side"]) / u0 * np.exp(-1j * oval.tilt)
                s = np.arctan2(normal.imag * oval.b, normal.real * oval.a)
            else:
                point = (z1 + u1 * numbers["point"] - z0) / u0
                samples = np.linspace(-np.pi, np.pi, SAMPLES, endpoint=False)
                middle = oval.at(samples) + numbers["away"] * oval.normal(samples)
                s = samples[np.argmin(np.abs(point[:, None] - middle), axis=1)]
                s = _foot(oval, point, s)
            home = numbers["s"]
            s = s - _turns(s - home)
            order = np.flatnonzero(self.assembled)
            order = order[np.argsort(np.abs(self.s[order]), kind="stable")]
            back, on = order[self.s[order] < 0], order[self.s[order] >= 0]
            for group in (on, back):
                s[group] = np.unwrap(np.concatenate(([home], s[group])))[1:]
            self.raw[:, n + number] = self.turned[:, n + number] = s

    def _pose(self, link: str) -> tuple[np.ndarray, np.ndarray]:
        if link == FRAME:
            return np.zeros(self.s.shape, dtype=complex), np.ones(self.s.shape, dtype=complex)
        k = 3 * self.equations.index[link]
        z = (self.raw[:, k] + 1j * self.raw[:, k + 1]) * self.equations.unit
        return z, np.exp(1j * self.raw[:, k + 2])

    def _known(self) -> dict[float, Place]:
        at = np.flatnonzero(self.assembled & np.isfinite(self.turned).all(axis=1))
        if not at.size:
            return {}
        x, moved, rates, signs = self.branch.proposed(self.turned[at], self.s[at])
        good = np.flatnonzero(moved < 1e-3)
        return {float(self.s[at[i]]): Place(float(self.s[at[i]]), x[i], rates[i], float(signs[i])) for i in good}

    def residuals(self, reached: Mapping[int, Place]) -> np.ndarray:
        """The greatest residual of each pose, as the package left it; of pairs that count turns where it is `reached`.

        Beyond a gap nobody can say by how many turns a link was turned; drivers are where they are modulo a turn.
        """
        found = np.full(self.s.shape, np.nan)
        at = np.flatnonzero(self.assembled)
        off = self.branch.residual(self._as_reached(reached)[at], self.s[at])
        beyond = np.isin(at, list(reached), invert=True)
        off[np.ix_(beyond, self.equations.turning)] = 0.0
        drivers = self.equations.count + np.flatnonzero(~self.equations.lengths)
        off[:, drivers] -= _turns(off[:, drivers])
        found[at] = np.max(np.abs(off), axis=-1)
        return found

    def _as_reached(self, reached: Mapping[int, Place]) -> np.ndarray:
        """The unknowns with the turns of counted links as at the nearest reached pose.

        Next to a limit links run so fast that the drawn pose does not tell their turns at the next one.
        """
        x = self.turned.copy()
        known = [k for k in reached if self.assembled[k]]
        if known:
            near = min(known, key=lambda k: abs(float(self.s[k])))
            columns = [3 * self.equations.index[link] + 2 for link in self.counted]
            x[:, columns] -= _turns(x[near, columns] - reached[near].x[columns])
        return x


def _turns(angle: Any) -> Any:
    return 2.0 * np.pi * np.round(angle / (2.0 * np.pi))


def _foot(oval: Oval, point: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Newton on the way of a point from the oval along its tangent, which is none of its parallel curve either."""
    for _ in range(8):
        gap, first, second = point - oval.at(s), oval.slope(s), oval.bend(s)
        s = s + (np.conj(first) * gap).real / (np.abs(first) ** 2 - (np.conj(second) * gap).real)
    return s
