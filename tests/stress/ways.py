"""Drivers' values of the stress suite: ways through the drawn pose, and the poses on them in any order and spacing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from tests.stress.sketch import Sketch

# Numbers of poses, and those of full turns.
POSES = ((2, 5, 9, 13, 25, 41, 73), (13, 25, 37, 73))
SMALL = ((2, 3, 4, 5, 6, 7, 8), (9, 13, 13, 25))
# Outside its range a motion is drawn where this (radians) is the whole way.
FAR_OUTSIDE = 2.5
# Beyond this number poses are neither repeated nor held.
MANY = 200


@dataclass
class Way:
    """Values of every driver: where each pose is along the way, whose drawn pose is at s = 0.

    Legs have rates of their own from their corners on; a straight way has one.
    """

    kind: str
    s: np.ndarray
    rates: np.ndarray
    corners: tuple[float, ...] = (0.0,)
    whole: bool = False  # a full turn of one driver, whose last pose is its first

    @property
    def poses(self) -> int:
        return self.s.size

    def offsets(self) -> np.ndarray:
        """How far every driver is from its drawn value: (drivers, poses)."""
        ends = np.append(self.corners[1:], np.inf)
        starts = np.array(self.corners)
        starts[0] = -np.inf
        first = np.maximum(starts, 0.0)
        legs = np.clip(self.s[:, None], starts, ends) - first
        return (np.where(self.s[:, None] > starts, legs, 0.0) @ self.rates).T


def random_way(rng: np.random.Generator, sketch: Sketch, numbers: tuple[tuple[int, ...], tuple[int, ...]]) -> Way:
    """A straight way with evenly spaced poses."""
    count = len(sketch.drivers)
    angles = np.array([d.kind in "RO" for d in sketch.drivers])
    poses = int(rng.choice(numbers[0], p=[0.05, 0.15, 0.2, 0.2, 0.2, 0.1, 0.1]))
    span = rng.uniform(0.05, 3.0, count) * rng.choice([-1.0, 1.0], count)
    rate = span / poses
    if angles[0] and rng.random() < 0.25:
        poses = int(rng.choice(numbers[1]))
        rate = rng.choice([-1.0, 1.0], count) * 2.0 * np.pi / (poses - 1)
        rate[1:] *= rng.integers(0, 2, count - 1)
        if count == 1:
            home = float(rng.choice([0.0, float(rng.integers(1, poses - 1)), rng.uniform(0.0, poses - 1)]))
            whole = not any(j.kind in COUNTED for j in sketch.joints)
            return Way("turn", np.arange(poses) - home, rate[None], whole=whole)
    kind = str(
        rng.choice(["start", "one", "end", "middle", "between", "outside"], p=[0.45, 0.05, 0.1, 0.15, 0.15, 0.1])
    )
    if kind == "one":
        return Way(kind, np.zeros(1), rate[None])
    if kind == "outside":
        # so far only that no pose of the motion is the drawn one after a full turn
        rate = np.where(angles, np.minimum(1.0, FAR_OUTSIDE / np.max(np.abs(rate) * (poses + 3))) * rate, rate)
    home = {
        "start": 0.0,
        "end": poses - 1.0,
        "middle": float(rng.integers(0, poses)),
        "between": float(rng.uniform(0.0, poses - 1.0)),
        "outside": -float(rng.uniform(0.0, 3.0)) if rng.random() < 0.5 else poses - 1.0 + float(rng.uniform(0.0, 3.0)),
    }[kind]
    return Way(kind, np.arange(poses) - home, rate[None])


# Pairs that count full turns.
COUNTED = frozenset("GBKLO")


# --- poses in another order and spacing ------------------------------------------------------------------


def _repeated(rng: np.random.Generator, s: np.ndarray) -> np.ndarray:
    return np.repeat(s, rng.integers(1, 4, s.size))


def _shuffled(rng: np.random.Generator, s: np.ndarray) -> np.ndarray:
    return rng.permutation(np.append(s, rng.choice(s, s.size // 4)))


def _uneven(rng: np.random.Generator, s: np.ndarray) -> np.ndarray:
    """Poses crowd anywhere; the ends stay, and so does the drawn pose where it is one."""
    inner = s[0] + (s[-1] - s[0]) * rng.beta(0.4, 0.4, s.size)
    inner[: s.size // 3] = rng.choice(s, s.size // 3) + 10.0 ** rng.uniform(-12, -1, s.size // 3)
    return np.unique(np.clip(np.concatenate((inner, s[[0, -1]], s[s == 0.0])), s[0], s[-1]))


def _stepped(rng: np.random.Generator, s: np.ndarray) -> np.ndarray:
    """A staircase up and down, each step held for some poses."""
    levels = rng.choice(s, int(rng.integers(2, 8)))
    return np.repeat(levels, rng.integers(1, 6, levels.size))


def _logged(rng: np.random.Generator, s: np.ndarray) -> np.ndarray:
    """What a recorder writes: there and part of the way back, with noise, rounded."""
    there = np.concatenate((s, s[::-1][: int(rng.integers(0, s.size + 1))]))
    span = max(float(np.ptp(s)), 1.0)
    noisy = there + span * 10.0 ** rng.uniform(-7, -2) * rng.normal(size=there.size)
    digit = span * 10.0 ** float(rng.integers(-6, -1))
    return np.round(noisy / digit) * digit


SPACINGS: dict[str, Callable[[np.random.Generator, np.ndarray], np.ndarray]] = {
    "repeated": _repeated,
    "shuffled": _shuffled,
    "uneven": _uneven,
    "stepped": _stepped,
    "logged": _logged,
}
# These keep the ends of the range, so that a full turn is one still.
KEEP_ENDS = frozenset({"repeated", "shuffled", "uneven"})


def spaced(way: Way, kind: str, rng: np.random.Generator) -> Way:
    """The same way with its poses in another order and spacing; none of them alone is the drawn one after a turn."""
    s = SPACINGS[kind](rng, way.s)
    if way.s.min() <= 0.0 <= way.s.max() and not s.min() <= 0.0 <= s.max():
        s = np.append(0.0, s)
    return replace(way, s=s, whole=way.whole and kind in KEEP_ENDS)


def bent(way: Way, rng: np.random.Generator) -> Way:
    """A way of several legs from the drawn pose on: one driver after the other, or all in new directions."""
    legs, drivers = int(rng.integers(2, 5)), way.rates.shape[1]
    size = np.abs(way.rates[0])
    rates = size * rng.uniform(-1.0, 1.0, (legs, drivers))
    if rng.random() < 0.5:
        rates = np.where(np.arange(legs)[:, None] % drivers == np.arange(drivers), rates, 0.0)
    poses = max(way.poses, 2)
    corners = np.append(0.0, np.sort(rng.choice(np.arange(1, poses + legs), legs - 1, replace=False)))
    s = np.arange(float(poses + legs))
    if rng.random() < 0.3:
        s = np.repeat(s, rng.integers(1, 3, s.size))
    return Way("bent", s, rates, tuple(corners))
