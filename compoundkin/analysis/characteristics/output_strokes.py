"""Strokes of outputs: how long they take forth and back, in angles of the driver or in time; and piece by piece."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from compoundkin.analysis.characteristics.figure import PlacedFigure, drivers_at, number, scalar
from compoundkin.base.arrays import TURN
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import extremes, pieces
from compoundkin.kinematics.quantities import Quantity
from compoundkin.model.attributes import GREATEST, IMBALANCE, LEAST, RADIANS, STROKE, TIME_RATIO

# A driver goes round where it turns by a full turn but for this (radians): rounding of degrees.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class QuickReturn:
    """How long a stroke takes forth and back. The time ratio is that of the longer to the shorter, one at least.

    `forth` from the least to the greatest value and `back` are angles of the driver, times where the motion is in time.
    The imbalance is by how much the driver's way of either differs from half a turn; None in time.
    """

    forth: Quantity
    back: Quantity
    time_ratio: Quantity
    imbalance: Quantity | None


def quick_return_between(
    motion: Motion, design: int, cycle: float, name: str, ends: tuple[PlacedFigure, PlacedFigure]
) -> QuickReturn | None:
    """Return how long a stroke takes forth and back.

    It is between its least and its greatest value. None where neither one driver goes round once nor the motion is in
    time. `cycle` is how many poses it has.
    """
    begin, end = drivers_at(motion, design, [0.0, cycle])
    driver, first = next(iter(begin.items()))
    whole = number(end[driver]) - number(first)
    if motion.time is None and not _goes_round(begin, whole):
        return None
    a, b = (number(one.at[driver]) for one in ends)
    forth = float(np.sign(whole) * (b - a) % abs(whole))
    back = abs(whole) - forth
    if not min(forth, back) > 0.0:
        return None
    ratio = Quantity(f"{name}.{TIME_RATIO}", "", max(forth, back) / min(forth, back))
    imbalance = scalar(f"{name}.{IMBALANCE}", abs(forth - back) / 2.0, first.unit) if first.unit == RADIANS else None
    there, back_again = scalar(f"{name}.forth", forth, first.unit), scalar(f"{name}.back", back, first.unit)
    return QuickReturn(there, back_again, ratio, imbalance)


def _goes_round(begin: Mapping[str, Quantity], whole: float) -> bool:
    """Tell whether one driver alone moves, by a full turn."""
    return len(begin) == 1 and next(iter(begin.values())).unit == RADIANS and abs(abs(whole) - TURN) <= SAME


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
        return scalar(self.greatest.name.replace(GREATEST, STROKE), far, self.greatest.unit)


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
