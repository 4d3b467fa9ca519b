"""The means of efforts and powers as dashed lines: what the driver gives all in all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.model.attributes import EFFORT, POWER
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import number
from compoundkin.view.plot.solved_courses import PlottedCourse

# A mean nearer to zero than this part of the greatest value is zero but for rounding.
NOTHING = 1e-9


def mean_lines(axes: Any, course: PlottedCourse, curves: Sequence[Plotted], shades: Sequence[Any]) -> None:
    """Draw the mean of each effort and power, of one design, with its value."""
    for k, curve in enumerate(curves):
        if len(curve.values) == 1 and curve.name.rpartition(".")[2] in (EFFORT, POWER):
            mean = _mean(*course.line(curve, 0))
            if np.isfinite(mean):
                axes.axhline(mean, color=shades[k], linestyle=(0, (5, 3)), linewidth=1.0, label=f"mean {number(mean)}")


def _mean(x: Any, y: Any) -> float:
    """The mean of a curve along its axis, pieces that are known only."""
    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    steps, middle = np.diff(x), (y[1:] + y[:-1]) / 2.0
    known = np.isfinite(middle) & np.isfinite(steps)
    way = float(np.sum(np.abs(steps[known])))
    found = float(np.sum(middle[known] * np.abs(steps[known]))) / way if way else np.nan
    largest = float(np.max(np.abs(y), initial=0.0, where=np.isfinite(y)))
    return 0.0 if abs(found) <= NOTHING * largest else found
