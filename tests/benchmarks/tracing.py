"""`python -m tests.benchmarks.tracing CURVES.npy [--open]`: how near drawn curves are traced, and how long it takes.

CURVES is an array (curves, places, 2), such as the coupler curves of the LINKS data set or LInK's hand-drawn letters
(A. H. Nobari et al., LInK, MIT 2024). The measure is LInK's: both curves at 2,000 places evenly along their arcs, in
the target's RMS radius, the mean distance from each place to the nearest of the other, both ways, summed.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.spatial import cKDTree

from compoundkin.dimensional import curve_fitting
from compoundkin.dimensional.coupler_atlas import coupler_atlas
from compoundkin.dimensional.tasks import curve

PLACES = 2000


def even(z: np.ndarray, closed: bool) -> np.ndarray:
    """Places evenly along a curve."""
    z = np.append(z, z[:1]) if closed else z
    along = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    wanted = np.linspace(0.0, along[-1], PLACES, endpoint=not closed)
    return np.interp(wanted, along, z.real) + 1j * np.interp(wanted, along, z.imag)


def chamfer(found: np.ndarray, target: np.ndarray, closed: bool) -> float:
    """LInK's measure."""
    one, two = even(found, True), even(target, closed)
    radius = np.sqrt(np.mean(np.abs(two - two.mean()) ** 2))
    planes = [np.stack([z.real, z.imag], axis=-1) / radius for z in (one, two)]
    return float(sum(cKDTree(planes[k]).query(planes[1 - k])[0].mean() for k in (0, 1)))


def main(path: str) -> None:
    """Print each curve, and means."""
    begun = time.perf_counter()
    atlas = coupler_atlas(6, curve_fitting.DESIGNS)
    print(f"atlas of {len(atlas)} designs: {time.perf_counter() - begun:.1f} s")
    rows: dict[bool, list[tuple[float, float]]] = {True: [], False: []}
    for k, places in enumerate(np.load(path)):
        task = curve(places)
        begun = time.perf_counter()
        best = curve_fitting.fitted(atlas.near(task.closed_curve, curve_fitting.STARTED), task.closed_curve)[0]
        spent = time.perf_counter() - begun
        z, _ = best.chain.curves(best.design[None], 720)
        laid = best.scale * z[0] + best.place
        apart = chamfer(np.conj(laid) if best.mirrored else laid, task.points, task.closed)
        rows[task.closed].append((apart, spent))
        print(
            f"{k:4d} {'closed' if task.closed else 'open':6s} {apart:.5f} {spent:5.1f} s  {best.chain.title}",
            flush=True,
        )
    for closed, found in rows.items():
        if found:
            apart, spent = np.array(found).T
            kind = "closed" if closed else "open"
            print(f"{kind}: mean {apart.mean():.5f}, median {np.median(apart):.5f}, {spent.mean():.1f} s each")


if __name__ == "__main__":
    main(sys.argv[1])
