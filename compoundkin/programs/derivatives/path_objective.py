"""An objective of a compiled path: a user's function of one pose, recorded, summed over the poses, and its gradient."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial, reduce
from math import prod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from compoundkin.base.arguments import checked
from compoundkin.base.arrays import Number
from compoundkin.base.display import ShortRepr
from compoundkin.base.errors import (
    CompoundkinError,
    InvalidInput,
    Problem,
    UnassembledPoses,
    UnknownName,
    suggestion,
    warn,
)
from compoundkin.programs.call_numbers import (
    Call,
    CallNumbers,
    ReadyProgram,
    check_threads,
    numbers_of_designs,
    parameter_inputs,
    with_parameters,
)
from compoundkin.programs.call_plans import CallPlan, CallPlans
from compoundkin.programs.derivatives.differentiation import reverse
from compoundkin.programs.derivatives.law_slopes import slope_inputs, summed_slopes
from compoundkin.programs.derivatives.solved_inputs import (
    ALL_POSES,
    ASSEMBLED_POSES,
    SOLVED_POSES,
    known_poses,
    solved_inputs,
)
from compoundkin.programs.graph.operation_graph import TOTAL, InputNumber, OperationGraph
from compoundkin.programs.limit_screening import negated_step
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_number import RecordedNumber, one_pose, selected

if TYPE_CHECKING:
    from compoundkin.programs.path_programs import PathPrograms


@dataclass(frozen=True, eq=False, repr=False)
class PathObjective(ShortRepr):
    """A function of the poses of a compiled path, summed over them.

    It is called like the path, and with what the function reads besides outputs (`target=...`): numbers or arrays, real
    or complex, that broadcast with the others. The sum is NaN where some pose is not assembled, unless the function
    leaves such poses out: `np.where(at.assembled, ..., 0.0)`.
    """

    path: PathPrograms
    function: Callable[[ObjectivePose], Any]
    _programs: dict[Any, ReadyProgram[str]] = field(default_factory=dict)

    @cached_property
    def _plans(self) -> CallPlans:
        return CallPlans(self.path, are_kept=False)

    def __call__(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        time: Any = None,
        threads: int = 1,
        **given: Any,
    ) -> Any:
        """Return the sum over the poses of each design.

        Its shape is that of the call without the last axis. Raises UnknownName for what is given and not read, or read
        and not given; InvalidInput for what cannot be recorded or does not broadcast.

        >>> import compoundkin as ck
        >>> crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
        >>> cost = ck.compile(crank, "B", free="crank.B").objective(lambda at: abs(at["B"] - at["target"]) ** 2)
        >>> float(cost([0.0, 0.0], {"crank.B": 3.0}, target=1.0))
        8.0
        """
        call = Call(values, dimensions, speed, acceleration, jerk, time)
        return self.computed(call, given, False, threads).value

    def gradient(
        self,
        values: Any = None,
        dimensions: Mapping[str, Any] | None = None,
        *,
        speed: Any = None,
        acceleration: Any = None,
        jerk: Any = None,
        time: Any = None,
        threads: int = 1,
        **given: Any,
    ) -> tuple[Any, dict[str, Any]]:
        """Return the sum and its slopes by all free dimensions.

        The slope by a point is complex: by x, and i times that by y. The slope by a dimension that varies along the
        motion does so too, others have the shape of the sum. Raises what a call does. Source: reverse accumulation; A.
        Griewank, A. Walther, Evaluating Derivatives, 2nd ed., SIAM 2008.

        >>> import compoundkin as ck
        >>> crank = ck.Mechanism("m", ck.link("frame", A=0), ck.link("crank", A=0, B=2), ck.drive("crank"))
        >>> cost = ck.compile(crank, "B", free="crank.B").objective(lambda at: abs(at["B"] - at["target"]) ** 2)
        >>> value, slope = cost.gradient([0.0, 0.0], target=1.0)
        >>> float(value), complex(slope["crank.B"])
        (2.0, (4+0j))
        """
        call = Call(values, dimensions, speed, acceleration, jerk, time)
        return self.computed(call, given, True, threads)[:2]

    def computed(self, call: Call, given: Mapping[str, Any], is_sloped: bool = False, threads: int = 1) -> ComputedSum:
        """Return sum and slopes of a call with what the function reads; raises what a call does."""
        return self._planned(call, given, is_sloped, threads) or self._in_full(*call, is_sloped, threads, **given)

    def _planned(self, call: Call, given: Mapping[str, Any], is_sloped: bool, threads: Any) -> ComputedSum | None:
        """Return sum and slopes of a call that is read by its plan; None of others."""
        read = self._plans.read((*call, given))
        if read is None or type(threads) is not int or threads < 1:
            return None
        moving = read.plan.moving
        program = read.plan.program(is_sloped, read, _MARGIN, partial(self._program_of_inputs, given, is_sloped))
        if program is None:
            return None
        arrays = program.run(read, threads)
        count = len(arrays) - len(moving)
        found = ObjectiveValues.of(program.program, arrays[:count])
        steps = dict(zip(moving, arrays[count:], strict=True))
        if self.path.limits.is_clear(read.driver_values, found.least, read.numbers, steps):
            return ComputedSum(*found.shaped(read.plan.shape), True)
        return self._screened(read.numbers(), given, is_sloped, threads, found) if read.is_finite() else None

    @checked
    def _in_full(
        self,
        values: Any,
        dimensions: Mapping[str, Any] | None,
        speed: Any,
        acceleration: Any,
        jerk: Any,
        time: Any,
        is_sloped: Any,
        threads: int,
        /,
        **given: Any,
    ) -> ComputedSum:
        """Return sum and slopes; raises InvalidInput for what does not fit."""
        call = Call(values, dimensions, speed, acceleration, jerk, time)
        numbers = self.path.numbers(call, with_slopes=is_sloped)
        check_threads(threads)
        whole = with_parameters(numbers, given)
        self._plans.keep((*call, given), whole)
        first = self._run(given, is_sloped, threads, whole, ALL_POSES)
        return self._screened(whole, given, is_sloped, threads, first)

    def _screened(
        self, whole: CallNumbers, given: Mapping[str, Any], is_sloped: bool, threads: int, first: ObjectiveValues
    ) -> ComputedSum:
        """Return sum and slopes of what was computed first; designs near a limit are computed again with masks."""
        run, path = partial(self._run, given, is_sloped, threads), self.path
        screened = path.limits.screen(whole, first.least)
        if screened is None:
            return ComputedSum(*first.shaped(whole.shape), True)
        designs = whole.extent[0]
        parts = [(np.arange(designs), first)]
        if len(screened.unassembled):
            masked = run(numbers_of_designs(whole, screened.unassembled), ASSEMBLED_POSES)
            parts.append((screened.unassembled, masked))
        parts += [(part, run(own, SOLVED_POSES)) for part, own in solved_inputs(path, whole, screened.to_solve)]
        joined = ObjectiveValues.joined(designs, parts)
        missing = int(np.count_nonzero(np.isnan(joined.value)))
        if missing:
            of_all = f"{missing} of {designs} designs have poses that cannot be assembled"
            warn(f"{of_all}: numpy.where(at.assembled, ..., 0.0) leaves them out", UnassembledPoses)
        return ComputedSum(*joined.shaped(whole.shape), False)

    def _program_of_inputs(
        self, given: Mapping[str, Any], is_sloped: bool, plan: CallPlan, numbers: CallNumbers
    ) -> ReadyProgram[str] | None:
        """Return the program of numbers without seeds; None where it needs some."""
        if self.path.variant(numbers.still).seeds:
            return None
        return self._program(given, is_sloped, numbers, ALL_POSES, plan.moving)

    def _program(
        self,
        given: Mapping[str, Any],
        is_sloped: bool,
        numbers: CallNumbers,
        known: str,
        moving: tuple[str, ...] = (),
    ) -> ReadyProgram[str]:
        # which parameters are complex decides on their inputs
        kinds = {name: np.iscomplexobj(value) for name, value in sorted(given.items())}
        key = numbers.form, tuple(kinds.items()), is_sloped, known, moving
        if key not in self._programs:
            path = self.path
            by = slope_inputs(path.dimensions, path.order) if is_sloped else {}
            form = ObjectiveForm(self.function, kinds, by, known, moving)
            variant = path.variant(numbers.still, known == SOLVED_POSES)
            self._programs[key] = objective_program(variant, path.names, numbers, form, path.chosen_backend)
        return self._programs[key]

    def _run(
        self, given: Mapping[str, Any], is_sloped: bool, threads: int, numbers: CallNumbers, known: str
    ) -> ObjectiveValues:
        program = self._program(given, is_sloped, numbers, known)
        values = ObjectiveValues.of(program, program.run(numbers, threads).values())
        if not (is_sloped and self.path.law_numbers):
            return values
        return replace(values, slopes=summed_slopes(self.path.dimensions, numbers, values.slopes, self.path.order))

    def __reduce__(self) -> tuple[Any, ...]:
        return PathObjective, (self.path, self.function)

    def __repr__(self) -> str:
        of = f"{', '.join(self.path.names)} by {', '.join(self.path.free) or 'nothing'}"
        return f"PathObjective({self.path.reference.mechanism.title!r}: {of})"


class ComputedSum(NamedTuple):
    """The sum of each design, its slopes by free dimensions, and whether surely no design comes near a limit."""

    value: Any
    slopes: dict[str, Any]
    is_clear: bool


# Besides the names of dimensions: the sum and the least margin.
_SUM, _MARGIN = "", " "


@dataclass(frozen=True)
class ObjectiveForm:
    """A function to record, and the form of its program.

    `given` tells of each parameter of a call whether it is complex; slopes are `by` one input, or two of a point;
    `known` is one of ALL_POSES, ASSEMBLED_POSES, SOLVED_POSES; of the drivers `moving` the longest steps are found.
    """

    function: Callable[[ObjectivePose], Any]
    given: Mapping[str, bool]
    by: Mapping[str, tuple[InputNumber, ...]]
    known: str
    moving: tuple[str, ...]


@dataclass(frozen=True, repr=False)
class ObjectiveValues(ShortRepr):
    """The sum, the least margin and the slopes of each design.

    All are arrays (1 or designs, 1 or poses).
    """

    value: Number
    least: Number
    slopes: Mapping[str, Number]

    @classmethod
    def of(cls, program: ReadyProgram[str], found: Iterable[Number]) -> ObjectiveValues:
        """Return the results of a program: sum and margin come first, the longest steps, which are left out, last."""
        (_, value), (_, least), *slopes = zip(program.nodes, found, strict=False)
        return cls(value, least, dict(slopes))

    @classmethod
    def joined(cls, count: int, parts: Sequence[tuple[Number, ObjectiveValues]]) -> ObjectiveValues:
        """Join the values of some designs, by index; later ones replace earlier ones."""

        def put(arrays: Sequence[Number]) -> Number:
            whole = np.empty((count, arrays[0].shape[1]), arrays[0].dtype)
            for (designs, _), array in zip(parts, arrays, strict=True):
                whole[designs] = array
            return whole

        values = [part for _, part in parts]
        slopes = {name: put([each.slopes[name] for each in values]) for name in values[0].slopes}
        value = put([each.value for each in values])
        for slope in slopes.values():
            # an invalid sum has no gradient
            slope[np.isnan(value[:, 0])] = complex(np.nan, np.nan) if np.iscomplexobj(slope) else np.nan
        return cls(value, put([each.least for each in values]), slopes)

    def shaped(self, shape: tuple[int, ...]) -> tuple[Any, dict[str, Any]]:
        """Return sum and slopes in the shape of the call; slopes along the motion keep the last axis."""

        designs = shape[:-1]

        def formed(array: Number) -> Any:
            if not designs and array.size == 1:
                return array.reshape(())
            over = shape if array.shape[1] > 1 else designs
            whole = array if array.size == prod(over) else np.broadcast_to(array, (prod(designs), array.shape[1]))
            return whole.reshape(over)

        return formed(self.value), {name: formed(slope) for name, slope in self.slopes.items()}


def objective_program(
    path: RecordedPath, names: Sequence[str], numbers: CallNumbers, form: ObjectiveForm, backend: str | None
) -> ReadyProgram[str]:
    """Make the program of an objective for numbers of some form."""
    graph = path.mechanism.graph
    assembled, known = known_poses(path, names, form.known)
    outputs = {}
    for name, output in zip(names, path.outputs, strict=True):
        outputs[name] = selected(known[name], output, complex(np.nan, np.nan) if output.y is not None else np.nan)
    cost = record_objective(form.function, graph, outputs, form.given, assembled)
    root = graph.apply(TOTAL, cost)
    needed = set(graph.needed([cost]))
    counted = reduce(RecordedNumber.__and__, (truth for truth in known.values() if truth.x in needed), assembled)
    by = {name: tuple(map(graph.input, parts)) for name, parts in form.by.items()}
    every = [k for nodes in by.values() for k in nodes]
    adjoints = dict(zip(every, reverse(graph, root, every, numbers.strata(graph), counted.x), strict=True))
    slopes = {name: tuple(adjoints[k] for k in nodes) for name, nodes in by.items()}
    steps = {f"{_MARGIN}{name}": (negated_step(graph, name),) for name in form.moving}
    nodes = {_SUM: (root,), _MARGIN: (path.least,), **slopes, **steps}
    return ReadyProgram.of(graph, nodes, numbers, backend, path.carried(numbers))


# An objective reads this name besides outputs and parameters.
ASSEMBLED = "assembled"


class ObjectivePose:
    """One pose of a path, as an objective reads it.

    `at["G.position"]` is an output of the path, `at["target"]` a parameter that each call gives; `at.assembled`, or
    `at["assembled"]`, tells whether the pose is assembled.
    """

    def __init__(self, known: Mapping[str, RecordedNumber], assembled: RecordedNumber) -> None:
        self._known = {**known, ASSEMBLED: assembled}
        self.read: set[str] = set()

    def __getitem__(self, name: str) -> RecordedNumber:
        """Return an output of the path, or a parameter of the call."""
        if name not in self._known:
            what = "it is neither an output of the path nor a parameter of the call"
            raise UnknownName(Problem(str(name), what, suggestion(name, list(self._known))))
        self.read.add(name)
        return self._known[name]

    @property
    def assembled(self) -> RecordedNumber:
        """Whether the pose is assembled."""
        return self[ASSEMBLED]

    def __repr__(self) -> str:
        return f"ObjectivePose({', '.join(self._known)})"


def record_objective(
    function: Callable[[ObjectivePose], Any],
    graph: OperationGraph,
    outputs: Mapping[str, RecordedNumber],
    given: Mapping[str, bool],
    assembled: RecordedNumber,
) -> int:
    """Return the node of an objective's value at one pose.

    `given` tells of each parameter of the call whether it is complex. Raises InvalidInput for what cannot be recorded,
    UnknownName for parameters that are not read or not given.
    """
    taken = [name for name in given if name in outputs or name == ASSEMBLED]
    if taken:
        raise InvalidInput([Problem(name, "the pose has this name itself", "choose another name") for name in taken])
    parameters = {name: RecordedNumber.given(graph, *parameter_inputs(name, kind)) for name, kind in given.items()}
    pose = ObjectivePose({**outputs, **parameters}, assembled)
    try:
        with one_pose():
            cost = assembled.like(function(pose))
    except CompoundkinError:
        raise
    except (TypeError, AttributeError, ValueError, OverflowError) as error:
        what = f"it cannot be recorded: {error}"
        remedy = "write it of one pose, in arithmetic and NumPy's functions of numbers; np.where instead of if"
        raise InvalidInput(Problem("objective", what, remedy)) from error
    unread = [name for name in given if name not in pose.read]
    if unread:
        what, read = "the objective does not read it", [name for name in pose.read if name not in outputs]
        raise UnknownName([Problem(name, what, suggestion(name, read)) for name in unread])
    if cost.y is not None:
        raise InvalidInput(Problem("objective", "its value is complex", "take abs(...) ** 2, or a .real part"))
    if graph.is_truth(cost.x):
        return graph.apply("select", cost.x, graph.constant(1.0), graph.constant(0.0))
    return cost.x
