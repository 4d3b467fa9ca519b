"""Places along a motion that are near to each other, though its poses are not."""

from __future__ import annotations

import numpy as np

from compoundkin.base.arrays import Number

# What lies between poses is sought in so many steps of a motion at least: ten degrees of a turn.
CLOSE = 36


def close_parts(poses: int) -> int:
    """Return in how many parts steps between poses are cut, to look closely.

    >>> close_parts(4), close_parts(361), close_parts(1)
    (12, 1, 1)
    """
    return -(-CLOSE // (poses - 1)) if poses > 1 else 1


def close_places(poses: int) -> Number:
    """Return the poses, and places between those of a motion that has few."""
    return np.linspace(0.0, poses - 1.0, close_parts(poses) * (poses - 1) + 1)
