"""A whole program in LLVM's language: its sections, and the function that calls them for designs, segments and pieces.

A section is straight-line code, once or in a loop over poses. By poses: designs by the chunk; the poses of each segment
by the piece, whose rows stay in cache; all designs of the chunk at a piece. A reduction adds pieces up by segment, then
segments, whichever thread computed them. By designs: a block of designs side by side through all poses; results are
kept for a few poses in lanes and then written along the poses of each design, since number by number each would go to
another place in memory.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from compoundkin.programs.backends.llvm_arrays import STEADY, LaneArrays, unpacking_text
from compoundkin.programs.backends.llvm_functions import (
    INSTRUCTIONS,
    ON_TRUTHS,
    beyond_reduction,
    lesser,
    quarter_turns,
    sine_and_cosine,
)
from compoundkin.programs.backends.llvm_plan import (
    AFTER,
    BEFORE,
    DESIGNS_AT_ONCE,
    EXTENT,
    FIXED,
    HEADER,
    LOOP,
    POSES_TOGETHER,
    ROWS,
    ROWS_OF,
    SECTIONS,
    SEGMENTS,
    SHORTEST_SEGMENT,
    TOO_LARGE,
    LanePlan,
)
from compoundkin.programs.backends.llvm_text import ControlText, LaneText, bits_of
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE
from compoundkin.programs.graph.operation_graph import CONSTANT, INPUT, OPERATIONS, TOTAL

# The arrays, scratch, designs and poses, which designs and segments, where their sums are, whether it is the last call
# for these designs, poses of a segment.
ARGUMENTS = "ptr %O, ptr %S, i64 %D, i64 %P, i64 %d0, i64 %d1, i64 %s0, i64 %s1, ptr %E, i64 %last, i64 %L"


RUN = f"define i32 @run({ARGUMENTS}) #0 {{"


# All designs and segments in one call. Every argument costs as much as a dozen poses: their numbers are in the header.
RUN_ALL = f"""define i32 @run_all(ptr %O, ptr %S) #0 {{
  %E = getelementptr i64, ptr %S, i64 {EXTENT}
  %extent = load <4 x i64>, ptr %E, align 8
  %D = extractelement <4 x i64> %extent, i64 0
  %P = extractelement <4 x i64> %extent, i64 1
  %L = extractelement <4 x i64> %extent, i64 2
  %s1 = extractelement <4 x i64> %extent, i64 3
  %answer = call i32 @run(ptr %O, ptr %S, i64 %D, i64 %P, i64 0, i64 %D, i64 0, i64 %s1, ptr null, i64 1, i64 %L)
  ret i32 %answer
}}"""


FITS_NOT, ANGLE_TOO_LARGE = 1, 2


def segment_length(poses: int) -> int:
    """Return how many poses a segment has, whoever computes it."""
    if poses <= SEGMENTS * SHORTEST_SEGMENT:
        return SHORTEST_SEGMENT
    return -(-poses // (SEGMENTS * POSES_TOGETHER)) * POSES_TOGETHER


def segments_of(poses: int, length: int) -> int:
    """Return how many segments of a length poses have, at least one."""
    return -(-poses // length) or 1


def program_text(plan: LanePlan) -> str:
    """Return all of a program."""
    parts, declared = (
        [unpacking_text(plan), reset_text(plan)],
        {f"declare i64 @llvm.{each}.i64(i64, i64)" for each in ("smin", "smax")},
    )
    for name in filter(lambda name: _is_used(plan, name), SECTIONS):
        for suffix in ("",) if plan.machine.has_masks else ("", "_rest"):
            is_masked = bool(suffix) or (plan.machine.has_masks and not (plan.overlaps and name == LOOP))
            function, declares = function_text(plan, name, is_masked, suffix)
            parts.append(function)
            declared |= declares
    if plan.staged:
        parts.append(staging_text(plan, PARAMETERS))
        declared.add("declare void @llvm.prefetch.p0(ptr, i32, i32, i32)")
    parts += [_by_poses(plan) if plan.axis == BY_POSE else _by_designs(plan), RUN_ALL]
    width = 64 * min(plan.machine.lanes, 8)
    vectors = f'"prefer-vector-width"="{width}" "min-legal-vector-width"="{width}"'
    # registers that do not last are put on the stack: in whole cache lines only if it starts at one
    attributes = f'attributes #0 = {{ nounwind alignstack=64 "stackrealign" {vectors} }}'
    return "\n".join([*sorted(declared), *parts, attributes, "!0 = !{}"])


def _is_used(plan: LanePlan, name: str) -> bool:
    """Tell whether a section does anything."""
    if name == STAGED:
        return bool(plan.staged)
    sums = plan.of_sums and (name == LOOP or (name == BEFORE and plan.width > 1))
    return bool(sums or plan.nodes[name] or plan.sinks[name])


class _RunText(ControlText):
    """The text of the function that is called."""

    def __init__(self, plan: LanePlan) -> None:
        super().__init__()
        self.plan = plan
        fits = self.put("call i1 @unpack(ptr %O, ptr %S, i64 %D, i64 %P)")
        self.do(f"br i1 {fits}, label %fits, label %bad")
        self.label("fits")
        for word, value in ((ROWS_OF, -1), (TOO_LARGE, 0)):
            self.do(f"store i64 {value}, ptr {self.words('%S', word)}")
        self.section(FIXED)

    def section(self, name: str, *, G: str = "null", A: str = "null", d: str = "0", end: str = "%D",
                poses: tuple[str, str, str] = ("0", "0", "0"), suffix: str = "") -> None:  # fmt: skip
        """Write the call of a section, if there is any."""
        if not _is_used(self.plan, name):
            return
        first, last, start = poses
        of_poses = f"i64 {first}, i64 {last}, i64 {start}"
        self.do(f"call void @{name}{suffix}(ptr %S, ptr {G}, ptr {A}, i64 {d}, i64 {end}, {of_poses})")

    def of_poses(self, name: str, first: str, last: str, **places: str) -> None:
        """Write the call of a section whose lanes go along poses; a part of a vector may be left over."""
        if not _is_used(self.plan, name):
            return
        if self.plan.machine.has_masks:
            self.section(name, poses=(first, last, first), **places)
            return
        lanes = self.plan.machine.lanes
        left = self.whole("srem", self.whole("sub", last, first), lanes)
        middle = self.whole("sub", last, left)
        for a, b, suffix in ((first, middle, ""), (middle, last, "_rest")):
            with self.when(self.put(f"icmp slt i64 {a}, {b}")):
                self.section(name, poses=(a, b, first), suffix=suffix, **places)

    def rows(self, first: str, last: str) -> None:
        """Write that the rows of a piece are computed, unless they are there."""
        if _is_used(self.plan, ROWS):
            there = self.loaded("%S", ROWS_OF)
            with self.when(self.put(f"icmp ne i64 {there}, {first}")):
                self.of_poses(ROWS, first, last)
                self.do(f"store i64 {first}, ptr {self.words('%S', ROWS_OF)}")

    def end(self) -> str:
        """Return the function."""
        large = self.put(f"icmp ne i64 {self.loaded('%S', TOO_LARGE)}, 0")
        answer = self.put(f"select i1 {large}, i32 {ANGLE_TOO_LARGE}, i32 0")
        ending = [f"  ret i32 {answer}", "bad:", f"  ret i32 {FITS_NOT}", "}"]
        return "\n".join([RUN, "entry:", *self.lines, *ending])


class _ByPoses(_RunText):
    """The text for lanes along poses."""

    def __init__(self, plan: LanePlan) -> None:
        super().__init__(plan)
        segments = self.whole("sdiv", self.whole("sub", self.whole("add", "%P", "%L"), 1), "%L")
        self.segments = self.put(f"call i64 @llvm.smax.i64(i64 {segments}, i64 1)")
        own = self.put("icmp eq ptr %E, null")
        self.sums = self.put(f"select i1 {own}, ptr {self.words('%S', plan.at_sums)}, ptr %E")

    def place(self, chunk: str, design: str, segment: str | int) -> tuple[str, str]:
        """Write where what a design fixes is, and its accumulators of a segment."""
        row = self.whole("sub", design, chunk)
        ahead = self.whole("add", self.whole("mul", row, self.segments), segment)
        fixed = self.whole("add", self.whole("mul", row, self.plan.of_design), self.plan.at_designs)
        return self.words("%S", fixed), self.words(self.sums, self.whole("mul", ahead, self.plan.of_sums))

    def begin(self, chunk: str, end: str) -> None:
        """Write what a design fixes, and the start of its accumulators."""
        with self.steps(chunk, end) as d:
            self.section(BEFORE, G=self.place(chunk, d, 0)[0], d=d)
            with self.steps("%s0", "%s1") as s:
                self.do(f"call void @reset(ptr {self.place(chunk, d, s)[1]})")

    def segment(self, chunk: str, end: str, s: str) -> None:
        """Write the poses of a segment, for all designs of the chunk."""
        first = self.whole("mul", s, "%L")
        last = self.least(self.whole("add", first, "%L"), "%P")
        with self.steps(first, last, self.plan.piece) as p:
            p_end = self.least(self.whole("add", p, self.plan.piece), last)
            self.rows(p, p_end)
            with self.steps(chunk, end) as d:
                G, A = self.place(chunk, d, s)
                self.of_poses(LOOP, p, p_end, G=G, A=A, d=d)

    def finish(self, chunk: str, end: str) -> None:
        """Write what follows from reductions, where this call is the last for the designs."""
        with self.when(self.put("icmp ne i64 %last, 0")), self.steps(chunk, end) as d:
            G, A = self.place(chunk, d, 0)
            with self.steps(1, self.segments) as s:
                self.do(f"call void @join(ptr {A}, ptr {self.place(chunk, d, s)[1]})")
            self.section(AFTER, G=G, A=A, d=d)


def _by_poses(plan: LanePlan) -> str:
    """Return the function for lanes along poses."""
    text = _ByPoses(plan)
    with text.steps("%d0", "%d1", DESIGNS_AT_ONCE) as chunk:
        end = text.least(text.whole("add", chunk, DESIGNS_AT_ONCE), "%d1")
        text.begin(chunk, end)
        with text.steps("%s0", "%s1") as s:
            text.segment(chunk, end, s)
        text.finish(chunk, end)
    return text.end()


def _by_designs(plan: LanePlan) -> str:
    """Return the function for lanes along designs."""
    text, lanes = _RunText(plan), plan.machine.lanes
    G, A = text.words("%S", plan.at_designs), text.words("%S", plan.at_sums)
    middle = "%d1"
    if not plan.machine.has_masks:
        middle = text.whole("sub", "%d1", text.whole("srem", text.whole("sub", "%d1", "%d0"), lanes))
    parts = (("%d0", middle, ""),) if plan.machine.has_masks else (("%d0", middle, ""), (middle, "%d1", "_rest"))
    for first, last, suffix in parts:
        with text.steps(first, last, lanes) as d:
            text.section(BEFORE, G=G, A=A, d=d, end="%d1", suffix=suffix)
            with text.steps(0, "%P", plan.piece) as p:
                end = text.least(text.whole("add", p, plan.piece), "%P")
                text.rows(p, end)
                text.section(LOOP, G=G, A=A, d=d, end="%d1", poses=(p, end, p), suffix=suffix)
                text.section(STAGED, d=d, end="%d1", poses=(p, end, p))
            text.section(AFTER, G=G, A=A, d=d, end="%d1", suffix=suffix)
    return text.end()


def reduction_start(plan: LanePlan, reduction: int) -> float:
    """Return what a reduction over no poses is."""
    return 0.0 if plan.program.graph.nodes[reduction].operation == TOTAL else math.inf


def reduction_of_two(text: LaneText, plan: LanePlan, reduction: int, a: str, b: str) -> str:
    """Write the reduction of two parts."""
    is_total = plan.program.graph.nodes[reduction].operation == TOTAL
    return text.exact("fadd", a, b) if is_total else lesser(text, a, b)


def function_text(plan: LanePlan, name: str, is_masked: bool, suffix: str = "") -> tuple[str, set[str]]:
    """Return the function of a section, and what it declares."""
    section = LaneSection(plan, name, is_masked)
    section.body()
    loop = _RowLoop(section)
    ends = list(loop.ends())
    large = section.too_large()
    lines = [f"define internal void @{name}{suffix}({PARAMETERS}) #0 {{", "entry:"]
    if section.loops:
        loop.close(ends, large)
        lines += [*section.text.entry, "  br label %head", "head:", *loop.phis, *section.text.lines]
    else:
        if large is not None:
            loop.note(large)
        lines += [*section.text.entry, *section.text.lines]
    return "\n".join([*lines, "  ret void", "}"]), section.text.declared


class _RowLoop:
    """Values that go from one round to the next."""

    def __init__(self, section: LaneSection) -> None:
        self.section, self.plan, self.text = section, section.plan, section.text
        self.phis: list[str] = []

    def ends(self) -> Iterator[tuple[str, str, int]]:
        """Yield the names that values have at the start of a round and at its end, and their words."""
        plan, section = self.plan, self.section
        if section.name == BEFORE and section.axis == BY_DESIGN:
            self._start()
        if section.name != LOOP:
            return
        for i, k in enumerate(plan.reductions):
            value = section.number(plan.program.graph.nodes[k].operands[0])
            if section.axis == BY_POSE and section.is_masked:
                value = self.text.select(section.arrays.mask(), value, self.text.number(reduction_start(plan, k)))
            yield f"%r{i}", reduction_of_two(self.text, plan, k, f"%r{i}", value), i * plan.width
        for j, one in enumerate(plan.program.carried):
            yield f"%c{j}", section.number(one.next), (len(plan.reductions) + j) * plan.width

    def _start(self) -> None:
        """Write what accumulators and carried numbers of a block of designs start with."""
        starts = [self.text.number(reduction_start(self.plan, k)) for k in self.plan.reductions]
        starts += [self.section.number(one.start) for one in self.plan.program.carried]
        for word, value in enumerate(starts):
            place = self.text.put(f"getelementptr double, ptr %A, i64 {word * self.plan.width}")
            self.text.do(f"store {self.text.real} {value}, ptr {place}, align 8")

    def close(self, ends: list[tuple[str, str, int]], large: str | None) -> None:
        """Write the end of a round, and after the last what is kept of it."""
        text, step = self.text, self.text.lanes if self.section.axis == BY_POSE else 1
        first = "%from"
        if self.plan.overlaps:
            last = text.first(f"sub i64 %to, {step}")
            first = text.first(f"call i64 @llvm.smin.i64(i64 %from, i64 {last})")
        self.phis.append(f"  %p = phi i64 [ {first}, %entry ], [ %next, %head ]")
        for name, end, word in ends:
            start = text.number(reduction_start(self.plan, self.plan.reductions[word])) if self.plan.width == 1 else ""
            if not start:
                place = text.first(f"getelementptr double, ptr %A, i64 {word}")
                start = text.first(f"load {text.real}, ptr {place}, align 8")
            self.phis.append(f"  {name} = phi {text.real} [ {start}, %entry ], [ {end}, %head ]")
        if large is not None:
            false = "zeroinitializer" if text.lanes > 1 else "false"
            some = text.truths("or", "%l", large)
            self.phis.append(f"  %l = phi {text.truth} [ {false}, %entry ], [ {some}, %head ]")
        if self.plan.overlaps:
            text.do(f"%next = call i64 @llvm.smin.i64(i64 {text.put(f'add i64 %p, {step}')}, i64 {last})")
            text.do(f"%more = icmp slt i64 %p, {last}")
        else:
            text.do(f"%next = add i64 %p, {step}")
            text.do("%more = icmp slt i64 %next, %to")
        text.do("br i1 %more, label %head, label %done")
        text.lines.append("done:")
        for _, end, word in ends:
            self._keep(end, word)
        if large is not None:
            self.note(some)

    def _keep(self, end: str, word: int) -> None:
        """Write an accumulator to its place; lanes of poses are put together first, always in one order."""
        text = self.text
        place = text.put(f"getelementptr double, ptr %A, i64 {word}")
        if self.plan.width > 1 or self.section.axis != BY_POSE:
            text.do(f"store {text.real} {end}, ptr {place}, align 8")
            return
        reduction, lanes = self.plan.reductions[word], text.lanes
        while lanes > 1:
            kind, lanes = text.kind("double", lanes), lanes // 2
            parts = []
            for first in (0, lanes):
                order = ", ".join(f"i32 {first + k}" for k in range(lanes))
                mask = f"<{lanes} x i32> <{order}>"
                half = text.put(f"shufflevector {kind} {end}, {kind} poison, {mask}")
                parts.append(half if lanes > 1 else text.put(f"extractelement <1 x double> {half}, i64 0"))
            end = reduction_of_two(text.narrowed(lanes), self.plan, reduction, *parts)
        before = text.put(f"load double, ptr {place}, align 8")
        total = reduction_of_two(text.narrowed(1), self.plan, reduction, before, end)
        text.do(f"store double {total}, ptr {place}, align 8")

    def note(self, large: str) -> None:
        """Write that an angle was too large."""
        text = self.text
        if text.lanes > 1:
            name = f"@llvm.vector.reduce.or.v{text.lanes}i1"
            text.declared.add(f"declare i1 {name}({text.truth})")
            large = text.put(f"call i1 {name}({text.truth} {large})")
        word = text.put(f"zext i1 {large} to i64")
        place = text.put(f"getelementptr i64, ptr %S, i64 {TOO_LARGE}")
        before = text.put(f"load i64, ptr {place}")
        text.do(f"store i64 {text.put(f'or i64 {word}, {before}')}, ptr {place}")


def reset_text(plan: LanePlan) -> str:
    """Return the functions that start accumulators and put two segments together."""
    text, lines = LaneText(1, plan.machine.has_fma), LaneText(1, plan.machine.has_fma)
    for i, k in enumerate(plan.reductions):
        place = text.put(f"getelementptr double, ptr %A, i64 {i}")
        text.do(f"store double {bits_of(reduction_start(plan, k))}, ptr {place}")
        a, b = (lines.put(f"getelementptr double, ptr {each}, i64 {i}") for each in ("%A", "%B"))
        found = reduction_of_two(lines, plan, k, *(lines.put(f"load double, ptr {each}") for each in (a, b)))
        lines.do(f"store double {found}, ptr {a}")
    return "\n".join(
        [
            "define internal void @reset(ptr %A) #0 {", *text.lines, "  ret void", "}",
            "define internal void @join(ptr %A, ptr %B) #0 {", *lines.lines, "  ret void", "}",
        ]
    )  # fmt: skip


# S: scratch with the table of arrays; G: what the design fixes; A: its accumulators; the design, and where designs end;
# the poses from, to, and where the piece of poses starts whose rows are kept.
PARAMETERS = "ptr noalias %S, ptr noalias %G, ptr noalias %A, i64 %d, i64 %end, i64 %from, i64 %to, i64 %start"


class LaneSection:
    """The writer of one section."""

    def __init__(self, plan: LanePlan, name: str, is_masked: bool) -> None:
        self.plan, self.name, self.is_masked = plan, name, is_masked
        self.loops = name in (ROWS, LOOP)
        self.axis = BY_POSE if name == ROWS else 0 if name == FIXED or plan.axis not in self._axes() else plan.axis
        self.text = LaneText(plan.machine.lanes if self.axis else 1, plan.machine.has_fma)
        self.arrays = LaneArrays(plan, self.text, self.axis, is_masked, self.loops)
        self._numbers: dict[int, str] = {}
        self._truths: dict[int, str] = {}
        self._turned: dict[int, tuple[str, str]] = {}
        self._large: list[str] = []
        self._row_now = ""

    def _axes(self) -> tuple[int, ...]:
        return (BY_POSE, BY_DESIGN) if self.loops else (BY_DESIGN,)

    # --- values ---

    def number(self, k: int) -> str:
        """Return a node's value as a number, computed before or read now."""
        if k not in self._numbers:
            if k in self._truths:
                one, zero = self.text.number(1.0), self.text.number(0.0)
                self._numbers[k] = self.text.select(self._truths[k], one, zero)
            else:
                self._numbers[k] = self._read(k)
        return self._numbers[k]

    def truth(self, k: int) -> str:
        """Return a node's value as a truth."""
        if k not in self._truths:
            self._truths[k] = self.text.compare("une", self.number(k), self.text.number(0.0))
        return self._truths[k]

    def _read(self, k: int) -> str:
        plan, node = self.plan, self.plan.program.graph.nodes[k]
        if node.operation == CONSTANT:
            return self.text.number(node.value)
        if node.operation == INPUT:
            for j, one in enumerate(plan.program.carried):
                if one.given == k:
                    return f"%c{j}"
            value = plan.program.delayed.get(k)
            if value is not None:
                now = self.number(value)
                varies = plan.program.strata[value] & BY_POSE
                return self.arrays.load_before(plan.inputs.index(value), now) if varies else now
            return self.arrays.load(plan.inputs.index(k))
        if k in plan.reductions:
            return self._word("%A", plan.reductions.index(k) * plan.width, self.axis)
        home = plan.section_of[k]
        place = plan.kept[home][k]
        if home == FIXED:
            return self._word("%S", plan.at_fixed + place, 0)
        if home == BEFORE:
            return self._word("%G", place * plan.width, self.axis & plan.axis & BY_DESIGN)
        return self._word(self._row(), plan.at_rows + place * plan.piece, self.axis & BY_POSE)

    def _row(self) -> str:
        """Write where the rows of the pose of the first lane start."""
        if not self._row_now:
            offset = self.text.put("sub i64 %p, %start")
            self._row_now = self.text.put(f"getelementptr double, ptr %S, i64 {offset}")
        return self._row_now

    def _place(self, base: str, word: int) -> str:
        return self.text.put(f"getelementptr double, ptr {base}, i64 {word}")

    def _word(self, base: str, word: int, many: int) -> str:
        """Write the reading of a kept value: of each lane its own, or one for all."""
        place = self._place(base, word)
        if many:
            return self.text.put(f"load {self.text.real}, ptr {place}, align 8, {STEADY}")
        return self.text.spread(self.text.put(f"load double, ptr {place}, align 8, {STEADY}"))

    # --- operations ---

    def _compute(self, k: int) -> None:
        node = self.plan.program.graph.nodes[k]
        if node.operation in ("sin", "cos"):
            self._numbers[k] = self._turn(node.operands[0], node.operation)
            return
        truths = len(node.operands) if node.operation in ON_TRUTHS else int(node.operation == "select")
        operands = [self.truth(n) if i < truths else self.number(n) for i, n in enumerate(node.operands)]
        found = INSTRUCTIONS[node.operation](self.text, *operands)
        (self._truths if OPERATIONS[node.operation].is_truth else self._numbers)[k] = found

    def _turn(self, angle: int, operation: str) -> str:
        """Write the sine or cosine of an angle; the other of the two is then known."""
        x = self.number(angle)
        if self.plan.wide:
            return self.text.call(operation, x)
        if angle not in self._turned:
            self._large.append(beyond_reduction(self.text, x))
            self._turned[angle] = sine_and_cosine(self.text, *quarter_turns(self.text, x))
        return self._turned[angle][operation == "cos"]

    def _keep(self, k: int) -> None:
        """Write a value to its place for later sections."""
        place = self.plan.kept.get(self.name, {}).get(k)
        if place is None:
            return
        if self.name == FIXED:
            base, word = "%S", self.plan.at_fixed + place
        elif self.name == BEFORE:
            base, word = "%G", place * self.plan.width
        else:
            base, word = self._row(), self.plan.at_rows + place * self.plan.piece
        value = self.number(k)
        self.text.do(f"store {self.text.real} {value}, ptr {self._place(base, word)}, align 8")

    def body(self) -> None:
        """Write the operations, and each output as soon as it is known."""
        sinks: dict[int, list[int]] = {}
        for array, k in self.plan.sinks[self.name]:
            sinks.setdefault(k, []).append(array)
        for k in self.plan.nodes[self.name]:
            self._compute(k)
            self._keep(k)
            for array in sinks.pop(k, ()):
                self.arrays.store(array, self.number(k))
        for k, arrays in sinks.items():
            for array in arrays:
                self.arrays.store(array, self.number(k))

    def too_large(self) -> str | None:
        """Write in which lanes an angle was too large."""
        found = None
        for each in self._large:
            found = each if found is None else self.text.truths("or", found, each)
        if found is None or not self.is_masked or not self.axis:
            return found
        return self.text.truths("and", found, self.arrays.mask())


STAGED = "staged"


def staging_text(plan: LanePlan, parameters: str) -> str:
    """Return the function that writes what is kept."""
    text = ControlText()
    lanes = text.least(text.whole("sub", "%end", "%d"), plan.machine.lanes)
    poses = text.whole("sub", "%to", "%from")
    for i, array in enumerate(plan.staged):
        row = text.words("%S", HEADER + 3 * array)
        by_design, by_pose = text.loaded(row, 1), text.loaded(row, 2)
        offset = text.whole("add", text.whole("mul", "%d", by_design), text.whole("mul", "%from", by_pose))
        ahead = text.whole("mul", by_pose, plan.piece)
        first = _bytes_behind(text, text.loaded(row, 0, "ptr"), offset)
        kept = text.words("%S", plan.at_staged + i * plan.piece * plan.machine.lanes)
        with text.steps(0, lanes) as lane:
            target = _bytes_behind(text, first, text.whole("mul", lane, by_design))
            source = text.words(kept, lane)
            with text.steps(0, poses) as pose:
                value = text.loaded(source, text.whole("mul", pose, plan.machine.lanes), "double")
                place = _bytes_behind(text, target, text.whole("mul", pose, by_pose))
                text.do(f"call void @llvm.prefetch.p0(ptr {_bytes_behind(text, place, ahead)}, i32 1, i32 3, i32 1)")
                text.do(f"store double {value}, ptr {place}")
    return "\n".join([f"define internal void @{STAGED}({parameters}) #0 {{", "entry:", *text.lines, "  ret void", "}"])


def _bytes_behind(text: ControlText, place: str, offset: str) -> str:
    """Write the place so many bytes behind another."""
    return text.put(f"getelementptr i8, ptr {place}, i64 {offset}")
