"""Change points: where the two modes of a dyad meet and the smooth motion goes on in the other one.

A parallelogram that becomes flat has both its modes in one pose. Its discriminant touches zero there
without changing sign, as a square does; the root of it that is smooth changes sign. Between samples such
a place is found as a minimum of the margin that is zero but for rounding.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import column
from compoundkin.base.bracketing import least
from compoundkin.base.poses import Pose
from compoundkin.base.series import Number
from compoundkin.kinematics.approach import CLOSE, between
from compoundkin.kinematics.block import blocks, places
from compoundkin.kinematics.inputs import Inputs
from compoundkin.kinematics.tracking import Tracker

# Margins (squared sines) below this between poses five degrees apart may have a zero between them.
NEAR = 0.05
# A margin below this at its minimum is a touching zero: rounding times the inverse of the margin's curvature.
TOUCHING = 1e-12
# A minimum is searched for unless the parabola through three samples stays above this part of the higher neighbour:
# that of a zero that falls like a square is near zero, that of one that falls linearly at most at a quarter.
CLEAR = 0.35
# From a zero a margin rises at most so many times as fast as to the higher end of its bracket.
STEEP = 4.0
# Steps of golden-section search: 0.618**65 is below TOUCHING, for margins that fall linearly to zero.
STEPS = 65
BLOCK = 4096


@dataclass(frozen=True)
class _Way:
    """The approach path or the motion, searched at samples near enough to each other, `unit` places apart."""

    samples: Inputs
    unit: float
    on_approach: bool

    def margins(self, tracker: Tracker, part: Inputs, s: Number, designs: Number, upto: int) -> Mapping[int, Number]:
        """Return the margins of all groups up to one, at samples `s` of a part of the way."""
        return tracker.run(part, 0, s * self.unit, designs, upto, self.on_approach).margins

    def blocks(self) -> Iterator[tuple[slice, slice, Inputs, Number, Number]]:
        """Return the way in blocks: designs, samples, their inputs, places and design indices."""
        for d, m in blocks(self.samples.designs, self.samples.poses, BLOCK):
            yield d, m, self.samples.cut(d, m), *places(d, m)


def near_groups(tracker: Tracker) -> set[int]:
    """Find groups near a limit position. It is on the approach path, or between a coarse motion's poses."""
    found: set[int] = set()
    upto = 1 + max((k for k, solver in enumerate(tracker.solving_order.solvers) if solver.modes_may_meet), default=-1)
    for way in _ways(tracker) if upto else ():
        if way.on_approach or way.unit < 1.0:
            for _, _, part, s, designs in way.blocks():
                margins = way.margins(tracker, part, s, designs, upto)
                found |= {k for k, margin in margins.items() if np.any(margin < NEAR)}
    return found


def pass_through(tracker: Tracker, near: Iterable[int]) -> bool:
    """Find the change points of the first group among `near` that has any. Tell whether there is one.

    They are noted in the tracker, which changes the group's sign there.
    """
    open_to = [k for k in sorted(near) if k not in tracker.flips and tracker.solving_order.solvers[k].modes_may_meet]
    if not open_to:
        return False
    found = [(way, _touching(way, tracker, open_to)) for way in _ways(tracker)]
    first = min((int(spots.groups[0]) for _, spots in found if len(spots.groups)), default=None)
    if first is None:
        return False
    for way, spots in found:
        here = spots.groups == first
        if here.any():
            flips = tracker.approach_flips if way.on_approach else tracker.flips
            flips[first] = _padded(spots.designs[here], spots.places[here], tracker.given.designs)
    tracker.flips.setdefault(first, np.full((tracker.given.designs, 1), np.inf))
    if tracker.solving_order.numbered or tracker.turns:
        tracker.choose()
    return True


def _sampled(way: _Way, tracker: Tracker, groups: Sequence[int]) -> dict[int, Number]:
    """Return the margins of some groups at all samples of a way; right as far as the first group that changes."""
    found = {k: np.empty((way.samples.designs, way.samples.poses)) for k in groups}
    for d, m, part, s, designs in way.blocks():
        margins = way.margins(tracker, part, s, designs, groups[-1] + 1)
        for k, whole in found.items():
            whole[d, m] = margins[k]
    return found


def _ways(tracker: Tracker) -> Iterator[_Way]:
    """The approach path, and the motion with samples put between poses that are far apart; none of a single pose."""
    if tracker.approach_path.poses > 1:
        yield _Way(tracker.approach_path, 1.0, on_approach=True)
    given = tracker.given
    if given.poses > 1:
        per_pose = max(1, between(tracker.solving_order, given))
        yield _Way(given.refined(per_pose), 1.0 / per_pose, on_approach=False)


def rates_at(given: Inputs, tracker: Tracker, order: int) -> tuple[Number, Number, Mapping[str, Pose]]:
    """Return the poses that are change points themselves, solved through the double root.

    They are designs, indices, poses.
    """
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
    block = tracker.run(part, order + 2 * len(doubles), after, designs[:, None], doubles=doubles)
    return designs, index, block.world


def _direction(given: Inputs, designs: Number, index: Number) -> Number:
    """+1 where the drivers' speeds carry the motion on to its next pose, -1 where back."""
    part = given.pick(designs, index.astype(float))
    ahead = given.pick(designs, np.minimum(index + 1, given.poses - 1).astype(float))
    behind = given.pick(designs, np.maximum(index - 1, 0).astype(float))
    total: Number = np.zeros(len(index))
    for name, values in part.drives.items():
        total = total + np.ravel((ahead.drives[name][0] - behind.drives[name][0]) * values[1])
    return np.where(total < 0, -1.0, 1.0)


class _Spots(NamedTuple):
    """Places along a way, each of one group and one design; in the order of the groups."""

    groups: Number
    designs: Number
    places: Number

    def where(self, which: Number) -> _Spots:
        """Return some of them."""
        return _Spots(self.groups[which], self.designs[which], self.places[which])


def _touching(way: _Way, tracker: Tracker, groups: Sequence[int]) -> _Spots:
    """Where groups have a zero margin that does not change sign; right as far as the first group that has any."""
    margins = _sampled(way, tracker, groups)
    lowest = [(k, *_lowest(margins[k])) for k in groups]
    spots = _Spots(*(np.concatenate(parts) for parts in zip(*((np.full(len(d), k), d, i) for k, d, i in lowest),
                                                           strict=True)))  # fmt: skip
    if not len(spots.groups):
        return spots
    place, lowest = _minimum(way, tracker, spots)
    place = place * way.unit
    snapped = np.where(np.abs(place - np.round(place)) < CLOSE, np.round(place), place)
    return spots._replace(places=snapped).where((np.abs(lowest) < TOUCHING) & np.isfinite(lowest))


def _lowest(margin: Number) -> tuple[Number, Number]:
    """Return designs and samples at which a margin is least and may have a zero beside them."""
    padded = np.pad(margin, ((0, 0), (1, 1)), constant_values=np.inf)
    here, before, after = margin, padded[:, :-2], padded[:, 2:]
    lowest = (here < NEAR) & (here >= -TOUCHING) & (here <= before) & (here < after) & (before >= 0) & (after >= 0)
    # at an end of the way the neighbour is not known: only between three samples is a parabola any evidence
    bend = before + after - 2.0 * here
    vertex = here - (after - before) ** 2 / (8.0 * bend)
    clear = np.isfinite(bend) & (vertex > CLEAR * np.maximum(before, after))
    designs, index = np.nonzero(lowest & ~clear)
    return designs, index


def _minimum(way: _Way, tracker: Tracker, spots: _Spots) -> tuple[Number, Number]:
    """Golden-section search for the least margins beside samples, for all groups and brackets at once.

    A bracket is left as soon as its margin is negative somewhere, or higher than it could rise from a zero within what
    is left of it.
    """
    low = np.maximum(spots.places - 1.0, 0.0)
    high = np.minimum(spots.places + 1.0, way.samples.poses - 1.0)
    steepest = STEEP * np.fmax(_margins(way, tracker, spots, low), _margins(way, tracker, spots, high))
    return least(
        lambda s, which: _margins(way, tracker, spots.where(which), s),
        low,
        high,
        STEPS,
        lambda values, widths: (values >= -TOUCHING) & (values <= steepest * widths),
    )


def _margins(way: _Way, tracker: Tracker, spots: _Spots, s: Number) -> Number:
    """Return the margin of each spot's group at a place beside it."""
    upto = int(spots.groups.max()) + 1
    found = way.margins(tracker, way.samples.pick(spots.designs, s), s[:, None], spots.designs[:, None], upto)
    own = np.empty(len(s))
    for k in np.unique(spots.groups):
        here = spots.groups == k
        own[here] = column(found[k], len(s))[here]
    return own


def _padded(designs: Number, where: Number, count: int) -> Number:
    rows = [np.sort(where[designs == d]) for d in range(count)]
    out = np.full((count, max(len(row) for row in rows)), np.inf)
    for d, row in enumerate(rows):
        out[d, : len(row)] = row
    return out
