"""The courses of plotted quantities between the poses, solved again: highest and lowest values, jumps as jumps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from compoundkin.base.arrays import degrees
from compoundkin.base.series import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import Places, between, extremes
from compoundkin.kinematics.extremes.places import SAME_PLACE
from compoundkin.kinematics.quantities import quantity
from compoundkin.model.attributes import TIME, course_figure, order_of
from compoundkin.view.plot.curve_places import CurvePlaces
from compoundkin.view.plot.marked_places import CONSTANT
from compoundkin.view.plot.plotted_rows import POSE, Plotted


@dataclass(frozen=True)
class PlottedExtreme:
    """A highest or lowest value `y` of a curve, with its `x`."""

    x: float
    y: float
    is_highest: bool


def plotted_extremes(
    motion: Motion, x: Plotted, curves: Sequence[Plotted]
) -> dict[str, tuple[tuple[PlottedExtreme, ...], ...]]:
    """Return the highest and lowest values of curves by name, for each design. A constant has none.

    Rates that grow without limit towards a limit position have none there.
    """
    named = {curve.name: curve for curve in curves if not course_figure(curve.name)[1]}
    found = {}
    for one in extremes(motion, *named):
        curve, rows = named[one.name], []
        both = tuple(_shown(curve, side.value) for side in (one.greatest, one.least))
        at = tuple(x_at(motion, x, side.at) for side in (one.greatest, one.least))
        for d, (high, low) in enumerate(zip(*both, strict=True)):
            size = max(curve.scale, abs(high), abs(low)) if np.isfinite([high, low]).all() else curve.scale
            level = high - low <= CONSTANT * size
            marks = (PlottedExtreme(float(at[k][d]), float(y), k == 0) for k, y in enumerate((high, low)))
            rows.append(() if level else tuple(mark for mark in marks if np.isfinite(mark.y)))
        found[one.name] = tuple(rows)
    return found


def x_at(motion: Motion, x: Plotted, at: Places) -> Number:
    """Return what a plot runs along at places; NaN where there is no place."""
    if x.name == POSE:
        return at.place
    if x.name == TIME and motion.time is not None:
        return at.time
    if x.name in motion.drives:
        return _shown(x, at.drives[x.name])
    known = np.isfinite(at.place)
    out = np.full(at.place.shape, np.nan)
    out[known] = values_at(motion, x, at.some(known))
    return out


def values_at(motion: Motion, curve: Plotted, at: Places) -> Number:
    """Return a plotted quantity at places, solved there."""
    with np.errstate(all="ignore"):
        there = between(motion, at.design, at.place, max(motion.order, order_of(curve.name)))
    return _shown(curve, np.asarray(quantity(there, curve.name).values))


def _shown(curve: Plotted, values: Number) -> Number:
    return np.asarray(degrees(values) if curve.is_angle else values)


@dataclass(frozen=True, eq=False)
class PlottedCourse:
    """How a plot goes from pose to pose. It is smooth, as solved between them, and goes through both sides of jumps."""

    motion: Motion
    x: Plotted
    more: CurvePlaces
    solved: Any

    @classmethod
    def of(cls, motion: Motion, x: Plotted, names: Sequence[str]) -> PlottedCourse:
        """Return the course of a motion. It is solved between its poses for the quantities of names."""
        more = CurvePlaces.of(motion)
        order = max([motion.order, *map(order_of, (*names, x.name))])
        with np.errstate(all="ignore"):
            return cls(motion, x, more, between(motion, more.at.design, more.at.place, order))

    def line(self, curve: Plotted, design: int) -> tuple[Number, Number]:
        """Return x and y of a curve. It goes as far as limit positions, unless it grows without limit there.

        A pose at a jump gives way to its two sides; NaN parts what passes infinity.
        """
        x, y = self.x.values[design], curve.values[design]
        mine = self.more.at.design == design
        if curve.is_unbounded or self.x.is_unbounded:
            mine &= ~self.more.to_limits
        if not mine.any() or course_figure(curve.name)[1]:
            return curve.parted(self.x, x, y)
        place, poses = self.more.at.place[mine], np.arange(len(x), dtype=float)
        kept = np.abs(poses[:, None] - place).min(axis=1) > SAME_PLACE
        order = np.argsort(np.concatenate([poses[kept], place]))
        new = (x_at(self.motion, self.x, self.more.at.some(mine)), self._values(curve)[mine])
        across, up = (np.concatenate([row[kept], one])[order] for row, one in zip((x, y), new, strict=True))
        return curve.parted(self.x, across, up)

    def _values(self, curve: Plotted) -> Number:
        found = np.asarray(quantity(self.solved, curve.name).values)
        return np.broadcast_to(_shown(curve, found).reshape(-1), self.more.at.place.shape)
