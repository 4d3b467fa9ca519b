"""Which point of one mechanism stands for which of another: those in the same places that move alike."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

import numpy as np

from compoundkin.analysis.comparison.compared_side import ComparedSide
from compoundkin.analysis.comparison.link_partners import link_partners
from compoundkin.base.arrays import Number

# Points nearer to each other than this part of the size are in the same place: files of other programs are rounded to
# three decimals, and drawings may be in numbers of one digit.
SAME_PLACE = 1e-3
# Below this part of the size distances tell points apart no more, names do.
_ALIKE = 1e-9


def shares_places(one: ComparedSide, at_one: Number, other: ComparedSide, at_other: Number) -> bool:
    """Tell whether all marks of one mechanism are where points of the other are."""
    near = _near(one, at_one, other, at_other, SAME_PLACE * one.size)
    of_one = [near[k].any() for k, name in enumerate(one.letters) if name in one.marks]
    of_other = [near[:, k].any() for k, name in enumerate(other.letters) if name in other.marks]
    return bool((of_one and all(of_one)) or (of_other and all(of_other)))


def partners_by_place(one: ComparedSide, at_one: Number, other: ComparedSide, at_other: Number) -> dict[str, str]:
    """Return which points stand for which, by their places over some poses, (poses, points).

    They are near at the first pose. Of several that are, those that move alike, then those of the same name.
    """
    near = _near(one, at_one[0], other, at_other[0], SAME_PLACE * one.size)
    pairs = ((int(i), int(j)) for i, j in np.argwhere(near))
    return _chosen(one, other, ((_apart(at_one[:, i], at_other[:, j]), i, j) for i, j in pairs))


def partners_by_name(one: ComparedSide, other: ComparedSide) -> dict[str, str]:
    """Return the points that have the same name. Both are of the frame, or both are not."""
    return {k: k for k in one.letters if k in other.letters and (k in one.fixed) == (k in other.fixed)}


def tracers_by_name(one: ComparedSide, other: ComparedSide, points: Mapping[str, str]) -> dict[str, str]:
    """Return the tracers left that have one name, on links that are partners."""
    links = link_partners(one.mechanism, other.mechanism, points)
    mine, theirs = one.mechanism.carriers, other.mechanism.carriers
    left = set(other.tracers).difference(points.values())
    return {k: k for k in one.tracers if k in left and k not in points and links.get(mine[k][0]) == theirs[k][0]}


def _near(one: ComparedSide, at_one: Number, other: ComparedSide, at_other: Number, most: float) -> Number:
    """Return which points are near which, those of the frame only to each other."""
    fixed = [np.array([k in side.fixed for k in side.letters], dtype=bool) for side in (one, other)]
    near: Number = np.abs(at_one[:, None] - at_other) <= most
    return near & (fixed[0][:, None] == fixed[1])


def _apart(one: Number, other: Number) -> float:
    """Return how far two points come apart, of the poses that both have."""
    off = np.abs(one - other)
    known = np.isfinite(off)
    return float(off[known].max()) if known.any() else 0.0


def _chosen(one: ComparedSide, other: ComparedSide, found: Iterable[tuple[float, int, int]]) -> dict[str, str]:
    """Return a partner for each point at most, the likeliest first."""
    ranked = sorted(_ranked(one, other, found))
    points: dict[str, str] = {}
    taken: set[str] = set()
    for *_, letter, partner in ranked:
        if letter not in points and partner not in taken:
            points[letter] = partner
            taken.add(partner)
    return {letter: points[letter] for letter in one.letters if letter in points}


def _ranked(
    one: ComparedSide, other: ComparedSide, found: Iterable[tuple[float, int, int]]
) -> Iterator[tuple[float, bool, int, str, str]]:
    floor = _ALIKE * one.size
    for off, i, j in found:
        letter, partner = one.letters[i], other.letters[j]
        links = abs(len(one.mechanism.carriers[letter]) - len(other.mechanism.carriers[partner]))
        yield 0.0 if off <= floor else off, letter != partner, links, letter, partner
