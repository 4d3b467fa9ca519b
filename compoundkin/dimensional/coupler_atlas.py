"""An atlas of coupler curves: fully turning designs of many chains, each with the descriptor of its curve.

It is made of Sobol's sequence by programs (`curve_chains`), always the same for a seed; `near` finds the designs whose
curves are nearest to a given one over rotation, size, start, direction and mirror image.

A descriptor are Fourier coefficients of the curve resampled evenly along its arc, without the place and of unit sum of
squares: rotation, start, direction and mirror image change their phases and order alone (C. T. Zahn and R. Z. Roskies,
Fourier descriptors for plane closed curves, IEEE Trans. Comput. C-21 (1972) 269-281).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.dimensional.curve_chains import CurveChain, curve_chains
from compoundkin.studies.samples.random_samples import SobolSample

# Poses of a turn of which a curve is made, and designs that are computed at once.
POSES, BLOCK = 64, 4096
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
# Starts that are tried along a curve.
STARTS = 64
_ORDERS = np.concatenate([np.arange(1, HARMONICS + 1), np.arange(-HARMONICS, 0)])


class AtlasMatch(NamedTuple):
    """A design of the atlas near a curve: its chain and numbers, whether mirrored, and how far apart the curves are.

    `apart` is the root of the mean square over places at equal parts of the arcs, in the curve's RMS radius.
    """

    chain: CurveChain
    design: Number
    mirrored: bool
    apart: float


@dataclass(frozen=True, eq=False, repr=False)
class CouplerAtlas(ShortRepr):
    """Designs of chains with the descriptors of their curves.

    `designs` are arrays (designs, numbers), `descriptors` (designs, coefficients), one each for every chain.
    """

    chains: tuple[CurveChain, ...]
    designs: tuple[Number, ...]
    descriptors: tuple[Number, ...]

    def __len__(self) -> int:
        return sum(map(len, self.designs))

    def near(self, curve: Number, count: int = 20) -> list[AtlasMatch]:
        """Return the nearest designs to a closed curve, an array (places,), of different shapes in each chain.

        They are the nearest over rotation, size, start (in parts of the arc), direction and mirror image, none is
        missed: bounds by the magnitudes of coefficients say where correlations need not be looked at.
        """
        wanted = coefficients(np.asarray(curve)[None])[0][0]
        each = max(2, -(-2 * count // len(self.chains)))
        found = [match for k in range(len(self.chains)) for match in self._nearest(k, wanted, each)]
        return sorted(found, key=lambda match: match.apart)[:count]

    def _nearest(self, k: int, wanted: Number, count: int) -> Iterator[AtlasMatch]:
        """Yield the nearest designs of one chain, none a twin of another."""
        own = self.descriptors[k]
        sizes, magnitudes = np.abs(wanted).astype(np.float32), np.abs(own)
        bound = np.maximum(magnitudes @ sizes, magnitudes @ sizes[::-1])
        order = np.argsort(-bound)
        wide, kept = 16 * count, np.zeros(0, int)
        best, mirrored = np.zeros(0), np.zeros(0, bool)
        for first in range(0, len(order), COMPARED):
            part = order[first : first + COMPARED]
            if len(best) >= wide and bound[part[0]] <= np.partition(best, -wide)[-wide]:
                break
            value, is_mirrored = likeness(own[part], wanted)
            best, mirrored, kept = np.append(best, value), np.append(mirrored, is_mirrored), np.append(kept, part)
        shown: list[Number] = []
        for j in np.argsort(-best)[:wide]:
            apart = float(np.sqrt(max(0.0, 2.0 - 2.0 * best[j])))
            if shown and likeness(np.array(shown), own[kept[j]])[0].max() > 1.0 - (TWINS * apart) ** 2 / 2.0:
                continue
            shown.append(own[kept[j]])
            yield AtlasMatch(self.chains[k], self.designs[k][kept[j]], bool(mirrored[j]), apart)
            if len(shown) == count:
                return


@lru_cache(maxsize=4)
def coupler_atlas(links: int = 6, count: int = 1_000_000, seed: int = 0) -> CouplerAtlas:
    """Return an atlas of so many designs whose driver turns fully, of chains of at most so many links.

    >>> len(coupler_atlas(4, 1000))
    1000
    """
    chains = curve_chains(links)
    shares = [count * (k + 1) // len(chains) - count * k // len(chains) for k in range(len(chains))]
    made = [_made(chain, share, seed + k) for k, (chain, share) in enumerate(zip(chains, shares, strict=True))]
    return CouplerAtlas(chains, tuple(designs for designs, _ in made), tuple(found for _, found in made))


def _made(chain: CurveChain, count: int, seed: int) -> tuple[Number, Number]:
    """Return the first so many designs of a chain that turn fully, and the descriptors of their curves."""
    most = 1 << max(count * DRAWS, BLOCK).bit_length()
    sample = SobolSample(min(most, 1 << 29), seed)
    designs, found, kept = list[Number](), list[Number](), 0
    for first in range(0, sample.count, BLOCK):
        if kept >= count:
            break
        drawn = chain.designs(sample.units(len(chain.numbers), range(first, first + BLOCK)))
        drawn = drawn.astype(np.float32).astype(float)  # as they are kept
        curves, clear = chain.curves(drawn, POSES)
        drawn, curves = drawn[clear], curves[clear]
        own, radius = coefficients(curves)
        seen = radius > LEAST_RADIUS * chain.size(drawn)
        designs.append(drawn[seen].astype(np.float32))
        found.append(own[seen].astype(np.complex64))
        kept += int(seen.sum())
    return np.concatenate(designs)[:count], np.concatenate(found)[:count]


def resampled(curves: Number, samples: int) -> Number:
    """Return closed curves (curves, places) evenly along their arcs, (curves, samples)."""
    z = np.concatenate([curves, curves[:, :1]], axis=1)
    along = np.zeros(z.shape)
    np.cumsum(np.abs(np.diff(z, axis=1)), axis=1, out=along[:, 1:])
    total = along[:, -1:]
    along /= np.where(total > 0.0, total, 1.0)
    # one interpolation for all rows: each has an interval of its own
    rows = 2.0 * np.arange(len(z))[:, None]
    wanted = np.arange(samples) / samples
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


def mean_distance(curve: Number, target: Number) -> float:
    """Return the mean nearest distance of closed curves both ways, summed, in the target's RMS radius.

    It is taken at places that lie evenly along the arcs, to the lines between those of the other curve.
    """
    one, two = (resampled(each[None], MEASURED)[0] for each in (curve, target))
    radius = np.sqrt(np.mean(np.abs(two - two.mean()) ** 2))
    return float((_nearest_distances(one, two).mean() + _nearest_distances(two, one).mean()) / radius)


def _nearest_distances(places: Number, curve: Number) -> Number:
    """Return the distances of places (n,) from a closed curve, by the lines next to its nearest place."""
    from scipy.spatial import cKDTree

    _, at = cKDTree(np.stack([curve.real, curve.imag], axis=-1)).query(np.stack([places.real, places.imag], axis=-1))
    best = np.abs(places - curve[at])
    for side in (-1, 1):
        way = curve[(at + side) % len(curve)] - curve[at]
        part = np.clip(((places - curve[at]) * np.conj(way)).real / np.maximum(np.abs(way) ** 2, 1e-300), 0.0, 1.0)
        best = np.minimum(best, np.abs(places - curve[at] - part * way))
    return best
