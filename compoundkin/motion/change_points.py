"""Change points: where the two modes of a dyad meet and the smooth motion goes on in the other one.

A parallelogram that becomes flat has both its modes in one pose. Its discriminant touches zero there
without changing sign, as a square does; the root of it that is smooth changes sign. Between samples such
a place is found as a minimum of the margin that is zero but for rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from compoundkin.motion.continuation import CLOSE
from compoundkin.motion.inputs import Inputs
from compoundkin.motion.plan import DyadStep, blocks
from compoundkin.motion.tracking import Tracker
from compoundkin.poses import Pose
from compoundkin.series import Number

# Margins (squared sines) below this between poses five degrees apart may have a zero between them.
NEAR = 0.05
# A margin below this at its minimum is a touching zero: rounding times the inverse of the margin's curvature.
TOUCHING = 1e-12
# Steps of golden-section search: 0.618**65 is below TOUCHING, for margins that fall linearly to zero.
STEPS = 65
GOLDEN = (np.sqrt(5.0) - 1.0) / 2.0
BLOCK = 4096


def pass_through(given: Inputs, tracker: Tracker, near: Iterable[int]) -> bool:
    """Find the change points of the first group among `near` that has any; whether there is one.

    They are noted in the tracker, which changes the group's sign there.
    """
    for k in sorted(near):
        step = tracker.plan.steps[k]
        if k in tracker.flips or not isinstance(step, DyadStep) or step.kernel.modes < 2:
            continue
        found = False
        for part, flips in ((tracker.lead, tracker.lead_flips), (given, tracker.flips)):
            designs, places = _touching(part, tracker, k, part is tracker.lead)
            if len(designs):
                flips[k] = _padded(designs, places, given.designs)
                found = True
        if found:
            tracker.flips.setdefault(k, np.full((given.designs, 1), np.inf))
            if tracker.plan.general:
                tracker.choose()
            return True
    return False


def rates_at(given: Inputs, tracker: Tracker, order: int) -> tuple[Number, Number, Mapping[str, Pose]]:
    """The poses that are change points themselves, solved through the double root: designs, indices, poses."""
    spots: dict[tuple[int, int], dict[int, bool]] = {}
    for k, flips in tracker.flips.items():
        place: Number = np.round(flips)
        for d, j in zip(*np.nonzero(np.abs(flips - place) < CLOSE), strict=True):
            spots.setdefault((int(d), int(place[d, j])), {})[k] = True
    designs = np.array([d for d, _ in spots], dtype=int)
    index = np.array([m for _, m in spots], dtype=int)
    if not spots:
        return designs, index, {}
    doubles = {k: np.array([[k in found] for found in spots.values()]) for k in tracker.flips}
    part = given.pick(designs, index.astype(float))
    after = index[:, None] + _direction(given, designs, index)[:, None] * 2.0 * CLOSE
    # each double root in a row costs two orders
    run = tracker.run(part, order + 2 * len(doubles), after, designs[:, None], doubles=doubles)
    return designs, index, run.world


def _direction(given: Inputs, designs: Number, index: Number) -> Number:
    """+1 where the drivers' speeds carry the motion on to its next pose, -1 where back."""
    part = given.pick(designs, index.astype(float))
    ahead = given.pick(designs, np.minimum(index + 1, given.poses - 1).astype(float))
    behind = given.pick(designs, np.maximum(index - 1, 0).astype(float))
    total: Number = np.zeros(len(index))
    for name, values in part.drives.items():
        total = total + np.ravel((ahead.drives[name][0] - behind.drives[name][0]) * values[1])
    return np.where(total < 0, -1.0, 1.0)


def _touching(given: Inputs, tracker: Tracker, k: int, lead: bool) -> tuple[Number, Number]:
    """Designs and places where group `k` has a zero margin that does not change sign."""
    if given.poses < 2:
        return np.zeros(0, dtype=int), np.zeros(0)
    margin = _margins(given, tracker, k, lead)
    padded = np.pad(margin, ((0, 0), (1, 1)), constant_values=np.inf)
    here, before, after = margin, padded[:, :-2], padded[:, 2:]
    lowest = (here < NEAR) & (here >= -TOUCHING) & (here <= before) & (here < after) & (before >= 0) & (after >= 0)
    designs, index = np.nonzero(lowest)
    if not len(designs):
        return designs, index
    low, high = np.maximum(index - 1.0, 0.0), np.minimum(index + 1.0, given.poses - 1.0)
    place, least = _minimum(given, tracker, k, lead, designs, low, high)
    snapped = np.where(np.abs(place - np.round(place)) < CLOSE, np.round(place), place)
    touching = (np.abs(least) < TOUCHING) & np.isfinite(least)
    return designs[touching], snapped[touching]


def _margins(given: Inputs, tracker: Tracker, k: int, lead: bool) -> Number:
    out = np.empty((given.designs, given.poses))
    for d, m in blocks(given.designs, given.poses, BLOCK):
        s, designs = np.arange(m.start, m.stop, dtype=float)[None], np.arange(d.start, d.stop)[:, None]
        out[d, m] = tracker.run(given.cut(d, m), 0, s, designs, k + 1, lead).margins[k]
    return out


def _minimum(
    given: Inputs, tracker: Tracker, k: int, lead: bool, designs: Number, low: Number, high: Number
) -> tuple[Number, Number]:
    """Golden-section search for the least margin of group `k`, for all brackets at once."""

    def margin(s: Number) -> Number:
        run = tracker.run(given.pick(designs, s), 0, s[:, None], designs[:, None], k + 1, lead)
        return np.broadcast_to(run.margins[k], (len(s), 1))[:, 0]

    a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
    fa, fb = margin(a), margin(b)
    for _ in range(STEPS):
        left = fa < fb
        low, high = np.where(left, low, a), np.where(left, b, high)
        new = np.where(left, high - GOLDEN * (high - low), low + GOLDEN * (high - low))
        f = margin(new)
        a, fa, b, fb = np.where(left, new, b), np.where(left, f, fb), np.where(left, a, new), np.where(left, fa, f)
    return np.where(fa < fb, a, b), np.minimum(fa, fb)


def _padded(designs: Number, places: Number, count: int) -> Number:
    rows = [np.sort(places[designs == d]) for d in range(count)]
    out = np.full((count, max(len(row) for row in rows)), np.inf)
    for d, row in enumerate(rows):
        out[d, : len(row)] = row
    return out
