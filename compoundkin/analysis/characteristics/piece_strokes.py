"""Strokes piece by piece, where a motion cannot be assembled throughout."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.characteristics.figure import GREATEST, LEAST, drivers_at, scalar
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import extremes, pieces
from compoundkin.kinematics.quantities import Quantity


@dataclass(frozen=True, eq=False)
class PieceStroke:
    """The stroke of an output over one assembled piece of a motion.

    The piece goes from `begin` to `end` of the drivers.
    """

    begin: Mapping[str, Quantity]
    end: Mapping[str, Quantity]
    least: Quantity
    greatest: Quantity

    @property
    def stroke(self) -> Quantity:
        """The greatest less the least value."""
        far = float(self.greatest.values) - float(self.least.values)
        return scalar(self.greatest.name.replace(GREATEST, "stroke"), far, self.greatest.unit)


def strokes_by_piece(motion: Motion, design: int, coordinate: str) -> tuple[PieceStroke, ...]:
    """Return the strokes of an output over the assembled pieces of a motion."""
    whole, (found,) = pieces(motion), extremes(motion, coordinate, by_piece=True)
    made = []
    for k in np.flatnonzero(whole.begin.design == design).tolist():
        begin, end = drivers_at(motion, design, [float(whole.begin.place[k]), float(whole.end.place[k])])
        values = (scalar(f"{coordinate}.{word}", float(one.value[k]), found.unit)
                  for word, one in ((LEAST, found.least), (GREATEST, found.greatest)))  # fmt: skip
        made.append(PieceStroke(begin, end, *values))
    return tuple(made)
