"""`interference`: which links on one layer touch along a motion, and how near the others come."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.analysis.interference.clearance_course import ClearanceCourse
from compoundkin.analysis.interference.compared_bodies import comparison_of
from compoundkin.analysis.interference.interference_findings import Interference, LinkClearance, LinkTouch
from compoundkin.analysis.interference.shapely_library import shapely
from compoundkin.analysis.interference.touch_search import TouchSearch
from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Places, closed_cycles
from compoundkin.model.mechanism import values_of_design
from compoundkin.model.outline_shapes import outline_shapes

# Runs that end nearer than this to a pose (in poses) end at it.
SAME = 1e-7


@checked
def interference(motion: Motion) -> Interference:
    """Find which links touch along a motion, and how near others come.

    All outlines that share a layer are compared, pins too, at the poses and between them: where the clearance of two
    links is zero is found to 1e-6 of the driver. Of joined links, what reaches the points of their common pin or slide
    overlaps by nature and is not compared; links that gears, cams, slots or other pairs join are not compared at all.
    Poses that cannot be assembled are left out.

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
    return ClearanceCourse(motion, design, comparison_of(motion.mechanism, shapes, points))


def _touches(course: ClearanceCourse, search: TouchSearch) -> Iterator[LinkTouch]:
    """Yield the runs of a design."""
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
    """Return runs, of closed cycles those that come to the last pose as one with those that begin at the first."""
    keep: Number = np.ones(len(which), dtype=bool)
    last, begin = course.motion.inputs.poses - 1, begin.copy()
    if closed_cycles(course.motion)[course.design]:
        for k in np.flatnonzero((begin <= 0.0) & (end < last)):
            before = np.flatnonzero((which == which[k]) & (end >= last) & (begin > 0.0))
            if len(before):
                begin[k], keep[before] = begin[before[0]], False
    return which[keep], begin[keep], end[keep]


def _open(course: ClearanceCourse, places: Number, side: int) -> Number:
    """Tell which places are poses beside which there is none, or none that is assembled."""
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
    """Return what the drivers and the time are at each of some places."""
    there = Places(course.motion, np.full(len(place), course.design), place)
    drives, time = there.drives, there.time
    times: list[float | None] = [None] * len(place) if time is None else np.asarray(time).tolist()
    return [({name: float(values[k]) for name, values in drives.items()}, times[k]) for k in range(len(place))]
