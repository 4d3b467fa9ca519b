"""The arrays of a call in LLVM's code: how they stand in memory, checked and read from NumPy's own records.

A call hands over the arrays as objects. To ask each for its address in Python would take longer than to compute a
hundred poses. Lanes are loaded and stored one by one or many at once.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from compoundkin.programs.backends.llvm_plan import (
    ANY_STRIDE,
    ARRAY_KIND,
    COMPLEX,
    HEADER,
    NUMBER_KIND,
    SIDE_BY_SIDE,
    ArrayLayout,
    LanePlan,
    home,
)
from compoundkin.programs.backends.llvm_text import ControlText, LaneText
from compoundkin.programs.graph.flat_program import BY_DESIGN, BY_POSE, FlatProgram

FLOAT = np.dtype(float)


WORDS_OF_RECORD = 16


# Where a tuple has its first object.
FIRST_OBJECT = tuple.__basicsize__


def _record(array: Any) -> Any:
    """Return what NumPy's record of an array holds, as words."""
    words = np.zeros(WORDS_OF_RECORD, np.int64)
    start = words.ctypes.data
    values = {KIND: id(np.ndarray), DATA: array.ctypes.data, DIMENSIONS: array.ndim, NUMBERS: id(array.dtype),
              FLAGS: array.flags.num, SHAPE: start + 72, STRIDES: start + 88}  # fmt: skip
    for byte, value in values.items():
        words[byte // 8] = value
    words[9:11], words[11:13] = array.shape, array.strides
    return words


def _are_records_known() -> bool:
    """Tell whether this NumPy keeps arrays as is expected here, on this Python."""
    if sys.implementation.name != "cpython":
        return False
    array = np.zeros((4, 6))[::2, ::3]
    at, words = id(array), _record(array)
    if ctypes.sizeof(ctypes.c_void_p) != 8 or array.__sizeof__() < FLAGS + 4:
        return False

    def word(place: int) -> int:
        return ctypes.c_int64.from_address(place).value

    same = all(word(at + byte) == words[byte // 8] for byte in (KIND, DATA, NUMBERS))
    same &= all(ctypes.c_int.from_address(at + byte).value == words[byte // 8] for byte in (DIMENSIONS, FLAGS))
    row = (array, same)
    if not same or [word(id(row) + FIRST_OBJECT + 8 * k) for k in (0, 1)] != [id(array), id(same)]:
        return False
    return all(
        [word(word(at + byte) + 8 * k) for k in (0, 1)] == list(row)
        for byte, row in ((SHAPE, array.shape), (STRIDES, array.strides))
    )


# Where NumPy's record of an array has what (PyArrayObject_fields of its C interface, which it never changes).
KIND, DATA, DIMENSIONS, SHAPE, STRIDES, NUMBERS, FLAGS = 8, 16, 24, 32, 40, 56, 64


RECORDS_ARE_KNOWN = _are_records_known()


def array_records(program: FlatProgram, inputs: Any, outputs: Any, shape: tuple[int, int]) -> Any:
    """Return the arrays of a call, where their records are, and what keeps these."""
    nodes = [*program.given, *program.outputs]
    arrays: list[Any] = []
    for k, array in zip(nodes, (*inputs, *outputs), strict=True):
        is_output = len(arrays) >= len(program.given)
        found = np.asarray(array) if is_output else np.require(array, FLOAT, "A")
        if found.dtype != FLOAT or found.shape != program.shape(k, *shape):
            raise ValueError(f"an array of shape {found.shape} stands where one of {program.shape(k, *shape)} belongs")
        if is_output and not (found.flags.writeable and found.flags.aligned):
            raise ValueError("an array of results cannot be written")
        arrays.append(found.view(FLOAT) if found.dtype is not FLOAT else found)
    records = arrays if RECORDS_ARE_KNOWN else [_record(array) for array in arrays]
    places = [id(array) if RECORDS_ARE_KNOWN else array.ctypes.data for array in records]
    row = np.array(places, np.int64)
    return arrays, row.ctypes.data, (records, row)


def layout_of(program: FlatProgram, arrays: Sequence[Any], axis: int) -> ArrayLayout:
    """Return how arrays stand along the lanes of a plan."""
    nodes = [*program.given, *program.outputs]
    places: dict[Any, int] = {}
    kinds: list[int] = []
    pairs: list[tuple[int, int]] = []
    for i, (k, array) in enumerate(zip(nodes, arrays, strict=True)):
        lanes = lane_axis_of(program.strata[k], axis)
        along = 1 if lanes == BY_POSE else 0
        length, stride = array.shape[along], array.strides[along]
        kinds.append(SIDE_BY_SIDE if not lanes or length == 1 or stride == FLOAT.itemsize else ANY_STRIDE)
        if not lanes or (length > 1 and stride != 2 * FLOAT.itemsize):
            continue
        other = array.strides[1 - along] if array.shape[1 - along] > 1 else 0
        role = (i < len(program.given), program.strata[k], home(program, k), other)
        places[role, array.ctypes.data] = i
    for (role, place), i in places.items():
        partner = places.get((role, place + FLOAT.itemsize))
        if partner is not None and not any({i, partner} & set(pair) for pair in pairs):
            pairs.append((i, partner))
            kinds[i] = kinds[partner] = COMPLEX
    return ArrayLayout(tuple(kinds), tuple(pairs))


ALIGNED, WRITEABLE = 0x100, 0x400


HEAD = "define internal i1 @unpack(ptr %O, ptr %S, i64 %D, i64 %P) #0 {"


WANTED_STRIDE = {ANY_STRIDE: -1, SIDE_BY_SIDE: 8, COMPLEX: 16}


def lane_axis_of(stratum: int, axis: int) -> int:
    """Return the axis along which arrays are read in lanes, or 0."""
    return axis if stratum & axis else stratum & BY_POSE


def unpacking_text(plan: LanePlan) -> str:
    """Return the function that fills the table of arrays and checks them."""
    n = plan.arrays
    axes = [lane_axis_of(plan.stratum(k), plan.axis) for k in range(n)]
    wanted = [WANTED_STRIDE[kind] if axis else -1 for kind, axis in zip(plan.layout.kinds, axes, strict=True)]
    flags = [ALIGNED if k < len(plan.inputs) else ALIGNED | WRITEABLE for k in range(n)]
    tables = {"strata": [plan.stratum(k) for k in range(n)], "axes": axes, "wanted": wanted, "flags": flags}
    text = ControlText()
    with text.steps(0, n) as i:
        array = text.loaded("%O", i, "ptr")
        _expect(text, text.put(f"icmp eq i64 {_field(text, array, KIND)}, {text.loaded('%S', ARRAY_KIND)}"))
        _expect(text, _is_matrix_of_numbers(text, array, i))
        _expect(text, _is_of_shape(text, array, i))
    for one, other in plan.layout.pairs:
        _expect(text, _is_pair(text, one, other))
    rows = (
        f"@{name} = private constant [{n} x i64] [{', '.join(f'i64 {k}' for k in row)}]" for name, row in tables.items()
    )
    return "\n".join([*rows, HEAD, "entry:", *text.lines, "  ret i1 true", "bad:", "  ret i1 false", "}"])


def _expect(text: ControlText, truth: str) -> None:
    """Write that all is lost where something is not true."""
    name = f"good{truth.removeprefix('%')}"
    text.do(f"br i1 {truth}, label %{name}, label %bad")
    text.label(name)


def _field(text: ControlText, array: str, offset: int, kind: str = "i64") -> str:
    """Write the reading of a field of an array's record."""
    return text.put(f"load {kind}, ptr {text.put(f'getelementptr i8, ptr {array}, i64 {offset}')}")


def _all_true(text: ControlText, *truths: str) -> str:
    found = truths[0]
    for each in truths[1:]:
        found = text.put(f"and i1 {found}, {each}")
    return found


def _is_matrix_of_numbers(text: ControlText, array: str, i: str) -> str:
    """Write whether an array has two axes and holds numbers that can be read, or written."""
    needed = text.put(f"trunc i64 {text.loaded('@flags', i)} to i32")
    flags = text.put(f"and i32 {_field(text, array, FLAGS, 'i32')}, {needed}")
    return _all_true(
        text,
        text.put(f"icmp eq i32 {_field(text, array, DIMENSIONS, 'i32')}, 2"),
        text.put(f"icmp eq i64 {_field(text, array, NUMBERS)}, {text.loaded('%S', NUMBER_KIND)}"),
        text.put(f"icmp eq i32 {flags}, {needed}"),
    )


def _is_of_shape(text: ControlText, array: str, i: str) -> str:
    """Write an array's row of the table, and whether its shape and stride are as expected."""
    shape, strides = _field(text, array, SHAPE, "ptr"), _field(text, array, STRIDES, "ptr")
    row = text.words("%S", text.whole("add", text.whole("mul", i, 3), HEADER))
    text.do(f"store i64 {_field(text, array, DATA)}, ptr {row}")
    stratum, axis, wanted = (text.loaded(f"@{name}", i) for name in ("strata", "axes", "wanted"))
    truths = []
    any_stride = text.put(f"icmp eq i64 {wanted}, -1")
    for word, (bit, length) in enumerate(((BY_DESIGN, "%D"), (BY_POSE, "%P"))):
        here, stride = text.loaded(shape, word), text.loaded(strides, word)
        varies = text.put(f"icmp ne i64 {text.whole('and', stratum, bit)}, 0")
        truths.append(text.put(f"icmp eq i64 {here}, {text.put(f'select i1 {varies}, i64 {length}, i64 1')}"))
        one = text.put(f"icmp eq i64 {here}, 1")
        text.do(f"store i64 {text.put(f'select i1 {one}, i64 0, i64 {stride}')}, ptr {text.words(row, word + 1)}")
        fits = text.put(f"or i1 {one}, {text.put(f'icmp eq i64 {stride}, {wanted}')}")
        free = text.put(f"or i1 {any_stride}, {text.put(f'icmp ne i64 {axis}, {bit}')}")
        truths.append(text.put(f"or i1 {fits}, {free}"))
    return _all_true(text, *truths)


def _is_pair(text: ControlText, one: int, other: int) -> str:
    """Write whether two arrays are the parts of a complex one."""
    a, b = (text.words("%S", HEADER + 3 * array) for array in (one, other))
    behind = text.whole("add", text.loaded(a, 0), 8)
    truths = [text.put(f"icmp eq i64 {behind}, {text.loaded(b, 0)}")]
    truths += [text.put(f"icmp eq i64 {text.loaded(a, k)}, {text.loaded(b, k)}") for k in (1, 2)]
    return _all_true(text, *truths)


# Inputs stay as they are while a program runs, and no output overlaps them.
STEADY = "!invariant.load !0"


# Bytes: so far ahead results are prepared for; twelve outputs out of cache then take half the time.
AHEAD, CACHE_LINE = 512, 64
# Of more arrays than these nothing is prepared: they would be a tenth faster, and take three times as long to compile.
MOST_PREPARED = 256


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

    def _address(self, array: int, pose: str = "%p") -> str:
        """Write where the first lane of an array is at a pose."""
        base = self._base(array)
        if not self.plan.stratum(array) & BY_POSE:
            return base
        if self.axis == BY_POSE and self._kind(array) != ANY_STRIDE:
            of = "double" if self._kind(array) != COMPLEX else "<2 x double>"
            return self.text.put(f"getelementptr {of}, ptr {base}, i64 {pose}")
        offset = self.text.put(f"mul i64 {pose}, {self._step(array, 2)}")
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
        if self.axis & self.plan.stratum(array) and self._kind(array) == COMPLEX:
            return self._part(array)
        return self._at(array, self._address(array))

    def load_before(self, array: int, now: str) -> str:
        """Write the reading of an array's lanes a pose before, which is as they are `now` at the first pose."""
        text = self.text
        text.declared.add("declare i64 @llvm.smax.i64(i64, i64)")
        pose = text.put(f"call i64 @llvm.smax.i64(i64 {text.put('sub i64 %p, 1')}, i64 0)")
        found = self._at(array, self._address(array, pose))
        if text.lanes == 1 or self.axis != BY_POSE:
            return found
        # the lanes of the first poses, moved on by one
        order = _order((0, *range(text.lanes - 1)))
        late = text.put(f"shufflevector {text.real} {now}, {text.real} poison, {order}")
        is_first = text.put("icmp eq i64 %p, 0")
        return text.put(f"select i1 {is_first}, {text.real} {late}, {text.real} {found}")

    def _at(self, array: int, place: str) -> str:
        """Write the reading of an array's lanes of which the first is at a place."""
        if not self.axis & self.plan.stratum(array):
            return self.text.spread(self.text.put(f"load double, ptr {place}, {STEADY}"))
        return self._many(place, 1) if self._kind(array) == SIDE_BY_SIDE else self._gathered(array, place)

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

    def _places(self, array: int, place: str) -> str:
        """Write where each lane of an array of any stride is, of which the first is at a place."""
        text, word = self.text, 1 if self.axis == BY_DESIGN else 2
        lanes, whole = text.lanes, text.whole
        one = text.put(f"insertelement {whole} poison, i64 {self._step(array, word)}, i64 0")
        all_ = text.put(f"shufflevector {whole} {one}, {whole} poison, <{lanes} x i32> zeroinitializer")
        numbers = ", ".join(f"i64 {k}" for k in range(lanes))
        steps = text.put(f"mul {whole} {all_}, <{numbers}>")
        return text.put(f"getelementptr i8, ptr {place}, {whole} {steps}")

    def _gathered(self, array: int, place: str) -> str:
        text, lanes = self.text, self.text.lanes
        name = f"@llvm.masked.gather.v{lanes}f64.v{lanes}p0"
        pointers, truths = f"<{lanes} x ptr>", f"<{lanes} x i1>"
        text.declared.add(f"declare {text.real} {name}({pointers}, i32, {truths}, {text.real})")
        arguments = (
            f"{pointers} {self._places(array, place)}, i32 8, {truths} {self.mask()}, {text.real} zeroinitializer"
        )
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
        if self.plan.arrays > MOST_PREPARED:
            return
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
        places = self._places(array, self._address(array))
        text.do(f"call void {name}({text.real} {value}, {pointers} {places}, i32 8, {truths} {self.mask()})")


def _order(lanes: Iterable[int]) -> str:
    """Return the lanes that a shuffle takes."""
    chosen = list(lanes)
    return f"<{len(chosen)} x i32> <{', '.join(f'i32 {k}' for k in chosen)}>"
