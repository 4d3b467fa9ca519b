"""Contacts of followers with profiles, found at every pose of a call by themselves, as `solve` finds them.

Where the path of a follower crosses the sampled profile its contact is known nearly. From there Newton's steps go on
both numbers at once, the follower's coordinate and the profile's parameter, on polynomials that are the profile. What
is not surely the contact that `solve` would find is left to it: one near a limit position or an end of the profile,
one of several equally near, one that Newton does not reach.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from math import comb
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.curves import Curve
from compoundkin.base.display import ShortRepr
from compoundkin.base.series import constant
from compoundkin.kinematics.groups import GroupSolver
from compoundkin.model.pairs.profile_contact import (
    BATCH,
    THINNED,
    Approach,
    PointPath,
    ProfileContact,
    as_profile_contact,
    nearest_angle,
)
from compoundkin.programs.call_numbers import CallNumbers, ReadyProgram
from compoundkin.programs.graph.operation_graph import PARAMETER, SEED, InputNumber, OperationGraph, group_seed
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_limits import RecordedLimits
from compoundkin.programs.recording.recorded_number import RecordedNumber

# Polynomials of this degree, each about the middle of its stretch, stand for a curve.
DEGREE = 12
# They reproduce its Taylor coefficients 0 .. 3 to such parts of its size (by the parameter as an angle).
EXACT = np.array([1e-15, 2e-15, 5e-15, 2e-13])
# Where in a stretch that is tried; no stretch is shorter than this part of the whole, and there are about so many at
# most.
TRIED, SHORTEST = np.array([-1.0 + 1e-9, -0.75, -0.25, 0.25, 0.75, 1.0 - 1e-9]), 1e-5
MOST_STRETCHES = 4096


class CurvePolynomials(NamedTuple):
    """A curve as polynomials between the breaks of its derivatives.

    Stretches lie between `edges`; the Taylor `coefficients` about the middle of each are (DEGREE + 1, stretches). They
    `are_exact` where all reproduce it as they should.
    """

    edges: Number
    coefficients: Number
    are_exact: bool

    @classmethod
    def of(cls, curve: Curve, exact: Number = EXACT) -> CurvePolynomials:
        """Return polynomials that reproduce a curve to some parts of its size: stretches are halved until they do.

        >>> from compoundkin.base.curves import Analytic
        >>> from compoundkin.base.series import Series
        >>> circle = CurvePolynomials.of(Analytic(Series.turn, 0.0, 2.0 * np.pi, closed=True))
        >>> bool(abs(circle.coefficients[0] - np.exp(0.5j * (circle.edges[1:] + circle.edges[:-1]))).max() < 1e-15)
        True
        """
        inner = sorted(at for at in curve.breaks if curve.low < at < curve.high)
        low, high = np.array([*pairwise([curve.low, *inner, curve.high])]).T
        width, points = curve.high - curve.low, curve.samples.points
        unit = (width / (2.0 * np.pi)) ** np.arange(len(exact)) / curve.size
        # of a curve far from its origin more digits are rounding
        exact = exact * max(1.0, float(np.max(np.abs(points))) / curve.size)
        starts, found, are_exact = list[Number](), list[Number](), True
        while low.size:
            middle = 0.5 * (low + high)
            known, away = np.array(curve.expansion(middle, DEGREE)), 0.5 * (high - low) * TRIED[:, None]
            trial = np.array([_coefficient(known, k, away) for k in range(len(exact))])
            off = np.max(np.abs(np.array(curve.expansion(middle + away, len(exact) - 1)) - trial), axis=1)
            good = np.all(off * unit[:, None] <= exact[:, None], axis=0)
            done = good | (high - low < SHORTEST * width) | (sum(map(len, starts)) + len(low) > MOST_STRETCHES)
            are_exact = are_exact and bool(good[done].all())
            starts.append(low[done])
            found.append(known[:, done])
            low, middle, high = (each[~done] for each in (low, middle, high))
            low, high = np.append(low, middle), np.append(middle, high)
        order = np.argsort(np.concatenate(starts))
        edges = np.append(np.concatenate(starts)[order], curve.high)
        return cls(edges, np.concatenate(found, axis=1)[:, order], are_exact)


def _coefficient(known: Sequence[Number] | Number, k: int, away: Number) -> Number:
    """Return the Taylor coefficient of an order away from where coefficients are known."""
    found: Number = 0.0
    for n in range(len(known) - 1, k - 1, -1):
        found = found * away + comb(n, k) * known[n]
    return found


class StretchEdges(NamedTuple):
    """The edges between stretches of a curve, which at a break has the derivatives of one side.

    `places` is where each edge is, `are_breaks` which are breaks. Stretches after the first one begin at `starts`: just
    behind an edge that has the derivatives of the stretch before it.
    """

    places: Number
    are_breaks: Number
    starts: Number


class FollowerPath(NamedTuple):
    """The path of a follower past its profile at some poses, as `Approach` has it.

    `start`, `centre` and `toward` are arrays (poses,) in the profile's frame.
    """

    straight: bool
    start: Number
    centre: Number
    toward: Number
    sense: float
    is_greatest: bool

    def part(self, which: slice) -> FollowerPath:
        """Return it at some of the poses."""
        return self._replace(start=self.start[which], centre=self.centre[which], toward=self.toward[which])


class ContactStart(NamedTuple):
    """Where contacts are nearly, at some poses: the coordinate, the parameter.

    `far` is how far from there the parameter may be; it is `sure` where no other contact is close by, `alone` where a
    path comes out of the profile's surroundings nowhere else.
    """

    coordinate: Number
    parameter: Number
    far: Number
    sure: Number
    alone: Number


# Newton's steps of one round, and rounds: a step that leaves its stretch is begun anew in the next one.
STEPS, ROUNDS = 3, 3
# After a last step below this (of the parameter's range, radians or the profile's size) what is left is rounding.
LAST = 1e-9
# A place is an edge of a stretch but for rounding within this part of the range, as in searches.
AT_EDGE = 4e-15
# So much farther from a break it is a matter of rounding on which side a search ends.
BESIDE = 250.0
# Contacts with so many samples between them, or fewer, are near a limit position.
APART = 2
# Next to where a parallel curve turns back, or a face lies on a straight profile, contacts have few digits.
BENT = 1e-3


@dataclass(frozen=True, eq=False, repr=False)
class SearchedProfile(ShortRepr):
    """A profile with what the contacts of its followers are searched by."""

    pair: ProfileContact
    orders: int  # of the Taylor coefficients at contacts
    backend: str | None
    _programs: dict[Any, ReadyProgram[str]] = field(default_factory=dict)
    _known_columns: dict[bool, Number] = field(default_factory=dict)

    @cached_property
    def polynomials(self) -> CurvePolynomials:
        """The profile."""
        return CurvePolynomials.of(self.pair.curve)

    @cached_property
    def _rows(self) -> Number:
        """The coefficients of its polynomials, real parts and then imaginary ones, and the middles of stretches."""
        edges, coefficients, _ = self.polynomials
        return np.concatenate([coefficients.real, coefficients.imag, 0.5 * (edges[1:] + edges[:-1])[None]])

    @cached_property
    def _middle(self) -> complex:
        """The mean of its samples: what is far from the origin has few digits."""
        return complex(np.mean(self.pair.samples.places))

    @cached_property
    def _around(self) -> tuple[Number, Number, Number]:
        """Parameters, points about the middle, and normals of samples; of a closed one the first again at the end."""
        (s, places, normals), curve = self.pair.samples, self.pair.curve
        if self.pair.turns:
            s = np.append(s, s[0] + curve.high - curve.low)
            places, normals = np.append(places, places[0]), np.append(normals, normals[0])
        return s, places - self._middle, normals

    @cached_property
    def _is_convex(self) -> bool:
        """Whether a face touches it at one place only: all its samples are on its hull."""
        return bool(self.pair.turns) and len(self.pair.samples.s) == len(self.pair.curve.samples.s[::THINNED])

    @cached_property
    def _sharpest(self) -> float:
        """Its greatest curvature."""
        return float(np.max(np.abs(self.pair.curve.curvature(self.pair.curve.samples.s))))

    def found(self, path: FollowerPath) -> tuple[Number, Number, Number, Number]:
        """Return coordinates, parameters, Taylor coefficients (2, orders + 1, poses), and where they are sure."""
        step, count = max(1, 4 * BATCH // len(self._around[0])), len(path.start)
        if count <= step:
            return self._found(path)
        parts = [self._found(path.part(slice(first, first + step))) for first in range(0, count, step)]
        coordinate, parameter, coefficients, sure = zip(*parts, strict=True)
        return (
            np.concatenate(coordinate),
            np.concatenate(parameter),
            np.concatenate(coefficients, axis=2),
            np.concatenate(sure),
        )

    def _found(self, path: FollowerPath) -> tuple[Number, Number, Number, Number]:
        start = self._touched(path) if path.straight and self.pair.is_flat else self._crossed(path)
        curve, (coordinate, parameter) = self.pair.curve, start[:2]
        edges, width = self.polynomials.edges, curve.high - curve.low
        parameter, stretch, _ = self._placed(parameter)
        for _ in range(ROUNDS):
            rows = self._rows[:, stretch]
            found = self._stepped(path, coordinate, parameter - rows[-1], rows)
            coordinate, last, bend, before = found[0], found[2], found[3], stretch
            parameter, stretch, is_beside = self._placed(rows[-1] + found[1])
            is_last = (stretch == before) & (last <= LAST)
            if is_last.all():
                break
        away = np.abs(parameter - start.parameter)
        away = np.minimum(away, width - away) if curve.closed else away
        sure = start.sure & is_last & ~is_beside & (away <= start.far) & (bend > BENT)
        if not curve.closed:
            sure &= (parameter > edges[0]) & (parameter < edges[-1])
        coefficients = np.array(found[4:]).reshape(2, self.orders + 1, -1)
        if np.any(doubtful := self._may_touch_elsewhere(path, start) & sure):
            sure = sure & ~(doubtful & self._touches_elsewhere(path, coordinate, coefficients[:, 0]))
        return coordinate, curve.wrapped(parameter), coefficients, sure

    def _placed(self, parameter: Number) -> tuple[Number, Number, Number]:
        """Return parameters within the period, their stretches, and which are beside a break but not on it.

        Those next to an edge are the edge: derivatives there are those of the stretch that has it.
        """
        edges, parameter = self.polynomials.edges, self.pair.curve.wrapped(parameter)
        nearest = np.searchsorted(self._rows[-1], parameter)
        away, near = np.abs(parameter - edges[nearest]), AT_EDGE * (edges[-1] - edges[0])
        parameter = np.where(away < near, self._edges.places[nearest], parameter)
        is_beside = self._edges.are_breaks[nearest] & (away >= 0.5 * near) & (away < BESIDE * near)
        return parameter, np.searchsorted(self._edges.starts, parameter, side="right"), is_beside

    @cached_property
    def _edges(self) -> StretchEdges:
        (edges, coefficients, _), curve = self.polynomials, self.pair.curve
        places, are_breaks = edges.copy(), np.isin(edges, curve.breaks)
        if curve.closed:
            are_breaks[-1] = are_breaks[0]
            places[-1] = edges[0]
        at, half = places[:-1], 0.5 * np.diff(edges)
        order = range(len(EXACT))
        own = np.array(curve.expansion(at, len(EXACT) - 1))
        first, last = (np.array([_coefficient(coefficients, k, half * sign) for k in order]) for sign in (-1.0, 1.0))
        scale = half ** np.array(order)[:, None]
        off_start = np.max(np.abs(own - first) * scale, axis=0)
        off_end = np.max(np.abs(own - np.roll(last, 1, axis=1)) * scale, axis=0)
        is_end = are_breaks[:-1] & (off_end < off_start)
        starts = np.where(is_end, np.nextafter(edges[:-1], np.inf), edges[:-1])[1:]
        if is_end[0] and curve.closed:
            places[[0, -1]] = edges[-1]
        return StretchEdges(places, are_breaks, starts)

    def _crossed(self, path: FollowerPath) -> ContactStart:
        """Return where a path crosses the sampled profile, or its parallel, as `extreme_contacts` finds it."""
        levels = self._levels(path)
        below = levels <= 0.0
        poses, sides = levels.shape[0], levels.shape[1] - 1
        crossed = np.flatnonzero(below[:, 1:] != below[:, :-1])
        pose, side = crossed // sides, crossed % sides
        counts = np.bincount(pose, minlength=poses)
        first = np.cumsum(counts) - counts
        chosen, share, sure = np.zeros(poses, dtype=int), np.zeros(poses), np.zeros(poses, dtype=bool)
        for count in np.unique(counts).tolist() if poses > 1 else [len(side)]:
            if count:
                rows = np.flatnonzero(counts == count)
                own = side[first[rows, None] + np.arange(count)]
                chosen[rows], share[rows], sure[rows] = self._outermost(path, rows, own, levels)
        s, places, normals = self._around
        parameter = s[chosen] + share * (s[chosen + 1] - s[chosen])
        place, normal = (each[chosen] + share * (each[chosen + 1] - each[chosen]) for each in (places, normals))
        coordinate = self._coordinate(path, place, normal) * (path.sense if self.pair.is_flat else 1.0)
        return ContactStart(coordinate, parameter, 1.5 * (s[chosen + 1] - s[chosen]), sure, counts <= 2)

    def _levels(self, path: FollowerPath) -> Number:
        """Return how far samples are from what is sought, (poses, samples): products of what is known of both."""
        start, centre = path.start - self._middle, path.centre
        if path.straight:
            # (p + n toward - start) across the path
            away, x, y = path.toward, centre.real, centre.imag
            rows: tuple[Number, ...] = x, x * away, -y, -y * away, -cross(centre, start)
        elif self.pair.is_flat:
            # the normal of a sample with (p - centre), less that of the face with its point
            centre = centre - self._middle
            rows = np.ones(len(start)), -centre.real, -centre.imag, -dot(path.toward, start - centre)
        else:
            # |p + n toward - centre|^2 - |start - centre|^2
            centre, away = centre - self._middle, path.toward
            arm, x, y = start - centre, -2.0 * centre.real, -2.0 * centre.imag
            rest = away * away + dot(centre, centre) - dot(arm, arm)
            rows = np.ones(len(start)), 2.0 * away, x, y, away * x, away * y, rest
        levels = np.array(rows).T @ self._columns(path.straight)
        if self.pair.turns:
            # the same sample at both ends, where a product may be rounded otherwise
            levels[:, -1] = levels[:, 0]
        return levels

    def _columns(self, straight: bool) -> Number:
        """Return what levels know of samples, (numbers, samples)."""
        if straight not in self._known_columns:
            _, places, normals = self._around
            ones = np.ones(len(places))
            if straight:
                columns: tuple[Number, ...] = places.imag, normals.imag, places.real, normals.real, ones
            elif self.pair.is_flat:
                columns = dot(normals, places), normals.real, normals.imag, ones
            else:
                columns = (dot(places, places), dot(places, normals), places.real, places.imag, normals.real,
                           normals.imag, ones)  # fmt: skip
            self._known_columns[straight] = np.array(columns)
        return self._known_columns[straight]

    def _outermost(self, path: FollowerPath, rows: Number, sides: Number, levels: Number) -> tuple[Number, ...]:
        """Return which of several crossings is the outermost of a path, where in its side, and where that is sure.

        `sides` are those of some poses `rows`, (rows, crossings).
        """
        before, after = levels[rows[:, None], sides], levels[rows[:, None], sides + 1]
        share = before / (before - after)
        count = sides.shape[1]
        sure = np.ones(len(rows), dtype=bool)
        if count == 1:
            return sides[:, 0], share[:, 0], sure
        sure = np.all(np.diff(sides, axis=1) > APART, axis=1)
        if self.pair.turns:
            sure &= sides[:, 0] + levels.shape[1] - 1 - sides[:, -1] > APART
        slope = 0.0 if path.straight else -self.pair.turns if self.pair.is_flat else self.pair.turns * path.sense
        if count == 2 and slope:
            # the only two on a circle, where there is no least one
            is_own = (after > before) == ((slope > 0.0) != path.is_greatest)
            sure &= is_own[:, 0] != is_own[:, 1]
            best = np.argmax(is_own, axis=1)
        else:
            _, places, normals = self._around
            place, normal = (each[sides] + share * (each[sides + 1] - each[sides]) for each in (places, normals))
            own = path._replace(**{name: getattr(path, name)[rows, None] for name in ("start", "centre", "toward")})
            found = self._coordinate(own, place, normal)
            best = np.argmax(found, axis=1) if path.is_greatest else np.argmin(found, axis=1)
        each = np.arange(len(rows))
        return sides[each, best], share[each, best], sure

    def _coordinate(self, path: FollowerPath, place: Number, normal: Number) -> Number:
        """Return the coordinate of a sample's place on a path, of a face without the sense of the path."""
        if self.pair.is_flat:
            middle = self._middle
            return nearest_angle(normal / path.toward, (path.centre - middle) / path.toward)
        start, centre = path.start - self._middle, path.centre if path.straight else path.centre - self._middle
        return PointPath(path.straight, start, centre, path.sense).coordinate(place + normal * path.toward, 0j)

    def _touched(self, path: FollowerPath) -> ContactStart:
        """Return where a face that does not turn touches: at the sample that is farthest toward it."""
        samples = self.pair.curve.samples
        known = np.isfinite(path.toward)
        parameter = samples.s[samples.outermost(np.where(known, path.toward, 1.0))]
        return ContactStart(np.zeros(len(known)), parameter, np.full(len(known), 1.5 * samples.step), known, known)

    def _stepped(self, path: FollowerPath, coordinate: Number, away: Number, rows: Number) -> list[Number]:
        """Return what Newton's steps lead to, by numbers at poses; see `_recorded`."""
        key = path.straight, path.sense
        if key not in self._programs:
            self._programs[key] = self._recorded(path)
        program = self._programs[key]
        numbers = {"x": path.start.real, "y": path.start.imag, "cx": path.centre.real, "cy": path.centre.imag,
                   "tx": path.toward.real, "ty": path.toward.imag, "coordinate": coordinate, "away": away}  # fmt: skip
        given = [
            rows[int(one.part), None] if one.part else numbers[one.name][None]
            for one in (program.flat.graph.nodes[k].given for k in program.flat.given)
            if one is not None
        ]
        return [one[0] for one in program.computed(given, (1, len(coordinate)))]

    def _recorded(self, path: FollowerPath) -> ReadyProgram[str]:
        """Record Newton's steps to the contact.

        Results are the coordinate, the parameter from the middle of the stretch on, the last step, how the contact is
        bent, and the Taylor coefficients there.
        """
        graph = OperationGraph()
        given = [InputNumber(PARAMETER, name) for name in ("x", "y", "cx", "cy", "tx", "ty", "coordinate", "away")]
        parts = [InputNumber(PARAMETER, "row", str(k)) for k in range(2 * (DEGREE + 1))]
        number = RecordedNumber.given
        start, centre, toward = (number(graph, *given[k : k + 2]) for k in (0, 2, 4))
        curve = [number(graph, parts[k], parts[k + DEGREE + 1]) for k in range(DEGREE + 1)]
        own = path._replace(start=start, centre=centre, toward=toward if self.pair.is_flat else toward.real)
        step = _face_step if self.pair.is_flat else _roller_step
        now: tuple[Any, ...] = number(graph, given[6]), number(graph, given[7])
        for _ in range(STEPS):
            local = [_coefficient(curve, k, now[1]) for k in range(3)]
            turned, moved, bend = step(own, now[0], local)
            now = now[0] + turned, now[1] + moved
        width = self.pair.curve.high - self.pair.curve.low
        last = np.maximum(np.abs(moved) / width, np.abs(turned) / (self.pair.curve.size if path.straight else 1.0))
        found = [_coefficient(curve, k, now[1]) for k in range(self.orders + 1)]
        results = [*now, last, bend, *(one.real for one in found), *(one.imag for one in found)]
        like = number(graph, given[6])
        nodes = {str(k): (like.like(one).x,) for k, one in enumerate(results)}
        row = np.zeros((1, 2))
        numbers = CallNumbers(dict.fromkeys([*given, *parts], row), (2,), frozenset())
        return ReadyProgram.of(graph, nodes, numbers, self.backend)

    def _may_touch_elsewhere(self, path: FollowerPath, start: ContactStart) -> Number:
        """Tell where the contact that is found may be beyond another one.

        From outside a closed profile the outermost contact of a guide, or the only two of a circle, touch nowhere else.
        """
        if self.pair.is_flat:
            return np.full(len(path.start), not self._is_convex)
        if not self.pair.turns:
            return path.toward != 0.0
        is_outside = path.toward * self.pair.curve.outer_side >= 0.0
        return ~(is_outside & (path.straight | start.alone))

    def _touches_elsewhere(self, path: FollowerPath, coordinate: Number, place: Number) -> Number:
        """Tell where a contact, at places (2, poses), is not the only one of a follower in its coordinate.

        Of one that is alone the distances of samples have one least, as far as they are not larger.
        """
        curve = self.pair.curve
        samples = curve.samples.points[::THINNED] - self._middle
        points = np.array([samples.real, samples.imag])
        sag, bend = (THINNED * np.max(np.abs(np.diff(curve.samples.points)))) ** 2, self._sharpest
        turn = np.exp(1j * path.sense * coordinate)
        if self.pair.is_flat:
            normal = path.toward if path.straight else path.toward * turn
            far = -(np.stack([normal.real, normal.imag], axis=1) @ points)
            own = -(normal.real * (place[0] - self._middle.real) + normal.imag * (place[1] - self._middle.imag))
            limit = own + 0.5 * sag * bend
        else:
            along = path.centre * path.sense * coordinate
            middle = path.start + along if path.straight else path.centre + (path.start - path.centre) * turn
            middle = middle - self._middle
            far = -2.0 * (np.stack([middle.real, middle.imag], axis=1) @ points)
            far += dot(middle, middle)[:, None] + np.sum(points * points, axis=0)
            limit = path.toward**2 + 0.5 * sag * (1.0 + np.abs(path.toward) * bend)
        wall = far[:, :1] * 0.0 + np.inf
        ends = (far[:, -1:], far[:, :1]) if curve.closed else (wall, wall)
        around = np.concatenate([ends[0], far, ends[1]], axis=1)
        least = (far < around[:, :-2]) & (far <= around[:, 2:]) & (far < limit[:, None])
        return np.count_nonzero(least, axis=1) != 1


def _roller_step(path: FollowerPath, coordinate: Any, local: Sequence[Any]) -> tuple[Any, Any, Any]:
    """Return Newton's step of coordinate and parameter to where a roller's middle is off the profile by its radius.

    The third number is how much of the profile's direction its parallel has: it turns back where that is negative.
    """
    place, first, second = local[0], local[1], local[2] * 2.0
    pace = np.abs(first)
    along = first / pace
    normal = along * -1j
    bend = 1.0 + path.toward * cross(first, second) / (pace * pace * pace)
    if path.straight:
        rate = path.centre * path.sense
        middle = path.start + rate * coordinate
    else:
        arm = (path.start - path.centre) * constant(coordinate * path.sense).turn().c[0]
        middle, rate = path.centre + arm, arm * (1j * path.sense)
    off = place + normal * path.toward - middle
    turned = dot(off, normal) / dot(rate, normal)
    return turned, (turned * dot(rate, along) - dot(off, along)) / (pace * bend), bend


def _face_step(path: FollowerPath, coordinate: Any, local: Sequence[Any]) -> tuple[Any, Any, Any]:
    """Return Newton's step of coordinate and parameter to where a face touches the profile.

    The third number is the curvature there in parts of the profile's own length, negative in a hollow.
    """
    place, first, second = local[0], local[1], local[2] * 2.0
    if path.straight:
        slope = dot(path.toward, second)
        moved = -dot(path.toward, first) / slope
        reach = path.sense * dot(path.toward, place + first * moved - path.start) / dot(path.toward, path.centre)
        return reach - coordinate, moved, -slope / np.abs(first)
    turn = constant(coordinate * path.sense).turn().c[0]
    normal, arm = path.toward * turn, (path.start - path.centre) * turn
    turning, off = normal * (1j * path.sense), path.centre + arm - place
    leans, gap = dot(normal, first), dot(normal, off)
    by_s, by_q = dot(normal, second), dot(turning, first)
    slope = dot(normal, arm * (1j * path.sense)) + dot(turning, off)
    whole = by_s * slope + leans * by_q
    return -(by_s * gap + leans * leans) / whole, (gap * by_q - leans * slope) / whole, -by_s / np.abs(first)


@dataclass(frozen=True, eq=False, repr=False)
class FollowerSeeds(ShortRepr):
    """A follower of a recorded path, whose contact is searched. `approach` is recorded, `sign` that of its mode."""

    solver: GroupSolver
    approach: Approach
    sign: int
    profile: SearchedProfile
    _programs: dict[Any, ReadyProgram[str]] = field(default_factory=dict)

    def seeds(self, path: RecordedPath, numbers: CallNumbers) -> tuple[dict[InputNumber, Number], Number]:
        """Return its seeds at all poses of a call, and where they are sure, (designs, poses)."""
        coordinate, parameter, coefficients, sure = self.profile.found(self._path(path, numbers))
        shape, name = numbers.extent, self.profile.pair.name
        found = {InputNumber(SEED, group_seed(self.solver.index), "0"): coordinate,
                 InputNumber(SEED, name, PARAMETER): parameter}  # fmt: skip
        for letter, own in zip("xy", coefficients, strict=True):
            found |= {InputNumber(SEED, name, f"{letter}{k}"): one for k, one in enumerate(own)}
        return {one: value.reshape(shape) for one, value in found.items()}, sure.reshape(shape)

    def _path(self, path: RecordedPath, numbers: CallNumbers) -> FollowerPath:
        """Return how it comes to its profile at all poses of a call."""
        form = numbers.form
        if form not in self._programs:
            mechanism, own = path.mechanism, self.approach.path
            wanted = {"start": own.start, "centre": own.centre, "toward": self.approach.toward,
                      "sense": own.sense, "sign": self.approach.sign}  # fmt: skip
            each = ((name, mechanism.number(value)) for name, value in wanted.items())
            nodes = {name: (one.x,) if one.y is None else (one.x, one.y) for name, one in each}
            self._programs[form] = ReadyProgram.of(mechanism.graph, nodes, numbers, self.profile.backend)
        found = self._programs[form].run(numbers)
        # which way it goes is a matter of its pair alone: +1 or -1 at all poses
        sense, sign = (float(np.sign(found.pop(name).flat[0])) for name in ("sense", "sign"))
        arrays = {name: np.broadcast_to(value, numbers.extent).reshape(-1) for name, value in found.items()}
        return FollowerPath(self.approach.path.straight, **arrays, sense=sense, is_greatest=sign * self.sign > 0.0)


@dataclass(frozen=True, eq=False, repr=False)
class FollowerContacts(ShortRepr):
    """The followers of a recorded path, in solving order: all that it asks to be found outside."""

    path: RecordedPath
    followers: tuple[FollowerSeeds, ...]
    backend: str | None
    _programs: dict[Any, ReadyProgram[str]] = field(default_factory=dict)

    @classmethod
    def of(cls, path: RecordedPath, backend: str | None) -> FollowerContacts | None:
        """Return the followers of a path; None where it asks for anything else."""
        mechanism, signs = path.mechanism, path.mechanism.recording.signs
        found, names = list[FollowerSeeds](), set[str]()
        for solver in mechanism.order.solvers:
            approach = solver.approach(mechanism.block) if solver.width == 1 and solver.index in signs else None
            if approach is None:
                continue
            pairs = (as_profile_contact(mechanism.recording.solving_order.pairs[one.name])
                     for one in solver.group.outer)  # fmt: skip
            pair = next(one for one in pairs if one)
            parts = [one.part for one in path.seeds if one.name == pair.name]
            orders = max((int(part[1:]) for part in parts if part[0] in "xy"), default=0)
            profile = SearchedProfile(pair, orders, backend)
            if profile.polynomials.are_exact:
                found.append(FollowerSeeds(solver, approach, signs[solver.index], profile))
                names |= {group_seed(solver.index), pair.name}
        return cls(path, tuple(found), backend) if names.issuperset(one.name for one in path.seeds) else None

    def added(self, numbers: CallNumbers) -> tuple[CallNumbers, Number]:
        """Return the numbers of a call with all seeds, and in which designs (designs,) they are sure."""
        given: Mapping[InputNumber, Number] = numbers.given
        sure: Number = np.ones(numbers.extent, dtype=bool)
        for follower in self.followers:
            seeds, own = follower.seeds(self.path, replace(numbers, given=given))
            given, sure = {**given, **seeds}, sure & own
        return replace(numbers, given=given), sure.all(axis=1)

    @property
    def watches(self) -> bool:
        """Whether groups beside them may pass between their modes."""
        return bool(RecordedLimits(self.path.mechanism).watched)

    def margins(self, numbers: CallNumbers) -> Number:
        """Return the least margins of these groups at all poses, (designs, poses); no numbers where it is not sure."""
        found, sure = self.added(numbers)
        form = found.form
        if form not in self._programs:
            limits = RecordedLimits(self.path.mechanism)
            nodes = {"": (limits.margin.x,)}
            self._programs[form] = ReadyProgram.of(self.path.mechanism.graph, nodes, found, self.backend)
        margins = np.broadcast_to(self._programs[form].run(found)[""], found.extent)
        return np.where(sure[:, None], margins, np.nan)
