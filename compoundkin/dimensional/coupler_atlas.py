"""An atlas of coupler curves: fully turning designs of many chains (`atlas_designs`), and those near a curve.

`near` finds the designs whose curves are nearest to a given one over rotation, size, start, direction and mirror image,
by descriptors of the curves (`curve_likeness`).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.dimensional.atlas_designs import (
    BLOCK,
    POSES,
    AtlasPart,
    AtlasPlan,
    opened_parts,
    parts_in_folder,
    parts_in_memory,
)
from compoundkin.dimensional.candidates import Linkage
from compoundkin.dimensional.curve_chains import CRANK, CurveChain, Laying, turn
from compoundkin.dimensional.curve_conditions import CurveConditions, LaidDesigns, UnlaidDesigns
from compoundkin.dimensional.curve_likeness import (
    ORDERS,
    SAMPLES,
    STARTS,
    best_laid,
    coefficients,
    likeness,
    on_target,
    resampled,
)
from compoundkin.dimensional.task_words import curve as curve_task
from compoundkin.dimensional.tasks import ACCURACY, Conditions, CurveTiming
from compoundkin.model.mechanism import Mechanism

# Designs that are compared exactly at once, and of those that are known first.
COMPARED, FEW = 1024, 64
# By how much a likeness in single precision may be above its bound.
ROUNDED = 1e-5
# For each design that is given so many that hold conditions are looked at for different ones.
LOOKED_AT = 16
# Two curves are of one kind where they are apart by less than this part of the way to the wanted one.
TWINS = 0.35
# Lengths of the parts that an open curve is held against.
PARTS = (16, 24, 32, 40, 48, 56)
# The least sum of squares of a part, of a curve of RMS radius one: less is nearly a straight line or a point.
LEAST_SPREAD = 0.05


class AtlasMatch(NamedTuple):
    """A design of the atlas near a curve, laid on it, and how far apart the curves are.

    `apart` is the root of the mean square over places at equal parts of the arcs, or of the driver's turn for a curve
    with timing, in the curve's RMS radius. `window` is of an open curve, or one with timing, the crank's angle at which
    it begins and the turn from there.
    """

    chain: CurveChain
    design: Number
    laying: Laying
    apart: float
    window: tuple[float, float] | None = None

    @property
    def links(self) -> int:
        """How many links it has."""
        return self.chain.links

    @property
    def linkage(self) -> Linkage:
        """The linkage where it lies on the curve, over a turn."""
        return self.chain.linkage(np.asarray(self.design, float), self.laying, turn(POSES))

    @property
    def mechanism(self) -> Mechanism:
        """The mechanism where it lies on the curve; its point is P, its driver the crank."""
        return self.linkage.mechanism(CRANK, turn(POSES + 1))


@dataclass(frozen=True, eq=False, repr=False)
class CouplerAtlas(ShortRepr):
    """Designs of chains with the descriptors of their curves, a part for each chain."""

    parts: tuple[AtlasPart, ...]

    def __len__(self) -> int:
        return sum(part.size for part in self.parts)

    @classmethod
    @checked
    def open(cls, folder: str | os.PathLike[str]) -> CouplerAtlas:
        """Return the atlas that a folder holds, whatever it is. Raises InvalidInput where it holds none."""
        return cls(opened_parts(folder))

    @property
    def links(self) -> tuple[int, ...]:
        """The numbers of links that its linkages have."""
        return tuple(sorted({part.chain.links for part in self.parts if part.size}))

    @property
    def chains(self) -> tuple[CurveChain, ...]:
        """The chains of its designs."""
        return tuple(part.chain for part in self.parts)

    @checked
    def near(
        self,
        curve: Any,
        count: int = 20,
        *,
        closed: bool | None = None,
        links: int | None = None,
        sliders: bool = True,
        size: float | None = None,
        region: Any = None,
        transmission: float = 0.0,
        obstacles: Any = None,
    ) -> list[AtlasMatch]:
        """Return designs near a curve, complex (places,) or (places, 2), of different shapes, the nearest first.

        They are the nearest over rotation, size, start (in parts of the arc), direction and mirror image, none is
        missed: bounds by the magnitudes of coefficients say where correlations need not be looked at. They are fewer
        than `count` where sixteen times as many have no more different shapes. A curve whose
        ends do not meet is `closed` False: it is held against parts of the designs' curves.

        Those of at most so many `links`, without `sliders`, whose lengths sum to `size` at most, with all fixed pivots
        in a `region` (two corners or a polygon), with a least `transmission` angle (radians), and clear of `obstacles`
        (polygons), as they lie on the curve: conditions are looked at as designs are found, none is missed. Raises
        InvalidInput for what is no curve or condition.

        >>> import numpy as np
        >>> found = coupler_atlas(4, 1000).near(np.exp(1j * np.linspace(0, 6, 40)), 3, closed=True)
        >>> [one.links for one in found]
        [4, 4, 4]
        """
        if links is not None and links not in self.links:
            known = ", ".join(map(str, self.links))
            raise InvalidInput(Problem("links", f"{links!r} links are not in this atlas", f"it has those of {known}"))
        if size is not None and not 0.0 < size < np.inf:
            raise InvalidInput(Problem("size", f"lengths do not sum to {size:g}", "give a length above zero"))
        if count < 1:
            raise InvalidInput(Problem("count", f"{count} designs are too few", "give one or more"))
        task = curve_task(curve, closed=closed)
        wanted = Conditions.of(region, None, None, transmission, False, ACCURACY, obstacles)
        sought = SoughtCurve(task.points, task.closed, None, CurveConditions(wanted, size))
        return self.nearest(sought, count, links=links, sliders=sliders)

    def nearest(
        self, sought: SoughtCurve, count: int, *, links: int | None = None, sliders: bool = True
    ) -> list[AtlasMatch]:
        """Return what `near` does, for a curve with its timing and conditions."""
        kept = [part for part in self.parts if sliders or not part.chain.has_slider]
        kept = [part for part in kept if part.size and (links is None or part.chain.links <= links)]
        each = max(2, -(-2 * count // max(len(kept), 1)))
        found = [(float(one.apart[0]), k, one) for k, part in enumerate(kept)
                 for one in islice(_different(part, sought, LOOKED_AT * each), each)]  # fmt: skip
        found = sorted(found, key=lambda one: one[0])[:count]
        matches = list[AtlasMatch]()
        for k in sorted({k for _, k, _ in found}):
            matches += _matches(kept[k], _Ranked.joined([one for _, of, one in found if of == k]), sought)
        return sorted(matches, key=lambda one: one.apart)

    def designs_for(
        self, mechanism: Mechanism, ranges: Mapping[str, tuple[complex, complex]], seed: int = 0
    ) -> dict[str, Number]:
        """Return values of dimensions by name, (designs,), with which a mechanism is a design of the atlas.

        Raises InvalidInput where the mechanism is no chain of it.
        """
        from compoundkin.dimensional.atlas_starts import designs_for

        held = [(part.chain, part.designs) for part in self.parts if part.size]
        return designs_for(held, mechanism, ranges, seed)


class SoughtCurve(NamedTuple):
    """A curve that designs are to be near, complex (places,), what it must be like, and what must hold of them."""

    points: Number
    closed: bool
    timing: CurveTiming | None = None
    conditions: CurveConditions = CurveConditions(Conditions())

    def seen(self, samples: int) -> Number:
        """Return so many places evenly along it, of one with timing evenly over the driver's turn."""
        if self.timing is None:
            return resampled(self.points[None], samples, self.closed)[0]
        parts, points = self.timing.parts, self.points
        if self.closed:
            parts, points = np.append(parts, 1.0), np.append(points, points[0])
        return np.interp(np.linspace(0.0, 1.0, samples, endpoint=not self.closed), parts, points)


class _Ranked(NamedTuple):
    """Designs of a part in the order of their likeness: its value, their places, whether mirrored, and which part.

    `window` is where a part begins and how long it is, in parts of the arc (or with timing of the turn), (n, 2).
    """

    likeness: Number
    at: Number
    mirrored: Number
    window: Number | None = None

    @property
    def apart(self) -> Number:
        """How far apart the curves are."""
        return np.sqrt(np.maximum(0.0, 2.0 - 2.0 * self.likeness.astype(float)))

    def some(self, kept: Any) -> _Ranked:
        """Return some of them."""
        return _Ranked(*(None if each is None else each[kept] for each in self))

    def split(self, many: int) -> Iterator[_Ranked]:
        """Yield so many at a time."""
        for first in range(0, len(self.at), many):
            yield self.some(slice(first, first + many))

    @staticmethod
    def joined(parts: Sequence[_Ranked]) -> _Ranked:
        """Return several as one."""
        return _Ranked(*(None if each[0] is None else np.concatenate(each) for each in zip(*parts, strict=True)))


def _different(part: AtlasPart, sought: SoughtCurve, looked_at: int) -> Iterator[_Ranked]:
    """Yield the nearest designs of one chain that hold the conditions, one by one, none a twin of one before.

    So many that hold are looked at.
    """
    descriptors = part.descriptors
    if sought.conditions:
        part = part.in_memory(descriptors)
    shown: list[Number] = []
    if sought.timing is not None:
        ranked = _with_timing(part, sought)
    else:
        ranked = (_likely if sought.closed else _likely_parts)(descriptors, sought.points)
    many = FEW
    for block in ranked:
        for some in block.split(many):
            if sought.conditions:
                some, many = _held(part, some, sought), min(2 * many, COMPARED)
            if looked_at <= 0:
                return
            some = some.some(slice(looked_at))
            looked_at -= len(some.at)
            own = descriptors[some.at]
            # no twin is as near as this
            limit = 1.0 - (TWINS * some.apart) ** 2 / 2.0
            alike = np.zeros(len(own), bool)
            for one in shown:
                alike |= _alike(own, one, limit, ~alike)
            for k in range(len(own)):
                if not alike[k]:
                    shown.append(own[k])
                    alike |= _alike(own, own[k], limit, ~alike)
                    yield some.some(slice(k, k + 1))


def _held(part: AtlasPart, some: _Ranked, sought: SoughtCurve) -> _Ranked:
    """Return those that hold the conditions: of closed curves without timing those that may are laid alone."""
    if sought.closed and sought.timing is None:
        target, (radius, middle) = sought.seen(SAMPLES), part.extents
        center = complex(target.mean())
        size = float(np.sqrt(np.mean(np.abs(target - center) ** 2)))
        own = part.designs(some.at), some.likeness, radius[some.at], middle[some.at]
        some = some.some(sought.conditions.possible(UnlaidDesigns(part.chain, *own, size, center)))
    if not len(some.at):
        return some
    designs, scale, place, _ = _laid(part, some, sought)
    return some.some(sought.conditions.held(LaidDesigns(part.chain, designs, scale, place, some.mirrored)))


def _alike(descriptors: Number, one: Number, limit: Number, asked: Number) -> Number:
    """Return which descriptors that are asked are more like one than a limit for each: by magnitudes, then exactly."""
    magnitudes, sizes = np.abs(descriptors), np.abs(one)
    asked = asked & (np.maximum(magnitudes @ sizes, magnitudes @ sizes[::-1]) > limit - ROUNDED)
    alike = np.zeros(len(descriptors), bool)
    if asked.any():
        alike[asked] = likeness(descriptors[asked], one)[0] > limit[asked]
    return alike


def _matches(part: AtlasPart, some: _Ranked, sought: SoughtCurve) -> list[AtlasMatch]:
    """Return designs of a part laid on a curve."""
    designs, scale, place, window = _laid(part, some, sought)
    layings = map(Laying, scale.tolist(), place.tolist(), some.mirrored.tolist())
    windows = [None] * len(designs) if window is None else list(map(tuple, window.tolist()))
    return list(map(AtlasMatch, [part.chain] * len(designs), designs, layings, some.apart.tolist(), windows))


def _laid(part: AtlasPart, some: _Ranked, sought: SoughtCurve) -> tuple[Number, Number, Number, Number | None]:
    """Return ranked designs, the scales and places that lay them on a curve, and the crank's angles there."""
    designs, target = part.designs(some.at).astype(float), sought.seen(SAMPLES)
    targets = np.where(some.mirrored[:, None], np.conj(target), target)
    if sought.timing is None:
        return designs, *best_laid(part.chain.curves(designs, 2 * POSES)[0], targets, some.window)
    assert some.window is not None
    window, parts = TURN * some.window, np.linspace(0.0, 1.0, SAMPLES, endpoint=not sought.closed)
    z, _ = part.chain.places(designs, window[:, :1] + window[:, 1:] * parts)
    return designs, *on_target(z, targets), window


def _in_blocks(value: Number, mirrored: Number, window: Number) -> Iterator[_Ranked]:
    """Yield designs in the order of their likeness, more and more at once."""
    order, first, many = np.argsort(-value, kind="stable"), 0, FEW
    while first < len(order):
        at = order[first : first + many]
        yield _Ranked(value[at], at, mirrored[at], window[at])
        first, many = first + many, min(2 * many, COMPARED)


def _likely(descriptors: Number, curve: Number) -> Iterator[_Ranked]:
    """Yield designs by their likeness to a closed curve.

    Likeness is computed in the order of a bound by magnitudes alone; what is nearer than the next bound comes next.
    """
    wanted = coefficients(curve[None])[0][0]
    sizes = np.abs(wanted).astype(np.float32)
    magnitudes = np.abs(descriptors)
    bound = np.maximum(magnitudes @ sizes, magnitudes @ sizes[::-1])
    waiting = _Ranked(np.zeros(0), np.zeros(0, int), np.zeros(0, bool))
    for order, least in _falling(bound):
        value, mirrored = likeness(descriptors[order], wanted)
        merged = [np.append(one, new) for one, new in zip(waiting, (value, order, mirrored), strict=False)]
        waiting = _Ranked(*merged).some(np.argsort(-merged[0], kind="stable"))
        ready = int(np.searchsorted(-waiting.likeness, -(least + ROUNDED)))
        if ready:
            yield waiting.some(slice(ready))
            waiting = waiting.some(slice(ready, None))


def _falling(bound: Number) -> Iterator[tuple[Number, float]]:
    """Yield places of numbers, the greatest first, some at once, and the greatest of those left."""
    many = 2 * FEW
    left = np.arange(len(bound))
    while len(left):
        if many < len(left):
            parted = np.argpartition(-bound[left], many)
            chosen, left = left[parted[:many]], left[parted[many:]]
        else:
            chosen, left = left, left[:0]
        yield np.sort(chosen), float(bound[left].max()) if len(left) else -np.inf
        many *= 2


def _likely_parts(descriptors: Number, curve: Number) -> Iterator[_Ranked]:
    """Yield designs by the likeness of parts of their curves to an open one."""
    from scipy.fft import ifft

    spectrum = np.zeros((len(descriptors), STARTS), np.complex64)
    spectrum[:, ORDERS] = descriptors
    z = ifft(spectrum, axis=1) * STARTS
    sought = {long: resampled(curve[None], long, closed=False)[0] for long in PARTS}
    # either sense, and mirrored
    variants = [(long, sense, mirrored) for long in PARTS for sense in (1, -1) for mirrored in (False, True)]
    value, start, found = _best_parts(z, [_seen(sought[long], sense, is_seen) for long, sense, is_seen in variants])
    long, _, mirrored = (np.array(each)[found] for each in zip(*variants, strict=True))
    window = np.stack([start / STARTS, (long - 1) / STARTS], axis=-1)
    yield from _in_blocks(np.minimum(value, 1.0), mirrored, window)


def _with_timing(part: AtlasPart, sought: SoughtCurve) -> Iterator[_Ranked]:
    """Yield designs by the likeness of parts of their turn to a curve with timing: place for place, at each time."""
    timing, designs = sought.timing, part.designs()
    assert timing is not None
    z = np.concatenate([part.chain.curves(designs[k : k + BLOCK].astype(float), STARTS)[0].astype(np.complex64)
                        for k in range(0, len(designs), BLOCK)])  # fmt: skip
    z -= z.mean(axis=1, keepdims=True)
    if sought.closed:
        lengths: Sequence[int] = (STARTS,)
    elif timing.turn:
        # a part that is all of the turn ends a step before it begins again
        lengths = (min(max(2, round(abs(timing.turn) / TURN * STARTS) + 1), STARTS),)
    else:
        lengths = PARTS
    variants = [(long, sense, mirrored) for long in lengths for sense in (1, -1) for mirrored in (False, True)
                if timing.either or ((sense < 0) != mirrored) == (timing.turn < 0)]  # fmt: skip
    value, start, found = _best_parts(
        z, [_seen(sought.seen(long), sense, is_seen) for long, sense, is_seen in variants]
    )
    long, sense, mirrored = (np.array(each)[found] for each in zip(*variants, strict=True))
    turned = long / STARTS if sought.closed else (long - 1) / STARTS
    if timing.turn:
        turned = np.full(len(z), abs(timing.turn) / TURN)
    begin = start / STARTS
    # backwards it begins where the part ends, of a whole turn a step before
    begin = np.where(sense < 0, begin + (long - 1) / STARTS, begin)
    yield from _in_blocks(np.minimum(value, 1.0), mirrored, np.stack([begin, sense * turned], axis=-1))


def _seen(curve: Number, sense: int, mirrored: bool) -> Number:
    return (np.conj(curve) if mirrored else curve)[::sense]


def _best_parts(z: Number, variants: Sequence[Number]) -> tuple[Number, Number, Number]:
    """Return the best likeness of parts of closed curves (n, STARTS) to any of some curves, where it begins, and which.

    A part's correlation with a curve over all places where it may begin is one transform; what it is divided by, the
    part's own sum of squares, is a difference of running sums.
    """
    from scipy.fft import fft, ifft

    spectrum = fft(z, axis=1)
    whole = (np.abs(spectrum[:, 1:]) ** 2).sum(axis=1, keepdims=True)
    least = LEAST_SPREAD * whole / STARTS**2
    best, at, which = np.zeros(len(z)), np.zeros(len(z), int), np.zeros(len(z), int)
    # what is divided by: of a whole curve that is the same wherever it begins
    spreads = {STARTS: np.sqrt(whole / STARTS)}
    if any(len(curve) != STARTS for curve in variants):
        running = [np.pad(np.cumsum(np.tile(one, 2), axis=1), ((0, 0), (1, 0))) for one in (z, z.real**2 + z.imag**2)]
    for k, curve in enumerate(variants):
        long = len(curve)
        if long not in spreads:
            sums, squares = (one[:, long : long + STARTS] - one[:, :STARTS] for one in running)
            spreads[long] = np.sqrt(np.maximum(squares - np.abs(sums) ** 2 / long, least))
        own = (curve - curve.mean()) / np.linalg.norm(curve - curve.mean())
        other = fft(np.pad(own, (0, STARTS - long)).astype(np.complex64))
        value = np.abs(ifft(spectrum * np.conj(other), axis=1)) / spreads[long]
        start = value.argmax(axis=1)
        value = value[np.arange(len(z)), start]
        better = value > best
        best[better], at[better], which[better] = value[better], start[better], k
    return best, at, which


@checked
def coupler_atlas(
    links: int = 6,
    count: int = 1_000_000,
    seed: int = 0,
    folder: str | os.PathLike[str] | None = None,
    *,
    on: Any = None,
) -> CouplerAtlas:
    """Return an atlas of so many designs whose driver turns fully, of chains of at most so many links: 4, 6 or 8.

    It is the same whenever it is made. A `folder` keeps it, a Parquet file for each chain: it is made there once, gone
    on with where that was ended, and opened from then on, not loaded. Chains are computed here, or `on` other workers:
    any executor of `concurrent.futures`, or a Dask client. Raises InvalidInput for other numbers of links, a negative
    seed, a folder of anything else, and what computes nothing; StudyStopped where workers die.

    >>> len(coupler_atlas(4, 1000))
    1000
    """
    plan = AtlasPlan(links, count, seed).checked()
    if folder is not None:
        return CouplerAtlas(parts_in_folder(plan, folder, on))
    return _atlas(plan) if on is None else CouplerAtlas(parts_in_memory(plan, on))


@lru_cache(maxsize=4)
def _atlas(plan: AtlasPlan) -> CouplerAtlas:
    return CouplerAtlas(parts_in_memory(plan))
