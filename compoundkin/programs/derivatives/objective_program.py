"""The program of an objective: its sum over the poses, the least margin, and the slopes where they are asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from math import prod
from typing import Any

import numpy as np

from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.derivatives.adjoints import reverse
from compoundkin.programs.derivatives.recorded_objective import ObjectivePose, recorded_cost
from compoundkin.programs.derivatives.told_designs import known_poses
from compoundkin.programs.graph.operation_graph import InputNumber, OperationGraph
from compoundkin.programs.graph.operations import TOTAL
from compoundkin.programs.ready_program import ReadyProgram
from compoundkin.programs.recorded_path import RecordedPath
from compoundkin.programs.recording.recorded_functions import chosen
from compoundkin.programs.recording.recorded_number import RecordedNumber

# Besides the names of dimensions: the sum and the least margin.
_TOTAL, _LEAST = "", " "


@dataclass(frozen=True)
class ObjectiveForm:
    """What is asked of an objective.

    `given` tells of each name given with the call whether it is complex, `by` what slopes are by, one input or two of a
    point, and `known` how it is known which poses there are.
    """

    function: Callable[[ObjectivePose], Any]
    given: Mapping[str, bool]
    by: Mapping[str, tuple[InputNumber, ...]]
    known: str


@dataclass(frozen=True, repr=False)
class ObjectiveValues(PrintsShort):
    """The sum, the least margin and the slopes of each design.

    All are arrays (1 or designs, 1 or poses).
    """

    value: Number
    least: Number
    slopes: Mapping[str, Number]

    @classmethod
    def of(cls, found: Mapping[str, Number]) -> ObjectiveValues:
        """Return what the program of an objective has found."""
        return cls(found[_TOTAL], found[_LEAST], {k: slope for k, slope in found.items() if k not in (_TOTAL, _LEAST)})

    @classmethod
    def joined(cls, count: int, parts: Sequence[tuple[Number, ObjectiveValues]]) -> ObjectiveValues:
        """Join the values of some designs, by index.

        Later ones take the place of earlier ones.
        """

        def put(arrays: Sequence[Number]) -> Number:
            whole = np.empty((count, arrays[0].shape[1]), arrays[0].dtype)
            for (designs, _), array in zip(parts, arrays, strict=True):
                whole[designs] = array
            return whole

        values = [part for _, part in parts]
        slopes = {name: put([each.slopes[name] for each in values]) for name in values[0].slopes}
        value = put([each.value for each in values])
        for slope in slopes.values():
            # a sum that is none has no slopes
            slope[np.isnan(value[:, 0])] = complex(np.nan, np.nan) if np.iscomplexobj(slope) else np.nan
        return cls(value, put([each.least for each in values]), slopes)

    def shaped(self, shape: tuple[int, ...]) -> tuple[Any, dict[str, Any]]:
        """Return sum and slopes in the form of the call.

        Slopes along the motion keep the last axis.
        """

        def formed(array: Number) -> Any:
            over = shape if array.shape[1] > 1 else shape[:-1]
            whole = array if array.size == prod(over) else np.broadcast_to(array, (prod(shape[:-1]), array.shape[1]))
            return whole.reshape(over)

        return formed(self.value), {name: formed(slope) for name, slope in self.slopes.items()}


def objective_program(
    path: RecordedPath, names: Sequence[str], numbers: CallNumbers, form: ObjectiveForm, backend: str | None
) -> ReadyProgram[str]:
    """Make the program of an objective for numbers of some form."""
    graph = path.mechanism.graph
    assembled, known = known_poses(path, names, form.known)
    outputs = {name: _masked(each, known[name]) for name, each in zip(names, path.outputs, strict=True)}
    cost = recorded_cost(form.function, graph, outputs, form.given, assembled)
    root = graph.apply(TOTAL, cost)
    kept = reduce(RecordedNumber.__and__, _read(graph, cost, known), assembled)
    by = {name: tuple(map(graph.input, parts)) for name, parts in form.by.items()}
    every = [k for nodes in by.values() for k in nodes]
    found = dict(zip(every, reverse(graph, root, every, numbers.strata(graph), kept.x), strict=True))
    slopes = {name: tuple(found[k] for k in nodes) for name, nodes in by.items()}
    nodes = {_TOTAL: (root,), _LEAST: (path.least,), **slopes}
    return ReadyProgram.of(graph, nodes, numbers, backend, path.carried(numbers))


def _masked(output: RecordedNumber, assembled: RecordedNumber) -> RecordedNumber:
    return chosen(assembled, output, complex(np.nan, np.nan) if output.y is not None else np.nan)


def _read(graph: OperationGraph, cost: int, known: Mapping[str, RecordedNumber]) -> list[RecordedNumber]:
    """Return where the outputs are known that a cost hangs on."""
    needed = set(graph.needed([cost]))
    return [truth for truth in known.values() if truth.x in needed]
