"""Angles with their full turns, told from one pose to the next by their rates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from compoundkin.base.series import Number


class LinearAngle(NamedTuple):
    """About where an angle is. Its value at values of the drivers, and its rates by them."""

    angle: float
    values: Number | None
    slopes: Number

    def at(self, values: Number) -> float:
        """Return it at other values."""
        return self.angle if self.values is None else self.angle + float(self.slopes @ (values - self.values))


def by_drivers(value: Number, names: tuple[str, ...]) -> Number:
    """Return the rates of a coordinate by the drivers. They are all in a column but the last."""
    return np.broadcast_to(value, (len(names) + 1, 1))[:-1, 0]
