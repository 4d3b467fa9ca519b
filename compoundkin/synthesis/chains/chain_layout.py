"""Where to draw the pins of a chain: spread out, no two links alike, the same on every machine.

The distance between two pins is made to be the number of links between them, as far as that can be.
Source: J. de Leeuw, Applications of convex analysis to multidimensional scaling, 1977 (majorization of stress).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from compoundkin.base.series import Number

# The angle that spreads points evenly over a disc: none is on a line with the others, none on a circle.
GOLDEN = np.pi * (3.0 - 5.0**0.5)
# Enough for layouts of some dozens of pins to settle; nothing depends on how well they have.
ROUNDS = 60
# Beyond this many pins the table of all distances would take long; the spiral alone does.
MOST_PINS = 300
# By how much a settled pin is moved, in lengths of a link: a symmetric layout is a special one.
SHAKEN = 0.23
# Pins nearer than this would make links of no length.
NEAREST = 0.15


def layout(pins: int, links: Sequence[Sequence[int]]) -> list[complex]:
    """Generic places for pins 0, 1, ..., given the pins of each link; a length of one is that of a link.

    >>> places = layout(4, [(0, 1), (1, 2), (2, 3), (3, 0)])
    >>> len(places), min(abs(places[k] - places[k - 1]) for k in range(4)) > NEAREST
    (4, True)
    """
    spiral = _spiral(pins)
    if pins < 3 or pins > MOST_PINS:
        return [complex(place) for place in spiral]
    settled = _settled(spiral, _distances(pins, links))
    shaken = settled + SHAKEN * spiral / np.max(np.abs(spiral))
    apart = np.abs(shaken[:, None] - shaken[None]) + np.eye(pins)
    chosen = shaken if np.min(apart) > NEAREST else spiral
    # rounded, so that the last digit of another machine's arithmetic makes no other mechanism
    return [complex(place) for place in np.round(chosen, 4)]


def _spiral(pins: int) -> Number:
    k = np.arange(1, pins + 1)
    return np.round(np.sqrt(k) * np.exp(1j * GOLDEN * k), 4)


def _distances(pins: int, links: Sequence[Sequence[int]]) -> Number:
    """How many links there are between every two pins; those that nothing joins are as far as all pins."""
    on: list[list[int]] = [[] for _ in range(pins)]
    for link, carried in enumerate(links):
        for pin in carried:
            on[pin].append(link)
    found = np.full((pins, pins), float(pins))
    for start in range(pins):
        found[start, start] = 0.0
        queue, seen = deque([start]), {start}
        while queue:
            pin = queue.popleft()
            for other in (other for link in on[pin] for other in links[link] if other not in seen):
                seen.add(other)
                found[start, other] = found[start, pin] + 1.0
                queue.append(other)
    return found


def _settled(places: Number, wanted: Number) -> Number:
    n = len(places)
    for _ in range(ROUNDS):
        gap = places[:, None] - places[None]
        length = np.abs(gap) + np.eye(n)
        places = np.sum(wanted / length * gap, axis=1) / n
    return places
