"""Rows that stay in cache, with the instructions of a phase bound to them: what the tape repeats for every block."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from compoundkin.programs.backends.tape.block_layout import PoseBlock
from compoundkin.programs.backends.tape.row_moves import RowLoad, RowReduction, RowStore
from compoundkin.programs.backends.tape.tape_instructions import (
    BEGIN,
    KERNELS,
    LOAD,
    NUMBER,
    SELECT,
    STORE,
    Instruction,
    Operand,
)
from compoundkin.programs.backends.tape.tape_phases import Stage, TapePhase
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE
from compoundkin.programs.graph.operations import REDUCTIONS

# Rows begin on lines of the cache; one line more lies between them, so that equal places of all rows do not compete.
LINE = 64
RowMove = RowLoad | RowStore | RowReduction
Call = Callable[[], Any]
# NumPy deprecates a third operand by place for these.
BY_NAME = {"max", "min"}


class RowBuffers:
    """The rows of a phase for blocks of one shape. Calls bound to them fill them."""

    def __init__(self, phase: TapePhase, designs: int, poses: int) -> None:
        self._shape = designs, poses
        self._rows: dict[int, Any] = {}
        self._numbers: dict[int, Any] = {}
        self._tables: dict[int, Any] = {}
        self._moves: list[list[RowMove]] = [[] for _ in phase.stages]
        for stratum, stage in enumerate(phase.stages):
            self._hold(stratum, stage)
        self._calls = [
            [call for step in stage.steps for call in self._bound(step, self._moves[stratum])]
            for stratum, stage in enumerate(phase.stages)
        ]
        self._start, self._go_on = self._carry(phase)

    def _hold(self, stratum: int, stage: Stage) -> None:
        """Make the rows of a stage: numbers, rows over designs or over poses, or blocks of both."""
        wide = self._shape[0] if stratum & BY_DESIGN else 1
        long = self._shape[1] if stratum & BY_POSE else 1
        counts = stage.allocation.counts
        buffers = {kind: _aligned(counts[kind], wide * long, bool if kind else float) for kind in counts}
        # plain rows take the short way through NumPy; only blocks of both have two axes
        flat = (wide * long,) if wide * long == 1 or min(self._shape) == 1 else (wide, long)
        for value, (kind, number) in stage.allocation.rows.items():
            self._tables[value] = buffers[kind][number].reshape(wide, long)
            self._rows[value] = buffers[kind][number].reshape(flat)
            if wide * long == 1:
                self._numbers[value] = buffers[kind][number].reshape(())

    def _bound(self, step: Instruction, moves: list[RowMove]) -> Sequence[Call]:
        """Return the calls of one instruction."""
        if step.operation == BEGIN:
            return []
        if step.operation in (LOAD, STORE, *REDUCTIONS):
            moves.append(self._moved(step))
            return moves[-1:]
        assert step.result is not None
        out, operands = self._rows[step.result], [self._operand(each) for each in step.operands]
        if step.operation == SELECT:
            is_there = np.shares_memory(operands[2], out)
            begun = [] if is_there else [partial(np.copyto, out, operands[2])]
            return [*begun, partial(np.copyto, out, operands[1], where=operands[0])]
        if step.operation == NUMBER:
            return [partial(np.copyto, out, *operands)]
        if step.operation in BY_NAME:
            return [partial(KERNELS[step.operation], *operands, out=out)]
        return [partial(KERNELS[step.operation], *operands, out)]

    def _moved(self, step: Instruction) -> RowMove:
        if step.result is not None:
            return RowLoad(self._tables[step.result], step.place)
        table = self._tables[step.used()[0]]
        if step.operation == STORE:
            return RowStore(table, step.place)
        return RowReduction(table, step.place, step.operation)

    def _operand(self, value: Operand) -> Any:
        return self._rows[value] if isinstance(value, int) else np.array(value)

    def _carry(self, phase: TapePhase) -> tuple[list[Call], list[Call]]:
        """Return what fills the carried rows at a first pose, and at any other; all are read before one is written."""
        rows = [self._rows[one.given] for one in phase.carries]
        spare = [np.empty_like(row) for row in rows]
        start: list[Call] = [
            partial(np.copyto, row, self._operand(c.start)) for row, c in zip(rows, phase.carries, strict=True)
        ]
        read = [partial(np.copyto, row, self._operand(c.next)) for row, c in zip(spare, phase.carries, strict=True)]
        return start, [*read, *(partial(np.copyto, row, kept) for row, kept in zip(rows, spare, strict=True))]

    def run(self, blocks: Sequence[PoseBlock], sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Compute some blocks, one after another. What one shares with that before it is kept."""
        there: list[PoseBlock | None] = [None] * len(self._calls)
        for block in blocks:
            for stratum, calls in enumerate(self._calls):
                part = block.part(stratum)
                if part != there[stratum]:
                    there[stratum] = part
                    for move in self._moves[stratum]:
                        move.aim(part, sources, targets)
                    if stratum == BY_BOTH:
                        self._take_over(part)
                    for call in calls:
                        call()

    def _take_over(self, block: PoseBlock) -> None:
        for call in self._go_on if block.pose else self._start:
            call()


def _aligned(count: int, length: int, kind: type) -> list[Any]:
    """Return rows that begin on lines of the cache."""
    size = np.dtype(kind).itemsize
    distance = LINE * (-(-length * size // LINE) + 1)
    memory = np.zeros(count * distance + LINE, np.uint8)
    first = -memory.ctypes.data % LINE
    return [memory[k : k + length * size].view(kind) for k in range(first, first + count * distance, distance)]
