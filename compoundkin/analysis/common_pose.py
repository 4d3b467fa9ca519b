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

# Newton steps to a pose, starting poses of a motion, and the step below which all is rounding.
_STEPS, _STARTS, _STILL = 10, 2, 1e-13
# Steps continue while they reduce the sum of squares to this part; near a solution they reduce it far more.
_LESS = 0.9
# Mechanisms whose sizes differ by more than this factor do not match by places.
_LIKE = 4.0


@dataclass(frozen=True, eq=False)
class CommonPose:
    """Two mechanisms at one pose, with their corresponding points.

    `values` and `other_values` are those of their drivers. `matched_by` is "place" or "name".
    """

    one: ComparedMechanism
    other: ComparedMechanism
    values: Mapping[str, float]
    other_values: Mapping[str, float]
    points: Mapping[str, str]
    matched_by: str

    @property
    def reversed(self) -> CommonPose:
        """The same with the two exchanged."""
        points = {partner: letter for letter, partner in self.points.items()}
        return CommonPose(self.other, self.one, self.other_values, self.values, points, self.matched_by)


def common_pose(one: ComparedMechanism, other: ComparedMechanism) -> CommonPose | None:
    """Return a common pose, None without common places and with too few common names."""
    for scale in _scales(one, other):
        found = _by_place(one, other.scaled(scale))
        if found is not None:
            return found
    return _by_name(one, other.scaled(_scales(one, other)[0]))


def _scales(one: ComparedMechanism, other: ComparedMechanism) -> list[float]:
    """Return the possible factors of lengths of the second.

    They are the ratio of units, else 1, and the power of ten that makes the two equally large: drawings for programs
    that round to few decimals are enlarged so.
    """
    units = scale_of_units(one.mechanism, other.mechanism)
    ratio = one.size / other.size
    power = float(10.0 ** np.round(np.log10(ratio))) if 0.0 < ratio < np.inf else 1.0
    return list(dict.fromkeys((units or 1.0, 1.0, power)))


def scale_of_units(one: Mechanism, other: Mechanism) -> float | None:
    """Return the unit of the second in that of the first, None without units."""
    units = [LENGTHS.get(mechanism.unit) for mechanism in (one, other)]
    return units[1] / units[0] if units[0] and units[1] else None


def _by_place(one: ComparedMechanism, other: ComparedMechanism) -> CommonPose | None:
    """Return the drawn pose of one in the motion of the other, or None."""
    if not 1.0 / _LIKE <= one.size / other.size <= _LIKE:
        return None
    at_one, at_other = (side.places(side.there)[0] for side in (one, other))
    values = _values_at_places(one, other, at_other)
    if values is not None:
        return _matched(one, other, values, other.drawn_values)
    values = _values_at_places(other, one, at_one)
    return None if values is None else _matched(one, other, one.drawn_values, values)


def _matched(
    one: ComparedMechanism, other: ComparedMechanism, values: Mapping[str, float], other_values: Mapping[str, float]
) -> CommonPose:
    places = one.places(one.at(values)), other.places(other.at(other_values))
    points = partners_by_place(one, places[0], other, places[1])
    return CommonPose(one, other, values, other_values, points, "place")


def _values_at_places(moving: ComparedMechanism, target: ComparedMechanism, places: Number) -> dict[str, float] | None:
    """Return the driver values at which a mechanism is in the places of the other, None if it never is."""
    for start in _starts(moving, target, places):
        try:
            values = _approached(moving, target, places, start)
            there = moving.places(moving.at(values))[0]
        except CompoundkinError:
            continue
        if shares_places(moving, there, target, places):
            return values
    return None


def _starts(moving: ComparedMechanism, target: ComparedMechanism, places: Number) -> Iterator[dict[str, float]]:
    """Yield the values of the drawn pose, then of those nearest to the places."""
    yield moving.drawn_values
    course = moving.places(moving.motion)
    off = np.array([np.mean(np.abs(_offsets(moving, target, row, places)[1]) ** 2) for row in course])
    for pose in np.argsort(off)[:_STARTS]:
        if np.isfinite(off[pose]):
            yield moving.values(int(pose))


def _offsets(moving: ComparedMechanism, target: ComparedMechanism, at: Number, places: Number) -> tuple[Number, Number]:
    """Return the points compared with places, and the offsets; the marks of the mechanism with fewer count."""
    if len(moving.marks) <= len(target.marks):
        which = np.array([moving.letters.index(k) for k in moving.marks], dtype=int)
        goals = places
        nearest = np.abs(at[which][:, None] - goals).argmin(axis=1)
        return which, goals[nearest] - at[which]
    goals = places[[target.letters.index(k) for k in target.marks]]
    which = np.abs(at[:, None] - goals).argmin(axis=0)
    return which, goals - at[which]


def _approached(
    moving: ComparedMechanism, target: ComparedMechanism, places: Number, start: Mapping[str, float]
) -> dict[str, float]:
    """Return the driver values at which the points are nearest to the places, by the Gauss-Newton method."""
    values, before = dict(start), np.inf
    for _ in range(_STEPS):
        there, rates = moving.rates(values)
        which, off = _offsets(moving, target, there, places)
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
    """Return a pose by the names of points, None where no more than half of the marks have common names."""
    points = partners_by_name(one, other)
    known = sum(k in points for k in one.marks)
    if 2 * known <= min(len(one.marks), len(other.marks)):
        return None
    return CommonPose(one, other, one.drawn_values, values_of_matching_pose(one, other, points), points, "name")


# Points nearer to each other than this part of the size define no direction.
_DISTINCT = 1e-9


def values_of_matching_pose(
    one: ComparedMechanism, other: ComparedMechanism, points: Mapping[str, str]
) -> dict[str, float]:
    """Return the second's driver values at the drawn pose of the first.

    Drivers correspond by name, else by rank. Along slides, and where no points define a link's angle, values are equal.
    """
    names = list(one.motion.drives)
    values = dict(other.drawn_values)
    for rank, name in enumerate(other.motion.drives):
        like = name if name in names else names[min(rank, len(names) - 1)]
        is_angle = other.structure.driven_angles[name]
        if is_angle != one.structure.driven_angles[like]:
            continue
        turn = _turn(one, like, other, name, points) if is_angle else None
        here = one.drawn_values[like] if is_angle else one.drawn_values[like] / other.scale
        values[name] = here if turn is None else other.drawn_values[name] + turn
    return values


def _turn(
    one: ComparedMechanism, driver: str, other: ComparedMechanism, name: str, points: Mapping[str, str]
) -> float | None:
    """Return the rotation of the second's driven link to the pose of the first's, None if no points define it."""
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
    """Return the rotation from a link of the second to one of the first, None if no two points define it."""
    on, of = one.mechanism.carriers, other.mechanism.carriers
    shared = [(k, p) for k, p in points.items() if k in on and link in on[k] and own in of[p]]
    if len(shared) < 2:
        return None
    at_one = dict(zip(one.letters, one.places(one.there)[0], strict=True))
    at_other = dict(zip(other.letters, other.places(other.there)[0], strict=True))
    (first, partner), *rest = shared
    for letter, like in rest:
        arms = at_one[letter] - at_one[first], at_other[like] - at_other[partner]
        if min(map(abs, arms)) > _DISTINCT * one.size:
            off = complex(arms[0] / arms[1])
            return off / abs(off)
    return None
