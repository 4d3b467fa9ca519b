"""Where a point stands still for an instant, and the part of its path that it passes but once."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from compoundkin.analysis.characteristics.traced_path import TracedPath, around, stretches
from compoundkin.base.arrays import Number, cross, dot
from compoundkin.base.display import short
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, nearest
from compoundkin.kinematics import Motion

# A point stands still where it is slower than this part of its fastest: books print dimensions of cusps to six digits.
STANDS = 1e-6
# A point moves where its path is longer than this part of the mechanism: rounding of a group on a group.
MOVES = 1e-9
# Beside a place where it stands still the way from sample to sample is shorter than this part of the longest.
SLOW = 0.3
# Newton from the middle of the shortest way: its error is squared with every step.
STEPS = 8


def path_of(motion: Motion, point: str, design: int = 0, whole: bool = False) -> tuple[TracedPath, bool]:
    """Return the longest part of a point's path that it passes once.

    With it, whether it turns back there. It is as far as no driver turns back, and unless `whole` as far as the point
    does not.
    """
    if not 0 <= design < motion.inputs.designs:
        known = f"0 to {motion.inputs.designs - 1}" if motion.inputs.designs > 1 else "there is only 0"
        raise InvalidInput(Problem("design", f"there is no design {short(design)}", known))
    if point not in motion.mechanism.carriers:
        letters = list(motion.mechanism.carriers)
        raise UnknownName(Problem(point, "there is no such point", nearest(point, letters)))
    if not motion.inputs.is_rigid:
        what = "dimensions change along the motion: its poses are of different mechanisms"
        raise InvalidInput(Problem(point, what, "solve one design over its driver's values"))
    found = [TracedPath(motion, design, point, a, b, closed) for a, b, closed in stretches(motion, design)]
    if not found:
        raise InvalidInput(Problem(point, "no driver moves between two assembled poses", "solve(...) at several poses"))
    longest = max(found, key=lambda path: path.samples.size)
    if not longest.samples.size > MOVES * motion.size:
        raise InvalidInput(Problem(point, "the point does not move", "name a point of a moving link"))
    return (longest, False) if whole else _once(longest)


def _once(path: TracedPath) -> tuple[TracedPath, bool]:
    """Return the longest part between places where a point turns back on its path, and whether it does."""
    s, still = resting_places(path)
    turns = s[~still]
    if not len(turns):
        return path, False
    cuts = np.append(turns, turns[0] + path.period) if path.closed else np.array([path.first, *turns, path.last])
    parts = [path.part(float(a), float(b)) for a, b in pairwise(cuts) if b - a > path.samples.step]
    return max(parts, key=lambda part: part.samples.size), True


def resting_places(path: TracedPath) -> tuple[Number, Number]:
    """Find where a point stands still, and which of the places are cusps.

    At a cusp acceleration and jerk have different directions; where they have one, the point turns back as it came.
    """
    samples = path.samples
    chords = np.abs(np.diff(around(path)))
    fastest = float(np.nanmax(chords)) / samples.step
    before, after = (np.roll(chords, k) if path.closed else np.concatenate(c) for k, c in
                     ((1, ([np.inf], chords[:-1])), (-1, (chords[1:], [np.inf]))))  # fmt: skip
    slow = np.flatnonzero((chords <= before) & (chords <= after) & (chords < SLOW * fastest * samples.step))
    start = samples.s[0] + (slow + 0.5) * samples.step
    if not start.size:
        return np.empty(0), np.empty(0, dtype=bool)
    s = start
    for _ in range(STEPS):
        _, v, a, j = path.derivatives(s, 3)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = dot(v, a) / (np.abs(a) ** 2 + dot(v, j))
        s = np.clip(np.where(np.isfinite(step), s - step, s), start - 1.5 * samples.step, start + 1.5 * samples.step)
        s = s if path.closed else np.clip(s, path.first, path.last)
    _, v, a, j = path.derivatives(s, 3)
    still = np.abs(v) <= STANDS * fastest
    bend = np.abs(cross(a, j)) > STANDS * np.abs(a) * (np.abs(j) + np.abs(a) ** 2 / fastest)
    return _distinct(path, s[still], bend[still])


def _distinct(path: TracedPath, s: Number, cusp: Number) -> tuple[Number, Number]:
    """Return places once that were found from both sides, in order."""
    s = path.first + (s - path.first) % path.period if path.closed else s
    s, index = np.unique(s, return_index=True)
    apart = np.diff(s, prepend=(s[-1:] - path.period if path.closed else s[:1] - np.inf)) > 0.5 * path.samples.step
    return s[apart | (len(s) == 1)], cusp[index][apart | (len(s) == 1)]
