"""Text in LLVM's language: straight-line arithmetic on lanes, loops and conditions as blocks of Python."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import count


def bits_of(value: float) -> str:
    """Return a number as LLVM writes it exactly.

    >>> bits_of(1.0)
    '0x3FF0000000000000'
    """
    return f"0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"


class LaneText:
    """Lines of code on values of several lanes, known by their names.

    Products are joined with sums where the machine can (`contract`); nothing else is loosened, so that what is not a
    number stays none.
    """

    def __init__(self, lanes: int, has_fma: bool) -> None:
        self.lanes, self.has_fma = lanes, has_fma
        self.lines: list[str] = []
        self.entry: list[str] = []
        self.declared: set[str] = set()
        self.real, self.whole, self.truth = self.kind("double"), self.kind("i64"), self.kind("i1")
        self._numbers = count(1)

    def narrowed(self, lanes: int) -> LaneText:
        """Return a writer of the same text for fewer lanes."""
        other = LaneText(lanes, self.has_fma)
        other.lines, other.entry, other.declared, other._numbers = self.lines, self.entry, self.declared, self._numbers
        return other

    def kind(self, scalar: str, lanes: int = 0) -> str:
        """Return the type of values of all lanes, or of some."""
        lanes = lanes or self.lanes
        return scalar if lanes == 1 else f"<{lanes} x {scalar}>"

    def put(self, code: str) -> str:
        """Write one instruction and return the name of its value."""
        name = f"%t{next(self._numbers)}"
        self.lines.append(f"  {name} = {code}")
        return name

    def first(self, code: str) -> str:
        """Write one instruction before the loop."""
        name = f"%t{next(self._numbers)}"
        self.entry.append(f"  {name} = {code}")
        return name

    def do(self, code: str) -> None:
        """Write an instruction that has no value."""
        self.lines.append(f"  {code}")

    # --- constants ---

    def number(self, value: float) -> str:
        """Return a number in all lanes."""
        return bits_of(value) if self.lanes == 1 else f"splat (double {bits_of(value)})"

    def integer(self, value: int) -> str:
        """Return a whole number in all lanes."""
        return str(value) if self.lanes == 1 else f"splat (i64 {value})"

    def spread(self, scalar: str) -> str:
        """Write one number in all lanes."""
        if self.lanes == 1:
            return scalar
        one = self.put(f"insertelement {self.real} poison, double {scalar}, i64 0")
        return self.put(f"shufflevector {self.real} {one}, {self.real} poison, {self.kind('i32')} zeroinitializer")

    # --- arithmetic ---

    def two(self, operation: str, a: str, b: str) -> str:
        """Write an operation on two numbers: fadd, fsub, fmul or fdiv."""
        return self.put(f"{operation} contract {self.real} {a}, {b}")

    def exact(self, operation: str, a: str, b: str) -> str:
        """Write an operation on two numbers that is never joined with another."""
        return self.put(f"{operation} {self.real} {a}, {b}")

    def bitwise(self, operation: str, a: str, b: str) -> str:
        """Write an operation on two whole numbers."""
        return self.put(f"{operation} {self.whole} {a}, {b}")

    def fma(self, a: str, b: str, c: str) -> str:
        """Write a b + c, rounded once where the machine can."""
        if self.has_fma:
            return self.call("fma", a, b, c)
        return self.exact("fadd", self.exact("fmul", a, b), c)

    def call(self, function: str, *operands: str) -> str:
        """Write a call of one of LLVM's own functions."""
        suffix = "f64" if self.lanes == 1 else f"v{self.lanes}f64"
        name, kinds = f"@llvm.{function}.{suffix}", ", ".join([self.real] * len(operands))
        self.declared.add(f"declare {self.real} {name}({kinds})")
        return self.put(f"call {self.real} {name}({', '.join(f'{self.real} {each}' for each in operands)})")

    def horner(self, x: str, coefficients: Sequence[float]) -> str:
        """Write a polynomial, its constant term first."""
        *others, found = (self.number(value) for value in coefficients)
        for value in reversed(others):
            found = self.fma(found, x, value)
        return found

    # --- truths and bits ---

    def compare(self, how: str, a: str, b: str) -> str:
        """Write a comparison of numbers: ogt, oge, oeq, uno ..."""
        return self.put(f"fcmp {how} {self.real} {a}, {b}")

    def truths(self, operation: str, a: str, b: str) -> str:
        """Write an operation on truths."""
        return self.put(f"{operation} {self.truth} {a}, {b}")

    def select(self, truth: str, one: str, other: str) -> str:
        """Write a choice between two numbers."""
        return self.put(f"select {self.truth} {truth}, {self.real} {one}, {self.real} {other}")

    def bits(self, a: str) -> str:
        """Write a number's bits as a whole number."""
        return self.put(f"bitcast {self.real} {a} to {self.whole}")

    def from_bits(self, a: str) -> str:
        """Write the number that has such bits."""
        return self.put(f"bitcast {self.whole} {a} to {self.real}")


class ControlText:
    """Lines of code with loops; the writer knows in which block it is."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.block = "entry"
        self._numbers = count(1)

    def put(self, code: str) -> str:
        """Write one instruction and return the name of its value."""
        name = f"%v{next(self._numbers)}"
        self.lines.append(f"  {name} = {code}")
        return name

    def do(self, code: str) -> None:
        """Write an instruction that has no value."""
        self.lines.append(f"  {code}")

    def label(self, name: str) -> None:
        """Begin a block."""
        self.lines.append(f"{name}:")
        self.block = name

    def whole(self, operation: str, a: str | int, b: str | int) -> str:
        """Write an operation on whole numbers."""
        return self.put(f"{operation} i64 {a}, {b}")

    def least(self, a: str | int, b: str | int) -> str:
        """Write the lesser of two whole numbers."""
        return self.put(f"call i64 @llvm.smin.i64(i64 {a}, i64 {b})")

    def words(self, base: str, offset: str | int) -> str:
        """Write the place so many words behind another."""
        return self.put(f"getelementptr i64, ptr {base}, i64 {offset}")

    def loaded(self, base: str, offset: str | int, kind: str = "i64") -> str:
        """Write the reading of a word."""
        return self.put(f"load {kind}, ptr {self.words(base, offset)}")

    @contextmanager
    def steps(self, start: str | int, stop: str | int, step: int = 1) -> Iterator[str]:
        """Write a loop that counts."""
        n = next(self._numbers)
        before, at = self.block, len(self.lines) + 2
        self.do(f"br label %test{n}")
        self.label(f"test{n}")
        self.lines.append("")
        self.do(f"%go{n} = icmp slt i64 %i{n}, {stop}")
        self.do(f"br i1 %go{n}, label %body{n}, label %exit{n}")
        self.label(f"body{n}")
        yield f"%i{n}"
        self.do(f"%next{n} = add i64 %i{n}, {step}")
        self.do(f"br label %test{n}")
        self.lines[at] = f"  %i{n} = phi i64 [ {start}, %{before} ], [ %next{n}, %{self.block} ]"
        self.label(f"exit{n}")

    @contextmanager
    def when(self, truth: str) -> Iterator[None]:
        """Write what is done only where something is true."""
        n = next(self._numbers)
        self.do(f"br i1 {truth}, label %then{n}, label %after{n}")
        self.label(f"then{n}")
        yield
        self.do(f"br label %after{n}")
        self.label(f"after{n}")
