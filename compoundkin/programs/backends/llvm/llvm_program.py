"""A whole program in LLVM's language: its sections, and the function that calls them for designs, segments and pieces.

By poses: designs by the chunk; the poses of each segment by the piece, whose rows stay in cache; all designs of the
chunk at a piece. A reduction adds pieces up by segment, then segments, whichever thread computed them. By designs: a
block of designs side by side through all poses.
"""

from __future__ import annotations

from compoundkin.programs.backends.llvm.llvm_control import ControlText
from compoundkin.programs.backends.llvm.llvm_loop import function_text, reset_text
from compoundkin.programs.backends.llvm.llvm_plan import (
    AFTER,
    BEFORE,
    DESIGNS_AT_ONCE,
    FIXED,
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
from compoundkin.programs.backends.llvm.llvm_records import unpacking_text
from compoundkin.programs.backends.llvm.llvm_section import PARAMETERS
from compoundkin.programs.backends.llvm.llvm_stage import STAGED, staging_text
from compoundkin.programs.graph.flat_program import BY_POSE

# The arrays, scratch, designs and poses, which designs and segments, where their sums are, whether it is the last call
# for these designs, poses of a segment.
ARGUMENTS = "ptr %O, ptr %S, i64 %D, i64 %P, i64 %d0, i64 %d1, i64 %s0, i64 %s1, ptr %E, i64 %last, i64 %L"
RUN = f"define i32 @run({ARGUMENTS}) #0 {{"
FITS_NOT, ANGLE_TOO_LARGE = 1, 2


def segment_length(poses: int) -> int:
    """Return how many poses a segment has, whoever computes it."""
    return max(-(-poses // (SEGMENTS * POSES_TOGETHER)) * POSES_TOGETHER, SHORTEST_SEGMENT)


def program_text(plan: LanePlan) -> str:
    """Return all of a program."""
    parts, declared = (
        [unpacking_text(plan), reset_text(plan)],
        {f"declare i64 @llvm.{each}.i64(i64, i64)" for each in ("smin", "smax")},
    )
    for name in filter(lambda name: _is_used(plan, name), SECTIONS):
        for suffix in ("",) if plan.machine.has_masks else ("", "_rest"):
            function, declares = function_text(plan, name, bool(suffix) or plan.machine.has_masks, suffix)
            parts.append(function)
            declared |= declares
    if plan.staged:
        parts.append(staging_text(plan, PARAMETERS))
        declared.add("declare void @llvm.prefetch.p0(ptr, i32, i32, i32)")
    parts.append(_by_poses(plan) if plan.axis == BY_POSE else _by_designs(plan))
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
