"""The NumPy tape: a flat program computed block by block in rows that stay in cache, where nothing faster is there."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain, groupby
from typing import Any

import numpy as np

from compoundkin.programs.backends.kept_threads import done_by_threads
from compoundkin.programs.backends.tape.block_layout import PoseBlock, number_of_pieces, pose_blocks, useful_threads
from compoundkin.programs.backends.tape.row_buffers import RowBuffers
from compoundkin.programs.backends.tape.tape_instructions import STORE
from compoundkin.programs.backends.tape.tape_phases import Sink, TapePhase, tape_phases
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE, FlatProgram
from compoundkin.programs.graph.operations import CONSTANT, INPUT, REDUCTIONS, TOTAL

# So many shapes of blocks keep their rows from call to call.
SHAPES = 8


class PhaseRunner:
    """A phase with the rows it has used."""

    def __init__(self, phase: TapePhase) -> None:
        self.phase = phase
        self._kept: dict[tuple[int, int], list[RowBuffers]] = {}

    def __call__(self, values: dict[int, Any], outputs: Sequence[Any], shape: tuple[int, int], threads: int) -> None:
        """Write the outputs of the phase, and put what later phases need among the values."""
        phase = self.phase
        designs, poses = shape[0] if phase.axes & BY_DESIGN else 1, shape[1] if phase.axes & BY_POSE else 1
        threads = useful_threads(threads, designs * poses)
        runs = pose_blocks(designs, poses, threads, bool(phase.carries))
        sources = [values[k] for k in phase.sources]
        targets = [_target(sink, outputs, (designs, poses)) for sink in phase.sinks]
        shares = [runs[k * len(runs) // threads : (k + 1) * len(runs) // threads] for k in range(threads)]
        done_by_threads(self._compute, ((share, sources, targets) for share in shares))
        for sink, target in zip(phase.sinks, targets, strict=True):
            if sink.output is None:
                values[sink.node] = _finished(sink, target, shape)

    def _compute(self, runs: Sequence[Sequence[PoseBlock]], sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Compute some blocks, those of one shape in the same rows."""
        with np.errstate(all="ignore"):
            for shape, blocks in groupby(chain.from_iterable(runs), lambda block: block.shape):
                buffers = self._buffers(shape)
                buffers.run(list(blocks), sources, targets)
                self._kept.setdefault(shape, []).append(buffers)

    def _buffers(self, shape: tuple[int, int]) -> RowBuffers:
        """Return rows that no other thread uses."""
        try:
            return self._kept[shape].pop()
        except (KeyError, IndexError):
            if len(self._kept) >= SHAPES:
                self._kept = {}
            return RowBuffers(self.phase, *shape)


def _target(sink: Sink, outputs: Sequence[Any], shape: tuple[int, int]) -> Any:
    """Return the array that a value goes into; sums have a place for each piece of the poses."""
    if sink.output is not None:
        return outputs[sink.output]
    designs, poses = shape[0] if sink.stratum & BY_DESIGN else 1, shape[1] if sink.stratum & BY_POSE else 1
    return np.empty((designs, poses if sink.kind == STORE else number_of_pieces(poses)))


def _finished(sink: Sink, found: Any, shape: tuple[int, int]) -> Any:
    """Return what later phases are given: for each design the reduction of its pieces."""
    if sink.kind == STORE:
        return found
    reduced = found if found.shape[1] == 1 else REDUCTIONS[sink.kind](found, axis=1, keepdims=True)
    if sink.kind == TOTAL and not sink.stratum & BY_POSE:
        reduced = reduced * shape[1]
    return reduced if len(reduced) == shape[0] else np.broadcast_to(reduced, (shape[0], 1))


class TapeRunner:
    """A flat program on NumPy arrays. It may be called from several threads."""

    def __init__(self, program: FlatProgram) -> None:
        self.program = program
        self._phases: dict[int, list[PhaseRunner]] = {}
        nodes = program.graph.nodes
        # reductions of numbers that are known
        self._known = [k for k in program.loop if nodes[nodes[k].operands[0]].operation == CONSTANT]
        carried = {one.given for one in program.carried}
        self._copied = [
            (place, k)
            for place, k in enumerate(program.outputs)
            if nodes[k].operation in (CONSTANT, INPUT, *REDUCTIONS) and k not in carried
        ]

    def __call__(self, inputs: Sequence[Any], outputs: Sequence[Any], shape: tuple[int, int], threads: int = 1) -> None:
        """Compute the outputs."""
        program, nodes = self.program, self.program.graph.nodes
        values: dict[int, Any] = dict(zip(program.inputs, inputs, strict=True))
        for k in self._known:
            times = shape[1] if nodes[k].operation == TOTAL else 1
            values[k] = np.full((shape[0], 1), times * nodes[nodes[k].operands[0]].value)
        axes = BY_BOTH if program.carried else BY_DESIGN * (shape[0] > 1) | BY_POSE * (shape[1] > 1)
        if axes not in self._phases:
            self._phases[axes] = [PhaseRunner(phase) for phase in tape_phases(program, axes)]
        for phase in self._phases[axes]:
            phase(values, outputs, shape, threads)
        for place, k in self._copied:
            outputs[place][...] = nodes[k].value if nodes[k].operation == CONSTANT else values[k]


class Tape:
    """The back end that needs nothing but NumPy."""

    def runner(self, program: FlatProgram) -> TapeRunner:
        """Make a program ready to run."""
        return TapeRunner(program)
