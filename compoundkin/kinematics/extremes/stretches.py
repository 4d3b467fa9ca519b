"""Smooth stretches of a motion: its breaks and places, and quantities over them: their values at places."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from compoundkin.base.arrays import Number, degrees, whole_turns
from compoundkin.base.bracketing import false_position
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.extremes import Windows
from compoundkin.kinematics.extremes.motion_between import between, inputs_between, times_between, times_of
from compoundkin.kinematics.motion import Motion
from compoundkin.kinematics.quantities import quantity, whole_and_part
from compoundkin.model.attributes import DEGREES, LENGTH, SPEED, Dimension, derivative_order, with_unit
from compoundkin.model.attributes import PARTS as VALUE_PARTS
from compoundkin.model.laws.law_numbers import derivative_jumps
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact

# A bracket between an assembled pose and one that is not is divided into so many parts at once, so often: to 1e-13.
PARTS, ROUNDS = 33, 9


# From a jump values are taken this far away (of a place): far beyond the rounding of where it is, far below anything.
ASIDE = 1e-9


# Nearer than this (of a place) a jump and a pose are one place.
SAME = 2.0 * ASIDE


@dataclass(frozen=True, eq=False, repr=False)
class Stretches(ShortRepr):
    """Stretches of a motion on which everything is smooth; arrays of shape (n,).

    They are in order along each design. `low` and `high` are places; `first` and `last` the poses there, -1 where an
    end is none. `limits` (n, 2) tells at which ends the motion stops being assembled, or has no rates; `piece` numbers
    its assembled pieces.
    """

    design: Number
    low: Number
    high: Number
    first: Number
    last: Number
    limits: Number
    piece: Number

    def __len__(self) -> int:
        return len(self.low)

    def places(self, t: Number, which: Number) -> Number:
        """Return the places at `t` from -1 to 1 on some stretches, (stretches, t).

        Next to limit positions everything goes with the square root of the distance: `t` is smooth there.
        """
        low, high, limits = (v[which][:, None] for v in (self.low, self.high, self.limits))
        at_low, at_high = limits[..., 0], limits[..., 1]
        plain, up, down = (1.0 + t) / 2.0, ((1.0 + t) / 2.0) ** 2, 1.0 - ((1.0 - t) / 2.0) ** 2
        both = (1.0 - np.cos(np.pi * (1.0 + t) / 2.0)) / 2.0
        part = np.where(at_low & at_high, both, np.where(at_low, up, np.where(at_high, down, plain)))
        return np.where(part < 1.0, low + part * (high - low), high)

    def at_ends(self, values: Number) -> Number:
        """Return values of poses at both ends.

        From (..., designs, poses) to (..., n, 2); NaN where an end is no pose.
        """
        return np.stack([np.where(at >= 0, values[..., self.design, at], np.nan) for at in (self.first, self.last)], -1)

    def bends(self, values: Number) -> Number:
        """Return the second differences of values of poses, the greater of both ends.

        From (..., designs, poses) to (..., n); NaN where no end is a pose, and of fewer than three poses.
        """
        bend = np.abs(np.diff(values, 2, axis=-1))
        if not bend.shape[-1]:
            return np.full((*values.shape[:-2], len(self)), np.nan)
        ends = self.at_ends(np.concatenate([bend[..., :1], bend, bend[..., -1:]], axis=-1))
        return np.fmax(ends[..., 0], ends[..., 1])


def stretches_of(motion: Motion) -> Stretches:
    """Return the smooth stretches of a motion. They are kept with it."""
    found: Stretches | None = motion.__dict__.get("_stretches")
    if found is None:
        found = motion.__dict__["_stretches"] = _boundaries(motion)
    return found


def share_stretches(motion: Motion, other: Motion) -> Motion:
    """Return another motion through the same poses, which need not be divided again."""
    other.__dict__["_stretches"] = stretches_of(motion)
    return other


def _boundaries(motion: Motion) -> Stretches:
    good = np.broadcast_to(motion.failed == 0, (motion.inputs.designs, motion.inputs.poses))
    design, k = np.nonzero(good[:, :-1] & good[:, 1:])
    rows = [_rows(design, k, k + 1.0, k, k + 1, k)]
    for step in (1, -1):  # the last pose before what is not assembled, the first one behind it
        beyond = np.roll(~good, -step, axis=1)
        beyond[:, -1 if step > 0 else 0] = False
        design, k = np.nonzero(good & beyond)
        rows.append(_to_limits(motion, design, k, step))
    return _numbered(_divided(np.concatenate(rows), *breaks_of(motion, good)), motion)


def _rows(design: Number, low: Number, high: Number, first: Number, last: Number, interval: Number) -> Number:
    """Return stretches as rows: design, low, high, first, last, limits at both ends, interval between poses."""
    columns = np.broadcast_arrays(design, low, high, first, last, 0.0, 0.0, interval)
    return np.stack([np.asarray(c, dtype=float) for c in columns], axis=-1)


def _to_limits(motion: Motion, design: Number, k: Number, step: int) -> Number:
    """Return the rows from assembled poses to the limit positions next to them."""
    good, bad = k.astype(float), k + float(step)
    for _ in range(ROUNDS if len(k) else 0):
        parts = np.linspace(good, bad, PARTS + 1, axis=-1)[:, 1:-1]
        there = between(motion, np.repeat(design, PARTS - 1), parts.ravel(), 0)
        holds = np.cumprod(there.failed.reshape(parts.shape) == 0, axis=1).sum(axis=1)
        whole = np.concatenate([good[:, None], parts, bad[:, None]], axis=1)
        index = np.arange(len(k))
        good, bad = whole[index, holds], whole[index, holds + 1]
    rows = _rows(design, np.minimum(k, good), np.maximum(k, good), k, -1, np.minimum(k, k + step))
    if step < 0:
        rows[:, [3, 4]] = rows[:, [4, 3]]
    rows[:, 6 if step > 0 else 5] = 1.0
    return rows[rows[:, 2] - rows[:, 1] > SAME]


def _divided(rows: Number, designs: Number, places: Number) -> Number:
    """Cut stretches where derivatives jump; a pose at a jump belongs to neither side."""
    for design, place in zip(designs.tolist(), places.tolist(), strict=True):
        mine = rows[:, 0] == design
        at_low, at_high = mine & (np.abs(rows[:, 1] - place) < SAME), mine & (np.abs(rows[:, 2] - place) < SAME)
        rows[at_low, 3], rows[at_high, 4] = -1, -1
        rows[at_low & (rows[:, 5] == 0), 1] = place + ASIDE
        rows[at_high & (rows[:, 6] == 0), 2] = place - ASIDE
        inside = np.flatnonzero(mine & ~at_low & ~at_high & (rows[:, 1] < place) & (rows[:, 2] > place))
        after = rows[inside].copy()
        rows[inside, 2], rows[inside, 4], rows[inside, 6] = place - ASIDE, -1, 0.0
        after[:, 1], after[:, 3], after[:, 5] = place + ASIDE, -1, 0.0
        rows = np.concatenate([rows, after])
    return rows[np.lexsort((rows[:, 1], rows[:, 0]))]


def _numbered(rows: Number, motion: Motion) -> Stretches:
    """Return the stretches of rows. Limits are also poses without rates; a piece ends where the next one is apart."""
    design, first, last = (rows[:, k].astype(int) for k in (0, 3, 4))
    still = np.broadcast_to(motion.regular | (motion.failed != 0), (motion.inputs.designs, motion.inputs.poses))
    limits = rows[:, 5:7] > 0
    limits[:, 0] |= (first >= 0) & ~still[design, first]
    limits[:, 1] |= (last >= 0) & ~still[design, last]
    apart = (np.diff(rows[:, 0]) != 0) | (rows[1:, 1] - rows[:-1, 2] > 2.0 * SAME)
    piece = np.cumsum(np.append(0, apart)) if len(rows) else np.empty(0, dtype=int)
    return Stretches(design, rows[:, 1], rows[:, 2], first, last, limits, piece)


# A contact is at a corner within this part of the way round its profile; found in so many trials at most.
FLAT, TRIALS = 1e-13, 40


# Nearer than this (of a place) two jumps are one.
SAME_BREAK = 1e-8


def breaks_of(motion: Motion, good: Number) -> tuple[Number, Number]:
    """Return designs and places at which derivatives jump; `good` (designs, poses) are assembled."""
    found = [*_of_laws(motion), *_of_profiles(motion, good)]
    rows = np.concatenate([np.empty((0, 2)), *found])
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    apart = np.append(True, (np.diff(rows[:, 0]) != 0) | (np.diff(rows[:, 1]) > SAME_BREAK))[: len(rows)]
    return rows[apart, 0].astype(int), rows[apart, 1]


def _of_laws(motion: Motion) -> list[Number]:
    """Return rows (design, place) where a driver's law has corners in time."""
    laws = [drive.law for drive in motion.mechanism.drives if drive.law is not None]
    if motion.time is None or not laws or motion.inputs.poses < 2:
        return []
    times = times_of(motion)
    low, high = float(np.min(times)), float(np.max(times))
    at = np.unique(np.concatenate([derivative_jumps(law, low, high) for law in laws]))
    slack = SAME_BREAK * (high - low) / motion.inputs.poses
    at = at[(at >= low - slack) & (at <= high + slack)]
    found = []
    for d, row in enumerate(times):
        before, after = np.minimum(row[:-1], row[1:])[:, None], np.maximum(row[:-1], row[1:])[:, None]
        k, which = np.nonzero((before - slack <= at) & (at <= after + slack) & (after > before))
        place = k + np.clip((at[which] - row[k]) / (row[k + 1] - row[k]), 0.0, 1.0)
        found.append(np.stack([np.full(len(k), float(d)), place], axis=-1))
    return found


def _of_profiles(motion: Motion, good: Number) -> list[Number]:
    """Return rows (design, place) where contacts pass from one smooth piece of their profile to the next."""
    return [_passed(motion, pair, good) for pair in filter(None, map(as_profile_contact, motion.structure.pairs))]


@dataclass(frozen=True)
class _Crossings:
    """Corners of a profile that its contact passes: designs, poses before, and the corners, (n,) each."""

    pair: ProfileContact
    design: Number
    k: Number
    corner: Number

    @property
    def period(self) -> float:
        """How far the parameter goes round a closed profile; that of an open one does not."""
        return self.pair.curve.high - self.pair.curve.low

    def beyond(self, motion: Motion, place: Number, before: Number) -> Number:
        """Return how far the contact is beyond the corners at places; `before` is how far it was at the poses."""
        with np.errstate(all="ignore"):
            there = between(motion, self.design, place, 0)
            found = _parameter(there, self.pair)[0] - self.corner
        return found + (whole_turns(before - found, self.period) if self.pair.curve.closed else 0.0)


def _parameter(motion: Motion, pair: ProfileContact) -> Number:
    poses = tuple(motion.poses[name] for name in pair.members)
    return np.broadcast_to(pair.parameter(motion.inputs.ends[pair.name], poses), motion.failed.shape)


def _passed(motion: Motion, pair: ProfileContact, good: Number) -> Number:
    """Return rows (design, place) where a contact passes corners of its profile, or leaps over a hollow."""
    curve = pair.curve
    known = np.array([*curve.breaks, *(0.5 * (a + b) for a, b in pair.bridged)])
    if not known.size:
        return np.empty((0, 2))
    with np.errstate(all="ignore"):
        parameter = np.where(good, _parameter(motion, pair), np.nan)
    period = curve.high - curve.low
    step = np.diff(parameter, axis=1)
    step = step - whole_turns(step, period) if curve.closed else step
    turns = np.arange(-1, 2) * period if curve.closed else np.zeros(1)
    # of a closed profile a corner may be a turn ahead or behind
    away = (known + turns[:, None]).ravel() - parameter[:, :-1, None]
    part = away / np.where(step == 0.0, np.nan, step)[..., None]
    design, k, which = np.nonzero((part > -SAME_BREAK) & (part < 1.0 + SAME_BREAK))
    place = k + np.clip(part[design, k, which], 0.0, 1.0)
    crossings = _Crossings(pair, design, k, np.tile(known, len(turns))[which])
    inside = np.abs(place - np.round(place)) > SAME_BREAK
    if inside.any():
        some = _Crossings(pair, *(v[inside] for v in (design, k, crossings.corner)))
        low = -away[design, k, which][inside]
        place[inside] = _refined(motion, some, low, low + step[design, k][inside])
    return np.stack([design.astype(float), place], axis=-1)


def _refined(motion: Motion, crossings: _Crossings, low: Number, high: Number) -> Number:
    """Return the places of corners between poses, from how far beyond them the contact is at the poses."""

    def beyond(part: Number) -> Number:
        return crossings.beyond(motion, crossings.k + part, (1.0 - part) * low + part * high)

    return crossings.k + false_position(beyond, np.ones(len(low)), low, high, FLAT * crossings.period, TRIALS)


# Two poses nearer than this (in parts of the size, or radians) are one: rounding of a full turn of many groups.
SAME_POSE = 1e-9


# Nearer than this (of a pose) two places are one.
SAME_PLACE = 1e-6


@dataclass(frozen=True, eq=False, repr=False)
class Places(ShortRepr):
    """Places along a motion, each of a design.

    `place` counts poses from 0, is fractional between them, and NaN for none.
    """

    motion: Motion = field(repr=False)
    design: Number
    place: Number

    @cached_property
    def drives(self) -> Mapping[str, Number]:
        """The drivers' values there, radians or lengths."""
        part = inputs_between(self.motion, *self._known)
        return {name: self._spread(values[0]) for name, values in part.drives.items()}

    @cached_property
    def time(self) -> Number | None:
        """The times there; None for a motion that is not in time."""
        return None if self.motion.time is None else self._spread(times_between(self.motion, *self._known))

    @property
    def _known(self) -> tuple[Number, Number]:
        good = np.isfinite(self.place)
        return self.design[good], self.place[good]

    def _spread(self, values: Number) -> Number:
        good = np.isfinite(self.place)
        out = np.full(self.place.shape, np.nan)
        out[good] = np.broadcast_to(np.reshape(values, (-1,)), np.shape(self.place[good]))
        return out

    def text(self, k: int) -> str:
        """Return one of them in words: the time, else the drivers' values, angles in degrees."""
        if self.time is not None:
            return f"{self.time[k] + 0.0:.6g} s"
        texts = []
        for name, values in self.drives.items():
            is_angle = self.motion.drives[name].is_angle
            unit = DEGREES if is_angle else self.motion.mechanism.unit
            value = np.round(degrees(values[k]), 9) if is_angle else values[k]
            texts.append(f"{name} {with_unit(f'{value + 0.0:.6g}', unit)}")
        return ", ".join(texts)

    def some(self, which: Number) -> Places:
        """Return some of the places."""
        return Places(self.motion, self.design[which], self.place[which])


def places_of_jumps(motion: Motion) -> Places:
    """Return both sides of the places where derivatives jump along a motion, in order."""
    s = stretches_of(motion)
    sides = [(s.low, (s.first < 0) & ~s.limits[:, 0]), (s.high, (s.last < 0) & ~s.limits[:, 1])]
    design, place = (np.concatenate([row[odd] for row, odd in rows]) for rows in
                     ([(s.design, odd) for _, odd in sides], sides))  # fmt: skip
    order = np.lexsort((place, design))
    return Places(motion, design[order], place[order])


def closed_cycles(motion: Motion) -> Number:
    """Tell which designs end where they began, (designs,)."""
    shape = motion.inputs.designs, motion.inputs.poses
    good = np.broadcast_to(motion.failed == 0, shape)
    whole = good[:, 0] & good[:, -1] & (shape[1] > 2)
    return np.asarray(whole & same_pose(motion, 0, -1) if whole.any() else whole)


def same_pose(motion: Motion, one: int, other: int) -> Number:
    """Tell in which designs two poses have all links at the same place, (designs,)."""
    shape = motion.inputs.designs, motion.inputs.poses
    same: Number = np.ones(shape[0], dtype=bool)
    for pose in motion.poses.values():
        for series, size in ((pose.z, np.ravel(motion.sizes)), (pose.u, 1.0)):
            value = np.broadcast_to(series.c[0], shape)
            same &= np.abs(value[:, one] - value[:, other]) <= SAME_POSE * size
    return same


@dataclass(frozen=True, eq=False, repr=False)
class Measure(ShortRepr):
    """A real quantity of any motion: its name and its function.

    `order` is how many time derivatives the motion must have. A length of a vector is `squared` to be smooth where it
    passes zero. Values below the part 1e-12 of `scale`, perhaps one of each design, are rounding.
    """

    name: str
    unit: str
    order: int
    of: Callable[[Motion], Number]
    squared: bool = False
    scale: Number = 0.0
    dimension: Dimension = "number"

    def scales(self, designs: int) -> Number:
        """Return the scale of each design, (designs,)."""
        return np.broadcast_to(np.ravel(self.scale), designs)

    def at_poses(self, motion: Motion) -> Number:
        """Return its values at all poses of a motion, (designs, poses)."""
        shape = motion.inputs.designs, motion.inputs.poses
        return np.broadcast_to(np.asarray(self.of(motion), dtype=float), motion.shape).reshape(shape)


def measure_of(motion: Motion, name: str) -> Measure:
    """Return the real quantity of a name. It may take derivatives beyond the motion's order.

    Raises UnknownName with the nearest known name, InvalidInput for a vector, which has extremes by its parts only.
    """
    known = motion if derivative_order(name) <= motion.order else between(motion, 0, 0.0, derivative_order(name))
    whole, part = whole_and_part(known, name)
    if whole.is_vector and not part:
        parts = " or ".join(f"{name}.{word}" for word in VALUE_PARTS)
        raise InvalidInput(Problem(name, "a vector has no least and no greatest value", f"take {parts}"))
    owner, _, word = whole.name.rpartition(".")
    is_length = part == LENGTH or (word == SPEED and owner in motion.points)
    size = motion.sizes if whole.dimension == "length" else 1.0
    scale = whole.scale or size * driver_pace(motion) ** whole.order

    def of(at: Motion) -> Number:
        values = quantity(at, whole.name).values
        return VALUE_PARTS[part](values) if part else values

    return Measure(name, whole.unit, max(derivative_order(name), whole.order), of, is_length, scale, whole.dimension)


def measures_of(motion: Motion, asked: Sequence[str | Measure]) -> tuple[Measure, ...]:
    """Return names as the quantities that they name, quantities as they are."""
    return tuple(measure_of(motion, one) if isinstance(one, str) else one for one in asked)


def driver_pace(motion: Motion) -> float:
    """Return the rate of the fastest driver. Slides count by the mechanism's size."""
    order, given = motion.solving_order, motion.inputs
    rates = (np.abs(v[1]) / order.unit_in(given.ends, k) for k, v in given.drives.items() if len(v) > 1)
    return max((float(np.max(rate)) for rate in rates), default=0.0)


def values_at_poses(motion: Motion, measures: Sequence[Measure]) -> Number:
    """Return the values of quantities at all poses, (quantities, designs, poses).

    Those beyond the motion's order are solved for.
    """
    order = max((one.order for one in measures), default=0)
    whole = motion
    if order > motion.order:
        designs, poses = np.indices((motion.inputs.designs, motion.inputs.poses)).reshape(2, -1)
        whole = between(motion, designs, poses, order)
    with np.errstate(all="ignore"):
        rows = [one.at_poses(motion if one.order <= motion.order else whole) for one in measures]
    shape = motion.inputs.designs, motion.inputs.poses
    return np.array([row.reshape(shape) for row in rows]).reshape(len(measures), *shape)


def solved(motion: Motion, measures: Sequence[Measure], designs: Number, places: Number) -> Number:
    """Return the values of quantities at places along a motion, (quantities, n)."""
    order = max((one.order for one in measures), default=0)
    there = between(motion, designs, places, order)
    with np.errstate(all="ignore"):
        return np.array([one.at_poses(there)[0] for one in measures])


@dataclass(frozen=True, eq=False, repr=False)
class Course(ShortRepr):
    """Quantities over the smooth stretches of a motion: their values at poses, and at places between them."""

    motion: Motion
    measures: tuple[Measure, ...]
    stretches: Stretches

    @cached_property
    def values(self) -> Number:
        """The values at all poses, (quantities, designs, poses)."""
        return values_at_poses(self.motion, self.measures)

    @cached_property
    def ends(self) -> Number:
        """The values at the ends of stretches that are poses, (quantities, stretches, 2)."""
        return self.stretches.at_ends(self.values)

    def solved(self, which: Number, places: Number) -> Number:
        """Return the values at places of stretches, both (n,) or (n, k): (quantities, n) or (quantities, n, k)."""
        designs = self.stretches.design[which].reshape(-1, *[1] * (places.ndim - 1))
        found = solved(self.motion, self.measures, np.broadcast_to(designs, places.shape).ravel(), places.ravel())
        return found.reshape(len(self.measures), *places.shape)

    def windows(self, which: Number, low: Number, high: Number) -> tuple[Windows, Number]:
        """Return windows of stretches from low to high in their own t, all solved at once, and the samples' places."""
        t = Windows.samples(low, high)
        places = self.stretches.places(t, which)
        # rates next to a limit position grow without limit, or are not known there
        limits = self.stretches.limits[which]
        ends = ((t == -1.0) & limits[:, :1]) | ((t == 1.0) & limits[:, 1:])
        rates = np.array([one.order > 0 for one in self.measures], dtype=bool)[:, None, None]
        values = np.where(rates & ends, np.nan, self.solved(which, places))
        squared = np.array([one.squared for one in self.measures], dtype=bool)[:, None]
        return Windows(low, high, values, np.broadcast_to(squared, values.shape[:2])), places


@dataclass(frozen=True, eq=False, repr=False)
class CourseParts(ShortRepr):
    """The quantities `measure` (n,) of a course, by index, each over a stretch `which` (n,)."""

    course: Course
    measure: Number
    which: Number

    def windows(self, which: Number, low: Number, high: Number) -> tuple[Windows, Number]:
        """Return windows with their samples, and the places of these."""
        windows, places = self.course.windows(self.which[which], low, high)
        return windows.some(self.measure[which], np.arange(len(which))), places

    def places(self, which: Number, t: Number) -> Number:
        """Return the places at the stretches' own t, (n,)."""
        return self.course.stretches.places(t[:, None], self.which[which])[:, 0]

    def values(self, which: Number, places: Number) -> Number:
        """Return the values at places, (n,)."""
        return self.course.solved(self.which[which], places)[self.measure[which], np.arange(len(which))]
