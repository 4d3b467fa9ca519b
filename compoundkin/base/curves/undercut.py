"""Where a function of the parameter is not positive along a curve: spans, their ends to rounding."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compoundkin.base.curves.samples import Samples
from compoundkin.base.series import Number

# Halvings of the distance of two samples until rounding.
HALVINGS = 45


def spans(
    samples: Samples, low: float, high: float, margin: Callable[[Number], Number]
) -> tuple[tuple[float, float], ...]:
    """The spans of parameters where `margin` is not positive; on a closed curve the last may run past `high`.

    >>> s = np.linspace(0.0, 1.0, 11)
    >>> ((start, end),) = spans(Samples(s, s + 0j, closed=False), 0.0, 1.0, lambda s: s - 0.25)
    >>> start, round(end, 12)
    (0.0, 0.25)
    """
    cut = margin(samples.s) <= 0.0
    if cut.all():
        return ((low, high),)
    before, after = np.roll(cut, 1), np.roll(cut, -1)
    if not samples.closed:
        before[0] = after[-1] = False
    starts = _edge(samples, samples.s[cut & ~before], -samples.step, margin)
    ends = _edge(samples, samples.s[cut & ~after], samples.step, margin)
    if before[0] and cut[0]:
        ends = np.append(ends[1:], ends[0] + high - low)
    return tuple([(float(a), float(b)) for a, b in zip(starts, ends, strict=True)])


def _edge(samples: Samples, inside: Number, step: float, margin: Callable[[Number], Number]) -> Number:
    """Where `margin` becomes positive within a step from places where it is not, by bisection."""
    outside = inside + step
    if not samples.closed:
        outside = np.clip(outside, samples.s[0], samples.s[-1])
    for _ in range(HALVINGS):
        middle = 0.5 * (inside + outside)
        positive = margin(middle) > 0.0
        inside, outside = np.where(positive, inside, middle), np.where(positive, middle, outside)
    return inside
