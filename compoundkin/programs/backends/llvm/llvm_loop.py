"""The loop around a section: what goes from pose to pose, and what is added up over them."""

from __future__ import annotations

import math
from collections.abc import Iterator

from compoundkin.programs.backends.llvm.llvm_operations import lesser
from compoundkin.programs.backends.llvm.llvm_plan import BEFORE, LOOP, TOO_LARGE, LanePlan
from compoundkin.programs.backends.llvm.llvm_section import PARAMETERS, LaneSection
from compoundkin.programs.backends.llvm.llvm_text import LaneText, bits_of
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE
from compoundkin.programs.graph.operations import TOTAL


def start_of(plan: LanePlan, reduction: int) -> float:
    """Return what a reduction over no poses is."""
    return 0.0 if plan.program.graph.nodes[reduction].operation == TOTAL else math.inf


def joined(text: LaneText, plan: LanePlan, reduction: int, a: str, b: str) -> str:
    """Write the reduction of two parts."""
    is_total = plan.program.graph.nodes[reduction].operation == TOTAL
    return text.exact("fadd", a, b) if is_total else lesser(text, a, b)


def function_text(plan: LanePlan, name: str, is_masked: bool, suffix: str = "") -> tuple[str, set[str]]:
    """Return the function of a section, and what it declares."""
    section = LaneSection(plan, name, is_masked)
    section.body()
    loop = _Loop(section)
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


class _Loop:
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
                value = self.text.select(section.arrays.mask(), value, self.text.number(start_of(plan, k)))
            yield f"%r{i}", joined(self.text, plan, k, f"%r{i}", value), i * plan.width
        for j, one in enumerate(plan.program.carried):
            yield f"%c{j}", section.number(one.next), (len(plan.reductions) + j) * plan.width

    def _start(self) -> None:
        """Write what accumulators and carried numbers of a block of designs start with."""
        starts = [self.text.number(start_of(self.plan, k)) for k in self.plan.reductions]
        starts += [self.section.number(one.start) for one in self.plan.program.carried]
        for word, value in enumerate(starts):
            place = self.text.put(f"getelementptr double, ptr %A, i64 {word * self.plan.width}")
            self.text.do(f"store {self.text.real} {value}, ptr {place}, align 8")

    def close(self, ends: list[tuple[str, str, int]], large: str | None) -> None:
        """Write the end of a round, and after the last what is kept of it."""
        text, step = self.text, self.text.lanes if self.section.axis == BY_POSE else 1
        self.phis.append("  %p = phi i64 [ %from, %entry ], [ %next, %head ]")
        for name, end, word in ends:
            start = text.number(start_of(self.plan, self.plan.reductions[word])) if self.plan.width == 1 else ""
            if not start:
                place = text.first(f"getelementptr double, ptr %A, i64 {word}")
                start = text.first(f"load {text.real}, ptr {place}, align 8")
            self.phis.append(f"  {name} = phi {text.real} [ {start}, %entry ], [ {end}, %head ]")
        if large is not None:
            false = "zeroinitializer" if text.lanes > 1 else "false"
            some = text.truths("or", "%l", large)
            self.phis.append(f"  %l = phi {text.truth} [ {false}, %entry ], [ {some}, %head ]")
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
            end = joined(text.narrowed(lanes), self.plan, reduction, *parts)
        before = text.put(f"load double, ptr {place}, align 8")
        text.do(f"store double {joined(text.narrowed(1), self.plan, reduction, before, end)}, ptr {place}, align 8")

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
        text.do(f"store double {bits_of(start_of(plan, k))}, ptr {place}")
        a, b = (lines.put(f"getelementptr double, ptr {each}, i64 {i}") for each in ("%A", "%B"))
        found = joined(lines, plan, k, *(lines.put(f"load double, ptr {each}") for each in (a, b)))
        lines.do(f"store double {found}, ptr {a}")
    return "\n".join(
        [
            "define internal void @reset(ptr %A) #0 {", *text.lines, "  ret void", "}",
            "define internal void @join(ptr %A, ptr %B) #0 {", *lines.lines, "  ret void", "}",
        ]
    )  # fmt: skip
