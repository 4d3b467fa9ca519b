"""Plans of calls: what arguments of a known form are to a program, kept from one call of the form to the next.

A call of some hundred poses takes a few microseconds in a program, so that every check of its arguments counts. The
first call of a form, that is of arguments of the same types, shapes and names, is read in full, with all checks. From
it the plan knows where each number goes; later calls need only those checks that depend on numbers. What does not pass
them is read in full again, which reports it. A plan is kept only if it reads what was read in full.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import takewhile
from math import copysign, prod
from typing import Any, NamedTuple

import numpy as np

from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.kinematics.driver_values import RATES, fit, timed
from compoundkin.kinematics.solution import COUNTED
from compoundkin.model.attributes import RATES as RATE_WORDS
from compoundkin.model.elements import Drive
from compoundkin.programs.call_numbers import (
    COMPLEX,
    FLOAT,
    READABLE_FLAGS,
    Call,
    CallNumbers,
    ReadyProgram,
    parameter_inputs,
)
from compoundkin.programs.graph.operation_graph import DRIVE, InputNumber
from compoundkin.programs.recorded_path import PathVariants

# So many plain numbers are kept as arrays, and so many plans.
NUMBERS_KEPT, PLANS_KEPT = 256, 64
# So few values are copied in less time than it takes to ask where they lie.
FEW_VALUES = 1_000
# The greatest finite number: greater whole numbers are not floats, and comparisons with NaN are false.
LARGEST_FLOAT = float(np.finfo(float).max)
# Plain numbers by their types: what they are read as.
NUMBERS: Mapping[type, type] = {float: float, int: float, np.float64: float, complex: complex, np.complex128: complex}
# Some arguments of a call, in the order of `Call`; parameters of an objective may follow. Rates stand between.
VALUES, DIMENSIONS, TIME, PARAMETERS = 0, 1, 5, 6
ZERO = np.zeros((1, 1))


class CallForm(NamedTuple):
    """The form of a call, by which its plan is known, and its numbers in the order of the form."""

    key: tuple[Any, ...]
    numbers: list[Any]

    @classmethod
    def of(cls, arguments: Sequence[Any]) -> CallForm | None:
        """Return the form of arguments; None where some are of other types than plans can read."""
        form: list[Any] = []
        numbers: list[Any] = []
        for one in arguments:
            if type(one) is dict:
                form.append((dict, *one))
                numbers += one.values()
            else:
                numbers.append(one)
        for k, one in enumerate(numbers):
            if one is None:
                form.append(None)
                continue
            kind = type(one)
            if kind is list:
                one = numbers[k] = _array_of_list(one)
                kind = type(one)
            if kind is np.ndarray:
                dtype, shape = one.dtype, one.shape
                if dtype is not FLOAT and dtype is not COMPLEX:
                    return None
                if not shape:
                    numbers[k] = one.item()
                    form.append(NUMBERS[dtype.type])
                else:
                    form.append(shape if dtype is FLOAT else (complex, shape))
            elif kind in NUMBERS:
                form.append(NUMBERS[kind])
            elif kind is tuple and _is_point(one) and _is_dimension(arguments, k):
                numbers[k] = complex(*one)
                form.append(tuple)
            else:
                return None
        return cls(tuple(form), numbers)


def _is_point(pair: tuple[Any, ...]) -> bool:
    """Tell whether a pair is that of a point: two finite real numbers."""
    if len(pair) != 2:
        return False
    x, y = pair
    are_real = NUMBERS.get(type(x)) is float and NUMBERS.get(type(y)) is float
    return are_real and -LARGEST_FLOAT <= x <= LARGEST_FLOAT and -LARGEST_FLOAT <= y <= LARGEST_FLOAT


def _is_dimension(arguments: Sequence[Any], k: int) -> bool:
    """Tell whether a number of a call is a free dimension."""
    values, dimensions = arguments[VALUES], arguments[DIMENSIONS]
    before = len(values) if type(values) is dict else 1
    return type(dimensions) is dict and before <= k < before + len(dimensions)


def _array_of_list(values: list[Any]) -> Any:
    """Return a list of numbers as an array; the list itself where it holds anything else, or lists."""
    found = np.array(values) if values and type(values[0]) in NUMBERS else None
    return found if found is not None and found.dtype is FLOAT else values


class CallPlans(ShortRepr):
    """The plans of a path's calls, by their forms. Numbers that `are_kept` are copied: the caller may change his."""

    def __init__(self, path: PathVariants, are_kept: bool = True) -> None:
        self.path, self.are_kept = path, are_kept
        self._plans: dict[tuple[Any, ...], CallPlan] = {}
        self._arrays: dict[float, Number] = {}

    @property
    def known(self) -> tuple[CallPlan, ...]:
        """The plans that are kept."""
        return tuple(self._plans.values())

    def read(self, arguments: Sequence[Any]) -> ReadCall | None:
        """Return a call that is read by its plan; None where there is none, or its numbers need more checks."""
        form = CallForm.of(arguments)
        plan = None if form is None else self._plans.get(form.key)
        return None if form is None or plan is None else plan.read(form.numbers)

    def keep(self, arguments: Sequence[Any], numbers: CallNumbers) -> None:
        """Make the plan of a call that was read in full, and keep it if it reads the same."""
        form = CallForm.of(arguments)
        if form is None or form.key in self._plans:
            return
        # free numbers of laws move the drivers; seeds are found by solving
        if any(one.is_of_law for one in self.path.dimensions) or numbers.is_seeded or numbers.marches:
            return
        plan = CallPlan(self.path, arguments, numbers, self)
        read = plan.read(form.numbers)
        if read is not None and _is_same(read.numbers(), numbers):
            if len(self._plans) >= PLANS_KEPT:
                self._plans.clear()
            self._plans[form.key] = plan

    def array(self, number: float) -> Number:
        """Return a number as an array (1, 1)."""
        if not number:
            return ZERO if copysign(1.0, number) > 0.0 else -ZERO
        array = self._arrays.get(number)
        if array is None:
            if len(self._arrays) >= NUMBERS_KEPT:
                self._arrays.clear()
            array = self._arrays[number] = np.full((1, 1), float(number))
        return array


def _is_same(one: CallNumbers, other: CallNumbers) -> bool:
    return (
        one.shape == other.shape
        and one.still == other.still
        and list(one.given) == list(other.given)
        and all(
            a.shape == b.shape and np.array_equal(a, b)
            for a, b in zip(one.given.values(), other.given.values(), strict=True)
        )
    )


# What stands for the times among the inputs of a call.
TIMES = InputNumber(DRIVE, "", "times")


def _inputs_of_numbers(path: PathVariants, arguments: Sequence[Any]) -> list[tuple[InputNumber, ...]]:
    """Return the inputs that each number of a call is, in the order of `CallForm.numbers`."""
    names = [one.name for one in path.reference.mechanism.drives]
    dimensions = {one.name: one.inputs for one in path.dimensions}
    found: list[tuple[InputNumber, ...]] = []
    for k, one in enumerate(arguments):
        if k == DIMENSIONS:
            found += [dimensions[name] for name in one] if isinstance(one, dict) else [()]
        elif k == PARAMETERS:
            found += [parameter_inputs(name, np.iscomplexobj(value)) for name, value in one.items()]
        elif k == TIME:
            found.append(() if one is None else (TIMES,))
        else:
            part, given = str(0 if k == VALUES else k - DIMENSIONS), one if isinstance(one, dict) else {names[0]: one}
            found += [() if value is None else (InputNumber(DRIVE, name, part),) for name, value in given.items()]
    return found


class NumberPlace(NamedTuple):
    """Where a number of a call goes: its index among them, the inputs that its parts are, its form there.

    An array is broadcast to the shape `whole`, where that is needed, and laid as `rows`; a plain number has no rows.
    `is_copied` tells whether it is copied although a program can read it as it is.
    """

    number: int
    inputs: tuple[int, ...]
    rows: tuple[int, int] | None
    whole: tuple[int, ...] | None
    is_copied: bool

    def laid(self, array: Number) -> list[Number]:
        """Return the parts of an array in the form of inputs."""
        if self.whole is not None:
            array = np.broadcast_to(array, self.whole)
        is_copied = self.is_copied or array.flags.num & READABLE_FLAGS != READABLE_FLAGS
        parts = (array.real, array.imag) if len(self.inputs) > 1 else (array,)
        laid = [one.reshape(self.rows) for one in parts]
        return [one.copy() for one in laid] if is_copied else laid


class TimedDriver(NamedTuple):
    """A driver that moves in time: the inputs that it is, and the numbers that say how it does.

    Those are value, speed, acceleration and jerk at time 0: its `own`, or those of the call, by their indices.
    `called` tells which of them, by its word, the call gives.
    """

    drive: Drive
    inputs: tuple[int, ...]
    own: tuple[Number, ...]
    numbers: tuple[int | None, ...]
    called: Mapping[str, bool]

    @classmethod
    def of(cls, drive: Drive, inputs: tuple[int, ...], names: Sequence[tuple[InputNumber, ...]]) -> TimedDriver:
        """Return a driver; `names` are the inputs that the numbers of the call are."""
        own = 0.0 if drive.values is None else drive.values, drive.speed, drive.acceleration, drive.jerk
        numbers = tuple(names.index((name,)) if (name,) in names else None for name in drive_inputs(drive.name))
        called = {word: k is not None for word, k in zip(("values", *RATE_WORDS), numbers, strict=True)}
        return cls(drive, inputs, own, numbers, called)

    def moved(self, numbers: Sequence[Any], times: Number, order: int) -> tuple[Number, ...] | None:
        """Return its value and rates at times; None where a number is not finite."""
        given = list(self.own)
        for k, number in enumerate(self.numbers):
            if number is not None:
                one = numbers[number]
                is_array = isinstance(one, np.ndarray)
                if not (_are_finite(one) if is_array else -LARGEST_FLOAT <= one <= LARGEST_FLOAT):
                    return None
                given[k] = one if is_array else float(one)
        return timed(self.drive, tuple(given), times, self.called, order)


class CallPlan(ShortRepr):
    """What the numbers of calls of one form are to programs.

    `inputs` are the inputs in their order, `shape` is that of the call's arrays, `values` are the places of drivers'
    values among the inputs, by name. `moving` are the drivers that have a value at each pose of one design, whose
    longest steps a program finds beside; `held` the places of those of them whose values the caller gives and results
    keep, which a program copies beside: it reads them anyway.
    """

    def __init__(self, path: PathVariants, arguments: Sequence[Any], numbers: CallNumbers, plans: CallPlans) -> None:
        self.path, self.array, self._are_kept = path, plans.array, plans.are_kept
        self.inputs, self.shape, self.extent = tuple(numbers.given), numbers.shape, numbers.extent
        self._own = [ZERO if a.size == 1 and a is not ZERO and _is_plain_zero(a) else a for a in numbers.given.values()]
        drives, angles = path.reference.mechanism.drives, path.reference.structure.driven_angles
        of_drives = [tuple(map(self.inputs.index, drive_inputs(one.name))) for one in drives]
        self.values = {one.name: inputs[0] for one, inputs in zip(drives, of_drives, strict=True)}
        self._angles = [place for one, (place, *_) in zip(drives, of_drives, strict=True) if angles[one.name]]
        self._rates = [place for _, *rates in of_drives for place in rates]
        self._still: dict[tuple[bool, ...], frozenset[tuple[str, int]]] = {}
        self._programs: dict[Any, PlannedProgram | None] = {}
        names = _inputs_of_numbers(path, arguments)
        flat = CallForm.of(arguments)
        assert flat is not None
        self.times = Call(*arguments[:PARAMETERS]).times(path.reference.solving_order)
        self._time = next((k for k, name in enumerate(names) if name == (TIMES,)), None)
        in_time = set() if self.times is None else {name for one in drives for name in drive_inputs(one.name)}
        is_long = numbers.extent[0] == 1 < numbers.extent[1]
        own = {name: self._own[k] for name, k in self.values.items()}
        self.moving = tuple(name for name, value in own.items() if is_long and value.shape == numbers.extent)
        self._places = [
            self._place(k, name, np.shape(number))
            for k, (name, number) in enumerate(zip(names, flat.numbers, strict=True))
            if name and name != (TIMES,) and not in_time.issuperset(name)
        ]
        laid = {k for place in self._places for k in place.inputs}
        self.held = {name: k for name, k in self.values.items() if name in self.moving and self._are_kept and k in laid}
        self._timed = [
            TimedDriver.of(one, inputs, names) for one, inputs in zip(drives, of_drives, strict=True) if in_time
        ]
        self._fitted, self._order = fit(self.shape), max(output.attribute.order for output in path.outputs)

    def _place(self, number: int, names: tuple[InputNumber, ...], shape: tuple[int, ...]) -> NumberPlace:
        inputs = tuple(map(self.inputs.index, names))
        # of several designs each reads it: one number after another, it is read in less time
        is_copied = self._are_kept or self.extent[0] > 1
        is_copied &= not any(self.values[name] in inputs for name in self.moving)
        if not shape:
            return NumberPlace(number, inputs, None, None, is_copied)
        if prod(shape) == shape[-1]:
            return NumberPlace(number, inputs, (1, shape[-1]), None, is_copied)
        whole = (*self.shape[:-1], shape[-1])
        rows = self.extent[0], shape[-1]
        return NumberPlace(number, inputs, rows, None if shape == whole else whole, is_copied)

    def read(self, numbers: Sequence[Any]) -> ReadCall | None:
        """Return the numbers of a call as inputs; None where they need the checks of a full reading.

        Whether drivers' values are finite is left to `ReadCall.is_finite`.
        """
        given, values = self._own.copy(), self.values.values()
        for place in self._places:
            number, inputs = numbers[place.number], place.inputs
            if place.rows is None:
                if not -LARGEST_FLOAT <= number.real <= LARGEST_FLOAT:
                    return None
                given[inputs[0]] = self.array(number.real)
                if len(inputs) > 1:
                    if not -LARGEST_FLOAT <= number.imag <= LARGEST_FLOAT:
                        return None
                    given[inputs[1]] = self.array(number.imag)
            else:
                if inputs[0] not in values and not _are_finite(number):
                    return None
                for k, part in zip(inputs, place.laid(number), strict=True):
                    given[k] = part
        if self._timed:
            if not self._move(given, numbers):
                return None
        else:
            for k in self._angles:
                first, last = given[k].item(0), given[k].item(-1)
                if first.is_integer() and last.is_integer() and max(first, last, -first, -last) > COUNTED:
                    return None
        still = tuple([given[k] is ZERO or _is_zero(given[k]) for k in self._rates])
        return ReadCall(self, given, still)

    def _move(self, given: list[Number], numbers: Sequence[Any]) -> bool:
        """Put the drivers where they are at the times of a call; tell whether all is finite that says where."""
        times: Any = self.times if self._time is None else numbers[self._time]
        if isinstance(times, np.ndarray):
            if not _are_finite(times):
                return False
            # what follows from a copy may stay as it is: the caller may change his before it is read
            times = times.copy()
        elif not -LARGEST_FLOAT <= times <= LARGEST_FLOAT:
            return False
        for one in self._timed:
            moved = one.moved(numbers, times, self._order)
            if moved is None:
                return False
            for k, value in zip(one.inputs, moved, strict=True):
                given[k] = self._laid(value)
        return True

    def _laid(self, value: Number) -> Number:
        """Return a value of a driver in the form of inputs."""
        if isinstance(value, np.ndarray) and value.ndim:
            if value.ndim == len(self.shape) == 1:
                return value[None] if value.dtype is FLOAT else np.array(value, float, ndmin=2)
            return np.array(self._fitted(value), float, ndmin=2)
        return self.array(float(value))

    def still(self, zero: tuple[bool, ...]) -> frozenset[tuple[str, int]]:
        """Return the drivers' rates that are zero, (driver, order)."""
        if zero not in self._still:
            rates = [self.inputs[k] for k in self._rates]
            self._still[zero] = frozenset(
                (one.name, int(one.part)) for one, is_zero in zip(rates, zero, strict=True) if is_zero
            )
        return self._still[zero]

    def program(
        self, key: Any, read: ReadCall, least: Any, make: Callable[[CallPlan, CallNumbers], ReadyProgram[Any] | None]
    ) -> PlannedProgram | None:
        """Return the program of a call of this form, made once for a key.

        `least` is the name of the least margin among its results. None where the program needs other inputs, or the
        drivers' values are not finite.
        """
        found = self._programs.get((key, read.zero))
        if found is None and (key, read.zero) not in self._programs:
            made = make(self, read.numbers())
            found = None if made is None else PlannedProgram.of(made, self, least)
            self._programs[key, read.zero] = found
        return found if found is not None and (found.is_watched or read.is_finite()) else None


def drive_inputs(name: str) -> tuple[InputNumber, ...]:
    """Return the inputs that a driver is: its value and rates."""
    return tuple(InputNumber(DRIVE, name, str(k)) for k in range(RATES))


def _is_zero(array: Number) -> bool:
    # zeros are counted in less time than `any` takes
    return bool(array.item(0) == 0.0) and not np.count_nonzero(array)


def _are_finite(array: Number) -> bool:
    """Tell whether all numbers of an array are finite, which it has some of."""
    if array.dtype is not FLOAT:
        return bool(np.isfinite(array).all())
    # places of the extremes are found in less time than it takes to ask each number; NaN counts as either
    least, greatest = array.item(array.argmin()), array.item(array.argmax())
    return -LARGEST_FLOAT <= least <= LARGEST_FLOAT and bool(-LARGEST_FLOAT <= greatest <= LARGEST_FLOAT)


def _is_plain_zero(array: Number) -> bool:
    return array.shape == (1, 1) and not array.item() and copysign(1.0, array.item()) > 0.0


class ReadCall:
    """A call read by its plan: its inputs, and which rates of drivers are `zero`, in their order."""

    __slots__ = ("given", "plan", "zero")

    def __init__(self, plan: CallPlan, given: list[Number], zero: tuple[bool, ...]) -> None:
        self.plan, self.given, self.zero = plan, given, zero

    def numbers(self) -> CallNumbers:
        """Return the inputs by name."""
        plan = self.plan
        return CallNumbers(dict(zip(plan.inputs, self.given, strict=True)), plan.shape, plan.still(self.zero))

    def hold(self) -> None:
        """Put copies in place of the values that are held."""
        for k in self.plan.held.values():
            self.given[k] = self.given[k].copy()

    def keep_apart(self, others: Collection[Number]) -> None:
        """Put copies in place of the values that are held and may lie in the memory of some arrays."""
        for k in self.plan.held.values():
            value = self.given[k]
            if value.size < FEW_VALUES or True in [np.may_share_memory(value, other) for other in others]:
                self.given[k] = value.copy()

    def is_finite(self) -> bool:
        """Tell whether the drivers' values are finite; all else is."""
        return all(_are_finite(self.given[k]) for k in self.plan.values.values())

    @property
    def driver_values(self) -> dict[str, Number]:
        """The drivers' values, without rates, by name."""
        given = self.given
        return {name: given[k] for name, k in self.plan.values.items()}


class PlannedProgram(NamedTuple):
    """A program, and the places of its inputs among those of a call.

    `is_watched` tells whether driver values that are not finite spoil the least margin, which is among the results;
    `vectors` are the results before it by name, and which are vectors.
    """

    program: ReadyProgram[Any]
    places: tuple[int, ...]
    is_watched: bool
    vectors: Mapping[Any, bool]

    @classmethod
    def of(cls, program: ReadyProgram[Any], plan: CallPlan, least: Any) -> PlannedProgram | None:
        """Return the plan of a program with the least margin by this name; None where it has other inputs."""
        flat = program.flat
        known = {name: k for k, name in enumerate(plan.inputs)}
        names = [flat.graph.nodes[k].given for k in flat.given]
        if any(name not in known for name in names):
            return None
        needed = flat.graph.needed(program.nodes[least])
        is_watched = all(flat.graph.input(plan.inputs[k]) in needed for k in plan.values.values())
        outputs = takewhile(lambda item: item[0] != least, program.nodes.items())
        vectors = {name: len(nodes) > 1 for name, nodes in outputs}
        return cls(program, tuple(known[name] for name in names if name is not None), is_watched, vectors)

    def run(self, read: ReadCall, threads: int, given: Mapping[Any, Number] | None = None) -> list[Number]:
        """Compute the results of a call, in their order."""
        return self.program.computed([read.given[k] for k in self.places], read.plan.extent, threads, given)
