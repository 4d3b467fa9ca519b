"""Drawn mechanisms made of chains: one link is the frame, some pairs have drivers.

The pins are spread out, no two links alike, the same on every machine: distances of pins approximate the number of
links between them. Source: J. de Leeuw, Applications of convex analysis to multidimensional scaling, 1977 (majorization
of stress).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from itertools import combinations
from string import ascii_uppercase
from typing import TypeAlias

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number, wrapped
from compoundkin.base.errors import InvalidInput, Problem, UnknownName
from compoundkin.model.elements import Drive, drawn, drive, link
from compoundkin.model.fields import Item
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.structure.decomposition import decomposed
from compoundkin.synthesis.chains.chain import Chain
from compoundkin.synthesis.chains.chain_names import chain_name

# A driver: a link that is driven on the frame, or two links, the second one driven on the first.
Driver: TypeAlias = int | tuple[int, int]
# The angle that spreads points evenly over a disc: none is on a line with the others, none on a circle.
GOLDEN = np.pi * (3.0 - 5.0**0.5)
# Enough iterations for layouts of some dozens of pins; nothing depends on their accuracy.
ROUNDS = 60
# Beyond this many pins the table of all distances would take long; the spiral alone does.
MOST_PINS = 300
# Displacement of pins after the iteration, in lengths of a link: a symmetric layout would be special.
DISPLACEMENT = 0.23
# Pins nearer than this would make very short links.
NEAREST = 0.15


@checked
def mechanism_from(chain: Chain, frame: int = 0, *drivers: Driver, title: str = "") -> Mechanism:
    """Return a mechanism with the structure of a chain, generic dimensions and pins A, B, C, ...

    Link k of the chain is "link k", except the frame. A driver is a link joined to the frame, or two joined links; by
    default the first that determine the motion, on the frame if possible. The drawn pose always assembles; the range of
    the drivers depends on the dimensions.

    Raises UnknownName for an unknown link, InvalidInput for drivers between links that are not joined, or if no drivers
    determine the motion.

    >>> from compoundkin.synthesis.chains.chain_atlas import chains
    >>> mechanism = mechanism_from(chains(6)[0], 0, 4)
    >>> mechanism.title, [drive.link for drive in mechanism.drives]
    ('Stephenson I', ['link 4'])
    """
    _known(chain, frame, drivers)
    letters = lettered(len(chain.pairs))
    pins = dict(zip(chain.pairs, letters, strict=True))
    carried = [[k for k, pair in enumerate(chain.pairs) if number in pair] for number in range(chain.links)]
    places = dict(zip(letters, layout(len(letters), carried), strict=True))
    names = [FRAME if number == frame else f"link {number}" for number in range(chain.links)]
    order = [frame, *(number for number in range(chain.links) if number != frame)]
    items: list[Item] = [link(names[n], *(letters[k] for k in carried[n])) for n in order]
    items.append(drawn(**places))
    title = title or chain_name(chain, frame) or f"{chain.links}-link mechanism"
    if drivers:
        driven = [_drive(items, names, *_between(frame, driver)) for driver in drivers]
        return Mechanism(title, *items, *driven)
    for chosen in combinations(sorted(pins, key=lambda pair: frame not in pair), max(chain.mobility, 0)):
        driven = [_drive(items, names, *(pair if pair[0] == frame else pair[::-1])) for pair in chosen]
        mechanism = Mechanism(title, *items, *driven)
        if not decomposed(mechanism).faults:
            return mechanism
    what = f"no drivers determine a chain of mobility {chain.mobility} with a part that is rigid or joined to nothing"
    raise InvalidInput(Problem("chain", what, "take a chain whose every part has a mobility of one at least"))


def lettered(number: int) -> list[str]:
    """Return so many names for points: A to Z, then A2 to Z2 and so on.

    >>> lettered(28)[-3:]
    ['Z', 'A2', 'B2']
    """
    rounds = [f"{turn}" if turn > 1 else "" for turn in range(1, number // len(ascii_uppercase) + 2)]
    return [f"{letter}{turn}" for turn in rounds for letter in ascii_uppercase][:number]


def _between(frame: int, driver: Driver) -> tuple[int, int]:
    return (frame, driver) if isinstance(driver, int) else driver


def _known(chain: Chain, frame: int, drivers: Sequence[Driver]) -> None:
    for number in (frame, *(k for driver in drivers for k in _between(frame, driver))):
        if not 0 <= number < chain.links:
            raise UnknownName(Problem(f"link {number}", "the chain has no such link", f"known: 0 to {chain.links - 1}"))
    for driver in drivers:
        pair = _between(frame, driver)
        if tuple(sorted(pair)) not in chain.pairs:
            near = ", ".join(map(str, chain.neighbours[pair[0]]))
            what = f"links {pair[0]} and {pair[1]} are not joined, so that no driver can be between them"
            raise InvalidInput(Problem("drivers", what, f"link {pair[0]} is joined to {near}"))


def _drive(items: Sequence[Item], names: Sequence[str], on: int, driven: int) -> Drive:
    """Return a driver at the drawn angle."""
    drawing = Mechanism("as drawn", *items).geometry.drawn
    angle = [float(drawing[names[k]].angle.c[0]) for k in (on, driven)]
    middle = float(wrapped(angle[1] - angle[0]))
    return drive(names[driven], on=names[on], values=middle)


@checked
def symmetric_drivers(chain: Chain, frame: int) -> Iterator[tuple[int, int]]:
    """Yield the places for one driver up to symmetry, each as the link it is on and the driven link.

    >>> len(list(symmetric_drivers(Chain.of(4, [(0, 1), (1, 2), (2, 3), (3, 0)]), 0)))
    2
    """
    for (first, second), *_ in chain.equivalent_pairs(frame):
        yield (second, first) if second == frame else (first, second)


def layout(pins: int, links: Sequence[Sequence[int]]) -> list[complex]:
    """Return generic places for pins 0, 1, ... from the pins of each link; links are about 1 long.

    >>> places = layout(4, [(0, 1), (1, 2), (2, 3), (3, 0)])
    >>> len(places), min(abs(places[k] - places[k - 1]) for k in range(4)) > NEAREST
    (4, True)
    """
    spiral = _spiral(pins)
    if pins < 3 or pins > MOST_PINS:
        return [complex(place) for place in spiral]
    spread = _majorised(spiral, _distances(pins, links))
    moved = spread + DISPLACEMENT * spiral / np.max(np.abs(spiral))
    apart = np.abs(moved[:, None] - moved[None]) + np.eye(pins)
    chosen = moved if np.min(apart) > NEAREST else spiral
    # rounded, so that all machines give the same mechanism
    return [complex(place) for place in np.round(chosen, 4)]


def _spiral(pins: int) -> Number:
    k = np.arange(1, pins + 1)
    return np.round(np.sqrt(k) * np.exp(1j * GOLDEN * k), 4)


def _distances(pins: int, links: Sequence[Sequence[int]]) -> Number:
    """Return the number of links between every two pins, the number of pins for unconnected ones."""
    on: list[list[int]] = [[] for _ in range(pins)]
    for number, carried in enumerate(links):
        for pin in carried:
            on[pin].append(number)
    found = np.full((pins, pins), float(pins))
    for start in range(pins):
        found[start, start] = 0.0
        queue, seen = deque([start]), {start}
        while queue:
            pin = queue.popleft()
            for other in (other for number in on[pin] for other in links[number] if other not in seen):
                seen.add(other)
                found[start, other] = found[start, pin] + 1.0
                queue.append(other)
    return found


def _majorised(places: Number, target: Number) -> Number:
    n = len(places)
    for _ in range(ROUNDS):
        gap = places[:, None] - places[None]
        length = np.abs(gap) + np.eye(n)
        places = np.sum(target / length * gap, axis=1) / n
    return places
