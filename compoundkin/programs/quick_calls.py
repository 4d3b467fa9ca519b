"""Quick calls: one driver's values in an array, plain numbers and columns of designs; others go the general way.

A call of some hundred poses takes a few microseconds in a program, so that every check of its arguments counts. Values
that are not finite need no check where they would spoil the margin of a group: the general way reports them then.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.buffers import LARGE, arrays_of_one_buffer, keep_freed_memory
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.curve.change_points import NEAR
from compoundkin.kinematics.curve.driver_path import SPACING
from compoundkin.kinematics.solution import COUNTED
from compoundkin.programs.call_numbers import Call, CallNumbers, ReadyProgram
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE
from compoundkin.programs.graph.operation_graph import DRIVE, InputNumber
from compoundkin.programs.limit_screening import passes_value

if TYPE_CHECKING:
    from compoundkin.programs.path_programs import PathPrograms
    from compoundkin.programs.path_values import PathValues

# So many plain numbers are kept as arrays.
NUMBERS_KEPT = 256
# The greatest finite number: greater whole numbers are not floats, and comparisons with NaN are false.
LARGEST_FLOAT = float(np.finfo(float).max)
FLOAT, COMPLEX = np.dtype(float), np.dtype(complex)


class QuickCalls(ShortRepr):
    """Calls of a path with one driver, read and computed with few checks.

    Arguments become arrays (1 or designs, 1 or poses) in one order: free dimensions, the driver's value, its rates.
    """

    def __init__(self, path: PathPrograms, driver: str, rates: tuple[float, ...]) -> None:
        self.path, self.driver, self.rates = path, driver, rates
        order = path.reference.solving_order
        self.is_angle = order.structure.driven_angles[driver]
        self.longest = order.unit(driver) * SPACING
        drawn = path.approach.drawn(driver)
        self.drawn = None if drawn is None else float(np.ravel(drawn)[0])
        self.names: list[InputNumber] = []
        self.own: list[Number] = []
        self.places: dict[str, tuple[int, bool]] = {}
        for one in path.dimensions:
            value = complex(path.stated.own(one))
            if not one.is_of_law:
                self.places[one.name] = len(self.own), one.is_vector
            self.names += one.inputs
            self.own += [np.full((1, 1), part) for part in (value.real, value.imag)[: len(one.inputs)]]
        self.at = len(self.own)
        self.names += [InputNumber(DRIVE, driver, str(k)) for k in range(4)]
        self.own += [np.zeros((1, 1)), *(np.full((1, 1), rate) for rate in rates)]
        self._arrays: dict[float, Number] = {}
        self._plans: dict[Any, QuickPlan | None] = {}

    @classmethod
    def of(cls, path: PathPrograms) -> QuickCalls | None:
        """Return the quick calls of a path; None where it has several drivers, or designs of its own."""
        drives = path.reference.mechanism.drives
        if len(drives) != 1:
            return None
        rates = drives[0].speed, drives[0].acceleration, drives[0].jerk
        if any(np.ndim(value) for value in (*rates, *(path.stated.own(one) for one in path.dimensions))):
            return None
        return cls(path, drives[0].name, tuple(float(rate) for rate in rates))

    def values(self, values: Any, dimensions: Any, rates: tuple[Any, Any, Any], threads: Any) -> PathValues | None:
        """Return the values of a call; None where it has to go the general way."""
        if type(values) is dict and len(values) == 1:
            values = values.get(self.driver)
        if type(values) is not np.ndarray or values.dtype is not FLOAT or values.ndim != 1 or len(values) < 2:
            return None
        first, last = values.item(0), values.item(-1)
        if self.is_angle and first.is_integer() and last.is_integer() and max(first, last, -first, -last) > COUNTED:
            return None
        given = self.own.copy()
        given[self.at] = values[None].copy()  # the caller may change his array before the result is read
        still = self._with_rates(given, rates)
        placed = self._with_dimensions(given, dimensions) if dimensions is not None else (1, 0)
        if still is None or placed is None or type(threads) is not int or threads < 1:
            return None
        designs, columns = placed
        if (still, columns) not in self._plans:
            self._plans[still, columns] = self._plan(self._numbers(given, designs, still))
        plan = self._plans[still, columns]
        if plan is None or (not plan.is_watched and not np.isfinite(values).all()):
            return None
        extent = designs, len(values)
        arrays, least = plan.run(given, extent, threads)
        if self._is_certain(least, values, first, last):
            numbers = partial(self._numbers, given, designs, still)
            return self.path.path_values(numbers, arrays, None, extent if columns else extent[1:])
        # the general way reports values that are not finite
        return self.path.checked_values(self.path.numbers(Call(values, dimensions, *rates)), arrays, least)

    def _plan(self, numbers: CallNumbers) -> QuickPlan | None:
        if self.path.variant(numbers.still).seeds:
            return None
        return QuickPlan.of(self.path.program(numbers), numbers, self.names[self.at])

    def _with_rates(self, given: list[Number], rates: tuple[Any, Any, Any]) -> int | None:
        """Put rates in their places; return which are zero, as bits."""
        zero = 0
        for k, rate in enumerate(rates):
            if rate is None:
                rate = self.rates[k]
            elif type(rate) in (float, int) and -LARGEST_FLOAT <= rate <= LARGEST_FLOAT:
                given[self.at + 1 + k] = self._array(rate)
            else:
                return None
            if rate == 0:
                zero |= 1 << k
        return zero

    def _with_dimensions(self, given: list[Number], dimensions: Any) -> tuple[int, int] | None:
        """Put dimensions in their places; return how many designs there are, and which are columns, as bits."""
        designs, columns = 1, 0
        if not isinstance(dimensions, Mapping):
            return None
        for name, value in dimensions.items():
            k, is_vector = self.places.get(name, (-1, False))
            if k < 0:
                return None
            if type(value) is np.ndarray:
                if value.dtype is not (COMPLEX if is_vector else FLOAT) or value.ndim != 2 or value.shape[1] != 1:
                    return None
                if len(value) < 2 or designs not in (1, len(value)) or not np.isfinite(value).all():
                    return None
                designs, columns = len(value), columns | 1 << k
                given[k] = value.real.copy()
                if is_vector:
                    given[k + 1] = value.imag.copy()
            elif type(value) in (float, int) or (is_vector and type(value) is complex):
                if not (
                    -LARGEST_FLOAT <= value.real <= LARGEST_FLOAT and -LARGEST_FLOAT <= value.imag <= LARGEST_FLOAT
                ):
                    return None
                given[k] = self._array(value.real)
                if is_vector:
                    given[k + 1] = self._array(value.imag)
            else:
                return None
        return designs, columns

    def _array(self, number: float) -> Number:
        array = self._arrays.get(number)
        if array is None:
            if len(self._arrays) >= NUMBERS_KEPT:
                self._arrays.clear()
            array = self._arrays[number] = np.full((1, 1), float(number))
        return array

    def _numbers(self, given: list[Number], designs: int, still: int) -> CallNumbers:
        zero = frozenset((self.driver, k + 1) for k in range(3) if still >> k & 1)
        shape = (designs, given[self.at].shape[1])
        return CallNumbers(dict(zip(self.names, given, strict=True)), shape if designs > 1 else shape[1:], zero)

    def _is_certain(self, least: Number, values: Number, first: float, last: float) -> bool:
        """Tell whether no design needs screening, as `LimitScreening.needed` does."""
        margin = least.item() if least.size == 1 else float(least.min())
        if not margin >= NEAR or not (self.drawn is None or passes_value(self.drawn, first, last, self.is_angle)):
            return False
        steps = values[1:] - values[:-1]
        longest = self.longest * sqrt(margin / NEAR)
        return bool(steps[steps.argmax()] <= longest and steps[steps.argmin()] >= -longest)


class QuickPlan(ShortRepr):
    """A program, and the places of its inputs and results.

    `is_watched` tells whether driver values that are not finite spoil the least margin.
    """

    __slots__ = ("_picks", "_rows", "_runner", "_shapes", "is_watched")

    def __init__(self, program: ReadyProgram[str], numbers: CallNumbers, value: InputNumber) -> None:
        flat, names = program.flat, list(numbers.given)
        least = flat.outputs[-1]
        self._runner = program.runner
        self._picks = [names.index(flat.graph.nodes[k].given) for k in flat.inputs]  # type: ignore[arg-type]
        # whether each output, and at last the margin, is a vector, and how it varies
        self._rows = [(len(nodes) > 1, flat.strata[nodes[0]]) for nodes in program.nodes.values()]
        self._shapes = self._shaped((1, 1))
        self.is_watched = flat.graph.input(value) in flat.graph.needed([least])

    @classmethod
    def of(cls, program: ReadyProgram[str], numbers: CallNumbers, value: InputNumber) -> QuickPlan | None:
        """Return the plan of a program; None where it has other inputs, or parts of a vector vary by other axes."""
        flat = program.flat
        if any(flat.graph.nodes[k].given not in numbers.given for k in flat.inputs):
            return None
        if any(len({flat.strata[k] for k in nodes}) > 1 for nodes in program.nodes.values()):
            return None
        return cls(program, numbers, value)

    def run(self, given: Sequence[Number], extent: tuple[int, int], threads: int) -> tuple[list[Number], Number]:
        """Compute the outputs and the least margin."""
        known, shapes, is_large = self._shapes
        if known != extent:
            known, shapes, is_large = self._shapes = self._shaped(extent)
        if is_large:
            keep_freed_memory()
            arrays = arrays_of_one_buffer(shapes)
        else:
            arrays = [np.empty(shape, dtype) for shape, dtype in shapes]
        rows: list[Any] = []
        for array, (is_vector, _) in zip(arrays, self._rows, strict=True):
            if is_vector:
                rows.append(array.real)
                rows.append(array.imag)
            else:
                rows.append(array)
        self._runner([given[k] for k in self._picks], rows, extent, threads)
        return arrays[:-1], rows[-1]

    def _shaped(self, extent: tuple[int, int]) -> tuple[tuple[int, int], list[Any], bool]:
        """Return the shapes and types of the arrays of a call, and whether they are large."""
        designs, poses = extent
        shapes = [
            ((designs if stratum & BY_DESIGN else 1, poses if stratum & BY_POSE else 1), COMPLEX if vector else FLOAT)
            for vector, stratum in self._rows
        ]
        return extent, shapes, designs * poses * len(shapes) * COMPLEX.itemsize >= LARGE
