"""Path generation without timing, and poses with points: four-bars by all pairs of dyads that meet them.

Nine points have finitely many four-bars, seven points with a given fixed pivot, five points with both; so do a body's
poses and points where twice the poses and the points are ten. Fewer points leave a family: of it some are given, with
pivots and points between that are spread evenly.

Sources: those of `dyad_pairs`; S. Roberts, Three-bar motion in plane space, Proc. London Math. Soc. 7 (1875) 14-23.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import count_phrase
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dimensional.candidates import Candidates, Linkage, of_dyads, of_points
from compoundkin.dimensional.dyad_equations import RR, Dyad
from compoundkin.dimensional.dyad_pairs import DesignPositions, Pairs, pairs_through
from compoundkin.dimensional.tasks import MixedTask, PointTask

# Points that have finitely many four-bars, by how many fixed pivots are given.
POINTS = (9, 7, 5)
# Of a family so many choices of pivots are tried, by how many of them are given or chosen.
TRIED = (1, 4, 16)
# Pivots of a family are chosen around the points, within so many times their extent.
AROUND = 1.5


def path_points(task: PointTask) -> Candidates:
    """Return four-bars whose coupler point goes through two to nine points, with their cognates.

    Raises InvalidInput for more points than four-bars go through, with the pivots that are given.
    """
    points, ground = task.points, task.conditions.ground
    if len(ground) > 2 or len(points) > POINTS[len(ground)]:
        what = f"no four-bar goes through {count_phrase(len(points), 'point')} at will"
        if ground:
            what += f" with {count_phrase(len(ground), 'fixed pivot')} given"
        raise InvalidInput(Problem("points", what, "nine points, seven with one given pivot, five with two"))
    pivots = next(p for p in (2, 1, 0) if len(points) <= POINTS[p])
    pivots = max(pivots, len(ground))
    full = _filled(points, POINTS[pivots])
    choices = _choices(task, pivots - len(ground))
    made: list[Linkage] = []
    found = real = 0
    for chosen in choices:
        pairs = _pairs(full, (*ground, *chosen))
        exist = pairs.real()
        found, real = found + pairs.numbers.shape[1], real + exist.numbers.shape[1]
        made += _four_bars(full, exist, pivots)
    is_family = len(choices) > 1 or len(full) > len(points)
    count = len(choices) * pairs.count
    what = "classes of cognates" if pivots == 0 else "linkages"
    complete = f"{found} of {count} {what}, {real} of them real"
    note = ""
    if is_family:
        complete = f"some of infinitely many: {complete}"
        added = len(full) - len(points)
        more = [count_phrase(pivots - len(ground), "fixed pivot")] if pivots > len(ground) else []
        more += [count_phrase(added, "point")] if added else []
        note = f"{' and '.join(more)} chosen beside the task"
    return Candidates(made, complete, note, is_family=is_family)


def mixed_positions(task: MixedTask) -> Candidates:
    """Return four-bars whose coupler takes poses and whose point goes through points besides (Alt-Burmester)."""
    z, u = np.asarray(task.z, dtype=complex), np.asarray(task.u, dtype=complex)
    places = np.concatenate([z, task.points])
    size = float(np.mean(np.abs(places[1:] - places[0])))
    d = (places[1:] - places[0]) / size
    pairs = pairs_through(DesignPositions(d, d.conj(), u[1:] / u[0], np.empty(0, dtype=complex)))
    exist = pairs.real()
    x, a, y, b = exist.numbers[0::2] * size
    made: list[Linkage] = []
    for k in range(exist.numbers.shape[1]):
        turned = np.concatenate([u, u[0] * exist.u[:, k]])
        ends = tuple(
            Dyad(RR, complex(fixed + z[0]), complex(joint / u[0]), None, float(abs(joint - fixed)))
            for fixed, joint in ((a[k], x[k]), (b[k], y[k]))
        )
        made += of_dyads(places, turned, [ends], task.link)  # type: ignore[list-item]
    complete = f"{pairs.numbers.shape[1]} of {pairs.count} pairs of dyads, {exist.numbers.shape[1]} of them real"
    return Candidates(made, complete)


def _pairs(points: Number, ground: tuple[complex, ...]) -> Pairs:
    """Return the pairs of dyads through points, in their own unit from the first."""
    size = _size(points)
    d, pivots = (points[1:] - points[0]) / size, (np.array(ground, dtype=complex) - points[0]) / size
    both = np.stack([pivots, pivots.conj()], axis=-1).ravel() if len(ground) else np.empty(0, dtype=complex)
    return pairs_through(DesignPositions(d, d.conj(), np.empty(0, dtype=complex), both))


def _size(points: Number) -> float:
    return float(np.mean(np.abs(points[1:] - points[0])))


def _four_bars(points: Number, pairs: Pairs, pivots: int) -> Iterator[Linkage]:
    """Yield the four-bars of pairs; where pivots are not both given, the cognates that have those given too."""
    x, a, y, b = pairs.numbers[0::2]
    with np.errstate(all="ignore"):  # no third pivot where both joints are one
        k = x / (x - y)
        c = a + k * (b - a)
        cognates = [(a, b, x, y), (a, c, a - x, (1.0 - k) * (a - x)), (c, b, k * (b - y), b - y)]
    size = _size(points)
    for one, two, first, second in cognates[: (3, 2, 1)[pivots]]:
        good = np.isfinite(one + two + first + second)
        places = (points[0] + size * part[good] for part in (one, two, first, second))
        yield from of_points(points, *places)


def _filled(points: Number, count: int) -> Number:
    """Return points with others between, on a smooth curve through them, until there are so many."""
    missing = count - len(points)
    if not missing:
        return points
    if len(points) == 2:  # a flat arc
        points = np.insert(points, 1, np.mean(points) + 0.2j * (points[1] - points[0]))
        missing -= 1
    from scipy.interpolate import CubicSpline

    course = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(points)))])
    curve = CubicSpline(course, points)
    for _ in range(missing):
        k = int(np.argmax(np.diff(course)))
        course = np.insert(course, k + 1, 0.5 * (course[k] + course[k + 1]))
    return np.asarray(curve(course), dtype=complex)


def _choices(task: PointTask, count: int) -> list[tuple[complex, ...]]:
    """Return fixed pivots to try, so many at a time, spread evenly around the points or over the region."""
    if not count:
        return [()]
    from scipy.stats import qmc

    tried = TRIED[count + len(task.conditions.ground)]
    region = task.conditions.region
    corners = task.points if region is None else region
    low, high = np.min(corners.real), np.max(corners.real)
    bottom, top = np.min(corners.imag), np.max(corners.imag)
    if region is None:
        around = AROUND * max(high - low, top - bottom)
        low, high, bottom, top = low - around, high + around, bottom - around, top + around
    found: list[tuple[complex, ...]] = []
    draws = qmc.Halton(2 * count, scramble=False).random(16 * tried + 1)[1:]
    for draw in draws:
        places = tuple(complex(low + (high - low) * s, bottom + (top - bottom) * t) for s, t in draw.reshape(count, 2))
        if all(task.conditions.holds(place) for place in places):
            found.append(places)
    return found[:tried]
