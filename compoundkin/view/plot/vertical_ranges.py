"""The vertical ranges of panels: room for values beside extremes, and what grows without limit cut off."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.base.series import Number
from compoundkin.view.plot import canvas
from compoundkin.view.plot.axis_scales import AxisScales
from compoundkin.view.plot.plotted_rows import Plotted
from compoundkin.view.plot.point_labels import number

# Beside limit positions rates grow without limit: what exceeds the inner nine tenths of the values this many times
# would press all else flat, and is cut off. Where a motion has no limit position it may end just before one, or have
# true peaks, which are cut off only where nothing else could be seen.
INNER, TALL, TALL_WITHOUT_LIMITS, MARGIN = (5.0, 95.0), 3.0, 50.0, 0.35
# Free space above and below curves, for the values of extremes; a part of their range.
HEADROOM = 0.16


def set_range(
    axes: Any, curves: Sequence[Plotted], lines: Sequence[tuple[Number, Number]], scales: AxisScales, near_limits: bool
) -> tuple[float, float] | None:
    """Set the vertical range of curves. It is returned where values lie outside of it."""
    if scales.ylim is not None:
        axes.set_ylim(*scales.ylim)
        return None
    scale = max(curve.scale for curve in curves)
    seen = scales.drawable(np.concatenate([scales.visible(*line) for line in lines]), scale)
    values = np.concatenate([curve.values.ravel() for curve in curves]) if scales.xlim is None else seen
    still, window = canvas.steady(seen, scale), _window(curves, values, near_limits)
    if still is not None:
        axes.set_ylim(*still)
    elif window is not None and "y" not in scales.log:
        axes.set_ylim(*window)
        canvas.note(axes, f"cut off: from {number(np.nanmin(values))} to {number(np.nanmax(values))}")
        return window
    elif np.isfinite(seen).any():
        window = _with_room(float(np.nanmin(seen)), float(np.nanmax(seen)), "y" in scales.log)
        axes.set_ylim(*window)
        return window if "y" in scales.log else None
    return None


def _with_room(low: float, high: float, is_log: bool) -> tuple[float, float]:
    """A range with room above and below, on a logarithmic axis by a part of its powers."""
    if not is_log:
        return low - HEADROOM * (high - low), high + HEADROOM * (high - low)
    room = (high / low) ** HEADROOM
    return low / room, high * room


def _window(curves: Sequence[Plotted], values: Number, near_limits: bool) -> tuple[float, float] | None:
    """The values to show where rates grow without limit; None for all of them."""
    known = values[np.isfinite(values)]
    if not len(known) or not any(curve.is_unbounded for curve in curves):
        return None
    low, high = np.percentile(known, INNER)
    span = high - low
    if span == 0.0 or np.ptp(known) <= (TALL if near_limits else TALL_WITHOUT_LIMITS) * span:
        return None
    edge, far = HEADROOM * span, MARGIN * span
    return float(max(low - far, known.min() - edge)), float(min(high + far, known.max() + edge))
