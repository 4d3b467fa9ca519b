"""The driver values at which the driven links of one mechanism stand as those of another do, by points they share."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from compoundkin.analysis.comparison.compared_side import ComparedSide
from compoundkin.model.geometry import FRAME

# Points nearer to each other than this part of the size tell no direction.
_DISTINCT = 1e-9


def values_of_like_stance(one: ComparedSide, other: ComparedSide, points: Mapping[str, str]) -> dict[str, float]:
    """Return the second's driver values at which it stands as the first is shown.

    Drivers are those of the same name, else of the same rank. Where no points tell how a link stands, and along
    slides, the values are equal.
    """
    names = list(one.motion.drives)
    values = dict(other.shown)
    for rank, name in enumerate(other.motion.drives):
        like = name if name in names else names[min(rank, len(names) - 1)]
        is_angle = other.structure.driven_angles[name]
        if is_angle != one.structure.driven_angles[like]:
            continue
        turn = _turn(one, like, other, name, points) if is_angle else None
        here = one.shown[like] if is_angle else one.shown[like] / other.scale
        values[name] = here if turn is None else other.shown[name] + turn
    return values


def _turn(one: ComparedSide, driver: str, other: ComparedSide, name: str, points: Mapping[str, str]) -> float | None:
    """Return by how much the second's driven link has to turn to stand as the first's. None where no points tell."""
    total = 1 + 0j
    drive, like = other.structure.driven[name].drive, one.structure.driven[driver].drive
    for link, own, part in ((like.link, drive.link, 1), (like.on, drive.on, -1)):
        if (link, own) == (FRAME, FRAME):
            continue
        off = _between(one, link, other, own, points)
        if off is None:
            return None
        total *= off if part > 0 else np.conj(off)
    return float(np.angle(total))


def _between(one: ComparedSide, link: str, other: ComparedSide, own: str, points: Mapping[str, str]) -> complex | None:
    """Return the turn from a link of the second to one of the first, of size one. None where no two points tell it."""
    on, of = one.mechanism.carriers, other.mechanism.carriers
    shared = [(k, p) for k, p in points.items() if k in on and link in on[k] and own in of[p]]
    if len(shared) < 2:
        return None
    at_one = dict(zip(one.letters, one.places(one.there)[0], strict=True))
    at_other = dict(zip(other.letters, other.places(other.there)[0], strict=True))
    (first, partner), *rest = shared
    for letter, like in rest:
        ways = at_one[letter] - at_one[first], at_other[like] - at_other[partner]
        if min(map(abs, ways)) > _DISTINCT * one.size:
            off = complex(ways[0] / ways[1])
            return off / abs(off)
    return None
