"""Motions that are sampled: linkages that carry a body along a course of many poses, closed or open, with any timing.

A course is a curve of the body's origin with an angle at each place. The steps are those of drawn curves: places and
unit vectors of many designs evenly along the arc, their correlations over all begins as transforms, then Levenberg's
steps from the nearest. How the body lies on its link is free, so that the correlation of the vectors has an absolute
value as that of the places has.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import TURN, Number
from compoundkin.dimensional.candidates import POINT, Candidates, Linkage
from compoundkin.dimensional.coupler_atlas import PARTS, coupler_atlas
from compoundkin.dimensional.curve_chains import CRANK, CurveChain, Laying, turn
from compoundkin.dimensional.curve_conditions import keeps_transmission
from compoundkin.dimensional.curve_likeness import arc_parts, interpolated_rows
from compoundkin.dimensional.design_refinement import (
    GIVEN,
    FittedDesigns,
    RefinementPlan,
    best_designs,
    different_verdicts,
    ranked,
)
from compoundkin.dimensional.tasks import PoseTask, extent
from compoundkin.model.attributes import ANGLE, POSITION
from compoundkin.model.elements import link
from compoundkin.programs.call_numbers import Call
from compoundkin.programs.compiled_path import CompiledPath, compile

# Designs of the atlas; samples of a course, evenly along its arc, and poses of a design.
DESIGNS, SAMPLES, POSES = 40_000, 64, 96
# Designs of a chain that are refined, the best of all that are refined to the end, steps of both, and rounds in which
# the best are moved.
STARTED, BEST, FIRST_STEPS, STEPS, ROUNDS = 12, 24, 20, 60, 1
# The least part of the turn that follows an open course, and the least spread of a part of a curve.
LEAST_TURN, LEAST_SPREAD = 0.3, 0.05
# The part of residuals along the course, which keeps poses from gliding without end; the weight of an open one's ends.
ALONG, ENDS = 0.1, 2.0
# Positions at which a refined linkage is handed on, and poses by which its error is measured.
POSITIONS, MEASURED = 12, 721
# Unknowns that lay a design on a course: which part of the turn follows it, logarithm of the size, angle, place, and
# how the body lies on its link.
LAYING = 7


class WantedMotion(NamedTuple):
    """A course that is looked for, evenly along its arc: `places` (SAMPLES,) of RMS radius one about zero, and `u`.

    It is ``size * places + middle``; a radian of `u` counts as `weight` of these radii, the extent of the course.
    `transmission` is the least transmission angle.
    """

    places: Number
    u: Number
    closed: bool
    size: float
    middle: complex
    weight: float
    transmission: float = 0.0

    @classmethod
    def of(cls, task: PoseTask) -> WantedMotion:
        """Return the course of a task."""
        z, angle = task.z, np.unwrap(np.angle(task.u))
        if task.closed:
            z = np.append(z, z[:1])
            angle = np.unwrap(np.append(angle, angle[0]))
        along = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
        at = np.linspace(0.0, along[-1], SAMPLES, endpoint=not task.closed)
        places, u = np.interp(at, along, z), np.exp(1j * np.interp(at, along, angle))
        middle = complex(places.mean())
        size = float(np.sqrt(np.mean(np.abs(places - middle) ** 2)))
        least = task.conditions.transmission
        return cls((places - middle) / size, u, task.closed, size, middle, extent(task.z) / size, least)

    @property
    def mirrored(self) -> WantedMotion:
        """Its mirror image."""
        return self._replace(places=np.conj(self.places), u=np.conj(self.u))


@cache
def _program(chain: CurveChain) -> CompiledPath:
    """Return the program of a chain's point and the angle of the link that has it."""
    some = chain.dimensions(np.zeros((1, len(chain.numbers))))
    outputs = [f"{POINT}.{POSITION}", f"{chain.plan.traced}.{ANGLE}"]
    return compile(chain.mechanism, outputs, free=list(some))


def _poses(chain: CurveChain, designs: Number, angles: Number) -> tuple[Number, Number, Number]:
    """Return places of P and unit vectors of its link, (designs, poses), and which designs are clear."""
    found, clear = _program(chain).programs.unscreened(Call({CRANK: angles}, chain.dimensions(designs)))
    z, angle = found[f"{POINT}.{POSITION}"], found[f"{chain.plan.traced}.{ANGLE}"]
    return z, np.exp(1j * np.broadcast_to(angle, z.shape)), clear


class _ChainCourses(NamedTuple):
    """Designs of a chain (designs, numbers), with places and unit vectors (designs, SAMPLES) evenly along the arc."""

    chain: CurveChain
    designs: Number
    places: Number
    u: Number


@lru_cache(maxsize=2)
def _courses(links: int, count: int) -> tuple[_ChainCourses, ...]:
    """Return the courses of the designs of an atlas of coupler curves."""
    found = []
    for part in coupler_atlas(links, count).parts:
        designs = part.designs().astype(float)
        z, u, clear = _poses(part.chain, designs, turn(SAMPLES))
        z, u = z[clear], u[clear]
        both = resampled_both(z, u)
        found.append(_ChainCourses(part.chain, designs[clear], *(one.astype(np.complex64) for one in both)))
    return tuple(found)


def resampled_both(z: Number, u: Number) -> tuple[Number, Number]:
    """Return closed courses, (courses, poses), evenly along the arcs of their places, (courses, SAMPLES)."""
    z, u = (np.concatenate([one, one[:, :1]], axis=1) for one in (z, u))
    along, wanted = arc_parts(z), np.linspace(0.0, 1.0, SAMPLES, endpoint=False)
    places, vectors = (interpolated_rows(np.broadcast_to(wanted, (len(z), SAMPLES)), along, one) for one in (z, u))
    return places, vectors / np.maximum(np.abs(vectors), 1e-9)


def nearest_courses(z: Number, u: Number, course: WantedMotion) -> tuple[Number, Number]:
    """Return by how much courses (designs, SAMPLES) miss one, and how: begin, length, sense, (designs, 3).

    It is the mean square over samples in RMS radii, the least over rotation, size, begin, sense, and how the body lies
    on its link. Lengths are in samples.
    """
    best, how = np.full(len(z), np.inf), np.zeros((len(z), 3), int)
    spectra = [np.fft.fft(one, axis=1) for one in (z, u)]
    whole = np.var(z, axis=1, keepdims=True)
    running = [np.pad(np.cumsum(np.tile(one, 2), axis=1), ((0, 0), (1, 0))) for one in (z, np.abs(z) ** 2)]
    for long in (SAMPLES,) if course.closed else PARTS:
        sums, squares = (one[:, long : long + SAMPLES] - one[:, :SAMPLES] for one in running)
        spread = squares - np.abs(sums) ** 2 / long
        at = np.linspace(0, SAMPLES - 1, long)
        places, vectors = (np.interp(at, np.arange(SAMPLES), one) for one in (course.places, course.u))
        places = places - places.mean()
        for sense in (1, -1):
            likeness = []
            for spectrum, own in zip(spectra, (places[::sense], vectors[::sense]), strict=True):
                other = np.fft.fft(np.pad(own, (0, SAMPLES - long)))
                likeness.append(np.abs(np.fft.ifft(spectrum * np.conj(other), axis=1)))
            norm = np.sqrt(np.maximum(spread, LEAST_SPREAD * long * whole) * np.sum(np.abs(places) ** 2))
            missed = 2.0 - 2.0 * likeness[0] / norm
            missed = missed + course.weight**2 * (2.0 - 2.0 * likeness[1] / long)
            start = missed.argmin(axis=1)
            value = missed[np.arange(len(z)), start]
            better = value < best
            best[better] = value[better]
            how[better] = np.stack([start, np.full(len(z), long), np.full(len(z), sense)], axis=-1)[better]
    return best, how


@dataclass(frozen=True, eq=False)
class _FittedMotions(FittedDesigns):
    """Designs of one chain that are refined together to a course, (designs, numbers + LAYING).

    After the designs' numbers stand the crank's angle at the begin, the turn from there, the logarithm of the size, the
    angle, the place, and the angle of the body on its link.
    """

    course: WantedMotion

    def moved(self, x: Number) -> _FittedMotions:
        """Return designs at other unknowns; a whole turn begins where it did."""
        if self.course.closed:
            x[:, -LAYING : 2 - LAYING] = self.x[0, -LAYING : 2 - LAYING]
        return super().moved(x)

    def _angles(self, x: Number, poses: int) -> Number:
        parts = np.linspace(0.0, 1.0, poses, endpoint=not self.course.closed)
        return x[:, [-LAYING]] + x[:, [1 - LAYING]] * parts

    def residuals(self, x: Number) -> tuple[Number, Number, Number]:
        """Return the gaps of each sample to the nearest pose, and of each pose to the nearest sample, their slopes."""
        n, course, count = len(self.chain.numbers), self.course, len(x)
        double = np.repeat(x, 2, axis=0) if count == 1 else x  # for one design other programs would be made
        angles = self._angles(double, POSES)
        w, v, slopes_w, slopes_v, clear = self._laid(double, angles)
        if not course.closed:
            clear = clear & _poses(self.chain, double[:, :n], turn(SAMPLES))[2]
            clear = clear & (double[:, 1 - LAYING] > LEAST_TURN) & (double[:, 1 - LAYING] < TURN)
        clear = clear & keeps_transmission(self.chain, double[:, :n], course.transmission)
        if not clear.all():  # what is not clear means nothing, and is not taken
            w, v, slopes_w, slopes_v = (np.where(clear[:, None], each, 1.0) for each in (w, v, slopes_w, slopes_v))
        weight = course.weight
        own, wanted = np.stack([w, weight * v]), np.stack([course.places, weight * course.u])
        slopes = np.stack([slopes_w, weight * slopes_v])
        square = (np.abs(own[:, :, :, None] - wanted[:, None, None, :]) ** 2).sum(axis=0)
        rows, at, nearest = np.arange(len(w))[:, None], square.argmin(axis=1), square.argmin(axis=2)
        ways = _ways(own, course.closed), _ways(wanted[:, None], course.closed)[:, 0]
        parts = [
            _across(own[:, rows, at] - wanted[:, None], ways[0][:, rows, at], slopes[:, :, rows, at]),
            _across(own - wanted[:, nearest], ways[1][:, nearest], slopes, np.sqrt(SAMPLES / POSES)),
        ]
        if not course.closed:
            ends = own[:, :, [0, -1]]
            gaps = [ends - wanted[:, None, [0, -1]], ends - wanted[:, None, [-1, 0]]]
            sizes = [(np.abs(each) ** 2).sum(axis=(0, 2)) for each in gaps]
            forth = sizes[0] <= sizes[1]
            parts.append(_plain(ENDS * np.where(forth[:, None], *gaps), ENDS * slopes[:, :, :, [0, -1]]))
        r, j = (np.concatenate([part[k] for part in parts], axis=1) for k in (0, 1))
        return r[:count], j[:count], clear[:count]

    def _laid(self, x: Number, angles: Number) -> tuple[Number, Number, Number, Number, Number]:
        """Return places and unit vectors of the body where it lies, their slopes by all unknowns, which is clear."""
        chain, n = self.chain, len(self.chain.numbers)
        dimensions = chain.dimensions(x[:, :n])
        found, clear = _program(chain).sensitivities.unscreened(Call({CRANK: angles}, dimensions))
        place, turned, shape = f"{POINT}.{POSITION}", f"{chain.plan.traced}.{ANGLE}", angles.shape
        scale = np.exp(x[:, [2 - LAYING]] + 1j * x[:, [3 - LAYING]])
        own = scale * np.broadcast_to(found[place, ""], shape)
        v = np.exp(1j * (np.broadcast_to(found[turned, ""], shape) + x[:, [-1]]))
        factors = [np.exp(x[:, [k]]) if one.is_length else 1.0 for k, one in enumerate(chain.numbers)]
        by_w = [scale * factor * np.broadcast_to(found[place, one.name], shape)
                for factor, one in zip(factors, chain.numbers, strict=True)]  # fmt: skip
        by_v = [1j * v * factor * np.broadcast_to(found[turned, one.name], shape)
                for factor, one in zip(factors, chain.numbers, strict=True)]  # fmt: skip
        crank_w = scale * np.broadcast_to(found[place, CRANK], shape)
        crank_v = 1j * v * np.broadcast_to(found[turned, CRANK], shape)
        still, one = np.zeros(shape, complex), np.ones(shape, complex)
        parts = np.zeros(shape) if self.course.closed else (angles - angles[:, :1]) / x[:, [1 - LAYING]]
        # around a whole turn it does not matter where it begins
        from_begin = still if self.course.closed else one
        by_w += [from_begin * crank_w, parts * crank_w, own, 1j * own, one, 1j * one, still]
        by_v += [from_begin * crank_v, parts * crank_v, still, still, still, still, 1j * v]
        w = own + (x[:, [4 - LAYING]] + 1j * x[:, [5 - LAYING]])
        return w, v, np.array(by_w), np.array(by_v), clear

    def linkage(self, k: int, task: PoseTask) -> Linkage:
        """Return one of them as a linkage with the body of a task, at positions along the course."""
        x, course = self.x[k], self.course
        n, size, middle = len(self.chain.numbers), course.size, course.middle
        if self.mirrored:
            middle = complex(np.conj(middle))
        scale = complex(np.exp(complex(x[2 - LAYING], x[3 - LAYING])))
        laying = Laying(scale * size, complex(x[4 - LAYING], x[5 - LAYING]) * size + middle, self.mirrored)
        angles = self._angles(x[None], POSITIONS)[0]
        found = self.chain.linkage(x[:n], laying, angles)
        # the link's frame turns by the angle of the laying too, which the body's does not
        body = laying.as_seen(complex(np.exp(1j * (x[-1] - x[3 - LAYING]))))
        error = self._error(x, task)
        return replace(_with_body(found, self.chain.plan.traced, task.link, body), error=error)

    def _error(self, x: Number, task: PoseTask) -> float:
        """Return the greatest distance of the task's poses from the course, of lengths and angles by the extent."""
        n, count = len(self.chain.numbers), MEASURED
        z, u, _ = _poses(self.chain, np.repeat(x[None, :n], 2, axis=0), self._angles(x[None], count)[0])
        course = self.course
        w = np.exp(complex(x[2 - LAYING], x[3 - LAYING])) * z[0] + complex(x[4 - LAYING], x[5 - LAYING])
        v = u[0] * np.exp(1j * x[-1])
        w, v = (np.conj(each) if self.mirrored else each for each in (w, v))
        places = w * course.size + course.middle
        far = extent(task.z)
        square = np.abs(task.z[:, None] - places) ** 2 + (far * np.angle(task.u[:, None] * np.conj(v))) ** 2
        return float(np.sqrt(square.min(axis=1).max()))


def _ways(own: Number, closed: bool) -> Number:
    """Return the directions of courses (2, courses, poses), of unit length."""
    if closed:
        found = np.roll(own, -1, axis=-1) - np.roll(own, 1, axis=-1)
    else:
        found = np.gradient(own, axis=-1)
    length = np.sqrt((np.abs(found) ** 2).sum(axis=0))
    return found / np.maximum(length, 1e-12)


def _across(gaps: Number, ways: Number, slopes: Number, counted: float = 1.0) -> tuple[Number, Number]:
    """Return gaps (2, designs, n) across directions, what lies along them little, as numbers; and their slopes."""
    less = 1.0 - ALONG
    r = gaps - less * ways * np.real(np.conj(ways) * gaps).sum(axis=0)
    j = slopes - less * ways[:, None] * np.real(np.conj(ways)[:, None] * slopes).sum(axis=0)
    return _plain(counted * r, counted * j)


def _plain(r: Number, j: Number) -> tuple[Number, Number]:
    """Return gaps (2, designs, n) as numbers (designs, 4 n), and their slopes (designs, 4 n, unknowns)."""
    numbers = np.concatenate([*r.real, *r.imag], axis=-1)
    steep = np.concatenate([*j.real, *j.imag], axis=-1)
    return numbers, np.moveaxis(steep, 0, -1)


def _with_body(found: Linkage, traced: str, name: str, body: complex) -> Linkage:
    """Return a linkage whose link with P is called after a body, and has its coordinates: P is the origin."""
    own = next(one for one in found.links if one.name == traced)
    places = {letter: np.complex128(place) for letter, place in own.points.items()}
    origin = places[POINT]
    points = {letter: complex((place - origin) / body) for letter, place in places.items()}
    links = tuple(link(name, **points) if one.name == traced else one for one in found.links)
    z, u = dict(found.z), dict(found.u)
    z[name], u[name] = z[traced] + u.pop(traced) * origin, found.u[traced] * body
    del z[traced]
    return replace(found, links=links, z=z, u=u, outputs=(f"{POINT}.{POSITION}", f"{name}.{ANGLE}"))


def sampled_motion(task: PoseTask) -> Candidates:
    """Return the linkages of at most `task.links` links that come nearest to a course of poses."""
    course = WantedMotion.of(task)
    parts = _courses(task.links, DESIGNS)
    begun = (one for part in parts for one in _begun(part, course))
    found = best_designs(begun, RefinementPlan(FIRST_STEPS, BEST, STEPS, ROUNDS))
    verdicts = different_verdicts((part.linkage(k, task) for part, k in ranked(found)), task, GIVEN)
    designs = sum(len(part.designs) for part in parts)
    complete = f"the best {len(verdicts)} of {designs} designs of {len(parts)} chains, refined"
    return Candidates([one.candidate for one in verdicts], complete, is_family=True, verdicts=tuple(verdicts))


def _begun(part: _ChainCourses, course: WantedMotion) -> Iterator[_FittedMotions]:
    """Yield the designs of a chain whose courses are nearest, as they are or mirrored."""
    both = [nearest_courses(part.places, part.u, one) for one in (course, course.mirrored)]
    allowed = keeps_transmission(part.chain, part.designs, course.transmission)
    missed = np.concatenate([np.where(allowed, one[0], np.inf) for one in both])
    chosen = np.argsort(missed, kind="stable")[: min(STARTED, 2 * allowed.sum())]
    count = len(part.designs)
    for mirrored, wanted in ((False, course), (True, course.mirrored)):
        own = chosen[(chosen >= count) == mirrored] % count
        if not len(own):
            continue
        how = both[int(mirrored)][1][own]
        x = [_unknowns(part.designs[k], one, part.chain, wanted) for k, one in zip(own, how, strict=True)]
        yield _FittedMotions(part.chain, mirrored, np.array(x), np.full(len(x), np.inf), wanted)


def _unknowns(design: Number, how: Number, chain: CurveChain, course: WantedMotion) -> Number:
    """Return the unknowns that lay a design on a course, by its best begin, length and sense along the arc."""
    start, long, sense = how.tolist()
    angles = np.append(turn(4 * SAMPLES), TURN)
    z, u, _ = _poses(chain, np.repeat(design[None], 2, axis=0), angles)
    at = np.interp((start + np.arange(long)) / SAMPLES % 1.0, arc_parts(z[:1])[0], angles)
    window = (0.0, TURN) if course.closed else (float(at[0]), float((at[-1] - at[0]) % TURN))
    z, u, _ = _poses(chain, np.repeat(design[None], 2, axis=0), at)
    wanted = [np.interp(np.linspace(0, SAMPLES - 1, long), np.arange(SAMPLES), one)[::sense] for one in course[:2]]
    own, target = z[0] - z[0].mean(), wanted[0] - wanted[0].mean()
    scale = np.vdot(own, target) / np.vdot(own, own)
    place = wanted[0].mean() - scale * z[0].mean()
    body = np.angle(np.vdot(u[0], wanted[1]))
    return np.array([*design, *window, np.log(np.abs(scale)), np.angle(scale), place.real, place.imag, body])
