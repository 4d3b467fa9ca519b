"""Where clearances are not above zero along a motion, and where they are least: between its poses too."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.interference.clearance_course import ClearanceCourse
from compoundkin.base.arrays import Number
from compoundkin.base.bracketing import bisect_brackets, golden_section_minimum
from compoundkin.base.display import ShortRepr

# Halvings of the distance of two poses, to 1e-8 of it.
HALVINGS = 27
# Steps of golden section, to 1e-9 of the distance of two poses.
STEPS = 44


class FoundTouches(NamedTuple):
    """Runs in which bodies touch, (n,). The bodies by their index, the places from which to which."""

    which: Number
    begin: Number
    end: Number


class FoundLeast(NamedTuple):
    """The least clearance of all bodies that never touch, (n,), and its places."""

    which: Number
    place: Number
    value: Number


@dataclass(frozen=True, eq=False, repr=False)
class TouchSearch(ShortRepr):
    """What is searched for touches: the clearances of a design."""

    course: ClearanceCourse

    @cached_property
    def _beside(self) -> Number:
        """Which known poses are followed by the next pose of the motion."""
        return np.diff(self.course.known) == 1

    @cached_property
    def _at_poses(self) -> Number:
        """The least clearance of each of the bodies at the poses, (bodies,)."""
        return self.course.at_poses.min(axis=1, initial=np.inf)

    @cached_property
    def _dips(self) -> tuple[Number, Number, Number]:
        """The bodies that come nearer between two poses than at any, where, and how near."""
        values, ways, touching = self.course.at_poses, self.course.ways, self.course.at_poses <= 0.0
        bound = 0.5 * (values[:, :-1] + values[:, 1:] - ways)
        free = ~(touching[:, :-1] | touching[:, 1:]) & self._beside
        worth = free & (bound < np.maximum(self._at_poses, 0.0)[:, None])
        return self._searched(np.argwhere(worth), 1.0)

    @cached_property
    def _gaps(self) -> tuple[Number, Number, Number]:
        """The bodies that part between two poses at which they touch, where, and by how much."""
        values, touching = self.course.at_poses, self.course.at_poses <= 0.0
        bound = 0.5 * (values[:, :-1] + values[:, 1:] + self.course.ways)
        worth = touching[:, :-1] & touching[:, 1:] & self._beside & (bound > 0.0)
        return self._searched(np.argwhere(worth), -1.0)

    def _searched(self, worth: Number, sign: float) -> tuple[Number, Number, Number]:
        """Return bodies, places and values of the least clearances between poses; the greatest with the sign -1."""
        which, index = worth.T
        low, ways = self.course.known[index].astype(float), self.course.ways[which, index]
        best: Number = np.maximum(self._at_poses, 0.0) if sign > 0 else np.zeros(len(self._at_poses))

        def value(s: Number, on: Number) -> Number:
            return np.nan_to_num(sign * self.course.between(which[on], s), nan=np.inf)

        def going(values: Number, widths: Number) -> Number:
            if sign > 0:
                np.minimum.at(best, which, np.maximum(values, 0.0))
            # a clearance changes no faster than its bodies move
            return (values > 0.0 if sign > 0 else values >= 0.0) & (values - ways * widths <= best[which])

        place, found = golden_section_minimum(value, low, low + 1.0, STEPS, going)
        return which, place, sign * found

    def touches(self) -> FoundTouches:
        """Return the runs in which bodies touch, in order of the bodies."""
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
        return FoundTouches(which[first].astype(int), begin, end)

    def _nodes(self) -> tuple[Number, Number, Number, Number]:
        """Return all places at which it is known whether bodies touch, in order: bodies, place, piece, whether."""
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

    def least(self) -> FoundLeast:
        """Return the least clearance of all bodies that never touch."""
        values, (which, place, found) = self.course.at_poses, self._dips
        best, at = self._at_poses.copy(), self.course.known[values.argmin(axis=1)].astype(float)
        order = np.argsort(-found, kind="stable")  # the least comes last, and stays
        lower = order[found[order] < best[which[order]]]
        best[which[lower]], at[which[lower]] = found[lower], place[lower]
        free = np.flatnonzero(best > 0.0)
        return FoundLeast(free, at[free], best[free])
