"""The NumPy tape: a flat program computed block by block in rows that stay in cache.

Designs x poses are cut into blocks; calls bound to the rows of a block load, compute, sum and store. Sums are taken in
pieces that do not depend on blocks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain, groupby
from typing import Any, NamedTuple

import numpy as np

from compoundkin.programs.backends.runner import run_in_threads
from compoundkin.programs.backends.tape_program import (
    BEGIN,
    KERNELS,
    LOAD,
    NUMBER,
    SELECT,
    STORE,
    Instruction,
    Operand,
    Sink,
    Stage,
    TapePhase,
    tape_phases,
)
from compoundkin.programs.graph.flat_program import BY_BOTH, BY_DESIGN, BY_POSE, FlatProgram
from compoundkin.programs.graph.operation_graph import CONSTANT, INPUT, REDUCTIONS, TOTAL

# So many shapes of blocks keep their rows from call to call.
SHAPES_KEPT = 8


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
        targets = [_target_array(sink, outputs, (designs, poses)) for sink in phase.sinks]
        shares = [runs[k * len(runs) // threads : (k + 1) * len(runs) // threads] for k in range(threads)]
        run_in_threads(self._compute, ((share, sources, targets) for share in shares))
        for sink, target in zip(phase.sinks, targets, strict=True):
            if sink.output is None:
                values[sink.node] = _final_value(sink, target, shape)

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
            if len(self._kept) >= SHAPES_KEPT:
                self._kept = {}
            return RowBuffers(self.phase, *shape)


def _target_array(sink: Sink, outputs: Sequence[Any], shape: tuple[int, int]) -> Any:
    """Return the array that a value goes into; sums have a place for each piece of the poses."""
    if sink.output is not None:
        return outputs[sink.output]
    designs, poses = shape[0] if sink.stratum & BY_DESIGN else 1, shape[1] if sink.stratum & BY_POSE else 1
    return np.empty((designs, poses if sink.kind == STORE else number_of_pieces(poses)))


def _final_value(sink: Sink, found: Any, shape: tuple[int, int]) -> Any:
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
        values: dict[int, Any] = dict(zip(program.given, inputs, strict=True))
        for k, value in program.delayed.items():
            values[k] = np.concatenate([values[value][:, :1], values[value][:, :-1]], axis=1)
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


# Rows begin on lines of the cache; one line more lies between them, so that equal places of all rows do not compete.
LINE = 64


class RowLoad:
    """Fills a row from a part of an array."""

    __slots__ = ("part", "place", "row")

    def __init__(self, row: Any, place: int) -> None:
        self.row, self.place = row, place

    def aim(self, block: PoseBlock, sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Set the part of the array that the next call reads."""
        self.part = sources[self.place][block.window()]

    def __call__(self) -> None:
        """Copy."""
        self.row[...] = self.part


class RowStore:
    """Copies a row into a part of an array."""

    __slots__ = ("part", "place", "row")

    def __init__(self, row: Any, place: int) -> None:
        self.row, self.place = row, place

    def aim(self, block: PoseBlock, sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Set the part of the array that the next call writes."""
        self.part = targets[self.place][block.window()]

    def __call__(self) -> None:
        """Copy."""
        self.part[...] = self.row


class RowReduction:
    """Reduces a row over its poses, piece by piece. A march adds one pose after another."""

    __slots__ = ("adds", "operation", "part", "place", "row", "starts")

    def __init__(self, row: Any, place: int, operation: str) -> None:
        self.row, self.place = row, place
        self.operation: np.ufunc = REDUCTIONS[operation].__self__  # type: ignore[attr-defined]
        self.starts = np.arange(0, row.shape[1], PIECE_LENGTH)
        self.adds = False

    def aim(self, block: PoseBlock, sources: Sequence[Any], targets: Sequence[Any]) -> None:
        """Set the pieces that the next call writes."""
        self.part = targets[self.place][block.pieces()]
        self.adds = block.pose % PIECE_LENGTH != 0

    def __call__(self) -> None:
        """Reduce."""
        if self.adds:
            self.operation(self.part, self.row, out=self.part)
        else:
            self.operation.reduceat(self.row, self.starts, axis=1, out=self.part)


RowMove = RowLoad | RowStore | RowReduction


RowCall = Callable[[], Any]


# NumPy deprecates a third operand by place for these.
OUT_BY_KEYWORD = {"max", "min"}


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
        buffers = {kind: _aligned_rows(counts[kind], wide * long, bool if kind else float) for kind in counts}
        # plain rows take the short way through NumPy; only blocks of both have two axes
        flat = (wide * long,) if wide * long == 1 or min(self._shape) == 1 else (wide, long)
        for value, (kind, number) in stage.allocation.rows.items():
            self._tables[value] = buffers[kind][number].reshape(wide, long)
            self._rows[value] = buffers[kind][number].reshape(flat)
            if wide * long == 1:
                self._numbers[value] = buffers[kind][number].reshape(())

    def _bound(self, step: Instruction, moves: list[RowMove]) -> Sequence[RowCall]:
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
        if step.operation in OUT_BY_KEYWORD:
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

    def _carry(self, phase: TapePhase) -> tuple[list[RowCall], list[RowCall]]:
        """Return what fills the carried rows at a first pose, and at any other; all are read before one is written."""
        rows = [self._rows[one.given] for one in phase.carries]
        spare = [np.empty_like(row) for row in rows]
        start: list[RowCall] = [
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


def _aligned_rows(count: int, length: int, kind: type) -> list[Any]:
    """Return rows that begin on lines of the cache."""
    size = np.dtype(kind).itemsize
    distance = LINE * (-(-length * size // LINE) + 1)
    memory = np.zeros(count * distance + LINE, np.uint8)
    first = -memory.ctypes.data % LINE
    return [memory[k : k + length * size].view(kind) for k in range(first, first + count * distance, distance)]


# Numbers in a row of a block: the calls of NumPy take a tenth of the time, and some thirty rows stay in cache.
BLOCK_SIZE = 12_288


# Poses that are summed as one piece, before the sums of pieces: so results do not depend on blocks.
PIECE_LENGTH = 1024


# Below so many numbers for each thread, threads cost more than they bring.
NUMBERS_PER_THREAD = 32_768


class PoseBlock(NamedTuple):
    """A rectangle of designs and poses. Each range ends before its last number."""

    design: int
    design_end: int
    pose: int
    pose_end: int

    @property
    def shape(self) -> tuple[int, int]:
        """How many designs and poses it has."""
        return self.design_end - self.design, self.pose_end - self.pose

    def part(self, stratum: int) -> PoseBlock:
        """Return the places that values of a stratum have."""
        designs = (self.design, self.design_end) if stratum & BY_DESIGN else (0, 1)
        return PoseBlock(*designs, *((self.pose, self.pose_end) if stratum & BY_POSE else (0, 1)))

    def window(self) -> tuple[slice, slice]:
        """Return the index of its places in an array."""
        return slice(self.design, self.design_end), slice(self.pose, self.pose_end)

    def pieces(self) -> tuple[slice, slice]:
        """Return the index of its pieces in an array of sums."""
        return slice(self.design, self.design_end), slice(self.pose // PIECE_LENGTH, -(-self.pose_end // PIECE_LENGTH))


def number_of_pieces(poses: int) -> int:
    """Return in how many pieces sums over poses are taken."""
    return -(-poses // PIECE_LENGTH)


def useful_threads(threads: int, count: int) -> int:
    """Return how many threads pay for so many numbers in a row."""
    return max(1, min(threads, count // NUMBERS_PER_THREAD))


def pose_blocks(designs: int, poses: int, threads: int, marches: bool) -> list[list[PoseBlock]]:
    """Cut designs x poses into blocks. Those of one list must follow one another.

    Blocks of several designs have all poses; others have one design and some pieces of poses. In a march each block is
    one pose of many designs.

    >>> pose_blocks(40, 3000, 1, False)[1]
    [PoseBlock(design=4, design_end=8, pose=0, pose_end=3000)]
    >>> [(run[0].pose, run[0].pose_end) for run in pose_blocks(1, 20_000, 1, False)]
    [(0, 10240), (10240, 20000)]
    """
    if marches:
        ranges = _cut_range(designs, max(1, min(BLOCK_SIZE, -(-designs // threads))), 1)
        return [[PoseBlock(*part, k, k + 1) for k in range(poses)] for part in ranges]
    if designs == 1 or poses > BLOCK_SIZE:
        ranges = _cut_range(poses, max(1, min(BLOCK_SIZE, -(-poses // threads))), PIECE_LENGTH)
        return [[PoseBlock(k, k + 1, *part)] for k in range(designs) for part in ranges]
    wide = max(1, BLOCK_SIZE // poses)
    return [[PoseBlock(*part, 0, poses)] for part in _cut_range(designs, min(wide, -(-designs // threads)), 1)]


def _cut_range(count: int, most: int, grain: int) -> list[tuple[int, int]]:
    """Cut a range into equal parts of whole grains and about `most` at most."""
    parts = -(-count // most)
    each = grain * -(-count // (parts * grain))
    return [(k, min(k + each, count)) for k in range(0, count, each)]
