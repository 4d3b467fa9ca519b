"""The LLVM back end: a program compiled by llvmlite for this processor, for the arrays it is called with.

Compiled code is kept on disk from one process to the next.
"""

from __future__ import annotations

import ctypes
import ctypes.util
import sys
import threading
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from itertools import count
from typing import Any

import llvmlite.binding as llvm
import numpy as np

from compoundkin.programs.backends.llvm_arrays import FIRST_OBJECT, RECORDS_ARE_KNOWN, array_records, layout_of
from compoundkin.programs.backends.llvm_plan import (
    ARRAY_KIND,
    DESIGNS_AT_ONCE,
    EXTENT,
    HEADER,
    NUMBER_KIND,
    LanePlan,
    Machine,
)
from compoundkin.programs.backends.llvm_program import (
    ANGLE_TOO_LARGE,
    FITS_NOT,
    program_text,
    segment_length,
    segments_of,
)
from compoundkin.programs.backends.object_cache import cached_object, store_object
from compoundkin.programs.backends.runner import run_in_threads
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, FlatProgram

# Poses that are worth a thread: fewer take less time than to wake one.
POSES_PER_THREAD = 8_192


# Poses below which lanes go along designs, where there are more of those.
FEW_POSES = 12


# Poses of a design from which on they are worth code of their own, without masks: it takes a tenth less.
LONG_POSES = 4_096


class PlannedCode:
    """The code for one plan, with scratch for each thread."""

    def __init__(self, plan: LanePlan) -> None:
        self.plan = plan
        self.code = compile_text(program_text(plan))
        self.run, self.run_all = self.code.run, self.code.run_all
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
            self._own.words, self._own.first, self._own.address = words, first, address
            return address

    def whole(self, objects: int, shape: tuple[int, int]) -> int:
        """Run all designs and segments; answer 0, or why not."""
        own = self._own
        if getattr(own, "extent", None) != shape:
            self.scratch()
            poses, first = shape[1], own.first + EXTENT
            length = segment_length(poses)
            own.words[first : first + 4] = *shape, length, segments_of(poses, length)
            own.extent = shape
        return self.run_all(objects, own.address)  # type: ignore[no-any-return]

    def part(self, objects: int, shape: tuple[int, int], *bounds: int, sums: int | None = None, last: int = 1) -> int:
        """Run some designs and segments; answer 0, or why not."""
        return self.run(objects, self.scratch(), *shape, *bounds, sums, last, segment_length(shape[1]))  # type: ignore[no-any-return]


class LlvmRunner:
    """A flat program as compiled code. There is one for each way in which arrays stand."""

    def __init__(self, program: FlatProgram) -> None:
        self.program = program
        self._codes: dict[Any, PlannedCode] = {}
        self._recent: dict[tuple[int, bool, bool], PlannedCode] = {}

    def __call__(self, inputs: Sequence[Any], outputs: Sequence[Any], shape: tuple[int, int], threads: int = 1) -> None:
        """Compute the outputs."""
        designs, poses = shape
        by_designs = designs > 1 and poses < FEW_POSES and poses < designs
        axis = BY_DESIGN if by_designs or self.program.carried else BY_POSE
        is_single = designs == 1 and axis == BY_POSE
        way = (axis, is_single, is_single and poses >= LONG_POSES and host_target()[0].has_masks)
        code = self._recent.get(way)
        answer = FITS_NOT
        arrays = (*inputs, *outputs)
        if code is not None and RECORDS_ARE_KNOWN and len(arrays) == code.plan.arrays:
            answer = _run_code(code, id(arrays) + FIRST_OBJECT, shape, threads)
        if answer:
            self._other_way(answer, way, (inputs, outputs), shape, threads)

    def _other_way(
        self, answer: int, way: tuple[int, bool, bool], arrays: Any, shape: tuple[int, int], threads: int
    ) -> None:
        """Run the code that suits the arrays, or the angles."""
        program = self.program
        inputs, outputs = arrays
        arrays, objects, _kept = array_records(program, inputs, outputs, shape)
        layout = layout_of(program, arrays, way[0])
        if answer == FITS_NOT:
            code = self._recent[way] = self._code(way, layout, False)
            answer = _run_code(code, objects, shape, threads)
        if answer == ANGLE_TOO_LARGE:
            answer = _run_code(self._code(way, layout, True), objects, shape, threads)
        assert not answer

    def _code(self, way: tuple[int, bool, bool], layout: Any, wide: bool) -> PlannedCode:
        key = (way, layout, wide)
        if key not in self._codes:
            self._codes[key] = PlannedCode(LanePlan(self.program, way[0], layout, host_target()[0], wide, *way[1:]))
        return self._codes[key]


def _run_code(code: PlannedCode, objects: int, shape: tuple[int, int], threads: int) -> int:
    """Run all designs and poses, in so many threads."""
    designs, poses = shape
    threads = threads if threads == 1 else min(threads, designs * poses // POSES_PER_THREAD + 1)
    if threads == 1:
        return code.whole(objects, shape)
    segments = segments_of(poses, segment_length(poses))
    if code.plan.axis == BY_DESIGN or designs >= min(threads, DESIGNS_AT_ONCE):
        step = code.plan.width * -(-designs // (threads * code.plan.width))
        parts = [(objects, shape, k, min(k + step, designs), 0, segments) for k in range(0, designs, step)]
        return int(max(run_in_threads(code.part, parts), default=0))
    return _run_by_segments(code, objects, shape, segments, threads)


def _run_by_segments(code: PlannedCode, objects: int, shape: tuple[int, int], segments: int, threads: int) -> int:
    """Run all poses in so many threads, then what depends on reductions."""
    sums = np.empty(max(shape[0] * segments * code.plan.of_sums, 1))
    step = -(-segments // threads)

    def work(first: int) -> int:
        last = min(first + step, segments)
        return code.part(objects, shape, 0, shape[0], first, last, sums=sums.ctypes.data, last=0)

    answer: int = max(run_in_threads(work, [(k,) for k in range(0, segments, step)]))
    if answer:
        return answer
    return code.part(objects, shape, 0, shape[0], 0, 0, sums=sums.ctypes.data)


class Llvm:
    """The back end that compiles."""

    def runner(self, program: FlatProgram) -> LlvmRunner:
        """Make a program ready to run."""
        return LlvmRunner(program)


# What code may call of the system's library: large angles, and rounding on processors without an instruction for it.
LIBRARY = ("sin", "cos", "floor", "ceil", "rint", "fma")


NUMBER, PLACE = ctypes.c_ssize_t, ctypes.c_void_p


RUN = ctypes.CFUNCTYPE(ctypes.c_int, PLACE, PLACE, *[NUMBER] * 6, PLACE, NUMBER, NUMBER)
RUN_ALL = ctypes.CFUNCTYPE(ctypes.c_int, PLACE, PLACE)


@dataclass(frozen=True)
class CompiledCode:
    """Code in memory, which lives as long as its library does."""

    library: Any
    run: Any
    run_all: Any


@cache
def host_target() -> tuple[Machine, str]:
    """Return what of this processor decides on the text, and its name."""
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    has = {name for name, there in llvm.get_host_cpu_features().items() if there}
    triple = llvm.get_process_triple()
    lanes = 16 if "avx512f" in has else 8 if "avx" in has else 4
    has_fma = "fma" in has or triple.startswith(("aarch64", "arm64"))
    version = ".".join(map(str, llvm.llvm_version_info))
    name = f"{version} {triple} {llvm.get_host_cpu_name()} {' '.join(sorted(has))}"
    return Machine(lanes, has_fma, "avx512bw" in has), name


# Texts longer than this are compiled with fewer passes: in half the time, for code that is at most some percent slower.
LONG = 300_000


def _object_of(text: str) -> bytes:
    """Compile a text for this processor."""
    machine = llvm.Target.from_triple(llvm.get_process_triple()).create_target_machine(
        cpu=llvm.get_host_cpu_name(),
        features=llvm.get_host_cpu_features().flatten(),
        opt=1 if len(text) > LONG else 2,
        reloc="pic",
        codemodel="small",
        jit=True,
    )
    return machine.emit_object(llvm.parse_assembly(text))  # type: ignore[no-any-return]


@cache
def _linker() -> tuple[Any, dict[str, int], Any]:
    """Return what links objects in memory, where the system's functions are, and numbers for names.

    The small code model needs the parts of an object within 2 GB of each other. LLVM's older linker asks the system
    for each part alone, and stops the process where they come to lie further apart, as happens in a process that has
    much memory; the newer one, JITLink, takes one piece for all.
    """
    found = {}
    with suppress(OSError, AttributeError, TypeError):
        library = ctypes.CDLL(ctypes.util.find_library("m") or ctypes.util.find_library("msvcrt"))
        for name in LIBRARY:
            found[name] = ctypes.cast(getattr(library, name), ctypes.c_void_p).value or 0
    return llvm.create_lljit_compiler(use_jit_link=sys.platform != "win32"), found, count()


def compile_text(text: str) -> CompiledCode:
    """Return the code of a text, from disk where it was compiled before."""
    key = f"{host_target()[1]}\n{text}"
    content = cached_object(key)
    if content is None:
        content = _object_of(text)
        store_object(key, content)
    linker, functions, numbers = _linker()
    builder = llvm.JITLibraryBuilder().add_object_img(content).export_symbol("run").export_symbol("run_all")
    for name, address in functions.items():
        builder.import_symbol(name, address)
    library = builder.link(linker, f"program {next(numbers)}")
    return CompiledCode(library, RUN(library["run"]), RUN_ALL(library["run_all"]))
