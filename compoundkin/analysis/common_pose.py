"""A pose that two mechanisms have in common: by the places of their points, else by the names of the points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.correspondence import ComparedMechanism, partners_by_name, partners_by_place, shares_places
from compoundkin.base.arrays import Number
from compoundkin.base.errors import CompoundkinError
from compoundkin.model.geometry import FRAME
from compoundkin.model.mechanism import Mechanism
from compoundkin.model.units import LENGTHS

# So many steps of Newton are taken to a pose, from so many poses of a motion; steps below this are rounding.
_STEPS, _STARTS, _STILL = 10, 2, 1e-13
# Steps go on while they leave less than this part of the squares: near a pose that is found they leave far less.
_LESS = 0.9
# Of mechanisms whose sizes differ by more than this factor neither is the other, or a part of it.
_LIKE = 4.0


@dataclass(frozen=True, eq=False)
class CommonPose:
    """Two mechanisms at one pose, with the points that stand for each other.

    `values` and `other_values` are their drivers'. `matched_by` is "place" or "name".
    """

    one: ComparedMechanism
    other: ComparedMechanism
    values: Mapping[str, float]
    other_values: Mapping[str, float]
    points: Mapping[str, str]
    matched_by: str

    @property
    def reversed(self) -> CommonPose:
        """The same, the second first."""
        points = {partner: letter for letter, partner in self.points.items()}
        return CommonPose(self.other, self.one, self.other_values, self.values, points, self.matched_by)


def common_pose(one: ComparedMechanism, other: ComparedMechanism) -> CommonPose | None:
    """Return a pose that both have. None where no place and too few names tell one."""
    for scale in _scales(one, other):
        found = _by_place(one, other.scaled(scale))
        if found is not None:
            return found
    return _by_name(one, other.scaled(_scales(one, other)[0]))


def _scales(one: ComparedMechanism, other: ComparedMechanism) -> list[float]:
    """Return what lengths of the second may have to be multiplied by.

    Units tell it where both have some; else they are as written, or the power of ten that makes the two as large.
    Programs that round to few decimals are given drawings enlarged so.
    """
    units = scale_of_units(one.mechanism, other.mechanism)
    ratio = one.size / other.size
    power = float(10.0 ** np.round(np.log10(ratio))) if 0.0 < ratio < np.inf else 1.0
    return list(dict.fromkeys((units or 1.0, 1.0, power)))


def scale_of_units(one: Mechanism, other: Mechanism) -> float | None:
    """Return the unit of the second in that of the first. None where one has none."""
    units = [LENGTHS.get(mechanism.unit) for mechanism in (one, other)]
    return units[1] / units[0] if units[0] and units[1] else None


def _by_place(one: ComparedMechanism, other: ComparedMechanism) -> CommonPose | None:
    """Find the pose in which one is shown in the motion of the other."""
    if not 1.0 / _LIKE <= one.size / other.size <= _LIKE:
        return None
    at_one, at_other = (side.places(side.there)[0] for side in (one, other))
    values = _values_at_places(one, other, at_other)
    if values is not None:
        return _matched(one, other, values, other.shown)
    values = _values_at_places(other, one, at_one)
    return None if values is None else _matched(one, other, one.shown, values)


def _matched(
    one: ComparedMechanism, other: ComparedMechanism, values: Mapping[str, float], other_values: Mapping[str, float]
) -> CommonPose:
    places = one.places(one.at(values)), other.places(other.at(other_values))
    points = partners_by_place(one, places[0], other, places[1])
    return CommonPose(one, other, values, other_values, points, "place")


def _values_at_places(moving: ComparedMechanism, shown: ComparedMechanism, places: Number) -> dict[str, float] | None:
    """Return the driver values at which a mechanism is where another is shown. None where it never comes there."""
    for start in _starts(moving, shown, places):
        try:
            values = _approached(moving, shown, places, start)
            there = moving.places(moving.at(values))[0]
        except CompoundkinError:
            continue
        if shares_places(moving, there, shown, places):
            return values
    return None


def _starts(moving: ComparedMechanism, shown: ComparedMechanism, places: Number) -> Iterator[dict[str, float]]:
    """Yield the values of the pose that is shown, then of those nearest to the places."""
    yield moving.shown
    course = moving.places(moving.motion)
    off = np.array([np.mean(np.abs(_offsets(moving, shown, row, places)[1]) ** 2) for row in course])
    for pose in np.argsort(off)[:_STARTS]:
        if np.isfinite(off[pose]):
            yield moving.values(int(pose))


def _offsets(moving: ComparedMechanism, shown: ComparedMechanism, at: Number, places: Number) -> tuple[Number, Number]:
    """Return which points are led to places, and how far off they are. It is the marks of the one that has fewer."""
    if len(moving.marks) <= len(shown.marks):
        which = np.array([moving.letters.index(k) for k in moving.marks], dtype=int)
        goals = places
        nearest = np.abs(at[which][:, None] - goals).argmin(axis=1)
        return which, goals[nearest] - at[which]
    goals = places[[shown.letters.index(k) for k in shown.marks]]
    which = np.abs(at[:, None] - goals).argmin(axis=0)
    return which, goals - at[which]


def _approached(
    moving: ComparedMechanism, shown: ComparedMechanism, places: Number, start: Mapping[str, float]
) -> dict[str, float]:
    """Return the driver values at which the points are nearest to the places, by the method of Gauss and Newton."""
    values, before = dict(start), np.inf
    for _ in range(_STEPS):
        there, rates = moving.rates(values)
        which, off = _offsets(moving, shown, there, places)
        rows = np.concatenate([rates[which].real, rates[which].imag])
        step = np.zeros(0)
        if np.isfinite(rows).all():
            step = np.linalg.lstsq(rows, np.concatenate([off.real, off.imag]), rcond=None)[0]
        for name, change in zip(values, step, strict=False):
            values[name] += float(change)
        far = float(np.sum(np.abs(off) ** 2))
        if np.abs(step).max(initial=0.0) <= _STILL or far > _LESS * before:
            break
        before = far
    return values


def _by_name(one: ComparedMechanism, other: ComparedMechanism) -> CommonPose | None:
    """Return a pose by the names of points. None where no more than half of the marks have names in common."""
    points = partners_by_name(one, other)
    known = sum(k in points for k in one.marks)
    if 2 * known <= min(len(one.marks), len(other.marks)):
        return None
    return CommonPose(one, other, one.shown, values_of_matching_pose(one, other, points), points, "name")


# Points nearer to each other than this part of the size tell no direction.
_DISTINCT = 1e-9


def values_of_matching_pose(
    one: ComparedMechanism, other: ComparedMechanism, points: Mapping[str, str]
) -> dict[str, float]:
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


def _turn(
    one: ComparedMechanism, driver: str, other: ComparedMechanism, name: str, points: Mapping[str, str]
) -> float | None:
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


def _between(
    one: ComparedMechanism, link: str, other: ComparedMechanism, own: str, points: Mapping[str, str]
) -> complex | None:
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
