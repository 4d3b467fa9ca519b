"""Motions for the tests of relative motion: the catalog's, and random mechanisms far from limit positions."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np

import compoundkin as ck
from compoundkin.files import load
from tests.support import drawn_values, random_sketch

KINDS = [("RRR",), ("RRP",), ("RPR",), ("RRR", "RPR"), ("RRP", "RRR"), ("PRP", "RRR")]
# How much faster than the driver a link or point of a random mechanism may be, and how far apart its points.
FASTEST = 40.0


def catalog(name: str, **words: Any) -> ck.results.Motion:
    """A shipped mechanism over its own motion, all drivers at unit speed; solved once where nothing else is asked."""
    return _solved(name, **words) if words else _own_motion(name)


@cache
def _own_motion(name: str) -> ck.results.Motion:
    return _solved(name)


def _solved(name: str, **words: Any) -> ck.results.Motion:
    mechanism = load(name)
    return ck.solve(mechanism, speed={drive.name: 1.0 for drive in mechanism.drives if drive.law is None}, **words)


def random_mechanism(seed: int, change: Callable[[complex], complex] = complex) -> ck.Mechanism:
    """A random mechanism far from its limit positions; the same for the same seed, its points moved by `change`."""
    for attempt in range(100):
        sketch = random_sketch(np.random.default_rng([seed, attempt]), KINDS[seed % len(KINDS)])
        mechanism = sketch.mechanism()
        motion = ck.solve(mechanism, drawn_values(mechanism))
        fast = [abs(m.derivative(k)) ** (1 / k) for m in motion.points.values() for k in (1, 2)]
        if motion.assembled and max(fast) < FASTEST:
            return sketch.mechanism(change)
    raise AssertionError("no well-conditioned mechanism was drawn")


def turning_pairs(motion: ck.results.Motion, least: float = 1e-3) -> list[tuple[str, str]]:
    """All ordered pairs of links that turn relative to each other at every pose, at `least` so fast."""
    links = motion.links
    found = []
    for link in links:
        for on in links:
            rate = np.abs(links[link].angular_velocity - links[on].angular_velocity)
            if np.all(rate > least):
                found.append((link, on))
    return found


def fastest(motion: ck.results.Motion) -> Any:
    """The rate of the fastest link at each pose, rad/s."""
    rates = [np.abs(link.angular_velocity) for link in motion.links.values()]
    rates += [link.origin.speed / motion.size for link in motion.links.values()]
    return np.max(np.broadcast_arrays(*rates), axis=0)
