"""Where derivatives jump along a motion: at the corners of laws in time and of profiles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.arrays import Number, whole_turns
from compoundkin.base.bracketing import false_position
from compoundkin.kinematics.extremes.inputs_between import times_of
from compoundkin.kinematics.extremes.motion_between import between
from compoundkin.kinematics.motion import Motion
from compoundkin.model.laws.law_numbers import derivative_jumps
from compoundkin.model.pairs.profile_contact import ProfileContact, as_profile_contact

# A contact is at a corner within this part of the way round its profile; found in so many trials at most.
FLAT, TRIALS = 1e-13, 40
# Nearer than this (of a place) two jumps are one.
SAME = 1e-8


def breaks_of(motion: Motion, good: Number) -> tuple[Number, Number]:
    """Return designs and places at which derivatives jump; `good` (designs, poses) are assembled."""
    found = [*_of_laws(motion), *_of_profiles(motion, good)]
    rows = np.concatenate([np.empty((0, 2)), *found])
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    apart = np.append(True, (np.diff(rows[:, 0]) != 0) | (np.diff(rows[:, 1]) > SAME))[: len(rows)]
    return rows[apart, 0].astype(int), rows[apart, 1]


def _of_laws(motion: Motion) -> list[Number]:
    """Return rows (design, place) where a driver's law has corners in time."""
    laws = [drive.law for drive in motion.mechanism.drives if drive.law is not None]
    if motion.time is None or not laws or motion.inputs.poses < 2:
        return []
    times = times_of(motion)
    low, high = float(np.min(times)), float(np.max(times))
    at = np.unique(np.concatenate([derivative_jumps(law, low, high) for law in laws]))
    slack = SAME * (high - low) / motion.inputs.poses
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
    design, k, which = np.nonzero((part > -SAME) & (part < 1.0 + SAME))
    place = k + np.clip(part[design, k, which], 0.0, 1.0)
    crossings = _Crossings(pair, design, k, np.tile(known, len(turns))[which])
    inside = np.abs(place - np.round(place)) > SAME
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
