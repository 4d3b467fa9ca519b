"""The figures of one output: stroke, dead points, time ratio, greatest rates, dwells, and the path of a point.

The time ratio compares the forward and the return stroke in angles of the driver, or in time.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from compoundkin.analysis.characteristics.dwells import Dwell, OutputDwells
from compoundkin.analysis.characteristics.figures import (
    PlacedFigure,
    Range,
    displayed_number,
    drivers_at,
    moving_drivers,
    quantity_number,
    scalar_quantity,
)
from compoundkin.analysis.characteristics.outputs import Output
from compoundkin.analysis.characteristics.path_features import PathFeatures, path_features
from compoundkin.base.arrays import TURN, Number
from compoundkin.base.errors import CompoundkinError
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between, closed_cycles, dead_points, extremes, pieces
from compoundkin.kinematics.extremes.stretches import SAME_PLACE
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import (
    GREATEST,
    IMBALANCE,
    LEAST,
    RADIANS,
    STROKE,
    TIME_RATIO,
    derivative_order,
    unit_of,
)


@dataclass(frozen=True, eq=False)
class OutputFigures:
    """The figures of one output over a motion, with their places along it.

    A point that moves in the plane has no least and no greatest value, but a `path`. Figures that are not defined are
    None or empty, such as the time ratio of an output that does not reciprocate in a cycle of one driver. Dwells are
    intervals within the part `dwell` of the stroke, stretches of paths are within the part `straight` of its size.
    """

    motion: Motion
    design: int
    output: Output
    ranges: Mapping[str, Range]
    dwell: float
    straight: float

    @property
    def name(self) -> str:
        """The name of the output."""
        return self.output.name

    @property
    def least(self) -> PlacedFigure | None:
        """The least value, at its first place."""
        return self.ranges[self.output.coordinate].least if self.output.coordinate in self.ranges else None

    @property
    def greatest(self) -> PlacedFigure | None:
        """The greatest value, at its first place."""
        return self.ranges[self.output.coordinate].greatest if self.output.coordinate in self.ranges else None

    @property
    def is_constant(self) -> bool:
        """Whether it does not change."""
        known = self.ranges.get(self.output.coordinate or self.output.rate)
        return known is None or (known.is_constant and not (self.output.is_point and known.greatest.number > 0))

    @cached_property
    def stroke(self) -> Quantity | None:
        """The greatest minus the least value, None where it passes infinity; of a point on a line the path's length."""
        if self.motion.inputs.poses < 2:
            return None
        if self.least is not None and self.greatest is not None:
            if not np.isfinite([self.least.number, self.greatest.number]).all():
                return None
            far, unit = self.greatest.number - self.least.number, self.least.value.unit
            far = 0.0 if self.is_constant else far  # but for rounding
            return scalar_quantity(f"{self.name}.{STROKE}", far, unit)
        if self.path is not None and self.path.is_straight and not self.path.closed:
            return scalar_quantity(
                f"{self.name}.{STROKE}", self.path.line.length, unit_of(self.motion.mechanism.unit, "length")
            )
        return None

    @cached_property
    def pieces(self) -> tuple[PieceStroke, ...]:
        """The strokes over the assembled pieces of a motion with gaps."""
        failed = np.broadcast_to(self.motion.failed != 0, (self.motion.inputs.designs, self.motion.inputs.poses))
        if self.least is None or self.motion.inputs.poses < 2 or not failed[self.design].any():
            return ()
        return strokes_by_piece(self.motion, self.design, self.output.coordinate)

    @property
    def speed(self) -> PlacedFigure | None:
        """The rate of greatest absolute value."""
        return self.ranges[self.output.rate].absolute if self.output.rate in self.ranges else None

    @property
    def acceleration(self) -> PlacedFigure | None:
        """The second rate of greatest absolute value."""
        return self.ranges[self.output.second].absolute if self.output.second in self.ranges else None

    @cached_property
    def dead_points(self) -> tuple[PlacedFigure, ...]:
        """The values at which it turns back, in the order of the motion."""
        if not self.moves or self.output.rate not in self.ranges:
            return ()
        if (turning := self._at_extremes()) is not None:
            return turning
        if self.motion.time is None and len(moving_drivers(self.motion, self.design)) != 1:
            return ()
        found = dead_points(self.motion, self.output.coordinate).at
        return self._figures(np.sort(found.place[found.design == self.design]))

    @cached_property
    def quick_return(self) -> QuickReturn | None:
        """The durations of the forward and the return stroke in a cycle. None if it dwells at an end or turns on."""
        if not self.moves or not self.cycle or len(self.dead_points) < 2 or self._turns_on:
            return None
        if self.ranges[self.output.coordinate].rests:
            return None
        assert self.least is not None
        assert self.greatest is not None
        return quick_return_between(self.motion, self.design, self.cycle, self.name, (self.least, self.greatest))

    @property
    def _turns_on(self) -> bool:
        """Whether it ends a turn further after the cycle."""
        assert self.stroke is not None
        course = quantity(self.motion, self.output.coordinate).values
        row = np.broadcast_to(course, self.motion.shape).reshape(self.motion.inputs.designs, -1)[self.design]
        return bool(abs(row[-1] - row[0]) > SAME_PLACE * quantity_number(self.stroke))

    @property
    def time_ratio(self) -> Quantity | None:
        """The longer of forward and return stroke divided by the shorter, in angles of the driver or times."""
        return self.quick_return.time_ratio if self.quick_return else None

    @cached_property
    def dwells(self) -> tuple[Dwell, ...]:
        """The intervals in which it changes by no more than the part `dwell` of its stroke."""
        return self._output_dwells.dwells() if self.moves and self.stroke is not None else ()

    def may_dwell(self, part: float) -> bool:
        """Return, from the poses alone, whether a dwell may last a part of the motion."""
        return self.moves and self.stroke is not None and self._output_dwells.may_dwell(part)

    @property
    def _output_dwells(self) -> OutputDwells:
        assert self.stroke is not None
        return OutputDwells(
            self.motion,
            self.design,
            self.output.coordinate,
            self.cycle,
            self.stroke.unit,
            self.dwell * quantity_number(self.stroke),
            tuple(one.place for one in self.dead_points),
        )

    @cached_property
    def path(self) -> PathFeatures | None:
        """The features of the path of a moving point, None for other outputs."""
        if not self.output.is_point:
            return None
        try:
            found = path_features(self.motion, self.output.owner, None, self.design)
        except CompoundkinError:
            return None
        return replace(found, tolerance=self.straight * found.size)

    @cached_property
    def cycle(self) -> float:
        """The number of poses of a closed cycle, 0 for any other motion."""
        closed = self.motion.inputs.poses > 1 and bool(closed_cycles(self.motion)[self.design])
        return float(self.motion.inputs.poses - 1) if closed else 0.0

    @property
    def moves(self) -> bool:
        """Whether it has a coordinate that changes along the motion."""
        return not self.output.is_point and not self.is_constant and self.motion.inputs.poses > 1

    def _figures(self, places: Number) -> tuple[PlacedFigure, ...]:
        """Return the values of its coordinate at places."""
        if not len(places):
            return ()
        found = quantity(
            between(self.motion, self.design, places, derivative_order(self.output.coordinate)), self.output.coordinate
        )
        at, values = drivers_at(self.motion, self.design, places.tolist()), np.ravel(found.values)
        return tuple(
            PlacedFigure(scalar_quantity(found.name, values[k], found.unit), at[k], float(place))
            for k, place in enumerate(places.tolist())
        )

    def _at_extremes(self) -> tuple[PlacedFigure, ...] | None:
        """Return the dead points if the least and the greatest value are the only ones, else None."""
        if self.motion.order < 1 or self.motion.time is not None:
            return None
        found = quantity(self.motion, self.output.rate).values
        shape = self.motion.inputs.designs, self.motion.inputs.poses
        rates = np.broadcast_to(found, self.motion.shape).reshape(shape)[self.design]
        assert self.least is not None
        assert self.greatest is not None
        inside = [one for one in (self.least, self.greatest) if 0.0 < one.place < shape[1] - 1.0]
        turns = np.count_nonzero(rates[:-1] * rates[1:] < 0.0)
        if np.any(rates == 0.0) or not np.isfinite(rates).all() or turns != len(inside):
            return None
        values = [replace(one, value=replace(one.value, name=self.output.coordinate)) for one in inside]
        return tuple(sorted(values, key=lambda one: one.place))

    def __repr__(self) -> str:
        parts = [one for one in (self.stroke, self.time_ratio) if one is not None]
        return f"OutputFigures({', '.join([self.name, *map(displayed_number, parts)])})"


# A driver makes a full turn within this (radians): rounding of degrees.
SAME = 1e-9


@dataclass(frozen=True, eq=False)
class QuickReturn:
    """The durations of the forward and the return stroke, and the ratio of the longer to the shorter.

    `forth`, from the least to the greatest value, and `back` are angles of the driver, or times of a motion in time.
    The imbalance is the difference of either angle from half a turn; None in time.
    """

    forth: Quantity
    back: Quantity
    time_ratio: Quantity
    imbalance: Quantity | None


def quick_return_between(
    motion: Motion, design: int, cycle: float, name: str, ends: tuple[PlacedFigure, PlacedFigure]
) -> QuickReturn | None:
    """Return the durations of the strokes between the least and the greatest value of a cycle of so many poses.

    None unless one driver makes one full turn or the motion is in time.
    """
    begin, end = drivers_at(motion, design, [0.0, cycle])
    driver, first = next(iter(begin.items()))
    whole = quantity_number(end[driver]) - quantity_number(first)
    if motion.time is None and not _goes_round(begin, whole):
        return None
    a, b = (quantity_number(one.at[driver]) for one in ends)
    forth = float(np.sign(whole) * (b - a) % abs(whole))
    back = abs(whole) - forth
    if not min(forth, back) > 0.0:
        return None
    ratio = Quantity(f"{name}.{TIME_RATIO}", "", max(forth, back) / min(forth, back))
    half = abs(forth - back) / 2.0
    imbalance = scalar_quantity(f"{name}.{IMBALANCE}", half, first.unit) if first.unit == RADIANS else None
    there = scalar_quantity(f"{name}.forth", forth, first.unit)
    return QuickReturn(there, scalar_quantity(f"{name}.back", back, first.unit), ratio, imbalance)


def _goes_round(begin: Mapping[str, Quantity], whole: float) -> bool:
    """Return whether one driver alone moves, by a full turn."""
    return len(begin) == 1 and next(iter(begin.values())).unit == RADIANS and abs(abs(whole) - TURN) <= SAME


@dataclass(frozen=True, eq=False)
class PieceStroke:
    """The stroke of an output over one assembled piece of a motion, between drivers' values `begin` and `end`."""

    begin: Mapping[str, Quantity]
    end: Mapping[str, Quantity]
    least: Quantity
    greatest: Quantity

    @property
    def stroke(self) -> Quantity:
        """The greatest minus the least value."""
        far = float(self.greatest.values) - float(self.least.values)
        return scalar_quantity(self.greatest.name.replace(GREATEST, STROKE), far, self.greatest.unit)


def strokes_by_piece(motion: Motion, design: int, coordinate: str) -> tuple[PieceStroke, ...]:
    """Return the strokes of an output over the assembled pieces of a motion."""
    whole, (found,) = pieces(motion), extremes(motion, coordinate, by_piece=True)
    made = []
    for k in np.flatnonzero(whole.begin.design == design).tolist():
        begin, end = drivers_at(motion, design, [float(whole.begin.place[k]), float(whole.end.place[k])])
        values = (scalar_quantity(f"{coordinate}.{word}", float(one.value[k]), found.unit)
                  for word, one in ((LEAST, found.least), (GREATEST, found.greatest)))  # fmt: skip
        made.append(PieceStroke(begin, end, *values))
    return tuple(made)
