"""Which link of one mechanism stands for which of another, by the points that they share; and their lengths."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations

from compoundkin.analysis.comparison.comparison_findings import ComparedLength
from compoundkin.base.arrays import first_entry
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism

# Of links with more points the distances from the first two are enough.
_ALL_DISTANCES = 5


def link_partners(one: Mechanism, other: Mechanism, points: Mapping[str, str]) -> dict[str, str]:
    """Return which links stand for each other. Those that share most points come first; the frames are one."""
    found, taken = {FRAME: FRAME}, {FRAME}
    for *_, name, partner in sorted(_shared(one, other, points)):
        if name not in found and partner not in taken:
            found[name] = partner
            taken.add(partner)
    return {name: found[name] for name in one.links if name in found}


def _shared(one: Mechanism, other: Mechanism, points: Mapping[str, str]) -> Iterator[tuple[int, bool, str, str]]:
    """Yield two links each that have points in common, with how many, and whether their names differ."""
    counts: dict[tuple[str, str], int] = {}
    for letter, like in points.items():
        for name in one.carriers[letter]:
            for partner in other.carriers[like]:
                if FRAME not in (name, partner):
                    counts[name, partner] = counts.get((name, partner), 0) + 1
    for (name, partner), count in counts.items():
        yield -count, name != partner, name, partner


def compared_lengths(
    one: Mechanism, other: Mechanism, links: Mapping[str, str], points: Mapping[str, str], scale: float
) -> Iterator[ComparedLength]:
    """Yield the distances of the points that links share. Those of the second count `scale` times."""
    for name, partner in links.items():
        mine, theirs = one.geometry.points.get(name, {}), other.geometry.points.get(partner, {})
        letters = [k for k in mine if points.get(k) in theirs]
        pairs = list(combinations(letters, 2))
        if len(letters) > _ALL_DISTANCES:
            pairs = [two for two in pairs if two[0] in letters[:2]]
        for a, b in pairs:
            like = points[a], points[b]
            lengths = abs(first_entry(mine[a] - mine[b])), scale * abs(first_entry(theirs[like[0]] - theirs[like[1]]))
            yield ComparedLength(name, partner, (a, b), like, float(lengths[0]), float(lengths[1]))
