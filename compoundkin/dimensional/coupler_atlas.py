"""An atlas of coupler curves: fully turning designs of many chains, each with the descriptor of its curve.

It is made of Sobol's sequence by programs (`curve_chains`), always the same for a seed; `near` finds the designs whose
curves are nearest to a given one over rotation, size, start, direction and mirror image.

A descriptor are Fourier coefficients of the curve resampled evenly along its arc, without the place and of unit sum of
squares: rotation, start, direction and mirror image change their phases and order alone (C. T. Zahn and R. Z. Roskies,
Fourier descriptors for plane closed curves, IEEE Trans. Comput. C-21 (1972) 269-281).
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem, StudyStopped
from compoundkin.base.suffixes import suffix_for
from compoundkin.dimensional import tasks
from compoundkin.dimensional.candidates import Linkage
from compoundkin.dimensional.curve_chains import CRANK, ChainPlan, CurveChain, Laying, curve_chain, curve_chains, turn
from compoundkin.dimensional.curve_conditions import CurveConditions, LaidDesigns
from compoundkin.dimensional.tasks import Conditions, CurveTiming
from compoundkin.files.atomic import new_folder
from compoundkin.files.parsed_document import unreadable
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.samples.random_samples import SobolSample
from compoundkin.studies.study import ends_a_run, run_pieces, workers
from compoundkin.studies.study_folder import part_columns, part_content, part_rows
from compoundkin.studies.study_program import StudyColumn

# Poses of a turn of which a curve is made, those at which a design that is kept must be clear of limits (between 64 one
# in a thousand passes one, where wheels turn fast), and designs that are computed at once.
POSES, CLEAR_AT, BLOCK = 64, 512, 4096
# A curve whose RMS radius is less than this part of its linkage's greatest number is the noise of a point at rest.
LEAST_RADIUS = 0.05
# Draws of a chain for each design that is kept, at most.
DRAWS = 400
# Designs that are compared exactly at once, and of those that are known first.
COMPARED, FEW = 1024, 64
# By how much a likeness in single precision may be above its bound.
ROUNDED = 1e-5
# For each design that is given so many that hold conditions are looked at for different ones.
LOOKED_AT = 16
# Two curves are of one kind where they are apart by less than this part of the way to the wanted one.
TWINS = 0.35

# Samples of a curve, and its harmonics on either side that are kept.
SAMPLES, HARMONICS = 64, 16
# Places of curves whose distance is measured.
MEASURED = 2000
# Starts that are tried along a curve, and lengths of the parts that an open one is held against.
STARTS, PARTS = 64, (16, 24, 32, 40, 48, 56)
# The least sum of squares of a part, of a curve of RMS radius one: less is nearly a straight line or a point.
LEAST_SPREAD = 0.05
# How many designs a chain of eight links has for one of each other.
EIGHTH = 0.12
_ORDERS = np.concatenate([np.arange(1, HARMONICS + 1), np.arange(-HARMONICS, 0)])


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


class AtlasPart(NamedTuple):
    """The designs of one chain, in memory or in a file."""

    chain: CurveChain
    size: int
    held: tuple[Number, Number] | None
    path: Path | None = None

    @property
    def descriptors(self) -> Number:
        """The descriptors of all designs (designs, coefficients)."""
        if self.held is not None:
            return self.held[1]
        assert self.path is not None
        return part_columns(self.path, [_DESCRIPTOR])[_DESCRIPTOR.name].view(np.complex64).reshape(-1, 2 * HARMONICS)

    def designs(self, at: Number = None) -> Number:
        """Return the designs at some places, else all (designs, numbers)."""
        if self.held is not None:
            return self.held[0] if at is None else self.held[0][at]
        assert self.path is not None
        columns = _numbers(self.chain)
        found = part_columns(self.path, columns) if at is None else part_rows(self.path, columns, at)
        return np.stack(list(found.values()), axis=-1)


@dataclass(frozen=True, eq=False, repr=False)
class CouplerAtlas(ShortRepr):
    """Designs of chains with the descriptors of their curves, a part for each chain."""

    parts: tuple[AtlasPart, ...]

    def __len__(self) -> int:
        return sum(part.size for part in self.parts)

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
        if links is not None and links not in (4, 6, 8):
            raise InvalidInput(Problem("links", f"{links!r} links are not in an atlas", "take 4, 6 or 8"))
        if size is not None and not 0.0 < size < np.inf:
            raise InvalidInput(Problem("size", f"lengths do not sum to {size:g}", "give a length above zero"))
        if count < 1:
            raise InvalidInput(Problem("count", f"{count} designs are too few", "give one or more"))
        task = tasks.curve(curve, closed=closed)
        wanted = Conditions.of(region, None, None, transmission, False, tasks.ACCURACY, obstacles)
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
    shown: list[Number] = []
    if sought.timing is not None:
        ranked = _with_timing(part, sought)
    else:
        ranked = (_likely if sought.closed else _likely_parts)(descriptors, sought.points)
    many = FEW
    for block in ranked:
        for some in block.split(many):
            if sought.conditions:
                designs, scale, place, _ = _laid(part, some, sought)
                held = sought.conditions.held(LaidDesigns(part.chain, designs, scale, place, some.mirrored))
                some, many = some.some(held), min(2 * many, COMPARED)
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
    spectrum[:, _ORDERS] = descriptors
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


def best_laid(z: Number, targets: Number, parts: Number | None = None) -> tuple[Number, Number, Number | None]:
    """Return scales and places that lay closed curves, or `parts` of them, on targets, and the crank's angles there.

    Curves (n, poses) have their poses evenly over a turn, targets (n, places) theirs evenly along the arc. All starts
    and both senses are tried. `parts` (n, 2) are where they begin and how long they are along the arc, the angles those
    at the begin and from there to the end, (n, 2).
    """
    n, rows = targets.shape[1], np.arange(len(z))
    if parts is None:
        own = resampled(z, n)
        spectrum, other = np.fft.fft(own - own.mean(axis=1, keepdims=True)), np.fft.fft(targets)
        best = np.zeros(len(z), complex)
        for sense in (spectrum, spectrum[:, (-np.arange(n)) % n]):
            found = np.fft.ifft(other * np.conj(sense))
            found = found[rows, np.abs(found).argmax(axis=1)]
            best = np.where(np.abs(found) > np.abs(best), found, best)
        return *_scaled(best, own, targets), None
    whole, angles = np.hstack([z, z[:, :1]]), np.arange(z.shape[1] + 1) * (TURN / z.shape[1])
    along = arc_parts(whole)
    ends = interpolated_rows(np.stack([parts[:, 0], parts.sum(axis=1)], axis=-1) % 1.0, along, angles)
    window = np.stack([ends[:, 0], (ends[:, 1] - ends[:, 0]) % TURN], axis=-1)
    at = (window[:, :1] + window[:, 1:] * np.linspace(0.0, 1.0, z.shape[1])) % TURN
    return *part_laid(interpolated_rows(at, np.broadcast_to(angles, whole.shape), whole, TURN), targets), window


def part_laid(z: Number, targets: Number) -> tuple[Number, Number]:
    """Return scales and places that lay open curves (n, poses) on targets (n, places) evenly along them, either way."""
    own = resampled(z, targets.shape[1], closed=False)
    forth, back = (on_target(sense, targets) for sense in (own, own[:, ::-1]))
    is_forth = np.abs(forth[0]) >= np.abs(back[0])
    return np.where(is_forth, forth[0], back[0]), np.where(is_forth, forth[1], back[1])


def on_target(own: Number, targets: Number) -> tuple[Number, Number]:
    """Return scales and places that lay curves on targets, place on place (n, places)."""
    best = (np.conj(own - own.mean(axis=1, keepdims=True)) * targets).sum(axis=1)
    return _scaled(best, own, targets)


def _scaled(best: Number, own: Number, targets: Number) -> tuple[Number, Number]:
    middle = own.mean(axis=1)
    scale = best / np.sum(np.abs(own - middle[:, None]) ** 2, axis=1)
    return scale, targets.mean(axis=1) - scale * middle


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

    It is the same whenever it is made. A `folder` keeps it, a Parquet file for each chain: it is made there once, and
    opened from then on, not loaded. Chains are computed here, or `on` other workers: any executor of
    `concurrent.futures`, or a Dask client. Raises InvalidInput for other numbers of links, a negative seed, a folder of
    anything else, and what computes nothing; StudyStopped where workers die.

    >>> len(coupler_atlas(4, 1000))
    1000
    """
    if links not in (4, 6, 8):
        raise InvalidInput(Problem("links", f"{links!r} links are not in an atlas", "take 4, 6 or 8"))
    chains = curve_chains(links)
    if count < len(chains):
        raise InvalidInput(Problem("count", f"{count} designs are too few", f"take one of each chain: {len(chains)}"))
    if seed < 0:
        raise InvalidInput(Problem("seed", f"{seed} is no seed", "give a whole number from 0 on"))
    if folder is None:
        return _atlas(links, count, seed) if on is None else _held(_all_made(links, count, seed, on))
    where = Path(folder)
    definition = json.dumps({"format": 2, "links": links, "count": count, "seed": seed}) + "\n"
    fingerprint = hashlib.sha256(definition.encode()).hexdigest()[:16]
    kept = _definition_in(where)
    if kept is None:
        with new_folder(where) as fresh:
            for k, (chain, designs, descriptors) in enumerate(_all_made(links, count, seed, on)):
                columns = {one.name: designs[:, n] for n, one in enumerate(chain.numbers)}
                columns[_DESCRIPTOR.name] = np.ravel(descriptors.view(f"V{descriptors.strides[0]}"))
                (fresh / _file(k)).write_bytes(part_content([*_numbers(chain), _DESCRIPTOR], [columns], fingerprint))
            (fresh / _DEFINITION).write_text(definition, encoding="utf-8")
    elif kept != definition:
        raise InvalidInput(
            Problem(str(folder), "it holds another atlas", f"it is {kept.strip()[:200]}: name a new one")
        )
    shares = _shares(chains, count)
    return CouplerAtlas(tuple(AtlasPart(chain, share, None, where / _file(k))
                              for k, (chain, share) in enumerate(zip(chains, shares, strict=True))))  # fmt: skip


# The file that says what an atlas in a folder is, and the column of descriptors.
_DEFINITION, _DESCRIPTOR = "atlas.json", StudyColumn("descriptor", "", "output")


def _definition_in(folder: Path) -> str | None:
    """Return what the atlas in a folder is, None where there is none. Raises InvalidInput where it cannot be read."""
    try:
        return (folder / _DEFINITION).read_text(encoding="utf-8")
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise unreadable(folder, f"it cannot be read: {getattr(error, 'strerror', None) or error}") from None


def _file(k: int) -> str:
    return f"{k:03d}{suffix_for('table', 'parquet')}"


def _numbers(chain: CurveChain) -> list[StudyColumn]:
    return [StudyColumn(one.name, "", "dimension") for one in chain.numbers]


@lru_cache(maxsize=4)
def _atlas(links: int, count: int, seed: int) -> CouplerAtlas:
    return _held(_all_made(links, count, seed))


def _held(made: Iterable[tuple[CurveChain, Number, Number]]) -> CouplerAtlas:
    return CouplerAtlas(tuple(AtlasPart(chain, len(designs), (designs, found)) for chain, designs, found in made))


def _shares(chains: Sequence[CurveChain], count: int) -> list[int]:
    """Return how many designs each chain has: of eight links there are as many as of all others."""
    weights = np.array([EIGHTH if chain.links == 8 else 1.0 for chain in chains])
    ends = np.round(np.cumsum(weights) / weights.sum() * (count - len(chains))).astype(int)
    return [int(share) + 1 for share in np.diff(ends, prepend=0)]


class _Piece(NamedTuple):
    """What is computed by itself: so many designs of a chain, where it has eight links on those of its parent."""

    plan: ChainPlan
    kept: int
    seed: int
    base: Number | None = None


def _all_made(links: int, count: int, seed: int, on: Any = None) -> Iterator[tuple[CurveChain, Number, Number]]:
    """Yield chains with their designs and descriptors. Those of eight links are dyads on designs of six."""
    chains, made = curve_chains(links), dict[ChainPlan, Number]()
    shares = enumerate(zip(chains, _shares(chains, count), strict=True))
    pieces = [_Piece(chain.plan, share, seed + k) for k, (chain, share) in shares]
    for is_grown in (False, True):
        some = [piece for piece, chain in zip(pieces, chains, strict=True) if (chain.links == 8) == is_grown]
        if is_grown:
            some = [piece._replace(base=made[curve_chain(piece.plan).parent.plan]) for piece in some]
        for piece, (designs, found) in _in_order(some, on):
            made[piece.plan] = designs
            yield curve_chain(piece.plan), designs, found


def _in_order(pieces: Sequence[_Piece], on: Any) -> Iterator[tuple[_Piece, tuple[Number, Number]]]:
    """Yield pieces in their order with what is made of them, here or on other workers."""
    if on is None:
        yield from ((piece, _made(piece)) for piece in pieces)
        return
    done, wanted = dict[int, tuple[Number, Number]](), 0
    with workers(on, None) as computing:
        assert computing.executor is not None
        numbered = list(enumerate(pieces))
        try:
            for (k, _), found in run_pieces(computing.executor, _made_of_numbered, numbered, computing.room):
                done[k] = found
                while wanted in done:
                    yield pieces[wanted], done.pop(wanted)
                    wanted += 1
        except Exception as error:
            if ends_a_run(error) and not isinstance(error, InvalidInput):
                what = str(error).strip() or type(error).__name__
                raise StudyStopped(Problem("on", what, "make the atlas again")) from error
            raise


def _made_of_numbered(one: tuple[int, _Piece]) -> tuple[Number, Number]:
    return _made(one[1])


def _made(piece: _Piece) -> tuple[Number, Number]:
    """Return the first so many designs of a chain that turn fully, and the descriptors of their curves."""
    chain, count = curve_chain(piece.plan), piece.kept
    most = 1 << max(count * DRAWS, BLOCK).bit_length()
    sample = SobolSample(min(most, 1 << 29), piece.seed)
    designs, found, kept = list[Number](), list[Number](), 0
    for first in range(0, sample.count, BLOCK):
        if kept >= count:
            break
        units = sample.units(len(chain.numbers), range(first, first + BLOCK))
        drawn = chain.designs(units)
        if piece.base is not None:
            own = piece.base[np.arange(first, first + BLOCK) % len(piece.base)].astype(float)
            drawn = chain.parent.grown_designs(chain, own, units, keep=False)
        drawn = drawn.astype(np.float32).astype(float)  # as they are kept
        curves, clear = chain.curves(drawn, POSES)
        drawn, curves = drawn[clear], curves[clear]
        own, radius = coefficients(curves)
        seen = radius > LEAST_RADIUS * chain.size(drawn)
        seen[seen] = chain.curves(drawn[seen], CLEAR_AT)[1]
        designs.append(drawn[seen].astype(np.float32))
        found.append(own[seen].astype(np.complex64))
        kept += int(seen.sum())
    return np.concatenate(designs)[:count], np.concatenate(found)[:count]


def resampled(curves: Number, samples: int, closed: bool = True) -> Number:
    """Return curves (curves, places) evenly along their arcs, (curves, samples), of open ones both ends."""
    z = np.concatenate([curves, curves[:, :1]], axis=1) if closed else curves
    wanted = np.linspace(0.0, 1.0, samples, endpoint=not closed)
    return interpolated_rows(np.broadcast_to(wanted, (len(z), samples)), arc_parts(z), z)


def arc_parts(curves: Number) -> Number:
    """Return which part of the arc lies before each place of open curves, (curves, places): 0 at first, 1 at last."""
    along = np.zeros(curves.shape)
    np.cumsum(np.abs(np.diff(curves, axis=1)), axis=1, out=along[:, 1:])
    total = along[:, -1:]
    return along / np.where(total > 0.0, total, 1.0)


def interpolated_rows(at: Number, x: Number, y: Number, long: float = 1.0) -> Number:
    """Return rows of y over x at places from 0 to `long`, in one interpolation: each row has an interval of its own."""
    rows = 2.0 * long * np.arange(len(x))[:, None]
    y = np.broadcast_to(y, x.shape)
    return np.interp((rows + at).ravel(), (rows + x).ravel(), y.ravel()).reshape(at.shape)


def coefficients(curves: Number) -> tuple[Number, Number]:
    """Return the descriptors of closed curves, (curves, 2 HARMONICS), and their RMS radii (curves,)."""
    found = np.fft.fft(resampled(curves, SAMPLES), axis=1)[:, _ORDERS] / SAMPLES
    radius = np.sqrt((np.abs(found) ** 2).sum(axis=1))
    return found / np.where(radius > 0.0, radius, 1.0)[:, None], radius


def likeness(descriptors: Number, wanted: Number) -> tuple[Number, Number]:
    """Return the greatest correlation of descriptors (n, 2 HARMONICS) with a wanted one, and whether mirrored (n,).

    It is the greatest over rotation, start, direction and mirror image: over all rotations the correlation is the
    absolute value of one number for each start.
    """
    from scipy.fft import ifft  # in single precision, as descriptors are kept

    wanted = np.conj(wanted).astype(np.complex64)
    back = descriptors[:, ::-1]  # orders are 1..n, -n..-1
    spectrum = np.zeros((len(descriptors), STARTS), np.complex64)
    found = []
    for own in (descriptors, back, np.conj(back), np.conj(descriptors)):
        spectrum[:, 1 : HARMONICS + 1] = own[:, :HARMONICS] * wanted[:HARMONICS]
        spectrum[:, -HARMONICS:] = own[:, HARMONICS:] * wanted[HARMONICS:]
        at = ifft(spectrum, axis=1)
        found.append(np.sqrt((at.real**2 + at.imag**2).max(axis=1)) * STARTS)
    plain, mirrored = np.maximum(*found[:2]), np.maximum(*found[2:])
    return np.maximum(plain, mirrored), mirrored > plain


def mean_distance(curve: Number, target: Number, closed: bool = True) -> float:
    """Return the mean nearest distance of curves both ways, summed, in the target's RMS radius.

    It is taken at places that lie evenly along the arcs, to the lines between those of the other curve.
    """
    one, two = (resampled(each[None], MEASURED, closed)[0] for each in (curve, target))
    radius = np.sqrt(np.mean(np.abs(two - two.mean()) ** 2))
    there, back = nearest_distances(one, two, closed), nearest_distances(two, one, closed)
    return float((there.mean() + back.mean()) / radius)


def nearest_distances(places: Number, curve: Number, closed: bool) -> Number:
    """Return the distances of places (n,) from a curve, by the lines next to its nearest place."""
    from scipy.spatial import cKDTree

    _, at = cKDTree(np.stack([curve.real, curve.imag], axis=-1)).query(np.stack([places.real, places.imag], axis=-1))
    best = np.abs(places - curve[at])
    for side in (-1, 1):
        beside = (at + side) % len(curve) if closed else np.clip(at + side, 0, len(curve) - 1)
        way = curve[beside] - curve[at]
        part = np.clip(((places - curve[at]) * np.conj(way)).real / np.maximum(np.abs(way) ** 2, 1e-300), 0.0, 1.0)
        best = np.minimum(best, np.abs(places - curve[at] - part * way))
    return best
