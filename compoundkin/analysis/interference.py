"""`interference`: which links on one layer touch along a motion, and the least clearance of the others.

Touches and least clearances are found between poses too: the clearance is a function of the place along the motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.clearances import ClearanceCourse, compared_outlines, shapely
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import bisect_brackets, golden_section_minimum
from compoundkin.base.display import DisplaysHtml, ShortRepr, count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Places, closed_cycles
from compoundkin.model.mechanism import values_of_design
from compoundkin.model.outline_shapes import outline_shapes

# Touches that end nearer than this to a pose (in poses) end at it.
SAME = 1e-7


@checked
def interference(motion: Motion) -> Interference:
    """Return which links touch along a motion, and the least clearance of the others.

    All outlines that share a layer are compared, pins too, at the poses and between them: zeros of a clearance are
    exact to 1e-6 of the driver. Shapes of joined links that reach the points of their common pin or slide always
    overlap and are not compared, nor are links joined by gears, cams, slots or other pairs. Poses that cannot be
    assembled are left out.

    Raises InvalidInput for a mechanism without outlines, for links whose dimensions change along the motion, and where
    shapely is not installed.

    >>> from compoundkin.kinematics import solve
    >>> from compoundkin.model.elements import drive, link
    >>> from compoundkin.model.mechanism import Mechanism
    >>> from compoundkin.model.outlines import outline
    >>> bar, stop = outline("crank", 2), outline("frame", at=(0, 8), radius=1)
    >>> frame, crank = link("frame", A=0), link("crank", A=0, B=9)
    >>> found = interference(solve(Mechanism("Crank and stop", frame, crank, drive("crank"), bar, stop)))
    >>> [np.rad2deg(found.touches[0].begin["crank"]).round(4), np.rad2deg(found.touches[0].end["crank"]).round(4)]
    [np.float64(75.5225), np.float64(104.4775)]
    """
    if not motion.mechanism.outlines:
        what, remedy = "no link has an outline", 'write some: outline("crank", 8)'
        raise InvalidInput(Problem("outlines", what, remedy))
    shapely()
    touches: list[LinkTouch] = []
    clearances: list[LinkClearance] = []
    neighbours: dict[tuple[str, str], None] = {}
    for design in range(motion.inputs.designs):
        course = _course(motion, design)
        neighbours |= dict.fromkeys(course.comparison.neighbours)
        search = TouchSearch(course)
        if len(course.known) and course.comparison.compared:
            touches += _touches(course, search)
            clearances += _clearances(course, search)
    assembled = int(np.count_nonzero(motion.failed == 0))
    return Interference(
        motion, tuple(touches), tuple(clearances), tuple(neighbours), assembled, int(motion.failed.size) - assembled
    )


def _course(motion: Motion, design: int) -> ClearanceCourse:
    """Return the clearances of a design."""
    points = values_of_design(motion.mechanism.geometry.points, motion.shape, design)
    for link, own in points.items():
        for letter, place in own.items():
            if np.ndim(place):
                what = f"{letter} on {link} is elsewhere at every pose"
                raise InvalidInput(Problem("motion", what, "give the dimensions an axis of their own before the last"))
    shapes = outline_shapes(motion.mechanism, points, motion.shape, design)
    return ClearanceCourse(motion, design, compared_outlines(motion.mechanism, shapes, points))


def _touches(course: ClearanceCourse, search: TouchSearch) -> Iterator[LinkTouch]:
    """Yield the touches of a design."""
    which, begin, end = _through_seam(course, *search.touches())
    at_begin, at_end = _drives(course, begin), _drives(course, end)
    middles = course.middles(which, begin)
    edges = _open(course, begin, -1), _open(course, end, 1)
    for k, index in enumerate(which.tolist()):
        two = course.comparison.compared[index]
        first, last = at_begin[k][1], at_end[k][1]
        times = None if first is None or last is None else (first, last)
        yield LinkTouch(
            two.one, two.other, two.layers, course.design, float(begin[k]), float(end[k]), at_begin[k][0], at_end[k][0],
            bool(edges[0][k]), bool(edges[1][k]), complex(middles[k]), times,
        )  # fmt: skip


def _through_seam(course: ClearanceCourse, which: Number, begin: Number, end: Number) -> tuple[Number, Number, Number]:
    """Return touches, in closed cycles those up to the last pose joined with those from the first."""
    keep: Number = np.ones(len(which), dtype=bool)
    last, begin = course.motion.inputs.poses - 1, begin.copy()
    if closed_cycles(course.motion)[course.design]:
        for k in np.flatnonzero((begin <= 0.0) & (end < last)):
            before = np.flatnonzero((which == which[k]) & (end >= last) & (begin > 0.0))
            if len(before):
                begin[k], keep[before] = begin[before[0]], False
    return which[keep], begin[keep], end[keep]


def _open(course: ClearanceCourse, places: Number, side: int) -> Number:
    """Return whether places are poses beside a pose that is missing or not assembled."""
    near = np.round(places)
    return (np.abs(places - near) <= SAME) & ~np.isin(near + side, course.known)


def _clearances(course: ClearanceCourse, search: TouchSearch) -> Iterator[LinkClearance]:
    """Yield the least clearances of a design, the least first."""
    which, place, value = search.least()
    order = np.argsort(value, kind="stable")
    which, place, value = which[order], place[order], value[order]
    there, middles = _drives(course, place), course.middles(which, place)
    for k, index in enumerate(which.tolist()):
        two = course.comparison.compared[index]
        known = two.one, two.other, two.layers, course.design, float(value[k]), float(place[k])
        yield LinkClearance(*known, there[k][0], complex(middles[k]), there[k][1])


def _drives(course: ClearanceCourse, place: Number) -> list[tuple[dict[str, float], float | None]]:
    """Return the values of the drivers and the time at some places."""
    there = Places(course.motion, np.full(len(place), course.design), place)
    drives, time = there.drives, there.time
    times: list[float | None] = [None] * len(place) if time is None else np.asarray(time).tolist()
    return [({name: float(values[k]) for name, values in drives.items()}, times[k]) for k in range(len(place))]


@dataclass(frozen=True)
class LinkTouch:
    """An interval in which two links touch, from the place `first` to the place `last` along the motion.

    Places count poses from 0, and are fractional between them. `begin` and `end` are the drivers' values there, exact
    to 1e-6, or those at an end of the motion or beside poses that cannot be assembled (`open_begin`, `open_end`). `at`
    is the first point of contact. In a closed cycle an interval through the first pose has `first` after `last`. The
    name of a pin is "pin B".
    """

    one: str
    other: str
    layers: tuple[int, ...]
    design: int
    first: float
    last: float
    begin: Mapping[str, float]
    end: Mapping[str, float]
    open_begin: bool
    open_end: bool
    at: complex
    times: tuple[float, float] | None = None


@dataclass(frozen=True)
class LinkClearance:
    """The least clearance of two links that never touch, at a place along the motion; `at` is midway between them."""

    one: str
    other: str
    layers: tuple[int, ...]
    design: int
    clearance: float
    place: float
    drives: Mapping[str, float]
    at: complex
    time: float | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Interference(DisplaysHtml):
    """The touches of outlines along a motion, and the least clearances of links that never touch.

    `clearances` are in increasing order, design by design. `neighbours` are joined links whose shapes at their common
    joint are not compared. `poses` is the number of poses compared, `missing` of those that are not assembled.
    """

    motion: Motion
    touches: tuple[LinkTouch, ...]
    clearances: tuple[LinkClearance, ...]
    neighbours: tuple[tuple[str, str], ...]
    poses: int
    missing: int

    @property
    def passed(self) -> bool:
        """Whether nothing touches, over one pose at least."""
        return self.poses > 0 and not self.touches

    @property
    def least(self) -> LinkClearance | None:
        """The least clearance of all, or None."""
        return min(self.clearances, key=lambda one: one.clearance, default=None)

    @property
    def touching(self) -> tuple[tuple[str, str], ...]:
        """The pairs of links that touch."""
        return tuple(dict.fromkeys((one.one, one.other) for one in self.touches))

    def at(self, pose: int, design: int = 0) -> tuple[LinkTouch, ...]:
        """Return the touches at a pose, by its index along the motion."""
        return tuple(one for one in self.touches if one.design == design and _within(one, pose))

    @property
    def verdict(self) -> str:
        """The result in words."""
        if not self.poses:
            return "no pose is assembled: nothing could be compared"
        if not self.touches and not self.clearances:
            return "no two links share a layer but neighbours"
        if self.touches:
            return f"{count_phrase(len(self.touching), 'pair')} of links touch"
        least = self.least
        unit = f" {self.motion.mechanism.unit}".rstrip()
        result = "" if least is None else f"; the least clearance is {least.clearance:.6g}{unit}"
        return f"no links touch{result}"

    def __repr__(self) -> str:
        return f"Interference({self.motion.mechanism.title!r} at {count_phrase(self.poses, 'pose')}: {self.verdict})"


def _within(one: LinkTouch, place: float) -> bool:
    if one.first <= one.last:
        return one.first <= place <= one.last
    return place >= one.first or place <= one.last


# Halvings of the interval between two poses, to 1e-8 of it.
HALVINGS = 27
# Steps of golden section, to 1e-9 of the interval between two poses.
STEPS = 44


class TouchIntervals(NamedTuple):
    """Intervals in which bodies touch, (n,): indices of the bodies, first and last places."""

    which: Number
    begin: Number
    end: Number


class LeastClearances(NamedTuple):
    """The least clearances of bodies that never touch, (n,), and their places."""

    which: Number
    place: Number
    value: Number


@dataclass(frozen=True, eq=False, repr=False)
class TouchSearch(ShortRepr):
    """The search for touches and least clearances of a design."""

    course: ClearanceCourse

    @cached_property
    def _beside(self) -> Number:
        """Whether the next known pose is the next pose of the motion."""
        return np.diff(self.course.known) == 1

    @cached_property
    def _at_poses(self) -> Number:
        """The least clearance of each of the bodies at the poses, (bodies,)."""
        return self.course.at_poses.min(axis=1, initial=np.inf)

    @cached_property
    def _dips(self) -> tuple[Number, Number, Number]:
        """The bodies that are nearer between two poses than at any pose: indices, places and clearances."""
        values, changes, touching = self.course.at_poses, self.course.changes, self.course.at_poses <= 0.0
        bound = 0.5 * (values[:, :-1] + values[:, 1:] - changes)
        free = ~(touching[:, :-1] | touching[:, 1:]) & self._beside
        worth = free & (bound < np.maximum(self._at_poses, 0.0)[:, None])
        return self._searched(np.argwhere(worth), 1.0)

    @cached_property
    def _gaps(self) -> tuple[Number, Number, Number]:
        """The bodies that part between two poses at which they touch: indices, places and clearances."""
        values, touching = self.course.at_poses, self.course.at_poses <= 0.0
        bound = 0.5 * (values[:, :-1] + values[:, 1:] + self.course.changes)
        worth = touching[:, :-1] & touching[:, 1:] & self._beside & (bound > 0.0)
        return self._searched(np.argwhere(worth), -1.0)

    def _searched(self, worth: Number, sign: float) -> tuple[Number, Number, Number]:
        """Return bodies, places and values of the least (sign 1) or greatest (-1) clearances between poses."""
        which, index = worth.T
        low, changes = self.course.known[index].astype(float), self.course.changes[which, index]
        best: Number = np.maximum(self._at_poses, 0.0) if sign > 0 else np.zeros(len(self._at_poses))

        def value(s: Number, on: Number) -> Number:
            return np.nan_to_num(sign * self.course.between(which[on], s), nan=np.inf)

        def going(values: Number, widths: Number) -> Number:
            if sign > 0:
                np.minimum.at(best, which, np.maximum(values, 0.0))
            # a clearance changes no faster than its bodies move
            return (values > 0.0 if sign > 0 else values >= 0.0) & (values - changes * widths <= best[which])

        place, found = golden_section_minimum(value, low, low + 1.0, STEPS, going)
        return which, place, sign * found

    def touches(self) -> TouchIntervals:
        """Return the intervals in which bodies touch, in order of the bodies."""
        which, place, piece, is_touching = self._nodes()
        same = (which[1:] == which[:-1]) & (piece[1:] == piece[:-1])
        k = np.flatnonzero(same & (is_touching[1:] != is_touching[:-1]))
        inside = np.where(is_touching[k], place[k], place[k + 1])
        outside = np.where(is_touching[k], place[k + 1], place[k])
        edge = np.full(len(place) + 1, np.nan)
        edge[k + 1] = bisect_brackets(lambda s: self.course.between(which[k], s) <= 0.0, inside, outside, HALVINGS)[0]
        first = is_touching & np.append(True, ~same | ~is_touching[:-1])
        last = is_touching & np.append(~same | ~is_touching[1:], True)
        begin = np.where(np.isnan(edge[:-1][first]), place[first], edge[:-1][first])
        end = np.where(np.isnan(edge[1:][last]), place[last], edge[1:][last])
        return TouchIntervals(which[first].astype(int), begin, end)

    def _nodes(self) -> tuple[Number, Number, Number, Number]:
        """Return all places with a known clearance in order: bodies, place, piece of the motion, whether they touch."""
        values, known = self.course.at_poses, self.course.known.astype(float)
        pieces = np.append(0, np.cumsum(~self._beside))[: len(known)]
        rows = [np.stack([np.repeat(np.arange(len(values)), len(known)), np.tile(known, len(values)),
                          np.tile(pieces, len(values)), (values <= 0.0).ravel()])]  # fmt: skip
        for (which, place, value), is_touching in ((self._dips, True), (self._gaps, False)):
            odd = (value <= 0.0) == is_touching
            before = np.searchsorted(known, place[odd], side="right") - 1
            rows.append(np.stack([which[odd], place[odd], pieces[before], np.full(odd.sum(), is_touching)]))
        which, place, piece, touching = np.concatenate(rows, axis=1)
        order = np.lexsort((place, which))
        return which[order], place[order], piece[order], touching[order].astype(bool)

    def least(self) -> LeastClearances:
        """Return the least clearances of all bodies that never touch."""
        values, (which, place, found) = self.course.at_poses, self._dips
        best, at = self._at_poses.copy(), self.course.known[values.argmin(axis=1)].astype(float)
        order = np.argsort(-found, kind="stable")  # the least comes last, and stays
        lower = order[found[order] < best[which[order]]]
        best[which[lower]], at[which[lower]] = found[lower], place[lower]
        free = np.flatnonzero(best > 0.0)
        return LeastClearances(free, at[free], best[free])
