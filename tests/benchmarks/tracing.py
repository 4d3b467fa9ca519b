"""`python -m tests.benchmarks.tracing CURVES.npy [LINKS [FIRST LAST]]`: how near drawn curves are traced, how fast.

CURVES is an array (curves, places, 2), such as the coupler curves of the LINKS data set or LInK's hand-drawn letters
(A. H. Nobari et al., LInK, MIT 2024). The measure is LInK's: both curves at 2,000 places evenly along their arcs, in
the target's RMS radius, the mean distance from each place to the nearest of the other, both ways, summed. Of an open
curve the part of the turn that traces it counts. Linkages have at most LINKS links, 8 if it is left out.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from scipy.spatial import cKDTree

from compoundkin.dimensional import curve_fitting
from compoundkin.dimensional.coupler_atlas import coupler_atlas
from compoundkin.dimensional.task_words import curve

PLACES = 2000
# LInK's own for its hand-drawn letters A to Z, with up to twenty joints: alpha_res.npy of ahnobari/LInKGenerator.
LINK = (
    0.01885, 0.02341, 0.00816, 0.0065, 0.05377, 0.01172, 0.04319, 0.02209, 0.01637, 0.01124, 0.14694, 0.00814, 0.02199,
    0.0331, 0.00491, 0.01266, 0.0157, 0.02907, 0.02259, 0.01528, 0.0067, 0.00823, 0.02015, 0.04098, 0.01616, 0.04254,
)  # fmt: skip


def even(z: np.ndarray, closed: bool) -> np.ndarray:
    """Places evenly along a curve."""
    z = np.append(z, z[:1]) if closed else z
    along = np.append(0.0, np.cumsum(np.abs(np.diff(z))))
    wanted = np.linspace(0.0, along[-1], PLACES, endpoint=not closed)
    x, y = (np.interp(wanted, along, part) for part in (z.real, z.imag))
    return np.asarray(x + 1j * y)


def chamfer(found: np.ndarray, target: np.ndarray, closed: bool) -> float:
    """LInK's measure."""
    one, two = even(found, closed), even(target, closed)
    radius = np.sqrt(np.mean(np.abs(two - two.mean()) ** 2))
    planes = [np.stack([z.real, z.imag], axis=-1) / radius for z in (one, two)]
    return float(sum(cKDTree(planes[k]).query(planes[1 - k])[0].mean() for k in (0, 1)))


def main(path: str, links: int = 8, first: int = 0, last: int | None = None) -> None:
    """Print each curve, and means; of each number of links the best, and LInK's beside its letters."""
    begun = time.process_time()
    atlas = coupler_atlas(6, curve_fitting.DESIGNS)
    print(f"atlas of {len(atlas)} designs: {time.process_time() - begun:.1f} s of CPU")
    rows: dict[bool, list[tuple[float, float]]] = {True: [], False: []}
    curves = np.load(path)
    theirs = LINK if len(curves) == len(LINK) else ()
    for k, places in list(enumerate(curves))[first:last]:
        task = curve(places)
        begun = time.process_time()
        near = atlas.near(task.points, curve_fitting.STARTED, closed=task.closed)
        found = curve_fitting.fitted(near, task.points, task.closed, links)
        spent = time.process_time() - begun
        least = {n: next((one for one in found if one.chain.links == n), None) for n in range(4, links + 1)}
        parts = []
        for best in least.values():
            if best is None:
                parts.append("      -")
                continue
            begin, by = best.window or (0.0, 2.0 * np.pi)
            angles = begin + by * np.linspace(0.0, 1.0, 720, endpoint=best.window is not None)
            z = best.laying.laid(best.chain.places(best.design[None], angles)[0][0])
            parts.append(f"{chamfer(z, task.points, task.closed):.5f}")
        apart = min(float(part) for part in parts if part.strip() != "-")
        rows[task.closed].append((apart, spent))
        kind = "closed" if task.closed else "open"
        beside = f"  LInK {theirs[k]:.5f}" if theirs else ""
        title = found[0].chain.title
        print(f"{k:4d} {kind:6s} {apart:.5f} {spent:5.1f} s  {' '.join(parts)}{beside}  {title}", flush=True)
    for closed, each in rows.items():
        if each:
            apart, spent = np.array(each).T
            kind = "closed" if closed else "open"
            print(f"{kind}: mean {apart.mean():.5f}, median {np.median(apart):.5f}, {spent.mean():.1f} s each")


if __name__ == "__main__":
    main(sys.argv[1], *map(int, sys.argv[2:]))
