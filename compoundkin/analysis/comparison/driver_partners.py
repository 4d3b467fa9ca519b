"""Which driver of one mechanism stands for which of another, and over which displacements both can be driven."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import tau

import numpy as np

from compoundkin.analysis.comparison.common_pose import CommonPose
from compoundkin.analysis.comparison.compared_side import ComparedSide
from compoundkin.analysis.comparison.comparison_findings import ComparedDriver
from compoundkin.base.arrays import Number

# A range that lacks no more than this of a full turn is one.
_ROUNDING = 1e-6


def driver_partners(common: CommonPose) -> tuple[ComparedDriver, ...]:
    """Return the drivers that stand for each other.

    Of each kind those do that move the points alike at the common pose, else those of the same name or rank.
    """
    one, other = common.one, common.other
    likeness = _likeness(common)
    pairs = sorted(_candidates(common, likeness), key=lambda two: two[:3])
    found: dict[str, ComparedDriver] = {}
    taken: set[str] = set()
    for *_, sign, name, partner in pairs:
        if name not in found and partner not in taken:
            is_angle = one.structure.driven_angles[name]
            start, there = common.values[name], common.other_values[partner]
            matched = ComparedDriver(name, partner, is_angle, sign, start, there)
            scale = sign * (1.0 if is_angle else other.scale)
            speeds = one.speed(name), scale * other.speed(partner)
            reach = _reach(matched, one, other)
            found[name] = replace(matched, reach=reach, speed=speeds[0], other_speed=speeds[1])
            taken.add(partner)
    return tuple(found[name] for name in one.motion.drives if name in found)


def _candidates(common: CommonPose, likeness: Number) -> Iterator[tuple[float, bool, int, int, str, str]]:
    """Yield two drivers of one kind each, with what makes them unlike, and the sign of one in the other's sense."""
    one, other = common.one.structure.driven_angles, common.other.structure.driven_angles
    for i, name in enumerate(common.one.motion.drives):
        for j, partner in enumerate(common.other.motion.drives):
            if one[name] == other[partner]:
                like = float(likeness[i, j])
                yield -round(abs(like), 3), name != partner, abs(i - j), -1 if like < 0.0 else 1, name, partner


def _likeness(common: CommonPose) -> Number:
    """Return how alike drivers move the points, 1 for the same way and -1 for the opposite one, 0 where unknown."""
    one = _rates(common.one, common.values, list(common.points))
    other = _rates(common.other, common.other_values, list(common.points.values()))
    product = (one.conj().T @ other).real
    size = np.linalg.norm(one, axis=0)[:, None] * np.linalg.norm(other, axis=0)
    known = np.isfinite(size) & np.isfinite(product) & (size > 0.0)
    return np.where(known, product / np.where(known, size, 1.0), 0.0)


def _rates(side: ComparedSide, values: Mapping[str, float], letters: list[str]) -> Number:
    """Return how fast each driver moves points, (points, drivers)."""
    found = side.rates(values)[1]
    return found[[side.letters.index(letter) for letter in letters]]


def _reach(driver: ComparedDriver, one: ComparedSide, other: ComparedSide) -> tuple[float, float]:
    """Return the displacements from the common pose that are in the own range of both."""
    mine = _range(one, driver.name, driver.start, 1.0)
    theirs = _range(other, driver.other, driver.other_start, driver.sign * (1.0 if driver.is_angle else other.scale))
    whole = [driver.is_angle and high - low >= tau - _ROUNDING for low, high in (mine, theirs)]
    if all(whole):
        return 0.0, tau
    if any(whole):
        return theirs if whole[0] else mine
    turns = (-tau, 0.0, tau) if driver.is_angle else (0.0,)
    common = [(max(mine[0], theirs[0] + turn), min(mine[1], theirs[1] + turn)) for turn in turns]
    low, high = max(common, key=lambda part: part[1] - part[0])
    return (low, high) if low <= high else (0.0, 0.0)


def _range(side: ComparedSide, name: str, start: float, scale: float) -> tuple[float, float]:
    """Return the least and the greatest displacement of a driver in its own range."""
    values = (np.ravel(side.motion.drives[name].value) - start) * scale
    values = values[np.isfinite(values)]
    return (float(values.min()), float(values.max())) if values.size else (0.0, 0.0)
