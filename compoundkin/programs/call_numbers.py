"""The numbers of one call of a program: drivers' values and rates, free dimensions, output arrays, threads.

A `ReadyProgram` computes the results of such numbers: complex arrays of two nodes, which may vary by fewer axes.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import prod
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from compoundkin.base.arguments import planar_numbers, real_numbers
from compoundkin.base.arrays import Number
from compoundkin.base.buffers import BufferLayout
from compoundkin.base.display import ShortRepr, short_repr
from compoundkin.base.errors import InvalidInput, Problem, suggestion
from compoundkin.kinematics.driver_values import Inputs, by_name, fit, inputs, times_of
from compoundkin.kinematics.solution import warn_of_degrees
from compoundkin.kinematics.solving_order import SolvingOrder
from compoundkin.model.elements import Drive
from compoundkin.programs.backends import runner_of
from compoundkin.programs.backends.runner import Runner
from compoundkin.programs.dimensions import FreeDimension, drives_of_call
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, Carried, FlatProgram, flat_program
from compoundkin.programs.graph.operation_graph import (
    BEFORE,
    DRIVE,
    INPUT,
    PARAMETER,
    SEED,
    STEP,
    InputNumber,
    OperationGraph,
)

FLOAT, COMPLEX = np.dtype(float), np.dtype(complex)


class Call(NamedTuple):
    """The arguments of a call of a compiled path, as its caller gives them; None is what the mechanism has itself."""

    values: Any = None
    dimensions: Mapping[str, Any] | None = None
    speed: Any = None
    acceleration: Any = None
    jerk: Any = None
    time: Any = None

    def times(self, order: SolvingOrder, drives: Sequence[Drive] | None = None) -> Number | None:
        """Return the times of the motion; None where values are given."""
        mechanism = order.structure.mechanism
        return times_of(mechanism, by_name(mechanism, self.values), self.time, drives)

    def inputs(self, order: SolvingOrder, highest: int, drives: Sequence[Drive] | None = None) -> Inputs:
        """Return values and rates of the drivers as `solve` takes them; raises InvalidInput for what does not fit.

        Laws that jump report their corners up to the `highest` derivative only. `drives` may replace the mechanism's.
        """
        values = by_name(order.structure.mechanism, self.values)
        times = self.times(order, drives)
        driven = inputs(order, values, self.speed, self.acceleration, self.jerk, times, highest, drives)
        if times is None:
            warn_of_degrees(order.structure, driven)
        return driven


@dataclass(frozen=True)
class CallNumbers:
    """The inputs of a call.

    Each is a float array (1 or designs, 1 or poses); `shape` is that of the call's arrays, `still` are the
    drivers' rates, (driver, order), that are zero.
    """

    given: Mapping[InputNumber, Number]
    shape: tuple[int, ...]
    still: frozenset[tuple[str, int]]

    @property
    def extent(self) -> tuple[int, int]:
        """Designs x poses."""
        return prod(self.shape[:-1]), self.shape[-1] if self.shape else 1

    @property
    def form(self) -> Any:
        """What a program depends on: which rates are zero, and how each input varies."""
        return self.still, self.marches, tuple(_stratum(array) for array in self.given.values())

    @property
    def marches(self) -> bool:
        """Whether states are carried along the motion: the drivers' steps are inputs."""
        return any(one.part == STEP for one in self.given)

    @property
    def is_seeded(self) -> bool:
        """Whether some of them are results of solving."""
        return any(one.kind == SEED for one in self.given)

    @property
    def driver_values(self) -> dict[str, Number]:
        """The drivers' values, without rates, by name."""
        return {one.name: value for one, value in self.given.items() if (one.kind, one.part) == (DRIVE, "0")}

    def strata(self, graph: OperationGraph) -> dict[InputNumber, int]:
        """Return how each input varies; inputs from outside the call vary by both."""
        known = {given: _stratum(array) for given, array in self.given.items()}
        inputs = (node.given for node in graph.nodes if node.operation == INPUT and node.given)
        places = {one: one._replace(part="0") if one.part == BEFORE else one for one in inputs}
        return {given: known.get(place, BY_DESIGN | BY_POSE) for given, place in places.items()}

    def reshaped(self, shape: tuple[int, ...]) -> CallNumbers:
        """Return the same numbers in a shape with which theirs broadcasts."""
        if shape == self.shape:
            return self
        fitted = fit(shape)

        def formed(array: Number) -> Number:
            own = self.shape[:-1] if array.shape[0] > 1 else (1,) * len(self.shape[:-1])
            return np.atleast_2d(fitted(array.reshape(*own, array.shape[1])))

        return replace(self, given={given: formed(array) for given, array in self.given.items()}, shape=shape)

    def arrays(self, flat: FlatProgram) -> list[Any]:
        """Return the arrays that a program reads."""
        return [self.given[flat.graph.nodes[k].given] for k in flat.given]  # type: ignore[index]


def _stratum(array: Number) -> int:
    return (BY_DESIGN if array.shape[0] > 1 else 0) | (BY_POSE if array.shape[1] > 1 else 0)


def call_numbers(
    order: SolvingOrder, call: Call, dimensions: Mapping[FreeDimension, Number], highest: int
) -> CallNumbers:
    """Return the numbers of a call with these values of dimensions; raises InvalidInput for what does not fit."""
    moving = {one.owner for one in dimensions if one.is_of_law}
    drives = drives_of_call(order.structure.mechanism.drives, dimensions) if moving else None
    driven = call.inputs(order, highest, drives)
    shape = driven.shape
    for one, value in dimensions.items():
        shape = broadcast_shape(shape, np.shape(value), f"dimensions.{one.name}")
    # a rate that a free number of a law changes is not always zero
    steady = {name: vs for name, vs in driven.drives.items() if name not in moving}
    still = frozenset((name, k) for name, vs in steady.items() for k, v in enumerate(vs) if k and np.all(v == 0))
    fitted = fit(shape)
    given: dict[InputNumber, Number] = {}
    for one, place in dimensions.items():
        given.update((each, np.array(part, float)) for each, part in one.parts_of(np.atleast_2d(fitted(place))))
    for name, numbers in driven.drives.items():
        for k, value in enumerate(numbers):
            if np.ndim(value) > 1 and value.shape[0] > 1:  # (designs, 1 or poses), in the shape of the call
                value = value.reshape(*driven.shape[:-1], value.shape[1])
            given[InputNumber(DRIVE, name, str(k))] = np.atleast_2d(np.array(fitted(value), float))
    return CallNumbers(given, shape, still)


def parameter_inputs(name: str, is_complex: bool) -> tuple[InputNumber, ...]:
    """Return the real inputs of a parameter."""
    return tuple(InputNumber(PARAMETER, name, part) for part in (("x", "y") if is_complex else ("",)))


def with_parameters(numbers: CallNumbers, given: Mapping[str, Any]) -> CallNumbers:
    """Return the numbers of a call with those given by name.

    Raises InvalidInput for what is no number, not finite, or does not broadcast.
    """
    arrays = {name: _parameter_array(name, value) for name, value in sorted(given.items())}
    shape = numbers.shape
    for name, array in arrays.items():
        try:
            shape = np.broadcast_shapes(shape, array.shape)
        except ValueError:
            what = f"shape {array.shape} does not broadcast with {shape}"
            raise InvalidInput(Problem(name, what, "the last axis is the motion")) from None
    found = numbers.reshaped(shape)
    more = dict(found.given)
    for name, array in arrays.items():
        whole = np.atleast_2d(fit(shape)(array))
        for part, number in zip(parameter_inputs(name, np.iscomplexobj(array)), (whole.real, whole.imag), strict=False):
            more[part] = np.asarray(number, float)
    return replace(found, given=more)


def _parameter_array(name: str, value: Any) -> Number:
    planar = planar_numbers(name, value)
    array = planar if np.iscomplexobj(value) else real_numbers(name, value)
    if array.size == 0 or not np.isfinite(array).all():
        raise InvalidInput(Problem(name, "the value is empty or not finite"))
    return array


def broadcast_shape(shape: tuple[int, ...], other: tuple[int, ...], where: str) -> tuple[int, ...]:
    """Return the shape to which two broadcast; raises InvalidInput, naming `where`."""
    try:
        return np.broadcast_shapes(shape, other)
    except ValueError:
        remedy = "give a new axis to designs: the last axis is the motion"
        raise InvalidInput(Problem(where, f"shape {other} does not broadcast with {shape}", remedy)) from None


def numbers_of_designs(numbers: CallNumbers, designs: Number) -> CallNumbers:
    """Return the numbers of some designs, by index."""
    given = {one: value.take(designs, axis=0) if len(value) > 1 else value for one, value in numbers.given.items()}
    return replace(numbers, given=given, shape=(len(designs), numbers.extent[1]))


def check_threads(threads: Any) -> None:
    """Raise InvalidInput unless `threads` is a whole number above zero."""
    if isinstance(threads, bool) or not isinstance(threads, int | np.integer) or threads < 1:
        raise InvalidInput(Problem("threads", f"{short_repr(threads)} is not a number of threads", "write 1, 2, ..."))


def output_arrays(out: Any, outputs: Mapping[str, bool], shape: tuple[int, ...]) -> dict[str, Number]:
    """Return the caller's arrays for results as (designs, poses); raises InvalidInput for those that cannot hold them.

    `outputs` tells which outputs are vectors.
    """
    if out is None:
        return {}
    if not isinstance(out, Mapping):
        raise InvalidInput(Problem("out", f"{short_repr(out)} is no table by name", 'write {"G.position": array}'))
    if _are_plain(out, outputs, shape):
        return {
            name: array.reshape(prod(shape[:-1]), -1) if len(shape) > 1 else array[None] for name, array in out.items()
        }
    problems = [_array_problem(name, array, outputs, shape) for name, array in out.items()
                if not _can_hold(array, outputs.get(name), shape)]  # fmt: skip
    # arrays with memory of their own do not overlap
    if not problems and not (all(array.base is None for array in out.values()) and _are_different(out.values())):
        problems = [
            Problem(f"out.{other}", f"it is in the memory of out.{name}", "give an array to each output")
            for (name, array), (other, known) in combinations(out.items(), 2)
            if np.may_share_memory(array, known)
        ]
    if problems:
        raise InvalidInput(problems)
    if len(shape) == 2:
        return dict(out)
    return {name: array.reshape(prod(shape[:-1]), *(shape[-1:] or (1,))) for name, array in out.items()}


def _are_plain(out: Mapping[str, Any], outputs: Mapping[str, bool], shape: tuple[int, ...]) -> bool:
    """Tell whether arrays are such as most callers give: right ones, each with memory of its own, and not a number."""
    places = set()
    for name, array in out.items():
        is_vector = outputs.get(name)
        if is_vector is None or type(array) is not np.ndarray or array.shape != shape or not shape:
            return False
        if array.dtype is not (COMPLEX if is_vector else FLOAT) or array.base is not None:
            return False
        if array.flags.num & PLAIN_FLAGS != PLAIN_FLAGS:
            return False
        places.add(id(array))
    return len(places) == len(out)


# Contiguous and aligned, as NumPy's interface numbers them, and writeable.
READABLE_FLAGS = 0x1 | 0x100
PLAIN_FLAGS = READABLE_FLAGS | 0x400


def _can_hold(array: Any, is_vector: bool | None, shape: tuple[int, ...]) -> bool:
    """Tell whether an array holds the results of an output; None is no output."""
    return (
        is_vector is not None
        and isinstance(array, np.ndarray)
        and array.dtype == (COMPLEX if is_vector else FLOAT)
        and array.shape == shape
        and array.flags.c_contiguous
        and array.flags.writeable
    )


def _are_different(arrays: Collection[Number]) -> bool:
    return len({id(array) for array in arrays}) == len(arrays)


def _array_problem(name: Any, array: Any, outputs: Mapping[str, bool], shape: tuple[int, ...]) -> Problem:
    """Return why an array cannot hold an output."""
    where = f"out.{name}"
    if name not in outputs:
        return Problem(where, "there is no such output", suggestion(name, list(outputs)))
    kind = COMPLEX if outputs[name] else FLOAT
    remedy = f"give numpy.empty({shape}, {kind})"
    if not isinstance(array, np.ndarray) or array.dtype != kind:
        what = f"an array of {array.dtype}" if isinstance(array, np.ndarray) else short_repr(array)
        return Problem(where, f"{what} is not an array of {kind}", remedy)
    if array.shape != shape:
        return Problem(where, f"its shape is {array.shape}, that of the call {shape}", remedy)
    return Problem(where, "it cannot be written, or is not contiguous", remedy)


Name = TypeVar("Name")


@dataclass(frozen=True, eq=False, repr=False)
class ReadyProgram(ShortRepr, Generic[Name]):
    """A flat program with its runner, and the nodes of its results by name: one, or two of a planar vector."""

    flat: FlatProgram
    runner: Runner
    nodes: Mapping[Name, tuple[int, ...]]
    _layouts: dict[Any, ResultLayout] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        graph: OperationGraph,
        nodes: Mapping[Name, tuple[int, ...]],
        numbers: CallNumbers,
        backend: str | None,
        carried: Sequence[Carried] = (),
    ) -> ReadyProgram[Name]:
        """Make the program that computes some nodes of numbers of this form."""
        wanted = [k for parts in nodes.values() for k in parts]
        flat = flat_program(graph, wanted, numbers.strata(graph), carried)
        return cls(flat, runner_of(flat, backend), nodes)

    def run(
        self, numbers: CallNumbers, threads: int = 1, given: Mapping[Name, Number] | None = None
    ) -> dict[Name, Number]:
        """Compute all results, (1 or designs, 1 or poses) each; arrays `given`, designs x poses, are written."""
        found = self.computed(numbers.arrays(self.flat), numbers.extent, threads, given)
        return dict(zip(self.nodes, found, strict=True))

    def computed(
        self,
        inputs: Sequence[Any],
        extent: tuple[int, int],
        threads: int = 1,
        given: Mapping[Name, Number] | None = None,
    ) -> list[Number]:
        """Compute all results from the arrays that the program reads; they are in the order of `nodes`."""
        key = (extent, *given) if given else extent
        layout = self._layouts.get(key)
        if layout is None:
            if len(self._layouts) >= LAYOUTS_KEPT:
                self._layouts.clear()
            layout = self._layouts[key] = ResultLayout.of(self, extent, given or ())
        arrays = layout.made.arrays()
        if given:
            made = iter(arrays)
            arrays = [given[name] if name in given else next(made) for name in self.nodes]
        rows: list[Number] = []
        narrow: list[tuple[Number, Number]] = []
        for array, parts in zip(arrays, layout.parts, strict=True):
            if parts is None:
                rows.append(array)
            elif parts is WHOLE:
                rows.append(array.real)
                rows.append(array.imag)
            else:
                for part, shape in zip((array.real, array.imag), parts, strict=False):
                    rows.append(part if shape == array.shape else np.empty(shape))
                    if shape != array.shape:
                        narrow.append((part, rows[-1]))
        self.runner(inputs, rows, extent, threads)
        for part, row in narrow:
            part[...] = row
        return arrays


# The layouts of so many calls are kept.
LAYOUTS_KEPT = 4
# Both parts of a vector vary as it does.
WHOLE: list[tuple[int, int]] = []


class ResultLayout(NamedTuple):
    """The arrays of a program's results for designs x poses.

    `made` are those that no caller gives. `parts` are, for each, the shapes of what is computed
    where an array holds more; else WHOLE of a vector, None of a number.
    """

    made: BufferLayout
    parts: list[list[tuple[int, int]] | None]

    @classmethod
    def of(cls, program: ReadyProgram[Any], extent: tuple[int, int], given: Collection[Any]) -> ResultLayout:
        """Return the arrays of a program's results; those that are given by name are designs x poses."""
        made, parts = [], []
        for name, nodes in program.nodes.items():
            shapes = [program.flat.shape(k, *extent) for k in nodes]
            whole = extent if name in given else np.broadcast_shapes(*shapes)
            narrow = any(shape != whole for shape in shapes)
            parts.append(shapes if narrow else WHOLE if len(nodes) > 1 else None)
            if name not in given:
                made.append((whole, COMPLEX if len(nodes) > 1 else FLOAT))
        return cls(BufferLayout.of_results(made), parts)
