"""What is marked in plots along a motion: gaps and change points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.gaps import Gap, gaps

# A curve that varies less than this part of its size is constant but for rounding.
CONSTANT = 1e-9


@dataclass(frozen=True)
class Blank:
    """A part of one design's motion without assembled poses. Its places are along the motion (pose 0, 1, 2 ...).

    `limits` tells for its begin and its end whether it is a limit position or the end of a guide; otherwise
    the motion ends there.
    """

    design: int
    begin: float
    end: float
    limits: tuple[bool, bool]


@dataclass(frozen=True)
class Events:
    """All that is marked in plots of a motion, in places along it."""

    blanks: tuple[Blank, ...]
    changes: tuple[tuple[int, float], ...]  # design and place of every change point

    def beside(self, design: int, poses: int) -> Number:
        """Return a design's last poses before and first ones after limit positions."""
        found = []
        for blank in self.blanks:
            if blank.design == design:
                places = (np.floor(blank.begin), np.ceil(blank.end))
                found += [int(s) for s, is_limit in zip(places, blank.limits, strict=True) if is_limit]
        return np.array([s for s in found if 0 <= s < poses], dtype=int)


def events(motion: Motion) -> Events:
    """Return the gaps and change points of a motion.

    >>> import warnings
    >>> from compoundkin.files.shipped_mechanisms import load_named
    >>> from compoundkin.kinematics import solve
    >>> with warnings.catch_warnings(action="ignore"):
    ...     motion = solve(load_named("triple-rocker"), {"driver": np.deg2rad([80.0, 88.0, 90.0])})
    >>> [round(blank.begin, 3) for blank in events(motion).blanks]     # the limit is at 88.98 degrees
    [1.488]
    """
    found = gaps(motion) if np.any(motion.failed) else ()
    changes = [
        (design, float(place))
        for _, places in sorted(motion.change_points.items())
        for design, row in enumerate(places)
        for place in row[np.isfinite(row)]
    ]
    return Events(tuple(_blank(motion, gap) for gap in found), tuple(dict.fromkeys(changes)))


def at(row: Number, place: float) -> float:
    """Return a quantity at a place, linear between poses as drivers and times are."""
    return float(np.interp(place, np.arange(len(row)), row))


def _blank(motion: Motion, gap: Gap) -> Blank:
    design = int(np.ravel_multi_index(gap.design, motion.shape[:-1])) if gap.design else 0
    begin = float(gap.first) if gap.open_begin else _place(motion, design, dict(gap.begin), gap.first - 1, gap.first)
    end = float(gap.last) if gap.open_end else _place(motion, design, dict(gap.end), gap.last + 1, gap.last)
    return Blank(design, begin, end, (not gap.open_begin, not gap.open_end))


def _place(motion: Motion, design: int, values: dict[str, float], good: int, bad: int) -> float:
    """The place between two poses where the drivers have these values."""
    rows = {n: np.broadcast_to(motion.drives[n].value, motion.shape).reshape(motion.failed.shape) for n in values}
    moved = {name: float(row[design, bad] - row[design, good]) for name, row in rows.items()}
    name = max(moved, key=lambda n: abs(moved[n]), default=None)
    if name is None or moved[name] == 0.0:
        return (good + bad) / 2.0
    return good + (values[name] - float(rows[name][design, good])) / moved[name] * (bad - good)
