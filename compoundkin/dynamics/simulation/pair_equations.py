"""The equations of all pairs of a mechanism, and of prescribed drivers, in the coordinates of its links.

Rows are in parts of the size and radians: pins, x and y in turn; slides, first the distances of their blocks, then the
sines of their angles; other pairs; coordinates that are prescribed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number, cross, dot, whole_turns
from compoundkin.base.poses import FIXED, Pose
from compoundkin.base.series import Series
from compoundkin.dynamics.simulation.driver_state import ONLY, prescribed_rates
from compoundkin.kinematics.driver_values import mapped
from compoundkin.kinematics.motion import Motion
from compoundkin.model.geometry import FRAME
from compoundkin.model.laws import Law
from compoundkin.model.pairs import Pair
from compoundkin.model.pairs.contract import Ends, constraint_scales


class Equations(NamedTuple):
    """The pairs' equations at a state, in parts of the size and radians: what is open, J, b and c."""

    open: Number
    jacobian: Number
    rates: Number
    second: Number


class _AllPins(NamedTuple):
    """All pins at once: the indices of their links, and their places there."""

    first: Number
    second: Number
    own: Number
    other: Number


class _AllSlides(NamedTuple):
    """All slides at once: the indices of their links, and their points and directions there."""

    first: Number
    second: Number
    own: Number
    other: Number
    guide: Number
    block: Number


class _SlideRows(NamedTuple):
    """What is open of slides, what it would be accelerated by, and its derivatives."""

    open: tuple[Number, Number]
    second: tuple[Number, Number]
    direction: Number
    turning: tuple[Number, Number]
    aligned: Number


class _OtherPair(NamedTuple):
    """A pair that is neither a pin nor a slide: the places of its members' columns, and the scales of its equations."""

    pair: Pair
    ends: Ends
    columns: Number
    scales: Number


class _PrescribedCoordinate(NamedTuple):
    """A coordinate that is prescribed: by the law of a driver, or at its first value."""

    pair: Pair
    ends: Ends
    columns: Number
    sense: float
    scale: float
    law: str | None
    first: float


class PairEquations:
    """The equations of all pairs of a mechanism, by the coordinates of its links: x, y and the angle of each.

    `start` is a motion of one pose, with the coordinates `first`; `laws` prescribe drivers.
    """

    def __init__(self, start: Motion, links: Sequence[str], laws: Mapping[str, Law], first: Number) -> None:
        self.start, self.links, self.laws = start, tuple(links), laws
        self.size = start.solving_order.size
        self.index = {link: k for k, link in enumerate(links)} | {FRAME: len(links)}
        # the units of all columns, those of the frame too
        self.lengths = np.tile([self.size, self.size, 1.0], len(links) + 1)
        known = start.inputs.cut(ONLY, ONLY).ends
        self.ends = {name: tuple(mapped(end, plain_number) for end in ends) for name, ends in known.items()}
        simple = [pair for pair in start.structure.pairs if pair.is_simple]
        self._pin_pairs = [pair for pair in simple if pair.free_is_angle]
        self._slide_pairs = [pair for pair in simple if not pair.free_is_angle]
        self.pins, self.slides = self._pins(), self._slides()
        self.others = tuple(
            _OtherPair(pair, self.ends_of(pair), self.columns(pair), np.array(constraint_scales(pair, self.size)))
            for pair in start.structure.pairs
            if not pair.is_simple
        )
        still = link_poses(self.links, first, np.zeros_like(first))
        steps = [step for body in start.structure.bodies for step in body.driven if step.is_passive]
        passive = [(step.pair, 1.0, None) for step in steps]
        driven = [(own.pair, float(own.pair.driven_by(own.drive.link)), name)
                  for name, own in start.structure.driven.items() if name in laws]  # fmt: skip
        self.prescribed = tuple(self._prescribed(*one, still) for one in (*passive, *driven))

    def _members(self, pairs: Sequence[Pair]) -> Number:
        return np.array([[self.index[link] for link in pair.members] for pair in pairs], dtype=int).reshape(-1, 2)

    def _pins(self) -> _AllPins:
        members = self._members(self._pin_pairs)
        points = [[end.point for end in self.ends_of(pair)] for pair in self._pin_pairs]
        places = np.array(points, dtype=complex).reshape(-1, 2)
        return _AllPins(members[:, 0], members[:, 1], places[:, 0], places[:, 1])

    def _slides(self) -> _AllSlides:
        members = self._members(self._slide_pairs)
        ends = [[(end.point, end.along.c[0]) for end in self.ends_of(pair)] for pair in self._slide_pairs]
        sides = np.array(ends, dtype=complex).reshape(-1, 2, 2)
        return _AllSlides(members[:, 0], members[:, 1], *sides[..., 0].T, *sides[..., 1].T)

    def _prescribed(self, pair: Any, sense: float, law: str | None, still: Mapping[str, Pose]) -> _PrescribedCoordinate:
        ends = self.ends_of(pair)
        scale = 1.0 if pair.free_is_angle else self.size
        # angles of links may be written with other turns than the driver's
        first = sense * coefficient(pair.coordinate(ends, tuple(still[link] for link in pair.members)), 0)
        return _PrescribedCoordinate(pair, ends, self.columns(pair), sense, scale, law, first)

    def ends_of(self, pair: Pair) -> Ends:
        """Return the ends of a pair as plain numbers."""
        known = self.ends.get(pair.name)
        return known or tuple(mapped(end, plain_number) for end in pair.ends(self.start.mechanism.geometry))

    def columns(self, pair: Pair) -> Number:
        """Return the places of the coordinates of a pair's members; the frame's are the last."""
        return np.concatenate([3 * self.index[link] + np.arange(3) for link in pair.members])

    @cached_property
    def rows(self) -> Mapping[str, slice]:
        """The rows of each pair among the equations."""
        found = {pair.name: slice(2 * k, 2 * k + 2) for k, pair in enumerate(self._pin_pairs)}
        first, n = 2 * len(self._pin_pairs), len(self._slide_pairs)
        found |= {pair.name: slice(first + k, first + n + k + 1, n) for k, pair in enumerate(self._slide_pairs)}
        ends = np.cumsum([first + 2 * n, *(len(one.scales) for one in self.others)]).tolist()
        found |= {one.pair.name: slice(*rows) for one, rows in zip(self.others, pairwise(ends), strict=True)}
        return found

    @cached_property
    def count(self) -> int:
        """The number of equations."""
        simple = 2 * (len(self._pin_pairs) + len(self._slide_pairs))
        return simple + sum(len(one.scales) for one in self.others) + len(self.prescribed)

    def at(self, time: float, values: Number, speeds: Number, world: Mapping[str, Pose]) -> Equations:
        """Return the equations of all pairs at coordinates and rates, `world` being the poses there."""
        # the frame has columns, too, which are left out at last
        shapes = self.count, (self.count, len(values) + 3), self.count, self.count
        whole = Equations(*(np.zeros(shape) for shape in shapes))
        z = np.append(values[0::3] + 1j * values[1::3], 0j)
        u, w = np.append(np.exp(1j * values[2::3]), 1.0), np.append(speeds[2::3], 0.0)
        row = self._put_pins(z, u, w, whole)
        if self._slide_pairs:
            guided = self._slide_rows(z, u, np.append(speeds[0::3] + 1j * speeds[1::3], 0j), w)
            row = self._put_slides(row, guided, whole)
        row = self._put_others(row, world, whole)
        self._put_prescribed(row, time, world, whole)
        return whole._replace(jacobian=whole.jacobian[:, :-3])

    def _put_pins(self, z: Number, u: Number, w: Number, whole: Equations) -> int:
        """Write the rows of all pins, x and y in turn, before all others; return the row behind them."""
        pins, m, matrix = self.pins, len(self._pin_pairs), whole.jacobian
        own, other = u[pins.first] * pins.own, u[pins.second] * pins.other
        gap = (z[pins.second] + other - z[pins.first] - own) / self.size
        turned = (np.square(w[pins.first]) * own - np.square(w[pins.second]) * other) / self.size
        even, odd = np.arange(0, 2 * m, 2), np.arange(1, 2 * m, 2)
        whole.open[even], whole.open[odd] = gap.real, gap.imag
        whole.second[even], whole.second[odd] = -turned.real, -turned.imag
        matrix[even, 3 * pins.first] = matrix[odd, 3 * pins.first + 1] = -1.0
        matrix[even, 3 * pins.second] = matrix[odd, 3 * pins.second + 1] = 1.0
        matrix[even, 3 * pins.first + 2], matrix[odd, 3 * pins.first + 2] = own.imag / self.size, -own.real / self.size
        matrix[even, 3 * pins.second + 2] = -other.imag / self.size
        matrix[odd, 3 * pins.second + 2] = other.real / self.size
        return 2 * m

    def _slide_rows(self, z: Number, u: Number, v: Number, w: Number) -> _SlideRows:
        """Return the rows of all slides: the distance of the block from the guide, the sine of their angle."""
        slides = self.slides
        w0, w1 = w[slides.first], w[slides.second]
        e, f = u[slides.first] * slides.guide, u[slides.second] * slides.block
        own, other = u[slides.first] * slides.own, u[slides.second] * slides.other
        gap = z[slides.second] + other - z[slides.first] - own
        rate = v[slides.second] + 1j * w1 * other - v[slides.first] - 1j * w0 * own
        inward = w0 * w0 * own - w1 * w1 * other
        sine, cosine = cross(e, f), dot(e, f)
        moved = -w0 * w0 * cross(e, gap) + 2.0 * cross(1j * w0 * e, rate) + cross(e, inward)
        turning = cross(1j * e, gap) - cross(e, 1j * own), cross(e, 1j * other)
        return _SlideRows(
            (cross(e, gap) / self.size, sine),
            (-moved / self.size, np.square(w1 - w0) * sine),
            e,
            (turning[0] / self.size, turning[1] / self.size),
            cosine,
        )

    def _put_slides(self, at: int, found: _SlideRows, whole: Equations) -> int:
        """Write the rows of all slides from a row on: distances, then angles; return the row behind them."""
        slides, k, matrix = self.slides, len(self._slide_pairs), whole.jacobian
        rows, angles = np.arange(at, at + k), np.arange(at + k, at + 2 * k)
        whole.open[rows], whole.open[angles] = found.open
        whole.second[rows], whole.second[angles] = found.second
        e = found.direction
        matrix[rows, 3 * slides.first], matrix[rows, 3 * slides.first + 1] = e.imag, -e.real
        matrix[rows, 3 * slides.second], matrix[rows, 3 * slides.second + 1] = -e.imag, e.real
        matrix[rows, 3 * slides.first + 2], matrix[rows, 3 * slides.second + 2] = found.turning
        matrix[angles, 3 * slides.first + 2], matrix[angles, 3 * slides.second + 2] = -found.aligned, found.aligned
        return at + 2 * k

    def _put_others(self, at: int, world: Mapping[str, Pose], whole: Equations) -> int:
        """Write the rows of all other pairs from a row on; return the row behind them."""
        for one in self.others:
            poses, rows = tuple(world[link] for link in one.pair.members), slice(at, at + len(one.scales))
            found = np.reshape(one.pair.jacobian(one.ends, poses), (-1, len(one.columns)))[: len(one.scales)]
            whole.jacobian[rows, one.columns] = found * self.lengths[one.columns] / one.scales[:, None]
            closure = one.pair.closure(one.ends, poses)
            whole.open[rows] = [coefficient(series, 0) for series in closure] / one.scales
            whole.second[rows] = [-2.0 * coefficient(series, 2) for series in closure] / one.scales
            at += len(one.scales)
        return at

    def _put_prescribed(self, at: int, time: float, world: Mapping[str, Pose], whole: Equations) -> None:
        """Write the rows of what drivers prescribe from a row on."""
        for row, one in enumerate(self.prescribed, start=at):
            poses = tuple(world[link] for link in one.pair.members)
            series = one.pair.coordinate(one.ends, poses)
            wanted = (one.first, 0.0, 0.0) if one.law is None else prescribed_rates(self.laws[one.law], time)
            apart = one.sense * coefficient(series, 0) - wanted[0]
            slopes = np.reshape(one.pair.jacobian(one.ends, poses), (-1, len(one.columns)))[-1]
            whole.jacobian[row, one.columns] = one.sense * slopes * self.lengths[one.columns] / one.scale
            whole.open[row] = (apart - whole_turns(apart) if one.pair.free_is_angle else apart) / one.scale
            whole.rates[row] = wanted[1] / one.scale
            whole.second[row] = (wanted[2] - 2.0 * one.sense * coefficient(series, 2)) / one.scale


def link_poses(links: Sequence[str], values: Number, speeds: Number) -> dict[str, Pose]:
    """Return the poses of all links at coordinates, with their rates and without accelerations."""
    z, w = values[0::3] + 1j * values[1::3], speeds[2::3]
    dz, u = speeds[0::3] + 1j * speeds[1::3], np.exp(1j * values[2::3])
    rows = zip(links, z.tolist(), dz.tolist(), u.tolist(), (1j * w * u).tolist(),
               (-0.5 * w * w * u).tolist(), values[2::3].tolist(), w.tolist(), strict=True)  # fmt: skip
    found = {
        link: Pose(Series((a, b, 0j)), Series((c, d, e)), Series((f, g, 0.0))) for link, a, b, c, d, e, f, g in rows
    }
    found[FRAME] = FIXED
    return found


def plain_number(value: Any) -> Any:
    """Return the last of a column, a number as it is."""
    return np.ravel(value)[-1].item() if isinstance(value, np.ndarray) else value


def coefficient(series: Series, k: int) -> float:
    """Return a coefficient of a series as a plain number, zero beyond its order."""
    return float(plain_number(series.c[k])) if len(series.c) > k else 0.0
