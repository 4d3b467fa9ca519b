"""The drivers of a drawing as words of a mechanism, with what they go through."""

from __future__ import annotations

from cmath import phase, rect
from math import ceil, log10
from typing import Any

import numpy as np

from compoundkin.base.arrays import TURN
from compoundkin.files.exchange.drawings.drawn_elements import Drawing, DrawnDriver, DrawnGuideway
from compoundkin.files.exchange.drawings.drawn_letters import DrawnLetters
from compoundkin.files.written_quantities import spaced
from compoundkin.model.elements import Drive, drive
from compoundkin.model.pairs import Pair

# How far a length is driven, as a part of the size, where the other program does not say.
TRAVEL = 0.1
# So many steps, of which each has few digits where the way has few, as the seventy-second part has not.
STEPS = 80
# So many digits of a way are written: fewer would be seen, more are rounding.
_DIGITS = 12


def drivers_of(drawing: Drawing, letters: DrawnLetters, pairs: dict[str, Pair], notes: list[str]) -> list[Drive]:
    """Return the drivers.

    One that is told no way makes a full turn, or goes a little both ways along its guide, which is noted. Several of
    them start together from the pose as drawn, each at its own speed: at once from zero most could not be assembled.
    """
    several = len(drawing.drivers) > 1
    found = []
    for one in drawing.drivers:
        guide = next((guide for guide in drawing.guides if guide.key == one.at), None)
        start = _shown(guide, one, letters)
        travel = one.travel or _reach(guide, letters)
        words: dict[str, Any] = {} if one.speed is None else {"speed": one.speed}
        if travel is not None:
            words["values"] = _way(start, *travel, guide is None)
        elif guide is not None:
            reach = TRAVEL * letters.size
            words["values"] = _way(start, 0.0 if several else -reach, reach, guide is None)
            how = "one way" if several else "both ways"
            notes.append(f"{letters.link[one.link]} is driven over a length of {reach:.4g} {how}: no way is told")
        elif several:
            words["values"] = _way(start, 0.0, TURN * _pace(one, drawing), guide is None)
        found.append(_driver(one, letters, pairs, words))
    return found


def _way(start: float, low: float, high: float, is_angle: bool) -> Any:
    """Return values in even steps such as files write: from, to and step in degrees or lengths, in few digits."""
    ends = np.array([start, start + low, start + high])
    _, first, last = (np.rad2deg(ends) if is_angle else ends).tolist()
    digits = _DIGITS - ceil(log10(abs(last - first) or 1.0))
    first, step = round(first, digits), round((last - first) / STEPS, digits + 2)
    found = spaced(first, first + STEPS * step, step) if step else None
    if found is None or found.size != STEPS + 1:
        return np.linspace(start + low, start + high, STEPS + 1)
    return np.deg2rad(found) if is_angle else found


def _driver(one: DrawnDriver, letters: DrawnLetters, pairs: dict[str, Pair], words: dict[str, Any]) -> Drive:
    link, on = letters.link[one.link], letters.link[one.on]
    shared = [letter for letter in letters.of[link] if letter in letters.of[on]]
    if len(shared) + sum({*pair.members} == {link, on} for pair in pairs.values()) > 1:
        words["pair"] = pairs[one.at].name if one.at in pairs else letters.point[one.at]
    if one.name:
        words["name"] = one.name
    made = drive(link, on=on, **words)
    assert isinstance(made, Drive)
    return made


def _pace(one: DrawnDriver, drawing: Drawing) -> float:
    """Return how fast a driver turns as a part of the fastest, by its sense; 1 where no speeds are told."""
    fastest = max(abs(other.speed or 0.0) for other in drawing.drivers)
    return 1.0 if one.speed is None or not fastest else one.speed / fastest


def _reach(guide: DrawnGuideway | None, letters: DrawnLetters) -> tuple[float, float] | None:
    """Return how far a guide lets its point go from where it is drawn, or None where it does not say."""
    if guide is None or guide.reach is None:
        return None
    here = _along(guide, guide.through, letters)
    return guide.reach[0] - here, guide.reach[1] - here


def _along(guide: DrawnGuideway, start: complex, letters: DrawnLetters) -> float:
    """Return how far along its line a guide's point is drawn."""
    return float(((letters.places[letters.point[guide.at]] - start) * rect(1.0, -guide.angle)).real)


def _shown(guide: DrawnGuideway | None, one: DrawnDriver, letters: DrawnLetters) -> float:
    """Return the value that the drawing shows of a driver."""
    if guide is None:
        return phase(rect(1.0, (letters.axis(one.link) or 0.0) - (letters.axis(one.on) or 0.0)))
    start = letters.point[guide.ends[0]] if guide.ends else letters.there(guide.on, guide.through)
    return _along(guide, letters.places[str(start)], letters)
