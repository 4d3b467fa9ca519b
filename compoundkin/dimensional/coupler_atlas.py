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
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import InvalidInput, Problem
from compoundkin.base.suffixes import suffix_for
from compoundkin.dimensional import tasks
from compoundkin.dimensional.candidates import Linkage
from compoundkin.dimensional.curve_chains import CRANK, ChainPlan, CurveChain, Laying, curve_chains, turn
from compoundkin.dimensional.defects import least_transmission
from compoundkin.dimensional.tasks import Conditions
from compoundkin.files.atomic import new_folder
from compoundkin.files.parsed_document import unreadable
from compoundkin.kinematics import solve
from compoundkin.model.mechanism import Mechanism
from compoundkin.studies.samples.random_samples import SobolSample
from compoundkin.studies.study_folder import part_columns, part_content
from compoundkin.studies.study_program import StudyColumn

# Poses of a turn of which a curve is made, those at which a design that is kept must be clear of limits (between 64 one
# in a thousand passes one, where wheels turn fast), and designs that are computed at once.
POSES, CLEAR_AT, BLOCK = 64, 512, 4096
# A curve whose RMS radius is less than this part of its linkage's greatest number is the noise of a point at rest.
LEAST_RADIUS = 0.05
# Draws of a chain for each design that is kept, at most.
DRAWS = 400
# Designs that are compared exactly at once.
COMPARED = 1024
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

    `apart` is the root of the mean square over places at equal parts of the arcs, in the curve's RMS radius. `part` is
    of an open curve where along the arc of the design's curve it begins, and how long it is, in parts of that arc.
    """

    chain: CurveChain
    design: Number
    laying: Laying
    apart: float
    part: tuple[float, float] | None = None

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
    fingerprint: str = ""

    def read(self) -> tuple[Number, Number]:
        """Return designs (designs, numbers) and descriptors (designs, coefficients)."""
        if self.held is not None:
            return self.held
        assert self.path is not None
        found = part_columns(self.path, _columns(self.chain))
        descriptors = np.ascontiguousarray(found.pop(_DESCRIPTOR)).view(np.complex64)
        return np.stack(list(found.values()), axis=-1), descriptors


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
    ) -> list[AtlasMatch]:
        """Return designs near a curve, complex (places,) or (places, 2), of different shapes, the nearest first.

        They are the nearest over rotation, size, start (in parts of the arc), direction and mirror image, none is
        missed: bounds by the magnitudes of coefficients say where correlations need not be looked at. A curve whose
        ends do not meet is `closed` False: it is held against parts of the designs' curves.

        Those of at most so many `links`, without `sliders`, whose lengths sum to `size` at most, with all fixed pivots
        in a `region` (two corners or a polygon), and with a least `transmission` angle (radians), as they lie on the
        curve. Raises InvalidInput for what is no curve or condition.

        >>> import numpy as np
        >>> found = coupler_atlas(4, 1000).near(np.exp(1j * np.linspace(0, 6, 40)), 3, closed=True)
        >>> [one.links for one in found]
        [4, 4, 4]
        """
        task = tasks.curve(curve, closed=closed)
        wanted = Conditions.of(region, None, None, transmission, False, tasks.ACCURACY)
        kept = [part for part in self.parts if sliders or not part.chain.has_slider]
        kept = [part for part in kept if part.size and (links is None or part.chain.links <= links)]
        bound = size is not None or region is not None or transmission > 0.0
        each = max(2, -(-(8 if bound else 2) * count // max(len(kept), 1)))
        found = [match for part in kept for match in _nearest(part, task.points, task.closed, each)]
        found.sort(key=lambda match: match.apart)
        if bound:
            found = list(islice((match for match in found if _holds(match, size, wanted)), count))
        return found[:count]

    def designs_for(
        self, mechanism: Mechanism, ranges: Mapping[str, tuple[complex, complex]], seed: int = 0
    ) -> dict[str, Number]:
        """Return values of dimensions by name, (designs,), with which a mechanism is a design of the atlas.

        Raises InvalidInput where the mechanism is no chain of it.
        """
        from compoundkin.dimensional.atlas_starts import designs_for

        held = [(part.chain, lambda part=part: part.read()[0]) for part in self.parts if part.size]
        return designs_for(held, mechanism, ranges, seed)


def _holds(match: AtlasMatch, size: float | None, wanted: Conditions) -> bool:
    """Return whether a match fulfils conditions where it lies."""
    linkage = match.linkage
    if (size is not None and linkage.span > size) or not all(map(wanted.holds, linkage.pivots)):
        return False
    if not wanted.transmission:
        return True
    return least_transmission(solve(match.mechanism, order=0), between=False) >= wanted.transmission


def _nearest(part: AtlasPart, curve: Number, closed: bool, count: int) -> Iterator[AtlasMatch]:
    """Yield the nearest designs of one chain, none a twin of another."""
    designs, descriptors = part.read()
    look = _likely if closed else _likely_parts
    shown: list[Number] = []
    target = resampled(curve[None], SAMPLES, closed)[0]
    for likeness_of_it, k, mirrored, window in look(descriptors, curve, count):
        apart = float(np.sqrt(max(0.0, 2.0 - 2.0 * likeness_of_it)))
        own = descriptors[k]
        if shown and likeness(np.array(shown), own)[0].max() > 1.0 - (TWINS * apart) ** 2 / 2.0:
            continue
        shown.append(own)
        z = part.chain.curves(np.asarray(designs[[k]], float), 2 * POSES)[0][0]
        scale, place, _ = best_laid(z, np.conj(target) if mirrored else target, window)
        yield AtlasMatch(part.chain, designs[k], Laying(scale, place, mirrored), apart, window)
        if len(shown) == count:
            return


_Likely = Iterator[tuple[float, int, bool, tuple[float, float] | None]]


def _likely(descriptors: Number, curve: Number, count: int) -> _Likely:
    """Yield the likeness of the nearest designs to a closed curve, their places, and whether mirrored."""
    wanted = coefficients(curve[None])[0][0]
    sizes, magnitudes = np.abs(wanted).astype(np.float32), np.abs(descriptors)
    bound = np.maximum(magnitudes @ sizes, magnitudes @ sizes[::-1])
    order = np.argsort(-bound)
    wide, kept = 16 * count, np.zeros(0, int)
    best, mirrored = np.zeros(0), np.zeros(0, bool)
    for first in range(0, len(order), COMPARED):
        part = order[first : first + COMPARED]
        if len(best) >= wide and bound[part[0]] <= np.partition(best, -wide)[-wide]:
            break
        value, is_mirrored = likeness(descriptors[part], wanted)
        best, mirrored, kept = np.append(best, value), np.append(mirrored, is_mirrored), np.append(kept, part)
    for j in np.argsort(-best)[:wide]:
        yield float(best[j]), int(kept[j]), bool(mirrored[j]), None


def _likely_parts(descriptors: Number, curve: Number, count: int) -> _Likely:
    """Yield the likeness of parts of curves to an open one, their places, whether mirrored, and which part.

    A part's correlation with the curve over all places where it may begin is one transform; what it is divided by, the
    part's own sum of squares, is a difference of running sums.
    """
    from scipy.fft import fft, ifft

    spectrum = np.zeros((len(descriptors), STARTS), np.complex64)
    spectrum[:, _ORDERS] = descriptors
    z = ifft(spectrum, axis=1) * STARTS
    spectrum = fft(z, axis=1)
    running = [np.pad(np.cumsum(np.tile(one, 2), axis=1), ((0, 0), (1, 0))) for one in (z, z.real**2 + z.imag**2)]
    best, found = np.zeros(len(z)), np.zeros((len(z), 3), int)
    for long in PARTS:
        sums, squares = (one[:, long : long + STARTS] - one[:, :STARTS] for one in running)
        spread = squares - np.abs(sums) ** 2 / long
        wanted = resampled(curve[None], long, closed=False)[0]
        wanted = (wanted - wanted.mean()) / np.linalg.norm(wanted - wanted.mean())
        for k, own in enumerate((wanted, wanted[::-1], np.conj(wanted), np.conj(wanted[::-1]))):
            other = fft(np.pad(own, (0, STARTS - long)).astype(np.complex64))
            value = np.abs(ifft(spectrum * np.conj(other), axis=1)) / np.sqrt(np.maximum(spread, LEAST_SPREAD))
            start = value.argmax(axis=1)
            value = value[np.arange(len(z)), start]
            better = value > best
            best[better] = value[better]
            found[better] = np.stack([start, np.full(len(z), long), np.full(len(z), k > 1)], axis=-1)[better]
    for k in np.argsort(-best)[: 16 * count]:
        start, long, mirrored = found[k].tolist()
        yield float(min(best[k], 1.0)), int(k), bool(mirrored), (start / STARTS, (long - 1) / STARTS)


def best_laid(
    z: Number, target: Number, part: tuple[float, float] | None = None
) -> tuple[complex, complex, tuple[float, ...]]:
    """Return scale and place that lay a closed curve, or a part of it, on a target, and the crank's angles there.

    Both have places evenly along the target's arc, and the curve's poses evenly over a turn. All starts and both senses
    are tried. The angles are those of the begin, and from there to the end; none of a whole curve.
    """
    n = len(target)
    window: tuple[float, ...] = ()
    if part is None:
        own = resampled(z[None], n)[0]
        spectrum, best = np.fft.fft(own - own.mean()), 0j
        for sense in (spectrum, spectrum[(-np.arange(n)) % n]):
            found = np.fft.ifft(np.fft.fft(target) * np.conj(sense))
            best = max(best, found[np.abs(found).argmax()], key=abs)
    else:
        whole, angles = np.append(z, z[:1]), np.arange(len(z) + 1) * (TURN / len(z))
        along = np.append(0.0, np.cumsum(np.abs(np.diff(whole))))
        ends = np.interp(np.array([part[0], part[0] + part[1]]) % 1.0, along / along[-1], angles)
        window = (float(ends[0]), float((ends[1] - ends[0]) % TURN))
        traced = np.interp((window[0] + window[1] * np.linspace(0.0, 1.0, len(z))) % TURN, angles, whole)
        own = resampled(traced[None], n, closed=False)[0]
        best = max((np.vdot(sense - own.mean(), target) for sense in (own, own[::-1])), key=abs)
    scale = complex(best) / float(np.sum(np.abs(own - own.mean()) ** 2))
    return scale, complex(target.mean() - scale * own.mean()), window


@checked
def coupler_atlas(
    links: int = 6, count: int = 1_000_000, seed: int = 0, folder: str | os.PathLike[str] | None = None
) -> CouplerAtlas:
    """Return an atlas of so many designs whose driver turns fully, of chains of at most so many links: 4, 6 or 8.

    It is the same whenever it is made. A `folder` keeps it, a Parquet file for each chain: it is made there once, and
    opened from then on, not loaded. Raises InvalidInput for other numbers of links, a negative seed, and a folder of
    anything else.

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
        return _atlas(links, count, seed)
    where = Path(folder)
    definition = json.dumps({"format": 1, "links": links, "count": count, "seed": seed}) + "\n"
    fingerprint = hashlib.sha256(definition.encode()).hexdigest()[:16]
    kept = _definition_in(where)
    if kept is None:
        with new_folder(where) as fresh:
            for k, (chain, designs, descriptors) in enumerate(_all_made(links, count, seed)):
                columns = {one.name: designs[:, n] for n, one in enumerate(chain.numbers)}
                columns[_DESCRIPTOR] = descriptors.view(np.float32)
                (fresh / _file(k)).write_bytes(part_content(_columns(chain), [columns], fingerprint))
            (fresh / _DEFINITION).write_text(definition, encoding="utf-8")
    elif kept != definition:
        raise InvalidInput(
            Problem(str(folder), "it holds another atlas", f"it is {kept.strip()[:200]}: name a new one")
        )
    shares = _shares(chains, count)
    return CouplerAtlas(tuple(AtlasPart(chain, share, None, where / _file(k), fingerprint)
                              for k, (chain, share) in enumerate(zip(chains, shares, strict=True))))  # fmt: skip


# The file that says what an atlas in a folder is, and the column of descriptors.
_DEFINITION, _DESCRIPTOR = "atlas.json", "descriptor"


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


def _columns(chain: CurveChain) -> list[StudyColumn]:
    columns = [StudyColumn(one.name, "", "dimension") for one in chain.numbers]
    return [*columns, StudyColumn(_DESCRIPTOR, "", "output", 4 * HARMONICS)]


@lru_cache(maxsize=4)
def _atlas(links: int, count: int, seed: int) -> CouplerAtlas:
    return CouplerAtlas(tuple(AtlasPart(chain, len(designs), (designs, descriptors))
                              for chain, designs, descriptors in _all_made(links, count, seed)))  # fmt: skip


def _shares(chains: Sequence[CurveChain], count: int) -> list[int]:
    """Return how many designs each chain has: of eight links there are as many as of all others."""
    weights = np.array([EIGHTH if chain.links == 8 else 1.0 for chain in chains])
    ends = np.round(np.cumsum(weights) / weights.sum() * (count - len(chains))).astype(int)
    return [int(share) + 1 for share in np.diff(ends, prepend=0)]


def _all_made(links: int, count: int, seed: int) -> Iterator[tuple[CurveChain, Number, Number]]:
    """Yield chains with their designs and descriptors. Those of eight links are dyads on designs of six."""
    chains, made = curve_chains(links), dict[ChainPlan, Number]()
    for k, (chain, share) in enumerate(zip(chains, _shares(chains, count), strict=True)):
        base = (chain.parent, made[chain.parent.plan]) if chain.links == 8 else None
        designs, found = _made(chain, share, seed + k, base)
        made[chain.plan] = designs
        yield chain, designs, found


def _made(chain: CurveChain, count: int, seed: int, base: tuple[CurveChain, Number] | None) -> tuple[Number, Number]:
    """Return the first so many designs of a chain that turn fully, and the descriptors of their curves."""
    most = 1 << max(count * DRAWS, BLOCK).bit_length()
    sample = SobolSample(min(most, 1 << 29), seed)
    designs, found, kept = list[Number](), list[Number](), 0
    for first in range(0, sample.count, BLOCK):
        if kept >= count:
            break
        units = sample.units(len(chain.numbers), range(first, first + BLOCK))
        drawn = chain.designs(units)
        if base is not None:
            own = base[1][np.arange(first, first + BLOCK) % len(base[1])].astype(float)
            drawn = base[0].grown_designs(chain, own, units, keep=False)
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
    along = np.zeros(z.shape)
    np.cumsum(np.abs(np.diff(z, axis=1)), axis=1, out=along[:, 1:])
    total = along[:, -1:]
    along /= np.where(total > 0.0, total, 1.0)
    # one interpolation for all rows: each has an interval of its own
    rows = 2.0 * np.arange(len(z))[:, None]
    wanted = np.linspace(0.0, 1.0, samples, endpoint=not closed)
    return np.interp((rows + wanted).ravel(), (rows + along).ravel(), z.ravel()).reshape(len(z), samples)


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

    back = descriptors[:, ::-1]  # orders are 1..n, -n..-1
    spectrum = np.zeros((len(descriptors), STARTS), np.complex64)
    found = []
    for own in (descriptors, back, np.conj(back), np.conj(descriptors)):
        spectrum[:, _ORDERS] = own * np.conj(wanted)
        found.append(np.abs(ifft(spectrum, axis=1)).max(axis=1) * STARTS)
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
