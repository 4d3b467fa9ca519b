"""The NumPy tape: a flat program computed operation by operation, where nothing faster is installed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.programs.graph.flat_program import FlatProgram
from compoundkin.programs.graph.operations import CONSTANT, OPERATIONS, REDUCTIONS


class TapeRunner:
    """A flat program on NumPy arrays."""

    def __init__(self, program: FlatProgram) -> None:
        self.program = program

    def __call__(self, inputs: Sequence[Any], outputs: Sequence[Any], shape: tuple[int, int], threads: int = 1) -> None:
        """Compute the outputs."""
        program = self.program
        values: dict[int, Any] = dict(zip(program.inputs, inputs, strict=True))
        with np.errstate(all="ignore"):
            for k in sorted((*program.before, *program.by_pose, *program.loop, *program.after)):
                values[k] = self._computed(k, values, shape)
            for k, out in zip(program.outputs, outputs, strict=True):
                out[...] = self._value(k, values)

    def _value(self, k: int, values: dict[int, Any]) -> Any:
        node = self.program.graph.nodes[k]
        return node.value if node.operation == CONSTANT else values[k]

    def _computed(self, k: int, values: dict[int, Any], shape: tuple[int, int]) -> Any:
        node = self.program.graph.nodes[k]
        operands = [self._value(n, values) for n in node.operands]
        if node.operation in REDUCTIONS:
            whole = np.broadcast_to(operands[0], shape)
            return REDUCTIONS[node.operation](whole, axis=1, keepdims=True)
        return OPERATIONS[node.operation].compute(*operands)


class Tape:
    """The back end that needs nothing but NumPy."""

    name = "numpy"

    def runner(self, program: FlatProgram) -> TapeRunner:
        """Make a program ready to run."""
        return TapeRunner(program)
