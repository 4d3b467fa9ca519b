"""How alike curves are: descriptors, the correlation of two, how one is laid on another, and distances.

A descriptor are Fourier coefficients of the curve resampled evenly along its arc, without the place and of unit sum of
squares: rotation, start, direction and mirror image change their phases and order alone (C. T. Zahn and R. Z. Roskies,
Fourier descriptors for plane closed curves, IEEE Trans. Comput. C-21 (1972) 269-281).
"""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import TURN, Number

# Samples of a curve, its harmonics on either side that are kept, and starts that are tried along it.
SAMPLES, HARMONICS, STARTS = 64, 16, 64
# Descriptors that are compared at once: they stay in the processor's cache.
COMPARED = 128
# Places of curves whose distance is measured.
MEASURED = 2000
ORDERS = np.concatenate([np.arange(1, HARMONICS + 1), np.arange(-HARMONICS, 0)])


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


def coefficients(curves: Number) -> tuple[Number, Number, Number]:
    """Return the descriptors of closed curves, (curves, 2 HARMONICS), their RMS radii and their middles (curves,)."""
    every = np.fft.fft(resampled(curves, SAMPLES), axis=1) / SAMPLES
    found = every[:, ORDERS]
    radius = np.sqrt((np.abs(found) ** 2).sum(axis=1))
    return found / np.where(radius > 0.0, radius, 1.0)[:, None], radius, every[:, 0]


def likeness(descriptors: Number, wanted: Number) -> tuple[Number, Number]:
    """Return the greatest correlation of descriptors (n, 2 HARMONICS) with a wanted one, and whether mirrored (n,).

    It is the greatest over rotation, start, direction and mirror image: over all rotations the correlation is the
    absolute value of one number for each start.
    """
    parts = [descriptors[k : k + COMPARED] for k in range(0, len(descriptors), COMPARED)] or [descriptors]
    values, mirrored = zip(*(_likeness(part, wanted) for part in parts), strict=True)
    return np.concatenate(values), np.concatenate(mirrored)


def _likeness(descriptors: Number, wanted: Number) -> tuple[Number, Number]:
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
