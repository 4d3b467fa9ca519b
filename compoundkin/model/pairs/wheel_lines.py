"""Two wheels: their axes and ratio, and lines of action between them, as flanks of teeth and strands of belts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from compoundkin.base.series import Number
from compoundkin.model.pairs.contract import Ends, Poses


class LineOfAction(NamedTuple):
    """Where a line touches the circles about two axes, in the world. `across` is a unit vector at right angles."""

    first: Number
    second: Number
    across: Number


def ratio(ends: Ends) -> Number:
    """Return how far the second wheel turns back for one of the first. Both are seen from the carrier."""
    return ends[0].measure / ends[1].measure


def axes_of(ends: Ends, poses: Poses) -> tuple[Number, Number]:
    """Return where the axes of two wheels are."""
    first, second = (pose.at(end.point).c[0] for pose, end in zip(poses[:2], ends[:2], strict=True))
    return first, second


def line_of_action(axes: tuple[Number, Number], radii: tuple[Number, Number], side: float = 1.0) -> LineOfAction:
    """Return a common tangent of the circles about two axes.

    It is the inner one; the outer one where the second radius is negative. It touches the first circle to the left of
    the way from axis to axis, or to the right for a `side` of -1.

    >>> complex(line_of_action((0j, 5 + 0j), (1.0, -1.0)).second)
    (5+1j)
    """
    (first, second), (one, two) = axes, radii
    distance = np.abs(second - first)
    cosine = (one + two) / distance
    across = (second - first) / distance * (cosine + 1j * side * np.sqrt(1.0 - cosine**2))
    return LineOfAction(first + one * across, second - two * across, across)
