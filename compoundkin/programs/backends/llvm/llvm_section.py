"""One section of a program as a function in LLVM's language: straight-line code, in a loop over poses or once."""

from __future__ import annotations

from compoundkin.programs.backends.llvm.llvm_arrays import STEADY, LaneArrays
from compoundkin.programs.backends.llvm.llvm_functions import beyond_reduction, quarter_turns, sine_and_cosine
from compoundkin.programs.backends.llvm.llvm_operations import INSTRUCTIONS, ON_TRUTHS
from compoundkin.programs.backends.llvm.llvm_plan import BEFORE, FIXED, LOOP, ROWS, LanePlan
from compoundkin.programs.backends.llvm.llvm_text import LaneText
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE
from compoundkin.programs.graph.operations import CONSTANT, INPUT, OPERATIONS

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
