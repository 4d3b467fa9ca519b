"""How LLVM's code reads and writes the arrays of a call, lane by lane or many at once."""

from __future__ import annotations

from collections.abc import Iterable

from compoundkin.programs.backends.llvm.llvm_plan import ANY_STRIDE, COMPLEX, HEADER, LanePlan
from compoundkin.programs.backends.llvm.llvm_text import LaneText
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE

# Inputs stay as they are while a program runs, and no output overlaps them.
STEADY = "!invariant.load !0"
# Bytes: so far ahead results are prepared for; twelve outputs out of cache then take half the time.
AHEAD, CACHE_LINE = 512, 64


class LaneArrays:
    """Loads and stores of one section. Its lanes go along an axis; without one there is one lane."""

    def __init__(self, plan: LanePlan, text: LaneText, axis: int, is_masked: bool, loops: bool) -> None:
        self.plan, self.text, self.axis, self.is_masked = plan, text, axis, is_masked
        self.loops, self._stage_now = loops, ""
        self._bases: dict[int, str] = {}
        self._steps: dict[tuple[int, int], str] = {}
        self._masks: dict[int, str] = {}
        self._loaded: dict[int, str] = {}
        self._waiting: dict[int, str] = {}

    def _entry(self, array: int, word: int) -> str:
        """Write, once, the reading of a word of an array's row in the table."""
        place = self.text.first(f"getelementptr i64, ptr %S, i64 {HEADER + 3 * array + word}")
        return self.text.first(f"load {'i64' if word else 'ptr'}, ptr {place}, {STEADY}")

    def _base(self, array: int) -> str:
        """Return where an array starts for the design of the section."""
        if array not in self._bases:
            base = self._entry(array, 0)
            if self.plan.stratum(array) & BY_DESIGN:
                offset = self.text.first(f"mul i64 %d, {self._entry(array, 1)}")
                base = self.text.first(f"getelementptr i8, ptr {base}, i64 {offset}")
            self._bases[array] = base
        return self._bases[array]

    def _step(self, array: int, word: int) -> str:
        """Return an array's stride along designs (1) or poses (2)."""
        if (array, word) not in self._steps:
            self._steps[array, word] = self._entry(array, word)
        return self._steps[array, word]

    def _kind(self, array: int) -> int:
        return self.plan.layout.kinds[array]

    def _address(self, array: int) -> str:
        """Write where the first lane of an array is now."""
        base = self._base(array)
        if not self.plan.stratum(array) & BY_POSE:
            return base
        if self.axis == BY_POSE and self._kind(array) != ANY_STRIDE:
            of = "double" if self._kind(array) != COMPLEX else "<2 x double>"
            return self.text.put(f"getelementptr {of}, ptr {base}, i64 %p")
        offset = self.text.put(f"mul i64 %p, {self._step(array, 2)}")
        return self.text.put(f"getelementptr i8, ptr {base}, i64 {offset}")

    def mask(self, each: int = 1) -> str:
        """Return which lanes are there, each so many times."""
        text = self.text
        lanes = text.lanes * each
        if not self.is_masked:
            return "splat (i1 true)"
        if each not in self._masks:
            # along designs the mask is that of the whole loop over poses
            put = text.put if self.axis == BY_POSE else text.first
            last, first = ("%to", "%p") if self.axis == BY_POSE else ("%end", "%d")
            text.declared.add("declare i64 @llvm.umin.i64(i64, i64)")
            few = put(f"call i64 @llvm.umin.i64(i64 {put(f'sub i64 {last}, {first}')}, i64 {text.lanes})")
            kind = f"<{lanes} x i8>"
            one = put(f"insertelement {kind} poison, i8 {put(f'trunc i64 {few} to i8')}, i64 0")
            all_ = put(f"shufflevector {kind} {one}, {kind} poison, <{lanes} x i32> zeroinitializer")
            numbers = ", ".join(f"i8 {k // each}" for k in range(lanes))
            self._masks[each] = put(f"icmp ugt {kind} {all_}, <{numbers}>")
        return self._masks[each]

    # --- reading ---

    def load(self, array: int) -> str:
        """Write the reading of an array's lanes."""
        if not self.axis & self.plan.stratum(array):
            return self.text.spread(self.text.put(f"load double, ptr {self._address(array)}, {STEADY}"))
        if self._kind(array) == ANY_STRIDE:
            return self._gathered(array)
        if self._kind(array) == COMPLEX:
            return self._part(array)
        return self._many(self._address(array), 1)

    def _many(self, place: str, each: int) -> str:
        """Write the reading of numbers side by side."""
        lanes = self.text.lanes * each
        kind, suffix = f"<{lanes} x double>", f"v{lanes}f64.p0"
        if not self.is_masked:
            return self.text.put(f"load {kind}, ptr {place}, align 8, {STEADY}")
        name, truths = f"@llvm.masked.load.{suffix}", f"<{lanes} x i1>"
        self.text.declared.add(f"declare {kind} {name}(ptr, i32, {truths}, {kind})")
        arguments = f"ptr {place}, i32 8, {truths} {self.mask(each)}, {kind} zeroinitializer"
        return self.text.put(f"call {kind} {name}({arguments})")

    def _part(self, array: int) -> str:
        """Write the reading of complex numbers, and return the part asked for."""
        if array not in self._loaded:
            pair = next(pair for pair in self.plan.layout.pairs if array in pair)
            lanes = self.text.lanes
            both, kind = self._many(self._address(pair[0]), 2), f"<{2 * lanes} x double>"
            for part, each in enumerate(pair):
                order = _order(range(part, 2 * lanes, 2))
                self._loaded[each] = self.text.put(f"shufflevector {kind} {both}, {kind} poison, {order}")
        return self._loaded[array]

    def _places(self, array: int) -> str:
        """Write where each lane of an array of any stride is."""
        text, word = self.text, 1 if self.axis == BY_DESIGN else 2
        lanes, whole = text.lanes, text.whole
        one = text.put(f"insertelement {whole} poison, i64 {self._step(array, word)}, i64 0")
        all_ = text.put(f"shufflevector {whole} {one}, {whole} poison, <{lanes} x i32> zeroinitializer")
        numbers = ", ".join(f"i64 {k}" for k in range(lanes))
        steps = text.put(f"mul {whole} {all_}, <{numbers}>")
        return text.put(f"getelementptr i8, ptr {self._address(array)}, {whole} {steps}")

    def _gathered(self, array: int) -> str:
        text, lanes = self.text, self.text.lanes
        name = f"@llvm.masked.gather.v{lanes}f64.v{lanes}p0"
        pointers, truths = f"<{lanes} x ptr>", f"<{lanes} x i1>"
        text.declared.add(f"declare {text.real} {name}({pointers}, i32, {truths}, {text.real})")
        arguments = f"{pointers} {self._places(array)}, i32 8, {truths} {self.mask()}, {text.real} zeroinitializer"
        return text.put(f"call {text.real} {name}({arguments})")

    # --- writing ---

    def store(self, array: int, value: str) -> None:
        """Write an array's lanes to it. One part of complex numbers waits for the other."""
        if not self.axis:
            self.text.do(f"store double {value}, ptr {self._address(array)}")
        elif self.loops and array in self.plan.staged:
            self._stage(array, value)
        elif self._kind(array) == ANY_STRIDE:
            self._scatter(array, value)
        elif self._kind(array) == COMPLEX:
            self._waiting[array] = value
            pair = next(pair for pair in self.plan.layout.pairs if array in pair)
            if all(each in self._waiting for each in pair):
                self._store_many(self._address(pair[0]), self._joined(pair), 2)
        else:
            self._store_many(self._address(array), value, 1)

    def _joined(self, pair: tuple[int, int]) -> str:
        """Write real and imaginary parts in turns."""
        real, lanes = self.text.real, self.text.lanes
        x, y = (self._waiting[each] for each in pair)
        order = _order(lanes * part + k for k in range(lanes) for part in (0, 1))
        return self.text.put(f"shufflevector {real} {x}, {real} {y}, {order}")

    def _store_many(self, place: str, value: str, each: int) -> None:
        lanes = self.text.lanes * each
        kind = f"<{lanes} x double>"
        self._prepare(place, lanes)
        if not self.is_masked:
            self.text.do(f"store {kind} {value}, ptr {place}, align 8")
            return
        name, truths = f"@llvm.masked.store.v{lanes}f64.p0", f"<{lanes} x i1>"
        self.text.declared.add(f"declare void {name}({kind}, ptr, i32, {truths})")
        self.text.do(f"call void {name}({kind} {value}, ptr {place}, i32 8, {truths} {self.mask(each)})")

    def _prepare(self, place: str, lanes: int) -> None:
        """Write that the cache is asked for what will be written soon: with many outputs it does not see it come."""
        self.text.declared.add("declare void @llvm.prefetch.p0(ptr, i32, i32, i32)")
        for byte in range(AHEAD, AHEAD + 8 * lanes, CACHE_LINE):
            line = self.text.put(f"getelementptr i8, ptr {place}, i64 {byte}")
            self.text.do(f"call void @llvm.prefetch.p0(ptr {line}, i32 1, i32 3, i32 1)")

    def _stage(self, array: int, value: str) -> None:
        """Write an array's lanes to where they are kept."""
        text, plan = self.text, self.plan
        if not self._stage_now:
            pose = text.put(f"mul i64 {text.put('sub i64 %p, %start')}, {text.lanes}")
            self._stage_now = text.put(f"getelementptr double, ptr %S, i64 {pose}")
        word = plan.at_staged + plan.staged.index(array) * plan.piece * text.lanes
        place = text.put(f"getelementptr double, ptr {self._stage_now}, i64 {word}")
        text.do(f"store {text.real} {value}, ptr {place}, align 8")

    def _scatter(self, array: int, value: str) -> None:
        text, lanes = self.text, self.text.lanes
        name = f"@llvm.masked.scatter.v{lanes}f64.v{lanes}p0"
        pointers, truths = f"<{lanes} x ptr>", f"<{lanes} x i1>"
        text.declared.add(f"declare void {name}({text.real}, {pointers}, i32, {truths})")
        places = self._places(array)
        text.do(f"call void {name}({text.real} {value}, {pointers} {places}, i32 8, {truths} {self.mask()})")


def _order(lanes: Iterable[int]) -> str:
    """Return the lanes that a shuffle takes."""
    chosen = list(lanes)
    return f"<{len(chosen)} x i32> <{', '.join(f'i32 {k}' for k in chosen)}>"
