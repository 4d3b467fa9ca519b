"""The dwells of an output: where it keeps its value within a part of its stroke, by the drivers' values there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from compoundkin.analysis.characteristics.dwell_intervals import DwellSpan, Sampled, dwells, longest_run
from compoundkin.analysis.characteristics.figure import drivers_at, number, scalar
from compoundkin.base.arrays import Number
from compoundkin.kinematics import Motion
from compoundkin.kinematics.extremes import between
from compoundkin.kinematics.quantities import Quantity, quantity
from compoundkin.model.attributes import derivative_order

# A motion is shown by about so many samples when dwells are looked for.
SAMPLES = 288
# A dwell takes at least this part of the motion.
SHORTEST = 1.0 / 36.0


@dataclass(frozen=True, eq=False)
class Dwell:
    """An interval in which an output changes by no more than a tolerance.

    `begin` and `end` are the drivers' values there, `span` how far the only driver that moves goes, or for how long
    where the motion is in time; `value` is the middle of the band the output stays in, `poses` how many poses it takes.
    """

    begin: Mapping[str, Quantity]
    end: Mapping[str, Quantity]
    span: Quantity
    value: Quantity
    poses: float


@dataclass(frozen=True, eq=False)
class OutputCourse:
    """The course of a coordinate along a motion, in which dwells are looked for.

    They are within a `tolerance`. It comes again after a `cycle` of so many poses, where that is not zero. `turns` are
    the places of its dead points.
    """

    motion: Motion
    design: int
    coordinate: str
    cycle: float
    unit: str
    tolerance: float
    turns: tuple[float, ...]

    def dwells(self) -> tuple[Dwell, ...]:
        """Return its dwells in their order."""
        spans = dwells(self._sampled, self.tolerance, SHORTEST * (self.motion.inputs.poses - 1))
        return tuple(map(self._dwell, spans))

    def may_dwell(self, part: float) -> bool:
        """Tell from the poses whether a dwell may take a part of the motion."""
        shape = self.motion.inputs.designs, self.motion.inputs.poses
        found = quantity(self.motion, self.coordinate).values
        values = np.broadcast_to(found, self.motion.shape).reshape(shape)[self.design]
        return longest_run(values, self.tolerance, bool(self.cycle)) >= part * (shape[1] - 1) - 2.0

    @cached_property
    def _sampled(self) -> Sampled:
        """The coordinate at places, the poses and dead points among them."""
        last = self.motion.inputs.poses - 1
        count = last * max(1, -(-SAMPLES // last)) + 1
        places = np.union1d(np.linspace(0.0, last, count), self.turns)
        values = self._at(places)
        good = np.isfinite(values)
        advance = float(values[-1] - values[0]) if self.cycle else 0.0
        return Sampled(places[good], values[good], self._at, self.cycle, advance)

    def _at(self, s: Number) -> Number:
        there = between(self.motion, self.design, np.ravel(s), derivative_order(self.coordinate))
        return np.ravel(quantity(there, self.coordinate).values)

    def _dwell(self, span: DwellSpan) -> Dwell:
        around = bool(self.cycle) and span.last > self.motion.inputs.poses - 1
        ends = [span.first, span.last - self.cycle if around else span.last]
        begin, end, first, last = drivers_at(self.motion, self.design, [*ends, 0.0, self.cycle])
        name = next(iter(begin))
        far = number(end[name]) - number(begin[name]) + around * (number(last[name]) - number(first[name]))
        middle = scalar(self.coordinate, 0.5 * (span.low + span.high), self.unit)
        return Dwell(begin, end, scalar(f"{name}.span", abs(far), begin[name].unit), middle, span.last - span.first)
