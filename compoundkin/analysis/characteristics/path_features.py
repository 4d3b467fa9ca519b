"""Features of a point's path: straight stretches, arcs of circles, cusps, and double points.

They are those of the longest part of the path that the point passes once. Lines and circles are fitted to many
stretches of it at once; the longest stretch within a tolerance is the answer.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from math import factorial
from typing import NamedTuple

import numpy as np

from compoundkin.analysis.characteristics.placed_figures import moving_drivers
from compoundkin.base.arguments import check_design, checked
from compoundkin.base.arrays import TURN, Number, cross, dot
from compoundkin.base.curves.samples import Samples, crossings
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.extremes.stretches import same_pose

# The least width as a function of the slope is convex and made of straight parts: cutting planes end on its least
# value after a few steps, mostly five to eight.
CUTS = 16
# Heights are found to this part of them.
LOWEST = 1e-7
# A stretch is judged by so many of its samples.
JUDGED = 33
# Stretches are first begun at every so many samples, then at all beside the best.
COARSE = 6
# Turned this often into the fitted direction: slopes are measured from there, which is exact for the last one.
ROUNDS = 2


class Fit(NamedTuple):
    """Lines or circles fitted to stretches.

    The `deviation` is the greatest distance of points on either side. Of a line `place` is a point and `direction` a
    unit vector; of a circle `place` is the centre, `radius` its own.
    """

    deviation: Number
    place: Number
    direction: Number
    radius: Number


def fitted_lines(points: Number, rounds: int = ROUNDS) -> Fit:
    """Fit the line of least greatest distance to stretches of points (..., count).

    One of the `rounds` is enough for stretches that are nearly straight.

    >>> fit = fitted_lines(np.array([0j, 1 + 1j, 2]))
    >>> float(fit.deviation), complex(fit.direction).real
    (0.5, 1.0)
    """
    middle = points.mean(axis=-1, keepdims=True)
    away = points - middle
    # the principal direction: the square root of the second moment
    along = np.sqrt(np.mean(away * away, axis=-1, keepdims=True))
    length = np.abs(along)
    along = np.where(length > 0, along / np.where(length > 0, length, 1.0), 1.0)
    along = np.where(along.real < 0, -along, along)
    for _ in range(rounds):
        turned = 1.0 + 1j * _flattest(away * np.conj(along))
        along = along * turned / np.abs(turned)
    across = cross(along, away)
    low, high = across.min(axis=-1), across.max(axis=-1)
    along = along[..., 0]
    place = middle[..., 0] + 0.5j * along * (low + high)
    return Fit(0.5 * (high - low), place, along, np.full(np.shape(low), np.inf))


def _flattest(z: Number) -> Number:
    """Return the slopes of the strips of least height around points, by cutting planes between -1 and 1."""
    x, y = (np.ascontiguousarray(part).reshape(-1, part.shape[-1]) for part in (z.real, z.imag))
    low, high = -np.ones((*x.shape[:-1], 1)), np.ones((*x.shape[:-1], 1))
    (f_low, g_low), (f_high, g_high) = _height(x, y, low), _height(x, y, high)
    slope = np.zeros_like(low)
    for _ in range(CUTS):
        with np.errstate(divide="ignore", invalid="ignore"):
            meet = (f_high - g_high * high - f_low + g_low * low) / (g_low - g_high)
        new = np.where(np.isfinite(meet), np.clip(meet, low, high), 0.5 * (low + high))
        slope = new
        f, g = _height(x, y, slope)
        # no strip is lower than where the planes from both sides meet
        if np.all(f - (f_low + g_low * (slope - low)) <= LOWEST * f):
            break
        left = g < 0
        low, f_low, g_low = np.where(left, slope, low), np.where(left, f, f_low), np.where(left, g, g_low)
        high, f_high, g_high = np.where(left, high, slope), np.where(left, f_high, f), np.where(left, g_high, g)
    return slope.reshape(*z.shape[:-1], 1)


def _height(x: Number, y: Number, slope: Number) -> tuple[Number, Number]:
    """Return the height of the strips of a slope around points, and its derivative by the slope."""
    above, rows = y - slope * x, np.arange(len(x))
    top, bottom = above.argmax(axis=-1), above.argmin(axis=-1)
    return (above[rows, top] - above[rows, bottom])[:, None], (x[rows, bottom] - x[rows, top])[:, None]


def fitted_circles(points: Number) -> Fit:
    """Fit circles to stretches of points (..., count).

    The squares of the points' powers are least. For points on a line the radius is infinite and the deviation NaN.
    Source: I. Kasa, A circle fitting procedure and its error analysis, IEEE Transactions on Instrumentation and
    Measurement 25 (1976) 8-14.

    >>> fit = fitted_circles(3j + 2 * np.exp(1j * np.linspace(0.1, 1.3, 20)))
    >>> round(float(fit.radius), 9), abs(complex(fit.place) - 3j) < 1e-9, bool(fit.deviation < 1e-9)
    (2.0, True, True)
    """
    middle = points.mean(axis=-1, keepdims=True)
    z = points - middle
    x, y, power = z.real, z.imag, np.abs(z) ** 2
    a, b, c = (np.mean(v, axis=-1) for v in (x * x, x * y, y * y))
    p, q = np.mean(x * power, axis=-1), np.mean(y * power, axis=-1)
    determinant = a * c - b * b
    with np.errstate(divide="ignore", invalid="ignore"):
        centre = 0.5 * ((c * p - b * q) + 1j * (a * q - b * p)) / determinant
        radii = np.abs(z - centre[..., None])
    low, high = radii.min(axis=-1), radii.max(axis=-1)
    return Fit(0.5 * (high - low), middle[..., 0] + centre, np.full(low.shape, np.nan + 0j), 0.5 * (low + high))


def longest_stretch(points: Number, closed: bool, tolerance: float, fit: Callable[[Number], Fit]) -> tuple[int, int]:
    """Return the first and last sample of the longest stretch that a fit meets within a tolerance.

    On a closed curve, without its first sample again at the end, the last index may run past the end.
    """
    around = np.concatenate([points, points]) if closed else points
    run = np.append(0.0, np.cumsum(np.abs(np.diff(around))))
    best, last = _longest_from(np.arange(0, len(points), COARSE), around, run, closed, tolerance, fit)
    near = np.arange(best - COARSE + 1, best + COARSE)
    near = near % len(points) if closed else near[(near >= 0) & (near < len(points))]
    finer = _longest_from(near, around, run, closed, tolerance, fit)
    return finer if run[finer[1]] - run[finer[0]] > run[last] - run[best] else (best, last)


def _longest_from(
    first: Number, around: Number, run: Number, closed: bool, tolerance: float, fit: Callable[[Number], Fit]
) -> tuple[int, int]:
    """Return the longest stretch of those that begin at some samples."""
    near = np.minimum(first + 2, len(around) - 1)
    far = first + len(around) // 2 - 1 if closed else np.full(len(first), len(around) - 1)
    far = np.maximum(far, near)
    while np.any(far > near):
        middle = (near + far + 1) // 2
        good = fit(around[_of(first, middle)]).deviation <= tolerance
        near, far = np.where(good, middle, near), np.where(good, far, middle - 1)
    fits = fit(around[_of(first, near)]).deviation <= tolerance
    best = int(np.argmax(np.where(fits, run[near] - run[first], -1.0)))
    return int(first[best]), int(near[best])


def _of(first: Number, last: Number) -> Number:
    """Return the indices of the samples by which stretches are judged, a row for each."""
    part = np.linspace(0.0, 1.0, JUDGED)
    return np.round(first[:, None] + (last - first)[:, None] * part).astype(int)


def projected(points: Number, fit: Fit) -> Number:
    """Return the coordinates of points along a fitted line."""
    return dot(fit.direction, points - fit.place)


# A path is a line or a circle if its samples deviate by less than this part of its extent.
EXACT = 1e-9
# Default tolerance of straight stretches and arcs, a part of the path's extent.
TOLERANCE = 1e-3
# A path that lies on itself has as many crossings as samples; a coupler curve of a four-bar, of order six, has three.
MOST_CROSSINGS = 60


@dataclass(frozen=True, eq=False)
class PathPlace:
    """A cusp, or a point that a path passes twice, with the drivers' values each time."""

    point: complex
    at: tuple[dict[str, float], ...]


@dataclass(frozen=True, eq=False)
class PathFeatures:
    """The features of the path of a point of one design over a motion, or its longest part without a gap.

    Straight stretches and arcs stay within the `tolerance`, a length. The path is `retraced` if the point turns back on
    it: then it is the path from one end to the other.
    """

    path: TracedPath
    point: str
    tolerance: float
    retraced: bool

    @property
    def size(self) -> float:
        """The diagonal of the box around the path."""
        return self.path.samples.size

    @property
    def closed(self) -> bool:
        """Whether the path is closed."""
        return self.path.closed

    @property
    def length(self) -> float:
        """The length of the path."""
        return self.path.length

    @cached_property
    def line(self) -> Stretch:
        """The whole path beside the line of least greatest distance."""
        return stretch_of(self.path, fitted_lines, 0, len(closed_samples(self.path)) - 1)

    @cached_property
    def circle(self) -> Stretch:
        """The whole path beside a circle."""
        return stretch_of(self.path, fitted_circles, 0, len(closed_samples(self.path)) - 1)

    @cached_property
    def is_straight(self) -> bool:
        """Whether it is a line within rounding."""
        return self.line.deviation <= EXACT * self.size

    @cached_property
    def is_circular(self) -> bool:
        """Whether it is a circle or an arc within rounding."""
        return not self.is_straight and self.circle.deviation <= EXACT * self.size

    @cached_property
    def straight(self) -> Stretch:
        """The longest stretch that is straight within the tolerance."""
        return self._longest(fitted_lines, partial(fitted_lines, rounds=1))

    @cached_property
    def arc(self) -> Stretch:
        """The longest stretch that is an arc of a circle within the tolerance."""
        return self._longest(fitted_circles, fitted_circles)

    @cached_property
    def cusps(self) -> tuple[PathPlace, ...]:
        """The places where the point stands still and its path turns sharply."""
        if self.is_straight or self.is_circular:
            return ()
        s, cusp = self.path.rests
        where, at = self.path.derivatives(s[cusp], 0)[0], self.path.drivers(*s[cusp])
        return tuple(PathPlace(complex(p), (drivers,)) for p, drivers in zip(where, at, strict=True))

    @cached_property
    def double_points(self) -> tuple[PathPlace, ...]:
        """The points that the path passes twice; empty for a path that lies on itself."""
        if self.is_straight or self.is_circular:
            return ()
        found = crossings(self.path.samples, self.path.expansion)
        known = found if len(found) <= MOST_CROSSINGS else ()
        at = self.path.drivers(*(s for c in known for s in (c.first, c.second)))
        return tuple(PathPlace(c.point, (at[2 * k], at[2 * k + 1])) for k, c in enumerate(known))

    def _longest(self, fit: Callable[[Number], Fit], judge: Callable[[Number], Fit]) -> Stretch:
        samples = self.path.samples
        return stretch_of(self.path, fit, *longest_stretch(samples.points, samples.closed, self.tolerance, judge))

    def __repr__(self) -> str:
        kind = "a line" if self.is_straight else "a circle" if self.is_circular else "a curve"
        ends = "closed" if self.closed else "open"
        features = f"{len(self.cusps)} cusps, {len(self.double_points)} double points"
        return f"PathFeatures({self.point}: {kind}, {ends}, {self.length:.6g} long, {features})"


def simple_shape(motion: Motion, point: str, design: int = 0) -> str:
    """Return, from the poses alone, "line" or "circle" for such a path within rounding, else "".

    >>> import compoundkin as ck
    >>> simple_shape(ck.solve(ck.load("slider-crank")), "A")
    'circle'
    """
    rows = np.asarray(motion.points[point].position).reshape(motion.inputs.designs, motion.inputs.poses)[design]
    points = rows[np.isfinite(rows)]
    if len(points) < 3:
        return "line"
    size = float(np.hypot(np.ptp(points.real), np.ptp(points.imag)))
    if not fitted_lines(points).deviation > EXACT * size:
        return "line"
    return "circle" if fitted_circles(points).deviation <= EXACT * size else ""


@checked
def path_features(motion: Motion, point: str, tolerance: float | None = None, design: int = 0) -> PathFeatures:
    """Return the features of a point's path: straight stretches, arcs, cusps, double points.

    Stretches are within `tolerance`, a length, by default 1/1000 of the path's extent. For a motion with gaps it is the
    path over the longest assembled part. Loops and stretches shorter than 1/360 of it may be missed. Raises UnknownName
    for an unknown point, InvalidInput for one that does not move.

    >>> import compoundkin as ck
    >>> found = path_features(ck.solve(ck.load("rolling-wheel")), "P")    # a cycloid
    >>> [round(cusp.point.real / np.pi, 9) for cusp in found.cusps], found.double_points
    ([4.0], ())
    """
    if tolerance is not None and not tolerance > 0:
        raise InvalidInput(Problem("tolerance", f"{tolerance:g} is no length of a deviation", "give one above zero"))
    path, retraced = longest_simple_path(motion, point, design)
    return PathFeatures(path, point, TOLERANCE * path.samples.size if tolerance is None else tolerance, retraced)


# A driver's value within this (radians, or parts of the size) of an end of its range is at the end: rounding of
# degrees.
AT_END = 1e-9


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of a path near a line or a circle. A line has an infinite `radius`, and `centre` is a point on it.

    `begin` and `end` are the drivers' values at its ends (radians or lengths), `deviation` the greatest distance from
    the line or circle on either side, `length` the extent along the line or the arc, `ends` its first and last point.
    """

    begin: dict[str, float]
    end: dict[str, float]
    ends: tuple[complex, complex]
    length: float
    deviation: float
    direction: complex
    centre: complex
    radius: float

    @property
    def is_straight(self) -> bool:
        """Whether it is fitted by a line."""
        return not np.isfinite(self.radius)

    @property
    def straightness(self) -> float:
        """The width of the strip around it, as a part of its length."""
        return 2.0 * self.deviation / self.length

    def __repr__(self) -> str:
        kind = "line" if self.is_straight else f"circle of radius {self.radius:.6g}"
        where = "; ".join(f"{name} {a:.6g} to {self.end[name]:.6g}" for name, a in self.begin.items())
        return f"Stretch({self.length:.6g} long within {self.deviation:.2g} of a {kind}, {where})"


def stretch_of(path: TracedPath, fit: Callable[[Number], Fit], first: int, last: int) -> Stretch:
    """Return the stretch of a path between two samples, which on a closed path count on beyond the end."""
    samples = path.samples
    points = samples.points[np.arange(first, last + 1) % len(samples.points)]
    found = fit(points)
    if not np.isfinite(found.radius):
        found = fitted_lines(points)  # no circle goes through points on a line
    radius = float(found.radius)
    if np.isfinite(radius):
        length = radius * float(np.ptp(np.unwrap(np.angle(points - found.place))))
    else:
        length = float(np.ptp(projected(points, found)))
    begin = float(samples.s[0]) + first * samples.step
    at, until = path.drivers(begin, begin + (last - first) * samples.step)
    ends = complex(points[0]), complex(points[-1])
    line = complex(found.direction), complex(found.place)
    return Stretch(at, until, ends, length, float(found.deviation), *line, radius)


@checked
def straightness(motion: Motion, point: str, begin: float, end: float, design: int = 0) -> Stretch:
    """Return the fit of a line to a point's path between two values of the only moving driver (radians or length).

    The line is that of least greatest distance. Raises as
    `path_features`, and InvalidInput for values outside.

    >>> import compoundkin as ck
    >>> motion = ck.solve(ck.load("hoecken-straight-line"))
    >>> stretch = straightness(motion, "P", *ck.deg([90, 270]))
    >>> round(100 * stretch.straightness, 2)
    0.24
    """
    path, _ = longest_simple_path(motion, point, design, whole=True)
    drives = moving_drivers(motion, design)
    if len(drives) != 1:
        what = f"{len(drives)} drivers move ({', '.join(drives) or 'none'})"
        raise InvalidInput(Problem("begin, end", what, "a stretch is named by the values of the only one that does"))
    first, last = sorted(_place_of(path, value, drives[0]) for value in (begin, end))
    part = path.part(first, last)
    return stretch_of(part, fitted_lines, 0, len(part.samples.points) - 1)


def _place_of(path: TracedPath, value: float, driver: str) -> float:
    """Return the place along a path at which the driver has a value."""
    poses = np.arange(round(path.first), round(path.last) + 1)
    values = np.array([at[driver] for at in path.drivers(poses[0], poses[-1])])
    slack = AT_END * path.motion.solving_order.unit(driver)
    inside = min(values) - slack <= value <= max(values) + slack
    if not inside or values[0] == values[1]:
        span = f"{driver} goes from {values[0]:g} to {values[1]:g}"
        raise InvalidInput(Problem("begin, end", f"{value:g} is outside: {span}", "give values between (radians)"))
    rows = np.broadcast_to(path.motion.inputs.drives[driver][0], path.motion.failed.shape)[path.design, poses]
    way = np.sign(values[1] - values[0])
    return float(np.interp(way * value, way * rows, poses))


# --- the path itself ------------------------------------------------------------------------------------------------


# A point moves if its path is longer than this part of the mechanism: rounding over groups.
MOVES = 1e-9


def longest_simple_path(motion: Motion, point: str, design: int = 0, whole: bool = False) -> tuple[TracedPath, bool]:
    """Return the longest part of a point's path that it passes once, and whether it turns back there.

    On it no driver turns back, nor, unless `whole`, the point.
    """
    check_design(design, motion.inputs.designs)
    if point not in motion.mechanism.carriers:
        letters = list(motion.mechanism.carriers)
        raise UnknownName(Problem(point, "there is no such point", suggestion(point, letters)))
    if not motion.inputs.is_rigid:
        what = "dimensions change along the motion: its poses are of different mechanisms"
        raise InvalidInput(Problem(point, what, "solve one design over its driver's values"))
    found = [TracedPath(motion, design, point, a, b, closed) for a, b, closed in monotonic_stretches(motion, design)]
    if not found:
        raise InvalidInput(Problem(point, "no driver moves between two assembled poses", "solve(...) at several poses"))
    longest = max(found, key=lambda path: path.samples.size)
    if not longest.samples.size > MOVES * motion.size:
        raise InvalidInput(Problem(point, "the point does not move", "name a point of a moving link"))
    return (longest, False) if whole else _simple_part(longest)


def _simple_part(path: TracedPath) -> tuple[TracedPath, bool]:
    """Return the longest part between places where a point turns back on its path, and whether it does."""
    s, still = path.rests
    turns = s[~still]
    if not len(turns):
        return path, False
    cuts = np.append(turns, turns[0] + path.period) if path.closed else np.array([path.first, *turns, path.last])
    parts = [path.part(float(a), float(b)) for a, b in pairwise(cuts) if b - a > path.samples.step]
    return max(parts, key=lambda part: part.samples.size), True


# Approximate number of samples of a path: shorter loops and stretches may be missed.
SAMPLES = 360
# Poses that differ by less than this part of the size are equal: rounding of a full turn of many groups.
SAME = 1e-9
# A point stands still below this part of its greatest speed: books print dimensions of cusps to six digits.
STANDS = 1e-6
# Beside a place of rest the distance of samples is below this part of the greatest.
SLOW = 0.3
# Newton from the middle of the shortest way: its error is squared with every step.
STEPS = 6


@dataclass(frozen=True, eq=False)
class TracedPath:
    """The path of a point of one design between two places along the motion, the first pose at place 0.

    A `closed` path is that of a full cycle. A part of it may run beyond the last pose: `cycle` is then the first place
    of the cycle and its length.
    """

    motion: Motion
    design: int
    point: str
    first: float
    last: float
    closed: bool = False
    cycle: tuple[float, float] | None = None

    def derivatives(self, s: Number, order: int) -> list[Number]:
        """Return the point and its derivatives by the place, at places. The drivers run evenly between two poses."""
        s = np.asarray(s, dtype=float)
        if not s.size:
            return [np.empty(s.shape, dtype=complex)] * (order + 1)
        found = between(self.motion, self.design, self._inside(np.ravel(s)), order, by_place=True).points[self.point]
        return [np.asarray(found.derivative(k)).reshape(s.shape) for k in range(order + 1)]

    def drivers(self, *s: float) -> tuple[dict[str, float], ...]:
        """Return the drivers' values at each of some places."""
        if not s:
            return ()
        found = between(self.motion, self.design, self._inside(np.array(s, dtype=float)), 0)
        values = {name: np.broadcast_to(drive.value, len(s)).tolist() for name, drive in found.drives.items()}
        return tuple({name: of[k] for name, of in values.items()} for k in range(len(s)))

    def _inside(self, s: Number) -> Number:
        """Return places within the motion; the end of a cycle stays."""
        around = self.cycle or ((self.first, self.period) if self.closed else None)
        if around is None:
            return np.clip(s, 0.0, self.motion.inputs.poses - 1.0)
        first, length = around
        return np.where((s > first + length) | (s < first), first + (s - first) % length, s)

    def expansion(self, s: Number, order: int) -> tuple[Number, ...]:
        """Return the Taylor coefficients of the path at places."""
        return tuple(c / factorial(k) for k, c in enumerate(self.derivatives(s, order)))

    @property
    def period(self) -> float:
        """The number of poses along the path."""
        return self.last - self.first

    @cached_property
    def samples(self) -> Samples:
        """Points at equally spaced places, every pose among them; of a closed path without the last."""
        s, points, _ = self._sampled
        return Samples(s, points, self.closed)

    @cached_property
    def _sampled(self) -> tuple[Number, Number, Number]:
        """Places, the points there, and their speeds by the place."""
        poses = round(self.period)
        count = 2 * (max(poses, 1) * max(1, -(-SAMPLES // (2 * max(poses, 1))))) + 1
        s = np.linspace(self.first, self.last, count)
        s = s[:-1] if self.closed else s
        points, rates = self.derivatives(s, 1)
        return s, points, np.abs(rates)

    @cached_property
    def length(self) -> float:
        """The length of the path, by Simpson's rule, around a cycle by the more accurate trapezoidal rule."""
        speed, step = self._sampled[2], self.samples.step
        if self.closed:
            return float(np.sum(speed) * step)
        return float(step / 3.0 * (4.0 * np.sum(speed[1::2]) + 2.0 * np.sum(speed[::2]) - speed[0] - speed[-1]))

    @cached_property
    def rests(self) -> tuple[Number, Number]:
        """The places where the point stands still, and which of them are cusps.

        At a cusp acceleration and jerk have different directions; with a common direction the point retraces its path.
        """
        step, chords = self.samples.step, np.abs(np.diff(closed_samples(self)))
        fastest = float(np.nanmax(chords)) / step
        if self.closed:
            before, after = np.roll(chords, 1), np.roll(chords, -1)
        else:
            before, after = np.append(np.inf, chords[:-1]), np.append(chords[1:], np.inf)
        slow = np.flatnonzero((chords <= before) & (chords <= after) & (chords < SLOW * fastest * step))
        s = self._slowest(self.samples.s[0] + (slow + 0.5) * step)
        if not s.size:
            return s, np.empty(0, dtype=bool)
        _, v, a, j = self.derivatives(s, 3)
        still = np.abs(v) <= STANDS * fastest
        bend = np.abs(cross(a, j)) > STANDS * np.abs(a) * (np.abs(j) + np.abs(a) ** 2 / fastest)
        return self._distinct(s[still], bend[still])

    def _slowest(self, start: Number) -> Number:
        """Return the slowest places near those where the point may stop."""
        step = self.samples.step
        if start.size:
            _, v, a = self.derivatives(start, 2)
            # it may stop if its acceleration brings it to rest within two samples
            start = start[np.abs(v) <= 2.0 * step * np.abs(a)]
        s = start
        for _ in range(STEPS if start.size else 0):
            _, v, a, j = self.derivatives(s, 3)
            with np.errstate(divide="ignore", invalid="ignore"):
                change = dot(v, a) / (np.abs(a) ** 2 + dot(v, j))
            s = np.clip(np.where(np.isfinite(change), s - change, s), start - 1.5 * step, start + 1.5 * step)
            s = s if self.closed else np.clip(s, self.first, self.last)
        return s

    def _distinct(self, s: Number, cusp: Number) -> tuple[Number, Number]:
        """Return distinct places in order, without those found from both sides."""
        s = self.first + (s - self.first) % self.period if self.closed else s
        s, index = np.unique(s, return_index=True)
        before = s[-1:] - self.period if self.closed else s[:1] - np.inf
        apart = (np.diff(s, prepend=before) > 0.5 * self.samples.step) | (len(s) == 1)
        return s[apart], cusp[index][apart]

    def part(self, first: float, last: float) -> TracedPath:
        """Return a part of the path."""
        cycle = (self.first, self.period) if self.closed else self.cycle
        return replace(self, first=first, last=last, closed=False, cycle=cycle)


def closed_samples(path: TracedPath) -> Number:
    """Return the samples of a path, of a closed one with the first again at the end."""
    points = path.samples.points
    return np.append(points, points[0]) if path.closed else points


# A full turn within rounding, in turns.
LACKS = 1e-9


def monotonic_stretches(motion: Motion, design: int) -> Iterator[tuple[int, int, bool]]:
    """Yield stretches of assembled poses along which no driver turns back: first pose, last pose, whether a cycle.

    Of drivers that turn on after a cycle only the first cycle counts.

    >>> import compoundkin as ck
    >>> list(monotonic_stretches(ck.solve(ck.load("crank-rocker")), 0))
    [(0, 72, True)]
    """
    drives = _driven(motion, design)
    sense = np.sign(np.diff(drives, axis=1))
    for begin, end in _runs(motion, design):
        turns_back = 1 + np.flatnonzero(np.any(np.diff(sense[:, begin:end], axis=1) != 0.0, axis=0))
        cuts = [begin, *(begin + turns_back).tolist(), end]
        for first, last in pairwise(cuts):
            if last > first and np.any(sense[:, first]):
                yield _first_cycle(motion, design, drives, first, last)


def _runs(motion: Motion, design: int) -> Iterator[tuple[int, int]]:
    """Yield the first and the last pose of each run of assembled poses."""
    good = np.broadcast_to(motion.failed == 0, (motion.inputs.designs, motion.inputs.poses))[design]
    edge = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(np.int8), [0]])))
    yield from zip(edge[::2].tolist(), (edge[1::2] - 1).tolist(), strict=True)


def _driven(motion: Motion, design: int) -> Number:
    """Return the values of the drivers of a design, (drivers, poses)."""
    shape = motion.inputs.designs, motion.inputs.poses
    return np.array([np.broadcast_to(v[0], shape)[design] for v in motion.inputs.drives.values()])


def _first_cycle(motion: Motion, design: int, drives: Number, first: int, last: int) -> tuple[int, int, bool]:
    """Return a stretch up to the first cycle: all links are back, and all turning drivers have turned fully."""
    gone = np.abs(drives[:, first : last + 1] - drives[:, first : first + 1])
    moving = gone[:, -1] > 0
    if all(one.is_angle for one, moves in zip(motion.drives.values(), moving, strict=True) if moves):
        turns = np.floor(gone[moving] / TURN + LACKS).min(axis=0)
        for k in (first + 1 + np.flatnonzero(np.diff(turns) > 0)).tolist():
            if same_pose(motion, first, k)[design]:
                return first, k, True
    return first, last, False
