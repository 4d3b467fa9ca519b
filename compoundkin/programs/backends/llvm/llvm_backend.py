"""The LLVM back end: a program compiled for this processor, for the arrays it is called with."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any

import numpy as np

from compoundkin.programs.backends.kept_threads import done_by_threads
from compoundkin.programs.backends.llvm.llvm_engine import compiled, target
from compoundkin.programs.backends.llvm.llvm_layout import FIRST, RECORDS_ARE_KNOWN, layout_of, recorded_arrays
from compoundkin.programs.backends.llvm.llvm_plan import ARRAY_KIND, DESIGNS_AT_ONCE, HEADER, NUMBER_KIND, LanePlan
from compoundkin.programs.backends.llvm.llvm_program import ANGLE_TOO_LARGE, FITS_NOT, program_text, segment_length
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, FlatProgram

# Poses that are worth a thread: fewer take less time than to wake one.
FOR_A_THREAD = 8_192
# Poses below which lanes go along designs, where there are more of those.
FEW_POSES = 12


class PlannedCode:
    """The code for one plan, with scratch for each thread."""

    def __init__(self, plan: LanePlan) -> None:
        self.plan = plan
        self.code = compiled(program_text(plan))
        self.run = self.code.run
        self._own = threading.local()

    def scratch(self) -> int:
        """Return where this thread's scratch is."""
        try:
            return self._own.address  # type: ignore[no-any-return]
        except AttributeError:
            words = np.zeros(self.plan.size + HEADER, np.int64)
            address = words.ctypes.data + (-words.ctypes.data) % 64
            first = (address - words.ctypes.data) // 8
            words[first + ARRAY_KIND], words[first + NUMBER_KIND] = id(np.ndarray), id(np.dtype(float))
            self._own.words, self._own.address = words, address
            return address

    def part(self, objects: int, shape: tuple[int, int], *bounds: int, sums: int | None = None, last: int = 1) -> int:
        """Run some designs and segments; answer 0, or why not."""
        return self.run(objects, self.scratch(), *shape, *bounds, sums, last, segment_length(shape[1]))  # type: ignore[no-any-return]


class LlvmRunner:
    """A flat program as compiled code. There is one for each way in which arrays stand."""

    def __init__(self, program: FlatProgram) -> None:
        self.program = program
        self._codes: dict[Any, PlannedCode] = {}
        self._recent: dict[tuple[int, bool], PlannedCode] = {}
        carried = {one.given for one in program.carried}
        self._given = [i for i, k in enumerate(program.inputs) if k not in carried]

    def __call__(self, inputs: Sequence[Any], outputs: Sequence[Any], shape: tuple[int, int], threads: int = 1) -> None:
        """Compute the outputs."""
        if self.program.carried:
            inputs = [inputs[i] for i in self._given]
        designs, poses = shape
        by_designs = designs > 1 and poses < FEW_POSES and poses < designs
        axis = BY_DESIGN if by_designs or self.program.carried else BY_POSE
        way = (axis, designs == 1 and axis == BY_POSE)
        code = self._recent.get(way)
        answer = FITS_NOT
        arrays = (*inputs, *outputs)
        if code is not None and RECORDS_ARE_KNOWN and len(arrays) == code.plan.arrays:
            answer = _done(code, id(arrays) + FIRST, shape, threads)
        if answer:
            self._other_way(answer, way, (inputs, outputs), shape, threads)

    def _other_way(self, answer: int, way: tuple[int, bool], arrays: Any, shape: tuple[int, int], threads: int) -> None:
        """Run the code that suits the arrays, or the angles."""
        program = self.program
        inputs, outputs = arrays
        arrays, objects, _kept = recorded_arrays(program, self._given, inputs, outputs, shape)
        layout = layout_of(program, self._given, arrays, way[0])
        if answer == FITS_NOT:
            code = self._recent[way] = self._code(way, layout, False)
            answer = _done(code, objects, shape, threads)
        if answer == ANGLE_TOO_LARGE:
            answer = _done(self._code(way, layout, True), objects, shape, threads)
        assert not answer

    def _code(self, way: tuple[int, bool], layout: Any, wide: bool) -> PlannedCode:
        key = (way, layout, wide)
        if key not in self._codes:
            self._codes[key] = PlannedCode(LanePlan(self.program, way[0], layout, target()[0], wide, way[1]))
        return self._codes[key]


def _done(code: PlannedCode, objects: int, shape: tuple[int, int], threads: int) -> int:
    """Run all designs and poses, in so many threads."""
    designs, poses = shape
    threads = min(threads, designs * poses // FOR_A_THREAD + 1)
    length = segment_length(poses)
    segments = max(-(-poses // length), 1)
    if threads == 1:
        return code.part(objects, shape, 0, designs, 0, segments)
    if code.plan.axis == BY_DESIGN or designs >= min(threads, DESIGNS_AT_ONCE):
        step = code.plan.width * -(-designs // (threads * code.plan.width))
        parts = [(objects, shape, k, min(k + step, designs), 0, segments) for k in range(0, designs, step)]
        return int(max(done_by_threads(code.part, parts), default=0))
    return _by_segments(code, objects, shape, segments, threads)


def _by_segments(code: PlannedCode, objects: int, shape: tuple[int, int], segments: int, threads: int) -> int:
    """Run all poses in so many threads, then what depends on reductions."""
    sums = np.empty(max(shape[0] * segments * code.plan.of_sums, 1))
    step = -(-segments // threads)

    def work(first: int) -> int:
        last = min(first + step, segments)
        return code.part(objects, shape, 0, shape[0], first, last, sums=sums.ctypes.data, last=0)

    answer: int = max(done_by_threads(work, [(k,) for k in range(0, segments, step)]))
    if answer:
        return answer
    return code.part(objects, shape, 0, shape[0], 0, 0, sums=sums.ctypes.data)


class Llvm:
    """The back end that compiles."""

    def runner(self, program: FlatProgram) -> LlvmRunner:
        """Make a program ready to run."""
        return LlvmRunner(program)
