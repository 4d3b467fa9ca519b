"""Searches for the greatest and least values of the courses of many designs, between the poses too.

Courses with one smooth peak or two take compiled programs, all others the search that a motion takes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.extremes import MOST_ADDED, POLE, ROUNDING, Offers, SoughtPeaks, Windows, best_of, peaks
from compoundkin.programs.backends.runner import THREAD_TURNS
from compoundkin.studies.responses.assembled_range import assembled_range
from compoundkin.studies.responses.course_peaks import CoursePrograms, SampledBest, Vertices, course_programs
from compoundkin.studies.responses.designs import Designs, refined_samples, refinement_parts

# A window is narrowed so often at most: at a kink to 1e-10 of it.
NARROWINGS = 20
# A window is narrowed so often by programs; its course is then searched as any other.
NARROWINGS_BY_PROGRAMS = 2
# Studies of fewer designs are over before the programs, which take a twentieth of a second once, are made.
MANY = 1024


@dataclass(frozen=True, eq=False, repr=False)
class CourseExtreme(ShortRepr):
    """The greatest value of a course of each design, and its place.

    With the sign -1 it is the least. Both are (designs,), NaN where a design is not assembled over the whole motion.
    """

    value: Number
    place: Number


class SampledCourse(NamedTuple):
    """A course of each design, `parts` samples from pose to pose.

    `high` and `low` (designs,) are its greatest and least samples, `high_at` and `low_at` their numbers.
    """

    parts: int
    values: Number
    high: Number
    low: Number
    high_at: Number
    low_at: Number

    @classmethod
    def of(cls, values: Number, parts: int) -> SampledCourse:
        """Return a course with its extremes; their places are found in less time than themselves."""
        begin, flat = np.arange(len(values)) * values.shape[1], np.ravel(values)
        with THREAD_TURNS.left():
            high_at, low_at = values.argmax(axis=1), values.argmin(axis=1)
        return cls(parts, values, flat.take(begin + high_at), flat.take(begin + low_at), high_at, low_at)

    def best(self, sign: float) -> SampledBest:
        """Return the greatest samples times a sign."""
        ends = (self.high, self.low, self.high_at) if sign > 0.0 else (-self.low, -self.high, self.low_at)
        return SampledBest(ends[0], ends[1], ends[2] / self.parts, np.full(len(self.values), sign))

    def some(self, rows: Number) -> SampledCourse:
        """Return it of some designs, by index."""
        return SampledCourse(self.parts, *(each.take(rows, axis=0) for each in self[1:]))

    def pass_infinity(self, rows: Number, values: Number) -> Number:
        """Tell which values of designs, by index, are far beyond all samples in pairs: as the reciprocal of a rate.

        Of two neighbours a pole is at one at most. Of a course that mostly rests the median would be rounding.
        """
        sizes = np.abs(self.values[rows])
        return values > POLE * np.minimum(sizes[:, 1:], sizes[:, :-1]).max(axis=1, initial=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class CourseSearch(ShortRepr):
    """A search for the greatest values of a course, and for its least ones, between the poses too.

    The length of a vector is `squared`, so that it is smooth where it passes zero.
    """

    designs: Designs
    name: str
    is_angle: bool = False
    squared: bool = False

    def extremes(self, signs: Sequence[float]) -> dict[float, CourseExtreme]:
        """Return the greatest values by the sign 1, the least by -1."""
        with np.errstate(all="ignore"):
            sampled = self.designs.computed_once((SampledCourse, self.name), self._course)
            values, places = self._searched(sampled, signs)
        values *= np.array(signs)[:, None]
        known = assembled_range(self.designs).assembled
        values, places = np.where(known, values, np.nan), np.where(known & ~np.isnan(values), places, np.nan)
        return {sign: CourseExtreme(*each) for sign, *each in zip(signs, values, places, strict=True)}

    def _course(self) -> SampledCourse:
        """Return the course at the poses, or in a motion that has few between them too."""
        number, poses = self.designs.number, self.designs.poses
        parts = refinement_parts(poses)
        if parts == 1:
            course = np.broadcast_to(self.designs.outputs[self.name], (number, poses))
        else:
            places = np.broadcast_to(refined_samples(poses), (number, parts * (poses - 1) + 1))
            course = self.designs.values_at(self.name, np.arange(number), places, self.is_angle)
        return SampledCourse.of(course, parts)

    def _searched(self, sampled: SampledCourse, signs: Sequence[float]) -> Number:
        """Return the greatest values times signs, and their places, (2, signs, designs)."""
        number, samples = sampled.values.shape
        found, left = np.empty((2, len(signs) * number)), np.ones(len(signs) * number, dtype=bool)
        programs = course_programs(self.squared, self.designs.path.compiled.backend)
        if programs is not None and number >= MANY and samples > 2:
            few, *own = self._few_peaks(sampled, signs, programs)
            if len(few) == len(left):
                return np.array(own).reshape(2, -1, number)
            found[:, few], left[few] = own, False
        for k, sign in enumerate(signs):
            rows = np.flatnonzero(left[k * number : (k + 1) * number])
            if len(rows):
                found[:, k * number + rows] = self._any_peaks(sampled.some(rows), rows, sign)
        return found.reshape(2, -1, number)

    def _few_peaks(
        self, sampled: SampledCourse, signs: Sequence[float], programs: CoursePrograms
    ) -> tuple[Number, Number, Number]:
        """Return the greatest values times signs of courses with one or two peaks, and their places.

        First are their indices among (signs, designs): of those whose peaks are smooth.
        """
        number = len(sampled.values)
        counted = programs.counted_peaks(sampled.values, sampled.high, sampled.low)
        count, first, second = (np.concatenate([counted[sign][k] for sign in signs]) for k in range(3))
        few = np.flatnonzero((count == 1.0) | (count == 2.0))
        if not len(few):
            return few, *np.empty((2, 0))
        best = SampledBest(*map(np.concatenate, zip(*map(sampled.best, signs), strict=True))).some(few)
        # the windows of all, then the other ones of those with two peaks
        pairs = np.flatnonzero(count.take(few) == 2.0)
        which, k = np.append(np.arange(len(few)), pairs), np.append(first.take(few), second.take(few.take(pairs)))
        f = DesignCourses(self, few.take(which) % number)
        windows, _ = f.windows_around(k.astype(int), sampled.values.shape[1], sampled.parts)
        found = self._vertices(f, windows, best.some(which), programs)
        value, place, is_right, infinite = self._best_of_few(best, found, pairs, programs)
        is_right[infinite[sampled.pass_infinity(few.take(infinite) % number, value.take(infinite))]] = False
        if is_right.all():
            return few, value, place
        right = np.flatnonzero(is_right)
        return few.take(right), value.take(right), place.take(right)

    def _best_of_few(
        self, best: SampledBest, found: Vertices, pairs: Number, programs: CoursePrograms
    ) -> tuple[Number, Number, Number, Number]:
        """Return the greatest of samples and of vertices, and their places, (n,).

        Vertices are those of all samples, then the other ones of `pairs`. Besides which are right, and which may be
        infinite, by index.
        """
        last, number = self.designs.poses - 1.0, len(best.value)
        one, other = found.some(slice(number)), found.some(slice(number, None))
        value, place, far = programs.best_of_few(best, [one], last)
        is_right, narrowed = one.is_right > 0.0, one.is_narrowed > 0.0
        if len(pairs):
            of_two = programs.best_of_few(best.some(pairs), [one.some(pairs), other], last)
            value[pairs], place[pairs], far[pairs] = of_two
            is_right[pairs] &= other.is_right > 0.0
            narrowed[pairs] |= other.is_narrowed > 0.0
        return value, place, is_right, np.flatnonzero(narrowed & (far > 0.0))

    def _vertices(self, f: DesignCourses, windows: Windows, best: SampledBest, programs: CoursePrograms) -> Vertices:
        """Return the vertices of courses in windows, which narrow where they are not smooth, with their values."""
        found = programs.vertices(windows, best)
        for _ in range(NARROWINGS_BY_PROGRAMS):
            wrong = np.flatnonzero(found.is_right == 0.0)
            if not len(wrong):
                break
            windows, _ = f.windows(wrong, found.before.take(wrong), found.after.take(wrong))
            narrow = programs.vertices(windows, best.some(wrong))
            for each, own in zip(found, narrow._replace(is_narrowed=np.ones(len(wrong))), strict=True):
                each[wrong] = own
        return found._replace(value=f.values(slice(None), found.place))

    def _any_peaks(self, sampled: SampledCourse, designs: Number, sign: float) -> tuple[Number, Number]:
        """Return the greatest values of some designs and their places: of samples, and of peaks in windows around."""
        best, least, place, _ = sampled.best(sign)
        largest = np.maximum(np.abs(best), np.abs(least))
        offers = [Offers(np.arange(len(best)), best, place)]
        rows, k = _peaks(sampled.values, best, sign)
        if len(rows):
            span = best - least
            sought = SoughtPeaks(rows, np.full(len(rows), sign), largest.take(rows), span.take(rows))
            f = DesignCourses(self, designs.take(rows))
            windows, table = f.windows_around(k, sampled.values.shape[1], sampled.parts)
            offers += peaks(f, sought, windows, table.take(k, axis=0), best, self.designs.poses - 1, NARROWINGS)
        value, place, _ = best_of(offers, largest, np.asarray(self.squared))
        # what is far beyond all others may be so
        far = value > POLE * np.maximum(np.maximum(least, -best), 0.0)
        narrowed = np.zeros(len(best), dtype=bool)
        for one in offers if far.any() else ():
            narrowed[one.kind] |= not one.exact
        rows = np.flatnonzero(narrowed & far)
        value[rows[sampled.pass_infinity(rows, value.take(rows))]] = np.inf
        return value, place


@dataclass(frozen=True, eq=False, repr=False)
class DesignCourses(ShortRepr):
    """A course of designs by index `rows` (n,), at places."""

    search: CourseSearch
    rows: Number

    def windows(self, which: Number, low: Number, high: Number) -> tuple[Windows, Number]:
        """Return windows with their samples, and the places of these."""
        places = Windows.samples(low, high)
        return Windows(low, high, self._at(which, places), self._squared(low)), places

    def windows_around(self, k: Number, samples: int, parts: int) -> tuple[Windows, Number]:
        """Return windows around samples `k` (n,) of so many, `parts` of them from pose to pose.

        Besides the places of the samples of all such windows, (samples, samples of one).
        """
        every = np.arange(float(samples))
        low, high = np.maximum(every - 1.0, 0.0) / parts, np.minimum(every + 1.0, samples - 1.0) / parts
        table, own, search = Windows.samples(low, high), low[k], self.search
        values = search.designs.values_at(search.name, self.rows, table, search.is_angle, k)
        return Windows(own, high[k], values, self._squared(own)), table

    def _squared(self, like: Number) -> Number:
        return np.broadcast_to(self.search.squared, len(like))

    def places(self, which: Number, t: Number) -> Number:
        """Return the places themselves."""
        return t

    def values(self, which: Number | slice, places: Number) -> Number:
        """Return the values at places, (n,)."""
        return self._at(which, places[:, None])[:, 0]

    def _at(self, which: Number | slice, places: Number) -> Number:
        return self.search.designs.values_at(self.search.name, self.rows[which], places, self.search.is_angle)


def _peaks(course: Number, best: Number, sign: float) -> tuple[Number, Number]:
    """Return designs and poses near which the greatest value may be: no neighbour is higher, the bend is large enough.

    `best` are the greatest at the poses, (designs,). Values are times the sign.
    """
    poses, ordered = course.shape[1], (np.greater_equal, np.less_equal)
    rises, drops = ordered if sign > 0.0 else ordered[::-1]
    # all rows are compared as one, which their ends interrupt
    flat = np.ravel(course)
    peak, falls = np.empty((2, *course.shape), dtype=bool)
    rises(flat[1:], flat[:-1], out=np.ravel(peak)[1:])
    drops(flat[1:], flat[:-1], out=np.ravel(falls)[:-1])
    peak[:, 0] = falls[:, -1] = True
    peak &= falls
    found = np.flatnonzero(peak)
    rows = found // poses
    k = found - rows * poses
    if poses < 3:
        return rows, k
    # the bend at a neighbour stands for that at an end
    inner = found + (k == 0) - (k == poses - 1)
    before, own, after = (flat.take(inner + step) for step in (-1, 0, 1))
    after -= own
    own -= before
    added = np.abs(after - own)
    added *= MOST_ADDED
    best = best.take(rows)
    may = np.flatnonzero((sign * flat.take(found) + added >= best) & (added > ROUNDING * np.abs(best)))
    return rows.take(may), k.take(may)
