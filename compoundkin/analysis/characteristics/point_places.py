"""The longest part of a point's path that it passes but once."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from compoundkin.analysis.characteristics.driver_stretches import stretches
from compoundkin.analysis.characteristics.traced_path import TracedPath
from compoundkin.base.arguments import check_design
from compoundkin.base.errors import InvalidInput, Problem, UnknownName, suggestion
from compoundkin.kinematics import Motion

# A point moves where its path is longer than this part of the mechanism: rounding of a group on a group.
MOVES = 1e-9


def path_of(motion: Motion, point: str, design: int = 0, whole: bool = False) -> tuple[TracedPath, bool]:
    """Return the longest part of a point's path that it passes once.

    With it, whether it turns back there. It is as far as no driver turns back, and unless `whole` as far as the point
    does not.
    """
    check_design(design, motion.inputs.designs)
    if point not in motion.mechanism.carriers:
        letters = list(motion.mechanism.carriers)
        raise UnknownName(Problem(point, "there is no such point", suggestion(point, letters)))
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
    s, still = path.rests
    turns = s[~still]
    if not len(turns):
        return path, False
    cuts = np.append(turns, turns[0] + path.period) if path.closed else np.array([path.first, *turns, path.last])
    parts = [path.part(float(a), float(b)) for a, b in pairwise(cuts) if b - a > path.samples.step]
    return max(parts, key=lambda part: part.samples.size), True
