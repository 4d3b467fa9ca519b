"""The pose in which a linkage is drawn, and the angles of its crank at which there is one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.model.elements import Drive, drawn, drive
from compoundkin.model.fields import Item
from compoundkin.model.geometry import deg
from compoundkin.model.mechanism import Mechanism
from compoundkin.synthesis.linkage_words import Closure, wrong

# Cranks are drawn at this angle where they can be.
DRAWN = np.pi / 3.0
# A pose is looked for at so many angles of a crank; a driver that does not turn fully has so many poses.
TRIED, POSES = 720, 73
# Links in one line, or lengths whose sums are equal, but for rounding: parts of a length, or of its square.
FOLDED = 1e-12
# The pins of a linkage in a pose, where they depend on it.
PinPlaces: TypeAlias = "dict[str, complex]"


def third_pin(first: complex, one: float, second: complex, two: float, closure: Closure) -> complex | None:
    """Return where circles about two places meet, to the left of the way from the first to the second where open."""
    way = second - first
    distance = abs(way)
    if distance == 0.0:  # one pin: any place of two equal circles, none that is chosen
        return None
    along = (distance**2 + one**2 - two**2) / (2.0 * distance)
    square = one**2 - along**2
    if square < -FOLDED * max(one, distance) ** 2:
        return None
    across = np.sqrt(max(square, 0.0))
    return complex(first + way / distance * (along + (1j if closure == "open" else -1j) * across))


def driven_crank(name: str, pose: Callable[[float], PinPlaces | None], crank: str = "crank") -> tuple[Drive, Item]:
    """Return the driver of a crank over all angles at which there is a pose, and one of these poses as drawn.

    It is the longest stretch of angles where there are several. Raises InvalidInput where there is no pose at all.
    """
    angles = np.linspace(0.0, TURN, TRIED, endpoint=False)
    closed = np.array([pose(float(angle)) is not None for angle in angles])
    if closed.all():
        shown = pose(DRAWN)
        assert shown is not None
        return full_turn(crank), drawn(**shown)
    if not closed.any():
        what = "it cannot be assembled at any angle of its crank"
        raise wrong(name, what, "lengthen what does not reach")
    first, count = _longest_run(closed)
    low, high = angles[first], angles[first] + TURN / TRIED * (count - 1)
    low, high = (low - TURN, high - TURN) if low + high > TURN + 1e-9 else (low, high)
    near = DRAWN if low < DRAWN < high else low + 0.5 * (high - low)
    shown = pose(near)
    assert shown is not None
    return drive(crank, values=np.linspace(low, high, POSES) if count > 1 else low), drawn(**shown)


def _longest_run(closed: np.ndarray) -> tuple[int, int]:
    """Return where the longest run of true values on a circle begins, and how long it is."""
    begins = np.flatnonzero(closed & ~np.roll(closed, 1))
    ends = np.flatnonzero(closed & ~np.roll(closed, -1))
    lengths = [int((ends[np.searchsorted(ends, k) % len(ends)] - k) % len(closed)) + 1 for k in begins]
    longest = int(np.argmax(lengths))
    return int(begins[longest]), lengths[longest]


def place_on(first: complex, second: complex, place: complex) -> complex:
    """Return where a place of a link is, seen from its first point with the x axis toward the second."""
    return first + place * (second - first) / abs(second - first)


def full_turn(crank: str) -> Drive:
    """Return the driver of a crank that turns fully."""
    return drive(crank, values=deg(np.arange(0, 361, 5)))


def drawn_linkage(title: str, unit: str, outputs: Sequence[str], description: str, *items: Item) -> Mechanism:
    """Return a linkage of its parts."""
    return Mechanism(title, *items, unit=unit, outputs=tuple(outputs), description=description)
