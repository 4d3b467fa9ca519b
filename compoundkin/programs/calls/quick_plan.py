"""How a program is run quickly: where its inputs stand among the arguments of a call, and which arrays it writes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.base.buffers import LARGE, arrays_of_one_buffer, keep_freed_memory
from compoundkin.base.display import PrintsShort
from compoundkin.base.series import Number
from compoundkin.programs.calls.call_numbers import CallNumbers
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE
from compoundkin.programs.graph.operation_graph import InputNumber
from compoundkin.programs.ready_program import ReadyProgram

FLOAT, COMPLEX = np.dtype(float), np.dtype(complex)


class QuickPlan(PrintsShort):
    """A program, and how its inputs and results stand.

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
        """Return the plan of a program.

        None where inputs are found outside, or parts of a vector vary by other axes.
        """
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
